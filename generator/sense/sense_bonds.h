/* What a law of bonds does with its memory, in states that a bond reaches from rest: states that
   change nothing or never move, a force that is a step late, softening without memory, a flow that
   misses its limit, a stress that is kept as a state, an energy that lacks what hardening locks
   in. */
#ifndef PERILAT_GENERATOR_SENSE_BONDS_H
#define PERILAT_GENERATOR_SENSE_BONDS_H

#include "generator/sense/sense_bench.h"

void sense_check_bonds(sense_bench *b);

#endif
