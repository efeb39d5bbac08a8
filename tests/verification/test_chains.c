/* Chains of particles, the axes of bars and beams, against closed forms: waves of a row of masses,
   the time that a pulse takes and how it comes back, the deflection of a cantilever. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/analysis/implied.h"
#include "runtime/analysis/stability.h"
#include "tests/verification/case.h"

static const double E = 200e9, rho = 7850, area = 1e-4, spacing = 0.01; /* Pa, kg/m^3, m^2, m */

static deck_lattice chain_at(double degrees) {
  deck_lattice l = lattice_default_chain(spacing, area);
  l.rotation = degrees * acos(-1) / 180;
  return l;
}

/* What follows from E and rho, however the chain is turned: the modulus, c^2 = E/rho, the shortest
   wave, of neighbours that swing against each other, with omega = 2 c/s. */
static void a_bar_has_its_modulus_and_waves(void **state) {
  (void)state;
  static const double turns[] = {0, 25, 50, 75, 90};
  for (int k = 0; k < 5; k++) {
    model m;
    diagnostics said;
    source_set sources = {NULL, 0};
    implied_elasticity e;
    implied_waves waves;
    char error[1000];
    const char *note;
    const deck_material of = {.model = "bar"};
    const deck_lattice like = chain_at(turns[k]);
    diag_begin(&said, &sources);
    assert_true(material_law_open(&of, &like, SOURCE_DIR "/models/deck.nml", &m, &said));
    const pl_law *kernel = model_kernel(&m, true, &note, error, sizeof error);
    const double parameters[2] = {E, rho}, c = sqrt(E / rho);
    rows *w = implied_lattice_like(&like, rho);
    assert_true(implied_elastic(kernel, parameters, w, &e));
    implied_wave_speeds(kernel, parameters, w, &e, &waves);
    step_limit step;
    stability_limit(kernel, parameters, NULL, w, &step);
    print_message("turned by %g degrees: E %+.1e, c %+.1e, stable step %+.1e of theory\n", turns[k],
                  e.E[0] / E - 1, waves.longitudinal[0] / c - 1, step.limit / (spacing / c) - 1);
    assert_true(fabs(e.E[0] / E - 1) < 1e-8 && isnan(e.E[1]) && isnan(e.nu[0]) && isnan(e.G));
    assert_true(fabs(waves.longitudinal[0] / c - 1) < 1e-8 && isnan(waves.transverse));
    assert_true(fabs(step.limit / (spacing / c) - 1) < 1e-8);
    rows_free(w);
    model_close(&m);
    diag_clear(&said);
    source_clear(&sources);
  }
}

/* --- runs ------------------------------------------------------------------------------------- */

enum { PARTICLES = 24 };

static void open_bar(deck_case *c, double degrees, double step, const char *groups) {
  char text[2000];
  snprintf(
      text, sizeof text,
      "&simulation end_time = 1 step = %.17g threads = 1 /\n"
      "&lattice name = 'l' kind = 'chain' spacing = %.17g area = %.17g rotation = %g /\n"
      "&material lattice = 'l' model = 'bar' E = %.17g rho = %.17g /\n"
      "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = %.17g, 0.001 rotation = %g "
      "/\n%s",
      step, spacing, area, degrees, E, rho, (PARTICLES - 1) * spacing, degrees, groups);
  assert_true(deck_case_text(c, text));
  assert_int_equal(simulation_rows(c->simulation, 0)->particle_count, PARTICLES);
}

/* Displacements along the bar, m. */
static void read_along(const deck_case *c, double degrees, double u[PARTICLES]) {
  const rows *w = simulation_rows(c->simulation, 0);
  const body *b = simulation_state(c->simulation, 0)->body;
  const double angle = degrees * acos(-1) / 180;
  for (int p = 0; p < PARTICLES; p++) {
    const long q = w->particle_site[p];
    u[p] = b->displacement[0][q] * cos(angle) + b->displacement[1][q] * sin(angle);
  }
}

/* A standing wave of a free row of equal masses, u_p = cos(pi m (p + 1/2)/n), that begins with a
   velocity. Returns its frequency, from u(t + dt) + u(t - dt) = (2 - (omega dt)^2) u(t). */
static double frequency_of(int wave, double degrees) {
  enum { STEPS = 200 };
  const double step = 0.4 * spacing / sqrt(E / rho), angle = degrees * acos(-1) / 180;
  double u[3][PARTICLES] = {{0}}, above = 0, below = 0;
  deck_case c;
  open_bar(&c, degrees, step, "");
  const rows *w = simulation_rows(c.simulation, 0);
  body *b = simulation_state(c.simulation, 0)->body;
  for (int p = 0; p < PARTICLES; p++) {
    const double v = 0.5 * cos(acos(-1) * wave * (p + 0.5) / PARTICLES); /* stretches of 1e-4 */
    b->velocity[0][w->particle_site[p]] = v * cos(angle);
    b->velocity[1][w->particle_site[p]] = v * sin(angle);
  }
  for (int n = 1; n <= STEPS; n++) {
    assert_int_equal(simulation_advance(c.simulation, 1, NULL), STEP_OK);
    read_along(&c, degrees, u[n % 3]);
    for (int p = 0; p < PARTICLES && n > 1; p++) {
      const double here = u[(n + 2) % 3][p];
      above += here * (u[n % 3][p] + u[(n + 1) % 3][p]);
      below += here * here;
    }
  }
  deck_case_close(&c);
  return sqrt(2 - above / below) / step;
}

/* omega = 2 c/s sin(k s/2) with k = pi m/(n s), exactly, from the longest wave to the shortest. */
static void waves_run_as_in_a_row_of_masses(void **state) {
  (void)state;
  static const int waves[] = {1, 2, 7, 12, 19, 23};
  for (int turned = 0; turned < 2; turned++) {
    double worst = 0;
    for (size_t k = 0; k < sizeof waves / sizeof *waves; k++) {
      const double theory =
          2 * sqrt(E / rho) / spacing * sin(acos(-1) * waves[k] / (2 * PARTICLES));
      worst = fmax(worst, fabs(frequency_of(waves[k], 30 * turned) / theory - 1));
    }
    print_message("frequencies of a bar turned by %d degrees: within %.1e\n", 30 * turned, worst);
    assert_true(worst < 1e-9);
  }
}

/* One end is pushed on at v. With steps of s/c the row's masses move as a bar's sections do
   (d'Alembert): a front of velocity v and force E A v/c that runs at c. The free end is half a
   spacing beyond the last particle: the front passes this once and comes back a step later. The
   largest stable step is told 3e-9 too short: steps are shorter by 1e-8. */
static void a_pulse_comes_back_from_the_free_end(void **state) {
  (void)state;
  const double v = 0.5, c = sqrt(E / rho), step = (1 - 1e-8) * spacing / c, way = v * step;
  double u[PARTICLES], worst = 0, off = 0;
  deck_case k;
  open_bar(&k, 0, step,
           "&region name = 'end' shape = 'rectangle' corner = -0.001, 0 size = 0.002, 0.001 /\n"
           "&drive region = 'end' component = 'x' velocity = 0.5 history = 'constant' /\n"
           "&monitor name = 'push' kind = 'reaction' region = 'end' component = 'x' /\n"
           "&output sample = 2e-6 /\n");
  for (int n = 1; n < 2 * PARTICLES - 2; n++) {
    assert_int_equal(simulation_advance(k.simulation, 1, NULL), STEP_OK);
    read_along(&k, 0, u);
    for (int p = 0; p < PARTICLES; p++) {
      const int here = n - p, back = n - (2 * PARTICLES - 1 - p);
      const double theory = way * (fmax(here, 0) + fmax(back, 0));
      worst = fmax(worst, fabs(u[p] - theory) / way);
    }
  }
  const double *push = deck_case_series(&k, "push"), force = E * area * v / c;
  const long samples = simulation_history(k.simulation, NULL);
  assert_true(samples > PARTICLES);
  for (long n = 1; n < samples; n++)
    off = fmax(off, fabs(push[n] / force - 1));
  print_message("way of the front: %.1e of a step's off; push %.1e of E A v/c off\n", worst, off);
  assert_true(worst < 1e-5 && off < 1e-5);
  deck_case_close(&k);
}

/* The bonds are beams of Euler and Bernoulli without loads between their ends: at the particles the
   deflection is theory's, P x^2 (3 L - x)/(6 EI), however few there are. A deflection of 1e-6 L
   shortens the beam by 1e-12 L. The run ends with 1e-9 of the reactions unbalanced, which count by
   the softness of the whole against that of a bond, about n^3. */
static void a_cantilever_bends_as_theory_says(void **state) {
  (void)state;
  const double I = 1e-9;
  for (int bonds = 2; bonds <= 16; bonds *= 2) {
    const double s = 0.32 / bonds, L = 0.32, P = 3e-6 * E * I / (L * L), angle = acos(-1) / 6;
    char text[2000];
    deck_case c;
    snprintf(
        text, sizeof text,
        "&simulation end_time = 1 threads = 1 /\n&relaxation increments = 1 tolerance = 1e-9 /\n"
        "&lattice name = 'l' kind = 'chain' spacing = %.17g area = %.17g rotation = 30 /\n"
        "&material lattice = 'l' model = 'beam' E = %.17g I = %.17g rho = %.17g /\n"
        "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = %.17g, 0.001 rotation = 30 "
        "/\n"
        "&region name = 'held' shape = 'point' at = 0, 0 /\n"
        "&region name = 'end' shape = 'point' at = %.17g, %.17g /\n"
        "&support region = 'held' fix = 'xy', 'rotation' /\n"
        "&force region = 'end' component = 'x' total = %.17g /\n"
        "&force region = 'end' component = 'y' total = %.17g /\n",
        s, area, E, I, rho, L, L * cos(angle), L * sin(angle), -P * sin(angle), P * cos(angle));
    assert_true(deck_case_text(&c, text));
    assert_int_equal(deck_case_go(&c), STEP_END);
    const rows *w = simulation_rows(c.simulation, 0);
    const body *b = simulation_state(c.simulation, 0)->body;
    const double end = P * L * L * L / (3 * E * I), turn = P * L * L / (2 * E * I);
    double worst = 0;
    assert_int_equal(w->particle_count, bonds + 1);
    for (int p = 0; p <= bonds; p++) {
      const long q = w->particle_site[p];
      const double x = p * s,
                   across = b->displacement[1][q] * cos(angle) - b->displacement[0][q] * sin(angle);
      worst = fmax(worst, fabs(across - P * x * x * (3 * L - x) / (6 * E * I)) / end);
      worst = fmax(worst, fabs(b->displacement[2][q] - P * x * (2 * L - x) / (2 * E * I)) / turn);
    }
    print_message("cantilever of %d bonds: deflections and rotations within %.1e of the end's\n",
                  bonds, worst);
    assert_true(worst < 1e-6);
    deck_case_close(&c);
  }
}

/* All particles turning alike against their bonds, omega^2 = 12 EI/(s theta) over I_p = m s^2/10,
   rule where the beam is stout; the swing along it, omega = 2 c/s, where it is slender. */
static void beams_have_the_stable_step_of_theory(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    const double I = k == 0 ? 1e-9 : k == 1 ? 5e-10 : 1e-11, m = rho * area * spacing;
    const double turning = sqrt(120 * E * I / (m * pow(spacing, 3)));
    const double along = 2 * sqrt(E / rho) / spacing;
    char text[1000];
    deck_case c;
    step_limit step;
    snprintf(text, sizeof text,
             "&simulation end_time = 1 /\n"
             "&lattice name = 'l' kind = 'chain' spacing = %.17g area = %.17g /\n"
             "&material lattice = 'l' model = 'beam' E = %.17g I = %.17g rho = %.17g /\n"
             "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = 0.2, 0.001 /\n",
             spacing, area, E, I, rho);
    assert_true(deck_case_text(&c, text));
    stability_limit(c.law.law, c.law.parameters, NULL, simulation_rows(c.simulation, 0), &step);
    print_message("I = %g m^4: largest frequency %+.1e of theory's %.4g rad/s\n", I,
                  step.omega_max / fmax(turning, along) - 1, fmax(turning, along));
    assert_true(fabs(step.omega_max / fmax(turning, along) - 1) < 1e-6);
    deck_case_close(&c);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_bar_has_its_modulus_and_waves),
      cmocka_unit_test(waves_run_as_in_a_row_of_masses),
      cmocka_unit_test(a_pulse_comes_back_from_the_free_end),
      cmocka_unit_test(a_cantilever_bends_as_theory_says),
      cmocka_unit_test(beams_have_the_stable_step_of_theory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
