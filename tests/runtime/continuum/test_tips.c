/* Tips in runs: where they end, when they are looked at, what their growth releases, faces that
   overlap; driven nodes that give way, against steps of Newmark's method one by one. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "fracture_law.h"
#include "hooke_law.h"
#include "mesh_cases.h"
#include "runtime/continuum/cells.h"
#include "runtime/continuum/node_masses.h"
#include "tests/runtime/hand_over.h"
#include "tests/runtime/small_run.h"

/* A run with the law of its mesh and one law for all of its cracks. */
typedef struct cracked_run {
  small_run r;
  double fracture[4][2];
  simulation_law laws[5];
} cracked_run;

static void open_cracked(cracked_run *c, const char *text) {
  small_run *r = &c->r;
  small_read(r, text);
  if (!r->deck) small_print(r);
  assert_non_null(r->deck);
  assert_true(material_parameters(&r->deck->materials[0], &hooke_law, r->parameters, &r->said));
  c->laws[0] = (simulation_law){.law = &hooke_law, .parameters = r->parameters};
  for (int k = 0; k < r->deck->crack_count; k++) {
    const deck_material *m = &r->deck->cracks[k].material;
    c->laws[k + 1] = (simulation_law){0};
    if (!m->model) continue;
    assert_true(material_parameters(m, &fracture_law, c->fracture[k], &r->said));
    c->laws[k + 1] = (simulation_law){.law = &fracture_law, .parameters = c->fracture[k]};
  }
  r->simulation = simulation_new(r->deck, c->laws, &r->said);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

static const mesh_tip *tip_of(const cracked_run *c, int number) {
  const tips *t = simulation_cells(c->r.simulation, 0)->tips;
  assert_true(t && number < t->count);
  return &t->items[number];
}

/* 200 mm x 100 mm, pulled up and down. */
#define PULLED                                                                                     \
  "&mesh name = 'plate' size = 0.2, 0.1 nodes = 41, 21 thickness = 0.01 method = 'element_free' "  \
  "/\n" LOADED
#define LOADED                                                                                     \
  "&material mesh = 'plate' model = 'hooke' /\n"                                                   \
  "&traction mesh = 'plate' from = 0, 0.1 to = 0.2, 0.1 component = 'y' stress = '5 MPa' /\n"      \
  "&traction mesh = 'plate' from = 0, 0 to = 0.2, 0 component = 'y' stress = '-5 MPa' /\n"
#define RUN   "&simulation end_time = '0.4 ms' step_safety = 0.5 /\n"
#define TIPS  "&tips half_size = 2 check_steps = 10 updates = 5 segment = 1000 "
#define GROWS " grows = .true. model = 'fracture' K_Ic = 1e5 v = 800 /\n"
#define LEFT  "&crack name = 'left' mesh = 'plate' points = 0, 0.0512, 0.05, 0.0512" GROWS
/* The same with as many rows of cells above the middle as below: cracks there run on one line. */
#define EVEN                                                                                       \
  "&mesh name = 'plate' size = 0.2, 0.1 nodes = 41, 22 thickness = 0.01 method = 'element_free' "  \
  "/\n" LOADED
#define AHEAD  "&crack name = 'left' mesh = 'plate' points = 0, 0.05, 0.05, 0.05" GROWS
#define FACING "&crack name = 'right' mesh = 'plate' points = 0.2, 0.05, 0.15, 0.05"

static void ends(const char *text, int number, tip_end why, double x) {
  static cracked_run c;
  open_cracked(&c, text);
  assert_int_equal(small_go(&c.r), STEP_END);
  const mesh_tip *p = tip_of(&c, number);
  assert_int_equal(p->now.done, why);
  assert_true(p->now.done_time > 0 && p->now.done_time < 0.4e-3);
  assert_true(p->now.speed == 0);
  print_message("%s: %s at %.5f, after %.3g ms\n", p->of->name, tip_end_words[why], p->now.at[0],
                1e3 * p->now.done_time);
  assert_true(fabs(p->now.at[0] - x) < 1e-3);
  assert_true(fabs(small_last(&c.r, "energy/imbalance")) <
              1e-9 * small_largest(&c.r, "energy/external"));
  small_close(&c.r);
}

static void tips_end_where_they_cannot_go_on(void **state) {
  (void)state;
  ends(RUN PULLED TIPS "/\n" LEFT, 0, TIP_HAS_LEFT, 0.2);
  ends(RUN PULLED TIPS "corner = 0, 0 size = 0.123, 0.1 /\n" LEFT, 0, TIP_HAS_LEFT, 0.123);
  ends(RUN PULLED TIPS
       "/\n" LEFT "&crack name = 'other' mesh = 'plate' points = 0.1512, 0.03, 0.1512, 0.07 /\n",
       0, TIP_HAS_MET, 0.1512);
  ends(RUN PULLED TIPS "/\n" LEFT "&zone mesh = 'plate' method = 'finite_elements' shape = "
                       "'rectangle' corner = 0.15, 0 size = 0.05, 0.1 /\n",
       0, TIP_AT_ELEMENTS, 0.1485);
  ends(RUN EVEN TIPS "/\n" AHEAD FACING " /\n", 0, TIP_HAS_MET, 0.15);
}

/* Head on: both end where they meet, halfway. */
static void two_tips_meet(void **state) {
  (void)state;
  ends(RUN EVEN TIPS "/\n" AHEAD FACING GROWS, 0, TIP_HAS_MET, 0.1);
  ends(RUN EVEN TIPS "/\n" AHEAD FACING GROWS, 1, TIP_HAS_MET, 0.1);
}

static void looks_begin_when_they_are_to(void **state) {
  (void)state;
  static cracked_run c;
  open_cracked(&c, RUN PULLED TIPS "from = '0.1 ms' /\n" LEFT "&output sample = '1 us' /\n");
  assert_int_equal(small_go(&c.r), STEP_END);
  const double *time, *K = small_values(&c.r, "left/K_I"),
                      *length = small_values(&c.r, "left/length");
  const long count = simulation_history(c.r.simulation, &time);
  const double step = simulation_step_limit(c.r.simulation)->step;
  for (long k = 0; k < count; k++) {
    if (time[k] < 0.1e-3) assert_true(K[k] == 0 && length[k] == 0.05);
    if (time[k] > 0.1e-3 + 11 * step) assert_true(K[k] != 0);
  }
  assert_true(length[count - 1] > 0.1);
  small_close(&c.r);
}

/* What growth releases is booked, and without numerical damping all energy is accounted for. */
static void growth_is_in_the_ledger(void **state) {
  (void)state;
  static cracked_run c;
  open_cracked(&c, RUN PULLED TIPS "/\n" LEFT);
  assert_int_equal(small_go(&c.r), STEP_END);
  const tips *t = simulation_cells(c.r.simulation, 0)->tips;
  assert_true(t->rated > 0 && t->released != 0);
  assert_true(t->released == small_last(&c.r, "energy/dissipated_damage"));
  assert_true(fabs(small_last(&c.r, "energy/imbalance")) <
              1e-9 * small_largest(&c.r, "energy/external"));
  small_close(&c.r);
}

static void same_end(const cracked_run *a, const cracked_run *b) {
  static const char *const series[] = {"left/K_I",    "left/x",        "left/y",
                                       "left/length", "energy/stored", "energy/dissipated_damage"};
  for (size_t k = 0; k < sizeof series / sizeof *series; k++)
    assert_true(small_last(&a->r, series[k]) == small_last(&b->r, series[k]));
  assert_memory_equal(&tip_of(a, 0)->now, &tip_of(b, 0)->now, sizeof(tip_state));
  assert_true(simulation_cells(a->r.simulation, 0)->tips->rated ==
              simulation_cells(b->r.simulation, 0)->tips->rated);
}

static void go_to(cracked_run *c, int64_t step) {
  while (simulation_step_done(c->r.simulation) < step) /* frames stop it */
    simulation_advance(c->r.simulation, step - simulation_step_done(c->r.simulation), NULL);
}

/* Stopped while the crack grows, and with other threads: the same to the last bit. */
static void a_crack_that_grows_is_resumed(void **state) {
  (void)state;
  static cracked_run whole, resumed, threads;
  const char *text = RUN PULLED TIPS "/\n&newmark beta_1 = 0.8 /\n" LEFT;
  open_cracked(&whole, text);
  open_cracked(&resumed, text);
  open_cracked(&threads,
               "&simulation end_time = '0.4 ms' step_safety = 0.5 threads = 3 /\n" PULLED TIPS
               "/\n&newmark beta_1 = 0.8 /\n" LEFT);
  go_to(&whole, 223);
  const double length = tip_of(&whole, 0)->now.length;
  assert_true(length > 0.06 && tip_of(&whole, 0)->now.speed > 0);
  hand_over(whole.r.simulation, simulation_step_done(whole.r.simulation), resumed.r.simulation);
  assert_true(tip_of(&resumed, 0)->now.length == length);
  small_go(&whole.r);
  small_go(&resumed.r);
  small_go(&threads.r);
  assert_true(small_last(&whole.r, "left/length") > length + 0.01);
  same_end(&whole, &resumed);
  same_end(&whole, &threads);
  small_close(&whole.r);
  small_close(&resumed.r);
  small_close(&threads.r);
}

/* A crack that has run into a hole parts what is on either side of it, also once it is resumed: of
   nodes just beyond the mouth, whose lines past the hole's outline are too short for it to hide
   them. */
static void a_crack_that_is_in_a_hole_is_resumed(void **state) {
  (void)state;
  static cracked_run whole, resumed;
  const char *text = RUN PULLED TIPS
      "/\n" LEFT "&notch mesh = 'plate' shape = 'disc' centre = 0.1, 0.0512 radius = 0.0113 /\n";
  open_cracked(&whole, text);
  open_cracked(&resumed, text);
  while (!tip_of(&whole, 0)->now.done)
    go_to(&whole, simulation_step_done(whole.r.simulation) + 20);
  assert_int_equal(tip_of(&whole, 0)->now.done, TIP_AT_HOLE);
  assert_true(simulation_step_done(whole.r.simulation) < 700);
  hand_over(whole.r.simulation, simulation_step_done(whole.r.simulation), resumed.r.simulation);
  assert_int_equal(tip_of(&resumed, 0)->now.done, TIP_AT_HOLE);
  small_go(&whole.r);
  small_go(&resumed.r);
  const double *at = tip_of(&whole, 0)->now.at;
  assert_true(fabs(hypot(at[0] - 0.1, at[1] - 0.0512) - 0.0113) < 1e-8);
  same_end(&whole, &resumed);
  small_close(&whole.r);
  small_close(&resumed.r);
}

static void faces_overlap_under_pressure(void **state) {
  (void)state;
  static cracked_run c;
  const char *text = RUN PULLED TIPS "/\n" LEFT;
  open_cracked(&c, text);
  small_go(&c.r);
  assert_false(tip_overlaps(&tip_of(&c, 0)->now));
  small_close(&c.r);
  char pressed[4096];
  snprintf(pressed, sizeof pressed, "%s", text);
  char *up = strstr(pressed, "'5 MPa'"), *down = strstr(pressed, "'-5 MPa'");
  memcpy(up, "-50000.", 7);
  memcpy(down, " 50000.0", 8);
  open_cracked(&c, pressed);
  small_go(&c.r);
  const mesh_tip *p = tip_of(&c, 0);
  assert_true(tip_overlaps(&p->now));
  /* waves meet in the middle after 0.05 m/c_d */
  assert_true(p->now.first_time > 0.5 * 0.05 / 3600 && p->now.first_time < 2 * 0.05 / 3600);
  assert_true(p->now.least < 0 && p->now.least_time >= p->now.first_time);
  assert_true(p->now.least == -p->now.largest);
  assert_true(p->toughness == 1e5);
  small_close(&c.r);
}

/* --- growth of a whole run -------------------------------------------------------------------- */

/* Half of the plate of Kalthoff and Winkler, 31 x 31 nodes, in plane strain by its moduli. */
#define PLATE                                                                                      \
  "&simulation end_time = '130 us' step = 2.9476e-7 /\n"                                           \
  "&mesh name = 'plate' corner = 0, -0.05 size = 0.1, 0.1 nodes = 31, 31 thickness = 1 "           \
  "method = 'element_free' support = 3.5 /\n"                                                      \
  "&zone mesh = 'plate' method = 'finite_elements' shape = 'segment' from = 0, -0.05 to = 0, "     \
  "0.05 /\n"                                                                                       \
  "&zone mesh = 'plate' method = 'finite_elements' shape = 'segment' from = 0, 0.05 to = 0.025, "  \
  "0.05 /\n"                                                                                       \
  "&material mesh = 'plate' model = 'hooke' E = 208.79e9 nu = 0.428571 rho = 8000 /\n"             \
  "&crack name = 'crack' mesh = 'plate' points = 0.025, 0.05, 0.025, 0, 0.0281323, -0.00114007 "   \
  "grows = .true. model = 'fracture' K_Ic = 68e6 v = 906.6 /\n"                                    \
  "&tips half_size = 1 check_steps = 12 updates = 5 segment = 0.5 /\n"                             \
  "&region name = 'axis' shape = 'segment' from = 0, -0.05 to = 0, 0.05 /\n"                       \
  "&region name = 'hit' shape = 'segment' from = 0, 0.05 to = 0.025, 0.05 /\n"                     \
  "&support region = 'axis' fix = 'x' /\n"                                                         \
  "&drive region = 'hit' component = 'y' velocity = -16.5 /\n"

static void open_plate(case_mesh *p) {
  mesh_open(&p->m, (int[2]){31, 31}, (double[2]){0, -0.05}, (double[2]){0.1, 0.1}, 1, 3.5);
  for (int n = 0; n < mesh_node_count(&p->m); n++)
    p->m.element_free[n] = n % 31 > 0 && !(n / 31 == 30 && n % 31 < 8);
  p->law = isotropic(208.79e9, 0.428571, false);
  crack_lines_add(&p->m.cracks, (double[2]){0.025, 0.05}, (double[2]){0.025, 0});
  crack_lines_add(&p->m.cracks, (double[2]){0.025, 0}, (double[2]){0.0281323, -0.00114007});
  case_settle(p);
}

static double largest_gap(const node_stencil *a, const node_stencil *b) {
  double most = 0, size = 0;
  for (long k = 0; k < a->block_count; k++) {
    most = fmax(most, fabs(a->blocks[k] - b->blocks[k]));
    size = fmax(size, fabs(a->blocks[k]));
  }
  return most / size;
}

static void stiffness_after_a_run_is_assembly_afresh(void **state) {
  (void)state;
  static cracked_run c;
  case_mesh p = {0};
  node_stencil fresh;
  open_cracked(&c, PLATE "&newmark beta_1 = 0.99 /\n");
  assert_int_equal(small_go(&c.r), STEP_END);
  const tips *t = simulation_cells(c.r.simulation, 0)->tips;
  open_plate(&p);
  for (long k = 0; k < t->pieces.count; k++)
    node_stencil_grow(&p.K, &p.m, t->pieces.items[k].a, t->pieces.items[k].b, -1);
  node_stencil_open(&fresh, &p.m, &p.points, &p.law, NULL);
  const double gap = largest_gap(&p.K, &fresh);
  print_message("%ld pieces, %ld legs: %.2g of the largest entry\n", (long)t->pieces.count,
                (long)t->items[0].now.segments, gap);
  assert_true(t->pieces.count > 80);
  assert_true(gap < 1e-12);
  const double part = t->released / t->rated; /* another program: 0.26 to 0.34 */
  print_message("released %.2f of the energy release rate over the way\n", part);
  assert_true(part > 0.2 && part < 0.4);
  node_stencil_close(&fresh);
  case_close(&p);
  small_close(&c.r);
}

/* --- driven nodes ----------------------------------------------------------------------------- */

enum { STEPS = 150 };

/* Steps one by one: u += dt v + dt^2 a/2, v += dt (a + a')/2; driven nodes with v prescribed, and a
   of the body's forces or of the prescribed motion. What acts is K of the uncut plate. Returns the
   displacement of node `watched` along y. */
static double step_by_step(bool gives_way, double dt, int watched) {
  case_mesh p = {0};
  mesh_open(&p.m, (int[2]){31, 31}, (double[2]){0, -0.05}, (double[2]){0.1, 0.1}, 1, 3.5);
  for (int n = 0; n < mesh_node_count(&p.m); n++)
    p.m.element_free[n] = n % 31 > 0 && !(n / 31 == 30 && n % 31 < 8);
  p.law = isotropic(208.79e9, 0.428571, false);
  case_settle(&p);
  const node_layout *l = &p.K.layout;
  const int nodes = mesh_node_count(&p.m);
  const double density = 8000;
  pool *memory = pool_new();
  double *mass = pool_doubles(memory, nodes), *u[2], *v[2], *a[2], *f[2];
  node_masses(&p.m, &p.points, &density, NULL, mass);
  for (int d = 0; d < 2; d++) {
    u[d] = pool_doubles(memory, l->size);
    f[d] = pool_doubles(memory, l->size);
    v[d] = pool_doubles(memory, nodes);
    a[d] = pool_doubles(memory, nodes);
  }
  for (int step = 0; step < STEPS; step++) {
    for (int d = 0; d < 2; d++)
      for (int n = 0; n < nodes; n++) {
        const bool held = d == 0 && n % 31 == 0, hit = d == 1 && n / 31 == 30 && n % 31 < 8;
        const double now = hit ? -16.5 : v[d][n];
        if (!held)
          u[d][node_layout_at(l, n)] +=
              dt * now + (hit && !gives_way ? 0 : 0.5 * dt * dt * a[d][n]);
      }
    node_stencil_multiply(&p.K, (const double *const *)u, f, 0, l->nodes[1]);
    for (int d = 0; d < 2; d++)
      for (int n = 0; n < nodes; n++) {
        const double after = -f[d][node_layout_at(l, n)] / mass[n];
        v[d][n] += 0.5 * dt * (a[d][n] + after);
        a[d][n] = after;
      }
  }
  const double found = u[1][node_layout_at(l, watched)];
  pool_free(memory);
  case_close(&p);
  return found;
}

static double by_the_run(const char *motion) {
  static cracked_run c;
  char text[4096];
  snprintf(text, sizeof text,
           PLATE "&region name = 'one' shape = 'point' at = 0.02, 0.05 /\n"
                 "&monitor name = 'u' kind = 'displacement' region = 'one' component = 'y' /\n%s",
           motion);
  char *crack = strstr(text, "&crack"), *end = strstr(text, "&tips");
  memset(crack, ' ', (size_t)(end - crack));
  memcpy(strstr(text, "'130 us'"), "44.2e-6 ", 8);
  open_cracked(&c, text);
  assert_int_equal(simulation_step_count(c.r.simulation), STEPS);
  assert_int_equal(small_go(&c.r), STEP_END);
  const double u = small_last(&c.r, "u");
  assert_true(fabs(small_last(&c.r, "energy/imbalance")) <
              1e-9 * small_largest(&c.r, "energy/external"));
  small_close(&c.r);
  return u;
}

static void driven_nodes_give_way(void **state) {
  (void)state;
  const int watched = 30 * 31 + 6;
  const double dt = 2.9476e-7, whole = -16.5 * STEPS * dt;
  const double consistent = by_the_run(""),
               giving = by_the_run("&newmark motion = 'velocity_only' /\n");
  print_message("%.6g m of %.6g m, and %.6g m\n", consistent, whole, giving);
  assert_true(fabs(consistent - whole) < 1e-12 * fabs(whole));
  assert_true(fabs(step_by_step(false, dt, watched) - whole) < 1e-12 * fabs(whole));
  assert_true(fabs(giving) < 0.9 * fabs(whole));
  assert_true(fabs(giving - step_by_step(true, dt, watched)) < 1e-10 * fabs(whole));
}

/* What lies below a crack hangs on the other side by its own weight, along the crack, and opens it:
   how large the box is makes no difference once the weight in it counts. */
static double hanging_K(int half_size) {
  static const char plate[] =
      "&simulation /\n&static /\n&tips half_size = %d points = 16 /\n"
      "&mesh name = 'plate' size = 1, 1 nodes = 61, 62 thickness = 0.1 "
      "method = 'element_free' support = 2.1 /\n"
      "&zone mesh = 'plate' method = 'finite_elements' shape = 'rectangle' corner = 0, 0.6 "
      "size = 0.1, 0.4 /\n"
      "&material mesh = 'plate' model = 'hooke' /\n"
      "&crack name = 'c' mesh = 'plate' points = 0, 0.5, 0.5, 0.5 /\n"
      "&region name = 'left' shape = 'segment' from = 0, 0.61 to = 0, 1 /\n"
      "&support region = 'left' fix = 'x', 'y' /\n"
      "&gravity acceleration = 9.81, 0 /\n";
  static cracked_run c;
  char text[2000];
  snprintf(text, sizeof text, plate, half_size);
  open_cracked(&c, text);
  assert_int_equal(small_go(&c.r), STEP_END);
  const double K = small_last(&c.r, "c/K_I");
  small_close(&c.r);
  return K;
}

static void weight_counts_in_the_box(void **state) {
  (void)state;
  const double K[3] = {hanging_K(4), hanging_K(8), hanging_K(12)};
  print_message("hanging by its weight: %.6g, %.6g, %.6g\n", K[0], K[1], K[2]);
  for (int k = 0; k < 3; k++)
    assert_true(fabs(K[k] - K[1]) < 0.004 * K[1]);
}

/* In free fall v = g t, and nothing is left for the integral: of nodes that a force acts on,
   too. */
static void looks_know_gravity(void **state) {
  (void)state;
  static cracked_run c;
  open_cracked(&c, "&simulation end_time = '0.1 ms' step_safety = 0.5 /\n"
                   "&mesh name = 'plate' size = 0.2, 0.1 nodes = 41, 21 thickness = 0.01 "
                   "method = 'element_free' /\n&material mesh = 'plate' model = 'hooke' /\n"
                   "&gravity acceleration = 3, -9.81 /\n&tips half_size = 2 check_steps = 10 /\n"
                   "&region name = 'top' shape = 'rectangle' corner = 0, 0.09 size = 0.2, 0.01 /\n"
                   "&force region = 'top' component = 'y' total = 1e-9 /\n"
                   "&crack name = 'c' mesh = 'plate' points = 0, 0.0512, 0.05, 0.0512 /\n");
  assert_int_equal(small_go(&c.r), STEP_END);
  const tips *t = simulation_cells(c.r.simulation, 0)->tips;
  const double step = simulation_step_limit(c.r.simulation)->step, g[2] = {3, -9.81};
  const double time = (double)(t->step / 10 * 10) * step; /* of the last look */
  for (int n = 0; n < 41 * 21; n++)
    for (int d = 0; d < 2; d++) {
      assert_true(fabs(t->acceleration[d][n]) < 1e-6 * 9.81);
      assert_true(fabs(t->velocity[d][n] - g[d] * time) < 1e-6 * 9.81 * time);
    }
  small_close(&c.r);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(tips_end_where_they_cannot_go_on),
                                     cmocka_unit_test(weight_counts_in_the_box),
                                     cmocka_unit_test(looks_know_gravity),
                                     cmocka_unit_test(two_tips_meet),
                                     cmocka_unit_test(looks_begin_when_they_are_to),
                                     cmocka_unit_test(growth_is_in_the_ledger),
                                     cmocka_unit_test(a_crack_that_grows_is_resumed),
                                     cmocka_unit_test(a_crack_that_is_in_a_hole_is_resumed),
                                     cmocka_unit_test(faces_overlap_under_pressure),
                                     cmocka_unit_test(stiffness_after_a_run_is_assembly_afresh),
                                     cmocka_unit_test(driven_nodes_give_way)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
