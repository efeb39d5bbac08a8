/* Mean dilatation and hourglass modes of elements: both ways to the forces agree, linear fields are
   exact, ranks and energies of a single element, a membrane that hardly changes its volume,
   ledgers, threads, resuming, cells that die. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "both_ways.h"
#include "brittle_law.h"
#include "laws_run.h"
#include "runtime/continuum/cells.h"
#include "runtime/continuum/node_matrix.h"
#include "runtime/mesh/cell_lists.h"
#include "runtime/mesh/element_modes.h"
#include "softening_law.h"

/* Hooke's law in plane strain is that in plane stress with other values. */
static const double E = 30e9, nu = 0.4;
static double values[3];
static pl_law bent;

static int set_up(void **state) {
  (void)state;
  values[0] = E / (1 - nu * nu);
  values[1] = nu / (1 - nu);
  values[2] = 2400;
  bent = hooke_law;
  bent.linear = 0;
  return 0;
}

/* --- forces ----------------------------------------------------------------------------------- */

enum { ALONG = 14, UP = 7 };
static const double slanted[4][2] = {{0, 0}, {0.3, 0.05}, {0.35, 0.2}, {-0.04, 0.13}};

/* Elements, a quadrilateral or a rectangle with an element-free corner. */
static void open_mesh(mesh *m, bool mapped) {
  if (mapped) {
    mesh_open_mapped(m, (int[2]){ALONG, UP}, slanted, 0.02, 2.1);
  } else {
    mesh_open(m, (int[2]){ALONG, UP}, (double[2]){0.3, -0.1}, (double[2]){0.3, 0.1}, 0.02, 2.1);
    for (int n = 0; n < mesh_node_count(m); n++)
      m->element_free[n] = n % ALONG > 8 && n / ALONG > 3;
  }
}

/* Every third cell as the mesh at large is not. */
static void choose(mesh *m, int gauss, double hourglass) {
  for (int c = 0; c < mesh_cell_count(m); c++) {
    m->element_gauss[c] = (unsigned char)(c % 3 == 2 ? 3 - gauss : gauss);
    m->mean_dilatation[c] = c % 4 != 1;
    m->hourglass[c] = c % 5 == 1 ? 0 : hourglass;
  }
  mesh_settle(m);
}

static void open_both(both *b) {
  both_open(b, isotropic(E, nu, true), &bent, values);
}

static double largest_of(const both *b, double *const f[2], bool inside) {
  double most = 0;
  for (int n = 0; n < mesh_node_count(&b->m); n++) {
    const int i = n % ALONG, j = n / ALONG;
    if (inside && (i == 0 || j == 0 || i == ALONG - 1 || j == UP - 1)) continue;
    for (int d = 0; d < 2; d++)
      most = fmax(most, fabs(f[d][node_layout_at(&b->K.layout, n)]));
  }
  return most;
}

static void both_ways_agree(void **state) {
  (void)state;
  for (int k = 0; k < 4; k++) {
    both b;
    open_mesh(&b.m, k % 2);
    choose(&b.m, 1 + k / 2, 0.05);
    open_both(&b);
    assert_true(b.P->mean && b.P->hourglass);
    both_move(&b);
    both_find(&b, true);
    double largest, half_work = 0, stored = 0;
    const double most = both_differ(&b, &largest);
    for (int n = 0; n < mesh_node_count(&b.m); n++)
      for (int d = 0; d < 2; d++) {
        const long at = node_layout_at(&b.K.layout, n);
        half_work += 0.5 * b.u[d][at] * b.by_stencil[d][at];
      }
    for (int row = 0; row < b.P->strips.rows; row++)
      stored += b.P->rows[row].stored;
    assert_true(largest > 0 && most <= 1e-13 * largest);
    assert_true(fabs(stored - half_work) < 1e-12 * half_work);
    both_close(&b);
  }
}

/* The cells of a grid as lists. */
static void open_listed(mesh *m, const mesh *grid) {
  const int nodes = mesh_node_count(grid), count = mesh_cell_count(grid);
  double(*at)[2] = must_calloc((size_t)nodes, sizeof *at);
  unsigned char *of_cell = must_calloc((size_t)count, 1);
  cell_nodes *cell = must_calloc((size_t)count, sizeof *cell);
  for (int n = 0; n < nodes; n++)
    mesh_place(grid, n, at[n]);
  for (int c = 0; c < count; c++) {
    int node[ELEMENT_MOST_NODES];
    of_cell[c] = (unsigned char)mesh_cell_nodes(grid, c, node);
    for (int q = 0; q < of_cell[c]; q++)
      cell[c][q] = node[q];
  }
  mesh_open_lists(
      m, grid->nodes,
      cell_lists_new(nodes, (const double(*)[2])at, count, of_cell, (const cell_nodes *)cell), 0.01,
      0.02, 2.1);
  memcpy(m->element_gauss, grid->element_gauss, (size_t)count);
  memcpy(m->mean_dilatation, grid->mean_dilatation, (size_t)count);
  memcpy(m->hourglass, grid->hourglass, (size_t)count * sizeof *m->hourglass);
  free(at);
  free(of_cell);
  free(cell);
}

/* Of quadrilaterals in lists, whose stiffness is assembled in another way. */
static void list_does_as_grid(int gauss, double hourglass) {
  both b;
  mesh listed;
  integration_points points;
  node_matrix of;
  open_mesh(&b.m, true);
  choose(&b.m, gauss, hourglass);
  open_both(&b);
  open_listed(&listed, &b.m);
  integration_points_open(&points, &listed);
  node_matrix_open(&of, &listed, &points, &b.law, NULL);
  node_matrix_resist_hourglass(&of, &listed, &b.law, NULL);
  point_forces *by_points = point_forces_new(&listed, NULL, &points, &bent, values, 1, true);
  double *f[2], *g[2];
  for (int d = 0; d < 2; d++) {
    f[d] = pool_doubles(b.memory, b.K.layout.size);
    g[d] = pool_doubles(b.memory, b.K.layout.size);
  }
  both_move(&b);
  const double *const u[2] = {b.u[0], b.u[1]};
  const point_motion at = {u, u, 0, 1, 0};
  both_find(&b, true);
  node_matrix_multiply(&of, u, f, 0, listed.nodes[1]);
  point_forces_find(by_points, 0, 0, listed.nodes[1], &at, true, NULL);
  for (int row = 0; row < listed.nodes[1]; row++)
    point_forces_take(by_points, row, false, g);
  double most = 0, half_work = 0, stored = 0;
  for (int n = 0; n < mesh_node_count(&b.m); n++)
    for (int d = 0; d < 2; d++) {
      const long site = node_layout_at(&b.K.layout, n);
      most = fmax(most, fabs(f[d][site] - b.by_stencil[d][site]));
      most = fmax(most, fabs(g[d][site] - b.by_stencil[d][site]));
      half_work += 0.5 * u[d][site] * f[d][site];
    }
  for (int row = 0; row < by_points->strips.rows; row++)
    stored += by_points->rows[row].stored;
  assert_true(by_points->mean && (!(hourglass > 0) || by_points->hourglass));
  assert_true(most <= 1e-10 * largest_of(&b, b.by_stencil, false));
  assert_true(fabs(stored - half_work) < 1e-12 * half_work);
  point_forces_free(by_points);
  node_matrix_close(&of);
  integration_points_close(&points);
  mesh_close(&listed);
  both_close(&b);
}

static void lists_do_as_grids(void **state) {
  (void)state;
  list_does_as_grid(2, 0);
  list_does_as_grid(2, 0.05);
  list_does_as_grid(1, 0.05);
}

/* A linear field leaves the nodes inside alone: the patch test. */
static void linear_fields_are_exact(void **state) {
  (void)state;
  for (int k = 0; k < 2; k++) {
    both b;
    open_mesh(&b.m, true);
    choose(&b.m, 1 + k, 0.7);
    open_both(&b);
    for (int n = 0; n < mesh_node_count(&b.m); n++) {
      double at[2];
      mesh_place(&b.m, n, at);
      b.u[0][node_layout_at(&b.K.layout, n)] = 1e-3 + 3e-4 * at[0] - 2e-4 * at[1];
      b.u[1][node_layout_at(&b.K.layout, n)] = -2e-3 + 1e-4 * at[0] + 5e-4 * at[1];
    }
    both_find(&b, true);
    const double inside = largest_of(&b, b.by_points, true),
                 all = largest_of(&b, b.by_points, false);
    assert_true(all > 0 && inside < 1e-11 * all);
    assert_true(largest_of(&b, b.by_stencil, true) < 1e-11 * all);
    both_close(&b);
  }
}

/* --- a single element ------------------------------------------------------------------------- */

/* How many motions of a matrix cost nothing, by elimination with the largest pivots. */
static int free_motions(double a[8][8]) {
  double scale = 0;
  int rank = 0;
  for (int i = 0; i < 8; i++)
    scale = fmax(scale, fabs(a[i][i]));
  for (; rank < 8; rank++) {
    int row = rank, column = rank;
    for (int i = rank; i < 8; i++)
      for (int j = rank; j < 8; j++)
        if (fabs(a[i][j]) > fabs(a[row][column])) {
          row = i;
          column = j;
        }
    if (fabs(a[row][column]) < 1e-10 * scale) break;
    for (int j = 0; j < 8; j++) {
      const double kept = a[rank][j];
      a[rank][j] = a[row][j];
      a[row][j] = kept;
    }
    for (int i = 0; i < 8; i++) {
      const double kept = a[i][rank];
      a[i][rank] = a[i][column];
      a[i][column] = kept;
    }
    for (int i = rank + 1; i < 8; i++) {
      const double part = a[i][rank] / a[rank][rank];
      for (int j = rank; j < 8; j++)
        a[i][j] -= part * a[rank][j];
    }
  }
  return 8 - rank;
}

static void open_single(both *b, const double corners[4][2], int gauss, double hourglass) {
  mesh_open_mapped(&b->m, (int[2]){2, 2}, corners, 0.5, 2.1);
  b->m.element_gauss[0] = (unsigned char)gauss;
  b->m.hourglass[0] = hourglass;
  b->m.mean_dilatation[0] = 1;
  mesh_settle(&b->m);
  open_both(b);
}

static int free_motions_of(int gauss, double hourglass) {
  static const double corners[4][2] = {{0, 0}, {1, 0.1}, {1.2, 0.9}, {-0.1, 0.7}};
  both b;
  double a[8][8];
  open_single(&b, corners, gauss, hourglass);
  for (int i = 0; i < 8; i++)
    for (int j = 0; j < 8; j++)
      a[i][j] = node_stencil_entry(&b.K, i / 2, j / 2, i % 2, j % 2);
  both_close(&b);
  return free_motions(a);
}

/* The same of a single cell in a list, which begins with any of its corners. */
static int free_motions_in_a_list(int first, double hourglass) {
  static const double around[4][2] = {{0, 0}, {1, 0.1}, {1.2, 0.9}, {-0.1, 0.7}};
  double at[4][2], a[8][8] = {{0}};
  const unsigned char nodes = 4;
  const cell_nodes cell = {0, 1, 2, 3};
  const plane_stiffness law = isotropic(E, nu, true);
  mesh m;
  integration_points points;
  node_matrix k;
  for (int q = 0; q < 4; q++)
    memcpy(at[q], around[(first + q) % 4], sizeof at[q]);
  mesh_open_lists(&m, (int[2]){PL_LANES, 2},
                  cell_lists_new(4, (const double(*)[2])at, 1, &nodes, &cell), 0.7, 0.5, 1);
  m.element_gauss[0] = 1;
  m.hourglass[0] = hourglass;
  integration_points_open(&points, &m);
  node_matrix_open(&k, &m, &points, &law, NULL);
  node_matrix_resist_hourglass(&k, &m, &law, NULL);
  for (int i = 0; i < 8; i++)
    for (int32_t e = k.first[i / 2]; e < k.first[i / 2 + 1]; e++)
      for (int d = 0; d < 2; d++)
        a[i][2 * k.other[e] + d] = k.block[e][2 * (i % 2) + d];
  node_matrix_close(&k);
  integration_points_close(&points);
  mesh_close(&m);
  return free_motions(a);
}

static void only_rigid_motions_are_free(void **state) {
  (void)state;
  assert_int_equal(free_motions_of(1, 0), 5);
  assert_int_equal(free_motions_of(1, 0.05), 3);
  assert_int_equal(free_motions_of(2, 0), 3); /* with the mean dilatation */
  for (int first = 0; first < 4; first++) {
    assert_int_equal(free_motions_in_a_list(first, 0), 5);
    assert_int_equal(free_motions_in_a_list(first, 0.05), 3);
  }
}

/* A square element that bends: with 1/6 it has the energy of a beam, E I kappa^2 l/2. */
static void a_square_bends_as_a_beam(void **state) {
  (void)state;
  static const double side = 0.3, h[4] = {1, -1, -1, 1};
  const double corners[4][2] = {{0, 0}, {side, 0}, {side, side}, {0, side}};
  for (int axis = 0; axis < 2; axis++) {
    both b;
    open_single(&b, corners, 1, 1.0 / 6);
    for (int n = 0; n < 4; n++)
      b.u[axis][node_layout_at(&b.K.layout, n)] = 1e-4 * h[n];
    both_find(&b, true);
    const double curvature = 4e-4 / (side * side), I = 0.5 * side * side * side / 12,
                 energy = 0.5 * E / (1 - nu * nu) * I * curvature * curvature * side;
    double stored = 0;
    for (int n = 0; n < 4; n++)
      stored += 0.5e-4 * h[n] * b.by_stencil[axis][node_layout_at(&b.K.layout, n)];
    assert_true(fabs(stored / energy - 1) < 1e-13);
    assert_true(fabs(b.P->rows[0].stored / energy - 1) < 1e-13);
    both_close(&b);
  }
}

/* --- a membrane ------------------------------------------------------------------------------- */

/* Cook's, of a material that hardly changes its volume, in plane strain: how far its upper corner
   moves. */
static double cook(const char *elements, int nodes) {
  const double E_cook = 250, nu_cook = 0.4999;
  char text[4096];
  laws_run c;
  const pl_law *const laws[] = {&hooke_law};
  snprintf(
      text, sizeof text,
      "&simulation /\n&static /\n"
      "&mesh name = 'panel' corners = 0, 0, 48, 44, 48, 60, 0, 44 nodes = %d, %d thickness = 1 "
      "setting = 'plane_strain' method = 'finite_elements' %s /\n"
      "&material mesh = 'panel' model = 'hooke' E = %.17g nu = %.17g /\n"
      "&region name = 'wall' shape = 'segment' from = 0, 0 to = 0, 44 /\n"
      "&region name = 'corner' shape = 'point' at = 48, 60 /\n"
      "&support region = 'wall' fix = 'x', 'y' /\n"
      "&traction mesh = 'panel' from = 48, 44 to = 48, 60 component = 'y' stress = 6.25 /\n"
      "&monitor name = 'corner' kind = 'displacement' region = 'corner' component = 'y' /\n",
      nodes, nodes, elements, E_cook / (1 - nu_cook * nu_cook), nu_cook / (1 - nu_cook));
  laws_open(&c, laws, text);
  if (!c.r.simulation) small_print(&c.r);
  assert_non_null(c.r.simulation);
  assert_int_equal(small_go(&c.r), STEP_END);
  const double found = small_last(&c.r, "corner");
  small_close(&c.r);
  return found;
}

static void a_membrane_does_not_lock(void **state) {
  (void)state;
  const char *plain = "gauss = 2", *mean = "gauss = 2 dilatation = 'mean'",
             *one = "gauss = 1 hourglass = 0.05";
  const double fine = cook(mean, 33), by_one = cook(one, 33), middle = cook(mean, 17),
               coarse = cook(mean, 9);
  print_message("corner of the membrane: mean %.4g, %.4g, %.4g; one point %.4g; 2 x 2 %.4g\n",
                coarse, middle, fine, by_one, cook(plain, 17));
  assert_true(fabs(fine / by_one - 1) < 0.005); /* two kinds of elements meet */
  assert_true(fine > middle && middle > coarse && fine - middle < 0.5 * (middle - coarse));
  assert_true(coarse > 0.94 * fine);
  assert_true(cook(plain, 17) < 0.4 * fine);
}

/* --- runs ------------------------------------------------------------------------------------- */

#define PLATE(elements)                                                                            \
  "&mesh name = 'plate' size = 0.2, 0.1 nodes = 21, 11 thickness = 0.02 setting = 'plane_strain' " \
  "method = 'finite_elements' " elements " /\n"                                                    \
  "&zone mesh = 'plate' method = 'finite_elements' shape = 'rectangle' corner = 0, 0 size = 0.1, " \
  "0.05 gauss = 1 hourglass = 0.1 /\n"                                                             \
  "&region name = 'left' shape = 'segment' from = 0, 0 to = 0, 0.1 /\n"                            \
  "&region name = 'end' shape = 'segment' from = 0.2, 0 to = 0.2, 0.1 /\n"                         \
  "&support region = 'left' fix = 'x', 'y' /\n"                                                    \
  "&traction mesh = 'plate' from = 0.2, 0 to = 0.2, 0.1 component = 'y' stress = '1 MPa' /\n"      \
  "&monitor name = 'u' kind = 'displacement' region = 'end' component = 'y' /\n"                   \
  "&monitor name = 's' kind = 'stress' at = 0.03, 0.084 component = 'xx' /\n"                      \
  "&output sample = '1 us' /\n"
#define MIXED PLATE("gauss = 2 dilatation = 'mean'")
#define SOFT  MIXED "&material mesh = 'plate' model = 'softening' k = 3e-4 /\n"

/* After the first step of an element at rest u_x = a x y dt: in a gauge the dilatation is that of
   the middle, half of the difference in either strain. */
static void gauges_see_the_mean_dilatation(void **state) {
  (void)state;
  const double a = 1, dt = 1e-6, y = 0.07, shift = 0.5 * a * dt * (0.05 - y);
  const pl_law *const ways[] = {&hooke_law, &bent};
  for (int k = 0; k < 2; k++) {
    laws_run c;
    laws_go(
        &c, &ways[k],
        "&simulation end_time = '1 us' step = '1 us' /\n"
        "&mesh name = 'plate' size = 0.2, 0.1 nodes = 2, 2 thickness = 0.02 setting = "
        "'plane_strain' "
        "method = 'finite_elements' gauss = 2 dilatation = 'mean' /\n"
        "&material mesh = 'plate' model = 'hooke' E = 30e9 nu = 0.2 rho = 2400 /\n"
        "&region name = 'all' lattice = 'plate' shape = 'rectangle' corner = -1, -1 size = 3, 3 /\n"
        "&initial_velocity region = 'all' component = 'x' value = '1 [m/s]*x*y/1 [m^2]' /\n"
        "&monitor name = 'x' kind = 'strain' at = 0.13, 0.07 component = 'xx' /\n"
        "&monitor name = 'y' kind = 'strain' at = 0.13, 0.07 component = 'yy' /\n"
        "&monitor name = 's' kind = 'stress' at = 0.13, 0.07 component = 'yy' /\n"
        "&output sample = '1 us' /\n");
    print_message("strain %.9g, %.9g\n", small_last(&c.r, "x"), small_last(&c.r, "y"));
    assert_true(fabs(small_last(&c.r, "x") - (a * y * dt + shift)) < 1e-10 * a * dt);
    assert_true(fabs(small_last(&c.r, "y") - shift) < 1e-10 * a * dt);
    const double stress = 30e9 / (1 - 0.2 * 0.2) * (shift + 0.2 * (a * y * dt + shift));
    assert_true(fabs(small_last(&c.r, "s") / stress - 1) < 1e-9);
    small_close(&c.r);
  }
}

static void runs_by_both_ways_agree(void **state) {
  (void)state;
  static const char *const names[] = {"u", "s", "energy/kinetic", "energy/stored"};
  const char *text = "&simulation end_time = '0.1 ms' step_safety = 0.9 /\n" MIXED
                     "&material mesh = 'plate' model = 'hooke' /\n";
  const pl_law *const linear[] = {&hooke_law}, *const points[] = {&bent};
  laws_run a, b;
  laws_go(&a, linear, text);
  laws_go(&b, points, text);
  for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
    const double *x = small_values(&a.r, names[n]), *y = small_values(&b.r, names[n]),
                 most = small_largest(&a.r, names[n]);
    assert_true(most > 0);
    for (long k = 0; k < simulation_history(a.r.simulation, NULL); k++)
      assert_true(fabs(x[k] - y[k]) <= 1e-10 * most);
  }
  assert_true(small_largest(&b.r, "energy/imbalance") <
              1e-11 * small_largest(&b.r, "energy/external"));
  small_close(&a.r);
  small_close(&b.r);
}

static const pl_law *const soft[] = {&softening_law};

static void threads_change_no_bit(void **state) {
  (void)state;
  laws_run c[LAWS_RUN_THREADS];
  laws_go_with_threads(c, soft, "end_time = '0.1 ms'", SOFT);
  assert_true(small_last(&c[0].r, "energy/dissipated_damage") > 0);
  assert_true(small_largest(&c[0].r, "energy/imbalance") <
              1e-11 * small_largest(&c[0].r, "energy/external"));
  for (int k = 0; k < LAWS_RUN_THREADS; k++)
    small_close(&c[k].r);
}

static void a_resumed_run_is_the_same(void **state) {
  (void)state;
  laws_run r, s;
  laws_resume(&r, &s, soft, "&simulation end_time = '0.1 ms' /\n" SOFT, 61);
  small_close(&r.r);
  small_close(&s.r);
}

/* What a cell that dies had stored in its hourglass modes is booked, too. */
static void dead_cells_resist_nothing(void **state) {
  (void)state;
  const pl_law *const laws[] = {&brittle_law};
  laws_run c;
  double first;
  laws_go(
      &c, laws,
      "&simulation end_time = '0.3 ms' step_safety = 0.7 /\n" PLATE(
          "gauss = 1 hourglass = 0.1") "&material mesh = 'plate' model = 'brittle' eps_u = 3e-5 "
                                       "/\n");
  const long died = cells_deaths(simulation_cells(c.r.simulation, 0), &first);
  const double taken = small_last(&c.r, "energy/dissipated_damage");
  print_message("%ld cells died; imbalance %.3g of what that took\n", died,
                small_largest(&c.r, "energy/imbalance") / taken);
  assert_true(died > 5);
  assert_true(small_largest(&c.r, "energy/imbalance") < 1e-9 * taken);
  small_close(&c.r);
}

/* --- decks ------------------------------------------------------------------------------------ */

static void refused(const char *elements, const char *setting, const char *message) {
  char text[2048];
  small_run r;
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n&mesh name = 'm' size = 1, 1 nodes = 5, 5 thickness = 1 "
           "setting = '%s' %s /\n&material mesh = 'm' model = 'hooke' /\n",
           setting, elements);
  small_read(&r, text);
  bool said = false;
  for (int k = 0; k < r.said.count; k++)
    said = said || strstr(r.said.items[k].message, message);
  if (!said) small_print(&r);
  assert_true(said && !r.deck);
  small_close(&r);
}

static void what_makes_no_sense_is_refused(void **state) {
  (void)state;
  refused("method = 'finite_elements' dilatation = 'mean'", "plane_stress",
          "in plane stress the thickness gives way");
  refused("method = 'finite_elements' gauss = 1 dilatation = 'mean'", "plane_strain",
          "has one dilatation anyhow");
  refused("method = 'element_free' dilatation = 'mean'", "plane_strain", "is of finite elements");
  refused("method = 'finite_elements' hourglass = 0.05", "plane_stress", "have no hourglass modes");
  refused("method = 'finite_elements' gauss = 1 hourglass = 3", "plane_stress", "0 to 1");
  refused("method = 'finite_elements' gauss = 1 hourglass = -1", "plane_stress", "negative");
  refused(
      "method = 'finite_elements' /\n&zone mesh = 'm' method = 'finite_elements' shape = 'disc' "
      "centre = 0, 0 radius = 0.6 dilatation = 'mean'",
      "plane_stress", "in plane stress the thickness gives way");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(lists_do_as_grids),
                                     cmocka_unit_test(both_ways_agree),
                                     cmocka_unit_test(linear_fields_are_exact),
                                     cmocka_unit_test(only_rigid_motions_are_free),
                                     cmocka_unit_test(a_square_bends_as_a_beam),
                                     cmocka_unit_test(a_membrane_does_not_lock),
                                     cmocka_unit_test(gauges_see_the_mean_dilatation),
                                     cmocka_unit_test(runs_by_both_ways_agree),
                                     cmocka_unit_test(threads_change_no_bit),
                                     cmocka_unit_test(a_resumed_run_is_the_same),
                                     cmocka_unit_test(dead_cells_resist_nothing),
                                     cmocka_unit_test(what_makes_no_sense_is_refused)};
  return cmocka_run_group_tests(tests, set_up, NULL);
}
