/* Two curves on their way from the process that judges, as numbers in a text. */
#ifndef PERILAT_GENERATOR_CURVE_TEXT_H
#define PERILAT_GENERATOR_CURVE_TEXT_H

#include "generator/drive/drive_table.h"

enum { CURVE_POINTS = 402 }; /* at most, of each */

/* Force over way of both tables, malloc'ed: name and unit of either axis, a line each, then a line
   of pairs for the reference and one for the answer. */
char *curve_text(const drive_table *answer, const drive_table *reference);

#endif
