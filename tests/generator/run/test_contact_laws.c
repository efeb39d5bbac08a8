/* Contact of bodies whose laws come along: of bonds, of families, on no lattice, in space. Momentum
   stays to rounding, the energies balance, threads and stops change no bit; a strip of many
   neighbours that was torn bears pressure again. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/runtime/hand_over.h"
#include "tests/runtime/same_runs.h"
#include "tests/verification/case.h"

typedef struct blow {
  const char *name, *bodies;
} blow;

static const blow blows[] = {
    {"bonds and families",
     "&lattice name = 'a' kind = 'hexagonal' spacing = '5 mm' thickness = '10 mm' /\n"
     "&material lattice = 'a' model = 'mplm_bilinear' /\n"
     "&lattice name = 'b' kind = 'square' spacing = '4 mm' horizon = 3.015 thickness = '10 mm' "
     "origin = '54.55 mm', 0 /\n&material lattice = 'b' model = 'pmb' G_0 = 10 /\n"
     "&body lattice = 'a' shape = 'rectangle' corner = 0, 0 size = '50 mm', '40 mm' /\n"
     "&body lattice = 'b' shape = 'rectangle' corner = '51 mm', 0 size = '40 mm', '40 mm' /\n"},
    {"on no lattice",
     "&lattice name = 'a' kind = 'blue_noise' spacing = '5 mm' thickness = '10 mm' /\n"
     "&material lattice = 'a' model = 'pmb' G_0 = 10 /\n"
     "&lattice name = 'b' kind = 'hexagonal' spacing = '5 mm' thickness = '10 mm' "
     "origin = '51 mm', 0 /\n&material lattice = 'b' model = 'splm_elastic' /\n"
     "&body lattice = 'a' shape = 'rectangle' corner = 0, 0 size = '50 mm', '40 mm' /\n"
     "&body lattice = 'b' shape = 'rectangle' corner = '51 mm', 0 size = '40 mm', '40 mm' /\n"},
    {"in space",
     "&lattice name = 'a' kind = 'fcc' spacing = '5 mm' shells = 2 /\n"
     "&material lattice = 'a' model = 'splm_elastic' /\n"
     "&lattice name = 'b' kind = 'cubic' spacing = '5 mm' horizon = 2.01 "
     "origin = '33.5 mm', 0, 0 /\n&material lattice = 'b' model = 'pmb' /\n"
     "&body lattice = 'a' shape = 'box' corner = 0, 0, 0 size = '30 mm', '20 mm', '20 mm' /\n"
     "&body lattice = 'b' shape = 'box' corner = '33.5 mm', 0, 0 size = '20 mm', '20 mm', '20 mm' "
     "/\n"},
};

static void open_blow(deck_case *c, const blow *of, int threads) {
  char text[4096];
  const bool space = strstr(of->bodies, "'box'") != NULL;
  snprintf(text, sizeof text,
           "&simulation end_time = '30 us' threads = %d /\n"
           "&output frames = 0 sample = '1 us' losses = T /\n%s&contact /\n"
           "&region name = 'all' lattice = 'b' shape = %s corner = -1, -1%s size = 2, 2%s /\n"
           "&initial_velocity region = 'all' component = 'x' value = -20 /\n",
           threads, of->bodies, space ? "'box'" : "'rectangle'", space ? ", -1" : "",
           space ? ", 2" : "");
  deck_case_open(c, text);
}

static double momentum(const deck_case *c, int component) {
  double sum = 0;
  for (int n = 0; n < simulation_bodies(c->simulation); n++) {
    const body *w = simulation_state(c->simulation, n)->body;
    for (long p = 0; p < w->lattice->particle_count; p++)
      sum += body_mass(w, component, w->lattice->particle_site[p]) *
             w->velocity[component][w->lattice->particle_site[p]];
  }
  return sum;
}

static void blows_keep_momentum_and_energy(void **state) {
  (void)state;
  for (size_t n = 0; n < sizeof blows / sizeof *blows; n++) {
    deck_case one, two, resumed;
    open_blow(&one, &blows[n], 1);
    const double before = momentum(&one, 0);
    assert_int_equal(deck_case_go(&one), STEP_END);
    const double drift = fabs(momentum(&one, 0) / before - 1),
                 kinetic = deck_case_largest(&one, "energy/kinetic");
    print_message("%-20s momentum %.1e, contact %.2f, imbalance %.1e of the kinetic energy\n",
                  blows[n].name, drift, deck_case_largest(&one, "contact/stored") / kinetic,
                  deck_case_largest(&one, "energy/imbalance") / kinetic);
    assert_true(drift < 1e-12 && fabs(momentum(&one, 1)) < 1e-12 * fabs(before));
    assert_true(deck_case_largest(&one, "contact/stored") > 0.01 * kinetic);
    assert_true(deck_case_largest(&one, "contact/imbalance") < 1e-3 * kinetic);
    assert_true(deck_case_largest(&one, "energy/imbalance") < 1e-2 * kinetic);
    open_blow(&two, &blows[n], 3);
    open_blow(&resumed, &blows[n], 2);
    hand_over(two.simulation, simulation_step_count(two.simulation) / 2, resumed.simulation);
    assert_int_equal(deck_case_go(&two), STEP_END);
    assert_int_equal(deck_case_go(&resumed), STEP_END);
    same_runs(one.simulation, two.simulation);
    same_runs(one.simulation, resumed.simulation);
    deck_case_close(&one);
    deck_case_close(&two);
    deck_case_close(&resumed);
  }
}

/* Pulled until it has parted, then pressed by a thousandth of its length. */
static double pressed_strip(const char *more, double *stored) {
  char text[4096];
  snprintf(
      text, sizeof text,
      "&simulation end_time = '0.7 ms' /\n&output frames = 0 losses = T /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = '5 mm' horizon = 3.015 thickness = "
      "'10 mm' /\n&material lattice = 'c' model = 'pmb' G_0 = 1 /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = '80 mm', '30 mm' /\n"
      "&region name = 'left' shape = 'rectangle' corner = 0, 0 size = '10 mm', '30 mm' /\n"
      "&region name = 'right' shape = 'rectangle' corner = '70 mm', 0 size = '10 mm', '30 mm' /\n"
      "&protect region = 'left' /\n&protect region = 'right' /\n"
      "&support region = 'left' fix = 'xy' /\n&support region = 'right' fix = 'y' /\n"
      "&drive region = 'right' component = 'x' displacement = '0.5 mm' times = 0, '0.1 ms', "
      "'0.3 ms' values = 0, 1, -0.04 /\n"
      "&damping rate = 20000 /\n"
      "&monitor name = 'F' kind = 'reaction' region = 'left' component = 'x' /\n%s",
      more);
  deck_case c;
  deck_case_open(&c, text);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const long last = simulation_history(c.simulation, NULL) - 1;
  const double force = deck_case_series(&c, "F")[last];
  *stored = *more ? deck_case_largest(&c, "contact/stored") : 0;
  deck_case_close(&c);
  return force;
}

static void a_torn_strip_bears_pressure_again(void **state) {
  (void)state;
  double none, stored;
  const double without = pressed_strip("", &none),
               with = pressed_strip("&contact lattices = 'c' /\n", &stored);
  print_message("reaction without and with contact %.4g, %.4g N\n", without, with);
  assert_true(stored > 0 && with > 20 * fabs(without));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(blows_keep_momentum_and_energy),
      cmocka_unit_test(a_torn_strip_bears_pressure_again),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
