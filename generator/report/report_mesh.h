/* What a run says of its meshes: before it begins nodes, cells, law, cracks; at its end which cells
   died. */
#ifndef PERILAT_GENERATOR_REPORT_MESH_H
#define PERILAT_GENERATOR_REPORT_MESH_H

#include "dsl/base/json.h"
#include "generator/report/run_state.h"

/* Of the deck's lattice of that number, a &mesh: a line each for the mesh, its law, its cracks. */
void announce_mesh(const run *r, int lattice);
/* How many cells died, and when the first one did; nothing where none did. */
void conclude_deaths(const run *r);
/* The same of all meshes whose cells can die. */
void put_deaths(json *w, const run *r);

#endif
