/* Histories of a body of families. */
#ifndef PERILAT_GENERATOR_PHYSICS_FAMILY_PATHS_H
#define PERILAT_GENERATOR_PHYSICS_FAMILY_PATHS_H

#include "generator/check/physics_family_bench.h"

/* Random histories: finite forces, bonds whose particles agree, ranges of damages, continuity,
   flow. */
void family_check_histories(family_bench *b, int legs);
void family_check_dissipation(family_bench *b, int cycles);

#endif
