/* The crack band: a bar torn across one row of cells costs the fracture energy times its section,
   whatever the size of the cells; across the corners of turned cells it costs more, as the band is
   wider. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/crack_band.h"

static double measured(const char *name, const char *nu, int size, bool turned) {
  const band b = {name, nu, size, turned};
  const double ratio = band_work(&b);
  band_page(&b, ratio);
  return ratio;
}

/* Without a strain across the bar nothing holds the band sideways: what is left is the tail of the
   softening, exp(-9.6), and what increments of 3 um smear. */
static void a_row_of_cells_costs_the_fracture_energy(void **state) {
  (void)state;
  assert_true(fabs(measured("mazars", "0", 20, false) - 1) < 2e-3);
  assert_true(fabs(measured("brittle_cracking", "0.2", 20, false) - 1) < 1e-3);
  assert_true(fabs(measured("brittle_cracking", "0.2", 10, false) - 1) < 1e-3);
}

/* Mazars' damage takes the contraction across the crack as well: the rows beside it hold the band,
   as in plane strain, and E/(1 - nu^2) stands for E, the more the smaller the cells are beside the
   width. */
static void held_sideways_it_costs_more(void **state) {
  (void)state;
  const double coarse = measured("mazars", "0.2", 20, false),
               fine = measured("mazars", "0.2", 10, false), most = 1 / (1 - 0.2 * 0.2);
  assert_true(1.03 < coarse && coarse < fine && fine < most);
}

/* A crack across the corners of cells runs over sqrt(2) of their size; half cells at the edges,
   which are the smaller ones, add to that. */
static void across_corners_the_band_is_wider(void **state) {
  (void)state;
  const double coarse = measured("mazars", "0.2", 20, true),
               fine = measured("mazars", "0.2", 10, true), free = sqrt(2),
               held = sqrt(2) / (1 - 0.2 * 0.2);
  assert_true(coarse > free && coarse < held && fine > free && fine < held);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_row_of_cells_costs_the_fracture_energy),
      cmocka_unit_test(held_sideways_it_costs_more),
      cmocka_unit_test(across_corners_the_band_is_wider),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
