/* Inside of a simulation, for the modules that make it up: simulation.c (set-up, time loop,
   samples), simulation_frames.c, simulation_bad.c, simulation_save.c. */
#ifndef PERILAT_RUNTIME_SIMULATION_PARTS_H
#define PERILAT_RUNTIME_SIMULATION_PARTS_H

#include "dsl/base/arena.h"
#include "runtime/base/subnormals.h"
#include "runtime/base/team.h"
#include "runtime/interaction/interaction.h"
#include "runtime/lattice/random_field.h"
#include "runtime/simulation/ledger.h"
#include "runtime/simulation/loads.h"
#include "runtime/simulation/monitor.h"
#include "runtime/simulation/profile.h"
#include "runtime/simulation/relaxation.h"
#include "runtime/simulation/simulation.h"

typedef struct progress_state { /* first part of a checkpoint: the sizes of others depend on it */
  int64_t begun;                /* the sample at step 0 is taken */
  int64_t step;                 /* steps done */
  int64_t status;               /* step_status */
  int64_t samples;              /* taken */
  int64_t next_sample;          /* in multiples of the interval */
  int64_t next_frame, last_frame_step;
  int64_t stop;      /* which &stop has ended the run; -1: none */
  frame_mark frames; /* of the caller */
} progress_state;

typedef struct frame_source { /* where a frame field comes from */
  enum {
    FROM_STATE,
    FROM_VELOCITY,
    FROM_DAMAGE,
    FROM_DISSIPATED,
    FROM_FIELD,
    FROM_OUTPUT,
    FROM_PARAMETER
  } kind;
  double *const *arrays; /* STATE: one a component */
  int index;             /* FIELD, OUTPUT, PARAMETER (of those that differ from bond to bond) */
} frame_source;

struct simulation {
  const deck *deck;
  rows *lattice;
  const pl_law *law;
  double *parameters;    /* the caller's; those of random fields become their mean */
  random_fields *fields; /* NULL without */
  sweep *state;
  body *body; /* of the state */
  team *team; /* of the threads; each has a block of the body */
  loads *loads;
  monitors *monitors;
  relaxation *relaxation; /* NULL: a dynamic run */
  ledger ledger;
  step_limit limit;
  double sample_interval; /* s */
  int64_t step_count, history_capacity;
  int series_count;
  double *time, *history; /* [capacity]; [series][capacity] */
  double *sampled;        /* [series] */
  rows_bond *bonds;
  frame_field *frame_fields;
  frame_source *frame_sources;
  int frame_field_count;
  bad_state bad;
  double *bad_parameters; /* of the bad bond */
  double *bad_fields;     /* [law's fields], of the bad bond; families: [1 + neighbours] of these */
  bad_neighbour *bad_family;
  progress_state at;
  bool observe, go_on;   /* set by one thread for all */
  int64_t observed_step; /* of the state observed last; -1: none */
  profile *profile;      /* NULL: nothing is measured */
  int64_t until;
  const volatile sig_atomic_t *interrupted;
};

/* False with a diagnostic when the deck asks for fields that no run has. */
bool frames_check(const simulation *s, diagnostics *d);
/* What the deck asks for. `damage` is that of particles and all damages of the law. */
void frames_choose(simulation *s);
/* True when the deck lists the field `name`. */
bool frames_want(const simulation *s, const char *name);
/* What the run has done and what it has to do: steps, or increments of quasi-static runs. */
int64_t simulation_position(const simulation *s);
int64_t simulation_end(const simulation *s);
/* Position at which a frame is due; the first is that of the undeformed body. */
int64_t frames_step(const simulation *s, int64_t frame);

/* Fills s->bad after a sweep that found a velocity beyond its limit. */
void bad_explain(simulation *s);
/* The energies just sampled are none that a stable step allows. */
void bad_energy(simulation *s, const char *what);

/* Makes sure that the run has begun and that its present state is the one observed; outside of the time loop. */
void simulation_observe(simulation *s);

#endif
