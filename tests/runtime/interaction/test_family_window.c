/* Passes over a body in windows of rows, which follow each other closely, against passes over the
   whole body: the same bits, however many blocks there are and whatever else is kept. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/family_run.h"
#include "runtime/interaction/interaction.h"
#include "runtime/lattice/lattice.h"
#include "tests/runtime/family_law.h"
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

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(windows_and_whole_bodies_give_the_same_bits),
      cmocka_unit_test(the_first_bad_site_is_told_whatever_moves_first),
      cmocka_unit_test(a_window_keeps_the_rows_that_passes_need),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
