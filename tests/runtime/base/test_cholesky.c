/* Factors of sparse matrices whose inverses are known, and of such as have none. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "runtime/base/cholesky.h"

enum { MOST = 200, ENTRIES = MOST * (MOST + 1) / 2 };

typedef struct case_matrix {
  sparse_upper of;
  int64_t count;
  int64_t begin[MOST + 1], row[ENTRIES];
  double value[ENTRIES], diagonal[MOST];
} case_matrix;

static case_matrix a;

static void begin(long order) {
  a.of = (sparse_upper){order, a.begin, a.row, a.value};
  a.count = 0;
}

/* Columns in their order, rows in theirs; the diagonal ends a column. */
static void add(long row, long column, double value) {
  a.row[a.count] = row;
  a.value[a.count++] = value;
  if (row < column) return;
  a.diagonal[column] = value;
  a.begin[column + 1] = a.count;
}

/* The second difference: 2 and -1 beside it. */
static void open_chain(long order) {
  begin(order);
  for (long k = 0; k < order; k++) {
    if (k > 0) add(k - 1, k, -1);
    add(k, k, 2);
  }
}

/* 1 + e e^T, e = 1: dense. Row `copy` is that of `of`, but for `more` on its diagonal; -1: none. */
static void open_dense(long order, long of, long copy, double more) {
  begin(order);
  for (long k = 0; k < order; k++)
    for (long j = 0; j <= k; j++)
      add(j, k, 1 + (j == k) + (k == copy && j == of) + (k == copy && j == k ? more : 0));
}

static void assert_near(double x, double y, double most) {
  if (!(fabs(x - y) <= most)) fail_msg("%.17g is not %.17g", x, y);
}

static cholesky *factors(double shift, cholesky_end end) {
  cholesky *f = cholesky_new(&a.of);
  assert_non_null(f);
  assert_int_equal(cholesky_factorise(f, &a.of, shift), end);
  return f;
}

/* A load of 1 bends a chain to a parabola. */
static void a_chain_is_a_parabola(void **state) {
  (void)state;
  double x[MOST];
  open_chain(MOST);
  cholesky *f = factors(0, CHOLESKY_DONE);
  assert_int_equal(cholesky_lost_row(f, a.diagonal, 1e-12), -1);
  for (int twice = 0; twice < 2; twice++) {
    for (int k = 0; k < MOST; k++)
      x[k] = 1 + twice;
    assert_true(cholesky_solve(f, x, x));
    for (int k = 0; k < MOST; k++)
      assert_near(x[k], (1 + twice) * 0.5 * (k + 1) * (MOST - k), 1e-9);
  }
  cholesky_free(f);
}

/* Its modes are sines, and a shift is added to their eigenvalues. */
static void a_shift_adds_to_eigenvalues(void **state) {
  (void)state;
  const double part = 3.14159265358979323846 / (MOST + 1), lambda = 4 * pow(sin(0.5 * part), 2);
  const double shifts[] = {0, 0.3, 1e-3};
  double x[MOST], y[MOST];
  open_chain(MOST);
  cholesky *f = cholesky_new(&a.of);
  for (int n = 0; n < 3; n++) {
    assert_int_equal(cholesky_factorise(f, &a.of, shifts[n]), CHOLESKY_DONE);
    for (int k = 0; k < MOST; k++)
      x[k] = sin(part * (k + 1));
    assert_true(cholesky_solve(f, x, y));
    for (int k = 0; k < MOST; k++)
      assert_near(y[k] * (lambda + shifts[n]), x[k], 1e-11);
  }
  cholesky_free(f);
}

/* (1 + e e^T)^-1 b = b - e (e b)/(n + 1); the larger one is factorised by blocks of columns. */
static void dense_matrices_are_solved(void **state) {
  (void)state;
  for (int order = 8; order <= MOST; order += MOST - 8) {
    double x[MOST], sum = 0;
    open_dense(order, -1, -1, 0);
    cholesky *f = factors(0, CHOLESKY_DONE);
    assert_int_equal(cholesky_lost_row(f, a.diagonal, 1e-12), -1);
    for (int k = 0; k < order; k++)
      sum += x[k] = cos(k);
    assert_true(cholesky_solve(f, x, x));
    for (int k = 0; k < order; k++)
      assert_near(x[k], cos(k) - sum / (order + 1), 1e-13);
    cholesky_free(f);
  }
}

/* Of two rows that are as good as one, that which comes later has no pivot left. */
static void lost_pivots_are_found(void **state) {
  (void)state;
  for (int order = 8; order <= MOST; order += MOST - 8) {
    open_dense(order, 3, 6, 1e-9);
    cholesky *f = factors(0, CHOLESKY_DONE);
    const long lost = cholesky_lost_row(f, a.diagonal, 1e-8);
    assert_true(lost == 3 || lost == 6);
    assert_int_equal(cholesky_lost_row(f, a.diagonal, 1e-12), -1);
    cholesky_free(f);
  }
}

static void negative_rows_are_found(void **state) {
  (void)state;
  for (int order = 8; order <= MOST; order += MOST - 8) {
    open_dense(order, 3, 6, -0.5);
    cholesky *f = factors(0, CHOLESKY_NOT_POSITIVE);
    const long lost = cholesky_lost_row(f, a.diagonal, 1e-12);
    assert_true(lost == 3 || lost == 6);
    assert_int_equal(cholesky_factorise(f, &a.of, 1), CHOLESKY_DONE);
    assert_int_equal(cholesky_lost_row(f, a.diagonal, 1e-12), -1);
    cholesky_free(f);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_chain_is_a_parabola), cmocka_unit_test(a_shift_adds_to_eigenvalues),
      cmocka_unit_test(dense_matrices_are_solved), cmocka_unit_test(lost_pivots_are_found),
      cmocka_unit_test(negative_rows_are_found)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
