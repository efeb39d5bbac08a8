/* Eigenvalues and vectors of symmetric matrices: A V = V diag, V orthogonal, known values. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "runtime/base/eigen.h"
#include "runtime/base/random_number.h"

typedef double matrix[EIGEN_MOST][EIGEN_MOST];

/* Entries between -1 and 1; of the chosen rank where that is less than the order. */
static void draw_matrix(int order, int rank, uint64_t seed, matrix a) {
  double factor[EIGEN_MOST][EIGEN_MOST];
  for (int m = 0; m < EIGEN_MOST; m++)
    for (int p = 0; p < EIGEN_MOST; p++)
      factor[m][p] = 2 * random_unit(random_mix(seed++)) - 1;
  memset(a, 0, sizeof(matrix));
  for (int p = 0; p < order; p++)
    for (int q = 0; q < order; q++)
      for (int m = 0; m < rank; m++)
        a[p][q] += factor[m][p] * factor[m][q];
}

static double off_by(int order, matrix a, const double *values, matrix vectors) {
  double worst = 0;
  for (int m = 0; m < order; m++)
    for (int n = 0; n < order; n++) {
      double product = 0, mapped = 0;
      for (int p = 0; p < order; p++) {
        product += vectors[m][p] * vectors[n][p];
        mapped += a[n][p] * vectors[m][p];
      }
      worst = fmax(worst, fabs(product - (m == n)));
      worst = fmax(worst, fabs(mapped - values[m] * vectors[m][n]));
    }
  return worst;
}

static void vectors_are_orthogonal_and_map_to_themselves(void **state) {
  (void)state;
  double worst = 0;
  for (uint64_t seed = 1; seed < 4000; seed++) {
    matrix a, copy, vectors;
    double values[EIGEN_MOST], trace = 0, sum = 0;
    const int order = 1 + (int)(seed % EIGEN_MOST), rank = 1 + (int)(seed / 7 % (uint64_t)order);
    draw_matrix(order, rank, 1000 * seed, a);
    memcpy(copy, a, sizeof a);
    eigen_symmetric(order, copy, values, vectors);
    worst = fmax(worst, off_by(order, a, values, vectors));
    for (int p = 0; p < order; p++) {
      trace += a[p][p];
      sum += values[p];
    }
    assert_true(fabs(sum - trace) < 20 * DBL_EPSILON * (1 + fabs(trace)));
  }
  print_message("largest error %.1e\n", worst);
  assert_true(worst < 1e-14);
}

static void zeros_stay_zeros(void **state) {
  (void)state;
  matrix a = {{0}}, vectors;
  double values[EIGEN_MOST];
  eigen_symmetric(EIGEN_MOST, a, values, vectors);
  for (int p = 0; p < EIGEN_MOST; p++)
    assert_true(values[p] == 0 && vectors[p][p] == 1);
}

/* 2 cos(k pi/7) for the matrix with ones beside the diagonal. */
static void values_of_a_chain(void **state) {
  (void)state;
  matrix a = {{0}}, vectors;
  double values[EIGEN_MOST];
  for (int p = 0; p + 1 < EIGEN_MOST; p++)
    a[p][p + 1] = a[p + 1][p] = 1;
  eigen_symmetric(EIGEN_MOST, a, values, vectors);
  for (int k = 1; k <= EIGEN_MOST; k++) {
    double nearest = INFINITY;
    for (int p = 0; p < EIGEN_MOST; p++)
      nearest = fmin(nearest, fabs(values[p] - 2 * cos(k * acos(-1) / 7)));
    assert_true(nearest < 10 * DBL_EPSILON);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(vectors_are_orthogonal_and_map_to_themselves),
      cmocka_unit_test(zeros_stay_zeros),
      cmocka_unit_test(values_of_a_chain),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
