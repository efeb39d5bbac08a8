/* Static solutions: patch tests, energies of a cracked plate, growth of a crack, convergence. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "mesh_cases.h"
#include "runtime/base/random_number.h"
#include "runtime/continuum/frequency_limit.h"
#include "runtime/continuum/node_masses.h"
#include "runtime/continuum/static_solution.h"
#include "runtime/mesh/shape_functions.h"

static double larger_of(double a, double b) {
  return a > b ? a : b;
}

static static_result solve(case_mesh *c) {
  return static_solution(&c->K, c->held, (const double *const *)c->force, c->u, c->reaction);
}

/* --- patch tests ------------------------------------------------------------------------------ */

/* 0.1 m x 0.05 m pulled by 1 MPa on its long edges. */
static void open_patch(case_mesh *c, int gauss) {
  mesh_open(&c->m, (int[2]){31, 16}, (double[2]){0, 0}, (double[2]){0.1, 0.05}, 1, 3.5);
  c->law = isotropic(200e9, 0.3, false);
  c->m.gauss = gauss;
}

static void pull_patch(case_mesh *c) {
  double up[2] = {0, 1e6}, down[2] = {0, -1e6};
  const int nx = c->m.nodes[0], ny = c->m.nodes[1];
  line_load(&c->m, (double[2]){0, 0.05}, (double[2]){0.1, 0.05}, constant_traction, up, c->force);
  line_load(&c->m, (double[2]){0, 0}, (double[2]){0.1, 0}, constant_traction, down, c->force);
  const int mid = mesh_node(&c->m, nx / 2, 0), top = mesh_node(&c->m, nx / 2, ny - 1);
  c->held[2 * mid] = c->held[2 * mid + 1] = c->held[2 * top] = 1;
}

/* The largest error of u = (-nu s x/E, s y/E) over the largest displacement. */
static double patch_error(const case_mesh *c) {
  double most = 0, at[2], point_u[2];
  point_shape s;
  uint64_t seed = 7;
  for (int k = 0; k < 2000; k++) {
    for (int d = 0; d < 2; d++)
      at[d] = (d ? 0.05 : 0.1) * random_unit(random_mix(seed++));
    shape_functions(&c->m, mesh_cell_of(&c->m, at), at, &s);
    point_u[0] = point_u[1] = 0;
    for (int q = 0; q < s.count; q++)
      for (int d = 0; d < 2; d++)
        point_u[d] += s.n[q] * c->u[d][s.node[q]];
    const double exact[2] = {-0.3 * 1e6 / 200e9 * (at[0] - 0.05), 1e6 / 200e9 * at[1]};
    for (int d = 0; d < 2; d++)
      most = larger_of(most, fabs(point_u[d] - exact[d]));
  }
  return most / 2.5e-7;
}

static void elements_pass_the_patch_test(void **state) {
  (void)state;
  case_mesh c = {0};
  open_patch(&c, 4);
  memset(c.m.element_free, 0, (size_t)mesh_node_count(&c.m));
  case_settle(&c);
  assert_int_equal(c.K.reach, 1);
  pull_patch(&c);
  const static_result r = solve(&c);
  assert_true(r.solved && r.residual < 1e-11);
  assert_true(patch_error(&c) < 1e-10);
  assert_true(fabs(r.energy - 0.5 * 1e6 * 1e6 / 200e9 * 0.1 * 0.05) < 1e-9 * r.energy);
  case_close(&c);
}

/* Zones of both methods side by side, corners included. *corner: of the node at the upper right. */
static double blended_error(int gauss, double *corner) {
  case_mesh c = {0};
  double at[2];
  open_patch(&c, gauss);
  for (int n = 0; n < mesh_node_count(&c.m); n++) {
    mesh_place(&c.m, n, at);
    const bool edge = at[1] < 1e-9 || at[1] > 0.05 - 1e-9;
    if (at[0] <= 0.02 + 1e-9 || at[0] >= 0.09 - 1e-9 ||
        (edge && at[0] > 0.04 - 1e-9 && at[0] < 0.06 + 1e-9))
      c.m.element_free[n] = 0;
  }
  case_settle(&c);
  pull_patch(&c);
  assert_true(solve(&c).solved);
  const int node = mesh_node(&c.m, 30, 15);
  const double error = patch_error(&c);
  *corner = larger_of(fabs(c.u[0][node] + 7.5e-8), fabs(c.u[1][node] - 2.5e-7)) / 2.5e-7;
  case_close(&c);
  return error;
}

static void zones_pass_the_patch_test_to_quadrature(void **state) {
  (void)state;
  double corner, fine_corner;
  const double usual = blended_error(4, &corner), fine = blended_error(6, &fine_corner);
  print_message("patch test of zones, corner and worst: 4 x 4 points %.2g %.2g, 6 x 6 %.2g %.2g\n",
                corner, usual, fine_corner, fine);
  assert_true(corner < 1e-5 && usual < 5e-5);
  assert_true(fine_corner < 3e-6 && fine < 0.2 * usual);
}

/* --- quadrilaterals --------------------------------------------------------------------------- */

static const double skew[4][2] = {{0.01, -0.02}, {0.12, 0.01}, {0.09, 0.08}, {-0.01, 0.05}};

static void open_skew(case_mesh *c, int gauss) {
  mesh_open_mapped(&c->m, (int[2]){9, 7}, skew, 0.03, 2.1);
  memset(c->m.element_gauss, gauss, (size_t)mesh_cell_count(&c->m));
  c->law = isotropic(200e9, 0.3, false);
  case_settle(c);
}

static double linear_field(int component, const double at[2]) {
  return component ? 2e-4 - 3e-3 * at[0] + 1e-3 * at[1] : 1e-4 + 2e-3 * at[0] - 4e-3 * at[1];
}

/* Prescribed on the border: inside, and at any place, it is the solution. */
static void a_skew_mesh_passes_the_patch_test(void **state) {
  (void)state;
  for (int gauss = 1; gauss <= 2; gauss++) {
    case_mesh c = {0};
    double at[2], most = 0;
    open_skew(&c, gauss);
    for (int n = 0; n < mesh_node_count(&c.m); n++) {
      const int i = n % 9, j = n / 9;
      mesh_place(&c.m, n, at);
      for (int d = 0; d < 2 && (i == 0 || j == 0 || i == 8 || j == 6); d++) {
        c.held[2 * n + d] = 1;
        c.u[d][n] = linear_field(d, at);
      }
    }
    assert_true(solve(&c).solved);
    for (int k = 0; k < 500; k++) {
      const double u[2] = {random_unit(random_mix((uint64_t)k)),
                           random_unit(random_mix((uint64_t)k + 1000))};
      double slope[2][2], gradient[2][2] = {{0}}, value[2] = {0};
      point_shape s;
      quadrilateral_map(skew, u, at, slope);
      shape_functions(&c.m, mesh_cell_of(&c.m, at), at, &s);
      for (int q = 0; q < s.count; q++)
        for (int d = 0; d < 2; d++) {
          value[d] += s.n[q] * c.u[d][s.node[q]];
          gradient[d][0] += s.nx[q] * c.u[d][s.node[q]];
          gradient[d][1] += s.ny[q] * c.u[d][s.node[q]];
        }
      for (int d = 0; d < 2; d++)
        most = larger_of(most, fabs(value[d] - linear_field(d, at)) / 1e-3);
      most = larger_of(most, fabs(gradient[0][0] - 2e-3) / 2e-3);
      most = larger_of(most, fabs(gradient[0][1] + 4e-3) / 4e-3);
      most = larger_of(most, fabs(gradient[1][0] + 3e-3) / 3e-3);
    }
    assert_true(most < 1e-10);
    case_close(&c);
  }
}

/* Area by the points; a traction on a slanted edge, and on a line across the cells, as a whole and
   its moment. */
static void a_skew_mesh_weighs_and_bears_what_it_should(void **state) {
  (void)state;
  case_mesh c = {0};
  double area = 0, push[2] = {3, -2}, sum[2], moment, at[2];
  open_skew(&c, 2);
  for (int n = 0; n < c.points.count; n++)
    area += c.points.area[n];
  assert_true(fabs(area - quadrilateral_area(skew)) < 1e-14 * area);
  const double lines[2][2][2] = {{{0.12, 0.01}, {0.09, 0.08}}, {{0.02, 0.0}, {0.08, 0.06}}};
  for (int k = 0; k < 2; k++) {
    const double *from = lines[k][0], *to = lines[k][1],
                 length = hypot(to[0] - from[0], to[1] - from[1]);
    for (int d = 0; d < 2; d++)
      memset(c.force[d], 0, (size_t)mesh_node_count(&c.m) * sizeof(double));
    assert_true(fabs(line_load(&c.m, from, to, constant_traction, push, c.force) - length) <
                1e-12 * length);
    sum[0] = sum[1] = moment = 0;
    for (int n = 0; n < mesh_node_count(&c.m); n++) {
      mesh_place(&c.m, n, at);
      sum[0] += c.force[0][n];
      sum[1] += c.force[1][n];
      moment += at[0] * c.force[1][n] - at[1] * c.force[0][n];
    }
    const double middle[2] = {0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])};
    assert_true(fabs(sum[0] - 3 * 0.03 * length) < 1e-14);
    assert_true(fabs(sum[1] + 2 * 0.03 * length) < 1e-14);
    assert_true(fabs(moment - (middle[0] * sum[1] - middle[1] * sum[0])) < 1e-15);
  }
  case_close(&c);
}

/* --- a cracked plate -------------------------------------------------------------------------- */

/* 1 x 3, crack of 0.475 from the left at mid height, pulled by 1. */
static void open_cracked(case_mesh *c, double support) {
  mesh_open(&c->m, (int[2]){41, 122}, (double[2]){0, -1.5}, (double[2]){1, 3}, 1, support);
  c->law = isotropic(1, 0.3, false);
}

static void pull_cracked(case_mesh *c) {
  double up[2] = {0, 1}, down[2] = {0, -1};
  line_load(&c->m, (double[2]){0, 1.5}, (double[2]){1, 1.5}, constant_traction, up, c->force);
  line_load(&c->m, (double[2]){0, -1.5}, (double[2]){1, -1.5}, constant_traction, down, c->force);
  const int low = mesh_node(&c->m, 40, 0), high = mesh_node(&c->m, 40, 121);
  c->held[2 * low] = c->held[2 * low + 1] = c->held[2 * high] = 1;
}

static double cracked_energy(double support) {
  case_mesh c = {0};
  open_cracked(&c, support);
  crack_lines_add(&c.m.cracks, (double[2]){0, 0}, (double[2]){0.475, 0});
  case_settle(&c);
  pull_cracked(&c);
  const static_result r = solve(&c);
  assert_true(r.solved && r.residual < 1e-9);
  assert_int_equal(c.K.blind, 0);
  case_close(&c);
  return r.energy;
}

/* Figures of a program of its own. */
static void a_cracked_plate_stores_the_known_energy(void **state) {
  (void)state;
  const double narrow = cracked_energy(2.1), wide = cracked_energy(3.5);
  print_message("energy of the cracked plate: %.5f and %.5f\n", narrow, wide);
  assert_true(fabs(narrow - 2.80654) < 1e-3 * 2.80654);
  assert_true(fabs(wide - 2.98933) < 1e-3 * 2.98933);
}

static double largest_gap(const node_stencil *a, const node_stencil *b) {
  double most = 0, size = 0;
  assert_int_equal(a->block_count, b->block_count);
  for (long k = 0; k < a->block_count; k++) {
    most = larger_of(most, fabs(a->blocks[k] - b->blocks[k]));
    size = larger_of(size, fabs(b->blocks[k]));
  }
  return most / size;
}

static void growth_in_pieces_is_assembly_afresh(void **state) {
  (void)state;
  case_mesh c = {0};
  node_stencil fresh;
  static double tip[1][2] = {{0, 0.013}};
  open_cracked(&c, 3.5);
  c.m.enriched = 0;
  case_settle(&c);
  double at[2] = {0, 0.013};
  int changed = 0;
  for (int k = 0; k < 12; k++) {
    const double to[2] = {at[0] + 0.031, at[1] + 0.017 * (k % 3)};
    changed += node_stencil_grow(&c.K, &c.m, at, to, -1);
    memcpy(at, to, sizeof at);
  }
  assert_true(changed > 0 && changed < c.points.count / 2);
  node_stencil_open(&fresh, &c.m, &c.points, &c.law, NULL);
  const double gap = largest_gap(&c.K, &fresh);
  print_message("after %d changed points of %d: %.2g of the largest entry\n", changed,
                c.points.count, gap);
  assert_true(gap < 1e-12);
  node_stencil_close(&fresh);
  case_close(&c);
  /* with an enriched basis the tip moves along */
  c = (case_mesh){0};
  open_cracked(&c, 3.5);
  c.m.enriched = 0.1;
  c.m.cracks.tips = tip;
  c.m.cracks.tip_count = 1;
  case_settle(&c);
  memcpy(at, tip[0], sizeof at);
  for (int k = 0; k < 4; k++) {
    const double to[2] = {at[0] + 0.031, at[1] + 0.017 * (k % 3)};
    node_stencil_grow(&c.K, &c.m, at, to, 0);
    memcpy(at, to, sizeof at);
  }
  assert_true(tip[0][0] == at[0]);
  node_stencil_open(&fresh, &c.m, &c.points, &c.law, NULL);
  assert_true(largest_gap(&c.K, &fresh) < 1e-12);
  node_stencil_close(&fresh);
  c.m.cracks.tips = NULL;
  case_close(&c);
}

/* --- the stencil ------------------------------------------------------------------------------ */

/* Forces as sums of B^T sigma over the points. */
static void point_forces(const case_mesh *c, double *const f[2]) {
  point_shape s;
  for (int n = 0; n < c->points.count; n++) {
    double e[3] = {0}, sigma[3] = {0};
    shape_functions(&c->m, c->points.cell[n], c->points.at[n], &s);
    for (int q = 0; q < s.count; q++) {
      e[0] += s.nx[q] * c->u[0][s.node[q]];
      e[1] += s.ny[q] * c->u[1][s.node[q]];
      e[2] += s.ny[q] * c->u[0][s.node[q]] + s.nx[q] * c->u[1][s.node[q]];
    }
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++)
        sigma[a] += c->law.D[a][b] * e[b] * c->m.thickness * c->points.area[n];
    for (int q = 0; q < s.count; q++) {
      f[0][s.node[q]] += s.nx[q] * sigma[0] + s.ny[q] * sigma[2];
      f[1][s.node[q]] += s.ny[q] * sigma[1] + s.nx[q] * sigma[2];
    }
  }
}

static void stencil_forces(const case_mesh *c, double *const f[2]) {
  const node_layout *l = &c->K.layout;
  pool *memory = pool_new();
  double *u[2], *product[2];
  for (int d = 0; d < 2; d++) {
    u[d] = pool_doubles(memory, l->size);
    product[d] = pool_doubles(memory, l->size);
    for (int n = 0; n < mesh_node_count(&c->m); n++)
      u[d][node_layout_at(l, n)] = c->u[d][n];
  }
  node_stencil_multiply(&c->K, (const double *const *)u, product, 0, 5);
  node_stencil_multiply(&c->K, (const double *const *)u, product, 5, c->m.nodes[1]);
  for (int d = 0; d < 2; d++)
    for (int n = 0; n < mesh_node_count(&c->m); n++)
      f[d][n] = product[d][node_layout_at(l, n)];
  pool_free(memory);
}

static void open_zoned(case_mesh *c) {
  mesh_open(&c->m, (int[2]){21, 14}, (double[2]){0, 0}, (double[2]){0.2, 0.13}, 0.03, 2.6);
  c->law = isotropic(30e9, 0.2, false);
  for (int j = 0; j < 14; j++)
    for (int i = 0; i < 5; i++)
      c->m.element_free[mesh_node(&c->m, i, j)] = 0;
  crack_lines_add(&c->m.cracks, (double[2]){0.123, 0}, (double[2]){0.133, 0.071});
  case_settle(c);
}

static void the_stencil_gives_the_points_forces(void **state) {
  (void)state;
  case_mesh c = {0};
  double most = 0, size = 0;
  open_zoned(&c);
  for (int n = 0; n < mesh_node_count(&c.m); n++)
    for (int d = 0; d < 2; d++)
      c.u[d][n] = random_unit(random_mix((uint64_t)(2 * n + d)));
  point_forces(&c, c.force);
  stencil_forces(&c, c.reaction);
  for (int n = 0; n < mesh_node_count(&c.m); n++)
    for (int d = 0; d < 2; d++) {
      most = larger_of(most, fabs(c.force[d][n] - c.reaction[d][n]));
      size = larger_of(size, fabs(c.force[d][n]));
    }
  assert_true(most < 1e-13 * size);
  case_close(&c);
}

static void rigid_motions_meet_no_force(void **state) {
  (void)state;
  case_mesh c = {0};
  double at[2], most = 0;
  open_zoned(&c);
  for (int n = 0; n < mesh_node_count(&c.m); n++) {
    mesh_place(&c.m, n, at);
    c.u[0][n] = 1e-3 - 2e-2 * at[1];
    c.u[1][n] = 4e-3 + 2e-2 * at[0];
  }
  stencil_forces(&c, c.force);
  for (int n = 0; n < mesh_node_count(&c.m); n++)
    for (int d = 0; d < 2; d++)
      most = larger_of(most, fabs(c.force[d][n]));
  assert_true(most < 1e-12 * 30e9 * 0.03 * 4e-3);
  case_close(&c);
}

static void masses_are_all_of_the_mesh(void **state) {
  (void)state;
  case_mesh c = {0};
  const double density = 2400;
  double sum = 0;
  open_zoned(&c);
  double *mass = must_calloc((size_t)mesh_node_count(&c.m), sizeof *mass);
  node_masses(&c.m, &c.points, &density, NULL, mass);
  for (int n = 0; n < mesh_node_count(&c.m); n++) {
    assert_true(mass[n] > 0);
    sum += mass[n];
  }
  assert_true(fabs(sum - 2400 * 0.2 * 0.13 * 0.03) < 1e-12 * sum);
  free(mass);
  case_close(&c);
}

/* Two nodes in a row are bars: a row of elements free at both ends, whose highest frequency is
   known where it is one element: of a square plate of one element by its 8 x 8 matrix. */
static void the_highest_frequency_is_that_of_one_element(void **state) {
  (void)state;
  case_mesh c = {0};
  const double density = 1, mass[4] = {0.25, 0.25, 0.25, 0.25};
  mesh_open(&c.m, (int[2]){2, 2}, (double[2]){0, 0}, (double[2]){1, 1}, 1, 1.5);
  c.law = isotropic(1, 0, false);
  memset(c.m.element_free, 0, 4);
  case_settle(&c);
  double found_mass[4];
  node_masses(&c.m, &c.points, &density, NULL, found_mass);
  for (int n = 0; n < 4; n++)
    assert_true(fabs(found_mass[n] - 0.25) < 1e-15);
  /* nu = 0: the modes of uniform strain have w^2 = 4 E/(rho) = 4, those of shear 4, of bending
     less */
  assert_true(fabs(frequency_limit(&c.K, mass, c.held) - 2) < 1e-9);
  case_close(&c);
}

/* --- convergence ------------------------------------------------------------------------------ */

/* Errors of a static plate 1 x 1 with prescribed displacements u = sin(2 x + y)(1, 1/2) and the
   body force that holds it: sizes relative to the field's. */
typedef struct field_errors {
  double displacement, energy;
} field_errors;

static void exact_at(const double at[2], double u[2], double gradient[2][2]) {
  const double phase = 2 * at[0] + at[1];
  for (int d = 0; d < 2; d++) {
    const double a = d ? 0.5 : 1;
    u[d] = a * sin(phase);
    gradient[d][0] = 2 * a * cos(phase);
    gradient[d][1] = a * cos(phase);
  }
}

/* -div sigma of that field: with e = cos(phase) (2, 1/2, 2) and sigma = D e. */
static void body_force(const plane_stiffness *law, const double at[2], double b[2]) {
  const double phase = 2 * at[0] + at[1], e[3] = {2, 0.5, 1 + 0.5 * 2};
  double s[3] = {0};
  for (int a = 0; a < 3; a++)
    for (int k = 0; k < 3; k++)
      s[a] += law->D[a][k] * e[k];
  b[0] = sin(phase) * (2 * s[0] + s[2]);
  b[1] = sin(phase) * (2 * s[2] + s[1]);
}

static field_errors manufactured(int cells, bool element_free) {
  case_mesh c = {0};
  mesh_open(&c.m, (int[2]){cells + 1, cells + 1}, (double[2]){0, 0}, (double[2]){1, 1}, 1, 2.1);
  c.law = isotropic(1, 0.3, false);
  for (int j = 0; j <= cells; j++) /* a frame of elements, on which displacements are prescribed */
    for (int i = 0; i <= cells; i++)
      if (!element_free || i < 1 || j < 1 || i > cells - 1 || j > cells - 1)
        c.m.element_free[mesh_node(&c.m, i, j)] = 0;
  case_settle(&c);
  point_shape s;
  double at[2], u[2], gradient[2][2], b[2];
  for (int n = 0; n < c.points.count; n++) {
    shape_functions(&c.m, c.points.cell[n], c.points.at[n], &s);
    body_force(&c.law, c.points.at[n], b);
    for (int q = 0; q < s.count; q++)
      for (int d = 0; d < 2; d++)
        c.force[d][s.node[q]] += c.points.area[n] * s.n[q] * b[d];
  }
  for (int j = 0; j <= cells; j++)
    for (int i = 0; i <= cells; i++) {
      const int n = mesh_node(&c.m, i, j);
      if (i > 0 && j > 0 && i < cells && j < cells) continue;
      mesh_place(&c.m, n, at);
      exact_at(at, u, gradient);
      for (int d = 0; d < 2; d++) {
        c.held[2 * n + d] = 1;
        c.u[d][n] = u[d];
      }
    }
  assert_true(solve(&c).solved);
  double off = 0, all = 0, off_energy = 0, all_energy = 0;
  for (int n = 0; n < c.points.count; n++) {
    shape_functions(&c.m, c.points.cell[n], c.points.at[n], &s);
    exact_at(c.points.at[n], u, gradient);
    double e[3] = {gradient[0][0], gradient[1][1], gradient[0][1] + gradient[1][0]}, d[3], w[2];
    memcpy(d, e, sizeof d);
    memcpy(w, u, sizeof w);
    for (int q = 0; q < s.count; q++) {
      const double x = c.u[0][s.node[q]], y = c.u[1][s.node[q]];
      w[0] -= s.n[q] * x;
      w[1] -= s.n[q] * y;
      d[0] -= s.nx[q] * x;
      d[1] -= s.ny[q] * y;
      d[2] -= s.ny[q] * x + s.nx[q] * y;
    }
    off += c.points.area[n] * (w[0] * w[0] + w[1] * w[1]);
    all += c.points.area[n] * (u[0] * u[0] + u[1] * u[1]);
    for (int a = 0; a < 3; a++)
      for (int k = 0; k < 3; k++) {
        off_energy += c.points.area[n] * d[a] * c.law.D[a][k] * d[k];
        all_energy += c.points.area[n] * e[a] * c.law.D[a][k] * e[k];
      }
  }
  case_close(&c);
  return (field_errors){sqrt(off / all), sqrt(off_energy / all_energy)};
}

static void errors_fall_with_the_orders_of_theory(void **state) {
  (void)state;
  for (int element_free = 0; element_free < 2; element_free++) {
    const field_errors coarse = manufactured(8, element_free),
                       fine = manufactured(16, element_free),
                       finest = manufactured(32, element_free);
    const double order = log2(fine.displacement / finest.displacement),
                 energy_order = log2(fine.energy / finest.energy);
    print_message(
        "%s: displacements %.2g %.2g %.2g, order %.2f; energy %.2g %.2g %.2g, order %.2f\n",
        element_free ? "element-free" : "elements", coarse.displacement, fine.displacement,
        finest.displacement, order, coarse.energy, fine.energy, finest.energy, energy_order);
    assert_true(coarse.displacement > fine.displacement && coarse.energy > fine.energy);
    assert_true(order > 1.85 && energy_order > 0.95);
  }
}

/* --- what cannot be solved -------------------------------------------------------------------- */

static void what_moves_freely_is_found(void **state) {
  (void)state;
  case_mesh c = {0};
  open_patch(&c, 4);
  case_settle(&c);
  pull_patch(&c);
  memset(c.held, 0, 2 * (size_t)mesh_node_count(&c.m));
  assert_false(solve(&c).solved);
  case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(elements_pass_the_patch_test),
      cmocka_unit_test(zones_pass_the_patch_test_to_quadrature),
      cmocka_unit_test(a_skew_mesh_passes_the_patch_test),
      cmocka_unit_test(a_skew_mesh_weighs_and_bears_what_it_should),
      cmocka_unit_test(a_cracked_plate_stores_the_known_energy),
      cmocka_unit_test(growth_in_pieces_is_assembly_afresh),
      cmocka_unit_test(the_stencil_gives_the_points_forces),
      cmocka_unit_test(rigid_motions_meet_no_force),
      cmocka_unit_test(masses_are_all_of_the_mesh),
      cmocka_unit_test(the_highest_frequency_is_that_of_one_element),
      cmocka_unit_test(errors_fall_with_the_orders_of_theory),
      cmocka_unit_test(what_moves_freely_is_found),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
