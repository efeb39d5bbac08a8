/* Point masses: natural frequencies of what carries them against closed forms, momentum, weight,
   energies, and the step, which they do not shorten. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/runtime/simulation/chain.h"

/* --- a mass at the end of a bar --------------------------------------------------------------- */

#define LENGTH 0.2

/* beta L of the first mode of a clamped bar of mass m with a mass M at its end:
   beta L tan(beta L) = m/M */
static double first_mode(double bar_over_end) {
  double low = 0, high = acos(-1) / 2;
  for (int k = 0; k < 100; k++) {
    const double middle = (low + high) / 2;
    *(middle * tan(middle) < bar_over_end ? &low : &high) = middle;
  }
  return low;
}

/* Let go in its first mode: after how long the end is where it began to swing, of a chain of so
   many bonds, over a quarter of the period. Its last particle stands for half a spacing beyond the
   end, too, which is as much more of the mass there. */
static double quarter_error(int bonds, double carried, double *frequency) {
  const double s = LENGTH / bonds, E = 30e9, rho = 2323, area = sqrt(3) / 2 * s * THICKNESS;
  const double EA = E * s * THICKNESS / (sqrt(3) * (1 - 0.2));
  const double bar = rho * area * LENGTH, end = carried * bar + rho * area * s / 2;
  const double beta = first_mode(bar / end) / LENGTH, omega = beta * sqrt(EA / (rho * area)),
               quarter = acos(-1) / (2 * omega);
  char text[4096];
  snprintf(text, sizeof text,
           "&simulation end_time = %.17g step = %.17g /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = %.17g thickness = 0.1 /\n"
           "&body lattice = 'c' shape = 'rectangle' corner = 0, -0.001 size = %g, 0.002 /\n"
           "&material lattice = 'c' model = 'm' /\n" POINT("left", "0", "0") POINT(
               "right", "0.2", "0") "&region name = 'all' shape = 'rectangle' corner = -1, -1 size "
                                    "= 2, 2 /\n"
                                    "&point_mass region = 'right' mass = %.17g /\n"
                                    "&support region = 'left' fix = 'x' /\n"
                                    "&initial_displacement region = 'all' component = 'x' value = "
                                    "'1e-6 [m]*sin(%.17g [1/m]*x)' /\n"
                                    "&monitor name = 'u' kind = 'displacement' region = 'right' "
                                    "component = 'x' /\n&output frames = 0 sample = %.17g /\n",
           1.2 * quarter, quarter / 20000, s, LENGTH, carried * bar, beta, quarter / 20000);
  small_run r;
  must_open(&r, &elastic_bar, text);
  assert_int_equal(small_go(&r), STEP_END);
  const double *time, *u;
  const long samples = simulation_history(r.simulation, &time);
  simulation_series(r.simulation, small_series(&r, "u"), NULL, &u);
  long k = 1;
  while (k < samples - 1 && u[k] > 0)
    k++;
  const double crossing = time[k - 1] + (time[k] - time[k - 1]) * u[k - 1] / (u[k - 1] - u[k]);
  small_close(&r);
  *frequency = omega;
  return fabs(crossing / quarter - 1);
}

/* Of a mass much heavier than the bar omega^2 = E A/(L M). */
static void a_mass_on_a_bar_has_its_frequency(void **state) {
  (void)state;
  static const double carried[] = {1, 3};
  for (int n = 0; n < 2; n++) {
    double omega;
    const double coarse = quarter_error(4, carried[n], &omega),
                 fine = quarter_error(8, carried[n], &omega);
    print_message("%g of the bar's mass: error of the period %.2e, %.2e\n", carried[n], coarse,
                  fine);
    assert_true(coarse < 5e-3 && fine < coarse / 3.5);
  }
  double omega;
  const double s = LENGTH / 4, m = 2323 * sqrt(3) / 2 * s * THICKNESS * LENGTH,
               EA = 30e9 * s * THICKNESS / (sqrt(3) * (1 - 0.2));
  assert_true(quarter_error(4, 1000, &omega) < 1e-5);
  assert_true(fabs(omega / sqrt(EA / (LENGTH * 1000 * m)) - 1) < 3e-4);
}

/* --- two particles ---------------------------------------------------------------------------- */

#define TWO                                                                                        \
  "&simulation end_time = 1e-4 step = 1e-7 /\n" CHAIN                                              \
  "&material lattice = 'c' model = 'm' /\n" POINT("left", "0", "0") POINT("right", "0.01", "0")    \
      POINT("other right", "0.01", "0")

static void open_two(small_run *r, const pl_law *law, const char *more) {
  char text[4096];
  const int n = snprintf(text, sizeof text, TWO, 1 * SPACING);
  snprintf(text + n, sizeof text - (size_t)n, "%s", more);
  must_open(r, law, text);
}

/* The heavy particle goes on at its speed less what the light one takes: momentum, and the swing of
   their distance with the reduced mass, six times: a step's phase is (omega dt)^2/24 too fast. */
static void momentum_and_energy_have_the_mass(void **state) {
  (void)state;
  const double m = particle_mass(), M = 4 * m, v = 3;
  char more[2048];
  snprintf(more, sizeof more,
           "&region name = 'both' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"
           "&point_mass region = 'right' mass = %.17g /\n"
           "&point_mass region = 'other right' total = %.17g /\n"
           "&initial_velocity region = 'right' component = 'x' value = 3 /\n"
           "&monitor name = 'p' kind = 'momentum' component = 'x' /\n"
           "&monitor name = 'left' kind = 'momentum' region = 'left' component = 'x' /\n"
           "&output frames = 0 sample = 1e-7 /\n",
           M / 2, M / 2);
  small_run r;
  open_two(&r, &elastic_bar, more);
  assert_int_equal(small_go(&r), STEP_END);
  const double *time, *p, *left;
  const long samples = simulation_history(r.simulation, &time);
  simulation_series(r.simulation, small_series(&r, "p"), NULL, &p);
  simulation_series(r.simulation, small_series(&r, "left"), NULL, &left);
  const double k = rigidity_axial(0.2) / SPACING, mean = (m + M) * v / (m + m + M);
  const double omega = sqrt(k * (1 / m + 1 / (m + M)));
  for (long n = 0; n < samples; n++) {
    assert_true(fabs(p[n] / ((m + M) * v) - 1) < 1e-13);
    assert_true(fabs(left[n] - m * mean * (1 - cos(omega * time[n]))) < 3e-3 * m * mean);
  }
  assert_true(fabs(small_largest(&r, "energy/imbalance")) < 1e-3 * (m + M) * v * v / 2);
  small_close(&r);
}

static void weight_grows_with_the_mass(void **state) {
  (void)state;
  const double m = particle_mass();
  char more[2048];
  snprintf(more, sizeof more,
           "&point_mass region = 'right' mass = %.17g /\n&gravity acceleration = 9, 0 /\n"
           "&monitor name = 'p' kind = 'momentum' component = 'x' /\n"
           "&monitor name = 'v' kind = 'velocity' region = 'left' component = 'x' /\n"
           "&output frames = 0 /\n",
           7 * m);
  small_run r;
  open_two(&r, &elastic_bar, more);
  assert_int_equal(small_go(&r), STEP_END);
  const double t = simulation_time(r.simulation);
  assert_true(fabs(small_last(&r, "p") / (9 * m * 9 * t) - 1) < 1e-10);
  assert_true(fabs(small_last(&r, "v") / (9 * t) - 1) < 1e-6);
  assert_true(fabs(small_last(&r, "energy/external") / (9 * m * 81 * t * t / 2) - 1) < 1e-6);
  small_close(&r);
}

/* A particle that only turns, on a beam whose other end is clamped: omega^2 = 4 E I/(s J). */
static void inertia_slows_the_turning(void **state) {
  (void)state;
  const double J = 2.0 / 5 * particle_mass() * SPACING * SPACING / 4, more_inertia = 8 * J;
  const double omega = sqrt(4 * rigidity_bending(0.2) / (SPACING * (J + more_inertia)));
  char more[2048];
  snprintf(more, sizeof more,
           "&point_mass region = 'right' mass = 1e-9 inertia = %.17g /\n"
           "&support region = 'left' fix = 'xy', 'rotation' /\n&support region = 'right' fix = "
           "'xy' /\n"
           "&initial_displacement region = 'right' component = 'rotation' value = 1e-5 /\n"
           "&monitor name = 'turn' kind = 'displacement' region = 'right' component = 'rotation' "
           "/\n&output frames = 0 sample = 1e-7 /\n",
           more_inertia);
  small_run r;
  open_two(&r, &elastic_beam, more);
  assert_int_equal(small_go(&r), STEP_END);
  const double *time, *turn;
  const long samples = simulation_history(r.simulation, &time);
  simulation_series(r.simulation, small_series(&r, "turn"), NULL, &turn);
  for (long n = 0; n < samples; n++)
    assert_true(fabs(turn[n] - 1e-5 * cos(omega * time[n])) < 1e-3 * 1e-5);
  small_close(&r);
}

/* What is heavier swings more slowly: the step is that of the body without. */
static void the_stable_step_stays(void **state) {
  (void)state;
  small_run r;
  open_two(&r, &elastic_bar, "&output frames = 0 /\n");
  const double without = simulation_step_limit(r.simulation)->limit;
  small_close(&r);
  open_two(&r, &elastic_bar, "&point_mass region = 'right' mass = 2 /\n&output frames = 0 /\n");
  assert_true(simulation_step_limit(r.simulation)->limit == without);
  long particles;
  assert_true(simulation_point_mass(r.simulation, 0, &particles) == 2);
  assert_int_equal(particles, 1);
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_mass_on_a_bar_has_its_frequency),
                                     cmocka_unit_test(momentum_and_energy_have_the_mass),
                                     cmocka_unit_test(weight_grows_with_the_mass),
                                     cmocka_unit_test(inertia_slows_the_turning),
                                     cmocka_unit_test(the_stable_step_stays)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
