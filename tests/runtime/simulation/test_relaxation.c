/* Quasi-static runs: balance after every increment, the work of a linear body, the same answer
   however it is reached, how loads come, damage, threads, resuming. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/sweep.h"
#include "runtime/filling/lattice.h"
#include "runtime/simulation/relaxation.h"
#include "tests/runtime/family_law.h"
#include "tests/runtime/hand_over.h"
#include "tests/runtime/simulation/same_runs.h"

/* A plate drawn out, its ends held; `motion` is that of the right one, in a deck's words. */
static void open_moved(small_run *r, const pl_law *kernel, const char *keys, const char *values,
                       int threads, const char *motion) {
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = 1 threads = %d /\n"
           "&relaxation %s /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = 10 /\n"
           "&material lattice = 'c' model = 'm' %s /\n"
           "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.3, 0.1 /\n"
           "&notch lattice = 'c' shape = 'rectangle' corner = 0.145, 0 size = 0.01, 0.03 /\n"
           "&region name = 'left' shape = 'rectangle' corner = 0, 0 size = 0.015, 0.1 /\n"
           "&region name = 'right' shape = 'rectangle' corner = 0.285, 0 size = 0.015, 0.1 /\n"
           "&support region = 'left' fix = 'xy' /\n"
           "&support region = 'right' fix = 'y' /\n"
           "&drive region = 'right' component = 'x' %s /\n"
           "&monitor name = 'left' kind = 'reaction' region = 'left' component = 'x' /\n"
           "&monitor name = 'right' kind = 'reaction' region = 'right' component = 'x' /\n"
           "&output frames = 4 /\n",
           threads, keys, values, motion);
  small_open(r, kernel, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

/* The displacement, m, comes evenly. */
static void open_plate(small_run *r, const pl_law *kernel, const char *keys, const char *values,
                       int threads, double displacement) {
  char motion[80];
  snprintf(motion, sizeof motion, "displacement = %g history = 'ramp' rise = 1", displacement);
  open_moved(r, kernel, keys, values, threads, motion);
}

static const double *series(const small_run *r, const char *name) {
  const double *values;
  const int k = small_series(r, name);
  assert_true(k >= 0);
  simulation_series(r->simulation, k, NULL, &values);
  return values;
}

static void every_increment_ends_in_balance(void **state) {
  (void)state;
  const pl_law *const kernels[] = {&family_hexagon, &elastic_beam, &elastic_bar};
  for (int n = 0; n < 3; n++) {
    small_run r;
    const double *time, u = 1e-7;
    open_plate(&r, kernels[n], "increments = 5 tolerance = 1e-6", "", 2, u);
    assert_int_equal(small_go(&r), STEP_END);
    assert_int_equal(simulation_history(r.simulation, &time), 6);
    const double *left = series(&r, "left"), *right = series(&r, "right");
    const double *steps = series(&r, "relaxation_steps"),
                 *unbalance = series(&r, "relaxation_unbalance");
    const double *stored = series(&r, "energy/stored");
    for (int k = 1; k <= 5; k++) {
      assert_true(fabs(time[k] - 0.2 * k) < 1e-15);
      assert_true(unbalance[k] <= 1e-6 && steps[k] > 0);
      assert_true(fabs(left[k] + right[k]) <= 1e-5 * fabs(right[k]));
      /* a linear body: forces follow the displacement and store half their product with it */
      assert_true(fabs(right[k] - k * right[1]) <= 1e-5 * k * fabs(right[1]));
      assert_true(fabs(stored[k] - 0.5 * right[k] * 0.2 * k * u) <= 1e-5 * stored[k]);
    }
    print_message("%s: %.0f steps in the last increment\n", kernels[n]->name, steps[5]);
    if (kernels[n]->kind != PL_STATE) /* of this one it is not checked */
      assert_true(fabs(small_last(&r, "energy/imbalance")) <=
                  1e-9 * small_last(&r, "energy/external"));
    assert_true(small_last(&r, "energy/kinetic") <= 1e-9 * small_last(&r, "energy/stored"));
    small_close(&r);
  }
}

/* Tighter, and in other parts: the same balance. */
static void the_way_does_not_matter_to_a_linear_body(void **state) {
  (void)state;
  double force[2];
  const char *const keys[] = {"increments = 1 tolerance = 1e-8", "increments = 7 tolerance = 1e-6"};
  for (int n = 0; n < 2; n++) {
    small_run r;
    open_plate(&r, &family_hexagon, keys[n], "", 1, 1e-7);
    assert_int_equal(small_go(&r), STEP_END);
    force[n] = small_last(&r, "right");
    small_close(&r);
  }
  assert_true(fabs(force[0] - force[1]) <= 1e-5 * fabs(force[0]));
}

/* The bar's increment takes a period, in which damping drags at it: the work of that, beside
   half of force times displacement. Critical damping would take 0.9 of that and more. */
static void an_increment_costs_little_more_than_it_stores(void **state) {
  (void)state;
  const pl_law *const kernels[] = {&family_hexagon, &elastic_beam, &elastic_bar};
  for (int n = 0; n < 3; n++) {
    small_run r;
    open_plate(&r, kernels[n], "increments = 1 tolerance = 1e-6", "", 1, 1e-7);
    assert_int_equal(small_go(&r), STEP_END);
    const double stored = small_last(&r, "energy/stored"), force = small_last(&r, "right");
    const double taken = small_last(&r, "energy/external") - stored;
    print_message("%s: %.3f of the stored energy to damping\n", kernels[n]->name, taken / stored);
    assert_true(fabs(stored - 0.5 * force * 1e-7) <= 1e-5 * stored);
    assert_true(taken >= 0 && taken < 0.5 * stored);
    small_close(&r);
  }
}

/* --- how loads come --------------------------------------------------------------------------- */

static void expect_loads(const char *motion, const double expected[5]) {
  small_run r;
  open_moved(&r, &elastic_bar, "increments = 4 tolerance = 1e-6", "", 1, motion);
  assert_int_equal(small_go(&r), STEP_END);
  const double *force = series(&r, "right"), *work = series(&r, "energy/external");
  double stiffness = 0;
  for (int k = 0; k < 5; k++) {
    if (stiffness == 0 && expected[k] > 0) stiffness = force[k] / expected[k];
    assert_true(fabs(force[k] - stiffness * expected[k]) <= 1e-4 * fabs(force[4]));
    assert_true(work[k] <= 2 * force[4] * 1e-7);
  }
  assert_true(stiffness > 0);
  small_close(&r);
}

/* In parts of the full displacement. A jump would take the work of a wall that hits the body. */
static void no_load_jumps(void **state) {
  (void)state;
  expect_loads("displacement = 1e-7", (double[]){0, 0.25, 0.5, 0.75, 1});
  expect_loads("displacement = 1e-7 start = 0.5", (double[]){0, 0, 0, 0.5, 1});
  expect_loads("displacement = 1e-7 history = 'constant'", (double[]){0, 1, 1, 1, 1});
  expect_loads("displacement = 1e-7 history = 'constant' start = 0.5", (double[]){0, 0, 0, 1, 1});
  expect_loads("displacement = 1e-7 history = 'constant' start = 0.3", (double[]){0, 0, 1, 1, 1});
  expect_loads("displacement = 1e-7 times = 0, 0.6, 1 values = 0, 0, 1",
               (double[]){0, 0, 0, 0.375, 1});
  expect_loads("velocity = 1e-7", (double[]){0, 0.25, 0.5, 0.75, 1});
  expect_loads("velocity = 1e-7 start = 0.5", (double[]){0, 0, 0, 0.25, 0.5});
}

/* A bar that hangs from its upper end and is drawn down at its lower: weight and force grow
   evenly. */
static void forces_and_gravity_grow_together(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &elastic_bar,
             "&simulation end_time = 1 /\n"
             "&relaxation increments = 4 tolerance = 1e-7 /\n"
             "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
             "&material lattice = 'c' model = 'm' /\n"
             "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.2 /\n"
             "&region name = 'top' shape = 'rectangle' corner = 0, 0.185 size = 0.1, 0.015 /\n"
             "&region name = 'foot' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.005 /\n"
             "&support region = 'top' fix = 'xy' /\n"
             "&force region = 'foot' component = 'y' total = -40 /\n"
             "&gravity acceleration = 0, -10 /\n"
             "&monitor name = 'top' kind = 'reaction' region = 'top' component = 'y' /\n"
             "&monitor name = 'foot' kind = 'displacement' region = 'foot' component = 'y' /\n");
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  assert_int_equal(small_go(&r), STEP_END);
  const rows *g = simulation_rows(r.simulation, 0);
  const double full = 40 + 10 * g->mass * (double)g->particle_count;
  const double *top = series(&r, "top"), *foot = series(&r, "foot");
  long unbalanced;
  assert_int_equal(simulation_increments(r.simulation, &unbalanced), 4);
  assert_int_equal(unbalanced, 0);
  for (int k = 0; k < 5; k++) {
    assert_true(fabs(top[k] - 0.25 * k * full) <= 1e-5 * full);
    assert_true(fabs(foot[k] - 0.25 * k * foot[4]) <= 1e-5 * fabs(foot[4]));
  }
  small_close(&r);
}

/* Two particles side by side that only their inertia holds in y: bonds do not answer, and the
   unbalance is that of the loads. */
static double unbalance_under(const char *groups) {
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n"
           "&relaxation increments = 1 tolerance = 1e-9 most_steps = 10 /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
           "&material lattice = 'c' model = 'm' /\n"
           "&body lattice = 'c' shape = 'rectangle' corner = 0, -0.001 size = 0.01, 0.002 /\n"
           "&region name = 'both' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"
           "&support region = 'both' fix = 'x', 'rotation' /\n%s"
           "&output frames = 0 /\n",
           groups);
  small_run r;
  small_open(&r, &elastic_beam, text);
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  assert_int_equal(small_go(&r), STEP_END);
  const double unbalance = small_last(&r, "relaxation_unbalance");
  small_close(&r);
  return unbalance;
}

/* Each particle weighs w and is drawn up by 3 w: 2 w of them are left, beside the loads sqrt(1 +
   9) w. */
static void weight_is_a_load(void **state) {
  (void)state;
  const double weight = 2323 * sqrt(3) / 2 * 0.01 * 0.01 * 0.1 * 1e-3;
  char groups[256];
  snprintf(groups, sizeof groups,
           "&gravity acceleration = 0, -1e-3 /\n"
           "&force region = 'both' component = 'y' force = %.17g /\n",
           2 * 3 * weight);
  assert_true(fabs(unbalance_under(groups) - 2 / sqrt(10)) < 1e-9);
}

/* A moment of twice the force's size times the spacing, held: 1 of sqrt(1 + 4) is left. */
static void a_moment_counts_over_a_spacing(void **state) {
  (void)state;
  const double unbalance = unbalance_under("&force region = 'both' component = 'y' force = 1e-3 /\n"
                                           "&force region = 'both' moment = 2e-5 /\n");
  assert_true(fabs(unbalance - 1 / sqrt(5)) < 1e-9);
}

/* No particle is free, and nothing unbalanced: an increment lasts until its loads have come all
   the same. */
static void loads_come_in_full(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &elastic_bar,
             "&simulation end_time = 1 /\n"
             "&relaxation increments = 4 tolerance = 1e-3 /\n"
             "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
             "&material lattice = 'c' model = 'm' /\n"
             "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.3, 0.1 /\n"
             "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"
             "&support region = 'all' fix = 'y' /\n"
             "&drive region = 'all' component = 'x' displacement = 4e-6 /\n"
             "&monitor name = 'u' kind = 'displacement' region = 'all' component = 'x' /\n");
  assert_non_null(r.simulation);
  assert_int_equal(small_go(&r), STEP_END);
  const double *u = series(&r, "u");
  for (int k = 0; k < 5; k++)
    assert_true(fabs(u[k] - 1e-6 * k) < 1e-15);
  small_close(&r);
}

/* --- damage ----------------------------------------------------------------------------------- */

/* A plate that breaks at the notch: the force rises, falls, and little moves while it does. */
static void a_plate_breaks_at_rest(void **state) {
  (void)state;
  small_run r;
  open_plate(&r, &family_hexagon, "increments = 60 tolerance = 1e-4", "S_t = 1e-4", 2, 1.2e-4);
  assert_int_equal(small_go(&r), STEP_END);
  const double *force = series(&r, "right"), *kinetic = series(&r, "energy/kinetic");
  const double *lost = series(&r, "energy/dissipated_damage");
  double peak = 0, moving = 0;
  for (int k = 0; k <= 60; k++) {
    peak = fmax(peak, force[k]);
    moving = fmax(moving, kinetic[k]);
  }
  long unbalanced;
  assert_int_equal(simulation_increments(r.simulation, &unbalanced), 60);
  assert_int_equal(unbalanced, 0);
  assert_true(peak > 0 && force[60] < 0.01 * peak && lost[60] > 0);
  assert_true(moving < 1e-6 * lost[60]);
  small_close(&r);
}

static void impatience_is_counted(void **state) {
  (void)state;
  small_run r;
  long unbalanced;
  open_plate(&r, &elastic_bar, "increments = 3 tolerance = 1e-9 most_steps = 10", "", 1, 1e-7);
  assert_int_equal(small_go(&r), STEP_END);
  assert_int_equal(simulation_increments(r.simulation, &unbalanced), 3);
  assert_int_equal(unbalanced, 3);
  assert_true(small_last(&r, "relaxation_unbalance") > 1e-9);
  small_close(&r);
}

/* --- same bits -------------------------------------------------------------------------------- */

static const char keys_of[] = "increments = 12 tolerance = 1e-3";

static void threads_and_resuming_change_no_bit(void **state) {
  (void)state;
  small_run straight;
  open_plate(&straight, &family_hexagon, keys_of, "S_t = 1e-4", 1, 6e-5);
  int frames = 0;
  step_status status = STEP_OK;
  while (status == STEP_OK) {
    frames += simulation_frame_due(straight.simulation);
    simulation_frame_taken(straight.simulation);
    status = simulation_advance(straight.simulation, 1L << 30, NULL);
  }
  assert_int_equal(status, STEP_END);
  assert_int_equal(frames, 4); /* the fifth, at the end, is still due */
  const long total = simulation_step_done(straight.simulation);
  const long stops[] = {0, 60, total / 2, total - 1};
  for (int k = 0; k < 4; k++) {
    small_run first, second;
    open_plate(&first, &family_hexagon, keys_of, "S_t = 1e-4", 2, 6e-5);
    open_plate(&second, &family_hexagon, keys_of, "S_t = 1e-4", 3, 6e-5);
    hand_over(first.simulation, stops[k], second.simulation);
    small_close(&first);
    assert_int_equal(small_go(&second), STEP_END);
    same_runs(&straight, &second);
    small_close(&second);
  }
  double most = 0;
  for (long p = 0; p < simulation_rows(straight.simulation, 0)->particle_count; p++)
    most = fmax(most, simulation_state(straight.simulation, 0)
                          ->field[0][simulation_rows(straight.simulation, 0)->particle_site[p]]);
  assert_true(most > 0.1);
  small_close(&straight);
}

/* --- by itself -------------------------------------------------------------------------------- */

#define PAIR                                                                                       \
  "&simulation end_time = 0.4 step_safety = 0.5 /\n&relaxation increments = 4 tolerance = 0.01 "   \
  "most_steps = 100 /\n&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"  \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, -0.001 size = 0.01, 0.002 /\n"              \
  "&material lattice = 'c' model = 'm' /\n"                                                        \
  "&region name = 'left' shape = 'point' at = 0, 0 /\n"                                            \
  "&region name = 'right' shape = 'point' at = 0.01, 0 /\n"                                        \
  "&support region = 'left' fix = 'x', 'y' /\n&force region = 'right' component = 'x' total = "    \
  "100 "                                                                                           \
  "/\n&output frames = 0 /\n"

typedef struct pair {
  small_run run;
  rows *lattice;
  run_body of;
  loads *loads;
  sweep *sweep;
  relaxation *relaxation;
  long left, right;
} pair;

static void relax_pair(pair *to) {
  pair p;
  small_open(&p.run, &elastic_bar, PAIR);
  if (!p.run.simulation) small_print(&p.run);
  assert_non_null(p.run.simulation);
  p.sweep = simulation_state(p.run.simulation, 0);
  p.lattice = lattice_build(p.run.deck, 0, &p.run.said);
  p.loads = loads_new(p.run.deck, 0, p.lattice, "m", 2, &p.run.said);
  p.of = (run_body){
      .lattice_rows = p.lattice, .body = p.sweep->body, .state = p.sweep, .loads = p.loads};
  p.left = p.lattice->particle_site[0];
  p.right = p.lattice->particle_site[1];
  *to = p;
  to->relaxation = relaxation_new(to->run.deck, &to->of, 1, 0.5);
  relaxation_begin(to->relaxation);
}

static void relax_no_more(pair *p) {
  relaxation_free(p->relaxation);
  loads_free(p->loads);
  rows_free(p->lattice);
  small_close(&p->run);
}

/* Two spacings there and back at half the stable step, half a spacing a step at most: sixteen
   steps of a period. While the loads move there is a tenth of the critical damping. */
static void an_increment_begins_with_a_ramp(void **state) {
  (void)state;
  pair p;
  relax_pair(&p);
  assert_int_equal(p.relaxation->ramp, 16);
  assert_true(fabs(p.relaxation->interval - 0.1) < 1e-16);
  assert_true(fabs(p.sweep->body->decay - exp(-0.1 * 2 * acos(-1) / 16)) < 1e-15);
  p.relaxation->state.done = 2;
  const load_clock clock = relaxation_clock(p.relaxation, 333);
  assert_true(fabs(clock.from - 0.2) < 1e-16 && fabs(clock.to - 0.3) < 1e-16);
  assert_int_equal(clock.first, 333);
  assert_int_equal(clock.ramp, 16);
  assert_true(relaxation_due(p.relaxation, 0) && relaxation_due(p.relaxation, 50));
  assert_false(relaxation_due(p.relaxation, 1) || relaxation_due(p.relaxation, 49));
  relax_no_more(&p);
}

/* Moved by u with forces that fall by k u, the right particle is an oscillator: critical is 2
   sqrt(k/m). */
static void damping_is_critical_for_the_motion_seen(void **state) {
  (void)state;
  pair p;
  relax_pair(&p);
  const double k = 3e7, u = 1e-6;
  p.sweep->body->displacement[0][p.right] = u;
  p.sweep->body->force[0][p.right] = -k * u;
  assert_false(relaxation_look(p.relaxation, 25));
  const double rate = 2 * sqrt(k / p.sweep->body->mass[0]);
  assert_true(fabs(p.relaxation->looked_at[0].state.rate / rate - 1) < 1e-12);
  assert_true(fabs(p.sweep->body->decay - exp(-rate * p.sweep->body->time_step)) < 1e-14);
  p.sweep->body->displacement[0][p.right] = 2 * u; /* forces that help the motion say nothing */
  p.sweep->body->force[0][p.right] = 0;
  relaxation_look(p.relaxation, 50);
  assert_true(fabs(p.relaxation->looked_at[0].state.rate / rate - 1) < 1e-12);
  relax_no_more(&p);
}

/* 100 N are applied, bonds carry 90 of them: a tenth is unbalanced. */
static void an_increment_ends_in_balance_or_after_most_steps(void **state) {
  (void)state;
  pair p;
  relax_pair(&p);
  assert_int_equal(p.loads->force_count, 1);
  p.loads->forces[0].now = 100;
  p.sweep->body->force[0][p.right] = -90;
  p.sweep->body->force[0][p.left] = 90;
  assert_false(relaxation_look(p.relaxation, 25));
  assert_true(fabs(p.relaxation->state.unbalance - 0.1) < 1e-15);
  assert_true(relaxation_look(p.relaxation, 100)); /* it was given up */
  assert_int_equal(p.relaxation->state.done, 1);
  assert_int_equal(p.relaxation->state.unbalanced, 1);
  relaxation_next(p.relaxation, 100);
  p.loads->forces[0].now = 100;
  p.sweep->body->force[0][p.right] = -99.5;
  assert_false(relaxation_look(p.relaxation, 115)); /* the loads still move */
  assert_true(relaxation_look(p.relaxation, 125));
  assert_true(fabs(p.relaxation->state.unbalance - 0.005) < 1e-14);
  assert_int_equal(p.relaxation->state.done, 2);
  assert_int_equal(p.relaxation->state.unbalanced, 1);
  assert_int_equal(p.relaxation->state.steps, 25);
  p.loads->forces[0].now = 0; /* broken: what was needed once, 100 N, counts a hundredth */
  p.sweep->body->force[0][p.right] = 0.5;
  p.sweep->body->force[0][p.left] = 0;
  relaxation_look(p.relaxation, 150);
  assert_true(fabs(p.relaxation->state.unbalance - 0.5) < 1e-14);
  relax_no_more(&p);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_increment_ends_in_balance),
      cmocka_unit_test(the_way_does_not_matter_to_a_linear_body),
      cmocka_unit_test(an_increment_costs_little_more_than_it_stores),
      cmocka_unit_test(no_load_jumps),
      cmocka_unit_test(forces_and_gravity_grow_together),
      cmocka_unit_test(weight_is_a_load),
      cmocka_unit_test(a_moment_counts_over_a_spacing),
      cmocka_unit_test(loads_come_in_full),
      cmocka_unit_test(a_plate_breaks_at_rest),
      cmocka_unit_test(impatience_is_counted),
      cmocka_unit_test(threads_and_resuming_change_no_bit),
      cmocka_unit_test(an_increment_begins_with_a_ramp),
      cmocka_unit_test(damping_is_critical_for_the_motion_seen),
      cmocka_unit_test(an_increment_ends_in_balance_or_after_most_steps),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
