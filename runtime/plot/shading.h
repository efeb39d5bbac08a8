/* A picture of values: an image of pixels, filled with what quadrilaterals have at their corners
   and between, that is painted in CELL_STEPS colours of the scale: steps that can be told apart,
   and small files. */
#ifndef PERILAT_RUNTIME_SHADING_H
#define PERILAT_RUNTIME_SHADING_H

#include "runtime/plot/canvas.h"

typedef struct shading {
  int width, height; /* pixels */
  double left, top;  /* of the image on the canvas */
  double fineness;   /* pixels to a unit of the canvas */
  float *values;     /* [height][width] NaN: nothing is there */
} shading;

/* Covers `width` x `height` of the canvas, from (left, top) on. */
shading shading_new(const canvas *c, double left, double top, double width, double height);
void shading_free(shading *s);
/* Corners around, on the canvas, and their values. */
void shading_fill(shading *s, const double at[4][2], const double value[4]);
void shading_paint(canvas *c, const shading *s, double low, double high);

#endif
