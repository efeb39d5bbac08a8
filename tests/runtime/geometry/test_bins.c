/* Points sorted into boxes: each is in the box of its place, once, whatever lies far away. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/geometry/bins.h"
#include "tests/runtime/scattered_points.h"

/* Each point is in one box, numbers ascend in each, and all within a box's size are in the boxes around. */
static void check_boxes(const test_points *p, double size) {
  const long count = p->cloud.count;
  const int dimensions = p->cloud.dimensions;
  unsigned char *seen = must_calloc((size_t)count, 1);
  bins b;
  bins_begin(&b, dimensions, p->at, count, size);
  assert_true(b.size >= size && (dimensions == 3 || b.count[2] == 1));
  for (int z = 0; z < b.count[2]; z++)
    for (int y = 0; y < b.count[1]; y++)
      for (int x = 0; x < b.count[0]; x++) {
        int64_t from, to;
        assert_true(bins_points(&b, (int[]){x, y, z}, &from, &to));
        for (int64_t n = from; n < to; n++) {
          const int64_t k = b.point[n];
          int box[3];
          assert_true(n == from || b.point[n - 1] < k);
          bins_box(&b, (double[]){p->at[0][k], p->at[1][k], dimensions == 3 ? p->at[2][k] : 0},
                   box);
          assert_true(box[0] == x && box[1] == y && box[2] == z);
          assert_int_equal(seen[k]++, 0);
        }
      }
  for (long k = 0; k < count; k++)
    assert_int_equal(seen[k], 1);
  int64_t from, to;
  assert_false(bins_points(&b, (int[]){-1, 0, 0}, &from, &to));
  assert_false(bins_points(&b, (int[]){0, b.count[1], 0}, &from, &to));
  bins_end(&b);
  free(seen);
}

static void every_point_is_in_one_box(void **state) {
  (void)state;
  static const double sides[3] = {3, 1, 2};
  for (int dimensions = 2; dimensions <= 3; dimensions++) {
    test_points p = points_drawn(dimensions, 3000, sides, 7);
    check_boxes(&p, 0.1);
    check_boxes(&p, 10);   /* all in one */
    check_boxes(&p, 1e-6); /* boxes are made larger */
    p.at[0][17] = 1e6;     /* one that lies far away */
    check_boxes(&p, 0.1);
    points_free(&p);
  }
}

/* Boxes stay about as many as points, though one of these is a million times as far away as all others. */
static void one_far_point_does_not_make_boxes_large(void **state) {
  (void)state;
  static const double sides[3] = {1, 1, 1};
  test_points p = points_drawn(2, 5000, sides, 3);
  double range[2];
  bins b;
  p.at[0][100] = 1e6;
  bins_range(p.at[0], 5000, range);
  assert_true(range[0] >= 0 && range[1] > 0.99 && range[1] < 1.2);
  bins_begin(&b, 2, p.at, 5000, 0.02);
  assert_true(b.size < 0.021 && b.count[0] > 45);
  bins_end(&b);
  points_free(&p);
}

static void the_range_of_few_points_holds_all(void **state) {
  (void)state;
  double range[2];
  bins_range((double[]){3, -2, 1e9, 4}, 4, range);
  assert_true(range[0] == -2 && range[1] == 1e9);
  bins_range(NULL, 0, range);
  assert_true(range[0] == 0 && range[1] == 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_point_is_in_one_box),
      cmocka_unit_test(one_far_point_does_not_make_boxes_large),
      cmocka_unit_test(the_range_of_few_points_holds_all),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
