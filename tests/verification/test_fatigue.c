/* Cracks by cycles, models/fatigue.plm, in quasi-static runs of a notched plate between two grips:
   twice the displacement does the same in a time that the exponent says, and what is broken around
   a bond makes it live less long. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"

enum { INCREMENTS = 80 };

/* Broken bonds after each increment; the plate is pulled apart by `pull`, um, in the first one.
   Returns the largest force, N. */
static double grow(double end, double pull, const char *given, double *broken) {
  char text[3000];
  snprintf(text, sizeof text,
           "&simulation end_time = '%.17g s' threads = 1 /\n"
           "&relaxation increments = %d tolerance = 1e-7 /\n"
           "&lattice name = 'l' kind = 'hexagonal' spacing = '5 mm' horizon = 2.015 "
           "thickness = '10 mm' /\n&material lattice = 'l' model = 'fatigue' s_0 = 1 %s /\n"
           "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '100 mm', '50 mm' /\n"
           "&notch lattice = 'l' shape = 'segment' from = '-1 mm', '24.5 mm' "
           "to = '30 mm', '24.5 mm' /\n"
           "&region name = 'foot' shape = 'rectangle' corner = -1, '-1 mm' size = 2, '6 mm' /\n"
           "&region name = 'head' shape = 'rectangle' corner = -1, '42 mm' size = 2, 1 /\n"
           "&support region = 'foot' fix = 'xy' /\n&support region = 'head' fix = 'x' /\n"
           "&drive region = 'head' component = 'y' displacement = '%.17g um' "
           "rise = '%.17g s' /\n"
           "&monitor name = 'load' kind = 'reaction' region = 'head' component = 'y' /\n"
           "&monitor name = 'broken' kind = 'broken' /\n",
           end, INCREMENTS, given, pull, end / INCREMENTS);
  deck_case c;
  deck_case_open(&c, text);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double *time, *load = deck_case_series(&c, "load"), *cut = deck_case_series(&c, "broken");
  assert_int_equal(simulation_history(c.simulation, &time), INCREMENTS + 1);
  double most = 0;
  for (int k = 0; k <= INCREMENTS; k++) {
    broken[k] = cut[k];
    most = fmax(most, fabs(load[k]));
  }
  deck_case_close(&c);
  return most;
}

/* Stretches go with the displacement, and lives with their third power: with Delta K the law of
   Paris and its exponent. Small displacements, so that chords hardly turn; a bond whose life ends
   as an increment does may break in this one or the next. */
static void a_crack_grows_with_the_power_of_the_range(void **state) {
  (void)state;
  static const char given[] = "m_1 = 3 A_1 = 6e10 m_2 = 3 A_2 = 3e11 phi_c = 0.15";
  double once[INCREMENTS + 1], twice[INCREMENTS + 1];
  const double load = grow(80, 1, given, once), other = grow(10, 2, given, twice);
  print_message("largest force %.6g and %.6g N, %g and %g bonds broken\n", load, other,
                once[INCREMENTS], twice[INCREMENTS]);
  assert_true(fabs(other / load - 2) < 1e-4);
  assert_true(once[INCREMENTS / 4] < once[INCREMENTS / 2] && once[INCREMENTS] > 30);
  for (int k = 0; k <= INCREMENTS; k++)
    if (fabs(once[k] - twice[k]) > 2)
      fail_msg("increment %d: %g and %g broken", k, once[k], twice[k]);
}

static void where_cracks_grow_bonds_live_less_long(void **state) {
  (void)state;
  double grown[INCREMENTS + 1], begun[INCREMENTS + 1];
  grow(80, 1, "m_1 = 3 A_1 = 6e10 m_2 = 3 A_2 = 3e11 phi_c = 0.15", grown);
  grow(80, 1, "m_1 = 3 A_1 = 6e10 m_2 = 3 A_2 = 3e11 phi_c = 1", begun);
  print_message("%g bonds broken, %g of them where cracks begin\n", grown[INCREMENTS],
                begun[INCREMENTS]);
  int k = 0;
  while (k < INCREMENTS && begun[k] == grown[k]) /* until enough of a family is broken */
    k++;
  assert_true(grown[k] > 0 && grown[INCREMENTS] > 2 * begun[INCREMENTS]);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_crack_grows_with_the_power_of_the_range),
      cmocka_unit_test(where_cracks_grow_bonds_live_less_long),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
