/* A strip with notches on both sides in plane strain, of a metal without hardening: with the mean
   dilatation its load comes to the limit (Ewing and Hill 1967; Nagtegaal, Parks and Rice 1974),
   with a dilatation at each point it rises on. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"

enum { INCREMENTS = 100 };
static const double f_y = 243e6, half_ligament = 2.5, half_width = 5; /* Pa, m, m */

/* A half of the strip's upper half. load[INCREMENTS + 1], over that of a strip of the ligament's
   width alone, 2/sqrt(3) f_y times that. */
static void draw_out(const char *elements, int cells, double *load) {
  char text[4096];
  deck_case c;
  snprintf(
      text, sizeof text,
      "&simulation end_time = 1 threads = 1 /\n"
      "&relaxation increments = %d tolerance = 1e-3 /\n"
      "&mesh name = 'part' size = 5, 10 nodes = %d, %d thickness = 1 setting = 'plane_strain' "
      "method = 'finite_elements' %s /\n"
      "&material mesh = 'part' model = 'von_mises' E = 70e9 nu = 0.3 f_y = %g H = 0 H_kin = 0 rho "
      "= "
      "2700 /\n"
      "&region name = 'middle' shape = 'segment' from = 0, 0 to = 0, 10 /\n"
      "&region name = 'ligament' shape = 'segment' from = 0, 0 to = %g, 0 /\n"
      "&region name = 'top' shape = 'segment' from = 0, 10 to = 5, 10 /\n"
      "&support region = 'middle' fix = 'x' /\n"
      "&support region = 'ligament' fix = 'y' /\n"
      "&drive region = 'top' component = 'y' displacement = 0.2 /\n"
      "&monitor name = 'load' kind = 'reaction' region = 'ligament' component = 'y' scale = -1 "
      "/\n",
      INCREMENTS, cells + 1, 2 * cells + 1, elements, f_y, half_ligament);
  deck_case_open(&c, text);
  assert_int_equal(deck_case_go(&c), STEP_END);
  assert_int_equal(simulation_history(c.simulation, NULL), INCREMENTS + 1);
  for (int k = 0; k <= INCREMENTS; k++)
    load[k] = deck_case_series(&c, "load")[k] / (2 / sqrt(3.0) * f_y * half_ligament);
  deck_case_close(&c);
}

static void the_limit_is_reached(void **state) {
  (void)state;
  const double notch = half_width - half_ligament, part = notch / (2 * half_width),
               limit = 1 + log((1 - part) / (1 - 2 * part));
  double coarse[INCREMENTS + 1], fine[INCREMENTS + 1], plain[INCREMENTS + 1];
  const int half = INCREMENTS / 2, end = INCREMENTS;
  draw_out("gauss = 2 dilatation = 'mean'", 10, coarse);
  draw_out("gauss = 2 dilatation = 'mean'", 20, fine);
  draw_out("gauss = 2", 10, plain);
  print_message("limit %.4f; mean dilatation %.4f, %.4f, over the last half of the way by %.2f %% "
                "and %.2f %%; at each point %.4f, by %.2f %%\n",
                limit, coarse[end], fine[end], 100 * (coarse[end] / coarse[half] - 1),
                100 * (fine[end] / fine[half] - 1), plain[end],
                100 * (plain[end] / plain[half] - 1));
  assert_true(fine[end] > limit && fine[end] < 1.04 * limit);
  assert_true(coarse[end] > fine[end] && coarse[end] < 1.07 * limit);
  /* from above, with the first power of the spacing */
  assert_true(fabs(2 * fine[end] - coarse[end] - limit) < 0.01 * limit);
  assert_true(coarse[end] < 1.01 * coarse[half] && fine[end] < 1.01 * fine[half]);
  assert_true(plain[end] > 1.15 * limit && plain[end] > 1.03 * plain[half]);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_limit_is_reached)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
