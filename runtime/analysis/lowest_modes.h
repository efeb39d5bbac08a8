/* The lowest eigenvalues of a sparse symmetric matrix A that has no negative ones but for rounding,
   and their vectors: the method of Lanczos (1950) with (A + shift)^-1 (Ericsson and Ruhe 1980),
   factorised by CHOLMOD, with full reorthogonalisation. A pass from one vector finds each multiple
   eigenvalue once; passes at right angles to all that is known follow until one finds nothing
   lower. Bits depend on the library. */
#ifndef PERILAT_RUNTIME_LOWEST_MODES_H
#define PERILAT_RUNTIME_LOWEST_MODES_H

#include "runtime/analysis/sparse_probe.h"

typedef struct lowest_mode {
  double value;    /* x A x, in more digits than A x has */
  double residual; /* |A x - value x|: an eigenvalue is that near, but for rounding */
  double *vector;  /* [order] of length 1 */
} lowest_mode;

/* Values up to `nothing` are 0: only counted, and no further than LOWEST_MOST_ZEROS. Of the others
   the lowest, ascending: `most`, or as many as there are; their vectors are malloc'ed. Returns
   NULL, or why there are none: "there is not enough memory ..." */
enum { LOWEST_MOST_ZEROS = 12 };
const char *lowest_modes_find(const sparse_matrix *a, double nothing, int most, lowest_mode *modes,
                              int *count, int *zeros);
void lowest_modes_free(lowest_mode *modes, int count);

#endif
