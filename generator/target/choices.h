/* Choices that a loop need not make, because it relies on what nearly all bonds have in common.

       turned = chord_moves < 1/16 ? series : atan2(...)       expected (ir_expect)
       D      = 0 < protected ? D_old : D_new                  by protection

   A loop that relies on what is expected computes `series` alone, and chord_moves, whose largest
   value is looked at behind the loop; one that relies on no bond being protected computes D_new
   alone. */
#ifndef PERILAT_GENERATOR_CHOICES_H
#define PERILAT_GENERATOR_CHOICES_H

#include "generator/target/expression.h"

/* A condition that is expected of the bonds of a strip: that a size is below a positive limit; or
   without a size any. */
typedef struct expectation {
  ir_node size[2]; /* [count]; of two the larger absolute value is meant */
  int count;
  ir_node limit;
} expectation;

/* A choice by a condition that is expected to hold. */
bool choice_is_expected(const emitter *e, ir_node n);
/* A line that is a choice by whether a bond is protected, of which strips say when none is: then
   its last operand. */
bool choice_is_by_protection(const emitter *e, ir_node n);
/* Two sizes are asked for together where the limit is 2: the highest bit of the exponent tells. */
expectation choice_expectation(const emitter *e, ir_node condition);
/* Operands of node n, operand[3]; in a loop that relies on what is expected, of a choice by an
   expected condition only the value it is expected to choose and what the condition asks about, and
   where no bond is protected, only what others get. Returns their number. */
int choice_operands(const emitter *e, ir_node n, unsigned relies, ir_node operand[3]);
/* Marks what the marked nodes need, too. */
void choice_mark_operands(const emitter *e, unsigned relies, unsigned char *mask);

#endif
