/* Loads as functions of time: constant, ramp, ramp and hold, cosine, table. */
#ifndef PERILAT_RUNTIME_TIME_FUNCTION_H
#define PERILAT_RUNTIME_TIME_FUNCTION_H

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

typedef enum time_shape {
  TIME_CONSTANT,  /* value from `start` on */
  TIME_RAMP,      /* value * (t - start)/rise, without end */
  TIME_RAMP_HOLD, /* the same up to `rise`, then value */
  TIME_COSINE,    /* value * (1 - cos(pi (t - start)/rise))/2 up to `rise`, then value */
  TIME_TABLE /* linear between points; held at the ends; times count from start; `value` is not used
              */
} time_shape;

typedef struct time_function {
  time_shape shape;
  double value;                 /* SI */
  double start, rise;           /* s */
  double end;                   /* s: nothing acts after; 0: it has none */
  const double *times, *values; /* table; not owned */
  const double *integrals;      /* table: of the values from the start to each of the times */
  int count;
} time_function;

/* Integrals of a table's values from 0 to each of its times; [count]. */
void time_table_integrals(const double *times, const double *values, int count, double *integrals);

/* When it ends; infinite without an end. */
double time_function_end(const time_function *f);
/* 0 before start; after the end as if there were none, here and below. */
double time_function_at(const time_function *f, double t);
/* Integral from start to t, exact: displacement of a prescribed velocity. */
double time_function_integral(const time_function *f, double t);
/* Slope just after t. */
double time_function_slope(const time_function *f, double t);
/* What comes at once at the start: the only jump that a function has. */
double time_function_jump(const time_function *f);

C_LINKAGE_END

#endif
