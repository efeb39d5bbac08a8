/* The C compiler, its flags, and the processor that kernels are compiled for. */
#ifndef PERILAT_GENERATOR_TOOLCHAIN_COMPILER_H
#define PERILAT_GENERATOR_TOOLCHAIN_COMPILER_H

#include <stdbool.h>
#include <stddef.h>

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

/* The C compiler in use: $PERILAT_CC, $CC, or the first of cc, gcc, clang on the path; NULL when
   there is none, also when $PERILAT_CC names one that is not there or $PERILAT_PROCESSOR no
   processor. May carry options ("cc -g"). */
const char *toolchain_compiler(void);
/* A sentence that says why there is none. */
const char *toolchain_no_compiler(void);
/* Flags of every kernel: -O3 -fno-math-errno -fno-trapping-math -ffp-contract=off ... and
   -march=$PERILAT_PROCESSOR, otherwise this one. */
const char *toolchain_flags(void);

/* An environment variable without leading blanks; NULL where it is empty or not set. */
const char *toolchain_setting(const char *name);
/* Model and instruction sets of this processor as /proc/cpuinfo has them; empty where there is
   none. */
void toolchain_processor(char *text, size_t size);
/* False with a sentence where kernels are compiled for instructions that are not here. */
bool toolchain_runs_here(char *error, size_t size);

C_LINKAGE_END

#endif
