/* Passes over a body in windows of rows, which follow each other closely, against passes over the
   whole body: the same bits, however many blocks there are and whatever else is kept. Which rows
   the passes of a block do, and when its particles may move. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/family_run.h"
#include "runtime/interaction/family_window.h"
#include "runtime/interaction/interaction.h"
#include "runtime/filling/lattice.h"
#include "tests/runtime/family_law.h"
#include "tests/runtime/interaction/pass_record.h"
#include "tests/runtime/small_run.h"

enum { STEPS = 60 };

static const char plate[] =
    "&simulation end_time = 1 /\n"
    "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = 7 /\n"
    "&material lattice = 'c' model = 'm' S_t = 1e-4 tau = 1e-7 /\n"
    "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.2, 0.5 /\n"
    "&notch lattice = 'c' shape = 'segment' from = 0.05, 0.2 to = 0.11, 0.24 /\n";

/* Particles in a motion that stretches and breaks. */
static sweep *moving_plate(const pl_law *law, const small_run *r, const rows *g, int blocks,
                           bool ledger, bool forces) {
  sweep *w = interaction_new(g, law, r->parameters, 2e-7, blocks, ledger, forces);
  for (long q = 0; q < g->size; q++) {
    if (!g->present[q]) continue;
    w->body->velocity[0][q] = 3 * sin(40 * g->y[q]) + 20 * g->x[q];
    w->body->velocity[1][q] = 2 * cos(31 * g->x[q] + 11 * g->y[q]);
  }
  for (int k = 0; k < STEPS; k++)
    assert_true(sweep_step(w));
  return w;
}

static void assert_same_values(const rows *g, const double *a, const double *b) {
  for (long q = 0; q < g->size; q++)
    if (g->present[q]) assert_memory_equal(&a[q], &b[q], sizeof *a);
}

static void assert_same_state(const sweep *a, const sweep *b) {
  const rows *g = a->body->lattice;
  for (int d = 0; d < a->body->dof; d++) {
    assert_same_values(g, a->body->displacement[d], b->body->displacement[d]);
    assert_same_values(g, a->body->velocity[d], b->body->velocity[d]);
  }
  for (int f = 0; f < a->law->field_count; f++)
    for (int k = 0; k < sweep_planes(a, a->law->fields[f].place); k++)
      assert_same_values(g, a->field[f] + k * g->size, b->field[f] + k * g->size);
}

static long count_broken(const sweep *w) {
  long count = 0;
  for (long q = 0; q < w->body->lattice->size; q++)
    count += w->body->lattice->present[q] && w->field[0][q] > 0;
  return count;
}

static void windows_and_whole_bodies_give_the_same_bits(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &family_hexagon, plate);
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  rows *g = lattice_build(r.deck, 0, &r.said);
  assert_non_null(g);
  g->mass = simulation_rows(r.simulation, 0)->mass;
  const int many = g->row_count / 2; /* of two rows: too few for windows */
  sweep *whole = moving_plate(&family_hexagon, &r, g, many, false, false);
  pl_law six = family_hexagon; /* whose passes take several rows a call */
  six.neighbours = 6;
  assert_null(family_of(whole)->windows);
  assert_true(count_broken(whole) > 20);
  for (int blocks = 1; blocks <= 3; blocks++)
    for (int kept = 0; kept < 6; kept++) {
      sweep *w = moving_plate(kept < 3 ? &family_hexagon : &six, &r, g, blocks, kept % 3 == 2,
                              kept % 3 == 1);
      assert_non_null(family_of(w)->windows);
      assert_same_state(whole, w);
      sweep_observe(w);
      sweep_observe(whole);
      assert_same_state(whole, w);
      for (int d = 0; d < w->body->dof; d++)
        assert_same_values(g, whole->body->force[d], w->body->force[d]);
      const body_totals a = body_sum(whole->body), b = body_sum(w->body);
      assert_memory_equal(&a.stored, &b.stored, sizeof a.stored);
      sweep_free(w);
    }
  sweep_free(whole);
  rows_free(g);
  small_close(&r);
}

/* Rows in the middle of a block move before those at its ends. */
static void the_first_bad_site_is_told_whatever_moves_first(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &family_hexagon, plate);
  assert_non_null(r.simulation);
  rows *g = lattice_build(r.deck, 0, &r.said);
  assert_non_null(g);
  g->mass = simulation_rows(r.simulation, 0)->mass;
  for (int blocks = 1; blocks <= 2; blocks++) {
    sweep *w = interaction_new(g, &family_hexagon, r.parameters, 2e-7, blocks, false, false);
    const int row = g->row_count / 2 + 1; /* of two blocks the second row of the second one */
    long first = rows_start(g, row), later = rows_start(g, row + 9);
    while (!g->present[first])
      first++;
    while (!g->present[later])
      later++;
    w->body->velocity[0][first] = w->body->velocity[1][later] = NAN;
    assert_false(sweep_step(w));
    const body_block *b = &w->body->blocks[body_bad(w->body)];
    assert_int_equal(rows_row(g, b->bad_site), row - 1); /* by the dampers of its bonds */
    sweep_free(w);
  }
  rows_free(g);
  small_close(&r);
}

/* Where a law says that its second pass needs no rows ahead, fewer rows are kept. */
static void a_window_keeps_the_rows_that_passes_need(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &family_hexagon, plate);
  assert_non_null(r.simulation);
  rows *g = lattice_build(r.deck, 0, &r.said);
  pl_law near = family_hexagon;
  near.step.at_hand = 1u << 1;
  sweep *far = interaction_new(g, &family_hexagon, r.parameters, 2e-7, 1, false, false),
        *here = interaction_new(g, &near, r.parameters, 2e-7, 1, false, false);
  assert_true(here->body->bytes < far->body->bytes);
  sweep_free(far);
  sweep_free(here);
  rows_free(g);
  small_close(&r);
}

/* A law whose passes may take rows that are alike in one call, or may not; a body in up to three
   blocks. */
typedef struct window_case {
  const char *deck;
  int neighbours; /* of the law */
} window_case;

static const window_case window_cases[] = {{DISC("", "0.3"), 0},
                                           {DISC("", "0.3"), 6},
                                           {DISC("rotation = 12", "0.3"), 6},
                                           {DISC("shells = 3", "0.4"), 18}};
enum { WINDOW_CASES = sizeof window_cases / sizeof *window_cases, MOST_BLOCKS = 3 };

typedef struct window_record { /* of one block */
  pass_record rows;
  int moved; /* rows below this one have moved, from the first that may on; -1: none */
} window_record;

/* A row that has moved is not read any more: passes stay out of its reach. */
static void look_for_moved_rows(pass_record *r, const pl_family *f, int pass, int row) {
  const window_record *v = (const window_record *)r;
  (void)f;
  if (v->moved > 0 && row - family_of(r->w)->reach < v->moved)
    fail_msg("pass %d on row %d reads row %d, which has moved", pass, row,
             row - family_of(r->w)->reach);
}

static void note_move(sweep *w, int block, int first, int last) {
  window_record *v = (window_record *)w->law->context;
  int inner, inner_end;
  family_window_inner(w, block, &inner, &inner_end);
  assert_int_equal(first, v->moved < 0 ? inner : v->moved);
  assert_true(first < last && last <= inner_end);
  v->moved = last;
}

/* Pass p of a block does its rows and those of its neighbours that the passes after it need, each
   once: a reach further for each of them. The last one does the block's own. */
static void check_rows(const window_record *v, int block) {
  const pass_record *r = &v->rows;
  const body_block *b = &r->w->body->blocks[block];
  for (int p = 0; p < RECORD_PASSES; p++)
    for (int row = 0; row < record_count(r); row++) {
      const int more = (RECORD_PASSES - 1 - p) * family_of(r->w)->reach;
      const bool needed = row >= b->first - more && row < b->last + more;
      assert_int_equal(r->times[p][row], needed && r->w->body->count[row] > 0);
    }
}

/* No other block reads the rows that move while it may be at work. */
static void check_moves(const window_record v[], int blocks, int block) {
  const sweep *w = v[block].rows.w;
  int first, last;
  family_window_inner(w, block, &first, &last);
  assert_true(first < last);
  assert_int_equal(v[block].moved, last);
  for (int other = 0; other < blocks; other++)
    for (int row = 0; row < w->body->lattice->row_count && other != block; row++) {
      const bool is_done = v[other].rows.times[0][row] > 0;
      const int reach = family_of(w)->reach;
      if (is_done && row + reach >= first && row - reach < last)
        fail_msg("block %d reads rows about %d, which block %d moves", other, row, block);
    }
}

static void passes_do_what_a_block_needs_and_rows_move_behind_them(void **state) {
  (void)state;
  for (int c = 0; c < WINDOW_CASES; c++)
    for (int blocks = 1; blocks <= MOST_BLOCKS; blocks++) {
      window_record v[MOST_BLOCKS];
      sweep *of_block[MOST_BLOCKS];
      pl_law laws[MOST_BLOCKS];
      built_rows b;
      build_rows(&b, window_cases[c].deck);
      rows_set_density(b.rows, 2000);
      for (int k = 0; k < blocks; k++) {
        v[k] = (window_record){.rows.look = look_for_moved_rows, .moved = -1};
        laws[k] = recording_law(&v[k].rows);
        laws[k].neighbours = window_cases[c].neighbours;
        of_block[k] = record_begin(&v[k].rows, b.rows, &laws[k], blocks, false);
        assert_non_null(family_of(of_block[k])->windows);
        family_window_run(of_block[k], &laws[k].step, k, note_move);
        check_rows(&v[k], k);
      }
      for (int k = 0; k < blocks; k++)
        check_moves(v, blocks, k);
      for (int k = 0; k < blocks; k++)
        sweep_free(of_block[k]);
      built_end(&b);
    }
}

/* Forces of rows that move at once stand in the window; of others, and of all where somebody looks
   at them, with the body. */
static void forces_are_kept_until_rows_move(void **state) {
  (void)state;
  built_rows b;
  build_rows(&b, window_cases[0].deck);
  rows_set_density(b.rows, 2000);
  for (int kept = 0; kept < 2; kept++) {
    pass_record r = {0};
    const pl_law law = recording_law(&r);
    sweep *w = record_begin(&r, b.rows, &law, 2, kept);
    int first, last;
    for (int block = 0; block < 2; block++) {
      family_window_inner(w, block, &first, &last);
      for (int row = w->body->blocks[block].first; row < w->body->blocks[block].last; row++)
        for (int a = 0; a < 2; a++) {
          const double *force = family_window_force(w, block, row, a);
          const bool of_body = force == w->body->force[a] + body_start(w->body, row);
          assert_true(of_body == (kept || row < first || row >= last));
          assert_ptr_not_equal(force, family_window_force(w, block, row, 1 - a));
        }
    }
    sweep_free(w);
  }
  built_end(&b);
}

/* Where blocks are too narrow, neighbours too many, or anywhere, there are no windows. */
static void windows_are_for_wide_blocks_of_near_neighbours(void **state) {
  (void)state;
  static const struct {
    const char *deck;
    int blocks;
    bool suits;
  } cases[] = {{DISC("", "0.3"), 4, true},
               {DISC("", "0.3"), 6, false}, /* 11 rows; the halo is of 3 */
               {DISC("horizon = 3.1", "0.3"), 1, true},
               {DISC("horizon = 3.7", "0.3"), 1, false}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    built_rows b;
    build_rows(&b, cases[k].deck);
    rows_set_density(b.rows, 2000);
    pass_record r = {0};
    const pl_law law = recording_law(&r);
    sweep *w = record_begin(&r, b.rows, &law, cases[k].blocks, false);
    family_window *v = family_windows(w, family_of(w));
    if ((v != NULL) != cases[k].suits) fail_msg("case %zu", k);
    family_windows_free(w, v);
    sweep_free(w);
    built_end(&b);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(windows_and_whole_bodies_give_the_same_bits),
      cmocka_unit_test(the_first_bad_site_is_told_whatever_moves_first),
      cmocka_unit_test(a_window_keeps_the_rows_that_passes_need),
      cmocka_unit_test(passes_do_what_a_block_needs_and_rows_move_behind_them),
      cmocka_unit_test(forces_are_kept_until_rows_move),
      cmocka_unit_test(windows_are_for_wide_blocks_of_near_neighbours),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
