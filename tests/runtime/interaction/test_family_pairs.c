/* Bonds that add to both of their ends: the forces of a law that computes either end by itself, the
   same bits in any blocks, nothing left from pass to pass; what a pass is told. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>

#include "runtime/interaction/family_pairs.h"
#include "runtime/interaction/interaction.h"
#include "tests/runtime/built_rows.h"
#include "tests/runtime/spring_law.h"

#define CUBE                                                                                       \
  "&simulation end_time = 1 /\n&material lattice = 'c' model = 'm' /\n"                            \
  "&lattice name = 'c' kind = 'cubic' spacing = 0.01 shells = 2 /\n"                               \
  "&body lattice = 'c' shape = 'sphere' centre = 3*0 radius = 0.05 /\n"

/* --- springs by both ends --------------------------------------------------------------------- */

/* Each spring once, from its lower end; what its other end feels waits in the sums. */
static void springs_forces_by_both_ends(const pl_law *law, const double *uniforms,
                                        const pl_family *f) {
  (void)law;
  for (long q = 0; q < f->count; q++) {
    double force[3];
    for (int a = 0; a < 3; a++) {
      force[a] = f->sum[a][q];
      f->sum[a][q] = 0;
    }
    for (long k = 0; k < f->neighbours / 2; k++) {
      double one[3] = {0, 0, 0};
      spring_of(uniforms + k * SPRING_UNIFORMS, f, k, q, one);
      for (int a = 0; a < 3; a++) {
        force[a] += one[a];
        f->sum[a][q + f->offset[k]] -= one[a];
      }
    }
    for (int a = 0; a < 3 && !f->ahead_only; a++)
      f->force[a][q] = force[a];
  }
}

static const pl_family_function both_ends[] = {springs_forces_by_both_ends};

static pl_law springs_by_both_ends(void) {
  pl_law law = springs;
  law.sum_count = 3;
  law.step.pass = both_ends;
  return law;
}

static void open_cube(built_rows *b) {
  build_rows(b, CUBE);
  rows_set_density(b->rows, spring_parameters[SPRING_RHO].initial);
}

static sweep *shaken(const rows *g, const pl_law *law, int blocks) {
  double parameters[SPRING_PARAMETERS];
  for (int p = 0; p < SPRING_PARAMETERS; p++)
    parameters[p] = spring_parameters[p].initial;
  sweep *w = interaction_new(g, law, parameters, 1e-6, blocks, false, true);
  assert_int_equal(w->body->block_count, blocks);
  for (long q = 0; q < g->size; q++)
    for (int a = 0; a < 3 && g->present[q]; a++)
      w->body->displacement[a][q] =
          1e-3 * sin(100.0 * (a + 1) * (g->x[q] + 2 * g->y[q]) + 300 * g->z[q] + a);
  return w;
}

static void the_forces_are_those_of_either_end(void **state) {
  (void)state;
  built_rows b;
  open_cube(&b);
  const pl_law law = springs_by_both_ends();
  sweep *either = shaken(b.rows, &springs, 1), *both = shaken(b.rows, &law, 3);
  assert_null(family_of(either)->pairs);
  assert_non_null(family_of(both)->pairs);
  sweep_find_forces(either);
  sweep_find_forces(both);
  double largest = 0, off = 0, total[3] = {0, 0, 0};
  for (long p = 0; p < b.rows->particle_count; p++)
    for (int a = 0; a < 3; a++) {
      const long q = b.rows->particle_site[p];
      const double x = either->body->force[a][q], y = both->body->force[a][q];
      largest = fmax(largest, fabs(x));
      off = fmax(off, fabs(x - y));
      total[a] += y;
    }
  assert_true(largest > 1e3);
  assert_true(off < 1e-14 * 18 * largest);
  for (int a = 0; a < 3; a++) /* action and reaction */
    assert_true(fabs(total[a]) < 1e-12 * largest * (double)b.rows->particle_count);
  sweep_free(either);
  sweep_free(both);
  built_end(&b);
}

/* In any order of blocks, and again: no sum is left from the pass before. */
static void blocks_do_not_change_a_bit(void **state) {
  (void)state;
  enum { MOST_BLOCKS = 9 };
  built_rows b;
  open_cube(&b);
  const pl_law law = springs_by_both_ends();
  sweep *one = shaken(b.rows, &law, 1);
  family_pairs_stage(one, 0, 0);
  for (int blocks = 1; blocks <= MOST_BLOCKS; blocks++) {
    sweep *many = shaken(b.rows, &law, blocks);
    for (int again = 0; again < 3; again++) {
      for (int k = 0; k < blocks; k++)
        family_pairs_stage(many, 0, again == 1 ? blocks - 1 - k : k);
      for (long q = 0; q < b.rows->size; q++)
        for (int a = 0; a < 3 && b.rows->present[q]; a++) {
          assert_memory_equal(&one->body->force[a][q], &many->body->force[a][q], sizeof(double));
          many->body->force[a][q] = NAN;
        }
    }
    sweep_free(many);
  }
  sweep_free(one);
  built_end(&b);
}

/* --- what a pass is told ---------------------------------------------------------------------- */

typedef struct told { /* what the passes of a block should see, and saw */
  const sweep *w;
  int first; /* row of the block */
  int constants_known;
  int last_row, rows;
  uint64_t filled, settled; /* of the site `marked`, when it came */
  long marked;
  const uint64_t *old_marks;
  uint64_t *new_marks;
} told;

/* Of the rows first .. last-1. */
static bool some_held(const rows *g, int first, int last) {
  for (long q = rows_start(g, first); q < rows_start(g, last) && q < g->size; q++)
    if (g->held[q]) return true;
  return false;
}

static void listen(const pl_law *law, const double *uniforms, const pl_family *f) {
  told *t = (told *)law->context;
  const rows *g = t->w->body->lattice;
  const long start = f->bonds - g->bonds;
  const int row = rows_row(g, start), reach = family_of(t->w)->reach;
  (void)uniforms;
  assert_true(row > t->last_row); /* from lower to higher sites */
  t->last_row = row;
  t->rows++;
  assert_int_equal(f->ahead_only, row < t->first);
  assert_int_equal(f->held_near, some_held(g, row, row + reach + 1));
  assert_int_equal(f->constants_known, t->constants_known);
  for (long q = 0; q < f->count; q++) { /* written once, then kept from step to step */
    if (!f->constants_known) f->constant_sum[0][q] = (double)(start + q);
    assert_true(f->constant_sum[0][q] == (double)(start + q));
  }
  if (t->marked < start || t->marked >= start + f->count) return;
  t->old_marks = &f->old_filled[0][(t->marked - start) / PL_LANES];
  t->new_marks = &f->new_filled[0][(t->marked - start) / PL_LANES];
  t->filled = *t->old_marks;
  t->settled = f->settled[0][(t->marked - start) / PL_LANES];
}

static const pl_family_function listening[] = {listen};
static const pl_field broken_on_bonds[] = {
    {"omega", "1", "damage", 0, PL_FIELD_DAMAGE, PL_ON_NEIGHBOUR}};

/* Each block does its rows, and those before from which bonds reach them. */
static void run_blocks(sweep *w, told *t) {
  for (int k = 0; k < w->body->block_count; k++) {
    const body_block *b = &w->body->blocks[k];
    int expected = 0;
    for (int row = 0; row < b->last; row++)
      expected += row >= b->first - family_of(w)->reach && w->body->count[row] > 0;
    t->first = b->first;
    t->last_row = -1;
    t->rows = 0;
    family_pairs_stage(w, 0, k);
    assert_int_equal(t->rows, expected);
  }
}

static pl_law listening_law(const told *t) {
  pl_law law = springs_by_both_ends();
  law.step.pass = listening;
  law.field_count = 1;
  law.fields = broken_on_bonds;
  law.constant_sum_count = 1;
  law.context = t;
  return law;
}

static void a_pass_is_told_where_it_is(void **state) {
  (void)state;
  built_rows b;
  open_cube(&b);
  told t = {.marked = -1};
  const pl_law law = listening_law(&t);
  b.rows->held[b.rows->particle_site[b.rows->particle_count / 2]] = 1;
  for (int blocks = 1; blocks <= 4; blocks++) {
    sweep *w = shaken(b.rows, &law, blocks);
    t = (told){.w = w, .marked = -1};
    run_blocks(w, &t);
    family_pairs_turn(family_of(w)->pairs);
    t.constants_known = 1;
    run_blocks(w, &t);
    sweep_free(w);
  }
  built_end(&b);
}

/* Bond 1 of a particle is damaged from outside: its marks say so, and that old and new values
   differ there; with the fields their marks change places. */
static void marks_go_with_their_fields(void **state) {
  (void)state;
  built_rows b;
  open_cube(&b);
  told t;
  const pl_law law = listening_law(&t);
  sweep *w = shaken(b.rows, &law, 1);
  const rows *g = b.rows;
  const uint64_t all = (UINT64_C(1) << g->directions) - 1;
  t = (told){.w = w, .marked = g->particle_site[g->particle_count / 2]};
  run_blocks(w, &t);
  assert_true(t.filled == 0 && t.settled == all);
  w->field[0][1 * g->size + t.marked] = 0.5;
  sweep_fields_set(w);
  run_blocks(w, &t);
  assert_true(t.filled == 2 && t.settled == all - 2);
  const uint64_t *old = t.old_marks, *new = t.new_marks;
  assert_ptr_not_equal(old, new);
  family_pairs_turn(family_of(w)->pairs);
  t.constants_known = 1;
  run_blocks(w, &t);
  assert_ptr_equal(t.old_marks, new);
  assert_ptr_equal(t.new_marks, old);
  assert_true(t.filled == 0);
  sweep_free(w);
  built_end(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_forces_are_those_of_either_end),
      cmocka_unit_test(blocks_do_not_change_a_bit),
      cmocka_unit_test(a_pass_is_told_where_it_is),
      cmocka_unit_test(marks_go_with_their_fields),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
