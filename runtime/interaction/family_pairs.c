#include "runtime/interaction/family_pairs.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/interaction/pair_sums.h"

typedef struct pairs_block { /* pointers to the run at hand, and sums of the block's own */
  const uint64_t **old_filled;
  uint64_t **new_filled, **settled;
  double **constant_sum;
  pair_sums sums;
} pairs_block;

struct family_pairs {
  unsigned char *held_near;                       /* [row_count] pl_family */
  uint64_t **old_filled, **new_filled, **settled; /* [fields] */
  double **constant_sum;                          /* [constant_sum_count][size] */
  bool constants_known;                           /* after a step */
  uint64_t *unusual;                              /* [size/PL_LANES] */
  pairs_block *blocks;                            /* [block_count] */
};

/* --- a pass ----------------------------------------------------------------------------------- */

static void point_at_marks(const sweep *w, const family_pairs *p, pairs_block *b, long start,
                           pl_family *run) {
  for (int k = 0; k < w->law->field_count; k++) {
    if (!p->old_filled[k]) continue;
    b->old_filled[k] = p->old_filled[k] + start / PL_LANES;
    b->new_filled[k] = p->new_filled[k] + start / PL_LANES;
    b->settled[k] = p->settled[k] + start / PL_LANES;
  }
  run->old_filled = b->old_filled;
  run->new_filled = b->new_filled;
  run->settled = b->settled;
}

static void point_at_constants(const sweep *w, const family_pairs *p, pairs_block *b, long start,
                               pl_family *run) {
  for (int k = 0; k < w->law->constant_sum_count; k++)
    b->constant_sum[k] = p->constant_sum[k] + start;
  run->constant_sum = b->constant_sum;
  run->constants_known = p->constants_known;
  run->unusual = p->unusual + start / PL_LANES;
}

static void run_row(const sweep *w, int pass, int block, int row, bool ahead_only, pl_family *run) {
  const family *f = family_of(w);
  pairs_block *b = &f->pairs->blocks[block];
  const long start = body_start(w->body, row);
  if (w->body->count[row] == 0) return;
  family_run_row_with_links(w, block, row, run);
  point_at_marks(w, f->pairs, b, start, run);
  point_at_constants(w, f->pairs, b, start, run);
  run->sum = pair_sums_at(w, &b->sums, start);
  run->ahead_only = ahead_only;
  run->held_near = f->pairs->held_near[row];
  f->march->pass[pass](w->law, f->uniforms, run);
}

/* Bonds of the rows before reach the block's own: they are done once more here, for these ends
   only, so that sums have the same terms in the same order whatever the blocks. */
void family_pairs_stage(const sweep *w, int pass, int block) {
  const body_block *b = &w->body->blocks[block];
  pair_sums *s = &family_of(w)->pairs->blocks[block].sums;
  const double begun = family_run_pass_begins(w);
  pl_family run;
  family_run_begin(w, family_of(w)->march, block, &run);
  for (int row = s->before; row < b->last; row++)
    run_row(w, pass, block, row, row < b->first, &run);
  pair_sums_clear_ahead(w, s);
  family_run_pass_ends(w, block, pass, begun);
}

void family_pairs_turn(family_pairs *p) {
  uint64_t **filled = p->old_filled;
  p->old_filled = p->new_filled;
  p->new_filled = filled;
  p->constants_known = true;
}

static void find_marks(const sweep *w, family_pairs *p) {
  pair_marks_filled(w, w->field, p->old_filled);
  pair_marks_filled(w, w->new_field, p->new_filled);
  pair_marks_settled(w, w->field, w->new_field, p->settled);
}

void family_pairs_fields_set(const sweep *w) {
  find_marks(w, family_of(w)->pairs);
}

/* --- set-up ----------------------------------------------------------------------------------- */

/* Rows from which bonds reach a held particle, or that have one. */
static unsigned char *rows_near_held(const sweep *w, int reach) {
  const rows *g = w->lattice;
  unsigned char *near = must_calloc((size_t)g->row_count + 1, sizeof *near);
  for (int row = 0; row < g->row_count; row++) {
    const int first = row > reach ? row - reach : 0;
    bool held = false;
    for (long q = body_start(w->body, row); q < body_start(w->body, row) + w->body->count[row]; q++)
      held = held || g->held[q];
    if (held) memset(near + first, 1, (size_t)(row - first) + 1);
  }
  return near;
}

family_pairs *family_pairs_new(sweep *w, const family *f) {
  const size_t fields = (size_t)w->law->field_count + 1;
  if (w->law->sum_count == 0) return NULL;
  family_pairs *p = must_calloc(1, sizeof *p);
  p->held_near = rows_near_held(w, f->reach);
  p->old_filled = pair_marks_new(w);
  p->new_filled = pair_marks_new(w);
  p->settled = pair_marks_new(w);
  p->unusual = must_calloc((size_t)(w->lattice->size / PL_LANES) + 1, sizeof *p->unusual);
  p->constant_sum = must_calloc((size_t)w->law->constant_sum_count + 1, sizeof *p->constant_sum);
  for (int k = 0; k < w->law->constant_sum_count; k++)
    p->constant_sum[k] = body_doubles(w->body, w->lattice->size);
  p->blocks = must_calloc((size_t)w->body->block_count, sizeof *p->blocks);
  for (int k = 0; k < w->body->block_count; k++) {
    pairs_block *b = &p->blocks[k];
    b->old_filled = must_calloc(fields, sizeof *b->old_filled);
    b->new_filled = must_calloc(fields, sizeof *b->new_filled);
    b->settled = must_calloc(fields, sizeof *b->settled);
    b->constant_sum = must_calloc((size_t)w->law->constant_sum_count + 1, sizeof *b->constant_sum);
    b->sums = pair_sums_new(w, &w->body->blocks[k], f->reach);
  }
  find_marks(w, p);
  return p;
}

void family_pairs_free(const sweep *w, family_pairs *p) {
  if (!p) return;
  for (int k = 0; k < w->body->block_count; k++) {
    free(p->blocks[k].old_filled);
    free(p->blocks[k].new_filled);
    free(p->blocks[k].settled);
    free(p->blocks[k].constant_sum);
    pair_sums_free(&p->blocks[k].sums);
  }
  pair_marks_free(w, p->old_filled);
  pair_marks_free(w, p->new_filled);
  pair_marks_free(w, p->settled);
  free(p->constant_sum);
  free(p->unusual);
  free(p->held_near);
  free(p->blocks);
  free(p);
}
