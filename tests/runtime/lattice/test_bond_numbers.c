/* Owners and numbers of bonds: unique on either side of every particle, and as few as there can be.
   */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/lattice/bond_numbers.h"
#include "tests/runtime/scattered_points.h"

static void check_numbers(const point_pairs *pairs, long particles) {
  numbered_bond *bonds = must_calloc((size_t)pairs->count + 1, sizeof *bonds);
  uint64_t *used = must_calloc(2 * (size_t)particles + 1, sizeof *used);
  int *side = must_calloc(2 * (size_t)particles + 1, sizeof *side), most = 0;
  const int numbers = bond_numbers(pairs, particles, bonds);
  for (long m = 0; m < pairs->count; m++) {
    const numbered_bond b = bonds[m];
    const point_pair ends = pairs->items[m];
    assert_true((b.owner == ends.i && b.other == ends.j) ||
                (b.owner == ends.j && b.other == ends.i));
    assert_true(b.number >= 0 && b.number < numbers);
    const uint64_t bit = UINT64_C(1) << b.number;
    assert_true((used[2 * b.owner] & bit) == 0 && (used[2 * b.other + 1] & bit) == 0);
    used[2 * b.owner] |= bit;
    used[2 * b.other + 1] |= bit;
    side[2 * b.owner]++;
    side[2 * b.other + 1]++;
  }
  for (long p = 0; p < particles; p++) {
    assert_true(abs(side[2 * p] - side[2 * p + 1]) <= 1); /* half of them are its own */
    for (int s = 0; s < 2; s++)
      most = side[2 * p + s] > most ? side[2 * p + s] : most;
  }
  assert_int_equal(numbers, most);
  free(bonds);
  free(used);
  free(side);
}

static void check_points(test_points p, int nearest, double distance) {
  point_pairs pairs = nearest > 0 ? pairs_of_nearest(&p.cloud, nearest, 128)
                                  : pairs_within(&p.cloud, distance, 128);
  assert_int_equal(pairs.crowded, -1);
  check_numbers(&pairs, p.cloud.count);
  free(pairs.items);
  points_free(&p);
}

static void points_anywhere(void **state) {
  (void)state;
  const double sides[3] = {1, 1, 1};
  for (uint64_t seed = 1; seed < 6; seed++) {
    check_points(points_drawn(2, 700, sides, seed), 3 * (int)seed, 0);
    check_points(points_drawn(3, 700, sides, seed), 3 * (int)seed, 0);
    check_points(points_drawn(2, 700, sides, seed), 0, 0.02 * (double)seed);
    check_points(points_drawn(3, 700, sides, seed), 0, 0.04 * (double)seed);
  }
}

/* Every particle inside has as many bonds as any: no number is to spare. */
static void lattices(void **state) {
  (void)state;
  check_points(points_hexagonal(60, 50, 0, 1), 0, 1.001);
  check_points(points_hexagonal(60, 50, 0, 1), 0, 1.75);
  check_points(points_hexagonal(60, 50, 0, 1), 0, 3.01);
  check_points(points_hexagonal(60, 50, 0.3, 4), 12, 0);
}

/* 128 bonds on each of 129 particles: all numbers there are. */
static void as_many_as_there_can_be(void **state) {
  (void)state;
  point_pairs pairs = {.crowded = -1};
  pairs.items = must_calloc(129 * 64, sizeof *pairs.items);
  for (int32_t i = 0; i < 129; i++)
    for (int32_t j = i + 1; j < 129; j++)
      pairs.items[pairs.count++] = (point_pair){i, j};
  check_numbers(&pairs, 129);
  numbered_bond *bonds = must_calloc((size_t)pairs.count, sizeof *bonds);
  assert_int_equal(bond_numbers(&pairs, 129, bonds), 64);
  free(bonds);
  free(pairs.items);
}

static void none_and_one(void **state) {
  (void)state;
  point_pair one = {0, 1};
  check_numbers(&(point_pairs){NULL, 0, -1}, 3);
  check_numbers(&(point_pairs){&one, 1, -1}, 2);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(points_anywhere),
      cmocka_unit_test(lattices),
      cmocka_unit_test(as_many_as_there_can_be),
      cmocka_unit_test(none_and_one),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
