#include "tests/benchmark/naive_families.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "runtime/lattice/shape_matrix.h"

typedef struct neighbour {
  int j;
  int back;                /* where j keeps this one */
  double chord[3], length; /* reference, m */
  bool second_shell, broken;
  double stretch, force; /* force: of this side */
  double elastic, damage_factor, plastic;
} neighbour;

typedef struct particle {
  double u[3], v[3], f[3]; /* m, m/s, N */
  int first, count;        /* neighbours */
  double sum;              /* dilatation, or coupled force */
  double weighted_volume, shape[6];
  double w_t, w_c;
  bool yielded;
} particle;

typedef struct naive {
  const family_problem *problem;
  int dimensions;
  long count;
  particle *particles;
  neighbour *neighbours;
  double a, second, b, damper;
} naive;

/* --- bonds ------------------------------------------------------------------------------------ */

static void chord_now(const particle *i, const particle *j, const neighbour *n, int dimensions,
                      double chord[3]) {
  for (int d = 0; d < dimensions; d++)
    chord[d] = n->chord[d] + j->u[d] - i->u[d];
}

static double length_of(const double *chord, int dimensions) {
  double square = 0;
  for (int d = 0; d < dimensions; d++)
    square += chord[d] * chord[d];
  return sqrt(square);
}

/* (L - s)/s, written so that a small stretch keeps its digits. */
static __attribute__((noinline)) double stretch_of(const particle *i, const particle *j,
                                                   const neighbour *n, int dimensions) {
  double chord[3], product = 0;
  chord_now(i, j, n, dimensions, chord);
  for (int d = 0; d < dimensions; d++)
    product += (j->u[d] - i->u[d]) * (n->chord[d] + chord[d]);
  return product / (n->length * (length_of(chord, dimensions) + n->length));
}

static __attribute__((noinline)) double stretch_rate_of(const particle *i, const particle *j,
                                                        const neighbour *n, int dimensions) {
  double chord[3], product = 0;
  chord_now(i, j, n, dimensions, chord);
  for (int d = 0; d < dimensions; d++)
    product += (j->v[d] - i->v[d]) * chord[d];
  return product / (length_of(chord, dimensions) * n->length);
}

/* This side's part of the bond force: to i, the opposite to j. */
static __attribute__((noinline)) void push_apart(particle *i, particle *j, const neighbour *n,
                                                 double force, int dimensions, bool reference) {
  double chord[3];
  chord_now(i, j, n, dimensions, chord);
  const double *along = reference ? n->chord : chord;
  const double length = reference ? n->length : length_of(chord, dimensions);
  for (int d = 0; d < dimensions; d++) {
    const double f = force * along[d] / length;
    i->f[d] += f;
    j->f[d] -= f;
  }
}

static void move(naive *n) {
  const double dt = n->problem->time_step, mass = n->problem->lattice->mass;
  for (particle *p = n->particles; p < n->particles + n->count; p++)
    for (int d = 0; d < n->dimensions; d++) {
      p->v[d] += dt * p->f[d] / mass;
      p->u[d] += dt * p->v[d];
      p->f[d] = 0;
    }
}

/* --- splm_elastic ----------------------------------------------------------------------------- */

static void elastic_step(naive *n) {
  const double s = n->problem->lattice->spacing;
  for (particle *i = n->particles; i < n->particles + n->count; i++) {
    i->sum = 0;
    for (neighbour *b = n->neighbours + i->first; b < n->neighbours + i->first + i->count; b++) {
      b->stretch = stretch_of(i, &n->particles[b->j], b, n->dimensions);
      i->sum += b->length / s * b->stretch;
    }
  }
  for (particle *i = n->particles; i < n->particles + n->count; i++)
    for (neighbour *b = n->neighbours + i->first; b < n->neighbours + i->first + i->count; b++) {
      const double stiffness = b->second_shell ? n->a + n->second : n->a;
      const double force = stiffness * b->stretch + n->b * i->sum;
      push_apart(i, &n->particles[b->j], b, force / 2, n->dimensions, false);
    }
  move(n);
}

/* --- lps -------------------------------------------------------------------------------------- */

static void lps_step(naive *n) {
  const family_problem *p = n->problem;
  const double V = p->lattice->volume, mu = p->E / (2 * (1 + p->nu)),
               k = p->E / (3 * (1 - 2 * p->nu));
  for (particle *i = n->particles; i < n->particles + n->count; i++) {
    i->sum = 0;
    for (neighbour *b = n->neighbours + i->first; b < n->neighbours + i->first + i->count; b++) {
      b->stretch = stretch_of(i, &n->particles[b->j], b, 3);
      if (b->stretch >= p->s_0) b->broken = true;
      if (!b->broken) i->sum += b->length * b->length * b->stretch * V;
    }
    i->sum *= 3 / i->weighted_volume;
  }
  for (particle *i = n->particles; i < n->particles + n->count; i++)
    for (neighbour *b = n->neighbours + i->first; b < n->neighbours + i->first + i->count; b++) {
      if (b->broken) continue;
      const double shape = b->length * (b->stretch - i->sum / 3);
      const double T = (3 * k * i->sum * b->length + 15 * mu * shape) / i->weighted_volume;
      push_apart(i, &n->particles[b->j], b, T * V * V, 3, false);
    }
  move(n);
}

/* --- splm_concrete ---------------------------------------------------------------------------- */

static double series(double p, double q) {
  if (p + q >= 2) return 0;
  return 2 * (1 - p) * (1 - q) / (2 - p - q);
}

static __attribute__((noinline)) double left_of(const naive *n, const particle *i, neighbour *b) {
  const particle *j = &n->particles[b->j];
  b->stretch = stretch_of(i, j, b, 2);
  b->elastic = b->stretch - (b->plastic + n->neighbours[b->back].plastic) / 2;
  b->damage_factor = b->elastic >= 0 ? series(i->w_t, j->w_t) : series(i->w_c, j->w_c);
  return b->damage_factor * b->elastic;
}

/* xx, yy, zz, xy */
typedef struct tensor {
  double xx, yy, zz, xy;
} tensor;

static double first_principal(tensor t) {
  const double half = (t.xx - t.yy) / 2;
  return fmax((t.xx + t.yy) / 2 + sqrt(t.xy * t.xy + half * half), t.zz);
}

static double second_invariant(tensor t) {
  const double mean = (t.xx + t.yy + t.zz) / 3;
  const double x = t.xx - mean, y = t.yy - mean, z = t.zz - mean;
  return (x * x + y * y + z * z) / 2 + t.xy * t.xy;
}

static double tensile_damage(const family_problem *p, double old, double sigma_1, double eps_1) {
  const double cod_c = 2 * p->G_f / (p->f_t * (p->alpha + p->gamma)), cod_1 = p->alpha * cod_c;
  const double cod = 2 * p->lattice->spacing * eps_1;
  double w = 1;
  if (sigma_1 < p->f_t && old <= 0) return old;
  if (cod <= cod_1)
    w = fmax(1 - p->f_t / (p->E * eps_1) * (1 - (1 - p->gamma) * cod / cod_1), 0);
  else if (cod <= cod_c)
    w = 1 - p->gamma * p->f_t / (p->E * eps_1) * (cod_c - cod) / (cod_c - cod_1);
  return fmax(w, old);
}

static double compressive_damage(const family_problem *p, double old, double w_t, bool yielded,
                                 double eps_eff) {
  if (yielded && eps_eff >= p->eps_ult) return 1;
  if (w_t > p->w_cr) return fmax(old, (sqrt(w_t) - sqrt(p->w_cr)) / (1 - sqrt(p->w_cr)));
  return old;
}

/* Stress by virtual work of the elastic forces, strain by the best fit. */
static void find_tensors(const naive *n, const particle *i, tensor *sigma, tensor *eps) {
  const double V = n->problem->lattice->volume, nu = n->problem->nu;
  double sum[3] = {0, 0, 0};
  *sigma = (tensor){0, 0, 0, 0};
  for (neighbour *b = n->neighbours + i->first; b < n->neighbours + i->first + i->count; b++) {
    const double x = b->chord[0] / b->length, y = b->chord[1] / b->length;
    sigma->xx += b->length * b->force * x * x / (2 * V);
    sigma->yy += b->length * b->force * y * y / (2 * V);
    sigma->xy += b->length * b->force * x * y / (2 * V);
    sum[0] += x * x * b->stretch;
    sum[1] += y * y * b->stretch;
    sum[2] += x * y * b->stretch;
  }
  const double *m = i->shape;
  eps->xx = m[0] * sum[0] + m[1] * sum[1] + m[2] * sum[2];
  eps->yy = m[1] * sum[0] + m[3] * sum[1] + m[4] * sum[2];
  eps->xy = (m[2] * sum[0] + m[4] * sum[1] + m[5] * sum[2]) / 2;
  eps->zz = -nu / (1 - nu) * (eps->xx + eps->yy);
}

static void flow(const naive *n, const particle *i, double *increment) {
  double mean = 0, squares = 0;
  for (int k = 0; k < i->count; k++)
    mean += n->neighbours[i->first + k].force / i->count;
  for (int k = 0; k < i->count; k++) {
    const double deviator = n->neighbours[i->first + k].force - mean;
    squares += deviator * deviator;
  }
  const double rate = *increment / fmax(sqrt(squares), 1e-6);
  for (int k = 0; k < i->count; k++)
    increment[k] = rate * (n->neighbours[i->first + k].force - mean);
}

enum { MOST_IN_PLANE = 6 };

static void change_particle(naive *n, particle *i, double increment[MOST_IN_PLANE]) {
  const family_problem *p = n->problem;
  tensor sigma, eps;
  find_tensors(n, i, &sigma, &eps);
  const double eps_eff = sqrt(3 * second_invariant(eps));
  const double F_eff = p->f_y + (p->f_c - p->f_y) * eps_eff / p->eps_ult;
  const double over = second_invariant(sigma) / (F_eff * F_eff / 3) - 1;
  for (int k = 0; k < MOST_IN_PLANE; k++)
    increment[k] = 0;
  if (over >= 0) {
    i->yielded = true;
    increment[0] = p->f_y / p->E * over;
    flow(n, i, increment);
  }
  i->w_t = tensile_damage(p, i->w_t, first_principal(sigma), fmax(first_principal(eps), 1e-12));
  i->w_c = compressive_damage(p, i->w_c, i->w_t, i->yielded, eps_eff);
}

static void concrete_step(naive *n) {
  double increment[MOST_IN_PLANE];
  for (particle *i = n->particles; i < n->particles + n->count; i++) {
    i->sum = 0;
    for (neighbour *b = n->neighbours + i->first; b < n->neighbours + i->first + i->count; b++) {
      b->force = left_of(n, i, b);
      i->sum += b->force;
    }
    for (neighbour *b = n->neighbours + i->first; b < n->neighbours + i->first + i->count; b++)
      b->force = n->a * b->force + n->b * i->sum;
  }
  for (particle *i = n->particles; i < n->particles + n->count; i++) {
    change_particle(n, i, increment);
    for (int k = 0; k < i->count; k++) {
      neighbour *b = &n->neighbours[i->first + k];
      particle *j = &n->particles[b->j];
      const double damper = b->damage_factor * n->damper * b->length * stretch_rate_of(i, j, b, 2);
      b->plastic += increment[k];
      push_apart(i, j, b, (b->force + damper) / 2, 2, true);
    }
  }
  move(n);
}

/* --- set-up ----------------------------------------------------------------------------------- */

static void set_law(naive *n) {
  const family_problem *p = n->problem;
  const double s = p->lattice->spacing, t = p->lattice->stiffness_thickness, nu = p->nu;
  if (n->dimensions == 3) {
    n->a = p->E * s * s / (sqrt(2) * (1 + nu));
    n->second = (1 / (2 * sqrt(2)) - 1) * n->a;
    n->b = (3 - 3 / sqrt(2)) * (sqrt(2) - 1) * p->E * s * s * (1 - 4 * nu) /
           (24 * (2 * nu - 1) * (1 + nu));
  } else {
    n->a = 2 * p->E * s * t / (sqrt(3) * (1 + nu));
    n->b = p->E * s * t * (1 - 3 * nu) / (6 * sqrt(3) * (nu * nu - 1));
  }
  n->damper = 2 * p->lattice->mass * p->xi_in * 2 * acos(-1) *
              sqrt(p->E / (3 * (1 - 2 * nu)) / p->rho) / (2 * s);
}

static void add_neighbours(naive *n, int i, int *next) {
  const rows *g = n->problem->lattice;
  const long site = g->particle_site[i];
  n->particles[i].first = *next;
  for (int k = 0; k < 2 * g->directions; k++) {
    const int half = k < g->directions ? k : k - g->directions;
    const long other = rows_partner(g, site, k);
    if (!rows_has_bond(g, k == half ? site : other, half)) continue;
    neighbour b = {.j = g->site_particle[other],
                   .length = g->length[half],
                   .second_shell = g->shell[half] == 2};
    for (int d = 0; d < n->dimensions; d++)
      b.chord[d] = k == half ? g->chord[half][d] : -g->chord[half][d];
    n->particles[i].weighted_volume += b.length * b.length * g->volume;
    n->neighbours[(*next)++] = b;
  }
  n->particles[i].count = *next - n->particles[i].first;
}

static void find_backs(naive *n) {
  for (int i = 0; i < n->count; i++)
    for (int k = 0; k < n->particles[i].count; k++) {
      neighbour *b = &n->neighbours[n->particles[i].first + k];
      b->back = n->particles[b->j].first;
      while (n->neighbours[b->back].j != i)
        b->back++;
    }
}

static void find_shapes(naive *n) {
  const rows *g = n->problem->lattice;
  double *shape[PL_SHAPE_PLANES(3)];
  for (int m = 0; m < PL_SHAPE_PLANES(3); m++)
    shape[m] = must_calloc((size_t)g->size, sizeof(double));
  shape_matrices(g, shape);
  for (int m = 0; m < 6; m++)
    for (long i = 0; i < n->count; i++)
      n->particles[i].shape[m] = shape[m][g->particle_site[i]];
  for (int m = 0; m < PL_SHAPE_PLANES(3); m++)
    free(shape[m]);
}

static void *start(const family_problem *p) {
  naive *n = must_calloc(1, sizeof *n);
  int next = 0;
  n->problem = p;
  n->dimensions = p->lattice->dimensions;
  n->count = p->lattice->particle_count;
  n->particles = must_calloc((size_t)n->count, sizeof *n->particles);
  n->neighbours = must_calloc(2 * (size_t)p->lattice->bond_count, sizeof *n->neighbours);
  for (int i = 0; i < n->count; i++)
    add_neighbours(n, i, &next);
  find_backs(n);
  if (n->dimensions == 2) find_shapes(n);
  set_law(n);
  return n;
}

static void end(void *state) {
  naive *n = state;
  free(n->particles);
  free(n->neighbours);
  free(n);
}

static void set(void *state, const motions *from) {
  naive *n = state;
  for (long i = 0; i < n->count; i++) {
    particle *p = &n->particles[i];
    const long site = n->problem->lattice->particle_site[i];
    for (int d = 0; d < n->dimensions; d++) {
      p->u[d] = from->displacement[d][site];
      p->v[d] = from->velocity[d][site];
    }
    p->w_t = p->w_c = 0;
    p->yielded = false;
    for (int k = 0; k < p->count; k++) {
      n->neighbours[p->first + k].broken = false;
      n->neighbours[p->first + k].plastic = 0;
    }
  }
}

static void get(const void *state, motions *to) {
  const naive *n = state;
  for (long i = 0; i < n->count; i++)
    for (int d = 0; d < n->dimensions; d++) {
      const long site = n->problem->lattice->particle_site[i];
      to->displacement[d][site] = n->particles[i].u[d];
      to->velocity[d][site] = n->particles[i].v[d];
    }
}

static void elastic_advance(void *state, long steps) {
  for (long step = 0; step < steps; step++)
    elastic_step(state);
}
static void concrete_advance(void *state, long steps) {
  for (long step = 0; step < steps; step++)
    concrete_step(state);
}
static void lps_advance(void *state, long steps) {
  for (long step = 0; step < steps; step++)
    lps_step(state);
}

const body_program naive_elastic = {start, end, set, get, elastic_advance};
const body_program naive_concrete = {start, end, set, get, concrete_advance};
const body_program naive_lps = {start, end, set, get, lps_advance};
