/* Polylines: lengths of legs, and how many equal parts they have. */
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

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(legs_have_their_lengths),
      cmocka_unit_test(parts_are_as_near_to_the_spacing_as_can_be),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
