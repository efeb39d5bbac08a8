/* Inputs of a law's graph: quantities, parameters, fields. */
#ifndef PERILAT_GENERATOR_LOWER_INPUTS_H
#define PERILAT_GENERATOR_LOWER_INPUTS_H

#include "dsl/semantics/law.h"
#include "generator/lower/lowered.h"

/* The input node of a built-in quantity that is one number. Stretch, its rate, theta_i, theta_j,
   twist and length vary from bond to bond; the others are those of a bond class. */
ir_node lower_quantity(ir *g, builtin_quantity q);
/* Components of the end rotations theta_i and theta_j: one in a plane, of bonds that bend in space
   three. */
static inline int lower_bending_axes(const law *l) {
  return l->bends_in_space ? BENDING_AXES : 1;
}
ir_node lower_bending(ir *g, const law *l, builtin_quantity theta, int axis);
/* What plane k of the parameters that differ in space has at a bond, a point or a particle. */
ir_node lower_varying(ir *g, const law *l, const law_variation *v, int k);
/* The input node of parameter or field k. */
ir_node lower_parameter(ir *g, const law *l, int k);
ir_node lower_field(ir *g, const law *l, int k);
/* `dt`, s. */
ir_node lower_advance(ir *g, const law *l);
/* Whether the rule of a state is a flow that returns; whether it is solved for the state, as a rate
   is, too. */
bool lower_is_returned(const symbol *s);
bool lower_is_solved(const symbol *s);
/* previous(field k) where that is so: stands in for field k until all rules are known. */
ir_node lower_kept_field(ir *g, const law *l, int k);
/* 2 in a plane, 3 in space. */
static inline int lower_dimensions(const law *l) {
  return l->setting == SETTING_SPACE ? 3 : 2;
}

/* Component k of a symmetric tensor (xx, yy, zz, xy, yz, xz) is 0 by its plane. */
static inline bool lower_is_none(const law *l, int k) {
  return lower_dimensions(l) == 2 && k >= 4;
}

/* Volume of the particle, m^3: one for all on a lattice, each its own in irregular bodies. */
ir_node lower_volume(ir *g, const law *l);
/* Spacing or horizon, where these are a particle's own; in laws of bonds the mean of both ends'. */
ir_node lower_own_size(ir *g, const law *l, builtin_quantity q);
/* Of families: 1 where the bonds of the particle resolve all strains, else 0. */
ir_node lower_resolved(ir *g, const law *l);
/* Entry (row, column) of the particle's inverse shape matrix, which the runtime keeps as an upper
   triangle. */
ir_node lower_inverse_shape(ir *g, const law *l, int row, int column);

#endif
