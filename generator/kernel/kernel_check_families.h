/* The programs of a compiled kernel for families against the interpreter's, on a random body: a
   run of particles that differ in the bonds they have, some held, displaced from nothing to
   destruction. */
#ifndef PERILAT_GENERATOR_KERNEL_CHECK_FAMILIES_H
#define PERILAT_GENERATOR_KERNEL_CHECK_FAMILIES_H

#include "generator/kernel/kernel_check_strips.h"

/* Runs all passes of its programs over at least `wanted` bonds (absent ones count); returns how
   many. The kernel's run is cut in two, the interpreter's is not: neither is a multiple of what
   they take at a time. */
long kernel_check_families(const law_readers *l, long wanted, uint64_t *seed, comparison *c);

/* The program that is run as the step: with what is lost in it where the law says that. */
const pl_program *kernel_check_step(const pl_law *law);

#endif
