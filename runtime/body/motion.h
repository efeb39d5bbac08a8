/* How the particles of a row move once the forces on them are known: gravity, outer forces, limits,
   the drift to the next place, and what their motion says of the energies. */
#ifndef PERILAT_RUNTIME_MOTION_H
#define PERILAT_RUNTIME_MOTION_H

#include "runtime/body/body.h"

/* Mass damping resists with the mean of the velocities before and after the step,
     m (v+ - v-) = dt f - tanh(c dt/2) m (v+ + v-),
   which is v+ = decay v- + part dt f/m with decay = exp(-c dt): exact without forces, of the second
   order with them, stable with any c wherever the step is without damping. */
static inline double motion_force_part(const body *w) {
  return 0.5 * (1 + w->decay);
}
static inline double motion_drag(const body *w) { /* tanh(c dt/2) */
  return (1 - w->decay) / (1 + w->decay);
}

/* Places first .. end-1 of the part of a row that holds sites, whole vectors. */
typedef struct row_part {
  int row;
  long first, end;
} row_part;

static inline row_part whole_row(const body *w, int row) {
  return (row_part){row, 0, w->count[row]};
}

/* What gravity and outer forces add to the velocities after the kick, next[count of the row]; not 0
   when one is not below its limit. */
int64_t motion_push(const body *w, const row_part *at, int component, double *next);
/* Notes the first bad velocity among the block's `next` from place `first` of a row on: from there
   on the row stays. */
void motion_note_bad(const body *w, body_block *b, int row, long first);
/* The velocities become the block's `next`, the displacements follow, the ledger of mass damping
   and gravity goes on. Rotations in space are rotation vectors, velocities rates of turning about
   x, y and z: a step turns the particle further, exp(dt w) after what it has turned. */
void motion_drift(body *w, body_block *b, const row_part *at);
/* A particle that has moved turns out to have another velocity after the step, by `change` (m/s,
   rad/s): its place follows. */
void motion_change(body *w, int component, long site, double change);
/* In space, what a particle that has moved had turned before the step. */
void motion_turned_before(const body *w, long site, double r[3]);
/* What a row's motion says of the energies, with the block's `next` and the forces at hand. */
void motion_observe(body *w, const body_block *b, int row);

#endif
