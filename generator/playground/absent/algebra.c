/* LAPACK and CHOLMOD: small and plain where a page needs them (the stable step of a small beam),
   absent where it does not (static solutions, lowest modes). Arguments are LAPACK's,
   column-major. */
#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/cholesky.h"

/* --- eigenvalues: Jacobi's rotations -------------------------------------------------------------
   a[n][n], symmetric, becomes diagonal; the columns of v its eigenvectors. */

static void rotate(double *a, double *v, int n, int p, int q) {
  const double theta = (a[q * n + q] - a[p * n + p]) / (2 * a[p * n + q]);
  const double t = (theta >= 0 ? 1 : -1) / (fabs(theta) + sqrt(theta * theta + 1));
  const double c = 1 / sqrt(t * t + 1), s = t * c;
  for (int k = 0; k < n; k++) {
    const double x = a[k * n + p], y = a[k * n + q];
    a[k * n + p] = c * x - s * y;
    a[k * n + q] = s * x + c * y;
  }
  for (int k = 0; k < n; k++) {
    const double x = a[p * n + k], y = a[q * n + k];
    a[p * n + k] = c * x - s * y;
    a[q * n + k] = s * x + c * y;
  }
  for (int k = 0; k < n; k++) {
    const double x = v[k * n + p], y = v[k * n + q];
    v[k * n + p] = c * x - s * y;
    v[k * n + q] = s * x + c * y;
  }
}

static double beside_diagonal(const double *a, int n) {
  double sum = 0;
  for (int p = 0; p < n; p++)
    for (int q = 0; q < p; q++)
      sum += a[p * n + q] * a[p * n + q];
  return sum;
}

static double all_squares(const double *a, int n) {
  double sum = 0;
  for (int k = 0; k < n * n; k++)
    sum += a[k] * a[k];
  return sum;
}

static void diagonalise(double *a, double *v, int n) {
  enum { MOST_SWEEPS = 60 };
  const double least = 1e-32 * all_squares(a, n);
  memset(v, 0, (size_t)(n * n) * sizeof *v);
  for (int k = 0; k < n; k++)
    v[k * n + k] = 1;
  for (int sweep = 0; sweep < MOST_SWEEPS && beside_diagonal(a, n) > least; sweep++)
    for (int p = 0; p < n; p++)
      for (int q = p + 1; q < n; q++)
        if (a[p * n + q] != 0) rotate(a, v, n, p, q);
}

/* order[n]: columns by ascending eigenvalue. */
static void sort_columns(const double *a, int n, int *order) {
  for (int k = 0; k < n; k++) {
    int at = k;
    for (; at > 0 && a[order[at - 1] * n + order[at - 1]] > a[k * n + k]; at--)
      order[at] = order[at - 1];
    order[at] = k;
  }
}

void dstev_(const char *job, const int *n, double *diagonal, double *beside, double *vectors,
            const int *lead, double *work, int *info, size_t job_length);

void dstev_(const char *job, const int *n, double *diagonal, double *beside, double *vectors,
            const int *lead, double *work, int *info, size_t job_length) {
  const int m = *n;
  double *a = must_calloc((size_t)(m * m), sizeof *a), *v = must_calloc((size_t)(m * m), sizeof *v);
  int *order = must_calloc((size_t)m, sizeof *order);
  (void)job, (void)work, (void)job_length;
  for (int k = 0; k < m; k++) {
    a[k * m + k] = diagonal[k];
    if (k + 1 < m) a[k * m + k + 1] = a[(k + 1) * m + k] = beside[k];
  }
  diagonalise(a, v, m);
  sort_columns(a, m, order);
  for (int c = 0; c < m; c++) {
    diagonal[c] = a[order[c] * m + order[c]];
    for (int r = 0; r < m; r++)
      vectors[c * *lead + r] = v[r * m + order[c]];
  }
  *info = 0;
  free(a);
  free(v);
  free(order);
}

/* A Hermitian X + iY as the symmetric (X -Y; Y X), which has each eigenvalue twice. */
void zheev_(const char *job, const char *triangle, const int *n, double complex *a, const int *lead,
            double *values, double complex *work, const int *size, double *real_work, int *info,
            size_t job_length, size_t triangle_length);

void zheev_(const char *job, const char *triangle, const int *n, double complex *a, const int *lead,
            double *values, double complex *work, const int *size, double *real_work, int *info,
            size_t job_length, size_t triangle_length) {
  const int m = *n, twice = 2 * m;
  double *b = must_calloc((size_t)(twice * twice), sizeof *b),
         *v = must_calloc((size_t)(twice * twice), sizeof *v);
  int *order = must_calloc((size_t)twice, sizeof *order);
  (void)job, (void)work, (void)size, (void)real_work, (void)job_length, (void)triangle_length;
  for (int r = 0; r < m; r++)
    for (int c = 0; c < m; c++) {
      const bool given = *triangle == 'U' ? r <= c : r >= c;
      const double complex z = given ? a[c * *lead + r] : conj(a[r * *lead + c]);
      const double x = creal(z), y = r == c ? 0 : cimag(z);
      b[r * twice + c] = b[(r + m) * twice + c + m] = x;
      b[(r + m) * twice + c] = y;
      b[r * twice + c + m] = -y;
    }
  diagonalise(b, v, twice);
  sort_columns(b, twice, order);
  for (int c = 0; c < m; c++) {
    const int of = order[2 * c];
    values[c] = b[of * twice + of];
    for (int r = 0; r < m; r++)
      a[c * *lead + r] = v[r * twice + of] + I * v[(r + m) * twice + of];
  }
  *info = 0;
  free(b);
  free(v);
  free(order);
}

/* --- linear equations ------------------------------------------------------------------------- */

static int largest_in_column(const double *a, int n, int lead, int column) {
  int at = column;
  for (int r = column + 1; r < n; r++)
    if (fabs(a[column * lead + r]) > fabs(a[column * lead + at])) at = r;
  return at;
}

static void exchange(double *x, double *y) {
  const double kept = *x;
  *x = *y;
  *y = kept;
}

void dgesv_(const int *n, const int *columns, double *a, const int *lead, int *pivot, double *b,
            const int *lead_b, int *info);

void dgesv_(const int *n, const int *columns, double *a, const int *lead, int *pivot, double *b,
            const int *lead_b, int *info) {
  const int m = *n, l = *lead;
  *info = 0;
  for (int k = 0; k < m; k++) {
    const int at = largest_in_column(a, m, l, k);
    pivot[k] = at + 1;
    if (a[k * l + at] == 0) {
      *info = k + 1;
      return;
    }
    for (int c = 0; c < m && at != k; c++)
      exchange(&a[c * l + k], &a[c * l + at]);
    for (int c = 0; c < *columns && at != k; c++)
      exchange(&b[c * *lead_b + k], &b[c * *lead_b + at]);
    for (int r = k + 1; r < m; r++) {
      const double part = a[k * l + r] / a[k * l + k];
      for (int c = k; c < m; c++)
        a[c * l + r] -= part * a[c * l + k];
      for (int c = 0; c < *columns; c++)
        b[c * *lead_b + r] -= part * b[c * *lead_b + k];
    }
  }
  for (int c = 0; c < *columns; c++)
    for (int r = m - 1; r >= 0; r--) {
      double *x = &b[c * *lead_b];
      for (int k = r + 1; k < m; k++)
        x[r] -= a[k * l + r] * x[k];
      x[r] /= a[r * l + r];
    }
}

/* --- what is not here ------------------------------------------------------------------------- */

enum { NOT_HERE = 1 }; /* as of a matrix that is not positive */

void dpotrf_(const char *triangle, const int *n, double *a, const int *lead, int *info,
             size_t length);
void dpotri_(const char *triangle, const int *n, double *a, const int *lead, int *info,
             size_t length);
void dpbtrf_(const char *triangle, const int *n, const int *bands, double *ab, const int *lead,
             int *info, size_t length);
void dpbtrs_(const char *triangle, const int *n, const int *bands, const int *columns,
             const double *ab, const int *lead, double *b, const int *lead_b, int *info,
             size_t length);

void dpotrf_(const char *triangle, const int *n, double *a, const int *lead, int *info,
             size_t length) {
  (void)triangle, (void)n, (void)a, (void)lead, (void)length;
  *info = NOT_HERE;
}

void dpotri_(const char *triangle, const int *n, double *a, const int *lead, int *info,
             size_t length) {
  (void)triangle, (void)n, (void)a, (void)lead, (void)length;
  *info = NOT_HERE;
}

void dpbtrf_(const char *triangle, const int *n, const int *bands, double *ab, const int *lead,
             int *info, size_t length) {
  (void)triangle, (void)n, (void)bands, (void)ab, (void)lead, (void)length;
  *info = NOT_HERE;
}

void dpbtrs_(const char *triangle, const int *n, const int *bands, const int *columns,
             const double *ab, const int *lead, double *b, const int *lead_b, int *info,
             size_t length) {
  (void)triangle, (void)n, (void)bands, (void)columns, (void)ab, (void)lead, (void)b, (void)lead_b;
  (void)length;
  *info = NOT_HERE;
}

cholesky *cholesky_new(const sparse_upper *a) {
  (void)a;
  return NULL;
}

void cholesky_free(cholesky *f) {
  (void)f;
}

cholesky_end cholesky_factorise(cholesky *f, const sparse_upper *a, double shift) {
  (void)f, (void)a, (void)shift;
  return CHOLESKY_NO_MEMORY;
}

long cholesky_lost_row(const cholesky *f, const double *diagonal, double part) {
  (void)f, (void)diagonal, (void)part;
  return -1;
}

bool cholesky_solve(cholesky *f, const double *x, double *y) {
  (void)f, (void)x, (void)y;
  return false;
}
