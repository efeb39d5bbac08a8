/* One number of an answer: what the law implies on a lattice, or what a run with it gives. */
#ifndef PERILAT_GENERATOR_GRADE_MEASURE_H
#define PERILAT_GENERATOR_GRADE_MEASURE_H

#include "generator/exercise/exercise.h"

/* In SI; NaN with a sentence in *why (of the arena) where there is none. The law's file `answer` is
   in the working folder. `beside`: of a law of bonds with the mean stiffness just beside rest, on
   both sides: at rest itself some ways to write a force have none (norm, positive_part). */
double measure_implied(arena *a, const exercise_item *item, const char *answer, bool beside,
                       const char **why);
/* The unit of an item's quantity; "1": a number. */
const char *implied_unit(const exercise_item *item);
/* Runs of an answer that were made: what is the same is not run again. */
typedef struct runs_made {
  const char **keys; /* [count] deck and all that is set */
  int *status, count;
  char unit[64]; /* of the number that was read last */
} runs_made;
/* Runs the item's deck on the interpreter, in the working folder, with `more` set, too. */
double measure_run(arena *a, const exercise_item *item, const char *answer, const char *const *more,
                   int more_count, runs_made *made, const char **why);

#endif
