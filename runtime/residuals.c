#include "runtime/residuals.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"
#include "runtime/shape_matrix.h"

static const double one_sided = 0.35;
static const double tiny = 1e-7; /* strain; in spacings, too */

static bool is_at_surface(const rows *w, long site) {
  double sum[3] = {0, 0, 0}, lengths = 0;
  for (int k = 0; k < 2 * w->directions; k++) {
    double chord[3];
    if (!rows_has_neighbour(w, site, k)) continue;
    lengths += rows_chord(w, site, k, chord);
    for (int a = 0; a < w->dimensions; a++)
      sum[a] += chord[a];
  }
  return !(hypot(hypot(sum[0], sum[1]), sum[2]) <= one_sided * lengths) || lengths == 0;
}

enum { SURFACE = 1, NEAR_SURFACE };

void residuals_inside(const rows *w, unsigned char *inside) {
  unsigned char *surface = must_calloc((size_t)w->size, 1);
  for (long p = 0; p < w->particle_count; p++)
    if (is_at_surface(w, w->particle_site[p])) surface[w->particle_site[p]] = SURFACE;
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    bool near = surface[site] == SURFACE;
    for (int k = 0; k < 2 * w->directions && !near; k++)
      near = rows_has_neighbour(w, site, k) && surface[rows_partner(w, site, k)] == SURFACE;
    inside[p] = !near;
  }
  free(surface);
}

static void count_bonds(const rows *w, residuals *r) {
  r->fewest = ROWS_MAX_NEIGHBOURS;
  for (long p = 0; p < w->particle_count; p++) {
    const int degree = rows_degree(w, w->particle_site[p]);
    r->fewest = degree < r->fewest ? degree : r->fewest;
    r->most = degree > r->most ? degree : r->most;
  }
  r->mean = 2 * (double)w->bond_count / (double)w->particle_count;
}

static void find_forces(sweep *w) {
  const unsigned environment = sweep_enter();
  for (int stage = 0; stage < w->law->step.pass_count; stage++)
    for (int b = 0; b < w->block_count; b++)
      w->engine.step(w, stage, b);
  sweep_leave(environment);
}

/* Displacements of strain number k: extensions along the axes, then shears. */
static void strain(sweep *w, int k) {
  static const int planes[][2] = {{0, 1}, {1, 2}, {0, 2}};
  const rows *g = w->lattice;
  const double *const at[3] = {g->x, g->y, g->z};
  const int n = w->dimensions, a = k < n ? k : planes[k - n][0], b = k < n ? k : planes[k - n][1];
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    for (int d = 0; d < n; d++)
      w->displacement[d][q] =
          tiny * ((d == a ? 0.5 * at[b][q] : 0) + (d == b ? 0.5 * at[a][q] : 0));
  }
}

static void clear(sweep *w) {
  for (int d = 0; d < w->dof; d++)
    memset(w->displacement[d], 0, (size_t)w->lattice->size * sizeof(double));
}

static void find_patch(sweep *w, residuals *r) {
  const rows *g = w->lattice;
  unsigned char *inside = must_calloc((size_t)g->particle_count + 1, 1);
  double squares[2] = {0, 0}, count[2] = {0, 0};
  residuals_inside(g, inside);
  for (int k = 0; k < (w->dimensions == 2 ? 3 : 6); k++) {
    strain(w, k);
    find_forces(w);
    for (long p = 0; p < g->particle_count; p++) {
      count[inside[p]]++;
      for (int d = 0; d < w->dimensions; d++)
        squares[inside[p]] += pow(w->force[d][g->particle_site[p]], 2);
    }
  }
  r->patch = count[1] > 0 ? sqrt(squares[1] / count[1] / (squares[0] / count[0])) : NAN;
  if (!isfinite(r->patch)) r->patch = NAN;
  free(inside);
}

static void find_unbalanced(sweep *w, residuals *r) {
  const rows *g = w->lattice;
  uint64_t bits = UINT64_C(0x9e3779b97f4a7c15);
  double sizes = 0;
  for (long q = 0; q < g->size; q++)
    for (int d = 0; d < w->dimensions && g->present[q]; d++) {
      bits ^= bits << 13;
      bits ^= bits >> 7;
      bits ^= bits << 17;
      w->displacement[d][q] = tiny * g->spacing * ((double)(bits >> 11) * 0x1p-52 - 1);
    }
  find_forces(w);
  for (int d = 0; d < w->dimensions; d++) {
    double sum = 0;
    for (long p = 0; p < g->particle_count; p++) {
      sum += w->force[d][g->particle_site[p]];
      sizes += fabs(w->force[d][g->particle_site[p]]);
    }
    r->unbalanced = fmax(r->unbalanced, fabs(sum));
  }
  r->unbalanced = sizes > 0 ? r->unbalanced / sizes : 0;
}

residuals residuals_find(sweep *w) {
  residuals r = {.patch = NAN};
  count_bonds(w->lattice, &r);
  r.unresolved = shape_unresolved(w->lattice, NULL);
  find_patch(w, &r);
  find_unbalanced(w, &r);
  clear(w);
  return r;
}
