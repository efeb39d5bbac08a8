/* Runs against closed forms: oscillator, chain, cantilever. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/sweep.h"
#include "tests/runtime/simulation/chain.h"

/* Frequency of a free pair of particles: sqrt(2 k/m). Displacements of a leapfrog oscillator lie on
   a sine exactly: u(n+1) + u(n-1) = 2 cos(omega' dt) u(n). */
static double measured_frequency(double step) {
  char text[1024];
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-3 step = %.17g /\n" CHAIN
           "&material lattice = 'c' model = 'm' /\n"
           "&output energy = .false. frames = 0 /\n",
           step, 1.0 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  sweep *w = simulation_state(r.simulation, 0);
  assert_int_equal(w->body->lattice->particle_count, 2);
  const double *u = &w->body->displacement[0][w->body->lattice->particle_site[1]];
  w->body->velocity[0][w->body->lattice->particle_site[0]] = -1e-3;
  w->body->velocity[0][w->body->lattice->particle_site[1]] = 1e-3;
  double last[3] = {0};
  while (simulation_step_done(r.simulation) < 10 || fabs(last[1]) < 0.5 * 1e-3 * 2e-6) {
    simulation_advance(r.simulation, 1, NULL);
    memmove(last, last + 1, 2 * sizeof *last);
    last[2] = *u;
  }
  small_close(&r);
  return acos((last[0] + last[2]) / (2 * last[1])) / step;
}

static void a_pair_oscillates_as_theory_says(void **state) {
  (void)state;
  const double omega = sqrt(2 * rigidity_axial(0.2) / SPACING / particle_mass());
  const double coarse = measured_frequency(0.2 / omega), fine = measured_frequency(0.1 / omega);
  /* leapfrog: sin(omega' dt/2) = omega dt/2 */
  assert_true(fabs(coarse * 0.2 / omega / 2 - asin(0.1)) < 1e-10);
  assert_true(fabs(fine * 0.1 / omega / 2 - asin(0.05)) < 1e-10);
  const double ratio = (coarse - omega) / (fine - omega);
  assert_true(ratio > 3.98 && ratio < 4.04); /* second order */
}

/* A chain of bars under a force at its end: F L/EA, reaction -F. */
static void a_chain_stretches_by_its_closed_form(void **state) {
  (void)state;
  char text[2048];
  snprintf(
      text, sizeof text,
      "&simulation end_time = 4e-3 step_safety = 0.5 /\n" CHAIN
      "&material lattice = 'c' model = 'm' /\n" POINT("left", "0", "0") POINT(
          "right", "0.05",
          "0") "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"
               "&support region = 'left' fix = 'x' /\n&support region = 'all' fix = 'y' /\n"
               "&force region = 'right' component = 'x' total = '1 kN' history = 'cosine' rise = "
               "'1 ms' /\n"
               "&damping rate = '40000 1/s' /\n"
               "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' /\n"
               "&monitor name = 'tip' kind = 'displacement' region = 'right' component = 'x' /\n"
               "&output frames = 0 /\n",
      5 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  assert_int_equal(small_go(&r), STEP_END);
  assert_true(fabs(small_last(&r, "load") / -1000 - 1) < 1e-9);
  assert_true(fabs(small_last(&r, "tip") / (1000 * 5 * SPACING / rigidity_axial(0.2)) - 1) < 1e-9);
  /* what the force did is stored or damped away; linear and on its axis: the ledger closes to
   * rounding */
  assert_true(fabs(small_last(&r, "energy/imbalance")) < 1e-10 * small_last(&r, "energy/external"));
  assert_true(fabs(small_last(&r, "energy/stored") / (0.5 * 1000 * small_last(&r, "tip")) - 1) <
              1e-9);
  assert_true(small_last(&r, "energy/dissipated_damping") > 0);
  small_close(&r);
}

/* A chain of beams clamped at one end: F L^3/(3 EI) and the clamp's reactions. */
static void a_cantilever_bends_by_its_closed_form(void **state) {
  (void)state;
  const double L = 4 * SPACING,
               force = 1; /* N: deflection 1e-7 of L, so that geometry stays linear */
  char text[2048];
  snprintf(
      text, sizeof text,
      "&simulation end_time = 0.03 step_safety = 0.9 /\n" CHAIN
      "&material lattice = 'c' model = 'm' /\n" POINT("left", "0", "0") POINT(
          "right", "0.04",
          "0") "&support region = 'left' fix = 'x', 'y', 'rotation' /\n"
               "&force region = 'right' component = 'y' total = %g history = 'cosine' rise = '10 "
               "ms' /\n"
               "&damping rate = '8000 1/s' /\n"
               "&monitor name = 'shear' kind = 'reaction' region = 'left' component = 'y' /\n"
               "&monitor name = 'moment' kind = 'reaction' region = 'left' component = 'rotation' "
               "/\n"
               "&monitor name = 'tip' kind = 'displacement' region = 'right' component = 'y' /\n"
               "&monitor name = 'turn' kind = 'displacement' region = 'right' component = "
               "'rotation' /\n"
               "&output frames = 0 /\n",
      L, force);
  small_run r;
  must_open(&r, &elastic_beam, text);
  assert_int_equal(small_go(&r), STEP_END);
  const double EI = rigidity_bending(0.2);
  assert_true(fabs(small_last(&r, "tip") / (force * L * L * L / (3 * EI)) - 1) < 1e-6);
  assert_true(fabs(small_last(&r, "turn") / (force * L * L / (2 * EI)) - 1) < 1e-6);
  assert_true(fabs(small_last(&r, "shear") / -force - 1) < 1e-6);
  assert_true(fabs(small_last(&r, "moment") / (-force * L) - 1) < 1e-6);
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_pair_oscillates_as_theory_says),
      cmocka_unit_test(a_chain_stretches_by_its_closed_form),
      cmocka_unit_test(a_cantilever_bends_by_its_closed_form),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
