/* Everything that one run holds, from its deck to its result. */
#ifndef PERILAT_GENERATOR_RUN_STATE_H
#define PERILAT_GENERATOR_RUN_STATE_H

#include "generator/kernel/model.h"
#include "generator/report/run_request.h"
#include "runtime/result/result.h"
#include "runtime/simulation/profile.h"
#include "runtime/simulation/simulation.h"

enum { ERROR_LENGTH = 1024 };

/* Everything a run holds, so that one function can let go of it. */
typedef struct run {
  const run_options *options;
  arena *memory;
  source_set sources;
  diagnostics said;
  const deck *deck;
  model *models; /* [material_count] */
  int open_models;
  int processors;   /* what the process was kept to before (processors.h); 0: it still is */
  model **model_of; /* [run_law_count] of these; NULL where it is built in or not known */
  /* [lattice_count] the simulation's, when there is one; NULL where it is not known */
  rows **lattices;
  simulation_law *laws;          /* [run_law_count] of a crack that does not grow without one */
  const built_in_law **built_in; /* [run_law_count], NULL entries otherwise */
  simulation *simulation;
  result *result;
  char *result_path, *checkpoint_path;
  const char *fingerprint;
  bool is_kept;     /* a checkpoint of this run stands, */
  double kept_time; /* s: of this moment */
  char started[32];
  double *frame_buffer;
  profile profile;                        /* with --profile */
  const char *said_begin, *said_warnings; /* what was said before the march */
  /* How it ended: */
  const char *ending; /* "end", "stopped", "interrupted", "failed" */
  int signal;         /* that interrupted it, or 0 */
  double wall;        /* s: of the march */
  bool is_written;    /* the result */
} run;

/* Laws stand one for each interaction, then one for each crack. */
static inline int run_law_count(const run *r) {
  return r->deck->interaction_count + r->deck->crack_count;
}

/* What the run has come to, and what it will exit with. */
typedef struct run_end {
  step_status status;
  int exit_status;
  double seconds;
} run_end;

#endif
