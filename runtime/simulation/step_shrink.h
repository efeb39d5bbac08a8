/* Steps that shrink where the bodies become stiffer than they were, or touch (`shrink_every`).

   Looks come every so many steps, after the state was sampled, and when particles come near to
   touch. Each finds the longest stable step of the present state: of a lattice by the largest
   eigenvalue of its stiffness (body_limit.h), of a mesh by its cracks and by the stiffest of its
   points; what links and contact add is as at rest. Where the step is longer than the part of it
   that the run began with (or `step_safety`, if that is more) times the root of 2, or than half way
   from that part to the stable step, it is halved, as often as it takes. It never grows again.

   Where and how often looks come depends on the deck and the state alone: not on threads, nor on
   how a run is cut. */
#ifndef PERILAT_RUNTIME_STEP_SHRINK_H
#define PERILAT_RUNTIME_STEP_SHRINK_H

#include "runtime/simulation/simulation_state.h"

/* Contact looks that far ahead: a part of the smallest spacing. Particles that come nearer than
   this in one planned step touch before they are seen to be near. */
#define STEP_LOOKS_AHEAD 0.05

/* Time for a look, after a whole step; not while a load begins or ends: then after the next one. */
bool step_shrink_due(const simulation *s);
/* A look, on one thread outside of the loop. The run goes bad where the step would be 2^-11 of that
   planned or less. */
void step_shrink_look(simulation *s);
/* At the end of a run, after which no look comes: it goes bad where the last sample found energies
   of no stable step, and steps were too long for the bodies as they are now. */
void step_shrink_settle(simulation *s);
/* From the present state on each planned step is done in 2^halvings parts. */
void step_shrink_to(simulation *s, int64_t halvings, step_cause cause, int number);
/* After the clock was read from a checkpoint: all else that the step is known by. */
void step_shrink_restored(simulation *s);

#endif
