#include "generator/lower/law_inputs.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

const builtin_quantity law_motion[PL_STATE_INPUTS] = {
    QUANTITY_STRETCH, QUANTITY_STRETCH_RATE, QUANTITY_THETA_I, QUANTITY_THETA_J, QUANTITY_LENGTH,
    QUANTITY_DT};

const ends_input law_chord[LAW_CHORD] = {ENDS_CLASS_CHORD_X, ENDS_CLASS_CHORD_Y,
                                         ENDS_CLASS_CHORD_Z};

int law_motion_place(builtin_quantity q) {
  for (int k = 0; k < PL_STATE_INPUTS; k++)
    if (law_motion[k] == q) return k;
  return -1;
}

void law_state_inputs(pl_input out[PL_STATE_INPUTS]) {
  for (int k = 0; k < PL_STATE_INPUTS; k++) {
    const builtin_quantity_info *q = &builtin_quantities[law_motion[k]];
    out[k] = (pl_input){q->name, q->unit};
  }
}

/* Motion, class, and what a law has in other ways: PI, TWIST, RESOLVED, DIRECTION, U, and what is
   made of the motion: SLIP, GAP, SLIP_RATE; and what a point has: STRAIN, STRAIN_RATE, CELL_SIZE,
   and what a tip has (point_inputs.h). */
#define X(code, value) +1
_Static_assert(PL_STATE_INPUTS CLASS_QUANTITIES(X) + 19 == QUANTITY_COUNT,
               "each quantity has a place where a law finds it");
#undef X

void law_class_values(const pl_bond_class *bonds, double values[QUANTITY_COUNT]) {
#define X(code, value) values[QUANTITY_##code] = value;
  CLASS_QUANTITIES(X)
#undef X
}

void law_inputs_open(law_inputs *v, const law *l, const double *parameters,
                     const pl_bond_class *bonds) {
  *v = (law_inputs){.parameters = NULL};
  law_class_values(bonds, v->of_class);
  for (int k = 0; k < QUANTITY_COUNT; k++)
    v->quantities[k] = &v->of_class[k];
  for (int k = 0; k < PL_STATE_INPUTS; k++)
    v->quantity_stride[law_motion[k]] = 1;
  for (int k = 0; k < LAW_CHORD; k++)
    v->ends[law_chord[k]] = &bonds->chord[k];
  v->parameters = must_calloc((size_t)l->parameters.count + 1, sizeof *v->parameters);
  for (int k = 0; k < l->parameters.count; k++)
    v->parameters[k] = &parameters[k];
  v->field_stride = must_calloc((size_t)l->fields.count + 1, 1);
  memset(v->field_stride, 1, (size_t)l->fields.count);
}

interpreter_inputs law_inputs_at(law_inputs *v, const double *const *in,
                                 const double *const *field) {
  for (int k = 0; k < PL_STATE_INPUTS; k++)
    v->quantities[law_motion[k]] = in[k];
  return (interpreter_inputs){
      .values = {[IR_FROM_PARAMETER] = v->parameters,
                 [IR_FROM_QUANTITY] = v->quantities,
                 [IR_FROM_FIELD] = field,
                 [IR_FROM_ENDS] = v->ends},
      .stride = {[IR_FROM_QUANTITY] = v->quantity_stride, [IR_FROM_FIELD] = v->field_stride}};
}

void law_inputs_close(law_inputs *v) {
  free(v->parameters);
  free(v->field_stride);
}
