/* Cases of laws of families against theory, from the decks of examples/ on coarser lattices: elastic constants of a cube,
   a pulse along a bar, a running crack, a beam in space; and what a crack through cohesive bonds in space costs. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"

static void run_of(deck_case *c, const char *name, const char *const *overrides, int count) {
  assert_true(deck_case_run(c, name, overrides, count));
  assert_int_equal(deck_case_go(c), STEP_END);
}

static double last_of(const deck_case *c, const char *name) {
  return deck_case_series(c, name)[simulation_history(c->simulation, NULL) - 1];
}

static void is_within(const char *what, double value, double low, double high) {
  print_message("%s: %.6g\n", what, value);
  if (!(value >= low && value <= high))
    fail_msg("%s: %g is not in %g to %g", what, value, low, high);
}

/* --- elasticity ------------------------------------------------------------------------------- */

static void a_cube_has_the_constants_of_the_solid(void **state) {
  (void)state;
  deck_case c;
  static const char *const coarse[] = {"lattice.spacing=10 mm"};
  run_of(&c, "examples/fcc_cube/cube.nml", coarse, 1);
  const double strain = last_of(&c, "strain");
  is_within("E/25 GPa", last_of(&c, "stress") / strain / 25e9, 0.99, 1.01);
  is_within("nu", -last_of(&c, "lateral") / strain, 0.185, 0.215);
  deck_case_close(&c);
}

/* --- waves ------------------------------------------------------------------------------------ */

/* Time of the pulse's centre of gravity. */
static double centre_of(const deck_case *c, const char *name) {
  const double *time, *v = deck_case_series(c, name);
  const long count = simulation_history(c->simulation, &time);
  double sum = 0, moment = 0;
  for (long k = 1; k < count; k++) {
    sum += v[k] * (time[k] - time[k - 1]);
    moment += v[k] * time[k] * (time[k] - time[k - 1]);
  }
  return moment / sum;
}

/* Error of the speed between the stations 0.4 m apart, against that of a bar of the lattice's own modulus. */
static double error_of_speed(const char *name, const char *spacing, const char *origin, double E) {
  deck_case c;
  const char *const overrides[] = {spacing, origin};
  run_of(&c, name, overrides, 2);
  const double speed = 0.4 / (centre_of(&c, "far") - centre_of(&c, "near"));
  const double error = speed / sqrt(E / 2323) - 1;
  print_message("%s, %s: error of the speed %.4f\n", name, spacing, error);
  deck_case_close(&c);
  return error;
}

/* The free sides make the bar stiffer by a part that goes with the horizon over the height. */
static void pulses_travel_along_a_bar(void **state) {
  (void)state;
  static const struct {
    const char *deck;
    double E; /* Pa, that perilat announces for the lattice */
  } laws[] = {{"examples/wave_in_a_bar/pmb.nml", 25.57e9},
              {"examples/wave_in_a_bar/lps.nml", 25.52e9}};
  for (size_t k = 0; k < sizeof laws / sizeof *laws; k++) {
    const double coarse = error_of_speed(laws[k].deck, "lattice.spacing=5 mm",
                                         "lattice.origin=2.5 mm, 2.5 mm", laws[k].E);
    const double fine = error_of_speed(laws[k].deck, "lattice.spacing=2.5 mm",
                                       "lattice.origin=1.25 mm, 1.25 mm", laws[k].E);
    assert_true(fine < 0.1 && fine < 0.7 * coarse);
  }
}

/* --- cracks ----------------------------------------------------------------------------------- */

/* Time at which a fifth of the bonds at a station is broken. */
static double passes_at(const deck_case *c, const char *name) {
  const double *time, *broken = deck_case_series(c, name);
  const long count = simulation_history(c->simulation, &time);
  for (long k = 0; k < count; k++)
    if (broken[k] > 0.2) return time[k];
  fail_msg("the crack does not reach %s", name);
  return 0;
}

/* Between 0.4 and 1 of the Rayleigh speed, 0.93 c_s; a crack that leaves its plane by three rows breaks a fifth
   of the bonds there and more. */
static void a_crack_runs_below_the_rayleigh_speed(void **state) {
  (void)state;
  deck_case c;
  static const char *const coarse[] = {"lattice.spacing=1 mm", "lattice.origin=0, 0.5 mm"};
  run_of(&c, "examples/running_crack/pmb.nml", coarse, 2);
  const double rayleigh = (0.862 + 1.14 / 3) / (4. / 3) * sqrt(27e9 / 2440);
  is_within("crack speed over Rayleigh's",
            0.04 / (passes_at(&c, "b85") - passes_at(&c, "b45")) / rayleigh, 0.4, 1);
  is_within("bonds broken above the crack", last_of(&c, "above"), 0, 0.2);
  is_within("bonds broken below the crack", last_of(&c, "below"), 0, 0.2);
  deck_case_close(&c);
}

static void a_beam_in_space_breaks(void **state) {
  (void)state;
  deck_case c;
  static const char *const coarse[] = {"lattice.spacing=8 mm"};
  run_of(&c, "examples/notched_beam_3d/beam.nml", coarse, 1);
  const double *load = deck_case_series(&c, "load");
  const double peak = load[largest_of(load, simulation_history(c.simulation, NULL))];
  is_within("peak, N", peak, 3500, 5500);
  is_within("load at the end over the peak", last_of(&c, "load") / peak, 0, 0.5);
  is_within("energy of the crack over G_f times the ligament",
            last_of(&c, "energy/dissipated_damage") / (80 * 50.8e-3 * 76.2e-3), 0.5, 1.3);
  is_within("imbalance over work",
            fabs(last_of(&c, "energy/imbalance")) / last_of(&c, "energy/external"), 0, 1e-9);
  deck_case_close(&c);
}

/* --- cohesive bonds in space ------------------------------------------------------------------ */

static const char *const layers =
    "&simulation end_time = '30 ms' step_safety = 0.8 /\n"
    "&lattice name = 'l' kind = 'fcc' shells = 2 spacing = '5 mm' /\n"
    "&material lattice = 'l' model = 'cohesive' /\n"
    "&body lattice = 'l' shape = 'box' corner = '-21 mm', '-21 mm', '-8 mm' size = '42 mm', "
    "'42 mm', '19 mm' /\n"
    "&region name = 'low' shape = 'box' corner = '-1 m', '-1 m', '-1 m' size = '2 m', '2 m', "
    "'1.001 m' /\n"
    "&region name = 'top' shape = 'box' corner = '-1 m', '-1 m', '2 mm' size = '2 m', '2 m', '1 m' "
    "/\n"
    "&support region = 'low' fix = 'xyz' /\n&support region = 'top' fix = 'xy' /\n"
    "&drive region = 'top' component = 'z' velocity = '1 mm/s' rise = '1 ms' /\n"
    "&output frames = 1 sample = '0.05 ms' /\n";

/* Bonds that cross the plane between the layers z = 0 and z = 3.5 mm, by shells. */
static void count_crossing(const rows *w, long count[2]) {
  count[0] = count[1] = 0;
  for (long q = 0; q < w->size; q++)
    for (int k = 0; k < w->directions; k++) {
      if (!(w->bonds[q] >> k & 1)) continue;
      const double from = w->z[q] - 1e-3, to = from + w->chord[k][2];
      if ((from > 0) != (to > 0)) count[w->shell[k] - 1]++;
    }
}

/* Half a crystal lifted off the other along a cube face costs what its bonds cost; on an endless plane that is G_f. */
static void a_crack_through_the_crystal_costs_G_f(void **state) {
  (void)state;
  deck_case l, c;
  long crossing[2];
  const double E = 30e9, f_t = 3e6, G_f = 80, s = 5e-3;
  const double last = 5 / (1 + 4 * sqrt(2)) * G_f / f_t; /* opening at separation */
  const double k_1 = 4 / (5 * sqrt(2)) * E * s * s, k_2 = E * s * s / 5;
  const double g_1 = k_1 * f_t / E * last / 2, g_2 = k_2 * f_t / E * last / 2;
  is_within("cost of an endless plane over G_f", (4 * g_1 + 2 * g_2) / (s * s) / G_f, 1 - 1e-12,
            1 + 1e-12);
  assert_true(deck_case_lattice(&l, layers));
  count_crossing(l.lattice, crossing);
  deck_case_close(&l);
  assert_true(deck_case_text(&c, layers));
  assert_int_equal(deck_case_go(&c), STEP_END);
  is_within("cost over that of the bonds cut",
            last_of(&c, "energy/dissipated_damage") /
                ((double)crossing[0] * g_1 + (double)crossing[1] * g_2),
            0.999, 1.001);
  deck_case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_cube_has_the_constants_of_the_solid),
      cmocka_unit_test(pulses_travel_along_a_bar),
      cmocka_unit_test(a_crack_runs_below_the_rayleigh_speed),
      cmocka_unit_test(a_beam_in_space_breaks),
      cmocka_unit_test(a_crack_through_the_crystal_costs_G_f),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
