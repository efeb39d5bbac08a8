/* Surfaces of solids: their distance is that of the shape (shape.h), and the way out is how it
   grows. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/geometry/surface.h"

typedef struct solid {
  deck_shape shape;
  int dimensions;
  double extent; /* m^2, m */
} solid;

static const double pi = 3.14159265358979323846;

static const solid solids[] = {
    {{.kind = SHAPE_RECTANGLE, .corner = {0.2, -0.1}, .size = {0.5, 0.3}}, 2, 1.6},
    {{.kind = SHAPE_RECTANGLE, .corner = {0.2, -0.1}, .size = {0.5, 0.3}, .rotation = 0.6}, 2, 1.6},
    {{.kind = SHAPE_DISC, .centre = {0.1, 0.2}, .radius = 0.4}, 2, 0.8 * pi},
    {{.kind = SHAPE_BOX, .corner = {-0.2, -0.1, 0}, .size = {0.5, 0.3, 0.7}}, 3, 1.42},
    {{.kind = SHAPE_SPHERE, .centre = {0.1, 0, 0.2}, .radius = 0.4}, 3, 0.64 * pi},
    {{.kind = SHAPE_CYLINDER, .from = {-0.3, 0.1, 0}, .to = {0.3, -0.2, 0.2}, .radius = 0.25},
     3,
     2 * pi * 0.25 * (0.7 + 0.25)},
};
enum { SOLIDS = sizeof solids / sizeof *solids, PLACES = 13 };

/* Places of a grid that is nowhere near a plane of symmetry. */
static void place_of(int k, int dimensions, double p[3]) {
  p[0] = -0.811 + 0.137 * (k % PLACES);
  p[1] = -0.923 + 0.151 * (k / PLACES % PLACES);
  p[2] = dimensions == 3 ? -0.777 + 0.143 * (k / PLACES / PLACES) : 0;
}

static void distances_are_those_of_the_shape(void **state) {
  (void)state;
  for (int n = 0; n < SOLIDS; n++) {
    const solid *s = &solids[n];
    surface of;
    assert_true(surface_open(&s->shape, &of));
    assert_true(fabs(surface_extent(&of, s->dimensions, 0) / s->extent - 1) < 1e-12);
    const int count = s->dimensions == 3 ? PLACES * PLACES * PLACES : PLACES * PLACES;
    for (int k = 0; k < count; k++) {
      double p[3], out[3];
      place_of(k, s->dimensions, p);
      const double d = surface_distance(&of, p, out);
      assert_true(fabs(d - shape_distance(&s->shape, p)) < 1e-14);
    }
  }
}

/* A little further along it the distance has grown by as much, and a little across not at all. */
static void the_way_out_is_how_it_grows(void **state) {
  (void)state;
  const double little = 1e-6;
  for (int n = 0; n < SOLIDS; n++) {
    const solid *s = &solids[n];
    surface of;
    surface_open(&s->shape, &of);
    const int count = s->dimensions == 3 ? PLACES * PLACES * PLACES : PLACES * PLACES;
    int edges = 0;
    for (int k = 0; k < count; k++) {
      double p[3], out[3], other[3], size = 0;
      place_of(k, s->dimensions, p);
      surface_distance(&of, p, out);
      for (int c = 0; c < 3; c++) {
        double q[3] = {p[0], p[1], p[2]};
        size += out[c] * out[c];
        if (c >= s->dimensions) continue;
        q[c] += little;
        const double ahead = surface_distance(&of, q, other);
        q[c] -= 2 * little;
        const double slope = (ahead - surface_distance(&of, q, other)) / (2 * little);
        edges += !(fabs(slope - out[c]) < 1e-4);
      }
      assert_true(fabs(size - 1) < 1e-14 && (s->dimensions == 3 || out[2] == 0));
    }
    assert_true(edges <= count / 100); /* beside the middle of a face that is as near as another */
  }
}

/* The layer of what lies between 0.1 and 0.2 outside, on a grid. */
static void extents_outside_are_those_of_layers(void **state) {
  (void)state;
  const double near = 0.1, far = 0.2, middle = 0.15, h = 0.02, room = 1;
  for (int n = 0; n < SOLIDS; n++) {
    const solid *s = &solids[n];
    const long side = lround(2 * room / h),
               count = s->dimensions == 3 ? side * side * side : side * side;
    long inside = 0;
    surface of;
    surface_open(&s->shape, &of);
    for (long k = 0; k < count; k++) {
      double p[3] = {h * ((double)(k % side) + 0.5) - room,
                     h * ((double)(k / side % side) + 0.5) - room, 0},
             out[3];
      if (s->dimensions == 3) p[2] = h * ((double)(k / side / side) + 0.5) - room;
      const double d = surface_distance(&of, p, out);
      inside += d > near && d < far;
    }
    const double layer = (double)inside * pow(h, s->dimensions) / (far - near),
                 is = surface_extent(&of, s->dimensions, middle);
    print_message("extent %.4f, of the layer %.4f\n", is, layer);
    assert_true(fabs(is / layer - 1) < 0.02);
  }
}

/* Each number tells one from another; rounding does not. */
static void numbers_tell_surfaces_apart(void **state) {
  (void)state;
  for (int n = 0; n < SOLIDS; n++) {
    double own[SURFACE_NUMBERS], other[SURFACE_NUMBERS];
    surface of;
    surface_open(&solids[n].shape, &of);
    surface_numbers(&of, own);
    for (int k = 0; k < SURFACE_NUMBERS; k++) {
      assert_true(isfinite(own[k]));
      memcpy(other, own, sizeof own);
      other[k] += 1e-6;
      assert_false(surface_is_alike(own, other));
      other[k] = own[k] * (1 + 1e-15);
      assert_true(k == 0 || surface_is_alike(own, other));
    }
  }
}

static void others_have_none(void **state) {
  (void)state;
  const deck_shape segment = {.kind = SHAPE_SEGMENT, .to = {1, 0}};
  surface of;
  assert_false(surface_open(&segment, &of));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(distances_are_those_of_the_shape),
      cmocka_unit_test(the_way_out_is_how_it_grows),
      cmocka_unit_test(extents_outside_are_those_of_layers),
      cmocka_unit_test(numbers_tell_surfaces_apart),
      cmocka_unit_test(others_have_none),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
