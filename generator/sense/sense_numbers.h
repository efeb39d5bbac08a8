/* Values of parameters that no material has, as Pa for MPa gives them: speeds of waves, strengths
   over the modulus, lengths of fracture, toughness; and whether a strength or a fracture energy is
   what its name says. */
#ifndef PERILAT_GENERATOR_SENSE_NUMBERS_H
#define PERILAT_GENERATOR_SENSE_NUMBERS_H

#include "generator/sense/sense_bench.h"

void sense_check_numbers(sense_bench *b);

#endif
