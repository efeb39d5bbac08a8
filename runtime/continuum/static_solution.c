#include "runtime/continuum/static_solution.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/continuum/node_factors.h"

/* LAPACK: factors of a symmetric positive band matrix, and a solution by them. The last argument is
   the hidden text length. */
void dpbtrf_(const char *triangle, const int *n, const int *bands, double *ab, const int *ldab,
             int *info, size_t triangle_length);
void dpbtrs_(const char *triangle, const int *n, const int *bands, const int *columns,
             const double *ab, const int *ldab, double *b, const int *ldb, int *info,
             size_t triangle_length);

/* Freedoms are numbered along the mesh's shorter side, so that the band is narrow. */
typedef struct band {
  const node_stencil *k;
  bool by_columns;
  int n, bands, rows; /* freedoms; below the diagonal; bands + 1 */
  double *matrix;     /* [n][rows], lower */
} band;

static int freedom(const band *b, int node, int axis) {
  const int nx = b->k->layout.nodes[0], ny = b->k->layout.nodes[1];
  const int number = b->by_columns ? node % nx * ny + node / nx : node;
  return 2 * number + axis;
}

static int node_of(const band *b, int freedom) {
  const int nx = b->k->layout.nodes[0], ny = b->k->layout.nodes[1], number = freedom / 2;
  return b->by_columns ? number % ny * nx + number / ny : number;
}

/* A node that nothing holds: no cell has it. */
static bool is_alone(const node_stencil *k, int node) {
  return node_stencil_entry(k, node, node, 0, 0) == 0 &&
         node_stencil_entry(k, node, node, 1, 1) == 0;
}

typedef void pair_visitor(band *b, int node, int other, void *context);
static void visit_pairs(band *b, pair_visitor *visit, void *context) {
  const node_layout *l = &b->k->layout;
  for (int node = 0; node < l->nodes[0] * l->nodes[1]; node++)
    for (int dj = -b->k->reach; dj <= b->k->reach; dj++)
      for (int di = -b->k->reach; di <= b->k->reach; di++) {
        const int i = node % l->nodes[0] + di, j = node / l->nodes[0] + dj;
        if (i >= 0 && j >= 0 && i < l->nodes[0] && j < l->nodes[1])
          visit(b, node, j * l->nodes[0] + i, context);
      }
}

static void fill(band *b, int node, int other, void *context) {
  const unsigned char *fixed = context;
  for (int d = 0; d < 2; d++)
    for (int e = 0; e < 2; e++) {
      const int row = freedom(b, node, d), column = freedom(b, other, e);
      if (fixed[2 * node + d] || fixed[2 * other + e] || row < column) continue;
      b->matrix[(size_t)column * (size_t)b->rows + (size_t)(row - column)] =
          node_stencil_entry(b->k, node, other, d, e);
    }
}

/* What is solved: the stiffness of a grid, or of lists. */
typedef struct stiffness {
  const node_stencil *stencil; /* or NULL, and */
  const node_matrix *matrix;
} stiffness;

static const node_layout *layout_of(const stiffness *k) {
  return k->matrix ? &k->matrix->layout : &k->stencil->layout;
}

static int node_count(const stiffness *k) {
  return layout_of(k)->nodes[0] * layout_of(k)->nodes[1];
}

static void multiply(const stiffness *k, const double *const u[2], double *const product[2]) {
  const node_layout *l = layout_of(k);
  pool *memory = pool_new();
  double *in[2], *out[2];
  for (int d = 0; d < 2; d++) {
    in[d] = pool_doubles(memory, l->size);
    out[d] = pool_doubles(memory, l->size);
    for (int n = 0; n < node_count(k); n++)
      in[d][node_layout_at(l, n)] = u[d][n];
  }
  if (k->matrix)
    node_matrix_multiply(k->matrix, (const double *const *)in, out, 0, l->nodes[1]);
  else
    node_stencil_multiply(k->stencil, (const double *const *)in, out, 0, l->nodes[1]);
  for (int d = 0; d < 2; d++)
    for (int n = 0; n < node_count(k); n++)
      product[d][n] = out[d][node_layout_at(l, n)];
  pool_free(memory);
}

static void judge(const stiffness *k, const unsigned char *fixed, const double *const force[2],
                  double *const u[2], double *const reaction[2], static_result *r) {
  double most = 0, off = 0;
  multiply(k, (const double *const *)u, reaction);
  for (int d = 0; d < 2; d++)
    for (int n = 0; n < node_count(k); n++) {
      r->energy += 0.5 * u[d][n] * reaction[d][n];
      most = pl_max(most, pl_max(fabs(force[d][n]), fabs(reaction[d][n])));
      reaction[d][n] -= force[d][n];
      if (!fixed[2 * n + d]) off = pl_max(off, fabs(reaction[d][n]));
    }
  r->residual = most > 0 ? off / most : 0;
}

static bool factor(band *b, static_result *r) {
  int info = 0;
  dpbtrf_("L", &b->n, &b->bands, b->matrix, &b->rows, &info, 1);
  if (info <= 0) return info == 0;
  r->loose = node_of(b, info - 1);
  r->loose_axis = (info - 1) % 2;
  return false;
}

/* A pivot lost to rounding is no stiffness either. */
static bool stays_positive(const band *b, const double *diagonal, static_result *r) {
  for (int k = 0; k < b->n; k++) {
    const double pivot = b->matrix[(size_t)k * (size_t)b->rows];
    if (pivot * pivot > 1e-12 * diagonal[k]) continue;
    r->loose = node_of(b, k);
    r->loose_axis = k % 2;
    return false;
  }
  return true;
}

struct static_factors {
  stiffness of;
  band b;
  cholesky *sparse;            /* in its place, of a matrix */
  unsigned char *held, *fixed; /* [2 nodes]; fixed: held, or alone */
};

static band band_of(const node_stencil *k) {
  const node_layout *l = &k->layout;
  const int narrow = l->nodes[0] < l->nodes[1] ? 0 : 1;
  band b = {.k = k, .by_columns = narrow == 1, .n = 2 * l->nodes[0] * l->nodes[1]};
  b.bands = 2 * (k->reach * l->nodes[narrow] + k->reach) + 1;
  if (b.bands > b.n - 1) b.bands = b.n - 1;
  b.rows = b.bands + 1;
  b.matrix = must_calloc((size_t)b.n * (size_t)b.rows, sizeof *b.matrix);
  return b;
}

/* None is factorised yet. */
static static_factors *begin_factors(const stiffness *k, const unsigned char *held) {
  const size_t freedoms = 2 * (size_t)node_count(k);
  static_factors *f = must_calloc(1, sizeof *f);
  f->of = *k;
  f->held = must_alloc(freedoms);
  f->fixed = must_alloc(freedoms);
  memcpy(f->held, held, freedoms);
  memcpy(f->fixed, held, freedoms);
  return f;
}

static static_factors *kept_if(bool good, static_factors *f) {
  if (good) return f;
  static_factors_free(f);
  return NULL;
}

static_factors *static_factors_new(const node_stencil *k, const unsigned char *held,
                                   static_result *r) {
  const stiffness of = {.stencil = k};
  const int nodes = node_count(&of);
  static_factors *f = begin_factors(&of, held);
  f->b = band_of(k);
  double *diagonal = must_calloc((size_t)f->b.n, sizeof *diagonal);
  for (int n = 0; n < 2 * nodes; n++)
    f->fixed[n] = held[n] || is_alone(k, n / 2);
  visit_pairs(&f->b, fill, f->fixed);
  for (int n = 0; n < 2 * nodes; n++) {
    const int at = freedom(&f->b, n / 2, n % 2);
    double *entry = &f->b.matrix[(size_t)at * (size_t)f->b.rows];
    if (f->fixed[n]) *entry = 1;
    diagonal[at] = *entry;
  }
  *r = (static_result){.solved = false};
  r->solved = factor(&f->b, r) && stays_positive(&f->b, diagonal, r);
  free(diagonal);
  return kept_if(r->solved, f);
}

static_factors *static_factors_of_matrix(const node_matrix *k, const unsigned char *held,
                                         static_result *r) {
  const stiffness of = {.matrix = k};
  static_factors *f = begin_factors(&of, held);
  long loose = -1;
  for (int n = 2 * k->nodes; n < 2 * node_count(&of); n++)
    f->fixed[n] = 1;
  f->sparse = node_factors_new(k, f->fixed, &loose);
  *r = (static_result){.solved = f->sparse != NULL};
  if (loose >= 0) {
    r->loose = (int)(loose / 2);
    r->loose_axis = (int)(loose % 2);
  }
  return kept_if(r->solved, f);
}

void static_factors_free(static_factors *f) {
  if (!f) return;
  cholesky_free(f->sparse);
  free(f->b.matrix);
  free(f->held);
  free(f->fixed);
  free(f);
}

/* Where a freedom stands among the unknowns. */
static int unknown(const static_factors *f, int n) {
  return f->sparse ? n : freedom(&f->b, n / 2, n % 2);
}

static bool solve(const static_factors *f, double *right) {
  const band *b = &f->b;
  const int one = 1;
  int info = 0;
  if (f->sparse) return cholesky_solve(f->sparse, right, right);
  dpbtrs_("L", &b->n, &b->bands, &one, b->matrix, &b->rows, right, &b->n, &info, 1);
  return info == 0;
}

static_result static_factors_solve(const static_factors *f, const double *const force[2],
                                   double *const u[2], double *const reaction[2]) {
  const int freedoms = 2 * node_count(&f->of);
  static_result r = {.solved = false};
  double *right = must_calloc((size_t)freedoms, sizeof *right);
  for (int n = 0; n < freedoms; n++)
    if (!f->held[n]) u[n % 2][n / 2] = 0;
  multiply(&f->of, (const double *const *)u, reaction); /* by what is prescribed */
  for (int n = 0; n < freedoms; n++)
    if (!f->fixed[n]) right[unknown(f, n)] = force[n % 2][n / 2] - reaction[n % 2][n / 2];
  r.solved = solve(f, right);
  for (int n = 0; n < freedoms; n++)
    if (!f->fixed[n]) u[n % 2][n / 2] = right[unknown(f, n)];
  judge(&f->of, f->fixed, force, u, reaction, &r);
  free(right);
  return r;
}

static_result static_solution(const node_stencil *k, const unsigned char *held,
                              const double *const force[2], double *const u[2],
                              double *const reaction[2]) {
  static_result r;
  static_factors *f = static_factors_new(k, held, &r);
  if (f) r = static_factors_solve(f, force, u, reaction);
  static_factors_free(f);
  return r;
}
