/* Symbolic derivatives against extrapolated central differences, identities, and values at kinks.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "generator/ir/derive.h"
#include "generator/ir/interpret.h"
#include "generator/ir/ir.h"

static ir_node variable(ir *g, int index) {
  static const char *const names[] = {"x", "y", "z"};
  return ir_input(g, IR_FROM_QUANTITY, index, names[index], ON_BOND);
}

static ir_node one(ir *g, ir_op op, ir_node a) {
  return ir_make(g, op, a, IR_NONE, IR_NONE);
}
static ir_node two(ir *g, ir_op op, ir_node a, ir_node b) {
  return ir_make(g, op, a, b, IR_NONE);
}
static ir_node number(ir *g, double value) {
  return ir_constant(g, value);
}

static double value_of(const ir *g, ir_node root, const double *at) {
  const double *quantities[] = {at, at + 1, at + 2};
  const interpreter_inputs in = {.values = {[IR_FROM_QUANTITY] = quantities}};
  double out, *const outputs[] = {&out};
  interpreter *p = interpreter_new(g, &root, 1);
  interpreter_run(p, &in, 1, outputs);
  interpreter_free(p);
  return out;
}

static double value_at(const ir *g, ir_node root, double x, double y) {
  return value_of(g, root, (const double[]){x, y, 0.0});
}

static double random_between(uint64_t *state, double low, double high) {
  *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return low + (high - low) * ((double)(*state >> 11) * 0x1p-53);
}

static double central(const ir *g, ir_node f, const double *at, int by, double h) {
  double up[3] = {at[0], at[1], at[2]}, down[3] = {at[0], at[1], at[2]};
  up[by] += h;
  down[by] -= h;
  return (value_of(g, f, up) - value_of(g, f, down)) / (up[by] - down[by]);
}

/* Error h^6: two Richardson steps. */
static double difference_quotient(const ir *g, ir_node f, const double *at, int by) {
  const double h = 4e-3;
  const double d1 = central(g, f, at, by, h), d2 = central(g, f, at, by, h / 2);
  const double d4 = central(g, f, at, by, h / 4);
  const double e1 = d2 + (d2 - d1) / 3, e2 = d4 + (d4 - d2) / 3;
  return e2 + (e2 - e1) / 15;
}

static void check_derivatives(ir *g, ir_node f, const char *name, double low, double high) {
  uint64_t state = 17;
  for (int by = 0; by < 3; by++) {
    const ir_node slope = ir_derivative(g, f, variable(g, by));
    for (int k = 0; k < 40; k++) {
      double at[3];
      for (int j = 0; j < 3; j++)
        at[j] = random_between(&state, low, high);
      const double symbolic = value_of(g, slope, at);
      const double numeric = difference_quotient(g, f, at, by);
      if (!(fabs(symbolic - numeric) <= 2e-9 * (1.0 + fabs(symbolic))))
        fail_msg("%s by %d at %g %g: %.15g, not %.15g", name, by, at[0], at[1], symbolic, numeric);
    }
  }
}

/* Every operation of two inner functions, so that the chain rule is in it; points away from kinks
 * and poles. */
static void every_operation(void **unused) {
  (void)unused;
  for (ir_op op = IR_ADD; op <= IR_SELECT; op++) {
    if (op == IR_ASIN || op == IR_ACOS) continue; /* arcs */
    ir *g = ir_new();
    const ir_node x = variable(g, 0), y = variable(g, 1);
    const ir_node u = ir_add(g, ir_mul(g, x, y), number(g, 0.1));               /* 0.26 to 1.1 */
    const ir_node v = ir_add(g, ir_mul(g, y, y), ir_add(g, x, number(g, 1.0))); /* above u */
    const ir_node f = ir_make(g, op, u, v, ir_mul(g, u, v));
    check_derivatives(g, f, ir_op_name(op), 0.4, 1.0);
    const ir_node reversed = ir_make(g, op, v, u, x);
    if (op != IR_TAN && op != IR_WRAP_ANGLE)
      check_derivatives(g, reversed, ir_op_name(op), 0.4, 1.0);
    ir_free(g);
  }
}

static void negative_arguments(void **unused) {
  (void)unused;
  const ir_op ops[] = {IR_NEG,  IR_ABS, IR_CBRT,  IR_SIN,  IR_COS,  IR_TAN,
                       IR_TANH, IR_EXP, IR_ATAN2, IR_SIGN, IR_SINH, IR_COSH};
  for (size_t k = 0; k < sizeof ops / sizeof *ops; k++) {
    ir *g = ir_new();
    const ir_node x = variable(g, 0), y = variable(g, 1);
    check_derivatives(g, two(g, ops[k], ir_mul(g, x, x), y), ir_op_name(ops[k]), -1.2, -0.5);
    check_derivatives(g, two(g, ops[k], x, y), ir_op_name(ops[k]), -1.2, -0.5);
    ir_free(g);
  }
}

/* asin and acos, of what stays within (-1, 1). */
static void arcs(void **unused) {
  (void)unused;
  const ir_op ops[] = {IR_ASIN, IR_ACOS};
  for (int k = 0; k < 2; k++) {
    ir *g = ir_new();
    const ir_node x = variable(g, 0), y = variable(g, 1);
    check_derivatives(g, one(g, ops[k], ir_mul(g, x, y)), ir_op_name(ops[k]), -0.9, 0.9);
    ir_free(g);
  }
}

static void powers(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = variable(g, 0), y = variable(g, 1);
  const double exponents[] = {-3, -1, -0.5, 1.0 / 3.0, 0.5, 1, 1.5, 2, 3, 7, 2.3, 20};
  for (size_t k = 0; k < sizeof exponents / sizeof *exponents; k++)
    check_derivatives(g, ir_power(g, x, number(g, exponents[k])), "x**constant", 0.6, 1.1);
  check_derivatives(g, ir_power(g, x, y), "x**y", 0.5, 1.5);
  check_derivatives(g, ir_power(g, number(g, 2.5), y), "constant**y", 0.5, 1.5);
  const ir_node cube = ir_power(g, x, number(g, 3.0)), slope = ir_derivative(g, cube, x);
  for (int k = -8; k <= 8; k++)
    assert_true(value_at(g, slope, k, 0) == 3.0 * k * k);
  const ir_node square = ir_power(g, x, number(g, 2.0));
  assert_int_equal(ir_derivative(g, square, x), ir_mul(g, number(g, 2.0), x));
  const ir_node by_exponent = ir_derivative(g, ir_power(g, x, y), y); /* x^y log x is 0 at x = 0 */
  assert_true(value_at(g, by_exponent, 0.0, 2.0) == 0.0);
  ir_free(g);
}

static void nothing_changes_nothing(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = variable(g, 0), y = variable(g, 1), zero = number(g, 0.0);
  assert_int_equal(ir_derivative(g, ir_mul(g, y, y), x), zero);
  assert_int_equal(ir_derivative(g, number(g, 5.0), x), zero);
  assert_int_equal(ir_derivative(g, one(g, IR_SIGN, x), x), zero);
  assert_int_equal(ir_derivative(g, two(g, IR_LT, x, y), x), zero);
  assert_int_equal(ir_derivative(g, x, x), number(g, 1.0));
  assert_int_equal(ir_derivative(g, ir_add(g, ir_mul(g, x, y), y), x), y);
  assert_int_equal(ir_derivative(g, one(g, IR_WRAP_ANGLE, ir_sub(g, y, x)), x), number(g, -1.0));
  /* an inner node taken as independent */
  const ir_node inner = ir_mul(g, x, x), outer = ir_mul(g, inner, y);
  assert_int_equal(ir_derivative(g, outer, inner), y);
  ir_free(g);
}

static void kinks(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = variable(g, 0), y = variable(g, 1), zero = number(g, 0.0);
  const ir_node size = one(g, IR_ABS, x), d_size = ir_derivative(g, size, x);
  assert_true(value_at(g, d_size, 2, 0) == 1 && value_at(g, d_size, -2, 0) == -1);
  assert_true(value_at(g, d_size, 0, 0) == 0);
  const ir_node soft_sign = ir_div(g, x, ir_add(g, number(g, 1.0), size));
  assert_true(value_at(g, ir_derivative(g, soft_sign, x), 0, 0) == 1.0);
  assert_true(fabs(value_at(g, ir_derivative(g, soft_sign, x), -3, 0) - 1.0 / 16) < 1e-16);
  const ir_node least = two(g, IR_MIN, ir_mul(g, x, x), y);
  const ir_node most = two(g, IR_MAX, ir_mul(g, x, x), y);
  assert_true(value_at(g, ir_derivative(g, least, x), 3, 1) == 0 &&
              value_at(g, ir_derivative(g, least, x), 3, 10) == 6);
  assert_true(value_at(g, ir_derivative(g, most, x), 3, 1) == 6 &&
              value_at(g, ir_derivative(g, most, x), 3, 10) == 0);
  assert_true(value_at(g, ir_derivative(g, most, y), 3, 9) == 1); /* a tie: the second */
  const ir_node positive_part = two(g, IR_MAX, x, zero);
  assert_true(value_at(g, ir_derivative(g, positive_part, x), 0, 0) == 0);
  const ir_node norm = one(g, IR_SQRT, ir_add(g, ir_mul(g, x, x), ir_mul(g, y, y)));
  assert_true(value_at(g, ir_derivative(g, norm, x), 0, 0) == 0);
  assert_true(value_at(g, ir_derivative(g, norm, x), -3, 4) == -0.6);
  ir_free(g);
}

/* A bilinear damage law: every case has its own slope, its guard is the law's own, and the poles of
   one case do not reach another. */
static void cases_keep_their_guards(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = variable(g, 0), limit = number(g, 0.5), zero = number(g, 0.0);
  const ir_node softening = ir_div(g, ir_sub(g, x, limit), x);
  const ir_node guard = two(g, IR_LE, x, limit), gone = two(g, IR_LE, number(g, 2.0), x);
  const ir_node w = ir_select(g, guard, zero, ir_select(g, gone, number(g, 1.0), softening));
  const ir_node slope = ir_derivative(g, w, x);
  assert_int_equal(ir_operation(g, slope), IR_SELECT);
  assert_int_equal(ir_operand(g, slope, 0), guard);
  assert_true(value_at(g, slope, 0.0, 0) == 0.0); /* softening has a pole here */
  assert_true(value_at(g, slope, 0.5, 0) == 0.0);
  assert_true(fabs(value_at(g, slope, 1.25, 0) - 0.5 / (1.25 * 1.25)) < 1e-15);
  assert_true(value_at(g, slope, 2.5, 0) == 0.0);
  ir_free(g);
}

/* d/dx of the chord's rotation and length, as the kinematics use them, at random states. */
static void random_compositions(void **unused) {
  (void)unused;
  uint64_t state = 23;
  const ir_op unary[] = {IR_SIN, IR_COS, IR_TANH, IR_EXP, IR_NEG, IR_CBRT};
  for (int round = 0; round < 60; round++) {
    ir *g = ir_new();
    ir_node pool[24] = {variable(g, 0), variable(g, 1), variable(g, 2), number(g, 0.7)};
    for (int n = 4; n < 24; n++) {
      const ir_node a = pool[(int)random_between(&state, 0, n)],
                    b = pool[(int)random_between(&state, 0, n)];
      const ir_node above_one = ir_add(g, number(g, 1.5), ir_mul(g, b, b));
      const int kind = (int)random_between(&state, 0, 6);
      if (kind == 0) pool[n] = one(g, IR_TANH, ir_add(g, a, b));
      if (kind == 1) pool[n] = one(g, IR_SIN, ir_mul(g, a, b));
      if (kind == 2) pool[n] = ir_div(g, a, above_one);
      if (kind == 3) pool[n] = ir_sub(g, a, one(g, IR_SQRT, above_one));
      if (kind == 4) pool[n] = two(g, IR_ATAN2, a, above_one);
      if (kind == 5) pool[n] = one(g, unary[(int)random_between(&state, 0, 5)], one(g, IR_TANH, a));
    }
    check_derivatives(g, one(g, IR_TANH, pool[23]), "random composition", -1.0, 1.0);
    ir_free(g);
  }
}

/* Second derivatives: N = dW/dx, its tangent d2W/dx2. */
static void derivatives_can_be_repeated(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = variable(g, 0), y = variable(g, 1);
  const ir_node energy = ir_mul(g, ir_power(g, x, number(g, 4.0)), one(g, IR_EXP, ir_mul(g, x, y)));
  const ir_node force = ir_derivative(g, energy, x);
  check_derivatives(g, force, "force", 0.3, 1.2);
  const ir_node xy = ir_derivative(g, force, y),
                yx = ir_derivative(g, ir_derivative(g, energy, y), x);
  assert_true(fabs(value_at(g, xy, 0.8, 0.4) / value_at(g, yx, 0.8, 0.4) - 1.0) < 1e-14);
  ir_free(g);
}

/* x -> sin(x^2 + y), n times: value and derivative share; their node counts grow with n, not with
 * 2^n. */
static void graphs_grow_linearly(void **unused) {
  (void)unused;
  int added[2];
  for (int k = 0; k < 2; k++) {
    ir *g = ir_new();
    ir_node f = variable(g, 0);
    for (int n = 0; n < 500 * (k + 1); n++)
      f = one(g, IR_SIN, ir_add(g, ir_mul(g, f, f), variable(g, 1)));
    const int before = ir_count(g);
    (void)ir_derivative(g, f, variable(g, 0));
    added[k] = ir_count(g) - before;
    const int once = ir_count(g);
    (void)ir_derivative(g, f, variable(g, 0));
    assert_int_equal(ir_count(g), once);
    ir_free(g);
  }
  assert_true(added[0] <= 500 * 5);
  assert_true(abs(added[1] - 2 * added[0]) <= 8);
}

/* Reductions over the family: the sum of the parts' changes; for an extreme those of the neighbours
 * that attain it. */
static void family_reductions(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = variable(g, 0), y = variable(g, 1), product = ir_mul(g, x, y);
  const ir_node total = one(g, IR_FAMILY_SUM, product), most = one(g, IR_FAMILY_MAX, product);
  assert_int_equal(ir_derivative(g, total, x), one(g, IR_FAMILY_SUM, y));
  const ir_node attains = two(g, IR_EQ, product, most);
  assert_int_equal(ir_derivative(g, most, x),
                   one(g, IR_FAMILY_SUM, ir_select(g, attains, y, number(g, 0.0))));
  assert_int_equal(ir_derivative(g, total, variable(g, 2)), number(g, 0.0));
  ir_free(g);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_operation),
      cmocka_unit_test(negative_arguments),
      cmocka_unit_test(arcs),
      cmocka_unit_test(powers),
      cmocka_unit_test(nothing_changes_nothing),
      cmocka_unit_test(kinks),
      cmocka_unit_test(cases_keep_their_guards),
      cmocka_unit_test(random_compositions),
      cmocka_unit_test(derivatives_can_be_repeated),
      cmocka_unit_test(graphs_grow_linearly),
      cmocka_unit_test(family_reductions),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
