/* A body of particles on the rows of a lattice: where they are, how they move, their masses, the
   forces on them. Knows neither laws nor loads; motion.h moves it, the engines of
   runtime/interaction find the forces.

   Rows are shared out to threads in contiguous blocks:
     row 5  . o o o .   block 1 (second thread): rows 3 .. 5
     row 4  o o o o .
     row 3  o o o o .
     row 2  o o o o .   block 0 (first thread): rows 0 .. 2
     row 1  . o o o .
     row 0  . o o . .   begin[0], count[0]: the part that holds sites, in whole vectors */
#ifndef PERILAT_RUNTIME_BODY_H
#define PERILAT_RUNTIME_BODY_H

#include "runtime/base/pool.h"
#include "runtime/kernel.h"
#include "runtime/lattice/rows.h"

enum { BODY_TIMED_PASSES = 8 }; /* of those after it the last one has the time, too */
/* B: nearer to what another thread writes, reading waits for that thread: pairs of cache lines go
   together */
enum { BODY_APART = 128 };

/* Which energies are kept: all but what laws of families lose, or these, too. */
typedef enum body_ledger { BODY_NO_LEDGER, BODY_LEDGER, BODY_LOSSES } body_ledger;

typedef struct body_block { /* what one thread works on */
  int first, last;          /* rows first .. last-1 */
  double *next;             /* [dof][pitch] velocities after the kick */
  bool aside;               /* forces are found of the present state, and not for a step */
  long bad_site;            /* first site whose velocity left the limits in this step, or -1 */
  int bad_component;
  double bad_velocity;
  /* s spent by whichever thread, on steps, of these on moving particles and on the passes of a law
     of families, and on samples; only kept when `timed`. Putting loaded particles right is no part
     of a step. */
  double stepping, moving, passes[BODY_TIMED_PASSES], loading, observing;
  char apart[BODY_APART];
} body_block;

typedef struct body_row { /* of a row in the state observed, J */
  double kinetic, stored, free;
  double state, rate; /* dissipated by the law of bonds since the start */
  double given;       /* by its rest state, likewise */
  /* mass damping, work against the bonds: from the middle of the last step on */
  double mass, internal;
} body_row;

typedef struct body_totals { /* sums over all particles and bonds, J, up to the state observed */
  double kinetic; /* half m (v before)(v after): what a spring and a mass conserve exactly */
  double stored;
  double free;                              /* kinetic, had only bonds acted */
  double dissipated_state, dissipated_rate; /* laws of bonds: by the law since the start */
  double given_by_rest; /* to the law since the start, by its rest state and fields that change */
  double internal;      /* laws of families: work done against the forces of the bonds */
  double dissipated;    /* by mass damping since the start */
  double gravity;       /* work of gravity since the start */
  double outer;         /* the same of outer forces */
} body_totals;

typedef struct body {
  const rows *lattice;
  int dimensions, dof;
  double time;       /* s: of the places */
  double reached;    /* s: of the states of the laws */
  double advance;    /* s: from these to the places; `dt` of laws */
  double time_step;  /* s */
  double decay;      /* factor of mass damping on the velocities in the coming step; 1: none */
  double gravity[3]; /* m/s^2 in the coming step */
  /* J s/m: work of gravity over the velocity after the coming step, of a particle of mean mass */
  double gravity_work[3];
  double *weight;          /* [size] 1 at particles, 0 at absent sites; NULL without gravity */
  bool ledger;             /* energies are kept */
  bool forces;             /* somebody looks at the forces of every step */
  bool works;              /* of the energies, the work against the forces of the bonds is kept */
  bool forces_alone;       /* nobody looks at energies or outputs when it is observed next */
  bool timed;              /* blocks keep the times of their parts of a step */
  double mass[PL_MAX_DOF]; /* kg, kg m^2; of the mean particle where they are not alike */
  /* [size] of a particle, over the mean, of its motion along the axes and about them (body_turns);
     NULL where all are alike. And the inverse; 0 at absent sites. */
  double *relative_mass[2], *mobility[2];
  /* velocity that no particle may reach: one spacing, half a turn a step */
  double limit[PL_MAX_DOF];
  double *displacement[PL_MAX_DOF], *velocity[PL_MAX_DOF]; /* [size] m, rad; m/s, rad/s */
  double *force[PL_MAX_DOF]; /* [size] N, N m: sums over bonds, as last observed (families: as last
                                used) */
  double *row_mass, *row_internal; /* [row_count] J up to the middle of the last step */
  double *row_gravity; /* [row_count] J: work of gravity since the start; NULL without */
  /* [size] N: what acts on the particles from outside, beside loads, in the coming step (contact);
     NULL without. The rows in which it is not 0 have a mark, [row_count]. */
  double *outer[3];
  unsigned char *row_outer;
  /* [size] m/s: of particles that are given away the velocity after the coming step, as the state
     was observed; NULL without */
  double *ahead[3];
  double outer_work; /* J: that it has done since the start */
  /* J: of static runs: what rest states have given since the start, less what is observed of it */
  double given_before;
  double rounding;    /* J: of static runs: energies of that size are */
  body_row *observed; /* [row_count] */
  /* [row_count] site from which on a row has not moved, a velocity there was bad; 0: it has */
  long *row_stuck;
  /* [row_count] part of the row that holds sites: offset from its start, doubles */
  long *begin, *count;
  int block_count;
  body_block *blocks;
  pool *memory; /* of the arrays */
  size_t bytes; /* held altogether */
} body;

/* How blocks share out rows: as many each, or as many sites each, to the nearest row. */
typedef enum body_share { BODY_SHARE_ROWS, BODY_SHARE_SITES } body_share;

/* At rest. `threads` at most, each with a block. */
body *body_new(const rows *lattice, int dof, double time_step, int threads, body_share share);
void body_free(body *w);
/* s: from now on; velocities stay as they are. */
void body_take_step(body *w, double time_step);
/* A particle carries a mass beside its own (kg), and what turns with it (kg m^2). */
void body_add_mass(body *w, long site, double mass, double inertia);
/* Others say where the particle goes, and have its mass: from now on it has neither mass nor
   weight, but is kicked by forces as before, by which these are known (body_kicked_by). It still
   turns by itself. */
void body_give_away(body *w, long site);
/* N: the force that has kicked it in a step, with the velocity before. */
double body_kicked_by(const body *w, int component, long site, double before);
/* From now on `gravity` counts. */
void body_add_gravity(body *w);
/* From now on `outer` counts; it is 0. */
void body_add_outer(body *w);
/* It becomes 0 again. */
void body_clear_outer(body *w);

/* `count` zeros, aligned, counted in w->bytes; they go with the body. */
double *body_doubles(body *w, long count);
/* Memory of one block for what is short and often written: zeros, away from all else. */
void *body_apart(body *w, size_t bytes);

/* First site of the part of a row that holds sites. */
static inline long body_start(const body *w, int row) {
  return rows_start(w->lattice, row) + w->begin[row];
}

/* 1 where a component is a rotation, else 0. */
static inline int body_turns(const body *w, int component) {
  return component >= w->dimensions;
}

/* Mass of a particle (kg), or what turns with that component (kg m^2). */
static inline double body_mass(const body *w, int component, long site) {
  const double *relative = w->relative_mass[body_turns(w, component)];
  return relative ? w->mass[component] * relative[site] : w->mass[component];
}

/* Adds to the outer forces on a particle. */
static inline void body_push(body *w, long site, const double force[3]) {
  w->row_outer[rows_row(w->lattice, site)] = 1;
  for (int d = 0; d < w->dimensions; d++)
    w->outer[d][site] += force[d];
}
/* N; 0 without, and of rotations. */
static inline double body_outer(const body *w, int component, long site) {
  return w->row_outer && component < w->dimensions ? w->outer[component][site] : 0;
}
/* Not only bonds act on the particles (motion_push). */
static inline bool body_is_pushed(const body *w) {
  return w->weight || w->row_outer;
}

/* Nothing is bad as yet. */
static inline void body_step_begins(body *w, int block) {
  w->blocks[block].bad_site = -1;
  w->blocks[block].aside = false;
}
/* Block with the lowest bad site after the last stage, or -1. Bad rows were not moved from there
   on. */
int body_bad(const body *w);
/* In the last step: false where a bad velocity keeps the site where it was. */
bool body_has_moved(const body *w, long site);
/* Sums in row order; call after all was observed. */
body_totals body_sum(const body *w);

#endif
