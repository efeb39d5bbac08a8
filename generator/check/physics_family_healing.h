/* States of a body of families that go back. */
#ifndef PERILAT_GENERATOR_PHYSICS_FAMILY_HEALING_H
#define PERILAT_GENERATOR_PHYSICS_FAMILY_HEALING_H

#include "generator/check/physics_family_bench.h"

/* A state that scales the forces may not go back toward its initial value (warning). */
void family_check_healing(family_bench *b);

#endif
