/* The form of a strip that is cut into stages (stages.h): loops over parts of its bonds, one stage
   after the other, and a function that computes again what is not as expected. */
#ifndef PERILAT_GENERATOR_STRIP_CUT_H
#define PERILAT_GENERATOR_STRIP_CUT_H

#include "generator/emit/stages.h"

/* What stands before a pass for which something is expected: its second function is declared. */
void strip_cut_declare(emitter *e, const char *name);
void strip_cut_loops(emitter *e, const stages *s, const char *name);
/* A function for the vectors that hold a bond that exists and is not as expected: computes again,
   with both sides, what the last loop takes from the buffers. */
void strip_cut_unexpected(emitter *e, const stages *s, const char *name);
/* What the loops need where all is as expected. The caller frees it. */
unsigned char *strip_cut_usually_needed(const emitter *e, const stages *s);

#endif
