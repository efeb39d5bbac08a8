/* What absent bonds add to sums. Where all that a loop over the neighbours adds up is a product
   with a value that the owner of the bond has left, it is enough that owners leave 0 where the bond
   is absent: then neither end asks in later passes whether it is there. The other factors must be
   finite there, too: what follows without divisions and functions from constants, motion and such
   sums, and links that follow so. Where no run comes, these are what a run left elsewhere, or 0: no
   other program may write them (program_build). */
#ifndef PERILAT_GENERATOR_PROGRAM_ABSENT_H
#define PERILAT_GENERATOR_PROGRAM_ABSENT_H

#include "generator/plan/segment.h"

/* Finds the sums that need not ask for absent bonds, and the shared values that owners leave as 0
   there (segment_root.vanishes). */
void program_find_vanishing(const ir *g, kernel_program *p);

#endif
