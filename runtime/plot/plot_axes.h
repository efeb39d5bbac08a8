/* The axes of a diagram: which units and numbers they show, and where a value stands in the
   picture. */
#ifndef PERILAT_RUNTIME_PLOT_AXES_H
#define PERILAT_RUNTIME_PLOT_AXES_H

#include "runtime/plot/canvas.h"

enum { DIAGRAM_WIDTH = 1200, DIAGRAM_HEIGHT = 800 };
/* The frame, which curves do not leave. */
enum { DIAGRAM_LEFT = 120, DIAGRAM_RIGHT = 1160, DIAGRAM_TOP = 70, DIAGRAM_BOTTOM = 705 };

typedef struct axis {
  const char *name;
  char unit_text[64];
  double low, high, step, factor; /* shown values; shown = SI * factor */
} axis;

/* From `low` to `high` (SI), or a little more. The `wanted` unit must fit; NULL: a readable one is
   taken. False with a sentence in error. */
bool axis_set(axis *a, const char *name, const char *si_unit, const char *wanted, double low,
              double high, char *error, size_t size);
/* Places of values in SI. */
double axis_along_x(const axis *a, double value);
double axis_along_y(const axis *a, double value);

void axes_draw(canvas *c, const axis *x, const axis *y, const char *title);

#endif
