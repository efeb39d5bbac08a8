/* The deck's time after a number of steps, and what its functions of time are then. */
#ifndef PERILAT_RUNTIME_LOAD_CLOCK_H
#define PERILAT_RUNTIME_LOAD_CLOCK_H

#include <stdbool.h>

#include "runtime/body/body.h"
#include "runtime/deck/time_function.h"

/* Steps times their length where `ramp` is 0. Else, in an increment of a quasi-static run, time and
   loads go evenly from what they are at `from` to what they are at `to` within so many steps, and
   stand. The body begins without loads; those that begin at the end of an increment come in the
   next one. A body that goes on from another run begins with the loads of time 0. */
typedef struct load_clock {
  double from, to; /* s */
  int64_t first, ramp;
  int64_t goes_on; /* 0 or 1 */
} load_clock;

/* Time functions or their integrals. */
typedef double in_time(const time_function *f, double t);

double load_clock_time(const load_clock *c, const body *w, long step);
/* A time later than t by what rounding may do to the ends of increments. */
double load_clock_just_after(const load_clock *c, double t);
/* When an increment has ended at t: whether it acts. What begins then comes in the next increment,
   what ends then goes in the next. */
bool load_clock_settled(const load_clock *c, const time_function *f, double t);
/* Part of the increment's way from its beginning to its end, after a number of steps. */
double load_clock_part(const load_clock *c, long step);
/* After a number of steps; within an increment evenly from its beginning to its end. */
double load_clock_value(const load_clock *c, const body *w, const time_function *f, in_time *value,
                        long step);
/* Part of the time within half a step of t that comes after `start`: of a jump there, the part that
   counts. */
double load_clock_part_after(const body *w, double start, double t);
/* What acts in the step: the value at its instant, of a jump nearby the part that is covered. At
   the end the last value falls away. */
double load_clock_acting(const load_clock *c, const body *w, const time_function *f, long step);

#endif
