/* Values on a grid: what is a product of straight lines along the axes is met exactly, wherever the
   places stand in the table; a grid with a hole or a double node is none. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/lattice/place_grid.h"

enum { NX = 4, NY = 3, NZ = 2, NODES = NX * NY * NZ };
static const double X[NX] = {-1, 0, 0.5, 3}, Y[NY] = {2, 2.25, 4}, Z[NZ] = {0, 1};

static double trilinear(double x, double y, double z) {
  return (1 + 2 * x) * (3 - y) * (z - 5);
}

/* The nodes in an order of no meaning. */
static void fill(place_table *t, int dimensions, int nodes, double *room) {
  *t = (place_table){.dimensions = dimensions, .count = nodes};
  for (int c = 0; c < dimensions; c++)
    t->at[c] = room + c * NODES;
  t->value = room + 3 * NODES;
  for (int n = 0; n < nodes; n++) {
    const int k = n * 7 % nodes; /* no node count here is a multiple of 7 */
    const double x = X[k % NX], y = Y[k / NX % NY], z = dimensions == 3 ? Z[k / NX / NY] : 0;
    t->at[0][n] = x;
    t->at[1][n] = y;
    if (dimensions == 3) t->at[2][n] = z;
    t->value[n] = trilinear(x, y, z);
  }
}

static void products_are_exact(void **state) {
  (void)state;
  double room[4 * NODES];
  for (int dimensions = 2; dimensions <= 3; dimensions++) {
    place_table t;
    place_grid g;
    diagnostics d;
    source_set sources = {0};
    diag_begin(&d, &sources);
    fill(&t, dimensions, dimensions == 3 ? NODES : NX * NY, room);
    assert_true(place_grid_open(&g, &t, (span){0, 0, 0}, &d));
    for (int k = 0; k < 200; k++) {
      const double at[3] = {-1 + 4 * fmod(0.618 * k, 1), 2 + 2 * fmod(0.755 * k, 1),
                            dimensions == 3 ? fmod(0.57 * k, 1) : 0};
      assert_true(place_grid_holds(&g, at));
      assert_true(fabs(place_grid_at(&g, at) - trilinear(at[0], at[1], at[2])) <= 1e-12);
    }
    for (long n = 0; n < t.count; n++) {
      const double at[3] = {t.at[0][n], t.at[1][n], dimensions == 3 ? t.at[2][n] : 0};
      assert_true(place_grid_at(&g, at) == t.value[n]);
    }
    assert_false(place_grid_holds(&g, (const double[]){-1.1, 3, 0.5}));
    assert_false(place_grid_holds(&g, (const double[]){0, 4.1, 0.5}));
    assert_int_equal(place_grid_holds(&g, (const double[]){0, 3, 1.1}), dimensions == 2);
    place_grid_free(&g);
    diag_clear(&d);
  }
}

static void check_refused(place_table *t, const char *what) {
  place_grid g;
  diagnostics d;
  source_set sources = {0};
  diag_begin(&d, &sources);
  assert_false(place_grid_open(&g, t, (span){0, 0, 0}, &d));
  assert_int_equal(d.errors, 1);
  assert_non_null(strstr(d.items[0].message, what));
  place_grid_free(&g);
  diag_clear(&d);
}

static void what_is_no_grid_is_told(void **state) {
  (void)state;
  double room[4 * NODES];
  place_table t;
  fill(&t, 2, NX * NY, room);
  t.count--;
  check_refused(&t, "there is no value at");
  fill(&t, 2, NX * NY, room);
  t.at[0][1] = t.at[0][0];
  t.at[1][1] = t.at[1][0];
  check_refused(&t, "there are two values at");
  t.count = 0;
  check_refused(&t, "no values");
}

/* Scattered places are far from a grid. */
static void scattered_places_are_refused(void **state) {
  (void)state;
  enum { MANY = 1000 };
  static double at[2][MANY], value[MANY];
  place_table t = {.dimensions = 2, .count = MANY, .at = {at[0], at[1]}, .value = value};
  for (int k = 0; k < MANY; k++) {
    at[0][k] = fmod(0.618 * k, 1);
    at[1][k] = fmod(0.755 * k * k, 1);
  }
  check_refused(&t, "no rectangular grid");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(products_are_exact),
                                     cmocka_unit_test(what_is_no_grid_is_told),
                                     cmocka_unit_test(scattered_places_are_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
