/* What the answers to one exercise are measured by: its paths with the solution's tables, the
   tables of known wrong laws, what the solution implies. */
#ifndef PERILAT_GENERATOR_GRADE_BASIS_H
#define PERILAT_GENERATOR_GRADE_BASIS_H

#include "generator/exercise/path_case.h"

typedef struct grade_basis {
  const exercise *of;
  arena *memory;
  source_set sources;
  diagnostics said;
  model solution; /* read, where has_solution */
  bool has_solution;
  driven_law kept;  /* the solution, as paths drive it */
  path_case *cases; /* of all items of paths that are judged, in their order */
  int case_count;
  declared_names *declared; /* [wrong_count] by known wrong laws; count 0: it does not even read */
  reference_law *wrong;     /* [case_count][wrong_count]; without rows where it can not be driven */
  double *measured;         /* [item_count] implied and run, of the solution; NaN: not yet known */
} grade_basis;

/* Reads and drives what `only_public` leaves. False, with messages in said, where the exercise is
   broken. To be closed in any case. */
bool grade_basis_open(grade_basis *b, const exercise *e, bool only_public);
void grade_basis_close(grade_basis *b);
/* Is the item judged by this basis? */
bool item_is_judged(const exercise_item *item, bool only_public);
/* The paths that a sample item begins with: its own, or all that are known. */
path_case *sample_origins(const grade_basis *b, const exercise_item *item, int *count);
/* The table of a known wrong law, or NULL. */
const reference_law *wrong_table(const grade_basis *b, int path, int wrong);

#endif
