#include "generator/ir/operation.h"

#include <assert.h>
#include <string.h>

#define IMAGE_ALL                                                                                  \
  { -INFINITY, INFINITY, true }
#define IMAGE_OPEN(low, high)                                                                      \
  { low, high, true }
#define IMAGE_CLOSED(low, high)                                                                    \
  { low, high, false }
#define PRICE(...)                                                                                 \
  { __VA_ARGS__ }

const operation operations[IR_OP_COUNT] = {
#define X(code, name, operands, traits)                                                            \
  [IR_##code] = {name, operands, traits, IMAGE_ALL, 0, 10, {0}},
    OPERATION_LEAVES(X) OPERATIONS_OF_FAMILIES(X) OPERATIONS_OF_SEARCHES(X)
#undef X
#define X(code, name, operands, traits, image, counted, weight, price, value)                      \
  [IR_##code] = {name, operands, traits, image, COUNT_##counted, weight, price},
        OPERATIONS_OF_NUMBERS(X)
#undef X
};

ir_op operation_named(const char *name) {
  ir_op op = IR_ADD;
  while (op < IR_OP_COUNT && strcmp(operations[op].name, name) != 0)
    op++;
  return op;
}

double operation_value(ir_op op, double a, double b, double c) {
  switch (op) {
#define X(code, name, operands, traits, image, counted, weight, price, value)                      \
  case IR_##code:                                                                                  \
    return value;
    OPERATIONS_OF_NUMBERS(X)
#undef X
  default:
    assert(op == IR_ADD && "an operation that is computed from its operands");
    return PL_NAN;
  }
}
