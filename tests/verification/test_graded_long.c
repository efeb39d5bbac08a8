/* A dog-bone of irregular particles of one size beside that with small ones in its neck alone:
   what its page says of both. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/page.h"
#include "tests/verification/specimen.h"

static outcome bone(const char *row, const char *more) {
  char figures[96];
  const outcome o = specimen_run("examples/dog_bone/d_graded.nml", NULL, more);
  const double work = o.lost / (0.24 * 0.1) / 85.57;
  print_message("%s %.2f kN, %.2f G_f\n", row, 1e-3 * o.peak, work);
  snprintf(figures, sizeof figures, " %.2f kN | %.2f G_f |", 1e-3 * o.peak, work);
  page_line_says("examples/dog_bone/README.md", row, figures);
  return o;
}

static void a_fine_neck_is_enough(void **state) {
  (void)state;
  const outcome graded = bone("| [d_graded.nml](d_graded.nml) |", NULL),
                even = bone("| the same, spacing 8 mm |", "lattice.spacing=8 mm");
  assert_true(fabs(graded.peak / even.peak - 1) < 0.005);
  assert_true(fabs(graded.lost / even.lost - 1) < 0.03);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_fine_neck_is_enough)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
