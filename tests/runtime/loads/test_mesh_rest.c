/* Static runs of decks: what is held, driven and loaded, against closed forms; their energies;
   loads that come and go; stress intensities; what cannot be. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/loads/mesh_rest.h"
#include "tests/runtime/continuum/hooke_law.h"
#include "tests/runtime/hand_over.h"
#include "tests/runtime/small_run.h"

/* 1 m x 0.5 m x 0.1 m; E 30 GPa, nu 0.2. */
#define PLATE                                                                                      \
  "&mesh name = 'plate' size = 1, 0.5 nodes = 21, 11 thickness = 0.1 "                             \
  "method = 'finite_elements' /\n"                                                                 \
  "&material mesh = 'plate' model = 'hooke' /\n"                                                   \
  "&region name = 'left' shape = 'segment' from = 0, 0 to = 0, 0.5 /\n"                            \
  "&region name = 'right' shape = 'segment' from = 1, 0 to = 1, 0.5 /\n"                           \
  "&region name = 'corner' shape = 'point' at = 0, 0 /\n"
#define STATIC "&simulation /\n&static /\n"
#define ROLLER "&support region = 'left' fix = 'x' /\n&support region = 'corner' fix = 'y' /\n"
#define U      "&monitor name = 'u' kind = 'displacement' region = 'right' component = 'x' /\n"
#define R      "&monitor name = 'R' kind = 'reaction' region = 'left' component = 'x' /\n"

static bool near_to(double a, double b, double part) {
  if (fabs(a - b) <= part * fabs(b)) return true;
  print_message("%.15g is not %.15g\n", a, b);
  return false;
}

static void solve(small_run *r, const char *text) {
  small_open(r, &hooke_law, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
  assert_int_equal(small_go(r), STEP_END);
}

/* All that is done is stored. */
static void keeps_energy(const small_run *r) {
  const double stored = small_last(r, "energy/stored");
  assert_true(stored > 0 && near_to(small_last(r, "energy/external"), stored, 1e-10));
  assert_true(small_last(r, "energy/kinetic") == 0);
}

static void a_pulled_plate_is_hookes(void **state) {
  (void)state;
  small_run r;
  solve(&r, STATIC PLATE ROLLER U R "&traction mesh = 'plate' from = 1, 0 to = 1, 0.5 "
                                    "component = 'x' stress = '3 MPa' /\n");
  assert_true(near_to(small_last(&r, "u"), 3e6 / 30e9, 1e-10));
  assert_true(near_to(small_last(&r, "R"), -3e6 * 0.05, 1e-10));
  assert_true(near_to(small_last(&r, "energy/stored"), 0.5 * 3e6 * 3e6 / 30e9 * 0.05, 1e-10));
  assert_int_equal(simulation_history(r.simulation, NULL), 2);
  keeps_energy(&r);
  small_close(&r);
}

/* By a drive, in increments; the load without a history grows with them. */
static void increments_follow_the_loads(void **state) {
  (void)state;
  small_run r;
  solve(&r, "&simulation end_time = 2 /\n&static increments = 4 /\n" PLATE ROLLER U R
            "&drive region = 'right' component = 'x' displacement = '1 mm' /\n"
            "&force region = 'right' component = 'y' total = 500 times = 0, 1, 2 "
            "values = 0, 1, 0 /\n"
            "&monitor name = 'F' kind = 'applied' region = 'right' component = 'y' /\n"
            "&monitor name = 'v' kind = 'reaction' region = 'corner' component = 'y' /\n");
  const double *time, *u = small_values(&r, "u"), *F = small_values(&r, "F"),
                      *v = small_values(&r, "v");
  assert_int_equal(simulation_history(r.simulation, &time), 5);
  for (int k = 0; k < 5; k++) {
    const double force = 500 * (k < 2 ? k * 0.5 : 2 - k * 0.5);
    assert_true(fabs(time[k] - 0.5 * k) < 1e-15);
    assert_true(fabs(u[k] - 0.25e-3 * k) < 1e-16);
    assert_true(fabs(F[k] - force) < 1e-9 && fabs(v[k] + force) < 1e-6);
  }
  assert_true(near_to(small_last(&r, "R"), -30e9 * 1e-3 * 0.05, 1e-9));
  keeps_energy(&r);
  small_close(&r);
}

/* A drive that ends lets its nodes go, which go back; what was stored is given back. */
static void a_drive_that_ends_lets_go(void **state) {
  (void)state;
  small_run r;
  solve(&r, "&simulation end_time = 4 /\n&static increments = 4 /\n" PLATE ROLLER U
            "&drive region = 'right' component = 'x' displacement = '1 mm' rise = 1 end = 2 /\n");
  const double *u = small_values(&r, "u");
  assert_true(near_to(u[1], 1e-3, 1e-12) && near_to(u[2], 1e-3, 1e-12));
  assert_true(fabs(u[3]) < 1e-15 && fabs(u[4]) < 1e-15);
  assert_true(fabs(small_last(&r, "energy/external")) < 1e-9);
  small_close(&r);
}

/* A hanging plate that may narrow: sigma = rho g (1 - x). */
static void weight_is_borne(void **state) {
  (void)state;
  small_run r;
  const double weight = 2400 * 0.05 * 9.81;
  solve(&r, STATIC PLATE ROLLER U R "&gravity acceleration = 9.81, 0 /\n");
  assert_true(near_to(small_last(&r, "R"), -weight, 1e-9));
  assert_true(near_to(small_last(&r, "u"), 0.5 * 2400 * 9.81 / 30e9, 0.03));
  keeps_energy(&r);
  small_close(&r);
}

/* Bending by a stress that is linear over the edge: the middle of the end sinks by M L^2/(2 E I);
   bilinear elements are a little stiffer. */
static void a_traction_by_a_formula_bends(void **state) {
  (void)state;
  small_run r;
  solve(&r, STATIC PLATE "&support region = 'left' fix = 'x', 'y' /\n"
                         "&traction mesh = 'plate' from = 1, 0 to = 1, 0.5 component = 'x' "
                         "stress = '1 MPa' formula = '(4*y - 1 [m])/1 [m]' /\n"
                         "&monitor name = 'R' kind = 'reaction' region = 'left' component = 'x' /\n"
                         "&monitor name = 'M' kind = 'displacement' region = 'tip' "
                         "component = 'y' /\n"
                         "&region name = 'tip' shape = 'point' at = 1, 0.25 /\n");
  const double moment = 1e6 * 0.1 * 0.5 * 0.5 / 6, inertia = 0.1 * 0.125 / 12;
  assert_true(fabs(small_last(&r, "R")) < 1e-6);
  assert_true(near_to(small_last(&r, "M"), -moment / (2 * 30e9 * inertia), 0.02));
  keeps_energy(&r);
  small_close(&r);
}

/* A stress along an inner line pulls what lies between it and the support; what is beyond goes
   along. */
static void a_line_inside_may_be_loaded(void **state) {
  (void)state;
  small_run r;
  solve(&r, STATIC PLATE ROLLER U R "&traction mesh = 'plate' from = 0.4, 0 to = 0.4, 0.5 "
                                    "component = 'x' stress = '3 MPa' /\n");
  assert_true(near_to(small_last(&r, "u"), 0.4 * 3e6 / 30e9, 1e-4));
  assert_true(near_to(small_last(&r, "R"), -3e6 * 0.05, 1e-10));
  small_close(&r);
}

#define HALF                                                                                       \
  STATIC "&mesh name = 'plate' size = 1, 1.5 nodes = 81, 121 thickness = 1 "                       \
         "method = 'finite_elements' /\n"                                                          \
         "&material mesh = 'plate' model = 'hooke' E = 1 nu = 0.3 /\n"                             \
         "&crack name = 'crack' mesh = 'plate' points = 0, 0, 0.475, 0 symmetry = .true. /\n"      \
         "&region name = 'ligament' shape = 'segment' from = 0.475, 0 to = 1, 0 /\n"               \
         "&region name = 'pin' shape = 'point' at = 1, 0 /\n"                                      \
         "&support region = 'ligament' fix = 'y' /\n&support region = 'pin' fix = 'x' /\n"         \
         "&traction mesh = 'plate' from = 0, 1.5 to = 1, 1.5 component = 'y' stress = 1 /\n"

/* sigma sqrt(pi a) F = 3.192 (Tada, Paris and Irwin), on elements alone. */
static void half_of_a_plate_has_the_whole_ones_K(void **state) {
  (void)state;
  static const char *const looks[] = {"&tips integral = 'plateau' half_size = 6 /\n",
                                      "&tips integral = 'pyramid' half_size = 8 /\n",
                                      "&tips half_size = 6 points = 6 /\n"};
  for (int k = 0; k < 3; k++) {
    char text[4096];
    small_run r;
    snprintf(text, sizeof text, HALF "%s", looks[k]);
    solve(&r, text);
    print_message("edge crack, half of the plate in elements: %.4f of 3.192\n",
                  small_last(&r, "crack/K_I"));
    assert_true(near_to(small_last(&r, "crack/K_I"), 3.192, 0.03));
    assert_true(small_last(&r, "crack/K_II") == 0);
    small_close(&r);
  }
}

#define PINNED                                                                                     \
  STATIC "&mesh name = 'plate' corner = 0, -1.5 size = 1, 3 nodes = 21, 62 thickness = 1 "         \
         "method = 'element_free' /\n"                                                             \
         "&material mesh = 'plate' model = 'hooke' /\n"                                            \
         "&region name = 'low' shape = 'point' at = 1, -1.5 /\n"                                   \
         "&region name = 'high' shape = 'point' at = 1, 1.5 /\n"                                   \
         "&support region = 'low' fix = 'x', 'y' /\n&support region = 'high' fix = 'x' /\n"        \
         "&traction mesh = 'plate' from = 0, 1.5 to = 1, 1.5 component = 'y' stress = 1 /\n"

static bool says(small_run *r, const char *text) {
  for (int k = 0; k < r->said.count; k++)
    if (strstr(r->said.items[k].message, text)) return true;
  small_print(r);
  return false;
}

static void wrong(const char *text, const char *message) {
  small_run r;
  small_open(&r, &hooke_law, text);
  assert_null(r.simulation);
  assert_true(says(&r, message));
  small_close(&r);
}

/* Pins on element-free nodes stand for a motion of the whole, and bear nothing. */
static void pins_without_reaction_may_be_element_free(void **state) {
  (void)state;
  small_run r;
  solve(&r, PINNED "&traction mesh = 'plate' from = 0, -1.5 to = 1, -1.5 component = 'y' "
                   "stress = -1 /\n"
                   "&monitor name = 'R' kind = 'reaction' region = 'low' component = 'y' /\n");
  assert_true(fabs(small_last(&r, "R")) < 1e-9);
  keeps_energy(&r);
  small_close(&r);
  wrong(PINNED, "its node is element-free");
}

static void what_cannot_be_solved_is_told(void **state) {
  (void)state;
  wrong(STATIC PLATE, "can move freely: nothing holds its node at (1000, ");
  wrong(STATIC PLATE "&support region = 'left' fix = 'x' /\n", "mm along y");
  wrong("&simulation end_time = 3 /\n&static increments = 3 /\n" PLATE
        "&support region = 'corner' fix = 'y' /\n"
        "&drive region = 'left' component = 'x' displacement = 1e-3 end = 1.5 /\n",
        "can move freely");
  wrong(STATIC "&relaxation increments = 2 /\n" PLATE ROLLER, "not both");
  wrong(STATIC PLATE ROLLER "&damping rate = 3 /\n", "no `&damping` with `&static`");
  wrong(STATIC PLATE ROLLER "&initial_velocity region = 'right' component = 'x' value = 1 /\n",
        "begins at rest");
  wrong("&simulation /\n" PLATE ROLLER, "has no `end_time`");
  wrong("&simulation /\n&static increments = 0 /\n" PLATE ROLLER, "at least one increment");
  wrong(STATIC PLATE ROLLER
        "&crack name = 'c' mesh = 'plate' points = 0.2, 0.2, 0.4, 0.2 symmetry = .true. /\n",
        "both on one straight edge");
  wrong(STATIC PLATE ROLLER
        "&crack name = 'c' mesh = 'plate' points = 0, 0, 1, 0 symmetry = .true. /\n",
        "has no tip");
  wrong(STATIC "&mesh name = 'plate' corners = 0, 0, 0, 1, 1, 1, 1, 0 nodes = 3, 3 thickness = 1 "
               "method = 'finite_elements' /\n&material mesh = 'plate' model = 'hooke' /\n",
        "not convex");
  wrong(STATIC "&mesh name = 'plate' corners = 0, 0, 1, 0, 1, 1 nodes = 3, 3 thickness = 1 "
               "method = 'finite_elements' /\n&material mesh = 'plate' model = 'hooke' /\n",
        "four corners");
  wrong(STATIC "&mesh name = 'plate' corners = 0, 0, 1, 0, 1, 1, 0, 1 nodes = 3, 3 thickness = 1 "
               "method = 'element_free' /\n&material mesh = 'plate' model = 'hooke' /\n",
        "`corners` are for finite elements");
  pl_law bent = hooke_law;
  bent.linear = 0;
  small_run r;
  small_open(&r, &bent, STATIC PLATE ROLLER);
  assert_null(r.simulation);
  assert_true(says(&r, "`&static` solves equations of linear laws alone"));
  small_close(&r);
}

static void a_resumed_run_is_the_same(void **state) {
  (void)state;
  static const char text[] =
      "&simulation end_time = 4 /\n&static increments = 4 /\n&output frames = 4 /\n" PLATE ROLLER U
          R "&drive region = 'right' component = 'x' displacement = '1 mm' end = 3 /\n"
      "&gravity acceleration = 0, -9.81 /\n";
  small_run r, s;
  small_open(&r, &hooke_law, text);
  small_open(&s, &hooke_law, text);
  for (int k = 0; k < 3; k++) {
    simulation_advance(r.simulation, 1, NULL);
    simulation_frame_taken(r.simulation);
  }
  hand_over(r.simulation, 3, s.simulation);
  while (simulation_advance(r.simulation, 1, NULL) == STEP_OK)
    simulation_frame_taken(r.simulation);
  while (simulation_advance(s.simulation, 1, NULL) == STEP_OK)
    simulation_frame_taken(s.simulation);
  assert_int_equal(simulation_history(s.simulation, NULL), 5);
  static const char *const series[] = {"u", "R", "energy/stored", "energy/external"};
  for (int k = 0; k < 4; k++)
    assert_true(small_last(&r, series[k]) == small_last(&s, series[k]));
  small_close(&r);
  small_close(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_pulled_plate_is_hookes),
                                     cmocka_unit_test(increments_follow_the_loads),
                                     cmocka_unit_test(a_drive_that_ends_lets_go),
                                     cmocka_unit_test(weight_is_borne),
                                     cmocka_unit_test(a_traction_by_a_formula_bends),
                                     cmocka_unit_test(a_line_inside_may_be_loaded),
                                     cmocka_unit_test(half_of_a_plate_has_the_whole_ones_K),
                                     cmocka_unit_test(pins_without_reaction_may_be_element_free),
                                     cmocka_unit_test(what_cannot_be_solved_is_told),
                                     cmocka_unit_test(a_resumed_run_is_the_same)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
