/* The classes of damage are those of Asadollahi (2014, table 4.3). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/plot/damage_classes.h"

/* Each bound belongs to the class below it; only a damage of 1 separates. */
static void bounds_belong_below(void **state) {
  (void)state;
  static const struct {
    double damage;
    int class;
  } rows[] = {{0, 0},   {1e-9, 1}, {0.3, 1},    {0.31, 2},        {0.6, 2},
              {0.7, 3}, {0.8, 3},  {0.8001, 4}, {0.999999999, 4}, {1, 5}};
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
    assert_int_equal(damage_class_of(rows[k].damage), rows[k].class);
  assert_string_equal(damage_classes[DAMAGE_CLASSES - 1].text, "separated");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(bounds_belong_below)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
