/* Where the time of a run goes, a mean over its threads: what they work on, and how long they wait
   for each other. Parts do not overlap, so that they add up to what the run took but for the little
   that is in none. */
#ifndef PERILAT_RUNTIME_PROFILE_H
#define PERILAT_RUNTIME_PROFILE_H

#include "runtime/parts/run_body.h"

/* X(code, name) */
#define PROFILE_PARTS(X)                                                                           \
  X(LAW, "law")                                                                                    \
  X(PARTICLES, "moving particles")                                                                 \
  X(LOADS, "loads and monitors")                                                                   \
  X(SAMPLING, "sampling")                                                                          \
  X(WAITING, "waiting for threads")                                                                \
  X(WRITING, "frames, checkpoints")

typedef enum profile_part {
#define X(code, name) PROFILE_##code,
  PROFILE_PARTS(X)
#undef X
      PROFILE_PART_COUNT
} profile_part;

typedef struct profile {
  double part[PROFILE_PART_COUNT]; /* s */
  double pass[BODY_TIMED_PASSES];  /* s: of a law of families, pass by pass */
  double elapsed;                  /* s: of the team, work and waiting */
  double sampled, loaded;          /* s: by one thread for all: samples; loads and monitors */
} profile;

extern const char *const profile_names[PROFILE_PART_COUNT];

/* From what the blocks of the bodies have measured so far, on so many threads. */
void profile_sum(profile *p, const run_body *bodies, int count, int threads);

#endif
