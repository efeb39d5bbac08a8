/* What a law is told about a bond, and the law alone on the interpreter: parameters, bond class and
   states as the inputs of its graph. */
#ifndef PERILAT_GENERATOR_LAW_INPUTS_H
#define PERILAT_GENERATOR_LAW_INPUTS_H

#include "dsl/semantics/builtins.h"
#include "dsl/semantics/law.h"
#include "generator/ir/interpret.h"
#include "generator/lower/kinematics.h"
#include "runtime/kernel.h"

/* Quantities of a bond's motion, in the order of pl_law's `state_inputs`; the tangent is by
   the first PL_STATE_RATES of them. */
extern const builtin_quantity law_motion[PL_STATE_INPUTS];
/* Place of a quantity among them, or -1. */
int law_motion_place(builtin_quantity q);
/* Their names and units. */
void law_state_inputs(pl_input out[PL_STATE_INPUTS]);

/* Quantities that a bond class knows. X(quantity, its value as C, of a class `bonds`) */
#define CLASS_QUANTITIES(X)                                                                        \
  X(S, bonds->s)                                                                                   \
  X(SPACING, bonds->spacing)                                                                       \
  X(T, bonds->t)                                                                                   \
  X(V, bonds->V)                                                                                   \
  X(M_BOND, pl_min(bonds->mass_i, bonds->mass_j))                                                  \
  X(M_END_I, bonds->mass_i)                                                                        \
  X(M_END_J, bonds->mass_j)                                                                        \
  X(AREA, bonds->area)                                                                             \
  X(SHELL, bonds->shell)                                                                           \
  X(HORIZON, bonds->horizon)                                                                       \
  X(WEIGHT, bonds->weight)                                                                         \
  X(N_FAMILY, bonds->n)

/* Components of the reference chord, of which `direction` is made: inputs IR_FROM_ENDS of a bond
   class. */
enum { LAW_CHORD = 3 };
extern const ends_input law_chord[LAW_CHORD];

/* Their values; those of all other quantities stay as they are. */
void law_class_values(const pl_bond_class *bonds, double values[QUANTITY_COUNT]);

typedef struct law_inputs {
  double of_class[QUANTITY_COUNT];
  const double *quantities[QUANTITY_COUNT];
  unsigned char quantity_stride[QUANTITY_COUNT];
  const double *ends[ENDS_COUNT]; /* law_chord */
  const double **parameters;      /* [parameters] */
  unsigned char *field_stride;
} law_inputs;

/* `parameters` and `bonds` must outlive the inputs, which must stay where they are. */
void law_inputs_open(law_inputs *v, const law *l, const double *parameters,
                     const pl_bond_class *bonds);
/* For states `in` with their fields, as in pl_states. */
interpreter_inputs law_inputs_at(law_inputs *v, const double *const *in,
                                 const double *const *field);
void law_inputs_close(law_inputs *v);

#endif
