/* The operations of the graph, each with its name, the number of its operands and its value. */
#ifndef PERILAT_GENERATOR_OPERATION_H
#define PERILAT_GENERATOR_OPERATION_H

#include "dsl/base/elementary.h"

/* X(code, name, arity, logical result) */
#define IR_OPERATIONS(X)                                                                           \
  X(CONSTANT, "constant", 0, 0) X(INPUT, "input", 0, 0)                                            \
  X(ADD, "add", 2, 0) X(SUB, "sub", 2, 0) X(MUL, "mul", 2, 0) X(DIV, "div", 2, 0)                  \
  X(FMA, "fma", 3, 0) /* a*b + c, rounded once: rewrite_fused */                                   \
  X(NEG, "neg", 1, 0) X(ABS, "abs", 1, 0) X(SQRT, "sqrt", 1, 0)                                    \
  X(MIN, "min", 2, 0) X(MAX, "max", 2, 0) X(SIGN, "sign", 1, 0)                                    \
  X(INVERSE_ROOT, "inverse_root", 1, 0) X(EXP, "exp", 1, 0) X(LOG, "log", 1, 0) X(POW, "pow", 2, 0) X(CBRT, "cbrt", 1, 0)\
  X(SIN, "sin", 1, 0) X(COS, "cos", 1, 0) X(TAN, "tan", 1, 0) X(TANH, "tanh", 1, 0)                \
  X(ATAN2, "atan2", 2, 0) X(WRAP_ANGLE, "wrap_angle", 1, 0)                                        \
  X(LT, "lt", 2, 1) X(LE, "le", 2, 1) X(EQ, "eq", 2, 1)                                            \
  X(AND, "and", 2, 1) X(OR, "or", 2, 1) X(NOT, "not", 1, 1)                                        \
  X(SELECT, "select", 3, 0) /* a ? b : c; both are evaluated, neither may trap */                  \
  /* over the bonds of a particle that exist: 0, -inf, inf where there are none */                 \
  X(FAMILY_SUM, "family_sum", 1, 0) X(FAMILY_MAX, "family_max", 1, 0) X(FAMILY_MIN, "family_min", 1, 0)\
  X(NEIGHBOUR, "neighbour", 1, 0) /* of the particle at the other end, toward me where it is directed */

typedef enum ir_op {
#define X(code, name, arity, logical) IR_##code,
  IR_OPERATIONS(X)
#undef X
  IR_OP_COUNT
} ir_op;

#define OPERATION_TRUTH(condition) ((condition) ? 1.0 : 0.0)

/* X(code, value of the operation on a, b, c): of those that are computed from operands alone. */
/* clang-format off */
#define OPERATION_VALUES(X)                                                                        \
  X(ADD, a + b) X(SUB, a - b) X(MUL, a * b) X(DIV, a / b) X(NEG, -a) X(FMA, pl_fma(a, b, c))       \
  X(ABS, pl_abs(a)) X(SQRT, pl_sqrt(a)) X(MIN, pl_min(a, b)) X(MAX, pl_max(a, b))                  \
  X(SIGN, pl_sign(a)) X(INVERSE_ROOT, pl_inverse_root(a)) X(EXP, pl_exp(a)) X(LOG, pl_log(a))      \
  X(POW, pl_pow(a, b))                                                                             \
  X(CBRT, pl_cbrt(a)) X(SIN, pl_sin(a)) X(COS, pl_cos(a)) X(TAN, pl_tan(a)) X(TANH, pl_tanh(a))    \
  X(ATAN2, pl_atan2(a, b)) X(WRAP_ANGLE, pl_wrap_angle(a))                                         \
  X(LT, OPERATION_TRUTH(a < b)) X(LE, OPERATION_TRUTH(a <= b)) X(EQ, OPERATION_TRUTH(a == b))      \
  X(AND, OPERATION_TRUTH((a != 0.0) & (b != 0.0))) X(OR, OPERATION_TRUTH((a != 0.0) | (b != 0.0))) \
  X(NOT, OPERATION_TRUTH(a == 0.0)) X(SELECT, a != 0.0 ? b : c)
/* clang-format on */

/* One operation on numbers, as both readers of the IR compute it: comparisons with NaN are false, logical results are
   0 or 1, select takes `b` where `a` is not 0. Not for inputs, constants, and reductions over the family. */
double operation_value(ir_op op, double a, double b, double c);

#endif
