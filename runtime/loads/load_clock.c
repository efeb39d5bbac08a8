#include "runtime/loads/load_clock.h"

#include <math.h>

#include "dsl/base/elementary.h"

double load_clock_part(const load_clock *c, long step) {
  return pl_fmin(1, (double)(step - c->first) / (double)c->ramp);
}

double load_clock_time(const load_clock *c, const body *w, long step) {
  if (c->ramp == 0) return (double)step * w->time_step;
  return c->from + (c->to - c->from) * load_clock_part(c, step);
}

/* A time later than t by what rounding may do to the ends of increments. */
double load_clock_just_after(const load_clock *c, double t) {
  return t + 1e-9 * (c->to - c->from);
}

bool load_clock_settled(const load_clock *c, const time_function *f, double t) {
  return t > load_clock_just_after(c, f->start) &&
         t <= load_clock_just_after(c, time_function_end(f));
}

static double settled(const load_clock *c, const time_function *f, in_time *value, double t) {
  return load_clock_settled(c, f, t) ? value(f, t) : 0;
}

/* After a number of steps; within an increment evenly from its beginning to its end, so that no
   load comes all at once. */
double load_clock_value(const load_clock *c, const body *w, const time_function *f, in_time *value,
                        long step) {
  if (c->ramp == 0) return value(f, load_clock_time(c, w, step));
  const double part = load_clock_part(c, step);
  return (1 - part) * settled(c, f, value, c->from) + part * settled(c, f, value, c->to);
}

/* Part of the time within half a step of t that comes after `start`. The run itself begins with
   what begins at 0. */
double load_clock_part_after(const body *w, double start, double t) {
  return start <= 0 ? 1 : pl_fmin(pl_fmax((t - start) / w->time_step + 0.5, 0), 1);
}

/* In the first increment of a body that goes on: what acts at time 0 already, as far as it still
   does. */
static double acting_before(const load_clock *c, const time_function *f, long step) {
  if (!c->goes_on || c->from > 0 || f->start > 0) return 0;
  return (1 - load_clock_part(c, step)) * time_function_at(f, 0);
}

/* What acts in the step: the value at its instant, of a jump nearby the part that is covered. At
   the end the last value falls away. */
double load_clock_acting(const load_clock *c, const body *w, const time_function *f, long step) {
  if (c->ramp > 0)
    return load_clock_value(c, w, f, time_function_at, step) + acting_before(c, f, step);
  const double t = load_clock_time(c, w, step), end = time_function_end(f),
               jump = time_function_jump(f), over = load_clock_part_after(w, end, t);
  double value = time_function_at(f, pl_fmin(t, end));
  if (jump != 0) value += jump * (load_clock_part_after(w, f->start, t) - (t >= f->start));
  return over > 0 ? value - over * time_function_at(f, end) : value;
}
