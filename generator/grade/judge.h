/* One answer judged, item by item. It runs in a process of its own, in an empty folder: what it
   reads is hostile. */
#ifndef PERILAT_GENERATOR_JUDGE_H
#define PERILAT_GENERATOR_JUDGE_H

#include "generator/grade/grade_basis.h"
#include "generator/grade/marks.h"

typedef struct judge_request {
  const grade_basis *basis;
  const char *answer; /* the law's file, in the working folder */
  const char *shown;  /* the file as it was given, in messages */
  bool only_public;
  /* of sample items: [sample_count], of this answer's seed */
  path_case *samples;
  int sample_count;
  const marks *like; /* of an answer with the same law: its runs are those of this one; or NULL */
  bool measure;      /* implied and run: tell the value, whatever is expected */
} judge_request;

/* Writes records (marks.h) as it goes; the last is RECORD_END. */
void judge_answer(const judge_request *q, FILE *out);

#endif
