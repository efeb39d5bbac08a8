/* Marks as a page that needs nothing else: no script, no picture from elsewhere. */
#ifndef PERILAT_GENERATOR_MARK_PAGE_H
#define PERILAT_GENERATOR_MARK_PAGE_H

#include <stdio.h>

#include "generator/exercise/exercise.h"
#include "generator/grade/marks.h"

/* A table of all answers, and of each its items, words, rows and curves. False after a sentence. */
bool marks_page(const exercise *e, const marks *all, int count, const char *path);

/* The text of two curves (curve_text.h) as a diagram: the right one, then the answer's. Whatever
   the text holds, the diagram holds numbers and what was written out; nothing where nothing can be
   drawn. */
void marks_curve(FILE *out, const char *text);

#endif
