#include "runtime/plot/colour_scale.h"

#include <math.h>

#include "dsl/base/elementary.h"

const colour scale_no_value = {0.85, 0.85, 0.85};

/* Between the colours of a list, `at` from 0 to its last. */
static colour between(const colour *list, int last, double at) {
  const int k = at < last ? (int)at : last - 1;
  const double part = at - k;
  const colour a = list[k], b = list[k + 1];
  return (colour){a.r + part * (b.r - a.r), a.g + part * (b.g - a.g), a.b + part * (b.b - a.b)};
}

colour scale_colour(double part) {
  static const colour stops[] = {{0.27, 0.00, 0.33},
                                 {0.23, 0.32, 0.55},
                                 {0.13, 0.57, 0.55},
                                 {0.37, 0.79, 0.38},
                                 {0.99, 0.91, 0.14}};
  enum { LAST = sizeof stops / sizeof *stops - 1 };
  return between(stops, LAST, pl_fmin(pl_fmax(part, 0), 1) * LAST);
}

double scale_part(double value, double low, double high) {
  return high > low ? pl_fmin(pl_fmax((value - low) / (high - low), 0), 1) : 0;
}

int scale_step(double value, double low, double high, int steps) {
  if (isnan(value)) return -1;
  return (int)pl_fmin(steps * scale_part(value, low, high), steps - 1);
}

static const colour palette[] = {{0.00, 0.27, 0.55}, {0.80, 0.25, 0.05}, {0.10, 0.50, 0.20},
                                 {0.55, 0.20, 0.60}, {0.85, 0.55, 0.00}, {0.05, 0.55, 0.60},
                                 {0.45, 0.30, 0.15}, {0.40, 0.40, 0.40}};
enum { PALETTE = sizeof palette / sizeof *palette };

/* More than there are colours go from blue to red, in their order. */
colour scale_ink(int k, int count) {
  static const colour scale[] = {{0.00, 0.15, 0.60},
                                 {0.00, 0.55, 0.75},
                                 {0.20, 0.65, 0.20},
                                 {0.90, 0.65, 0.00},
                                 {0.75, 0.05, 0.05}};
  enum { LAST = sizeof scale / sizeof *scale - 1 };
  if (count <= PALETTE) return palette[k % PALETTE];
  return between(scale, LAST, (double)LAST * k / (count - 1));
}
