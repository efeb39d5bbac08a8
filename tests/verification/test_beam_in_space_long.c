/* The beam in space with bars and stirrups as its deck has it: strength. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/beam_in_space.h"

static void it_carries_what_its_steel_bears(void **state) {
  (void)state;
  deck_case c;
  const char *const overrides[] = {"output.frames=0"};
  assert_true(deck_case_run(&c, BEAM_IN_SPACE, overrides, 1));
  assert_int_equal(deck_case_go(&c), STEP_END);
  carries_what_steel_bears(&c, "| 10 mm");
  deck_case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(it_carries_what_its_steel_bears)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
