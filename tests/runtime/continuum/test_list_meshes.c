/* Meshes of lists with linear laws: patch tests, order of convergence, the matrix beside points,
   the cell that holds a place, the highest frequency, what is loose. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "hooke_law.h"
#include "list_cases.h"
#include "mesh_cases.h"
#include "runtime/continuum/frequency_limit.h"
#include "runtime/continuum/node_factors.h"
#include "runtime/continuum/node_masses.h"
#include "runtime/continuum/point_forces.h"
#include "runtime/continuum/static_solution.h"
#include "runtime/mesh/element_strips.h"
#include "runtime/mesh/mesh_fields.h"

static const int kinds[] = {3, 4, 6, MIXED};

typedef struct solved { /* a mesh and its solution */
  list_mesh of;
  plane_stiffness law;
  node_matrix K;
  unsigned char *held;
  double *u[2], *force[2], *reaction[2];
} solved;

static void open_case(solved *s, int n, int kind, double part, int gauss) {
  list_open(&s->of, n, kind, part, gauss);
  s->law = isotropic(1, 0.3, false);
  node_matrix_open(&s->K, &s->of.m, &s->of.points, &s->law, NULL);
  const size_t nodes = (size_t)mesh_node_count(&s->of.m);
  s->held = must_calloc(2 * nodes, 1);
  for (int d = 0; d < 2; d++) {
    s->u[d] = must_calloc(nodes, sizeof(double));
    s->force[d] = must_calloc(nodes, sizeof(double));
    s->reaction[d] = must_calloc(nodes, sizeof(double));
  }
}

static void close_case(solved *s) {
  for (int d = 0; d < 2; d++) {
    free(s->u[d]);
    free(s->force[d]);
    free(s->reaction[d]);
  }
  free(s->held);
  node_matrix_close(&s->K);
  list_close(&s->of);
}

typedef void field(const double at[2], double u[2], double gradient[2][2]);

static static_result solve(solved *s, field *edge) {
  static_result r;
  for (int n = 0; n < s->K.nodes; n++) {
    double at[2], u[2], gradient[2][2];
    if (!list_on_edge(&s->of, n)) continue;
    mesh_place(&s->of.m, n, at);
    edge(at, u, gradient);
    for (int d = 0; d < 2; d++) {
      s->held[2 * n + d] = 1;
      s->u[d][n] = u[d];
    }
  }
  static_factors *f = static_factors_of_matrix(&s->K, s->held, &r);
  assert_non_null(f);
  r = static_factors_solve(f, (const double *const *)s->force, s->u, s->reaction);
  static_factors_free(f);
  return r;
}

/* Root of the integrals of the squared error: of displacements, and of strains in the energy. */
static void errors(const solved *s, field *exact, double *of_u, double *of_energy) {
  const mesh *m = &s->of.m;
  *of_u = *of_energy = 0;
  for (int c = 0; c < mesh_cell_count(m); c++) {
    static const double place[] = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                                   0.9061798459386640},
                        part[] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                  0.4786286704993665, 0.2369268850561891};
    double corner[ELEMENT_MOST_NODES][2];
    const int nodes = m->lists->nodes[c];
    cell_lists_places(m->lists, c, corner);
    for (int k = 0; k < 25; k++) { /* of a triangle: the square with one side drawn together */
      const double a = place[k % 5], b = place[k / 5];
      const double u = nodes == 4 ? a : 0.5 * (1 + a),
                   v = nodes == 4 ? b : 0.25 * (1 + b) * (1 - a);
      double at[2], n[ELEMENT_MOST_NODES], g[ELEMENT_MOST_NODES][2], x[2], gradient[2][2], e[3];
      const double here[2] = {u, v},
                   area = part[k % 5] * part[k / 5] * (nodes == 4 ? 1 : 0.125 * (1 - a)) *
                          element_map(nodes, (const double(*)[2])corner, here, at, NULL);
      element_gradients(nodes, (const double(*)[2])corner, here, n, g);
      exact(at, x, gradient);
      for (int q = 0; q < nodes; q++)
        for (int d = 0; d < 2; d++) {
          const double value = s->u[d][m->lists->cell[c][q]];
          x[d] -= n[q] * value;
          for (int i = 0; i < 2; i++)
            gradient[d][i] -= g[q][i] * value;
        }
      *of_u += area * (x[0] * x[0] + x[1] * x[1]);
      mesh_strain(gradient, e);
      e[2] *= 2;
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
          *of_energy += 0.5 * area * e[i] * s->law.D[i][j] * e[j];
    }
  }
  *of_u = sqrt(*of_u);
  *of_energy = sqrt(*of_energy);
}

/* --- patches ---------------------------------------------------------------------------------- */

static void linear(const double at[2], double u[2], double gradient[2][2]) {
  u[0] = 0.1 + 0.3 * at[0] - 0.2 * at[1];
  u[1] = -0.2 + 0.4 * at[0] + 0.5 * at[1];
  gradient[0][0] = 0.3;
  gradient[0][1] = -0.2;
  gradient[1][0] = 0.4;
  gradient[1][1] = 0.5;
}

/* The same with the mean dilatation. */
static void take_means(solved *s) {
  memset(s->of.m.mean_dilatation, 1, (size_t)mesh_cell_count(&s->of.m));
  node_matrix_close(&s->K);
  node_matrix_open(&s->K, &s->of.m, &s->of.points, &s->law, NULL);
}

/* The same with one point and what resists hourglass modes. */
static void resist_modes(solved *s) {
  for (int c = 0; c < mesh_cell_count(&s->of.m); c++)
    s->of.m.hourglass[c] = 0.3;
  node_matrix_resist_hourglass(&s->K, &s->of.m, &s->law, NULL);
}

static void patches_are_exact(void **state) {
  (void)state;
  for (int k = 0; k < 12; k++) {
    solved s;
    double of_u, of_energy;
    open_case(&s, 5, kinds[k % 4], 0.4, k < 8 ? 2 : 1);
    if (k / 4 == 1) take_means(&s);
    if (k / 4 == 2) resist_modes(&s);
    const static_result r = solve(&s, linear);
    errors(&s, linear, &of_u, &of_energy);
    assert_true(r.solved && r.residual < 1e-13);
    assert_true(of_u < 1e-14 && of_energy < 1e-13);
    close_case(&s);
  }
}

/* Bending, sigma_xx = y: displacements are quadratic, and triangles of 6 nodes with straight sides
   have them. */
static void bending(const double at[2], double u[2], double gradient[2][2]) {
  u[0] = at[0] * at[1];
  u[1] = -0.5 * at[0] * at[0] - 0.5 * 0.3 * at[1] * at[1];
  gradient[0][0] = at[1];
  gradient[0][1] = at[0];
  gradient[1][0] = -at[0];
  gradient[1][1] = -0.3 * at[1];
}

static void quadratic_triangles_bend_exactly(void **state) {
  (void)state;
  solved s;
  double of_u, of_energy;
  open_case(&s, 4, 6, 0.4, 2);
  solve(&s, bending);
  errors(&s, bending, &of_u, &of_energy);
  assert_true(of_u < 1e-14 && of_energy < 1e-13);
  close_case(&s);
}

/* A square that hardly changes its volume and is bent: quadrilaterals lock unless they take the
   mean dilatation. The energy over that of the exact field, which is a bound from below:
   displacements are prescribed all around. */
static void bent_without_volume(const double at[2], double u[2], double gradient[2][2]) {
  u[0] = at[0] * at[1];
  u[1] = -0.5 * at[0] * at[0] - 0.5 * at[1] * at[1];
  gradient[0][0] = at[1];
  gradient[0][1] = at[0];
  gradient[1][0] = -at[0];
  gradient[1][1] = -at[1];
}

static void the_mean_dilatation_unlocks(void **state) {
  (void)state;
  double energy[2];
  for (int means = 0; means < 2; means++) {
    solved s;
    open_case(&s, 8, 4, 0.2, 2);
    s.law = isotropic(1, 0.49999, true);
    node_matrix_close(&s.K);
    node_matrix_open(&s.K, &s.of.m, &s.of.points, &s.law, NULL);
    if (means) take_means(&s);
    energy[means] = solve(&s, bent_without_volume).energy;
    close_case(&s);
  }
  /* E/(1 + nu) integral of (eps_xx^2 + eps_yy^2)/2 t = 1/1.49999 * 1/3 * 1/2 */
  const double exact = 1 / 1.49999 / 6;
  print_message("energy over the exact one: %.4f, with the mean dilatation %.4f\n",
                energy[0] / exact, energy[1] / exact);
  assert_true(energy[0] > 2 * exact && fabs(energy[1] / exact - 1) < 0.05);
}

/* --- convergence ------------------------------------------------------------------------------ */

/* In balance without forces: of the complex potentials phi = e^z, psi = 0 (Kolosov and
   Muskhelishvili), 2 mu (u + i v) = kappa phi - z conj(phi'). */
static void of_potentials(const double at[2], double u[2], double gradient[2][2]) {
  const double nu = 0.3, mu = 1 / (2 * (1 + nu)), kappa = (3 - nu) / (1 + nu), x = at[0], y = at[1],
               e = exp(x), c = cos(y), s = sin(y), by = 1 / (2 * mu);
  u[0] = by * e * (kappa * c - x * c - y * s);
  u[1] = by * e * (kappa * s + x * s - y * c);
  gradient[0][0] = by * e * ((kappa - 1 - x) * c - y * s);
  gradient[0][1] = by * e * (-(kappa + 1 - x) * s - y * c);
  gradient[1][0] = by * e * ((kappa + 1 + x) * s - y * c);
  gradient[1][1] = by * e * ((kappa - 1 + x) * c + y * s);
}

/* Orders: of displacements, of strains. */
static void converges(int kind, double order_u, double order_energy) {
  double of_u[2], of_energy[2];
  for (int k = 0; k < 2; k++) {
    solved s;
    open_case(&s, k ? 32 : 16, kind, 0.3, 2);
    solve(&s, of_potentials);
    errors(&s, of_potentials, &of_u[k], &of_energy[k]);
    close_case(&s);
  }
  const double found[2] = {log2(of_u[0] / of_u[1]), log2(of_energy[0] / of_energy[1])};
  print_message("kind %d: orders %.3f, %.3f (errors %.3g, %.3g)\n", kind, found[0], found[1],
                of_u[1], of_energy[1]);
  assert_true(fabs(found[0] - order_u) < 0.1 && fabs(found[1] - order_energy) < 0.1);
}

static void errors_fall_as_they_are_to(void **state) {
  (void)state;
  converges(3, 2, 1);
  converges(4, 2, 1);
  converges(6, 3, 2);
}

/* --- other ways ------------------------------------------------------------------------------- */

static double draw(int k) {
  return random_unit(random_mix((uint64_t)k)) - 0.5;
}

/* Forces by points, of a third of the cells and of the others one by one, are those of the matrix;
   the third has another law. */
static void points_and_matrix_agree(void **state) {
  (void)state;
  static const double values[2][3] = {{30e9, 0.2, 2400}, {4e9, 0.35, 2400}};
  for (int k = 0; k < 4; k++)
    for (int way = 0; way < 4; way++) { /* 1 x 1, 2 x 2, with the mean, hourglass */
      list_mesh l;
      list_open(&l, 7, kinds[k], 0.4, way % 3 == 0 ? 1 : 2);
      for (int c = 0; c < mesh_cell_count(&l.m); c++)
        l.m.hourglass[c] = way == 3 ? 0.05 : 0;
      memset(l.m.mean_dilatation, way == 2, (size_t)mesh_cell_count(&l.m));
      const plane_stiffness law[2] = {isotropic(30e9, 0.2, false), isotropic(4e9, 0.35, false)};
      const int cells = mesh_cell_count(&l.m);
      unsigned char *own[2] = {must_calloc((size_t)cells, 1), must_calloc((size_t)cells, 1)};
      for (int c = 0; c < cells; c++)
        own[c % 3 == 0][c] = 1;
      node_matrix K;
      node_matrix_open(&K, &l.m, &l.points, law, own[1]);
      node_matrix_resist_hourglass(&K, &l.m, law, own[1]);
      pool *memory = pool_new();
      double *u[2], *by_points[2], *by_matrix[2], most = 0, largest = 0;
      for (int d = 0; d < 2; d++) {
        u[d] = pool_doubles(memory, K.layout.size);
        by_points[d] = pool_doubles(memory, K.layout.size);
        by_matrix[d] = pool_doubles(memory, K.layout.size);
        for (int n = 0; n < K.nodes; n++)
          u[d][node_layout_at(&K.layout, n)] = 1e-4 * draw(2 * n + d);
      }
      const point_motion at = {(const double *const *)u, (const double *const *)u, 0, 1, 0};
      node_matrix_multiply(&K, at.displacement, by_matrix, 0, l.m.nodes[1]);
      for (int part = 0; part < 2; part++) {
        point_forces *p =
            point_forces_new(&l.m, own[part], &l.points, &hooke_law, values[part], 1, true);
        point_forces_find(p, 0, 0, l.m.nodes[1], &at, part == 1, NULL);
        for (int row = 0; row < l.m.nodes[1]; row++)
          point_forces_take(p, row, part == 1, by_points);
        point_forces_free(p);
      }
      for (int n = 0; n < K.nodes; n++)
        for (int d = 0; d < 2; d++) {
          const long site = node_layout_at(&K.layout, n);
          most = fmax(most, fabs(by_points[d][site] - by_matrix[d][site]));
          largest = fmax(largest, fabs(by_matrix[d][site]));
        }
      assert_true(largest > 0 && most < 1e-13 * largest);
      pool_free(memory);
      node_matrix_close(&K);
      free(own[0]);
      free(own[1]);
      list_close(&l);
    }
}

static void cells_of_places_are_found(void **state) {
  (void)state;
  for (int k = 0; k < 4; k++) {
    list_mesh l;
    list_open(&l, 9, kinds[k], 0.4, 2);
    for (int n = 0; n < 500; n++) {
      const double at[2] = {draw(2 * n) + 0.5, draw(2 * n + 1) + 0.5};
      double u[2], back[2], corner[ELEMENT_MOST_NODES][2];
      const int cell = cell_lists_find(l.m.lists, at, u);
      assert_true(cell >= 0 && cell == mesh_cell_of(&l.m, at));
      assert_true(element_outside(l.m.lists->nodes[cell], u) < 1e-9);
      cell_lists_places(l.m.lists, cell, corner);
      element_map(l.m.lists->nodes[cell], (const double(*)[2])corner, u, back, NULL);
      assert_true(fabs(back[0] - at[0]) < 1e-14 && fabs(back[1] - at[1]) < 1e-14);
    }
    assert_int_equal(mesh_cell_of(&l.m, (const double[2]){1.001, 0.5}), -1);
    assert_int_equal(mesh_cell_of(&l.m, (const double[2]){NAN, 0.5}), -1);
    assert_true(mesh_cell_of(&l.m, (const double[2]){1, 1}) >= 0);
    list_close(&l);
  }
}

/* Masses sum to that of the square; all are positive. */
/* Parallel cells that lie aslant, 4000 times as long as wide: boxes of their mean side would hold
   most of them each. */
static void slivers_lie_in_few_boxes(void **state) {
  (void)state;
  enum { SLIVERS = 400 };
  static double at[2 * SLIVERS + 2][2];
  static cell_nodes cell[SLIVERS];
  static unsigned char nodes[SLIVERS];
  for (int k = 0; k <= SLIVERS; k++)
    for (int end = 0; end < 2; end++) {
      at[2 * k + end][0] = end + k / (4000.0 * 1.41421356);
      at[2 * k + end][1] = end - k / (4000.0 * 1.41421356);
    }
  for (int32_t k = 0; k < SLIVERS; k++) {
    const int32_t of[] = {2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1};
    memcpy(cell[k], of, sizeof of);
    nodes[k] = 4;
  }
  cell_lists *l = cell_lists_new(2 * SLIVERS + 2, (const double(*)[2])at, SLIVERS, nodes, cell);
  assert_true(l->first_in[(long)l->boxes[0] * l->boxes[1]] <= 16 * SLIVERS);
  for (int k = 0; k < SLIVERS; k++) {
    const double there[2] = {0.3 + (k + 0.5) / (4000.0 * 1.41421356),
                             0.3 - (k + 0.5) / (4000.0 * 1.41421356)};
    double u[2];
    assert_int_equal(cell_lists_find(l, there, u), k);
    assert_true(fabs(u[0]) < 1e-9 && fabs(u[1] + 0.4) < 1e-9);
  }
  cell_lists_free(l);
}

static void masses_are_those_of_the_body(void **state) {
  (void)state;
  for (int k = 0; k < 4; k++) {
    list_mesh l;
    const double density = 3;
    list_open(&l, 6, kinds[k], 0.4, 2);
    double *mass = must_calloc((size_t)mesh_node_count(&l.m), sizeof *mass), sum = 0;
    node_masses(&l.m, &l.points, &density, NULL, mass);
    for (int n = 0; n < l.m.lists->node_count; n++) {
      assert_true(mass[n] > 0);
      sum += mass[n];
    }
    assert_true(fabs(sum - 3 * 0.5) < 1e-13);
    free(mass);
    list_close(&l);
  }
}

/* A free square with E = 1, nu = 0, t = 1/2 and a mass of 1 at each corner: the highest modes are
   uniform strains, u = +-1/2 at the corners, for which u K u = t E = 1/2 and u M u = 1. */
static void the_highest_frequency_is_known(void **state) {
  (void)state;
  list_mesh l;
  node_matrix K;
  const plane_stiffness law = isotropic(1, 0, false);
  list_open(&l, 1, 4, 0, 2);
  node_matrix_open(&K, &l.m, &l.points, &law, NULL);
  const size_t nodes = (size_t)mesh_node_count(&l.m);
  double *mass = must_calloc(nodes, sizeof *mass);
  unsigned char *held = must_calloc(2 * nodes, 1);
  for (int n = 0; n < 4; n++)
    mass[n] = 1;
  const double omega = frequency_limit_of_matrix(&K, mass, held);
  assert_true(fabs(omega - sqrt(0.5)) < 1e-9);
  free(mass);
  free(held);
  node_matrix_close(&K);
  list_close(&l);
}

static void what_is_loose_is_named(void **state) {
  (void)state;
  solved s;
  static_result r;
  open_case(&s, 3, 3, 0.2, 2);
  s.held[0] = s.held[1] = 1; /* it can turn */
  assert_null(static_factors_of_matrix(&s.K, s.held, &r));
  assert_true(!r.solved && r.loose >= 0 && r.loose < s.K.nodes);
  int other = 1;
  double a[2], b[2];
  mesh_place(&s.of.m, 0, a);
  for (mesh_place(&s.of.m, other, b); fabs(a[0] - b[0]) < 0.1;)
    mesh_place(&s.of.m, ++other, b);
  s.held[2 * other + 1] = 1;
  static_factors *f = static_factors_of_matrix(&s.K, s.held, &r);
  assert_non_null(f);
  static_factors_free(f);
  close_case(&s);
}

/* A body that can turn, of many meshes: rounding makes its last pivot small, of either sign. */
static void what_can_turn_is_loose_in_any_mesh(void **state) {
  (void)state;
  int lost = 0;
  for (int n = 1; n <= 8; n++)
    for (int k = 0; k < 4; k++) {
      solved s;
      long loose = -1;
      open_case(&s, n, kinds[k], 0.4, 2);
      const int at = 7 * n % s.K.nodes;
      s.held[2 * at] = s.held[2 * at + 1] = 1;
      cholesky *f = node_factors_new(&s.K, s.held, &loose);
      assert_null(f);
      assert_true(loose >= 0 && loose < 2 * s.K.nodes && !s.held[loose]);
      s.held[2 * at] = 0; /* it can go, too */
      assert_null(node_factors_new(&s.K, s.held, &loose));
      lost++;
      close_case(&s);
    }
  assert_int_equal(lost, 32);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(patches_are_exact),
      cmocka_unit_test(quadratic_triangles_bend_exactly),
      cmocka_unit_test(the_mean_dilatation_unlocks),
      cmocka_unit_test(errors_fall_as_they_are_to),
      cmocka_unit_test(points_and_matrix_agree),
      cmocka_unit_test(cells_of_places_are_found),
      cmocka_unit_test(slivers_lie_in_few_boxes),
      cmocka_unit_test(masses_are_those_of_the_body),
      cmocka_unit_test(the_highest_frequency_is_known),
      cmocka_unit_test(what_can_turn_is_loose_in_any_mesh),
      cmocka_unit_test(what_is_loose_is_named),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
