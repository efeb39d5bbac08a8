/* Ranges: their arithmetic against what a few thousand numbers in them give, and the warnings of
 * whole laws. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "dsl/semantics/law_check.h"
#include "dsl/syntax/parse.h"
#include "generator/intervals/interval_check.h"
#include "generator/ir/interpret.h"
#include "generator/ir/interval.h"
#include "generator/ir/random_values.h"

/* --- arithmetic -------------------------------------------------------------------------- */

static range draw_range(uint64_t *seed) {
  double a = draw_size(seed, -2, 1), b = draw_size(seed, -2, 1);
  bool low_open = draw_bits(seed) % 2, high_open = draw_bits(seed) % 2;
  if (a == b) low_open = high_open = false;
  return range_between(fmin(a, b), fmax(a, b), low_open, high_open);
}

/* Inside, and on the ends that belong to it. */
static double draw_in(uint64_t *seed, range r) {
  uint64_t choice = draw_bits(seed) % 6;
  if (choice == 0 && !r.low_open) return r.low;
  if (choice == 1 && !r.high_open) return r.high;
  if (choice == 2 && range_holds(r, 0)) return 0;
  return r.low + (r.high - r.low) * draw_uniform(seed, 0.001, 0.999);
}

static range result_range(ir_op op, range a, range b) {
  switch (op) {
  case IR_ADD:
    return range_add(a, b);
  case IR_SUB:
    return range_add(a, range_neg(b));
  case IR_MUL:
    return range_mul(a, b);
  case IR_DIV:
    return range_div(a, b);
  default:
    return range_apply(op, a, b);
  }
}

/* Every value of an operation lies in the range that is said to hold it. */
static void ranges_hold_all_values(void **state) {
  (void)state;
  uint64_t seed = 5;
  for (ir_op op = IR_ADD; op <= IR_SELECT; op++)
    for (int round = 0; round < 2000; round++) {
      range a = draw_range(&seed), b = draw_range(&seed), r = result_range(op, a, b);
      for (int q = 0; q < 8; q++) {
        double x = draw_in(&seed, a), y = draw_in(&seed, b), z = operation_value(op, x, y, 0);
        if (!isfinite(z)) continue;
        double slack = 1e-14 * fmax(1, fabs(z));
        if (!range_holds(r, z) && !range_holds(r, z - slack) && !range_holds(r, z + slack))
          fail_msg("%s of %.17g and %.17g is %.17g, not in [%g, %g]", ir_op_name(op), x, y, z,
                   r.low, r.high);
      }
    }
}

/* Open ends stay open: what is positive stays so. */
static void open_ends_are_kept(void **state) {
  (void)state;
  range positive = range_between(0, INFINITY, true, true),
        above_one = range_between(1, INFINITY, true, true);
  assert_true(range_is_positive(range_mul(positive, positive)));
  assert_true(range_is_positive(range_div(positive, positive)));
  assert_true(range_is_positive(range_add(positive, positive)));
  assert_true(range_is_positive(range_add(above_one, range_of(-1))));
  assert_true(range_is_positive(range_apply(IR_EXP, range_all(), range_all())));
  assert_true(range_is_positive(range_apply(IR_MAX, range_all(), positive)));
  assert_false(range_is_positive(range_mul(positive, range_between(0, 1, false, false))));
  assert_true(range_is_nonnegative(range_square(range_all())));
  assert_false(range_holds(range_between(0, 1, true, false), 0));
  assert_true(range_holds(range_between(0, 1, true, false), 1));
  assert_false(range_holds(positive, INFINITY));
  range below_one = range_between(0, 1, false, true), to_three = range_between(2, 3, false, false);
  assert_false(range_holds(range_mul(below_one, to_three), 3));
  assert_true(range_holds(range_mul(to_three, to_three), 9));
}

/* Of a base that may be below 1 the largest exponent gives the least power. */
static void powers_of_any_base_are_held(void **state) {
  (void)state;
  const range base = range_between(0.5, INFINITY, false, true),
              exponent = range_between(1, 2, false, false);
  assert_true(range_holds(range_apply(IR_POW, base, exponent), 0.25));
}

/* --- laws -------------------------------------------------------------------------------- */

/* Codes of the warnings of a law with these lines, and the first note (size 512). */
static int warnings_of(const char *lines, diag_code *code, int *line, char *note) {
  char text[4096];
  snprintf(text, sizeof text,
           "model tried\n  law micropolar bond\n  parameter k = 5 [MN] in (0, inf)\n%s"
           "  moment M_i = k*s*theta_i\n  moment M_j = k*s*theta_j\nend model\n",
           lines);
  source_set sources = {0};
  diagnostics d;
  diag_begin(&d, &sources);
  arena *memory = arena_new();
  int file = source_add(&sources, "law.plm", text, strlen(text));
  tree *t = parse_model(memory, &sources, file, NULL, &d);
  law *l = t ? law_check(memory, t, &sources, NULL, 0, &d) : NULL;
  if (!l) {
    diag_print(&d, stderr);
    fail_msg("not a law:\n%s", text);
  }
  int before = d.count;
  interval_check(l, &d);
  int count = d.count - before;
  if (count) {
    *code = d.items[before].code;
    *line = source_place(&sources, d.items[before].where.file, d.items[before].where.begin).line;
    snprintf(note, 512, "%s", d.items[before].note ? d.items[before].note : "");
  }
  diag_clear(&d);
  source_clear(&sources);
  arena_free(memory);
  return count;
}

static void expect_quiet(const char *lines) {
  diag_code code;
  int line;
  char note[512];
  if (warnings_of(lines, &code, &line, note))
    fail_msg("%s in line %d (%s):\n%s", diag_name(code), line, note, lines);
}

/* One warning of this code on line `wanted`, with a state that holds `shows`. */
static void expect(const char *lines, diag_code wanted, int wanted_line, const char *shows) {
  diag_code code;
  int line;
  char note[512];
  int count = warnings_of(lines, &code, &line, note);
  if (count != 1) fail_msg("%d warnings:\n%s", count, lines);
  assert_int_equal(code, wanted);
  assert_int_equal(line, wanted_line);
  if (strncmp(note, "found at", 8) != 0 || !strstr(note, shows))
    fail_msg("`%s` does not show `%s`", note, shows);
}

static void guards_keep_values_in_range(void **state) {
  (void)state;
  expect_quiet("  force N = | 0*k when stretch <= 0\n            | k/stretch otherwise\n");
  expect_quiet(
      "  a = abs(stretch)\n  force N = | 0*k when a == 0\n            | k*stretch/a otherwise\n");
  expect_quiet("  force N = | k*log(stretch) when stretch > 0 and stretch < 1\n            | 0*k "
               "otherwise\n");
  expect_quiet("  force N = | 0*k when stretch <= 0 or stretch_rate <= 0 [1/s]\n"
               "            | k*log(stretch)*(1 [1/s]/stretch_rate) otherwise\n");
  expect_quiet(
      "  force N = | 0*k when not stretch > 0.1\n            | k*sqrt(stretch - 0.1) otherwise\n");
  expect_quiet(
      "  p = abs(stretch)\n  q = norm(theta_i)\n"
      "  force N = | 0*k when p + q >= 2\n            | k*stretch/(2 - p - q) otherwise\n");
  expect_quiet("  y = norm(theta_i)\n  force N = | k*stretch when y <= 0.1\n            | "
               "k*stretch*sqrt(1 - 0.1/y) otherwise\n");
  expect_quiet("  parameter c = 0.1 in (0, 1)\n  force N = | k*stretch*sqrt(1 - (stretch/c)**2) "
               "when abs(stretch) < c\n"
               "            | 0*k otherwise\n");
  /* the negation of the lines above */
  expect_quiet(
      "  force N = | 0*k when stretch <= 0\n            | k*log(stretch) when stretch < 0.5\n"
      "            | k/(stretch - 0.4) otherwise\n");
}

static void bounds_keep_values_in_range(void **state) {
  (void)state;
  expect_quiet("  parameter a = 2 in (1, inf)\n  parameter b = 3 in (a, inf)\n  force N = "
               "k*stretch/((a - 1)*(b - a))\n");
  expect_quiet(
      "  parameter a = 2 in (1, b)\n  parameter b = 3\n  force N = k*stretch*sqrt(b - a)\n");
  expect_quiet("  parameter a = 2 in (1, 5)\n  parameter b = -3 in (-inf, 0)\n  force N = "
               "k*stretch/(a*b - b)\n");
  expect_quiet(
      "  parameter a = 2 in (0, 5)\n  w = max(a, 1.001*a)\n  force N = k*stretch/(w - a/2)\n");
  expect_quiet(
      "  parameter nu = 0.2 in [0, 1/3]\n  force N = k*stretch*sqrt((1 - 3*nu)/(1 - nu**2))\n");
  expect_quiet("  force N = k*stretch/(1 + stretch)\n"); /* a bond has a length */
  expect_quiet("  force N = k*log(length/s)\n");
  expect_quiet("  force N = k*stretch/sqrt(1 + stretch**2 + norm(theta_i)**2)\n");
  expect_quiet("  damage d = | 0 when stretch <= 0.1 | 1 - 0.1/stretch otherwise\n  force N = "
               "k*stretch*sqrt(1 - d)\n");
  expect_quiet("  force N = k*stretch/(1 + abs(stretch_rate/1 [1/s]))\n");
  expect_quiet("  force N = k*(acos(min(1 + stretch, 1)) + asin(tanh(stretch)))\n");
  expect_quiet("  force N = k*asin((| -1 when stretch < -1/2 | 2*stretch when stretch < 1/2"
               " | 1 otherwise))\n");
  /* cosh >= 1; acos from 0 to pi, asin from -pi/2 to pi/2 */
  expect_quiet("  a = max(min(stretch, 1), -1)\n  force N = k*stretch*sqrt(cosh(stretch) - 1)*"
               "sqrt(acos(a))*sqrt(1.6 - asin(a))*log10(1 + cosh(stretch))\n");
}

static void what_may_be_undefined_is_shown(void **state) {
  (void)state;
  expect("  force N = k*(1 - 0.1/stretch)\n", DIAG_DIVISION_BY_ZERO, 4, "stretch = 0");
  expect("  force N = k*stretch/(stretch - 0.5)\n", DIAG_DIVISION_BY_ZERO, 4, "stretch = 0.5");
  expect("  force N = k*stretch*sqrt(1 + 2*stretch)\n", DIAG_DOMAIN, 4, "stretch = -0.");
  expect("  force N = k*log(1.5 + 2*stretch)\n", DIAG_DOMAIN, 4, "stretch = -0.");
  expect("  force N = k*log10(1.5 + 2*stretch)\n", DIAG_DOMAIN, 4, "stretch = -0.");
  expect("  force N = k*(acos(1.5 + stretch) - 2)\n", DIAG_DOMAIN, 4, "stretch = ");
  expect("  force N = k*asin(2*stretch - 1.2)\n", DIAG_DOMAIN, 4, "stretch = ");
  expect("  force N = k*stretch*(stretch + 0.2)**0.7\n", DIAG_DOMAIN, 4, "stretch = -0.");
  expect("  parameter nu = 0.2 in [0, 1]\n  force N = k*stretch/(1 - nu**2)\n",
         DIAG_DIVISION_BY_ZERO, 5, "nu = 1");
  expect("  parameter a = 2 in [1, inf)\n  parameter b = 3 in [a, inf)\n  force N = k*stretch/(b - "
         "a)\n",
         DIAG_DIVISION_BY_ZERO, 6, "");
  /* `<` instead of `<=` lets the zero through */
  expect("  force N = | 0*k when stretch < 0\n            | k*0.1/stretch otherwise\n",
         DIAG_DIVISION_BY_ZERO, 5, "stretch = 0");
}

/* Found deep inside functions, and once however often they are called. */
static void functions_are_looked_into(void **state) {
  (void)state;
  expect("  function share(p) = 1/p\n  force N = k*(share(stretch) + share(stretch))\n",
         DIAG_DIVISION_BY_ZERO, 4, "stretch = 0");
}

/* Sums that unfold without end, and choices within choices, are given up in time and without a
 * false word. */
static void large_laws_end(void **state) {
  (void)state;
  static char text[4000];
  int n = 0;
  n += snprintf(text, sizeof text, "  x0 = stretch + 2\n");
  for (int k = 1; k < 40; k++)
    n += snprintf(text + n, sizeof text - (size_t)n, "  x%d = x%d*x%d + x%d\n", k, k - 1, k - 1,
                  k - 1);
  snprintf(text + n, sizeof text - (size_t)n, "  force N = k*stretch/x39\n");
  expect_quiet(text);
  n = snprintf(text, sizeof text, "  x0 = stretch\n");
  for (int k = 1; k < 25; k++)
    n += snprintf(text + n, sizeof text - (size_t)n,
                  "  x%d = | x%d + 1 when x%d <= %d | x%d - 0.5 otherwise\n", k, k - 1, k - 1, k,
                  k - 1);
  snprintf(text + n, sizeof text - (size_t)n, "  force N = k*stretch/(1 + x24**2)\n");
  expect_quiet(text);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(ranges_hold_all_values),
      cmocka_unit_test(open_ends_are_kept),
      cmocka_unit_test(powers_of_any_base_are_held),
      cmocka_unit_test(guards_keep_values_in_range),
      cmocka_unit_test(bounds_keep_values_in_range),
      cmocka_unit_test(what_may_be_undefined_is_shown),
      cmocka_unit_test(functions_are_looked_into),
      cmocka_unit_test(large_laws_end),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
