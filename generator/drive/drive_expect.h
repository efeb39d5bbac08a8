/* What a path expects, asked before anything is driven and judged by the rows that came out. */
#ifndef PERILAT_GENERATOR_DRIVE_EXPECT_H
#define PERILAT_GENERATOR_DRIVE_EXPECT_H

#include "generator/drive/drive_path.h"
#include "generator/drive/drive_table.h"
#include "generator/kernel/model.h"

typedef struct drive_verdict {
  bool passed;
  double found, expected, allowed;
  const char *unit;
  double time, way; /* of the row: `way` of what the path drives */
  const char *way_name;
  bool extreme;     /* the row was chosen for a largest or smallest value */
  double beside[2]; /* times of the rows before and after it */
} drive_verdict;

/* What every &expect asks for, before anything is driven: names, units and times are checked
   against `columns` (of drive_columns, which must stay), closed forms are compiled as further
   outputs of `m`, the law as it will be driven. NULL, with messages, when one cannot be
   understood. */
typedef struct drive_expectations drive_expectations;
drive_expectations *drive_expectations_read(const drive_input *in, const model *m,
                                            const drive_table *columns, diagnostics *d);
/* Judges every &expect by the rows of `t`; verdicts[expect_count]. */
void drive_judge(const drive_expectations *x, const double *parameters, const drive_table *t,
                 drive_verdict *verdicts);
void drive_expectations_free(drive_expectations *x);

#endif
