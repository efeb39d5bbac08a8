/* What acts on a few particles from outside: supports, drives, forces, end moments, and mass
   damping in time. The sweep moves every particle as if it were free; afterwards the loaded ones
   are put right.

   Steps are of the second order. Places and forces are of the instants t_n = n dt, velocities of the middles between them, the
   first of them half a step before the run:
     v(-1/2) = v(0) - dt/2 a(0)                                   (loads_set_back)
   A load that begins at once within half a step of t_n counts there with the part of t_n - dt/2 .. t_n + dt/2 that it covers:
     t_(n-1)      t_n       t_(n+1)
        |----.-----|-----.-----|        here with three quarters of its value at t_n; damping likewise
               #################

   Signs: a reaction is what the support or drive exerts on the body,
     reaction = mass times prescribed acceleration - bond forces - mass damping - applied force,
   so that the sum of reactions, applied forces and damping is the rate of the momentum, to
   rounding. A drive leaves its particles free before its start; then their displacement follows
   time_function_integral (or the prescribed displacement) exactly, counted from where each particle
   is at the start. One that begins with a velocity changes the momentum at once: the impulse does work, but is no part of any
   reaction. */
#ifndef PERILAT_RUNTIME_LOADS_H
#define PERILAT_RUNTIME_LOADS_H

#include "dsl/base/diagnostics.h"
#include "runtime/body/body.h"
#include "runtime/deck/deck.h"
#include "runtime/lattice/rows.h"

typedef struct load_sums { /* J, since the start */
  double work; /* done by applied forces up to now and by reactions up to the last half step */
  /* of loaded particles beyond what the sweep counts: */
  double dissipated; /* by mass damping */
  double internal;   /* work done against the forces of the bonds; laws of families */
} load_sums;

typedef struct constraint { /* one component of one particle that is held or driven */
  int64_t site;
  int32_t component;
  int32_t drive;   /* index into the deck's drives; -1: support */
  int64_t active;  /* it is held now */
  double anchor;   /* m, rad: displacement less the motion prescribed */
  double held;     /* present prescribed displacement */
  double velocity; /* after the last step */
  double
      impulse; /* m/s, rad/s: what the velocity changes by at once, as the motion begins in the coming step */
  double
      reaction; /* N, N m: in the state that the last step began with, or in the one observed since */
  load_sums sums;
} constraint;

typedef struct applied { /* part of a force that acts on one component of one particle */
  int64_t site;
  int32_t component;
  int32_t cause;   /* index into the deck's forces, then end moments */
  int64_t holder;  /* index of the constraint on the same component, or -1 */
  double share;    /* force = share * time function */
  double now;      /* N: force of the coming step */
  double velocity; /* m/s: after the last step */
  load_sums sums;
} applied;

typedef struct
    load_look {      /* at the state observed: what loaded particles add to the sweep's sums, J */
  double kinetic;    /* they are not free */
  double work;       /* of reactions, from the last half step on */
  double dissipated; /* by mass damping, likewise */
} load_look;

typedef struct region_sites { /* of a region of the deck */
  int32_t *particles;
  long count;
} region_sites;

/* The deck's time after a number of steps: steps times their length where `ramp` is 0. Else, in an
   increment of a quasi-static run, time and loads go evenly from what they are at `from` to what they
   are at `to` within so many steps, and stand. The body begins without loads; those that begin at
   the end of an increment come in the next one. */
typedef struct load_clock {
  double from, to; /* s */
  int64_t first, ramp;
} load_clock;

typedef struct loads {
  const deck *deck;
  const rows *lattice;
  region_sites *regions; /* [deck->region_count] */
  /* Both in the order of their sites, so that each thread puts its own right, and sums in one order whatever the threads. */
  constraint *constraints;
  long constraint_count;
  applied *forces;
  long force_count;
  load_clock clock;
} loads;

/* Selects the regions, protects what is to be protected, collects supports, drives and forces. NULL
   with diagnostics where two motions or velocities at the start are one too many. */
loads *loads_new(const deck *k, int lattice, rows *w, const char *law, int dof, diagnostics *d);
void loads_free(loads *l);

/* Velocities that regions begin with. False with diagnostics where one is too large for a step. */
bool loads_initial_velocity(const loads *l, body *w, diagnostics *d);
/* Before the first step of each increment of a quasi-static run: its loads, and what they hold. */
void loads_increment(loads *l, const body *w, load_clock clock);
/* To be called once, before the first step: forces at time 0, places of the supports. */
void loads_begin(loads *l, body *w);
/* Then, in dynamic runs, when the state at time 0 was observed: velocities from there to half a step before. */
void loads_set_back(loads *l, body *w);
/* When step n -> n+1 has moved the rows of a block: applied forces, prescribed motions, reactions, work. What has not moved, as
   its row has a bad velocity, is left alone. */
void loads_apply(loads *l, body *w, int block, long step);
/* When all blocks have, alone: gravity and damping of the coming step (with a clock of its own that stays as it is). */
void loads_turn(const loads *l, body *w, long step);
load_sums loads_total(const loads *l);

/* When the state after `step` steps was observed: reactions in it. */
load_look loads_observe(loads *l, const body *w, long step);
/* Then: velocity (m/s, rad/s) of a particle at this instant, the mean of those half a step before and after. */
double loads_velocity(const loads *l, const body *w, int component, int64_t site, long step);

/* Indices of the constraints of a region's particles in a component; malloc'ed. */
long loads_constraints_of(const loads *l, int region, int component, int32_t **indices);

#endif
