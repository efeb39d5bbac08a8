/* Forces by points of integration beside those of the assembled stencil, and what becomes of states
   that stand at points. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "both_ways.h"
#include "runtime/base/random_number.h"
#include "runtime/continuum/cells.h"
#include "runtime/continuum/point_forces.h"
#include "runtime/interaction/sweep.h"
#include "runtime/mesh/cell_strips.h"
#include "runtime/mesh/cut_cells.h"
#include "softening_law.h"
#include "tests/runtime/hand_over.h"
#include "tests/runtime/small_run.h"

static const double hooke_values[] = {30e9, 0.2, 2400};

/* --- forces ----------------------------------------------------------------------------------- */

/* A plate with zones of elements at its left edge and in the middle of the lower one. */
static void open_plate(mesh *m, int nx, int ny, double support, int gauss, int parts) {
  const double corner[2] = {0.3, -0.1}, size[2] = {0.1 * (nx - 1) / 10, 0.04 * (ny - 1) / 5};
  mesh_open(m, (int[2]){nx, ny}, corner, size, 0.02, support);
  m->gauss = gauss;
  m->gauss_parts = parts;
  for (int j = 0; j < ny; j++)
    for (int i = 0; i < nx; i++)
      if (i < 4 || (j < 3 && i > nx / 2 && i < nx / 2 + 5)) m->element_free[mesh_node(m, i, j)] = 0;
  memset(m->element_gauss, 2, (size_t)mesh_cell_count(m));
  m->element_gauss[0] = 1;
  mesh_settle(m);
}

static void open_both(both *b) {
  both_open(b, isotropic(30e9, 0.2, false), &hooke_law, hooke_values);
}

static void check_both(both *b) {
  double largest;
  open_both(b);
  both_move(b);
  both_find(b, false);
  const double most = both_differ(b, &largest);
  if (!(most <= 1e-13 * largest)) print_message("%.3g of %.3g\n", most, largest);
  assert_true(largest > 0);
  assert_true(most <= 1e-13 * largest);
  both_close(b);
}

static void both_ways_agree(void **state) {
  (void)state;
  both b;
  const struct {
    int nx, ny, gauss, parts;
    double support;
  } cases[] = {{31, 16, 4, 1, 3.5}, {31, 16, 4, 1, 2.1}, {9, 9, 6, 1, 5.5},
               {12, 7, 2, 2, 1.5},  {3, 3, 4, 1, 2.6},   {40, 5, 3, 1, 1.9}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    open_plate(&b.m, cases[k].nx, cases[k].ny, cases[k].support, cases[k].gauss, cases[k].parts);
    check_both(&b);
  }
}

/* Cracks hide nodes, so that cells that stand side by side differ. */
static void they_agree_about_cracks(void **state) {
  (void)state;
  both b;
  open_plate(&b.m, 31, 16, 3.5, 4, 1);
  crack_lines_add(&b.m.cracks, (double[2]){0.4512, 0.02}, (double[2]){0.4512, -0.033});
  crack_lines_add(&b.m.cracks, (double[2]){0.4512, -0.033}, (double[2]){0.4704, -0.041});
  check_both(&b);
}

/* A plate with a disc and a slot, in and beside its zones. */
static void open_holed(mesh *m, int gauss, int parts) {
  const deck_shape disc = {.kind = SHAPE_DISC, .centre = {0.4531, -0.0412}, .radius = 0.0247},
                   slot = {
                       .kind = SHAPE_RECTANGLE, .corner = {0.3213, -0.02}, .size = {0.07, 0.011}};
  open_plate(m, 31, 16, 2.6, gauss, parts);
  holes_add(&m->holes, &disc);
  holes_add(&m->holes, &slot);
  assert_in_range(mesh_cut(m), 31 * 16 - 60, 31 * 16 - 20);
  mesh_settle(m);
}

/* Cells that holes cut have points of their own number and places. */
static void they_agree_about_holes(void **state) {
  (void)state;
  both b;
  open_holed(&b.m, 4, 1);
  check_both(&b);
  open_holed(&b.m, 3, 2);
  check_both(&b);
}

/* What cells hold is the nodes' that are there, whatever of their corners holes have taken. */
static void nodes_share_all(void **state) {
  (void)state;
  both b;
  double sum = 0, all = 0;
  open_holed(&b.m, 4, 1);
  open_both(&b);
  double *plane = must_calloc((size_t)b.P->strips.count, sizeof *plane);
  for (int k = 0; k < b.P->strips.count; k++) {
    plane[k] = random_unit(random_mix((uint64_t)k));
    all += b.P->strips.volume[k] * plane[k];
  }
  for (int n = 0; n < mesh_node_count(&b.m); n++)
    if (!b.m.gone[n]) sum += point_forces_share(b.P, plane, n);
  assert_true(all > 0 && fabs(sum - all) < 1e-12 * all);
  free(plane);
  both_close(&b);
}

/* Its stress and its output are the size of the cell. */
static void sized_step(const pl_law *law, const double *uniforms, const pl_points *p) {
  (void)law, (void)uniforms;
  for (long q = 0; q < p->count; q++)
    for (int c = 0; c < 4; c++)
      p->stress[c][q] = p->cell_size[q];
}

static void sized_observe(const pl_law *law, const double *uniforms, const pl_points *p) {
  hooke_law.point_observe(law, uniforms, p);
  for (long q = 0; q < p->count; q++)
    p->observed[0][q] = p->cell_size[q] * p->cell_size[q] / 1e3;
}

/* Cook's outline: cells are of many sizes. */
static const double cook[4][2] = {{0, 0}, {48, 44}, {48, 60}, {0, 44}};

static void laws_read_the_size_of_their_cell(void **state) {
  (void)state;
  pl_law sized = hooke_law;
  sized.point_step = sized_step;
  sized.point_observe = sized_observe;
  sized.reads_size = 1;
  mesh m;
  integration_points points;
  mesh_open_mapped(&m, (int[2]){12, 6}, cook, 1, 2.1);
  integration_points_open(&points, &m);
  point_forces *p = point_forces_new(&m, NULL, &points, &sized, hooke_values, 1, true);
  pool *memory = pool_new();
  const double *u = pool_doubles(memory, p->strips.layout.size);
  double sum = 0, stored = 0, expected = 0;
  const double *const still[2] = {u, u};
  const point_motion at = {still, still, 0, 1, 0};
  point_forces_find(p, 0, 0, m.nodes[1], &at, true, NULL);
  for (int c = 0; c < mesh_cell_count(&m); c++) {
    double area = 0;
    for (int n = points.first[c]; n < points.first[c + 1]; n++)
      area += points.area[n];
    sum += area;
    expected += area * area / 1e3;
    assert_true(fabs(mesh_cell_size(&m, c) - sqrt(area)) < 1e-13);
    for (int n = 0; n < points.first[c + 1] - points.first[c]; n++)
      assert_true(fabs(p->stress[p->strips.of_cell[c] + n * PL_LANES] - sqrt(area)) < 1e-13);
  }
  for (int row = 0; row < p->strips.rows; row++)
    stored += p->rows[row].stored;
  assert_true(fabs(sum - quadrilateral_area(cook)) < 1e-10);
  assert_true(fabs(stored - expected) < 1e-12 * expected);
  pool_free(memory);
  point_forces_free(p);
  integration_points_close(&points);
  mesh_close(&m);
}

static long asked;

static void sized_tangent(const pl_law *law, const double *uniforms, const pl_points *p) {
  hooke_law.point_tangent(law, uniforms, p);
  for (int c = 0; c < 9; c++)
    for (long q = 0; q < p->count; q++)
      p->tangent[c][q] *= p->cell_size[q];
  asked++;
}

/* Of a law that reads sizes the stiffest of its cells counts; of another one any cell will do. */
static void the_stiffest_cell_counts(void **state) {
  (void)state;
  const plane_stiffness of = isotropic(30e9, 0.2, false);
  pl_law sized = hooke_law;
  sized.point_tangent = sized_tangent;
  mesh m;
  mesh_open_mapped(&m, (int[2]){12, 6}, cook, 1, 2.1);
  for (int k = 0; k < 3; k++) {
    unsigned char own[55];
    double D[3][3], most = 0;
    for (int c = 0; c < mesh_cell_count(&m); c++) {
      own[c] = k == 0 || c % 11 > 6;
      if (own[c]) most = fmax(most, mesh_cell_size(&m, c));
    }
    sized.reads_size = k < 2;
    asked = 0;
    point_forces_rest(&m, k ? own : NULL, &sized, hooke_values, false, D);
    if (k == 2) assert_int_equal(asked, 1);
    for (int i = 0; i < 3 && k < 2; i++)
      for (int j = 0; j < 3; j++)
        assert_true(fabs(D[i][j] - most * of.D[i][j]) <= 1e-12 * most * of.D[0][0]);
  }
  mesh_close(&m);
}

/* Cells that are alike share what acts in them: a larger mesh has a few tables more or none. */
static void tables_are_shared(void **state) {
  (void)state;
  mesh m;
  int tables[2];
  for (int k = 0; k < 2; k++) {
    integration_points points;
    cell_strips s;
    mesh_open(&m, (int[2]){25 + 16 * k, 25 + 32 * k}, (double[2]){0, 0},
              (double[2]){24 + 16 * k, 24 + 32 * k}, 1, 2.6);
    mesh_settle(&m);
    integration_points_open(&points, &m);
    cell_strips_open(&s, &m, &points, NULL);
    tables[k] = s.table_count;
    cell_strips_close(&s);
    integration_points_close(&points);
    mesh_close(&m);
  }
  assert_true(tables[0] <= 21);
  assert_true(tables[1] <= tables[0] + 7);
}

/* Small turns and shifts of the whole strain nothing. */
static void rigid_motions_push_nothing(void **state) {
  (void)state;
  both b;
  double largest = 0, most = 0;
  open_plate(&b.m, 31, 16, 2.6, 4, 1);
  open_both(&b);
  both_move(&b);
  both_find(&b, false);
  for (int n = 0; n < mesh_node_count(&b.m); n++)
    for (int d = 0; d < 2; d++)
      largest = fmax(largest, fabs(b.by_points[d][node_layout_at(&b.K.layout, n)]));
  for (int n = 0; n < mesh_node_count(&b.m); n++) {
    double at[2];
    mesh_place(&b.m, n, at);
    b.u[0][node_layout_at(&b.K.layout, n)] = 2e-5 - 1e-4 * at[1];
    b.u[1][node_layout_at(&b.K.layout, n)] = -3e-5 + 1e-4 * at[0];
  }
  both_find(&b, false);
  for (int n = 0; n < mesh_node_count(&b.m); n++)
    for (int d = 0; d < 2; d++)
      most = fmax(most, fabs(b.by_points[d][node_layout_at(&b.K.layout, n)]));
  assert_true(most < 1e-11 * largest);
  both_close(&b);
}

/* Hooke's law that has no number beyond a strain. */
static void brittle_step(const pl_law *law, const double *uniforms, const pl_points *p) {
  hooke_step(law, uniforms, p);
  for (long q = 0; q < p->count; q++)
    if (p->strain[0][q] > 3e-5) p->stress[0][q] = NAN;
}

/* What fills vectors up is not strained by what lies beside the mesh. */
static void nothing_comes_from_beside(void **state) {
  (void)state;
  both b;
  pl_law brittle = hooke_law;
  brittle.point_step = brittle_step;
  open_plate(&b.m, 12, 7, 2.1, 4, 1);
  open_both(&b);
  point_forces_free(b.P);
  b.P = point_forces_new(&b.m, NULL, &b.points, &brittle, hooke_values, 1, true);
  for (int d = 0; d < 2; d++)
    for (int n = 0; n < mesh_node_count(&b.m); n++)
      b.u[d][node_layout_at(&b.K.layout, n)] = d ? 0.002 : -0.003;
  both_find(&b, false);
  for (int d = 0; d < 2; d++)
    for (int n = 0; n < mesh_node_count(&b.m); n++)
      assert_true(fabs(b.by_points[d][node_layout_at(&b.K.layout, n)]) < 1);
  both_close(&b);
}

/* Forces of a mesh of which x and y, or left and right, have changed places, come with it. */
static void mirrored(bool transposed) {
  double *f[2][2];
  node_layout l[2];
  both b[2];
  for (int k = 0; k < 2; k++) {
    const int nodes[2] = {k && transposed ? 9 : 15, k && transposed ? 15 : 9};
    const double size[2] = {nodes[0] - 1, nodes[1] - 1};
    mesh_open(&b[k].m, nodes, (double[2]){0, 0}, size, 0.02, 2.6);
    mesh_settle(&b[k].m);
    open_both(&b[k]);
    l[k] = b[k].K.layout;
  }
  for (int j = 0; j < 9; j++)
    for (int i = 0; i < 15; i++) {
      const int n = mesh_node(&b[0].m, i, j),
                image = transposed ? mesh_node(&b[1].m, j, i) : mesh_node(&b[1].m, 14 - i, j);
      for (int d = 0; d < 2; d++) {
        const double u = 1e-4 * (random_unit(random_mix((uint64_t)(2 * n + d))) - 0.5);
        b[0].u[d][node_layout_at(&l[0], n)] = u;
        b[1].u[transposed ? 1 - d : d][node_layout_at(&l[1], image)] =
            !transposed && d == 0 ? -u : u;
      }
    }
  double most = 0, largest = 0;
  for (int k = 0; k < 2; k++) {
    both_find(&b[k], false);
    f[k][0] = b[k].by_points[0];
    f[k][1] = b[k].by_points[1];
  }
  for (int j = 0; j < 9; j++)
    for (int i = 0; i < 15; i++)
      for (int d = 0; d < 2; d++) {
        const int n = mesh_node(&b[0].m, i, j),
                  image = transposed ? mesh_node(&b[1].m, j, i) : mesh_node(&b[1].m, 14 - i, j);
        const double here = f[0][d][node_layout_at(&l[0], n)],
                     there = f[1][transposed ? 1 - d : d][node_layout_at(&l[1], image)];
        most = fmax(most, fabs(here - (!transposed && d == 0 ? -there : there)));
        largest = fmax(largest, fabs(here));
      }
  assert_true(largest > 0 && most < 1e-12 * largest);
  both_close(&b[0]);
  both_close(&b[1]);
}

static void mirror_images_push_alike(void **state) {
  (void)state;
  mirrored(false);
  mirrored(true);
}

/* --- runs ------------------------------------------------------------------------------------- */

#define BARE                                                                                       \
  "&mesh name = 'plate' corner = '10 mm', 0 size = '200 mm', '100 mm' nodes = 21, 11 "             \
  "thickness = '20 mm' method = 'element_free' support = 2.6 /\n"                                  \
  "&zone mesh = 'plate' method = 'finite_elements' shape = 'rectangle' corner = '10 mm', 0 "       \
  "size = '30 mm', '100 mm' /\n"                                                                   \
  "&region name = 'left' shape = 'segment' from = '10 mm', 0 to = '10 mm', '100 mm' /\n"           \
  "&region name = 'right' shape = 'segment' from = '210 mm', 0 to = '210 mm', '100 mm' /\n"        \
  "&support region = 'left' fix = 'x', 'y' /\n"                                                    \
  "&traction mesh = 'plate' from = '210 mm', 0 to = '210 mm', '100 mm' component = 'x' stress = "  \
  "'1 MPa' /\n"                                                                                    \
  "&monitor name = 'u' kind = 'displacement' region = 'right' component = 'x' /\n"                 \
  "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' /\n"
#define PLATE BARE "&output sample = '1 us' /\n"
#define HOOKE "&material mesh = 'plate' model = 'hooke' /\n"
#define SOFT  "&material mesh = 'plate' model = 'softening' k = 3e-4 tau = '1 us' /\n"

static bool says(small_run *r, const char *text) {
  for (int k = 0; k < r->said.count; k++)
    if (strstr(r->said.items[k].message, text)) return true;
  small_print(r);
  return false;
}

static void go(small_run *r, const pl_law *law, const char *text) {
  small_open(r, law, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
  assert_int_equal(small_go(r), STEP_END);
}

/* A linear law by both ways. */
static void runs_by_both_ways_agree(void **state) {
  (void)state;
  static const char *const names[] = {"u", "load", "energy/kinetic", "energy/stored",
                                      "energy/dissipated_damping"};
  const char *text =
      "&simulation end_time = '0.1 ms' step_safety = 0.5 /\n&newmark beta_1 = 0.8 /\n" PLATE HOOKE;
  pl_law bent = hooke_law;
  bent.linear = 0;
  small_run r, s;
  go(&r, &hooke_law, text);
  go(&s, &bent, text);
  const long count = simulation_history(r.simulation, NULL);
  assert_int_equal(count, simulation_history(s.simulation, NULL));
  for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
    const double *a = small_values(&r, names[n]), *b = small_values(&s, names[n]),
                 largest = small_largest(&r, names[n]);
    for (long k = 0; k < count; k++)
      assert_true(fabs(a[k] - b[k]) <= 1e-10 * largest);
    assert_true(largest > 0);
  }
  small_close(&r);
  small_close(&s);
}

/* Drawn out slowly both are in uniaxial stress. */
static void quasi_static_runs_agree(void **state) {
  (void)state;
  const char *text =
      "&simulation end_time = 1 /\n&relaxation increments = 2 tolerance = 1e-9 /\n"
      "&mesh name = 'bar' size = 0.2, 0.04 nodes = 21, 5 thickness = '20 mm' "
      "method = 'element_free' support = 2.1 /\n"
      "&zone mesh = 'bar' method = 'finite_elements' shape = 'rectangle' corner = 0, 0 "
      "size = 0.03, 0.04 /\n"
      "&zone mesh = 'bar' method = 'finite_elements' shape = 'rectangle' corner = 0.17, 0 "
      "size = 0.03, 0.04 /\n"
      "&material mesh = 'bar' model = 'hooke' nu = 0.3 /\n"
      "&region name = 'left' shape = 'segment' from = 0, 0 to = 0, 0.04 /\n"
      "&region name = 'right' shape = 'segment' from = 0.2, 0 to = 0.2, 0.04 /\n"
      "&support region = 'left' fix = 'x' /\n"
      "&drive region = 'right' component = 'x' displacement = '0.02 mm' /\n"
      "&monitor name = 'load' kind = 'reaction' region = 'right' component = 'x' /\n";
  pl_law bent = hooke_law;
  bent.linear = 0;
  const pl_law *laws[] = {&hooke_law, &bent};
  for (int k = 0; k < 2; k++) {
    small_run r;
    go(&r, laws[k], text);
    const double load = 30e9 * 1e-4 * 0.04 * 0.02;
    assert_true(fabs(small_last(&r, "load") - load) < 1e-7 * load);
    assert_true(fabs(small_last(&r, "energy/stored") - 0.5 * load * 2e-5) < 1e-7 * load * 2e-5);
    assert_true(fabs(small_last(&r, "energy/imbalance")) < 1e-9 * load * 2e-5);
    small_close(&r);
  }
}

static double series_sum(small_run *r) {
  double sum = 0;
  static const char *const names[] = {"u", "load", "energy/dissipated_damage",
                                      "energy/dissipated_damping", "energy/stored"};
  for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
    const double *values = small_values(r, names[n]);
    for (long k = 0; k < simulation_history(r->simulation, NULL); k++)
      sum += values[k] * (double)(k + 1) / (1e-300 + small_largest(r, names[n]));
  }
  return sum;
}

static void threads_change_no_bit(void **state) {
  (void)state;
  double first = 0;
  for (int threads = 1; threads <= 3; threads++) {
    char text[4096];
    small_run r;
    snprintf(text, sizeof text, "&simulation end_time = '0.15 ms' threads = %d /\n%s", threads,
             PLATE SOFT);
    go(&r, &softening_law, text);
    const double sum = series_sum(&r);
    if (threads == 1) first = sum;
    assert_true(small_last(&r, "energy/dissipated_damage") > 0);
    assert_true(sum == first);
    small_close(&r);
  }
}

static void a_resumed_run_is_the_same(void **state) {
  (void)state;
  const char *text = "&simulation end_time = '0.15 ms' /\n&newmark beta_1 = 0.7 /\n" PLATE SOFT;
  small_run r, s;
  small_open(&r, &softening_law, text);
  small_open(&s, &softening_law, text);
  hand_over(r.simulation, 81, s.simulation);
  small_go(&r);
  small_go(&s);
  assert_true(small_last(&r, "energy/dissipated_damage") > 0);
  assert_true(series_sum(&r) == series_sum(&s));
  small_close(&r);
  small_close(&s);
}

/* What states and rates take is booked: the imbalance falls with the step (ledger.h). */
static double imbalance_of(const char *safety) {
  char text[4096];
  small_run r;
  snprintf(text, sizeof text, "&simulation end_time = '0.15 ms' step_safety = %s /\n%s", safety,
           PLATE SOFT);
  go(&r, &softening_law, text);
  const double part = small_largest(&r, "energy/imbalance") / small_largest(&r, "energy/external");
  assert_true(small_last(&r, "energy/dissipated_damage") >
              0.02 * small_last(&r, "energy/external"));
  assert_true(small_last(&r, "energy/dissipated_damping") >
              0.005 * small_last(&r, "energy/external"));
  small_close(&r);
  return part;
}

/* Where rates take nothing a quadratic energy is balanced to rounding, whatever the step: the work
   of the mean of two stresses is that of the way between. */
static void states_are_balanced(void **state) {
  (void)state;
  small_run r;
  go(&r, &softening_law,
     "&simulation end_time = '0.15 ms' step_safety = 0.8 /\n" PLATE
     "&material mesh = 'plate' model = 'softening' k = 3e-4 /\n");
  const double external = small_largest(&r, "energy/external");
  assert_true(small_last(&r, "energy/dissipated_damage") > 0.02 * external);
  assert_true(small_largest(&r, "energy/imbalance") < 1e-11 * external);
  small_close(&r);
}

static void losses_are_booked(void **state) {
  (void)state;
  const double coarse = imbalance_of("0.4"), middle = imbalance_of("0.2"),
               fine = imbalance_of("0.1");
  print_message("imbalance %.3g, %.3g, %.3g\n", coarse, middle, fine);
  assert_true(coarse < 0.02);
  assert_true(middle < 0.65 * coarse && fine < 0.65 * middle && fine < 5e-4);
}

/* Nodes show the mean of the points around: of a bar that is stretched evenly what each point
   has. */
static void nodes_show_states(void **state) {
  (void)state;
  small_run r;
  const frame_field *fields;
  go(&r, &softening_law,
     "&simulation end_time = '1 ms' /\n&relaxation increments = 20 tolerance = 1e-9 /\n"
     "&mesh name = 'bar' size = 0.2, 0.02 nodes = 21, 3 thickness = '20 mm' "
     "method = 'finite_elements' /\n"
     "&material mesh = 'bar' model = 'softening' nu = 1e-9 k = 1e-3 /\n"
     "&region name = 'left' shape = 'segment' from = 0, 0 to = 0, 0.02 /\n"
     "&region name = 'right' shape = 'segment' from = 0.2, 0 to = 0.2, 0.02 /\n"
     "&support region = 'left' fix = 'x', 'y' /\n"
     "&drive region = 'right' component = 'x' displacement = '0.02 mm' /\n"
     "&output fields = 'kappa', 'omega', 'press', 'damage', 'dissipated' frames = 1 /\n");
  const double kappa = 1e-4, omega = kappa / (kappa + 1e-3),
               expected[] = {kappa, omega, (1 - omega) * 30e9 * kappa / 3, omega};
  const char *const names[] = {"kappa", "omega", "press", "damage"};
  int found = 0;
  double values[126], lost = 0;
  const int count = simulation_frame_fields(r.simulation, &fields);
  for (int f = 0; f < count; f++) {
    simulation_frame_values(r.simulation, f, values);
    for (int n = 0; n < 4; n++) {
      if (strcmp(fields[f].name, names[n]) != 0) continue;
      found++;
      assert_int_equal(fields[f].count, fields[f].on_cells ? 40 : 63);
      for (int p = 0; p < fields[f].count; p++)
        assert_true(fabs(values[p] - expected[n]) < 1e-2 * expected[n]);
    }
    for (int p = 0; p < 63 && strcmp(fields[f].name, "dissipated") == 0; p++)
      lost += values[p];
  }
  assert_int_equal(found, 2 * 4); /* of nodes, of cells */
  double stress[4], states[2], most[2] = {0, 0};
  const cells *c = simulation_cells(r.simulation, 0);
  for (int p = 0; p < 63; p++) {
    assert_true(cells_mean_stress(c, 0, p, stress));
    assert_true(fabs(stress[0] - 3 * expected[2]) < 1e-2 * 3 * expected[2]);
    assert_true(fabs(stress[1]) < 1e-3 * stress[0] && fabs(stress[2]) < 1e-3 * stress[0]);
  }
  for (int n = 0; n < c->points.count; n++) {
    assert_true(cells_states_near(c, c->points.at[n], states));
    for (int f = 0; f < 2; f++)
      most[f] = fmax(most[f], fabs(states[f] - expected[f]) / expected[f]);
  }
  assert_true(most[0] > 0 && most[0] < 1e-2 && most[1] < 1e-2);
  assert_false(cells_states_near(c, (double[2]){1, 1}, states));
  const double taken = small_last(&r, "energy/dissipated_damage");
  assert_true(taken > 0 && fabs(lost - taken) < 1e-9 * taken);
  small_close(&r);
}

#define HOLE "&notch mesh = 'plate' shape = 'disc' centre = '76 mm', '34 mm' radius = '24 mm' /\n"

/* Nodes in a hole are no particles, so that these have other numbers than nodes. */
static void nodes_beside_a_hole_show_states(void **state) {
  (void)state;
  small_run r;
  const frame_field *fields;
  double values[231], stress[4], most = 0;
  go(&r, &softening_law,
     "&simulation end_time = '0.1 ms' /\n" BARE HOLE
     "&material mesh = 'plate' model = 'softening' k = 3e-4 /\n"
     "&output fields = 'press', 'dissipated' frames = 1 /\n");
  const cells *c = simulation_cells(r.simulation, 0);
  const rows *w = simulation_rows(r.simulation, 0);
  assert_in_range(w->particle_count, 200, 220);
  const double taken = small_last(&r, "energy/dissipated_damage");
  int found = 0;
  for (int f = 0; f < simulation_frame_fields(r.simulation, &fields); f++) {
    const bool press = strcmp(fields[f].name, "press") == 0;
    double sum = 0;
    if (fields[f].on_cells || (!press && strcmp(fields[f].name, "dissipated") != 0)) continue;
    found++;
    simulation_frame_values(r.simulation, f, values);
    for (long p = 0; p < w->particle_count; p++) {
      sum += values[p];
      if (!press) continue;
      assert_true(cells_mean_stress(c, 0, cells_node(c, w->particle_site[p]), stress));
      most = fmax(most, fabs(values[p]));
      assert_true(fabs(values[p] - (stress[0] + stress[1]) / 3) < 1);
    }
    if (!press) assert_true(taken > 0 && fabs(sum - taken) < 1e-9 * taken);
  }
  assert_true(found == 2 && most > 1e5);
  const sweep *of = simulation_state(r.simulation, 0);
  for (long q = 0; q < w->size; q++)
    for (int f = 0; f < SOFT_FIELDS; f++)
      assert_true(isfinite(of->new_field[f][q]) && isfinite(of->field[f][q]));
  small_close(&r);
}

/* A damper shortens the step: with tau = 1/omega_max the limit is (sqrt(5) - 1)/2 of that
   without. */
static void dampers_shorten_the_step(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &softening_law,
             "&simulation end_time = '0.1 ms' /\n" PLATE
             "&material mesh = 'plate' model = 'softening' /\n");
  const step_limit bare = *simulation_step_limit(r.simulation);
  small_close(&r);
  char text[4096];
  snprintf(text, sizeof text,
           "&simulation end_time = '0.1 ms' /\n%s&material mesh = 'plate' model = "
           "'softening' tau = %.17g /\n",
           PLATE, 1 / bare.omega_max);
  small_open(&r, &softening_law, text);
  const step_limit *limit = simulation_step_limit(r.simulation);
  assert_true(fabs(limit->limit / bare.limit - 0.5 * (sqrt(5) - 1)) < 0.01);
  small_close(&r);
}

/* --- what goes wrong -------------------------------------------------------------------------- */

static void names_bad_point(const char *text) {
  pl_law brittle = hooke_law;
  small_run r;
  brittle.linear = 0;
  brittle.point_step = brittle_step;
  small_open(&r, &brittle, text);
  assert_non_null(r.simulation);
  assert_int_equal(small_go(&r), STEP_BAD);
  const bad_state bad = simulation_bad(r.simulation);
  assert_string_equal(bad.what, "not a number");
  assert_non_null(bad.point);
  assert_true(bad.point->strain[0] > 2.9e-5 && bad.point->strain[0] < 1e-3);
  assert_true(isnan(bad.point->stress[0]));
  assert_in_range(bad.point->cell[0], 0, 19);
  assert_in_range(bad.point->cell[1], 0, 9);
  assert_true(fabs(bad.point->at[0] - bad.place[0]) <= 0.027 &&
              fabs(bad.point->at[1] - bad.place[1]) <= 0.027);
  small_close(&r);
}

static void a_bad_point_is_named(void **state) {
  (void)state;
  names_bad_point("&simulation end_time = '0.15 ms' /\n" PLATE HOOKE);
  names_bad_point("&simulation end_time = '0.15 ms' /\n" PLATE HOOKE
                  "&notch mesh = 'plate' shape = 'disc' centre = '76 mm', 0 radius = '24 mm' /\n");
}

static void cracks_are_refused(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &softening_law,
             "&simulation end_time = '0.1 ms' /\n" PLATE SOFT
             "&crack name = 'c' mesh = 'plate' points = 0.1234, 0.1, 0.1234, 0.053 /\n");
  assert_null(r.simulation);
  assert_true(says(&r, "a crack needs a linear elastic law"));
  small_close(&r);
}

/* Hooke's law whose tangent grows with the strain: nine times as stiff at 1e-4. */
static void stiff_tangent(const pl_law *law, const double *uniforms, const pl_points *p) {
  hooke_tangent(law, uniforms, p);
  for (int k = 0; k < 9; k++)
    for (long q = 0; q < p->count; q++)
      p->tangent[k][q] *= 1 + 8e4 * fabs(p->strain[0][q]);
}

static void stiffening_is_seen(void **state) {
  (void)state;
  pl_law stiff = hooke_law;
  small_run r;
  stiff.linear = 0;
  stiff.point_tangent = stiff_tangent;
  go(&r, &stiff,
     "&simulation end_time = '1 ms' /\n&relaxation increments = 1 tolerance = 1e-11 /\n"
     "&mesh name = 'bar' size = 0.2, 0.02 nodes = 21, 3 thickness = '20 mm' "
     "method = 'finite_elements' /\n"
     "&material mesh = 'bar' model = 'hooke' nu = 1e-9 /\n"
     "&region name = 'left' shape = 'segment' from = 0, 0 to = 0, 0.02 /\n"
     "&region name = 'right' shape = 'segment' from = 0.2, 0 to = 0.2, 0.02 /\n"
     "&support region = 'left' fix = 'x', 'y' /\n"
     "&drive region = 'right' component = 'x' displacement = '0.02 mm' /\n");
  const cells *c = simulation_cells(r.simulation, 0);
  assert_true(c->stiffened.now > 8.95 && c->stiffened.now < 9.05);
  assert_true(c->stiffened.most >= c->stiffened.now && c->stiffened.most < 20); /* on the way */
  assert_true(c->stiffened.since >= 0);
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(both_ways_agree),
                                     cmocka_unit_test(they_agree_about_cracks),
                                     cmocka_unit_test(they_agree_about_holes),
                                     cmocka_unit_test(nodes_share_all),
                                     cmocka_unit_test(nodes_beside_a_hole_show_states),
                                     cmocka_unit_test(laws_read_the_size_of_their_cell),
                                     cmocka_unit_test(the_stiffest_cell_counts),
                                     cmocka_unit_test(tables_are_shared),
                                     cmocka_unit_test(rigid_motions_push_nothing),
                                     cmocka_unit_test(nothing_comes_from_beside),
                                     cmocka_unit_test(mirror_images_push_alike),
                                     cmocka_unit_test(runs_by_both_ways_agree),
                                     cmocka_unit_test(quasi_static_runs_agree),
                                     cmocka_unit_test(threads_change_no_bit),
                                     cmocka_unit_test(a_resumed_run_is_the_same),
                                     cmocka_unit_test(states_are_balanced),
                                     cmocka_unit_test(losses_are_booked),
                                     cmocka_unit_test(nodes_show_states),
                                     cmocka_unit_test(dampers_shorten_the_step),
                                     cmocka_unit_test(a_bad_point_is_named),
                                     cmocka_unit_test(cracks_are_refused),
                                     cmocka_unit_test(stiffening_is_seen)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
