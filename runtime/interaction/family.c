#include "runtime/interaction/family.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/clock.h"
#include "runtime/body/advance.h"
#include "runtime/body/motion.h"
#include "runtime/interaction/family_pairs.h"
#include "runtime/interaction/family_run.h"
#include "runtime/interaction/family_stages.h"
#include "runtime/interaction/family_window.h"
#include "runtime/lattice/shape_matrix.h"

/* --- particles -------------------------------------------------------------------------------- */

static void forces_of_row(const sweep *w, const body_block *b, int row, bool moving,
                          const double *force[PL_MAX_DOF]) {
  const bool in_window = moving && family_of(w)->windows;
  for (int d = 0; d < w->body->dof; d++)
    force[d] = in_window ? family_window_force(w, (int)(b - w->body->blocks), row, d)
                         : w->force[d] + body_start(w->body, row);
}

static void move_rows(sweep *w, int block, int first, int last) {
  body *of = w->body;
  body_block *b = &of->blocks[block];
  const double begun = of->timed ? monotonic_seconds() : 0, *force[PL_MAX_DOF] = {NULL};
  for (int row = first; row < last; row++) {
    forces_of_row(w, b, row, true, force);
    advance_row(of, b, row, force);
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
  if (stage == 0) body_step_begins(w->body, block);
  if (family_of(w)->windows)
    step_in_windows(w, stage, block);
  else if (stage < family_of(w)->march->pass_count)
    run_program(w, family_of(w)->march, stage, block);
  else
    move_rows(w, block, b->first, b->last);
}

/* What the law takes in the state observed, to begin with. */
static void clear_lost(sweep *w, int block) {
  const body_block *b = &w->body->blocks[block];
  if (!w->lost_state || !b->aside) return;
  for (int row = b->first; row < b->last; row++)
    sweep_clear_losses(w, row);
}

/* Begins to find forces: of a law beside others, for a step or for a look at the present state. */
static void look(sweep *w, int block) {
  if (!w->beside) w->body->blocks[block].aside = true;
  clear_lost(w, block);
}

static void find_forces(sweep *w, int stage, int block) {
  if (stage == 0) look(w, block);
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
void family_add_losses(sweep *w, int row) {
  double *const energies[] = {w->dissipated_state, w->dissipated_rate, w->lost_state,
                              w->lost_rate,        w->given_by_rest,   w->given_now};
  const int count = w->given_by_rest ? 6 : 4;
  const long start = body_start(w->body, row);
  if (!w->lost_state) return;
  for (long q = start; q < start + w->body->count[row]; q++)
    for (int k = 0; k < count && !stores(w->lattice, q); k++)
      energies[k][q] = 0;
  sweep_add_losses(w, row);
}

double family_stored_in_row(const sweep *w, int row) {
  const long start = body_start(w->body, row);
  double sum = 0;
  for (long q = start; q < start + w->body->count[row]; q++)
    if (stores(w->lattice, q)) sum += family_of(w)->observed[0][q];
  return sum;
}

static void observe_rows(sweep *w, int block) {
  body_block *b = &w->body->blocks[block];
  const double *force[PL_MAX_DOF] = {NULL};
  for (int row = b->first; row < b->last; row++) {
    forces_of_row(w, b, row, false, force);
    advance_kick(w->body, b, row, force);
    motion_observe(w->body, b, row);
    if (w->body->forces_alone) continue;
    w->body->observed[row].stored = family_stored_in_row(w, row);
    family_add_losses(w, row);
  }
}

/* Forces and new fields of the present state: the passes of a step, whose new fields are written
   again by the next one. Then, where somebody wants them, energy and outputs with these. */
static void observe(sweep *w, int stage, int block) {
  const family *f = family_of(w);
  const int forces = program_stages(f, f->march),
            all = forces + program_stages(f, &w->law->observe);
  if (stage == 0) look(w, block);
  if (stage < forces)
    run_program(w, f->march, stage, block);
  else if (stage == all)
    observe_rows(w, block);
  else if (!w->body->forces_alone)
    run_program(w, &w->law->observe, stage - forces, block);
}

static void output_values(sweep *w, int output, double *values) {
  const size_t count = (size_t)sweep_planes(w, w->law->outputs[output].place);
  memcpy(values, family_of(w)->observed[1 + output],
         count * (size_t)w->lattice->size * sizeof *values);
}

static void stored_values(sweep *w, double *values) {
  const rows *g = w->lattice;
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
    f->shape[v] = body_doubles(w->body, w->lattice->size);
  shape_matrices(w->lattice, f->shape);
}

static void new_shares(sweep *w, family *f) {
  const long size = w->lattice->size;
  f->whole = body_doubles(w->body, size);
  for (long q = 0; q < size; q++)
    f->whole[q] = 1;
}

/* Of a law that reads sizes on particles of one. */
static bool sizes_are_alike(const sweep *w) {
  return PL_HAS(w->law, reads_own_size) && w->law->reads_own_size && !w->lattice->own_size;
}

static void new_masses(sweep *w, family *f) {
  const long size = w->lattice->size;
  f->mass = body_doubles(w->body, size);
  for (long q = 0; q < size; q++)
    f->mass[q] = w->lattice->mass;
}

static void new_planes(sweep *w, family *f) {
  const pl_law *law = w->law;
  const long size = w->lattice->size;
  f->observed = must_calloc((size_t)law->output_count + 1, sizeof *f->observed);
  f->observed[0] = body_doubles(w->body, size);
  for (int k = 0; k < law->output_count; k++)
    f->observed[1 + k] = body_doubles(w->body, sweep_planes(w, law->outputs[k].place) * size);
}

static void new_links(sweep *w, family *f) {
  const pl_law *law = w->law;
  const long size = w->lattice->size;
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

/* Rows from a particle to the farthest of its neighbours. */
static int reach_of_list(const rows *g) {
  long most = 0;
  for (long q = 0; q < g->size; q++)
    for (int k = 0; k < g->directions; k++)
      if (rows_has_bond(g, q, k)) {
        const long rows_to = rows_partner(g, q, k) / g->pitch - q / g->pitch;
        most = labs(rows_to) > most ? labs(rows_to) : most;
      }
  return (int)most;
}

static int reach_of(const rows *g) {
  double most = 0;
  if (g->list) return reach_of_list(g);
  for (int k = 0; k < g->directions; k++)
    most = pl_fmax(most, rint((double)g->offset[0][k] / (double)g->pitch));
  return (int)most;
}

/* Losses are not kept where a law at work on the body does not say what it takes. */
static void choose_march(sweep *w, family *f) {
  const bool says = PL_HAS(w->law, ledger) && w->law->ledger.pass_count > 0;
  const bool kept = says && w->body->ledger && !w->body->works;
  f->march = kept ? &w->law->ledger : &w->law->step;
  if (kept) sweep_new_losses(w);
}

sweep_engine family_engine(sweep *w, const double *parameters) {
  const pl_law *law = w->law;
  family *f = must_calloc(1, sizeof *f);
  assert(law->neighbours == 0 || law->neighbours == 2 * w->lattice->directions);
  choose_march(w, f);
  f->neighbours = 2 * w->lattice->directions;
  f->reach = reach_of(w->lattice);
  assert(f->march->pass_count <= FAMILY_MOST_PASSES);
  f->uniforms = family_uniforms(law, w->lattice, parameters);
  new_planes(w, f);
  new_blocks(w, f);
  if (law->reads_shape) find_shapes(w, f);
  if (law->reads_share || sizes_are_alike(w)) new_shares(w, f);
  if (law->reads_mass && !w->lattice->site_mass) new_masses(w, f);
  f->pairs = family_pairs_new(w, f);
  f->windows = f->pairs ? NULL : family_windows(w, f);
  if (!f->windows) new_links(w, f);
  const int forces = program_stages(f, f->march), looks = program_stages(f, &law->observe);
  const int move = w->beside ? 0 : 1;
  return (sweep_engine){.step_stages = forces + move,
                        .force_stages = forces,
                        .observe_stages = forces + looks + move,
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
