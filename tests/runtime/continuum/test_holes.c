/* Holes in meshes: Kirsch's plate, tunnels, masses, rigid motions, what is on either side of a hole. */
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

static inline deck_shape rectangle(double x, double y, double w, double h) {
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

typedef struct edge {
  double normal[2];
} edge;

static void kirsch_traction(void *context, const double at[2], double t[2]) {
  const edge *e = context;
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
  static edge sides[4] = {{{0, -1}}, {{1, 0}}, {{0, 1}}, {{-1, 0}}};
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

static void kirsch_study(void **state) {
  (void)state;
  static const double longer[] = {1, 1.02, 1.05, 1.1, 1.2, 1.4};
  for (int l = 0; l < 6; l++)
  for (int w = 0; w < 3; w++)
  for (int n = 20; n <= 80; n *= 2) {
    case_mesh c = {0};
    double s[3], k[3], off = 0, all = 0;
    holes_longer(longer[l]);
    solve_plate(&c, n, w == 0 ? 2.1 : w == 1 ? 2.6 : 3.5);
    for (int p = 0; p < c.points.count; p++) {
      stress_at(&c, c.points.at[p], s);
      kirsch(c.points.at[p], k);
      for (int a = 0; a < 3; a++) {
        off += c.points.area[p] * (s[a] - k[a]) * (s[a] - k[a]);
        all += c.points.area[p] * k[a] * k[a];
      }
    }
    double worst = 0;
    for (int p = 0; p < 360; p++) {
      const double at[2] = {1.000001 * cos(p * M_PI / 180), 1.000001 * sin(p * M_PI / 180)};
      stress_at(&c, at, s);
      kirsch(at, k);
      for (int a = 0; a < 3; a++)
        worst = larger_of(worst, fabs(s[a] - k[a]));
    }
    stress_at(&c, (double[2]){1e-7, 1.0000001}, s);
    double s2[3];
    stress_at(&c, (double[2]){1.0000001,1e-7}, s2);
    print_message("longer %.2f w %d n %d: top %.4f side %.4f worst on circle %.3f l2 %.4g blind %d\n", longer[l], w, n, s[0], s2[1], worst, sqrt(off / all), c.K.blind);
    case_close(&c);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(kirsch_study),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
