/* Gravity and initial velocities against closed forms: free fall, weight on a support, flight of a
   body; their work in the energy ledger; what decks that contradict themselves are told. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/sweep.h"
#include "tests/runtime/small_run.h"

#define SPACING   0.01
#define THICKNESS 0.1
#define BLOCK                                                                                      \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"                      \
  "&material lattice = 'c' model = 'm' /\n"                                                        \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.1 /\n"                      \
  "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"                       \
  "&region name = 'foot' shape = 'rectangle' corner = -1, -0.001 size = 2, 0.002 /\n"              \
  "&monitor name = 'fall' kind = 'displacement' region = 'all' component = 'y' /\n"

static double block_mass(const small_run *r) {
  const rows *w = simulation_rows(r->simulation, 0);
  return 2323 * sqrt(3) / 2 * SPACING * SPACING * THICKNESS * (double)w->particle_count;
}

static double first_of(const small_run *r, const char *name) {
  const double *values;
  simulation_series(r->simulation, small_series(r, name), NULL, &values);
  return values[0];
}

static void must_open(small_run *r, const char *text) {
  small_open(r, &elastic_beam, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

/* The parabola, for every particle alike: u = a t^2/2. With the velocities half a step before and
   after, the kinetic energy is m a^2 (t^2 - dt^2/4)/2: less by what it is at the start. */
static void a_free_body_falls_as_a_whole(void **state) {
  (void)state;
  small_run r;
  must_open(&r, "&simulation end_time = 1e-3 /\n" BLOCK
                "&gravity acceleration = '2 m/s^2', -9.81 /\n&output frames = 0 /\n");
  assert_int_equal(small_go(&r), STEP_END);
  const double dt = simulation_step_limit(r.simulation)->step;
  const double n = (double)simulation_step_done(r.simulation);
  const sweep *w = simulation_state(r.simulation, 0);
  const double way = dt * dt * n * n / 2;
  for (long q = 0; q < w->body->lattice->size; q++) {
    const double here = w->body->lattice->present[q] ? way : 0; /* absent sites stay */
    assert_true(fabs(w->body->displacement[0][q] - 2 * here) <= 1e-11 * way);
    assert_true(fabs(w->body->displacement[1][q] + 9.81 * here) <= 1e-11 * way);
  }
  const double work = block_mass(&r) * (4 + 9.81 * 9.81) * way;
  assert_true(fabs(small_last(&r, "energy/external") / work - 1) < 1e-10);
  const double before = first_of(&r, "energy/kinetic");
  assert_true(fabs((small_last(&r, "energy/kinetic") - before) / work - 1) < 1e-10);
  assert_true(fabs(before / (work / (4 * n * n)) + 1) < 1e-10);
  assert_true(fabs(small_last(&r, "energy/imbalance")) < 1e-10 * work);
  small_close(&r);
}

/* Weight that takes particles further than a spacing in the first step: nothing moves. */
static void gravity_runs_away_before_it_moves(void **state) {
  (void)state;
  small_run r;
  must_open(&r, "&simulation end_time = 1e-3 /\n" BLOCK
                "&gravity acceleration = 0, -1e13 /\n&output frames = 0 /\n");
  const double dt = simulation_step_limit(r.simulation)->step;
  assert_true(1e13 * dt * dt > SPACING);
  assert_int_equal(small_go(&r), STEP_BAD);
  assert_int_equal(simulation_bad(r.simulation).step, 0);
  assert_string_equal(simulation_bad(r.simulation).what, "runaway velocity");
  const sweep *w = simulation_state(r.simulation, 0);
  for (long q = 0; q < w->body->lattice->size; q++)
    assert_true(w->body->displacement[1][q] == 0);
  small_close(&r);
}

/* At rest the foot carries the weight. */
static void a_foot_carries_the_weight(void **state) {
  (void)state;
  small_run r;
  must_open(&r, "&simulation end_time = 10e-3 step_safety = 0.5 /\n" BLOCK
                "&support region = 'foot' fix = 'x', 'y', 'rotation' /\n"
                "&monitor name = 'push' kind = 'reaction' region = 'foot' component = 'y' /\n"
                "&monitor name = 'side' kind = 'reaction' region = 'foot' component = 'x' /\n"
                "&gravity acceleration = 0, -9.81 history = 'cosine' rise = '1 ms' /\n"
                "&gravity acceleration = 3, 0 rise = '1 ms' /\n"
                "&damping rate = '10000 1/s' /\n&output frames = 0 /\n");
  assert_int_equal(small_go(&r), STEP_END);
  const double mass = block_mass(&r);
  print_message("weight on the foot: %.3e off\n", small_last(&r, "push") / (9.81 * mass) - 1);
  assert_true(fabs(small_last(&r, "push") / (9.81 * mass) - 1) < 1e-6);
  assert_true(fabs(small_last(&r, "side") / (-3 * mass) - 1) < 1e-6);
  small_close(&r);
}

/* Weight that changes, a held foot, a driven side, a force and damping: the ledger closes, better
   with shorter steps. */
static double imbalance(double safety) {
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = 3e-4 step_safety = %g /\n" BLOCK
           "&region name = 'side' shape = 'rectangle' corner = 0.095, 0.05 size = 0.01, 0.1 /\n"
           "&support region = 'foot' fix = 'xy' /\n"
           "&gravity acceleration = 2000, -9000 start = 5e-5 rise = 1e-4 /\n"
           "&drive region = 'side' component = 'x' velocity = 0.05 start = 1e-4 rise = 1e-5 /\n"
           "&force region = 'side' component = 'y' total = 100 rise = 1e-5 /\n"
           "&damping rate = 3000 until = 2e-4 /\n&output frames = 0 sample = 1e-6 /\n",
           safety);
  small_run r;
  must_open(&r, text);
  assert_int_equal(small_go(&r), STEP_END);
  const double *values;
  const long samples = simulation_history(r.simulation, NULL);
  simulation_series(r.simulation, small_series(&r, "energy/imbalance"), NULL, &values);
  double most = 0;
  for (long k = 0; k < samples; k++)
    most = fmax(most, fabs(values[k]));
  most /= fabs(small_last(&r, "energy/external"));
  small_close(&r);
  return most;
}

static void the_ledger_counts_the_work_of_gravity(void **state) {
  (void)state;
  const double coarse = imbalance(0.5), fine = imbalance(0.25);
  print_message("imbalance %.2e and %.2e of the work at 0.5 and 0.25 of the limit\n", coarse, fine);
  assert_true(coarse < 1e-4);
  assert_true(fine < 0.4 * coarse);
}

static void threads_do_not_change_the_fall(void **state) {
  (void)state;
  static const char format[] =
      "&simulation end_time = 2e-4 threads = %d /\n" BLOCK "&support region = 'foot' fix = 'y' /\n"
      "&gravity acceleration = 50, -900 rise = 1e-4 /\n"
      "&output frames = 0 sample = 1e-6 /\n";
  small_run r[2];
  const int threads[] = {1, 3};
  for (int k = 0; k < 2; k++) {
    char text[2048];
    snprintf(text, sizeof text, format, threads[k]);
    must_open(&r[k], text);
    assert_int_equal(small_go(&r[k]), STEP_END);
  }
  const long samples = simulation_history(r[0].simulation, NULL);
  for (int s = 0; s < simulation_series_count(r[0].simulation); s++) {
    const double *a, *b;
    simulation_series(r[0].simulation, s, NULL, &a);
    simulation_series(r[1].simulation, s, NULL, &b);
    assert_memory_equal(a, b, (size_t)samples * sizeof *a);
  }
  for (int k = 0; k < 2; k++)
    small_close(&r[k]);
}

/* A body that is thrown keeps its velocity and its energy, to rounding; what it is thrown with is
   no work. */
static void a_thrown_body_keeps_its_velocity(void **state) {
  (void)state;
  small_run r;
  must_open(&r, "&simulation end_time = 1e-3 /\n" BLOCK
                "&initial_velocity region = 'all' component = 'x' value = '300 mm/s' /\n"
                "&initial_velocity region = 'all' component = 'y' value = -0.4 /\n"
                "&output frames = 0 /\n");
  assert_int_equal(small_go(&r), STEP_END);
  const double t = simulation_time(r.simulation), energy = 0.5 * block_mass(&r) * 0.25;
  const sweep *w = simulation_state(r.simulation, 0);
  for (long p = 0; p < w->body->lattice->particle_count; p++) {
    const int64_t q = w->body->lattice->particle_site[p];
    assert_true(fabs(w->body->displacement[0][q] / (0.3 * t) - 1) < 1e-10);
    assert_true(fabs(w->body->displacement[1][q] / (-0.4 * t) - 1) < 1e-10);
  }
  assert_true(fabs(small_last(&r, "energy/kinetic") / energy - 1) < 1e-10);
  assert_true(fabs(small_last(&r, "energy/imbalance")) < 1e-10 * energy);
  assert_true(small_last(&r, "energy/external") == 0);
  small_close(&r);
}

/* The ledger begins with the run: nothing is lost before it. */
static void a_thrown_body_with_damping_has_lost_nothing_at_first(void **state) {
  (void)state;
  small_run r;
  must_open(&r, "&simulation end_time = 1e-3 /\n" BLOCK
                "&initial_velocity region = 'all' component = 'x' value = 0.5 /\n"
                "&damping kind = 'mass' rate = 500 /\n"
                "&output frames = 0 /\n");
  assert_int_equal(small_go(&r), STEP_END);
  assert_true(first_of(&r, "energy/dissipated_damping") == 0);
  assert_true(first_of(&r, "energy/imbalance") == 0);
  const double t = simulation_time(r.simulation), before = first_of(&r, "energy/kinetic"),
               after = small_last(&r, "energy/kinetic");
  assert_true(fabs(after / before / exp(-2 * 500 * t) - 1) < 1e-9);
  assert_true(fabs(small_last(&r, "energy/dissipated_damping") / (before - after) - 1) < 1e-9);
  assert_true(fabs(small_last(&r, "energy/imbalance")) < 1e-10 * before);
  small_close(&r);
}

typedef struct misfit {
  const char *groups;
  diag_code code;
  const char *text;
} misfit;

#define RUN   "&simulation end_time = 1e-4 /\n"
#define THROW "&initial_velocity region = 'all' component = 'x' value = 1 /\n"

static const misfit misfits[] = {
    {RUN BLOCK THROW "&support region = 'foot' fix = 'x' /\n", DIAG_CONFLICT,
     "the particle at (0, 0) mm is held from the start in x"},
    {RUN BLOCK THROW "&drive region = 'foot' component = 'x' velocity = 1 /\n", DIAG_CONFLICT,
     "is held from the start in x"},
    {RUN BLOCK THROW "&initial_velocity region = 'foot' component = 'x' value = 2 /\n",
     DIAG_CONFLICT, "the particle at (0, 0) mm is given two initial velocities in x"},
    {RUN BLOCK "&initial_velocity region = 'all' component = 'x' value = 1e6 /\n",
     DIAG_OUT_OF_BOUNDS, "further than a spacing in one step"},
    {RUN BLOCK "&initial_velocity region = 'al' component = 'x' value = 1 /\n", DIAG_UNKNOWN_NAME,
     "there is no region `al`"},
    {RUN BLOCK "&initial_velocity region = 'all' component = 'rotation' value = '1 m/s' /\n",
     DIAG_UNITS, "`value`"},
    {RUN BLOCK "&gravity acceleration = 0, '-9.81 m/s' /\n", DIAG_UNITS, "`acceleration`"},
    {RUN BLOCK "&gravity acceleration = -9.81 /\n", DIAG_BAD_VALUE, "acceleration"},
    {RUN BLOCK "&gravity acceleration = 0, 0 /\n", DIAG_DECK_WARNING, "this gravity is zero"},
    {RUN BLOCK "&gravity acceleration = 0, -9.81 history = 'ramp' /\n", DIAG_MISSING_KEY, "rise"},
    {RUN BLOCK "&gravity acceleration = 0, -9.81 start = 1 /\n", DIAG_DECK_WARNING,
     "`start` is not before the end"},
};

static void misfits_are_told(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof misfits / sizeof *misfits; k++) {
    small_run r;
    small_open(&r, &elastic_beam, misfits[k].groups);
    bool said = false;
    for (int i = 0; i < r.said.count; i++)
      said |= r.said.items[i].code == misfits[k].code &&
              strstr(r.said.items[i].message, misfits[k].text);
    if (!said) {
      print_error("case %zu: expected \"%s\"\n", k, misfits[k].text);
      small_print(&r);
      fail();
    }
    const bool warning = diag_severity(misfits[k].code) == SEVERITY_WARNING;
    assert_int_equal(r.simulation != NULL, warning);
    small_close(&r);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_free_body_falls_as_a_whole),
      cmocka_unit_test(a_foot_carries_the_weight),
      cmocka_unit_test(gravity_runs_away_before_it_moves),
      cmocka_unit_test(the_ledger_counts_the_work_of_gravity),
      cmocka_unit_test(threads_do_not_change_the_fall),
      cmocka_unit_test(a_thrown_body_keeps_its_velocity),
      cmocka_unit_test(a_thrown_body_with_damping_has_lost_nothing_at_first),
      cmocka_unit_test(misfits_are_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
