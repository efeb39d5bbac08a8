/* Quasi-static runs by dynamic relaxation: the loads are applied in increments of the deck's time;
   within one all of them move on evenly for as long as a wave takes through the body and back, then
   stand still until the body has come to rest. Time steps are those of dynamics; the inertia is a
   means.

   Mass damping is chosen as they go (Underwood 1983): critical for the frequency of the motion
   since the last look, omega^2 = -du df/(du m du) with the displacements u and the forces f of
   bonds and links. While the loads move, there is a tenth of it: the drag of the whole on a bar
   that is drawn out in this time is pi/2 of the force that the increment needs, and breaks what
   would have held. The ramp takes about a period, so that a bar without damping comes out of it at
   rest.

   An increment is done when the unbalanced force, the root of the sum of squares over all
   components that are not held, is at most `tolerance` times the same of the reactions, or of the
   forces and weights applied if that is larger. What once was needed does not sink below a
   hundredth of its largest value, so that a broken body comes to rest, too. Where nothing is held
   or applied, as of a free body that its rest state moves, that value is the largest unbalanced
   force. Moments count over a spacing.

   A body that shrinks or swells by itself (`rest stretch`) needs no forces. Where loads and
   reactions are less than 1e-5 of the largest forces between particles so far, that part of these
   is what the unbalance is compared with: the slenderest bodies that are loaded bear more. A body
   is at rest, too, when rounding alone is left, a strain of 1e-15.

   Between increments the body may have become stiffer, by its age, say: after increments 1, 2, 4,
   8, ... its present stiffness is looked at, and after each one as long as it grows. Then the step
   is chosen anew, for what another such increment makes of it. It never grows again.

   Static runs (mesh_rest.h) have increments, too, of one step each, which solves K u = F. */
#ifndef PERILAT_RUNTIME_RELAXATION_H
#define PERILAT_RUNTIME_RELAXATION_H

#include "runtime/parts/run_body.h"

typedef struct relaxation_state { /* what a later step depends on */
  int64_t done;                   /* increments */
  int64_t unbalanced;             /* of these: ended after `most_steps` */
  int64_t within;                 /* of these: compared with forces between particles */
  int64_t steps;                  /* of the last that was done */
  double unbalance;               /* as it was looked at last, of the body with the largest */
  int64_t next_look;              /* at the stiffness: after so many increments */
  double part;                    /* longest stable step at the last look, over that at rest */
  double step;                    /* s: the step since it was changed; 0: as planned */
} relaxation_state;

typedef struct relaxed_state { /* of a body, likewise */
  double rate;                 /* 1/s: mass damping, critical for the motion looked at last */
  double largest;              /* N: the largest reaction or load so far */
  double inner;                /* N: the same of the forces between particles */
  int64_t within;              /* these were what its unbalance was compared with */
} relaxed_state;

typedef struct relaxed_body { /* a body at the last look */
  relaxed_state state;
  double *displacement[PL_MAX_DOF], *force[PL_MAX_DOF]; /* [size] */
} relaxed_body;

typedef struct relaxation {
  relaxation_state state;
  relaxed_body *looked_at; /* [body_count] */
  double interval;         /* s of the deck's time in an increment */
  long ramp;               /* steps */
  bool goes_on;            /* from another run */

  /* own */
  const deck_relaxation *deck;
  const run_body *bodies;
  int body_count;
  double *total; /* [size] of the largest body */
} relaxation;

/* Each body is damped and judged by itself; all come to rest before the next increment. Forces of
   the sweeps must be kept. `part` of the largest stable step is taken. */
relaxation *relaxation_new(const deck *k, const run_body *bodies, int count, double part);
void relaxation_free(relaxation *r);

/* Before the first step. */
void relaxation_begin(relaxation *r);
/* In a static run the increment is done at once: each is one step. */
void relaxation_solved(relaxation *r, double unbalance);
/* The forces after that many steps should be observed and looked at. */
bool relaxation_due(const relaxation *r, int64_t step);
/* Looks at what was observed: damping of the coming steps; true when the increment is done. */
bool relaxation_look(relaxation *r, int64_t step);
/* The next increment begins. */
void relaxation_next(relaxation *r, int64_t step);
/* The stiffness should be looked at; what was found, the part of the longest stable step at rest
   that is left. Returns the part that the next increment may leave. */
bool relaxation_stiffness_due(const relaxation *r);
double relaxation_stiffness(relaxation *r, double part);
/* Clock of the loads in the increment that began after `first` steps. */
load_clock relaxation_clock(const relaxation *r, int64_t first);

#endif
