/* What a stage of a loop over bonds costs, by a formula that was fitted to measurements: how long
   the chains of operations are that wait for each other, and how much there is to do. */
#ifndef PERILAT_GENERATOR_STAGE_COST_H
#define PERILAT_GENERATOR_STAGE_COST_H

#include "generator/emit/stages.h"

/* A loop that relies on all that it may. */
enum { RELIES_ON_ALL = RELIES_ON_EXPECTED | RELIES_ON_UNPROTECTED };

/* Cycles into `stage` at which node n is computed; finish[node_count]: those of the lines before
   it. */
int stage_finish(const stages *s, const emitter *e, const int *finish, ir_node n, int stage);
/* Fills in `finish` for the stage's lines; mask and taken: [node_count] for its own use. */
stage_cost stage_cost_of(const stages *s, const emitter *e, int *finish, int stage,
                         unsigned char *mask, unsigned char *taken);

#endif
