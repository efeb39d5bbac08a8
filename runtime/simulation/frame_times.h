/* When frames are taken: evenly spaced (&output), at given times, and at the first sample at which a
   monitor says so (&frame). The last state is always worth a frame. */
#ifndef PERILAT_RUNTIME_FRAME_TIMES_H
#define PERILAT_RUNTIME_FRAME_TIMES_H

#include <stdbool.h>
#include <stdint.h>

#include "runtime/deck/deck.h"
#include "runtime/simulation/monitor.h"
#include "runtime/simulation/run_clock.h"

typedef struct frame_times {
  const deck *deck;
  const run_clock *clock;
  int64_t *position; /* [count] steps, of quasi-static runs increments; growing */
  int64_t count;
  double *came; /* [deck->frame_count] s: when the event of a &frame came; -1: not yet */
} frame_times;

/* Deck and clock must stay. */
void frame_times_open(frame_times *f, const deck *k, const run_clock *clock);
void frame_times_close(frame_times *f);

/* Position of the first frame after the present one; INT64_MAX without. */
int64_t frame_times_next(const frame_times *f);
/* A frame's time has been reached, and it is not taken yet. */
bool frame_times_due(const frame_times *f);
/* Values just sampled: whether an event has come for the first time, and a frame is due for it. */
bool frame_times_look(frame_times *f, const monitors *m, double time, const double *values,
                      run_progress *at);
/* That after a frame was taken at the present step: which one is next. */
void frame_times_taken(const frame_times *f, run_progress *at);

#endif
