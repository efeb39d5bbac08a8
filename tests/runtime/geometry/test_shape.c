/* Shapes against half planes, circles and dense sampling. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "runtime/geometry/shape.h"

static uint64_t state;

static double uniform(double low, double high) {
  state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return low + (high - low) * (double)(state >> 11) / 9007199254740992.0;
}

static bool contains(const deck_shape *s, double x, double y, double tolerance) {
  const double p[3] = {x, y, 0};
  return shape_contains(s, p, tolerance);
}

static bool crossed(const deck_shape *s, double ax, double ay, double bx, double by) {
  const double a[2] = {ax, ay}, b[2] = {bx, by};
  return shape_crossed(s, a, b, 1e-9);
}

static deck_shape rectangle(double x, double y, double w, double h) {
  return (deck_shape){.kind = SHAPE_RECTANGLE, .corner = {x, y}, .size = {w, h}};
}

static deck_shape disc(double x, double y, double radius, double inner) {
  return (deck_shape){
      .kind = SHAPE_DISC, .centre = {x, y}, .radius = radius, .inner_radius = inner};
}

static deck_shape polygon(const double *points, int count) {
  return (deck_shape){.kind = SHAPE_POLYGON, .points = points, .point_count = count};
}

static void rectangle_holds_its_outline(void **unused) {
  (void)unused;
  const deck_shape s = rectangle(1, 2, 3, 4);
  assert_true(contains(&s, 2, 3, 0));
  assert_true(contains(&s, 1, 2, 1e-12));
  assert_true(contains(&s, 4, 6, 1e-12));
  assert_true(contains(&s, 4 + 0.9e-6, 5, 1e-6));
  assert_false(contains(&s, 4 + 1.1e-6, 5, 1e-6));
  assert_false(contains(&s, 0.5, 3, 1e-6));
}

static void ring_has_a_hole(void **unused) {
  (void)unused;
  const deck_shape s = disc(1, 1, 2, 1);
  assert_false(contains(&s, 1, 1, 1e-6));
  assert_true(contains(&s, 2, 1, 1e-12));
  assert_true(contains(&s, 2.5, 1, 0));
  assert_true(contains(&s, 1, 3, 1e-12));
  assert_false(contains(&s, 1, 3.1, 1e-6));
}

static void point_is_its_own_outline(void **unused) {
  (void)unused;
  const deck_shape s = {.kind = SHAPE_POINT, .at = {1, 2}};
  assert_true(contains(&s, 1, 2, 1e-6));
  assert_false(contains(&s, 1, 2.1, 1e-6));
  assert_false(crossed(&s, 0, 2, 2, 2));
}

/* A U, clockwise: 4 x 3 with a gap of 2 x 2 from above. */
static const double letter_u[] = {0, 0, 0, 3, 1, 3, 1, 1, 3, 1, 3, 3, 4, 3, 4, 0};

static void concave_polygon(void **unused) {
  (void)unused;
  const deck_shape s = polygon(letter_u, 8);
  double lower[3], upper[3];
  state = 1;
  shape_box(&s, lower, upper);
  assert_true(lower[0] == 0 && lower[1] == 0 && upper[0] == 4 && upper[1] == 3);
  for (int n = 0; n < 20000; n++) {
    const double x = uniform(-1, 5), y = uniform(-1, 4);
    const bool in_box = x > 0 && x < 4 && y > 0 && y < 3;
    const bool in_gap = x > 1 && x < 3 && y > 1;
    assert_int_equal(contains(&s, x, y, 0), in_box && !in_gap);
  }
  assert_true(contains(&s, 1, 1, 1e-12)); /* inner corner */
  assert_true(contains(&s, 2, 1, 1e-12));
}

static void touching_is_not_crossing(void **unused) {
  (void)unused;
  const deck_shape s = rectangle(0, 0, 2, 1);
  assert_true(crossed(&s, -1, 0.5, 3, 0.5));
  assert_true(crossed(&s, 1, 0.5, 3, 0.5)); /* begins inside */
  assert_true(crossed(&s, 0.5, 0.5, 1.5, 0.6));
  assert_true(crossed(&s, -1, -1, 3, 1.2));
  assert_false(crossed(&s, -1, 1, 3, 1));         /* along the top */
  assert_false(crossed(&s, -1, 1 + 1e-12, 3, 1)); /* the same, a hair off */
  assert_false(crossed(&s, -1, 1 - 1e-12, 3, 1 - 1e-12));
  assert_false(crossed(&s, 0, -1, 0, 2));
  assert_false(crossed(&s, -1, 0, 1, 2)); /* corner (0, 1) */
  assert_false(crossed(&s, -1, 1, 0, 1)); /* ends in the corner */
  assert_false(crossed(&s, 1, 1, 1, 2));  /* ends on the outline */
  assert_false(crossed(&s, 3, 0, 4, 1));
}

static void gap_is_not_crossed(void **unused) {
  (void)unused;
  const deck_shape u = polygon(letter_u, 8), ring = disc(0, 0, 2, 1);
  assert_false(crossed(&u, 1.5, 2, 2.5, 1.5));
  assert_false(crossed(&u, 1, 2, 3, 2)); /* from arm to arm, between them only */
  assert_true(crossed(&u, 0.5, 2, 3.5, 2));
  assert_true(crossed(&u, -1, 2, 5, 2));
  assert_false(crossed(&u, 1, 3, 3, 1.0000001));
  assert_false(crossed(&ring, -0.5, 0, 0.5, 0.3));
  assert_false(crossed(&ring, -3, 2, 3, 2)); /* tangent */
  assert_true(crossed(&ring, 0, 0, 3, 0));
  assert_true(crossed(&ring, -3, 1.99, 3, 1.99));
}

static void slits_cut(void **unused) {
  (void)unused;
  const deck_shape upright = rectangle(1, 0, 0, 2);
  assert_true(crossed(&upright, 0.5, 1, 1.5, 1.2));
  assert_true(crossed(&upright, 0.5, 2, 1.5, 2)); /* its tip */
  assert_false(crossed(&upright, 0.5, 2.1, 1.5, 2.1));
  assert_false(crossed(&upright, 1, -1, 1, 3)); /* along it */
  assert_false(crossed(&upright, 0, 1, 0.9, 1));
  static const double folded[] = {0, 0, 1, 1, 2, 1, 1, 1};
  const deck_shape kinked = polygon(folded, 4);
  assert_true(crossed(&kinked, 0.5, 1.5, 1.5, 0.5)); /* through the kink */
  assert_true(crossed(&kinked, 0, 1, 1, 0));
  assert_false(crossed(&kinked, 0, 0.5, 0.4, 0.5));
}

/* Half planes x cos a + y sin a < 1 of a regular hexagon with apothem 1: largest excess, negative
 * inside. */
static double hexagon_excess(double x, double y) {
  double excess = -INFINITY;
  for (int k = 0; k < 6; k++) {
    const double a = (k + 0.5) * acos(-1) / 3;
    excess = fmax(excess, x * cos(a) + y * sin(a) - 1);
  }
  return excess;
}

static double disc_excess(double x, double y) {
  return hypot(x, y) - 1;
}

static void compare_with_samples(const deck_shape *s, double (*excess)(double, double)) {
  int decided[2] = {0, 0};
  for (int n = 0; n < 3000; n++) {
    const double ax = uniform(-2, 2), ay = uniform(-2, 2);
    const double bx = ax + uniform(-2, 2), by = ay + uniform(-2, 2);
    double deepest = INFINITY;
    for (int k = 0; k <= 1000; k++) {
      const double u = k / 1000.0;
      deepest = fmin(deepest, excess(ax + u * (bx - ax), ay + u * (by - ay)));
    }
    if (fabs(deepest) < 3e-3) continue; /* too near to tell by samples 3e-3 apart */
    assert_int_equal(crossed(s, ax, ay, bx, by), deepest < 0);
    decided[deepest < 0]++;
  }
  assert_true(decided[0] > 500 && decided[1] > 500);
}

static void crossings_agree_with_samples(void **unused) {
  (void)unused;
  double points[12];
  for (int k = 0; k < 6; k++) {
    points[2 * k] = 2 / sqrt(3) * cos(k * acos(-1) / 3);
    points[2 * k + 1] = 2 / sqrt(3) * sin(k * acos(-1) / 3);
  }
  const deck_shape hexagon = polygon(points, 6), circle = disc(0, 0, 1, 0);
  state = 7;
  compare_with_samples(&hexagon, hexagon_excess);
  compare_with_samples(&circle, disc_excess);
}

/* A comb of 200 teeth: more places than the fixed buffer holds. */
static void many_crossings(void **unused) {
  (void)unused;
  enum { TEETH = 200 };
  double points[4 * TEETH + 4];
  int n = 0;
  for (int k = 0; k < TEETH; k++) {
    const double tooth[4] = {k, 0, k + 0.5, 1};
    for (int c = 0; c < 4; c++)
      points[n++] = tooth[c];
  }
  const double back[4] = {TEETH, 0, TEETH, 2};
  for (int c = 0; c < 4; c++)
    points[n++] = back[c];
  points[n - 1] = -1; /* from here straight back to the first point, below all teeth */
  const deck_shape comb = polygon(points, n / 2);
  assert_true(crossed(&comb, -1, 0.5, TEETH + 1, 0.5));
  assert_false(crossed(&comb, -1, 1.5, TEETH + 1, 1.5));
  assert_false(crossed(&comb, 0.6, 0.9, 1.2, 0.9)); /* between two teeth */
  assert_true(crossed(&comb, 0.4, 0.9, 1.2, 0.9));
}

/* --- arcs ------------------------------------------------------------------------------------- */

static const double pi = 3.14159265358979323846;

/* Four corners of a square on the unit circle, each edge an arc of it, begun at any corner. */
static void four_arcs_are_a_disc(void **unused) {
  (void)unused;
  const deck_shape circle = disc(0.3, -0.2, 1, 0);
  for (int turn = 0; turn < 8; turn++) {
    double points[8], bulge[4], lower[3], upper[3];
    for (int k = 0; k < 4; k++) {
      const double angle = pi / 8 * turn + pi / 2 * k;
      points[2 * k] = 0.3 + cos(angle);
      points[2 * k + 1] = -0.2 + sin(angle);
      bulge[k] = 1 - sqrt(0.5);
    }
    deck_shape s = polygon(points, 4);
    s.bulge = bulge;
    shape_box(&s, lower, upper);
    assert_true(fabs(lower[0] + 0.7) < 1e-14 && fabs(upper[0] - 1.3) < 1e-14);
    assert_true(fabs(lower[1] + 1.2) < 1e-14 && fabs(upper[1] - 0.8) < 1e-14);
    state = (uint64_t)turn + 3;
    for (int n = 0; n < 20000; n++) {
      double x = uniform(-1, 1.6), y = uniform(-1.5, 1.1);
      if (n % 4 == 0) y = points[2 * (n / 4 % 4) + 1]; /* at a corner's height */
      if (n % 8 == 1) y = points[1] + (y > 0 ? 1 : -1) * 1e-17;
      const double outside = hypot(x - 0.3, y + 0.2) - 1;
      if (fabs(outside) < 1e-12) continue;
      assert_int_equal(contains(&s, x, y, 0), outside < 0);
      assert_int_equal(contains(&s, x, y, 0.01), outside < 0.01);
      const double bx = uniform(-1, 1.6), by = uniform(-1.5, 1.1);
      assert_int_equal(crossed(&s, x, y, bx, by), crossed(&circle, x, y, bx, by));
    }
  }
}

/* A keyhole: an arc of more than half a circle on one edge, a bite of less on another. */
static void arcs_reach_out_and_in(void **unused) {
  (void)unused;
  static const double points[] = {-1, -2, 1, -2, 1, 0, -1, 0};
  static const double bulge[] = {-0.5, 0, 3, 0};
  deck_shape s = polygon(points, 4);
  s.bulge = bulge;
  const double R = (1 + 9) / 6.0, r = (1 + 0.25) / 1.0; /* of chords of length 2 */
  state = 11;
  long inside[2] = {0, 0};
  for (int n = 0; n < 100000; n++) {
    const double x = uniform(-2, 2), y = uniform(-2.5, 3.5);
    const bool bite = hypot(x, y - (-1.5 - r)) < r && y > -2;
    const bool head = hypot(x, y - (3 - R)) < R && y > 0;
    const bool shaft = fabs(x) < 1 && y > -2 && y <= 0;
    const bool in = head || (shaft && !bite);
    assert_int_equal(contains(&s, x, y, 0), in);
    inside[in]++;
  }
  assert_true(inside[0] > 20000 && inside[1] > 20000);
}

/* The dog-bone of van Vliet and van Mier: width D, height 1.5 D, neck 0.6 D, radius 0.725 D; the
   arcs end 0.25 D from the ends. */
static void dog_bone_has_its_area(void **unused) {
  (void)unused;
  enum { SIDE = 1200 };
  const deck_shape s = {.kind = SHAPE_DOG_BONE,
                        .centre = {0.1, 0.2},
                        .width = 1,
                        .height = 1.5,
                        .neck = 0.6,
                        .radius = 0.725};
  const double half_chord = 0.5, depth = 0.725 - 0.2;
  const double segment = 0.725 * 0.725 * acos(depth / 0.725) - depth * half_chord;
  const double area = 1.5 - 2 * segment;
  double counted = 0, turned = 0;
  deck_shape t = s;
  t.rotation = 0.3;
  for (int i = 0; i < SIDE; i++)
    for (int j = 0; j < SIDE; j++) {
      const double x = -1 + 2 * (i + 0.5) / SIDE, y = -1 + 2 * (j + 0.5) / SIDE;
      counted += contains(&s, 0.1 + x, 0.2 + y, 0) ? 4.0 / SIDE / SIDE : 0;
      turned += contains(&t, 0.1 + x, 0.2 + y, 0) ? 4.0 / SIDE / SIDE : 0;
    }
  print_message("dog-bone: area %.6f, counted %.6f, turned %.6f\n", area, counted, turned);
  assert_true(fabs(counted - area) < 3e-4);
  assert_true(fabs(turned - area) < 3e-4);
  assert_true(contains(&s, 0.4 - 1e-9, 0.2, 0) && !contains(&s, 0.4 + 1e-9, 0.2, 0));
  assert_true(contains(&s, 0.6, 0.2 + 0.5, 1e-12) && !contains(&s, 0.6, 0.2 + 0.49, 1e-6));
  assert_true(crossed(&s, -1, 0.2, 1, 0.2) && !crossed(&s, 0.45, 0.1, 0.45, 0.3));
}

static void rectangles_turn_about_their_corner(void **unused) {
  (void)unused;
  deck_shape s = rectangle(1, 2, 3, 0.5);
  s.rotation = 0.7;
  const double c = cos(0.7), d = sin(0.7);
  const double corners[] = {
      1,           2,          1 + 3 * c, 2 + 3 * d, 1 + 3 * c - 0.5 * d, 2 + 3 * d + 0.5 * c,
      1 - 0.5 * d, 2 + 0.5 * c};
  const deck_shape same = polygon(corners, 4);
  state = 5;
  for (int n = 0; n < 5000; n++) {
    const double ax = uniform(0, 5), ay = uniform(1, 5), bx = uniform(0, 5), by = uniform(1, 5);
    assert_int_equal(contains(&s, ax, ay, 0), contains(&same, ax, ay, 0));
    assert_int_equal(crossed(&s, ax, ay, bx, by), crossed(&same, ax, ay, bx, by));
  }
}

static void segments_are_slits(void **unused) {
  (void)unused;
  const deck_shape s = {.kind = SHAPE_SEGMENT, .from = {0, 0}, .to = {2, 1}};
  assert_true(contains(&s, 1, 0.5, 1e-12));
  assert_false(contains(&s, 1, 0.51, 1e-6));
  assert_true(crossed(&s, 0.5, 1, 1.5, 0));
  assert_true(crossed(&s, 2, 0, 2, 2)); /* its tip */
  assert_false(crossed(&s, 3, 0, 2.5, 2));
  assert_false(crossed(&s, -1, -0.5, 4, 2)); /* along it */
}

static void ways_along_outlines_of_shapes(void **unused) {
  (void)unused;
  const deck_shape ring = {.kind = SHAPE_DISC, .centre = {1, 2}, .radius = 2, .inner_radius = 1};
  const deck_shape box = {.kind = SHAPE_RECTANGLE, .corner = {0, 0}, .size = {3, 1}};
  const double right[] = {3, 2}, top[] = {1, 4}, inner_right[] = {2, 2}, inner_top[] = {1, 3};
  assert_true(fabs(shape_way(&ring, right, top) - M_PI) < 1e-14);
  assert_true(fabs(shape_way(&ring, inner_right, inner_top) - M_PI / 2) < 1e-14);
  assert_true(isinf(shape_way(&ring, right, inner_right)));
  assert_true(fabs(shape_way(&box, (double[]){2.5, 0}, (double[]){2.5, 1}) - 2) < 1e-15);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(ways_along_outlines_of_shapes),
      cmocka_unit_test(rectangle_holds_its_outline),
      cmocka_unit_test(ring_has_a_hole),
      cmocka_unit_test(point_is_its_own_outline),
      cmocka_unit_test(concave_polygon),
      cmocka_unit_test(touching_is_not_crossing),
      cmocka_unit_test(gap_is_not_crossed),
      cmocka_unit_test(slits_cut),
      cmocka_unit_test(crossings_agree_with_samples),
      cmocka_unit_test(many_crossings),
      cmocka_unit_test(four_arcs_are_a_disc),
      cmocka_unit_test(arcs_reach_out_and_in),
      cmocka_unit_test(dog_bone_has_its_area),
      cmocka_unit_test(rectangles_turn_about_their_corner),
      cmocka_unit_test(segments_are_slits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
