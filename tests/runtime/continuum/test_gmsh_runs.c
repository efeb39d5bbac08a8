/* Runs of meshes from Gmsh: regions of physical groups, loads on edges, materials of groups, the
   same bits for any number of threads; and decks that do not suit their file. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "brittle_law.h"
#include "hooke_law.h"
#include "runtime/continuum/cells.h"
#include "runtime/continuum/side_load.h"
#include "runtime/geometry/gmsh_mesh.h"
#include "runtime/simulation/frame_field.h"
#include "tests/runtime/small_run.h"

/* A square of 1 mm, its quadrant at the upper right an arc of radius 1 mm about (0, 0): two
   triangles of 6 nodes. */
static const char disc[] =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
    "$PhysicalNames\n4\n1 1 \"base\"\n1 2 \"arc\"\n2 1 \"lower\"\n2 2 "
    "\"upper\"\n$EndPhysicalNames\n"
    "$Entities\n0 3 2 0\n1 0 0 0 1 0 0 1 1 0\n2 0 0 0 1 1 0 1 2 0\n3 0 0 0 0 1 0 0 0\n"
    "1 0 0 0 1 1 0 1 1 0\n2 0 0 0 1 1 0 1 2 0\n$EndEntities\n"
    "$Nodes\n1 9 1 9\n2 1 0 9\n1 2 3 4 5 6 7 8 9\n0 0 0\n1 0 0\n0 1 0\n.7071067811865476 "
    ".7071067811865476 0\n.5 0 0\n.9238795325112867 .3826834323650898 0\n.3826834323650898 "
    ".9238795325112867 0\n0 .5 0\n.3535533905932738 .3535533905932738 0\n$EndNodes\n"
    "$Elements\n4 5 1 5\n1 1 8 1\n1 1 2 5\n1 2 8 2\n2 2 4 6\n3 4 3 7\n2 1 9 1\n4 1 2 4 5 6 9\n"
    "2 2 9 1\n5 1 4 3 9 7 8\n$EndElements\n";

static const char rest[] = "&support region = 'base' fix = 'x', 'y' /\n";

static int threads_wanted = 1;
static const char *whole_deck; /* in place of the one below */

static void read_deck(small_run *r, const char *msh, const char *more) {
  char text[4096];
  memset(r, 0, sizeof *r);
  r->memory = arena_new();
  diag_begin(&r->said, &r->sources);
  snprintf(text, sizeof text,
           "&simulation end_time = '2 us' threads = %d /\n"
           "&mesh name = 'disc' file = 'disc.msh' unit = 'mm' thickness = '10 mm' /\n"
           "&material mesh = 'disc' model = 'hooke' /\n%s",
           threads_wanted, more);
  const char *whole = whole_deck ? whole_deck : text;
  const int file = source_add(&r->sources, "deck.nml", whole, strlen(whole));
  source_add(&r->sources, "disc.msh", msh, strlen(msh));
  r->deck = deck_read(r->memory, &r->sources, file, NULL, 0, &r->said);
}

static void open_file(small_run *r, const char *msh, const char *more) {
  read_deck(r, msh, more);
  if (!r->deck) small_print(r);
  assert_non_null(r->deck);
  assert_true(material_parameters(&r->deck->materials[0], &hooke_law, r->parameters, &r->said));
  for (int k = 0; k < r->deck->interaction_count; k++)
    r->laws[k] = (simulation_law){.law = &hooke_law, .parameters = r->parameters};
  r->simulation = simulation_new(r->deck, r->laws, &r->said);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

static void open_run(small_run *r, const char *more) {
  open_file(r, disc, more);
}

static void groups_are_regions(void **state) {
  (void)state;
  small_run r;
  read_deck(&r, disc, rest);
  assert_non_null(r.deck);
  assert_int_equal(r.deck->region_count, 4);
  const deck_region *arc = &r.deck->regions[deck_find_region(r.deck, "arc")];
  assert_string_equal(arc->lattice, "disc");
  assert_int_equal(arc->shape.member_count, 5);
  assert_true(arc->group->dimension == 1);
  const gmsh_mesh *m = r.deck->lattices[0].gmsh;
  assert_int_equal(m->node_count, 9);
  assert_true(r.deck->lattices[0].nodes[0] * r.deck->lattices[0].nodes[1] >= 9);
  small_close(&r);
}

typedef struct sums {
  double x, y, around, length;
} sums;

static void add_normal(void *context, const double at[2], const double normal[2], double area,
                       const point_shape *s) {
  sums *sum = context;
  double whole = 0;
  for (int k = 0; k < s->count; k++)
    whole += s->n[k];
  assert_true(fabs(whole - 1) < 1e-14);
  assert_true(fabs(normal[0] * normal[0] + normal[1] * normal[1] - 1) < 1e-14);
  sum->x += area * normal[0];
  sum->y += area * normal[1];
  sum->around += area * (at[0] * normal[1] - at[1] * normal[0]);
}

/* A pressure on an arc: its resultant is that on the chord, its moment that of the chord, too. */
static void normals_point_out(void **state) {
  (void)state;
  small_run r;
  open_run(&r, rest);
  const cells *c = simulation_cells(r.simulation, 0);
  const gmsh_mesh *m = r.deck->lattices[0].gmsh;
  sums sum = {0};
  sum.length = sides_visit(&c->mesh, m, gmsh_mesh_group(m, "arc"), add_normal, &sum);
  assert_true(fabs(sum.x - 1e-5) < 1e-17 && fabs(sum.y - 1e-5) < 1e-17);
  assert_true(fabs(sum.around) < 1e-4 * 1e-8); /* of parabolas, not quite a circle */
  assert_true(fabs(sum.length - M_PI_2 * 1e-3) < 2e-3 * 1e-3);
  sum = (sums){0};
  sides_visit(&c->mesh, m, gmsh_mesh_group(m, "base"), add_normal, &sum);
  assert_true(fabs(sum.x) < 1e-20 && fabs(sum.y + 1e-5) < 1e-17);
  small_close(&r);
}

/* Of a curve that runs the other way round than its surface normals point out, too. */
static void normals_of_turned_curves_point_out(void **state) {
  (void)state;
  char turned[sizeof disc];
  small_run r;
  memcpy(turned, disc, sizeof disc);
  char *lines = strstr(turned, "2 2 4 6\n3 4 3 7\n"), *base = strstr(turned, "1 1 2 5\n");
  assert_true(lines && base);
  memcpy(lines, "2 4 2 6\n3 3 4 7\n", 16);
  memcpy(base, "1 2 1 5\n", 8);
  open_file(&r, turned,
            "&support region = 'base' fix = 'x', 'y' /\n&static /\n"
            "&monitor name = 'x' kind = 'reaction' region = 'base' component = 'x' /\n"
            "&monitor name = 'y' kind = 'reaction' region = 'base' component = 'y' /\n"
            "&traction mesh = 'disc' edge = 'arc' component = 'normal' stress = '1 MPa' /\n");
  const cells *c = simulation_cells(r.simulation, 0);
  const gmsh_mesh *m = r.deck->lattices[0].gmsh;
  sums sum = {0};
  sides_visit(&c->mesh, m, gmsh_mesh_group(m, "arc"), add_normal, &sum);
  assert_true(fabs(sum.x - 1e-5) < 1e-17 && fabs(sum.y - 1e-5) < 1e-17);
  sum = (sums){0};
  sides_visit(&c->mesh, m, gmsh_mesh_group(m, "base"), add_normal, &sum);
  assert_true(fabs(sum.x) < 1e-20 && fabs(sum.y + 1e-5) < 1e-17);
  assert_int_equal(small_go(&r), STEP_END);
  assert_true(fabs(small_last(&r, "x") + 10) < 0.02 && fabs(small_last(&r, "y") + 10) < 0.02);
  small_close(&r);
}

#define MONITORS                                                                                   \
  "&monitor name = 'x' kind = 'reaction' region = 'base' component = 'x' /\n"                      \
  "&monitor name = 'y' kind = 'reaction' region = 'base' component = 'y' /\n"
#define AT_REST "&static /\n"

/* The base bears what the edge is loaded by, 10 mm times the integral of the direction. */
static void edges_are_loaded(void **state) {
  (void)state;
  static const struct {
    const char *component;
    double x, y; /* N, of 1 MPa */
  } loads[] = {
      {"x", M_PI_2 * 10, 0}, {"y", 0, M_PI_2 * 10}, {"normal", 10, 10}, {"tangential", -10, 10}};
  for (int k = 0; k < 4; k++)
    for (int placed = 0; placed < 2; placed++) {
      small_run r;
      char text[1024];
      snprintf(text, sizeof text,
               "%s" AT_REST MONITORS
               "&traction mesh = 'disc' edge = 'arc' component = '%s' stress = '1 MPa' %s /\n",
               rest, loads[k].component,
               placed ? "history = 'formula' formula = '1 + 0*x/(1 [m])'" : "");
      open_run(&r, text);
      assert_int_equal(small_go(&r), STEP_END);
      assert_true(fabs(small_last(&r, "x") + loads[k].x) < 0.02);
      assert_true(fabs(small_last(&r, "y") + loads[k].y) < 0.02);
      small_close(&r);
    }
}

/* Of two materials of the same law and values, each with the cells of a group, nothing changes. */
static void materials_of_groups(void **state) {
  (void)state;
  double way[2];
  for (int k = 0; k < 2; k++) {
    small_run r;
    char text[1024];
    snprintf(
        text, sizeof text,
        "%s" AT_REST "%s&monitor name = 'way' kind = 'displacement' region = 'upper' component "
        "= 'y' /\n&traction mesh = 'disc' edge = 'arc' component = 'normal' stress = '1 MPa' /\n",
        rest, k ? "&material mesh = 'disc' region = 'upper' model = 'hooke_2' /\n" : "");
    open_run(&r, text);
    if (k) {
      const cells *c = simulation_cells(r.simulation, 0);
      assert_int_equal(c->where.count, 2);
      assert_int_equal(c->where.of_cell[0] + c->where.of_cell[1], 1);
    }
    assert_int_equal(small_go(&r), STEP_END);
    way[k] = small_last(&r, "way");
    small_close(&r);
  }
  assert_true(way[0] > 0 && fabs(way[1] / way[0] - 1) < 1e-12);
}

static void threads_have_the_same_bits(void **state) {
  (void)state;
  double found[3];
  for (int threads = 1; threads <= 3; threads++) {
    small_run r;
    threads_wanted = threads;
    char text[1024];
    snprintf(text, sizeof text,
             "%s&monitor name = 'way' kind = 'displacement' region = 'upper' component = 'y' /\n"
             "&traction mesh = 'disc' edge = 'arc' component = 'normal' stress = '1 MPa' /\n",
             rest);
    open_run(&r, text);
    assert_int_equal(small_go(&r), STEP_END);
    found[threads - 1] = small_last(&r, "way");
    small_close(&r);
  }
  threads_wanted = 1;
  assert_true(found[0] != 0 && found[0] == found[1] && found[0] == found[2]);
}

/* --- two laws --------------------------------------------------------------------------------- */

#define TWO_SURFACES                                                                               \
  "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"lower\"\n2 2 \"upper\"\n"        \
  "$EndPhysicalNames\n$Entities\n0 0 2 0\n1 0 0 0 4 1 0 1 1 0\n2 0 0 0 4 1 0 1 2 "                 \
  "0\n$EndEntities\n"

/* Values of its own for each of two laws. */
static void open_two(small_run *r, const pl_law *const law[2], const char *msh, const char *more,
                     double values[2][8]) {
  read_deck(r, msh, more);
  if (!r->deck) small_print(r);
  assert_non_null(r->deck);
  assert_int_equal(r->deck->interaction_count, 2);
  for (int k = 0; k < 2; k++) {
    assert_true(
        material_parameters(r->deck->interactions[k].material, law[k], values[k], &r->said));
    r->laws[k] = (simulation_law){.law = law[k], .parameters = values[k]};
  }
  r->simulation = simulation_new(r->deck, r->laws, &r->said);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

/* Two squares of h = 1 mm apart from each other, nu = 0: the highest modes of each are uniform
   strains, omega^2 = 4 E/(rho h^2). Of the longest step, 2/omega of the stiffer one, 0.98 is
   taken. */
static const char squares[] =
    TWO_SURFACES "$Nodes\n1 8 1 8\n2 1 0 8\n1 2 3 4 5 6 7 8\n0 0 0 1 0 0 1 1 0 0 1 0\n"
                 "3 0 0 4 0 0 4 1 0 3 1 0\n$EndNodes\n"
                 "$Elements\n2 2 1 2\n2 1 3 1\n1 1 2 3 4\n2 2 3 1\n2 5 6 7 8\n$EndElements\n";

/* This deck of them, of Hooke's law by the matrix or point by point. */
static void open_squares(small_run *r, const char *text, bool by_points, double values[2][8]) {
  static pl_law bent;
  bent = hooke_law;
  bent.linear = 0;
  const pl_law *of = by_points ? &bent : &hooke_law, *const law[2] = {of, of};
  whole_deck = text;
  open_two(r, law, squares, "", values);
  whole_deck = NULL;
}

static void the_stiffer_law_limits_the_step(void **state) {
  (void)state;
  for (int k = 0; k < 4; k++) {
    small_run r;
    char text[512];
    double values[2][8];
    snprintf(text, sizeof text,
             "&simulation end_time = '2 us' /\n"
             "&mesh name = 'disc' file = 'disc.msh' unit = 'mm' thickness = '10 mm' /\n"
             "&material mesh = 'disc' model = 'hooke' E = %s nu = 1e-9 /\n"
             "&material mesh = 'disc' region = 'upper' model = 'hooke' E = %s nu = 1e-9 /\n",
             k < 2 ? "30e9" : "30e11", k < 2 ? "30e11" : "30e9");
    open_squares(&r, text, k % 2, values);
    const double omega = sqrt(4 * 30e11 / 2400) / 1e-3,
                 part = simulation_step_limit(r.simulation)->limit * omega / 2;
    print_message("step over the longest: %.5f\n", part);
    assert_true(fabs(part - 0.98) < 1e-3);
    small_close(&r);
  }
}

/* Hourglass modes of either square, by the matrix and point by point. */
static void each_law_resists_its_own_hourglass(void **state) {
  (void)state;
  double stored[2][2];
  for (int k = 0; k < 4; k++) {
    small_run r;
    char text[1024];
    double values[2][8];
    snprintf(text, sizeof text,
             "&simulation end_time = '0.02 us' step = '0.001 us' /\n"
             "&mesh name = 'disc' file = 'disc.msh' unit = 'mm' thickness = '10 mm' gauss = 1 "
             "hourglass = 0.5 /\n"
             "&material mesh = 'disc' model = 'hooke' /\n"
             "&material mesh = 'disc' region = 'upper' model = 'hooke' E = 30e8 /\n"
             "&region name = 'of' lattice = 'disc' shape = 'rectangle' corner = %g, -1 size = "
             "1.8e-3, 3 /\n"
             "&initial_velocity region = 'of' component = 'x' value = '1 [m/s]*(x/1 [mm] - %g)*"
             "(y/1 [mm] - 0.5)' /\n",
             k < 2 ? -0.4e-3 : 2.6e-3, k < 2 ? 0.5 : 3.5);
    open_squares(&r, text, k % 2, values);
    assert_int_equal(small_go(&r), STEP_END);
    stored[k / 2][k % 2] = small_last(&r, "energy/stored");
    small_close(&r);
  }
  for (int k = 0; k < 2; k++)
    assert_true(stored[k][0] > 0 && fabs(stored[k][1] / stored[k][0] - 1) < 1e-9);
  const double ratio = stored[0][0] / stored[1][0];
  print_message("stored in hourglass modes: %.3g J, %.3g J\n", stored[0][0], stored[1][0]);
  assert_true(fabs(ratio - 10) < 0.2); /* as E: after the same way, nearly */
}

/* A square and a rectangle three times as wide side by side: at nodes of both, laws count by
   area. */
static void laws_share_nodes_by_area(void **state) {
  (void)state;
  static const char sides[] =
      TWO_SURFACES "$Nodes\n1 6 1 6\n2 1 0 6\n1 2 3 4 5 6\n0 0 0 1 0 0 1 1 0 0 1 0 4 0 0 4 1 0\n"
                   "$EndNodes\n$Elements\n2 2 1 2\n2 1 3 1\n1 1 2 3 4\n2 2 3 1\n2 2 5 6 3\n"
                   "$EndElements\n";
  const pl_law *const law[2] = {&hooke_law, &hooke_law};
  small_run r;
  double values[2][8];
  open_two(&r, law, sides, "&material mesh = 'disc' region = 'upper' model = 'hooke' /\n", values);
  const cells *c = simulation_cells(r.simulation, 0);
  for (int n = 0; n < 6; n++) {
    double at[2];
    mesh_place(&c->mesh, n, at);
    const long site = cells_site(c, n);
    const double wide = at[0] < 0.5e-3 ? 0 : at[0] > 2e-3 ? 1 : 0.75;
    assert_true(fabs(c->where.share[1][site] - wide) < 1e-12);
    assert_true(fabs(c->where.share[0][site] - (1 - wide)) < 1e-12);
  }
  small_close(&r);
}

/* A fan of four triangles about a node that all begin with: the second and the fourth are weak.
   Pulled alike, these two die, and the node's bits are theirs. */
static void two_cells_of_one_node_die(void **state) {
  (void)state;
  static const char fan[] =
      TWO_SURFACES "$Nodes\n1 5 1 5\n2 1 0 5\n1 2 3 4 5\n0.5 0.5 0 0 0 0 1 0 0 1 1 0 0 1 0\n"
                   "$EndNodes\n$Elements\n4 4 1 4\n2 1 2 1\n1 1 2 3\n2 2 2 1\n2 1 3 4\n"
                   "2 1 2 1\n3 1 4 5\n2 2 2 1\n4 1 5 2\n$EndElements\n";
  const pl_law *const law[2] = {&hooke_law, &brittle_law};
  const frame_field *fields;
  small_run r;
  double values[2][8], dead[5], first;
  open_two(
      &r, law, fan,
      "&material mesh = 'disc' region = 'upper' model = 'brittle' eps_u = 1e-6 /\n"
      "&region name = 'all' lattice = 'disc' shape = 'rectangle' corner = -1, -1 size = 3, 3 /\n"
      "&initial_velocity region = 'all' component = 'x' value = '100 [1/s]*x' /\n"
      "&initial_velocity region = 'all' component = 'y' value = '100 [1/s]*y' /\n",
      values);
  assert_int_equal(small_go(&r), STEP_END);
  const cells *c = simulation_cells(r.simulation, 0);
  assert_int_equal(cells_deaths(c, &first), 2);
  int bits = 0, corner[ELEMENT_MOST_NODES], middle = -1;
  for (int k = 0; k < 4; k++) { /* in whatever order */
    const bool weak = r.deck->lattices[0].gmsh->cell_tag[k] % 2 == 0;
    assert_int_equal(cells_dead(c, k), weak);
    bits += weak ? 1 << k : 0;
    mesh_cell_nodes(&c->mesh, k, corner);
    assert_true(k == 0 || corner[0] == middle);
    middle = corner[0];
  }
  const int count = simulation_frame_fields(r.simulation, &fields);
  int field = 0;
  while (field < count && strcmp(fields[field].name, "dead_cells") != 0)
    field++;
  assert_true(field < count);
  simulation_frame_values(r.simulation, field, dead);
  for (int n = 0; n < 5; n++)
    assert_true(dead[cells_particle(c, n)] == (n == middle ? bits : 0));
  small_close(&r);
}

/* --- quadrilaterals with one point ------------------------------------------------------------ */

enum { ALONG = 21, UP = 11, MOST_TEXT = 40000 };
#define PANEL_CORNERS "0, 0, 0.2, 0.02, 0.19, 0.12, -0.01, 0.1"
static const double panel_corners[4][2] = {{0, 0}, {0.2, 0.02}, {0.19, 0.12}, {-0.01, 0.1}};

__attribute__((format(printf, 2, 3))) static void put(char *text, const char *format, ...) {
  const size_t used = strlen(text);
  va_list rest_of;
  va_start(rest_of, format);
  vsnprintf(text + used, MOST_TEXT - used, format, rest_of);
  va_end(rest_of);
  assert_true(strlen(text) < MOST_TEXT - 1);
}

/* The file of a panel, a parallelogram, whose nodes are those of a grid between its corners. */
static void put_panel(char *text) {
  const int nodes = ALONG * UP, count = (ALONG - 1) * (UP - 1), sides = UP - 1;
  put(text,
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"left\"\n1 2 \"right\"\n2 3 "
      "\"all\"\n$EndPhysicalNames\n$Entities\n0 2 1 0\n1 0 0 0 1 1 0 1 1 0\n2 0 0 0 1 1 0 1 2 0\n"
      "1 0 0 0 1 1 0 1 3 0\n$EndEntities\n$Nodes\n1 %d 1 %d\n2 1 0 %d\n",
      nodes, nodes, nodes);
  for (int n = 1; n <= nodes; n++)
    put(text, "%d\n", n);
  for (int n = 0; n < nodes; n++) {
    const double u = n % ALONG / (ALONG - 1.0), v = n / ALONG / (UP - 1.0);
    double at[2];
    for (int a = 0; a < 2; a++)
      at[a] = (1 - v) * ((1 - u) * panel_corners[0][a] + u * panel_corners[1][a]) +
              v * ((1 - u) * panel_corners[3][a] + u * panel_corners[2][a]);
    put(text, "%.17g %.17g 0\n", at[0], at[1]);
  }
  put(text, "$EndNodes\n$Elements\n3 %d 1 %d\n", count + 2 * sides, count + 2 * sides);
  for (int edge = 0; edge < 2; edge++) {
    put(text, "1 %d 1 %d\n", edge + 1, sides);
    for (int k = 0; k < sides; k++)
      put(text, "%d %d %d\n", edge * sides + k + 1, k * ALONG + 1 + edge * (ALONG - 1),
          (k + 1) * ALONG + 1 + edge * (ALONG - 1));
  }
  put(text, "2 1 3 %d\n", count);
  for (int c = 0; c < count; c++) {
    const int n = c / (ALONG - 1) * ALONG + c % (ALONG - 1) + 1, first = c % 4;
    const int around[4] = {n, n + 1, n + ALONG + 1, n + ALONG}; /* from any corner on */
    put(text, "%d %d %d %d %d\n", 2 * sides + c + 1, around[first], around[(first + 1) % 4],
        around[(first + 2) % 4], around[(first + 3) % 4]);
  }
  put(text, "$EndElements\n");
}

/* The panel as a file or as a grid, bent by a shear on its end. */
static void open_panel(small_run *r, const pl_law *law, bool file, const char *keys) {
  char text[4096];
  char *msh = must_calloc(MOST_TEXT, 1);
  put_panel(msh);
  memset(r, 0, sizeof *r);
  r->memory = arena_new();
  diag_begin(&r->said, &r->sources);
  snprintf(
      text, sizeof text,
      "&simulation end_time = '0.2 ms' step = '0.7 us' threads = 2 /\n&mesh name = 'panel' %s "
      "thickness = '10 mm' gauss = 1 %s /\n&material mesh = 'panel' model = 'hooke' /\n%s"
      "&support region = 'left' fix = 'x', 'y' /\n&traction mesh = 'panel' %s component = 'y' "
      "stress = '1 MPa' /\n&monitor name = 'u' kind = 'displacement' region = 'right' component = "
      "'y' /\n&output sample = '1.4 us' /\n",
      file ? "file = 'panel.msh'"
           : "corners = " PANEL_CORNERS " nodes = 21, 11 method = 'finite_elements'",
      keys,
      file ? ""
           : "&region name = 'left' shape = 'segment' from = 0, 0 to = -0.01, 0.1 /\n"
             "&region name = 'right' shape = 'segment' from = 0.2, 0.02 to = 0.19, 0.12 /\n",
      file ? "edge = 'right'" : "from = 0.2, 0.02 to = 0.19, 0.12");
  const int begun = source_add(&r->sources, "deck.nml", text, strlen(text));
  source_add(&r->sources, "panel.msh", msh, strlen(msh));
  r->deck = deck_read(r->memory, &r->sources, begun, NULL, 0, &r->said);
  if (!r->deck) small_print(r);
  assert_non_null(r->deck);
  assert_true(material_parameters(&r->deck->materials[0], law, r->parameters, &r->said));
  if (law == &brittle_law) r->parameters[3] = 3e-5;
  r->laws[0] = (simulation_law){.law = law, .parameters = r->parameters};
  r->simulation = simulation_new(r->deck, r->laws, &r->said);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
  free(msh);
}

static void agree(const small_run *a, const small_run *b, const char *name) {
  const double *x = small_values(a, name), *y = small_values(b, name),
               most = small_largest(a, name);
  const long count = simulation_history(a->simulation, NULL);
  assert_int_equal(count, simulation_history(b->simulation, NULL));
  assert_true(most > 0);
  for (long k = 0; k < count; k++)
    if (!(fabs(x[k] - y[k]) <= 1e-9 * most))
      fail_msg("%s: %.17g, %.17g of %.3g", name, x[k], y[k], most);
}

/* As a grid does, by the matrix and point by point: motions, energies, the longest step. */
static void resistance_to_hourglass_modes_is_that_of_grids(void **state) {
  (void)state;
  static const char *const names[] = {"u", "energy/stored", "energy/kinetic", "energy/external"};
  pl_law bent = hooke_law;
  bent.linear = 0;
  for (int k = 0; k < 2; k++) {
    small_run grid, file;
    const pl_law *law = k ? &bent : &hooke_law;
    open_panel(&grid, law, false, "hourglass = 0.7");
    open_panel(&file, law, true, "hourglass = 0.7");
    const double of_grid = simulation_step_limit(grid.simulation)->limit,
                 of_file = simulation_step_limit(file.simulation)->limit;
    assert_true(fabs(of_file / of_grid - 1) <
                0.01); /* power iteration: half of what it keeps back */
    assert_int_equal(small_go(&grid), STEP_END);
    assert_int_equal(small_go(&file), STEP_END);
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
      agree(&grid, &file, names[n]);
    assert_true(small_largest(&file, "energy/imbalance") <
                1e-11 * small_largest(&file, "energy/external"));
    small_close(&grid);
    open_panel(&grid, law, true, "");
    const double without = simulation_step_limit(grid.simulation)->limit;
    print_message("longest step %.4g us, without resistance %.4g us\n", 1e6 * of_file,
                  1e6 * without);
    assert_true(of_file < 0.95 * without);
    small_close(&grid);
    small_close(&file);
  }
}

/* What dead cells had stored so is booked, too; the same cells die as of a grid. */
static void dead_quadrilaterals_resist_nothing(void **state) {
  (void)state;
  small_run grid, file;
  double first[2];
  open_panel(&grid, &brittle_law, false, "hourglass = 0.1");
  open_panel(&file, &brittle_law, true, "hourglass = 0.1");
  assert_int_equal(small_go(&grid), STEP_END);
  assert_int_equal(small_go(&file), STEP_END);
  const long died = cells_deaths(simulation_cells(file.simulation, 0), &first[0]);
  print_message("%ld cells died\n", died);
  assert_true(died > 5);
  assert_int_equal(cells_deaths(simulation_cells(grid.simulation, 0), &first[1]), died);
  assert_true(first[0] == first[1]);
  agree(&grid, &file, "energy/stored");
  agree(&grid, &file, "energy/dissipated_damage");
  assert_true(small_largest(&file, "energy/imbalance") <
              1e-9 * small_last(&file, "energy/dissipated_damage"));
  small_close(&grid);
  small_close(&file);
}

/* --- what cannot be --------------------------------------------------------------------------- */

typedef struct wrong {
  const char *deck, *message;
} wrong;

static const wrong decks[] = {
    {"&support region = 'bass' fix = 'x' /", "there is no region `bass`"},
    {"&region name = 'arc' shape = 'point' at = 0, 0 /", "a region `arc` exists already"},
    {"&traction mesh = 'disc' edge = 'ark' component = 'x' stress = '1 Pa' /",
     "the file of `disc` has no physical group `ark`"},
    {"&traction mesh = 'disc' edge = 'upper' component = 'x' stress = '1 Pa' /",
     "`upper` is a physical group of cells, not of lines"},
    {"&traction mesh = 'disc' from = 0, 0 to = 1, 1 component = 'x' stress = '1 Pa' /",
     "`disc` is the mesh of a file: its loaded lines are an `edge`"},
    {"&notch mesh = 'disc' shape = 'disc' centre = 0, 0 radius = 1 /",
     "`disc` is the mesh of a file, in which there are no holes"},
    {"&crack name = 'c' mesh = 'disc' points = 0, 0, 1, 1 /",
     "`disc` is the mesh of a file, in which there are no cracks"},
    {"&zone mesh = 'disc' method = 'finite_elements' shape = 'disc' centre = 0, 0 radius = 1 /",
     "`disc` is the mesh of a file, in which there are no zones"},
    {"&mesh name = 'b' file = 'disc.msh' size = 1, 1 thickness = 1 /",
     "`file` and `size` exclude each other"},
    {"&mesh name = 'b' file = 'disc.msh' method = 'element_free' thickness = 1 /",
     "element-free nodes stand on a rectangle"},
    {"&mesh name = 'b' file = 'disc.msh' setting = 'plane_strain' dilatation = 'mean' thickness = "
     "1 "
     "/",
     "quadrilaterals alone take the mean dilatation, and `disc.msh` has triangles only"},
    {"&mesh name = 'b' file = 'disc.msh' gauss = 1 hourglass = 0.05 thickness = 1 /",
     "triangles have no hourglass modes, and `disc.msh` has nothing else"},
    {"&mesh name = 'b' file = 'disc.msh' gauss = 1 thickness = 1 /",
     "quadrilaterals alone may have one point in place of 2 x 2, and `disc.msh` has triangles "
     "only"},
    {"&mesh name = 'b' size = 1, 1 nodes = 3, 3 method = 'finite_elements' unit = 'mm' thickness = "
     "1 /",
     "`unit` is that of places in a `file`"},
    {"&mesh name = 'b' size = 1, 1 thickness = 1 /", "`&mesh` has no `nodes`"},
    {"&mesh name = 'b' file = 'none.msh' thickness = 1 /", "cannot read `none.msh`"},
};

static void decks_that_do_not_suit_are_told(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof decks / sizeof *decks; k++) {
    small_run r;
    bool found = false;
    read_deck(&r, disc, decks[k].deck);
    assert_null(r.deck);
    for (int n = 0; n < r.said.count; n++)
      found = found || strstr(r.said.items[n].message, decks[k].message);
    if (!found) small_print(&r);
    assert_true(found);
    small_close(&r);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(groups_are_regions),
      cmocka_unit_test(normals_point_out),
      cmocka_unit_test(normals_of_turned_curves_point_out),
      cmocka_unit_test(edges_are_loaded),
      cmocka_unit_test(the_stiffer_law_limits_the_step),
      cmocka_unit_test(each_law_resists_its_own_hourglass),
      cmocka_unit_test(laws_share_nodes_by_area),
      cmocka_unit_test(two_cells_of_one_node_die),
      cmocka_unit_test(materials_of_groups),
      cmocka_unit_test(threads_have_the_same_bits),
      cmocka_unit_test(resistance_to_hourglass_modes_is_that_of_grids),
      cmocka_unit_test(dead_quadrilaterals_resist_nothing),
      cmocka_unit_test(decks_that_do_not_suit_are_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
