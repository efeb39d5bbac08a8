/* Rewrites that may change last bits, and what is seen of degrees and NaN. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "generator/ir/derive.h"
#include "generator/ir/interpret.h"
#include "generator/ir/rewrite.h"

static ir_node input(ir *g, int k, placement on) {
  return ir_input(g, IR_FROM_FIELD, k, NULL, on);
}

static void degrees_are_seen(void **state) {
  (void)state;
  ir *g = ir_new();
  ir_node x = input(g, 0, ON_BOND), y = input(g, 1, ON_BOND), k = input(g, 2, ON_BODY);
  ir_node xs[] = {x, y}, two = ir_constant(g, 2), zero = ir_constant(g, 0);
  ir_node linear = ir_add(g, ir_mul(g, k, x), ir_mul(g, two, y));
  ir_node positive = ir_make(g, IR_LT, zero, x, IR_NONE);
  ir_node at_two = ir_make(g, IR_LT, two, x, IR_NONE);
  ir_node larger = ir_make(g, IR_MAX, ir_make(g, IR_ABS, x, IR_NONE, IR_NONE), y, IR_NONE);
  assert_true(rewrite_degree(g, linear, xs, 2) == 1);
  assert_true(rewrite_degree(g, ir_mul(g, linear, larger), xs, 2) == 2);
  assert_true(rewrite_degree(g, ir_div(g, linear, larger), xs, 2) == 0);
  assert_true(rewrite_degree(g, ir_select(g, positive, linear, ir_mul(g, x, two)), xs, 2) == 1);
  assert_true(isnan(rewrite_degree(g, ir_select(g, at_two, linear, x), xs, 2)));
  assert_true(isnan(rewrite_degree(g, ir_add(g, linear, two), xs, 2)));
  assert_true(isnan(rewrite_degree(g, ir_make(g, IR_SIN, x, IR_NONE, IR_NONE), xs, 2)));
  assert_true(rewrite_degree(g, k, xs, 2) == 0);
  ir_free(g);
}

/* Products of sums and differences, on either side; what is named, or the same for all bonds, stays
   as it is. */
static void sums_of_products_are_fused(void **state) {
  (void)state;
  ir *g = ir_new();
  const ir_node x = input(g, 0, ON_BOND), y = input(g, 1, ON_BOND), k = input(g, 2, ON_BODY),
                xy = ir_mul(g, x, y), yy = ir_mul(g, y, y), kk = ir_mul(g, k, k);
  const ir_node area = ir_mul(g, x, x);
  ir_set_name(g, area, "area", (span){0, 0, 0});
  const ir_node roots[] = {ir_add(g, xy, x),   ir_sub(g, xy, x), ir_sub(g, x, xy),
                           ir_add(g, area, y), ir_add(g, kk, x), ir_add(g, xy, yy)};
  ir_node fused[6];
  rewrite_fused(g, roots, 6, fused);
  assert_int_equal(fused[0], ir_make(g, IR_FMA, x, y, x));
  assert_int_equal(fused[1], ir_make(g, IR_FMA, x, y, ir_neg(g, x)));
  assert_int_equal(fused[2], ir_make(g, IR_FMA, ir_neg(g, x), y, x));
  assert_int_equal(fused[3], roots[3]);
  assert_int_equal(fused[4], roots[4]);
  /* of two products the one that nothing else needs */
  assert_int_equal(fused[5], ir_make(g, IR_FMA, y, y, xy));
  /* d(x y + x)/dx = y + 1, as before */
  assert_int_equal(ir_derivative(g, fused[0], x), ir_derivative(g, roots[0], x));
  ir_free(g);
}

/* Factors that are the same for all bonds meet where that costs nothing. */
static void uniform_factors_are_joined(void **state) {
  (void)state;
  ir *g = ir_new();
  const ir_node x = input(g, 0, ON_BOND), y = input(g, 1, ON_BOND), k = input(g, 2, ON_BODY),
                l = input(g, 3, ON_BODY), kl = ir_mul(g, k, l), xy = ir_mul(g, x, y);
  const ir_node kx = ir_mul(g, k, x), ly = ir_mul(g, l, y);
  const ir_node roots[] = {ir_mul(g, l, kx),
                           ir_mul(g, ir_mul(g, k, ir_mul(g, y, y)), x),
                           ir_div(g, ir_mul(g, l, xy), x),
                           kx,
                           ir_mul(g, kx, ly),
                           ir_mul(g, kx, y)};
  ir_node out[6];
  rewrite_factors(g, roots, 6, out);
  assert_int_equal(out[0], ir_mul(g, kl, x));
  assert_int_equal(out[1], ir_mul(g, k, ir_mul(g, x, ir_mul(g, y, y))));
  assert_int_equal(out[2], ir_mul(g, l, ir_div(g, xy, x)));
  assert_int_equal(out[3], kx);
  assert_int_equal(out[4],
                   ir_mul(g, kl, xy)); /* l comes out of its product, so that k may as well */
  assert_int_equal(out[5], roots[5]);  /* others need kx as it is */
  ir_free(g);
}

/* Sizes give their factors away, too, and the larger of two is a choice where a choice keeps NaN.
   */
static void the_larger_of_two_keeps_its_nan(void **state) {
  (void)state;
  ir *g = ir_new();
  const ir_node x = input(g, 0, ON_BOND), y = input(g, 1, ON_BOND), k = input(g, 2, ON_BODY);
  const ir_node sum = ir_add(g, x, y), root = ir_make(g, IR_SQRT, x, IR_NONE, IR_NONE);
  const ir_node kx = ir_mul(g, k, x), k_sum = ir_mul(g, k, sum);
  const ir_node size_x = ir_make(g, IR_ABS, x, IR_NONE, IR_NONE),
                size_sum = ir_make(g, IR_ABS, sum, IR_NONE, IR_NONE),
                size_k = ir_make(g, IR_ABS, k, IR_NONE, IR_NONE);
  const ir_node larger = ir_make(g, IR_MAX, ir_make(g, IR_ABS, kx, IR_NONE, IR_NONE),
                                 ir_make(g, IR_ABS, k_sum, IR_NONE, IR_NONE), IR_NONE);
  const ir_node roots[] = {larger, ir_make(g, IR_MAX, sum, x, IR_NONE),
                           ir_make(g, IR_MIN, root, sum, IR_NONE)};
  ir_node out[3];
  rewrite_factors(g, roots, 3, out);
  const ir_node choice =
      ir_select(g, ir_make(g, IR_LT, size_sum, size_x, IR_NONE), size_x, size_sum);
  assert_int_equal(out[0], ir_mul(g, size_k, choice));
  assert_int_equal(out[1], ir_select(g, ir_make(g, IR_LT, sum, x, IR_NONE), x,
                                     sum)); /* y may be NaN where x is not */
  assert_int_equal(out[2], roots[2]);       /* the root of x < 0 is NaN, the sum is not */
  assert_true(rewrite_nan_follows(g, x, sum) && !rewrite_nan_follows(g, sum, x));
  assert_false(rewrite_nan_follows(g, root, x));
  assert_false(rewrite_nan_follows(g, x, ir_select(g, ir_make(g, IR_LT, x, y, IR_NONE), x, y)));
  ir_free(g);
}

static void choices_divide_once(void **state) {
  (void)state;
  ir *g = ir_new();
  ir_node x[6], out;
  for (int k = 0; k < 6; k++)
    x[k] = input(g, k, ON_BOND);
  const ir_node zero = ir_constant(g, 0), asked = ir_make(g, IR_LT, zero, x[0], IR_NONE);
  const ir_node a = ir_div(g, x[1], x[2]), b = ir_div(g, x[3], x[4]);
  const ir_node plain = ir_select(g, asked, a, b);
  const ir_node once = ir_div(g, ir_select(g, asked, x[1], x[3]), ir_select(g, asked, x[2], x[4]));
  rewrite_choices(g, &plain, 1, &out);
  assert_int_equal(out, once);
  const ir_node guarded =
      ir_select(g, asked, ir_select(g, ir_make(g, IR_LE, x[5], x[2], IR_NONE), zero, a),
                ir_select(g, ir_make(g, IR_LE, x[5], x[4], IR_NONE), zero, b));
  rewrite_choices(g, &guarded, 1, &out);
  const ir_node below = ir_select(g, asked, x[2], x[4]);
  assert_int_equal(out, ir_select(g, ir_make(g, IR_LE, x[5], below, IR_NONE), zero, once));
  const ir_node needed[] = {plain, a}; /* a is divided in any case */
  ir_node both[2];
  rewrite_choices(g, needed, 2, both);
  assert_int_equal(both[0], plain);
  ir_free(g);
}

/* a/b by its reciprocal, put right: the bits of a division. */
static ir_node by_reciprocal(ir *g, ir_node above, ir_node below) {
  const ir_node reciprocal = ir_div(g, ir_constant(g, 1), below),
                rough = ir_mul(g, above, reciprocal);
  return ir_make(g, IR_FMA, ir_make(g, IR_FMA, ir_neg(g, rough), below, above), reciprocal, rough);
}

static double value_of(const ir *g, ir_node n, const double *a, const double *b) {
  const double *fields[] = {a, b};
  const interpreter_inputs in = {.values = {[IR_FROM_FIELD] = fields}};
  double value, *out[] = {&value};
  interpreter *p = interpreter_new(g, &n, 1);
  interpreter_run(p, &in, 1, out);
  interpreter_free(p);
  return value;
}

/* Also where n (1/n) is not 1, as for 49, and where a/b is between two numbers. */
static void quotients_keep_their_bits(void **state) {
  (void)state;
  long rough = 0;
  for (int n = 1; n <= 128; n++)
    for (int a = 0; a <= n; a++) {
      ir *g = ir_new();
      const ir_node x = input(g, 0, ON_NEIGHBOUR), d = input(g, 1, ON_PARTICLE);
      const ir_node quotient = ir_div(g, x, d);
      ir_node out;
      rewrite_reciprocals(g, &quotient, 1, &out);
      const double above[1] = {a}, below[1] = {n};
      assert_true(value_of(g, out, above, below) == (double)a / n);
      rough += a * (1.0 / n) != (double)a / n;
      ir_free(g);
    }
  assert_true(rough > 100);
}

static void neighbours_share_the_reciprocal_of_a_particle(void **state) {
  (void)state;
  ir *g = ir_new();
  const ir_node x = input(g, 0, ON_NEIGHBOUR), p = input(g, 1, ON_PARTICLE),
                q = input(g, 2, ON_PARTICLE), one = ir_constant(g, 1);
  const ir_node roots[] = {ir_div(g, x, q), ir_div(g, p, q)};
  ir_node out[2];
  rewrite_reciprocals(g, roots, 1, out);
  assert_int_equal(out[0], by_reciprocal(g, x, q));
  const ir_node product = ir_div(g, ir_mul(g, p, x), q);
  rewrite_reciprocals(g, &product, 1, out);
  assert_int_equal(out[0], ir_mul(g, roots[1], x));
  rewrite_reciprocals(g, roots + 1, 1, out);
  assert_int_equal(out[0], roots[1]);
  const ir_node degree = ir_make(g, IR_FAMILY_SUM, one, IR_NONE, IR_NONE); /* lasts, p does not */
  const ir_node mean = ir_div(g, p, degree);
  rewrite_reciprocals(g, &mean, 1, out);
  assert_int_equal(out[0], by_reciprocal(g, p, degree));
  ir_free(g);
}

static void zero_and_reciprocal_rewrites(void **state) {
  (void)state;
  ir *g = ir_new();
  ir_node x = input(g, 0, ON_BOND), y = input(g, 1, ON_BOND), k = input(g, 2, ON_BODY);
  ir_node f = ir_add(g, ir_mul(g, k, y), ir_div(g, ir_mul(g, x, k), ir_add(g, y, k))), out;
  rewrite_zero(g, &f, 1, &x, 1, &out);
  assert_int_equal(out, ir_mul(g, k, y));
  ir_node one = ir_constant(g, 1), roots[] = {ir_div(g, x, k), ir_div(g, k, y)}, results[2];
  rewrite_reciprocals(g, roots, 2, results);
  assert_int_equal(results[0], ir_mul(g, x, ir_div(g, one, k)));
  assert_int_equal(results[1], roots[1]); /* the only division by y */
  ir_node shared[] = {ir_div(g, x, y), ir_div(g, k, y)};
  rewrite_reciprocals(g, shared, 2, results);
  assert_int_equal(results[0], ir_mul(g, x, ir_div(g, one, y)));
  assert_int_equal(results[1], ir_mul(g, k, ir_div(g, one, y)));
  ir_free(g);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(degrees_are_seen),
      cmocka_unit_test(sums_of_products_are_fused),
      cmocka_unit_test(uniform_factors_are_joined),
      cmocka_unit_test(the_larger_of_two_keeps_its_nan),
      cmocka_unit_test(choices_divide_once),
      cmocka_unit_test(quotients_keep_their_bits),
      cmocka_unit_test(neighbours_share_the_reciprocal_of_a_particle),
      cmocka_unit_test(zero_and_reciprocal_rewrites),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
