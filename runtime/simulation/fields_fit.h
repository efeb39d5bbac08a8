/* Do the fields of a run have names of their own in its result? */
#ifndef PERILAT_RUNTIME_FIELDS_FIT_H
#define PERILAT_RUNTIME_FIELDS_FIT_H

#include "runtime/parts/run_body.h"
#include "runtime/simulation/frame_field.h"

/* What the laws of a run store has other names than what stands beside it in the result: fields of
   other laws, folders of lattices. */
bool fields_fit_result(const deck *k, const run_body *bodies, const frame_field *fields, int count,
                       diagnostics *d);

#endif
