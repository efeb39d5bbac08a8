#include "runtime/interaction/family_stages.h"

#include <stdlib.h>

/* The row after the last that goes on in memory as this one begins, with neighbours at the same
   offsets: together they are one long row, with absent sites in between. */
static int end_of_alike(const sweep *w, int row, int last) {
  const unsigned char *kind = w->lattice->row_class + w->lattice->margin;
  int end = row + 1;
  if (w->lattice->list && w->lattice->list->way) return end;
  while (end < last && w->body->count[row] > 0 && w->body->count[end] > 0 && kind[end] == kind[row])
    end++;
  return end;
}

/* Rows first .. last-1. */
static void run_rows(const sweep *w, const pl_program *program, int pass, int block, int first,
                     int last) {
  pl_family run;
  family_run_begin(w, program, block, &run);
  for (int row = first, end; row < last; row = end) {
    end = end_of_alike(w, row, last);
    if (w->body->count[row] == 0) continue;
    family_run_row_with_links(w, block, row, &run);
    run.count = body_start(w->body, end - 1) + w->body->count[end - 1] - body_start(w->body, row);
    program->pass[pass](w->law, family_of(w)->uniforms, &run);
  }
}

/* Rows of a block that a pass can do without what other blocks do at the same time: a pass needs
   the pass before on all rows in reach, so each loses as many at either end, but at the ends of the
   body. */
static void inner_rows(const sweep *w, int block, int pass, int *first, int *last) {
  const body_block *b = &w->body->blocks[block];
  const int lost = pass * family_of(w)->reach;
  *first = b->first == 0 ? 0 : b->first + lost;
  *last = b->last == w->lattice->row_count ? b->last : b->last - lost;
  if (*last < *first) *last = *first = b->last;
}

/* All passes on the inner rows, some rows at a time, each pass as soon as the one before is far
   enough ahead: what one leaves the next finds in a cache. */
static void run_inner(const sweep *w, const pl_program *program, int block) {
  enum { ROWS_AT_A_TIME = 16 };
  enum { FARTHEST = 100 }; /* rows between passes that a cache may still hold */
  const int at_a_time = family_of(w)->reach > FARTHEST ? w->lattice->row_count : ROWS_AT_A_TIME;
  int next[FAMILY_MOST_PASSES], last[FAMILY_MOST_PASSES];
  const int passes = program->pass_count;
  for (int p = 0; p < passes; p++)
    inner_rows(w, block, p, &next[p], &last[p]);
  while (next[0] < last[0]) { /* when the first is done, all follow */
    int end = least(next[0] + at_a_time, last[0]);
    for (int p = 0; p < passes; p++) {
      const double begun = family_run_pass_begins(w);
      run_rows(w, program, p, block, next[p], end);
      family_run_pass_ends(w, block, p, begun);
      next[p] = end > next[p] ? end : next[p];
      if (p + 1 < passes) end = next[p] == last[p] ? last[p + 1] : next[p] - family_of(w)->reach;
    }
  }
}

/* A pass on the rows that the inner rows leave. */
static void run_outer(const sweep *w, const pl_program *program, int pass, int block) {
  const body_block *b = &w->body->blocks[block];
  int first, last;
  inner_rows(w, block, pass, &first, &last);
  const double begun = family_run_pass_begins(w);
  run_rows(w, program, pass, block, b->first, first);
  run_rows(w, program, pass, block, last, b->last);
  family_run_pass_ends(w, block, pass, begun);
}

void family_stage(const sweep *w, const pl_program *program, int stage, int block) {
  if (stage == 0)
    run_inner(w, program, block);
  else
    run_outer(w, program, stage, block);
}
