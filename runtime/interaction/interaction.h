/* Where an engine is picked for a law: the body that a lattice's particles are, and the law at work
   on it. */
#ifndef PERILAT_RUNTIME_INTERACTION_H
#define PERILAT_RUNTIME_INTERACTION_H

#include "runtime/interaction/sweep.h"

/* At rest, fields at their initial values. `ledger`: which energies are kept, and so forces;
   `forces`: somebody looks at the forces of every step. To be freed by sweep_free. */
sweep *interaction_new(const rows *lattice, const pl_law *law, const double *parameters,
                       double time_step, int threads, body_ledger ledger, bool forces);

/* One of several laws at work on a lattice. */
typedef struct interaction_law {
  const pl_law *law;
  const double *parameters;
  double *const *varying; /* as sweep.parameter */
  const rows *lattice;    /* with the bonds that the law is at work on */
  const double *share;    /* as sweep.share */
} interaction_law;

/* Each law beside the others (joint.h); `parts` [count] become the sweeps of each, which belong to
   the one returned. */
sweep *interaction_joint(const rows *lattice, const interaction_law *laws, int count,
                         double time_step, int threads, body_ledger ledger, sweep **parts);

#endif
