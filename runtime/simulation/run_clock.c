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
                       : (double)run_clock_parts(c) * run_clock_step(c);
}

double run_clock_step(const run_clock *c) {
  if (c->relaxation && c->relaxation->state.step > 0) return c->relaxation->state.step;
  return c->time_step / (double)(INT64_C(1) << c->at.halvings);
}

int64_t run_clock_parts(const run_clock *c) {
  return (c->at.step << c->at.halvings) + c->at.part;
}

bool run_clock_go_on(run_clock *c) {
  c->at.part++;
  if (c->at.part < INT64_C(1) << c->at.halvings) {
    c->at.more++;
    return false;
  }
  c->at.part = 0;
  c->at.step++;
  return true;
}
