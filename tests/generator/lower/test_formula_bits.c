/* A formula has the values that the same expression has in a law: to the last bit, whether its
   operands are numbers or quantities of the bond. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "dsl/semantics/formula.h"
#include "dsl/semantics/law_check.h"
#include "dsl/syntax/parse.h"
#include "generator/ir/interpret.h"
#include "generator/lower/lower.h"
#include "runtime/base/random_number.h"

enum { PLACES = 200 };

static const formula_variable variables[] = {{"p", "1"}, {"q", "m"}, {"r", "1/s"}};
static const formula_scope scope = {variables, 3, "p, q (m), r (1/s)"};

/* Nothing that takes p, q and r out of what the functions are defined for. */
static const char *const formulas[] = {
    "p",
    "-p + 3 - +p",
    "q/(1 + abs(q)/3 [mm]) - 2 [in]*p",
    "q**2/1 [m] + q**-2*1 [m^3]",
    "p**7 + p**16 - p**17 + p**0",
    "abs(p)**0.5 + abs(p)**2.5 + abs(p)**-1.5 + (p**2)**(1/3)",
    "abs(p)**0.7 + 1.1**p + abs(p)**p + 2**0.3 + 4**0.5 + 3**4 + 27**(1/3)",
    "(q/r)*exp(-(q/1 [m])**2)*log(1 + p**2)",
    "sin(q/1 [mm]) + cos(q/1 [cm])*tan(p/3) + tanh(p) + sin(30 [deg]) + 0*p",
    "atan2(q, 2 [m]) + atan2(r, -1 [Hz])",
    "asin(tanh(p)) + acos(p/(1 + abs(p))) - pi*sinh(q/1 [m]) + cosh(p) + log10(1 + p**2)",
    "sqrt(q*q) + cbrt(q**3)",
    "sign(p) + soft_sign(10*p) + positive_part(p - 0.1)",
    "min(p, 0.3, p**2) + max(p, -p, 0.5)",
    "| p when q < 0.2 [m] and not (r > 0.1 [Hz]) | 2*p when p == 0 or q /= q | 3 otherwise",
    "2*(| p when p >= 0.1 | -p when p <= -0.1 | 0 otherwise)**2",
    "(| 1 when sqrt(p) > 0.5 | 2 otherwise)*q",
    "max(1 - ((q - 300 [mm*s]*r)/20 [mm])**2, 0)*5 [MPa]*(1 + p/3)",
};

static const formula *must_read(arena *a, source_set *sources, diagnostics *d, const char *text) {
  const int file = source_add(sources, "formula", text, strlen(text));
  const formula *f = formula_read(a, sources, source_whole(sources, file), &scope, NULL, "it", d);
  if (!f) diag_print(d, stderr);
  assert_non_null(f);
  return f;
}

/* Output of a law with the variables as names for what it reads. */
static ir_node lowered(arena *a, source_set *sources, diagnostics *d, const char *text, ir *g) {
  const char *law_text = arena_printf(a,
                                      "model m\nlaw central bond\np = stretch\nq = length\n"
                                      "r = stretch_rate\nforce N = 1 [N]*stretch\noutput o = %s\n"
                                      "end model\n",
                                      text);
  const int file = source_add(sources, "law", law_text, strlen(law_text));
  tree *t = parse_model(a, sources, file, NULL, d);
  law *l = law_check(a, t, sources, NULL, 0, d);
  lowered_law out;
  const bool good = l && lower_law(l, g, LOWER_STEP, a, &out, d);
  if (!good) diag_print(d, stderr);
  assert_true(good);
  return out.outputs[0];
}

static uint64_t bits(double x) {
  uint64_t u;
  memcpy(&u, &x, sizeof u);
  return isnan(x) ? 0 : u == UINT64_C(1) << 63 ? 0 : u; /* rewriting may change the sign of a 0 */
}

static double interpreted(const ir *g, ir_node root, const double *at) {
  const double *inputs[QUANTITY_COUNT] = {
      [QUANTITY_STRETCH] = at, [QUANTITY_LENGTH] = at + 1, [QUANTITY_STRETCH_RATE] = at + 2};
  const interpreter_inputs in = {.values[IR_FROM_QUANTITY] = inputs};
  interpreter *p = interpreter_new(g, &root, 1);
  double value;
  interpreter_run(p, &in, 1, &(double *){&value});
  interpreter_free(p);
  return value;
}

static void values_are_those_of_laws(void **state) {
  (void)state;
  int numbers = 0;
  for (size_t k = 0; k < sizeof formulas / sizeof *formulas; k++) {
    arena *a = arena_new();
    source_set sources = {0};
    diagnostics d;
    diag_begin(&d, &sources);
    ir *g = ir_new();
    const formula *f = must_read(a, &sources, &d, formulas[k]);
    const ir_node root = lowered(a, &sources, &d, formulas[k], g);
    for (uint64_t n = 0; n < PLACES; n++) {
      double at[3];
      for (uint64_t i = 0; i < 3; i++)
        at[i] = 2 * random_unit(random_mix(3 * (PLACES * k + n) + i)) - 1;
      if (n == 0) at[0] = at[1] = at[2] = 0;
      const double mine = formula_value(f, at), law_has = interpreted(g, root, at);
      if (bits(mine) != bits(law_has))
        fail_msg("%s: %.17g, in a law %.17g", formulas[k], mine, law_has);
      numbers += isfinite(mine);
    }
    ir_free(g);
    diag_clear(&d);
    source_clear(&sources);
    arena_free(a);
  }
  assert_true(numbers > (int)(sizeof formulas / sizeof *formulas) * PLACES * 8 / 10);
}

/* The same with numbers in place of variables: what the graph folds. */
static void numbers_are_folded_alike(void **state) {
  (void)state;
  static const char *const folded[] = {
      "1.7**2.5 - sin(0.3)*exp(-1.5)/3 + 0.1*3", "(2 [mm]/3 [us])**-3*1 [m^3/s^3]",
      "| 1 when 0.1 + 0.2 > 0.3 | 2 otherwise", "min(1/3, 0.3333, cbrt(0.03)) + atan2(1, 3)**0.3"};
  for (size_t k = 0; k < sizeof folded / sizeof *folded; k++) {
    arena *a = arena_new();
    source_set sources = {0};
    diagnostics d;
    diag_begin(&d, &sources);
    ir *g = ir_new();
    const formula *f = must_read(a, &sources, &d, folded[k]);
    const ir_node root = lowered(a, &sources, &d, folded[k], g);
    assert_int_equal(ir_operation(g, root), IR_CONSTANT);
    assert_true(bits(formula_value(f, NULL)) == bits(ir_value(g, root)));
    for (int v = 0; v < 3; v++)
      assert_false(formula_reads(f, v));
    ir_free(g);
    diag_clear(&d);
    source_clear(&sources);
    arena_free(a);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(values_are_those_of_laws),
                                     cmocka_unit_test(numbers_are_folded_alike)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
