/* The interpreter against the same expressions written in C, to the bit. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "dsl/base/elementary.h"
#include "generator/ir/interpret.h"
#include "generator/ir/ir.h"

enum { MOST = 300 };

static double random_number(uint64_t *state) {
  *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return ((double)(*state >> 11) * 0x1p-53 - 0.5) * 4.0;
}

static ir_node bond(ir *g, int index) {
  return ir_input(g, IR_FROM_QUANTITY, index, "q", ON_BOND);
}

static bool same(double a, double b) {
  return a == b || (isnan(a) && isnan(b));
}

/* N = (1 - w) EA (stretch + beta theta^2) with a case; w a field. */
typedef struct law_nodes {
  ir_node force, damage;
} law_nodes;

static law_nodes make_law(ir *g) {
  const ir_node EA = ir_input(g, IR_FROM_PARAMETER, 0, "EA", ON_BODY);
  const ir_node limit = ir_input(g, IR_FROM_PARAMETER, 1, "S_t", ON_BODY);
  const ir_node stretch = bond(g, 0), theta = bond(g, 3);
  const ir_node old = ir_input(g, IR_FROM_FIELD, 0, "omega", ON_BOND);
  const ir_node square = ir_power(g, theta, ir_constant(g, 2.0));
  const ir_node measure = ir_add(g, stretch, square);
  const ir_node excess = ir_div(g, ir_sub(g, measure, limit), measure);
  const ir_node whole = ir_make(g, IR_LE, measure, limit, IR_NONE);
  const ir_node rule = ir_select(g, whole, ir_constant(g, 0.0), excess);
  law_nodes l;
  l.damage = ir_make(g, IR_MAX, old, rule, IR_NONE);
  const ir_node left = ir_sub(g, ir_constant(g, 1.0), l.damage);
  l.force = ir_mul(g, ir_mul(g, left, EA), measure);
  return l;
}

static double damage_in_c(double limit, double stretch, double theta, double old) {
  const double measure = stretch + theta * theta;
  return pl_max(old, measure <= limit ? 0.0 : (measure - limit) / measure);
}

/* Any count, whole strips and parts of them; parameters uniform, quantities an array each. */
static void strips_of_any_count(void **unused) {
  (void)unused;
  static double stretch[MOST], theta[MOST], old[MOST], force[MOST], damage[MOST];
  uint64_t state = 1;
  for (int k = 0; k < MOST; k++) {
    stretch[k] = random_number(&state);
    theta[k] = random_number(&state);
    old[k] = fabs(random_number(&state)) / 4.0;
  }
  ir *g = ir_new();
  const law_nodes l = make_law(g);
  const ir_node roots[] = {l.force, l.damage};
  interpreter *p = interpreter_new(g, roots, 2);
  const double EA = 3.5, limit = 0.4;
  const double *parameters[] = {&EA, &limit}, *fields[] = {old};
  const double *quantities[] = {stretch, NULL, NULL, theta};
  const unsigned char varies[] = {1, 1, 1, 1};
  const interpreter_inputs in = {.values = {[IR_FROM_PARAMETER] = parameters,
                                            [IR_FROM_QUANTITY] = quantities,
                                            [IR_FROM_FIELD] = fields},
                                 .stride = {[IR_FROM_QUANTITY] = varies, [IR_FROM_FIELD] = varies}};
  double *const outputs[] = {force, damage};
  const int counts[] = {0, 1, 7, 63, 64, 65, 128, 200, MOST - 1};
  for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
    for (int k = 0; k < MOST; k++)
      force[k] = damage[k] = -77.0;
    interpreter_run(p, &in, counts[c], outputs);
    for (int k = 0; k < counts[c]; k++) {
      const double w = damage_in_c(limit, stretch[k], theta[k], old[k]);
      assert_true(same(damage[k], w));
      assert_true(same(force[k], (1.0 - w) * EA * (stretch[k] + theta[k] * theta[k])));
    }
    for (int k = counts[c]; k < MOST; k++)
      assert_true(force[k] == -77.0 && damage[k] == -77.0);
  }
  interpreter_free(p);
  ir_free(g);
}

/* X(operation, C expression of a, b): each on numbers of all sizes, zeros, infinities and NaN. */
/* clang-format off */
#define OPERATIONS_IN_C(X)                                                                         \
  X(ADD, a + b) X(SUB, a - b) X(MUL, a * b) X(DIV, a / b) X(NEG, -a) X(FMA, fma(a, b, a))          \
  X(ABS, fabs(a)) X(SQRT, sqrt(a)) X(MIN, pl_min(a, b)) X(MAX, pl_max(a, b))                  \
  X(SIGN, pl_sign(a)) X(INVERSE_ROOT, pl_inverse_root(a)) X(EXP, pl_exp(a)) X(LOG, pl_log(a)) \
  X(POW, pl_pow(a, b))                                                                             \
  X(CBRT, pl_cbrt(a)) X(SIN, pl_sin(a)) X(COS, pl_cos(a)) X(TAN, pl_tan(a)) X(TANH, pl_tanh(a))    \
  X(LOG10, pl_log10(a)) X(ASIN, pl_asin(a)) X(ACOS, pl_acos(a)) X(SINH, pl_sinh(a))                \
  X(COSH, pl_cosh(a))                                                                              \
  X(ATAN2, pl_atan2(a, b)) X(WRAP_ANGLE, pl_wrap_angle(a))                                         \
  X(LT, a < b) X(LE, a <= b) X(EQ, a == b) X(AND, (a != 0) && (b != 0))                            \
  X(OR, (a != 0) || (b != 0)) X(NOT, !(a != 0)) X(SELECT, a != 0 ? b : a)
/* clang-format on */

static double in_c(ir_op op, double a, double b) {
  switch (op) {
#define X(code, value)                                                                             \
  case IR_##code:                                                                                  \
    return (double)(value);
    OPERATIONS_IN_C(X)
#undef X
  default:
    return NAN;
  }
}

static void every_operation(void **unused) {
  (void)unused;
  static double a[MOST], b[MOST], out[MOST];
  const double corners[] = {0.0, -0.0,   1.0,   -1.0, INFINITY, -INFINITY,
                            NAN, 1e-310, 1e300, -7.5, 0.5};
  const int n = sizeof corners / sizeof *corners;
  uint64_t state = 9;
  for (int k = 0; k < MOST; k++) {
    a[k] = k < n * n ? corners[k / n] : random_number(&state);
    b[k] = k < n * n ? corners[k % n] : random_number(&state);
  }
  ir *g = ir_new();
  const double *quantities[] = {a, b};
  const unsigned char varies[] = {1, 1};
  const interpreter_inputs in = {.values = {[IR_FROM_QUANTITY] = quantities},
                                 .stride = {[IR_FROM_QUANTITY] = varies}};
  double *const outputs[] = {out};
  const ir_node x = bond(g, 0), y = bond(g, 1);
  for (ir_op op = IR_ADD; op <= IR_SELECT; op++) {
    const ir_node root = ir_make(g, op, x, y, x);
    interpreter *p = interpreter_new(g, &root, 1);
    interpreter_run(p, &in, MOST, outputs);
    for (int k = 0; k < MOST; k++)
      if (!same(out[k], in_c(op, a[k], b[k])))
        fail_msg("%s(%a, %a) = %a", ir_op_name(op), a[k], b[k], out[k]);
    interpreter_free(p);
  }
  ir_free(g);
}

/* One value for all lanes is kept between runs: more lanes, another value, and values of their own
   in between must all be seen. */
static void one_value_for_all_is_followed(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node root = ir_add(g, bond(g, 0), ir_constant(g, 1));
  interpreter *p = interpreter_new(g, &root, 1);
  double value = 2, out[40], many[40];
  double *const outputs[] = {out};
  const double *quantities[] = {&value};
  unsigned char varies[] = {0};
  const interpreter_inputs in = {.values = {[IR_FROM_QUANTITY] = quantities},
                                 .stride = {[IR_FROM_QUANTITY] = varies}};
  interpreter_run(p, &in, 3, outputs);
  interpreter_run(p, &in, 40, outputs);
  for (int k = 0; k < 40; k++)
    assert_true(out[k] == 3);
  value = 5;
  interpreter_run(p, &in, 40, NULL);
  assert_true(interpreter_root(p, 0)[0] == 6 && interpreter_root(p, 0)[39] == 6);
  for (int k = 0; k < 40; k++)
    many[k] = k;
  quantities[0] = many;
  varies[0] = 1;
  interpreter_run(p, &in, 40, outputs);
  assert_true(out[0] == 1 && out[39] == 40);
  quantities[0] = &value;
  varies[0] = 0;
  interpreter_run(p, &in, 40, outputs);
  assert_true(out[0] == 6 && out[39] == 6);
  interpreter_free(p);
  ir_free(g);
}

/* Both sides of a case are evaluated and the other one's NaN does not leak. */
static void cases_do_not_leak(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = bond(g, 0), zero = ir_constant(g, 0.0);
  const ir_node root = ir_select(g, ir_make(g, IR_LE, x, zero, IR_NONE), zero,
                                 ir_make(g, IR_LOG, x, IR_NONE, IR_NONE));
  interpreter *p = interpreter_new(g, &root, 1);
  const double values[] = {-1.0, 0.0, 1.0, NAN};
  const double *quantities[] = {values};
  const unsigned char varies[] = {1};
  const interpreter_inputs in = {.values = {[IR_FROM_QUANTITY] = quantities},
                                 .stride = {[IR_FROM_QUANTITY] = varies}};
  double out[4], *const outputs[] = {out};
  interpreter_run(p, &in, 4, outputs);
  assert_true(out[0] == 0.0 && out[1] == 0.0 && out[2] == 0.0);
  assert_true(isnan(out[3])); /* a comparison with NaN is false, so `otherwise` passes it on */
  interpreter_free(p);
  ir_free(g);
}

static void first_bad_node_is_found(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = bond(g, 0), root_of_x = ir_make(g, IR_SQRT, x, IR_NONE, IR_NONE);
  const ir_node shifted = ir_add(g, root_of_x, ir_constant(g, 1.0));
  const ir_node unneeded = ir_div(g, ir_constant(g, 1.0), ir_sub(g, x, x));
  const ir_node roots[] = {ir_mul(g, shifted, shifted), shifted};
  interpreter *p = interpreter_new(g, roots, 2);
  double x_value = 4.0, a, b, *const outputs[] = {&a, &b};
  const double *quantities[] = {&x_value};
  const interpreter_inputs in = {.values = {[IR_FROM_QUANTITY] = quantities}};
  interpreter_run(p, &in, 1, outputs);
  assert_int_equal(interpreter_first_bad(p), IR_NONE);
  assert_true(interpreter_value(p, root_of_x) == 2.0 && a == 9.0 && b == 3.0);
  x_value = -4.0;
  interpreter_run(p, &in, 1, outputs);
  assert_int_equal(interpreter_first_bad(p), root_of_x);
  assert_true(interpreter_value(p, x) == -4.0);
  x_value = INFINITY;
  interpreter_run(p, &in, 1, outputs);
  assert_int_equal(interpreter_first_bad(p), x);
  assert_true(unneeded > x);
  interpreter_free(p);
  ir_free(g);
}

/* The graph may grow after the interpreter is made; constants and inputs can be roots, one root
 * twice. */
static void graph_may_grow(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = bond(g, 0), three = ir_constant(g, 3.0), twice = ir_add(g, x, x);
  const ir_node roots[] = {x, three, twice, twice};
  interpreter *p = interpreter_new(g, roots, 4);
  ir_node grown = x;
  for (int k = 0; k < 2000; k++)
    grown = ir_make(g, IR_SIN, grown, IR_NONE, IR_NONE);
  double x_value = 2.5, out[4], *const outputs[] = {out, out + 1, out + 2, out + 3};
  const double *quantities[] = {&x_value};
  const interpreter_inputs in = {.values = {[IR_FROM_QUANTITY] = quantities}};
  interpreter_run(p, &in, 1, outputs);
  assert_true(out[0] == 2.5 && out[1] == 3.0 && out[2] == 5.0 && out[3] == 5.0);
  assert_true(grown > twice);
  interpreter_free(p);
  interpreter_free(NULL);
  ir_free(g);
  ir_free(NULL);
}

/* max(z, flat)^3 + max(z, flat) - y, which is flat below `flat`: a Newton's step there leads
   nowhere. */
static ir_node cubic_less(ir *g, ir_node z, ir_node flat, ir_node y) {
  const ir_node x = ir_binary(g, IR_MAX, z, flat);
  return ir_sub(g, ir_add(g, ir_mul(g, x, ir_mul(g, x, x)), x), y);
}

/* The root of it from 0 on, by Newton's method with slope 1 where there is none. */
static ir_node root_of_cubic(ir *g, ir_node flat, ir_node y) {
  const ir_node z = ir_sought(g), f = cubic_less(g, z, flat, y), one = ir_constant(g, 1);
  const ir_node three = ir_constant(g, 3), square = ir_mul(g, z, z);
  const ir_node slope =
      ir_select(g, ir_binary(g, IR_LT, flat, z), ir_add(g, ir_mul(g, three, square), one), one);
  const ir_node open = ir_binary(g, IR_LT, ir_constant(g, 1e-12), ir_unary(g, IR_ABS, f));
  return ir_search(g, ir_constant(g, 0), ir_neg(g, ir_div(g, f, slope)), open);
}

/* A search comes to the root, whatever lanes stand beside; Cardano's formula tells which it is. */
static void searches_find_roots(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node flat = bond(g, 0), y = bond(g, 1), root = root_of_cubic(g, flat, y);
  assert_false(ir_is_sought(g, root));
  interpreter *p = interpreter_new(g, &root, 1);
  double flats[MOST], ys[MOST], together[MOST], alone;
  uint64_t state = 5;
  for (int k = 0; k < MOST; k++) {
    flats[k] = k % 3 == 0 ? 0.5 + 0.2 * random_number(&state) : -100;
    ys[k] = k % 3 == 0 ? 50 * (3 + random_number(&state)) : 50 * random_number(&state);
  }
  const double *inputs[] = {flats, ys};
  const unsigned char stride[] = {1, 1};
  interpreter_inputs in = {.values = {[IR_FROM_QUANTITY] = inputs},
                           .stride = {[IR_FROM_QUANTITY] = stride}};
  interpreter_run(p, &in, MOST, (double *const[]){together});
  for (int k = 0; k < MOST; k++) {
    const double deep = sqrt(ys[k] * ys[k] / 4 + 1.0 / 27);
    const double root_by_formula = cbrt(deep + ys[k] / 2) - cbrt(deep - ys[k] / 2);
    assert_true(fabs(together[k] - root_by_formula) < 1e-10);
    inputs[0] = flats + k, inputs[1] = ys + k;
    interpreter_run(p, &in, 1, (double *const[]){&alone});
    assert_true(alone == together[k]);
  }
  interpreter_free(p);
  ir_free(g);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(strips_of_any_count),           cmocka_unit_test(every_operation),
      cmocka_unit_test(one_value_for_all_is_followed), cmocka_unit_test(cases_do_not_leak),
      cmocka_unit_test(first_bad_node_is_found),       cmocka_unit_test(graph_may_grow),
      cmocka_unit_test(searches_find_roots),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
