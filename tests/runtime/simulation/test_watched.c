/* Monitors of momenta, energies, accelerations, sections, stresses and crack tips: laws of motion,
   statics, closed forms; errors that fall with the step. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/analysis/crack_tip.h"
#include "runtime/analysis/watched.h"
#include "runtime/base/symmetric_tensor.h"
#include "runtime/body/momentum.h"
#include "runtime/interaction/family_forces.h"
#include "runtime/simulation/monitor.h"
#include "tests/runtime/simulation/chain.h"

#define BLOCK                                                                                      \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = 7 /\n"         \
  "&material lattice = 'c' model = 'm' /\n"                                                        \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.12, 0.07 /\n"                    \
  "&region name = 'left' shape = 'rectangle' corner = -1, -1 size = 1.0501, 2 /\n"                 \
  "&region name = 'right' shape = 'rectangle' corner = 0.0502, -1 size = 1, 2 /\n"

static const double *series(const small_run *r, const char *name) {
  const double *values;
  const int k = small_series(r, name);
  assert_true(k >= 0);
  simulation_series(r->simulation, k, NULL, &values);
  return values;
}

static void assert_unit(const small_run *r, const char *name, const char *expected) {
  const char *found;
  simulation_series(r->simulation, small_series(r, name), &found, NULL);
  assert_string_equal(found, expected);
}

/* --- motion ----------------------------------------------------------------------------------- */

/* A free body in a constant force and gravity: Newton's second law, at each sample, and the parts
   make up the whole. */
static void momentum_is_what_forces_have_given(void **state) {
  (void)state;
  small_run r;
  must_open(&r, &elastic_beam,
            "&simulation end_time = 2e-4 /\n" BLOCK
            "&force region = 'left' component = 'x' total = 300 /\n"
            "&gravity acceleration = 0, -50 /\n"
            "&monitor name = 'px' kind = 'momentum' component = 'x' /\n"
            "&monitor name = 'py' kind = 'momentum' component = 'y' /\n"
            "&monitor name = 'left' kind = 'momentum' component = 'x' region = 'left' /\n"
            "&monitor name = 'right' kind = 'momentum' component = 'x' region = 'right' /\n"
            "&monitor name = 'kinetic' kind = 'energy' component = 'kinetic' /\n"
            "&monitor name = 'stored' kind = 'energy' component = 'stored' /\n"
            "&monitor name = 's_left' kind = 'energy' component = 'stored' region = 'left' /\n"
            "&monitor name = 's_right' kind = 'energy' component = 'stored' region = 'right' /\n"
            "&output frames = 0 sample = 1e-5 /\n");
  const rows *g = simulation_rows(r.simulation, 0);
  const double mass = g->mass * (double)g->particle_count;
  assert_int_equal(small_go(&r), STEP_END);
  const double *time, *px = series(&r, "px"), *py = series(&r, "py"), *left = series(&r, "left"),
                      *right = series(&r, "right"), *kinetic = series(&r, "kinetic"),
                      *stored = series(&r, "stored");
  const long samples = simulation_history(r.simulation, &time);
  assert_true(samples > 20);
  const double most = 300 * time[samples - 1], energy = small_largest(&r, "energy/kinetic"),
               held = small_largest(&r, "energy/stored");
  assert_true(energy > 1e-6 && held > 1e-6);
  for (long k = 0; k < samples; k++) {
    assert_true(fabs(px[k] - 300 * time[k]) < 1e-12 * most);
    assert_true(fabs(py[k] + 50 * mass * time[k]) < 1e-12 * mass * 50 * time[samples - 1]);
    assert_true(fabs(left[k] + right[k] - px[k]) < 1e-13 * most);
    assert_true(fabs(kinetic[k] - series(&r, "energy/kinetic")[k]) < 1e-12 * energy);
    assert_true(fabs(stored[k] - series(&r, "energy/stored")[k]) < 1e-12 * held);
    assert_true(fabs(series(&r, "s_left")[k] + series(&r, "s_right")[k] - stored[k]) <
                1e-12 * held);
  }
  assert_unit(&r, "px", "N*s");
  assert_unit(&r, "kinetic", "J");
  small_close(&r);
}

/* In a force that changes: largest error of the momentum over the last one. */
static double momentum_error(double step) {
  char text[2048];
  small_run r;
  snprintf(text, sizeof text,
           "&simulation end_time = 6.4e-5 step = %.17g /\n" BLOCK
           "&force region = 'left' component = 'x' total = 300 history = 'cosine' "
           "rise = 6.4e-5 /\n"
           "&monitor name = 'p' kind = 'momentum' component = 'x' /\n"
           "&output frames = 0 sample = 1.6e-5 /\n",
           step);
  must_open(&r, &elastic_beam, text);
  assert_int_equal(small_go(&r), STEP_END);
  const double w = M_PI / 6.4e-5, *time, *p = series(&r, "p");
  const long samples = simulation_history(r.simulation, &time);
  double worst = 0;
  for (long k = 0; k < samples; k++)
    worst = fmax(worst, fabs(p[k] - 150 * (time[k] - sin(w * time[k]) / w)));
  const double last = p[samples - 1];
  small_close(&r);
  return worst / last;
}

static void momentum_is_of_the_second_order(void **state) {
  (void)state;
  double before = momentum_error(1.6e-6);
  for (int k = 1; k < 3; k++) {
    const double error = momentum_error(1.6e-6 / (1 << k));
    assert_true(before / error > 3.95 && before / error < 4.05);
    before = error;
  }
  assert_true(before < 1e-4);
}

/* In the monitor's own unit. */
static void a_stop_looks_at_them(void **state) {
  (void)state;
  small_run r;
  must_open(&r, &elastic_beam,
            "&simulation end_time = 2e-4 /\n" BLOCK
            "&force region = 'left' component = 'x' total = 300 /\n"
            "&monitor name = 'p' kind = 'momentum' component = 'x' /\n"
            "&monitor name = 'a' kind = 'acceleration' component = 'rotation' region = 'left' /\n"
            "&stop monitor = 'p' above = '0.0265 N*s' /\n"
            "&stop monitor = 'a' above = '1e30 rad/s^2' /\n"
            "&output frames = 0 sample = 1e-5 /\n");
  assert_int_equal(small_go(&r), STEP_STOPPED);
  assert_true(fabs(small_last(&r, "p") - 0.027) < 3e-4);
  assert_unit(&r, "a", "rad/s^2");
  small_close(&r);
}

/* A free body that turns and vibrates: about any place, with what its particles turn by
   themselves. Steps conserve it exactly. */
static void angular_momentum_stays(void **state) {
  (void)state;
  for (int beams = 0; beams < 2; beams++) {
    small_run r;
    must_open(&r, beams ? &elastic_beam : &elastic_bar,
              "&simulation end_time = 2e-4 /\n" BLOCK
              "&monitor name = 'L' kind = 'angular_momentum' about = 0.3, -0.2 component = 'z' /\n"
              "&monitor name = 'p' kind = 'momentum' component = 'y' /\n"
              "&output frames = 0 sample = 1e-5 /\n");
    body *b = simulation_state(r.simulation, 0)->body;
    const rows *g = b->lattice;
    double expected = 0;
    for (long p = 0; p < g->particle_count; p++) {
      const long q = g->particle_site[p];
      const double x = g->x[q] - 0.3, y = g->y[q] + 0.2;
      b->velocity[0][q] = -40 * y + 0.3 * sin(200 * x);
      b->velocity[1][q] = 40 * x + 0.2 * cos(150 * y);
      if (beams) b->velocity[2][q] = 40 + 30 * sin(100 * x);
      expected += b->mass[0] * (x * b->velocity[1][q] - y * b->velocity[0][q]);
      if (beams) expected += b->mass[2] * b->velocity[2][q];
    }
    assert_int_equal(small_go(&r), STEP_END);
    const double *L = series(&r, "L");
    for (long k = 0; k < simulation_history(r.simulation, NULL); k++)
      assert_true(fabs(L[k] - expected) < 1e-12 * fabs(expected));
    assert_unit(&r, "L", "N*m*s");
    small_close(&r);
  }
}

/* What a region is given by a drive, at the place and in the mean: of the second order. */
static double acceleration_error(double step, double *mean_error) {
  char text[2048];
  small_run r;
  snprintf(text, sizeof text,
           "&simulation end_time = 6.4e-5 step = %.17g /\n" BLOCK
           "&drive region = 'left' component = 'x' displacement = 1e-5 history = 'cosine' "
           "rise = 6.4e-5 /\n"
           "&monitor name = 'a' kind = 'acceleration' component = 'x' at = 0.02, 0.02 /\n"
           "&monitor name = 'all' kind = 'acceleration' component = 'x' region = 'left' /\n"
           "&monitor name = 'mean' kind = 'acceleration' component = 'x' region = 'left' "
           "average = 8e-6 /\n"
           "&output frames = 0 sample = 1.6e-5 /\n",
           step);
  must_open(&r, &elastic_beam, text);
  assert_int_equal(small_go(&r), STEP_END);
  const double w = M_PI / 6.4e-5, size = 0.5e-5 * w * w, *time, *a = series(&r, "a"),
               *mean = series(&r, "mean");
  double worst = 0;
  *mean_error = 0;
  assert_true(simulation_history(r.simulation, &time) == 5);
  for (int k = 1; k < 4; k++) {
    const double from = w * (time[k] + step / 2 - 8e-6), to = w * (time[k] + step / 2);
    const double slope = size / w * (sin(to) - sin(from)) / 8e-6; /* over the states of the mean */
    worst = fmax(worst, fabs(a[k] / size - cos(w * time[k])));
    *mean_error = fmax(*mean_error, fabs(mean[k] - slope) / size);
    assert_true(fabs(series(&r, "all")[k] - a[k]) < 1e-9 * size);
  }
  assert_unit(&r, "a", "m/s^2");
  small_close(&r);
  return worst;
}

static void accelerations_are_of_the_second_order(void **state) {
  (void)state;
  double means[3], errors[3];
  for (int k = 0; k < 3; k++)
    errors[k] = acceleration_error(8e-7 / (1 << k), &means[k]);
  for (int k = 1; k < 3; k++) {
    assert_true(errors[k - 1] / errors[k] > 3.9 && errors[k - 1] / errors[k] < 4.1);
    assert_true(means[k - 1] / means[k] > 3.8 && means[k - 1] / means[k] < 4.2);
  }
  assert_true(errors[2] < 1e-4);
}

/* Free fall, and free particles in a force. */
static void a_free_body_falls_as_gravity_says(void **state) {
  (void)state;
  small_run r;
  must_open(&r, &elastic_beam,
            "&simulation end_time = 1e-4 /\n" BLOCK "&gravity acceleration = 3, -50 /\n"
            "&monitor name = 'now' kind = 'acceleration' component = 'y' region = 'left' /\n"
            "&monitor name = 'mean' kind = 'acceleration' component = 'x' at = 0, 0 "
            "average = 1e-5 /\n&output frames = 0 sample = 1e-5 /\n");
  assert_int_equal(small_go(&r), STEP_END);
  for (long k = 0; k < simulation_history(r.simulation, NULL); k++) {
    assert_true(fabs(series(&r, "now")[k] + 50) < 1e-9 * 50);
    assert_true(fabs(series(&r, "mean")[k] - 3) < 1e-9 * 3);
  }
  small_close(&r);
}

/* --- statics ---------------------------------------------------------------------------------- */

/* A strip pulled at its ends, at rest: any section carries the load, and stresses times volumes the
   load times the length (virtual work). */
static void a_section_carries_the_load(void **state) {
  (void)state;
  small_run r;
  must_open(
      &r, &elastic_beam,
      "&simulation end_time = 1 /\n&relaxation increments = 2 tolerance = 1e-9 /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 "
      "mass_thickness = 0.2 /\n&material lattice = 'c' model = 'm' /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.12, 0.07 /\n"
      "&region name = 'left' shape = 'rectangle' corner = -0.001, -1 size = 0.002, 2 /\n"
      "&region name = 'right' shape = 'rectangle' corner = 0.119, -1 size = 0.002, 2 /\n"
      "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"
      "&region name = 'corner' shape = 'point' at = 0, 0 /\n"
      "&support region = 'left' fix = 'x' /\n&support region = 'corner' fix = 'y' /\n"
      "&drive region = 'right' component = 'x' displacement = 1e-6 /\n"
      "&monitor name = 'load' kind = 'reaction' region = 'right' component = 'x' /\n"
      "&monitor name = 'mid' kind = 'force' at = 0.0512, 0 normal = 3, 0 /\n"
      "&monitor name = 'back' kind = 'force' at = 0.0512, 0 normal = -1, 0 component = 'x' /\n"
      "&monitor name = 'oblique' kind = 'force' at = 0.06, 0.03 normal = 1, 0.5 component = 'x' /\n"
      "&monitor name = 'across' kind = 'force' at = 0.06, 0.03 normal = 1, 0.5 component = 'y' /\n"
      "&monitor name = 'sigma' kind = 'stress' region = 'all' component = 'xx' /\n"
      "&monitor name = 'tau' kind = 'stress' region = 'all' component = 'xy' /\n"
      "&monitor name = 'eps' kind = 'strain' at = 0.06, 0.034 component = 'xx' /\n"
      "&output frames = 0 /\n");
  const rows *g = simulation_rows(r.simulation, 0);
  assert_int_equal(small_go(&r), STEP_END);
  const double load = small_last(&r, "load"), volume = g->volume / 2 * (double)g->particle_count;
  assert_true(load > 100);
  assert_true(fabs(small_last(&r, "mid") - load) < 1e-7 * load);
  assert_true(fabs(small_last(&r, "back") + load) < 1e-7 * load);
  assert_true(fabs(small_last(&r, "oblique") - load) < 1e-7 * load);
  assert_true(fabs(small_last(&r, "across")) < 1e-7 * load);
  assert_true(fabs(small_last(&r, "sigma") * volume - load * 0.12) < 1e-5 * load * 0.12);
  assert_true(fabs(small_last(&r, "tau")) < 1e-5 * small_last(&r, "sigma"));
  assert_true(fabs(small_last(&r, "eps") * 0.12 / 1e-6 - 1) < 0.1);
  assert_unit(&r, "sigma", "Pa");
  assert_unit(&r, "mid", "N");
  small_close(&r);
}

/* --- crack tips ------------------------------------------------------------------------------- */

/* A row of particles that hardly feel their bonds and fly apart, so that bond k comes to a damage
   of 0.5 half a step before state k + 1. */
static void the_tip_is_the_furthest_damaged_bond(void **state) {
  (void)state;
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-5 step = 1e-7 /\n" CHAIN
           "&material lattice = 'c' model = 'm' E = 1e-3 S_t = 1e-4 /\n"
           "&region name = 'near' shape = 'rectangle' corner = -1, -1 size = 1.0401, 2 /\n"
           "&monitor name = 'way' kind = 'tip' at = -0.02, 0 direction = 2, 0 above = 0.5 /\n"
           "&monitor name = 'near' kind = 'tip' at = 0, 0 direction = 1, 0 above = 0.5 "
           "region = 'near' /\n"
           "&monitor name = 'back' kind = 'tip' at = 0.1, 0 direction = -1, 0 above = 0.5 /\n"
           "&monitor name = 'mean' kind = 'tip' at = 0, 0 direction = 1, 0 above = 0.5 "
           "average = 2e-7 /\n"
           "&monitor name = 'speed' kind = 'tip_speed' at = 0, 0 direction = 1, 0 above = 0.5 "
           "average = 3e-7 /\n"
           "&output frames = 0 sample = 1e-7 energy = .false. /\n",
           9 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  const body *b = simulation_state(r.simulation, 0)->body;
  assert_int_equal(b->lattice->bond_count, 9);
  double v = 0;
  for (int k = 0; k < 10; k++) {
    b->velocity[0][b->lattice->particle_site[k]] = v;
    v += 1.5e-4 * SPACING / ((k + 0.5) * 1e-7);
  }
  assert_int_equal(simulation_advance(r.simulation, 6, NULL), STEP_OK);
  const double *way = series(&r, "way"), *near = series(&r, "near"), *back = series(&r, "back"),
               *mean = series(&r, "mean"), *speed = series(&r, "speed");
  assert_true(simulation_history(r.simulation, NULL) == 7);
  for (int k = 1; k < 7; k++) {
    const double tip = (k - 0.5) * SPACING;
    assert_true(fabs(way[k] - tip - 0.02) < 1e-15);
    assert_true(fabs(near[k] - fmin(tip, 4.5 * SPACING)) < 1e-15);
    assert_true(fabs(back[k] - 0.095) < 1e-15); /* the first bond */
    if (k > 1) assert_true(fabs(mean[k] - tip + 0.5 * SPACING) < 1e-15);
    if (k > 3) assert_true(fabs(speed[k] * 1e-7 / SPACING - 1) < 1e-9);
  }
  assert_unit(&r, "way", "m");
  assert_unit(&r, "speed", "m/s");
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(momentum_is_what_forces_have_given),
      cmocka_unit_test(momentum_is_of_the_second_order),
      cmocka_unit_test(a_stop_looks_at_them),
      cmocka_unit_test(angular_momentum_stays),
      cmocka_unit_test(accelerations_are_of_the_second_order),
      cmocka_unit_test(a_free_body_falls_as_gravity_says),
      cmocka_unit_test(a_section_carries_the_load),
      cmocka_unit_test(the_tip_is_the_furthest_damaged_bond),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
