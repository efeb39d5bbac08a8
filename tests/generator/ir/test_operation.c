/* What the table says of each operation, against its values on many numbers. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "dsl/semantics/builtins.h"
#include "generator/ir/operation.h"
#include "generator/ir/random_values.h"

enum { ROUNDS = 4000 };
static const ir_op FIRST = IR_ADD, LAST = IR_SELECT;

static bool same(double a, double b) {
  return a == b || (isnan(a) && isnan(b));
}

/* Numbers of all sizes that angles can have, and those at which something happens. */
static double draw(uint64_t *seed) {
  static const double corners[] = {0, -0.0, 1, -1, 0.5, -0.5, 2, M_PI, -M_PI};
  const size_t corner = draw_bits(seed) % 30;
  return corner < sizeof corners / sizeof *corners ? corners[corner] : draw_size(seed, -6, 2);
}

static double of_one(ir_op op, double x) {
  return operation_value(op, x, 0, 0);
}

static void check_function(ir_op op, double x, double y) {
  const double at = of_one(op, x), opposite = of_one(op, -x);
  if (operation_has(op, ODD) && !same(opposite, -at)) fail_msg("not odd at %g", x);
  if (operation_has(op, EVEN) && !same(opposite, at)) fail_msg("not even at %g", x);
  if (operation_has(op, VANISHES) && of_one(op, 0) != 0) fail_msg("not 0 at 0");
  if (operation_has(op, RISING) && x < y && of_one(op, y) < at)
    fail_msg("falls from %g to %g", x, y);
}

static void check_value(ir_op op, double a, double b, double c) {
  const double value = operation_value(op, a, b, c);
  const operation_image *image = &operations[op].image;
  if (value < image->low || value > image->high) fail_msg("%g at %g, %g", value, a, b);
  if (operation_has(op, LOGICAL)) assert_true(value == 0 || value == 1);
  if (!operation_has(op, MAKES_NAN) && isnan(value)) fail_msg("NaN at %g, %g", a, b);
  if (operation_has(op, ARITHMETIC) && !operation_has(op, PARTIAL) && !isfinite(value))
    fail_msg("%g at %g, %g", value, a, b);
  if (operation_has(op, COMMUTES) && !same(value, operation_value(op, b, a, c)))
    fail_msg("does not commute at %g, %g", a, b);
  if (operation_has(op, ARITHMETIC))
    assert_true(isnan(operation_value(op, NAN, b, c)) &&
                (operations[op].arity < 2 || isnan(operation_value(op, a, NAN, c))));
}

static void rows_are_true(void **unused) {
  (void)unused;
  for (ir_op op = FIRST; op <= LAST; op++) {
    uint64_t seed = 3;
    for (int k = 0; k < ROUNDS; k++) {
      const double a = draw(&seed), b = draw(&seed);
      check_value(op, a, b, draw(&seed));
      if (operations[op].arity == 1) check_function(op, a, b);
    }
  }
}

/* And nothing is left out that the program makes use of: each such function has the trait. */
static void rows_are_complete(void **unused) {
  (void)unused;
  for (ir_op op = FIRST; op <= LAST; op++) {
    bool nan = false, odd = true, even = true;
    uint64_t seed = 5;
    for (int k = 0; k < ROUNDS; k++) {
      const double x = draw(&seed), y = draw(&seed), at = of_one(op, x);
      nan = nan || isnan(operation_value(op, x, y, 0));
      odd = odd && same(of_one(op, -x), -at);
      even = even && same(of_one(op, -x), at);
    }
    if (nan && !operation_has(op, PARTIAL)) fail_msg("%s makes NaN", operations[op].name);
    if (operations[op].arity != 1 || operation_has(op, LOGICAL)) continue;
    if (odd && !operation_has(op, ODD)) fail_msg("%s is odd", operations[op].name);
    if (even && !operation_has(op, EVEN)) fail_msg("%s is even", operations[op].name);
    if (of_one(op, 0) == 0) assert_true(operation_has(op, VANISHES));
  }
}

static void costs_are_given(void **unused) {
  (void)unused;
  for (ir_op op = FIRST; op <= LAST; op++) {
    const operation *o = &operations[op];
    assert_true(o->weight > 0 && o->price.latency > 0 && o->price.operations > 0);
    assert_true(o->price.latency >= o->price.divisions);
    assert_true(o->count != COUNT_DIVISION || o->price.divisions > 0);
  }
}

/* A law calls an operation by its name, with as many arguments as it has operands; of the larger
   and the smaller, of any number. */
static void functions_find_their_operation(void **unused) {
  (void)unused;
  int found = 0;
  for (ir_op op = 0; op < IR_OP_COUNT; op++)
    if (operations[op].arity > 0) assert_int_equal(operation_named(operations[op].name), op);
  assert_int_equal(operation_named("none"), IR_OP_COUNT);
  for (int f = 0; f < FUNCTION_COUNT; f++) {
    const ir_op op = operation_named(builtin_functions[f].name);
    if (op == IR_OP_COUNT) continue;
    assert_in_range(op, FIRST, LAST);
    assert_false(operation_has(op, LOGICAL));
    assert_true(op == IR_MIN || op == IR_MAX ||
                (builtin_functions[f].least == operations[op].arity &&
                 builtin_functions[f].most == operations[op].arity));
    found++;
  }
  assert_true(found >= 13);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rows_are_true),
      cmocka_unit_test(rows_are_complete),
      cmocka_unit_test(costs_are_given),
      cmocka_unit_test(functions_find_their_operation),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
