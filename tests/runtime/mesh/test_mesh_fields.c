/* A linear field of the nodes is itself at every point, in element-free, blended and finite
   cells. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#include "dsl/base/arena.h"
#include "runtime/mesh/mesh_fields.h"

static const double SLOPE[2][2] = {{2, -1}, {0.5, 3}}, OFFSET[2] = {7, -2};

static double linear(int d, const double at[2]) {
  return OFFSET[d] + SLOPE[d][0] * at[0] + SLOPE[d][1] * at[1];
}

static void open_mixed(mesh *m) {
  mesh_open(m, (const int[2]){12, 9}, (const double[2]){0, 0}, (const double[2]){1.1, 0.8}, 1, 2.1);
  for (int n = 0; n < mesh_node_count(m); n++)
    m->element_free[n] = n % 12 > 4;
  mesh_settle(m);
}

static void test_linear_field(void **state) {
  mesh m;
  double *nodes[2], at[2], value[2], gradient[2][2], strain[3];
  point_shape s;
  (void)state;
  open_mixed(&m);
  const node_layout l = node_layout_of(m.nodes, m.support);
  for (int d = 0; d < 2; d++) {
    nodes[d] = must_calloc((size_t)l.size, sizeof(double));
    for (int n = 0; n < mesh_node_count(&m); n++) {
      mesh_place(&m, n, at);
      nodes[d][node_layout_at(&l, n)] = linear(d, at);
    }
  }
  for (int k = 0; k < 60; k++) {
    const double x[2] = {1.1 * fmod(0.618 * k, 1), 0.8 * fmod(0.755 * k, 1)};
    assert_true(shape_functions(&m, mesh_cell_of(&m, x), x, &s));
    mesh_field(&s, &l, (const double *const *)nodes, value, gradient);
    mesh_strain(gradient, strain);
    for (int d = 0; d < 2; d++) {
      assert_true(fabs(value[d] - linear(d, x)) <= 1e-12);
      for (int b = 0; b < 2; b++)
        assert_true(fabs(gradient[d][b] - SLOPE[d][b]) <= 1e-11);
    }
    assert_true(fabs(strain[2] - (0.5 * (SLOPE[0][1] + SLOPE[1][0]))) <= 1e-11);
  }
  mesh_close(&m);
  free(nodes[0]);
  free(nodes[1]);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_linear_field)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
