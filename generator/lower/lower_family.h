/* What goes over a particle's family. Mechanics: stress by virtual work, sigma = sum(s F n n^T)/(2
   V) (Nikravesh 2017, eq 3.18 with the bond's own length), strain from the stretches by least
   squares over the family. */
#ifndef PERILAT_GENERATOR_LOWER_FAMILY_H
#define PERILAT_GENERATOR_LOWER_FAMILY_H

#include "generator/lower/lowering.h"

/* The values that the neighbour has, toward me where it has one for each of its own neighbours. */
components lower_neighbour(ir *g, components value);
/* Number of bonds of the particle. */
ir_node lower_family_size(ir *g);
/* Unit vector along the reference bond, from i to j. */
components lower_direction(ir *g, const law *l);
/* Whether a force state is in N/m^6, and what it is in N: the bond force, the mean of both sides'
   forces in N, is the sum of both sides' densities times both volumes. */
bool lower_is_per_volumes(dimension d);
ir_node lower_force_of_density(ir *g, const law *l, ir_node density);
/* Whether a built-in function goes over a family or takes tensors; its value, of arguments
   a[e->argument_count]. */
bool lower_is_family_call(const expr *e);
components lower_family_call(lowering *c, const expr *e, const components *a);

#endif
