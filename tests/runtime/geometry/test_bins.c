/* Points in boxes: every point in the box that holds it, once, ascending; boxes of the size or the
   number of points that was asked for. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "runtime/base/random_number.h"
#include "runtime/geometry/bins.h"

enum { COUNT = 5000 };
static double x[COUNT], y[COUNT], z[COUNT];
static const double *const at[3] = {x, y, z};

static void scatter(double width, double height, double depth) {
  for (int k = 0; k < COUNT; k++) {
    x[k] = width * random_unit(random_mix((uint64_t)(3 * k)));
    y[k] = height * random_unit(random_mix((uint64_t)(3 * k + 1)));
    z[k] = depth * random_unit(random_mix((uint64_t)(3 * k + 2)));
  }
}

static void each_point_is_in_its_box(const bins *b) {
  const int64_t all = boxes_all(&b->boxes);
  assert_int_equal(b->first[0], 0);
  assert_int_equal(b->first[all], COUNT);
  for (int64_t n = 0; n < all; n++)
    for (int32_t m = b->first[n]; m < b->first[n + 1]; m++) {
      const int32_t k = b->point[m];
      const double p[3] = {x[k], y[k], b->boxes.dimensions == 3 ? z[k] : 0};
      int box[3];
      boxes_home(&b->boxes, p, box);
      assert_int_equal(boxes_number(&b->boxes, box), n);
      assert_true(m == b->first[n] || b->point[m - 1] < k);
      for (int a = 0; a < b->boxes.dimensions; a++) {
        const double low = b->boxes.lower[a] + box[a] * b->boxes.size;
        assert_true(p[a] > low - 1e-9 || box[a] == 0);
        assert_true(p[a] < low + b->boxes.size + 1e-9 || box[a] == b->boxes.count[a] - 1);
      }
    }
}

static void boxes_of_a_size(void **state) {
  (void)state;
  bins b;
  scatter(10, 4, 7);
  bins_of_size(&b, 3, at, COUNT, 1);
  assert_true(b.boxes.size == 1);
  assert_int_equal(boxes_all(&b.boxes), 10 * 4 * 7);
  each_point_is_in_its_box(&b);
  bins_end(&b);
  bins_of_size(&b, 2, at, COUNT, 1e-6); /* so many boxes would serve nobody */
  assert_true(boxes_all(&b.boxes) <= 4 * COUNT + 64 && b.boxes.count[2] == 1);
  each_point_is_in_its_box(&b);
  bins_end(&b);
}

/* Also where all points lie in a plane, or on a line. */
static void boxes_of_a_few(void **state) {
  (void)state;
  bins b;
  for (int flat = 0; flat < 3; flat++) {
    scatter(10, flat > 1 ? 0 : 4, flat > 0 ? 0 : 7);
    bins_of_few(&b, 3, at, COUNT, 2);
    const double mean = (double)COUNT / (double)boxes_all(&b.boxes);
    assert_true(mean > 1.5 && mean < 2.5);
    each_point_is_in_its_box(&b);
    bins_end(&b);
  }
}

static void what_lies_outside_is_in_the_nearest_box(void **state) {
  (void)state;
  const boxes b = {.dimensions = 2, .lower = {1, 2}, .size = 0.5, .count = {4, 3, 1}};
  int box[3];
  boxes_home(&b, (const double[3]){-1e300, 1e300, 5}, box);
  assert_true(box[0] == 0 && box[1] == 2 && box[2] == 0);
  assert_int_equal(boxes_number(&b, box), 8);
  assert_int_equal(boxes_number(&b, (const int[3]){4, 0, 0}), -1);
  assert_int_equal(boxes_number(&b, (const int[3]){0, -1, 0}), -1);
  assert_int_equal(boxes_along(&b, 0, 2.1), 2);
}

/* One point far away must not make the boxes large. */
static void a_stray_point_does_not_count(void **state) {
  (void)state;
  bins b;
  scatter(10, 10, 10);
  x[77] = 1e6;
  bins_of_few(&b, 2, at, COUNT, 2);
  assert_true(b.boxes.size < 0.3);
  each_point_is_in_its_box(&b);
  bins_end(&b);
}

static void few_points_all_count(void **state) {
  (void)state;
  bins b;
  scatter(1, 1, 1);
  x[0] = -2;
  x[3] = 1e9;
  bins_of_size(&b, 2, at, 4, 1);
  assert_true(b.boxes.lower[0] == -2 && b.boxes.count[0] * b.boxes.size > 1e9);
  bins_end(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(boxes_of_a_size), cmocka_unit_test(boxes_of_a_few),
      cmocka_unit_test(what_lies_outside_is_in_the_nearest_box),
      cmocka_unit_test(a_stray_point_does_not_count), cmocka_unit_test(few_points_all_count)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
