/* Bodies that turn as a whole, in the plane about z and in space about an oblique axis, and what
   they keep: momentum and angular momentum, of ways and of rotations together. */
#ifndef PERILAT_TESTS_RIGID_MOTION_H
#define PERILAT_TESTS_RIGID_MOTION_H

#include "runtime/body/body.h"
#include "tests/runtime/beam_law.h"

/* A vector of that length along the axis. */
static inline void rigid_axis(int dimensions, double length, double out[3]) {
  const double root = sqrt(14), oblique[3] = {1 / root, 2 / root, 3 / root};
  for (int k = 0; k < 3; k++)
    out[k] = length * (dimensions == 3 ? oblique[k] : k == 2);
}

/* Component of a vector of space that a rotation of the body is. */
static inline int rigid_component(const body *b, int d) {
  return b->dof == 6 ? d - 3 : 2;
}

/* Turned about the origin, and moved by `way` along every axis. */
static inline void rigid_turn(body *b, double angle, double way) {
  for (long p = 0; p < b->lattice->particle_count; p++) {
    const long q = b->lattice->particle_site[p];
    double theta[3], at[3], moved[3];
    rigid_axis(b->dimensions, angle, theta);
    rows_place(b->lattice, q, at);
    beam_turned(theta, at, moved);
    for (int d = 0; d < b->dof; d++)
      b->displacement[d][q] = d < b->dimensions ? moved[d] + way : theta[rigid_component(b, d)];
  }
}

/* Spins at `rate`, flies at `drift` along every axis, and breathes at `part` of the speeds at the
   rim. */
static inline void rigid_spin(body *b, double rate, double drift, double part) {
  const double size = b->lattice->width / 2;
  double omega[3];
  rigid_axis(b->dimensions, rate, omega);
  for (long p = 0; p < b->lattice->particle_count; p++) {
    const long q = b->lattice->particle_site[p];
    double at[3], v[3];
    rows_place(b->lattice, q, at);
    beam_cross(omega, at, v);
    for (int d = 0; d < b->dimensions; d++)
      b->velocity[d][q] = v[d] + drift + part * rate * size * sin(6 * at[d] / size);
    for (int d = b->dimensions; d < b->dof; d++)
      b->velocity[d][q] = omega[rigid_component(b, d)];
  }
}

typedef struct momenta {
  double linear[3], angular[3];
} momenta;

static inline momenta momenta_of(const body *b) {
  momenta m = {{0}, {0}};
  for (long p = 0; p < b->lattice->particle_count; p++) {
    const long q = b->lattice->particle_site[p];
    double at[3], v[3] = {0, 0, 0}, arm[3];
    rows_place(b->lattice, q, at);
    for (int d = 0; d < b->dimensions; d++) {
      at[d] += b->displacement[d][q];
      v[d] = body_mass(b, d, q) * b->velocity[d][q];
    }
    beam_cross(at, v, arm);
    for (int k = 0; k < 3; k++) {
      m.linear[k] += v[k];
      m.angular[k] += arm[k];
    }
    for (int d = b->dimensions; d < b->dof; d++)
      m.angular[rigid_component(b, d)] += body_mass(b, d, q) * b->velocity[d][q];
  }
  return m;
}

static inline double rigid_apart(const double a[3], const double b[3]) {
  const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
  return sqrt(beam_dot(d, d));
}

/* The larger of both changes, over what there was. */
static inline double momenta_apart(const momenta *now, const momenta *before) {
  static const double none[3] = {0, 0, 0};
  return fmax(rigid_apart(now->linear, before->linear) / rigid_apart(before->linear, none),
              rigid_apart(now->angular, before->angular) / rigid_apart(before->angular, none));
}

#endif
