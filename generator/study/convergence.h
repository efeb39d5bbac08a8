/* Does a computed quantity settle as a size h (a spacing, a step) falls, and to what? From three or
   more sizes: order p and limit Q0 of Q = Q0 + C h^p, and an error bar that joins discretisation
   and scatter over orientations or seeds; or the reason why nothing can be said.

   Three sizes of any ratio give p, C and Q0; more are fitted by least squares, with equal weights
   or weights 1/h, whichever is nearer. The bar is the uncertainty of the finest size (Eca and
   Hoekstra, J. Comput. Phys. 262, 2014, 104-130), put about Q0:

     U = F |Q_finest - Q0| + sigma + |Q_finest - fit|,   F = 1.25 for 0.5 <= p <= 2.1, else 3,

   sigma the standard deviation from the fit; above 2.1 the limit is that of order 2. Here they
   answer a scatter of sigma >= (largest - smallest)/(sizes - 1) with a wider bar, and this does
   with "not converged". Each orientation or seed has a limit of its own, linearised about the mean
   one; the 95 % interval of their mean (Student's t) joins U as a sum of squares. Where several
   keys are crossed, runs that share a value of one are no independent draws: the means over its
   values are, and the widest of these intervals counts. */
#ifndef PERILAT_GENERATOR_CONVERGENCE_H
#define PERILAT_GENERATOR_CONVERGENCE_H

#include <stdbool.h>

/* Values at a size, one an orientation or seed, in the same order at all sizes; NaN: it failed. */
typedef struct convergence_level {
  double size;
  const char *name; /* as it is shown: "5 mm" */
  const double *values;
  int count;
  const int *const *shared; /* of the first level; of each crossed key the number of each value's */
  int shared_count;
} convergence_level;

typedef struct convergence {
  bool converged;
  double order;          /* NaN: unknown, as where all values are the same */
  double value, error;   /* Q0 and half the width of its bar; NaN where it is not converged */
  double discretisation; /* of the error: of the size, */
  double scatter;        /* and of orientations or seeds */
  char reason[256];      /* why it is not converged, or what is special; else empty */
} convergence;

/* Levels may stand in any order. */
void convergence_find(const convergence_level *levels, int count, convergence *found);

#endif
