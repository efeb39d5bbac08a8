/* Concrete in space with other spacings, turned, with the other profile: loads that its page has. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"
#include "tests/verification/page.h"

enum { MOST_SETTINGS = 4 };

typedef struct variant {
  const char *deck, *until; /* `until` is past the peak */
  const char *set[MOST_SETTINGS];
  const char *line, *format; /* of the page: where the peak stands, kN */
} variant;

#define TURNED(degrees) "lattice.rotation=" degrees, "lattice.axis=1, 0, 0"
#define OBJECTIVE       "material.profile=objective"

static const variant variants[] = {
    {"tension", "3.1 ms", {"lattice.spacing=15 mm"}, "| [tension.nml]", "| %.1f kN |"},
    {"tension", "3.1 ms", {"lattice.spacing=10 mm"}, "| [tension.nml]", "| %.1f kN |"},
    {"compression", "6.3 ms", {"lattice.spacing=15 mm"}, "| [compression.nml]", "| %.1f kN |"},
    {"compression", "6.1 ms", {"lattice.spacing=10 mm"}, "| [compression.nml]", "| %.1f kN |"},
    {"crushed", "6.5 ms", {"lattice.spacing=15 mm"}, "| [crushed.nml]", "| %.1f kN |"},
    {"split", "3.5 ms", {"lattice.spacing=15 mm"}, "| [split.nml]", "| %.1f kN |"},
    {"tension", "3.2 ms", {TURNED("15")}, "- **The lattice turned", ", %.1f and "},
    {"tension", "3.2 ms", {TURNED("30")}, "- **The lattice turned", " and %.1f kN at"},
    {"compression", "4.3 ms", {TURNED("15")}, "- **The lattice turned", ", %.1f and "},
    {"compression", "4.9 ms", {TURNED("30")}, "- **The lattice turned", " and %.1f kN."},
    {"compression", "6.6 ms", {OBJECTIVE}, "  prism bears ", "prism bears %.1f kN"},
    {"compression",
     "6.1 ms",
     {OBJECTIVE, "lattice.spacing=15 mm", TURNED("15")},
     "  prism bears ",
     " %.1f and "},
    {"compression",
     "6.1 ms",
     {OBJECTIVE, "lattice.spacing=15 mm", TURNED("30")},
     "  prism bears ",
     " and %.1f kN"},
    {"crushed", "4.6 ms", {"material.profile=thesis"}, "  prism bears ", "bears %.1f kN."},
    {"tension", "8.3 ms", {"drive.rise=33.6 ms"}, "- **Speed of the load", " %.2f kN"},
};

static double peak_of(const variant *v) {
  const char *overrides[MOST_SETTINGS + 2] = {"output.frames=0"};
  char path[128], until[64];
  int count = 1;
  deck_case c;
  snprintf(path, sizeof path, "examples/prism_in_space/%s.nml", v->deck);
  snprintf(until, sizeof until, "simulation.end_time=%s", v->until);
  overrides[count++] = until;
  for (int k = 0; k < MOST_SETTINGS && v->set[k]; k++)
    overrides[count++] = v->set[k];
  if (!deck_case_run(&c, path, overrides, count)) fail_msg("%s does not run", path);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double *load = deck_case_series(&c, "load");
  const long samples = simulation_history(c.simulation, NULL), at = largest_of(load, samples);
  assert_true(at < samples - 5);
  const double peak = load[at];
  deck_case_close(&c);
  return peak;
}

static void the_page_has_their_loads(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof variants / sizeof *variants; k++) {
    const variant *v = &variants[k];
    char figure[64];
    snprintf(figure, sizeof figure, v->format, 1e-3 * peak_of(v));
    print_message("%s, %s: %s\n", v->deck, v->set[0], figure);
    page_line_says("examples/prism_in_space/README.md", v->line, figure);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_page_has_their_loads)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
