/* The cells of a mesh at work: an engine (sweep.h) that finds the forces of nodes and moves them. A
   linear law has its stiffness assembled once (node_stencil.h), f = K u.

   Steps are those of the time loop, central differences. Newmark's method with beta_2 = 0 and
   beta_1 > 1/2 is the same with the forces

       f_n + (beta_1 - 1/2)(f_n - f_(n-1)),

   which damps fast waves by (beta_1 - 1/2) omega dt/2 of the critical damping; what that takes is
   in the ledger. Stable up to dt = sqrt(2/beta_1)/omega_max (Hughes 1987, 9.1). */
#ifndef PERILAT_RUNTIME_CELLS_H
#define PERILAT_RUNTIME_CELLS_H

#include "dsl/base/diagnostics.h"
#include "runtime/analysis/step_limit.h"
#include "runtime/continuum/node_stencil.h"
#include "runtime/continuum/tips.h"
#include "runtime/deck/deck.h"
#include "runtime/interaction/sweep.h"

typedef struct cells {
  const pl_law *law;
  const rows *nodes; /* the mesh's, not owned */
  double beta_1;
  mesh mesh;
  integration_points points;
  plane_stiffness stiffness;
  node_stencil stencil;
  bool has_stencil;
  tips *tips; /* of its cracks; NULL without */
} cells;

/* Of the deck's lattice of that number, a &mesh; its nodes learn what volume each stands for.
   NULL with diagnostics. */
cells *cells_new(const deck *k, int lattice, rows *nodes, diagnostics *d);
void cells_free(cells *c);

/* The law with its parameters. */
void cells_take_law(cells *c, const pl_law *law, const double *parameters);
/* The longest stable step; held[2 n + d]: freedoms that do not move by themselves. */
void cells_step_limit(const cells *c, const unsigned char *held, step_limit *limit);
/* At rest; to be freed by sweep_free, before the cells. cracks[k->crack_count]: the laws of the deck's
   cracks. */
sweep *cells_sweep(cells *c, const deck *k, const double *parameters, const tip_law *cracks,
                   double time_step, int threads, body_ledger ledger);

/* Stress intensities at the tips, where the body stands still. */
void cells_look(const sweep *w);

/* What the engine remembers from step to step, for checkpoints; and after one was read. */
enum { CELLS_PLANES = 6 };
typedef struct cells_memory {
  int count;
  void *planes[CELLS_PLANES];
  size_t bytes[CELLS_PLANES];
} cells_memory;
cells_memory cells_remembered(const sweep *w);
void cells_restored(sweep *w);

#endif
