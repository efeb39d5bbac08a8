#include "runtime/interaction/family_window.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

/* Each pass follows the one before as soon as that has done all rows in reach, some rows at a time;
   so links are needed of few rows, and stay in a cache. Two passes with a reach of one row, four
   rows at a time, in a block of rows 0 .. 9 that is the whole body (`behind` is 0 and 1, window of
   4 + 2 rows):

              row  0  1  2  3  4  5  6  7  8  9
     round 1       A  A  A  A                       pass A
                   B  B  B                          pass B: its row 3 needs A on row 4
                   m  m                             move: row 2 is still to be read by B on row 3
     round 2                   A  A  A  A
                            B  B  B  B
                         m  m  m  m
     round 3                               A  A
                                        B  B  B
                                     m  m  m  m

   Row r has its links in place r mod 6. In round 2 pass A writes rows 4 .. 7 to places 4, 5, 0, 1;
   pass B reads rows 2 .. 7, which are all six places.

   A block does the first passes on rows of its neighbours, too, as far as its own need them: that
   costs a few rows, and blocks wait for each other but once a step. Those rows stay where they are
   until then, and so do the block's own that the others read (`inner` are the rest). */

typedef struct sites {
  long begin, end;
} sites;

struct family_window { /* row r stands in place r mod rows */
  int rows;
  int at_a_time;              /* rows */
  int step;                   /* to the next row of a run */
  int inner, inner_end;       /* rows of the block whose present state no other block needs */
  long plane;                 /* doubles between planes */
  double **link, **bond_link; /* [links] begin of place 0 */
  /* begin of place 0: of rows that move at once; NULL where all forces are kept */
  double *force[PL_MAX_DOF];
  double *memory;             /* [links + neighbours*links of bonds + forces][plane] */
  double **field, **observed; /* [planes][pitch] what other blocks write for their rows */
  double *lost[PL_LOSSES];    /* the same */
  long *offset;               /* [neighbours] of links, from the row at hand */
  int *row_offset;            /* [neighbours] rows to the neighbour */
  sites *
      /* [passes of a step][rows] sites of a place where the pass has left what both ends share */
      left;
  int *straight; /* [rows] places from here on before a row, or one of a neighbour, is at place 0 */
};

static int most(int a, int b) {
  return a > b ? a : b;
}

static long shorter(long a, long b) {
  return a < b ? a : b;
}

static long longer(long a, long b) {
  return a > b ? a : b;
}

/* --- set-up ----------------------------------------------------------------------------------- */

/* Rows by which a pass is behind the first one. */
static int rows_behind(const family *f, const pl_program *program, int pass) {
  int behind = 0;
  for (int p = 1; p <= pass; p++)
    if (!(program->at_hand >> p & 1)) behind += f->reach;
  return behind;
}

/* Rows below a block that a pass must do, too, for those after it. */
static int rows_before(const family *f, const pl_program *program, int pass) {
  int before = 0;
  for (int p = pass + 1; p < program->pass_count; p++)
    if (!(program->upward >> p & 1)) before += f->reach;
  return before;
}

/* Rows of which a block reads the state at either end in addition to its own. */
static int halo(const family *f, const pl_program *program) {
  return most(rows_before(f, program, 0), rows_behind(f, program, program->pass_count - 1)) +
         f->reach;
}

/* Rows that the links, or the forces on particles that have yet to move, are kept of. */
static int rows_kept(const family *f, const pl_program *program) {
  const int links = rows_behind(f, program, program->pass_count - 1) + f->reach;
  return most(links - program->spared * f->reach, f->reach);
}

static bool suits(const sweep *w, const family *f) {
  enum { ROWS_TO_HALO = 4 }; /* fewer rows of a block: too much would be done twice */
  enum {
    MOST_NEIGHBOURS = 39
  }; /* of more, links fill no cache, and later passes may read new fields */
  const int least = w->lattice->row_count / w->body->block_count;
  return !w->lattice->list && f->neighbours <= MOST_NEIGHBOURS &&
         (w->body->block_count == 1 ||
          least >= ROWS_TO_HALO * most(halo(f, f->march), halo(f, &w->law->observe)));
}

/* Short rows are done many at a time, and as many as are alike in one run: a call sets up as much
   as some vectors take. Of long rows the next one finds more in the first cache than the next one
   alike. */
static void choose_runs(family_window *v, const pl_law *law, long pitch) {
  enum { SITES = 1024, FEW = 8, MANY = 32 };
  const int rows_here = (int)(SITES / pitch);
  v->at_a_time = rows_here < FEW ? FEW : least(rows_here, MANY);
  v->step = law->neighbours && rows_here >= FEW ? FAMILY_ROWS_ALIKE : 1;
}

/* Room for a row before and one after, and an odd number of cache lines: the same places of no two
   of 64 planes are a multiple of a page apart, where a load would wait for the store to such a
   place. */
static long distance_of_planes(const family_window *v, long pitch) {
  const long lines = (v->rows + 2) * pitch / PL_LANES;
  return (lines | 1) * PL_LANES;
}

static void open_planes(sweep *w, const family *f, family_window *v) {
  const pl_law *law = w->law;
  const int forces = w->body->forces ? 0 : w->body->dof;
  const long planes = law->link_count + (long)law->bond_link_count * f->neighbours + forces;
  v->plane = distance_of_planes(v, w->lattice->pitch);
  v->memory = body_doubles(w->body, planes * v->plane);
  v->link = must_calloc((size_t)law->link_count + 1, sizeof *v->link);
  v->bond_link = must_calloc((size_t)law->bond_link_count + 1, sizeof *v->bond_link);
  double *next = v->memory + w->lattice->pitch;
  for (int k = 0; k < law->link_count; k++, next += v->plane)
    v->link[k] = next;
  for (int k = 0; k < law->bond_link_count; k++, next += f->neighbours * v->plane)
    v->bond_link[k] = next;
  for (int d = 0; d < forces; d++, next += v->plane)
    v->force[d] = next;
}

static double **scratch_rows(sweep *w, const pl_field *fields, int count, int more) {
  double **rows_of = must_calloc((size_t)(more + count) + 1, sizeof *rows_of);
  for (int k = 0; k < more + count; k++)
    rows_of[k] = body_doubles(w->body, (k < more ? 1 : sweep_planes(w, fields[k - more].place)) *
                                           w->lattice->pitch);
  return rows_of;
}

/* Where rows, or those of neighbours, begin again at place 0. */
static void find_straight(family_window *v, int neighbours) {
  bool *turns = must_calloc((size_t)v->rows, sizeof *turns);
  v->straight = must_calloc((size_t)v->rows, sizeof *v->straight);
  for (int k = 0; k < neighbours; k++)
    turns[(2 * v->rows - v->row_offset[k]) % v->rows] = true;
  turns[0] = true;
  for (int here = v->rows - 1, end = v->rows; here >= 0; here--) {
    v->straight[here] = end - here;
    if (turns[here]) end = here;
  }
  free(turns);
}

static void find_inner(const sweep *w, const family *f, const body_block *b, family_window *v) {
  const int lost = halo(f, f->march);
  v->inner = b->first == 0 ? 0 : b->first + lost;
  v->inner_end = b->last == w->lattice->row_count ? b->last : b->last - lost;
}

static void open_window(sweep *w, const family *f, const body_block *b, family_window *v) {
  const pl_law *law = w->law;
  const rows *g = w->lattice;
  find_inner(w, f, b, v);
  choose_runs(v, law, g->pitch);
  v->rows = v->at_a_time + most(rows_kept(f, f->march), rows_kept(f, &law->observe));
  open_planes(w, f, v);
  v->field = scratch_rows(w, law->fields, law->field_count, 0);
  v->observed = scratch_rows(w, law->outputs, law->output_count, 1);
  for (int k = 0; k < PL_LOSSES && w->lost_state; k++)
    v->lost[k] = body_doubles(w->body, g->pitch);
  v->offset = must_calloc((size_t)f->neighbours, sizeof *v->offset);
  v->row_offset = must_calloc((size_t)f->neighbours, sizeof *v->row_offset);
  v->left = must_calloc((size_t)(f->march->pass_count * v->rows), sizeof *v->left);
  for (int k = 0; k < f->neighbours; k++)
    v->row_offset[k] = (int)rint((double)g->offset[0][k] / (double)g->pitch);
  find_straight(v, f->neighbours);
}

family_window *family_windows(sweep *w, const family *f) {
  if (!suits(w, f)) return NULL;
  family_window *v = must_calloc((size_t)w->body->block_count, sizeof *v);
  for (int k = 0; k < w->body->block_count; k++)
    open_window(w, f, &w->body->blocks[k], &v[k]);
  return v;
}

void family_windows_free(const sweep *w, family_window *v) {
  for (int k = 0; v && k < w->body->block_count; k++) {
    free(v[k].field);
    free(v[k].observed);
    free(v[k].link);
    free(v[k].bond_link);
    free(v[k].offset);
    free(v[k].row_offset);
    free(v[k].left);
    free(v[k].straight);
  }
  free(v);
}

/* --- what stands where no run has come -------------------------------------------------------- */

/* The values of shared bit s. */
static double *shared_planes(const sweep *w, const family_window *v, int s) {
  return v->bond_link[s / 2] + (s % 2 ? family_of(w)->neighbours / 2 * v->plane : 0);
}

static void clear_sites(const sweep *w, const family_window *v, uint64_t shared, int here,
                        sites of) {
  const long first = here * w->lattice->pitch + of.begin;
  if (of.begin >= of.end) return;
  for (int s = 0; s < 64; s++)
    for (int k = 0; k < family_of(w)->neighbours / 2 && (shared >> s & 1); k++)
      memset(shared_planes(w, v, s) + k * v->plane + first, 0,
             (size_t)(of.end - of.begin) * sizeof(double));
}

/* Rows first .. last-1 take their places before a pass of a step does them: beside their sites what
   it leaves for both ends is 0. Rows below the body have no sites; observing shares nothing. */
static void take_places(const sweep *w, const pl_program *program, int pass, int block, int first,
                        int last) {
  const family_window *v = &family_of(w)->windows[block];
  const uint64_t shared =
      program != &w->law->observe && program->shared ? program->shared[pass] : 0;
  for (int row = first; row < last && shared; row++) {
    const int here = (row % v->rows + v->rows) % v->rows;
    sites *left = &v->left[pass * v->rows + here], was = *left;
    *left = row < 0 ? (sites){0, 0}
                    : (sites){w->body->begin[row], w->body->begin[row] + w->body->count[row]};
    clear_sites(w, v, shared, here, (sites){was.begin, shorter(was.end, left->begin)});
    clear_sites(w, v, shared, here, (sites){longer(was.begin, left->end), was.end});
  }
}

/* --- running ---------------------------------------------------------------------------------- */

static void point_at_links(const sweep *w, int block, int row, pl_family *run) {
  family_block *b = &family_of(w)->blocks[block];
  family_window *v = &family_of(w)->windows[block];
  const int here = row % v->rows;
  const long pitch = w->lattice->pitch, start = here * pitch + w->body->begin[row];
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
    b->new_field[k] = v->field[k] + w->body->begin[row];
  for (int k = 0; k <= w->law->output_count; k++)
    b->observed[k] = v->observed[k] + w->body->begin[row];
  for (int k = 0; k < PL_LOSSES && w->lost_state; k++)
    run->lost[k] = v->lost[k] + w->body->begin[row];
  run->new_plane = w->lattice->pitch;
}

static bool moves_at_once(const family_window *v, int row) {
  return row >= v->inner && row < v->inner_end;
}

static double *force_place(const sweep *w, const family_window *v, int row, int component) {
  return v->force[component] + (row % v->rows) * w->lattice->pitch + w->body->begin[row];
}

const double *family_window_force(const sweep *w, int block, int row, int component) {
  const family_window *v = &family_of(w)->windows[block];
  return w->body->forces || !moves_at_once(v, row) ? w->force[component] + body_start(w->body, row)
                                                   : force_place(w, v, row, component);
}

/* The end of the rows that a run may take from `row` on, step by step: as many as need no other
   links, fields or forces than the first, and whose neighbours stand alike. */
static int end_of_run(const sweep *w, int block, int row, int last) {
  const body_block *b = &w->body->blocks[block];
  const family_window *v = &family_of(w)->windows[block];
  const unsigned char *kind = w->lattice->row_class + w->lattice->margin;
  int next = row + v->step;
  if (v->step == 1 || row < b->first || row >= b->last) return next;
  const int edges[] = {b->last, v->inner, v->inner_end, row + v->straight[row % v->rows]};
  for (int k = 0; k < 4; k++)
    if (edges[k] > row) last = least(last, edges[k]);
  while (next < last && w->body->begin[next] == w->body->begin[row] &&
         w->body->count[next] == w->body->count[row] && kind[next] == kind[row])
    next += v->step;
  return next;
}

/* With `passing` forces are needed until the particles have moved. */
static void run_until(const sweep *w, pl_family_function pass, int block, int row, int end,
                      bool passing, pl_family *run) {
  const body_block *b = &w->body->blocks[block];
  const family_window *v = &family_of(w)->windows[block];
  family_run_row(w, block, row, run);
  run->rows = (end - row) / v->step;
  point_at_links(w, block, row, run);
  if (row < b->first || row >= b->last) write_nowhere(w, block, row, run);
  for (int d = 0; d < w->body->dof && passing && !w->body->forces && moves_at_once(v, row); d++)
    family_of(w)->blocks[block].force[d] = force_place(w, v, row, d);
  pass(w->law, family_of(w)->uniforms, run);
}

/* Rows first .. last-1. */
static void run_rows(const sweep *w, const pl_program *program, int pass, int block, int first,
                     int last, bool passing) {
  pl_family run;
  family_run_begin(w, program, block, &run);
  for (int of_kind = first; of_kind < first + family_of(w)->windows[block].step; of_kind++)
    for (int row = of_kind, end; row < last; row = end) {
      end = end_of_run(w, block, row, last);
      if (w->body->count[row] > 0)
        run_until(w, program->pass[pass], block, row, end, passing, &run);
    }
}

void family_window_inner(const sweep *w, int block, int *first, int *last) {
  *first = family_of(w)->windows[block].inner;
  *last = family_of(w)->windows[block].inner_end;
}

/* Where each pass begins and ends: where those after it need what it finds. */
static void find_spans(const sweep *w, const pl_program *program, int block, int *next, int *last) {
  const body_block *b = &w->body->blocks[block];
  const family *f = family_of(w);
  const int passes = program->pass_count, behind = rows_behind(f, program, passes - 1);
  for (int p = 0; p < passes; p++) {
    next[p] = most(b->first - rows_before(f, program, p), 0);
    last[p] = least(b->last + behind - rows_behind(f, program, p), w->lattice->row_count);
  }
}

void family_window_run(sweep *w, const pl_program *program, int block,
                       void (*move)(sweep *, int block, int first, int last)) {
  const family *f = family_of(w);
  const int passes = program->pass_count, at_a_time = f->windows[block].at_a_time;
  int next[FAMILY_MOST_PASSES], last[FAMILY_MOST_PASSES], moved, last_moved, end;
  find_spans(w, program, block, next, last);
  family_window_inner(w, block, &moved, &last_moved);
  for (int p = 0; p < passes; p++)
    take_places(w, program, p, block, next[p] - f->reach, next[p]);
  for (int ahead = next[0]; next[passes - 1] < last[passes - 1] || (move && moved < last_moved);) {
    ahead += at_a_time;
    for (int p = 0; p < passes; p++) {
      end = least(ahead - rows_behind(f, program, p), last[p]);
      if (end <= next[p]) continue;
      take_places(w, program, p, block, next[p], end);
      const double begun = family_run_pass_begins(w);
      run_rows(w, program, p, block, next[p], end, move != NULL);
      family_run_pass_ends(w, block, p, begun);
      next[p] = end;
    }
    end = least(ahead - rows_behind(f, program, passes - 1) - f->reach, last_moved);
    if (!move || end <= moved) continue;
    move(w, block, moved, end);
    moved = end;
  }
}
