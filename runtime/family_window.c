#include <math.h>
#include <stdlib.h>

#include "dsl/arena.h"
#include "runtime/family_parts.h"

/* Each pass follows the one before as soon as that has done all rows in reach, some rows at a time; so links are needed
   of few rows, and stay in a cache. A block does the first passes on rows of its neighbours, too, as far as its own need
   them: that costs a few rows, and blocks wait for each other but once a step. */

enum { ROWS_AT_A_TIME = 8 };

struct family_window { /* row r stands in place r mod rows */
  int rows;
  long plane;                 /* doubles between planes of links of bonds */
  double **link, **bond_link; /* [links] begin of place 0 */
  double
      *force[3];   /* begin of place 0: of rows that move at once; NULL where all forces are kept */
  double **memory; /* [links + links of bonds + forces] */
  double **field, **observed; /* [planes][pitch] what other blocks write for their rows */
  long *offset;               /* [neighbours] of links, from the row at hand */
  int *row_offset;            /* [neighbours] rows to the neighbour */
};

/* --- set-up ----------------------------------------------------------------------------------- */

/* Rows that a block does at either end for its passes in addition to its own, and of which it reads the state. */
static int halo(const family *f, int passes) {
  return f->reach * passes;
}

static int most_passes(const pl_law *law) {
  const int step = law->step.pass_count, observe = law->observe.pass_count;
  return step > observe ? step : observe;
}

/* Rows by which a pass is behind the first one. */
static int rows_behind(const family *f, const pl_program *program, int pass) {
  int behind = 0;
  for (int p = 1; p <= pass; p++)
    if (!(program->at_hand >> p & 1)) behind += f->reach;
  return behind;
}

/* Rows between the first and the last that a link is kept of. */
static int rows_kept(const family *f, const pl_law *law) {
  const int step = rows_behind(f, &law->step, law->step.pass_count - 1),
            observe = rows_behind(f, &law->observe, law->observe.pass_count - 1);
  return (step > observe ? step : observe) + f->reach;
}

static bool suits(const sweep *w, const family *f) {
  enum { ROWS_TO_HALO = 8 }; /* fewer rows of a block: too much would be done twice */
  enum {
    MOST_NEIGHBOURS = 39
  }; /* of more, links fill no cache, and later passes may read new fields */
  const int least = w->lattice->row_count / w->block_count;
  return !w->lattice->list && f->neighbours <= MOST_NEIGHBOURS &&
         least >= ROWS_TO_HALO * halo(f, most_passes(w->law));
}

static double *padded(sweep *w, long count, double **memory) {
  *memory = sweep_doubles(w, count + 2 * w->lattice->pitch);
  return *memory + w->lattice->pitch;
}

static double **scratch_rows(sweep *w, const pl_field *fields, int count, int more) {
  double **rows_of = must_calloc((size_t)(more + count) + 1, sizeof *rows_of);
  for (int k = 0; k < more + count; k++)
    rows_of[k] = sweep_doubles(w, (k < more ? 1 : sweep_planes(w, fields[k - more].place)) *
                                      w->lattice->pitch);
  return rows_of;
}

static void open_window(sweep *w, const family *f, family_window *v) {
  const pl_law *law = w->law;
  const rows *g = w->lattice;
  v->rows = ROWS_AT_A_TIME + rows_kept(f, law);
  v->plane = (v->rows + 2) * g->pitch;
  v->link = must_calloc((size_t)law->link_count + 1, sizeof *v->link);
  v->bond_link = must_calloc((size_t)law->bond_link_count + 1, sizeof *v->bond_link);
  v->memory =
      must_calloc((size_t)(law->link_count + law->bond_link_count + w->dof) + 1, sizeof *v->memory);
  for (int k = 0; k < law->link_count; k++)
    v->link[k] = padded(w, v->rows * g->pitch, &v->memory[k]);
  for (int k = 0; k < law->bond_link_count; k++)
    v->bond_link[k] = padded(w, f->neighbours * v->plane, &v->memory[law->link_count + k]);
  for (int d = 0; d < w->dof && !w->forces; d++)
    v->force[d] =
        padded(w, v->rows * g->pitch, &v->memory[law->link_count + law->bond_link_count + d]);
  v->field = scratch_rows(w, law->fields, law->field_count, 0);
  v->observed = scratch_rows(w, law->outputs, law->output_count, 1);
  v->offset = must_calloc((size_t)f->neighbours, sizeof *v->offset);
  v->row_offset = must_calloc((size_t)f->neighbours, sizeof *v->row_offset);
  for (int k = 0; k < f->neighbours; k++)
    v->row_offset[k] = (int)rint((double)g->offset[0][k] / (double)g->pitch);
}

family_window *family_windows(sweep *w, const family *f) {
  if (!suits(w, f)) return NULL;
  family_window *v = must_calloc((size_t)w->block_count, sizeof *v);
  for (int k = 0; k < w->block_count; k++)
    open_window(w, f, &v[k]);
  return v;
}

static void free_rows(double **rows_of, int count) {
  for (int k = 0; k < count; k++)
    free(rows_of[k]);
  free(rows_of);
}

void family_windows_free(const sweep *w, family_window *v) {
  const pl_law *law = w->law;
  for (int k = 0; v && k < w->block_count; k++) {
    free_rows(v[k].memory, law->link_count + law->bond_link_count + w->dof);
    free_rows(v[k].field, law->field_count);
    free_rows(v[k].observed, 1 + law->output_count);
    free(v[k].link);
    free(v[k].bond_link);
    free(v[k].offset);
    free(v[k].row_offset);
  }
  free(v);
}

/* --- running ---------------------------------------------------------------------------------- */

static void point_at_links(const sweep *w, int block, int row, pl_family *run) {
  family_block *b = &family_of(w)->blocks[block];
  family_window *v = &family_of(w)->windows[block];
  const int here = row % v->rows;
  const long pitch = w->lattice->pitch, start = here * pitch + w->begin[row];
  for (int k = 0; k < w->law->link_count; k++)
    b->link[k] = v->link[k] + start;
  for (int k = 0; k < w->law->bond_link_count; k++)
    b->bond_link[k] = v->bond_link[k] + start;
  for (int k = 0; k < family_of(w)->neighbours; k++) {
    const int there = here + v->row_offset[k];
    const int round = there < 0 ? v->rows : there >= v->rows ? -v->rows : 0;
    v->offset[k] = run->offset[k] + round * pitch;
  }
  run->link_offset = v->offset;
  run->link_plane = v->plane;
}

/* What is found of another block's row is for links only. */
static void write_nowhere(const sweep *w, int block, int row, pl_family *run) {
  family_block *b = &family_of(w)->blocks[block];
  const family_window *v = &family_of(w)->windows[block];
  for (int k = 0; k < w->law->field_count; k++)
    b->new_field[k] = v->field[k] + w->begin[row];
  for (int k = 0; k <= w->law->output_count; k++)
    b->observed[k] = v->observed[k] + w->begin[row];
  run->new_plane = w->lattice->pitch;
}

static bool moves_at_once(const sweep *w, int block, int row) {
  int first, last;
  family_window_inner(w, block, &first, &last);
  return row >= first && row < last;
}

static double *force_place(const sweep *w, int block, int row, int component) {
  const family_window *v = &family_of(w)->windows[block];
  return v->force[component] + (row % v->rows) * w->lattice->pitch + w->begin[row];
}

const double *family_window_force(const sweep *w, int block, int row, int component) {
  return w->forces || !moves_at_once(w, block, row) ? w->force[component] + sweep_start(w, row)
                                                    : force_place(w, block, row, component);
}

/* Rows first .. last-1. With `passing` forces are needed until the particles have moved. */
static void run_rows(const sweep *w, pl_family_function pass, int block, int first, int last,
                     bool passing) {
  const sweep_block *b = &w->blocks[block];
  for (int row = first; row < last; row++) {
    if (w->count[row] == 0) continue;
    pl_family run = family_run_of(w, block, row);
    point_at_links(w, block, row, &run);
    if (row < b->first || row >= b->last) write_nowhere(w, block, row, &run);
    for (int d = 0; d < w->dof && passing && !w->forces && moves_at_once(w, block, row); d++)
      family_of(w)->blocks[block].force[d] = force_place(w, block, row, d);
    pass(w->law, family_of(w)->uniforms, &run);
  }
}

static int most(int a, int b) {
  return a > b ? a : b;
}

void family_window_inner(const sweep *w, int block, int *first, int *last) {
  const sweep_block *b = &w->blocks[block];
  const int lost = halo(family_of(w), w->law->step.pass_count);
  *first = b->first == 0 ? 0 : b->first + lost;
  *last = b->last == w->lattice->row_count ? b->last : b->last - lost;
}

void family_window_run(sweep *w, const pl_program *program, int block,
                       void (*move)(sweep *, int block, int first, int last)) {
  const sweep_block *b = &w->blocks[block];
  const family *f = family_of(w);
  const int passes = program->pass_count, reach = f->reach;
  int next[FAMILY_MOST_PASSES], last[FAMILY_MOST_PASSES], moved, last_moved;
  family_window_inner(w, block, &moved, &last_moved);
  for (int p = 0; p < passes; p++) {
    next[p] = most(b->first - reach * (passes - 1 - p), 0);
    last[p] = least(b->last + rows_behind(f, program, passes - 1) - rows_behind(f, program, p),
                    w->lattice->row_count);
  }
  while (next[0] < last[0]) { /* when the first is done, all follow */
    int end = least(next[0] + ROWS_AT_A_TIME, last[0]);
    for (int p = 0; p < passes; p++) {
      run_rows(w, program->pass[p], block, next[p], end, move != NULL);
      next[p] = most(end, next[p]);
      const bool ahead = p + 1 == passes || !(program->at_hand >> (p + 1) & 1);
      end = next[p] == last[p] ? w->lattice->row_count : next[p] - (ahead ? reach : 0);
      if (p + 1 < passes) end = least(end, last[p + 1]);
    }
    end = least(end, last_moved);
    if (move && end > moved) {
      move(w, block, moved, end);
      moved = end;
    }
  }
}
