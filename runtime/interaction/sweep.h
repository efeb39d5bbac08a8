/* The state of a body of particles on rows, and the sweep that moves it by one step. Knows neither
   loads nor files.

   A step is a few stages: every block of rows does a stage, and when all blocks have, the next one
   begins. What the stages do is an engine's affair: pairwise.h for laws of bonds, family.h for laws
   that read a particle's whole family. Both kick and move the particles of a row in the same way.

   Rows are shared out to threads in contiguous blocks. A particle's bonds are summed in one order,
   whatever the blocks, so that results are the same to the last bit. */
#ifndef PERILAT_RUNTIME_SWEEP_H
#define PERILAT_RUNTIME_SWEEP_H

#include "runtime/base/pool.h"
#include "runtime/kernel.h"
#include "runtime/lattice/rows.h"

enum { SWEEP_TIMED_PASSES = 8 }; /* of those after it the last one has the time, too */
enum {
  SWEEP_APART = 128
}; /* B: nearer to what another thread writes, reading waits for that thread: pairs of lines go together */

typedef struct sweep_block { /* what one thread works on */
  int first, last;           /* rows first .. last-1 */
  double *next;              /* [dof][pitch] velocities after the kick */
  long bad_site;             /* first site whose velocity left the limits in this step, or -1 */
  int bad_component;
  double bad_velocity;
  /* s spent by whichever thread, on steps, of these on moving particles and on the passes of a law of families, and on
     samples; only kept when `timed`. Putting loaded particles right is no part of a step. */
  double stepping, moving, passes[SWEEP_TIMED_PASSES], loading, observing;
  char apart[SWEEP_APART];
} sweep_block;

typedef struct sweep_totals { /* sums over all particles and bonds, J, up to the state observed */
  double kinetic; /* half m (v before)(v after): what a spring and a mass conserve exactly */
  double stored;
  double free; /* kinetic, had only bonds acted */
  double dissipated_state, dissipated_rate; /* pairwise laws: by the law since the start */
  double internal;   /* laws of families: work done against the forces of the bonds */
  double dissipated; /* by mass damping since the start */
  double gravity;    /* work of gravity since the start */
} sweep_totals;

typedef struct sweep_row { /* of a row in the state observed, J */
  double kinetic, stored, free;
  double state, rate;    /* dissipated by the law of bonds since the start */
  double mass, internal; /* mass damping, work against the bonds: from the middle of the last step on */
} sweep_row;

typedef struct sweep sweep;

typedef struct sweep_engine {
  int step_stages, force_stages, observe_stages;
  void (*step)(sweep *w, int stage, int block);
  void (*forces)(sweep *w, int stage, int block); /* of the present state */
  void (*fields_set)(
      sweep *w);          /* after values of fields were set from outside; NULL: nothing to do */
  void (*turn)(sweep *w); /* after the last stage of a good step, alone; NULL: nothing to do */
  void (*observe)(sweep *w, int stage, int block);
  void (*output)(sweep *w, int output, double *values);
  void (*free)(sweep *w);
  bool
      keeps_links; /* laws of families: what passes leave for each other is kept of the whole body */
  void *own;
} sweep_engine;

struct sweep {
  const rows *lattice;
  const pl_law *law;
  double time_step; /* s */
  double decay;     /* factor of mass damping on the velocities in the coming step; 1: none */
  double gravity[3]; /* m/s^2 in the coming step */
  /* J s/m: work of gravity over the velocity after the coming step, of a particle of mean mass */
  double gravity_work[3];
  double *weight; /* [size] 1 at particles, 0 at absent sites; NULL without gravity */
  bool ledger;    /* dissipated energies are kept */
  bool forces;    /* somebody looks at the forces of every step */
  bool timed;     /* blocks keep the times of their parts of a step */
  int dimensions, dof;
  double mass[PL_MAX_DOF]; /* kg, kg, kg m^2; of the mean particle where they are not alike */
  double *relative_mass;   /* [size] of a particle, over the mean; NULL where all are alike */
  double *mobility;        /* [size] 1/relative_mass; 0 at absent sites */
  double
      limit[PL_MAX_DOF]; /* velocity that no particle may reach: one spacing, half a turn a step */
  double *displacement[PL_MAX_DOF], *velocity[PL_MAX_DOF]; /* [size] m, rad; m/s, rad/s */
  /* [fields][sweep_planes * size] of the state that the last step left behind, and of that observed last; which memory is
     whose may change in a step. */
  double **field, **new_field;
  double *const *parameter; /* [varying][directions * size] of random fields; not owned */
  /* [size] J at the site that owns the bond, of all steps and of what the law takes in the state observed; NULL without
     ledger and for laws of families. */
  double *dissipated_state, *dissipated_rate, *lost_state, *lost_rate;
  double *force[PL_MAX_DOF]; /* [size] N, N m: sums over bonds, as last observed (families: as last
                                used) */
  double *row_mass, *row_internal; /* [row_count] J up to the middle of the last step */
  sweep_row *observed;             /* [row_count] */
  long *
      row_stuck; /* [row_count] site from which on a row has not moved, a velocity there was bad; 0: it has */
  double *row_gravity; /* [row_count] J: work of gravity since the start; NULL without */
  long *begin,
      *count; /* [row_count] part of the row that holds sites: offset from its start, doubles */
  int block_count;
  sweep_block *blocks;
  pool *memory; /* of the arrays */
  size_t bytes; /* held altogether */
  sweep_engine engine;
};

/* The fields start at their initial values, all at rest. */
sweep *sweep_new(const rows *lattice, const pl_law *law, const double *parameters, double time_step,
                 int threads, bool ledger, bool forces);
void sweep_free(sweep *w);
/* Mass of a particle (kg), or what turns with that component (kg m^2). */
static inline double sweep_mass(const sweep *w, int component, long site) {
  return w->relative_mass ? w->mass[component] * w->relative_mass[site] : w->mass[component];
}

/* From now on `gravity` counts. */
void sweep_add_gravity(sweep *w);

/* Mass damping resists with the mean of the velocities before and after the step,
     m (v+ - v-) = dt f - tanh(c dt/2) m (v+ + v-),
   which is v+ = decay v- + part dt f/m with decay = exp(-c dt): exact without forces, of the second order with
   them, stable with any c wherever the step is without damping. */
static inline double sweep_force_part(const sweep *w) {
  return 0.5 * (1 + w->decay);
}
static inline double sweep_drag(const sweep *w) { /* tanh(c dt/2) */
  return (1 - w->decay) / (1 + w->decay);
}

/* Site arrays that make up a field or an output in that place (pl_place): one for each direction of
   a pairwise law's bonds; of a law of families one on particles, else one for each neighbour. */
int sweep_planes(const sweep *w, int where);

/* Subnormal numbers are slow and mean nothing here: they count as zero in this thread until
 * sweep_leave. */
unsigned sweep_enter(void);
void sweep_leave(unsigned before);

/* To be called when values of `field` have been set otherwise than by a step. */
void sweep_fields_set(sweep *w);

/* Block with the lowest bad site after the last stage, or -1. Bad rows were not moved from there on. */
int sweep_bad(const sweep *w);
/* In the last step: false where a bad velocity keeps the site where it was. */
bool sweep_has_moved(const sweep *w, long site);
/* Ends a step in which nothing was bad, alone. */
void sweep_turn(sweep *w);
/* All stages and blocks of a step, one after the other: for tools and tests. False when it went
 * bad. */
bool sweep_step(sweep *w);

/* Forces of the present state, a thread for each block; nothing moves, and the fields stay. */
void sweep_find_forces(sweep *w);

/* Observing is done in stages too: the law at the present places, aside: forces on the particles, new fields, stored energy and
   outputs with these; it changes no state. A step brings places to t_n and fields to t_(n-1): observed, all is of t_n. The
   velocity after the coming kick is needed for the kinetic energy: that of free particles without applied forces is taken. This
   does all stages, a thread for each block. */
void sweep_observe(sweep *w);
/* Sums in row order; call after all was observed. */
sweep_totals sweep_sum(const sweep *w);
/* Value in a bond of a field, an output, or a parameter that stands on bonds or neighbours; of a law
   of families the mean of both sides. */
double sweep_bond_value(const sweep *w, const double *values, const rows_bond *bond);
/* An output in the state observed last: values[sweep_planes * size], defined where bonds or particles are. */
void sweep_output(sweep *w, int output, double *values);

#endif
