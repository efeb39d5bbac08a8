/* Waves in the infinite lattice of equal particles, from its force constants: frequencies and the
   largest stable time step, undamped and damped. Searched over the whole Brillouin zone.
     omega_max = max over k of sqrt(largest eigenvalue of M^-1/2 K(k) M^-1/2)
     dt = 2/omega (sqrt(1 + xi^2) - xi) for the worst mode (Asadollahi 2014, eq 2.75) */
#ifndef PERILAT_RUNTIME_WAVES_H
#define PERILAT_RUNTIME_WAVES_H

#include "runtime/analysis/step_limit.h"
#include "runtime/lattice/rows.h"

enum { WAVES_MOST_DOF = PL_MAX_DOF };

typedef double wave_block[WAVES_MOST_DOF][WAVES_MOST_DOF];

/* Part of K(k) = sum of self + forward e^(i k R) + backward e^(-i k R): what a particle feels from
   its own motion and from those R ahead and behind. */
typedef struct wave_part {
  wave_block self, forward, backward;
} wave_part;

typedef struct wave_term {
  double R[3];                  /* m */
  wave_part stiffness, damping; /* N/m, N, N m; N s/m, ... */
} wave_term;

typedef struct crystal {
  int dimensions, dof; /* what is beyond the dimensions turns */
  int term_count;
  wave_term *terms;
  double scale[WAVES_MOST_DOF]; /* 1/sqrt(mass), 1/sqrt(inertia) */
  double reciprocal[3][3];      /* 1/m */
  bool finite, damped;
} crystal;

/* Of the lattice, with its masses, and `terms` zeros. */
crystal crystal_new(const rows *w, int dof, int terms);
void crystal_free(crystal *c);

/* Vectors that all chords of the lattice are whole multiples of: primitive[dimensions], m. */
void lattice_primitive(const rows *w, double primitive[3][3]);

/* Fills limit, omega_max, damping_ratio, mode (step stays as it is). limit is exact for the
   coupled, damped lattice: the largest step with dt^2 K(k) + 2 dt C(k) <= 4 M at every k. omega_max
   is undamped; damping_ratio and mode are of the wave that rules the limit. Negative stiffness
   counts as none. Without stiffness and damping the limit is infinite; of a lattice that is not
   finite it is 0. */
void waves_limit(const crystal *c, step_limit *out);

/* Largest frequency (rad/s) of all branches at wave vector k (1/m), undamped; NaN when not finite.
   */
double waves_omega(const crystal *c, const double k[3]);

#endif
