/* Two curves on their way from the process that judges: as numbers in a text; and as a picture. */
#ifndef PERILAT_GENERATOR_CURVE_TEXT_H
#define PERILAT_GENERATOR_CURVE_TEXT_H

#include <stdio.h>

#include "generator/drive/drive_table.h"

/* Force over way of both tables, at most some hundred points each, malloc'ed: names and units of
   the axes, then the points. */
char *curve_text(const drive_table *answer, const drive_table *reference);
/* Such a text as SVG: the right curve dashed, the answer's above it. Whatever the text holds, the
   picture holds numbers and what was written out. */
void curve_svg(const char *text, FILE *out);

#endif
