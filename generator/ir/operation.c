#include "generator/ir/operation.h"

#include <assert.h>

/* All but the two leaves and what a family or a neighbour is asked. */
#define X(code, value) +1
_Static_assert(0 OPERATION_VALUES(X) == IR_OP_COUNT - 6, "each operation has a value");
#undef X

double operation_value(ir_op op, double a, double b, double c) {
  switch (op) {
#define X(code, value)                                                                             \
  case IR_##code:                                                                                  \
    return value;
    OPERATION_VALUES(X)
#undef X
  default:
    assert(op == IR_ADD && "an operation that is computed from its operands");
    return PL_NAN;
  }
}
