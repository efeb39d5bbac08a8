/* Strips: every group stands in one, in order; rectangles that are alike side by side, apart. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/kernel.h"
#include "runtime/mesh/point_strips.h"

enum { NX = 3 * PL_LANES + 4, NY = 4, CELLS = NX - 1, POINTS = 4 };

typedef struct plate {
  mesh m;
  integration_points points;
  cell_strips groups;
} plate;

/* Elements of 2 x 2 points; cell `single` has one. */
static void plate_open(plate *p, int single) {
  mesh_open(&p->m, (int[2]){NX, NY}, (double[2]){0, 0}, (double[2]){0.01 * CELLS, 0.06}, 0.5, 1.5);
  memset(p->m.element_free, 0, (size_t)mesh_node_count(&p->m));
  memset(p->m.element_gauss, 2, (size_t)mesh_cell_count(&p->m));
  if (single >= 0) p->m.element_gauss[single] = 1;
  mesh_settle(&p->m);
  integration_points_open(&p->points, &p->m);
  cell_strips_open(&p->groups, &p->m, &p->points, NULL);
}

static void plate_close(plate *p) {
  cell_strips_close(&p->groups);
  integration_points_close(&p->points);
  mesh_close(&p->m);
}

static void every_group_once(const plate *p, const point_strips *s) {
  int group = 0;
  for (int row = 0; row < p->groups.rows; row++)
    for (int k = s->first_of_row[row]; k < s->first_of_row[row + 1]; k++) {
      const point_strip *strip = &s->items[k];
      long points = 0;
      assert_int_equal(strip->row, row);
      assert_int_equal(strip->first, group);
      assert_int_equal(strip->at, p->groups.groups[group].at);
      for (; group < strip->last; group++) {
        points += (long)p->groups.groups[group].points * PL_LANES;
        assert_true(strip->rectangles == 0 || p->groups.groups[group].even > 0);
      }
      assert_int_equal(strip->count, points);
      assert_true(points <= s->most);
    }
  assert_int_equal(group, p->groups.group_count);
}

static void lengths_are_kept_to(void **state) {
  (void)state;
  enum { GROUP = POINTS * PL_LANES };
  static const struct {
    bool apart;
    long points, of_rectangles;
    int strips; /* of a row of 4 groups */
    long longest;
  } cases[] = {{true, GROUP, 100 * GROUP, 1, 4 * GROUP},
               {true, 100 * GROUP, 3 * GROUP, 2, 3 * GROUP},
               {true, 100 * GROUP, GROUP, 4, GROUP},
               {false, 2 * GROUP, GROUP, 2, 2 * GROUP},
               {false, 1, 1, 4, GROUP}};
  plate p;
  plate_open(&p, -1);
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    point_strips *s =
        point_strips_new(&p.groups, cases[k].apart, cases[k].points, cases[k].of_rectangles);
    every_group_once(&p, s);
    for (int row = 0; row <= NY - 1; row++)
      assert_int_equal(s->first_of_row[row], row * cases[k].strips);
    assert_int_equal(s->most, cases[k].longest);
    assert_int_equal(s->items[0].rectangles, cases[k].apart);
    point_strips_free(s);
  }
  plate_close(&p);
}

/* A row with an element of one point: rectangles before it, it, rectangles behind it. */
static void others_come_between(void **state) {
  (void)state;
  plate p;
  plate_open(&p, CELLS + PL_LANES);
  point_strips *s = point_strips_new(&p.groups, true, 1000, 1000);
  every_group_once(&p, s);
  assert_int_equal(s->first_of_row[1], 1);
  assert_int_equal(s->first_of_row[2], 4);
  for (int k = 1; k < 4; k++)
    assert_int_equal(s->items[k].rectangles, k != 2);
  /* slopes times volume: of a point 1/4 of 0.01 x 0.02 x 0.5 m^3, between edges 0.01 m apart */
  assert_true(fabs(s->items[1].push.mean[0] / (0.25 * 0.02 * 0.5 / 2) - 1) < 1e-12);
  point_strips_free(s);
  plate_close(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(lengths_are_kept_to),
                                     cmocka_unit_test(others_come_between)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
