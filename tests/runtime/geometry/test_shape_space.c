/* Shapes in space against their definitions: points, volumes, and chords by dense sampling. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/geometry/shape.h"

static uint64_t state;

static double uniform(double low, double high) {
  state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return low + (high - low) * (double)(state >> 11) / 9007199254740992.0;
}

static void draw(double p[3]) {
  for (int c = 0; c < 3; c++)
    p[c] = uniform(-2, 2);
}

/* How far a point is outside, not a distance but of its sign. */
typedef double (*excess)(const double p[3]);

static double larger(double a, double b, double c) {
  return fmax(fmax(a, b), c);
}

static double box_excess(const double p[3]) {
  return larger(fabs(p[0] - 0.25) - 0.75, fabs(p[1]) - 1, fabs(p[2] + 0.5) - 0.5);
}

static double shell_excess(const double p[3]) {
  const double r = hypot(hypot(p[0], p[1]), p[2]);
  return fmax(r - 1.5, 0.7 - r);
}

/* A tube about the line from (-1, -1, -1) to (1, 1, 0). */
static double tube_excess(const double p[3]) {
  const double along = (2 * (p[0] + 1) + 2 * (p[1] + 1) + (p[2] + 1)) / 3;
  const double x = p[0] + 1 - along * 2 / 3, y = p[1] + 1 - along * 2 / 3, z = p[2] + 1 - along / 3;
  const double r = hypot(hypot(x, y), z);
  return larger(fmax(-along, along - 3), r - 0.9, 0.3 - r);
}

/* A quarter of a disc of radius 1.5, from z = -1 to 0.5. */
static double wedge_excess(const double p[3]) {
  return larger(fmax(-p[0], -p[1]), hypot(p[0], p[1]) - 1.5, fabs(p[2] + 0.25) - 0.75);
}

static const double wedge_points[] = {0, 0, 1.5, 0, 0, 1.5};
static const double wedge_bulge[] = {0, 1.5 * (1 - 0.70710678118654752), 0};

static const struct solid {
  const char *name;
  deck_shape shape;
  excess excess;
  double volume;
} solids[] = {
    {"box", {.kind = SHAPE_BOX, .corner = {-0.5, -1, -1}, .size = {1.5, 2, 1}}, box_excess, 3},
    {"shell",
     {.kind = SHAPE_SPHERE, .radius = 1.5, .inner_radius = 0.7},
     shell_excess,
     4.18879020478639098 * (3.375 - 0.343)},
    {"tube",
     {.kind = SHAPE_CYLINDER,
      .from = {-1, -1, -1},
      .to = {1, 1, 0},
      .radius = 0.9,
      .inner_radius = 0.3},
     tube_excess,
     3.14159265358979324 * 0.72 * 3},
    {"wedge",
     {.kind = SHAPE_EXTRUSION,
      .points = wedge_points,
      .point_count = 3,
      .bulge = wedge_bulge,
      .z = {-1, 0.5}},
     wedge_excess,
     3.14159265358979324 * 2.25 / 4 * 1.5},
};
enum { SOLIDS = sizeof solids / sizeof *solids };

static void points_lie_inside_or_outside(void **unused) {
  (void)unused;
  for (int k = 0; k < SOLIDS; k++) {
    const struct solid *s = &solids[k];
    double lower[3], upper[3];
    shape_box(&s->shape, lower, upper);
    double volume = (upper[0] - lower[0]) * (upper[1] - lower[1]) * (upper[2] - lower[2]);
    enum { SAMPLES = 200000 };
    int inside = 0;
    state = 17;
    for (int n = 0; n < SAMPLES; n++) {
      double p[3];
      for (int c = 0; c < 3; c++)
        p[c] = uniform(lower[c], upper[c]);
      const double e = s->excess(p);
      if (fabs(e) > 1e-9) assert_int_equal(shape_contains(&s->shape, p, 0), e < 0);
      inside += shape_contains(&s->shape, p, 0);
    }
    volume *= (double)inside / SAMPLES;
    print_message("%s: volume %.4f, counted %.4f\n", s->name, s->volume, volume);
    assert_true(fabs(volume / s->volume - 1) < 0.01);
  }
}

/* The tolerance is a distance: a point that far outside an edge or a corner is not near in each
   direction only. */
static void tolerance_is_a_distance(void **unused) {
  (void)unused;
  const deck_shape *box = &solids[0].shape;
  const double corner[3] = {1 + 0.09, 1 + 0.09, 0 + 0.09}, side[3] = {1 + 0.09, 0, -0.5};
  assert_true(shape_contains(box, side, 0.1));
  assert_false(shape_contains(box, corner, 0.1));
  assert_true(shape_contains(box, corner, 0.09 * 1.7321));
}

static void crossings_agree_with_samples(void **unused) {
  (void)unused;
  for (int k = 0; k < SOLIDS; k++) {
    const struct solid *s = &solids[k];
    int decided[2] = {0, 0};
    state = 7;
    for (int n = 0; n < 4000; n++) {
      double a[3], b[3], deepest = INFINITY;
      draw(a);
      draw(b);
      if (n % 2) /* short chords, as bonds are */
        for (int c = 0; c < 3; c++)
          b[c] = a[c] + 0.2 * b[c];
      for (int m = 0; m <= 1000; m++) {
        const double u = m / 1000.0;
        const double p[3] = {a[0] + u * (b[0] - a[0]), a[1] + u * (b[1] - a[1]),
                             a[2] + u * (b[2] - a[2])};
        deepest = fmin(deepest, s->excess(p));
      }
      if (fabs(deepest) < 6e-3) continue; /* too near to tell by samples so far apart */
      assert_int_equal(shape_crossed(&s->shape, a, b, 1e-9), deepest < 0);
      decided[deepest < 0]++;
    }
    assert_true(decided[0] > 500 && decided[1] > 500);
  }
}

static void touching_is_not_crossing(void **unused) {
  (void)unused;
  const deck_shape *box = &solids[0].shape;
  const double on_top[2][3] = {{-1, 0, 0}, {2, 0, 0}}, past_edge[2][3] = {{0, 0, 1}, {2, 0, -1}};
  const double into[2][3] = {{0, 0, 0}, {0, 0, -0.1}};
  assert_false(shape_crossed(box, on_top[0], on_top[1], 1e-9));
  assert_false(shape_crossed(box, past_edge[0], past_edge[1], 1e-9));
  assert_true(shape_crossed(box, into[0], into[1], 1e-9));
}

/* A triangle in an oblique plane: chords through it, beside it, along it. */
static const double triangle[] = {0, 0, 0, 2, 0, 1, 0, 2, 1};

static void faces_are_slits(void **unused) {
  (void)unused;
  const deck_shape s = {.kind = SHAPE_FACE, .points = triangle, .point_count = 3};
  int decided[2] = {0, 0};
  state = 3;
  for (int n = 0; n < 20000; n++) {
    double a[3], b[3], u;
    draw(a);
    draw(b);
    /* plane z = (x + y)/2 */
    const double over_a = a[2] - (a[0] + a[1]) / 2, over_b = b[2] - (b[0] + b[1]) / 2;
    u = over_a / (over_a - over_b);
    const double x = a[0] + u * (b[0] - a[0]), y = a[1] + u * (b[1] - a[1]);
    const double beside = larger(-x, -y, x + y - 2);
    if (fabs(beside) < 1e-6 || fabs(over_a) < 1e-6 || fabs(over_b) < 1e-6) continue;
    const bool through = u > 0 && u < 1 && beside < 0;
    assert_int_equal(shape_crossed(&s, a, b, 1e-9), through);
    decided[through]++;
  }
  assert_true(decided[1] > 500);
  const double on[3] = {0.5, 0.5, 0.5}, above[3] = {0.5, 0.5, 0.51}, past[3] = {-0.1, -0.1, -0.1};
  assert_true(shape_contains(&s, on, 1e-12));
  assert_false(shape_contains(&s, above, 1e-6));
  assert_false(shape_contains(&s, past, 1e-6));
  assert_true(shape_contains(&s, past, 0.174));
  const double along[3] = {1.5, 1.5, 1.5};
  assert_false(shape_crossed(&s, past, along, 1e-9));
}

static void faces_are_plane(void **unused) {
  (void)unused;
  static const double bent[] = {0, 0, 0, 1, 0, 0, 1, 1, 0.1, 0, 1, 0};
  static const double line[] = {0, 0, 0, 1, 1, 1, 2, 2, 2};
  const deck_shape plane = {.kind = SHAPE_FACE, .points = triangle, .point_count = 3};
  const deck_shape uneven = {.kind = SHAPE_FACE, .points = bent, .point_count = 4};
  const deck_shape none = {.kind = SHAPE_FACE, .points = line, .point_count = 3};
  assert_true(shape_unevenness(&plane) < 1e-15);
  assert_true(shape_unevenness(&uneven) > 0.02);
  assert_true(isnan(shape_unevenness(&none)));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(points_lie_inside_or_outside),
      cmocka_unit_test(tolerance_is_a_distance),
      cmocka_unit_test(crossings_agree_with_samples),
      cmocka_unit_test(touching_is_not_crossing),
      cmocka_unit_test(faces_are_slits),
      cmocka_unit_test(faces_are_plane),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
