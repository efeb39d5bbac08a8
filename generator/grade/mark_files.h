/* Marks for other programs: JSON, a table for a teacher, test results for continuous
   integration. */
#ifndef PERILAT_GENERATOR_MARK_FILES_H
#define PERILAT_GENERATOR_MARK_FILES_H

#include "dsl/base/json.h"
#include "generator/exercise/exercise.h"
#include "generator/grade/marks.h"

/* An object of one answer, in an array that is open. */
void marks_json(const exercise *e, const marks *m, json *j);
/* A row an answer: name, points, a column an item, seconds, the most important sentence. */
bool marks_csv(const exercise *e, const marks *all, int count, const char *path);
/* An answer is a test suite, an item a test; points that are lost are a failure. */
bool marks_junit(const exercise *e, const marks *all, int count, const char *path);

#endif
