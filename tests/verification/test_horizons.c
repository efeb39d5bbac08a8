/* Micropolar concrete with bonds to more than the nearest neighbours: a crack costs what is asked
   for at every horizon, and the strength of a prism hangs less on the lattice's angle. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"
#include "tests/verification/page.h"

/* Two halves are drawn apart as they are, along y: what all bonds between them cost, over the
   area. Their particles do not turn. */
static double cost_of_parting(double horizon, double rotation) {
  deck_case c;
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = '10 ms' step = '5 us' /\n"
           "&lattice name = 'l' kind = 'hexagonal' spacing = '10 mm' thickness = '100 mm' "
           "horizon = %g rotation = %g /\n"
           "&material lattice = 'l' model = 'mplm_concrete' tension = 'energy' G_F = '100 N/m' "
           "zeta = 0 rho = '2.4e6 kg/m^3' /\n"
           "&body lattice = 'l' shape = 'rectangle' corner = '-150 mm', '-40 mm' "
           "size = '300 mm', '80 mm' /\n"
           "&region name = 'lower' shape = 'rectangle' corner = '-160 mm', '-50 mm' "
           "size = '320 mm', '51.3 mm' /\n"
           "&region name = 'upper' shape = 'rectangle' corner = '-160 mm', '1.3 mm' "
           "size = '320 mm', '50 mm' /\n"
           "&support region = 'lower' fix = 'x', 'y', 'rotation' /\n"
           "&support region = 'upper' fix = 'x', 'rotation' /\n"
           "&drive region = 'upper' component = 'y' velocity = '0.2 m/s' /\n"
           "&output losses = .true. /\n",
           horizon, rotation);
  deck_case_open(&c, text);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double cost = deck_case_last(&c, "energy/dissipated_damage") / (0.3 * 0.1);
  deck_case_close(&c);
  return cost;
}

/* In the mean over angles the same at every horizon, but for the parts of shear and curvature; 1.5
   to 2.4 times as much where bonds took what they take of nearest neighbours. */
static void a_crack_costs_the_same_at_every_horizon(void **state) {
  (void)state;
  static const double horizons[] = {1.5, 1.75, 2.1, 2.7, 3.1}, angles[] = {0, 10, 20, 30};
  double mean[5] = {0};
  for (int h = 0; h < 5; h++) {
    for (int a = 0; a < 4; a++)
      mean[h] += cost_of_parting(horizons[h], angles[a]) / 4;
    print_message("horizon %.2f: %.1f N/m, %+.1f %% of that of nearest neighbours\n", horizons[h],
                  mean[h], 100 * (mean[h] / mean[0] - 1));
  }
  for (int h = 1; h < 5; h++)
    assert_true(fabs(mean[h] / mean[0] - 1) < 0.12);
}

/* J, in the first steps of a plate whose rows all move away from each other at the same rate. */
static double taken_by_dampers(double horizon) {
  deck_case c;
  char text[1024];
  snprintf(text, sizeof text,
           "&simulation end_time = '0.5 us' step = '0.1 us' /\n"
           "&lattice name = 'l' kind = 'hexagonal' spacing = '10 mm' thickness = '100 mm' "
           "horizon = %g /\n"
           "&material lattice = 'l' model = 'mplm_concrete' zeta = 0.05 rho = '2400 kg/m^3' /\n"
           "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '1 m', '1 m' /\n"
           "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 3, 3 /\n"
           "&initial_velocity region = 'all' component = 'y' value = '0.1 [1/s]*y' /\n"
           "&output losses = .true. /\n",
           horizon);
  deck_case_open(&c, text);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double taken = deck_case_last(&c, "energy/dissipated_damping");
  deck_case_close(&c);
  return taken;
}

/* Long waves are damped alike: what dampers take of a uniform rate of strain hangs on the horizon
   by the sides alone, which lack bonds. */
static void dampers_take_the_same_at_every_horizon(void **state) {
  (void)state;
  static const double horizons[] = {1.75, 2.1, 2.7, 3.1};
  const double nearest = taken_by_dampers(1.5);
  for (int h = 0; h < 4; h++) {
    const double part = taken_by_dampers(horizons[h]) / nearest;
    print_message("horizon %.2f: dampers take %.3f of what they do with nearest neighbours\n",
                  horizons[h], part);
    assert_true(part > 0.93 && part < 1.01);
  }
}

/* --- strength over the angle ------------------------------------------------------------------ */

static double strength(double horizon, double rotation) {
  char reach[64], turn[64];
  deck_case c;
  const char *overrides[] = {reach, turn, "simulation.threads=1", "output.frames=0"};
  snprintf(reach, sizeof reach, "lattice.horizon=%g", horizon);
  snprintf(turn, sizeof turn, "lattice.rotation=%g", rotation);
  assert_true(deck_case_run(&c, "examples/horizon/tension.nml", overrides, 4));
  deck_case_go(&c);
  double most = 0;
  const double *stress = deck_case_series(&c, "stress");
  for (long k = 0; k < simulation_history(c.simulation, NULL); k++)
    most = fmax(most, stress[k]);
  deck_case_close(&c);
  return 1e-6 * most;
}

/* The largest strength over the smallest of three angles, with the row of the page. */
static double spread(double horizon, const char *row) {
  static const double angles[] = {0, 15, 30};
  double least = INFINITY, most = 0;
  for (int k = 0; k < 3; k++) {
    const double found = strength(horizon, angles[k]);
    char figure[32];
    snprintf(figure, sizeof figure, "| %.2f", found);
    page_line_says("examples/horizon/README.md", row, figure);
    least = fmin(least, found);
    most = fmax(most, found);
  }
  print_message("%s: largest over smallest %.3f\n", row, most / least);
  return most / least;
}

/* E eps_t = 3.13 MPa is what an endless lattice bears along its rows. */
static void the_strength_hangs_less_on_the_angle(void **state) {
  (void)state;
  const double nearest = spread(1.5, "| tension, 1.5 s |"),
               larger = spread(2.1, "| tension, 2.1 s |");
  assert_true(larger - 1 < 0.6 * (nearest - 1));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_crack_costs_the_same_at_every_horizon),
      cmocka_unit_test(dampers_take_the_same_at_every_horizon),
      cmocka_unit_test(the_strength_hangs_less_on_the_angle),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
