/* How far a result is to be trusted: warnings of steps too long, of energies that are missing or
   given, of increments too large, of faces that overlap, of damage at the edge of a mesh. */
#ifndef PERILAT_GENERATOR_REPORT_TRUST_H
#define PERILAT_GENERATOR_REPORT_TRUST_H

#include "generator/report/run_state.h"

/* Of the largest energy: more than this missing or too much is warned of, with these words, where
   the law says that it keeps energy. */
#define MUCH_IMBALANCE   0.05
#define IMBALANCE_WARNED "the energies do not add up"

/* Steps that have become too long for a mesh, as its points became stiffer or its cracks grew: why
   the run may have failed, or a warning. */
void tell_of_steps(const run *r, bool failed);
/* All warnings at the end of a run, to stderr. */
void warn_of_doubts(const run *r);

#endif
