/* The graph: sharing, simplifications that keep values, substitution, cost, printing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "generator/ir/derive.h"
#include "generator/ir/interpret.h"
#include "generator/ir/ir.h"

static ir_node parameter(ir *g, int index) {
  static const char *const names[] = {"a", "b", "c", "d"};
  return ir_input(g, IR_FROM_PARAMETER, index, names[index], ON_BODY);
}

static ir_node quantity(ir *g, int index) {
  static const char *const names[] = {"x", "y", "z"};
  return ir_input(g, IR_FROM_QUANTITY, index, names[index], ON_BOND);
}

static ir_node one(ir *g, ir_op op, ir_node a) {
  return ir_make(g, op, a, IR_NONE, IR_NONE);
}
static ir_node two(ir *g, ir_op op, ir_node a, ir_node b) {
  return ir_make(g, op, a, b, IR_NONE);
}

static double value_at(const ir *g, ir_node root, double x, double y) {
  const double *quantities[] = {&x, &y};
  const double *parameters[] = {&y, &x};
  interpreter_inputs in = {0};
  in.values[IR_FROM_QUANTITY] = quantities;
  in.values[IR_FROM_PARAMETER] = parameters;
  double out, *outputs[] = {&out};
  interpreter *p = interpreter_new(g, &root, 1);
  interpreter_run(p, &in, 1, outputs);
  interpreter_free(p);
  return out;
}

static char *dump_text(const ir *g, ir_node root) {
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  const char *const name = "root";
  ir_dump(g, &root, &name, 1, out);
  fclose(out);
  return text;
}

static int nodes_needed(const ir *g, ir_node root) {
  unsigned char *marks = calloc((size_t)ir_count(g), 1);
  ir_mark(g, &root, 1, marks);
  int count = 0;
  for (int n = 0; n < ir_count(g); n++)
    count += marks[n];
  free(marks);
  return count;
}

/* (1 - w) E (x + b y psi) with a case and a power, as a law has it. */
static ir_node sample(ir *g) {
  const ir_node a = parameter(g, 0), b = parameter(g, 1), x = quantity(g, 0), y = quantity(g, 1);
  const ir_node measure = ir_add(g, x, ir_mul(g, ir_mul(g, b, y), one(g, IR_ABS, y)));
  const ir_node cubed = ir_power(g, measure, ir_constant(g, 3.0));
  const ir_node guard = two(g, IR_LE, measure, a);
  const ir_node w = ir_select(g, guard, ir_constant(g, 0.0), ir_div(g, cubed, ir_add(g, a, b)));
  return ir_mul(g, ir_mul(g, ir_sub(g, ir_constant(g, 1.0), w), a), measure);
}

static void equal_expressions_are_one_node(void **unused) {
  (void)unused;
  ir *g = ir_new(), *h = ir_new();
  const ir_node first = sample(g);
  const int count = ir_count(g);
  assert_int_equal(sample(g), first);
  assert_int_equal(ir_count(g), count);
  assert_int_equal(sample(h), first);
  assert_int_equal(ir_count(h), count);
  char *text = dump_text(g, first), *again = dump_text(h, first);
  assert_string_equal(text, again);
  free(text);
  free(again);
  const ir_node x = quantity(g, 0), y = quantity(g, 1);
  assert_int_equal(ir_add(g, x, y), ir_add(g, y, x));
  assert_int_equal(ir_mul(g, x, y), ir_mul(g, y, x));
  assert_int_not_equal(ir_sub(g, x, y), ir_sub(g, y, x));
  assert_int_not_equal(ir_constant(g, 0.0), ir_constant(g, -0.0));
  assert_int_equal(ir_constant(g, NAN), ir_constant(g, -NAN));
  ir_free(g);
  ir_free(h);
}

static void operands_come_first_and_places_spread(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node root = sample(g);
  for (ir_node n = 0; n < ir_count(g); n++)
    for (int k = 0; k < ir_arity(ir_operation(g, n)); k++)
      assert_true(ir_operand(g, n, k) < n);
  assert_int_equal(ir_place(g, root), ON_BOND);
  assert_int_equal(ir_place(g, ir_mul(g, parameter(g, 0), ir_constant(g, 3.0))), ON_BODY);
  assert_int_equal(ir_place(g, ir_constant(g, 3.0)), ON_NOTHING);
  ir_free(g);
}

static void identities_are_simplified(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = quantity(g, 0), y = quantity(g, 1);
  const ir_node zero = ir_constant(g, 0.0), whole = ir_constant(g, 1.0);
  assert_int_equal(ir_add(g, x, zero), x);
  assert_int_equal(ir_add(g, zero, x), x);
  assert_int_equal(ir_sub(g, x, zero), x);
  assert_int_equal(ir_sub(g, zero, x), ir_neg(g, x));
  assert_int_equal(ir_mul(g, x, whole), x);
  assert_int_equal(ir_mul(g, whole, x), x);
  assert_int_equal(ir_mul(g, ir_constant(g, -1.0), x), ir_neg(g, x));
  assert_int_equal(ir_div(g, x, whole), x);
  assert_int_equal(ir_div(g, x, ir_constant(g, -1.0)), ir_neg(g, x));
  assert_int_equal(ir_div(g, x, ir_constant(g, 4.0)), ir_mul(g, x, ir_constant(g, 0.25)));
  assert_int_equal(ir_operation(g, ir_div(g, x, ir_constant(g, 3.0))), IR_DIV);
  assert_int_equal(ir_operation(g, ir_div(g, x, ir_constant(g, 0x1p-1023))), IR_DIV);
  assert_int_equal(ir_operation(g, ir_div(g, x, ir_constant(g, 0x1p1023))), IR_DIV);
  assert_int_equal(ir_neg(g, ir_neg(g, x)), x);
  assert_int_equal(ir_add(g, x, ir_neg(g, y)), ir_sub(g, x, y));
  assert_int_equal(ir_sub(g, x, ir_neg(g, y)), ir_add(g, x, y));
  assert_int_equal(ir_mul(g, ir_neg(g, x), ir_neg(g, y)), ir_mul(g, x, y));
  assert_int_equal(ir_mul(g, ir_neg(g, x), ir_constant(g, 2.0)),
                   ir_mul(g, x, ir_constant(g, -2.0)));
  assert_int_equal(ir_div(g, ir_neg(g, x), y), ir_neg(g, ir_div(g, x, y)));
  assert_int_equal(one(g, IR_ABS, ir_neg(g, x)), one(g, IR_ABS, x));
  assert_int_equal(one(g, IR_ABS, one(g, IR_ABS, x)), one(g, IR_ABS, x));
  assert_int_equal(two(g, IR_MIN, x, x), x);
  assert_int_equal(two(g, IR_MAX, x, x), x);
  ir_free(g);
}

static void truth_values_are_simplified(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = quantity(g, 0), y = quantity(g, 1);
  const ir_node p = two(g, IR_LT, x, y), q = two(g, IR_EQ, x, y);
  const ir_node no = ir_constant(g, 0.0), yes = ir_constant(g, 1.0);
  assert_int_equal(one(g, IR_NOT, one(g, IR_NOT, p)), p);
  assert_int_equal(two(g, IR_AND, p, yes), p);
  assert_int_equal(two(g, IR_AND, no, p), no);
  assert_int_equal(two(g, IR_OR, p, no), p);
  assert_int_equal(two(g, IR_OR, yes, p), yes);
  assert_int_equal(two(g, IR_AND, p, p), p);
  assert_int_equal(ir_select(g, yes, x, y), x);
  assert_int_equal(ir_select(g, no, x, y), y);
  assert_int_equal(ir_select(g, p, x, x), x);
  assert_int_equal(ir_select(g, one(g, IR_NOT, p), x, y), ir_select(g, p, y, x));
  assert_int_equal(two(g, IR_LT, x, x), no);
  assert_true(ir_is_logical(g, ir_select(g, p, q, two(g, IR_LE, x, y))));
  assert_true(ir_is_logical(g, two(g, IR_AND, x, p))); /* a number becomes "other than 0" */
  const ir_node both = two(g, IR_AND, x, y);
  assert_true(value_at(g, both, -3.0, 0.5) == 1.0 && value_at(g, both, 0.0, 2.0) == 0.0);
  ir_free(g);
}

/* What could change a NaN, an infinity or a rounding stays as written. */
static void values_are_kept(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = quantity(g, 0), y = quantity(g, 1), zero = ir_constant(g, 0.0);
  assert_true(isnan(value_at(g, ir_sub(g, x, x), INFINITY, 0)));
  assert_true(isnan(value_at(g, ir_mul(g, zero, x), NAN, 0)));
  assert_true(isnan(value_at(g, ir_div(g, x, x), 0.0, 0)));
  assert_true(value_at(g, two(g, IR_EQ, x, x), NAN, 0) == 0.0);
  assert_true(value_at(g, two(g, IR_LE, x, x), NAN, 0) == 0.0);
  const ir_node tiny = ir_constant(g, 1e-16);
  const ir_node left = ir_sub(g, ir_add(g, ir_add(g, x, tiny), tiny), x);
  assert_true(value_at(g, left, 1.0, 0.0) == 0.0); /* not regrouped to 2e-16 */
  assert_true(value_at(g, one(g, IR_NOT, two(g, IR_LT, x, y)), NAN, 1.0) == 1.0);
  ir_free(g);
}

static double random_number(uint64_t *state) {
  *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return ((double)(*state >> 11) * 0x1p-53 - 0.5) * 6.0;
}

/* A constant folded is, to the bit, what the interpreter computes at run time. */
static void folding_is_evaluation(void **unused) {
  (void)unused;
  uint64_t state = 11;
  for (int round = 0; round < 200; round++) {
    ir *g = ir_new();
    const double a = random_number(&state), b = random_number(&state);
    for (ir_op op = IR_ADD; op <= IR_SELECT; op++) {
      const ir_node live = ir_make(g, op, quantity(g, 0), quantity(g, 1), quantity(g, 1));
      const ir_node kb = ir_constant(g, b);
      const ir_node folded = ir_make(g, op, ir_constant(g, a), kb, kb);
      assert_int_equal(ir_operation(g, folded), IR_CONSTANT);
      const double computed = value_at(g, live, a, b), known = ir_value(g, folded);
      assert_true(computed == known || (isnan(computed) && isnan(known)));
    }
    ir_free(g);
  }
}

static void powers_avoid_pow(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = quantity(g, 0), y = quantity(g, 1);
  for (int twice = -34; twice <= 34; twice++) {
    const double exponent = 0.5 * twice, base = 1.7;
    const ir_node r = ir_power(g, x, ir_constant(g, exponent));
    assert_true(fabs(value_at(g, r, base, 0) / pow(base, exponent) - 1.0) < 4e-15);
    const bool by_products = abs(twice) <= 32;
    assert_true((ir_operation(g, r) == IR_POW) == !by_products);
  }
  assert_true(ir_value(g, ir_power(g, x, ir_constant(g, 0.0))) == 1.0);
  assert_int_equal(ir_power(g, x, ir_constant(g, 1.0)), x);
  assert_int_equal(ir_operation(g, ir_power(g, x, ir_constant(g, 0.5))), IR_SQRT);
  assert_int_equal(ir_operation(g, ir_power(g, x, ir_constant(g, 1.0 / 3.0))), IR_CBRT);
  assert_int_equal(ir_operation(g, ir_power(g, x, y)), IR_POW);
  assert_int_equal(nodes_needed(g, ir_power(g, x, ir_constant(g, 16.0))), 5); /* x and 4 squares */
  assert_true(ir_value(g, ir_power(g, ir_constant(g, 3.0), ir_constant(g, 4.0))) == 81.0);
  assert_true(value_at(g, ir_power(g, x, ir_constant(g, 3.0)), -2.0, 0) == -8.0);
  ir_free(g);
}

static void substitution_is_simultaneous(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = quantity(g, 0), y = quantity(g, 1);
  const ir_node roots[] = {ir_sub(g, ir_mul(g, x, x), y), x, IR_NONE, parameter(g, 0)};
  const ir_node from[] = {x, y}, to[] = {y, x};
  ir_node out[4];
  ir_substitute(g, roots, 4, from, to, 2, out);
  assert_int_equal(out[0], ir_sub(g, ir_mul(g, y, y), x));
  assert_int_equal(out[1], y);
  assert_int_equal(out[2], IR_NONE);
  assert_int_equal(out[3], roots[3]); /* untouched, so the same node */
  const ir_node inner = ir_mul(g, x, x), three = ir_constant(g, 3.0);
  ir_substitute(g, roots, 1, &inner, &three, 1, out);
  assert_int_equal(out[0], ir_sub(g, three, y));
  const ir_node two_numbers[] = {ir_constant(g, 3.0), ir_constant(g, 2.0)};
  ir_substitute(g, roots, 1, from, two_numbers, 2, out);
  assert_true(ir_value(g, out[0]) == 7.0); /* folded on the way */
  ir_free(g);
}

static void names_are_kept(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = quantity(g, 0), y = quantity(g, 1), m = ir_mul(g, x, y);
  char buffer[] = "omega";
  ir_set_name(g, m, buffer, (span){.begin = 4, .end = 9});
  buffer[0] = '?';
  ir_set_name(g, m, "later", (span){.begin = 1, .end = 2});
  assert_string_equal(ir_name(g, m), "omega");
  assert_int_equal(ir_where(g, m).begin, 4);
  const ir_node number = ir_constant(g, 2.0);
  ir_set_name(g, number, "k", (span){0});
  assert_null(ir_name(g, number));
  ir_set_name(g, x, "alias", (span){0});
  assert_string_equal(ir_name(g, x), "x");
  const ir_node z = quantity(g, 2);
  ir_node moved;
  ir_substitute(g, &m, 1, &x, &z, 1, &moved);
  assert_string_equal(ir_name(g, moved), "omega");
  ir_free(g);
}

/* Conditions keep the mark when they are rebuilt; a number is no condition to expect. */
static void what_is_expected_stays_expected(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node x = quantity(g, 0), y = quantity(g, 1), z = quantity(g, 2);
  const ir_node small = ir_expect(g, two(g, IR_LT, x, y));
  const ir_node chosen = ir_select(g, small, x, one(g, IR_SIN, x));
  ir_node out;
  ir_substitute(g, &chosen, 1, &x, &z, 1, &out);
  assert_int_equal(ir_operation(g, out), IR_SELECT);
  assert_true(ir_is_expected(g, ir_operand(g, out, 0)) && ir_is_expected(g, small));
  assert_false(ir_is_expected(g, two(g, IR_LT, y, x)));
  assert_false(ir_is_expected(g, ir_expect(g, two(g, IR_LT, x, x))));
  ir_free(g);
}

static void costs_are_counted_once(void **unused) {
  (void)unused;
  ir *g = ir_new();
  const ir_node a = parameter(g, 0), x = quantity(g, 0), y = quantity(g, 1);
  const ir_node uniform = ir_div(g, ir_constant(g, 1.0), ir_add(g, a, ir_constant(g, 1.0)));
  const ir_node shared = ir_mul(g, x, uniform);
  const ir_node angle = two(g, IR_ATAN2, shared, y);
  const ir_node chosen = ir_select(g, two(g, IR_LT, x, y), angle, ir_add(g, shared, y));
  const ir_node root = one(g, IR_SQRT, two(g, IR_MAX, chosen, ir_neg(g, shared)));
  const ir_node roots[] = {root, shared};
  ir_cost cost = ir_count_cost(g, roots, 2, ON_BOND, NULL);
  assert_int_equal(cost.additions, 1);
  assert_int_equal(cost.multiplications, 1);
  assert_int_equal(cost.divisions, 1);
  assert_int_equal(cost.functions, 1);
  assert_int_equal(cost.selects, 2);
  cost = ir_count_cost(g, roots, 2, ON_NOTHING, NULL);
  assert_int_equal(cost.additions, 2);
  assert_int_equal(cost.divisions, 2);
  ir_free(g);
}

static void dump_is_readable(void **unused) {
  (void)unused;
  source_set sources = {0};
  const char *const text = "model m\n  w = a*x\n";
  source_add(&sources, "m.plm", text, strlen(text));
  ir *g = ir_new();
  const ir_node a = parameter(g, 0), x = quantity(g, 0);
  const ir_node w = ir_mul(g, a, x);
  const ir_node guard = two(g, IR_LT, w, ir_constant(g, 0.1));
  const ir_node r = ir_select(g, guard, w, ir_neg(g, x));
  ir_set_name(g, w, "w", (span){.begin = 10, .end = 11});
  ir_set_sources(g, &sources);
  char *got = dump_text(g, r);
  assert_string_equal(got, "%0 = input parameter 0 : body  ; a\n"
                           "%1 = input quantity 0 : bond  ; x\n"
                           "%2 = mul %0 %1 : bond  ; w (line 2)\n"
                           "%3 = constant 0.10000000000000001\n"
                           "%4 = lt %2 %3 : bond\n"
                           "%5 = neg %1 : bond\n"
                           "%6 = select %4 %2 %5 : bond\n"
                           "root = %6\n");
  free(got);
  ir_free(g);
  source_clear(&sources);
}

enum { DEEP = 100000 };

/* A chain of nodes through every walk. */
static void *walk_deep_chain(void *failed) {
  ir *g = ir_new();
  const ir_node x = quantity(g, 0), y = quantity(g, 1);
  ir_node f = x;
  for (int k = 0; k < DEEP; k++) {
    f = ir_add(g, one(g, IR_SIN, f), y);
  }
  ir_node swapped;
  ir_substitute(g, &f, 1, &x, &y, 1, &swapped);
  const ir_node slope = ir_derivative(g, f, x);
  const double at_zero = value_at(g, slope, 0.3, 0.0), straight = value_at(g, swapped, 0.3, 0.0);
  *(int *)failed = nodes_needed(g, f) != 2 * DEEP + 2 || !(fabs(at_zero) < 1.0) ||
                   straight != 0.0 ||
                   ir_count_cost(g, &slope, 1, ON_BOND, NULL).functions != 2 * DEEP - 1;
  ir_free(g);
  return NULL;
}

/* On a stack of 128 KiB no walk can recurse over 2e5 nodes. */
static void deep_graphs_need_no_stack(void **unused) {
  (void)unused;
  pthread_attr_t attributes;
  pthread_t thread;
  int failed = 1;
  pthread_attr_init(&attributes);
  assert_int_equal(pthread_attr_setstacksize(&attributes, 128 * 1024), 0);
  assert_int_equal(pthread_create(&thread, &attributes, walk_deep_chain, &failed), 0);
  pthread_join(thread, NULL);
  pthread_attr_destroy(&attributes);
  assert_int_equal(failed, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(equal_expressions_are_one_node),
      cmocka_unit_test(operands_come_first_and_places_spread),
      cmocka_unit_test(identities_are_simplified),
      cmocka_unit_test(truth_values_are_simplified),
      cmocka_unit_test(values_are_kept),
      cmocka_unit_test(folding_is_evaluation),
      cmocka_unit_test(powers_avoid_pow),
      cmocka_unit_test(substitution_is_simultaneous),
      cmocka_unit_test(names_are_kept),
      cmocka_unit_test(what_is_expected_stays_expected),
      cmocka_unit_test(costs_are_counted_once),
      cmocka_unit_test(dump_is_readable),
      cmocka_unit_test(deep_graphs_need_no_stack),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
