/* Single laws, each with what is said of it: a code with part of its words, or nothing at all. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/semantics/law_check.h"
#include "dsl/syntax/parse.h"
#include "generator/facts/law_judged.h"

typedef struct judged {
  arena *memory;
  source_set sources;
  diagnostics said;
} judged;

/* As `perilat check` has it. */
static judged *judge(const char *text) {
  judged *j = must_calloc(1, sizeof *j);
  const parse_options options = {NULL, NULL};
  j->memory = arena_new();
  diag_begin(&j->said, &j->sources);
  const int file = source_add(&j->sources, "law.plm", text, strlen(text));
  tree *t = parse_model(j->memory, &j->sources, file, &options, &j->said);
  law *l = t && !j->said.errors ? law_check(j->memory, t, &j->sources, NULL, 0, &j->said) : NULL;
  if (l) law_obeys(l, NULL, &j->said, NULL);
  return j;
}

static void judged_free(judged *j) {
  diag_clear(&j->said);
  source_clear(&j->sources);
  arena_free(j->memory);
  free(j);
}

static int count_of(const judged *j, const char *code) {
  int count = 0;
  for (int k = 0; k < j->said.count; k++)
    count += strcmp(diag_name(j->said.items[k].code), code) == 0;
  return count;
}

static bool holds_words(const judged *j, const char *code, const char *words) {
  for (int k = 0; k < j->said.count; k++)
    if (strcmp(diag_name(j->said.items[k].code), code) == 0 &&
        strstr(j->said.items[k].message, words))
      return true;
  return false;
}

static void nothing_is_said_of(const char *text) {
  judged *j = judge(text);
  if (j->said.count) diag_print(&j->said, stderr);
  assert_int_equal(j->said.count, 0);
  judged_free(j);
}

static void is_said_once(const char *text, const char *code, const char *words) {
  judged *j = judge(text);
  if (count_of(j, code) != 1 || !holds_words(j, code, words)) diag_print(&j->said, stderr);
  assert_int_equal(count_of(j, code), 1);
  assert_true(holds_words(j, code, words));
  judged_free(j);
}

#define BOND                                                                                      \
  "model m\n  law central bond\n  parameter k = 10 [MN] in (0, inf)\n"                             \
  "  parameter rho = 2323 [kg/m^3] in (0, inf)\n"
#define END "end model\n"

/* --- the rest state --------------------------------------------------------------------------- */

static void states_may_act_by_the_rest_alone(void **state) {
  (void)state;
  nothing_is_said_of(BOND "  state v on bond = 0\n  rest stretch = previous(v)\n"
                          "  v = max(previous(v), stretch)\n  force N = k*stretch\n" END);
  nothing_is_said_of(BOND "  damage d on bond\n  rest stretch = 1e-4*d\n"
                          "  d = min(max(stretch*100, 0), 1)\n  force N = k*stretch\n" END);
}

/* --- time ------------------------------------------------------------------------------------- */

static void stiffness_by_the_step_is_told(void **state) {
  (void)state;
  is_said_once(BOND "  parameter tau = 2 [s] in (0, inf)\n"
                    "  energy W = s*k*stretch**2*(1 + dt/tau)\n" END,
               "step-dependent", "reads `dt`");
  is_said_once("model m\n  law continuum\n  parameter E = 25 [GPa] in (0, inf)\n"
               "  parameter nu = 0.2 in [0, 0.5)\n  parameter tau = 2 [s] in (0, inf)\n"
               "  parameter rho = 2323 [kg/m^3] in (0, inf)\n"
               "  stress sigma = hooke(strain, E, nu)*(1 + dt/tau)\n" END,
               "step-dependent", "reads `dt`");
}

/* Implicit Euler of a chain, its force written of the old state: that of the new one. */
static void a_step_may_be_written_out(void **state) {
  (void)state;
  nothing_is_said_of(BOND "  parameter tau = 2 [s] in (0, inf)\n  state v on bond = 0\n"
                          "  v = (previous(v) + dt/tau*stretch)/(1 + dt/tau)\n"
                          "  force N = k*stretch + k*(stretch - previous(v))/(1 + dt/tau)\n" END);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(states_may_act_by_the_rest_alone),
      cmocka_unit_test(stiffness_by_the_step_is_told),
      cmocka_unit_test(a_step_may_be_written_out),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
