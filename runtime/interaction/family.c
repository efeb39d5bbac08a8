#include "runtime/interaction/family.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/clock.h"
#include "runtime/base/lane_sum.h"
#include "runtime/body/motion.h"
#include "runtime/interaction/family_pairs.h"
#include "runtime/interaction/family_run.h"
#include "runtime/interaction/family_stages.h"
#include "runtime/interaction/family_window.h"
#include "runtime/lattice/shape_matrix.h"

/* --- particles -------------------------------------------------------------------------------- */

static const double *force_of_row(const sweep *w, const body_block *b, int row, int component,
                                  bool moving) {
  if (moving && family_of(w)->windows)
    return family_window_force(w, (int)(b - w->body->blocks), row, component);
  return w->body->force[component] + body_start(w->body, row);
}

/* `moving`: the forces are those of a step, and not of looking at the present state. All components
   in one loop, with a literal number of them and what is the same for most bodies left out:

     next = decay v + part dt/m f (motion.h)

   Not 0 when a velocity is not below the limit (NaN is not below anything). */
static inline __attribute__((always_inline)) int64_t kick(const body *w, const body_block *b,
                                                          int row,
                                                          const double *const force[PL_MAX_DOF],
                                                          int dimensions, int dof, bool each_mass) {
  const long start = body_start(w, row), count = w->count[row], pitch = w->lattice->pitch;
  const double decay = w->decay, *v[PL_MAX_DOF], *mobility[2] = {NULL, NULL};
  double factor[PL_MAX_DOF], *restrict next = b->next;
  int64_t bad = 0;
  for (int d = 0; d < dof; d++) {
    v[d] = w->velocity[d] + start;
    factor[d] = motion_force_part(w) * w->time_step / w->mass[d];
    if (each_mass) mobility[d >= dimensions] = w->mobility[d >= dimensions] + start;
  }
  INDEPENDENT
  for (long q = 0; q < count; q++)
    for (int d = 0; d < dof; d++) {
      const double push = each_mass ? factor[d] * mobility[d >= dimensions][q] * force[d][q]
                                    : factor[d] * force[d][q];
      const double after = decay * v[d][q] + push;
      next[d * pitch + q] = after;
      bad |= __builtin_fabs(after) < w->limit[d] ? INT64_C(0) : INT64_C(1);
    }
  return bad;
}

/* With literal numbers of dimensions and components: without rotations and with them. */
static inline __attribute__((always_inline)) int64_t
kick_components(const body *of, const body_block *b, int row, const double *const force[PL_MAX_DOF],
                bool each_mass) {
  if (of->dof == 2) return kick(of, b, row, force, 2, 2, each_mass);
  if (of->dof == 6) return kick(of, b, row, force, 3, 6, each_mass);
  return of->dimensions == 2 ? kick(of, b, row, force, 2, 3, each_mass)
                             : kick(of, b, row, force, 3, 3, each_mass);
}

static int64_t kick_row(const sweep *w, body_block *b, int row, bool moving) {
  const body *of = w->body;
  const double *force[PL_MAX_DOF] = {NULL};
  for (int d = 0; d < of->dof; d++)
    force[d] = force_of_row(w, b, row, d, moving);
  int64_t bad = of->mobility[0] ? kick_components(of, b, row, force, true)
                                : kick_components(of, b, row, force, false);
  for (int d = 0; d < of->dof; d++)
    bad |= motion_push(of, whole_row(of, row), d, b->next + d * of->lattice->pitch);
  return bad;
}

/* Work against the bonds: the force of a state counts over half of the way to it and half of the
   way from it (ledger.h). */
static double work_over(const body *w, int row, int component, const double *v) {
  return -0.5 * w->time_step *
         lane_dot(w->count[row], NULL, w->force[component] + body_start(w, row), v);
}

/* A row with a bad velocity stays where it is. */
static void move_rows(sweep *w, int block, int first, int last) {
  body *of = w->body;
  body_block *b = &of->blocks[block];
  const double begun = of->timed ? monotonic_seconds() : 0;
  for (int row = first; row < last; row++) {
    if (kick_row(w, b, row, true)) {
      motion_note_bad(of, b, row, 0);
      continue;
    }
    for (int d = 0; d < of->dof && of->works; d++)
      of->row_internal[row] += work_over(of, row, d, of->velocity[d] + body_start(of, row)) +
                               work_over(of, row, d, b->next + d * of->lattice->pitch);
    motion_drift(of, b, whole_row(of, row));
  }
  if (of->timed) b->moving += monotonic_seconds() - begun;
}

static int program_stages(const family *f, const pl_program *program) {
  return f->windows ? 1 : program->pass_count;
}

static void run_program(sweep *w, const pl_program *program, int stage, int block) {
  const bool pairs = family_of(w)->pairs && program == family_of(w)->march;
  if (family_of(w)->windows)
    family_window_run(w, program, block, NULL);
  else if (pairs)
    family_pairs_stage(w, stage, block);
  else
    family_stage(w, program, stage, block);
}

static void step_in_windows(sweep *w, int stage, int block) {
  const body_block *b = &w->body->blocks[block];
  int first, last;
  if (stage == 0) {
    family_window_run(w, family_of(w)->march, block, move_rows);
    return;
  }
  family_window_inner(w, block, &first, &last);
  move_rows(w, block, b->first, first);
  move_rows(w, block, last, b->last);
}

static void step(sweep *w, int stage, int block) {
  const body_block *b = &w->body->blocks[block];
  if (stage == 0) {
    w->body->blocks[block].bad_site = -1;
    family_of(w)->blocks[block].aside = false;
  }
  if (family_of(w)->windows)
    step_in_windows(w, stage, block);
  else if (stage < family_of(w)->march->pass_count)
    run_program(w, family_of(w)->march, stage, block);
  else
    move_rows(w, block, b->first, b->last);
}

/* What the law takes in the state observed, to begin with; no part of what has been lost for good. */
static void look_aside(sweep *w, int block) {
  const body_block *b = &w->body->blocks[block];
  family_of(w)->blocks[block].aside = true;
  for (int row = b->first; row < b->last && w->lost_state; row++) {
    const size_t bytes = (size_t)w->body->count[row] * sizeof(double);
    memset(w->lost_state + body_start(w->body, row), 0, bytes);
    memset(w->lost_rate + body_start(w->body, row), 0, bytes);
  }
}

static void find_forces(sweep *w, int stage, int block) {
  if (stage == 0) look_aside(w, block);
  run_program(w, family_of(w)->march, stage, block);
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

/* Values at absent sites mean nothing, and without bonds a particle stores nothing: a law may
   divide by what a family has. */
static bool stores(const rows *g, long site) {
  return g->present[site] && (g->bonds[site] || rows_degree(g, site) > 0);
}

/* At the other sites what passes have added means nothing. */
static void sum_losses(sweep *w, int row) {
  double *const energies[] = {w->dissipated_state, w->dissipated_rate, w->lost_state, w->lost_rate};
  const long start = body_start(w->body, row);
  for (long q = start; q < start + w->body->count[row]; q++)
    for (int k = 0; k < 4 && !stores(w->body->lattice, q); k++)
      energies[k][q] = 0;
  sweep_sum_losses(w, row);
}

static double stored_in_row(const sweep *w, int row) {
  const long start = body_start(w->body, row);
  double sum = 0;
  for (long q = start; q < start + w->body->count[row]; q++)
    if (stores(w->body->lattice, q)) sum += family_of(w)->observed[0][q];
  return sum;
}

static void observe_rows(sweep *w, int block) {
  body_block *b = &w->body->blocks[block];
  for (int row = b->first; row < b->last; row++) {
    kick_row(w, b, row, false);
    motion_observe(w->body, b, row);
    w->body->observed[row].stored = stored_in_row(w, row);
    if (w->lost_state) sum_losses(w, row);
  }
}

/* Forces and new fields of the present state: the passes of a step, whose new fields are written
   again by the next one. Then energy and outputs with these. */
static void observe(sweep *w, int stage, int block) {
  const family *f = family_of(w);
  const int forces = program_stages(f, f->march),
            all = forces + program_stages(f, &w->law->observe);
  if (stage == 0) look_aside(w, block);
  if (stage < forces)
    run_program(w, f->march, stage, block);
  else if (stage < all)
    run_program(w, &w->law->observe, stage - forces, block);
  else
    observe_rows(w, block);
}

static void output_values(sweep *w, int output, double *values) {
  const size_t count = (size_t)sweep_planes(w, w->law->outputs[output].place);
  memcpy(values, family_of(w)->observed[1 + output],
         count * (size_t)w->body->lattice->size * sizeof *values);
}

static void stored_values(sweep *w, double *values) {
  const rows *g = w->body->lattice;
  memset(values, 0, (size_t)g->size * sizeof *values);
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    if (stores(g, q)) values[q] = family_of(w)->observed[0][q];
  }
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
  for (int v = 0; v < PL_SHAPE_PLANES(w->body->dimensions); v++)
    f->shape[v] = body_doubles(w->body, w->body->lattice->size);
  shape_matrices(w->body->lattice, f->shape);
}

static void new_shares(sweep *w, family *f) {
  const long size = w->body->lattice->size;
  f->whole = body_doubles(w->body, size);
  for (long q = 0; q < size; q++)
    f->whole[q] = 1;
}

static void new_planes(sweep *w, family *f) {
  const pl_law *law = w->law;
  const long size = w->body->lattice->size;
  f->observed = must_calloc((size_t)law->output_count + 1, sizeof *f->observed);
  f->observed[0] = body_doubles(w->body, size);
  for (int k = 0; k < law->output_count; k++)
    f->observed[1 + k] = body_doubles(w->body, sweep_planes(w, law->outputs[k].place) * size);
}

static void new_links(sweep *w, family *f) {
  const pl_law *law = w->law;
  const long size = w->body->lattice->size;
  f->link = must_calloc((size_t)law->link_count + 1, sizeof *f->link);
  for (int k = 0; k < law->link_count; k++)
    f->link[k] = body_doubles(w->body, size);
  f->bond_link = must_calloc((size_t)law->bond_link_count + 1, sizeof *f->bond_link);
  for (int k = 0; k < law->bond_link_count; k++)
    f->bond_link[k] = body_doubles(w->body, sweep_planes(w, PL_ON_NEIGHBOUR) * size);
}

static void new_blocks(sweep *w, family *f) {
  const pl_law *law = w->law;
  const size_t one = sizeof(double *), fields = (size_t)law->field_count * one;
  f->blocks = must_calloc((size_t)w->body->block_count, sizeof *f->blocks);
  for (int k = 0; k < w->body->block_count; k++) {
    family_block *b = &f->blocks[k];
    b->parameter = body_apart(w->body, (size_t)law->varying_count * one);
    b->old_field = body_apart(w->body, fields);
    b->new_field = body_apart(w->body, fields);
    b->link = body_apart(w->body, (size_t)law->link_count * one);
    b->bond_link = body_apart(w->body, (size_t)law->bond_link_count * one);
    b->observed = body_apart(w->body, (size_t)(1 + law->output_count) * one);
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
  assert(law->neighbours == 0 || law->neighbours == 2 * w->body->lattice->directions);
  const bool losses = w->body->ledger && sweep_books_losses(law);
  f->march = losses ? &law->ledger : &law->step;
  if (losses) sweep_new_losses(w);
  f->neighbours = 2 * w->body->lattice->directions;
  f->reach = reach_of(w->body->lattice);
  assert(f->march->pass_count <= FAMILY_MOST_PASSES);
  f->uniforms = family_uniforms(law, w->body->lattice, parameters);
  new_planes(w, f);
  new_blocks(w, f);
  if (law->reads_shape) find_shapes(w, f);
  if (law->reads_share) new_shares(w, f);
  f->pairs = family_pairs_new(w, f);
  f->windows = f->pairs ? NULL : family_windows(w, f);
  if (!f->windows) new_links(w, f);
  const int forces = program_stages(f, f->march), looks = program_stages(f, &law->observe);
  return (sweep_engine){.step_stages = forces + 1,
                        .force_stages = forces,
                        .observe_stages = forces + looks + 1,
                        .step = step,
                        .forces = find_forces,
                        .turn = turn,
                        .fields_set = fields_set,
                        .observe = observe,
                        .output = output_values,
                        .stored = stored_values,
                        .free = free_own,
                        .keeps_links = f->windows == NULL,
                        .own = f};
}
