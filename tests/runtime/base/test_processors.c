/* A process that is bound to some processors counts these. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <omp.h>
#include <sched.h>

#include "runtime/base/processors.h"

static void as_many_as_it_may_use(void **state) {
  (void)state;
  cpu_set_t all;
  assert_int_equal(sched_getaffinity(0, sizeof all, &all), 0);
  const int count = CPU_COUNT(&all);
  assert_int_equal(usable_processors(), count);
  for (size_t cpu = 0, bound = 0; cpu < CPU_SETSIZE && !bound; cpu++) {
    if (!CPU_ISSET(cpu, &all)) continue;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(cpu, &one);
    assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
    bound = 1;
  }
  assert_int_equal(usable_processors(), 1);
  assert_int_equal(sched_setaffinity(0, sizeof all, &all), 0);
  assert_int_equal(usable_processors(), count);
}

/* Other answers of a class have the others. */
static void no_more_than_it_keeps_to(void **state) {
  (void)state;
  const int count = usable_processors();
  processors_keep_to(1);
  assert_int_equal(usable_processors(), 1);
  assert_int_equal(omp_get_max_threads(), 1);
  processors_keep_to(count + 5);
  assert_int_equal(usable_processors(), count);
  assert_int_equal(omp_get_max_threads(), count);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(as_many_as_it_may_use),
                                     cmocka_unit_test(no_more_than_it_keeps_to)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
