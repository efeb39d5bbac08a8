/* The bounds of the classes of damage are those of Asadollahi (2014, table 4.3); the worse, the
   darker. */
#include <math.h>
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

/* Relative luminance of sRGB (IEC 61966-2-1). */
static double luminance(colour c) {
  const double parts[] = {c.r, c.g, c.b}, weights[] = {0.2126, 0.7152, 0.0722};
  double sum = 0;
  for (int k = 0; k < 3; k++)
    sum += weights[k] *
           (parts[k] <= 0.04045 ? parts[k] / 12.92 : pow((parts[k] + 0.055) / 1.055, 2.4));
  return sum;
}

static void worse_is_darker(void **state) {
  (void)state;
  for (int k = 1; k < DAMAGE_CLASSES; k++)
    assert_true(luminance(damage_classes[k].ink) < luminance(damage_classes[k - 1].ink) - 0.01);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(bounds_belong_below),
                                     cmocka_unit_test(worse_is_darker)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
