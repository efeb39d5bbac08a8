#include "runtime/lattice/shape_matrix.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/base/eigen.h"

/* Of the largest eigenvalue: smaller ones count as 0. Families of lattices lack a strain or have it
   well; on lists there is all between, and where a strain is hardly seen its fit is noise. */
#define SMALLEST         1e-9
#define SMALLEST_ON_LIST 1e-3
#define RESOLVED         1e-3

enum { MOST_ORDER = EIGEN_MOST, MOST_PLANES = PL_SHAPE_PLANES(3), PLACES = 4096 };

/* Families differ in the bonds they have, and most of them are alike. */
typedef struct known_family {
  bool known;
  uint64_t own, incoming; /* bit k: the bond in direction k, the bond from there */
  double matrix[MOST_PLANES];
} known_family;

/* n of a bond of this chord and length; returns how many there are. */
static int products(const rows *w, const double c[3], double s, double n[MOST_ORDER]) {
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

/* Least squares with the smallest tensor, sum of e_ab^2, so that the axes do not matter: shear,
   which counts twice in that, is scaled by the root of 2. Behind the matrix stands whether the
   bonds resolve all strains. */
static void invert(int dimensions, int order, double smallest, double *sum) {
  double scale[MOST_ORDER], a[MOST_ORDER][MOST_ORDER], values[MOST_ORDER],
      vectors[MOST_ORDER][MOST_ORDER];
  double least = INFINITY, most = 0;
  int at = 0;
  for (int p = 0; p < order; p++)
    scale[p] = p < dimensions ? 1 : sqrt(2);
  for (int p = 0; p < order; p++)
    for (int q = p; q < order; q++)
      a[p][q] = a[q][p] = scale[p] * scale[q] * sum[at++];
  eigen_symmetric(order, a, values, vectors);
  for (int m = 0; m < order; m++) {
    least = values[m] < least ? values[m] : least;
    most = values[m] > most ? values[m] : most;
  }
  at = 0;
  for (int p = 0; p < order; p++)
    for (int q = p; q < order; q++) {
      double value = 0;
      for (int m = 0; m < order; m++)
        if (values[m] > smallest * most) value += vectors[m][p] * vectors[m][q] / values[m];
      sum[at++] = scale[p] * scale[q] * value;
    }
  sum[at] = most > 0 && least >= RESOLVED * most;
}

static void add_products(const double *n, int order, double weight, double *sum) {
  for (int a = 0; a < order; a++)
    for (int b = a; b < order; b++)
      *sum++ += weight * n[a] * n[b];
}

static void find_matrix(const rows *w, known_family *f) {
  int order = 0;
  memset(f->matrix, 0, sizeof f->matrix);
  for (int k = 0; k < w->directions; k++) {
    const int bonds = (int)(f->own >> k & 1) + (int)(f->incoming >> k & 1); /* n n^T is even */
    double n[MOST_ORDER];
    order = products(w, w->chord[k], w->length[k], n);
    add_products(n, order, bonds, f->matrix);
  }
  invert(w->dimensions, order, SMALLEST, f->matrix);
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

/* Of a particle of a list, whose family has no like. */
static void list_matrix(const rows *w, long site, double *matrix) {
  const int order = w->dimensions == 2 ? 3 : 6;
  memset(matrix, 0, MOST_PLANES * sizeof *matrix);
  for (int k = 0; k < 2 * w->directions; k++) {
    double chord[3], n[MOST_ORDER];
    if (!rows_has_neighbour(w, site, k)) continue;
    const double length = rows_chord(w, site, k, chord);
    products(w, chord, length, n);
    add_products(n, order, length, matrix);
  }
  invert(w->dimensions, order, SMALLEST_ON_LIST, matrix);
}

static void list_matrices(const rows *w, double *const *matrix) {
  double here[MOST_PLANES];
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    list_matrix(w, site, here);
    for (int v = 0; v < PL_SHAPE_PLANES(w->dimensions); v++)
      matrix[v][site] = here[v];
  }
}

void shape_matrices(const rows *w, double *const *matrix) {
  const int values = PL_SHAPE_PLANES(w->dimensions);
  if (w->list) {
    list_matrices(w, matrix);
    return;
  }
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
  memcpy(values, f.matrix, (size_t)PL_SHAPE_PLANES(w->dimensions) * sizeof *values);
}

long shape_unresolved(const rows *w, int32_t *resolved) {
  double here[MOST_PLANES];
  long count = 0;
  for (long p = 0; p < w->particle_count; p++) {
    list_matrix(w, w->particle_site[p], here);
    const bool all = here[PL_SHAPE_VALUES(w->dimensions)] > 0;
    if (resolved) resolved[p] = all;
    count += !all;
  }
  return count;
}
