/* What every contestant of the benchmark of families is given: a body on rows, the constants of the
   state-based laws that come along, a time step, and states of motion to start from. */
#ifndef PERILAT_BENCHMARK_FAMILY_PROBLEM_H
#define PERILAT_BENCHMARK_FAMILY_PROBLEM_H

#include "runtime/lattice/rows.h"

/* X(parameter of splm_elastic, splm_concrete or lps); those that a law lacks are 0 */
#define FAMILY_PARAMETERS(X)                                                                       \
  X(E) X(nu) X(rho) X(f_t) X(f_c) X(f_y) X(eps_ult) X(G_f) X(alpha) X(gamma) X(w_cr) X(xi_in) X(s_0)

typedef struct family_problem {
  const rows *lattice; /* with mass; no particle is protected */
  double time_step;    /* s */
#define X(name) double name;
  FAMILY_PARAMETERS(X)
#undef X
} family_problem;

/* In the order of the lattice's sites. */
typedef struct motions {
  int dimensions, dof; /* what is beyond the dimensions turns */
  /* [size] m, rad; m/s, rad/s; 0 where no particle is */
  double *displacement[PL_MAX_DOF], *velocity[PL_MAX_DOF];
} motions;

motions motions_new(const rows *lattice, int dof);
void motions_free(motions *m);

/* Each particle is moved at random by up to `stretch` spacings in each direction and turned by as
   many rad, and flies at a random velocity that takes it as far within some steps. The same numbers
   whenever and wherever it is called. */
void motions_start(motions *m, const family_problem *p, double stretch);

/* To and from displacements in spacings and velocities in spacings a step; rotations are left out.
   */
void motions_scale(double *const *u, double *const *v, const motions *from,
                   const family_problem *p);
void motions_unscale(motions *to, double *const *u, double *const *v, const family_problem *p);

/* Largest difference of two displacements, relative to the largest displacement of `a`; of
   velocities likewise, and of rotations; the largest of these. Of particles that are further than
   `margin` spacings from the outline of a body that is a rectangle or box. NaN counts as infinite;
   without particles 0. */
double motions_difference(const motions *a, const motions *b, const rows *lattice, double margin);

/* A program that moves such a body: memory is its own; `set` starts with virgin fields. */
typedef struct body_program {
  void *(*start)(const family_problem *p); /* p stays until the end */
  void (*end)(void *state);
  void (*set)(void *state, const motions *from);
  void (*get)(const void *state, motions *to);
  void (*advance)(void *state, long steps);
} body_program;

#endif
