/* Marks as a page that needs nothing else: no script, no picture from elsewhere. */
#ifndef PERILAT_GENERATOR_MARK_PAGE_H
#define PERILAT_GENERATOR_MARK_PAGE_H

#include "generator/exercise/exercise.h"
#include "generator/grade/marks.h"

/* A table of all answers, and of each its items, words, rows and curves. False after a sentence. */
bool marks_page(const exercise *e, const marks *all, int count, const char *path);

#endif
