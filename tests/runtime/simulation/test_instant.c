/* What stands at a sample, and in a frame, is of one instant: places, forces, damage, reactions,
   energies. Windows and zeros look at the states that they say. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/sweep.h"
#include "tests/runtime/family_law.h"
#include "tests/runtime/small_run.h"
#include "tests/runtime/spring_law.h"

#define SPACING   0.01
#define THICKNESS 0.1
#define S_T       1e-4
#define STEP      1e-7

/* A bar that is drawn out evenly until it has broken; both ends move at constant velocity, so that
   reactions are its force. */
#define DRAWN                                                                                      \
  "&simulation end_time = 3e-5 step = 1e-7 /\n"                                                    \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"                      \
  "&material lattice = 'c' model = 'm' S_t = 1e-4 /\n"                                             \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, -0.001 size = 0.01, 0.002 /\n"              \
  "&region name = 'left' shape = 'point' at = 0, 0 /\n"                                            \
  "&region name = 'right' shape = 'point' at = 0.01, 0 /\n"                                        \
  "&support region = 'left' fix = 'x' /\n"                                                         \
  "&drive region = 'right' component = 'x' velocity = 0.1 /\n"                                     \
  "&monitor name = 'u' kind = 'opening' between = 'left', 'right' component = 'x' /\n"             \
  "&monitor name = 'held' kind = 'reaction' region = 'left' component = 'x' /\n"                   \
  "&monitor name = 'drawn' kind = 'reaction' region = 'right' component = 'x' /\n"                 \
  "&monitor name = 'speed' kind = 'velocity' region = 'right' component = 'x' /\n"                 \
  "&monitor name = 'cracked' kind = 'damaged' /\n"                                                 \
  "&monitor name = 'broken' kind = 'broken' /\n"                                                   \
  "&monitor name = 'mean_held' kind = 'reaction' region = 'left' component = 'x' average = 5e-7 "  \
  "/\n"                                                                                            \
  "&monitor name = 'mean_u' kind = 'opening' between = 'left', 'right' component = 'x' average = " \
  "5e-7 /\n"                                                                                       \
  "&monitor name = 'mean_speed' kind = 'velocity' region = 'right' component = 'x' average = "     \
  "5e-7 /\n"                                                                                       \
  "&monitor name = 'from_10' kind = 'reaction' region = 'left' component = 'x' zero_at = 1e-6 /\n"

static small_run drawn(const char *more) {
  char text[4096];
  small_run r;
  snprintf(text, sizeof text, DRAWN "%s", more);
  small_open(&r, &elastic_bar, text);
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  return r;
}

static double rigidity(void) {
  return 30e9 * SPACING * THICKNESS / (sqrt(3) * (1 - 0.2));
}

static double damage_at(double u) {
  return fmin(1, fmax(0, (u / SPACING - S_T) / S_T));
}

static double force_at(double u) {
  return (1 - damage_at(u)) * rigidity() * u / SPACING;
}

static const double *series(const small_run *r, const char *name) {
  const double *values;
  assert_true(small_series(r, name) >= 0);
  simulation_series(r->simulation, small_series(r, name), NULL, &values);
  return values;
}

static void near(double got, double expected, double size) {
  if (!(fabs(got - expected) <= 1e-9 * size)) fail_msg("%.12g instead of %.12g", got, expected);
}

static void a_sample_is_of_one_instant(void **state) {
  (void)state;
  small_run r = drawn("&output frames = 0 sample = 1e-7 /\n");
  assert_int_equal(small_go(&r), STEP_END);
  const double *time, *u = series(&r, "u"), peak = rigidity() * S_T;
  const long samples = simulation_history(r.simulation, &time);
  const double *kept = series(&r, "energy/stored"), *lost = series(&r, "energy/dissipated_damage");
  assert_int_equal(samples, 301);
  double dissipated = 0;
  for (long n = 0; n < samples; n++) {
    near(u[n], 0.1 * time[n], 1e-6);
    near(series(&r, "held")[n], -force_at(u[n]), peak);
    near(series(&r, "drawn")[n], force_at(u[n]), peak);
    near(series(&r, "speed")[n], 0.1, 0.1);
    if (fabs(damage_at(u[n]) - 0.5) < 0.5 - 1e-9 || n < 90) /* not at the corners */
      assert_true(series(&r, "cracked")[n] == (damage_at(u[n]) > 0));
    if (n != 200) assert_true(series(&r, "broken")[n] == (damage_at(u[n]) >= 1));
    const double whole = 0.5 * rigidity() / SPACING * u[n] * u[n];
    near(kept[n], (1 - damage_at(u[n])) * whole, 1e-4);
    if (n > 0) dissipated += (damage_at(u[n]) - damage_at(u[n - 1])) * whole;
    near(lost[n], dissipated, 1e-4);
  }
  assert_true(u[samples - 1] > 2.9e-6); /* it has broken */
  small_close(&r);
}

/* Of the last five states, the present one included; the mean of velocities is way over time. */
static void a_window_ends_at_the_sample(void **state) {
  (void)state;
  small_run r = drawn("&output frames = 0 sample = 1e-7 /\n");
  assert_int_equal(small_go(&r), STEP_END);
  const double *u = series(&r, "u"), peak = rigidity() * S_T;
  for (long n = 0; n < simulation_history(r.simulation, NULL); n++) {
    double force = 0, way = 0;
    const long first = n < 4 ? 0 : n - 4;
    for (long k = first; k <= n; k++) {
      force += force_at(u[k]) / (double)(n - first + 1);
      way += u[k] / (double)(n - first + 1);
    }
    near(series(&r, "mean_held")[n], -force, peak);
    near(series(&r, "mean_u")[n], way, 1e-6);
    near(series(&r, "mean_speed")[n],
         n == 0 ? 0.1 : (u[n] - u[n < 5 ? 0 : n - 5]) / (STEP * (double)(n < 5 ? n : 5)), 0.1);
    const double zero = n < 10 ? 0 : -force_at(u[10]);
    near(series(&r, "from_10")[n], -force_at(u[n]) - zero, peak);
  }
  small_close(&r);
}

/* The same where samples are far apart: what lies between is looked at all the same. */
static void windows_and_zeros_do_not_need_samples(void **state) {
  (void)state;
  small_run fine = drawn("&output frames = 0 sample = 1e-7 /\n"),
            coarse = drawn("&output frames = 0 sample = 7e-7 /\n");
  assert_int_equal(small_go(&fine), STEP_END);
  assert_int_equal(small_go(&coarse), STEP_END);
  static const char *const names[] = {"u", "held", "mean_held", "mean_u", "mean_speed", "from_10"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++)
    for (long n = 0; n < simulation_history(coarse.simulation, NULL) - 1; n++)
      assert_true(series(&coarse, names[k])[n] == series(&fine, names[k])[7 * n]);
  small_close(&fine);
  small_close(&coarse);
}

static long field_of(const small_run *r, const char *name, bool on_bonds) {
  const frame_field *fields;
  const int count = simulation_frame_fields(r->simulation, &fields);
  for (int k = 0; k < count; k++)
    if (strcmp(fields[k].name, name) == 0 && fields[k].on_bonds == on_bonds) return k;
  return -1;
}

static double frame_value(small_run *r, const char *name, bool on_bonds, int at) {
  double values[8];
  const long field = field_of(r, name, on_bonds);
  assert_true(field >= 0);
  simulation_frame_values(r->simulation, (int)field, values);
  return values[at];
}

static void a_frame_is_of_one_instant(void **state) {
  (void)state;
  small_run r = drawn("&output frames = 0 fields = 'displacement', 'velocity', 'force', 'damage', "
                      "'dissipated', 'axial' /\n");
  const double peak = rigidity() * S_T;
  double dissipated = 0;
  for (int n = 0; n < 250; n += 13) {
    if (n > 0) simulation_advance(r.simulation, 13, NULL);
    const double u = 0.1 * n * STEP;
    near(frame_value(&r, "displacement", false, 2), u, 1e-6);
    near(frame_value(&r, "velocity", false, 2), 0.1, 0.1);
    near(frame_value(&r, "force", false, 0), force_at(u), peak);
    near(frame_value(&r, "omega", true, 0), damage_at(u), 1);
    near(frame_value(&r, "damage", false, 0), damage_at(u), 1);
    near(frame_value(&r, "axial", true, 0), force_at(u), peak);
    for (int k = n > 13 ? n - 12 : 1; k <= n; k++) { /* damage times what is stored without it */
      const double now = 0.1 * k * STEP, grown = damage_at(now) - damage_at(now - 0.1 * STEP);
      dissipated += grown * 0.5 * rigidity() / SPACING * now * now;
    }
    near(frame_value(&r, "dissipated", false, 0) + frame_value(&r, "dissipated", false, 1),
         dissipated, 1e-4);
  }
  small_close(&r);
}

/* --- laws of families ------------------------------------------------------------------------- */

#define FAMILY                                                                                     \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"                      \
  "&material lattice = 'c' model = 'm' S_t = 1e-4 /\n"                                             \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.06 /\n"                     \
  "&region name = 'left' shape = 'rectangle' corner = -1, -1 size = 1.011, 2 /\n"                  \
  "&region name = 'right' shape = 'rectangle' corner = 0.089, -1 size = 1, 2 /\n"                  \
  "&support region = 'left' fix = 'xy' /\n"                                                        \
  "&drive region = 'right' component = 'x' velocity = 2 /\n"

/* Stepped by hand: what a frame says of a state is what the step out of it writes. */
static void damage_of_a_family_is_that_of_its_places(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &family_hexagon,
             "&simulation end_time = 1e-4 /\n" FAMILY "&output frames = 0 /\n");
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  sweep *w = simulation_state(r.simulation, 0);
  const long size = w->body->lattice->size;
  double *seen = must_calloc((size_t)size, sizeof *seen), grown = 0;
  for (int n = 0; n < 60; n++) {
    simulation_advance(r.simulation, 1, NULL);
    sweep_observe(w);
    memcpy(seen, w->new_field[0], (size_t)size * sizeof *seen);
    for (long q = 0; q < size; q++)
      grown = fmax(grown, fabs(w->new_field[0][q] - w->field[0][q]));
    simulation_advance(r.simulation, 1, NULL);
    assert_memory_equal(seen, w->field[0], (size_t)size * sizeof *seen);
  }
  assert_true(grown > 0);
  free(seen);
  small_close(&r);
}

/* A law of families that takes nothing: the imbalance is what steps leave, and falls with their
   square. One that takes something does not say how much: there the imbalance is no number. */
static double spring_imbalance(double safety) {
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = 2e-4 step_safety = %g /\n"
           "&lattice name = 'c' kind = 'fcc' spacing = 0.01 /\n"
           "&material lattice = 'c' model = 'm' /\n"
           "&body lattice = 'c' shape = 'box' corner = 0, 0, 0 size = 0.04, 0.04, 0.04 /\n"
           "&region name = 'foot' shape = 'box' corner = -1, -1, -1 size = 2, 2, 1.001 /\n"
           "&region name = 'top' shape = 'box' corner = -1, -1, 0.035 size = 2, 2, 1 /\n"
           "&support region = 'foot' fix = 'xyz' /\n"
           "&drive region = 'top' component = 'x' velocity = 40 rise = 1e-4 /\n"
           "&output frames = 0 sample = 1e-5 /\n",
           safety);
  small_run r;
  small_open(&r, &springs, text);
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  assert_int_equal(small_go(&r), STEP_END);
  const double external = small_last(&r, "energy/external");
  const char *unchecked;
  assert_true(simulation_imbalance(r.simulation, &unchecked) >= 0 && !unchecked);
  assert_true(small_largest(&r, "energy/dissipated_damage") == 0);
  const double imbalance = small_largest(&r, "energy/imbalance") / external;
  small_close(&r);
  return imbalance;
}

static void what_takes_nothing_is_checked(void **state) {
  (void)state;
  const double coarse = spring_imbalance(0.5), fine = spring_imbalance(0.125);
  print_message("imbalance %.1e, %.1e of the work at 0.5 and 0.125 of the stable step\n", coarse,
                fine);
  assert_true(coarse > 1e-9 && coarse < 1e-2);
  assert_true(fine < coarse / 10);
}

static void what_takes_energy_says_so(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &family_hexagon,
             "&simulation end_time = 2e-5 /\n" FAMILY "&output frames = 0 /\n");
  assert_non_null(r.simulation);
  assert_int_equal(small_go(&r), STEP_END);
  const char *unchecked;
  assert_true(simulation_imbalance(r.simulation, &unchecked) >= 0);
  assert_non_null(unchecked);
  assert_true(isnan(small_last(&r, "energy/imbalance")));
  assert_true(small_last(&r, "energy/external") > 0);
  small_close(&r);
}

/* --- runs that give energy -------------------------------------------------------------------- */

static double limit_of(const pl_law *law, const char *groups) {
  small_run r;
  small_open(&r, law, groups);
  assert_non_null(r.simulation);
  const double limit = simulation_step_limit(r.simulation)->limit;
  small_close(&r);
  return limit;
}

/* Half of the limit, and the limit is taken away from under the run: lighter particles. It is
   stopped at a sample, long before one of them runs away. Just below the limit it goes on, though
   half m v- v+ alone is negative at times. */
static void energy_from_nothing_stops_a_run(void **state) {
  (void)state;
#define THROWN                                                                                     \
  "&lattice name = 'c' kind = 'fcc' spacing = 0.01 /\n&material lattice = 'c' model = 'm' /\n"     \
  "&body lattice = 'c' shape = 'box' corner = 0, 0, 0 size = 0.06, 0.06, 0.06 /\n"                 \
  "&region name = 'one' shape = 'point' at = 0.03, 0.03, 0.03 within = 0.02 /\n"                   \
  "&initial_velocity region = 'one' component = 'x' value = 1e-3 /\n"                              \
  "&output frames = 0 sample = 1e-6 /\n"
  const double limit = limit_of(&springs, "&simulation end_time = 1e-3 /\n" THROWN);
  for (int side = 0; side < 2; side++) {
    char text[2048];
    snprintf(text, sizeof text, "&simulation end_time = %.17g step = %.17g /\n" THROWN,
             3000 * limit, (side == 0 ? 0.98 : 0.5) * limit);
    small_run r;
    small_open(&r, &springs, text);
    if (!r.simulation) small_print(&r);
    assert_non_null(r.simulation);
    sweep *w = simulation_state(r.simulation, 0);
    for (int d = 0; d < 3 && side == 1; d++)
      w->body->mass[d] /= 4.1;
    const step_status status = small_go(&r);
    assert_int_equal(status, side == 0 ? STEP_END : STEP_BAD);
    if (side == 1) {
      const bad_state b = simulation_bad(r.simulation);
      assert_int_equal(b.particle, -1);
      assert_string_equal(b.what, "energy from nothing");
    }
    small_close(&r);
  }
}

/* Weight and drives make half m v- v+ negative where a body turns round: that is no fault. */
static void turning_round_is_no_fault(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &elastic_beam,
             "&simulation end_time = 2e-4 step_safety = 0.98 /\n"
             "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
             "&material lattice = 'c' model = 'm' tau = 1e-7 /\n"
             "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.05, 0.05 /\n"
             "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"
             "&initial_velocity region = 'all' component = 'y' value = 1 /\n"
             "&gravity acceleration = 0, -1e5 /\n&damping rate = 3e4 from = 1e-4 /\n"
             "&output frames = 0 sample = 1e-7 /\n");
  assert_non_null(r.simulation);
  assert_int_equal(small_go(&r), STEP_END);
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_sample_is_of_one_instant),
      cmocka_unit_test(a_window_ends_at_the_sample),
      cmocka_unit_test(windows_and_zeros_do_not_need_samples),
      cmocka_unit_test(a_frame_is_of_one_instant),
      cmocka_unit_test(damage_of_a_family_is_that_of_its_places),
      cmocka_unit_test(what_takes_nothing_is_checked),
      cmocka_unit_test(what_takes_energy_says_so),
      cmocka_unit_test(energy_from_nothing_stops_a_run),
      cmocka_unit_test(turning_round_is_no_fault),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
