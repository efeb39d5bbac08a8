#include <math.h>

#include "runtime/lattice/shape_matrix.h"
#include "tests/benchmark/bond_lanes.h"
#include "tests/benchmark/handwritten_families.h"

/* As handwritten_elastic.c, in three turns: the bonds of a row, with the damage of the last step;
   what its particles become; then forces and flow in the bonds of the row below, which moves.

   Where the law keeps a plastic stretch on either side of a bond, only their mean is ever read, and
   kept here. Damage stands as the part that is left, which the springs in series want: 2 x y/(x +
   y). */

enum { ALONG, RIGHT, LEFT, DIRECTIONS };

/* What depends on the bonds that a particle has: [FACTS][LANES], shared by all blocks of LANES
   sites that are alike. */
enum { SHAPE, PAIRS = SHAPE + 6, SHARE = PAIRS + DIRECTIONS, FACTS };

typedef struct row_buffer {
  double *stretch[DIRECTIONS], *left[DIRECTIONS]; /* left: elastic stretch times damage factor */
  double *pull[DIRECTIONS];                       /* a left, and the damper */
  double *force[DIRECTIONS];                      /* RIGHT and LEFT: of the bond to the row above */
  double *coupled;                                /* b/2 times the sum of left */
  double *flow,
      *flow_mean; /* f_y a f/(2 E norm), and times the mean of left; 0 where nothing flows */
} row_buffer;

enum { BUFFERS = 4 * DIRECTIONS + 3 };

typedef struct concrete_hexagon {
  const family_problem *problem;
  double chord[DIRECTIONS][2];  /* spacings */
  double square[DIRECTIONS][3]; /* of its direction: x x, y y, x y */
  double a, b, damper;          /* N; N; N by spacings a step */
  double kick;                  /* spacings a step, by N */
  double stress;                /* s/(2 V), 1/m^2 */
  double third;                 /* -nu/(1 - nu) */
  double cod_1, cod_c, root_w_cr;
  double *u[2], *v[2];         /* [size] spacings; spacings a step */
  double *left_t, *left_c;     /* [size] 1 - w_t, 1 - w_c */
  double *yielded;             /* [size] */
  double *plastic[DIRECTIONS]; /* [size] mean of the plastic stretches of either side */
  double *facts;               /* [fact_sets][FACTS][LANES] */
  int32_t *fact_set;           /* [size/LANES] */
  row_buffer row[2];
  double *buffers;
  long width;
} concrete_hexagon;

/* 2 x y/(x + y), 0 when both are 0. */
LANES_FUNCTION lanes in_series(lanes x, lanes y) {
  return (2 * (x * y)) * lanes_inverse(lanes_max(x + y, lanes_all(1e-100)));
}

static void find_bonds(concrete_hexagon *h, int row, int k) {
  const rows *g = h->problem->lattice;
  const long near = rows_start(g, row), far = near + rows_offset(g, row, k);
  const double *i_x = h->u[0] + near, *i_y = h->u[1] + near, *j_x = h->u[0] + far,
               *j_y = h->u[1] + far;
  const double *i_vx = h->v[0] + near, *i_vy = h->v[1] + near, *j_vx = h->v[0] + far,
               *j_vy = h->v[1] + far;
  const double *i_t = h->left_t + near, *i_c = h->left_c + near, *j_t = h->left_t + far,
               *j_c = h->left_c + far, *plastic = h->plastic[k] + near;
  const uint64_t *bonds = g->bonds + near;
  const double x = h->chord[k][0], y = h->chord[k][1], a = h->a, damper = h->damper;
  double *to_stretch = h->row[row & 1].stretch[k] + LANES,
         *to_left = h->row[row & 1].left[k] + LANES, *to_pull = h->row[row & 1].pull[k] + LANES;
  for (long q = 0; q < g->pitch; q += LANES) {
    const lanes_marks exists = lanes_marked(bonds + q, UINT64_C(1) << k);
    const lanes d_x = lanes_load(j_x + q) - lanes_load(i_x + q),
                d_y = lanes_load(j_y + q) - lanes_load(i_y + q);
    const bond_lanes bond =
        bond_of_growth(((2 * x) * d_x + (2 * y) * d_y) + (d_x * d_x + d_y * d_y));
    const lanes speed = ((x + d_x) * (lanes_load(j_vx + q) - lanes_load(i_vx + q)) +
                         (y + d_y) * (lanes_load(j_vy + q) - lanes_load(i_vy + q))) *
                        bond.inverse;
    const lanes stretch = 0.5 * bond.twice, elastic = stretch - lanes_load(plastic + q);
    const lanes_marks tension = lanes_least(elastic, lanes_all(0));
    const lanes factor = in_series(lanes_choose(tension, lanes_load(i_t + q), lanes_load(i_c + q)),
                                   lanes_choose(tension, lanes_load(j_t + q), lanes_load(j_c + q)));
    const lanes left = factor * elastic;
    lanes_store(to_stretch + q, lanes_keep(exists, stretch));
    lanes_store(to_left + q, lanes_keep(exists, left));
    lanes_store(to_pull + q, lanes_keep(exists, a * left + (damper * factor) * speed));
  }
}

/* Root of x >= 0. */
LANES_FUNCTION lanes root(lanes x) {
  return x * lanes_inverse_root(lanes_max(x, lanes_all(1e-200)));
}

typedef struct plane_tensor {
  lanes xx, yy, zz, xy;
} plane_tensor;

LANES_FUNCTION lanes first_principal(plane_tensor t) {
  const lanes half = 0.5 * (t.xx - t.yy);
  return lanes_max(0.5 * (t.xx + t.yy) + root(t.xy * t.xy + half * half), t.zz);
}

LANES_FUNCTION lanes second_invariant(plane_tensor t) {
  const lanes mean = (1.0 / 3) * (t.xx + t.yy + t.zz);
  const lanes x = t.xx - mean, y = t.yy - mean, z = t.zz - mean;
  return 0.5 * (x * x + y * y + z * z) + t.xy * t.xy;
}

/* Eqs 4.12 to 4.14: tensile damage after the step. */
LANES_FUNCTION lanes tensile(const concrete_hexagon *h, lanes old, lanes sigma_1, lanes eps_1) {
  const family_problem *p = h->problem;
  const lanes cod = (2 * p->lattice->spacing) * eps_1;
  const lanes share = (p->f_t / p->E) * lanes_inverse(eps_1);
  const lanes first = lanes_max(1 - share * (1 - ((1 - p->gamma) / h->cod_1) * cod), lanes_all(0));
  const lanes second = 1 - (share * (p->gamma / (h->cod_c - h->cod_1))) * (h->cod_c - cod);
  const lanes opened = lanes_choose(lanes_least(lanes_all(h->cod_c), cod), second, lanes_all(1));
  const lanes line = lanes_choose(lanes_least(lanes_all(h->cod_1), cod), first, opened);
  const lanes sound = lanes_choose(lanes_least(lanes_all(0), old), old, line);
  const lanes now = lanes_choose(lanes_least(sigma_1, lanes_all(p->f_t)), line, sound);
  return lanes_min(lanes_max(now, old), lanes_all(1));
}

/* Eq 4.16, and crushing. */
LANES_FUNCTION lanes compressive(const concrete_hexagon *h, lanes old, lanes w_t, lanes yielded,
                                 lanes eps_eff) {
  const family_problem *p = h->problem;
  const lanes torn = (root(w_t) - h->root_w_cr) * (1 / (1 - h->root_w_cr));
  const lanes slow = lanes_choose(lanes_least(lanes_all(p->w_cr), w_t), lanes_all(0), torn);
  const lanes crushed =
      lanes_choose(lanes_least(eps_eff, lanes_all(p->eps_ult)), lanes_all(1), slow);
  const lanes now = lanes_choose(lanes_least(yielded, lanes_all(1)), crushed, slow);
  return lanes_min(lanes_max(now, old), lanes_all(1));
}

typedef struct family_sums {
  lanes stretch[DIRECTIONS], left[DIRECTIONS]; /* of a bond and its opposite */
  lanes squares;                               /* of all that is left */
} family_sums;

LANES_FUNCTION family_sums sum_bonds(const row_buffer *now, const row_buffer *below, long at,
                                     const long shift[DIRECTIONS]) {
  family_sums f;
  f.squares = lanes_all(0);
  for (int k = 0; k < DIRECTIONS; k++) {
    const row_buffer *other = k == ALONG ? now : below;
    const lanes mine = lanes_load(now->left[k] + at),
                back = lanes_load(other->left[k] + at + shift[k]);
    f.left[k] = mine + back;
    f.squares += mine * mine + back * back;
    f.stretch[k] = lanes_load(now->stretch[k] + at) + lanes_load(other->stretch[k] + at + shift[k]);
  }
  return f;
}

LANES_FUNCTION plane_tensor stress_of(const concrete_hexagon *h, const double *facts,
                                      const family_sums *f, lanes coupled) {
  plane_tensor sigma = {lanes_all(0), lanes_all(0), lanes_all(0), lanes_all(0)};
  for (int k = 0; k < DIRECTIONS; k++) {
    const lanes pair =
        h->stress * (h->a * f->left[k] + lanes_load(facts + (PAIRS + k) * LANES) * coupled);
    sigma.xx += h->square[k][0] * pair;
    sigma.yy += h->square[k][1] * pair;
    sigma.xy += h->square[k][2] * pair;
  }
  return sigma;
}

LANES_FUNCTION plane_tensor strain_of(const concrete_hexagon *h, const double *facts,
                                      const family_sums *f) {
  lanes shape[6], sum[3] = {lanes_all(0), lanes_all(0), lanes_all(0)};
  for (int n = 0; n < 6; n++)
    shape[n] = lanes_load(facts + (SHAPE + n) * LANES);
  for (int k = 0; k < DIRECTIONS; k++)
    for (int n = 0; n < 3; n++)
      sum[n] += h->square[k][n] * f->stretch[k];
  plane_tensor eps;
  eps.xx = shape[0] * sum[0] + shape[1] * sum[1] + shape[2] * sum[2];
  eps.yy = shape[1] * sum[0] + shape[3] * sum[1] + shape[4] * sum[2];
  eps.xy = 0.5 * (shape[2] * sum[0] + shape[4] * sum[1] + shape[5] * sum[2]);
  eps.zz = h->third * (eps.xx + eps.yy);
  return eps;
}

/* New damage, and how fast the bonds of each particle flow. */
static void change_particles(concrete_hexagon *h, int row) {
  const rows *g = h->problem->lattice;
  const family_problem *p = h->problem;
  const long start = rows_start(g, row);
  const row_buffer *now = &h->row[row & 1], *below = &h->row[~row & 1];
  const long shift[DIRECTIONS] = {-1, g->pitch - rows_offset(g, row - 1, RIGHT),
                                  g->pitch - rows_offset(g, row - 1, LEFT)};
  double *t = h->left_t + start, *c = h->left_c + start, *yielded = h->yielded + start;
  const double hardening = (p->f_c - p->f_y) / p->eps_ult;
  for (long q = 0; q < g->pitch; q += LANES) {
    const double *facts = h->facts + h->fact_set[(start + q) / LANES] * (FACTS * LANES);
    const family_sums f = sum_bonds(now, below, LANES + q, shift);
    const lanes sum = (f.left[0] + f.left[1]) + f.left[2], coupled = h->b * sum;
    const plane_tensor sigma = stress_of(h, facts, &f, coupled), eps = strain_of(h, facts, &f);
    const lanes eps_eff = root(3 * second_invariant(eps)), F_eff = p->f_y + hardening * eps_eff;
    const lanes over = 3 * second_invariant(sigma) * lanes_inverse(F_eff * F_eff) - 1;
    const lanes mean = lanes_load(facts + SHARE * LANES) * sum;
    const lanes spread = lanes_max(f.squares - sum * mean, lanes_all(0));
    const lanes_marks yields = lanes_least(over, lanes_all(0));
    const lanes flow =
        lanes_keep(yields, (0.5 * h->a * p->f_y / p->E) * over *
                               lanes_inverse(lanes_max(h->a * root(spread), lanes_all(1e-6))));
    const lanes yielded_now = lanes_choose(yields, lanes_all(1), lanes_load(yielded + q));
    const lanes w_t = tensile(h, 1 - lanes_load(t + q), first_principal(sigma),
                              lanes_max(first_principal(eps), lanes_all(1e-12)));
    const lanes w_c = compressive(h, 1 - lanes_load(c + q), w_t, yielded_now, eps_eff);
    lanes_store(now->coupled + LANES + q, 0.5 * coupled);
    lanes_store(now->flow + LANES + q, flow);
    lanes_store(now->flow_mean + LANES + q, flow * mean);
    lanes_store(yielded + q, yielded_now);
    lanes_store(t + q, 1 - w_t);
    lanes_store(c + q, 1 - w_c);
  }
}

/* The force in a bond, in N, and its flow: `shift` leads to the other end in `far`. */
LANES_FUNCTION lanes bond_force(const row_buffer *now, const row_buffer *far, int k, long at,
                                long shift, const uint64_t *bonds, double *plastic) {
  const lanes_marks exists = lanes_marked(bonds, UINT64_C(1) << k);
  const lanes coupled = lanes_load(now->coupled + at) + lanes_load(far->coupled + at + shift);
  const lanes flow = lanes_load(now->flow + at) + lanes_load(far->flow + at + shift);
  const lanes mean = lanes_load(now->flow_mean + at) + lanes_load(far->flow_mean + at + shift);
  const lanes more = flow * lanes_load(now->left[k] + at) - lanes_keep(exists, mean);
  lanes_store(plastic, lanes_load(plastic) + more);
  return lanes_load(now->pull[k] + at) + lanes_keep(exists, coupled);
}

/* All that acts on the row's particles, which move. */
static void move_row(concrete_hexagon *h, int row) {
  const rows *g = h->problem->lattice;
  const long start = rows_start(g, row);
  const row_buffer *now = &h->row[row & 1], *other = &h->row[~row & 1];
  const long to_right = rows_offset(g, row, RIGHT) - g->pitch,
             to_left = rows_offset(g, row, LEFT) - g->pitch;
  const long from_left = LANES + g->pitch - rows_offset(g, row - 1, RIGHT),
             from_right = LANES + g->pitch - rows_offset(g, row - 1, LEFT);
  const uint64_t *bonds = g->bonds + start;
  double *u[2] = {h->u[0] + start, h->u[1] + start}, *v[2] = {h->v[0] + start, h->v[1] + start};
  double *plastic[DIRECTIONS] = {h->plastic[0] + start, h->plastic[1] + start,
                                 h->plastic[2] + start};
  double kick[DIRECTIONS][2];
  for (int k = 0; k < DIRECTIONS; k++)
    for (int d = 0; d < 2; d++)
      kick[k][d] = h->kick * h->chord[k][d];
  lanes before = lanes_all(0);
  for (long q = 0; q < g->pitch; q += LANES) {
    const long at = LANES + q;
    const lanes along = bond_force(now, now, ALONG, at, 1, bonds + q, plastic[ALONG] + q);
    const lanes right = bond_force(now, other, RIGHT, at, to_right, bonds + q, plastic[RIGHT] + q);
    const lanes left = bond_force(now, other, LEFT, at, to_left, bonds + q, plastic[LEFT] + q);
    const lanes line = along - lanes_shift_in(before, along);
    const lanes from_right_below = right - lanes_load(other->force[RIGHT] + from_left + q);
    const lanes from_left_below = left - lanes_load(other->force[LEFT] + from_right + q);
    before = along;
    lanes_store(now->force[RIGHT] + at, right);
    lanes_store(now->force[LEFT] + at, left);
    for (int d = 0; d < 2; d++) {
      const lanes next = lanes_load(v[d] + q) +
                         (kick[ALONG][d] * line +
                          (kick[RIGHT][d] * from_right_below + kick[LEFT][d] * from_left_below));
      lanes_store(v[d] + q, next);
      lanes_store(u[d] + q, lanes_load(u[d] + q) + next);
    }
  }
}

static void advance(void *state, long steps) {
  concrete_hexagon *h = state;
  const int rows_here = h->problem->lattice->row_count;
  for (long step = 0; step < steps; step++) {
    memset(h->buffers, 0, (size_t)(2 * BUFFERS * h->width) * sizeof(double));
    for (int row = 0; row < rows_here; row++) {
      for (int k = 0; k < DIRECTIONS; k++)
        find_bonds(h, row, k);
      change_particles(h, row);
      if (row > 0) move_row(h, row - 1);
    }
    move_row(h, rows_here - 1); /* what the buffers hold of a row above meets no bond */
  }
}

/* --- set-up ----------------------------------------------------------------------------------- */

static void share_out_buffers(concrete_hexagon *h) {
  h->width = h->problem->lattice->pitch + 3 * LANES; /* less likely a part of 4 KiB */
  h->buffers = lanes_zeros(2 * BUFFERS * h->width);
  double *next = h->buffers;
  for (row_buffer *b = h->row; b < h->row + 2; b++) {
    double **all[BUFFERS] = {&b->coupled, &b->flow, &b->flow_mean};
    for (int k = 0; k < DIRECTIONS; k++) {
      double **bond[] = {&b->stretch[k], &b->left[k], &b->pull[k], &b->force[k]};
      for (int n = 0; n < 4; n++)
        all[3 + 4 * k + n] = bond[n];
    }
    for (int n = 0; n < BUFFERS; n++, next += h->width)
      *all[n] = next;
  }
}

static void facts_of(const rows *g, double *const *shape, long block, double *facts) {
  memset(facts, 0, FACTS * LANES * sizeof(double));
  for (long l = 0; l < LANES; l++) {
    const long site = block * LANES + l;
    double bonds = 0;
    if (!g->present[site]) continue;
    for (int n = 0; n < 6; n++)
      facts[(SHAPE + n) * LANES + l] = shape[n][site];
    for (int k = 0; k < DIRECTIONS; k++) {
      const double pair =
          rows_has_bond(g, site, k) + rows_has_bond(g, rows_partner(g, site, k + DIRECTIONS), k);
      facts[(PAIRS + k) * LANES + l] = pair;
      bonds += pair;
    }
    facts[SHARE * LANES + l] = bonds > 0 ? 1 / bonds : 0;
  }
}

/* Each kind of block is kept once: there are few. */
static void find_facts(concrete_hexagon *h) {
  const rows *g = h->problem->lattice;
  const size_t set = FACTS * LANES;
  double *shape[PL_SHAPE_PLANES(2)], facts[FACTS * LANES];
  long sets = 0;
  for (int n = 0; n < PL_SHAPE_PLANES(2); n++)
    shape[n] = lanes_zeros(g->size);
  shape_matrices(g, shape);
  h->fact_set = must_calloc((size_t)(g->size / LANES), sizeof *h->fact_set);
  h->facts = NULL;
  for (long block = 0; block < g->size / LANES; block++) {
    long same = 0;
    facts_of(g, shape, block, facts);
    while (same < sets && memcmp(h->facts + (size_t)same * set, facts, sizeof facts) != 0)
      same++;
    h->fact_set[block] = (int32_t)same;
    if (same < sets) continue;
    h->facts = must_realloc(h->facts, (size_t)++sets * sizeof facts);
    memcpy(h->facts + (size_t)same * set, facts, sizeof facts);
  }
  for (int n = 0; n < PL_SHAPE_PLANES(2); n++)
    free(shape[n]);
}

static void set_law(concrete_hexagon *h) {
  const family_problem *p = h->problem;
  const rows *g = p->lattice;
  const double s = g->spacing, t = g->stiffness_thickness, pi = acos(-1);
  const double omega = 2 * pi * sqrt(p->E / (3 * (1 - 2 * p->nu)) / p->rho) / (2 * s);
  h->a = 2 * p->E * s * t / (sqrt(3) * (1 + p->nu));
  h->b = p->E * s * t * (1 - 3 * p->nu) / (6 * sqrt(3) * (p->nu * p->nu - 1));
  h->damper = 2 * g->mass * p->xi_in * omega * s / p->time_step;
  h->kick = p->time_step * p->time_step / (g->mass * s);
  h->stress = s / (2 * g->volume);
  h->third = -p->nu / (1 - p->nu);
  h->cod_c = 2 * p->G_f / (p->f_t * (p->alpha + p->gamma));
  h->cod_1 = p->alpha * h->cod_c;
  h->root_w_cr = sqrt(p->w_cr);
  for (int k = 0; k < DIRECTIONS; k++) {
    const double x = g->chord[k][0] / s, y = g->chord[k][1] / s;
    h->chord[k][0] = x;
    h->chord[k][1] = y;
    h->square[k][0] = x * x;
    h->square[k][1] = y * y;
    h->square[k][2] = x * y;
  }
}

static void *start(const family_problem *p) {
  const long size = p->lattice->size;
  concrete_hexagon *h = must_calloc(1, sizeof *h);
  h->problem = p;
  set_law(h);
  share_out_buffers(h);
  find_facts(h);
  for (int d = 0; d < 2; d++) {
    h->u[d] = lanes_zeros(size);
    h->v[d] = lanes_zeros(size);
  }
  h->left_t = lanes_zeros(size);
  h->left_c = lanes_zeros(size);
  h->yielded = lanes_zeros(size);
  for (int k = 0; k < DIRECTIONS; k++)
    h->plastic[k] = lanes_zeros(size);
  return h;
}

static void end(void *state) {
  concrete_hexagon *h = state;
  for (int d = 0; d < 2; d++) {
    free(h->u[d]);
    free(h->v[d]);
  }
  for (int k = 0; k < DIRECTIONS; k++)
    free(h->plastic[k]);
  free(h->left_t);
  free(h->left_c);
  free(h->yielded);
  free(h->facts);
  free(h->fact_set);
  free(h->buffers);
  free(h);
}

static void set(void *state, const motions *from) {
  concrete_hexagon *h = state;
  const long size = h->problem->lattice->size;
  motions_scale(h->u, h->v, from, h->problem);
  memset(h->yielded, 0, (size_t)size * sizeof(double));
  for (int k = 0; k < DIRECTIONS; k++)
    memset(h->plastic[k], 0, (size_t)size * sizeof(double));
  for (long q = 0; q < size; q++)
    h->left_t[q] = h->left_c[q] = 1;
}

static void get(const void *state, motions *to) {
  const concrete_hexagon *h = state;
  motions_unscale(to, h->u, h->v, h->problem);
}

const body_program HANDWRITTEN_NAME(concrete_hexagon) = {start, end, set, get, advance};
