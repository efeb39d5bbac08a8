/* Displacements and velocities that a run begins with, by numbers and by formulas of the place:
   against closed forms, energies, and what is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>

#include "runtime/lattice/placed_values.h"
#include "tests/runtime/simulation/chain.h"
#include "tests/runtime/spring_law.h"

enum { LINKS = 24 }; /* of the chain; one particle more */

#define ALL "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 3, 3 /\n"

static void open_chain(small_run *r, const pl_law *law, const char *groups) {
  char text[4096];
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-4 step = 1e-7 /\n" CHAIN ALL
           "&material lattice = 'c' model = 'm' /\n&output frames = 0 sample = 1e-6 /\n%s",
           LINKS * SPACING, groups);
  must_open(r, law, text);
}

/* Mode n of a free chain of N particles, cos(pi n (j + 1/2)/N): steps of leapfrog take it to
   cos(omega' t), sin(omega' dt/2) = omega dt/2, and one that begins with a velocity to sin(omega' t)
   over sin(omega' dt)/dt. */
static void expect_mode(const char *groups, double amplitude, bool thrown) {
  enum { MODE = 3, PARTICLES = LINKS + 1 };
  small_run r;
  open_chain(&r, &elastic_bar, groups);
  const sweep *w = simulation_state(r.simulation, 0);
  const rows *g = w->body->lattice;
  const double dt = w->body->time_step, pi = acos(-1);
  const double omega =
      2 * sqrt(rigidity_axial(0.2) / SPACING / particle_mass()) * sin(pi * MODE / (2 * PARTICLES));
  const double of_steps = 2 / dt * asin(omega * dt / 2);
  for (int n = 0; n < 20; n++) {
    const double t = simulation_time(r.simulation);
    const double part = thrown ? dt * sin(of_steps * t) / sin(of_steps * dt) : cos(of_steps * t);
    for (long p = 0; p < g->particle_count; p++) {
      const int64_t q = g->particle_site[p];
      const double mode = cos(pi * MODE * (g->x[q] / SPACING + 0.5) / PARTICLES);
      const double error = w->body->displacement[0][q] - amplitude * mode * part;
      if (!(fabs(error) <= 1e-9 * fabs(amplitude) * (thrown ? 1 / omega : 1)))
        fail_msg("step %ld: off by %g of %g", simulation_step_done(r.simulation), error, amplitude);
    }
    simulation_advance(r.simulation, 50, NULL);
  }
  assert_true(small_largest(&r, "energy/external") == 0);
  const double held = small_largest(&r, "energy/kinetic");
  assert_true(held > 0);
  assert_true(small_largest(&r, "energy/imbalance") < 1e-10 * held);
  small_close(&r);
}

static void a_chain_swings_in_its_modes(void **state) {
  (void)state;
#define MODE_3 "cos(180 [deg]*3*(x/10 [mm] + 0.5)/25)"
  expect_mode("&initial_displacement region = 'all' component = 'x' value = '1 [nm]*" MODE_3
              "' /\n",
              1e-9, false);
  expect_mode("&initial_velocity region = 'all' component = 'x' value = '10 [um/s]*" MODE_3 "' /\n",
              1e-5, true);
}

/* What the bonds hold is there from the start on. */
static void the_first_sample_knows_the_energy(void **state) {
  (void)state;
  small_run r;
  open_chain(&r, &elastic_bar,
             "&initial_displacement region = 'all' component = 'x' value = '1e-6*x' /\n");
  const double *stored;
  simulation_advance(r.simulation, 1, NULL);
  simulation_series(r.simulation, small_series(&r, "energy/stored"), NULL, &stored);
  const double held = LINKS * 0.5 * rigidity_axial(0.2) * SPACING * 1e-12;
  assert_true(fabs(stored[0] / held - 1) < 1e-9);
  small_close(&r);
}

/* A rigid rotation, small: beams that turn with their particles are not bent. */
static void a_turned_body_is_at_rest(void **state) {
  (void)state;
  small_run turned, bent;
#define TURN                                                                                       \
  "&initial_displacement region = 'all' component = 'x' value = '-1e-6*y' /\n"                     \
  "&initial_displacement region = 'all' component = 'y' value = '1e-6*x' /\n"
  open_chain(&turned, &elastic_beam,
             TURN "&initial_displacement region = 'all' component = 'rotation' value = '1e-6 rad' "
                  "/\n");
  open_chain(&bent, &elastic_beam, TURN);
  simulation_advance(turned.simulation, 1, NULL);
  simulation_advance(bent.simulation, 1, NULL);
  const double scale = rigidity_bending(0.2) / SPACING * 1e-12 * LINKS;
  assert_true(small_largest(&turned, "energy/stored") < 1e-6 * scale);
  assert_true(small_largest(&bent, "energy/stored") > scale);
  small_close(&turned);
  small_close(&bent);
}

/* A support holds a particle where it was displaced to, a drive goes on from there. */
static void what_is_held_is_held_where_it_is(void **state) {
  (void)state;
  small_run r;
  open_chain(&r, &elastic_bar,
             POINT("left", "0", "0") POINT(
                 "right", "0.24",
                 "0") "&initial_displacement region = 'left' component = 'x' value = '-2 um' /\n"
                      "&initial_displacement region = 'right' component = 'x' value = '3 um' /\n"
                      "&support region = 'left' fix = 'x' /\n"
                      "&drive region = 'right' component = 'x' velocity = '10 mm/s' /\n");
  assert_int_equal(small_go(&r), STEP_END);
  const sweep *w = simulation_state(r.simulation, 0);
  const rows *g = w->body->lattice;
  assert_true(w->body->displacement[0][g->particle_site[0]] == -2e-6);
  assert_true(fabs(w->body->displacement[0][g->particle_site[LINKS]] - 4e-6) < 1e-16);
  small_close(&r);
}

static void formulas_know_all_three_directions(void **state) {
  (void)state;
  small_run r;
  must_open(
      &r, &springs,
      "&simulation end_time = '2 ms' step = '5 us' /\n"
      "&lattice name = 'b' kind = 'fcc' shells = 2 spacing = '10 mm' rotation = 20 axis = 1, 2, "
      "1 /\n&material lattice = 'b' model = 'm' /\n"
      "&region name = 'all' shape = 'sphere' centre = 0, 0, 0 radius = 1 /\n"
      "&body lattice = 'b' shape = 'box' corner = 0, 0, 0 size = '60 mm', '50 mm', '40 mm' /\n"
      "&initial_displacement region = 'all' component = 'z' value = '1e-4*(x - 2*y) + "
      "z**2/1 [km]' /\n"
      "&initial_velocity region = 'all' component = 'y' value = '| 1 [m/s] when z < 20 [mm] "
      "| -z/1 [s] otherwise' /\n");
  const body *b = simulation_state(r.simulation, 0)->body;
  const rows *g = b->lattice;
  assert_true(g->particle_count > 100);
  for (long p = 0; p < g->particle_count; p++) {
    const int64_t q = g->particle_site[p];
    const double x = g->x[q], y = g->y[q], z = g->z[q];
    assert_true(fabs(b->displacement[2][q] - (1e-4 * (x - 2 * y) + z * z / 1000)) < 1e-18);
    assert_true(b->velocity[1][q] == (z < 0.02 ? 1 : -z));
  }
  small_close(&r);
}

/* In increments the displaced body comes to rest where it was made. */
static void a_quasi_static_run_may_begin_displaced(void **state) {
  (void)state;
  small_run r;
  must_open(&r, &elastic_bar,
            "&simulation end_time = 1 /\n&relaxation increments = 2 tolerance = 1e-8 /\n"
            "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
            "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.06 /\n" ALL
            "&material lattice = 'c' model = 'm' /\n&output frames = 0 /\n"
            "&region name = 'foot' shape = 'rectangle' corner = -1, -1 size = 1.006, 2 /\n"
            "&support region = 'foot' fix = 'xy' /\n"
            "&initial_displacement region = 'all' component = 'x' value = '1e-5*max(x - 6 [mm], "
            "0)*(1 + y/1 [m])' /\n");
  assert_int_equal(small_go(&r), STEP_END);
  const body *b = simulation_state(r.simulation, 0)->body;
  for (long p = 0; p < b->lattice->particle_count; p++)
    assert_true(fabs(b->displacement[0][b->lattice->particle_site[p]]) < 1e-5 * 1e-6);
  assert_true(small_last(&r, "energy/stored") < 1e-9 * small_largest(&r, "energy/stored"));
  small_close(&r);
}

static void what_cannot_be_is_told(void **state) {
  (void)state;
  static const struct {
    const char *groups, *message;
  } cases[] = {
      {"&initial_displacement region = 'all' component = 'x' value = 1e-6 /\n"
       "&initial_displacement region = 'left' component = 'x' value = 1e-6 /\n",
       "the particle at (0, 0) mm is given two initial displacements in x"},
      {"&initial_velocity region = 'all' component = 'x' value = '1 [m**2/s]/x' /\n",
       "this formula has no finite value at (0, 0) mm"},
      {"&initial_displacement region = 'all' component = 'x' value = 'x*sqrt(5 - x/10 [mm])' /\n",
       "this formula has no finite value at (60, 0) mm"},
      {"&initial_velocity region = 'all' component = 'x' value = '1e6 [1/s]*x' /\n",
       "this velocity takes a particle further than a spacing in one step"},
      {"&initial_velocity region = 'all' component = 'x' value = '1 [1/s]*x*t' /\n",
       "there is no quantity `t`"},
      {"&initial_displacement region = 'all' component = 'rotation' value = '1 mm' /\n",
       "`value` is a pure number; `1 mm` is a length"},
      {"&initial_displacement region = 'all' component = 'x' value = '1 m + x' /\n",
       "there is no unit `+ x`"},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    char text[4096];
    snprintf(
        text, sizeof text,
        "&simulation end_time = 1e-4 step = 1e-7 /\n" CHAIN ALL POINT(
            "left", "0",
            "0") "&material lattice = 'c' model = 'm' /\n&output frames = 0 /\n"
                 "&monitor name = 'u' kind = 'displacement' region = 'left' component = 'x' /\n%s",
        LINKS * SPACING, cases[k].groups);
    small_run r;
    small_open(&r, &elastic_beam, text);
    assert_null(r.simulation);
    if (strcmp(r.said.items[0].message, cases[k].message) != 0)
      fail_msg("%s: %s", cases[k].groups, r.said.items[0].message);
    small_close(&r);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_chain_swings_in_its_modes),
      cmocka_unit_test(the_first_sample_knows_the_energy),
      cmocka_unit_test(a_turned_body_is_at_rest),
      cmocka_unit_test(what_is_held_is_held_where_it_is),
      cmocka_unit_test(formulas_know_all_three_directions),
      cmocka_unit_test(a_quasi_static_run_may_begin_displaced),
      cmocka_unit_test(what_cannot_be_is_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
