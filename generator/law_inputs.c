#include "generator/law_inputs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"

static const builtin_quantity moving[LAW_INPUTS] = {
    QUANTITY_STRETCH, QUANTITY_STRETCH_RATE, QUANTITY_THETA_I, QUANTITY_THETA_J, QUANTITY_LENGTH};

static void take_class(double *of_class, const pl_bond_class *b) {
  of_class[QUANTITY_S] = b->s;
  of_class[QUANTITY_SPACING] = b->spacing;
  of_class[QUANTITY_T] = b->t;
  of_class[QUANTITY_V] = b->V;
  of_class[QUANTITY_M_END_I] = b->mass_i;
  of_class[QUANTITY_M_END_J] = b->mass_j;
  of_class[QUANTITY_M_BOND] = fmin(b->mass_i, b->mass_j);
  of_class[QUANTITY_AREA] = b->area;
  of_class[QUANTITY_SHELL] = b->shell;
  of_class[QUANTITY_N_FAMILY] = b->n;
}

void law_inputs_open(law_inputs *v, const law *l, const double *parameters,
                     const pl_bond_class *bonds) {
  *v = (law_inputs){.parameters = NULL};
  take_class(v->of_class, bonds);
  for (int k = 0; k < QUANTITY_COUNT; k++)
    v->quantities[k] = &v->of_class[k];
  for (int k = 0; k < LAW_INPUTS; k++)
    v->quantity_stride[moving[k]] = 1;
  v->parameters = must_calloc((size_t)l->parameters.count + 1, sizeof *v->parameters);
  for (int k = 0; k < l->parameters.count; k++)
    v->parameters[k] = &parameters[k];
  v->field_stride = must_calloc((size_t)l->fields.count + 1, 1);
  memset(v->field_stride, 1, (size_t)l->fields.count);
}

interpreter_inputs law_inputs_at(law_inputs *v, const double *const *in) {
  for (int k = 0; k < LAW_INPUTS; k++)
    v->quantities[moving[k]] = in[k];
  return (interpreter_inputs){
      .values = {[IR_FROM_PARAMETER] = v->parameters,
                 [IR_FROM_QUANTITY] = v->quantities,
                 [IR_FROM_FIELD] = in + LAW_INPUTS},
      .stride = {[IR_FROM_QUANTITY] = v->quantity_stride, [IR_FROM_FIELD] = v->field_stride}};
}

void law_inputs_close(law_inputs *v) {
  free(v->parameters);
  free(v->field_stride);
}
