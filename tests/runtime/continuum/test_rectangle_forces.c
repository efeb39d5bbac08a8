/* Rows of rectangles from nodes to nodes beside the same law point by point: forces, states and
   energies have the same bits, however rows are shared out and whatever else there is. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "dsl/base/arena.h"
#include "rectangle_law.h"
#include "runtime/base/random_number.h"
#include "runtime/continuum/point_forces.h"

enum { STEPS = 4, BLOCKS = 5 };

static const double values[] = {30e9, 0.2, 2400, 1e-3, 1e-6};

/* A mesh of elements of 2 x 2 points and how its nodes move. */
typedef struct plate {
  mesh m;
  integration_points points;
  node_layout layout;
  pool *memory;
  double *u[2], *v[2];
  unsigned char *own; /* cells of the law; NULL: all */
} plate;

static void plate_open(plate *p, int nx, int ny) {
  *p = (plate){.memory = pool_new()};
  mesh_open(&p->m, (int[2]){nx, ny}, (double[2]){0.3, -0.1},
            (double[2]){0.01 * (nx - 1), 0.02 * (ny - 1)}, 0.02, 1.5);
  memset(p->m.element_free, 0, (size_t)mesh_node_count(&p->m));
  memset(p->m.element_gauss, 2, (size_t)mesh_cell_count(&p->m));
  mesh_settle(&p->m);
  integration_points_open(&p->points, &p->m);
  p->layout = node_layout_of(p->m.nodes, p->m.support);
  for (int d = 0; d < 2; d++) {
    p->u[d] = pool_doubles(p->memory, p->layout.size);
    p->v[d] = pool_doubles(p->memory, p->layout.size);
    for (long q = 0; q < p->layout.size; q++)
      p->u[d][q] = p->v[d][q] = NAN; /* where no node is */
  }
}

static void plate_close(plate *p) {
  integration_points_close(&p->points);
  mesh_close(&p->m);
  pool_free(p->memory);
  free(p->own);
}

static void plate_move(plate *p, int step) {
  for (int n = 0; n < mesh_node_count(&p->m); n++)
    for (int d = 0; d < 2; d++) {
      const long at = node_layout_at(&p->layout, n);
      const uint64_t drawn = random_mix((uint64_t)(2 * n + d) + ((uint64_t)step << 40));
      p->u[d][at] = 1e-5 * step * (random_unit(drawn) - 0.5);
      p->v[d][at] = random_unit(random_mix(drawn)) - 0.5;
    }
}

/* How the forces are found. */
typedef struct way {
  int blocks;
  bool loops; /* over rectangles */
  bool alone; /* planes of the forces are known when they are found */
} way;

/* Forces of all steps, and of the state observed; states and energies. */
typedef struct found {
  point_forces *of;
  double *force[STEPS][2], *seen[2];
} found;

/* Blocks one after the other from the last on: none may wait for another. What nodes had before
   counts for nothing. */
static void find(const plate *p, point_forces *of, const way *w, int step, bool seen,
                 double *const force[2]) {
  const double *const u[] = {p->u[0], p->u[1]}, *const v[] = {p->v[0], p->v[1]};
  const point_motion at = {u, v, step, 1e-6, 0};
  const int rows = p->m.nodes[1];
  for (int n = 0; n < mesh_node_count(&p->m); n++)
    for (int d = 0; d < 2; d++)
      force[d][node_layout_at(&p->layout, n)] = 1e200;
  for (int b = w->blocks - 1; b >= 0; b--)
    point_forces_find(of, b, b * rows / w->blocks, (b + 1) * rows / w->blocks, &at, seen,
                      w->alone ? force : NULL);
  for (int row = 0; row < rows; row++)
    point_forces_take(of, row, false, force);
}

/* Half of the way it is observed. */
static found go(plate *p, const way *w, bool ledger) {
  static pl_law laws[2];
  laws[0] = softening_law;
  laws[1] = rectangle_law();
  found out = {.of = point_forces_new(&p->m, p->own, &p->points, &laws[w->loops], values, w->blocks,
                                      ledger)};
  for (int d = 0; d < 2; d++)
    out.seen[d] = pool_doubles(p->memory, p->layout.size);
  for (int step = 0; step < STEPS; step++) {
    for (int d = 0; d < 2; d++)
      out.force[step][d] = pool_doubles(p->memory, p->layout.size);
    plate_move(p, step + 1);
    find(p, out.of, w, step, false, out.force[step]);
    point_forces_turn(out.of, step);
    if (step == STEPS / 2) find(p, out.of, w, step, true, out.seen);
  }
  return out;
}

static void same_bits(const double *a, const double *b, long count, const char *what) {
  for (long k = 0; k < count; k++)
    if (memcmp(&a[k], &b[k], sizeof *a) != 0)
      fail_msg("%s %ld: %.17g, not %.17g", what, k, a[k], b[k]);
}

/* Of points that are there. */
static void same_planes(const point_forces *a, const double *x, const double *y, int planes,
                        const char *what) {
  const long count = a->strips.count;
  for (int k = 0; k < planes; k++)
    for (long q = 0; q < count; q++)
      if (a->strips.volume[q] > 0) same_bits(x + k * count + q, y + k * count + q, 1, what);
}

static void same_states(const point_forces *a, const point_forces *b) {
  same_planes(a, a->old_field, b->old_field, SOFT_FIELDS, "state");
  if (a->loses) same_planes(a, a->lost, b->lost, PL_LOSSES, "loss");
  same_planes(a, a->observed, b->observed, 2, "what is observed");
}

/* Sums of rows go strip by strip, and these are of different lengths. */
static void near_rows(const point_forces *a, const point_forces *b) {
  for (int row = 0; row < a->strips.rows; row++) {
    const point_row *x = &a->rows[row], *y = &b->rows[row];
    assert_true(fabs(x->stored - y->stored) <= 1e-13 * fabs(y->stored));
    assert_true(fabs(x->state - y->state) <= 1e-10 * fabs(y->state));
    assert_true(x->stiffness == y->stiffness);
  }
}

static void all_ways_agree(plate *p) {
  const way points = {1, false, false};
  for (int ledger = 0; ledger < 2; ledger++) {
    const found right = go(p, &points, ledger);
    for (int blocks = 1; blocks <= BLOCKS; blocks++)
      for (int alone = 0; alone < 2; alone++) {
        const found here = go(p, &(way){blocks, true, alone}, ledger);
        for (int step = 0; step < STEPS; step++)
          for (int d = 0; d < 2; d++)
            same_bits(here.force[step][d], right.force[step][d], p->layout.size, "force");
        for (int d = 0; d < 2; d++)
          same_bits(here.seen[d], right.seen[d], p->layout.size, "force that is observed");
        same_states(here.of, right.of);
        near_rows(here.of, right.of);
        point_forces_free(here.of);
      }
    point_forces_free(right.of);
  }
}

/* Widths around those of vectors and of long strips; fewer rows than blocks. */
static void rows_are_summed(void **state) {
  (void)state;
  static const int cases[][2] = {{22, 14}, {9, 7}, {6, 3}, {2, 2}, {18, 9}, {1043, 4}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    plate p;
    plate_open(&p, cases[k][0], cases[k][1]);
    all_ways_agree(&p);
    plate_close(&p);
  }
}

/* Rows with cells of other laws, and rows without any of this one, between rows that are whole. */
static void rows_are_of_other_laws_too(void **state) {
  (void)state;
  plate p;
  plate_open(&p, 22, 14);
  p.own = must_calloc((size_t)mesh_cell_count(&p.m), 1);
  for (int c = 0; c < mesh_cell_count(&p.m); c++) {
    const int i = c % 21, j = c / 21;
    p.own[c] = j != 5 && j != 9 && !(j == 2 && i > 8 && i < 12) && !(j == 7 && i < 3);
  }
  all_ways_agree(&p);
  plate_close(&p);
}

/* An element of one point in a row. */
static void rows_are_no_rectangles_too(void **state) {
  (void)state;
  plate p;
  plate_open(&p, 22, 14);
  integration_points_close(&p.points);
  p.m.element_gauss[21 * 12] = 1;
  mesh_settle(&p.m);
  integration_points_open(&p.points, &p.m);
  all_ways_agree(&p);
  plate_close(&p);
}

/* Lanes that fill vectors up are strained by what stands beside the edge, here by no numbers: in a
   look they are as made. */
static void what_fills_up_is_forgotten(void **state) {
  (void)state;
  plate p;
  plate_open(&p, 22, 6);
  const way w = {2, true, true};
  const found here = go(&p, &w, true);
  find(&p, here.of, &w, STEPS, true, here.seen);
  long filling = 0, moved = 0;
  for (long k = 0; k < here.of->strips.count; k++) {
    const bool fills = !(here.of->strips.volume[k] > 0);
    filling += fills;
    moved += !fills && here.of->old_field[k] > softening_fields[SOFT_KAPPA].initial;
    for (int f = 0; f < SOFT_FIELDS && fills; f++)
      assert_true(here.of->old_field[f * (long)here.of->strips.count + k] ==
                  softening_fields[f].initial);
    for (int loss = 0; loss < PL_LOSSES && fills; loss++)
      assert_true(here.of->lost[loss * (long)here.of->strips.count + k] == 0);
  }
  for (int row = 0; row < here.of->strips.rows; row++)
    assert_true(isfinite(here.of->rows[row].stored) && isfinite(here.of->rows[row].state));
  assert_int_equal(filling, 5 * 3 * 4);
  assert_int_equal(moved, 5 * 21 * 4);
  point_forces_free(here.of);
  plate_close(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rows_are_summed), cmocka_unit_test(rows_are_of_other_laws_too),
      cmocka_unit_test(rows_are_no_rectangles_too), cmocka_unit_test(what_fills_up_is_forgotten)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
