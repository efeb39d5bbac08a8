/* What a law is given as its rest state changes, or fields that a deck changes in time.

   W(u, r, d) is stored at the deformation u, the rest state r and fields d; forces are F = dW/du.
   In a step r and d change while u goes its way du; the forces work over half of the way with the
   old ones and over half with the new ones, so that up to du^3 what they do not account for is the
   difference of W halfway:

     given = W(u, r', d') - W(u, r, d) - (F(u, r', d') - F(u, r, d)) du/2

   u being where the step has come to (ledger.h). States are booked in two parts: what they take is
   at the rest state of the old ones (plan_losses.h), and what that gives as it follows them is
   here. Where nothing but r moves it is -F dr, the work of the mean force over the change of the
   rest state. */
#ifndef PERILAT_GENERATOR_PLAN_GIVEN_H
#define PERILAT_GENERATOR_PLAN_GIVEN_H

#include "generator/plan/plan.h"
#include "generator/plan/plan_losses.h"

/* Of a bond, a point or a particle. */
typedef struct rest_energy {
  /* J, W, or per m^3: what is stored, and what forces do at rest as the body moves, with the fields
     at hand and a stand-in for the rest state; IR_NONE: not known, or none */
  ir_node stored, power;
  const ir_node *stand_in, *rest; /* [rests]: that, and the rest state of the fields at hand */
  int rests;
  const ir_node *new_fields; /* [law->fields] */
  force_fields forces;       /* of the step, by their rest state, too */
} rest_energy;

/* What is given in a step, J; a constant 0 where nothing is. */
ir_node plan_given_by_rest(const kernel_plan *plan, const rest_energy *of);

/* Whether anything may be: fields change in time, or the rest state reads states. */
bool plan_rest_changes(const kernel_plan *plan, const ir_node *rest, int rests);

#endif
