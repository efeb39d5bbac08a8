/* This room: loads. What acts on a few particles from outside: supports, drives, forces, end
   moments, collected from a deck; load_steps.h says what they do in a step. And the masses that
   particles carry. */
#ifndef PERILAT_RUNTIME_LOADS_H
#define PERILAT_RUNTIME_LOADS_H

#include "dsl/base/diagnostics.h"
#include "runtime/body/body.h"
#include "runtime/deck/deck.h"
#include "runtime/lattice/regions.h"
#include "runtime/lattice/rows.h"
#include "runtime/loads/load_clock.h"

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
  /* rad/s: in space, about all axes; kept by the first constraint of a particle's rotations */
  double turning[3];
  /* m/s, rad/s: what the velocity changes by at once, as the motion begins in the coming step */
  double impulse;
  /* N, N m: in the state that the last step began with, or in the one observed since */
  double reaction;
  load_sums sums;
} constraint;

typedef struct applied { /* part of a force that acts on one component of one particle */
  int64_t site;
  int32_t component;
  int32_t cause;      /* index into the deck's forces, then end moments, then the run's links */
  const double *link; /* N, N m: of a link, what it exerts in the present state; else NULL */
  int64_t place;  /* of what differs from place to place: one of loads.places + 1; 0: the site */
  int64_t holder; /* index of the constraint on the same component, or -1 */
  double share;   /* force = share * time function */
  /* A tie's: it is known when the particles of the lattice have moved, and acts in the same step;
     in between `seen` (N) is that of the state observed. */
  int64_t tied;
  double seen;
  double now;      /* N: force of the coming step; of a tie of the last one */
  double velocity; /* m/s: after the last step */
  load_sums sums;
} applied;

typedef struct loads {
  const deck *deck;
  const rows *lattice;
  bool gives_way;        /* of a mesh: driven nodes do (newmark_motion) */
  region_sites *regions; /* [deck->region_count] */
  /* Both in the order of their sites, so that each thread puts its own right, and sums in one order
     whatever the threads. */
  constraint *constraints;
  long constraint_count;
  applied *forces;
  long force_count;
  double (*places)[3]; /* [place_count] m */
  long place_count;
  /* [size] 1: the particle goes on from another run, whose steps were so long (s; 0: it was at
     rest): its velocity is already that of half of it before the run; NULL: of none */
  unsigned char *goes_on;
  double former_step;
  load_clock clock;
} loads;

/* Selects the regions, protects what is to be protected, collects supports, drives and forces. NULL
   with diagnostics where two motions or velocities at the start are one too many. */
loads *loads_new(const deck *k, int lattice, rows *w, const char *law, int dof, diagnostics *d);
void loads_free(loads *l);

/* The shares of the deck's force of that number in sum, of a load per length its length in m, and
   on how many particles. */
double loads_shares_of(const loads *l, int force, long *particles);

/* A share of the deck's force of that number that is found elsewhere, as of a traction: m^2; the
   last one is to be followed by loads_links_added. */
void loads_add_share(loads *l, int32_t particle, int component, int force, double share);
/* The same of one that differs from place to place, with the value that it has at `at` (m), which
   the shares of several particles may follow. False with a diagnostic where the formula has none
   there when it begins. */
bool loads_add_place(loads *l, const double at[3], int force, diagnostics *d);
void loads_add_share_there(loads *l, int32_t particle, int component, int force, double share);

/* A share of a force of the run's link of that number, which stands at `force` (N, N m) when it is
   known; the last one is to be followed by loads_links_added. */
void loads_add_link(loads *l, int64_t site, int component, int link, double share,
                    const double *force);
void loads_links_added(loads *l);
/* The same of a tie; numbers of ties go on behind those of links. */
void loads_add_tie(loads *l, int64_t site, int component, int tie, double share,
                   const double *force);
int loads_cause_of_tie(const loads *l, int tie);
/* N: what acts in the state observed. */
static inline double loads_acting(const applied *f) {
  return f->tied ? f->seen : f->now;
}

/* Puts the deck's point masses on the particles. */
void loads_point_masses(const loads *l, body *w);
/* kg: the deck's point mass of that number on all of its particles, and how many these are; 0 of
   another lattice's. */
double loads_point_mass_of(const loads *l, int index, long *particles);
/* kg: of the heaviest particle, with its point masses. */
double loads_heaviest(const loads *l);

/* Displacements and velocities that regions begin with. False with diagnostics where a velocity is
   too large for a step. */
bool loads_initial_motion(const loads *l, body *w, diagnostics *d);
/* Indices of the constraints of a region's particles in a component; malloc'ed. */
long loads_constraints_of(const loads *l, int region, int component, int32_t **indices);
/* Likewise of the forces and end moments on these. */
long loads_forces_of(const loads *l, int region, int component, int32_t **indices);

#endif
