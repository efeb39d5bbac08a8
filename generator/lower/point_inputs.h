/* What a law of a continuum is told about its point, and one of cracks about its tip, as inputs of
   its graph. */
#ifndef PERILAT_GENERATOR_POINT_INPUTS_H
#define PERILAT_GENERATOR_POINT_INPUTS_H

#include "dsl/semantics/builtins.h"
#include "dsl/semantics/law.h"
#include "generator/ir/ir.h"

/* Strains, then their rates (1/s), as xx, yy, zz, xy, yz, xz of the tensors; the size of the cell
   (m). */
enum { POINT_STRAINS = 6 };
enum {
  POINT_STRAIN = 0,
  POINT_STRAIN_RATE = POINT_STRAINS,
  POINT_CELL_SIZE = 2 * POINT_STRAINS,
  POINT_INPUTS
};

/* What a law of cracks is told of its tip, in the order of pl_tips. */
enum {
  TIP_K_I,
  TIP_K_II,
  TIP_ENERGY_RELEASE,
  TIP_ANGLE,
  TIP_SPEED,
  TIP_LENGTH,
  TIP_RAYLEIGH_SPEED,
  TIP_SHEAR_SPEED,
  TIP_DILATATIONAL_SPEED,
  TIP_INPUTS
};
/* Of a quantity that laws of cracks have. */
ir_node lower_tip_quantity(ir *g, builtin_quantity q);

/* Component k of the order above that is number `at` of what a kernel reads: in the plane xx, yy,
   xy. */
int point_component(int dimensions, int at);

ir_node point_input_node(ir *g, int input);
/* Component k of the strain, or of its rate, as a law sees it. In the plane those along z are none,
   but zz is an input all the same: what it is follows from the setting (plan_points.h). */
ir_node lower_point_strain(ir *g, const law *l, int k, bool rate);

#endif
