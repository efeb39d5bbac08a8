/* Checked law to IR: results, new field values and outputs as functions of parameters, quantities
   and old fields. Functions are expanded at their calls; options are decided; damage is made
   non-decreasing and kept in [0, 1]. */
#ifndef PERILAT_GENERATOR_LOWER_H
#define PERILAT_GENERATOR_LOWER_H

#include "generator/lower/lowered.h"

/* Adds the law's nodes to g. Quantities become inputs IR_FROM_QUANTITY, fields IR_FROM_FIELD.
   Arrays live in `memory`. diff(f, x) and forces derived from `energy W` hold every state and
   damage (old and new) that is not x itself: N = dW/dL = (dW/dstretch)/s, M_i = dW/dtheta_i, M_j =
   dW/dtheta_j `force V` gives M_i = M_j = V L/2. A damage rule that is not a number gives a damage
   that is not a number: it is found, not clamped away. What goes over a family are FAMILY
   operations, what belongs to a neighbour IR_NEIGHBOUR. False with a NOT_SUPPORTED diagnostic for
   what cannot be compiled yet. */
bool lower_law(const law *l, ir *g, lower_mode mode, arena *memory, lowered_law *out,
               diagnostics *d);

/* The same of a law of families (or of bonds, as one of families) whose parameters differ in space:
   inputs IR_FROM_PARTICLE_PARAMETER, or IR_FROM_BOND_PARAMETER. */
bool lower_law_varying(const law *l, ir *g, lower_mode mode, const law_variation *v, arena *memory,
                       lowered_law *out, diagnostics *d);

/* A bound of a parameter as IR over the parameters; infinite without an expression. IR_NONE with a
   diagnostic when it cannot be compiled. */
ir_node lower_bound(ir *g, const law *l, const expr *bound, double infinite, diagnostics *d);

#endif
