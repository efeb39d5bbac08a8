/* What is said of rest stretches that are made of states: the order of the lines decides whether
   the force knows their new values. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <string.h>

#include "dsl/semantics/law_check.h"
#include "dsl/syntax/parse.h"
#include "generator/kernel/model.h"
#include "generator/sense/sense.h"

static bool is_late(const char *lines) {
  char text[1000];
  model m = {.memory = arena_new()};
  snprintf(text, sizeof text,
           "model m\n  law central bond\n  parameter k = 10 [MN] in (0, inf)\n"
           "  parameter tau = 10 [s] in (0, inf)\n  parameter rho = 2323 [kg/m^3] in (0, inf)\n"
           "  state v on bond = 0\n%s  force N = k*stretch\nend model\n",
           lines);
  diag_begin(&m.said, &m.sources);
  const int file = source_add(&m.sources, "law.plm", text, strlen(text));
  m.tree = parse_model(m.memory, &m.sources, file, NULL, &m.said);
  m.law = m.tree ? law_check(m.memory, m.tree, &m.sources, NULL, 0, &m.said) : NULL;
  if (!m.law) diag_print(&m.said, stderr);
  assert_non_null(m.law);
  law_is_sound(m.law, NULL, &m.said, NULL);
  bool late = false;
  for (int k = 0; k < m.said.count; k++)
    late = late || m.said.items[k].code == DIAG_ONE_STEP_LATE;
  model_close(&m);
  return late;
}

static void a_rest_above_the_rule_of_its_state_is_late(void **state) {
  (void)state;
  assert_true(is_late("  rest stretch = v\n  rate v = stretch/tau\n"));
  assert_true(is_late("  rest stretch = 1e-3*v\n  rate v = (1 - v)/tau\n"));
  assert_true(is_late("  x = 1e-3*v**2\n  rest stretch = x\n  rate v = (1 - v)/tau\n"));
  assert_true(is_late("  x = 1e-3*v**2\n  rate v = (1 - v)/tau\n  rest stretch = x\n"));
  assert_false(is_late("  rate v = (1 - v)/tau\n  rest stretch = 1e-3*v\n"));
  assert_false(is_late("  rest stretch = 1e-3*previous(v)\n  rate v = (1 - v)/tau\n"));
}

static void a_late_rest_can_be_meant(void **state) {
  (void)state;
  assert_false(is_late("  rest stretch = v\n  rate v = stretch/tau\n"
                       "  accept one-step-late \"steps are short beside tau\"\n"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_rest_above_the_rule_of_its_state_is_late),
      cmocka_unit_test(a_late_rest_can_be_meant),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
