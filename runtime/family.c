#include "runtime/family.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"
#include "runtime/shape_matrix.h"
#include "runtime/sweep_parts.h"

enum { SHAPE_PLANES = PL_SHAPE_PLANES(3) }; /* the most */

enum { FAMILY_MOST_PASSES = 16 };

typedef struct family_block { /* pointers to the run at hand, for the law */
  const double **old_field;
  double **new_field, **link, **bond_link, **observed;
  const double *shape[SHAPE_PLANES];
} family_block;

typedef struct family {
  int neighbours, reach;       /* rows between a particle and its farthest neighbour */
  double *uniforms;            /* [neighbours][uniform_count]; lists: [uniform_count] */
  double **new_field;          /* [fields][planes * size] */
  double **link;               /* [links][size] */
  double **bond_link;          /* [bond_links][neighbours * size] */
  double **observed;           /* [1 + outputs][planes * size] */
  double *shape[SHAPE_PLANES]; /* [size]; NULL unless the law reads them */
  family_block *blocks;        /* [block_count] */
} family;

static family *own(const sweep *w) {
  return w->engine.own;
}

/* --- passes ----------------------------------------------------------------------------------- */

static void point_at_run(const sweep *w, family_block *b, long start) {
  const family *f = own(w);
  for (int k = 0; k < w->law->field_count; k++) {
    b->old_field[k] = w->field[k] + start;
    b->new_field[k] = f->new_field[k] + start;
  }
  for (int k = 0; k < w->law->link_count; k++)
    b->link[k] = f->link[k] + start;
  for (int k = 0; k < w->law->bond_link_count; k++)
    b->bond_link[k] = f->bond_link[k] + start;
  for (int k = 0; k <= w->law->output_count; k++)
    b->observed[k] = f->observed[k] + start;
  for (int k = 0; k < SHAPE_PLANES && f->shape[k]; k++)
    b->shape[k] = f->shape[k] + start;
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

static pl_family run_of(const sweep *w, family_block *b, int row) {
  const family *f = own(w);
  const long start = sweep_start(w, row);
  point_at_run(w, b, start);
  pl_family run = {.count = w->count[row],
                   .neighbours = f->neighbours,
                   .plane = w->lattice->size,
                   .bonds = w->lattice->bonds + start,
                   .held = w->lattice->held + start,
                   .shape = b->shape,
                   .old_field = b->old_field,
                   .new_field = b->new_field,
                   .link = b->link,
                   .bond_link = b->bond_link,
                   .observed = b->observed,
                   .time_step = w->time_step};
  point_at_neighbours(w->lattice, row, start, &run);
  for (int d = 0; d < w->dof; d++) {
    run.displacement[d] = w->displacement[d] + start;
    run.velocity[d] = w->velocity[d] + start;
  }
  return run;
}

/* The row after the last that goes on in memory as this one begins, with neighbours at the same offsets: together they are one
   long row, with absent sites in between. */
static int end_of_alike(const sweep *w, int row, int last) {
  const unsigned char *kind = w->lattice->row_class + w->lattice->margin;
  int end = row + 1;
  while (end < last && w->count[row] > 0 && w->count[end] > 0 && kind[end] == kind[row])
    end++;
  return end;
}

/* Rows first .. last-1. */
static void run_rows(const sweep *w, pl_family_function pass, int block, int first, int last) {
  double *force[3];
  for (int row = first, end; row < last; row = end) {
    end = end_of_alike(w, row, last);
    if (w->count[row] == 0) continue;
    const long start = sweep_start(w, row);
    pl_family run = run_of(w, &own(w)->blocks[block], row);
    run.count = sweep_start(w, end - 1) + w->count[end - 1] - start;
    for (int d = 0; d < w->dof; d++)
      force[d] = w->force[d] + start;
    run.force = force;
    pass(w->law, own(w)->uniforms, &run);
  }
}

static void run_pass(const sweep *w, const pl_program *program, int pass, int block) {
  const sweep_block *b = &w->blocks[block];
  run_rows(w, program->pass[pass], block, b->first, b->last);
}

/* Rows of a block that a pass can do without what other blocks do at the same time: a pass needs the pass before on all
   rows in reach, so each loses as many at either end, but at the ends of the body. */
static void inner_rows(const sweep *w, int block, int pass, int *first, int *last) {
  const sweep_block *b = &w->blocks[block];
  const int lost = pass * own(w)->reach;
  *first = b->first == 0 ? 0 : b->first + lost;
  *last = b->last == w->lattice->row_count ? b->last : b->last - lost;
  if (*last < *first) *last = *first = b->last;
}

static int least(int a, int b) {
  return a < b ? a : b;
}

/* All passes on the inner rows, some rows at a time, each pass as soon as the one before is far enough ahead: what one
   leaves the next finds in a cache. */
static void run_inner(const sweep *w, const pl_program *program, int block) {
  enum { ROWS_AT_A_TIME = 16 };
  enum { FARTHEST = 400 }; /* rows between passes that a cache may still hold */
  const int at_a_time = own(w)->reach > FARTHEST ? w->lattice->row_count : ROWS_AT_A_TIME;
  int next[FAMILY_MOST_PASSES], last[FAMILY_MOST_PASSES];
  const int passes = program->pass_count;
  for (int p = 0; p < passes; p++)
    inner_rows(w, block, p, &next[p], &last[p]);
  while (next[0] < last[0]) { /* when the first is done, all follow */
    int end = least(next[0] + at_a_time, last[0]);
    for (int p = 0; p < passes; p++) {
      run_rows(w, program->pass[p], block, next[p], end);
      next[p] = end > next[p] ? end : next[p];
      if (p + 1 < passes) end = next[p] == last[p] ? last[p + 1] : next[p] - own(w)->reach;
    }
  }
}

/* A pass on the rows that the inner rows leave. */
static void run_outer(const sweep *w, const pl_program *program, int pass, int block) {
  const sweep_block *b = &w->blocks[block];
  int first, last;
  inner_rows(w, block, pass, &first, &last);
  run_rows(w, program->pass[pass], block, b->first, first);
  run_rows(w, program->pass[pass], block, last, b->last);
}

/* Stages of a program: the inner rows, then what is left for each pass after the first. */
static void run_stage(const sweep *w, const pl_program *program, int stage, int block) {
  if (stage == 0)
    run_inner(w, program, block);
  else
    run_outer(w, program, stage, block);
}

/* --- particles -------------------------------------------------------------------------------- */

/* next = decay v + dt/m f. Not 0 when a velocity is not below the limit (NaN is not below anything). */
static int64_t kick(long count, double factor, double decay, double limit,
                    const double *restrict force, const double *restrict v, double *restrict next) {
  int64_t bad = 0;
  INDEPENDENT
  for (long q = 0; q < count; q++) {
    const double after = decay * v[q] + factor * force[q];
    next[q] = after;
    bad |= __builtin_fabs(after) < limit ? INT64_C(0) : INT64_C(1);
  }
  return bad;
}

/* The same for particles of different masses. */
static int64_t kick_each(long count, double factor, double decay, double limit,
                         const double *restrict mobility, const double *restrict force,
                         const double *restrict v, double *restrict next) {
  int64_t bad = 0;
  INDEPENDENT
  for (long q = 0; q < count; q++) {
    const double after = decay * v[q] + factor * mobility[q] * force[q];
    next[q] = after;
    bad |= __builtin_fabs(after) < limit ? INT64_C(0) : INT64_C(1);
  }
  return bad;
}

static int64_t kick_row(const sweep *w, sweep_block *b, int row) {
  const long start = sweep_start(w, row), count = w->count[row];
  int64_t bad = 0;
  for (int d = 0; d < w->dof; d++) {
    double *next = b->next + d * w->lattice->pitch;
    const double factor = w->time_step / w->mass[d], *f = w->force[d] + start;
    const double *v = w->velocity[d] + start;
    bad |= w->mobility
               ? kick_each(count, factor, w->decay, w->limit[d], w->mobility + start, f, v, next)
               : kick(count, factor, w->decay, w->limit[d], f, v, next);
    bad |= sweep_push(w, row, d, next);
  }
  return bad;
}

/* Work against the bonds: the force of a state counts over half of the way to it and half of the
   way from it (ledger.h). */
static double work_over(const sweep *w, int row, int component, const double *v) {
  return -0.5 * w->time_step *
         sweep_dot(w->count[row], w->force[component] + sweep_start(w, row), v);
}

/* A row with a bad velocity stays where it is. */
static void move_rows(sweep *w, int block) {
  sweep_block *b = &w->blocks[block];
  b->bad_site = -1;
  for (int row = b->first; row < b->last; row++) {
    if (kick_row(w, b, row)) {
      sweep_note_bad(w, b, row);
      continue;
    }
    for (int d = 0; d < w->dof && w->ledger; d++)
      w->row_internal[row] += work_over(w, row, d, w->velocity[d] + sweep_start(w, row)) +
                              work_over(w, row, d, b->next + d * w->lattice->pitch);
    sweep_drift(w, b, row);
  }
}

static void step(sweep *w, int stage, int block) {
  if (stage < w->law->step.pass_count)
    run_stage(w, &w->law->step, stage, block);
  else
    move_rows(w, block);
}

/* What was new is now at hand. */
static void turn(sweep *w) {
  double **old = w->field;
  w->field = own(w)->new_field;
  own(w)->new_field = old;
}

/* --- sampling --------------------------------------------------------------------------------- */

/* Values at absent sites mean nothing, and without bonds a particle stores nothing: a law may divide by what a family
   has. */
static double stored_in_row(const sweep *w, int row) {
  const long start = sweep_start(w, row);
  double sum = 0;
  for (long q = start; q < start + w->count[row]; q++)
    if (w->lattice->present[q] && rows_degree(w->lattice, q) > 0) sum += own(w)->observed[0][q];
  return sum;
}

static void observe_rows(sweep *w, int block) {
  sweep_block *b = &w->blocks[block];
  for (int row = b->first; row < b->last; row++) {
    kick_row(w, b, row);
    sweep_observe_motion(w, b, row);
    w->row_stored[row] = stored_in_row(w, row);
    w->row_internal_pending[row] = 0;
    for (int d = 0; d < w->dof; d++)
      w->row_internal_pending[row] += work_over(w, row, d, w->velocity[d] + sweep_start(w, row));
  }
}

/* Forces of the present state: the passes of a step, whose new fields are written again by the next
   one. */
static void observe(sweep *w, int stage, int block) {
  const int forces = w->law->step.pass_count, all = forces + w->law->observe.pass_count;
  if (stage < forces)
    run_stage(w, &w->law->step, stage, block);
  else if (stage < all)
    run_pass(w, &w->law->observe, stage - forces, block);
  else
    observe_rows(w, block);
}

static void output_values(sweep *w, int output, double *values) {
  const size_t count = (size_t)sweep_planes(w, w->law->outputs[output].place);
  for (int stage = 0; stage < w->law->observe.pass_count; stage++)
    for (int b = 0; b < w->block_count; b++)
      run_pass(w, &w->law->observe, stage, b);
  memcpy(values, own(w)->observed[1 + output], count * (size_t)w->lattice->size * sizeof *values);
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
  f->new_field = must_calloc((size_t)law->field_count + 1, sizeof *f->new_field);
  for (int k = 0; k < law->field_count; k++) {
    const long count = sweep_planes(w, law->fields[k].place) * size;
    f->new_field[k] = sweep_doubles(w, count);
    memcpy(f->new_field[k], w->field[k], (size_t)count * sizeof(double));
  }
  f->link = must_calloc((size_t)law->link_count + 1, sizeof *f->link);
  for (int k = 0; k < law->link_count; k++)
    f->link[k] = sweep_doubles(w, size);
  f->bond_link = must_calloc((size_t)law->bond_link_count + 1, sizeof *f->bond_link);
  for (int k = 0; k < law->bond_link_count; k++)
    f->bond_link[k] = sweep_doubles(w, sweep_planes(w, PL_ON_NEIGHBOUR) * size);
  f->observed = must_calloc((size_t)law->output_count + 1, sizeof *f->observed);
  f->observed[0] = sweep_doubles(w, size);
  for (int k = 0; k < law->output_count; k++)
    f->observed[1 + k] = sweep_doubles(w, sweep_planes(w, law->outputs[k].place) * size);
}

static void new_blocks(const sweep *w, family *f) {
  const pl_law *law = w->law;
  f->blocks = must_calloc((size_t)w->block_count, sizeof *f->blocks);
  for (int k = 0; k < w->block_count; k++) {
    family_block *b = &f->blocks[k];
    b->old_field = must_calloc((size_t)law->field_count + 1, sizeof *b->old_field);
    b->new_field = must_calloc((size_t)law->field_count + 1, sizeof *b->new_field);
    b->link = must_calloc((size_t)law->link_count + 1, sizeof *b->link);
    b->bond_link = must_calloc((size_t)law->bond_link_count + 1, sizeof *b->bond_link);
    b->observed = must_calloc((size_t)law->output_count + 1, sizeof *b->observed);
  }
}

static void free_arrays(double **arrays, int count) {
  for (int k = 0; k < count; k++)
    free(arrays[k]);
  free(arrays);
}

static void free_own(sweep *w) {
  family *f = own(w);
  for (int k = 0; k < w->block_count; k++) {
    free(f->blocks[k].old_field);
    free(f->blocks[k].new_field);
    free(f->blocks[k].link);
    free(f->blocks[k].bond_link);
    free(f->blocks[k].observed);
  }
  free_arrays(f->new_field, w->law->field_count);
  free_arrays(f->link, w->law->link_count);
  free_arrays(f->bond_link, w->law->bond_link_count);
  free_arrays(f->observed, 1 + w->law->output_count);
  for (int v = 0; v < SHAPE_PLANES; v++)
    free(f->shape[v]);
  free(f->blocks);
  free(f->uniforms);
  free(f);
}

/* On lists neighbours may be anywhere. */
static int reach_of(const rows *g) {
  double most = 0;
  for (int k = 0; k < g->directions; k++)
    most = fmax(most, rint((double)g->offset[0][k] / (double)g->pitch));
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
  return (sweep_engine){.step_stages = law->step.pass_count + 1,
                        .observe_stages = law->step.pass_count + law->observe.pass_count + 1,
                        .step = step,
                        .turn = turn,
                        .observe = observe,
                        .output = output_values,
                        .free = free_own,
                        .own = f};
}
