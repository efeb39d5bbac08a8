/* Convex cells against closed forms: boxes cut by planes, polygons and balls of many cuts. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "runtime/geometry/cell.h"

static const double pi = 3.14159265358979323846;
static const double below[3] = {-1, -1, -1}, above[3] = {1, 1, 1};

static cell box(int dimensions) {
  cell c;
  cell_begin(&c, dimensions);
  cell_set_box(&c, below, above);
  return c;
}

static void boxes_have_their_size(void **state) {
  (void)state;
  for (int dimensions = 2; dimensions <= 3; dimensions++) {
    cell c;
    cell_begin(&c, dimensions);
    cell_set_box(&c, (double[]){-1, -2, -3}, (double[]){2, 1, 4});
    const cell_moments m = cell_measure(&c);
    const double size = dimensions == 2 ? 9 : 63;
    assert_true(fabs(m.size - size) < 1e-13);
    assert_true(fabs(m.first[0] - 0.5 * size) < 1e-13 && fabs(m.first[1] + 0.5 * size) < 1e-13);
    assert_true(dimensions == 2 || fabs(m.first[2] - 0.5 * size) < 1e-12);
    assert_true(fabs(c.reach - (dimensions == 2 ? sqrt(8) : sqrt(24))) < 1e-15);
    cell_end(&c);
  }
}

/* A plane through x + y + z = 2 takes a corner tetrahedron of edge 1 off the cube: volume 1/6, centroid 3/4 on each axis. */
static void a_corner_is_cut_off(void **state) {
  (void)state;
  cell c = box(3);
  assert_true(cell_cut(&c, (double[]){1, 1, 1}, 2));
  cell_moments m = cell_measure(&c);
  assert_true(fabs(m.size - (8 - 1.0 / 6)) < 1e-14);
  for (int d = 0; d < 3; d++)
    assert_true(fabs(m.first[d] + 0.75 / 6) < 1e-14);
  assert_false(cell_cut(&c, (double[]){1, 1, 1}, 2.5)); /* there is nothing left */
  double lower[3], upper[3];
  cell_extent(&c, lower, upper);
  assert_true(lower[0] == -1 && upper[0] == 1 && lower[2] == -1 && upper[2] == 1);
  cell_end(&c);
  c = box(2);
  assert_true(cell_cut(&c, (double[]){1, 1, 0}, 1));
  m = cell_measure(&c);
  assert_true(fabs(m.size - 3.5) < 1e-15 && fabs(m.first[0] + 0.5 * 2.0 / 3) < 1e-15);
  cell_end(&c);
}

/* A thousand cuts at the distance r of a circle leave the regular polygon of area n r^2 tan(pi/n). */
static void many_cuts_make_a_polygon(void **state) {
  (void)state;
  for (int n = 5; n < 1000; n = 3 * n + 1) {
    cell c = box(2);
    for (int k = 0; k < n; k++)
      assert_true(cell_cut(&c, (double[]){cos(2 * pi * k / n), sin(2 * pi * k / n), 0}, 0.5));
    const cell_moments m = cell_measure(&c);
    assert_true(fabs(m.size / (n * 0.25 * tan(pi / n)) - 1) < 1e-12);
    assert_true(fabs(m.first[0]) < 1e-14 && fabs(m.first[1]) < 1e-14);
    assert_true(fabs(c.reach * cos(pi / n) - 0.5) < 1e-14);
    assert_int_equal(c.now.point_count, n);
    cell_end(&c);
  }
}

/* Cuts that touch a ball: how much more than the ball is left falls as the area of a face does, and points, edges and faces
   are as Euler says. */
static double around_a_ball(int n) {
  cell c = box(3);
  for (int k = 0; k < n; k++) {
    const double z = (2 * k + 1.0) / n - 1, flat = sqrt(1 - z * z), turn = 2.399963229728653 * k;
    cell_cut(&c, (double[]){flat * cos(turn), flat * sin(turn), z}, 0.5);
  }
  const int edges = c.now.corner_count / 2;
  assert_int_equal(c.now.point_count - edges + c.now.face_count, 2);
  const double size = cell_measure(&c).size;
  cell_end(&c);
  return size / (4 * pi / 3 * 0.125) - 1;
}

static void many_cuts_make_a_ball(void **state) {
  (void)state;
  const double coarse = around_a_ball(100), fine = around_a_ball(400);
  assert_true(fine > 0 && coarse > 0);
  assert_true(coarse / fine > 3.5 && coarse / fine < 4.5); /* as the area of a face */
}

/* The order of the cuts does not matter but for rounding; memory is kept for the next cell. */
static void the_order_of_cuts_does_not_matter(void **state) {
  (void)state;
  enum { CUTS = 40 };
  cell c = box(3);
  double size[2];
  for (int way = 0; way < 2; way++) {
    cell_set_box(&c, below, above);
    for (int k = 0; k < CUTS; k++) {
      const int n = way ? CUTS - 1 - k : k;
      const double z = sin(1.7 * n), flat = sqrt(1 - z * z);
      cell_cut(&c, (double[]){flat * cos(2.9 * n), flat * sin(2.9 * n), z}, 0.6 + 0.3 * sin(n));
    }
    size[way] = cell_measure(&c).size;
  }
  assert_true(size[0] > 0.1 && size[0] < 4 && fabs(size[0] / size[1] - 1) < 1e-12);
  cell_end(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(boxes_have_their_size),
      cmocka_unit_test(a_corner_is_cut_off),
      cmocka_unit_test(many_cuts_make_a_polygon),
      cmocka_unit_test(many_cuts_make_a_ball),
      cmocka_unit_test(the_order_of_cuts_does_not_matter),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
