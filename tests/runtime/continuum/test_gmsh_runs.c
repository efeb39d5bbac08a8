/* Runs of meshes from Gmsh: regions of physical groups, loads on edges, materials of groups, the same
   bits for any number of threads; and decks that do not suit their file. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "hooke_law.h"
#include "runtime/continuum/cells.h"
#include "runtime/continuum/side_load.h"
#include "runtime/geometry/gmsh_mesh.h"
#include "tests/runtime/small_run.h"

/* A square of 1 mm, its quadrant at the upper right an arc of radius 1 mm about (0, 0): two triangles of
   6 nodes. */
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
  const int file = source_add(&r->sources, "deck.nml", text, strlen(text));
  source_add(&r->sources, "disc.msh", msh, strlen(msh));
  r->deck = deck_read(r->memory, &r->sources, file, NULL, 0, &r->said);
}

static void open_run(small_run *r, const char *more) {
  read_deck(r, disc, more);
  if (!r->deck) small_print(r);
  assert_non_null(r->deck);
  assert_true(material_parameters(&r->deck->materials[0], &hooke_law, r->parameters, &r->said));
  for (int k = 0; k < r->deck->interaction_count; k++)
    r->laws[k] = (simulation_law){.law = &hooke_law, .parameters = r->parameters};
  r->simulation = simulation_new(r->deck, r->laws, &r->said);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
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
      cmocka_unit_test(edges_are_loaded),
      cmocka_unit_test(materials_of_groups),
      cmocka_unit_test(threads_have_the_same_bits),
      cmocka_unit_test(decks_that_do_not_suit_are_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
