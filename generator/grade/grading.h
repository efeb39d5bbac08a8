/* One exercise opened for grading: what its answers are measured by, and one answer judged by
   it. */
#ifndef PERILAT_GENERATOR_GRADING_H
#define PERILAT_GENERATOR_GRADING_H

#include "generator/grade/grade_child.h"
#include "generator/grade/grade_options.h"

/* A law that was judged, and what it got. */
typedef struct judged_law {
  const char *bare; /* handed_text_bare */
  const marks *m;
} judged_law;

typedef struct grading {
  const grade_options *o;
  arena *memory;
  source_set sources;
  diagnostics said;
  exercise *e;
  grade_basis basis;
  bool opened;        /* the basis is */
  judged_law *judged; /* [judged_count] */
  int judged_count;
} grading;

/* Reads the exercise and drives its laws. False, with messages kept for grading_close, where it is
   broken. To be closed in any case. */
bool grading_open(grading *g, const grade_options *o);
/* Prints what is wrong with the exercise. */
void grading_close(grading *g);
/* Begins to judge an answer; m is opened here. False where the grader fails, after a sentence or
   with a message kept; grading_end is to follow in any case, and fills the marks. */
bool grading_begin(grading *g, const handed_in *answer, marks *m, judging_child *c);
void grading_end(grading *g, judging_child *c);
/* From here on whoever hands in the same law, comments and blanks aside, gets its runs as they were
   judged here: these marks must outlive the grading. */
void grading_keep(grading *g, const judging_child *c);
/* Both. */
bool grading_judge(grading *g, const handed_in *answer, marks *m);

#endif
