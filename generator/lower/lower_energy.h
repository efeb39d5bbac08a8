/* What a law of bonds stores and what its rate terms take; forces of laws of families that give an
   energy. */
#ifndef PERILAT_GENERATOR_LOWER_ENERGY_H
#define PERILAT_GENERATOR_LOWER_ENERGY_H

#include "generator/lower/lowering.h"

/* Stored energy of a bond (J) in a frozen law at zero rate, as a function of its kinematics: the
   law's `energy` if it has one; half of force times deformation where the forces are homogeneous of
   degree one (linear, also piecewise); from the stress-free point where N is affine in the stretch
   alone; otherwise Gauss integration along the straight path from rest (4 points: exact for forces
   up to degree 7). */
ir_node lower_stored_energy(ir *g, const law *l, const lowered_law *frozen);

/* Power (W) of the parts of the results that vanish at zero rate: (N - N at zero rate) dL/dt, and
   the moments' with the given rates of theta_i, theta_j and the twist (rad/s; unused where there
   are none), of bonds that bend in a plane.
   IR_NONE if there are none. */
ir_node lower_rate_power(ir *g, const law *l, const lowered_law *frozen, ir_node theta_rate_i,
                         ir_node theta_rate_j, ir_node twist_rate);

/* Power (W) of the results at zero rate, likewise. */
ir_node lower_still_power(ir *g, const law *l, const lowered_law *frozen, ir_node theta_rate_i,
                          ir_node theta_rate_j, ir_node twist_rate);

/* Force state from `energy W` of a particle (IR_NONE after a message): bonds share it with the
   other side. */
ir_node lower_force_state_of_energy(lowering *c, ir_node W);
/* The same of an energy that reads the displacement `u`: a vector toward each neighbour. */
void lower_force_vector_of_energy(lowering *c, ir_node W, ir_node F[FORCE_AXES]);

#endif
