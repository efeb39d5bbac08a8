#include "runtime/interaction/family_parts.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/clock.h"
#include "runtime/lattice/shape_matrix.h"

/* --- runs of particles -------------------------------------------------------------------------- */

static void point_at_fields(const sweep *w, family_block *b, long start) {
  const family *f = family_of(w);
  for (int k = 0; k < w->law->field_count; k++) {
    b->old_field[k] = (b->observing ? w->new_field : w->field)[k] + start;
    b->new_field[k] = w->new_field[k] + start;
  }
  for (int k = 0; k <= w->law->output_count; k++)
    b->observed[k] = f->observed[k] + start;
  for (int k = 0; k < SHAPE_PLANES && f->shape[k]; k++)
    b->shape[k] = f->shape[k] + start;
  for (int d = 0; d < w->dof; d++)
    b->force[d] = w->force[d] + start;
}

/* Where the neighbours of the run's particles are. */
static void point_at_neighbours(const rows *g, int row, long start, pl_family *run) {
  const neighbour_list *l = g->list;
  if (!l) {
    run->offset = g->offset[g->row_class[row + g->margin]];
    return;
  }
  run->neighbour = l->neighbour + start;
  run->incoming = l->incoming + start;
  run->length = l->length + start;
  for (int d = 0; d < g->dimensions; d++)
    run->chord[d] = l->chord[d] + start;
  run->volume = g->site_volume + start;
  run->mass = g->site_mass + start;
}

void family_begin_runs(const sweep *w, const pl_program *program, int block, pl_family *run) {
  const family *f = family_of(w);
  family_block *b = &f->blocks[block];
  b->observing = program == &w->law->observe;
  *run = (pl_family){.row_stride = FAMILY_ROWS_ALIKE * w->lattice->pitch,
                     .neighbours = f->neighbours,
                     .plane = w->lattice->size,
                     .shape = b->shape,
                     .old_field = b->old_field,
                     .new_field = b->new_field,
                     .link = b->link,
                     .bond_link = b->bond_link,
                     .force = b->force,
                     .observed = b->observed,
                     .time_step = w->time_step};
}

void family_turn_to_row(const sweep *w, int block, int row, pl_family *run) {
  const long start = sweep_start(w, row);
  point_at_fields(w, &family_of(w)->blocks[block], start);
  run->count = w->count[row];
  run->rows = 1;
  run->new_plane = w->lattice->size;
  run->bonds = w->lattice->bonds + start;
  run->held = w->lattice->held + start;
  point_at_neighbours(w->lattice, row, start, run);
  for (int d = 0; d < w->dof; d++) {
    run->displacement[d] = w->displacement[d] + start;
    run->velocity[d] = w->velocity[d] + start;
  }
}

double family_pass_begins(const sweep *w) {
  return w->timed ? monotonic_seconds() : 0;
}

void family_pass_ends(const sweep *w, int block, int pass, double begun) {
  const int slot = least(pass, SWEEP_TIMED_PASSES - 1);
  if (w->timed) w->blocks[block].passes[slot] += monotonic_seconds() - begun;
}

/* --- particles -------------------------------------------------------------------------------- */

static const double *force_of_row(const sweep *w, const sweep_block *b, int row, int component,
                                  bool moving) {
  if (moving && family_of(w)->windows)
    return family_window_force(w, (int)(b - w->blocks), row, component);
  return w->force[component] + sweep_start(w, row);
}

/* `moving`: the forces are those of a step, and not of looking at the present state. All components in one loop, with a
   literal number of them and what is the same for most bodies left out:

     next = decay v + part dt/m f (sweep.h)

   Not 0 when a velocity is not below the limit (NaN is not below anything). */
static inline __attribute__((always_inline)) int64_t
kick(const sweep *w, const sweep_block *b, int row, bool moving, int dof, bool each_mass) {
  const long start = sweep_start(w, row), count = w->count[row], pitch = w->lattice->pitch;
  const double decay = w->decay, *mobility = each_mass ? w->mobility + start : NULL;
  const double *force[3], *v[3];
  double factor[3], *restrict next = b->next;
  int64_t bad = 0;
  for (int d = 0; d < dof; d++) {
    force[d] = force_of_row(w, b, row, d, moving);
    v[d] = w->velocity[d] + start;
    factor[d] = sweep_force_part(w) * w->time_step / w->mass[d];
  }
  INDEPENDENT
  for (long q = 0; q < count; q++)
    for (int d = 0; d < dof; d++) {
      const double push =
          each_mass ? factor[d] * mobility[q] * force[d][q] : factor[d] * force[d][q];
      const double after = decay * v[d][q] + push;
      next[d * pitch + q] = after;
      bad |= __builtin_fabs(after) < w->limit[d] ? INT64_C(0) : INT64_C(1);
    }
  return bad;
}

static int64_t kick_row(const sweep *w, sweep_block *b, int row, bool moving) {
  const bool each = w->mobility != NULL;
  int64_t bad = w->dof == 2
                    ? (each ? kick(w, b, row, moving, 2, true) : kick(w, b, row, moving, 2, false))
                    : (each ? kick(w, b, row, moving, 3, true) : kick(w, b, row, moving, 3, false));
  for (int d = 0; d < w->dof; d++)
    bad |= sweep_push(w, whole_row(w, row), d, b->next + d * w->lattice->pitch);
  return bad;
}

/* Work against the bonds: the force of a state counts over half of the way to it and half of the
   way from it (ledger.h). */
static double work_over(const sweep *w, int row, int component, const double *v) {
  return -0.5 * w->time_step *
         sweep_dot(w->count[row], w->force[component] + sweep_start(w, row), v);
}

/* A row with a bad velocity stays where it is. */
static void move_rows(sweep *w, int block, int first, int last) {
  sweep_block *b = &w->blocks[block];
  const double begun = w->timed ? monotonic_seconds() : 0;
  for (int row = first; row < last; row++) {
    if (kick_row(w, b, row, true)) {
      sweep_note_bad(w, b, row, 0);
      continue;
    }
    for (int d = 0; d < w->dof && w->ledger; d++)
      w->row_internal[row] += work_over(w, row, d, w->velocity[d] + sweep_start(w, row)) +
                              work_over(w, row, d, b->next + d * w->lattice->pitch);
    sweep_drift(w, b, whole_row(w, row));
  }
  if (w->timed) b->moving += monotonic_seconds() - begun;
}

static int program_stages(const family *f, const pl_program *program) {
  return f->windows ? 1 : program->pass_count;
}

static void run_program(sweep *w, const pl_program *program, int stage, int block) {
  const bool pairs = family_of(w)->pairs && program == &w->law->step;
  if (family_of(w)->windows)
    family_window_run(w, program, block, NULL);
  else if (pairs)
    family_pairs_stage(w, stage, block);
  else
    family_stage(w, program, stage, block);
}

static void step_in_windows(sweep *w, int stage, int block) {
  const sweep_block *b = &w->blocks[block];
  int first, last;
  if (stage == 0) {
    family_window_run(w, &w->law->step, block, move_rows);
    return;
  }
  family_window_inner(w, block, &first, &last);
  move_rows(w, block, b->first, first);
  move_rows(w, block, last, b->last);
}

static void step(sweep *w, int stage, int block) {
  const sweep_block *b = &w->blocks[block];
  if (stage == 0) w->blocks[block].bad_site = -1;
  if (family_of(w)->windows)
    step_in_windows(w, stage, block);
  else if (stage < w->law->step.pass_count)
    run_program(w, &w->law->step, stage, block);
  else
    move_rows(w, block, b->first, b->last);
}

static void find_forces(sweep *w, int stage, int block) {
  run_program(w, &w->law->step, stage, block);
}

/* What was new is now at hand. */
static void turn(sweep *w) {
  double **old = w->field;
  w->field = w->new_field;
  w->new_field = old;
  if (family_of(w)->pairs) family_pairs_turn(family_of(w)->pairs);
}

static void fields_set(sweep *w) {
  if (family_of(w)->pairs) family_pairs_fields_set(w);
}

/* --- sampling --------------------------------------------------------------------------------- */

/* Values at absent sites mean nothing, and without bonds a particle stores nothing: a law may divide by what a family
   has. */
static double stored_in_row(const sweep *w, int row) {
  const long start = sweep_start(w, row);
  double sum = 0;
  for (long q = start; q < start + w->count[row]; q++)
    if (w->lattice->present[q] && (w->lattice->bonds[q] || rows_degree(w->lattice, q) > 0))
      sum += family_of(w)->observed[0][q];
  return sum;
}

static void observe_rows(sweep *w, int block) {
  sweep_block *b = &w->blocks[block];
  for (int row = b->first; row < b->last; row++) {
    kick_row(w, b, row, false);
    sweep_observe_motion(w, b, row);
    w->observed[row].stored = stored_in_row(w, row);
  }
}

/* Forces and new fields of the present state: the passes of a step, whose new fields are written again by the next one. Then
   energy and outputs with these. */
static void observe(sweep *w, int stage, int block) {
  const family *f = family_of(w);
  const int forces = program_stages(f, &w->law->step),
            all = forces + program_stages(f, &w->law->observe);
  if (stage < forces)
    run_program(w, &w->law->step, stage, block);
  else if (stage < all)
    run_program(w, &w->law->observe, stage - forces, block);
  else
    observe_rows(w, block);
}

static void output_values(sweep *w, int output, double *values) {
  const size_t count = (size_t)sweep_planes(w, w->law->outputs[output].place);
  memcpy(values, family_of(w)->observed[1 + output],
         count * (size_t)w->lattice->size * sizeof *values);
}

/* --- set-up ----------------------------------------------------------------------------------- */

double *family_uniforms(const pl_law *law, const rows *g, const double *parameters) {
  const int count = g->list ? 1 : 2 * g->directions;
  double *uniforms = must_calloc((size_t)count * (size_t)law->uniform_count + 1, sizeof *uniforms);
  for (int k = 0; k < count; k++) {
    const pl_bond_class c = rows_bond_class(g, k);
    law->prepare(law, parameters, &c, uniforms + (long)k * law->uniform_count);
  }
  return uniforms;
}

static void find_shapes(sweep *w, family *f) {
  for (int v = 0; v < PL_SHAPE_PLANES(w->dimensions); v++)
    f->shape[v] = sweep_doubles(w, w->lattice->size);
  shape_matrices(w->lattice, f->shape);
}

static void new_planes(sweep *w, family *f) {
  const pl_law *law = w->law;
  const long size = w->lattice->size;
  f->observed = must_calloc((size_t)law->output_count + 1, sizeof *f->observed);
  f->observed[0] = sweep_doubles(w, size);
  for (int k = 0; k < law->output_count; k++)
    f->observed[1 + k] = sweep_doubles(w, sweep_planes(w, law->outputs[k].place) * size);
}

static void new_links(sweep *w, family *f) {
  const pl_law *law = w->law;
  const long size = w->lattice->size;
  f->link = must_calloc((size_t)law->link_count + 1, sizeof *f->link);
  for (int k = 0; k < law->link_count; k++)
    f->link[k] = sweep_doubles(w, size);
  f->bond_link = must_calloc((size_t)law->bond_link_count + 1, sizeof *f->bond_link);
  for (int k = 0; k < law->bond_link_count; k++)
    f->bond_link[k] = sweep_doubles(w, sweep_planes(w, PL_ON_NEIGHBOUR) * size);
}

static void new_blocks(sweep *w, family *f) {
  const pl_law *law = w->law;
  const size_t one = sizeof(double *), fields = (size_t)law->field_count * one;
  f->blocks = must_calloc((size_t)w->block_count, sizeof *f->blocks);
  for (int k = 0; k < w->block_count; k++) {
    family_block *b = &f->blocks[k];
    b->old_field = sweep_apart(w, fields);
    b->new_field = sweep_apart(w, fields);
    b->link = sweep_apart(w, (size_t)law->link_count * one);
    b->bond_link = sweep_apart(w, (size_t)law->bond_link_count * one);
    b->observed = sweep_apart(w, (size_t)(1 + law->output_count) * one);
  }
}

static void free_own(sweep *w) {
  family *f = family_of(w);
  free(f->link);
  free(f->bond_link);
  family_windows_free(w, f->windows);
  family_pairs_free(w, f->pairs);
  free(f->observed);
  free(f->blocks);
  free(f->uniforms);
  free(f);
}

/* On lists neighbours may be anywhere. */
static int reach_of(const rows *g) {
  double most = 0;
  for (int k = 0; k < g->directions; k++)
    most = pl_fmax(most, rint((double)g->offset[0][k] / (double)g->pitch));
  return g->list ? g->row_count : (int)most;
}

sweep_engine family_engine(sweep *w, const double *parameters) {
  const pl_law *law = w->law;
  family *f = must_calloc(1, sizeof *f);
  assert(law->dof == law->dimensions);
  assert(law->neighbours == 0 || law->neighbours == 2 * w->lattice->directions);
  f->neighbours = 2 * w->lattice->directions;
  f->reach = reach_of(w->lattice);
  assert(law->step.pass_count <= FAMILY_MOST_PASSES);
  f->uniforms = family_uniforms(law, w->lattice, parameters);
  new_planes(w, f);
  new_blocks(w, f);
  if (law->reads_shape) find_shapes(w, f);
  f->pairs = family_pairs_new(w, f);
  f->windows = f->pairs ? NULL : family_windows(w, f);
  if (!f->windows) new_links(w, f);
  const int forces = program_stages(f, &law->step), looks = program_stages(f, &law->observe);
  return (sweep_engine){.step_stages = forces + 1,
                        .force_stages = forces,
                        .observe_stages = forces + looks + 1,
                        .step = step,
                        .forces = find_forces,
                        .turn = turn,
                        .fields_set = fields_set,
                        .observe = observe,
                        .output = output_values,
                        .free = free_own,
                        .keeps_links = f->windows == NULL,
                        .own = f};
}
