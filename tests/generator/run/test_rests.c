/* Laws with a rest state, `rest stretch`. Theory: a free body takes it up without stress; a held
   one has the stress of a body without that is pressed together by as much; a virgin body stores
   the energy of being held at its reference lengths and keeps it; what is measured from the rest
   state is what the law reads. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"

#define LAW_OF(name) SOURCE_DIR "/tests/generator/run/rests/" name ".plm"
static const double growth = 1e-4;

#define HEXAGON   "kind = 'hexagonal'"
#define SQUARE    "kind = 'square' shells = 2"
#define SCATTERED "kind = 'blue_noise' horizon = 2.2"
static const char *step_safety = "0.8";
static const char *const bar_size = "'200 mm', '60 mm'";
static const char *body_size = "'200 mm', '60 mm'";
#define RELAXED "&relaxation increments = 1 tolerance = 1e-9 /\n"

static void open_bar(deck_case *c, const char *law_path, const char *lattice, double grown,
                     const char *more) {
  char text[4096];
  snprintf(text, sizeof text,
           "&simulation end_time = '100 us' step_safety = %s /\n"
           "&lattice name = 'l' %s spacing = '10 mm' thickness = '10 mm' /\n"
           "&material lattice = 'l' model = '%s' growth = %.17g /\n"
           "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = %s /\n"
           "%s",
           step_safety, lattice, law_path, grown, body_size, more);
  deck_case_open(c, text);
}

/* Largest distance of what has moved from growth times the place, measured from the first particle,
   over growth times the body's length. */
static double off_growth(const deck_case *c, double grown) {
  const sweep *w = simulation_state(c->simulation, 0);
  const rows *g = w->body->lattice;
  const double *const site[] = {g->x, g->y};
  const long first = g->particle_site[0];
  double most = 0;
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < 2; d++) {
      const long q = g->particle_site[p];
      const double moved = w->body->displacement[d][q] - w->body->displacement[d][first],
                   wanted = grown * (site[d][q] - site[d][first]);
      most = fmax(most, fabs(moved - wanted));
    }
  return most / (grown * 0.2);
}

static const struct {
  const char *what, *law_path, *lattice;
} bodies[] = {{"bonds of the hexagon", LAW_OF("grown_bond"), HEXAGON},
              {"bonds of two shells of squares", LAW_OF("grown_bond"), SQUARE},
              {"families", LAW_OF("grown_family"), HEXAGON},
              {"bonds of blue noise", LAW_OF("grown_bond"), SCATTERED}};
enum { BODIES = sizeof bodies / sizeof *bodies };

/* The body turns by nothing, so that its rows stay straight. */
static void a_free_body_grows_without_stress(void **state) {
  (void)state;
  for (int k = 0; k < BODIES; k++) {
    deck_case c;
    open_bar(&c, bodies[k].law_path, bodies[k].lattice, growth, RELAXED);
    assert_int_equal(deck_case_go(&c), STEP_END);
    const double first = deck_case_series(&c, "energy/stored")[0];
    const double off = off_growth(&c, growth), stored = deck_case_last(&c, "energy/stored");
    print_message("%s: off by %.1e of the growth; stored %.4g J at first, %.1e of it at last\n",
                  bodies[k].what, off, first, stored / first);
    assert_true(off < 1e-6 && first > 0 && stored < 1e-9 * first);
    assert_true(fabs(deck_case_last(&c, "energy/imbalance")) < 1e-3 * first);
    deck_case_close(&c);
  }
}

/* The stiffness of small strains hardly knows what bonds carry: by N/L beside EA/L, the growth. A
   small body whose rigid rotation its compressed bonds help is no unstable one. */
static void the_step_does_not_know_the_growth(void **state) {
  (void)state;
  static const double grown[] = {0, 1e-6, -1e-6, 1e-4, -1e-4, 1e-3, -1e-3, 1e-2};
  for (int k = 0; k < BODIES; k++) {
    double free_step = 0;
    for (size_t g = 0; g < sizeof grown / sizeof *grown; g++) {
      deck_case c;
      body_size = "'60 mm', '50 mm'";
      open_bar(&c, bodies[k].law_path, bodies[k].lattice, grown[g], g == 3 ? RELAXED : "");
      body_size = bar_size;
      const double step = simulation_step_limit(c.simulation)->limit;
      if (g == 0) free_step = step;
      print_message("%s: growth %g, step %.8g us\n", bodies[k].what, grown[g], 1e6 * step);
      assert_true(fabs(step / free_step - 1) <= 2 * fabs(grown[g]) + 1e-6);
      if (g == 3) {
        assert_int_equal(deck_case_go(&c), STEP_END);
        const double left = deck_case_last(&c, "energy/stored");
        assert_true(left < 1e-9 * deck_case_series(&c, "energy/stored")[0]);
      }
      deck_case_close(&c);
    }
  }
}

/* Of the same bar without growth, whose ends are pressed together by growth times the length:
   lengths differ by the growth, and so may loads. */
static void a_held_body_is_pressed(void **state) {
  (void)state;
#define ENDS                                                                                       \
  "&region name = 'left' shape = 'rectangle' corner = -1, -1 size = '1.006 m', 2 /\n"              \
  "&region name = 'right' shape = 'rectangle' corner = '194 mm', -1 size = 1, 2 /\n"               \
  "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' /\n"                   \
  "&support region = 'left' fix = 'x' /\n&drive region = 'right' component = 'x' "
  for (int k = 1; k < 3; k++) { /* bonds and families, of squares: whole columns are held */
    double load[2];
    for (int grows = 0; grows < 2; grows++) {
      char more[512];
      deck_case c;
      snprintf(more, sizeof more, RELAXED ENDS "displacement = '%.17g m' /\n",
               grows ? 0.0 : -growth * 0.2);
      open_bar(&c, bodies[k].law_path, SQUARE, grows ? growth : 0, more);
      assert_int_equal(deck_case_go(&c), STEP_END);
      load[grows] = deck_case_last(&c, "load");
      deck_case_close(&c);
    }
    print_message("%s: %.6g N held, %.6g N pressed\n", bodies[k].what, load[1], load[0]);
    assert_true(fabs(load[1]) > 100 && fabs(load[1] / load[0] - 1) < 3 * growth);
  }
}

/* A body let go at its reference lengths swings: what it stores and moves with stays what it stored
   at first, by an error that falls with the square of the step. */
static void a_body_let_go_keeps_its_energy(void **state) {
  (void)state;
  for (int k = 0; k < BODIES; k++) {
    double off[2];
    for (int fine = 0; fine < 2; fine++) {
      deck_case c;
      step_safety = fine ? "0.2" : "0.8";
      open_bar(&c, bodies[k].law_path, bodies[k].lattice, growth,
               "&output frames = 0 sample = '1 us' /\n");
      assert_int_equal(deck_case_go(&c), STEP_END);
      const double first = deck_case_series(&c, "energy/stored")[0];
      off[fine] = deck_case_largest(&c, "energy/imbalance") / first;
      assert_true(deck_case_largest(&c, "energy/kinetic") > 0.1 * first);
      deck_case_close(&c);
    }
    print_message("%s: imbalance %.1e of the energy, with a quarter of the step %.1e\n",
                  bodies[k].what, off[0], off[1]);
    assert_true(off[0] < 2e-2 && off[1] < off[0] / 8);
  }
}

/* By a state: the growth is whole after some hundred steps. What it does is no loss, and damping
   has taken what it gave (test_rest_work.c). */
static void growth_in_time_is_not_lost(void **state) {
  (void)state;
  deck_case c;
  open_bar(&c, LAW_OF("swelling_bond"), HEXAGON, growth, RELAXED);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const char *unchecked;
  simulation_imbalance(c.simulation, &unchecked);
  assert_null(unchecked);
  assert_true(off_growth(&c, growth) < 1e-5);
  assert_true(fabs(deck_case_last(&c, "energy/dissipated_damage")) < 1e-12);
  deck_case_close(&c);
}

/* --- by the temperature ----------------------------------------------------------------------- */

static const double alpha = 1.2e-5; /* 1/K */

static void open_heated(deck_case *c, const char *temperature, double spacing_mm,
                        const char *more) {
  char text[4096];
  snprintf(text, sizeof text,
           "&simulation end_time = '100 us' /\n"
           "&lattice name = 'l' kind = 'hexagonal' spacing = '%g mm' thickness = '10 mm' /\n"
           "&material lattice = 'l' model = 'thermal_bond' /\n"
           "&field lattice = 'l' name = 'T' value = '%s' /\n"
           "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '201 mm', '60 mm' /\n"
           "%s",
           spacing_mm, temperature, more);
  deck_case_open(c, text);
}

static double across_at(const deck_case *c, double x) {
  const sweep *w = simulation_state(c->simulation, 0);
  const rows *g = w->body->lattice;
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    if (fabs(g->x[q] - x) < 1e-6 && fabs(g->y[q]) < 1e-6) return w->body->displacement[1][q];
  }
  return NAN;
}

/* A temperature that is linear in the place leaves a free body without stress (every strain is
   compatible), and bends it: with a gradient g across a bar the curvature is alpha g. */
static void a_gradient_across_bends_a_bar(void **state) {
  (void)state;
  const double g = 1000; /* K/m */
  deck_case c;
  open_heated(&c, "293 [K] + 1000 [K]*y/1 [m]", 10, RELAXED);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double first = deck_case_series(&c, "energy/stored")[0],
               last = deck_case_last(&c, "energy/stored"),
               bent = across_at(&c, 0) - 2 * across_at(&c, 0.1) + across_at(&c, 0.2),
               theory = -alpha * g * 0.2 * 0.2 / 4;
  print_message(
      "second difference of the deflection %.6g, theory %.6g um; %.1e of the energy left\n",
      1e6 * bent, 1e6 * theory, last / first);
  assert_true(fabs(bent / theory - 1) < 1e-3 && last < 1e-6 * first);
  deck_case_close(&c);
}

/* Between ends that are held the stress is that of the mean temperature, wherever it is warm, but
   for what the ends hold across, which is a matter of edges: its part falls with the spacing. */
static void a_gradient_along_presses_as_its_mean(void **state) {
  (void)state;
#define HELD                                                                                       \
  RELAXED                                                                                          \
  "&region name = 'left' shape = 'rectangle' corner = -1, -1 size = '1.006 m', 2 /\n"              \
  "&region name = 'right' shape = 'rectangle' corner = '194 mm', -1 size = 1, 2 /\n"               \
  "&support region = 'left' fix = 'x' /\n&support region = 'right' fix = 'x' /\n"                  \
  "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' /\n"
  double load[2];
  for (int graded = 0; graded < 2; graded++) {
    deck_case c;
    open_heated(&c, graded ? "293 [K] + 100 [K]*x/100 [mm]" : "393 [K]", 5, HELD);
    assert_int_equal(deck_case_go(&c), STEP_END);
    load[graded] = deck_case_last(&c, "load");
    deck_case_close(&c);
  }
  const double bar = 30e9 * alpha * 100 * 0.06 * 0.01;
  print_message("%.6g N by the gradient, %.6g N by its mean; a bar %.6g N\n", load[1], load[0],
                bar);
  assert_true(fabs(load[1] / load[0] - 1) < 1e-2 && fabs(load[0]) > 0.9 * bar);
}

/* Nothing loads or holds a free body: it is in balance when little is left of the forces that its
   particles exert on each other, or, where it grows without stress, did. Rows that grow by the
   square of the height press each other; more steps change nothing. */
static void a_free_body_comes_to_balance(void **state) {
  (void)state;
  static const char *const warm[] = {"393 [K]", "293 [K] + 100 [K]*(y/60 [mm])**2*t/100 [us]"};
  for (int k = 0; k < 2; k++) {
    double stored[2];
    for (int fine = 0; fine < 2; fine++) {
      deck_case c;
      long unbalanced;
      open_heated(&c, warm[k], 10,
                  fine ? "&relaxation increments = 2 tolerance = 1e-9 /\n"
                       : "&relaxation increments = 2 /\n");
      assert_int_equal(deck_case_go(&c), STEP_END);
      assert_int_equal(simulation_increments(c.simulation, &unbalanced), 2);
      assert_int_equal(simulation_increments_within(c.simulation), 2);
      assert_int_equal(unbalanced, 0);
      stored[fine] = deck_case_last(&c, "energy/stored");
      print_message("%s: %.10g J stored, at most %.0f steps\n", warm[k], stored[fine],
                    deck_case_largest(&c, "relaxation_steps"));
      assert_true(deck_case_largest(&c, "relaxation_steps") < (fine ? 10000 : 3000));
      deck_case_close(&c);
    }
    const double held = 0.5 * 2 * 30e9 * 1.2e-3 * 1.2e-3 * 0.2 * 0.06 * 0.01; /* J, at 393 K */
    assert_true(fabs(stored[0] - stored[1]) < 1e-9 * held);
    assert_true(k == 0 ? stored[0] < 1e-9 * held : stored[0] > 1e-3 * held);
  }
}

/* A point's strain of 1e-5 (T - T_0) is not quite 0 where T is interpolated to T_0: what the first
   sample finds is rounding, no energy that steps have made. */
static void rounding_is_no_energy_from_nothing(void **state) {
  (void)state;
  deck_case c;
  deck_case_open(&c,
                 "&simulation end_time = '0.02 ms' /\n"
                 "&mesh name = 'p' corner = 0, 0 size = '40 mm', '40 mm' nodes = 5, 5 method = "
                 "'finite_elements' thickness = '100 mm' /\n"
                 "&material mesh = 'p' model = '" LAW_OF(
                     "warm_point") "' /\n"
                                     "&region name = 'left' shape = 'rectangle' corner = '-1 mm', "
                                     "'-1 mm' size = '2 mm', '60 mm' /\n"
                                     "&region name = 'right' shape = 'rectangle' corner = '39 mm', "
                                     "'-1 mm' size = '2 mm', '60 mm' /\n"
                                     "&support region = 'left' fix = 'x', 'y' /\n"
                                     "&drive region = 'right' component = 'x' displacement = "
                                     "'0.05 mm' history = 'cosine' rise = '0.02 ms' /\n"
                                     "&field name = 'T' mesh = 'p' times = 0, 1e-3, 1 values = "
                                     "'293 K', '293 K', '500 K' /\n");
  assert_int_equal(deck_case_go(&c), STEP_END);
  deck_case_close(&c);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_free_body_grows_without_stress),
      cmocka_unit_test(the_step_does_not_know_the_growth),
      cmocka_unit_test(a_held_body_is_pressed),
      cmocka_unit_test(a_body_let_go_keeps_its_energy),
      cmocka_unit_test(growth_in_time_is_not_lost),
      cmocka_unit_test(a_gradient_across_bends_a_bar),
      cmocka_unit_test(a_gradient_along_presses_as_its_mean),
      cmocka_unit_test(a_free_body_comes_to_balance),
      cmocka_unit_test(rounding_is_no_energy_from_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
