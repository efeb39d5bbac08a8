/* The operations of the graph: one row holds all that is known of one but its derivative
   (derive.c). Readers take what they need from the row, so that a function of numbers is added by a
   row here and a rule there. */
#ifndef PERILAT_GENERATOR_OPERATION_H
#define PERILAT_GENERATOR_OPERATION_H

#include <math.h>
#include <stdbool.h>

#include "dsl/base/elementary.h"

/* What holds of a row whatever the operands are. */
enum {
  LOGICAL = 1, /* the result is a truth value, 0 or 1 */
  /* NaN where an operand is; finite where operands are, unless PARTIAL; overflow aside */
  ARITHMETIC = 2,
  COMMUTES = 4,   /* in its first two operands, to the bit */
  PARTIAL = 8,    /* not defined for all numbers: divisions, roots, logarithms, powers */
  MAKES_NAN = 16, /* NaN of some numbers: what is partial, and of very large or infinite angles */
  ODD = 32,       /* f(-x) = -f(x) */
  EVEN = 64,      /* f(-x) = f(x) */
  VANISHES = 128, /* f(0) = 0 */
  RISING = 256,   /* f(x) <= f(y) for x < y, from one end of its image to the other */
  KINKED = 512,   /* has a kink or a jump where its last operand changes sign */
  OVER_FAMILY = 1024, /* its operand has a value for each neighbour */
};

/* As which operation `perilat info` counts it; signs and comparisons are part of what uses them. */
typedef enum operation_count {
  COUNT_NOTHING,
  COUNT_ADDITION,
  COUNT_MULTIPLICATION,
  COUNT_FUSED, /* a multiplication and an addition */
  COUNT_DIVISION,
  COUNT_FUNCTION,
  COUNT_SELECT
} operation_count;

/* Values of a function of any operands lie between these; open: it does not reach them. */
typedef struct operation_image {
  double low, high;
  bool open;
} operation_image;

/* Cycles until the result is there, operations it is made of, and divisions or roots among them, of
   eight doubles on processors with 512-bit vectors (Intel's of 2019 and later); only their ratios
   matter. */
typedef struct operation_price {
  int latency, operations, divisions;
} operation_price;

typedef struct operation {
  /* of the built-in function, if a law can write it; in C: pl_name, or an operator */
  const char *name;
  int arity;
  unsigned traits;
  operation_image image;
  operation_count count;
  int weight; /* additions that it is worth when it is asked what to compute twice */
  operation_price price;
} operation;

#define TRUTH(condition) ((condition) ? 1.0 : 0.0)

/* X(code, name, operands, traits, image, counted as, weight, price, value of a, b, c) */
/* clang-format off */
#define OPERATIONS_OF_NUMBERS(X)                                                                   \
  X(ADD, "add", 2, ARITHMETIC | COMMUTES, IMAGE_ALL, ADDITION, 1, PRICE(4, 1, 0), a + b)           \
  X(SUB, "sub", 2, ARITHMETIC, IMAGE_ALL, ADDITION, 1, PRICE(4, 1, 0), a - b)                      \
  X(MUL, "mul", 2, ARITHMETIC | COMMUTES, IMAGE_ALL, MULTIPLICATION, 1, PRICE(4, 1, 0), a * b)     \
  X(DIV, "div", 2, ARITHMETIC | PARTIAL | MAKES_NAN, IMAGE_ALL, DIVISION, 10, PRICE(24, 3, 1),     \
    a / b)                                                                                         \
  /* a*b + c, rounded once: rewrite_fused */                                                       \
  X(FMA, "fma", 3, ARITHMETIC | COMMUTES, IMAGE_ALL, FUSED, 1, PRICE(4, 1, 0), pl_fma(a, b, c))    \
  X(NEG, "neg", 1, ARITHMETIC | ODD | VANISHES, IMAGE_ALL, NOTHING, 1, PRICE(1, 1, 0), -a)         \
  X(ABS, "abs", 1, ARITHMETIC | EVEN | VANISHES | KINKED, IMAGE_CLOSED(0, INFINITY), NOTHING, 1,   \
    PRICE(1, 1, 0), pl_abs(a))                                                                     \
  X(SQRT, "sqrt", 1, PARTIAL | MAKES_NAN | VANISHES, IMAGE_CLOSED(0, INFINITY), DIVISION, 10,      \
    PRICE(32, 3, 2), pl_sqrt(a))                                                                   \
  X(MIN, "min", 2, ARITHMETIC, IMAGE_ALL, SELECT, 1, PRICE(8, 3, 0), pl_min(a, b))                 \
  X(MAX, "max", 2, ARITHMETIC, IMAGE_ALL, SELECT, 1, PRICE(8, 3, 0), pl_max(a, b))                 \
  X(SIGN, "sign", 1, ODD | VANISHES | KINKED, IMAGE_CLOSED(-1, 1), SELECT, 10, PRICE(6, 4, 0),     \
    pl_sign(a))                                                                                    \
  X(INVERSE_ROOT, "inverse_root", 1, PARTIAL | MAKES_NAN, IMAGE_OPEN(0, INFINITY), FUNCTION, 20,   \
    PRICE(48, 14, 0), pl_inverse_root(a))                                                          \
  X(EXP, "exp", 1, RISING, IMAGE_OPEN(0, INFINITY), FUNCTION, 10, PRICE(75, 25, 0), pl_exp(a))     \
  X(LOG, "log", 1, PARTIAL | MAKES_NAN, IMAGE_ALL, FUNCTION, 10, PRICE(100, 25, 1), pl_log(a))     \
  X(LOG10, "log10", 1, PARTIAL | MAKES_NAN, IMAGE_ALL, FUNCTION, 10, PRICE(115, 35, 1),            \
    pl_log10(a))                                                                                   \
  X(POW, "pow", 2, PARTIAL | MAKES_NAN, IMAGE_ALL, FUNCTION, 10, PRICE(230, 90, 1), pl_pow(a, b))  \
  X(CBRT, "cbrt", 1, ODD | VANISHES | RISING | KINKED, IMAGE_ALL, FUNCTION, 10,                    \
    PRICE(110, 35, 0), pl_cbrt(a))                                                                 \
  X(SIN, "sin", 1, MAKES_NAN | ODD | VANISHES, IMAGE_CLOSED(-1, 1), FUNCTION, 10,                  \
    PRICE(75, 35, 0), pl_sin(a))                                                                   \
  X(COS, "cos", 1, MAKES_NAN | EVEN, IMAGE_CLOSED(-1, 1), FUNCTION, 10, PRICE(75, 35, 0),          \
    pl_cos(a))                                                                                     \
  X(TAN, "tan", 1, MAKES_NAN | ODD | VANISHES, IMAGE_ALL, FUNCTION, 10, PRICE(110, 60, 1),         \
    pl_tan(a))                                                                                     \
  X(ASIN, "asin", 1, PARTIAL | MAKES_NAN | ODD | VANISHES,                                         \
    IMAGE_CLOSED(-M_PI / 2, M_PI / 2), FUNCTION, 10, PRICE(130, 40, 3), pl_asin(a))                \
  X(ACOS, "acos", 1, PARTIAL | MAKES_NAN, IMAGE_CLOSED(0, M_PI), FUNCTION, 10,                     \
    PRICE(130, 45, 3), pl_acos(a))                                                                 \
  X(SINH, "sinh", 1, ODD | VANISHES | RISING, IMAGE_ALL, FUNCTION, 10, PRICE(120, 45, 1),          \
    pl_sinh(a))                                                                                    \
  X(COSH, "cosh", 1, EVEN, IMAGE_CLOSED(1, INFINITY), FUNCTION, 10, PRICE(105, 35, 1),             \
    pl_cosh(a))                                                                                    \
  X(TANH, "tanh", 1, ODD | VANISHES | RISING, IMAGE_OPEN(-1, 1), FUNCTION, 10, PRICE(110, 35, 1),  \
    pl_tanh(a))                                                                                    \
  X(ATAN2, "atan2", 2, KINKED, IMAGE_CLOSED(-M_PI, M_PI), FUNCTION, 10,                            \
    PRICE(100, 50, 1), pl_atan2(a, b))                                                             \
  X(WRAP_ANGLE, "wrap_angle", 1, ODD | VANISHES | KINKED, IMAGE_CLOSED(-M_PI, M_PI),               \
    FUNCTION, 10, PRICE(35, 10, 0), pl_wrap_angle(a))                                              \
  X(LT, "lt", 2, LOGICAL, IMAGE_CLOSED(0, 1), NOTHING, 1, PRICE(4, 1, 0), TRUTH(a < b))            \
  X(LE, "le", 2, LOGICAL, IMAGE_CLOSED(0, 1), NOTHING, 1, PRICE(4, 1, 0), TRUTH(a <= b))           \
  X(EQ, "eq", 2, LOGICAL | COMMUTES, IMAGE_CLOSED(0, 1), NOTHING, 1, PRICE(4, 1, 0),               \
    TRUTH(a == b))                                                                                 \
  X(AND, "and", 2, LOGICAL | COMMUTES, IMAGE_CLOSED(0, 1), NOTHING, 1, PRICE(1, 1, 0),             \
    TRUTH((a != 0.0) & (b != 0.0)))                                                                \
  X(OR, "or", 2, LOGICAL | COMMUTES, IMAGE_CLOSED(0, 1), NOTHING, 1, PRICE(1, 1, 0),               \
    TRUTH((a != 0.0) | (b != 0.0)))                                                                \
  X(NOT, "not", 1, LOGICAL, IMAGE_CLOSED(0, 1), NOTHING, 1, PRICE(1, 1, 0), TRUTH(a == 0.0))       \
  /* a ? b : c; both are evaluated, neither may trap */                                            \
  X(SELECT, "select", 3, 0, IMAGE_ALL, SELECT, 1, PRICE(2, 1, 0), a != 0.0 ? b : c)

/* What has no value of operands alone. X(code, name, operands, traits) */
#define OPERATION_LEAVES(X)                                                                        \
  X(CONSTANT, "constant", 0, 0) X(INPUT, "input", 0, 0)
/* Over the bonds of a particle that exist: 0, -inf, inf where there are none; of the particle at
   the other end, toward me where it is directed. */
#define OPERATIONS_OF_FAMILIES(X)                                                                  \
  X(FAMILY_SUM, "family_sum", 1, OVER_FAMILY) X(FAMILY_MAX, "family_max", 1, OVER_FAMILY)          \
  X(FAMILY_MIN, "family_min", 1, OVER_FAMILY) X(NEIGHBOUR, "neighbour", 1, 0)
/* The root that a search comes to (pl_search): from where, how far to go from IR_FROM_SEARCH,
   whether to go on behind that. */
#define OPERATIONS_OF_SEARCHES(X) X(SEARCH, "search", 3, 0)
/* clang-format on */

typedef enum ir_op {
#define X(code, ...) IR_##code,
  OPERATION_LEAVES(X) OPERATIONS_OF_NUMBERS(X) OPERATIONS_OF_FAMILIES(X) OPERATIONS_OF_SEARCHES(X)
#undef X
      IR_OP_COUNT
} ir_op;

extern const operation operations[IR_OP_COUNT];

static inline bool operation_has(ir_op op, unsigned trait) {
  return (operations[op].traits & trait) != 0;
}

/* The operation of this name, as the built-in functions of laws have it; IR_OP_COUNT: none. */
ir_op operation_named(const char *name);

/* One operation on numbers, as both readers of the IR compute it: comparisons with NaN are false,
   logical results are 0 or 1, select takes `b` where `a` is not 0. Not for inputs, constants, and
   reductions over the family. */
double operation_value(ir_op op, double a, double b, double c);

#endif
