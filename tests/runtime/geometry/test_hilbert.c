/* The Hilbert curve: it visits every cell of a grid once, and each step leads to a cell beside the
   last one. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/geometry/hilbert.h"
#include "tests/runtime/scattered_points.h"

enum { SIDE_BITS = 3, SIDE = 1 << SIDE_BITS, MOST = SIDE * SIDE * SIDE };

typedef struct visited {
  uint64_t place;
  int cell[3];
} visited;

static int by_place(const void *p, const void *q) {
  const visited *a = p, *b = q;
  return (a->place > b->place) - (a->place < b->place);
}

static void each_step_leads_to_a_neighbour(void **state) {
  (void)state;
  for (int dimensions = 2; dimensions <= 3; dimensions++) {
    const int count = dimensions == 2 ? SIDE * SIDE : MOST;
    visited all[MOST];
    for (int k = 0; k < count; k++) {
      all[k] = (visited){.cell = {k % SIDE, k / SIDE % SIDE, k / SIDE / SIDE}};
      uint32_t cell[3];
      for (int a = 0; a < 3; a++)
        cell[a] = (uint32_t)all[k].cell[a] << (HILBERT_BITS - SIDE_BITS);
      all[k].place = hilbert_place(dimensions, cell);
    }
    qsort(all, (size_t)count, sizeof *all, by_place);
    for (int k = 1; k < count; k++) {
      int steps = 0;
      for (int a = 0; a < 3; a++)
        steps += abs(all[k].cell[a] - all[k - 1].cell[a]);
      assert_true(all[k].place > all[k - 1].place);
      assert_int_equal(steps, 1);
    }
  }
}

/* A permutation that follows the points, whatever their numbers; points on one place are no harm.
   */
static void order_is_that_of_the_places(void **state) {
  (void)state;
  enum { COUNT = 500 };
  for (int dimensions = 2; dimensions <= 3; dimensions++) {
    test_points p = points_drawn(dimensions, COUNT, (const double[3]){1, 3, 0.1}, 8);
    int32_t *to = points_shuffle(COUNT, 5), order[COUNT], other[COUNT];
    test_points q = points_renumbered(&p, to);
    bool seen[COUNT] = {false};
    hilbert_order(&p.cloud, order);
    hilbert_order(&q.cloud, other);
    for (long k = 0; k < COUNT; k++) {
      assert_false(seen[order[k]]);
      seen[order[k]] = true;
      assert_int_equal(other[k], to[order[k]]);
    }
    points_free(&p);
    points_free(&q);
    free(to);
  }
  test_points one = points_new(2, 3);
  int32_t order[3];
  hilbert_order(&one.cloud, order);
  for (int k = 0; k < 3; k++)
    assert_int_equal(order[k], k);
  points_free(&one);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(each_step_leads_to_a_neighbour),
      cmocka_unit_test(order_is_that_of_the_places),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
