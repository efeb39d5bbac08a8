/* What the cracks of a run's meshes have done: in words at its end, and for other programs. */
#ifndef PERILAT_GENERATOR_RUN_CRACKS_H
#define PERILAT_GENERATOR_RUN_CRACKS_H

#include "dsl/base/json.h"
#include "generator/report/run_state.h"

/* Some tip has: what its advances release may have either sign. */
bool cracks_have_grown(const run *r);
/* Of each tip its stress intensities, of one that has grown where it is, of those that are finished
   why; what growth has released; whose faces overlap. Nothing without cracks. */
void conclude_cracks(const run *r);
/* "cracks": [...], "growth": {...} or null. */
void put_cracks(json *w, const run *r);

#endif
