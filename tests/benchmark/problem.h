/* What every contestant of the benchmark is given: a body on rows, the constants of the bilinear
   micropolar law (Asadollahi 2014, equations 2.49 and 3.1-3.15), a time step, and states of motion
   to start from. */
#ifndef PERILAT_BENCHMARK_PROBLEM_H
#define PERILAT_BENCHMARK_PROBLEM_H

#include "runtime/lattice/rows.h"

typedef struct bilinear_law {
  double E; /* Pa */
  double nu;
  double S_t; /* stretch where softening begins */
  double alpha1, alpha2,
      alpha3; /* force ratio at the knee; stretch ratios at knee and separation */
  double beta, zeta;
  double rate_0; /* 1/s */
} bilinear_law;

typedef struct problem {
  const rows *lattice; /* with mass and inertia */
  bilinear_law law;
  double time_step; /* s */
} problem;

/* Axial force over stretch (N) and moment over curvature (N m^2) of a bond of length s (eq 2.49).
 */
double problem_axial_rigidity(const problem *p);
double problem_bending_rigidity(const problem *p);

/* Everything that a step depends on, in the order of the lattice's sites. */
typedef struct motion {
  double *displacement[3], *velocity[3]; /* [size] m, m, rad; m/s, m/s, rad/s */
  double *damage;                        /* [directions * size], where bonds are */
} motion;

motion motion_new(const rows *lattice);
void motion_free(motion *m);

/* Virgin bonds; each particle is moved and turned at random so that bonds stretch by about
   `stretch`, and flies at a random velocity that would stretch them as much within some steps. On
   top the body is turned about its middle by `turn`. The same numbers whenever and wherever it is
   called. */
void motion_start(motion *m, const problem *p, double stretch, double turn);

/* Largest difference of two motions of the present particles and bonds, relative to the largest
   velocity of a kind (translation, rotation) or, for damage, to 1. NaN counts as infinite. */
double motion_difference(const motion *a, const motion *b, const rows *lattice);

/* Share of the bonds with damage above `least`. */
double motion_damaged(const motion *m, const rows *lattice, double least);

#endif
