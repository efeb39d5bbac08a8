/* Stamps of a run at work (stamp.h): how they move, what they do to bodies, and what of it the
   ledger has.

   When a step has taken all bodies to t_(n+1) each stamp goes there, too: a free one by the forces
   found at t_n, v += dt (F/m + g), x += dt v; another one where the deck says. Then forces are
   found at the new places, and act in the coming step. Their work on each body is work from
   outside; that on the stamp, of its motion and contact together, has the opposite sign, so that in
   sum it goes out. Gravity, and what moves a prescribed stamp, do work on it.

   The largest frequencies: with k |(u - x) n|^2 <= k ((1 + a) |u n|^2 + (1 + 1/a) |x n|^2), x the
   motion of a stamp of mass M that at most N particles of a body touch, S the sum of N k/M over its
   bodies, and a = S m/k for a particle of mass m, each stamp adds k/m + S to the square of a body's
   own, of the lightest particle; its dampers c/m and the sum of N c/M likewise. c/m = 2 z sqrt(k/m)
   is most of the lightest particle, c of the heaviest, with its point masses. N is the surface half
   a spacing outside the stamp over that of a particle, and no more than there are particles. */
#ifndef PERILAT_RUNTIME_RUN_STAMP_H
#define PERILAT_RUNTIME_RUN_STAMP_H

#include "runtime/interaction/stamp.h"
#include "runtime/parts/link_limit.h"
#include "runtime/parts/run_body.h"
#include "runtime/parts/run_contact.h"

typedef struct stamp_peaks { /* of all states so far */
  int64_t touching;          /* particles at a time */
  double force;              /* N, on the stamp */
} stamp_peaks;

typedef struct stamp_state { /* what a later step depends on */
  stamp_motion at;
  double way;             /* m along the direction, of a prescribed motion */
  double work;            /* J: done on it, by bodies and by what moves it */
  double damped, slipped; /* J: taken by damping, by friction */
  stamp_peaks peaks;
  ledger ledger;
} stamp_state;

typedef struct run_stamp {
  const deck_stamp *from;
  int *of; /* [count] numbers of the bodies that it touches */
  int count;
  double *stiffness; /* [count] N/m */
  double damping;    /* of the critical one; 0 in quasi-static runs */
  stamp *found;
  stamp_state state;
  stamp_load load; /* at the present places */
  bool too_far;    /* it has gone further than a spacing in the last step */
  /* Of one that goes on from another run, whose step was that long (s; 0: it was quasi-static), the
     place that its way counts from, m. */
  bool goes_on;
  double former_step, start[3];
} run_stamp;

typedef struct run_stamps {
  run_stamp *items; /* [count] */
  int count;
  const deck *deck;
  run_body *bodies;
  int body_count;
  bool *clears;   /* [body_count] no contact clears the outer forces of the body */
  int64_t step;   /* whose forces are known; -1: of none */
  double *power;  /* [body_count] */
  double slowest; /* m: the least spacing: none may go further in a step */
} run_stamps;

/* Which bodies, and how stiff; their masses are known. touching[body_count]: what stamps add to the
   fastest mode of each. False with diagnostics where a stiffness cannot be told. */
bool run_stamps_open(run_stamps *s, const deck *k, run_body *bodies, int body_count,
                     touch_rates *touching, diagnostics *d);
/* When the bodies and contacts have begun. */
void run_stamps_begin(run_stamps *s, const run_contacts *contacts);
void run_stamps_free(run_stamps *s);
/* When all is where it begins: no particle lies in a stamp, and none is too fast for the step.
   False with diagnostics. */
bool run_stamps_fit(const run_stamps *s, double step, diagnostics *d);

/* Forces at the present places, after `step` steps and after those of contacts. False where a stamp
   has gone further than a spacing. */
bool run_stamps_find(run_stamps *s, int64_t step);
/* When the forces at the beginning are known: velocities half a step before. */
void run_stamps_set_back(run_stamps *s);
/* In the state after `step` steps: m/s, the mean of those half a step before and after;
   energies. */
double run_stamp_velocity(const run_stamps *s, int number, int component, int64_t step);
stamp_energies run_stamp_energies(const run_stamps *s, int number, int64_t step);
double run_stamps_memory(const run_stamps *s); /* bytes */

#endif
