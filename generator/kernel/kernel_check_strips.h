/* The strip functions of a compiled kernel against the interpreter's, on random bonds: absent and
   protected ones, turned by several revolutions, stretched from nothing to destruction. */
#ifndef PERILAT_GENERATOR_KERNEL_CHECK_STRIPS_H
#define PERILAT_GENERATOR_KERNEL_CHECK_STRIPS_H

#include "generator/interpreter/comparison.h"
#include "runtime/kernel.h"

/* One law read twice: the compiled kernel, then the interpreter. */
typedef struct law_readers {
  const pl_law *law[2];
  double *uniforms[2];        /* of `prepare`: [classes][uniform_count] */
  const pl_bond_class *bonds; /* [classes] one; in laws of families one for each neighbour */
  int classes;
  const double *parameters; /* those that differ from bond to bond are drawn around these */
} law_readers;

/* Runs all six strip functions on at least `wanted` bonds each; returns how many. A list's count is
   no multiple of PL_LANES. */
long kernel_check_strips(const law_readers *l, long wanted, uint64_t *seed, comparison *c);

#endif
