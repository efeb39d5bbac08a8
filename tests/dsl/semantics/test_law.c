/* Checked laws: names, units, shapes, placement and order as mechanics has them, and hostile texts
 * that must end. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/semantics/law_check.h"
#include "dsl/semantics/law_limits.h"
#include "dsl/semantics/law_variant.h"
#include "dsl/syntax/parse.h"

/* One text and what became of it. */
typedef struct checked {
  source_set *sources;
  diagnostics d;
  arena *memory;
  law *law;
} checked;

static char *no_include(void *context, const char *name, const char *from, char **found) {
  (void)from;
  if (!context) return NULL;
  *found = strdup(name);
  return strdup(context);
}

static checked check_with(const char *text, const char *library, const law_choice *choices,
                          int count) {
  checked c = {.memory = arena_new()};
  c.sources = arena_alloc(c.memory, sizeof(source_set));
  int file = source_add(c.sources, "law.plm", text, strlen(text));
  diag_begin(&c.d, c.sources);
  parse_options options = {no_include, (void *)(uintptr_t)library};
  tree *t = parse_model(c.memory, c.sources, file, &options, &c.d);
  if (t && c.d.errors == 0) c.law = law_check(c.memory, t, c.sources, choices, count, &c.d);
  return c;
}

static void release(checked *c) {
  diag_clear(&c->d);
  source_clear(c->sources);
  arena_free(c->memory);
}

static checked check(const char *text) {
  checked c = check_with(text, NULL, NULL, 0);
  if (c.law) return c;
  diag_print(&c.d, stderr);
  fail_msg("the law is not accepted");
  return c;
}

static const symbol *symbol_named(const law *l, const char *name) {
  for (int i = 0; i < l->parameters.count; i++)
    if (strcmp(l->parameters.items[i]->name, name) == 0) return l->parameters.items[i];
  for (int i = 0; i < l->fields.count; i++)
    if (strcmp(l->fields.items[i]->name, name) == 0) return l->fields.items[i];
  for (int i = 0; i < l->rule_count; i++)
    if (l->rules[i]->symbol && strcmp(l->rules[i]->symbol->name, name) == 0)
      return l->rules[i]->symbol;
  fail_msg("there is no `%s`", name);
  return NULL;
}

static dimension dimension_named(const char *text) {
  unit u = {DIMENSIONLESS, 0};
  const char *bad;
  size_t length;
  assert_true(unit_parse(text, strlen(text), &u, &bad, &length));
  return u.dim;
}

static void is_of(const law *l, const char *name, symbol_kind kind, const char *unit_text, shape s,
                  placement p) {
  const symbol *found = symbol_named(l, name);
  char text[100];
  dim_unit(found->dim, text, sizeof(text));
  if (!dim_equal(found->dim, dimension_named(unit_text))) fail_msg("`%s` is in %s", name, text);
  if (found->kind != kind || found->shape != s || found->place != p)
    fail_msg("`%s`: kind %d, shape %d, place %d", name, found->kind, found->shape, found->place);
}

#define CENTRAL(body) "model m\nlaw central bond\nparameter EA = 2 [MN]\n" body "\nend model\n"
#define MICROPOLAR(body)                                                                           \
  "model m\nlaw micropolar bond\nparameter EA = 2 [MN]\nparameter EI = 3 [N*m^2]\n" body           \
  "\nend model\n"
#define STATE(body) "model m\nlaw state\nparameter a = 2 [MN]\n" body "\nend model\n"

/* --- what a good law becomes ------------------------------------------------------------------ */

static void micropolar_law_is_understood(void **state) {
  (void)state;
  char path[] = SOURCE_DIR "/models/mplm_bilinear.plm";
  FILE *f = fopen(path, "rb");
  assert_non_null(f);
  static char text[65536];
  size_t length = fread(text, 1, sizeof(text) - 1, f);
  fclose(f);
  text[length] = '\0';
  checked c = check(text);
  const law *l = c.law;
  assert_int_equal(c.d.count, 0);
  assert_int_equal(l->fields.count, 1);
  assert_non_null(l->rho);
  assert_true(l->rho->initial == 2323);
  is_of(l, "E", SYMBOL_PARAMETER, "Pa", SHAPE_SCALAR, ON_BODY);
  is_of(l, "EA", SYMBOL_CONSTANT, "N", SHAPE_SCALAR, ON_BODY);
  is_of(l, "EI", SYMBOL_CONSTANT, "N*m^2", SHAPE_SCALAR, ON_BOND);
  is_of(l, "psi", SYMBOL_DEFINED, "1/m", SHAPE_SCALAR, ON_BOND);
  is_of(l, "omega", SYMBOL_DAMAGE, "1", SHAPE_SCALAR, ON_BOND);
  is_of(l, "N", SYMBOL_RESULT, "N", SHAPE_SCALAR, ON_BOND);
  is_of(l, "M_i", SYMBOL_RESULT, "N*m", SHAPE_BENDING, ON_BOND);
  assert_true(symbol_named(l, "E")->initial == 30e9);
  assert_ptr_equal(l->results[RESULT_N], symbol_named(l, "N"));
  assert_ptr_equal(l->results[RESULT_M_J], symbol_named(l, "M_j"));
  assert_null(l->results[RESULT_V]);
  assert_null(l->results[RESULT_W]);
  assert_false(symbol_named(l, "omega")->old_is_read);
  release(&c);
}

/* X(expression, unit, shape): what becomes of units and shapes in a micropolar law. */
#define EXPRESSIONS(X)                                                                             \
  X("EA*stretch**2", "N", SCALAR)                                                                  \
  X("EA/s**2 + 3 [MPa]", "Pa", SCALAR)                                                             \
  X("sqrt(EA/area)", "Pa^0.5", SCALAR)                                                             \
  X("cbrt(V)", "m", SCALAR)                                                                        \
  X("V**(1/3)", "m", SCALAR)                                                                       \
  X("s**-2", "1/m^2", SCALAR)                                                                      \
  X("s**0.5*s**1.5", "m^2", SCALAR)                                                                \
  X("(s**2)**(3/4)", "m^1.5", SCALAR)                                                              \
  X("stretch**rate_free", "1", SCALAR)                                                             \
  X("2**stretch", "1", SCALAR)                                                                     \
  X("m*stretch_rate**2", "kg/s^2", SCALAR)                                                         \
  X("theta_i - 2*theta_j", "1", BENDING) X("EI*theta_i/s", "N*m", BENDING)                         \
      X("norm(EI*theta_i/s**2)", "N", SCALAR) X("theta_i : theta_j", "1", SCALAR)                  \
          X("EI*(theta_i : theta_i)/s", "J", SCALAR) X("sign(EA)", "1", SCALAR)                    \
              X("positive_part(EA - 1 [kN])", "N", SCALAR) X("max(0, EA, 1 [kN])", "N", SCALAR)    \
                  X("min(0, stretch)", "1", SCALAR) X("atan2(s, spacing)", "1",                    \
                                                      SCALAR) X("exp(-stretch)*EA", "N", SCALAR)   \
                      X("abs(EA)", "N", SCALAR) X("soft_sign(stretch)", "1", SCALAR) X(            \
                          "twist*EA", "N", SCALAR) X("diff(EA*stretch**2, stretch)", "N", SCALAR)  \
                          X("diff(EA*stretch, stretch_rate)", "N*s",                               \
                            SCALAR) X("diff(EI*theta_i/s, theta_i)", "N*m",                        \
                                      SCALAR) X("diff(EI*theta_i/s, s)", "N", BENDING)             \
                              X("diff(EI*(theta_i : theta_i)/s, theta_i)", "J",                    \
                                BENDING) X("diff(EA*stretch, EA)", "1", SCALAR)                    \
                                  X("direction*EA", "N", VECTOR) X("norm(direction)", "1", SCALAR) \
                                      X("30 [deg]", "1", SCALAR)                                   \
                                          X("(| 0 when stretch > 0 | EA otherwise)", "N", SCALAR)  \
                                              X("(| theta_i when stretch > 0 | 0 otherwise)", "1", \
                                                BENDING) X("0*s", "m", SCALAR)                     \
                                                  X("-(+EA) - 0", "N", SCALAR) X("0", "1", SCALAR) \
                                                      X("f(s, theta_i)", "m", BENDING)             \
                                                          X("f(stretch, EA)", "N", SCALAR)         \
                                                              X("f(f(s, s), s)", "m^3", SCALAR)

static void expressions_have_their_unit_and_shape(void **state) {
  (void)state;
  static const struct {
    const char *text, *unit;
    shape shape;
  } cases[] = {
#define X(text, unit, shape) {text, unit, SHAPE_##shape},
      EXPRESSIONS(X)
#undef X
  };
  for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
    char text[1000];
    snprintf(
        text, sizeof(text),
        MICROPOLAR("parameter rate_free = 2\nfunction f(p, q) = p*q\nx = %s\nforce N = EA*stretch\n"
                   "force V = EI*(theta_i + theta_j)/s**2\noutput y = f(1, 1)"),
        cases[i].text);
    checked c = check_with(text, NULL, NULL, 0);
    if (!c.law) {
      diag_print(&c.d, stderr);
      fail_msg("`%s` is not accepted", cases[i].text);
    }
    const symbol *x = symbol_named(c.law, "x");
    if (!dim_equal(x->dim, dimension_named(cases[i].unit)) || x->shape != cases[i].shape)
      fail_msg("`%s` has another unit or shape", cases[i].text);
    release(&c);
  }
}

static void constants_come_first(void **state) {
  (void)state;
  checked c = check(CENTRAL("x = 2*stretch\nconstant k = 3*EA\ny = x*k\nforce N = y\n"
                            "constant q = k/s\noutput z = q"));
  static const char *const order[] = {"k", "q", "x", "y", "N", "z"};
  assert_int_equal(c.law->rule_count, 6);
  for (int i = 0; i < 6; i++)
    assert_string_equal(c.law->rules[i]->name, order[i]);
  is_of(c.law, "k", SYMBOL_CONSTANT, "N", SHAPE_SCALAR, ON_BODY);
  is_of(c.law, "q", SYMBOL_CONSTANT, "N/m", SHAPE_SCALAR, ON_BOND);
  release(&c);
}

static const expr *rule_of(const law *l, const char *name) {
  for (int i = 0; i < l->rule_count; i++)
    if (strcmp(l->rules[i]->name, name) == 0) return l->rules[i]->value;
  fail_msg("no rule `%s`", name);
  return NULL;
}

static void fields_are_old_above_their_rule_and_new_below(void **state) {
  (void)state;
  checked c =
      check(CENTRAL("state top = 0\nstate low = 0\nbefore = 1*top\ntop = max(top, stretch)\n"
                    "after = 1*top\nolder = 1*previous(top)\nlow = min(previous(low), stretch)\n"
                    "force N = EA*(before + after + older + low)"));
  assert_true(rule_of(c.law, "before")->right->reads_old);
  assert_true(rule_of(c.law, "top")->arguments[0].value->reads_old);
  assert_false(rule_of(c.law, "after")->right->reads_old);
  assert_true(rule_of(c.law, "older")->right->arguments[0].value->reads_old);
  assert_false(rule_of(c.law, "N")->right->right->reads_old);
  assert_true(symbol_named(c.law, "top")->old_is_read);
  release(&c);

  c = check(CENTRAL("force N = (1 - omega)*EA*stretch\ndamage omega = min(1, abs(stretch))"));
  assert_true(symbol_named(c.law, "omega")->old_is_read);
  release(&c);
}

static void states_take_unit_and_shape_from_their_rule(void **state) {
  (void)state;
  checked c = check(MICROPOLAR(
      "state slip on bond = 0\nstate bend on bond = 0\nstate first on bond = 0\nstate open = 1 "
      "[mm]\n"
      "state later = 0\nforce N = EA*(stretch - slip/s) + 0*EA*later*open/s\n"
      "first = max(first, slip)\nslip = max(slip, length - s)\nbend = bend + theta_i/2\nlater = "
      "first/slip\n"
      "open = max(open, s)\n"
      "moment M_i = EI/s*(theta_i - bend)\nmoment M_j = EI/s*theta_j\noutput f = first"));
  is_of(c.law, "slip", SYMBOL_STATE, "m", SHAPE_SCALAR, ON_BOND);
  is_of(c.law, "first", SYMBOL_STATE, "m", SHAPE_SCALAR, ON_BOND);
  is_of(c.law, "bend", SYMBOL_STATE, "1", SHAPE_BENDING, ON_BOND);
  is_of(c.law, "later", SYMBOL_STATE, "1", SHAPE_SCALAR, ON_BOND);
  assert_true(fabs(symbol_named(c.law, "open")->initial / 1e-3 - 1) < 1e-15);
  for (int i = 0; i < c.law->fields.count; i++)
    assert_int_equal(c.law->fields.items[i]->index, i);
  release(&c);
}

static void an_energy_is_enough(void **state) {
  (void)state;
  checked c = check(
      MICROPOLAR("energy W = EA*s*stretch**2/2 + 2*EI/s*(theta_i : theta_i + theta_j : theta_j "
                 "+ theta_i : theta_j)"));
  assert_non_null(c.law->results[RESULT_W]);
  assert_null(c.law->results[RESULT_N]);
  is_of(c.law, "W", SYMBOL_RESULT, "J", SHAPE_SCALAR, ON_BOND);
  release(&c);
}

static void shear_force_stands_beside_the_volume(void **state) {
  (void)state;
  checked c = check(
      MICROPOLAR("force V = 6*EI/s**2*(theta_i + theta_j)\nforce N = EA*stretch*V/(s*t*spacing)"));
  const symbol *shear = c.law->results[RESULT_V];
  assert_non_null(shear);
  assert_int_equal(shear->shape, SHAPE_BENDING);
  assert_true(dim_equal(shear->dim, dimension_named("N")));
  release(&c);
}

static void options_are_chosen(void **state) {
  (void)state;
  const char *text = CENTRAL("option onset = rankine | mohr\noption sign_of = plus | minus\n"
                             "force N = | EA*stretch when onset == rankine and not plane_strain\n"
                             "| 2*EA*stretch when minus_sign\n| 0 otherwise");
  char fixed[1000];
  const char *at = strstr(text, "minus_sign");
  snprintf(fixed, sizeof(fixed), "%.*ssign_of /= plus%s", (int)(at - text), text, at + 10);
  checked c = check(fixed);
  assert_string_equal(c.law->chosen[0], "rankine");
  assert_string_equal(c.law->chosen[1], "plus");
  release(&c);

  law_choice mohr = {"onset", "mohr"};
  c = check_with(fixed, NULL, &mohr, 1);
  assert_string_equal(c.law->chosen[0], "mohr");
  assert_string_equal(c.law->chosen[1], "plus");
  release(&c);

  law_choice wrong[] = {{"onset", "mor"}, {"onsat", "mohr"}};
  c = check_with(fixed, NULL, wrong, 2);
  assert_null(c.law);
  assert_int_equal(c.d.errors, 2);
  assert_string_equal(c.d.items[0].message, "option `onset` has no choice `mor`");
  assert_string_equal(c.d.items[0].hint, "did you mean `mohr`?");
  assert_string_equal(c.d.items[1].message, "this law has no option `onsat`");
  release(&c);
}

/* Which bound counts, options and the lattice decide. */
static void bounds_may_differ(void **state) {
  (void)state;
  const law_choice full = {"onset", "full"};
  checked c = check(CENTRAL("option onset = half | full\n"
                            "parameter nu = 0.2 in [0, (| 1/4 when plane_strain | 1/3 otherwise)]\n"
                            "parameter b = 0.1 in [0, (| nu when onset == half and not irregular "
                            "| 2*nu otherwise)]\nforce N = EA*stretch*(nu + b)"));
  const double v[] = {2e6, 0.3, 0.4};
  char text[80] = "";
  const law *strain = law_on_lattice(c.law, SETTING_PLANE_STRAIN, false, 6);
  assert_true(law_parameter_within(c.law, 1, v, text, sizeof text));
  assert_false(law_parameter_within(strain, 1, v, text, sizeof text));
  assert_string_equal(text, "[0, 0.25]");
  assert_false(law_parameter_within(strain, 2, v, text, sizeof text));
  assert_string_equal(text, "[0, 0.3]");
  assert_true(law_parameter_within(law_with_options(c.law, &full, 1), 2, v, text, sizeof text));
  assert_true(law_parameter_within(law_on_lattice(c.law, SETTING_PLANE_STRESS, true, 0), 2, v, text,
                                   sizeof text));
  release(&c);
}

static void bounds_are_kept(void **state) {
  (void)state;
  checked c = check(CENTRAL("parameter nu = 0.2 in [0, 1/3]\nparameter a2 = 20 in (1, inf)\n"
                            "parameter a3 in (2*a2, inf)\nparameter G [N/m] in [-1 [kN/m], 0)\n"
                            "force N = EA*stretch*(nu + a2 + a3) + G*s"));
  const law *l = c.law;
  double v[] = {2e6, 1.0 / 3, 20, 41, -1000};
  char text[80] = "";
  for (int i = 0; i < 5; i++)
    assert_true(law_parameter_within(l, i, v, text, sizeof(text)));
  v[1] = 0.34;
  assert_false(law_parameter_within(l, 1, v, text, sizeof(text)));
  assert_string_equal(text, "[0, 0.333333]");
  v[3] = 40;
  assert_false(law_parameter_within(l, 3, v, text, sizeof(text)));
  assert_string_equal(text, "(40, inf)");
  v[4] = 0;
  assert_false(law_parameter_within(l, 4, v, text, sizeof(text)));
  assert_string_equal(text, "[-1000, 0)");
  v[0] = NAN;
  assert_false(law_parameter_within(l, 0, v, text, sizeof(text)));
  v[1] = NAN;
  assert_false(law_parameter_within(l, 1, v, text, sizeof(text)));
  v[2] = INFINITY;
  assert_false(law_parameter_within(l, 2, v, text, sizeof(text)));
  assert_false(l->parameters.items[3]->has_default);
  is_of(l, "G", SYMBOL_PARAMETER, "N/m", SHAPE_SCALAR, ON_BODY);
  release(&c);
}

static void defaults_are_computed(void **state) {
  (void)state;
  checked c = check(CENTRAL(
      "parameter p = -2*(3 [mm] + 1 [cm])/4\nparameter q = max(1, sqrt(2), 2**-1)\n"
      "parameter r = 1.18d-4\nparameter phi = 30 [deg]\nparameter turn = pi/4 in [0, 2*pi)\n"
      "constant c = turn + pi\nforce N = EA*stretch*(p/s + q + r + phi + c)"));
  assert_true(symbol_named(c.law, "turn")->initial == acos(-1.0) / 4);
  assert_true(fabs(symbol_named(c.law, "p")->initial + 6.5e-3) < 1e-17);
  assert_true(symbol_named(c.law, "q")->initial == sqrt(2));
  assert_true(symbol_named(c.law, "r")->initial == 1.18e-4);
  assert_true(fabs(symbol_named(c.law, "phi")->initial - acos(-1.0) / 6) < 1e-16);
  is_of(c.law, "p", SYMBOL_PARAMETER, "m", SHAPE_SCALAR, ON_BODY);
  release(&c);
}

/* Every function that has a value of numbers, against values of sixteen digits. */
static void defaults_may_call_functions(void **state) {
  (void)state;
  static const struct {
    const char *text;
    double value;
  } calls[] = {{"abs(-1.5)", 1.5},
               {"sqrt(1.5)", 1.224744871391589},
               {"cbrt(-3.375)", -1.5},
               {"exp(0.5)", 1.6487212707001282},
               {"log(2)", 0.6931471805599453},
               {"sin(0.5)", 0.479425538604203},
               {"cos(0.5)", 0.8775825618903728},
               {"tan(0.5)", 0.5463024898437905},
               {"tanh(0.5)", 0.46211715726000973},
               {"log10(0.5)", -0.3010299956639812},
               {"asin(0.5)", 0.5235987755982989},
               {"acos(0.5)", 1.0471975511965979},
               {"sinh(0.5)", 0.5210953054937474},
               {"cosh(0.5)", 1.1276259652063807},
               {"sign(-0.5)", -1},
               {"soft_sign(-3)", -0.75},
               {"positive_part(-3)", 0},
               {"min(3, -1, 2)", -1},
               {"max(-3, 2, 1)", 2}};
  int plain = 0;
  for (int f = 0; f < FUNCTION_COUNT; f++)
    plain += builtin_functions[f].of_one != NULL || builtin_functions[f].of_many != NULL;
  assert_int_equal(plain, sizeof(calls) / sizeof(calls[0]));
  for (size_t i = 0; i < sizeof(calls) / sizeof(calls[0]); i++) {
    char text[200];
    snprintf(text, sizeof(text), CENTRAL("parameter p = %s\nforce N = p*EA*stretch"),
             calls[i].text);
    checked c = check_with(text, NULL, NULL, 0);
    assert_non_null(c.law);
    const double found = symbol_named(c.law, "p")->initial;
    if (fabs(found - calls[i].value) > 2e-16 * fabs(calls[i].value))
      fail_msg("%s is %.17g", calls[i].text, found);
    release(&c);
  }
  /* no number is lost on the way: sign(NaN) is no number either, as in compiled laws */
  checked c =
      check_with(CENTRAL("parameter p = sign(log(-1))\nforce N = p*EA*stretch"), NULL, NULL, 0);
  assert_null(c.law);
  assert_int_equal(c.d.items[0].code, DIAG_BAD_NUMBER);
  release(&c);
}

static void state_law_is_understood(void **state) {
  (void)state;
  checked c = check(STATE(
      "damage w on particle\nstate S_p on neighbour = 0\nconstant k = a*s/spacing\n"
      "constant c[j] = k*V/V[j]\nconstant b[j] = a/spacing\n"
      "S_e[j] = stretch[j] - (S_p[j] + S_p'[j])/2\nd[j] = (1 - w)*(1 - w[j])\nuniform[j] = n\n"
      "force state F[j] = d[j]*c[j]*S_e[j] + a/n*sum(d[j]*S_e[j])\nstress sigma = virtual_work(F)\n"
      "strain eps = fit(stretch)\nyield f = J2(sigma)/(30 [MPa])**2 - 1\n"
      "flow S_p[j] by 0.1*deviator(F[j])/norm(deviator(F)) when f >= 0\n"
      "worst = max(stretch[j])\nw = min(1, abs(principal(eps, 1)) + trace(eps)*worst)\n"
      "output slope = mean(b[j])\noutput mises = von_mises(sigma)\noutput work = sigma : "
      "eps\noutput same = eps : sigma\n"
      "drawn[j] = | 1 when stretch[j] > 0 | 0 otherwise\ncracked = | 1 when w > 0 | 0 otherwise\n"
      "output part = cracked*mean(drawn[j])\noutput even = mean(uniform[j], "
      "weight = d[j])"));
  const law *l = c.law;
  is_of(l, "k", SYMBOL_CONSTANT, "N", SHAPE_SCALAR, ON_BOND);
  is_of(l, "c", SYMBOL_CONSTANT, "N", SHAPE_SCALAR, ON_NEIGHBOUR);
  is_of(l, "b", SYMBOL_CONSTANT, "N/m", SHAPE_SCALAR, ON_BOND);
  is_of(l, "S_p", SYMBOL_STATE, "1", SHAPE_SCALAR, ON_NEIGHBOUR);
  is_of(l, "S_e", SYMBOL_DEFINED, "1", SHAPE_SCALAR, ON_NEIGHBOUR);
  is_of(l, "d", SYMBOL_DEFINED, "1", SHAPE_SCALAR, ON_NEIGHBOUR);
  is_of(l, "uniform", SYMBOL_DEFINED, "1", SHAPE_SCALAR, ON_NEIGHBOUR);
  is_of(l, "F", SYMBOL_RESULT, "N", SHAPE_SCALAR, ON_NEIGHBOUR);
  is_of(l, "sigma", SYMBOL_DEFINED, "Pa", SHAPE_TENSOR, ON_PARTICLE);
  is_of(l, "eps", SYMBOL_DEFINED, "1", SHAPE_TENSOR, ON_PARTICLE);
  is_of(l, "worst", SYMBOL_DEFINED, "1", SHAPE_SCALAR, ON_PARTICLE);
  is_of(l, "mises", SYMBOL_OUTPUT, "Pa", SHAPE_SCALAR, ON_PARTICLE);
  is_of(l, "work", SYMBOL_OUTPUT, "Pa", SHAPE_SCALAR, ON_PARTICLE);
  is_of(l, "same", SYMBOL_OUTPUT, "Pa", SHAPE_SCALAR, ON_PARTICLE);
  is_of(l, "drawn", SYMBOL_DEFINED, "1", SHAPE_SCALAR, ON_BOND); /* where its guard is */
  is_of(l, "cracked", SYMBOL_DEFINED, "1", SHAPE_SCALAR, ON_PARTICLE);
  assert_true(symbol_named(l, "w")->old_is_read);
  release(&c);
}

static void libraries_may_hold_more_than_is_used(void **state) {
  (void)state;
  checked c =
      check_with(CENTRAL("include \"lib.plm\"\nforce N = two(EA)*stretch"),
                 "function two(p) = 2*p\nfunction three(p) = 3*p\nconstant c = 3 [m]\n", NULL, 0);
  assert_non_null(c.law);
  assert_int_equal(c.d.count, 0);
  release(&c);
}

static void what_is_used_is_marked(void **state) {
  (void)state;
  checked c =
      check(CENTRAL("parameter idle = 3\nparameter busy = 4\nx = busy*stretch\nforce N = EA*x"));
  assert_false(symbol_named(c.law, "idle")->used);
  assert_true(symbol_named(c.law, "busy")->used);
  assert_true(symbol_named(c.law, "x")->used);
  assert_int_equal(c.d.count, 1);
  assert_int_equal(c.d.items[0].code, DIAG_UNUSED);
  release(&c);
}

static void every_builtin_has_a_unit(void **state) {
  (void)state;
  for (int i = 0; i < QUANTITY_COUNT; i++) {
    dimension_named(builtin_quantities[i].unit);
    assert_int_equal(builtin_quantity_find(builtin_quantities[i].name), i);
  }
  for (int i = 0; i < FUNCTION_COUNT; i++)
    assert_int_equal(builtin_function_find(builtin_functions[i].name), i);
  assert_int_equal(builtin_quantity_find("alpha2"), -1);
  assert_int_equal(builtin_function_find("stretch"), -1);
}

/* --- texts that want to hang or crash it ------------------------------------------------------ */

typedef struct page {
  char *text;
  size_t length;
  FILE *out;
} page;

static void page_begin(page *p, const char *kind) {
  p->out = open_memstream(&p->text, &p->length);
  fprintf(p->out, "model m\nlaw %s bond\nparameter EA = 2 [MN]\n", kind);
}

static checked page_check(page *p) {
  fprintf(p->out, "\nend model\n");
  fclose(p->out);
  checked c = check_with(p->text, NULL, NULL, 0);
  free(p->text);
  return c;
}

static bool has_code(const checked *c, diag_code code) {
  for (int i = 0; i < c->d.count; i++)
    if (c->d.items[i].code == code) return true;
  return false;
}

static void long_chains_are_followed(void **state) {
  (void)state;
  page p;
  page_begin(&p, "central");
  fprintf(p.out, "x0 = stretch\n");
  for (int i = 1; i < 20000; i++)
    fprintf(p.out, "x%d = x%d\n", i, i - 1);
  fprintf(p.out, "force N = EA*x19999\n");
  checked c = page_check(&p);
  assert_non_null(c.law);
  assert_int_equal(c.d.count, 0);
  release(&c);

  page_begin(&p, "central");
  for (int i = 0; i < 20000; i++)
    fprintf(p.out, "x%d = x%d\n", i, (i + 1) % 20000);
  fprintf(p.out, "force N = EA*x0\n");
  c = page_check(&p);
  assert_null(c.law);
  assert_int_equal(c.d.items[0].code, DIAG_CYCLE);
  assert_int_equal(c.d.errors, 1);
  release(&c);
}

/* Each state takes its unit from the next one: the order that is worst for the checker. */
static checked chain_of_states(int count) {
  page p;
  page_begin(&p, "central");
  for (int i = 0; i < count; i++)
    fprintf(p.out, "state y%d = 0\n", i);
  fprintf(p.out, "force N = EA*stretch + EA*y0/s\n");
  for (int i = 0; i + 1 < count; i++)
    fprintf(p.out, "y%d = 2*y%d\n", i, i + 1);
  fprintf(p.out, "y%d = s\n", count - 1);
  return page_check(&p);
}

static void many_states_are_inferred(void **state) {
  (void)state;
  checked c = chain_of_states(200);
  assert_non_null(c.law);
  is_of(c.law, "y0", SYMBOL_STATE, "m", SHAPE_SCALAR, ON_BOND);
  is_of(c.law, "y199", SYMBOL_STATE, "m", SHAPE_SCALAR, ON_BOND);
  release(&c);

  c = chain_of_states(3000); /* too long to be inferred: it ends, and says which unit it took */
  assert_null(c.law);
  assert_true(has_code(&c, DIAG_UNITS));
  release(&c);
}

static void doubling_functions_are_stopped(void **state) {
  (void)state;
  page p;
  page_begin(&p, "central");
  fprintf(p.out, "function f0(p) = 2*p\n");
  for (int i = 1; i < 60; i++)
    fprintf(p.out, "function f%d(p) = f%d(p) + f%d(p)\n", i, i - 1, i - 1);
  fprintf(p.out, "force N = f59(EA*stretch)\n");
  checked c = page_check(&p);
  assert_null(c.law);
  assert_int_equal(c.d.errors, 1);
  assert_int_equal(c.d.items[0].code, DIAG_TOO_LONG);
  release(&c);
}

static void deep_calls_are_stopped(void **state) {
  (void)state;
  page p;
  page_begin(&p, "central");
  fprintf(p.out, "function f0(p) = 2*p\n");
  for (int i = 1; i < 5000; i++)
    fprintf(p.out, "function f%d(p) = ((((f%d(p)))))\n", i, i - 1);
  fprintf(p.out, "force N = f4999(EA*stretch)\n");
  checked c = page_check(&p);
  assert_null(c.law);
  assert_int_equal(c.d.errors, 1);
  assert_int_equal(c.d.items[0].code, DIAG_TOO_LONG);
  release(&c);
}

/* EA*(stretch + stretch + ...), with that operator and so many operands. */
static checked chain_of_operands(const char *operator, int count) {
  page p;
  page_begin(&p, "central");
  fprintf(p.out, "force N = EA*(stretch");
  for (int i = 1; i < count; i++)
    fprintf(p.out, "%sstretch", operator);
  fprintf(p.out, ")\n");
  return page_check(&p);
}

/* n operands in a row are a tree of n levels, and the product with EA is one more. */
static void long_sums_end(void **state) {
  (void)state;
  static const char *const operators[] = {"+", "*", "-", "**"};
  for (int k = 0; k < 4; k++) {
    checked c = chain_of_operands(operators[k], TREE_DEEPEST - 1);
    assert_non_null(c.law);
    is_of(c.law, "N", SYMBOL_RESULT, "N", SHAPE_SCALAR, ON_BOND);
    assert_int_equal(rule_of(c.law, "N")->depth, TREE_DEEPEST);
    release(&c);
    for (int count = TREE_DEEPEST; count <= 20000; count += 20000 - TREE_DEEPEST) {
      c = chain_of_operands(operators[k], count);
      assert_null(c.law);
      assert_int_equal(c.d.errors, 1);
      assert_int_equal(c.d.items[0].code, DIAG_TOO_DEEP);
      release(&c);
    }
  }
}

static void long_options_end(void **state) {
  (void)state;
  page p;
  page_begin(&p, "central");
  fprintf(p.out, "option o = w0");
  for (int i = 1; i < 60000; i++)
    fprintf(p.out, "|w%d", i);
  fprintf(p.out, "\nforce N = | 0 when o == w0");
  for (int i = 1; i < 20000; i++)
    fprintf(p.out, "\n| 0 when o == w%d", i);
  fprintf(p.out, "\n| EA*stretch otherwise\n");
  checked c = page_check(&p);
  assert_non_null(c.law);
  assert_int_equal(c.law->options.items[0]->declared->word_count, 60000);
  release(&c);
}

static void many_errors_end(void **state) {
  (void)state;
  page p;
  page_begin(&p, "central");
  for (int i = 0; i < 10000; i++)
    fprintf(p.out, "a%d = b%d\n", i, i);
  for (int i = 0; i < 10000; i++)
    fprintf(p.out, "c%d = d%d\nd%d = 2\n", i, i, i);
  fprintf(p.out, "force N = EA*stretch\n");
  checked c = page_check(&p);
  assert_null(c.law);
  assert_int_equal(
      c.d.errors,
      20000); /* one a line: b of a = b, and d of c = d, which is used above its definition */
  for (int i = 0; i < c.d.count; i++)
    assert_int_equal(c.d.items[i].code, i < 10000 ? DIAG_UNKNOWN_NAME : DIAG_UNDEFINED);
  release(&c);
}

static void assert_messages_are_placed(const checked *c, size_t length) {
  for (int i = 0; i < c->d.count; i++) {
    const diagnostic *said = &c->d.items[i];
    assert_true(said->message[0] && said->where.begin <= said->where.end);
    assert_true(said->where.end <= length && said->note_where.end <= length);
  }
}

/* Words and signs of the language in any order: each program is refused, in words and in places of
   its own text. Programs that are accepted: test_homogeneous.c. */
static void any_program_is_survived(void **state) {
  (void)state;
  static const char *const words[] = {
      "stretch",    "EA",          "s",        "theta_i", "omega",
      "top",        "x",           "onset",    "rankine", "plane_stress",
      "0",          "1",           "2 [m]",    "3 [q]",   "+",
      "-",          "*",           "/",        "**",      ":",
      "<",          "==",          "and",      "or",      "not ",
      "(",          ")",           ",",        "max(",    "norm(",
      "diff(",      "previous(",   "sum(",     "f(",      "fit(",
      "mean(",      "principal(",  "[j]",      "'[j]",    "y",
      "(| 0 when ", " otherwise)", "\n| ",     " when ",  "n",
      "S_p",        "F",           "deviator("};
  enum { WORDS = sizeof(words) / sizeof(words[0]) };
  static const char *const laws[] = {"central bond", "micropolar bond", "state"};
  uint32_t random = 2014;
  int parsed = 0;
  for (int n = 0; n < 15000; n++) {
    page p = {0};
    p.out = open_memstream(&p.text, &p.length);
    fprintf(p.out,
            "model m\nlaw %s\nparameter EA = 2 [MN]\noption onset = rankine | mohr\nstate top = 0\n"
            "state S_p on neighbour = 0\nfunction f(p) = p*stretch\ndamage omega on bond\n",
            laws[n % 3]);
    static const char *const starts[] = {
        "x = ",         "y[j] = ",     "force N = ",          "top = ",
        "omega = ",     "S_p[j] = ",   "force state F[j] = ", "constant c = ",
        "energy W = ",  "output o = ", "parameter q = ",      "function g(y) = ",
        "moment M_i = "};
    for (int k = 0; k < 4; k++) {
      random = random * 1664525u + 1013904223u;
      fprintf(p.out, "%s", starts[(random >> 12) % (sizeof(starts) / sizeof(starts[0]))]);
      int length = 1 + (int)((random >> 24) % 4) * 2;
      for (int i = 0; i < length; i++) {
        random = random * 1664525u + 1013904223u;
        fprintf(p.out, "%s",
                words[i % 2 == 0 ? (random >> 10) % 14 : 14 + (random >> 10) % (WORDS - 14)]);
      }
      fprintf(p.out, "\n");
    }
    fprintf(p.out, "end model\n");
    fclose(p.out);
    checked c = {.memory = arena_new()};
    c.sources = arena_alloc(c.memory, sizeof(source_set));
    int file = source_add(c.sources, "law.plm", p.text, p.length);
    diag_begin(&c.d, c.sources);
    parse_options options = {0};
    tree *t = parse_model(c.memory, c.sources, file, &options, &c.d);
    if (t && c.d.errors == 0) parsed++;
    if (t) c.law = law_check(c.memory, t, c.sources, NULL, 0, &c.d); /* broken trees too */
    assert_null(c.law); /* no states without rules, and four lines are too few to give them all */
    assert_true(c.d.errors > 0);
    assert_messages_are_placed(&c, p.length);
    release(&c);
    free(p.text);
  }
  assert_true(parsed > 200);
}

/* Words that came to begin lines later are names all the same where nothing else fits. */
static void late_words_may_be_names(void **state) {
  (void)state;
  checked c =
      check(CENTRAL("rest stretch = 1e-4*EA/EA\nrest = 2*stretch\nrate = rest\nfield = rate\n"
                    "accept = field\nstate q = 0\nrate q = accept/(1 [s])\n"
                    "force N = EA*(stretch + q)"));
  release(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(late_words_may_be_names),
      cmocka_unit_test(micropolar_law_is_understood),
      cmocka_unit_test(expressions_have_their_unit_and_shape),
      cmocka_unit_test(constants_come_first),
      cmocka_unit_test(fields_are_old_above_their_rule_and_new_below),
      cmocka_unit_test(states_take_unit_and_shape_from_their_rule),
      cmocka_unit_test(an_energy_is_enough),
      cmocka_unit_test(shear_force_stands_beside_the_volume),
      cmocka_unit_test(options_are_chosen),
      cmocka_unit_test(bounds_are_kept),
      cmocka_unit_test(bounds_may_differ),
      cmocka_unit_test(defaults_are_computed),
      cmocka_unit_test(defaults_may_call_functions),
      cmocka_unit_test(state_law_is_understood),
      cmocka_unit_test(libraries_may_hold_more_than_is_used),
      cmocka_unit_test(what_is_used_is_marked),
      cmocka_unit_test(every_builtin_has_a_unit),
      cmocka_unit_test(long_chains_are_followed),
      cmocka_unit_test(many_states_are_inferred),
      cmocka_unit_test(doubling_functions_are_stopped),
      cmocka_unit_test(deep_calls_are_stopped),
      cmocka_unit_test(long_sums_end),
      cmocka_unit_test(long_options_end),
      cmocka_unit_test(many_errors_end),
      cmocka_unit_test(any_program_is_survived),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
