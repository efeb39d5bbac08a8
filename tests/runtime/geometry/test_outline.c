/* Outlines of straight edges and arcs against closed forms: boxes, distances, what is inside,
   circles of edges. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "runtime/geometry/outline.h"

static const double pi = 3.14159265358979323846;

/* A square of side 2 about the origin, counter-clockwise. */
static const double square_points[] = {-1, -1, 1, -1, 1, 1, -1, 1};
static const outline square = {square_points, NULL, 4};

/* The same with half a disc of radius 1 on its right side, and with one taken out of it there. */
static const double outward[] = {0, 1, 0, 0}, inward[] = {0, -1, 0, 0};
static const outline capsule = {square_points, outward, 4}, bitten = {square_points, inward, 4};

static double distance(const outline *o, double x, double y) {
  return outline_distance(o, (double[]){x, y});
}

static void distances_of_a_square(void **state) {
  (void)state;
  assert_true(distance(&square, 0, 0) == -1 && distance(&square, 0.5, 0.25) == -0.5);
  assert_true(distance(&square, 3, 0.5) == 2);
  assert_true(fabs(distance(&square, 4, 5) - 5) < 1e-15); /* 3, 4, 5 from the corner */
  assert_true(distance(&square, 1, 0.3) == 0);
  assert_true(distance(&square, -7, 1) == 6 &&
              distance(&square, -7, -1) == 6); /* rays meet corners */
}

static void distances_of_arcs(void **state) {
  (void)state;
  double centre[2], radius;
  assert_true(outline_arc(&capsule, 1, centre, &radius));
  assert_true(fabs(centre[0] - 1) < 1e-15 && fabs(centre[1]) < 1e-15 && fabs(radius - 1) < 1e-15);
  assert_false(outline_arc(&capsule, 0, centre, &radius));
  for (int k = 0; k <= 40; k++) { /* rays from the centre of the circle to the right */
    const double angle = pi * (k / 40.0 - 0.5), c = cos(angle), s = sin(angle);
    assert_true(fabs(distance(&capsule, 1 + 1.75 * c, 1.75 * s) - 0.75) < 1e-15);
    assert_true(fabs(distance(&capsule, 1 + 0.9 * c, 0.9 * s) + 0.1) < 1e-15);
  }
  assert_true(fabs(distance(&bitten, 0.5, 0) - 0.5) < 1e-15); /* in the bite: outside */
  assert_true(fabs(distance(&bitten, -0.25, 0) + 0.25) < 1e-15);
  assert_true(fabs(distance(&bitten, 1, 0) - 1) < 1e-15);
}

static void boxes_hold_arcs(void **state) {
  (void)state;
  double lower[2], upper[2];
  outline_box(&capsule, lower, upper);
  assert_true(lower[0] == -1 && lower[1] == -1 && fabs(upper[0] - 2) < 1e-15 && upper[1] == 1);
  outline_box(&bitten, lower, upper);
  assert_true(lower[0] == -1 && upper[0] == 1);
  const double lost[] = {0, 0, NAN, 0, 1, 1};
  outline_box(&(outline){lost, NULL, 3}, lower, upper);
  assert_true(isnan(lower[0]) && isnan(upper[0]) && lower[1] == 0 && upper[1] == 1);
}

/* A circle of two arcs: whatever its chord's direction, the distance is that from the centre
   less the radius. */
static void a_circle_of_two_arcs_is_round(void **state) {
  (void)state;
  for (int turn = 0; turn < 24; turn++) {
    const double a = 2 * pi * turn / 24,
                 ends[] = {3 + 2 * cos(a), 1 + 2 * sin(a), 3 - 2 * cos(a), 1 - 2 * sin(a)};
    const outline circle = {ends, (const double[]){2, 2}, 2};
    for (int k = 0; k < 50; k++) {
      const double r = 0.083 * k, angle = 1.7 * k;
      assert_true(fabs(distance(&circle, 3 + r * cos(angle), 1 + r * sin(angle)) - (r - 2)) <
                  1e-14);
    }
  }
}

/* Turned and moved, it is as far from the point turned and moved with it. */
static void distances_turn_with_the_outline(void **state) {
  (void)state;
  const double c = cos(0.7), s = sin(0.7);
  double turned[8];
  for (int k = 0; k < 4; k++) {
    turned[2 * k] = 5 + c * square_points[2 * k] - s * square_points[2 * k + 1];
    turned[2 * k + 1] = -2 + s * square_points[2 * k] + c * square_points[2 * k + 1];
  }
  const outline other = {turned, outward, 4};
  for (int k = 0; k < 200; k++) {
    const double x = 3 * sin(1.1 * k), y = 3 * cos(1.9 * k);
    assert_true(fabs(distance(&other, 5 + c * x - s * y, -2 + s * x + c * y) -
                     distance(&capsule, x, y)) < 1e-14);
  }
}

static void folded_polygons_are_flat(void **state) {
  (void)state;
  const double folded[] = {0, 0, 1, 1, 2, 2, 0.5, 0.5};
  assert_true(outline_is_flat(&(outline){folded, NULL, 4}, 1e-12));
  assert_false(outline_is_flat(&square, 1e-12));
  assert_false(
      outline_is_flat(&(outline){folded, outward, 4}, 1e-12)); /* an arc encloses something */
  const double thin[] = {0, 0, 1, 0, 1, 1e-3, 0, 1e-3};
  assert_true(outline_is_flat(&(outline){thin, NULL, 4}, 2e-3));
  assert_false(outline_is_flat(&(outline){thin, NULL, 4}, 5e-4));
}

static double way(const outline *o, double x, double y, double u, double v) {
  return outline_way(o, (double[]){x, y}, (double[]){u, v});
}

/* The shorter way along the outline, around corners and along arcs. */
static void ways_along_the_outline(void **state) {
  (void)state;
  assert_true(fabs(way(&square, -0.5, -1, 0.5, -1) - 1) < 1e-15);
  assert_true(fabs(way(&square, 0.5, -1, 1, 0.25) - 1.75) < 1e-15);
  assert_true(fabs(way(&square, -0.5, -1, -0.5, 1) - 3) < 1e-15);    /* not 5 */
  assert_true(fabs(way(&square, -1, -0.75, -0.25, -1) - 1) < 1e-15); /* past the first corner */
  assert_true(fabs(way(&capsule, 2, 0, 1, 1) - pi / 2) < 1e-14);
  assert_true(fabs(way(&capsule, 0.5, -1, 2, 0) - (0.5 + pi / 2)) < 1e-14);
  assert_true(fabs(way(&bitten, 0, 0, 1, -1) - pi / 2) < 1e-14);
  assert_true(fabs(way(&bitten, 0, 0, 0.75, 1) - (0.25 + pi / 2)) < 1e-14);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(distances_of_a_square),
      cmocka_unit_test(ways_along_the_outline),
      cmocka_unit_test(distances_of_arcs),
      cmocka_unit_test(boxes_hold_arcs),
      cmocka_unit_test(a_circle_of_two_arcs_is_round),
      cmocka_unit_test(distances_turn_with_the_outline),
      cmocka_unit_test(folded_polygons_are_flat),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
