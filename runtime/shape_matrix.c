#include "runtime/shape_matrix.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"

/* LAPACK: eigenvalues and vectors of a symmetric matrix. The last two arguments are the hidden text
 * lengths. */
void dsyev_(const char *job, const char *triangle, const int *n, double *a, const int *lda,
            double *values, double *work, const int *work_size, int *info, size_t job_length,
            size_t triangle_length);

#define SMALLEST 1e-9 /* of the largest eigenvalue */

enum { MOST_ORDER = 6, MOST_VALUES = PL_SHAPE_VALUES(3), PLACES = 4096 };

/* Families differ in the bonds they have, and most of them are alike. */
typedef struct known_family {
  bool known;
  uint64_t own, incoming; /* bit k: the bond in direction k, the bond from there */
  double matrix[MOST_VALUES];
} known_family;

/* n of a bond; returns how many there are. */
static int products(const rows *w, int direction, double n[MOST_ORDER]) {
  const double *c = w->chord[direction], s = w->length[direction];
  const double e[3] = {c[0] / s, c[1] / s, c[2] / s};
  int count = 0;
  for (int a = 0; a < w->dimensions; a++)
    n[count++] = e[a] * e[a];
  n[count++] = e[0] * e[1];
  if (w->dimensions == 2) return count;
  n[count++] = e[1] * e[2];
  n[count++] = e[0] * e[2];
  return count;
}

/* Least squares with the smallest tensor, sum of e_ab^2, so that the axes do not matter: shear, which counts twice in
   that, is scaled by the root of 2. */
static void invert(int dimensions, int order, double *sum) {
  double scale[MOST_ORDER], a[MOST_ORDER * MOST_ORDER], values[MOST_ORDER], work[16 * MOST_ORDER];
  const int size = 16 * MOST_ORDER;
  int info = 0, at = 0;
  for (int p = 0; p < order; p++)
    scale[p] = p < dimensions ? 1 : sqrt(2);
  for (int p = 0; p < order; p++)
    for (int q = p; q < order; q++)
      a[q * order + p] = scale[p] * scale[q] * sum[at++];
  dsyev_("V", "U", &order, a, &order, values, work, &size, &info, 1, 1);
  assert(info == 0);
  at = 0;
  for (int p = 0; p < order; p++)
    for (int q = p; q < order; q++) {
      double value = 0;
      for (int m = 0; m < order; m++)
        if (values[m] > SMALLEST * values[order - 1])
          value += a[m * order + p] * a[m * order + q] / values[m];
      sum[at++] = scale[p] * scale[q] * value;
    }
}

static void find_matrix(const rows *w, known_family *f) {
  int order = 0;
  memset(f->matrix, 0, sizeof f->matrix);
  for (int k = 0; k < w->directions; k++) {
    const int bonds = (int)(f->own >> k & 1) + (int)(f->incoming >> k & 1); /* n n^T is even */
    double n[MOST_ORDER];
    int at = 0;
    order = products(w, k, n);
    for (int a = 0; a < order; a++)
      for (int b = a; b < order; b++)
        f->matrix[at++] += bonds * n[a] * n[b];
  }
  invert(w->dimensions, order, f->matrix);
}

static const double *matrix_at(const rows *w, known_family *known, long site) {
  const uint64_t own = w->bonds[site];
  uint64_t incoming = 0;
  for (int k = 0; k < w->directions; k++)
    incoming |= w->bonds[rows_partner(w, site, w->directions + k)] & (UINT64_C(1) << k);
  const uint64_t mixed =
      own * UINT64_C(0x9e3779b97f4a7c15) ^ incoming * UINT64_C(0xc2b2ae3d27d4eb4f);
  known_family *f = &known[(mixed >> 32) % PLACES];
  if (f->known && f->own == own && f->incoming == incoming) return f->matrix;
  *f = (known_family){.known = true, .own = own, .incoming = incoming};
  find_matrix(w, f);
  return f->matrix;
}

void shape_matrices(const rows *w, double *const *matrix) {
  const int values = PL_SHAPE_VALUES(w->dimensions);
  known_family *known = must_calloc(PLACES, sizeof *known);
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    const double *here = matrix_at(w, known, site);
    for (int v = 0; v < values; v++)
      matrix[v][site] = here[v];
  }
  free(known);
}

void shape_matrix_full(const rows *w, double *values) {
  known_family f = {.own = UINT64_MAX, .incoming = UINT64_MAX};
  find_matrix(w, &f);
  memcpy(values, f.matrix, (size_t)PL_SHAPE_VALUES(w->dimensions) * sizeof *values);
}
