/* What a law of a continuum does with its memory: states that change nothing or never move, a
   stress that is a step late, an energy that lacks what hardening locks in. */
#ifndef PERILAT_GENERATOR_SENSE_POINTS_H
#define PERILAT_GENERATOR_SENSE_POINTS_H

#include "generator/sense/sense_bench.h"

void sense_check_points(sense_bench *b);

#endif
