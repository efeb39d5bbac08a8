/* Slip and gap: what a law of slip reads, and what its forces are on the bond.

   A bond of such a law leads from a bar to a place in a body, a length s ahead on the bar, and both
   its ends turn with the bar. With the bond's length L and theta, by which the bar's tangent is
   turned against the chord (the mean of both ends' rotations),

        place o---___                      slip = L cos(theta) - s        along the tangent
                     ---___ L              gap  = -L sin(theta)           across it
              bar  o========---> tangent

   A law's N along the tangent and V across it do the work N d(slip) + V d(gap). The bond's axial
   force and end moments are those of the same work: derivatives of slip and gap by the length and
   the rotations. In space gap and V are vectors across the bar, given as theta is. */
#ifndef PERILAT_GENERATOR_LOWER_SLIP_H
#define PERILAT_GENERATOR_LOWER_SLIP_H

#include "generator/lower/lowering.h"

/* SLIP, GAP or SLIP_RATE of stretch, length and end rotations. */
components lower_slip_quantity(lowering *c, builtin_quantity q);

/* An energy whose derivatives at fixed N and V are the bond's forces: they stand in it as inputs,
   which lower_slip_settle puts N and V in place of. */
typedef struct slip_work {
  ir_node energy;
  ir_node stand_in[1 + BENDING_AXES], meant[1 + BENDING_AXES];
  int count;
} slip_work;
slip_work lower_slip_work(lowering *c, ir_node N, const components *V);
ir_node lower_slip_settle(ir *g, const slip_work *w, ir_node force);

#endif
