/* The blow of examples/projectile: rods against the theory of waves in rods, impulse and momentum,
   what mass and speed of the projectile do to the stress under it, and what the page says. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"
#include "tests/verification/page.h"

#define FOLDER "examples/projectile/"
enum { MOST_OVERRIDES = 12 };

typedef char override_text[96];

static void run(deck_case *c, const char *deck_name, override_text *texts, int count) {
  const char *overrides[MOST_OVERRIDES];
  char path[256];
  for (int n = 0; n < count; n++)
    overrides[n] = texts[n];
  snprintf(path, sizeof path, FOLDER "%s.nml", deck_name);
  assert_true(deck_case_run(c, path, overrides, count));
  assert_int_equal(deck_case_go(c), STEP_END);
}

static double last_of(const deck_case *c, const char *series) {
  return deck_case_series(c, series)[simulation_history(c->simulation, NULL) - 1];
}

static void says(const char *row, const char *form, double value) {
  char figure[64];
  snprintf(figure, sizeof figure, form, value);
  page_line_says(FOLDER "README.md", row, figure);
}

/* --- rods ------------------------------------------------------------------------------------- */

static const double speed = 40; /* m/s */

static double impedance(double E, double rho) {
  return sqrt(E * rho);
}

/* Stress that two long rods press each other with: v Z1 Z2/(Z1 + Z2). */
static double plateau(double v) {
  const double steel = impedance(210e9, 7850), concrete = impedance(30e9, 2400);
  return v * steel * concrete / (steel + concrete);
}

/* Of the momentum that the wall has after 8 us, before the projectile's far end makes itself felt;
   spacings of 1 mm over `finer`. */
static double rod_error(int finer) {
  static const struct {
    const char *name;
    double spacing, edge; /* mm; of the side that the first site stands half a spacing within */
  } rods[] = {{"wall", 1, 0}, {"bar", 1, 0}, {"projectile", 1.01305, 10}};
  override_text texts[6];
  for (int n = 0; n < 3; n++) {
    const double s = rods[n].spacing / finer, site = rods[n].edge + (n ? s : -s) / 2;
    snprintf(texts[2 * n], sizeof *texts, "lattice[%s].spacing=%.10g mm", rods[n].name, s);
    snprintf(texts[2 * n + 1], sizeof *texts, "lattice[%s].origin=0, %.10g mm", rods[n].name, site);
  }
  deck_case c;
  run(&c, "rods", texts, 6);
  const double begins = 0.01 / sqrt(210e9 / 7850), area = 1256.64e-6,
               theory = plateau(speed) * area * (simulation_time(c.simulation) - begins);
  const double error = 1 - last_of(&c, "handed_on") / theory;
  deck_case_close(&c);
  return error;
}

static void rods_hand_on_what_theory_says(void **state) {
  (void)state;
  double error[3];
  for (int n = 0; n < 3; n++) {
    error[n] = rod_error(1 << n);
    print_message("rods, spacing %g mm: impulse on the wall %.2f %% short of theory\n",
                  1.0 / (1 << n), 1e2 * error[n]);
    says("| impulse on the rod", "| %.2f %% |", 1e2 * error[n]);
  }
  assert_true(error[0] < 0.02 && error[1] < 0.55 * error[0] && error[2] < 0.55 * error[1]);
  says("| rods in theory", "| %.1f MPa |", plateau(speed) / 1e6);
}

/* --- the wall --------------------------------------------------------------------------------- */

typedef struct blow {
  double peak; /* Pa */
  double impulse_error, momentum_error;
} blow;

static double momentum_of(const deck_case *c) {
  double sum = 0;
  for (int n = 0; n < simulation_bodies(c->simulation); n++) {
    const body *b = simulation_state(c->simulation, n)->body;
    for (long p = 0; p < b->lattice->particle_count; p++) {
      const long q = b->lattice->particle_site[p];
      sum += body_mass(b, 1, q) * b->velocity[1][q];
    }
  }
  return sum;
}

/* Until so many us; means of the contact's force over the time between samples are its impulse. */
static blow strike(const char *deck_name, const char *length, double v, double mass, double until) {
  override_text texts[4];
  int count = 2;
  snprintf(texts[0], sizeof *texts, "initial_velocity.value=-%g m/s", v);
  snprintf(texts[1], sizeof *texts, "simulation.end_time=%g us", until);
  if (length) snprintf(texts[count++], sizeof *texts, "%s", length);
  deck_case c;
  blow b;
  run(&c, deck_name, texts, count);
  const double *time, *force = deck_case_series(&c, "blow"),
                      *momentum = deck_case_series(&c, "momentum"),
                      *stress = deck_case_series(&c, "stress");
  const long samples = simulation_history(c.simulation, &time);
  double impulse = 0;
  for (long k = 1; k < samples; k++)
    impulse += force[k] * (time[k] - time[k - 1]);
  b.peak = stress[largest_of(stress, samples)];
  b.impulse_error = impulse / (momentum[samples - 1] - momentum[0]) - 1;
  b.momentum_error = momentum_of(&c) / momentum[0] - 1;
  assert_true(fabs(momentum[0] / (-mass * v) - 1) < 1e-5); /* the projectile's mass */
  deck_case_close(&c);
  return b;
}

static double peak_of(const char *deck_name, const char *length, double v, double mass) {
  return strike(deck_name, length, v, mass, 13).peak / 1e6;
}

/* The projectile has left again after 40 us, and no wave has come to the feet. */
static void the_impulse_is_the_change_of_momentum(void **state) {
  (void)state;
  const blow b = strike("plane", NULL, speed, 0.2, 40);
  print_message("plane: impulse %.1e, momentum %.1e\n", b.impulse_error, b.momentum_error);
  assert_true(fabs(b.impulse_error) < 1e-10);
  assert_true(fabs(b.momentum_error) < 1e-10);
  says("| 40 m/s |", "| %.1f |", b.peak / 1e6);
  says("| peak in the plane", "| %.1f MPa |", b.peak / 1e6);
}

static void the_peak_is_by_the_speed_and_not_by_the_mass(void **state) {
  (void)state;
  const double light = peak_of("plane", "body[projectile].size=31.4 mm, 17.728 mm", 30, 0.175),
               heavy = peak_of("plane", "body[projectile].size=31.4 mm, 25.326 mm", 30, 0.25),
               fast = peak_of("plane", "body[projectile].size=31.4 mm, 17.728 mm", 70, 0.175);
  print_message("plane: %.1f and %.1f MPa at 30 m/s, %.1f MPa at 70 m/s\n", light, heavy, fast);
  assert_true(fabs(heavy / light - 1) < 2e-3);
  assert_true(fabs(fast / light / (70.0 / 30) - 1) < 2e-2);
  says("| 30 m/s |", "| 30 m/s | %.1f |", light);
  says("| 30 m/s |", "| %.1f |", heavy);
  says("| 70 m/s |", "| 70 m/s | %.1f |", fast);
}

/* The source: about 250 MPa at 35 to 45 m/s, 300 MPa at 40 to 50 m/s. With layers of 2.5 mm that is
   so; finer ones give up to 16 % more. */
static void a_blow_in_space(void **state) {
  (void)state;
  const blow b = strike("space", NULL, speed, 0.2, 12.8);
  const double per_speed = b.peak / speed;
  print_message("space: %.1f MPa, 250 MPa at %.1f m/s, 300 MPa at %.1f m/s\n", b.peak / 1e6,
                250e6 / per_speed, 300e6 / per_speed);
  assert_true(250e6 / per_speed > 35 && 250e6 / per_speed < 45);
  assert_true(300e6 / per_speed > 40 && 300e6 / per_speed < 50);
  says("| peak in space", "| %.1f MPa |", b.peak / 1e6);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(rods_hand_on_what_theory_says),
      cmocka_unit_test(the_impulse_is_the_change_of_momentum),
      cmocka_unit_test(the_peak_is_by_the_speed_and_not_by_the_mass),
      cmocka_unit_test(a_blow_in_space),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
