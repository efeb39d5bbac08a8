#include "runtime/deck/time_function.h"

#include <math.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "dsl/semantics/formula.h"

/* --- tables ----------------------------------------------------------------------------------- */

/* Piece of the table that holds t: the last k with times[k] <= t; -1 before the first point. */
static int table_piece(const time_function *f, double t) {
  int low = -1, high = f->count;
  while (high - low > 1) {
    int middle = low + (high - low) / 2;
    if (f->times[middle] <= t)
      low = middle;
    else
      high = middle;
  }
  return low;
}

static double table_at(const time_function *f, double t) {
  int k = table_piece(f, t);
  if (k < 0) return f->values[0];
  if (k == f->count - 1) return f->values[k];
  double part = (t - f->times[k]) / (f->times[k + 1] - f->times[k]);
  return f->values[k] + part * (f->values[k + 1] - f->values[k]);
}

/* Trapezoids, which are exact for straight pieces; held values before the first and after the last
 * point. */
void time_table_integrals(const double *times, const double *values, int count, double *integrals) {
  double sum = values[0] * times[0];
  for (int k = 0; k < count; k++) {
    integrals[k] = sum;
    if (k + 1 < count) sum += (values[k] + values[k + 1]) / 2 * (times[k + 1] - times[k]);
  }
}

static double table_integral(const time_function *f, double t) {
  const int last = table_piece(f, t);
  if (last < 0) return f->values[0] * t;
  return f->integrals[last] + (f->values[last] + table_at(f, t)) / 2 * (t - f->times[last]);
}

/* --- formulas --------------------------------------------------------------------------------- */

bool time_function_varies(const time_function *f) {
  return f->formula &&
         (formula_reads(f->formula, FORMULA_X) || formula_reads(f->formula, FORMULA_Y) ||
          formula_reads(f->formula, FORMULA_Z));
}

time_function time_function_placed(const time_function *f, const double at[3]) {
  time_function there = *f;
  memcpy(there.place, at, sizeof there.place);
  return there;
}

static double formula_at(const time_function *f, double since) {
  const double variables[FORMULA_VARIABLES] = {f->place[0], f->place[1], f->place[2], since};
  return f->value * formula_value(f->formula, variables);
}

/* --- all shapes ------------------------------------------------------------------------------- */

double time_function_end(const time_function *f) {
  return f->end > 0 ? f->end : INFINITY;
}

double time_function_at(const time_function *f, double t) {
  double since = t - f->start;
  if (since < 0) return 0;
  switch (f->shape) {
  case TIME_CONSTANT:
    return f->value;
  case TIME_RAMP:
    return f->value * (since / f->rise);
  case TIME_RAMP_HOLD:
    return since < f->rise ? f->value * (since / f->rise) : f->value;
  case TIME_COSINE:
    return since < f->rise ? f->value * (1 - pl_cos(M_PI * since / f->rise)) / 2 : f->value;
  case TIME_TABLE:
    return table_at(f, since);
  case TIME_FORMULA:
    return formula_at(f, since);
  }
  return 0;
}

double time_function_integral(const time_function *f, double t) {
  double since = t - f->start;
  if (since < 0) return 0;
  double rising = since < f->rise ? since : f->rise;
  switch (f->shape) {
  case TIME_CONSTANT:
    return f->value * since;
  case TIME_RAMP:
    return f->value * since * since / (2 * f->rise);
  case TIME_RAMP_HOLD:
    return f->value * (rising * rising / (2 * f->rise) + (since - rising));
  case TIME_COSINE:
    return f->value *
           ((rising - f->rise / M_PI * pl_sin(M_PI * rising / f->rise)) / 2 + (since - rising));
  case TIME_TABLE:
    return table_integral(f, since);
  case TIME_FORMULA:
    return NAN;
  }
  return 0;
}

double time_function_way(const time_function *f, double from, double to, int pieces) {
  const double h = (to - from) / pieces;
  double sum = 0;
  for (int k = 0; k < pieces; k++)
    sum += time_function_at(f, from + k * h) + 4 * time_function_at(f, from + (k + 0.5) * h) +
           time_function_at(f, from + (k + 1) * h);
  return sum * h / 6;
}

/* 0 where the values are held. */
static double table_slope(const time_function *f, double t) {
  const int k = table_piece(f, t);
  if (k < 0 || k == f->count - 1) return 0;
  return (f->values[k + 1] - f->values[k]) / (f->times[k + 1] - f->times[k]);
}

double time_function_slope(const time_function *f, double t) {
  const double since = t - f->start;
  if (since < 0) return 0;
  switch (f->shape) {
  case TIME_CONSTANT:
    return 0;
  case TIME_RAMP:
    return f->value / f->rise;
  case TIME_RAMP_HOLD:
    return since < f->rise ? f->value / f->rise : 0;
  case TIME_COSINE:
    return since < f->rise ? f->value * M_PI / (2 * f->rise) * pl_sin(M_PI * since / f->rise) : 0;
  case TIME_TABLE:
    return table_slope(f, since);
  case TIME_FORMULA:
    return NAN;
  }
  return 0;
}

double time_function_jump(const time_function *f) {
  switch (f->shape) {
  case TIME_CONSTANT:
    return f->value;
  case TIME_TABLE:
    return f->values[0];
  case TIME_FORMULA:
    return formula_at(f, 0);
  default:
    return 0;
  }
}
