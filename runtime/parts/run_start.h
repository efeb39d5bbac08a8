/* Stages: what a run leaves in its result for another one, and how a run begins from it. Particles
   are known by their lattice and their place at rest, bonds by their particles and their
   interaction, so that the bodies of the two may differ. */
#ifndef PERILAT_RUNTIME_RUN_START_H
#define PERILAT_RUNTIME_RUN_START_H

#include "runtime/parts/run_contact.h"
#include "runtime/parts/run_stamp.h"
#include "runtime/result/result_state.h"

/* The state after a step: places, velocities, the fields of all laws, where contacts know bonds to
   be lost, and stamps. `step` (s) is that of the run, 0 of one that is quasi-static: its bodies are
   at rest. To be freed by result_state_free. */
result_state *run_state_take(const run_body *bodies, int count, const run_contacts *contacts,
                             const run_stamps *stamps, const deck *k, double step);

/* Puts bodies, contacts and stamps that have begun into the state of the deck's &start; nothing
   without one. Numbers of what does not go on are left in run_body.going; *fingerprint tells states
   from each other. False with diagnostics at the deck's line. */
bool run_start(run_body *bodies, int count, const run_contacts *contacts, run_stamps *stamps,
               const deck *k, uint64_t *fingerprint, diagnostics *d);

#endif
