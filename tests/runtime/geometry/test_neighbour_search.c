/* The search for neighbours against a comparison of all points with all. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/runtime/scattered_points.h"

enum { ANY = 1 << 30 };

static double square_between(const point_cloud *c, long i, long j) {
  double square = 0;
  for (int a = 0; a < c->dimensions; a++)
    square += (c->at[a][i] - c->at[a][j]) * (c->at[a][i] - c->at[a][j]);
  return square;
}

/* b comes before a, seen from p. */
static bool comes_before(const point_cloud *c, long p, long b, long a) {
  const double to_a = square_between(c, p, a), to_b = square_between(c, p, b);
  if (to_a != to_b) return to_b < to_a;
  for (int k = 0; k < c->dimensions; k++)
    if (c->at[k][a] != c->at[k][b]) return c->at[k][b] < c->at[k][a];
  return b < a;
}

static bool is_among_nearest(const point_cloud *c, long p, long q, int nearest) {
  int before = 0;
  for (long b = 0; b < c->count; b++)
    before += b != p && b != q && comes_before(c, p, b, q);
  return before < nearest;
}

static void check_nearest(const point_cloud *c, int nearest) {
  point_pairs found = pairs_of_nearest(c, nearest, ANY);
  long at = 0;
  points_sort(&found);
  assert_int_equal(found.crowded, -1);
  for (long i = 0; i < c->count; i++)
    for (long j = i + 1; j < c->count; j++) {
      if (!is_among_nearest(c, i, j, nearest) && !is_among_nearest(c, j, i, nearest)) continue;
      assert_true(at < found.count);
      assert_int_equal(found.items[at].i, i);
      assert_int_equal(found.items[at].j, j);
      at++;
    }
  assert_int_equal(at, found.count);
  free(found.items);
}

static void check_within(const point_cloud *c, double distance) {
  point_pairs found = pairs_within(c, distance, ANY);
  long at = 0;
  points_sort(&found);
  assert_int_equal(found.crowded, -1);
  for (long i = 0; i < c->count; i++)
    for (long j = i + 1; j < c->count; j++) {
      if (square_between(c, i, j) > distance * distance) continue;
      assert_true(at < found.count);
      assert_true(found.items[at].i == i && found.items[at].j == j);
      at++;
    }
  assert_int_equal(at, found.count);
  free(found.items);
}

/* Of reaches of their own: the mean of both counts. */
static void check_within_own(const point_cloud *c) {
  enum { MOST = 150 };
  double reach[MOST];
  long at = 0;
  for (long k = 0; k < c->count; k++)
    reach[k] = 0.05 * (1 + (double)(k * k % 7));
  point_pairs found = pairs_within_own(c, reach, ANY);
  points_sort(&found);
  assert_int_equal(found.crowded, -1);
  for (long i = 0; i < c->count; i++)
    for (long j = i + 1; j < c->count; j++) {
      const double mean = 0.5 * (reach[i] + reach[j]);
      if (square_between(c, i, j) > mean * mean) continue;
      assert_true(at < found.count);
      assert_true(found.items[at].i == i && found.items[at].j == j);
      at++;
    }
  assert_int_equal(at, found.count);
  free(found.items);
}

static const double boxes[][3] = {{1, 1, 1}, {5, 0.2, 1}, {1, 0, 0}, {0, 2, 0.01}, {1e-3, 3e3, 1}};
enum { BOXES = sizeof boxes / sizeof *boxes };

static void agrees_with_all_against_all(void **state) {
  (void)state;
  for (int dimensions = 2; dimensions <= 3; dimensions++)
    for (int k = 0; k < BOXES; k++) {
      test_points p = points_drawn(dimensions, 150, boxes[k], 11 + (uint64_t)k);
      check_nearest(&p.cloud, 1);
      check_nearest(&p.cloud, 12);
      check_nearest(&p.cloud, 400);
      check_within_own(&p.cloud);
      for (double part = 1e-3; part < 10; part *= 5)
        check_within(&p.cloud, part * hypot(boxes[k][0], boxes[k][1]));
      points_free(&p);
    }
}

/* Most of the box is empty, a corner of it crowded. */
static void finds_what_stands_far_apart(void **state) {
  (void)state;
  test_points p = points_drawn(2, 200, boxes[0], 5);
  for (long k = 0; k < 190; k++)
    for (int a = 0; a < 2; a++)
      p.at[a][k] *= 1e-4;
  check_nearest(&p.cloud, 6);
  check_nearest(&p.cloud, 30);
  check_within(&p.cloud, 1e-4);
  check_within(&p.cloud, 0.7);
  points_free(&p);
}

/* Three of very many stand so far away that the others are as one point. Among these they change
   nothing. */
static void stragglers_do_not_matter(void **state) {
  (void)state;
  enum { CROWD = 2000, ALL = CROWD + 3, NEAREST = 7 };
  for (int dimensions = 2; dimensions <= 3; dimensions++) {
    test_points p = points_drawn(dimensions, ALL, boxes[0], 41);
    for (int a = 0; a < dimensions; a++) {
      p.at[a][CROWD] = 1e20 * (a + 1);
      p.at[a][CROWD + 1] = -3e7;
      p.at[a][CROWD + 2] = 5 - 2 * a;
    }
    point_cloud crowd = p.cloud;
    crowd.count = CROWD;
    point_pairs few = pairs_of_nearest(&crowd, NEAREST, ANY);
    point_pairs all = pairs_of_nearest(&p.cloud, NEAREST, ANY);
    points_sort(&few);
    points_sort(&all);
    long at = 0, far = 0;
    for (long m = 0; m < all.count; m++) {
      if (all.items[m].j < CROWD) {
        assert_true(at < few.count);
        assert_memory_equal(&all.items[m], &few.items[at++], sizeof *few.items);
        continue;
      }
      assert_true(is_among_nearest(&p.cloud, all.items[m].j, all.items[m].i, NEAREST) ||
                  is_among_nearest(&p.cloud, all.items[m].i, all.items[m].j, NEAREST));
      far++;
    }
    assert_int_equal(at, few.count);
    assert_true(far >= 3 * NEAREST - 3);
    free(few.items);
    free(all.items);
    check_within(&p.cloud, 0.05);
    check_within(&p.cloud, 7);
    points_free(&p);
  }
}

static void small_sets_are_served(void **state) {
  (void)state;
  for (long count = 0; count < 4; count++) {
    test_points p = points_drawn(3, count, boxes[0], 3);
    check_nearest(&p.cloud, 2);
    check_within(&p.cloud, 9);
    points_free(&p);
  }
}

/* On whole coordinates distances are equal to the last bit; k of them are not all. */
static void ties_do_not_depend_on_numbers(void **state) {
  (void)state;
  enum { SIDE = 12 };
  test_points p = points_new(2, SIDE * SIDE);
  for (long k = 0; k < SIDE * SIDE; k++) {
    p.at[0][k] = (double)(k % SIDE);
    p.at[1][k] = (double)(k / SIDE);
  }
  for (int nearest = 1; nearest < 14; nearest++) {
    check_nearest(&p.cloud, nearest);
    int32_t *to = points_shuffle(p.cloud.count, 17 + (uint64_t)nearest);
    test_points other = points_renumbered(&p, to);
    point_pairs one = pairs_of_nearest(&p.cloud, nearest, ANY);
    point_pairs two = pairs_of_nearest(&other.cloud, nearest, ANY);
    assert_int_equal(one.count, two.count);
    for (long m = 0; m < one.count; m++) {
      const int32_t i = to[one.items[m].i], j = to[one.items[m].j];
      one.items[m] = i < j ? (point_pair){i, j} : (point_pair){j, i};
    }
    points_sort(&one);
    points_sort(&two);
    assert_memory_equal(one.items, two.items, (size_t)one.count * sizeof *one.items);
    free(one.items);
    free(two.items);
    free(to);
    points_free(&other);
  }
  points_free(&p);
}

/* The bonds of a hexagonal lattice can be counted. */
static void shells_of_a_lattice(void **state) {
  (void)state;
  test_points p = points_hexagonal(20, 20, 0, 1);
  point_pairs found = pairs_within(&p.cloud, 1.001, ANY);
  assert_int_equal(found.count, 20 * 19 + 19 * 39); /* along rows, and between rows */
  free(found.items);
  found = pairs_within(&p.cloud, 0.999, ANY);
  assert_int_equal(found.count, 0);
  free(found.items);
  points_free(&p);
}

static void crowds_are_named(void **state) {
  (void)state;
  test_points p = points_drawn(2, 300, boxes[0], 23);
  point_pairs found = pairs_within(&p.cloud, 0.5, 128);
  assert_true(found.crowded >= 0);
  long near = -1;
  for (long k = 0; k < p.cloud.count; k++)
    near += square_between(&p.cloud, found.crowded, k) <= 0.25;
  assert_true(near > 128);
  free(found.items);
  found = pairs_of_nearest(&p.cloud, 129, 128);
  assert_true(found.crowded >= 0);
  free(found.items);
  points_free(&p);
}

static void near_some(void **state) {
  (void)state;
  enum { COUNT = 400, CHOSEN = 25 };
  for (int dimensions = 2; dimensions <= 3; dimensions++)
    for (double distance = 1e-3; distance < 3; distance *= 3) {
      test_points p = points_drawn(dimensions, COUNT, boxes[0], 31);
      int32_t *to = points_shuffle(COUNT, 7);
      unsigned char near[COUNT];
      points_near(&p.cloud, to, CHOSEN, distance, near);
      for (long k = 0; k < COUNT; k++) {
        bool expected = false;
        for (long c = 0; c < CHOSEN; c++)
          expected = expected || square_between(&p.cloud, k, to[c]) <= distance * distance;
        assert_int_equal(near[k], expected);
      }
      points_near(&p.cloud, to, 0, distance, near);
      for (long k = 0; k < COUNT; k++)
        assert_int_equal(near[k], 0);
      free(to);
      points_free(&p);
    }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(agrees_with_all_against_all),
      cmocka_unit_test(finds_what_stands_far_apart),
      cmocka_unit_test(stragglers_do_not_matter),
      cmocka_unit_test(small_sets_are_served),
      cmocka_unit_test(ties_do_not_depend_on_numbers),
      cmocka_unit_test(shells_of_a_lattice),
      cmocka_unit_test(crowds_are_named),
      cmocka_unit_test(near_some),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
