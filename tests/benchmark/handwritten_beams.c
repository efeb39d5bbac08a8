#include <math.h>

#include "tests/benchmark/bond_lanes.h"
#include "tests/benchmark/handwritten_families.h"

/* One turn over the rows: the bonds that a row owns add forces and moments to both ends; then the
   row moves, as no other bond reads it any more. What a particle has turned is kept as a unit
   quaternion, so that nothing of a step needs an angle function. Angles of ends against bonds and
   of ends against each other are taken from their sines by series, exact to rounding up to a
   sixteenth of a radian. */

enum { DIRECTIONS = 9 };

typedef struct vector {
  lanes x, y, z;
} vector;

typedef struct turned { /* a unit quaternion */
  lanes w;
  vector v;
} turned;

typedef struct beams_fcc {
  const family_problem *problem;
  double chord[DIRECTIONS][3]; /* unit vector */
  double inverse[DIRECTIONS];  /* 1/length, 1/spacings */
  /* spacings a step: axial force by stretch; moments over the spacing, 2 EI/s and GJ/s */
  double axial[DIRECTIONS], bending[DIRECTIONS], twisting[DIRECTIONS];
  double turning;                 /* rad a step, of such a moment */
  double *u[3], *v[3], *force[3]; /* [size] spacings; spacings a step; the same a step, more */
  double *w, *r[3], *spin[3], *moment[3]; /* [size] the quaternion; rad a step; */
} beams_fcc;

LANES_FUNCTION vector load(double *const *from, long q) {
  return (vector){lanes_load(from[0] + q), lanes_load(from[1] + q), lanes_load(from[2] + q)};
}
LANES_FUNCTION void add(double *const *to, long q, vector a) {
  lanes_store(to[0] + q, lanes_load(to[0] + q) + a.x);
  lanes_store(to[1] + q, lanes_load(to[1] + q) + a.y);
  lanes_store(to[2] + q, lanes_load(to[2] + q) + a.z);
}
LANES_FUNCTION vector sum(vector a, vector b) {
  return (vector){a.x + b.x, a.y + b.y, a.z + b.z};
}
LANES_FUNCTION vector less(vector a, vector b) {
  return (vector){a.x - b.x, a.y - b.y, a.z - b.z};
}
LANES_FUNCTION vector times(lanes f, vector a) {
  return (vector){f * a.x, f * a.y, f * a.z};
}
LANES_FUNCTION lanes dot(vector a, vector b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
LANES_FUNCTION vector cross(vector a, vector b) {
  return (vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* asin(x)/x of x^2. */
LANES_FUNCTION lanes arc_ratio(lanes z) {
  return 1 +
         z * (1.0 / 6 + z * (3.0 / 40 + z * (5.0 / 112 + z * (35.0 / 1152 + z * (63.0 / 2816)))));
}

/* 1/sqrt(1 - x^2) of x^2. */
LANES_FUNCTION lanes over_cosine(lanes z) {
  return 1 + z * (0.5 + z * (0.375 + z * (0.3125 + z * (35.0 / 128 + z * (63.0 / 256)))));
}

typedef struct end {
  vector theta; /* against the bond */
  lanes h, k;   /* of the moments that its angles carry: h + k theta theta^T */
} end_of_bond;

/* The sine of an end's angle is e x t, t the reference direction n as it has turned by dn. */
LANES_FUNCTION end_of_bond find_end(const turned *q, vector n, vector e, vector straight) {
  const vector once = cross(q->v, n), twice = cross(q->v, once);
  const vector dn = times(lanes_all(2), sum(times(q->w, once), twice));
  const vector sine = sum(cross(e, dn), straight);
  const lanes square = dot(sine, sine), ratio = arc_ratio(square);
  end_of_bond t = {.theta = times(ratio, sine)};
  const lanes angle = ratio * ratio * square;
  t.h = ratio * (dot(e, n) + dot(e, dn));
  t.k = 1.0 / 3 + angle * (1.0 / 45 + angle * (2.0 / 945 + angle * (1.0 / 4725)));
  return t;
}

LANES_FUNCTION vector carried(const end_of_bond *t, vector M) {
  return sum(times(t->h, M), times(t->k * dot(t->theta, M), t->theta));
}

LANES_FUNCTION turned turned_at(const beams_fcc *h, long q) {
  return (turned){lanes_load(h->w + q), load(h->r, q)};
}

static void find_bonds(beams_fcc *h, int row, int k) {
  const rows *g = h->problem->lattice;
  const long first = rows_start(g, row), offset = rows_offset(g, row, k);
  const vector n = {lanes_all(h->chord[k][0]), lanes_all(h->chord[k][1]),
                    lanes_all(h->chord[k][2])};
  const lanes per_length = lanes_all(h->inverse[k]);
  for (long q = first; q < first + g->pitch; q += LANES) {
    const lanes_marks exists = lanes_marked(g->bonds + q, UINT64_C(1) << k);
    const vector d = times(per_length, less(load(h->u, q + offset), load(h->u, q)));
    const bond_lanes bond = bond_of_growth(2 * dot(n, d) + dot(d, d));
    const vector e = times(bond.inverse, sum(n, d)), straight = times(bond.inverse, cross(d, n));
    const turned a = turned_at(h, q), b = turned_at(h, q + offset);
    const end_of_bond i = find_end(&a, n, e, straight), j = find_end(&b, n, e, straight);
    const vector both =
        sum(less(times(a.w, b.v), times(b.w, a.v)), cross(a.v, b.v)); /* from end to end */
    const lanes w = a.w * b.w + dot(a.v, b.v), sine = dot(both, e), z = sine * sine;
    const lanes bending = lanes_keep(exists, lanes_all(h->bending[k])),
                T = lanes_keep(exists, 2 * h->twisting[k] * arc_ratio(z) * sine) * over_cosine(z),
                N = lanes_keep(exists, 0.5 * h->axial[k] * bond.twice);
    const vector M_i = times(bending, sum(times(lanes_all(2), i.theta), j.theta)),
                 M_j = times(bending, sum(times(lanes_all(2), j.theta), i.theta));
    const vector m_i = carried(&i, M_i), m_j = carried(&j, M_j), turn = times(T, cross(both, e));
    const lanes about = T * w + 0.5 * (dot(M_i, cross(i.theta, e)) - dot(M_j, cross(j.theta, e)));
    const vector along = times(about, e), twice = times(lanes_all(2), turn);
    const vector force =
        less(times(N, e), times(h->inverse[k] * bond.inverse, cross(sum(sum(m_i, m_j), twice), e)));
    add(h->force, q, force);
    add(h->force, q + offset, times(lanes_all(-1), force));
    add(h->moment, q, less(along, sum(m_i, turn)));
    add(h->moment, q + offset, times(lanes_all(-1), sum(along, sum(m_j, turn))));
  }
}

/* Turns further by the rate: exp(spin/2) times what has been turned, by series. */
LANES_FUNCTION void turn_on(beams_fcc *h, long q, vector spin) {
  const turned t = turned_at(h, q);
  const lanes z = dot(spin, spin);
  const lanes c = 1 - z * (1.0 / 8 - z * (1.0 / 384 - z * (1.0 / 46080))),
              s = 0.5 - z * (1.0 / 48 - z * (1.0 / 3840 - z * (1.0 / 645120)));
  const vector v = sum(sum(times(c, t.v), times(s * t.w, spin)), times(s, cross(spin, t.v)));
  lanes_store(h->w + q, c * t.w - s * dot(spin, t.v));
  lanes_store(h->r[0] + q, v.x);
  lanes_store(h->r[1] + q, v.y);
  lanes_store(h->r[2] + q, v.z);
}

static void move_row(beams_fcc *h, int row) {
  const rows *g = h->problem->lattice;
  const long start = rows_start(g, row);
  for (long q = start; q < start + g->pitch; q += LANES) {
    for (int d = 0; d < 3; d++) {
      const lanes next = lanes_load(h->v[d] + q) + lanes_load(h->force[d] + q);
      const lanes spin = lanes_load(h->spin[d] + q) + h->turning * lanes_load(h->moment[d] + q);
      lanes_store(h->v[d] + q, next);
      lanes_store(h->u[d] + q, lanes_load(h->u[d] + q) + next);
      lanes_store(h->spin[d] + q, spin);
      lanes_store(h->force[d] + q, lanes_all(0));
      lanes_store(h->moment[d] + q, lanes_all(0));
    }
    turn_on(h, q, load(h->spin, q));
  }
}

static void advance(void *state, long steps) {
  beams_fcc *h = state;
  for (long step = 0; step < steps; step++)
    for (int row = 0; row < h->problem->lattice->row_count; row++) {
      for (int k = 0; k < DIRECTIONS; k++)
        find_bonds(h, row, k);
      move_row(h, row);
    }
}

/* --- set-up ----------------------------------------------------------------------------------- */

static void set_law(beams_fcc *h) {
  const family_problem *p = h->problem;
  const rows *g = p->lattice;
  const double s = g->spacing, kick = p->time_step * p->time_step / (g->mass * s);
  const double lambda = p->E * p->nu / ((1 + p->nu) * (1 - 2 * p->nu)),
               mu = p->E / (2 * (1 + p->nu));
  for (int k = 0; k < DIRECTIONS; k++) {
    const double length = g->length[k], part = g->shell[k] == 1 ? 1 : 0.25;
    const double across = part * 2 * sqrt(2) / 5 * s * (mu - lambda),
                 along = across + part * sqrt(2) * s * lambda,
                 EI = across * length * length * length / 12;
    h->inverse[k] = s / length;
    h->axial[k] = kick * along * length;
    h->bending[k] = kick * 2 * EI / length / s;
    h->twisting[k] = kick * EI / (1 + p->nu) / length / s;
    for (int d = 0; d < 3; d++)
      h->chord[k][d] = g->chord[k][d] / length;
  }
  h->turning = g->mass * s * s / g->inertia;
}

static void *start(const family_problem *p) {
  const rows *g = p->lattice;
  beams_fcc *h = must_calloc(1, sizeof *h);
  h->problem = p;
  set_law(h);
  double **arrays[19] = {&h->w};
  for (int d = 0; d < 3; d++) {
    double **const of[] = {&h->u[d], &h->v[d], &h->force[d], &h->r[d], &h->spin[d], &h->moment[d]};
    memcpy(arrays + 1 + 6 * d, of, sizeof of);
  }
  lanes_share(arrays, 19, g->size);
  return h;
}

static void end(void *state) {
  beams_fcc *h = state;
  free(h->w); /* with all that share its memory */
  free(h);
}

static void set(void *state, const motions *from) {
  const beams_fcc *h = state;
  motions_scale(h->u, h->v, from, h->problem);
  for (long q = 0; q < h->problem->lattice->size; q++) {
    double square = 0;
    for (int d = 0; d < 3; d++)
      square += from->displacement[3 + d][q] * from->displacement[3 + d][q];
    const double angle = sqrt(square);
    h->w[q] = cos(angle / 2);
    for (int d = 0; d < 3; d++) {
      h->r[d][q] = angle > 0 ? sin(angle / 2) / angle * from->displacement[3 + d][q] : 0;
      h->spin[d][q] = from->velocity[3 + d][q] * h->problem->time_step;
    }
  }
}

static void get(const void *state, motions *to) {
  const beams_fcc *h = state;
  motions_unscale(to, h->u, h->v, h->problem);
  for (long q = 0; q < h->problem->lattice->size; q++) {
    const double sine =
        sqrt(h->r[0][q] * h->r[0][q] + h->r[1][q] * h->r[1][q] + h->r[2][q] * h->r[2][q]);
    for (int d = 0; d < 3; d++) {
      to->displacement[3 + d][q] = sine > 0 ? 2 * atan2(sine, h->w[q]) / sine * h->r[d][q] : 0;
      to->velocity[3 + d][q] = h->spin[d][q] / h->problem->time_step;
    }
  }
}

const body_program HANDWRITTEN_NAME(beams_fcc) = {start, end, set, get, advance};
