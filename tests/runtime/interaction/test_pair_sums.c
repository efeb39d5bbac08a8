/* Sums that wait for particles ahead and marks of fields: whose rows they hold, what is
   forgotten, where fields are not 0. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/pair_sums.h"
#include "tests/runtime/small_run.h"

#define BLOCK                                                                                      \
  "&simulation end_time = 1e-5 step = 1e-7 threads = 3 /\n"                                        \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"                      \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.15 /\n"                     \
  "&material lattice = 'c' model = 'm' /\n&output frames = 0 /\n"

static void open_block(small_run *r, const pl_law *law) {
  small_open(r, law, BLOCK);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

/* Sums reach from the rows before a block, whose bonds reach it, to the rows that its own bonds
   reach. */
static void sums_hold_all_rows_that_bonds_reach(void **state) {
  (void)state;
  enum { REACH = 2 };
  pl_law law = elastic_bar;
  small_run r;
  open_block(&r, &law);
  law.sum_count = 3;
  sweep *w = simulation_state(r.simulation, 0);
  const rows *g = w->body->lattice;
  assert_int_equal(w->body->block_count, 3);
  for (int b = 0; b < w->body->block_count; b++) {
    const body_block *block = &w->body->blocks[b];
    pair_sums s = pair_sums_new(w, block, REACH);
    assert_int_equal(s.before, block->first > REACH ? block->first - REACH : 0);
    assert_int_equal(s.base, rows_start(g, s.before));
    assert_true(s.base + s.size <= g->size);
    assert_true(s.base + s.size >= rows_start(g, block->last - 1 + REACH) + g->pitch ||
                s.base + s.size == g->size);
    const long start = rows_start(g, block->first) + PL_LANES;
    double *const *at = pair_sums_at(w, &s, start);
    for (int k = 0; k < law.sum_count; k++) {
      assert_true(at[k] - s.sum[k] == start - s.base);
      for (long q = 0; q < s.size; q++) {
        assert_true(s.sum[k][q] == 0);
        s.sum[k][q] = 1;
      }
    }
    pair_sums_clear_ahead(w, &s); /* what is for particles of the next block goes */
    for (int k = 0; k < law.sum_count; k++)
      for (long q = 0; q < s.size; q++)
        assert_true(s.sum[k][q] == (s.base + q < rows_start(g, block->last)));
    pair_sums_free(&s);
  }
  small_close(&r);
}

static void marks_stand_where_fields_are_not_0(void **state) {
  (void)state;
  small_run r;
  open_block(&r, &elastic_bar);
  sweep *w = simulation_state(r.simulation, 0);
  const rows *g = w->body->lattice;
  const size_t before = w->body->bytes;
  uint64_t **marks = pair_marks_new(w);
  assert_true(w->body->bytes > before);
  const long slot = 5 * PL_LANES + 3;
  w->field[0][2 * g->size + slot] = 1e-300;
  w->field[0][0 * g->size + slot] = -0.0; /* not the bits of a 0 that nobody wrote */
  pair_marks_filled(w, w->field, marks);
  for (long q = 0; q + PL_LANES <= g->size; q += PL_LANES)
    assert_true(marks[0][q / PL_LANES] == (q == 5 * PL_LANES ? 5 : 0));
  pair_marks_settled(w, w->field, w->new_field, marks);
  const uint64_t all = (UINT64_C(1) << g->directions) - 1;
  for (long q = 0; q + PL_LANES <= g->size; q += PL_LANES)
    assert_true(marks[0][q / PL_LANES] == (q == 5 * PL_LANES ? all - 5 : all));
  pair_marks_free(w, marks);
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sums_hold_all_rows_that_bonds_reach),
      cmocka_unit_test(marks_stand_where_fields_are_not_0),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
