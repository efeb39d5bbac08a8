/* Fields that a law declares, as a path gives them in time: what its parameters are then, and what
   a table shows of them. */
#ifndef PERILAT_GENERATOR_DRIVEN_FIELDS_H
#define PERILAT_GENERATOR_DRIVEN_FIELDS_H

#include "generator/drive/drive_path.h"
#include "generator/drive/drive_table.h"
#include "runtime/kernel.h"

/* Whether the law has the fields that the path gives, in these units, and allows their values, with
   its other `parameters`. False after messages. */
bool driven_fields_suit(const drive_input *in, const pl_law *law, const double *parameters,
                        diagnostics *d);
/* Sets those of a path that suits the law in values[law->parameter_count]. False where the path
   gives none. */
bool driven_fields_at(const drive_input *in, const pl_law *law, double time, double *values);

/* Columns of the fields that a law has; how many; in a row those of `values` from `column` on.
   Returns the column behind them. */
int driven_fields_count(const pl_law *law);
void driven_fields_add(drive_table *t, const pl_law *law, long room);
int driven_fields_put(drive_table *t, const pl_law *law, const double *values, int column,
                      long row);

#endif
