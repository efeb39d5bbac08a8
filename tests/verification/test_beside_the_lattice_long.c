/* The finest bars of the crack band, the larger dog-bone and the split discs on finite elements,
   beside the lattice and theory. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/beside.h"
#include "tests/verification/crack_band.h"

static void finest(const char *name, const char *nu, bool turned, double least, double most) {
  const band b = {name, nu, 5, turned};
  const double ratio = band_work(&b);
  band_page(&b, ratio);
  assert_true(least < ratio && ratio < most);
}

static void bands_of_5_mm(void **state) {
  (void)state;
  const double held = 1 / (1 - 0.2 * 0.2);
  finest("mazars", "0", false, 0.998, 1.002);
  finest("mazars", "0.2", false, 1.037, held);
  finest("brittle_cracking", "0.2", false, 0.997, 1.003);
  finest("mazars", "0.2", true, sqrt(2), sqrt(2) * held);
}

/* The stress at the sides of the neck is above the mean, and the crack begins there while the
   middle is sound: less than the strength of all of the neck. */
static void the_larger_dog_bone(void **state) {
  (void)state;
  const double theory = 57.96e3,
               brittle = beside_check(
                   &(beside){"dog_bone", "d_brittle", "10.4 ms", theory, 0.9, 0.98, NULL}),
               plastic = beside_check(
                   &(beside){"dog_bone", "d_continuum", "10.8 ms", theory, 0.9, 0.98, NULL});
  assert_true(fabs(brittle / plastic - 1) < 0.03);
}

/* Lubliner's surface has 0.81 and 0.77 f_t under three times as much pressure across; from there
   the load is yet to grow, as the stress moves away from the middle. */
static void split_discs_under_plastic_damage(void **state) {
  (void)state;
  beside_check(&(beside){"cylinder", "rot0_continuum", "6.5 ms", 236.0e3, 0.81, 1, NULL});
  beside_check(&(beside){"brazilian", "rot0_continuum", "6.5 ms", 193.0e3, 0.77, 1, NULL});
}

/* Brittle cracking knows no crushing: the discs split, and bear more and more. */
static void split_discs_under_brittle_cracking(void **state) {
  (void)state;
  assert_true(
      beside_at_end(&(beside){
          .example = "cylinder", .deck = "rot0_brittle", .until = "12 ms", .theory = 236.0e3}) > 2);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bands_of_5_mm),
      cmocka_unit_test(the_larger_dog_bone),
      cmocka_unit_test(split_discs_under_plastic_damage),
      cmocka_unit_test(split_discs_under_brittle_cracking),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
