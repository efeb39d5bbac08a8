/* Holes in meshes: Kirsch's plate, tunnels, masses, rigid motions, what is on either side of a
   hole. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "mesh_cases.h"
#include "runtime/base/random_number.h"
#include "runtime/continuum/node_masses.h"
#include "runtime/continuum/static_solution.h"
#include "runtime/mesh/cut_cells.h"
#include "runtime/mesh/gauss_rule.h"
#include "runtime/mesh/holes.h"
#include "runtime/mesh/shape_functions.h"

static double larger_of(double a, double b) {
  return a > b ? a : b;
}

static deck_shape disc(double x, double y, double radius) {
  return (deck_shape){.kind = SHAPE_DISC, .centre = {x, y}, .radius = radius};
}

static deck_shape rectangle(double x, double y, double w, double h) {
  return (deck_shape){.kind = SHAPE_RECTANGLE, .corner = {x, y}, .size = {w, h}};
}

static void cut(case_mesh *c, const deck_shape *shapes, int count) {
  for (int n = 0; n < count; n++)
    holes_add(&c->m.holes, &shapes[n]);
  assert_true(mesh_cut(&c->m) > 0);
}

/* --- Kirsch ----------------------------------------------------------------------------------- */

/* Stresses around a hole of radius 1 in a plate pulled by 1 along x (Kirsch 1898). */
static void kirsch(const double at[2], double s[3]) {
  const double r = hypot(at[0], at[1]), c = atan2(at[1], at[0]), q = 1 / (r * r);
  const double c2 = cos(2 * c), s2 = sin(2 * c), c4 = cos(4 * c), s4 = sin(4 * c);
  s[0] = 1 - q * (1.5 * c2 + c4) + 1.5 * q * q * c4;
  s[1] = -q * (0.5 * c2 - c4) - 1.5 * q * q * c4;
  s[2] = -q * (0.5 * s2 + s4) + 1.5 * q * q * s4;
}

typedef struct plate_side {
  double normal[2];
} plate_side;

static void kirsch_traction(void *context, const double at[2], double t[2]) {
  const plate_side *e = context;
  double s[3];
  kirsch(at, s);
  t[0] = s[0] * e->normal[0] + s[2] * e->normal[1];
  t[1] = s[2] * e->normal[0] + s[1] * e->normal[1];
}

static void stress_at(const case_mesh *c, const double at[2], double s[3]) {
  double e[3] = {0};
  point_shape f;
  shape_functions(&c->m, mesh_cell_of(&c->m, at), at, &f);
  for (int q = 0; q < f.count; q++) {
    e[0] += f.nx[q] * c->u[0][f.node[q]];
    e[1] += f.ny[q] * c->u[1][f.node[q]];
    e[2] += f.ny[q] * c->u[0][f.node[q]] + f.nx[q] * c->u[1][f.node[q]];
  }
  for (int a = 0; a < 3; a++) {
    s[a] = 0;
    for (int b = 0; b < 3; b++)
      s[a] += c->law.D[a][b] * e[b];
  }
}

/* The whole plate 10 x 10 with the exact tractions on its edges; held without reactions. */
static void solve_plate(case_mesh *c, int nodes, double support) {
  static plate_side sides[4] = {{{0, -1}}, {{1, 0}}, {{0, 1}}, {{-1, 0}}};
  static const double corner[5][2] = {{-5, -5}, {5, -5}, {5, 5}, {-5, 5}, {-5, -5}};
  const deck_shape hole = disc(0, 0, 1);
  mesh_open(&c->m, (int[2]){nodes, nodes}, (double[2]){-5, -5}, (double[2]){10, 10}, 1, support);
  c->law = isotropic(1, 0.3, false);
  cut(c, &hole, 1);
  case_settle(c);
  for (int k = 0; k < 4; k++)
    line_load(&c->m, corner[k], corner[k + 1], kirsch_traction, &sides[k], c->force);
  const int left = mesh_node(&c->m, 0, 0), right = mesh_node(&c->m, nodes - 1, 0);
  c->held[2 * left] = c->held[2 * left + 1] = c->held[2 * right + 1] = 1;
  const static_result r =
      static_solution(&c->K, c->held, (const double *const *)c->force, c->u, c->reaction);
  assert_true(r.solved);
}

typedef struct plate_errors {
  double top, stresses; /* of the largest stress, 3; of all stresses, in the mean of squares */
} plate_errors;

static plate_errors plate(int nodes, double support) {
  case_mesh c = {0};
  double s[3], k[3], off = 0, all = 0;
  solve_plate(&c, nodes, support);
  assert_int_equal(c.K.blind, 0);
  for (int p = 0; p < c.points.count; p++) {
    stress_at(&c, c.points.at[p], s);
    kirsch(c.points.at[p], k);
    for (int a = 0; a < 3; a++) {
      off += c.points.area[p] * (s[a] - k[a]) * (s[a] - k[a]);
      all += c.points.area[p] * k[a] * k[a];
    }
  }
  stress_at(&c, (double[2]){0, 1}, s);
  case_close(&c);
  return (plate_errors){s[0] / 3 - 1, sqrt(off / all)};
}

static void a_round_hole_trebles_the_stress(void **state) {
  (void)state;
  static const double supports[] = {2.1, 3.5};
  for (int n = 0; n < 2; n++) {
    const plate_errors coarse = plate(20, supports[n]), fine = plate(40, supports[n]),
                       finest = plate(80, supports[n]);
    print_message("Kirsch, support %.1f, 20, 40, 80 nodes: largest stress %+.1f %+.1f %+.1f %%, "
                  "all stresses %.2f %.2f %.2f %%\n",
                  supports[n], 100 * coarse.top, 100 * fine.top, 100 * finest.top,
                  100 * coarse.stresses, 100 * fine.stresses, 100 * finest.stresses);
    assert_true(fabs(finest.top) < 0.03);
    assert_true(fine.stresses < 0.5 * coarse.stresses && finest.stresses < 0.6 * fine.stresses);
    assert_true(finest.stresses < 0.015);
  }
}

/* --- masses ----------------------------------------------------------------------------------- */

static const double density = 2600;

/* All of them; of nodes that are there none is 0 or negative. */
static double mass_of(const case_mesh *c) {
  double *mass = must_calloc((size_t)mesh_node_count(&c->m), sizeof *mass), sum = 0;
  node_masses(&c->m, &c->points, &density, NULL, mass);
  for (int n = 0; n < mesh_node_count(&c->m); n++) {
    assert_true(c->m.gone[n] ? mass[n] == 0 : mass[n] > 0);
    sum += mass[n];
  }
  free(mass);
  return sum;
}

static void open_block(case_mesh *c, double support) {
  mesh_open(&c->m, (int[2]){31, 24}, (double[2]){0, 0}, (double[2]){3, 2.3}, 0.5, support);
  c->law = isotropic(30e9, 0.25, true);
}

/* A rectangle 2 r x r with half a disc on it. */
static void cut_tunnel(case_mesh *c, double x, double y, double r) {
  const deck_shape parts[2] = {rectangle(x - r, y - r, 2 * r, r), disc(x, y, r)};
  cut(c, parts, 2);
}

static void masses_are_those_of_what_is_left(void **state) {
  (void)state;
  case_mesh c = {0};
  const double r = 0.537, tunnel = 2 * r * r + M_PI * r * r / 2;
  open_block(&c, 2.1);
  cut_tunnel(&c, 1.52, 1.13, r);
  case_settle(&c);
  const double expected = density * 0.5 * (3 * 2.3 - tunnel), sum = mass_of(&c);
  assert_true(fabs(sum - expected) < 1e-6 * expected);
  case_close(&c);
  /* two discs that overlap: less their lens */
  c = (case_mesh){0};
  const double a = 0.41, b = 0.33, d = 0.52,
               lens = a * a * acos((d * d + a * a - b * b) / (2 * d * a)) +
                      b * b * acos((d * d + b * b - a * a) / (2 * d * b)) -
                      0.5 * sqrt((a + b - d) * (d + a - b) * (d - a + b) * (d + a + b));
  const deck_shape discs[2] = {disc(1.2, 1.1, a), disc(1.2 + d, 1.1, b)};
  open_block(&c, 3.5);
  cut(&c, discs, 2);
  case_settle(&c);
  const double left = density * 0.5 * (3 * 2.3 - M_PI * (a * a + b * b) + lens);
  assert_true(fabs(mass_of(&c) - left) < 1e-5 * left);
  case_close(&c);
}

/* Discs of all sizes anywhere: no node lacks mass. */
static void holes_leave_no_node_without_mass(void **state) {
  (void)state;
  uint64_t seed = 3;
  for (int n = 0; n < 150; n++) {
    case_mesh c = {0};
    double draw[4];
    for (int k = 0; k < 4; k++)
      draw[k] = random_unit(random_mix(seed++));
    open_block(&c, 2.1 + 2 * draw[0]);
    const deck_shape hole = disc(1 + draw[1], 0.8 + 0.8 * draw[2], 0.06 + 0.6 * draw[3]);
    cut(&c, &hole, 1);
    mesh_settle(&c.m);
    integration_points_open(&c.points, &c.m);
    const double left = density * 0.5 * (3 * 2.3 - M_PI * hole.radius * hole.radius);
    assert_true(fabs(mass_of(&c) - left) < 1e-5 * left);
    integration_points_close(&c.points);
    mesh_close(&c.m);
  }
}

/* --- motions ---------------------------------------------------------------------------------- */

static void product(const case_mesh *c, double *const f[2]) {
  const node_layout *l = &c->K.layout;
  pool *memory = pool_new();
  double *u[2], *out[2];
  for (int d = 0; d < 2; d++) {
    u[d] = pool_doubles(memory, l->size);
    out[d] = pool_doubles(memory, l->size);
    for (int n = 0; n < mesh_node_count(&c->m); n++)
      u[d][node_layout_at(l, n)] = c->u[d][n];
  }
  node_stencil_multiply(&c->K, (const double *const *)u, out, 0, c->m.nodes[1]);
  for (int d = 0; d < 2; d++)
    for (int n = 0; n < mesh_node_count(&c->m); n++)
      f[d][n] = out[d][node_layout_at(l, n)];
  pool_free(memory);
}

/* The left third of the block is finite elements, into the tunnel. */
static void open_zoned_tunnel(case_mesh *c) {
  open_block(c, 2.6);
  for (int n = 0; n < mesh_node_count(&c->m); n++)
    if (n % 31 < 14) c->m.element_free[n] = 0;
  cut_tunnel(c, 1.4, 1.13, 0.437);
  case_settle(c);
}

static void rigid_motions_meet_no_force(void **state) {
  (void)state;
  case_mesh c = {0};
  double at[2], most = 0;
  int elements = 0, blended = 0;
  open_zoned_tunnel(&c);
  for (int k = 0; k < mesh_cell_count(&c.m); k++) {
    elements += c.m.cell[k] == CELL_ELEMENT;
    blended += c.m.cell[k] == CELL_INTERFACE;
    assert_true(!c.m.cut[k] || c.m.cell[k] == CELL_ELEMENT_FREE);
  }
  assert_true(elements > 200 && blended > 20);
  for (int n = 0; n < mesh_node_count(&c.m); n++) {
    mesh_place(&c.m, n, at);
    c.u[0][n] = 1e-3 - 2e-2 * at[1];
    c.u[1][n] = 4e-3 + 2e-2 * at[0];
  }
  product(&c, c.force);
  for (int n = 0; n < mesh_node_count(&c.m); n++)
    for (int d = 0; d < 2; d++)
      most = larger_of(most, fabs(c.force[d][n]));
  assert_true(most < 1e-12 * 30e9 * 0.5 * 0.06);
  assert_true(
      fabs(mass_of(&c) - density * 0.5 * (6.9 - 2 * 0.437 * 0.437 - M_PI * 0.437 * 0.437 / 2)) <
      1e-6 * mass_of(&c));
  case_close(&c);
}

/* --- a uniform stress ------------------------------------------------------------------------- */

typedef struct uniform_stress {
  double s[3], normal[2];
} uniform_stress;

static void traction_of(void *context, const double at[2], double t[2]) {
  const uniform_stress *of = context;
  (void)at;
  t[0] = of->s[0] * of->normal[0] + of->s[2] * of->normal[1];
  t[1] = of->s[2] * of->normal[0] + of->s[1] * of->normal[1];
}

/* On the four sides of a rectangle whose inside is material (out = 1) or hole (-1). */
static void load_sides(case_mesh *c, double x, double y, double w, double h, double out) {
  static const double normals[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
  const double corner[5][2] = {{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}, {x, y}};
  for (int k = 0; k < 4; k++) {
    uniform_stress t = {{2e6, -1e6, 0.7e6}, {out * normals[k][0], out * normals[k][1]}};
    const double length = line_load(&c->m, corner[k], corner[k + 1], traction_of, &t, c->force);
    assert_true(fabs(length - (k % 2 ? h : w)) < 1e-12);
  }
}

/* The error of the stresses at the points in the mean of squares, over the largest stress. */
static double error_in_uniform_stress(case_mesh *c) {
  double s[3], off = 0, area = 0;
  const int left = mesh_node(&c->m, 0, 0), right = mesh_node(&c->m, 30, 0);
  c->held[2 * left] = c->held[2 * left + 1] = c->held[2 * right + 1] = 1;
  load_sides(c, 0, 0, 3, 2.3, 1);
  const static_result r =
      static_solution(&c->K, c->held, (const double *const *)c->force, c->u, c->reaction);
  assert_true(r.solved);
  for (int p = 0; p < c->points.count; p++) {
    const double known[3] = {2e6, -1e6, 0.7e6};
    stress_at(c, c->points.at[p], s);
    for (int a = 0; a < 3; a++)
      off += c->points.area[p] * (s[a] - known[a]) * (s[a] - known[a]) / 4e12;
    area += c->points.area[p];
  }
  assert_int_equal(c->K.blind, 0);
  case_close(c);
  return sqrt(off / area);
}

static void a_uniform_stress_stays_uniform(void **state) {
  (void)state;
  case_mesh c = {0};
  /* a hole on lines of nodes in elements leaves elements: exact */
  deck_shape hole = rectangle(1, 0.8, 0.7, 0.9);
  open_block(&c, 2.1);
  memset(c.m.element_free, 0, (size_t)mesh_node_count(&c.m));
  cut(&c, &hole, 1);
  case_settle(&c);
  assert_int_equal(c.K.reach, 1);
  load_sides(&c, 1, 0.8, 0.7, 0.9, -1);
  const double elements = error_in_uniform_stress(&c);
  /* anywhere in zones of both: to the quadrature, which shrinks with more points */
  double blended[2];
  for (int fine = 0; fine < 2; fine++) {
    c = (case_mesh){0};
    hole = rectangle(1.03, 0.77, 0.91, 0.68);
    open_block(&c, 2.1);
    c.m.gauss = fine ? 6 : 4;
    c.m.gauss_parts = fine ? 2 : 1;
    for (int n = 0; n < mesh_node_count(&c.m); n++)
      if (n % 31 < 14) c.m.element_free[n] = 0;
    cut(&c, &hole, 1);
    case_settle(&c);
    load_sides(&c, 1.03, 0.77, 0.91, 0.68, -1);
    blended[fine] = error_in_uniform_stress(&c);
  }
  print_message(
      "uniform stress around a hole: elements %.2g; both methods %.2g, finer points %.2g\n",
      elements, blended[0], blended[1]);
  assert_true(elements < 1e-10);
  assert_true(blended[0] < 5e-4 && blended[1] < 0.7 * blended[0]);
}

/* --- what is on either side ------------------------------------------------------------------- */

/* A slot of a quarter of a spacing, between two rows of nodes, through most of the block. */
static void a_slot_parts_what_is_on_either_side(void **state) {
  (void)state;
  case_mesh c = {0};
  const deck_shape slot = rectangle(-1, 1.14, 3.55, 0.025);
  int crossing = 0;
  open_block(&c, 3.5);
  cut(&c, &slot, 1);
  case_settle(&c);
  for (int n = 0; n < mesh_node_count(&c.m); n++)
    assert_false(c.m.gone[n]);
  for (int i = 0; i < 18; i++) /* farther from its end than two supports */
    for (int k = -6; k <= 6; k++)
      for (int j = 0; j < 12; j++) {
        const int below = mesh_node(&c.m, i, 11 - j), above = mesh_node(&c.m, i + k, 12);
        if (i + k < 0) continue;
        for (int a = 0; a < 4; a++)
          assert_true(node_stencil_entry(&c.K, below, above, a / 2, a % 2) == 0);
        crossing++;
      }
  assert_true(crossing > 2000);
  /* beyond its end they act on each other */
  assert_true(node_stencil_entry(&c.K, mesh_node(&c.m, 28, 11), mesh_node(&c.m, 28, 12), 0, 0) !=
              0);
  case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_round_hole_trebles_the_stress),
      cmocka_unit_test(masses_are_those_of_what_is_left),
      cmocka_unit_test(holes_leave_no_node_without_mass),
      cmocka_unit_test(rigid_motions_meet_no_force),
      cmocka_unit_test(a_uniform_stress_stays_uniform),
      cmocka_unit_test(a_slot_parts_what_is_on_either_side),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
