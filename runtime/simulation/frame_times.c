#include "runtime/simulation/frame_times.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"

/* Positions of &output's, the first of which is that of the undeformed body. */
static int64_t evenly(const frame_times *f, int64_t frame) {
  const int64_t end = run_clock_end(f->clock), count = f->deck->output.frames;
  return (int64_t)llround((double)frame * (double)end / (double)count);
}

static int64_t position_at(const frame_times *f, double time) {
  const int64_t end = run_clock_end(f->clock);
  const double whole = f->deck->simulation.end_time;
  const double position =
      f->clock->relaxation ? time / whole * (double)end : time / f->clock->time_step;
  return position < (double)end ? (int64_t)llround(position) : end;
}

static int growing(const void *a, const void *b) {
  const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
  return (x > y) - (x < y);
}

void frame_times_open(frame_times *f, const deck *k, const run_clock *clock) {
  const int64_t even = k->output.frames > 0 ? k->output.frames + 1 : 0;
  int64_t most = even, count = 0;
  for (int n = 0; n < k->frame_count; n++)
    most += k->frames[n].at_count;
  *f = (frame_times){.deck = k, .clock = clock};
  f->position = must_calloc((size_t)most + 1, sizeof *f->position);
  f->came = must_calloc((size_t)k->frame_count + 1, sizeof *f->came);
  for (int64_t n = 0; n < even; n++)
    f->position[count++] = evenly(f, n);
  for (int n = 0; n < k->frame_count; n++) {
    f->came[n] = -1;
    for (int t = 0; t < k->frames[n].at_count; t++)
      f->position[count++] = position_at(f, k->frames[n].at[t]);
  }
  qsort(f->position, (size_t)count, sizeof *f->position, growing);
  for (int64_t n = 0; n < count; n++)
    if (n == 0 || f->position[n] != f->position[n - 1]) f->position[f->count++] = f->position[n];
}

void frame_times_close(frame_times *f) {
  free(f->position);
  free(f->came);
}

/* The first frame after the present position, from `frame` on. */
static int64_t frame_after(const frame_times *f, int64_t frame) {
  const int64_t here = run_clock_position(f->clock);
  while (frame < f->count && f->position[frame] <= here)
    frame++;
  return frame;
}

int64_t frame_times_next(const frame_times *f) {
  const int64_t frame = frame_after(f, f->clock->at.next_frame);
  return frame < f->count ? f->position[frame] : INT64_MAX;
}

bool frame_times_due(const frame_times *f) {
  const run_progress *at = &f->clock->at;
  if ((f->count == 0 && f->deck->frame_count == 0) || at->last_frame_step == at->step) return false;
  if (at->status != STEP_OK || at->event) return true;
  return frame_after(f, at->next_frame) > at->next_frame;
}

bool frame_times_look(frame_times *f, const monitors *m, double time, const double *values,
                      run_progress *at) {
  bool some = false;
  for (int n = 0; n < f->deck->frame_count; n++) {
    const deck_frame *frame = &f->deck->frames[n];
    if (frame->at_count > 0 || f->came[n] >= 0 || !monitors_meet(m, &frame->event, time, values))
      continue;
    f->came[n] = time;
    some = true;
  }
  some = some && at->last_frame_step != at->step;
  if (some) at->event = 1;
  return some;
}

void frame_times_taken(const frame_times *f, run_progress *at) {
  at->last_frame_step = at->step;
  at->event = 0;
  at->next_frame = frame_after(f, at->next_frame);
}
