/* States of a bond that go back. */
#ifndef PERILAT_GENERATOR_PHYSICS_HEALING_H
#define PERILAT_GENERATOR_PHYSICS_HEALING_H

#include "generator/check/physics_report.h"

/* A state that scales the forces may not go back toward its initial value (warning). */
void physics_check_healing(physics *p);

#endif
