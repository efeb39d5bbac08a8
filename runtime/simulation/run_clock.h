/* How far a run is: steps and increments done, samples and frames taken, and the time as the
   deck's loads count it.

   Steps are counted as they were planned. Where they have shrunk (step_shrink.h), each is done in
   2^halvings parts; samples, frames and windows of monitors keep to whole ones. What moves the
   bodies knows the parts alone: it counts them as if all steps since the start had been so long,
   so that times stay whole numbers of them. */
#ifndef PERILAT_RUNTIME_RUN_CLOCK_H
#define PERILAT_RUNTIME_RUN_CLOCK_H

#include <stdbool.h>
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

/* The most that a step may shrink: by 2^this. */
enum { RUN_MOST_HALVINGS = 10 };

typedef enum step_cause { STEP_STIFFER, STEP_CRACKED, STEP_TOUCHED } step_cause;

typedef struct step_change { /* the step became shorter */
  int64_t step;              /* steps done then */
  int64_t halvings;          /* from then on it is 2^-halvings of that planned */
  int64_t cause, body;       /* step_cause; which body of the run, of contact the first of them */
} step_change;

typedef struct run_progress { /* first part of a checkpoint: the sizes of others depend on it */
  int64_t begun;              /* the sample at step 0 is taken */
  int64_t step;               /* steps done */
  int64_t status;             /* step_status */
  int64_t samples;            /* taken */
  int64_t next_sample;        /* in multiples of the interval */
  int64_t next_frame, last_frame_step;
  int64_t event;                  /* of a &frame: it has come, its frame is not taken */
  int64_t stop;                   /* which &stop has ended the run; -1: none */
  frame_mark frames;              /* of the caller */
  int64_t halvings, part, looked; /* parts done of the step; steps done at the last look at it */
  int64_t more;                   /* parts done beside whole steps, in all */
  int64_t doubted;                /* energies of the last sample are none of a stable step */
  int64_t touched;                /* some particles have come near to touch */
  int64_t change_count;
  step_change changes[RUN_MOST_HALVINGS]; /* [change_count] */
} run_progress;

typedef struct run_clock {
  run_progress at;
  double time_step;                    /* s: as planned */
  int64_t step_count;                  /* planned; quasi-static runs take as many as it takes */
  const struct relaxation *relaxation; /* NULL: a dynamic run */
} run_clock;

/* What the run has done and what it has to do: steps, or increments of quasi-static runs. */
int64_t run_clock_position(const run_clock *c);
int64_t run_clock_end(const run_clock *c);
double run_clock_time(const run_clock *c); /* s */
/* The present step, s; of dynamic runs, how many of these it would have taken up to here. */
double run_clock_step(const run_clock *c);
int64_t run_clock_parts(const run_clock *c);
/* A part more is done; false: the step is not whole yet. */
bool run_clock_go_on(run_clock *c);

C_LINKAGE_END

#endif
