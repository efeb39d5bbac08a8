/* Symmetric tensors and vectors, component by component. */
#ifndef PERILAT_GENERATOR_LOWER_TENSOR_H
#define PERILAT_GENERATOR_LOWER_TENSOR_H

#include "generator/lower/lowering.h"

bool tensor_is_deviator(const ir *g, const components *a);
/* `a`, whose trace is 0. */
components tensor_as_deviator(ir *g, components a);
/* After something linear has been done to each component, the same to all: a deviator stays one; of
   another tensor the trace is no longer known. */
components tensor_settled(ir *g, components a);
/* What is 0 stays so, whatever the factor: in the plane nothing leaves it. */
ir_node tensor_scaled(ir *g, ir_node factor, ir_node component);
/* a : b, of vectors a . b. */
ir_node tensor_contract(ir *g, components a, components b);
ir_node tensor_trace(ir *g, components a);
/* A deviator is its own. */
components tensor_deviator(ir *g, components a);
/* Half of the deviator's square. */
ir_node tensor_J2(ir *g, components a);
/* Principal value `which` of 1, 2, 3; the largest is the first. */
ir_node tensor_principal(ir *g, components a, int which);
/* Stress of a strain. */
components tensor_hooke(ir *g, law_setting setting, components eps, ir_node E, ir_node nu);
/* `a op b`, one of which may be a number. */
components tensor_binary(lowering *c, const expr *e, components a, components b);

#endif
