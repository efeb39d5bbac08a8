/* The finest bars of the crack band. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

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

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bands_of_5_mm),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
