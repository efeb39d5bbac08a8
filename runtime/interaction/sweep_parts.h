/* Inside of a sweep, for its engines (pairwise.c, family.c): memory, and what happens to the
   particles of a row once the forces on them are known. */
#ifndef PERILAT_RUNTIME_SWEEP_PARTS_H
#define PERILAT_RUNTIME_SWEEP_PARTS_H

#include "runtime/interaction/sweep.h"

#if defined(__clang__)
#define INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define INDEPENDENT _Pragma("GCC ivdep")
#endif

/* `count` zeros, aligned, counted in w->bytes; they go with the sweep. */
double *sweep_doubles(sweep *w, long count);

/* First site of the part of a row that holds sites. */
static inline long sweep_start(const sweep *w, int row) {
  return rows_start(w->lattice, row) + w->begin[row];
}

/* Memory of one block for what is short and often written: zeros, away from all else. */
void *sweep_apart(sweep *w, size_t bytes);

/* Places first .. end-1 of the part of a row that holds sites, whole vectors. */
typedef struct row_part {
  int row;
  long first, end;
} row_part;

static inline row_part whole_row(const sweep *w, int row) {
  return (row_part){row, 0, w->count[row]};
}

/* What gravity adds to the velocities after the kick, next[count of the row]; not 0 when one is not
   below its limit. */
int64_t sweep_push(const sweep *w, row_part at, int component, double *next);
/* Notes the first bad velocity among the block's `next` from place `first` of a row on: from there on the row stays. */
void sweep_note_bad(const sweep *w, sweep_block *b, int row, long first);
/* The velocities become the block's `next`, the displacements follow, the ledger of mass damping and gravity goes on. */
void sweep_drift(sweep *w, sweep_block *b, row_part at);

/* Sums in an order of their own, whatever the vector width; count is a multiple of PL_LANES. */
double sweep_dot(long count, const double *a, const double *b);
double sweep_total(long count, const double *a);
/* What a row's motion says of the energies, with the block's `next` and the forces at hand. */
void sweep_observe_motion(sweep *w, const sweep_block *b, int row);

#endif
