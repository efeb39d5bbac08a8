/* What the text of a law alone shows: `x**1/2`, angles in degrees, sums of what does not differ
   from neighbour to neighbour. */
#ifndef PERILAT_GENERATOR_SENSE_TEXT_H
#define PERILAT_GENERATOR_SENSE_TEXT_H

#include "generator/sense/sense_bench.h"

void sense_check_text(sense_bench *b);

#endif
