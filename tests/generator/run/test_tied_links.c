/* Bars tied to places: pulled out of a rigid block against closed forms, of a bond that is linear
   and of the Model Code's; no force in rigid motions; momentum, energies and the stable step. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/analysis/bar_force.h"
#include "runtime/parts/run_link.h"
#include "runtime/simulation/simulation_state.h"
#include "tests/verification/case.h"
#include "tests/verification/long_bar.h"

enum { CONCRETE, BAR, LINK };

/* --- pulled out ------------------------------------------------------------------------------- */

static const double length = 0.3;

/* The block is held, so that places do not move. */
#define PULL                                                                                       \
  "&lattice name = 'c' kind = 'hexagonal' spacing = '20 mm' thickness = '120 mm' /\n"              \
  "&body lattice = 'c' shape = 'rectangle' corner = '-40 mm', '-60 mm' size = '400 mm', "          \
  "'120 mm' /\n&material lattice = 'c' model = 'elastic_micropolar' /\n"                           \
  "&region name = 'block' lattice = 'c' shape = 'rectangle' corner = -1, -1 size = 3, 3 /\n"       \
  "&support region = 'block' fix = 'x', 'y', 'rotation' /\n"                                       \
  "&bar name = 'b' points = 0, '3 mm', '300 mm', '3 mm' spacing = '%g mm' diameter = '12.7 mm' "   \
  "/\n&material bar = 'b' model = 'steel_bar' %s zeta = 0 /\n"                                     \
  "&link name = 'l' bar = 'b' lattice = 'c' to = 'place' every = %d /\n"                           \
  "&material link = 'l' model = 'bond_slip' /\n"                                                   \
  "&region name = 'end' lattice = 'b' shape = 'rectangle' corner = '-1 mm', -1 size = '2 mm', 2 "  \
  "/\n&monitor name = 'F' kind = 'reaction' region = 'end' component = 'x' scale = -1 /\n"         \
  "&output frames = 0 energy = F /\n"
#define AT_REST                                                                                    \
  "&simulation end_time = 1 /\n&relaxation increments = 1 tolerance = 1e-9 /\n"                    \
  "&drive region = 'end' component = 'x' displacement = -1e-7 /\n"
/* Slowly: in a quasi-static run the bond would slip to and fro in each increment. */
#define IN_MOTION                                                                                  \
  "&simulation end_time = %g step_safety = 0.9 threads = 1 /\n&damping rate = 4000 /\n"            \
  "&drive region = 'end' component = 'x' velocity = -%g rise = 1e-3 /\n"
#define STEEL "F_y = '40 GPa'"
/* Out of the way that the ramp of the velocity leaves. */
static double time_to(double way, double speed) {
  return way / speed + 0.5e-3;
}

static double pull_of(const char *motion, double spacing, int every, const char *bar) {
  deck_case c;
  char text[4096];
  const int head = snprintf(text, sizeof text, "%s", motion);
  snprintf(text + head, sizeof text - (size_t)head, PULL, 1e3 * spacing, bar, every);
  deck_case_open(&c, text);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double force = deck_case_last(&c, "F");
  deck_case_close(&c);
  return force;
}

static double pulled_to(double way, double speed, double spacing, int every, const char *bar) {
  char motion[512];
  snprintf(motion, sizeof motion, IN_MOTION, time_to(way, speed), speed);
  return pull_of(motion, spacing, every, bar);
}

/* Slips so small that the bond is a spring of K on the bar's surface: with lambda^2 = 4 K/(E d)
   F = E A lambda u tanh(lambda l). */
static void a_linear_bond_holds_as_its_closed_form(void **state) {
  (void)state;
  static const double spacings[] = {0.02, 0.01, 0.005};
  const double u = 1e-7, lambda = sqrt(4 * bond_line / (bar_E * bar_diameter)),
               exact = bar_E * bar_area() * lambda * u * tanh(lambda * length);
  double error[3];
  for (int n = 0; n < 3; n++) {
    error[n] = fabs(pull_of(AT_REST, spacings[n], 1, STEEL) / exact - 1);
    print_message("spacing %g mm: %.2e\n", 1e3 * spacings[n], error[n]);
  }
  assert_true(error[0] < 2e-2);
  assert_true(error[1] < 0.27 * error[0] && error[2] < 0.27 * error[1]);
}

/* What monitors say of it: with u(x) = u cosh(lambda (l - x))/cosh(lambda l) the slip, the tension
   is E A u', in the bond whose middle is there. */
static void slip_and_tension_are_the_closed_form(void **state) {
  (void)state;
  static const double spacings[] = {0.02, 0.01, 0.005};
  const double u = 1e-7, lambda = sqrt(4 * bond_line / (bar_E * bar_diameter)),
               scale = u / cosh(lambda * length), EA = bar_E * bar_area();
  double before[3] = {0, 0, 0};
  for (int n = 0; n < 3; n++) {
    const double s = spacings[n], middle = (floor(0.103 / s) + 0.5) * s,
                 exact[3] = {scale * cosh(lambda * (length - 0.1)),
                             EA * lambda * scale * sinh(lambda * (length - middle)),
                             EA * lambda * scale * sinh(lambda * (length - s / 2))};
    deck_case c;
    char text[4096];
    snprintf(text, sizeof text,
             AT_REST "&monitor name = 's' kind = 'slip' lattice = 'l' at = 0.1, 0.003 /\n"
                     "&monitor name = 's_most' kind = 'slip' lattice = 'l' /\n"
                     "&monitor name = 'N' kind = 'bar_force' lattice = 'b' at = 0.103, 0.003 /\n"
                     "&monitor name = 'N_most' kind = 'bar_force' lattice = 'b' /\n" PULL,
             1e3 * s, STEEL, 1);
    deck_case_open(&c, text);
    assert_int_equal(deck_case_go(&c), STEP_END);
    const double found[3] = {deck_case_last(&c, "s"), deck_case_last(&c, "N"),
                             deck_case_last(&c, "N_most")};
    assert_true(fabs(deck_case_last(&c, "s_most") / u - 1) < 1e-9);
    deck_case_close(&c);
    for (int k = 0; k < 3; k++) {
      const double error = fabs(found[k] / exact[k] - 1);
      print_message("spacing %g mm: %.6g, closed form %.6g, %.1e\n", 1e3 * s, found[k], exact[k],
                    error);
      assert_true(error < 0.1 && (n == 0 || error < 0.3 * before[k]));
      before[k] = error;
    }
  }
}

/* The power law along a bar that is long enough. */
static void the_model_code_holds_as_its_closed_form(void **state) {
  (void)state;
  const double u = 4e-5, exact = long_bar_force(u), found = pulled_to(u, 0.01, 0.005, 1, STEEL);
  print_message("%.1f N, closed form %.1f N; the line ends at %.5f mm\n", found, exact,
                1e3 * bond_line_end());
  assert_true(fabs(bond_line_end() - 1.07e-5) < 1e-7);
  assert_true(fabs(found / exact - 1) < 3e-4); /* models/README.md: 0.03 % */
}

/* A stiff bar slips as a whole: tau_max over its surface at s_1, whichever particles are tied. */
static void a_short_bar_slips_as_a_whole(void **state) {
  (void)state;
  const double speed = 0.1, drag = 4000 * 7850 * bar_area() * length * speed, /* mass damping */
      exact = bond_tau_max() * M_PI * bar_diameter * length + drag;
  static const int every[] = {1, 2, 5};
  for (int n = 0; n < 3; n++) {
    const double found = pulled_to(1.5e-3, speed, 0.02, every[n], "E = '2e4 GPa' F_y = '1e4 GPa'");
    print_message("every %d: %.8g of tau_max\n", every[n], found / exact);
    assert_true(fabs(found / exact - 1) < 1e-4);
  }
}

/* --- motions ---------------------------------------------------------------------------------- */

#define FREE                                                                                       \
  "&simulation end_time = '%g ms' step_safety = %g threads = 1 /\n"                                \
  "&output frames = 0 losses = T energy = T /\n"                                                   \
  "&lattice name = 'c' kind = 'hexagonal' spacing = '20 mm' thickness = '120 mm' /\n"              \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = '300 mm', '80 mm' /\n"             \
  "&material lattice = 'c' model = 'elastic_micropolar' /\n"                                       \
  "&bar name = 'b' points = '11 mm', '23 mm', '281 mm', '49 mm' spacing = '10 mm' diameter = "     \
  "'12.7 mm' /\n&material bar = 'b' model = 'steel_bar' zeta = 0 /\n"                              \
  "&link name = 'l' bar = 'b' lattice = 'c' to = 'place' /\n"                                      \
  "&material link = 'l' model = 'bond_slip' /\n"                                                   \
  "&region name = 'all' lattice = 'c' shape = 'rectangle' corner = -1, -1 size = 3, 3 /\n"         \
  "&initial_velocity region = 'all' component = 'x' value = '%g [m/s]*y/0.08 [m]' /\n"

static body *body_of(const deck_case *c, int lattice) {
  return simulation_state(c->simulation, lattice)->body;
}

static void turn_all(const deck_case *c, double angle) {
  for (int n = CONCRETE; n <= BAR; n++) {
    body *b = body_of(c, n);
    for (long p = 0; p < b->lattice->particle_count; p++) {
      const long q = b->lattice->particle_site[p];
      const double x = b->lattice->x[q], y = b->lattice->y[q];
      b->displacement[0][q] = x * cos(angle) - y * sin(angle) - x + 3;
      b->displacement[1][q] = x * sin(angle) + y * cos(angle) - y - 2;
      b->displacement[2][q] = angle;
    }
  }
}

static void rigid_motions_cause_no_force(void **state) {
  (void)state;
  deck_case c;
  char text[4096];
  snprintf(text, sizeof text, FREE, 0.3, 0.5, 0.0);
  deck_case_open(&c, text);
  run_link *link = &c.simulation->links[0];
  const sweep *bond = simulation_law_state(c.simulation, LINK);
  const double scale = bar_E * bar_area(); /* N: E A, or of the bond K pi d l times a spacing */
  for (int n = 1; n <= 4; n++) {
    turn_all(&c, 1.3 * n);
    link->known = false;
    run_link_begin(link);
    for (int d = 0; d < 2; d++)
      for (long q = 0; q < bond->lattice->size; q++)
        assert_true(fabs(bond->force[d][q]) < 1e-12 * scale);
  }
  deck_case_close(&c);
}

/* Momentum along x and y of all, and its scale. */
static double momentum_in(const deck_case *c, double sum[2]) {
  double scale = 0;
  sum[0] = sum[1] = 0;
  for (int n = CONCRETE; n <= BAR; n++) {
    const body *b = body_of(c, n);
    for (int d = 0; d < 2; d++)
      for (long p = 0; p < b->lattice->particle_count; p++) {
        const long q = b->lattice->particle_site[p];
        const double part = body_mass(b, d, q) * b->velocity[d][q];
        sum[d] += part;
        scale += fabs(part);
      }
  }
  return scale;
}

/* Angular momentum about the origin, of places and velocities as the steps have them: places of the
   instant, velocities half a step before it, which forces through one line change by nothing. */
static double spin_in(const deck_case *c) {
  double sum = 0;
  for (int n = CONCRETE; n <= BAR; n++) {
    const body *b = body_of(c, n);
    for (long p = 0; p < b->lattice->particle_count; p++) {
      const long q = b->lattice->particle_site[p];
      const double x = b->lattice->x[q] + b->displacement[0][q],
                   y = b->lattice->y[q] + b->displacement[1][q];
      sum += body_mass(b, 0, q) * (x * b->velocity[1][q] - y * b->velocity[0][q]) +
             body_mass(b, 2, q) * b->velocity[2][q];
    }
  }
  return sum;
}

/* Slips on the way: what they take is booked, and the sum closes better with the square of the
   step. */
static void momentum_and_energies_balance(void **state) {
  (void)state;
  static const double safety[] = {0.8, 0.2};
  double imbalance[2];
  for (int n = 0; n < 2; n++) {
    deck_case c;
    char text[4096];
    double before[2], after[2];
    snprintf(text, sizeof text, FREE, 0.3, safety[n], 20.0);
    deck_case_open(&c, text);
    assert_int_equal(simulation_advance(c.simulation, 1, NULL), STEP_OK);
    momentum_in(&c, before);
    const double spin = spin_in(&c);
    assert_int_equal(deck_case_go(&c), STEP_END);
    const double scale = momentum_in(&c, after);
    for (int d = 0; d < 2; d++)
      assert_true(fabs(after[d] - before[d]) < 1e-12 * scale);
    assert_true(fabs(spin_in(&c) - spin) < 1e-12 * scale * 0.3);
    const double kinetic = deck_case_largest(&c, "energy/kinetic");
    imbalance[n] = deck_case_largest(&c, "energy/imbalance") / kinetic;
    print_message("at %g: imbalance %.1e, slip took %.1e of the energy\n", safety[n], imbalance[n],
                  deck_case_last(&c, "l/dissipated_damage") / kinetic);
    assert_true(deck_case_last(&c, "l/dissipated_damage") > 1e-3 * kinetic);
    deck_case_close(&c);
  }
  assert_true(imbalance[0] < 1e-2);
  assert_true(imbalance[1] < 0.15 * imbalance[0]);
}

/* At just less than the stable step small motions stay small for long. */
static void the_step_is_stable(void **state) {
  (void)state;
  deck_case c;
  char text[4096];
  snprintf(text, sizeof text, FREE, 30.0, 0.999, 1e-5);
  deck_case_open(&c, text);
  assert_int_equal(deck_case_go(&c), STEP_END);
  assert_true(deck_case_stays_below(&c, 1.5));
  deck_case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_linear_bond_holds_as_its_closed_form),
                                     cmocka_unit_test(slip_and_tension_are_the_closed_form),
                                     cmocka_unit_test(the_model_code_holds_as_its_closed_form),
                                     cmocka_unit_test(a_short_bar_slips_as_a_whole),
                                     cmocka_unit_test(rigid_motions_cause_no_force),
                                     cmocka_unit_test(momentum_and_energies_balance),
                                     cmocka_unit_test(the_step_is_stable)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
