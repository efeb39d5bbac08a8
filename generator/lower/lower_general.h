/* Tensors that need not be symmetric: nine components, those of a symmetric one and then yx, zy,
   zx. Functions of one tensor take symmetric ones, too. What is 0 by the plane stays so: nothing is
   multiplied by it. */
#ifndef PERILAT_GENERATOR_LOWER_GENERAL_H
#define PERILAT_GENERATOR_LOWER_GENERAL_H

#include "generator/lower/lowering.h"

/* Where the component in a row and a column stands. */
int general_place(int row, int column);
/* The same tensor with nine components; 0 is a tensor of zeros. */
components general_of(ir *g, components a);
components general_transpose(components a);
/* (a + transpose(a))/2, with six components. */
components general_symmetric(ir *g, components a);
/* a b of two tensors, one of which may be a vector behind the other. */
components general_product(ir *g, components a, components b);
/* The sum of the products of all components. */
ir_node general_contract(ir *g, components a, components b);
ir_node general_determinant(ir *g, components a);
/* That of the entry in a row and a column, with its sign. */
ir_node general_cofactor(ir *g, const components *a, int row, int column);
/* By cofactors; of a symmetric tensor symmetric. */
components general_inverse(ir *g, components a);
/* R of F = R U. Of a tensor that does not leave the plane in closed form; else by GENERAL_TURNS
   steps of Newton's method, R = (R + R^-T)/2 from F on (Higham 1986), each of which squares
   e = |x - 1|/(x + 1) of every principal stretch x: after them R is off by 2 e^32, which is below
   rounding for stretches from 1/2 to 2. */
enum { GENERAL_TURNS = 5 };
components general_rotation(ir *g, components F);

#endif
