#include "runtime/interaction/joint.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/base/clock.h"
#include "runtime/body/advance.h"
#include "runtime/body/motion.h"
#include "runtime/interaction/family.h"

typedef struct joint {
  sweep **parts;
  int count;
  double *scratch; /* [size] */
} joint;

static joint *own(const sweep *w) {
  return w->engine.own;
}

/* --- forces ----------------------------------------------------------------------------------- */

static void find_parts(sweep *w, int stage, int block) {
  for (int k = 0; k < own(w)->count; k++) {
    sweep *part = own(w)->parts[k];
    if (stage < part->engine.force_stages) part->engine.forces(part, stage, block);
  }
}

static void add_row(const sweep *w, int row) {
  const long start = body_start(w->body, row), count = w->body->count[row];
  for (int d = 0; d < w->body->dof; d++) {
    double *restrict sum = w->body->force[d] + start;
    memcpy(sum, own(w)->parts[0]->force[d] + start, (size_t)count * sizeof *sum);
    for (int k = 1; k < own(w)->count; k++) {
      const double *restrict force = own(w)->parts[k]->force[d] + start;
      for (long q = 0; q < count; q++)
        sum[q] += force[q];
    }
  }
}

/* Of a row whose forces have been added. */
static void forces_of_row(const body *of, int row, const double *force[PL_MAX_DOF]) {
  for (int d = 0; d < of->dof; d++)
    force[d] = of->force[d] + body_start(of, row);
}

static void find_forces(sweep *w, int stage, int block) {
  body_block *b = &w->body->blocks[block];
  b->aside = true;
  if (stage < w->engine.force_stages - 1)
    find_parts(w, stage, block);
  else
    for (int row = b->first; row < b->last; row++)
      add_row(w, row);
}

static void move_rows(sweep *w, int block) {
  body *of = w->body;
  body_block *b = &of->blocks[block];
  const double begun = of->timed ? monotonic_seconds() : 0, *force[PL_MAX_DOF] = {NULL};
  for (int row = b->first; row < b->last; row++) {
    add_row(w, row);
    forces_of_row(of, row, force);
    advance_row(of, b, row, force);
  }
  if (of->timed) b->moving += monotonic_seconds() - begun;
}

static void step(sweep *w, int stage, int block) {
  if (stage == 0) body_step_begins(w->body, block);
  if (stage < w->engine.step_stages - 1)
    find_parts(w, stage, block);
  else
    move_rows(w, block);
}

static void turn(sweep *w) {
  for (int k = 0; k < own(w)->count; k++)
    sweep_turn(own(w)->parts[k]);
}

static void fields_set(sweep *w) {
  for (int k = 0; k < own(w)->count; k++)
    sweep_fields_set(own(w)->parts[k]);
}

/* --- sampling --------------------------------------------------------------------------------- */

static void observe_rows(sweep *w, int block) {
  body_block *b = &w->body->blocks[block];
  const double *force[PL_MAX_DOF] = {NULL};
  for (int row = b->first; row < b->last; row++) {
    add_row(w, row);
    forces_of_row(w->body, row, force);
    advance_kick(w->body, b, row, force);
    motion_observe(w->body, b, row);
    if (w->body->forces_alone) continue;
    w->body->observed[row].stored = 0;
    for (int k = 0; k < own(w)->count; k++)
      w->body->observed[row].stored += family_stored_in_row(own(w)->parts[k], row);
    for (int k = 0; k < own(w)->count; k++)
      family_add_losses(own(w)->parts[k], row);
  }
}

static void observe(sweep *w, int stage, int block) {
  w->body->blocks[block].aside = true;
  if (stage == w->engine.observe_stages - 1) {
    observe_rows(w, block);
    return;
  }
  for (int k = 0; k < own(w)->count; k++) {
    sweep *part = own(w)->parts[k];
    if (stage < part->engine.observe_stages) part->engine.observe(part, stage, block);
  }
}

static void stored_values(sweep *w, double *values) {
  const long size = w->lattice->size;
  double *more = own(w)->scratch;
  sweep_stored(own(w)->parts[0], values);
  for (int k = 1; k < own(w)->count; k++) {
    sweep_stored(own(w)->parts[k], more);
    for (long q = 0; q < size; q++)
      values[q] += more[q];
  }
}

/* --- set-up ----------------------------------------------------------------------------------- */

static void free_own(sweep *w) {
  for (int k = 0; k < own(w)->count; k++)
    sweep_free(own(w)->parts[k]);
  free(own(w)->parts);
  free(own(w));
}

static int most(int a, int b) {
  return a > b ? a : b;
}

sweep *joint_new(body *of, sweep *const *parts, int count) {
  sweep *w = must_calloc(1, sizeof *w);
  joint *j = must_calloc(1, sizeof *j);
  *j = (joint){.parts = must_calloc((size_t)count, sizeof(sweep *)),
               .count = count,
               .scratch = body_doubles(of, of->lattice->size)};
  memcpy(j->parts, parts, (size_t)count * sizeof *parts);
  int forces = 0, looks = 0;
  for (int k = 0; k < count; k++) {
    forces = most(forces, parts[k]->engine.force_stages);
    looks = most(looks, parts[k]->engine.observe_stages);
  }
  *w = (sweep){.body = of, .lattice = of->lattice, .law = parts[0]->law};
  memcpy(w->force, of->force, sizeof w->force);
  w->engine = (sweep_engine){.step_stages = forces + 1,
                             .force_stages = forces + 1,
                             .observe_stages = looks + 1,
                             .step = step,
                             .forces = find_forces,
                             .turn = turn,
                             .fields_set = fields_set,
                             .observe = observe,
                             .stored = stored_values,
                             .free = free_own,
                             .own = j};
  return w;
}

sweep *const *joint_parts(const sweep *w, int *count) {
  if (w->engine.step != step) return NULL;
  *count = own(w)->count;
  return own(w)->parts;
}
