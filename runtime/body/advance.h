/* The particles of a row by one step, once the forces of their bonds are known. */
#ifndef PERILAT_RUNTIME_ADVANCE_H
#define PERILAT_RUNTIME_ADVANCE_H

#include "runtime/body/body.h"

/* Velocities after the coming kick, into the block's `next`: force[dof][count of the row] N, N m.
   Not 0 when one is not below its limit. */
int64_t advance_kick(const body *w, const body_block *b, int row,
                     const double *const force[PL_MAX_DOF]);
/* Kick and drift. A row with a bad velocity stays where it is. Where works are kept (body.works)
   the body has the same forces. */
void advance_row(body *w, body_block *b, int row, const double *const force[PL_MAX_DOF]);

#endif
