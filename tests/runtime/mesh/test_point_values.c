/* What is linear at the nodes is linear at the points of integration of all kinds of cells. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "dsl/base/arena.h"
#include "runtime/mesh/point_values.h"

static double linear(const double at[2]) {
  return 7 + 2 * at[0] - 3 * at[1];
}

static void a_linear_field_stays_linear(void **state) {
  mesh m;
  integration_points p;
  point_values v;
  double at[2];
  (void)state;
  mesh_open(&m, (const int[2]){12, 9}, (const double[2]){0, 0}, (const double[2]){1.1, 0.8}, 1,
            2.1);
  for (int n = 0; n < mesh_node_count(&m); n++)
    m.element_free[n] = n % 12 > 4;
  mesh_settle(&m);
  integration_points_open(&p, &m);
  point_values_open(&v, &m, &p);
  double *nodes = must_calloc((size_t)mesh_node_count(&m), sizeof *nodes);
  for (int n = 0; n < mesh_node_count(&m); n++) {
    mesh_place(&m, n, at);
    nodes[n] = linear(at);
  }
  assert_true(p.count > 300);
  for (int n = 0; n < p.count; n++)
    assert_true(fabs(point_values_at(&v, n, nodes) - linear(p.at[n])) <= 1e-12);
  free(nodes);
  point_values_close(&v);
  integration_points_close(&p);
  mesh_close(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_linear_field_stays_linear)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
