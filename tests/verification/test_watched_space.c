/* A free ball of a micropolar lattice that turns about an oblique axis and vibrates: its monitors
   of momentum and angular momentum stand still, and their energies are the ledger's. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"

static const char deck_text[] =
    "&simulation end_time = 2e-4 /\n"
    "&lattice name = 'l' spacing = 0.01 kind = 'fcc' shells = 2 rotation = 20 axis = 1, 1, 0 /\n"
    "&material lattice = 'l' model = 'mplm_space' /\n"
    "&body lattice = 'l' shape = 'sphere' centre = 3*0 radius = 0.04 /\n"
    "&monitor name = 'Lx' kind = 'angular_momentum' component = 'x' about = 0.1, 0.2, -0.1 /\n"
    "&monitor name = 'Ly' kind = 'angular_momentum' component = 'y' about = 0.1, 0.2, -0.1 /\n"
    "&monitor name = 'Lz' kind = 'angular_momentum' component = 'z' about = 0.1, 0.2, -0.1 /\n"
    "&monitor name = 'pz' kind = 'momentum' component = 'z' /\n"
    "&monitor name = 'kinetic' kind = 'energy' component = 'kinetic' /\n"
    "&monitor name = 'stored' kind = 'energy' component = 'stored' /\n"
    "&output frames = 0 sample = 1e-5 /\n";

static const double turn[3] = {30, -20, 40}; /* rad/s */

static void spin(body *b) {
  const rows *g = b->lattice;
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    const double at[3] = {g->x[q], g->y[q], g->z[q]};
    for (int a = 0; a < 3; a++) {
      const int n = (a + 1) % 3, m = (a + 2) % 3;
      b->velocity[a][q] = turn[n] * at[m] - turn[m] * at[n] + 0.2 * sin(150 * at[n] + a);
      b->velocity[3 + a][q] = turn[a] + 20 * sin(120 * at[m]);
    }
  }
}

/* Moments of inertia of particles are alike about all axes. */
static double expected_angular(const body *b, int axis) {
  static const double about[3] = {0.1, 0.2, -0.1};
  const rows *g = b->lattice;
  const int n = (axis + 1) % 3, m = (axis + 2) % 3;
  double sum = 0;
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    const double at[3] = {g->x[q], g->y[q], g->z[q]};
    sum += b->mass[0] *
               ((at[n] - about[n]) * b->velocity[m][q] - (at[m] - about[m]) * b->velocity[n][q]) +
           b->mass[3] * b->velocity[3 + axis][q];
  }
  return sum;
}

static void a_spinning_ball_keeps_its_momenta(void **state) {
  (void)state;
  static const char *const names[] = {"Lx", "Ly", "Lz"};
  deck_case c;
  double expected[3], largest = 0;
  assert_true(deck_case_text(&c, deck_text));
  body *b = simulation_state(c.simulation, 0)->body;
  assert_int_equal(b->dof, 6);
  spin(b);
  for (int a = 0; a < 3; a++) {
    expected[a] = expected_angular(b, a);
    largest = fmax(largest, fabs(expected[a]));
  }
  assert_int_equal(deck_case_go(&c), STEP_END);
  const long samples = simulation_history(c.simulation, NULL);
  assert_true(samples > 10);
  for (long k = 0; k < samples; k++) {
    const double kinetic = deck_case_series(&c, "energy/kinetic")[k],
                 stored = deck_case_series(&c, "energy/stored")[k];
    for (int a = 0; a < 3; a++)
      assert_true(fabs(deck_case_series(&c, names[a])[k] - expected[a]) < 1e-12 * largest);
    assert_true(fabs(deck_case_series(&c, "pz")[k] - deck_case_series(&c, "pz")[0]) <
                1e-12 * b->lattice->mass * (double)b->lattice->particle_count);
    assert_true(fabs(deck_case_series(&c, "kinetic")[k] - kinetic) < 1e-12 * kinetic);
    assert_true(fabs(deck_case_series(&c, "stored")[k] - stored) <= 1e-12 * stored);
  }
  deck_case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_spinning_ball_keeps_its_momenta)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
