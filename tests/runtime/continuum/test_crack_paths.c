/* The points of a crack that has grown at both ends, in their order; pieces of one leg are one. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/continuum/crack_paths.h"

static const double points[] = {1, 0, 2, 0, 3, 1};
static const deck_crack slit = {.name = "slit", .points = points, .point_count = 3};
static const pl_law some_law = {.abi = PL_KERNEL_ABI};

typedef struct grown {
  tips tips;
  mesh_tip items[2];
  crack_piece pieces[8];
  int32_t tip[8];
  unsigned char leg[8];
} grown;

static void begin(grown *g) {
  memset(g, 0, sizeof *g);
  g->items[0] = (mesh_tip){.of = &slit, .at_start = true, .number = 0, .law = &some_law};
  g->items[1] = (mesh_tip){.of = &slit, .at_start = false, .number = 1, .law = &some_law};
  g->tips = (tips){.items = g->items, .count = 2, .check_steps = 10, .planned = {10}};
  g->tips.pieces.items = g->pieces;
  g->tips.pieces.tip = g->tip;
  g->tips.pieces.leg = g->leg;
}

static void add(grown *g, int tip, bool leg, double ax, double ay, double bx, double by) {
  const int64_t n = g->tips.pieces.count++;
  g->pieces[n] = (crack_piece){{ax, ay}, {bx, by}};
  g->tip[n] = tip;
  g->leg[n] = leg;
}

static void is_path(const grown *g, const double *wanted, int count) {
  double at[16][2];
  assert_int_equal(crack_path(&g->tips, &slit, at, 16), count);
  assert_memory_equal(at, wanted, 2 * (size_t)count * sizeof *wanted);
}

static void points_come_from_the_first_to_the_last(void **state) {
  (void)state;
  grown g;
  begin(&g);
  is_path(&g, points, 3);
  add(&g, 1, true, 3, 1, 3, 2);
  is_path(&g, (const double[]){1, 0, 2, 0, 3, 1, 3, 2}, 4);
  add(&g, 0, true, 1, 0, 0.5, 0);
  add(&g, 1, false, 3, 2, 3, 3); /* on along the same leg */
  add(&g, 0, true, 0.5, 0, 0, -1);
  is_path(&g, (const double[]){0, -1, 0.5, 0, 1, 0, 2, 0, 3, 1, 3, 3}, 6);
}

static void there_is_room_for_all_that_can_grow(void **state) {
  (void)state;
  grown g;
  double at[4][2];
  begin(&g);
  assert_int_equal(crack_path_most(&g.tips, &slit, 100), 3 + 2 * 11);
  g.items[0].law = NULL; /* it does not grow */
  assert_int_equal(crack_path_most(&g.tips, &slit, 100), 3 + 11);
  assert_int_equal(crack_path_most(&g.tips, &slit, INT64_MAX), 3 + TIPS_MOST_PIECES);
  add(&g, 1, true, 3, 1, 3, 2);
  add(&g, 1, true, 3, 2, 4, 4);
  assert_int_equal(crack_path(&g.tips, &slit, at, 4), 4); /* not one more */
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(points_come_from_the_first_to_the_last),
                                     cmocka_unit_test(there_is_room_for_all_that_can_grow)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
