/* Several laws at work on the particles of one body: each finds the forces of its bonds, or its
   share of what bonds bear, into planes of its own (a sweep that is beside); then all are added,
   in the order of the laws, and the particles move. Laws of families, and laws of bonds in their
   form. */
#ifndef PERILAT_RUNTIME_JOINT_H
#define PERILAT_RUNTIME_JOINT_H

#include "runtime/interaction/sweep.h"

/* Owns the body and the parts, all of which are beside. Forces are kept. It has no fields, no
   outputs and no parameters of its own: those are the parts'. */
sweep *joint_new(body *of, sweep *const *parts, int count);
/* Its parts; NULL of any other sweep. */
sweep *const *joint_parts(const sweep *w, int *count);

#endif
