/* A prism with a slit at either side is pulled in two: the width of its crack is how far its ends
   have parted, on lattices in the plane and in space and on none; frames hold what the monitor
   says. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"

typedef struct prism {
  const char *name, *lattice, *law;
  bool space;
} prism;

static const prism prisms[] = {
    {"hexagonal", "kind = 'hexagonal' spacing = '5 mm' thickness = '10 mm'", "mplm_bilinear",
     false},
    {"square", "kind = 'square' spacing = '5 mm' horizon = 3.015 thickness = '10 mm'",
     "pmb' G_0 = '10 J/m^2", false},
    {"no lattice", "kind = 'blue_noise' spacing = '5 mm' thickness = '10 mm'",
     "pmb' G_0 = '10 J/m^2", false},
    {"fcc", "kind = 'fcc' spacing = '5 mm' shells = 2", "pmb' G_0 = '10 J/m^2", true},
};

static void open_prism(deck_case *c, const prism *p) {
  char text[4096];
  const char *from = p->space ? "'8 mm', '8 mm', '8 mm'" : "'8 mm', '8 mm'",
             *to = p->space ? "'92 mm', '8 mm', '8 mm'" : "'92 mm', '8 mm'",
             *block = p->space ? "'box' corner = 0, 0, 0 size = '100 mm', '20 mm', '20 mm'"
                               : "'rectangle' corner = 0, 0 size = '100 mm', '20 mm'",
             *slit = p->space ? "'face' points = '52 mm', '14 mm', -1, '52 mm', 1, -1, '52 mm', 1, "
                                "1, '52 mm', '14 mm', 1"
                              : "'segment' from = '52 mm', '14 mm' to = '52 mm', 1",
             *whole = p->space ? "'box' corner = %s, -1, -1 size = 1, 3, 3"
                               : "'rectangle' corner = %s, -1 size = 1, 3";
  char left[128], right[128];
  snprintf(left, sizeof left, whole, "'-992 mm'");
  snprintf(right, sizeof right, whole, "'92 mm'");
  snprintf(text, sizeof text,
           "&simulation end_time = '1.5 ms' threads = 1 /\n"
           "&output frames = 3 sample = '0.1 ms' /\n&damping rate = 20000 /\n"
           "&lattice name = 'c' %s /\n&material lattice = 'c' model = '%s' /\n"
           "&body lattice = 'c' shape = %s /\n&notch lattice = 'c' shape = %s /\n"
           "&region name = 'left' shape = %s /\n&region name = 'right' shape = %s /\n"
           "&support region = 'left' fix = 'x' /\n"
           "&drive region = 'right' component = 'x' velocity = 0.2 rise = '0.1 ms' /\n"
           "&monitor name = 'apart' kind = 'opening' between = 'left', 'right' component = 'x' /\n"
           "&monitor name = 'width' kind = 'crack_width' from = %s to = %s /\n"
           "&monitor name = 'held' kind = 'reaction' region = 'left' component = 'x' /\n",
           p->lattice, p->law, block, slit, left, right, from, to);
  if (!deck_case_text(c, text)) diag_print(&c->model.said, stderr);
  if (!c->simulation) {
    diag_print(&c->said, stderr);
    fail_msg("%s", text);
  }
}

/* The last frame: the sum of its widths, and the widest. */
static long widths_in_frame(const deck_case *c, double *sum, double *widest) {
  const frame_field *fields;
  const int count = simulation_frame_fields(c->simulation, &fields);
  for (int k = 0; k < count; k++) {
    if (!fields[k].of_cracks) continue;
    double *values = calloc((size_t)fields[k].count * 2, sizeof *values);
    long cracks = 0;
    *sum = *widest = 0;
    assert_string_equal(fields[k].name, "width");
    simulation_frame_values(c->simulation, k, values);
    for (; cracks < fields[k].count && !isnan(values[2 * cracks]); cracks++) {
      *sum += values[2 * cracks + 1];
      *widest = fmax(*widest, values[2 * cracks + 1]);
      assert_true(values[2 * cracks] > 0 && values[2 * cracks] < 0.084);
    }
    free(values);
    return cracks;
  }
  return -1;
}

static void a_torn_prism_opens_as_its_ends_part(void **state) {
  (void)state;
  for (size_t n = 0; n < sizeof prisms / sizeof *prisms; n++) {
    deck_case c;
    double sum = 0, widest = 0;
    open_prism(&c, &prisms[n]);
    assert_int_equal(deck_case_go(&c), STEP_END);
    const long last = simulation_history(c.simulation, NULL) - 1,
               cracks = widths_in_frame(&c, &sum, &widest);
    const double apart = deck_case_series(&c, "apart")[last],
                 width = deck_case_series(&c, "width")[last];
    print_message("%s: ends %.2f um apart, %ld cracks of %.2f um in sum\n", prisms[n].name,
                  1e6 * apart, cracks, 1e6 * sum);
    assert_true(apart > 2e-4 && cracks >= 1);
    assert_true(deck_case_series(&c, "width")[0] == 0);
    assert_true(fabs(widest - width) == 0);
    assert_true(fabs(sum / apart - 1) < 0.01);
    deck_case_close(&c);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_torn_prism_opens_as_its_ends_part)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
