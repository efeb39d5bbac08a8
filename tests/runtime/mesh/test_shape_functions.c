/* What acts at a point of a mesh: values known from elsewhere, sums, gradients, edges, mirrors. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "runtime/base/random_number.h"
#include "runtime/mesh/crack_lines.h"
#include "runtime/mesh/integration_points.h"
#include "runtime/mesh/mesh.h"
#include "runtime/mesh/moving_least_squares.h"
#include "runtime/mesh/shape_functions.h"

/* 41 x 41 nodes at (-20 .. 20)^2, all element-free. */
static void open_unit(mesh *m, double support) {
  mesh_open(m, (int[2]){41, 41}, (double[2]){-20, -20}, (double[2]){40, 40}, 1, support);
}

static int unit_node(const mesh *m, int i, int j) {
  return mesh_node(m, i + 20, j + 20);
}

static void shape_at(const mesh *m, double x, double y, point_shape *s) {
  const double at[2] = {x, y};
  assert_true(shape_functions(m, mesh_cell_of(m, at), at, s));
}

static int place_of(const point_shape *s, int node) {
  for (int k = 0; k < s->count; k++)
    if (s->node[k] == node) return k;
  return -1;
}

static void is(const mesh *m, const point_shape *s, int i, int j, double n, double nx, double ny) {
  const int k = place_of(s, unit_node(m, i, j));
  assert_true(k >= 0);
  assert_true(fabs(s->n[k] - n) <= 0.51e-6);
  assert_true(fabs(s->nx[k] - nx) <= 0.51e-6);
  assert_true(fabs(s->ny[k] - ny) <= 0.51e-6);
}

static int acting(const point_shape *s) {
  int count = 0;
  for (int k = 0; k < s->count; k++)
    count += s->n[k] != 0;
  return count;
}

/* Figures of a program of its own, to six digits. */
static void known_values(void **state) {
  (void)state;
  mesh m;
  point_shape s;
  const double a[2] = {-20, 0.5}, b[2] = {0.45, 0.5};
  open_unit(&m, 2.1);
  shape_at(&m, 0.3, 0.4, &s);
  assert_int_equal(acting(&s), 16);
  is(&m, &s, 0, 0, .297266, -.213058, -.280650);
  is(&m, &s, 1, 0, .184473, .316425, -.174161);
  crack_lines_add(&m.cracks, a, b);
  shape_at(&m, 0.3, 0.4, &s);
  assert_int_equal(s.count, 9);
  is(&m, &s, 0, 0, .777643, -.589328, .474652);
  is(&m, &s, 1, 0, .417615, .309880, -.092945);
  assert_true(fabs(s.n[place_of(&s, unit_node(&m, 2, 1))] - .043477) <= 0.51e-6);
  assert_int_equal(place_of(&s, unit_node(&m, 1, 1)), -1);
  mesh_close(&m);
  open_unit(&m, 3.5);
  shape_at(&m, 0.3, 0.4, &s);
  assert_int_equal(acting(&s), 49);
  is(&m, &s, 0, 0, .129551, -.034364, -.044715);
  crack_lines_add(&m.cracks, a, b);
  shape_at(&m, 0.3, 0.4, &s);
  assert_int_equal(s.count, 31);
  is(&m, &s, 0, 0, .371476, -.150662, .170798);
  mesh_close(&m);
}

static void known_value_of_the_enriched_basis(void **state) {
  (void)state;
  mesh m;
  point_shape s;
  static double tip[1][2] = {{0.45, 0.5}};
  open_unit(&m, 2.1);
  m.enriched = 10; /* all within half of it: the enriched functions alone */
  m.cracks.tips = tip;
  m.cracks.tip_count = 1;
  shape_at(&m, 0.3, 0.4, &s);
  is(&m, &s, 0, 0, 1.056604, .083522, -1.161908);
  m.cracks.tips = NULL;
  m.cracks.tip_count = 0;
  mesh_close(&m);
}

static double draw(uint64_t *k) {
  return random_unit(random_mix((*k)++));
}

/* 13 x 9 nodes, a corner of finite elements, two cracks. */
static void open_mixed(mesh *m, bool cracks) {
  mesh_open(m, (int[2]){13, 9}, (double[2]){0.1, -0.2}, (double[2]){2.4, 1.2}, 0.1, 2.6);
  for (int j = 0; j < 9; j++)
    for (int i = 0; i < 13; i++)
      if (i < 4 || (i > 9 && j < 3)) m->element_free[mesh_node(m, i, j)] = 0;
  mesh_settle(m);
  if (!cracks) return;
  crack_lines_add(&m->cracks, (double[2]){1.23, -0.2}, (double[2]){1.23, 0.33});
  crack_lines_add(&m->cracks, (double[2]){1.23, 0.33}, (double[2]){1.41, 0.52});
}

static void reproduces(const mesh *m, const point_shape *s, const double at[2]) {
  double one[3] = {0}, x[3] = {0}, y[3] = {0}, place[2];
  for (int k = 0; k < s->count; k++) {
    const double of[3] = {s->n[k], s->nx[k], s->ny[k]};
    mesh_place(m, s->node[k], place);
    for (int d = 0; d < 3; d++) {
      one[d] += of[d];
      x[d] += of[d] * place[0];
      y[d] += of[d] * place[1];
    }
  }
  assert_true(fabs(one[0] - 1) < 1e-12 && fabs(one[1]) < 1e-11 && fabs(one[2]) < 1e-11);
  assert_true(fabs(x[0] - at[0]) < 1e-12 && fabs(x[1] - 1) < 1e-11 && fabs(x[2]) < 1e-11);
  assert_true(fabs(y[0] - at[1]) < 1e-12 && fabs(y[1]) < 1e-11 && fabs(y[2] - 1) < 1e-11);
}

static void linear_fields_are_reproduced(void **state) {
  (void)state;
  uint64_t seed = 1;
  for (int cracks = 0; cracks < 2; cracks++) {
    mesh m;
    point_shape s;
    open_mixed(&m, cracks);
    for (int smooth = 0; smooth < 2; smooth++) {
      m.smooth_ramp = smooth;
      for (int k = 0; k < 2000; k++) {
        const double at[2] = {0.1 + 2.4 * draw(&seed), -0.2 + 1.2 * draw(&seed)};
        shape_functions(&m, mesh_cell_of(&m, at), at, &s);
        reproduces(&m, &s, at);
      }
    }
    mesh_close(&m);
  }
}

static void gradients_are_those_of_the_values(void **state) {
  (void)state;
  uint64_t seed = 2;
  mesh m;
  point_shape s, side[2];
  open_mixed(&m, false);
  m.smooth_ramp = true;
  for (int k = 0; k < 300; k++) {
    const double at[2] = {0.1 + 2.4 * draw(&seed), -0.2 + 1.2 * draw(&seed)}, by = 1e-6;
    const int cell = mesh_cell_of(&m, at);
    shape_functions(&m, cell, at, &s);
    for (int d = 0; d < 2; d++) {
      for (int up = 0; up < 2; up++) {
        double there[2] = {at[0], at[1]};
        there[d] += up ? by : -by;
        shape_functions(&m, cell, there, &side[up]);
      }
      for (int q = 0; q < s.count; q++) {
        const int low = place_of(&side[0], s.node[q]), high = place_of(&side[1], s.node[q]);
        if (low < 0 || high < 0) continue;
        const double slope = (side[1].n[high] - side[0].n[low]) / (2 * by);
        assert_true(fabs(slope - (d ? s.ny[q] : s.nx[q])) < 2e-7 / m.spacing[d]);
      }
    }
  }
  mesh_close(&m);
}

/* The values of all nodes at an edge, from the cell below and the one above it. */
static void cells_agree_on_their_edges(void **state) {
  (void)state;
  uint64_t seed = 3;
  mesh m;
  open_mixed(&m, true);
  for (int j = 1; j < 8; j++)
    for (int i = 0; i < 12; i++)
      for (int axis = 0; axis < 2; axis++) {
        if (axis && i == 0) continue;
        const int here = mesh_cell_at(&m, i, j),
                  other = axis ? mesh_cell_at(&m, i - 1, j) : mesh_cell_at(&m, i, j - 1);
        const double u = draw(&seed);
        const double at[2] = {mesh_at(&m, 0, i) + (axis ? 0 : u * m.spacing[0]),
                              mesh_at(&m, 1, j) + (axis ? u * m.spacing[1] : 0)};
        point_shape a, b;
        shape_functions(&m, here, at, &a);
        shape_functions(&m, other, at, &b);
        for (int k = 0; k < a.count; k++) {
          const int there = place_of(&b, a.node[k]);
          assert_true(fabs(a.n[k] - (there < 0 ? 0 : b.n[there])) < 1e-12);
        }
      }
  mesh_close(&m);
}

static void a_mirrored_point_has_mirrored_functions(void **state) {
  (void)state;
  uint64_t seed = 4;
  mesh m;
  point_shape a, b;
  open_unit(&m, 3.5);
  for (int k = 0; k < 100; k++) {
    const double x = 10 * draw(&seed) - 5, y = 10 * draw(&seed) - 5;
    shape_at(&m, x, y, &a);
    shape_at(&m, y, -x, &b); /* turned by -90 degrees */
    assert_int_equal(a.count, b.count);
    for (int q = 0; q < a.count; q++) {
      const int i = a.node[q] % 41 - 20, j = a.node[q] / 41 - 20;
      const int there = place_of(&b, unit_node(&m, j, -i));
      assert_true(there >= 0);
      assert_true(fabs(a.n[q] - b.n[there]) < 1e-13);
      assert_true(fabs(a.nx[q] + b.ny[there]) < 1e-13);
      assert_true(fabs(a.ny[q] - b.nx[there]) < 1e-13);
    }
  }
  mesh_close(&m);
}

/* Where cracks leave too few nodes the point sees all of them, and says so. */
static void a_walled_in_point_ignores_cracks(void **state) {
  (void)state;
  mesh m;
  point_shape s;
  const double corner[4][2] = {{0.1, 0.1}, {0.6, 0.1}, {0.6, 0.6}, {0.1, 0.6}}, at[2] = {0.3, 0.3};
  open_unit(&m, 2.1);
  for (int k = 0; k < 4; k++)
    crack_lines_add(&m.cracks, corner[k], corner[(k + 1) % 4]);
  assert_false(shape_functions(&m, mesh_cell_of(&m, at), at, &s));
  assert_int_equal(acting(&s), 16);
  reproduces(&m, &s, at);
  mesh_close(&m);
}

static void points_fill_the_mesh(void **state) {
  (void)state;
  mesh m;
  integration_points p;
  open_mixed(&m, false);
  m.element_gauss[0] = 1;
  m.gauss_parts = 2;
  integration_points_open(&p, &m);
  double area = 0, moment = 0;
  for (int k = 0; k < p.count; k++) {
    assert_int_equal(mesh_cell_of(&m, p.at[k]), p.cell[k]);
    assert_true(k >= p.first[p.cell[k]] && k < p.first[p.cell[k] + 1]);
    area += p.area[k];
    moment += p.area[k] * p.at[k][0] * p.at[k][1];
  }
  assert_int_equal(p.first[1], 1);
  assert_int_equal(p.first[mesh_cell_at(&m, 6, 6) + 1] - p.first[mesh_cell_at(&m, 6, 6)], 64);
  assert_true(fabs(area - 2.4 * 1.2) < 1e-12);
  assert_true(fabs(moment - 2.4 * 1.2 * 1.3 * 0.4) < 1e-12);
  integration_points_close(&p);
  mesh_close(&m);
}

/* Exact for polynomials up to degree 2n - 1. */
static void rules_are_exact(void **state) {
  (void)state;
  for (int order = 1; order <= MESH_MOST_GAUSS; order++) {
    double at[MESH_MOST_GAUSS], weight[MESH_MOST_GAUSS];
    gauss_rule(order, at, weight);
    for (int degree = 0; degree < 2 * order; degree++) {
      double sum = 0;
      for (int k = 0; k < order; k++)
        sum += weight[k] * pow(at[k], degree);
      assert_true(fabs(sum - (degree % 2 ? 0 : 2.0 / (degree + 1))) < 1e-14);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(known_values),
      cmocka_unit_test(known_value_of_the_enriched_basis),
      cmocka_unit_test(linear_fields_are_reproduced),
      cmocka_unit_test(gradients_are_those_of_the_values),
      cmocka_unit_test(cells_agree_on_their_edges),
      cmocka_unit_test(a_mirrored_point_has_mirrored_functions),
      cmocka_unit_test(a_walled_in_point_ignores_cracks),
      cmocka_unit_test(points_fill_the_mesh),
      cmocka_unit_test(rules_are_exact),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
