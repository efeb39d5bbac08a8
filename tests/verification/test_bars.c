/* Bars along polylines against closed forms: modulus and stable step, cantilevers turned anywhere
   in the plane and in space, a bent one that twists, a closed ring, and a bar that is pulled until
   it yields. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/analysis/stability.h"
#include "runtime/analysis/uniform_strain.h"
#include "tests/verification/case.h"

static const double E = 200e9, rho = 7850, area = 1e-4, I = 1e-9; /* Pa, kg/m^3, m^2, m^4 */
static const double F_y = 414e6, pulled = 0.4;                    /* Pa, m */

#define PI acos(-1)

/* A run of bars alone; `groups` has them and what else there is. */
static void open_bars(deck_case *c, const char *rest, const char *of_law, const char *groups) {
  char text[16000];
  const int length = snprintf(
      text, sizeof text, "&simulation end_time = 1 threads = 1 %s /\n&material bar = 'b' %s /\n%s",
      rest, of_law, groups);
  assert_true(length < (int)sizeof text);
  assert_true(deck_case_text(c, text));
}

/* --- what follows from the law ---------------------------------------------------------------- */

/* A free row of n equal masses: omega = 2 c/s cos(pi/(2 n)), the ends too. The modulus is the
   law's, of bars that are bent or closed, too, whatever their spacing. */
static void a_bar_has_its_modulus_and_step(void **state) {
  (void)state;
  static const struct {
    const char *line;
    int straight; /* particles */
  } bars[] = {
      {"points = 0, 0, 0.2, 0 spacing = 0.01", 21},
      {"points = 0.1, 0, 0.22, 0.16 spacing = 0.01", 21},
      {"points = 0, 0, 0.203, 0, 0.203, 0.1 spacing = 0.01", 0},
      {"points = 0, 0, 0.2, 0, 0.2, 0.1, 0, 0.1 closed = T spacing = 0.02", 0},
      {"points = 0, 0, 0, 0.12, 0.16, 0 setting = 'space' spacing = 0.01", 21},
      {"points = 0, 0, 0, 0.12, 0.16, 0, 0.12, 0.16, 0.3 setting = 'space' spacing = 0.01", 0}};
  for (size_t k = 0; k < sizeof bars / sizeof *bars; k++) {
    deck_case c;
    char groups[500];
    step_limit step;
    snprintf(groups, sizeof groups, "&bar name = 'b' area = %.17g %s /\n", area, bars[k].line);
    open_bars(&c, "", "model = 'bar'", groups);
    const rows *w = simulation_rows(c.simulation, 0);
    const double modulus = uniform_strain_of_bar(c.law.law, c.law.parameters, w);
    stability_limit(c.law.law, c.law.parameters, NULL, w, &step);
    const double n = bars[k].straight, theory = 2 * sqrt(E / rho) / 0.01 * cos(PI / (2 * n));
    print_message("%s: E %+.1e, largest frequency %+.1e of theory\n", bars[k].line, modulus / E - 1,
                  bars[k].straight ? step.omega_max / theory - 1 : 0);
    assert_true(fabs(modulus / E - 1) < 1e-8);
    if (bars[k].straight) assert_true(fabs(step.omega_max / theory - 1) < 1e-6);
    deck_case_close(&c);
  }
}

/* --- cantilevers ------------------------------------------------------------------------------ */

static const char *const statics =
    "/\n&relaxation increments = 1 tolerance = 1e-10 most_steps = 2000000";

/* Of the bar's last particle, in the order of the polyline; rotations follow. */
static void read_end(const deck_case *c, double u[6]) {
  const rows *w = simulation_rows(c->simulation, 0);
  const body *b = simulation_state(c->simulation, 0)->body;
  for (int d = 0; d < b->dof; d++)
    u[d] = b->displacement[d][w->particle_site[w->particle_count - 1]];
}

/* P L^3/(3 EI) and P L^2/(2 EI) across the bar, at any angle and for any number of bonds. */
static void a_turned_cantilever_bends_as_theory_says(void **state) {
  (void)state;
  const double L = 0.32, P = 3e-6 * E * I / (L * L);
  for (int k = 0; k < 4; k++) {
    const double angle = (10 + 50 * k) * PI / 180, way[2] = {-sin(angle), cos(angle)};
    const int bonds = 2 << k;
    char groups[2000];
    double u[6];
    deck_case c;
    snprintf(groups, sizeof groups,
             "&bar name = 'b' area = %.17g points = 0.1, 0.1, %.17g, %.17g spacing = %.17g /\n"
             "&region name = 'held' shape = 'point' at = 0.1, 0.1 /\n"
             "&region name = 'end' shape = 'point' at = %.17g, %.17g /\n"
             "&support region = 'held' fix = 'xy', 'rotation' /\n"
             "&force region = 'end' component = 'x' total = %.17g /\n"
             "&force region = 'end' component = 'y' total = %.17g /\n",
             area, 0.1 + L * cos(angle), 0.1 + L * sin(angle), L / bonds, 0.1 + L * cos(angle),
             0.1 + L * sin(angle), P * way[0], P * way[1]);
    open_bars(&c, statics, "model = 'beam' I = 1e-9", groups);
    assert_int_equal(deck_case_go(&c), STEP_END);
    read_end(&c, u);
    const double across = (u[0] * way[0] + u[1] * way[1]) / (P * L * L * L / (3 * E * I)),
                 turned = u[2] / (P * L * L / (2 * E * I));
    print_message("%d bonds at %.0f degrees: deflection %+.1e, rotation %+.1e of theory\n", bonds,
                  angle * 180 / PI, across - 1, turned - 1);
    assert_true(fabs(across - 1) < 1e-6 && fabs(turned - 1) < 1e-6);
    deck_case_close(&c);
  }
}

/* A bar in space from x = 0 along x for a, then along y for b, loaded at its end along z: bending
   of both legs, and the first one twists: w = P a^3/(3 EI) + P b^3/(3 EI) + P b^2 a/GJ, GJ = EI.
   The steel bar's law says EI by its area. */
static void a_bent_bar_bends_and_twists(void **state) {
  (void)state;
  const double a = 0.12, b = 0.08, EI = E * area * area / (4 * PI), P = 1e-5 * EI / (a * a);
  char groups[2000];
  double u[6];
  deck_case c;
  snprintf(groups, sizeof groups,
           "&bar name = 'b' area = %.17g points = 0, 0, 0, %g, 0, 0, %g, %g, 0 setting = 'space' "
           "spacing = 0.02 /\n"
           "&region name = 'held' shape = 'point' at = 0, 0, 0 /\n"
           "&region name = 'end' shape = 'point' at = %g, %g, 0 /\n"
           "&support region = 'held' fix = 'xyz', 'rotation' /\n"
           "&force region = 'end' component = 'z' total = %.17g /\n",
           area, a, a, b, a, b, P);
  open_bars(&c, statics, "model = 'steel_bar' zeta = 0", groups);
  assert_int_equal(deck_case_go(&c), STEP_END);
  read_end(&c, u);
  const double theory = P * (a * a * a + b * b * b) / (3 * EI) + P * b * b * a / EI,
               twist = P * b * a / EI + P * b * b / (2 * EI), turned = -P * a * a / (2 * EI);
  print_message("bent bar: deflection %+.1e, rotations %+.1e, %+.1e of theory\n", u[2] / theory - 1,
                u[3] / twist - 1, u[4] / turned - 1);
  assert_true(fabs(u[2] / theory - 1) < 1e-6);
  assert_true(fabs(u[3] / twist - 1) < 1e-6 && fabs(u[4] / turned - 1) < 1e-6);
  deck_case_close(&c);
}

/* --- a ring ----------------------------------------------------------------------------------- */

/* Pulled apart at two opposite particles; how much wider it gets over what a circle would:
   P R^3/EI (pi/4 - 2/pi) + P R/EA pi/4. */
static double ring_of(int corners) {
  const double R = 0.1, P = 1e-5 * E * I / (R * R);
  char groups[12000];
  double u[6];
  deck_case c;
  int n = snprintf(groups, sizeof groups,
                   "&bar name = 'b' area = %.17g closed = T spacing = %.17g points =", area,
                   2 * R * sin(PI / corners) * (1 - 1e-9));
  for (int k = 0; k < corners; k++)
    n += snprintf(groups + n, sizeof groups - (size_t)n, "%s %.17g, %.17g", k ? "," : "",
                  R * cos(2 * PI * k / corners), R * sin(2 * PI * k / corners));
  snprintf(groups + n, sizeof groups - (size_t)n,
           " /\n&region name = 'right' shape = 'point' at = %g, 0 within = 1e-4 /\n"
           "&region name = 'left' shape = 'point' at = %g, 0 within = 1e-4 /\n"
           "&support region = 'left' fix = 'xy', 'rotation' /\n"
           "&force region = 'right' component = 'x' total = %.17g /\n"
           "&monitor name = 'wider' kind = 'displacement' region = 'right' component = 'x' /\n",
           R, -R, P);
  open_bars(&c, statics, "model = 'beam' I = 1e-9", groups);
  assert_int_equal(simulation_rows(c.simulation, 0)->particle_count, corners);
  assert_int_equal(simulation_rows(c.simulation, 0)->bond_count, corners);
  assert_int_equal(deck_case_go(&c), STEP_END);
  u[0] = deck_case_series(&c, "wider")[simulation_history(c.simulation, NULL) - 1];
  deck_case_close(&c);
  return u[0] / (P * R * R * R / (E * I) * (PI / 4 - 2 / PI) + P * R / (E * area) * PI / 4);
}

/* A polygon is a circle but for an error that falls with the square of its sides. */
static void a_ring_gets_wider_as_a_circle_does(void **state) {
  (void)state;
  double before = 0;
  for (int corners = 24; corners <= 96; corners *= 2) {
    const double off = fabs(ring_of(corners) - 1);
    print_message("ring of %d bonds: %.2e off the circle\n", corners, off);
    assert_true(corners == 24 || (off < before / 3.8 && off > before / 4.2));
    before = off;
  }
  assert_true(before < 1e-3);
}

/* --- yield ------------------------------------------------------------------------------------ */

/* Of theory; 0: the same. */
typedef struct yielding {
  double force, slope, stays;
} yielding;

/* Pulled by its end to 4 times the elastic way, and half of that back, in so many increments: the
   force is A F_y and goes on along E H/(E + H); back it falls along E A/L, and what stays when it
   is gone is what was pulled less the elastic part. */
static yielding pull(double H, int increments) {
  char groups[2000], of_law[200];
  deck_case c;
  snprintf(groups, sizeof groups,
           "&bar name = 'b' area = %.17g points = 0, 0.01, %g, 0.01 spacing = 0.02 /\n"
           "&region name = 'held' shape = 'point' at = 0, 0.01 /\n"
           "&region name = 'end' shape = 'point' at = %g, 0.01 /\n"
           "&support region = 'held' fix = 'xy', 'rotation' /\n"
           "&support region = 'end' fix = 'y', 'rotation' /\n"
           "&drive region = 'end' component = 'x' displacement = %.17g times = 0, 0.5, 1 values = "
           "0, 1, 0.5 /\n"
           "&monitor name = 'load' kind = 'reaction' region = 'end' component = 'x' /\n"
           "&monitor name = 'u' kind = 'displacement' region = 'end' component = 'x' /\n"
           "&relaxation increments = %d tolerance = 1e-9 most_steps = 2000000 /\n",
           area, pulled, pulled, 4 * F_y / E * pulled, increments);
  snprintf(of_law, sizeof of_law, "model = 'steel_bar' zeta = 0 H = %.17g", H);
  open_bars(&c, "", of_law, groups);
  assert_int_equal(deck_case_go(&c), STEP_END);
  assert_int_equal(simulation_history(c.simulation, NULL), increments + 1);
  const double *load = deck_case_series(&c, "load"), *u = deck_case_series(&c, "u");
  const int top = increments / 2, from = top + increments / 20, to = top + increments / 5;
  const double full = 1 + 3 * H / (E + H), soft = pulled / (E * area);
  const yielding found = {load[top] / (area * F_y) / full - 1,
                          (load[to] - load[from]) / (u[to] - u[from]) * soft - 1,
                          (u[to] - load[to] * soft) / (F_y / E * pulled) / (4 - full) - 1};
  deck_case_close(&c);
  return found;
}

/* In an increment the bar swings about where it comes to rest, and bonds yield before they do at
   rest: without hardening the next increment makes that good, with hardening it halves with the
   increments. */
static void a_bar_yields_and_unloads(void **state) {
  (void)state;
  const yielding plastic = pull(0, 200);
  print_message("force %+.1e, unloading slope %+.1e, what stays %+.1e of theory\n", plastic.force,
                plastic.slope, plastic.stays);
  assert_true(fabs(plastic.force) < 1e-6 && fabs(plastic.slope) < 1e-6);
  assert_true(fabs(plastic.stays) < 1e-6);
  yielding before = {0};
  for (int increments = 100; increments <= 400; increments *= 2) {
    const yielding now = pull(10e9, increments);
    print_message("hardening, %d increments: force %+.1e, slope %+.1e, what stays %+.1e\n",
                  increments, now.force, now.slope, now.stays);
    assert_true(fabs(now.slope) < 1e-6 && fabs(now.force) < 1e-2 && fabs(now.stays) < 1e-2);
    assert_true(increments == 100 || (fabs(now.force) < 0.6 * fabs(before.force) &&
                                      fabs(now.stays) < 0.6 * fabs(before.stays)));
    before = now;
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_bar_has_its_modulus_and_step),
      cmocka_unit_test(a_turned_cantilever_bends_as_theory_says),
      cmocka_unit_test(a_bent_bar_bends_and_twists),
      cmocka_unit_test(a_ring_gets_wider_as_a_circle_does),
      cmocka_unit_test(a_bar_yields_and_unloads),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
