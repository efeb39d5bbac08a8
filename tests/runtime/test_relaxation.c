/* Quasi-static runs: balance after every increment, the work of a linear body, the same answer
   however it is reached, damage, threads, resuming. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <unistd.h>

#include <cmocka.h>

#include "tests/runtime/family_law.h"
#include "tests/runtime/small_run.h"

/* A plate drawn out, its ends held; the format takes relaxation keys, the law's values, threads and
   the displacement. */
static void open_plate(small_run *r, const pl_law *kernel, const char *keys, const char *values,
                       int threads, double displacement) {
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
           "&drive region = 'right' component = 'x' displacement = %g history = 'ramp' rise = 1 /\n"
           "&monitor name = 'left' kind = 'reaction' region = 'left' component = 'x' /\n"
           "&monitor name = 'right' kind = 'reaction' region = 'right' component = 'x' /\n"
           "&output frames = 4 /\n",
           threads, keys, values, displacement);
  small_open(r, kernel, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
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
  for (int k=0;k<=60;k+=3) fprintf(stderr,"%d %g N kin %g lost %g steps %g unb %g imb %g\n",k,force[k],kinetic[k],lost[k],series(&r,"relaxation_steps")[k],series(&r,"relaxation_unbalance")[k],series(&r,"energy/imbalance")[k]);
  long unbalanced;
  assert_int_equal(simulation_increments(r.simulation, &unbalanced), 60);
  assert_int_equal(unbalanced, 0);
  assert_true(peak > 0 && force[60] < 0.01 * peak && lost[60] > 0);
  assert_true(moving < 1e-6 * lost[60]);
  assert_true(fabs(small_last(&r, "energy/imbalance")) < 1e-8 * lost[60]);
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

static void same_runs(small_run *a, small_run *b) {
  const sweep *x = simulation_state(a->simulation), *y = simulation_state(b->simulation);
  const size_t site = (size_t)x->lattice->size * sizeof(double);
  assert_int_equal(simulation_step_done(a->simulation), simulation_step_done(b->simulation));
  for (int d = 0; d < 2; d++)
    assert_memory_equal(x->displacement[d], y->displacement[d], site);
  assert_memory_equal(x->field[0], y->field[0], site);
  const double *p, *q;
  const long samples = simulation_history(a->simulation, &p);
  assert_int_equal(simulation_history(b->simulation, &q), samples);
  assert_memory_equal(p, q, (size_t)samples * sizeof(double));
  for (int k = 0; k < simulation_series_count(a->simulation); k++) {
    simulation_series(a->simulation, k, NULL, &p);
    simulation_series(b->simulation, k, NULL, &q);
    assert_memory_equal(p, q, (size_t)samples * sizeof(double));
  }
}

static void threads_and_resuming_change_no_bit(void **state) {
  (void)state;
  static const char path[] = "test_relaxation.state", fingerprint[] = "deck 1, law 4";
  char error[200];
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
    long taken = -1;
    open_plate(&first, &family_hexagon, keys_of, "S_t = 1e-4", 2, 6e-5);
    while (simulation_step_done(first.simulation) < stops[k])
      simulation_advance(first.simulation, stops[k] - simulation_step_done(first.simulation), NULL);
    assert_true(simulation_save(first.simulation, path, fingerprint, 0, error, sizeof error));
    small_close(&first);
    open_plate(&second, &family_hexagon, keys_of, "S_t = 1e-4", 3, 6e-5);
    assert_true(
        simulation_restore(second.simulation, path, fingerprint, &taken, error, sizeof error));
    assert_int_equal(small_go(&second), STEP_END);
    same_runs(&straight, &second);
    small_close(&second);
  }
  double most = 0;
  for (long p = 0; p < simulation_rows(straight.simulation, 0)->particle_count; p++)
    most = fmax(most, simulation_state(straight.simulation)
                          ->field[0][simulation_rows(straight.simulation, 0)->particle_site[p]]);
  assert_true(most > 0.1);
  small_close(&straight);
  unlink(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_increment_ends_in_balance),
      cmocka_unit_test(the_way_does_not_matter_to_a_linear_body),
      cmocka_unit_test(a_plate_breaks_at_rest),
      cmocka_unit_test(impatience_is_counted),
      cmocka_unit_test(threads_and_resuming_change_no_bit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
