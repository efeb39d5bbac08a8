#include "tests/benchmark/naive.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"

typedef struct particle {
  double u_x, u_y, rotation; /* m, rad */
  double v_x, v_y, spin;     /* m/s, rad/s */
  double f_x, f_y, moment;   /* N, N m */
  double mass, inertia;      /* kg, kg m^2 */
} particle;

typedef struct bond {
  int i, j;
  double chord_x, chord_y, length; /* reference, m */
  double damage;
  bool is_protected;
} bond;

struct naive {
  const problem *problem;
  double EA, EI;
  rows_bond *slots; /* where the lattice keeps the same bonds */
  particle *particles;
  bond *bonds;
  long particle_count, bond_count;
};

naive *naive_new(const problem *p) {
  const rows *g = p->lattice;
  naive *n = must_calloc(1, sizeof *n);
  n->problem = p;
  n->EA = problem_axial_rigidity(p);
  n->EI = problem_bending_rigidity(p);
  n->particle_count = g->particle_count;
  n->bond_count = g->bond_count;
  n->slots = rows_bonds(g);
  n->particles = must_calloc((size_t)n->particle_count, sizeof *n->particles);
  n->bonds = must_calloc((size_t)n->bond_count, sizeof *n->bonds);
  for (long m = 0; m < n->bond_count; m++) {
    const long direction = n->slots[m].slot / g->size, site = n->slots[m].slot % g->size;
    n->bonds[m] = (bond){.i = n->slots[m].i,
                         .j = n->slots[m].j,
                         .chord_x = g->chord[direction][0],
                         .chord_y = g->chord[direction][1],
                         .length = g->length[direction],
                         .is_protected = g->held_bonds[site] >> direction & 1};
  }
  return n;
}

void naive_free(naive *n) {
  free(n->slots);
  free(n->particles);
  free(n->bonds);
  free(n);
}

void naive_set(naive *n, const motion *from) {
  for (long k = 0; k < n->particle_count; k++) {
    const long site = n->problem->lattice->particle_site[k];
    n->particles[k] = (particle){.u_x = from->displacement[0][site],
                                 .u_y = from->displacement[1][site],
                                 .rotation = from->displacement[2][site],
                                 .v_x = from->velocity[0][site],
                                 .v_y = from->velocity[1][site],
                                 .spin = from->velocity[2][site],
                                 .mass = n->problem->lattice->mass,
                                 .inertia = n->problem->lattice->inertia};
  }
  for (long m = 0; m < n->bond_count; m++)
    n->bonds[m].damage = from->damage[n->slots[m].slot];
}

void naive_get(const naive *n, motion *to) {
  for (long k = 0; k < n->particle_count; k++) {
    const long site = n->problem->lattice->particle_site[k];
    const particle *p = &n->particles[k];
    const double u[3] = {p->u_x, p->u_y, p->rotation}, v[3] = {p->v_x, p->v_y, p->spin};
    for (int d = 0; d < 3; d++) {
      to->displacement[d][site] = u[d];
      to->velocity[d][site] = v[d];
    }
  }
  for (long m = 0; m < n->bond_count; m++)
    to->damage[n->slots[m].slot] = n->bonds[m].damage;
}

static double wrap(double angle) {
  while (angle > M_PI)
    angle -= 2 * M_PI;
  while (angle <= -M_PI)
    angle += 2 * M_PI;
  return angle;
}

static double softening(const bilinear_law *law, double strain) {
  if (strain <= law->S_t) return 0;
  if (strain <= law->alpha2 * law->S_t)
    return (law->alpha2 - law->alpha1) / (law->alpha2 - 1) * (strain - law->S_t) / strain;
  if (strain <= law->alpha3 * law->S_t)
    return 1 -
           law->alpha1 / (law->alpha3 - law->alpha2) * (law->alpha3 * law->S_t - strain) / strain;
  return 1;
}

static __attribute__((noinline)) void bond_force(const naive *n, bond *b, particle *i,
                                                 particle *j) {
  const bilinear_law *law = &n->problem->law;
  const double s = b->length;
  const double d_x = j->u_x - i->u_x, d_y = j->u_y - i->u_y;
  const double c_x = b->chord_x + d_x, c_y = b->chord_y + d_y;
  const double length = sqrt(c_x * c_x + c_y * c_y);
  const double e_x = c_x / length, e_y = c_y / length;
  /* (L - s)/s, written so that a small stretch keeps its digits */
  const double stretch = (d_x * (b->chord_x + c_x) + d_y * (b->chord_y + c_y)) / (s * (length + s));
  const double rate = (e_x * (j->v_x - i->v_x) + e_y * (j->v_y - i->v_y)) / s;
  const double chord_rotation =
      atan2(b->chord_x * d_y - b->chord_y * d_x, b->chord_x * c_x + b->chord_y * c_y);
  const double theta_i = wrap(i->rotation - chord_rotation);
  const double theta_j = wrap(j->rotation - chord_rotation);

  const double psi_i = fabs(2 / s * (2 * theta_i + theta_j));
  const double psi_j = fabs(2 / s * (2 * theta_j + theta_i));
  const double strain = stretch + law->beta * s * (psi_i > psi_j ? psi_i : psi_j);
  if (!b->is_protected) {
    const double damage = softening(law, strain);
    if (damage > b->damage) b->damage = damage;
  }

  const double intact = 1 - b->damage;
  const double elastic = intact * n->EA * stretch;
  const double x = rate / law->rate_0;
  const double N = elastic + law->zeta * fabs(elastic) * x / (1 + fabs(x));
  const double M_i = intact * 2 * n->EI / s * (2 * theta_i + theta_j);
  const double M_j = intact * 2 * n->EI / s * (2 * theta_j + theta_i);
  const double V = (M_i + M_j) / length;

  const double f_x = N * e_x + V * e_y, f_y = N * e_y - V * e_x;
  i->f_x += f_x;
  i->f_y += f_y;
  i->moment -= M_i;
  j->f_x -= f_x;
  j->f_y -= f_y;
  j->moment -= M_j;
}

static void move(particle *p, double dt) {
  p->v_x += dt * p->f_x / p->mass;
  p->v_y += dt * p->f_y / p->mass;
  p->spin += dt * p->moment / p->inertia;
  p->u_x += dt * p->v_x;
  p->u_y += dt * p->v_y;
  p->rotation += dt * p->spin;
}

void naive_advance(naive *n, long steps) {
  for (long step = 0; step < steps; step++) {
    for (long k = 0; k < n->particle_count; k++)
      n->particles[k].f_x = n->particles[k].f_y = n->particles[k].moment = 0;
    for (long m = 0; m < n->bond_count; m++) {
      bond *b = &n->bonds[m];
      bond_force(n, b, &n->particles[b->i], &n->particles[b->j]);
    }
    for (long k = 0; k < n->particle_count; k++)
      move(&n->particles[k], n->problem->time_step);
  }
}
