#include "runtime/simulation/run_clock.h"

#include "runtime/simulation/relaxation.h"

int64_t run_clock_position(const run_clock *c) {
  return c->relaxation ? c->relaxation->state.done : c->at.step;
}

int64_t run_clock_end(const run_clock *c) {
  return c->relaxation ? c->relaxation->deck->increments : c->step_count;
}

double run_clock_time(const run_clock *c) {
  return c->relaxation ? (double)c->relaxation->state.done * c->relaxation->interval
                       : (double)c->at.step * c->time_step;
}
