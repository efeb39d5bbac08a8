/* What a simulation is made of, for the modules that march, save and show it. */
#ifndef PERILAT_RUNTIME_SIMULATION_STATE_H
#define PERILAT_RUNTIME_SIMULATION_STATE_H

#include "runtime/base/team.h"
#include "runtime/loads/tie_steps.h"
#include "runtime/parts/run_body.h"
#include "runtime/parts/run_contact.h"
#include "runtime/parts/run_link.h"
#include "runtime/parts/run_stamp.h"
#include "runtime/parts/step_choice.h"
#include "runtime/simulation/frame_times.h"
#include "runtime/simulation/frames.h"
#include "runtime/simulation/history.h"
#include "runtime/simulation/monitor.h"
#include "runtime/simulation/profile.h"
#include "runtime/simulation/relaxation.h"
#include "runtime/simulation/run_clock.h"
#include "runtime/simulation/simulation.h"

struct simulation {
  const deck *deck; /* `own` */
  struct deck own;  /* the caller's, but for what follows from frequencies */
  deck_damping *dampings;
  double *omegas;   /* rad/s of the lowest modes, as many as the deck asks about; else NULL */
  run_body *bodies; /* [body_count] in the order of the deck's lattices */
  int body_count;
  run_link *links; /* [link_count] between bodies */
  int link_count;
  tie_steps *ties; /* [tie_count] of lattices to meshes */
  int tie_count;
  run_contacts contacts;
  run_stamps stamps;
  tip_law *cracks; /* [cracks of the deck] */
  run_law *laws;   /* [law_count] the deck's interactions, those of one body after the other */
  int law_count;
  team *team; /* of the threads */
  int blocks; /* of a round of the team; each has a block of some bodies */
  monitors *monitors;
  relaxation *relaxation; /* NULL: a dynamic run */
  step_limit limit;       /* at rest the shortest of the bodies', */
  double touching;        /* s: the longest stable step once bodies touch, where steps may shrink */
  int ruling;             /* which is this one's */
  step_plan plan;
  run_clock clock;
  history history;
  frame_set *frames;
  frame_times frame_times;
  bad_search *bad;
  /* The time loop's: */
  int step_stages;       /* of a step: as many as the body with the most has */
  int link_stages;       /* then of links; none without them */
  int observe_stages;    /* the same of observing */
  bool observe, go_on;   /* set by one thread for all */
  uint64_t started_from; /* tells states of &start from each other; 0 without */
  int64_t observed_step; /* of the state observed last; -1: none */
  profile *profile;      /* NULL: nothing is measured */
  double links_begun;    /* s of the clock: their stages, where it is */
  int64_t until;
  const volatile sig_atomic_t *interrupted;
};

#endif
