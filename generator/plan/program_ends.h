/* What either end of a bond has by itself: dear values that follow from the motion, the fields and
   the parameters of one particle alone are computed once for the particle, in an earlier pass, and
   not for each of its bonds.

       quaternion of a rotation vector      of both ends of all bonds: links
       u_j - u_i, exp(-w[j]) of few bonds   stays: of both ends; cheap */
#ifndef PERILAT_GENERATOR_PROGRAM_ENDS_H
#define PERILAT_GENERATOR_PROGRAM_ENDS_H

#include "generator/plan/program_builder.h"

/* Such values become values of the particle in the roots, and links of the neighbour. */
void program_leave_ends(builder *b, segment *roots);

#endif
