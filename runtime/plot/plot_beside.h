/* What a diagram shows beside computed curves: points of a table, a band between two curves or
   values, the line of a value. */
#ifndef PERILAT_RUNTIME_PLOT_BESIDE_H
#define PERILAT_RUNTIME_PLOT_BESIDE_H

#include "runtime/plot/plot_axes.h"
#include "runtime/plot/plot_curve.h"

/* The least and the largest value along x, or along y, widen the range *low to *high. */
void beside_range(const plot_beside *b, bool of_x, double *low, double *high);

/* Bands lie below the curves, points and lines above. `number` of its kind among all, from 0,
   decides colour and mark. */
void beside_draw_band(canvas *c, const plot_beside *b, int number, const axis *x, const axis *y);
void beside_draw_points(canvas *c, const plot_beside *b, int number, const axis *x, const axis *y);
/* The same as a sample of a legend, 36 wide, in the middle of a line of text. */
void beside_draw_sample(canvas *c, const plot_beside *b, int number, double left, double middle);

#endif
