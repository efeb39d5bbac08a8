/* Passes in stages: each pass does each row once, after the pass before on all rows in reach, and
   the first stage does what needs no other block. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/family_stages.h"
#include "tests/runtime/interaction/pass_record.h"

static void open_disc(built_rows *b, const char *text) {
  build_rows(b, text);
  rows_set_density(b->rows, 2000);
}

static void check_once(const pass_record *r) {
  for (int p = 0; p < RECORD_PASSES; p++)
    for (int row = 0; row < record_count(r); row++)
      assert_int_equal(r->times[p][row], r->w->body->count[row] > 0);
}

/* Blocks of few rows, so that links of the whole body are kept. The blocks of a stage come in
   any order. */
static void each_row_is_done_once_after_all_in_reach(void **state) {
  (void)state;
  static const char *const discs[] = {DISC("", "0.3"), DISC("shells = 3 rotation = 12", "0.3"),
                                      DISC("horizon = 3.7", "0.3")};
  for (int d = 0; d < 3; d++) {
    built_rows b;
    open_disc(&b, discs[d]);
    for (int rows_a_block = 1; rows_a_block <= 4; rows_a_block++)
      for (int order = 0; order < 2; order++) {
        pass_record r = {0};
        const pl_law law = recording_law(&r);
        const int blocks = b.rows->row_count / rows_a_block;
        sweep *w = record_begin(&r, b.rows, &law, blocks, false);
        assert_true(w->engine.keeps_links);
        for (int stage = 0; stage < RECORD_PASSES; stage++)
          for (int k = 0; k < blocks; k++)
            family_stage(w, &w->law->step, stage, order ? blocks - 1 - k : k);
        check_once(&r);
        sweep_free(w);
      }
    built_end(&b);
  }
}

/* Rows of a block that pass p does in the first stage: p times the reach less at either end, but at
   the ends of the body. The record refuses what would need other blocks. */
static void the_first_stage_does_what_needs_no_other_block(void **state) {
  (void)state;
  enum { BLOCKS = 3 };
  built_rows b;
  open_disc(&b, DISC("horizon = 3.7", "0.75")); /* of too many neighbours for windows */
  for (int block = 0; block < BLOCKS; block++) {
    pass_record r = {0};
    const pl_law law = recording_law(&r);
    sweep *w = record_begin(&r, b.rows, &law, BLOCKS, false);
    assert_true(w->engine.keeps_links);
    const int reach = family_of(w)->reach;
    assert_int_equal(reach, 4); /* rows 0.866 spacings apart */
    family_stage(w, &w->law->step, 0, block);
    const body_block *own = &w->body->blocks[block];
    for (int p = 0; p < RECORD_PASSES; p++)
      for (int row = 0; row < record_count(&r); row++) {
        const int first = own->first > 0 ? own->first + p * reach : 0,
                  last = own->last < record_count(&r) ? own->last - p * reach : own->last;
        assert_int_equal(r.times[p][row], row >= first && row < last && w->body->count[row] > 0);
      }
    sweep_free(w);
  }
  built_end(&b);
}

/* What one pass leaves is in a cache yet when the next one comes: before the last pass does a row,
   the first one is at most two reaches and the rows at a time ahead. */
static void look_how_far_the_first_pass_is(pass_record *r, const pl_family *f, int pass, int row) {
  enum { AT_A_TIME = 16 };
  (void)f;
  if (pass < RECORD_PASSES - 1) return;
  for (int k = row + 2 * family_of(r->w)->reach + AT_A_TIME; k < record_count(r); k++)
    assert_int_equal(r->times[0][k], 0);
}

static void passes_follow_each_other_closely(void **state) {
  (void)state;
  built_rows b;
  open_disc(&b, DISC("horizon = 3.7", "0.75"));
  pass_record r = {.look = look_how_far_the_first_pass_is};
  const pl_law law = recording_law(&r);
  sweep *w = record_begin(&r, b.rows, &law, 1, false);
  assert_true(record_count(&r) > 160);
  family_stage(w, &w->law->step, 0, 0);
  check_once(&r);
  sweep_free(w);
  built_end(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_row_is_done_once_after_all_in_reach),
      cmocka_unit_test(the_first_stage_does_what_needs_no_other_block),
      cmocka_unit_test(passes_follow_each_other_closely),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
