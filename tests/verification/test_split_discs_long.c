/* The split discs on finite elements, beside the lattice and theory. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/beside.h"

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
      cmocka_unit_test(split_discs_under_plastic_damage),
      cmocka_unit_test(split_discs_under_brittle_cracking),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
