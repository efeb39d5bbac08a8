/* What both ends of a bond share: values whose mirror image is the value itself, or its opposite.
   Of the example in program.h the other end finds the same stretch and 1/length, the opposite
   direction e, and another theta. Shared is the largest that is dear:

       SHARE_DEAR   1/length            a root; the rest is a few products, cheaper than its memory
       SHARE_MOST   stretch, e_x, e_y   all that follows from it, too: registers and caches hold it

   theta goes over a family and is no value of the bond; it is left as a link. */
#ifndef PERILAT_GENERATOR_PROGRAM_SHARE_H
#define PERILAT_GENERATOR_PROGRAM_SHARE_H

#include "generator/plan/program_builder.h"

/* Values that the ends of bonds share become inputs of the roots, as b->sharing says. */
void program_share(builder *b, segment *wanted);

#endif
