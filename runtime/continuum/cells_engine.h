/* The cells of a mesh at work: an engine (sweep.h) that finds the forces of nodes and moves them.
   Linear laws have their stiffness assembled once (node_stencil.h), f = K u; of any other one, and
   of laws with states, each point is asked in each step (point_forces.h). What these push is added
   to the forces of the linear ones in the order of the laws.

   Steps are those of the time loop, central differences. Newmark's method with beta_2 = 0 and
   beta_1 > 1/2 is the same with the forces

       f_n + (beta_1 - 1/2)(f_n - f_(n-1)),

   which damps fast waves by (beta_1 - 1/2) omega dt/2 of the critical damping; what that takes is
   in the ledger. Stable up to dt = sqrt(2/beta_1)/omega_max (Hughes 1987, 9.1). */
#ifndef PERILAT_RUNTIME_CELLS_ENGINE_H
#define PERILAT_RUNTIME_CELLS_ENGINE_H

#include "runtime/continuum/cells.h"
#include "runtime/interaction/sweep.h"

/* At rest; to be freed by sweep_free, before the cells. cracks[k->crack_count]: the laws of the
   deck's cracks. states[where.count]: of each law its fields, outputs and what it stores; the first
   is what is returned, and moves the body. */
sweep *cells_sweep(cells *c, const deck *k, const tip_law *cracks, double time_step, int threads,
                   body_ledger ledger, sweep **states);
/* Parameters that the law reads point by point, from now on: planes[varying][size of the body] SI
   at the nodes. */
void cells_give(const sweep *law, double *const *planes);
/* Where a node had a velocity that is no number or too large: of the points that push it the one
   with the largest stress, with the nodes where they were before the step. Number of its law; -1
   where all around are linear. `out` has memory for any law's fields. */
int cells_worst_point(const sweep *w, long site, point_state *out);
/* J stored in the cells of a law in the state observed last, where it has others beside it. */
double cells_stored_by(const sweep *law);
/* Stress intensities at the tips, where the body stands still. */
void cells_look_at_tips(const sweep *w);

/* What the engine remembers from step to step, for checkpoints, to be freed; and after one was
   read. */
typedef struct cells_memory {
  int count;
  void **planes;
  size_t *bytes;
} cells_memory;
cells_memory cells_remembered(const sweep *w);
void cells_memory_free(cells_memory *m);
void cells_restored(sweep *w);

#endif
