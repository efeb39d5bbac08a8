/* The energy ledger: each term is integrated on its own, so that the imbalance says how far the run
   can be trusted. The terms belong to the state sampled (n). v- and v+ are the velocities half a
   step before and after it.

   - kinetic: the sum of half m v- v+.
   - external: the sum over the steps of force times (v- + v+)/2 dt; of step n half, with v-.
   - dissipated: by mass damping in the same way, by the law as its kernel counts it.

   A law of families states what it stores, not what it loses: dissipated_damage is the work done
   against the forces of the bonds, -f (v- + v+)/2 dt for each step and half of it for step n, less
   the change of the stored energy. It holds all that the law takes, its dampers too, and is only as
   true as that energy; for a law that states none, stored is 0. The imbalance then tests the
   integration, the loads and the damping, not the law.

   For linear springs they balance to rounding whatever the step (summation by parts of the leapfrog
   scheme). */
#ifndef PERILAT_RUNTIME_LEDGER_H
#define PERILAT_RUNTIME_LEDGER_H

#include <stdbool.h>

#include "runtime/loads.h"
#include "runtime/sweep.h"

/* X(code, name) in the order of the history; all in J */
#define LEDGER_TERMS(X)                                                                            \
  X(KINETIC, "energy/kinetic")                                                                     \
  X(STORED, "energy/stored")                                                                       \
  X(DISSIPATED_DAMAGE, "energy/dissipated_damage")                                                 \
  X(DISSIPATED_DAMPING, "energy/dissipated_damping")                                               \
  X(EXTERNAL, "energy/external")                                                                   \
  X(IMBALANCE, "energy/imbalance")

typedef enum ledger_term {
#define X(code, name) LEDGER_##code,
  LEDGER_TERMS(X)
#undef X
      LEDGER_COUNT
} ledger_term;

extern const char *const ledger_names[LEDGER_COUNT];

typedef struct ledger {
  double initial; /* J: kinetic and stored at the first sample */
  double lost;    /* J: laws of families: work against the bonds less stored, then */
  double pending; /* J: damping of the half step before the first sample, which is before the run */
  int64_t begun;
} ledger;

/* Terms of the state after `step` steps; all blocks of the sweep have just been observed. */
void ledger_sample(ledger *g, const sweep *state, const loads *l, long step,
                   double terms[LEDGER_COUNT]);

#endif
