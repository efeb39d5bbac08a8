/* The colours that stand for values in pictures. */
#ifndef PERILAT_RUNTIME_COLOUR_SCALE_H
#define PERILAT_RUNTIME_COLOUR_SCALE_H

#include "runtime/plot/canvas.h"

/* Dark blue - green - yellow for 0 to 1; equal steps look equal, also in grey. */
colour scale_colour(double part);
/* Place of a value between two others, 0 to 1. */
double scale_part(double value, double low, double high);
/* One of so many steps of the scale, from 0; negative of what is no number. */
enum { SCALE_STEPS = 64, CELL_STEPS = 24 };
int scale_step(double value, double low, double high, int steps);
/* Of what is no number: a body may not have the field. */
extern const colour scale_no_value;
/* Colours that tell curves, or paths, of several results apart: number k of `count`. */
colour scale_ink(int k, int count);

#endif
