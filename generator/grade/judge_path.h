/* An answer driven along paths, beside what they are measured by. */
#ifndef PERILAT_GENERATOR_JUDGE_PATH_H
#define PERILAT_GENERATOR_JUDGE_PATH_H

#include "generator/grade/grade_basis.h"
#include "generator/interpreter/case_witness.h"

/* What came of one path. */
typedef struct path_outcome {
  bool right;
  char *words;       /* why not: sentences, a line each; NULL: right */
  char *state;       /* rows of the first state that differs, or NULL */
  drive_table table; /* without memory where it could not be driven */
} path_outcome;

/* Texts in the arena; the table must be freed where it has memory. What of the answer's cases is
   reached goes to `seen`; `kept`: driven_law_open_kept. */
void judge_path(path_outcome *out, arena *a, const path_case *c, const char *answer,
                const declared_names *declared, driven_law *kept, cases_seen *seen);

#endif
