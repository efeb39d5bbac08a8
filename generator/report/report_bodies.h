/* What a run says before it begins of what its bodies consist of: lattices, particles, bars, links
   with their sizes and places; ties and notches. Of meshes: report_mesh.h. */
#ifndef PERILAT_GENERATOR_REPORT_BODIES_H
#define PERILAT_GENERATOR_REPORT_BODIES_H

#include "generator/report/run_state.h"

/* Of the deck's lattice of that number, no &mesh: its particles and bonds. */
void announce_body(const run *r, int lattice);
/* Which of its particles meshes carry along. */
void announce_ties(const run *r, int lattice);
/* How deep its notches are as drawn and from bond to bond. */
void announce_notches(const run *r, int lattice);

#endif
