/* What engineers use otherwise, beside the lattice: the prisms and the smaller dog-bone on finite
   elements, under Mazars' damage, brittle cracking and plastic damage. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/beside.h"

static const double tension = 58.88e3, compression = 620.55e3, bone_b = 14.49e3;

/* A uniform stress up to the peak: what is short of the strength is the dampers' share, which parts
   what the ends carry by 0.2 %. */
static void the_prism_in_tension(void **state) {
  (void)state;
  beside_check(&(beside){"tension", "rot0_continuum", "7.8 ms", tension, 0.99, 1.005, NULL});
  beside_check(&(beside){"tension", "rot0_brittle", "7.8 ms", tension, 0.99, 1.005, NULL});
}

/* The dampers' share is larger, and near its flat peak the prism begins to bulge in bands. */
static void the_prism_in_compression(void **state) {
  (void)state;
  beside_check(&(beside){"compression", "rot0_continuum", "10 ms", compression, 0.98, 1.005, NULL});
}

/* The lattice carries 14.61 kN (b_s4.nml). */
static void the_dog_bone(void **state) {
  (void)state;
  const double lattice = 14.61e3,
               brittle = beside_check(
                   &(beside){"dog_bone", "b_brittle", "3.5 ms", bone_b, 0.98, 1.02, NULL}),
               plastic = beside_check(
                   &(beside){"dog_bone", "b_continuum", "3.5 ms", bone_b, 0.98, 1.02, NULL});
  assert_true(fabs(brittle / plastic - 1) < 0.02);
  assert_true(fabs(brittle / lattice - 1) < 0.02);
  assert_true(fabs(plastic / lattice - 1) < 0.02);
}

/* On a third of the cells. Where the disc begins to split the stress across is f_t for Rankine;
   under three times as much pressure Lubliner's surface has 0.81 f_t, from where the load is yet to
   grow. Brittle cracking knows no crushing: the disc splits, and bears more and more. */
static void the_split_cylinder(void **state) {
  (void)state;
  const double theory = 236.0e3;
  beside_run(&(beside){"cylinder", "rot0_continuum", "6.5 ms", theory, 0.81, 1, "disc_coarse.msh"});
  assert_true(beside_at_end(&(beside){.example = "cylinder",
                                      .deck = "rot0_brittle",
                                      .until = "11 ms",
                                      .theory = theory,
                                      .mesh = "disc_coarse.msh"}) > 1.8);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_prism_in_tension),
      cmocka_unit_test(the_prism_in_compression),
      cmocka_unit_test(the_dog_bone),
      cmocka_unit_test(the_split_cylinder),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
