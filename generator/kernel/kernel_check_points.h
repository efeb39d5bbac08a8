/* Compiled kernels of laws of continua and of cracks against the interpreter, on random points and
   tips. */
#ifndef PERILAT_GENERATOR_KERNEL_CHECK_POINTS_H
#define PERILAT_GENERATOR_KERNEL_CHECK_POINTS_H

#include "generator/kernel/kernel_check.h"

/* readers[0] compiled, readers[1] interpreted, each with its uniforms; `parameters` around which
   those that differ in space are drawn. Strains are log-uniform in
   size from 1e-9 to 0.1, K from 1 to 1e9 Pa m^(1/2). */
void kernel_check_points(const pl_law *const readers[2], const double *const uniforms[2],
                         const double *parameters, long states, uint64_t *seed, comparison *c);

#endif
