/* The state of a body of particles on rows and the sweep that moves it one step: bonds of a row
   into a row buffer, its forces at once into velocities and displacements. Knows neither loads nor
   files.

   Rows are shared out to threads in contiguous blocks. A row's forces need the bonds of the row
   below, so that the last row of a block (its seam) is evaluated before anything moves: every block
   does sweep_seam; when all have, every block does sweep_rows.

   A particle's force is summed in one order: its own bonds by direction, then those that others own
   by direction. */
#ifndef PERILAT_RUNTIME_SWEEP_H
#define PERILAT_RUNTIME_SWEEP_H

#include "runtime/kernel.h"
#include "runtime/rows.h"

typedef struct sweep_block { /* what one thread works on and with */
  int first, last;           /* rows first .. last-1 */
  double *buffer[2], *seam;  /* bond forces of one row each: [planes][directions][stride] */
  double *next;              /* [dof][pitch] velocities after the kick */
  double *fields;   /* [fields][pitch] copy of a row's fields for evaluations that leave no trace */
  double *observed; /* [1 + outputs][pitch] */
  double **pointers;         /* of fields and observed values, for strips */
  const double **parameters; /* [varying] for strips */
  long bad_site;             /* first site whose velocity left the limits in this step, or -1 */
  int bad_component;
  double bad_velocity;
} sweep_block;

typedef struct sweep_totals { /* sums over all particles and bonds, J */
  double kinetic; /* half m (v before)(v after): what a spring and a mass conserve exactly */
  double stored;
  double dissipated_state, dissipated_rate; /* by the law since the start */
  double dissipated_mass; /* by mass damping since the start, up to the middle of the last step */
  double gravity;         /* work of gravity since the start */
  double dissipated_pending; /* by mass damping from there to the state sampled */
} sweep_totals;

typedef struct sweep {
  const rows *lattice;
  int64_t *flags; /* [size] PL_PRESENT, PL_PROTECTED of the bonds that a site owns */
  const pl_law *law;
  double time_step;    /* s */
  double decay;        /* factor of mass damping on the velocities in the coming step; 1: none */
  double push[2];      /* m/s that gravity adds to the velocities in the coming step */
  double push_work[2]; /* J s/m: work of gravity over the velocity after the coming step */
  double *weight;      /* [size] 1 at particles, 0 at absent sites; NULL without gravity */
  bool ledger;         /* dissipated energies are kept */
  double *uniforms;    /* [directions][uniform_count] */
  int dof;
  double mass[PL_MAX_DOF]; /* kg, kg, kg m^2 */
  double
      limit[PL_MAX_DOF]; /* velocity that no particle may reach: one spacing, half a turn a step */
  double *displacement[PL_MAX_DOF], *velocity[PL_MAX_DOF]; /* [size] m, rad; m/s, rad/s */
  double **field;                                          /* [fields][directions * size] */
  double *const *parameter; /* [varying][directions * size] of random fields; not owned */
  double *dissipated_state,
      *dissipated_rate;      /* [size] J at the site that owns the bond; NULL without ledger */
  double *force[PL_MAX_DOF]; /* [size] N, N m: sums over bonds, written by sweep_observe; NULL when
                                never asked */
  double *row_kinetic, *row_stored, *row_mass, *row_pending; /* [row_count] J */
  double *row_gravity; /* [row_count] J: work of gravity since the start; NULL without */
  long *begin,
      *count; /* [row_count] part of the row that holds sites: offset from its start, doubles */
  int block_count;
  sweep_block *blocks;
  long stride;  /* doubles of a direction in a buffer */
  size_t bytes; /* held altogether */
} sweep;

/* The fields start at their initial values, all at rest. With `ledger` or `forces` the force arrays
 * exist. */
sweep *sweep_new(const rows *lattice, const pl_law *law, const double *parameters, double time_step,
                 int threads, bool ledger, bool forces);
void sweep_free(sweep *w);
/* From now on `push` counts. */
void sweep_add_gravity(sweep *w);

/* Subnormal numbers are slow and mean nothing here: they count as zero in this thread until
 * sweep_leave. */
unsigned sweep_enter(void);
void sweep_leave(unsigned before);

void sweep_seam(sweep *w, int block);
void sweep_rows(sweep *w, int block);
/* Block with the lowest bad site after sweep_rows, or -1. */
int sweep_bad(const sweep *w);

/* Forces on the particles in the present state, and the block's share of the energies; changes no
   state. The velocity after the coming kick is needed for the kinetic energy: that of free
   particles without applied forces is taken. */
void sweep_observe(sweep *w, int block);
/* Sums in row order; call after all blocks were observed. */
sweep_totals sweep_sum(const sweep *w);
/* An output of the law in the present state: values[directions * size], defined where bonds are. */
void sweep_output(sweep *w, int output, double *values);

#endif
