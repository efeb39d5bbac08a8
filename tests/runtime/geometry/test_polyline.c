/* Polylines: lengths of legs, how many equal parts they have, and how far lines are apart. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "runtime/geometry/polyline.h"

static void legs_have_their_lengths(void **state) {
  (void)state;
  const double triangle[] = {0, 0, 3, 0, 3, 4};
  const double *from, *to;
  const polyline open = {2, 3, triangle, false}, closed = {2, 3, triangle, true};
  assert_int_equal(polyline_legs(&open), 2);
  assert_int_equal(polyline_legs(&closed), 3);
  assert_true(polyline_leg(&closed, 2, &from, &to) == 5);
  assert_ptr_equal(from, &triangle[4]);
  assert_ptr_equal(to, &triangle[0]);
  assert_true(polyline_length(&open) == 7 && polyline_length(&closed) == 12);
  const double stair[] = {0, 0, 0, 1, 2, 2, 1, 2, 8};
  const polyline space = {3, 3, stair, false};
  assert_true(polyline_length(&space) == 9);
}

static void parts_are_as_near_to_the_spacing_as_can_be(void **state) {
  (void)state;
  static const struct {
    double spacing;
    long parts;
  } known[] = {{1, 1}, {0.5, 2}, {0.1, 10}, {0.7, 1}, {0.6, 2}, {0.41, 2}, {0.39, 3}, {3, 1}};
  const double straight[] = {0, 0, 1, 0};
  const polyline p = {2, 2, straight, false};
  for (size_t k = 0; k < sizeof known / sizeof *known; k++)
    assert_int_equal(polyline_parts(&p, 0, known[k].spacing), known[k].parts);
}

/* By looking at many places of both. */
static double looked_apart(const polyline *p, const double shift[3]) {
  enum { PLACES = 200 };
  double least = INFINITY;
  for (int k = 0; k < polyline_legs(p); k++)
    for (int m = 0; m < polyline_legs(p); m++)
      for (int i = 0; i <= PLACES; i++)
        for (int j = 0; j <= PLACES; j++) {
          const double *from, *to, *of, *up_to, u = i / (double)PLACES, v = j / (double)PLACES;
          double square = 0;
          polyline_leg(p, k, &from, &to);
          polyline_leg(p, m, &of, &up_to);
          for (int a = 0; a < p->dimensions; a++) {
            const double way =
                from[a] + u * (to[a] - from[a]) - of[a] - v * (up_to[a] - of[a]) - shift[a];
            square += way * way;
          }
          least = fmin(least, square);
        }
  return sqrt(least);
}

static void lines_are_apart_as_their_nearest_places_are(void **state) {
  (void)state;
  static const double corner[] = {0, 0, 0, 1, 0.4, 1},
                      stair[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0.3, 1, 2};
  static const double shifts[][3] = {{0.1, 0, 0},     {0, 0.1, 0},      {0, 2, 0},
                                     {0.7, 0.3, 0.4}, {-0.3, 1.5, 0.8}, {0.2, -0.1, 0.05},
                                     {3, 0, -1}};
  for (int n = 0; n < 4; n++)
    for (size_t k = 0; k < sizeof shifts / sizeof *shifts; k++) {
      const polyline p = {2 + n / 2, 3 + n / 2, n / 2 ? stair : corner, n % 2};
      const double found = polyline_apart(&p, shifts[k]), looked = looked_apart(&p, shifts[k]);
      assert_true(found <= looked + 1e-15 && found > looked - 0.01);
    }
  const polyline straight = {2, 2, corner, false};
  assert_true(polyline_apart(&straight, shifts[0]) == 0.1 &&
              polyline_apart(&straight, shifts[1]) == 0);
  assert_true(polyline_apart(&straight, shifts[2]) == 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(legs_have_their_lengths),
      cmocka_unit_test(parts_are_as_near_to_the_spacing_as_can_be),
      cmocka_unit_test(lines_are_apart_as_their_nearest_places_are),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
