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

static void is_not_said(const char *text, const char *code) {
  judged *j = judge(text);
  if (count_of(j, code)) diag_print(&j->said, stderr);
  assert_int_equal(count_of(j, code), 0);
  judged_free(j);
}

static void is_said_once(const char *text, const char *code, const char *words) {
  judged *j = judge(text);
  if (count_of(j, code) != 1 || !holds_words(j, code, words)) diag_print(&j->said, stderr);
  assert_int_equal(count_of(j, code), 1);
  assert_true(holds_words(j, code, words));
  judged_free(j);
}

#define BOND                                                                                       \
  "model m\n  law central bond\n  parameter k = 10 [MN] in (0, inf)\n"                             \
  "  parameter rho = 2323 [kg/m^3] in (0, inf)\n"
#define END "end model\n"

/* --- the rest state --------------------------------------------------------------------------- */

static void states_may_act_by_the_rest_alone(void **state) {
  (void)state;
  nothing_is_said_of(BOND "  state v on bond = 0\n  rest stretch = previous(v)\n"
                          "  v = max(previous(v), stretch)\n  force N = k*stretch\n" END);
  is_not_said(BOND "  damage d on bond\n  rest stretch = 1e-4*d\n"
                   "  d = min(max(stretch*100, 0), 1)\n  force N = k*stretch\n" END,
              "elastic");
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

static void stiffness_of_a_family_by_the_step_is_told(void **state) {
  (void)state;
  is_said_once("model m\n  law state\n  for plane_strain\n  parameter a = 3 [MN/m] in (0, inf)\n"
               "  parameter tau = 1 [s] in (0, inf)\n  parameter rho = 2300 [kg/m^3] in (0, inf)\n"
               "  force state F[j] = a*s*stretch[j]*(1 + dt/tau)\n" END,
               "step-dependent", "reads `dt`");
}

/* Implicit Euler of a chain, its force written of the old state: that of the new one. */
static void a_step_may_be_written_out(void **state) {
  (void)state;
  nothing_is_said_of(BOND "  parameter tau = 2 [s] in (0, inf)\n  state v on bond = 0\n"
                          "  v = (previous(v) + dt/tau*stretch)/(1 + dt/tau)\n"
                          "  force N = k*stretch + k*(stretch - previous(v))/(1 + dt/tau)\n" END);
}

/* What acts in motion alone, and a vector whose third component stays 0. */
static void states_may_act_by_rates(void **state) {
  (void)state;
  nothing_is_said_of(BOND "  parameter T_0 = 24 [h] in (0, inf)\n"
                          "  state age on bond = 0 [s]\n"
                          "  age = previous(age) + dt\n"
                          "  force N = k*(stretch + age/(T_0 + age)*1 [s]*stretch_rate)\n" END);
  nothing_is_said_of(BOND "  parameter tau = 2 [s] in (0, inf)\n"
                          "  state v on bond = vector 0\n"
                          "  rate v = (stretch*direction - v)/tau\n"
                          "  force N = k*stretch + k*(stretch - dot(v, direction))\n" END);
}

/* --- angles ----------------------------------------------------------------------------------- */

static void angles_with_their_unit_are_none_in_degrees(void **state) {
  (void)state;
  nothing_is_said_of(BOND
                     "  parameter phi = 30 [deg] in (0, 400 [deg])\n"
                     "  parameter m_0 = 7 in (0, 10)\n"
                     "  force N = k*(1 + 0.1*sin(phi)**2)*(1 + 0.1*sin(m_0*1.5)**2)*stretch\n" END);
  is_said_once(BOND "  parameter phi = 30 [deg] in (0, 90 [deg])\n"
                    "  force N = k*cos(phi*pi/180)*stretch\n" END,
               "degrees", "`phi` is in radians already");
}

/* sin(30) is negative, and so is the stiffness: the cause is said, too. */
static void the_text_is_read_beside_errors(void **state) {
  (void)state;
  static const char text[] = BOND "  force N = k*stretch*sin(30)\n" END;
  is_said_once(text, "stiffness", "negative");
  is_said_once(text, "degrees", "`30`");
}

/* Written out the angle has 2^40 terms. */
static void long_chains_of_names_are_given_up(void **state) {
  (void)state;
  char text[4096];
  size_t n = (size_t)snprintf(text, sizeof text, BOND "  constant c0 = 1\n");
  for (int k = 1; k <= 40; k++)
    n += (size_t)snprintf(text + n, sizeof text - n, "  constant c%d = (c%d + c%d)/2\n", k, k - 1,
                          k - 1);
  snprintf(text + n, sizeof text - n, "  force N = k*stretch*cos(c40)\n" END);
  nothing_is_said_of(text);
}

/* --- materials -------------------------------------------------------------------------------- */

static void a_cable_is_no_solid(void **state) {
  (void)state;
  nothing_is_said_of("model m\n  law central bond\n  parameter E = 200 [GPa] in (0, inf)\n"
                     "  parameter rho = 7850 [kg/m^3] in (0, inf)\n"
                     "  force N = E*area*max(stretch, 0)\n" END);
}

#define GEL(E, F)                                                                                  \
  "model m\n  law central bond\n  parameter E = " E " in (0, inf) \"Young's modulus\"\n"           \
  "  parameter f_t = " F " in (0, inf)\n  parameter S_u = 2 in (0, inf)\n"                         \
  "  parameter rho = 1000 [kg/m^3] in (0, inf)\n"                                                  \
  "  damage d = | 0 when stretch < f_t/E\n"                                                        \
  "             | 1 - (f_t/E)/stretch*(S_u - stretch)/(S_u - f_t/E) when stretch < S_u\n"          \
  "             | 1 otherwise\n"                                                                   \
  "  force N = (1 - d)*sqrt(3)/2*E*s*t*stretch\n" END

static void what_is_soft_may_be_strong(void **state) {
  (void)state;
  nothing_is_said_of(GEL("1 [MPa]", "0.2 [MPa]"));
  is_said_once(GEL("30 [GPa]", "6 [GPa]"), "absurd-value", "0.2 of `E`");
}

/* --- zeros ------------------------------------------------------------------------------------ */

/* Of a rate that is solved by Newton's method; only what is written can divide by zero. */
static void what_solves_a_rate_divides_by_no_zero(void **state) {
  (void)state;
  nothing_is_said_of(BOND "  parameter e_0 = 1e-5 [1/h] in (0, inf)\n"
                          "  parameter N_0 = 1 [kN] in (0, inf)\n"
                          "  parameter m_N = 4.5 in [1, 10]\n  state e_c on bond = 0\n"
                          "  pull = k*(stretch - e_c)\n"
                          "  rate e_c = e_0*(abs(pull)/N_0)**m_N*sign(pull)\n"
                          "  force N = k*(stretch - e_c)\n"
                          "  energy W = k*s/2*(stretch - e_c)**2\n" END);
}

static const char *note_of(const judged *j, const char *code) {
  for (int k = 0; k < j->said.count; k++)
    if (strcmp(diag_name(j->said.items[k].code), code) == 0) return j->said.items[k].note;
  return NULL;
}

/* Once, with the default that is the cause. */
static void a_time_of_zero_is_told(void **state) {
  (void)state;
  static const char text[] = BOND "  parameter tau = 0 [s] in [0, inf)\n  state v on bond = 0\n"
                                  "  rate v = (stretch - v)/tau\n"
                                  "  force N = k*stretch + k*(stretch - v)\n" END;
  is_said_once(text, "division-by-zero", "divides by zero");
  judged *j = judge(text);
  assert_non_null(strstr(note_of(j, "division-by-zero"), "tau = 0 s"));
  judged_free(j);
}

static void a_step_of_zero_is_told(void **state) {
  (void)state;
  judged *j = judge(BOND "  parameter tau = 1 [s] in (0, inf)\n  state v on bond = 0\n"
                         "  v = previous(v) + (stretch - previous(v))*dt/tau\n"
                         "  force N = k*(stretch - v) + k*tau/dt*v\n" END);
  assert_non_null(strstr(note_of(j, "division-by-zero"), "dt = 0 s"));
  judged_free(j);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(states_may_act_by_the_rest_alone),
      cmocka_unit_test(stiffness_by_the_step_is_told),
      cmocka_unit_test(stiffness_of_a_family_by_the_step_is_told),
      cmocka_unit_test(a_step_may_be_written_out),
      cmocka_unit_test(states_may_act_by_rates),
      cmocka_unit_test(angles_with_their_unit_are_none_in_degrees),
      cmocka_unit_test(the_text_is_read_beside_errors),
      cmocka_unit_test(long_chains_of_names_are_given_up),
      cmocka_unit_test(a_cable_is_no_solid),
      cmocka_unit_test(what_is_soft_may_be_strong),
      cmocka_unit_test(what_solves_a_rate_divides_by_no_zero),
      cmocka_unit_test(a_time_of_zero_is_told),
      cmocka_unit_test(a_step_of_zero_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
