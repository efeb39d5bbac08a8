/* Whether what a law is made of has the Young's modulus and Poisson's ratio that its parameters
   `E` and `nu` name: a perfect lattice of its bonds or families, or a point. */
#ifndef PERILAT_GENERATOR_SENSE_MODULI_H
#define PERILAT_GENERATOR_SENSE_MODULI_H

#include "generator/sense/sense_bench.h"

void sense_check_moduli(sense_bench *b);

#endif
