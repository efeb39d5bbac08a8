/* How far a run is: steps and increments done, samples and frames taken, and the time as the
   deck's loads count it. */
#ifndef PERILAT_RUNTIME_RUN_CLOCK_H
#define PERILAT_RUNTIME_RUN_CLOCK_H

#include <stdint.h>

#include "dsl/base/c_linkage.h"
#include "runtime/result/frame_file.h"

C_LINKAGE_BEGIN

struct relaxation;

typedef enum step_status {
  STEP_OK,
  STEP_STOPPED /* a &stop */,
  STEP_END /* end_time */,
  STEP_BAD /* NaN or runaway */
} step_status;

typedef struct run_progress { /* first part of a checkpoint: the sizes of others depend on it */
  int64_t begun;              /* the sample at step 0 is taken */
  int64_t step;               /* steps done */
  int64_t status;             /* step_status */
  int64_t samples;            /* taken */
  int64_t next_sample;        /* in multiples of the interval */
  int64_t next_frame, last_frame_step;
  int64_t event;     /* of a &frame: it has come, its frame is not taken */
  int64_t stop;      /* which &stop has ended the run; -1: none */
  frame_mark frames; /* of the caller */
} run_progress;

typedef struct run_clock {
  run_progress at;
  double time_step;                    /* s */
  int64_t step_count;                  /* planned; quasi-static runs take as many as it takes */
  const struct relaxation *relaxation; /* NULL: a dynamic run */
} run_clock;

/* What the run has done and what it has to do: steps, or increments of quasi-static runs. */
int64_t run_clock_position(const run_clock *c);
int64_t run_clock_end(const run_clock *c);
double run_clock_time(const run_clock *c); /* s */

C_LINKAGE_END

#endif
