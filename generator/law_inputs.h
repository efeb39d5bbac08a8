/* The law alone on the interpreter: parameters, bond class and states as the inputs of its graph.
 */
#ifndef PERILAT_GENERATOR_LAW_INPUTS_H
#define PERILAT_GENERATOR_LAW_INPUTS_H

#include "generator/interpret.h"
#include "generator/passes.h"

/* Arrays that pl_law's `states` and `tangent` read (before the fields) and write. */
enum { LAW_INPUTS = 5, LAW_RESULTS = 3, LAW_TANGENTS = 12 };

typedef struct law_inputs {
  double of_class[QUANTITY_COUNT];
  const double *quantities[QUANTITY_COUNT];
  unsigned char quantity_stride[QUANTITY_COUNT];
  const double **parameters; /* [parameters] */
  unsigned char *field_stride;
} law_inputs;

/* `parameters` must outlive the inputs, which must stay where they are. */
void law_inputs_open(law_inputs *v, const law *l, const double *parameters,
                     const pl_bond_class *bonds);
/* For states `in` as pl_law's `states` takes them: [5 + fields][count]. */
interpreter_inputs law_inputs_at(law_inputs *v, const double *const *in);
void law_inputs_close(law_inputs *v);

#endif
