/* Loads as functions of time: constant, ramp, ramp and hold, cosine, table, formula. A formula may
   also read the place, and is then a function of time at one place at a time. */
#ifndef PERILAT_RUNTIME_TIME_FUNCTION_H
#define PERILAT_RUNTIME_TIME_FUNCTION_H

#include <stdbool.h>

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

struct formula; /* dsl/semantics/formula.h */

typedef enum time_shape {
  TIME_CONSTANT,  /* value from `start` on */
  TIME_RAMP,      /* value * (t - start)/rise, without end */
  TIME_RAMP_HOLD, /* the same up to `rise`, then value */
  TIME_COSINE,    /* value * (1 - cos(pi (t - start)/rise))/2 up to `rise`, then value */
  TIME_TABLE,     /* linear between points; held at the ends; times count from start; `value` is not
                 used */
  TIME_FORMULA    /* value * formula(x, y, z, t - start) */
} time_shape;

typedef struct time_function {
  time_shape shape;
  double value;                 /* SI */
  double start, rise;           /* s */
  double end;                   /* s: nothing acts after; 0: it has none */
  const double *times, *values; /* table; not owned */
  const double *integrals;      /* table: of the values from the start to each of the times */
  int count;
  const struct formula *formula; /* of the variables below, in their order */
  double place[3];               /* m: where it is evaluated */
} time_function;

/* Variables of formulas. */
enum { FORMULA_X, FORMULA_Y, FORMULA_Z, FORMULA_T, FORMULA_VARIABLES };

/* Is it another function at another place? */
bool time_function_varies(const time_function *f);
/* The one at that place. */
time_function time_function_placed(const time_function *f, const double at[3]);

/* Integrals of a table's values from 0 to each of its times; [count]. */
void time_table_integrals(const double *times, const double *values, int count, double *integrals);

/* When it ends; infinite without an end. */
double time_function_end(const time_function *f);
/* 0 before start; after the end as if there were none, here and below. */
double time_function_at(const time_function *f, double t);
/* Integral from start to t, exact: displacement of a prescribed velocity. Not of a formula. */
double time_function_integral(const time_function *f, double t);
/* The same of any function by Simpson's rule, in so many pieces. */
double time_function_way(const time_function *f, double from, double to, int pieces);
/* Slope just after t. Not of a formula. */
double time_function_slope(const time_function *f, double t);
/* What comes at once at the start: the only jump that a function has. */
double time_function_jump(const time_function *f);

C_LINKAGE_END

#endif
