/* What laws of families lose in a step, by particle: to states and damage, and to rate terms. */
#ifndef PERILAT_GENERATOR_PLAN_LOSSES_H
#define PERILAT_GENERATOR_PLAN_LOSSES_H

#include "generator/plan/plan.h"

/* Which fields the forces of a step, and the rest state that they are measured from, are those
   of. */
typedef enum force_fields { FORCES_OF_BOTH, FORCES_OF_NEW, FORCES_OF_OLD } force_fields;

/* As lowered: `step` has new fields where the law reads them, `frozen` the old ones. */
force_fields plan_force_fields(const kernel_plan *plan, const lowered_law *step,
                               const lowered_law *frozen);

/* What a law stores and how its forces take it. Nodes that a bond has are of one neighbour. */
typedef struct law_energy {
  const lowered_law *frozen;
  ir_node stored;        /* J of a particle, with the old fields, at zero rate */
  ir_node theta_rate[2]; /* rad/s, of end i and j: in the plane, with rotations; else IR_NONE */
  force_fields forces;
} law_energy;

/* W of a particle's halves of its bonds: what forces at zero rate do as the body moves; of bending
   in space it is left out. */
ir_node plan_still_power(const kernel_plan *plan, const law_energy *of);

/* Of lost[PL_LOSSES] of a particle (J) the first two, given the fields that the step ends with
   (new_fields[fields]).
   False: the power of a bond's rate terms is not known.

   States: what is stored with the old fields less what is with the new ones. Both are those of the
   places of this step; but its forces work over half of the way that led here and half of the one
   to come, and with the other fields they would have been others. That difference, over half of the
   step's way, is what places halfway would give instead, and makes the balance one of second order
   (ledger.h); of bending in space it is left out.
   Rates: the power of what vanishes at zero rate, over the step. */
bool plan_losses(const kernel_plan *plan, const law_energy *of, const ir_node *new_fields,
                 ir_node lost[PL_LOSSES]);

#endif
