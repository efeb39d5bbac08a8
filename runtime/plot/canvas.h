/* A Cairo surface that becomes PNG, SVG or PDF by the ending of its path, and the few shapes that
   pictures are made of. */
#ifndef PERILAT_RUNTIME_CANVAS_H
#define PERILAT_RUNTIME_CANVAS_H

#include <cairo.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "runtime/base/whole_file.h"

typedef struct colour {
  double r, g, b;
} colour;

typedef struct canvas {
  cairo_t *cr;
  cairo_surface_t *surface;
  double width, height; /* in points (pixels of a PNG) */
  const char *path;
  whole_file place;
  FILE *file;
  int reason; /* errno of the first write that failed */
  bool is_png;
} canvas;

/* False with a sentence in `error` when the ending is none of .png, .svg, .pdf or the file cannot
   be made. White background. The canvas must stay where it is until it is closed. */
bool canvas_open(canvas *c, const char *path, double width, double height, char *error,
                 size_t size);
/* Writes the picture, whole or not at all; frees. */
bool canvas_close(canvas *c, char *error, size_t size);

typedef enum anchor { ANCHOR_LEFT, ANCHOR_CENTRE, ANCHOR_RIGHT } anchor;

void canvas_colour(canvas *c, colour k);
void canvas_text(canvas *c, double x, double y, double size, anchor a, const char *text);
/* Left at x; smaller, and then cut, where it would be wider than `width`. */
void canvas_text_within(canvas *c, double x, double y, double size, double width, const char *text);
/* Centred and turned by 90 degrees; smaller, and then cut, where it would be longer than `length`.
   */
void canvas_text_upward(canvas *c, double x, double y, double size, double length,
                        const char *text);
void canvas_line(canvas *c, double x1, double y1, double x2, double y2, double width);
double canvas_text_width(canvas *c, double size, const char *text);

/* Largest of 1, 2, 5 x 10^n that divides `range` into at least `least` parts. */
double nice_step(double range, int least);

/* A unit in which values up to `largest` (SI, `si_unit`) read well: "mm" for m, "kN" for N, "ms"
   for s, "MPa" for Pa, "mJ" for J. *factor: shown = SI * factor. Keeps the SI unit when it knows
   none. */
const char *readable_unit(const char *si_unit, double largest, double *factor);

#endif
