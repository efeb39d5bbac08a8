/* What the language brings along: quantities that laws read, functions. One table each; what
   else a new function needs stands in dsl/README.md, "Modules". */
#ifndef PERILAT_DSL_BUILTINS_H
#define PERILAT_DSL_BUILTINS_H

#include "dsl/base/c_linkage.h"
#include "dsl/syntax/tree.h"

C_LINKAGE_BEGIN

/* Which kinds of law may read a quantity. */
enum {
  IN_CENTRAL = 1,
  IN_MICROPOLAR = 2,
  IN_STATE = 4,
  IN_SLIP = 8,
  IN_CONTINUUM = 16,
  IN_CRACK = 32,
  IN_BOND = IN_CENTRAL | IN_MICROPOLAR | IN_SLIP,
  IN_LATTICE = IN_CENTRAL | IN_MICROPOLAR | IN_STATE,
  IN_ANY = 15, /* bonds and families */
  IN_ALL = IN_ANY | IN_CONTINUUM | IN_CRACK
};

/* Whether it is the same at all times. */
enum { MOVES, FIXED };

/* clang-format off */
/* X(code, name, unit, shape, place, laws that may read it, does it change in time,
     a line of a law that reads it, meaning) */
#define BUILTIN_QUANTITIES(X)                                                                      \
  X(PI, "pi", "1", SCALAR, NOTHING, IN_ALL, FIXED, "x = sin(pi*stretch)",                          \
    "circumference of a circle over its diameter: 3.141592653589793")                              \
  X(STRETCH, "stretch", "1", SCALAR, BOND, IN_LATTICE, MOVES, "x = stretch**2",                    \
    "change of bond length over reference length")                                                 \
  X(STRETCH_RATE, "stretch_rate", "1/s", SCALAR, BOND, IN_LATTICE, MOVES,                          \
    "x = stretch_rate/10 [1/s]", "time derivative of the stretch")                                 \
  X(THETA_I, "theta_i", "1", BENDING, BOND, IN_MICROPOLAR, MOVES, "x = norm(2*theta_i + theta_j)", \
    "rotation of end i less the chord's")                                                          \
  X(THETA_J, "theta_j", "1", BENDING, BOND, IN_MICROPOLAR, MOVES, "x = norm(2*theta_j + theta_i)", \
    "rotation of end j less the chord's")                                                          \
  X(TWIST, "twist", "1", SCALAR, BOND, IN_MICROPOLAR, MOVES, "x = twist/s",                        \
    "rotation of end j about the bond less that of end i; 0 in the plane")                         \
  X(LENGTH, "length", "m", SCALAR, BOND, IN_LATTICE | IN_CRACK, MOVES, "x = length/s - 1",         \
    "present length of the bond; of a crack how long it is")                                       \
  X(S, "s", "m", SCALAR, BOND, IN_ANY, FIXED, "x = 2*s", "reference length of the bond")           \
  X(SPACING, "spacing", "m", SCALAR, BODY, IN_ANY, FIXED, "x = s/spacing",                         \
    "distance of nearest sites of the lattice")                                                    \
  X(T, "t", "m", SCALAR, BODY, IN_ANY, FIXED, "x = s*t", "thickness used for stiffness")           \
  X(V, "V", "m^3", SCALAR, PARTICLE, IN_ANY, FIXED, "x = V/spacing**2",                            \
    "volume of the particle; all have the same on a lattice")                                      \
  X(M_BOND, "m", "kg", SCALAR, BOND, IN_ANY, FIXED, "x = sqrt(EA/s/m)",                            \
    "smaller mass of the two particles of the bond")                                               \
  X(M_END_I, "m_i", "kg", SCALAR, BOND, IN_ANY, FIXED, "x = m_i*m_j/(m_i + m_j)",                  \
    "mass of particle i")                                                                          \
  X(M_END_J, "m_j", "kg", SCALAR, BOND, IN_ANY, FIXED, "x = min(m_i, m_j)/m_j",                    \
    "mass of particle j")                                                                          \
  X(AREA, "area", "m^2", SCALAR, BODY, IN_BOND, FIXED, "x = sqrt(area)",                           \
    "cross-section of a bar")                                                                      \
  X(SHELL, "shell", "1", SCALAR, BOND, IN_LATTICE, FIXED,                                          \
    "x = | 1 when shell == 1 | 0.5 otherwise", "shell of the neighbour: 1 nearest, 2 second, ...") \
  X(HORIZON, "horizon", "m", SCALAR, BODY, IN_LATTICE, FIXED, "x = s/horizon",                     \
    "distance up to which particles are neighbours")                                               \
  X(WEIGHT, "weight", "1", SCALAR, BOND, IN_STATE, FIXED, "x = sum(weight*stretch[j])",            \
    "part of the neighbour's volume that counts: 1 unless the lattice corrects volumes")           \
  X(N_FAMILY, "n", "1", SCALAR, PARTICLE, IN_STATE, FIXED, "x = sum(stretch[j])/n",                \
    "number of bonds of the particle")                                                             \
  X(RESOLVED, "resolved", "1", SCALAR, PARTICLE, IN_STATE, FIXED,                                  \
    "x = | 1 when resolved >= 1 | 0 otherwise",                                                    \
    "1 where the particle's bonds resolve all strains, else 0")                                    \
  X(DIRECTION, "direction", "1", VECTOR, BOND, IN_LATTICE, FIXED, "x = norm(direction)",           \
    "unit vector along the reference bond")                                                        \
  X(U, "u", "m", VECTOR, PARTICLE, IN_STATE, MOVES, "x = trace(gradient(u))",                      \
    "displacement of the particle, in its gradient and in u[j] - u")                               \
  X(SLIP, "slip", "m", SCALAR, BOND, IN_SLIP, MOVES, "x = slip/s",                                 \
    "how far the place has moved along the bar, as its tangent is now")                            \
  X(GAP, "gap", "m", BENDING, BOND, IN_SLIP, MOVES, "x = norm(gap)/s",                             \
    "how far the place has moved across the bar, as its tangent is now")                           \
  X(SLIP_RATE, "slip_rate", "m/s", SCALAR, BOND, IN_SLIP, MOVES, "x = slip_rate/1 [m/s]",          \
    "time derivative of the slip while the gap is small against s")                                \
  X(DT, "dt", "s", SCALAR, BODY, IN_ANY | IN_CONTINUUM, MOVES, "x = dt/1 [s]",                     \
    "by how much the time of the deck has gone on since the last step")                            \
  X(STRAIN, "strain", "1", TENSOR, POINT, IN_CONTINUUM, MOVES, "x = trace(strain)",                \
    "small strain of the point; in plane stress the third one leaves no stress")                   \
  X(STRAIN_RATE, "strain_rate", "1/s", TENSOR, POINT, IN_CONTINUUM, MOVES,                         \
    "x = trace(strain_rate)/10 [1/s]", "time derivative of the strain")                            \
  X(CELL_SIZE, "h", "m", SCALAR, POINT, IN_CONTINUUM, FIXED, "x = h/1 [mm]",                       \
    "size of the cell that the point stands for: in the plane the root of its area, of 3 "         \
    "nodes of twice that")                                                                         \
  X(K_I, "K_I", "Pa*sqrt(m)", SCALAR, TIP, IN_CRACK, MOVES, "x = K_I/K_Ic",                        \
    "stress intensity factor of mode I: opening")                                                  \
  X(K_II, "K_II", "Pa*sqrt(m)", SCALAR, TIP, IN_CRACK, MOVES, "x = K_II/K_Ic",                     \
    "stress intensity factor of mode II: sliding")                                                 \
  X(ENERGY_RELEASE, "energy_release", "N/m", SCALAR, TIP, IN_CRACK, MOVES,                         \
    "x = energy_release/80 [N/m]", "energy release rate of the tip as it runs")                    \
  X(ANGLE_NOW, "angle_now", "1", SCALAR, TIP, IN_CRACK, MOVES, "x = cos(angle_now)",               \
    "direction of the crack's last leg, from x")                                                   \
  X(SPEED_NOW, "speed_now", "m/s", SCALAR, TIP, IN_CRACK, MOVES, "x = speed_now/rayleigh_speed",   \
    "speed of the tip; 0 where it does not run")                                                   \
  X(RAYLEIGH_SPEED, "rayleigh_speed", "m/s", SCALAR, TIP, IN_CRACK, FIXED,                         \
    "x = speed_now/rayleigh_speed", "speed of waves along a surface")                              \
  X(SHEAR_SPEED, "shear_speed", "m/s", SCALAR, TIP, IN_CRACK, FIXED,                               \
    "x = speed_now/shear_speed", "speed of shear waves")                                           \
  X(DILATATIONAL_SPEED, "dilatational_speed", "m/s", SCALAR, TIP, IN_CRACK, FIXED,                 \
    "x = speed_now/dilatational_speed", "speed of dilatational waves")

/* X(code, name, least arguments, most arguments, check of the arguments (calls.c), value, formula,
     a line of a law that calls it, meaning)
   The value, of numbers alone, is ONE(f) of one argument, MANY(f) where f(f(a, b), c) goes on from
   two to many, or NO_VALUE. In the formula (LaTeX) # stands for the argument; without #, it is a
   name before bracketed arguments, and "" is the function's own name. */
#define BUILTIN_FUNCTIONS(X)                                                                       \
  X(ABS, "abs", 1, 1, same_unit, ONE(pl_abs), "\\left|#\\right|", "x = abs(stretch)",              \
    "absolute value")                                                                              \
  X(SQRT, "sqrt", 1, 1, root, ONE(pl_sqrt), "\\sqrt{#}", "x = sqrt(length*s)", "square root")      \
  X(CBRT, "cbrt", 1, 1, root, ONE(pl_cbrt), "\\sqrt[3]{#}", "x = cbrt(V)", "cube root")            \
  X(EXP, "exp", 1, 1, pure, ONE(pl_exp), "\\exp", "x = exp(-stretch/S_t)",                         \
    "exponential of a pure number")                                                                \
  X(LOG, "log", 1, 1, pure, ONE(pl_log), "\\ln", "x = log(1 + stretch)",                           \
    "natural logarithm of a pure number")                                                          \
  X(LOG10, "log10", 1, 1, pure, ONE(pl_log10), "\\log_{10}", "x = log10(1 + stretch)",             \
    "logarithm of a pure number to the base 10")                                                   \
  X(SIN, "sin", 1, 1, pure, ONE(pl_sin), "\\sin", "x = sin(norm(theta_i))", "sine")                \
  X(COS, "cos", 1, 1, pure, ONE(pl_cos), "\\cos", "x = cos(30 [deg])", "cosine")                   \
  X(TAN, "tan", 1, 1, pure, ONE(pl_tan), "\\tan", "x = tan(30 [deg])", "tangent")                  \
  X(ASIN, "asin", 1, 1, pure, ONE(pl_asin), "\\arcsin", "x = asin(min(stretch, 1))",               \
    "angle from -pi/2 to pi/2 whose sine is the argument")                                         \
  X(ACOS, "acos", 1, 1, pure, ONE(pl_acos), "\\arccos", "x = acos(min(stretch, 1))",               \
    "angle from 0 to pi whose cosine is the argument")                                             \
  X(SINH, "sinh", 1, 1, pure, ONE(pl_sinh), "\\sinh", "x = sinh(stretch/S_t)", "hyperbolic sine")  \
  X(COSH, "cosh", 1, 1, pure, ONE(pl_cosh), "\\cosh", "x = cosh(stretch/S_t)",                     \
    "hyperbolic cosine")                                                                           \
  X(TANH, "tanh", 1, 1, pure, ONE(pl_tanh), "\\tanh", "x = tanh(stretch/S_t)",                     \
    "hyperbolic tangent")                                                                          \
  X(ATAN2, "atan2", 2, 2, arctangent, NO_VALUE, "\\operatorname{atan2}",                           \
    "x = atan2(norm(theta_i), stretch)", "angle of the vector (x, y) given as y, x")               \
  X(SIGN, "sign", 1, 1, sign, ONE(pl_sign), "\\operatorname{sign}", "x = sign(stretch)",           \
    "-1, 0 or 1")                                                                                  \
  X(SOFT_SIGN, "soft_sign", 1, 1, pure, ONE(soft_sign), "\\operatorname{soft\\_sign}",             \
    "x = soft_sign(stretch_rate/10 [1/s])", "x/(1 + |x|)")                                         \
  X(MACAULAY, "positive_part", 1, 1, same_unit, ONE(positive_part),                                \
    "\\left\\langle #\\right\\rangle", "x = positive_part(stretch - S_t)", "max(x, 0)")            \
  X(MIN, "min", 1, 16, extreme, MANY(pl_min), "\\min", "x = min(stretch, S_t)",                    \
    "smallest of its arguments, or of x[j] over the family")                                       \
  X(MAX, "max", 1, 16, extreme, MANY(pl_max), "\\max", "x = max(norm(theta_i), norm(theta_j))",    \
    "largest of its arguments, or of x[j] over the family")                                        \
  X(NORM, "norm", 1, 1, norm, NO_VALUE, "\\left\\lVert #\\right\\rVert",                           \
    "x = norm(theta_i + theta_j)",                                                                 \
    "magnitude of a bending quantity, vector or tensor; of a family's values, `norm(F)` or "       \
    "`norm(deviator(F))` without [j], the root of the sum of their squares")                       \
  X(PREVIOUS, "previous", 1, 1, previous, NO_VALUE, "", "x = omega - previous(omega)",             \
    "value of a state or damage at the end of the last step")                                      \
  X(DIFF, "diff", 2, 2, derivative, NO_VALUE, "", "x = diff(stretch**2, stretch)",                 \
    "symbolic derivative of the first argument by the second")                                     \
  X(SUM, "sum", 1, 1, sum, NO_VALUE, "\\sum_{j}\\left(#\\right)", "x = sum(stretch[j])",           \
    "sum over the family")                                                                         \
  X(MEAN, "mean", 1, 2, mean, NO_VALUE, "\\operatorname{mean}_{j}",                                \
    "x = mean(stretch[j], weight = length[j])", "mean over the family, with an optional weight")   \
  X(DEVIATOR, "deviator", 1, 1, deviator, NO_VALUE, "\\operatorname{deviator}",                    \
    "x[j] = deviator(F[j])", "directed quantity less its mean")                                    \
  X(VIRTUAL_WORK, "virtual_work", 1, 1, virtual_work, NO_VALUE, "\\operatorname{virtual\\_work}",  \
    "stress x = virtual_work(F)", "stress tensor of a force state")                                \
  X(FIT, "fit", 1, 1, fit, NO_VALUE, "\\operatorname{fit}", "strain x = fit(stretch)",             \
    "strain tensor that fits the family's stretches best")                                         \
  X(UNIFORM_FORCE, "uniform_force", 1, 1, uniform_force, NO_VALUE, "",                             \
    "x[j] = uniform_force(virtual_work(F))",                                                       \
    "force state toward each neighbour of a uniform stress")                                       \
  X(UNIFORM_STRETCH, "uniform_stretch", 1, 1, uniform_stretch, NO_VALUE, "",                       \
    "x[j] = stretch[j] - uniform_stretch(fit(stretch))",                                           \
    "stretch toward each neighbour of a uniform strain")                                           \
  X(HOOKE, "hooke", 3, 3, hooke, NO_VALUE, "", "stress x = hooke(fit(stretch), 30 [GPa], 0.2)",    \
    "stress of a strain: hooke(eps, E, nu), isotropic")                                            \
  X(PRINCIPAL, "principal", 2, 2, principal, NO_VALUE, "\\operatorname{principal}",                \
    "x = principal(fit(stretch), 1)", "principal value 1, 2 or 3 of a tensor, largest first")      \
  X(TRACE, "trace", 1, 1, tensor_to_scalar, NO_VALUE, "\\operatorname{tr}",                        \
    "x = trace(fit(stretch))", "trace of a tensor")                                                \
  X(DEV, "dev", 1, 1, deviator_of_tensor, NO_VALUE, "\\operatorname{dev}",                         \
    "x = norm(dev(fit(stretch)))", "deviator of a tensor")                                         \
  X(J2, "J2", 1, 1, tensor_to_scalar, NO_VALUE, "J_{2}", "x = J2(virtual_work(F))",                \
    "second invariant of a stress deviator")                                                       \
  X(VON_MISES, "von_mises", 1, 1, tensor_to_scalar, NO_VALUE, "\\operatorname{von\\ Mises}",       \
    "x = von_mises(virtual_work(F))", "von Mises equivalent of a stress tensor")                   \
  X(PRINCIPAL_DIRECTION, "principal_direction", 2, 2, principal_direction, NO_VALUE,               \
    "\\operatorname{direction}", "x = norm(principal_direction(fit(stretch), 1))",                 \
    "tensor n n of the unit vector n along principal value 1, 2 or 3 of a tensor")                 \
  X(PRODUCT, "product", 2, 2, product, NO_VALUE, "\\operatorname{product}",                        \
    "x = trace(product(fit(stretch), fit(stretch)))",                                              \
    "symmetric product (a b + b a)/2 of two tensors")                                              \
  X(VECTOR, LAW_VECTOR, 2, 3, vector_of_components, NO_VALUE, "", "x = norm(vector(1, 0, 0))",     \
    "vector of its components x, y and, where it is not 0, z; `(1, 0, 0)` is the same")            \
  X(DOT, "dot", 2, 2, dot, NO_VALUE, "", "x = dot(direction, (1, 0, 0))",                          \
    "scalar product of two vectors")                                                               \
  X(CROSS, "cross", 2, 2, cross, NO_VALUE, "", "x = norm(cross(direction, (1, 0, 0)))",            \
    "vector product of two vectors")                                                               \
  X(DYAD, "dyad", 2, 2, dyad, NO_VALUE, "\\operatorname{dyad}",                                    \
    "x = trace(dyad((1, 0), (0, 1)))",                                                             \
    "symmetric tensor (a b + b a)/2 of two vectors")                                               \
  X(TENSOR, "tensor", 4, 9, tensor_of_components, NO_VALUE, "\\operatorname{tensor}",              \
    "x = trace(tensor(1, 1, 1, 0))",                                                               \
    "symmetric tensor of its components xx, yy, zz, xy and, where they are not 0, yz, xz; with "   \
    "yx, zy, zx behind them one that need not be symmetric")                                       \
  X(GRADIENT, "gradient", 1, 2, gradient, NO_VALUE, "\\operatorname{grad}",                        \
    "x = trace(gradient(u))",                                                                      \
    "gradient of a particle's number or vector over its family, by least squares; "                \
    "`gradient(u)` is the deformation gradient less 1")                                            \
  X(CORRESPONDENCE, "correspondence", 1, 2, correspondence, NO_VALUE,                              \
    "\\operatorname{correspondence}", "x[j] = norm(correspondence(30 [GPa]*gradient(u)))",         \
    "force state toward each neighbour whose work in `gradient(u)` is that of a stress")           \
  X(TRANSPOSE, "transpose", 1, 1, transpose, NO_VALUE, "",                                         \
    "x = norm(gradient(u) - transpose(gradient(u)))", "transpose of a tensor")                     \
  X(SYM, "sym", 1, 1, sym, NO_VALUE, "\\operatorname{sym}", "x = principal(sym(gradient(u)), 1)",  \
    "symmetric part (a + transpose(a))/2 of a tensor")                                             \
  X(DET, "det", 1, 1, det, NO_VALUE, "\\det", "x = det(tensor(1, 1, 1, 0) + fit(stretch))",        \
    "determinant of a tensor")                                                                     \
  X(INVERSE, "inverse", 1, 1, inverse, NO_VALUE, "",                                               \
    "x = trace(inverse(tensor(1, 1, 1, 0) + fit(stretch)))", "inverse of a tensor")                \
  X(ROTATION, "rotation", 1, 1, rotation, NO_VALUE, "\\operatorname{rotation}",                    \
    "x = norm(rotation(tensor(1, 1, 1, 0) + gradient(u)))",                                        \
    "rotation R of a deformation gradient F = R U, with a symmetric, positive U")

typedef enum builtin_quantity {
#define X(code, ...) QUANTITY_##code,
  BUILTIN_QUANTITIES(X)
#undef X
  QUANTITY_COUNT
} builtin_quantity;

typedef enum builtin_function {
#define X(code, ...) FUNCTION_##code,
  BUILTIN_FUNCTIONS(X)
#undef X
  FUNCTION_COUNT
} builtin_function;

/* clang-format on */

typedef struct builtin_quantity_info {
  const char *name, *unit, *meaning, *example;
  enum shape shape;
  placement place;
  int kinds;
  bool fixed;
} builtin_quantity_info;

typedef struct builtin_function_info {
  const char *name, *meaning, *example;
  const char *formula; /* LaTeX */
  int least, most;
  double (*of_one)(double x);            /* value, or NULL */
  double (*of_many)(double x, double y); /* of the first two arguments; or NULL */
} builtin_function_info;

extern const builtin_quantity_info builtin_quantities[QUANTITY_COUNT];
extern const builtin_function_info builtin_functions[FUNCTION_COUNT];

/* The laws that may read a quantity, in a word or two. */
const char *builtin_laws(int kinds);
/* Index of the quantity or function called `name`, or -1. */
int builtin_quantity_find(const char *name);
int builtin_function_find(const char *name);

C_LINKAGE_END

#endif
