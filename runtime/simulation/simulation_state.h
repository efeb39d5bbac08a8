/* What a simulation is made of, for the modules that march, save and show it. */
#ifndef PERILAT_RUNTIME_SIMULATION_STATE_H
#define PERILAT_RUNTIME_SIMULATION_STATE_H

#include "runtime/base/team.h"
#include "runtime/interaction/sweep.h"
#include "runtime/lattice/parameter_planes.h"
#include "runtime/simulation/frames.h"
#include "runtime/simulation/history.h"
#include "runtime/simulation/ledger.h"
#include "runtime/simulation/loads.h"
#include "runtime/simulation/monitor.h"
#include "runtime/simulation/profile.h"
#include "runtime/simulation/relaxation.h"
#include "runtime/simulation/run_clock.h"
#include "runtime/simulation/simulation.h"
#include "runtime/simulation/step_choice.h"

struct simulation {
  const deck *deck;
  rows *lattice;
  const pl_law *law;
  double *parameters;       /* the caller's; those of random fields become their mean */
  parameter_planes *planes; /* NULL without */
  sweep *state;
  body *body; /* of the state */
  team *team; /* of the threads; each has a block of the body */
  loads *loads;
  monitors *monitors;
  relaxation *relaxation; /* NULL: a dynamic run */
  ledger ledger;
  step_limit limit;
  step_plan plan;
  run_clock clock;
  history history;
  rows_bond *bonds;
  frame_set *frames;
  bad_search *bad;
  /* The time loop's: */
  bool observe, go_on;   /* set by one thread for all */
  int64_t observed_step; /* of the state observed last; -1: none */
  profile *profile;      /* NULL: nothing is measured */
  int64_t until;
  const volatile sig_atomic_t *interrupted;
};

#endif
