/* Whether a perfect lattice of a law of families resists all motions: those by turns, which a
   gradient over the family does not see, may cost nothing. */
#ifndef PERILAT_GENERATOR_SENSE_MODES_H
#define PERILAT_GENERATOR_SENSE_MODES_H

#include "generator/sense/sense_bench.h"

void sense_check_modes(sense_bench *b);

#endif
