/* Holes: what they hide, how far a line goes, points of cells that they cut, nodes that are
   gone. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/mesh/cut_cells.h"
#include "runtime/mesh/gauss_rule.h"
#include "runtime/mesh/holes.h"
#include "runtime/mesh/mesh.h"
#include "runtime/mesh/shape_functions.h"

static deck_shape disc(double x, double y, double radius) {
  return (deck_shape){.kind = SHAPE_DISC, .centre = {x, y}, .radius = radius};
}

static deck_shape rectangle(double x, double y, double w, double h) {
  return (deck_shape){.kind = SHAPE_RECTANGLE, .corner = {x, y}, .size = {w, h}};
}

/* 11 x 11 nodes at (0 .. 10)^2. */
static void open_cut(mesh *m, const deck_shape *shapes, int count) {
  mesh_open(m, (int[2]){11, 11}, (double[2]){0, 0}, (double[2]){10, 10}, 1, 2.1);
  for (int n = 0; n < count; n++)
    holes_add(&m->holes, &shapes[n]);
  mesh_cut(m);
  mesh_settle(m);
}

/* --- holes ------------------------------------------------------------------------------------ */

static bool hides(const mesh_holes *h, double x, double y, double i, double j) {
  return holes_hide(h, (double[]){x, y}, (double[]){i, j});
}

static void a_way_around_that_is_long_hides(void **state) {
  (void)state;
  mesh_holes h = {.tolerance = 1e-6};
  const deck_shape slot = rectangle(0, 0, 10, 0.2);
  holes_add(&h, &slot);
  assert_true(hides(&h, 5, -1, 5, 1) && hides(&h, 5, -1, 7, 1));
  assert_false(hides(&h, 5, -1, 9, -2));      /* on one side */
  assert_false(hides(&h, 5, 0, 7, 0));        /* along its outline */
  assert_true(hides(&h, 5, 0, 5, 0.2));       /* across it from outline to outline */
  assert_true(hides(&h, 9.93, -1, 9.93, 1));  /* 0.2 through it, 0.34 around its end */
  assert_false(hides(&h, 9.97, -1, 9.97, 1)); /* 0.26 */
  assert_true(hides(&h, 9.93, 1, 9.93, -1));
  holes_close(&h);
  /* a chord of a disc, of 2 sin(a/2), has an arc of a: 1.5 times longer at a = 2.99 */
  const deck_shape hole = disc(0, 0, 1);
  holes_add(&h, &hole);
  h.tolerance = 1e-6;
  assert_true(hides(&h, -2, 0, 2, 0));
  assert_false(hides(&h, -2, 0.2, 2, 0.2));
  holes_close(&h);
  /* a ring: between its hole and what is around there is no way */
  const deck_shape ring = {.kind = SHAPE_DISC, .radius = 1, .inner_radius = 0.8};
  holes_add(&h, &ring);
  h.tolerance = 1e-6;
  assert_true(hides(&h, 0, 0, 0.9, 0.9) && !hides(&h, 0, 0, 0.3, 0.2));
  holes_close(&h);
}

static void lines_end_at_holes(void **state) {
  (void)state;
  mesh_holes h = {.tolerance = 1e-6};
  const deck_shape shapes[2] = {rectangle(0, 0, 2, 1), disc(2, 0.5, 0.5)};
  double middle[2], *u;
  for (int n = 0; n < 2; n++)
    holes_add(&h, &shapes[n]);
  assert_true(fabs(holes_until(&h, (double[]){-3, 0.5}, (double[]){1, 0.5}) - 0.75) < 1e-12);
  assert_true(holes_until(&h, (double[]){-3, 2}, (double[]){5, 2}) == 1);
  assert_true(holes_until(&h, (double[]){1, 0.5}, (double[]){5, 0.5}) == 0);
  assert_true(holes_hold(&h, (double[]){1, 0.5}) && !holes_hold(&h, (double[]){1, 1}));
  assert_true(holes_near(&h, (double[]){2.9, 0.5}, 0.41) &&
              !holes_near(&h, (double[]){2.9, 0.5}, 0.39));
  /* through both: from 0 to 2.5 along y = 0.5 */
  assert_true(holes_beyond(&h, (double[]){-1, 0.5}, (double[]){0, 0.5}, middle));
  assert_true(fabs(middle[0] - 1.25) < 1e-12 && fabs(middle[1] - 0.5) < 1e-12);
  assert_true(holes_beyond(&h, (double[]){-1, 0.5}, (double[]){0.5, 0.5}, middle));
  assert_true(fabs(middle[0] - 1.5) < 1e-12);
  assert_false(holes_beyond(&h, (double[]){-1, 0.5}, (double[]){-0.5, 0.5}, middle));
  const int count = holes_cuts(&h, (double[]){-1, 0.5}, (double[]){4, 0.5}, &u);
  assert_true(count >= 4 && u[0] == 0 && u[count - 1] == 1);
  for (int k = 1; k < count; k++)
    assert_true(u[k] >= u[k - 1]);
  free(u);
  assert_true(holes_meet_box(&h, (double[]){2.4, 0}, (double[]){3, 1}) &&
              !holes_meet_box(&h, (double[]){2.6, 0}, (double[]){3, 1}));
  holes_close(&h);
}

/* --- cut cells -------------------------------------------------------------------------------- */

/* Integrals of 1, x, x y over what is left: all cells. */
static void integrate(const mesh *m, double sum[3]) {
  cut_points p = {.count = 0};
  sum[0] = sum[1] = sum[2] = 0;
  for (int c = 0; c < mesh_cell_count(m); c++) {
    const double x = mesh_at(m, 0, c % 10) + 0.5, y = mesh_at(m, 1, c / 10) + 0.5;
    if (m->cell[c] == CELL_ABSENT) continue;
    p.count = 0;
    if (m->cut[c]) {
      cut_cell_points(m, c, &p);
    } else {
      sum[0] += 1;
      sum[1] += x;
      sum[2] += x * y;
    }
    for (int n = 0; n < p.count; n++) {
      assert_true(p.area[n] > 0 && !holes_hold(&m->holes, p.at[n]));
      assert_int_equal(mesh_cell_of(m, p.at[n]), c);
      sum[0] += p.area[n];
      sum[1] += p.area[n] * p.at[n][0];
      sum[2] += p.area[n] * p.at[n][0] * p.at[n][1];
    }
  }
  cut_points_free(&p);
}

/* What a shape of area A about (x, y), and of equal products of area about its axes, leaves. */
static void leaves(const mesh *m, double area, double x, double y, double accuracy) {
  double sum[3];
  integrate(m, sum);
  assert_true(fabs(sum[0] - (100 - area)) < accuracy);
  assert_true(fabs(sum[1] - (500 - area * x)) < accuracy * 10);
  assert_true(fabs(sum[2] - (2500 - area * x * y)) < accuracy * 100);
}

static void cut_cells_hold_what_is_left_of_them(void **state) {
  (void)state;
  mesh m;
  deck_shape shape = rectangle(2.3, 3.1, 4.45, 1.7);
  open_cut(&m, &shape, 1);
  leaves(&m, 4.45 * 1.7, 2.3 + 4.45 / 2, 3.1 + 1.7 / 2, 1e-12);
  mesh_close(&m);
  shape = rectangle(4, 3, 3, 2.5);
  shape.rotation = 0.3;
  open_cut(&m, &shape, 1);
  double sum[3];
  integrate(&m, sum);
  assert_true(fabs(sum[0] - 92.5) < 1e-12);
  mesh_close(&m);
  static const double radii[] = {0.31, 0.95, 2, 3.37};
  for (int n = 0; n < 4; n++) {
    shape = disc(5.21, 4.87, radii[n]);
    open_cut(&m, &shape, 1);
    leaves(&m, M_PI * radii[n] * radii[n], 5.21, 4.87, 1e-5);
    mesh_close(&m);
  }
}

static void cells_and_nodes_are_flagged(void **state) {
  (void)state;
  mesh m;
  /* on lines of nodes cells go as a whole, and nothing is cut; nodes between two holes go, too */
  const deck_shape two[2] = {rectangle(2, 3, 3, 4), rectangle(5, 3, 2, 4)};
  int gone = 0, absent = 0, cut = 0;
  open_cut(&m, two, 2);
  for (int n = 0; n < mesh_node_count(&m); n++)
    gone += m.gone[n];
  for (int c = 0; c < mesh_cell_count(&m); c++) {
    absent += m.cell[c] == CELL_ABSENT;
    cut += m.cut[c];
  }
  assert_int_equal(gone, 4 * 3);
  assert_int_equal(absent, 5 * 4);
  assert_int_equal(cut, 0);
  assert_false(m.gone[mesh_node(&m, 2, 3)] || m.gone[mesh_node(&m, 5, 3)]);
  assert_true(m.gone[mesh_node(&m, 5, 4)]);
  /* a point on the outline belongs to the cell that is there */
  assert_int_equal(mesh_cell_of(&m, (double[]){2, 4.5}), mesh_cell_at(&m, 1, 4));
  assert_int_equal(mesh_cell_of(&m, (double[]){4.5, 7}), mesh_cell_at(&m, 4, 7));
  mesh_close(&m);
  /* nodes of cut cells are element-free, in holes they have no function */
  const deck_shape hole = disc(5, 5, 1.2);
  mesh_open(&m, (int[2]){11, 11}, (double[2]){0, 0}, (double[2]){10, 10}, 1, 2.1);
  memset(m.element_free, 0, 121);
  holes_add(&m.holes, &hole);
  assert_int_equal(mesh_cut(&m), 121 - 5);
  mesh_settle(&m);
  assert_true(m.element_free[mesh_node(&m, 4, 4)] && m.moving[mesh_node(&m, 4, 4)]);
  assert_true(m.gone[mesh_node(&m, 5, 4)] && !m.moving[mesh_node(&m, 5, 4)]);
  assert_int_equal(m.cell[mesh_cell_at(&m, 4, 4)], CELL_ELEMENT_FREE);
  assert_int_equal(m.cell[mesh_cell_at(&m, 1, 1)], CELL_ELEMENT);
  mesh_close(&m);
}

/* Of the cell beyond its corner a hole takes 1e-10 of the area, and the node that stands there. */
static void a_corner_that_is_gone_cuts_its_cell(void **state) {
  (void)state;
  mesh m;
  point_shape s;
  const deck_shape hole = rectangle(3 - 1e-5, 3 - 1e-5, 3 + 2e-5, 4 + 2e-5);
  const int corners[4][2] = {{2, 2}, {6, 2}, {2, 7}, {6, 7}};
  mesh_open(&m, (int[2]){11, 11}, (double[2]){0, 0}, (double[2]){10, 10}, 1, 2.1);
  memset(m.element_free, 0, 121);
  holes_add(&m.holes, &hole);
  assert_int_equal(mesh_cut(&m), 121 - 4 * 5);
  mesh_settle(&m);
  for (int k = 0; k < 4; k++) {
    const int cell = mesh_cell_at(&m, corners[k][0], corners[k][1]);
    assert_true(m.cut[cell] && m.cell[cell] == CELL_ELEMENT_FREE);
    shape_functions(&m, cell, (double[]){corners[k][0] + 0.5, corners[k][1] + 0.5}, &s);
    for (int n = 0; n < s.count; n++)
      assert_false(m.gone[s.node[n]]);
  }
  mesh_close(&m);
}

static void rules_integrate_polynomials(void **state) {
  (void)state;
  double at[MESH_MOST_GAUSS], weight[MESH_MOST_GAUSS];
  for (int order = 1; order <= MESH_MOST_GAUSS; order++) {
    gauss_rule(order, at, weight);
    for (int power = 0; power < 2 * order; power++) {
      double sum = 0;
      for (int k = 0; k < order; k++)
        sum += weight[k] * pow(at[k], power);
      assert_true(fabs(sum - (power % 2 ? 0 : 2.0 / (power + 1))) < 1e-14);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_way_around_that_is_long_hides),
      cmocka_unit_test(lines_end_at_holes),
      cmocka_unit_test(cut_cells_hold_what_is_left_of_them),
      cmocka_unit_test(cells_and_nodes_are_flagged),
      cmocka_unit_test(a_corner_that_is_gone_cuts_its_cell),
      cmocka_unit_test(rules_integrate_polynomials),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
