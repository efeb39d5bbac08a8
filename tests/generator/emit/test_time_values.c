/* What follows from the step in time alone stands before the loops: a law with a rate computes its
   exponentials once for all bonds of a strip. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "generator/emit/emit.h"
#include "generator/kernel/model.h"

#define HEAD "PL_PASS void rows(const pl_law *law"

static int count_of(const char *begin, const char *end, const char *what) {
  int count = 0;
  for (const char *at = begin; (at = strstr(at, what)) && at < end; at++)
    count++;
  return count;
}

static void exponentials_of_the_step_stand_before_the_loops(void **state) {
  (void)state;
  model m;
  assert_true(model_open(&m, SOURCE_DIR "/models/maxwell_bond.plm", NULL, 0));
  assert_true(model_plan(&m));
  char *text = emit_kernel(m.plan);
  const char *begin = strstr(text, HEAD), *end = begin ? strstr(begin, "\n}\n") : NULL;
  assert_non_null(end);
  const char *loop = strstr(begin, "  for (");
  assert_true(loop && loop < end);
  assert_int_equal(count_of(begin, loop, "pl_exp("), 2); /* one of each chain */
  assert_int_equal(count_of(loop, end, "pl_exp("), 0);
  assert_int_equal(count_of(loop, end, "/"), count_of(loop, end, "/*") + count_of(loop, end, "*/"));
  assert_true(m.plan->divisions_per_bond == 0); /* nor do they count */
  free(text);
  model_close(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(exponentials_of_the_step_stand_before_the_loops),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
