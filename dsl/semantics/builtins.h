/* Names the language brings along: lattice and kinematic quantities, functions. One table each. */
#ifndef PERILAT_DSL_BUILTINS_H
#define PERILAT_DSL_BUILTINS_H

#include "dsl/base/c_linkage.h"
#include "dsl/syntax/tree.h"

C_LINKAGE_BEGIN

/* Which kinds of law may read a quantity. */
enum { IN_CENTRAL = 1, IN_MICROPOLAR = 2, IN_STATE = 4, IN_PAIR = 3, IN_ANY = 7 };

/* X(code, name, unit, shape, place, kinds, meaning) */
#define BUILTIN_QUANTITIES(X)                                                                      \
  X(STRETCH, "stretch", "1", SCALAR, BOND, IN_ANY, "change of bond length over reference length")  \
  X(STRETCH_RATE, "stretch_rate", "1/s", SCALAR, BOND, IN_ANY, "time derivative of the stretch")   \
  X(THETA_I, "theta_i", "1", BENDING, BOND, IN_MICROPOLAR, "rotation of end i less the chord's")   \
  X(THETA_J, "theta_j", "1", BENDING, BOND, IN_MICROPOLAR, "rotation of end j less the chord's")   \
  X(TWIST, "twist", "1", SCALAR, BOND, IN_MICROPOLAR,                                              \
    "rotation of end j about the bond less that of end i; 0 in 2D")                                \
  X(LENGTH, "length", "m", SCALAR, BOND, IN_ANY, "present length of the bond")                     \
  X(S, "s", "m", SCALAR, BOND, IN_ANY, "reference length of the bond")                             \
  X(SPACING, "spacing", "m", SCALAR, BODY, IN_ANY, "distance of nearest sites of the lattice")     \
  X(T, "t", "m", SCALAR, BODY, IN_ANY, "thickness used for stiffness")                             \
  X(V, "V", "m^3", SCALAR, PARTICLE, IN_ANY,                                                       \
    "volume of the particle; all have the same on a lattice")                                      \
  X(M_BOND, "m", "kg", SCALAR, BOND, IN_ANY, "smaller mass of the two particles of the bond")      \
  X(M_END_I, "m_i", "kg", SCALAR, BOND, IN_ANY, "mass of particle i")                              \
  X(M_END_J, "m_j", "kg", SCALAR, BOND, IN_ANY, "mass of particle j")                              \
  X(AREA, "area", "m^2", SCALAR, BODY, IN_PAIR, "cross-section of a bar")                          \
  X(SHELL, "shell", "1", SCALAR, BOND, IN_ANY, "shell of the neighbour: 1 nearest, 2 second, ...") \
  X(HORIZON, "horizon", "m", SCALAR, BODY, IN_ANY,                                                 \
    "distance up to which particles are neighbours")                                               \
  X(WEIGHT, "weight", "1", SCALAR, BOND, IN_STATE,                                                 \
    "part of the neighbour's volume that counts: 1 unless the lattice corrects volumes")           \
  X(N_FAMILY, "n", "1", SCALAR, PARTICLE, IN_STATE, "number of bonds of the particle")             \
  X(RESOLVED, "resolved", "1", SCALAR, PARTICLE, IN_STATE,                                         \
    "1 where the particle's bonds resolve all strains, else 0")                                    \
  X(DIRECTION, "direction", "1", VECTOR, BOND, IN_ANY, "unit vector along the reference bond")

typedef enum builtin_quantity {
#define X(code, name, unit, shape, place, kinds, meaning) QUANTITY_##code,
  BUILTIN_QUANTITIES(X)
#undef X
      QUANTITY_COUNT
} builtin_quantity;

/* X(code, name, least arguments, most arguments, meaning) */
#define BUILTIN_FUNCTIONS(X)                                                                       \
  X(ABS, "abs", 1, 1, "absolute value")                                                            \
  X(SQRT, "sqrt", 1, 1, "square root")                                                             \
  X(CBRT, "cbrt", 1, 1, "cube root")                                                               \
  X(EXP, "exp", 1, 1, "exponential of a pure number")                                              \
  X(LOG, "log", 1, 1, "natural logarithm of a pure number")                                        \
  X(SIN, "sin", 1, 1, "sine")                                                                      \
  X(COS, "cos", 1, 1, "cosine")                                                                    \
  X(TAN, "tan", 1, 1, "tangent")                                                                   \
  X(TANH, "tanh", 1, 1, "hyperbolic tangent")                                                      \
  X(ATAN2, "atan2", 2, 2, "angle of the vector (x, y) given as y, x")                              \
  X(SIGN, "sign", 1, 1, "-1, 0 or 1")                                                              \
  X(SOFT_SIGN, "soft_sign", 1, 1, "x/(1 + |x|)")                                                   \
  X(MACAULAY, "positive_part", 1, 1, "max(x, 0)")                                                  \
  X(MIN, "min", 1, 16, "smallest of its arguments, or of x[j] over the family")                    \
  X(MAX, "max", 1, 16, "largest of its arguments, or of x[j] over the family")                     \
  X(NORM, "norm", 1, 1, "magnitude of a bending quantity, vector, tensor or directed quantity")    \
  X(PREVIOUS, "previous", 1, 1, "value of a state or damage at the end of the last step")          \
  X(DIFF, "diff", 2, 2, "symbolic derivative of the first argument by the second")                 \
  X(SUM, "sum", 1, 1, "sum over the family")                                                       \
  X(MEAN, "mean", 1, 2, "mean over the family, with an optional weight")                           \
  X(DEVIATOR, "deviator", 1, 1, "directed quantity less its mean")                                 \
  X(VIRTUAL_WORK, "virtual_work", 1, 1, "stress tensor of a force state")                          \
  X(FIT, "fit", 1, 1, "strain tensor that fits the family's stretches best")                       \
  X(UNIFORM_FORCE, "uniform_force", 1, 1, "force state toward each neighbour of a uniform stress") \
  X(UNIFORM_STRETCH, "uniform_stretch", 1, 1, "stretch toward each neighbour of a uniform strain") \
  X(HOOKE, "hooke", 3, 3, "stress of a strain: hooke(eps, E, nu), isotropic")                      \
  X(PRINCIPAL, "principal", 2, 2, "principal value 1, 2 or 3 of a tensor, largest first")          \
  X(TRACE, "trace", 1, 1, "trace of a tensor")                                                     \
  X(DEV, "dev", 1, 1, "deviator of a tensor")                                                      \
  X(J2, "J2", 1, 1, "second invariant of a stress deviator")                                       \
  X(VON_MISES, "von_mises", 1, 1, "von Mises equivalent of a stress tensor")

typedef enum builtin_function {
#define X(code, name, least, most, meaning) FUNCTION_##code,
  BUILTIN_FUNCTIONS(X)
#undef X
      FUNCTION_COUNT
} builtin_function;

typedef struct builtin_quantity_info {
  const char *name, *unit, *meaning;
  enum shape shape;
  placement place;
  int kinds;
} builtin_quantity_info;

typedef struct builtin_function_info {
  const char *name, *meaning;
  int least, most;
} builtin_function_info;

extern const builtin_quantity_info builtin_quantities[QUANTITY_COUNT];
extern const builtin_function_info builtin_functions[FUNCTION_COUNT];

/* Index of the quantity or function called `name`, or -1. */
int builtin_quantity_find(const char *name);
int builtin_function_find(const char *name);

C_LINKAGE_END

#endif
