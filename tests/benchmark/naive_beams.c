#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "tests/benchmark/naive_families.h"

typedef struct neighbour {
  int j;
  double chord[3], length; /* reference: unit vector, m */
  double EA, EI, GJ;
} neighbour;

typedef struct particle {
  double u[3], v[3], f[3];        /* m, m/s, N */
  double theta[3], spin[3], m[3]; /* rotation vector, rad/s, N m */
  int first, count;               /* neighbours */
} particle;

typedef struct naive {
  const family_problem *problem;
  long count;
  particle *particles;
  neighbour *neighbours;
} naive;

/* --- vectors ---------------------------------------------------------------------------------- */

static double dot(const double *a, const double *b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double *a, const double *b, double *c) {
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

/* The unit quaternion of a rotation vector. */
static void quaternion_of(const double *theta, double *q) {
  const double angle = sqrt(dot(theta, theta));
  const double scale = angle > 0 ? sin(angle / 2) / angle : 0.5;
  q[0] = cos(angle / 2);
  for (int d = 0; d < 3; d++)
    q[1 + d] = scale * theta[d];
}

static void vector_of(const double *q, double *theta) {
  const double sine = sqrt(dot(q + 1, q + 1));
  const double scale = sine > 0 ? 2 * atan2(sine, q[0]) / sine : 2;
  for (int d = 0; d < 3; d++)
    theta[d] = scale * q[1 + d];
}

/* a b, after one another: first b. */
static void product(const double *a, const double *b, double *q) {
  double both[3];
  cross(a + 1, b + 1, both);
  q[0] = a[0] * b[0] - dot(a + 1, b + 1);
  for (int d = 0; d < 3; d++)
    q[1 + d] = a[0] * b[1 + d] + b[0] * a[1 + d] + both[d];
}

/* --- bonds ------------------------------------------------------------------------------------ */

typedef struct end {
  double theta[3], h, k; /* against the bond; its moments are carried by h + k theta theta^T */
} end_of_bond;

static __attribute__((noinline)) end_of_bond end_at(const double *q, const neighbour *n,
                                                    const double *e, const double *d, double l) {
  double once[3], twice[3], dn[3], chord[3], across[3], moved[3], sine[3], cosine = 0;
  end_of_bond t;
  cross(q + 1, n->chord, once);
  cross(q + 1, once, twice);
  for (int a = 0; a < 3; a++) {
    dn[a] = 2 * (q[0] * once[a] + twice[a]);
    chord[a] = l * e[a];
    cosine += e[a] * (n->chord[a] + dn[a]);
  }
  cross(chord, dn, across);
  cross(d, n->chord, moved);
  for (int a = 0; a < 3; a++)
    sine[a] = (across[a] + moved[a]) / l;
  const double size = sqrt(dot(sine, sine)), angle = atan2(size, cosine);
  for (int a = 0; a < 3; a++)
    t.theta[a] = size > 0 ? angle / size * sine[a] : 0;
  t.h = angle > 0 ? angle * cosine / size : 1;
  t.k = angle > 1e-3 ? (1 - t.h) / (angle * angle) : 1.0 / 3 + angle * angle / 45;
  return t;
}

static void carried(const end_of_bond *t, const double *M, double *m) {
  const double along = t->k * dot(t->theta, M);
  for (int d = 0; d < 3; d++)
    m[d] = t->h * M[d] + along * t->theta[d];
}

/* What the bond does to i. */
static __attribute__((noinline)) void act(particle *i, const particle *j, const neighbour *n) {
  double d[3], e[3], square = 0, q_i[4], q_j[4], back[4], q[4], difference = 0;
  for (int a = 0; a < 3; a++) {
    d[a] = j->u[a] - i->u[a];
    e[a] = n->length * n->chord[a] + d[a];
    square += e[a] * e[a];
    difference += d[a] * (n->length * n->chord[a] + e[a]);
  }
  const double l = sqrt(square), s = n->length, stretch = difference / (s * (l + s));
  for (int a = 0; a < 3; a++)
    e[a] /= l;
  quaternion_of(i->theta, q_i);
  quaternion_of(j->theta, q_j);
  const end_of_bond at_i = end_at(q_i, n, e, d, l), at_j = end_at(q_j, n, e, d, l);
  for (int a = 0; a < 4; a++)
    back[a] = a ? -q_i[a] : q_i[a];
  product(q_j, back, q);
  const double sine = dot(q + 1, e), T = n->GJ / s * 2 * asin(sine), u = 1 / sqrt(1 - sine * sine);
  double M_i[3], M_j[3], m_i[3], m_j[3], turn[3], cross_i[3], cross_j[3], sum[3], couple[3];
  for (int a = 0; a < 3; a++) {
    M_i[a] = 2 * n->EI / s * (2 * at_i.theta[a] + at_j.theta[a]);
    M_j[a] = 2 * n->EI / s * (2 * at_j.theta[a] + at_i.theta[a]);
  }
  carried(&at_i, M_i, m_i);
  carried(&at_j, M_j, m_j);
  cross(q + 1, e, turn);
  cross(at_i.theta, e, cross_i);
  cross(at_j.theta, e, cross_j);
  const double about = T * u * q[0] + (dot(M_i, cross_i) - dot(M_j, cross_j)) / 2;
  for (int a = 0; a < 3; a++)
    sum[a] = m_i[a] + m_j[a] + 2 * T * u * turn[a];
  cross(sum, e, couple);
  for (int a = 0; a < 3; a++) {
    i->f[a] += n->EA * stretch * e[a] - couple[a] / l;
    i->m[a] += about * e[a] - m_i[a] - T * u * turn[a];
  }
}

static void move(naive *n) {
  const rows *g = n->problem->lattice;
  const double dt = n->problem->time_step;
  for (particle *p = n->particles; p < n->particles + n->count; p++) {
    double way[3], step[4], here[4], next[4];
    for (int d = 0; d < 3; d++) {
      p->v[d] += dt * p->f[d] / g->mass;
      p->u[d] += dt * p->v[d];
      p->spin[d] += dt * p->m[d] / g->inertia;
      way[d] = dt * p->spin[d];
      p->f[d] = p->m[d] = 0;
    }
    quaternion_of(way, step);
    quaternion_of(p->theta, here);
    product(step, here, next);
    vector_of(next, p->theta);
  }
}

static void advance(void *state, long steps) {
  naive *n = state;
  for (long step = 0; step < steps; step++) {
    for (particle *i = n->particles; i < n->particles + n->count; i++)
      for (neighbour *b = n->neighbours + i->first; b < n->neighbours + i->first + i->count; b++)
        act(i, &n->particles[b->j], b);
    move(n);
  }
}

/* --- set-up ----------------------------------------------------------------------------------- */

static void set_bond(const naive *n, neighbour *b, int k) {
  const family_problem *p = n->problem;
  const rows *g = p->lattice;
  const double lambda = p->E * p->nu / ((1 + p->nu) * (1 - 2 * p->nu)),
               mu = p->E / (2 * (1 + p->nu)), part = g->shell[k % g->directions] == 1 ? 1 : 0.25;
  const double across = part * 2 * sqrt(2) / 5 * g->spacing * (mu - lambda),
               along = across + part * sqrt(2) * g->spacing * lambda;
  b->EA = along * b->length;
  b->EI = across * b->length * b->length * b->length / 12;
  b->GJ = b->EI / (1 + p->nu);
}

static void *start(const family_problem *p) {
  const rows *g = p->lattice;
  naive *n = must_calloc(1, sizeof *n);
  n->problem = p;
  n->count = g->particle_count;
  n->particles = must_calloc((size_t)n->count, sizeof *n->particles);
  n->neighbours = must_calloc(2 * (size_t)g->bond_count, sizeof *n->neighbours);
  int next = 0;
  for (long i = 0; i < n->count; i++) {
    const long site = g->particle_site[i];
    n->particles[i].first = next;
    for (int k = 0; k < 2 * g->directions; k++) {
      if (!rows_has_neighbour(g, site, k)) continue;
      neighbour *b = &n->neighbours[next++];
      b->j = g->site_particle[rows_partner(g, site, k)];
      b->length = rows_chord(g, site, k, b->chord);
      for (int d = 0; d < 3; d++)
        b->chord[d] /= b->length;
      set_bond(n, b, k);
    }
    n->particles[i].count = next - n->particles[i].first;
  }
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
    const long q = n->problem->lattice->particle_site[i];
    particle *p = &n->particles[i];
    for (int d = 0; d < 3; d++) {
      p->u[d] = from->displacement[d][q];
      p->v[d] = from->velocity[d][q];
      p->theta[d] = from->displacement[3 + d][q];
      p->spin[d] = from->velocity[3 + d][q];
      p->f[d] = p->m[d] = 0;
    }
  }
}

static void get(const void *state, motions *to) {
  const naive *n = state;
  for (long i = 0; i < n->count; i++) {
    const long q = n->problem->lattice->particle_site[i];
    const particle *p = &n->particles[i];
    for (int d = 0; d < 3; d++) {
      to->displacement[d][q] = p->u[d];
      to->velocity[d][q] = p->v[d];
      to->displacement[3 + d][q] = p->theta[d];
      to->velocity[3 + d][q] = p->spin[d];
    }
  }
}

const body_program naive_beams = {start, end, set, get, advance};
