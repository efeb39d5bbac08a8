#include "runtime/mesh/moving_least_squares.h"

#include <math.h>
#include <string.h>

#include "dsl/base/elementary.h"

enum { MOST_ALONG = 13, MOST_BASIS = 4, MOST_NEAR = 256 };

static const double LEAST_PIVOT = 1e-9;

double moving_weight(double r) {
  if (r >= 1) return 0;
  if (r <= 0.5) return 2.0 / 3 - 4 * r * r + 4 * r * r * r;
  return 4.0 / 3 - 4 * r + 4 * r * r - 4.0 / 3 * r * r * r;
}

double moving_weight_slope(double r) {
  if (r >= 1) return 0;
  if (r <= 0.5) return -8 * r + 12 * r * r;
  return -4 + 8 * r - 4 * r * r;
}

/* The nodes along an axis whose supports hold x: first .. first + count - 1. */
typedef struct along {
  int first, count;
  double weight[MOST_ALONG], slope[MOST_ALONG]; /* 1, 1/m */
} along;

static along weights_along(const mesh *m, int axis, double x) {
  const double u = (x - m->corner[axis]) / m->spacing[axis];
  along a = {.first = (int)ceil(u - m->support)};
  if (a.first < 0) a.first = 0;
  for (int k = a.first; k < m->nodes[axis] && k < u + m->support && a.count < MOST_ALONG; k++) {
    const double r = fabs(u - k) / m->support, sign = u > k ? 1 : u < k ? -1 : 0;
    a.weight[a.count] = moving_weight(r);
    a.slope[a.count++] = sign * moving_weight_slope(r) / (m->support * m->spacing[axis]);
  }
  return a;
}

/* A node's part of the moment matrix. */
typedef struct neighbour {
  int node;
  double weight, slope[2], p[MOST_BASIS];
} neighbour;

/* --- the basis -------------------------------------------------------------------------------- */

/* Value of the fourth term, sqrt(r/dx) about the nearest live tip, and its gradient. */
static double enriched_term(const mesh *m, const double tip[2], const double at[2],
                            double gradient[2]) {
  const double dx = m->spacing[0], d[2] = {at[0] - tip[0], at[1] - tip[1]};
  const double r = sqrt(d[0] * d[0] + d[1] * d[1]);
  for (int a = 0; a < 2 && gradient; a++)
    gradient[a] = r > 0 ? d[a] / (2 * r * sqrt(r * dx)) : 0;
  return sqrt(r / dx);
}

static double *nearest_tip(const mesh *m, const double at[2], double *distance) {
  double *nearest = NULL;
  *distance = INFINITY;
  for (int k = 0; k < m->cracks.tip_count; k++) {
    const double *t = m->cracks.tips[k], d[2] = {at[0] - t[0], at[1] - t[1]};
    const double r = sqrt(d[0] * d[0] + d[1] * d[1]);
    if (r >= *distance) continue;
    *distance = r;
    nearest = m->cracks.tips[k];
  }
  return nearest;
}

/* --- nodes ------------------------------------------------------------------------------------ */

/* Pieces of cracks that may hide nodes from a point. */
typedef struct near_pieces {
  bool all; /* so many are near that each of the mesh is asked */
  int count, piece[MOST_NEAR];
  bool left[MOST_NEAR]; /* the point is on the piece's left */
} near_pieces;

static void find_pieces(const mesh *m, const double at[2], const double lower[2],
                        const double upper[2], near_pieces *out) {
  out->count = crack_lines_near(&m->cracks, lower, upper, out->piece, MOST_NEAR);
  out->all = out->count > MOST_NEAR;
  for (int k = 0; k < out->count && !out->all; k++) {
    const crack_piece *p = &m->cracks.pieces[out->piece[k]];
    out->left[k] = crack_turn(p->a, p->b, at) >= 0;
  }
}

static bool is_hidden(const mesh *m, const near_pieces *near, const double at[2],
                      const double place[2]) {
  const crack_piece *pieces = m->cracks.pieces;
  for (int k = 0; k < m->cracks.count && near->all; k++)
    if (crack_piece_hides(&pieces[k], at, place)) return true;
  for (int k = 0; k < near->count && !near->all; k++)
    if (crack_piece_parts(&pieces[near->piece[k]], near->left[k], at, place)) return true;
  return false;
}

static int visible_nodes(const mesh *m, const double at[2], bool see_all, neighbour *out) {
  const along x = weights_along(m, 0, at[0]), y = weights_along(m, 1, at[1]);
  const double reach[2] = {m->support * m->spacing[0], m->support * m->spacing[1]},
               lower[2] = {at[0] - reach[0], at[1] - reach[1]},
               upper[2] = {at[0] + reach[0], at[1] + reach[1]};
  near_pieces near;
  int count = 0;
  near.all = false;
  near.count = 0;
  if (!see_all && m->cracks.count > 0) find_pieces(m, at, lower, upper, &near);
  const bool by_holes = !see_all && holes_meet_box(&m->holes, lower, upper);
  for (int j = 0; j < y.count; j++)
    for (int i = 0; i < x.count; i++) {
      const int node = mesh_node(m, x.first + i, y.first + j);
      const double place[2] = {mesh_at(m, 0, x.first + i), mesh_at(m, 1, y.first + j)};
      if (!m->moving[node] || is_hidden(m, &near, at, place)) continue;
      if (by_holes && holes_hide(&m->holes, at, place)) continue;
      neighbour *n = &out[count++];
      n->node = node;
      n->weight = x.weight[i] * y.weight[j];
      n->slope[0] = x.slope[i] * y.weight[j];
      n->slope[1] = x.weight[i] * y.slope[j];
      n->p[0] = 1;
      n->p[1] = (place[0] - at[0]) / m->spacing[0];
      n->p[2] = (place[1] - at[1]) / m->spacing[1];
    }
  return count;
}

/* --- the moment matrix ------------------------------------------------------------------------ */

typedef struct moments {
  int size;
  double l[MOST_BASIS][MOST_BASIS], d[MOST_BASIS]; /* L D L^T */
  double slope[2][MOST_BASIS][MOST_BASIS];
} moments;

/* False: not enough nodes. */
static bool moments_of(const neighbour *n, int count, int size, moments *a) {
  double sum[MOST_BASIS][MOST_BASIS] = {{0}};
  memset(a, 0, sizeof *a);
  a->size = size;
  if (count < size) return false;
  for (int k = 0; k < count; k++)
    for (int r = 0; r < size; r++)
      for (int c = 0; c <= r; c++) {
        const double pp = n[k].p[r] * n[k].p[c];
        sum[r][c] += n[k].weight * pp;
        a->slope[0][r][c] += n[k].slope[0] * pp;
        a->slope[1][r][c] += n[k].slope[1] * pp;
      }
  for (int r = 0; r < size; r++)
    for (int c = 0; c < r; c++)
      for (int s = 0; s < 2; s++)
        a->slope[s][c][r] = a->slope[s][r][c];
  for (int c = 0; c < size; c++) {
    a->d[c] = sum[c][c];
    for (int k = 0; k < c; k++)
      a->d[c] -= a->l[c][k] * a->l[c][k] * a->d[k];
    if (!(a->d[c] >= LEAST_PIVOT)) return false;
    for (int r = c + 1; r < size; r++) {
      a->l[r][c] = sum[r][c];
      for (int k = 0; k < c; k++)
        a->l[r][c] -= a->l[r][k] * a->l[c][k] * a->d[k];
      a->l[r][c] /= a->d[c];
    }
  }
  return true;
}

static void solve(const moments *a, double *x) {
  for (int r = 0; r < a->size; r++)
    for (int k = 0; k < r; k++)
      x[r] -= a->l[r][k] * x[k];
  for (int r = a->size - 1; r >= 0; r--) {
    x[r] /= a->d[r];
    for (int k = r + 1; k < a->size; k++)
      x[r] -= a->l[k][r] * x[k];
  }
}

static double dot(const double *a, const double *b, int size) {
  double sum = 0;
  for (int k = 0; k < size; k++)
    sum += a[k] * b[k];
  return sum;
}

/* N and its gradient of the nodes, from the basis p (value and gradient) at the point. */
static void functions(const neighbour *n, int count, const moments *a, const double *p,
                      const double p_slope[2][MOST_BASIS], point_shape *out) {
  double g[MOST_BASIS], h[2][MOST_BASIS];
  memcpy(g, p, sizeof g);
  solve(a, g);
  for (int s = 0; s < 2; s++) {
    for (int r = 0; r < a->size; r++)
      h[s][r] = p_slope[s][r] - dot(a->slope[s][r], g, a->size);
    solve(a, h[s]);
  }
  out->count = count;
  for (int k = 0; k < count; k++) {
    const double value = dot(n[k].p, g, a->size);
    out->node[k] = n[k].node;
    out->n[k] = n[k].weight * value;
    out->nx[k] = n[k].weight * dot(n[k].p, h[0], a->size) + n[k].slope[0] * value;
    out->ny[k] = n[k].weight * dot(n[k].p, h[1], a->size) + n[k].slope[1] * value;
  }
}

/* --- the point -------------------------------------------------------------------------------- */

/* R of N = R N_enriched + (1 - R) N_linear at a distance r from the tip, and dR/dr: 1 up to half of
   the radius, then 1 - 10 x^3 + 15 x^4 - 6 x^5. */
static double share_of_enriched(double r, double radius, double *slope) {
  const double inner = 0.5 * radius, x = (r - inner) / (radius - inner);
  *slope = 0;
  if (r <= inner) return 1;
  if (r >= radius) return 0;
  *slope = (-30 * x * x + 60 * x * x * x - 30 * x * x * x * x) / (radius - inner);
  return 1 - 10 * x * x * x + 15 * x * x * x * x - 6 * x * x * x * x * x;
}

/* Adds the fourth term near the tip; where the nodes do not bear it the linear basis stays. */
static void enrich(const mesh *m, const double at[2], neighbour *n, int count, point_shape *out) {
  double r, gradient[2];
  const double *tip = nearest_tip(m, at, &r);
  if (!tip || r >= m->enriched) return;
  double place[2], p[MOST_BASIS] = {1, 0, 0, 0};
  p[3] = enriched_term(m, tip, at, gradient);
  const double p_slope[2][MOST_BASIS] = {{0, 1 / m->spacing[0], 0, gradient[0]},
                                         {0, 0, 1 / m->spacing[1], gradient[1]}};
  for (int k = 0; k < count; k++) {
    mesh_place(m, n[k].node, place);
    n[k].p[3] = enriched_term(m, tip, place, NULL);
  }
  moments a;
  point_shape rich;
  if (!moments_of(n, count, MOST_BASIS, &a)) return;
  functions(n, count, &a, p, p_slope, &rich);
  double slope;
  const double share = share_of_enriched(r, m->enriched, &slope);
  const double by[2] = {r > 0 ? slope * (at[0] - tip[0]) / r : 0,
                        r > 0 ? slope * (at[1] - tip[1]) / r : 0};
  for (int k = 0; k < count; k++) {
    const double more = rich.n[k] - out->n[k];
    out->nx[k] += share * (rich.nx[k] - out->nx[k]) + by[0] * more;
    out->ny[k] += share * (rich.ny[k] - out->ny[k]) + by[1] * more;
    out->n[k] += share * more;
  }
}

bool moving_least_squares(const mesh *m, const double at[2], point_shape *out) {
  enum { LINEAR = 3 };
  neighbour n[MOST_ALONG * MOST_ALONG];
  const double p[MOST_BASIS] = {1, 0, 0, 0};
  const double p_slope[2][MOST_BASIS] = {{0, 1 / m->spacing[0], 0, 0},
                                         {0, 0, 1 / m->spacing[1], 0}};
  moments a;
  int count = visible_nodes(m, at, false, n);
  const bool sees = moments_of(n, count, LINEAR, &a);
  if (!sees) {
    count = visible_nodes(m, at, true, n);
    if (!moments_of(n, count, LINEAR, &a)) {
      out->count = 0;
      return false;
    }
  }
  functions(n, count, &a, p, p_slope, out);
  if (sees && m->enriched > 0) enrich(m, at, n, count, out);
  return sees;
}
