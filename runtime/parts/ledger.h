/* The energy ledger: each term is integrated on its own, so that the imbalance says how far the run
   can be trusted. The terms belong to the state sampled (n). v- and v+ are the velocities half a
   step before and after it.

   - kinetic: the sum of half m v- v+.
   - external: the sum over the steps of force times (v- + v+)/2 dt; of step n half, with v-.
   - dissipated: by mass damping in the same way, by the law as its kernel counts it.
   - rest: what rest states, and fields that change in time, give, as the kernel counts it.

   For linear springs they balance to rounding whatever the step (summation by parts of the leapfrog
   scheme).

   What damage and states take in a step is what is stored with the old fields less what is with the
   new ones. Where is a matter of order. With W(u, d) stored, forces F = dW/du, and the way du of a
   step the work of the mean force of both ends is W(u + du, d) - W(u, d) up to du^3 for fields d
   that stay. Forces of step n are F(u_n, d_n): they work over half of the way that led there, where
   the fields were still d_(n-1). So the balance wants

     lost_n = W(u_n, d_(n-1)) - W(u_n, d_n) - (F(u_n, d_(n-1)) - F(u_n, d_n)) du/2

   which is the difference of the two energies at places halfway, up to du^2. With it the imbalance
   falls with the square of the step, also where damage jumps. Laws of families book so
   (pl_law.ledger; those whose forces are of the old fields with the other sign), and those of
   continua; laws of bonds on strips without the last term: there the imbalance falls with the step.
   So it does where rate terms take energy: they know the velocity v- and are booked with it, while
   they work over the mean of v- and v+; what is missed is about c v^2 dt/4, v being how fast a
   damper c now moves.

   A rest state r from which deformations are measured, and fields that the deck changes in time,
   are booked in the same way: as a step ends they are what they are then, and stored energy has
   changed by what no force has done,

     given_n = W(u_n, r_n) - W(u_n, r_(n-1)) - (F(u_n, r_n) - F(u_n, r_(n-1))) du/2

   of laws of bonds on strips, too (plan_given.h). It is -F dr up to third order, F being the mean
   force of the step.

   Of a law that does not say what it stores, or of families what it takes, nothing can be balanced:
   dissipated_damage is then the work done against the forces of the bonds, -f (v- + v+)/2 dt for
   each step and half of it for step n, less the change of the stored energy. It holds all that the
   law takes, its dampers too, what changing rest states have not given, and the error of the steps;
   the imbalance would be 0 by definition, and is NaN. */
#ifndef PERILAT_RUNTIME_LEDGER_H
#define PERILAT_RUNTIME_LEDGER_H

#include <stdbool.h>

#include "runtime/interaction/sweep.h"
#include "runtime/loads/load_steps.h"

/* X(code, name, words) in the order of the history; all in J */
#define LEDGER_TERMS(X)                                                                            \
  X(KINETIC, "energy/kinetic", "kinetic energy")                                                   \
  X(STORED, "energy/stored", "energy stored in the bonds")                                         \
  X(DISSIPATED_DAMAGE, "energy/dissipated_damage",                                                 \
    "energy dissipated by damage and states of the law")                                           \
  X(DISSIPATED_DAMPING, "energy/dissipated_damping",                                               \
    "energy dissipated by mass damping and rate terms of the law")                                 \
  X(EXTERNAL, "energy/external", "work of loads and drives")                                       \
  X(REST, "energy/rest", "work of rest states and fields that change")                             \
  X(IMBALANCE, "energy/imbalance", "work of loads, drives and rest states less all other energies")

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
  double carried[LEDGER_COUNT]; /* J: what a change of the step has left out, so that terms go on */
} ledger;

/* Why the imbalance of a run with this law says nothing, as the end of a sentence; NULL where it
   does. `kept`: losses of laws of families are. */
const char *ledger_unchecked(const pl_law *law, bool kept);

/* What the laws at work on a body say of their energies. */
typedef struct ledger_laws {
  const char *unchecked; /* as of one law */
  bool families;         /* some are laws of families */
  bool silent;           /* some say nothing of what they store */
  bool reads_rates;
} ledger_laws;
/* Why the imbalance says nothing; NULL where it does. */
const char *ledger_why(const ledger_laws *of);
void ledger_add_law(ledger_laws *of, const pl_law *law, bool kept);

/* Terms of the state observed last. False where the steps make energy. With the velocity v of the
   state and the forces f of bonds alone half m v- v+ = half m v^2 - (dt f)^2/(8 m), and bonds that
   are not stiffer than virgin ones store at least f^2/(2 m omega^2): so the sum of half m v- v+ and
   (dt omega/2)^2 of what is stored is never negative. (That of both, with a factor of 1, would not
   tell: leapfrog steps that are too long leave it as it is while kinetic energy falls below 0
   without end and stored energy rises.) `omega` (rad/s) is the largest frequency that the step was
   chosen by. Bonds may become twice as stiff; a millionth of the largest energy so far is rounding,
   and so is what a strain of 1e-14 takes. Where the stored energy is not known nothing is said. */
bool ledger_sample(ledger *g, const ledger_laws *of, const body *state, const loads *l,
                   const load_look *look, double omega, double terms[LEDGER_COUNT]);
/* The step has changed: the same state was `before` and is `after`, as it is now. Kinetic energies
   half m v- v+ of one state differ by (dt^2 - dt'^2) f^2/(8 m), which is of the second order; from
   now on all is counted from what the new one finds. The works of half a step go on as they were.
   */
void ledger_carry(ledger *g, const double before[LEDGER_COUNT], const double after[LEDGER_COUNT]);
/* The same of a contact: it stores that much (J), and `work` is done on it by the ways of its
   particles. */
void ledger_sample_contact(ledger *g, double stored, double work, double terms[LEDGER_COUNT]);
/* The same of a stamp: of its motion and its contact (J), what it has taken by damping and
   friction, and the work done on it by bodies and by what moves it. */
typedef struct stamp_energies {
  double kinetic, stored, dissipated, work;
} stamp_energies;
void ledger_sample_stamp(ledger *g, const stamp_energies *e, double terms[LEDGER_COUNT]);
/* Of one of several laws at work on a body, in the state observed last: J stored in its bonds;
   taken by its states and damage since the start. NaN where the law does not say it, or it was not
   kept. */
double ledger_stored_by(const sweep *law);
double ledger_taken_by(const sweep *law);
/* The same of a link (run_link.h), whose particles are copies: what moves is the bodies'. `work`
   (J) is done on it by their ways. */
void ledger_sample_link(ledger *g, const ledger_laws *of, const body *state, double work,
                        double terms[LEDGER_COUNT]);

#endif
