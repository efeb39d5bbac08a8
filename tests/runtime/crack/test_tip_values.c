/* Names of what is known of a tip: each has a unit that the language knows, and words. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "dsl/base/units.h"
#include "runtime/crack/tip_values.h"

static void test_names(void **state) {
  (void)state;
  assert_string_equal(tip_value_names[TIP_K_I], "K_I");
  assert_string_equal(tip_value_names[TIP_segments], "segments");
  for (int k = 0; k < TIP_VALUE_COUNT; k++) {
    unit found;
    const char *bad;
    size_t length;
    assert_true(unit_parse(tip_value_units[k], strlen(tip_value_units[k]), &found, &bad, &length));
    assert_true(strlen(tip_value_words[k]) > 0);
    for (int n = 0; n < k; n++)
      assert_string_not_equal(tip_value_names[n], tip_value_names[k]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_names)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
