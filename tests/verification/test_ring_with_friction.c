/* The thick ring of examples/thick_ring with friction: plastic radius, displacements and the
   pressure that it bears at most, beside the closed forms of Mohr and Coulomb's condition with
   associated flow. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"
#include "tests/verification/page.h"

#define RING "examples/thick_ring/"

static const double a = 0.1, b = 0.2, E = 20e9, nu = 0.25, cohesion = 5e6, pressure = 5.273464e6;

/* Of the friction angle, 20 degrees: sine; c cot phi, Pa; kappa = 2 sin/(1 + sin), the power by
   which the stress in the plastic zone falls; (1 - sin)/(1 + sin). */
static double sine(void) {
  return sin(20 * M_PI / 180);
}
static double tip(void) {
  return cohesion / tan(20 * M_PI / 180);
}
static double kappa(void) {
  return 2 * sine() / (1 + sine());
}
static double ratio(void) {
  return (1 - sine()) / (1 + sine());
}

/* Pa: what the elastic ring from radius c on bears where it begins to yield there. */
static double at_border(double c) {
  return tip() * sine() * (b * b - c * c) / (b * b + c * c * sine());
}

/* The stress along the radius is tip - (p + tip) (a/r)^kappa in the plastic zone. */
static double pressure_for(double c) {
  return (at_border(c) + tip()) * pow(c / a, kappa()) - tip();
}

static double yielded(double p) {
  double low = a, high = b;
  for (int n = 0; n < 60; n++) {
    const double c = (low + high) / 2;
    *(pressure_for(c) < p ? &low : &high) = c;
  }
  return low;
}

/* Lame, of the ring from c on under a pressure there. */
static double elastic(double c, double p, double r) {
  return (1 + nu) / E * p * c * c / (b * b - c * c) * ((1 - 2 * nu) * r + b * b / r);
}

/* In the plastic zone du/dr + m u/r = e_r + m e_t of the elastic strains, with m = ratio(), since
   plastic ones along and across the radius are as -m to 1: the integral of that times r^m. */
static double integral(double p, double r) {
  const double m = ratio(), fall = (p + tip()) * pow(a, kappa()),
               of_tip = (1 + nu) / E * tip() * (1 + m) * (1 - 2 * nu),
               of_fall = (1 + nu) / E * fall * ((1 - nu) - m * nu + m * (m * (1 - nu) - nu));
  return of_tip * pow(r, m + 1) / (m + 1) - of_fall * pow(r, m + 1 - kappa()) / (m + 1 - kappa());
}

/* Of the inner edge, m; c: the plastic radius. */
static double moved(double p, double c) {
  if (c <= a * (1 + 1e-9)) return elastic(a, p, a);
  const double m = ratio(),
               rest = elastic(c, at_border(c), c) * pow(c, m) - integral(p, c) + integral(p, a);
  return rest / pow(a, m);
}

static double moved_outside(double p, double c) {
  return c <= a * (1 + 1e-9) ? elastic(a, p, b) : elastic(c, at_border(c), b);
}

static void page_row(double p, double c, const double theory[2], const double found[2]) {
  char line[32], figure[96];
  snprintf(line, sizeof line, "| %.3f |", 1e-6 * p);
  snprintf(figure, sizeof figure, "| %.1f | %.2f | %.2f | %.2f | %.2f |", 1e3 * c, 1e6 * theory[0],
           1e6 * found[0], 1e6 * theory[1], 1e6 * found[1]);
  page_line_says(RING "README.md", line, figure);
}

/* Elastic to 0.1 %. The cone's border moves ahead of Mohr and Coulomb's: the stress along the axis
   of the ring, of which theirs knows nothing, is at first the elastic one. */
static void the_edges_move_as_mohr_and_coulomb_have_it(void **state) {
  (void)state;
  static const char *const overrides[] = {"simulation.threads=1"};
  deck_case run;
  const double *time;
  assert_true(deck_case_run(&run, RING "friction.nml", overrides, 1));
  assert_int_equal(deck_case_go(&run), STEP_END);
  const long samples = simulation_history(run.simulation, &time);
  const double *inside = deck_case_series(&run, "inside"),
               *outside = deck_case_series(&run, "outside"),
               *force = deck_case_series(&run, "pressure_force");
  assert_int_equal(samples, 25);
  assert_true(fabs(pressure_for(0.15) / pressure - 1) < 1e-6);
  for (long n = 1; n < samples; n++) {
    const double p = pressure * time[n], c = yielded(p),
                 theory[2] = {moved(p, c), moved_outside(p, c)}, found[2] = {inside[n], outside[n]};
    const bool flows = c > a * (1 + 1e-9);
    print_message("%.3f MPa: plastic to %.1f mm, inside %.2f um, theory %.2f, outside %.2f, theory "
                  "%.2f\n",
                  1e-6 * p, 1e3 * c, 1e6 * found[0], 1e6 * theory[0], 1e6 * found[1],
                  1e6 * theory[1]);
    assert_true(fabs(force[n] / (p * a * 0.01) - 1) < 2e-3);
    for (int k = 0; k < 2; k++) {
      const double off = found[k] / theory[k] - 1;
      assert_true(flows ? off > -1e-3 && off < 0.022 : fabs(off) < 1e-3);
    }
    if (flows && n % 2 == 0) page_row(p, c, theory, found);
  }
  deck_case_close(&run);
}

/* Steps that the last increment took, of 20 000 at most, at this part of the pressure at which all
   of the ring flows. */
static double steps_at(double part) {
  char stress[64];
  const char *const overrides[] = {"simulation.threads=1", stress, "relaxation.most_steps=20000"};
  deck_case run;
  snprintf(stress, sizeof stress, "traction.stress=%.10g Pa", -part * pressure_for(b));
  assert_true(deck_case_run(&run, RING "friction.nml", overrides, 3));
  assert_int_equal(deck_case_go(&run), STEP_END);
  const double steps = deck_case_last(&run, "relaxation_steps");
  print_message("%.2f of %.4f MPa: %.0f steps, inside %.3g um\n", part, 1e-6 * pressure_for(b),
                steps, 1e6 * deck_case_last(&run, "inside"));
  deck_case_close(&run);
  return steps;
}

/* By the theorems of limit analysis that does not depend on elasticity, and where the cone flows in
   plane strain it is Mohr and Coulomb's surface. */
static void it_bears_the_limit_pressure_and_no_more(void **state) {
  (void)state;
  assert_true(steps_at(0.99) < 20000);
  assert_true(steps_at(1.01) >= 20000);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_edges_move_as_mohr_and_coulomb_have_it),
      cmocka_unit_test(it_bears_the_limit_pressure_and_no_more),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
