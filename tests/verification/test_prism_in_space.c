/* Concrete in space: strength of the prism and of a cylinder, as their page has it; the same for a
   lattice that is turned onto itself. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/beside.h"

static void check(const char *name, const char *until, double theory, double least, double most) {
  const beside b = {"prism_in_space", name, until, theory, least, most, NULL};
  const beside_peak p = beside_run(&b);
  const double away = 1e6 * p.displacement; /* um */
  char line[96], figure[64];
  snprintf(line, sizeof line, "| [%s.nml](%s.nml) |", name, name);
  snprintf(figure, sizeof figure, away < 100 ? " %.1f kN at %.1f µm |" : " %.1f kN at %.3f mm |",
           1e-3 * p.load, away < 100 ? away : 1e-3 * away);
  page_line_says("examples/prism_in_space/README.md", line, figure);
}

static void the_prism_is_pulled(void **state) {
  (void)state;
  check("tension", "3.4 ms", 58.88e3, 0.96, 1.06);
}

static void the_prism_is_pressed(void **state) {
  (void)state;
  check("compression", "6.3 ms", 620.55e3, 0.9, 1.02);
}

static void the_cylinder_is_pressed(void **state) {
  (void)state;
  check("crushed", "6.8 ms", 487.39e3, 0.9, 1.02);
}

/* The platens are two sites wide. */
static void the_cylinder_is_split(void **state) {
  (void)state;
  check("split", "4.5 ms", 193.0e3, 0.7, 1.02);
}

/* Largest load up to 3.2 ms, and the damage then. */
static void pull(const char *rotation, double *load, double *damage) {
  deck_case c;
  const char *overrides[] = {"simulation.threads=1", "simulation.end_time=3.2 ms",
                             "output.frames=0", rotation, "lattice.axis=0, 0, 1"};
  assert_true(deck_case_run(&c, "examples/prism_in_space/tension.nml", overrides, 5));
  assert_int_equal(deck_case_go(&c), STEP_END);
  const long samples = simulation_history(c.simulation, NULL);
  const double *series = deck_case_series(&c, "load");
  *load = series[largest_of(series, samples)];
  *damage = deck_case_last(&c, "energy/dissipated_damage");
  deck_case_close(&c);
}

/* A quarter turn takes the lattice and the prism to themselves. */
static void a_quarter_turn_changes_nothing(void **state) {
  (void)state;
  double load[2], damage[2];
  pull("lattice.rotation=0", &load[0], &damage[0]);
  pull("lattice.rotation=90", &load[1], &damage[1]);
  assert_true(fabs(load[1] / load[0] - 1) < 1e-9);
  assert_true(fabs(damage[1] / damage[0] - 1) < 1e-6);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_prism_is_pulled), cmocka_unit_test(the_prism_is_pressed),
      cmocka_unit_test(the_cylinder_is_pressed), cmocka_unit_test(the_cylinder_is_split),
      cmocka_unit_test(a_quarter_turn_changes_nothing)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
