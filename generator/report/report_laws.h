/* What a run says of its laws before it begins: what they imply on the deck's lattice and on the
   body with its edges, and which parameters differ from place to place. */
#ifndef PERILAT_GENERATOR_REPORT_LAWS_H
#define PERILAT_GENERATOR_REPORT_LAWS_H

#include "generator/report/run_state.h"

/* Of those at work on the deck's lattice of that number, a line or a few each. */
void announce_laws(const run *r, int lattice);

#endif
