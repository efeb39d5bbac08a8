/* Curves of histories through Cairo, as PNG, SVG or PDF by the path's ending. */
#ifndef PERILAT_RUNTIME_PLOT_CURVE_H
#define PERILAT_RUNTIME_PLOT_CURVE_H

#include <stdbool.h>
#include <stddef.h>

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

/* Beside computed curves, in SI: points (x, y), a band (x, low, high), or both; without x over the
   whole width, a line at y[0] or a band from low[0] to high[0]. What is not there is NULL; a value
   that is no number is a gap. */
typedef struct plot_beside {
  const char *label;
  const double *x, *y, *low, *high; /* [count] */
  long count;
} plot_beside;

typedef struct plot_curve_options {
  const char *output;          /* path */
  const char *x, *y;           /* histories: "cmod", "load", "time", "energy/kinetic" */
  const char *const *ys;       /* several histories of one unit, a curve each, instead of y */
  int y_count;                 /* of ys; 0: y alone */
  const char *x_unit, *y_unit; /* shown unit, e.g. "mm", "kN"; NULL: a readable one is chosen */
  const char *title;           /* NULL: the result's title */
  const char *const *labels;   /* legend, one a result; NULL: file names */
  double y_most; /* SI; larger sizes of curves are beyond the picture; 0: all are within */
  const plot_beside *beside;
  int beside_count;
} plot_curve_options;

/* One curve a result file and history in one picture. */
bool plot_curve(const char *const *results, int result_count, const plot_curve_options *o,
                char *error, size_t size);
/* Two histories of a result as a diagram has them, malloc'ed, with their units: the time of a
   quasi-static run is a pure number. */
typedef struct plot_histories {
  double *x, *y;
  long count;
  char x_unit[64], y_unit[64];
} plot_histories;
bool plot_histories_read(plot_histories *h, const char *path, const char *x, const char *y,
                         char *error, size_t size);
/* A curve of values at hand, in SI. */
typedef struct plot_series {
  const double *x, *y; /* [count] */
  long count;
  const char *label; /* in the legend of several */
} plot_series;
/* Several of them, the later ones above the earlier; o->x and o->y name the axes, x_unit and y_unit
   are the values' SI units. */
bool plot_series_draw(const plot_series *series, int count, const char *x_unit, const char *y_unit,
                      const plot_curve_options *o, char *error, size_t size);
/* One of them, without a legend. */
bool plot_values(const double *x, const double *y, long count, const char *x_unit,
                 const char *y_unit, const plot_curve_options *o, char *error, size_t size);

C_LINKAGE_END

#endif
