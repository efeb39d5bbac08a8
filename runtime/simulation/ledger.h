/* The energy ledger: each term is integrated on its own, so that the imbalance says how far the run
   can be trusted. The terms belong to the state sampled (n). v- and v+ are the velocities half a
   step before and after it.

   - kinetic: the sum of half m v- v+.
   - external: the sum over the steps of force times (v- + v+)/2 dt; of step n half, with v-.
   - dissipated: by mass damping in the same way, by the law as its kernel counts it.

   For linear springs they balance to rounding whatever the step (summation by parts of the leapfrog
   scheme).

   A law of families states what it stores, not what it takes. Where it takes nothing (no states, no
   damage, no rate terms) nothing is dissipated, and the imbalance shows what the steps have lost or
   won. Where it does, dissipated_damage is the work done against the forces of the bonds, -f (v- +
   v+)/2 dt for each step and half of it for step n, less the change of the stored energy. It holds
   all that the law takes, its dampers too, and the error of the steps; the imbalance would be 0 by
   definition, and is NaN. */
#ifndef PERILAT_RUNTIME_LEDGER_H
#define PERILAT_RUNTIME_LEDGER_H

#include <stdbool.h>

#include "runtime/interaction/sweep.h"
#include "runtime/simulation/load_steps.h"

/* X(code, name, words) in the order of the history; all in J */
#define LEDGER_TERMS(X)                                                                            \
  X(KINETIC, "energy/kinetic", "kinetic energy")                                                   \
  X(STORED, "energy/stored", "energy stored in the bonds")                                         \
  X(DISSIPATED_DAMAGE, "energy/dissipated_damage",                                                 \
    "energy dissipated by the law: damage, rate terms")                                            \
  X(DISSIPATED_DAMPING, "energy/dissipated_damping", "energy dissipated by mass damping")          \
  X(EXTERNAL, "energy/external", "work of loads and drives")                                       \
  X(IMBALANCE, "energy/imbalance", "work of loads and drives less all other energies")

typedef enum ledger_term {
#define X(code, name, words) LEDGER_##code,
  LEDGER_TERMS(X)
#undef X
      LEDGER_COUNT
} ledger_term;

extern const char *const ledger_names[LEDGER_COUNT], *const ledger_words[LEDGER_COUNT];

typedef struct ledger {
  double initial; /* J: kinetic and stored at the first sample */
  double lost;    /* J: laws of families: work against the bonds less stored, then */
  double pending; /* J: damping of the half step before the first sample, which is before the run */
  double largest; /* J: of kinetic, stored and external energy, in size, so far */
  int64_t begun;
} ledger;

/* Why the imbalance of a run with this law says nothing, as the end of a sentence; NULL where it
   does. */
const char *ledger_unchecked(const pl_law *law);

/* What the laws at work on a body say of their energies. */
typedef struct ledger_laws {
  const char *unchecked; /* as of one law */
  bool families;         /* some are laws of families */
  bool silent;           /* some say nothing of what they store */
  bool reads_rates;
} ledger_laws;
void ledger_add_law(ledger_laws *of, const pl_law *law);

/* Terms of the state observed last. False where the steps make energy. With the velocity v of the
   state and the forces f of bonds alone half m v- v+ = half m v^2 - (dt f)^2/(8 m), and bonds that
   are not stiffer than virgin ones store at least f^2/(2 m omega^2): so the sum of half m v- v+ and
   (dt omega/2)^2 of what is stored is never negative. (That of both, with a factor of 1, would not
   tell: leapfrog steps that are too long leave it as it is while kinetic energy falls below 0
   without end and stored energy rises.) `omega` (rad/s) is the largest frequency that the step was
   chosen by. Bonds may become twice as stiff; a millionth of the largest energy so far is rounding.
   Where the stored energy is not known nothing is said. */
bool ledger_sample(ledger *g, const ledger_laws *of, const body *state, const loads *l,
                   const load_look *look, double omega, double terms[LEDGER_COUNT]);

#endif
