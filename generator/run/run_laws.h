/* The laws of a run: opened and compiled, or built in, with their parameters. */
#ifndef PERILAT_GENERATOR_RUN_LAWS_H
#define PERILAT_GENERATOR_RUN_LAWS_H

#include "generator/report/run_state.h"

/* Opens and compiles the law of an interaction and reads its parameters; what is wrong with them
   leaves them NULL. 0, or an exit status. What a law's own file has to answer for stays in
   models[].said. */
/* The law of a crack of the deck that grows, which stands behind those of the interactions. 0, or
   an exit status. */
int load_crack_law(run *r, int crack);
int load_law(run *r, int interaction);
/* Of the simulation_law that it filled in. */
void free_parameters(simulation_law *l);
/* Only says what is wrong with the law's file and its options: of a material whose lattice is not
   known. */
bool check_law_alone(run *r, const deck_material *m);
/* The physics checks with the deck's parameters, also those of regions, on its lattice, which must
   have been built where particles stand on none. */
bool obeys_mechanics(run *r, int interaction);

#endif
