/* Time that passes: it never goes back, and a sleep takes as long as the machine's own clock says. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <time.h>

#include "runtime/base/clock.h"

static void time_never_goes_back(void **state) {
  (void)state;
  double last = monotonic_seconds();
  for (int k = 0; k < 100000; k++) {
    const double now = monotonic_seconds();
    assert_true(now >= last);
    last = now;
  }
}

/* A second way to the same number, read before and after: what the clock says lies between. */
static void a_sleep_takes_its_time(void **state) {
  (void)state;
  struct timespec from, to;
  const struct timespec nap = {0, 20000000};
  clock_gettime(CLOCK_MONOTONIC, &from);
  const double begin = monotonic_seconds();
  nanosleep(&nap, NULL);
  const double took = monotonic_seconds() - begin;
  clock_gettime(CLOCK_MONOTONIC, &to);
  const double around =
      (double)(to.tv_sec - from.tv_sec) + 1e-9 * (double)(to.tv_nsec - from.tv_nsec);
  assert_true(took >= 0.02 - 1e-6 && took <= around + 1e-6);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(time_never_goes_back),
      cmocka_unit_test(a_sleep_takes_its_time),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
