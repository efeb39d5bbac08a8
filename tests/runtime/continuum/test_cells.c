/* Meshes from decks and how they run: nodes, zones, cracks that are refused, energies, a known
   frequency, threads, resuming. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "hooke_law.h"
#include "runtime/continuum/cells.h"
#include "runtime/continuum/mesh_build.h"
#include "runtime/continuum/tips.h"
#include "runtime/deck/group_mesh.h"
#include "runtime/filling/mesh_rows.h"
#include "runtime/interaction/sweep.h"
#include "runtime/mesh/node_layout.h"
#include "tests/runtime/hand_over.h"
#include "tests/runtime/small_run.h"

#define MESH                                                                                       \
  "&simulation end_time = '0.1 ms' step_safety = 0.5 /\n"                                          \
  "&mesh name = 'plate' corner = '10 mm', 0 size = '200 mm', '100 mm' nodes = 21, 11 "             \
  "thickness = '20 mm' method = 'element_free' support = 2.6 /\n"                                  \
  "&zone mesh = 'plate' method = 'finite_elements' shape = 'rectangle' corner = '10 mm', 0 "       \
  "size = '30 mm', '100 mm' /\n"                                                                   \
  "&material mesh = 'plate' model = 'hooke' /\n"                                                   \
  "&region name = 'left' shape = 'segment' from = '10 mm', 0 to = '10 mm', '100 mm' /\n"
#define HELD "&support region = 'left' fix = 'x', 'y' /\n"
#define PULL                                                                                       \
  "&traction mesh = 'plate' from = '210 mm', 0 to = '210 mm', '100 mm' component = 'x' stress = "  \
  "'1 MPa' /\n"

static bool says(small_run *r, const char *text) {
  for (int k = 0; k < r->said.count; k++)
    if (strstr(r->said.items[k].message, text)) return true;
  small_print(r);
  return false;
}

static void nodes_are_particles_in_rows(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &hooke_law, MESH HELD);
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  const rows *w = simulation_rows(r.simulation, 0);
  double at[3], volume = 0;
  assert_int_equal(w->particle_count, 231);
  rows_place(w, w->particle_site[21 + 3], at);
  assert_true(fabs(at[0] - 0.04) < 1e-15 && fabs(at[1] - 0.01) < 1e-15);
  const node_layout l = node_layout_of((int[2]){21, 11}, 2.6);
  assert_int_equal(l.reach, 5);
  assert_int_equal(node_layout_at(&l, 24), w->particle_site[24]);
  for (long p = 0; p < w->particle_count; p++)
    volume += w->site_mass[w->particle_site[p]] / 2400;
  assert_true(fabs(volume - 0.2 * 0.1 * 0.02) < 1e-15);
  small_close(&r);
}

static void zones_flag_nodes(void **state) {
  (void)state;
  small_run r;
  mesh m;
  small_read(&r, MESH);
  assert_true(mesh_build(r.deck, 0, &m, &r.said));
  int elements = 0;
  for (int n = 0; n < mesh_node_count(&m); n++)
    elements += !m.element_free[n];
  assert_int_equal(elements, 4 * 11);
  assert_int_equal(m.cell[mesh_cell_at(&m, 2, 5)], CELL_ELEMENT);
  assert_int_equal(m.cell[mesh_cell_at(&m, 3, 5)], CELL_INTERFACE);
  assert_int_equal(m.cell[mesh_cell_at(&m, 4, 5)], CELL_ELEMENT_FREE);
  mesh_close(&m);
  small_close(&r);
}

static void an_enriched_basis_reaches_as_far_as_asked(void **state) {
  (void)state;
  small_run r;
  mesh m;
  char text[2048] = MESH;
  char *at = strstr(text, "support = 2.6");
  memcpy(at, "gauss = 3    ", 13);
  for (int n = 0; n < 3; n++) {
    const char *const keys[] = {"", "basis = 'enriched' ",
                                "basis = 'enriched' enriched_radius = 2.5 "};
    char with[4096];
    snprintf(with, sizeof with, "%.*s%s%s", (int)(at - text), text, keys[n], at);
    small_read(&r, with);
    assert_non_null(r.deck);
    assert_true(mesh_build(r.deck, 0, &m, &r.said));
    assert_true(fabs(m.enriched - (double[]){0, 4, 2.5}[n] * 0.01) < 1e-15);
    mesh_close(&m);
    small_close(&r);
  }
  char *method = strstr(text, "method = 'element_free'");
  for (int n = 0; n < 2; n++) {
    const char *const keys[] = {"enriched_radius = 2",
                                "basis = 'enriched' method = 'finite_elements'"};
    char with[4096];
    snprintf(with, sizeof with, "%.*s%s%s%s", (int)(method - text), text,
             n ? "" : "method = 'element_free' ", keys[n], strstr(method, " gauss"));
    char *gauss = strstr(with, "gauss = 3");
    memset(gauss, ' ', 9);
    small_read(&r, with);
    assert_null(r.deck);
    assert_true(says(&r, n ? "have no basis to enrich" : "has no `enriched_radius`"));
    small_close(&r);
  }
}

static void wrong(const char *text, const char *message) {
  small_run r;
  small_open(&r, &hooke_law, text);
  assert_null(r.simulation);
  assert_true(says(&r, message));
  small_close(&r);
}

static void what_cannot_be_is_refused(void **state) {
  (void)state;
  wrong(MESH HELD "&zone mesh = 'plate' method = 'finite_elements' shape = 'disc' centre = 9, 9 "
                  "radius = '1 mm' /\n",
        "the zone holds no node");
  wrong(MESH HELD "&crack name = 'c' mesh = 'plate' points = 0.02, 0.05, 0.1, 0.052 /\n",
        "the crack is in a finite element");
  wrong(MESH HELD "&crack name = 'c' mesh = 'plate' points = 0.1, 0.05, 0.1, 0.2 /\n",
        "the crack leaves the mesh");
  wrong(MESH HELD "&traction mesh = 'plate' from = 1, 1 to = 1, 2 component = 'x' stress = 1 /\n",
        "lies outside the mesh");
  wrong(MESH HELD "&crack name = 'c' mesh = 'plate' points = 0.1, 0.05, 0.1 /\n",
        "a point has two coordinates");
  wrong(MESH "&region name = 'right' shape = 'segment' from = 0.21, 0 to = 0.21, 0.1 /\n"
             "&support region = 'right' fix = 'x' /\n",
        "is element-free");
  wrong(MESH "&support region = 'left' fix = 'x', 'y' /\n&tips from = '-1 ms' /\n", "negative");
  wrong(MESH HELD "&newmark motion = 'slow' /\n", "cannot be `slow`");
  wrong(MESH HELD "&notch lattice = 'plate' shape = 'disc' centre = 0.1, 0.1 radius = 0.01 /\n",
        "is a mesh, not a lattice");
  wrong(MESH HELD "&zone mesh = 'plat' method = 'finite_elements' shape = 'disc' centre = 9, 9 "
                  "radius = 1 /\n",
        "there is no mesh `plat`");
}

#define HOLE "&notch mesh = 'plate' shape = 'disc' centre = '110 mm', '50 mm' radius = '24 mm' /\n"

static void holes_that_cannot_be(void **state) {
  (void)state;
  wrong(MESH HELD "&notch mesh = 'plate' shape = 'segment' from = 0.1, 0 to = 0.1, 0.05 /\n",
        "has no inside");
  wrong(MESH HELD "&notch mesh = 'plat' shape = 'disc' centre = 0.1, 0.05 radius = 0.01 /\n",
        "there is no mesh `plat`");
  wrong(MESH HELD "&notch shape = 'disc' centre = 0.1, 0.05 radius = 0.01 /\n",
        "`&notch` has no `lattice`");
  wrong(MESH HELD "&notch mesh = 'plate' cut_bonds = .false. shape = 'disc' centre = 0.1, 0.05 "
                  "radius = 0.01 /\n",
        "exclude each other");
  wrong(MESH HELD "&notch mesh = 'plate' shape = 'disc' centre = 0.1, 0.15 radius = 0.02 /\n",
        "the hole lies outside the mesh");
  wrong(MESH HELD "&notch mesh = 'plate' shape = 'rectangle' corner = 0, -0.1 size = 1, 1 /\n",
        "the holes leave nothing of the mesh");
  wrong(MESH HELD HOLE "&crack name = 'c' mesh = 'plate' points = 0.1, 0.05, 0.11, 0.06 /\n",
        "the crack lies in a hole");
  wrong(MESH HOLE
        "&region name = 'wall' shape = 'disc' centre = '110 mm', '50 mm' radius = '30 mm' "
        "/\n&support region = 'wall' fix = 'x' /\n",
        "is element-free");
  wrong(MESH HELD HOLE "&region name = 'in' shape = 'disc' centre = '110 mm', '50 mm' radius = "
                       "'10 mm' /\n&support region = 'in' fix = 'x' /\n",
        "no node");
  wrong(MESH HELD HOLE "&traction mesh = 'plate' from = 0.1, 0.05 to = 0.12, 0.05 component = 'x' "
                       "stress = 1 /\n",
        "lies outside the mesh");
  /* four columns of nodes between two slots, then two */
  wrong("&simulation end_time = 1 /\n&mesh name = 'plate' size = 1, 1 nodes = 11, 11 thickness = 1 "
        "method = 'element_free' support = 1.5 /\n&material mesh = 'plate' model = 'hooke' /\n"
        "&notch mesh = 'plate' shape = 'rectangle' corner = -1, -1 size = 1.61, 3 /\n"
        "&notch mesh = 'plate' shape = 'rectangle' corner = 0.79, -1 size = 1, 3 /\n",
        "holes leave too few nodes");
}

/* Nodes in a hole are no particles, those beside it weigh what is left; it swings as anything
   does. */
static void a_plate_with_a_hole(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &hooke_law, MESH HELD HOLE PULL);
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  const rows *w = simulation_rows(r.simulation, 0);
  double at[3], mass = 0;
  int holds = 0;
  for (int n = 0; n < 231; n++)
    holds += hypot(n % 21 - 10, n / 21 - 5) < 2.4;
  assert_int_equal(w->particle_count, 231 - holds);
  for (long p = 0; p < w->particle_count; p++) {
    rows_place(w, w->particle_site[p], at);
    assert_true(hypot(at[0] - 0.11, at[1] - 0.05) >= 0.024);
    assert_int_equal(w->site_particle[w->particle_site[p]], p);
    mass += w->site_mass[w->particle_site[p]];
  }
  const double expected = 2400 * 0.02 * (0.2 * 0.1 - 3.14159265358979 * 0.024 * 0.024);
  assert_true(fabs(mass - expected) < 1e-6 * expected);
  assert_int_equal(small_go(&r), STEP_END);
  assert_true(small_last(&r, "energy/kinetic") > 0);
  assert_true(fabs(small_last(&r, "energy/imbalance")) < 1e-9 * small_last(&r, "energy/external"));
  const body *b = simulation_state(r.simulation, 0)->body;
  for (long q = 0; q < w->size; q++)
    assert_true(w->present[q] || (b->displacement[0][q] == 0 && b->displacement[1][q] == 0));
  small_close(&r);
}

/* Corners of a hole hardly beyond nodes: the cells there lose the node and none of their area. */
static void nothing_holds_a_body_that_moves(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &hooke_law,
             "&simulation end_time = '0.1 ms' step_safety = 0.7 /\n"
             "&mesh name = 'plate' corner = 0, 0 size = 0.12, 0.12 nodes = 41, 41 thickness = 0.01 "
             "method = 'finite_elements' /\n&material mesh = 'plate' model = 'hooke' /\n"
             "&notch mesh = 'plate' shape = 'rectangle' corner = 0.02999997, 0.02999997 "
             "size = 0.03000006, 0.03000006 /\n"
             "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 3, 3 /\n"
             "&initial_velocity region = 'all' component = 'x' value = 1 /\n"
             "&traction mesh = 'plate' from = 0.025, 0.0295 to = 0.035, 0.0295 component = 'y' "
             "stress = '1 Pa' /\n"
             "&monitor name = 'p' kind = 'momentum' component = 'x' /\n");
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  assert_int_equal(simulation_rows(r.simulation, 0)->particle_count, 41 * 41 - 11 * 11);
  assert_int_equal(small_go(&r), STEP_END);
  const double mass = 2400 * 0.01 * (0.12 * 0.12 - 0.03000006 * 0.03000006);
  const double *p = small_values(&r, "p");
  for (long k = 0; k < simulation_history(r.simulation, NULL); k++)
    assert_true(fabs(p[k] - mass) < 1e-9 * mass);
  small_close(&r);
}

#define SLOTTED                                                                                    \
  "size = 1, 1 nodes = 11, 11 thickness = 1 method = 'element_free' support = 1.5 gauss = 3 "      \
  "parts = 2 /\n"

/* The first mesh has a hole, too: the message is about the second. */
static void the_hole_that_leaves_too_few_is_named(void **state) {
  (void)state;
  const char *text =
      "&simulation end_time = 1 /\n&mesh name = 'good' " SLOTTED "&mesh name = 'bad' " SLOTTED
      "&material mesh = 'good' model = 'hooke' /\n&material mesh = 'bad' model = 'hooke' /\n"
      "&notch mesh = 'good' shape = 'disc' centre = 0.5, 0.5 radius = 0.2 /\n"
      "&notch mesh = 'bad' shape = 'rectangle' corner = -1, -1 size = 1.61, 3 /\n"
      "&notch mesh = 'bad' shape = 'rectangle' corner = 0.79, -1 size = 1, 3 /\n";
  small_run r;
  small_read(&r, text);
  if (!r.deck) small_print(&r);
  assert_non_null(r.deck);
  assert_true(material_parameters(&r.deck->materials[0], &hooke_law, r.parameters, &r.said));
  const simulation_law law = {.law = &hooke_law, .parameters = r.parameters};
  r.simulation = simulation_new(r.deck, (simulation_law[]){law, law}, &r.said);
  assert_null(r.simulation);
  assert_true(says(&r, "holes leave too few nodes of `bad` around"));
  const char *second = strstr(text, "&notch mesh = 'bad'");
  assert_true(r.said.items[r.said.count - 1].where.begin >= (size_t)(second - text));
  small_close(&r);
}

/* By one rule both for the nodes and for the cells. */
static void holes_are_cut_by_the_decks_rule(void **state) {
  (void)state;
  small_run r;
  mesh m;
  small_read(&r, "&simulation end_time = 1 /\n&mesh name = 'plate' " SLOTTED
                 "&material mesh = 'plate' model = 'hooke' /\n"
                 "&notch mesh = 'plate' shape = 'disc' centre = 0.5, 0.5 radius = 0.2 /\n");
  assert_non_null(r.deck);
  mesh_open(&m, (int[2]){11, 11}, (double[2]){0, 0}, (double[2]){1, 1}, 1, 1.5);
  assert_int_equal(mesh_rows_cut(r.deck, &r.deck->lattices[0], &m), 121 - 9);
  assert_true(m.gauss == 3 && m.gauss_parts == 2);
  mesh_close(&m);
  small_close(&r);
}

static void a_crack_along_nodes_is_warned_of(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &hooke_law,
             MESH HELD "&crack name = 'c' mesh = 'plate' points = 0.21, 0.05, 0.15, 0.05 /\n");
  assert_non_null(r.simulation);
  assert_true(says(&r, "runs along a row of nodes"));
  small_close(&r);
}

/* A bar pulled at once swings about its static length with the period 4 L/c; all energy is kept. */
static void a_pulled_bar_swings(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &hooke_law,
             "&simulation end_time = '0.3 ms' step_safety = 0.7 /\n"
             "&mesh name = 'plate' size = 0.2, '20 mm' nodes = 41, 5 thickness = '20 mm' "
             "method = 'finite_elements' /\n"
             "&material mesh = 'plate' model = 'hooke' nu = 1e-6 /\n"
             "&region name = 'left' shape = 'segment' from = 0, 0 to = 0, '20 mm' /\n"
             "&region name = 'right' shape = 'segment' from = 0.2, 0 to = 0.2, '20 mm' /\n"
             "&support region = 'left' fix = 'x', 'y' /\n"
             "&traction mesh = 'plate' from = 0.2, 0 to = 0.2, '20 mm' component = 'x' "
             "stress = '3 MPa' /\n"
             "&monitor name = 'u' kind = 'displacement' region = 'right' component = 'x' /\n"
             "&output sample = '2 us' /\n");
  assert_non_null(r.simulation);
  assert_int_equal(small_go(&r), STEP_END);
  const double *time, *u = small_values(&r, "u"), c = sqrt(30e9 / 2400);
  const long count = simulation_history(r.simulation, &time);
  double most = 0, when = 0;
  for (long k = 0; k < count; k++)
    if (u[k] > most) {
      most = u[k];
      when = time[k];
    }
  assert_true(fabs(most - 2 * 3e6 * 0.2 / 30e9) < 0.04 * most);
  assert_true(fabs(when - 2 * 0.2 / c) < 0.03 * when);
  assert_true(fabs(small_last(&r, "energy/imbalance")) < 1e-9 * small_last(&r, "energy/external"));
  small_close(&r);
}

/* What beta_1 takes is in the ledger. */
static void numerical_damping_is_counted(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &hooke_law, MESH HELD PULL "&newmark beta_1 = 0.9 /\n");
  assert_non_null(r.simulation);
  assert_int_equal(small_go(&r), STEP_END);
  assert_true(small_last(&r, "energy/dissipated_damping") > 0);
  assert_true(fabs(small_last(&r, "energy/imbalance")) < 1e-9 * small_last(&r, "energy/external"));
  small_close(&r);
}

#define CRACKED                                                                                    \
  MESH HELD PULL "&newmark beta_1 = 0.9 /\n&tips half_size = 2 check_steps = 3 /\n"                \
                 "&crack name = 'c' mesh = 'plate' points = 0.1234, 0.1, 0.1234, 0.053 /\n"

static double last_K(const char *threads) {
  char text[4096];
  small_run r;
  snprintf(text, sizeof text, CRACKED "%s", "");
  char *at = strstr(text, "step_safety");
  memmove(at + strlen(threads), at, strlen(at) + 1);
  memcpy(at, threads, strlen(threads));
  small_open(&r, &hooke_law, text);
  assert_non_null(r.simulation);
  small_go(&r);
  const double K = small_last(&r, "c/K_I");
  small_close(&r);
  return K;
}

static void threads_change_no_bit(void **state) {
  (void)state;
  const double one = last_K("threads = 1 ");
  assert_true(one > 0);
  assert_true(last_K("threads = 2 ") == one);
  assert_true(last_K("threads = 3 ") == one);
}

static void a_resumed_run_is_the_same(void **state) {
  (void)state;
  small_run r, s;
  small_open(&r, &hooke_law, CRACKED);
  small_open(&s, &hooke_law, CRACKED);
  hand_over(r.simulation, 40, s.simulation);
  small_go(&r);
  small_go(&s);
  assert_true(small_last(&r, "c/K_I") == small_last(&s, "c/K_I"));
  assert_true(small_last(&r, "energy/stored") == small_last(&s, "energy/stored"));
  assert_true(small_last(&r, "energy/dissipated_damping") ==
              small_last(&s, "energy/dissipated_damping"));
  small_close(&r);
  small_close(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(nodes_are_particles_in_rows),
                                     cmocka_unit_test(zones_flag_nodes),
                                     cmocka_unit_test(an_enriched_basis_reaches_as_far_as_asked),
                                     cmocka_unit_test(what_cannot_be_is_refused),
                                     cmocka_unit_test(holes_that_cannot_be),
                                     cmocka_unit_test(a_plate_with_a_hole),
                                     cmocka_unit_test(nothing_holds_a_body_that_moves),
                                     cmocka_unit_test(the_hole_that_leaves_too_few_is_named),
                                     cmocka_unit_test(holes_are_cut_by_the_decks_rule),
                                     cmocka_unit_test(a_crack_along_nodes_is_warned_of),
                                     cmocka_unit_test(a_pulled_bar_swings),
                                     cmocka_unit_test(numerical_damping_is_counted),
                                     cmocka_unit_test(threads_change_no_bit),
                                     cmocka_unit_test(a_resumed_run_is_the_same)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
