/* Laws of continua with a rest state, `rest strain`, on meshes. Theory: a free body takes it up
   without stress, whatever its cells are; so it does where it is linear in the place, and bends; a
   held bar has the stress of one that is pressed together by as much; of two layers that grow
   differently the curvature is Timoshenko's (1925), with an error that falls with the size of the
   cells. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/verification/case.h"

static const double ALPHA = 1.2e-5; /* 1/K */
static const double HOT = 100;      /* K above what the body is without strain */

#define ELEMENTS "method = 'finite_elements'"
#define BAR      "size = '200 mm', '40 mm' thickness = '10 mm'"

/* A bar of 20 x 4 cells or finer that nothing holds. */
static int finer = 1; /* times as many cells along either axis */
static const char *comes_to_rest = "&relaxation increments = 1 tolerance = 1e-10 /\n";

static void open_bar(deck_case *c, const char *mesh, const char *temperature, const char *more) {
  char text[4096];
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n"
           "%s"
           "&mesh name = 'bar' corner = 0, 0 " BAR " nodes = %d, %d %s /\n"
           "&material mesh = 'bar' model = 'thermal_elastic' /\n"
           "&field mesh = 'bar' name = 'T' value = '%s' /\n%s",
           comes_to_rest, 20 * finer + 1, 4 * finer + 1, mesh, temperature, more);
  deck_case_open(c, text);
}

static const body *body_of(const deck_case *c) {
  return simulation_state(c->simulation, 0)->body;
}

/* Largest distance of what has moved from `growth` times the place, measured from the first node,
   over growth times the body's length. */
static double off_growth(const deck_case *c, double growth) {
  const body *w = body_of(c);
  const rows *g = w->lattice;
  const double *const site[] = {g->x, g->y};
  const long first = g->particle_site[0];
  double most = 0;
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < 2; d++) {
      const long q = g->particle_site[p];
      const double moved = w->displacement[d][q] - w->displacement[d][first];
      most = fmax(most, fabs(moved - growth * (site[d][q] - site[d][first])));
    }
  return most / (growth * 0.2);
}

static double moved_at(const deck_case *c, int d, double x, double y) {
  const body *w = body_of(c);
  const rows *g = w->lattice;
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    if (fabs(g->x[q] - x) < 1e-6 && fabs(g->y[q] - y) < 1e-6) return w->displacement[d][q];
  }
  return NAN;
}

static const struct {
  const char *what, *mesh;
  bool plane_strain;
} meshes[] = {
    {"squares", ELEMENTS, false},
    {"squares in plane strain", ELEMENTS " setting = 'plane_strain'", true},
    {"squares of one point", ELEMENTS " gauss = 1 hourglass = 0.05", false},
    {"mean dilatation", ELEMENTS " dilatation = 'mean' setting = 'plane_strain'", true},
    {"element-free cells", "method = 'element_free' support = 2.1", false},
};
enum { MESHES = sizeof meshes / sizeof *meshes };

/* In plane strain what is held across grows in the plane, too, by nu alpha dT. */
static void a_free_mesh_grows_without_stress(void **state) {
  (void)state;
  for (int k = 0; k < MESHES; k++) {
    deck_case c;
    const double growth = ALPHA * HOT * (meshes[k].plane_strain ? 1.2 : 1),
                 across = meshes[k].plane_strain ? 30e9 * pow(ALPHA * HOT, 2) / 2 * 8e-5 : 0;
    open_bar(&c, meshes[k].mesh, "393 K", "");
    assert_int_equal(deck_case_go(&c), STEP_END);
    const double first = deck_case_series(&c, "energy/stored")[0],
                 left = deck_case_last(&c, "energy/stored") - across, off = off_growth(&c, growth);
    print_message("%s: off by %.1e of the growth; stored %.4g J at first, %.1e of it at last\n",
                  meshes[k].what, off, first, left / first);
    assert_true(off < 1e-8 && first > 0 && fabs(left) < 1e-12 * first);
    deck_case_close(&c);
  }
}

/* Second difference of the deflection of the lower edge over `way` to either side of the middle. */
static double bent(const deck_case *c, double way) {
  return moved_at(c, 1, 0.1 - way, 0) - 2 * moved_at(c, 1, 0.1, 0) + moved_at(c, 1, 0.1 + way, 0);
}

/* A temperature that is linear in the place leaves no stress, and bends the bar by alpha times the
   gradient; bilinear elements are stiffer in bending by an error of second order. */
static void a_gradient_across_bends_a_bar(void **state) {
  (void)state;
  double off[2];
  for (finer = 1; finer < 3; finer++) {
    deck_case c;
    open_bar(&c, ELEMENTS, "293 [K] + 1000 [K]*y/1 [m]", "");
    assert_int_equal(deck_case_go(&c), STEP_END);
    off[finer - 1] = fabs(bent(&c, 0.1) / (-ALPHA * 1000 * 0.1 * 0.1) - 1);
    print_message("curvature off by %.2e of alpha times the gradient\n", off[finer - 1]);
    deck_case_close(&c);
  }
  finer = 1;
  assert_true(off[0] < 5e-2 && off[0] / off[1] > 3.5);
}

/* Of two layers with thicknesses of the ratio m and moduli of the ratio n, lower over upper
   (Timoshenko 1925, eq 4); positive where the lower one grows more. */
static double curvature_of_layers(double m, double n, double grown_more, double height) {
  const double square = (1 + m) * (1 + m);
  return 6 * grown_more * square / (height * (3 * square + (1 + m * n) * (m * m + 1 / (m * n))));
}

/* Away from the ends, where the layers shear each other. */
static void two_layers_bend_as_timoshenko_says(void **state) {
  (void)state;
  const double theory = curvature_of_layers(1.0 / 3, 3, 1.2e-5 * HOT, 0.04) * 0.04 * 0.04;
  double off[2];
  for (finer = 1; finer < 3; finer++) {
    deck_case c;
    open_bar(&c, ELEMENTS, "393 K",
             "&material mesh = 'bar' region = 'lower' model = 'thermal_elastic' E = '90 GPa' "
             "alpha = '2.4e-5 1/K' /\n"
             "&region name = 'lower' shape = 'rectangle' corner = '-1 mm', '-1 mm' size = "
             "'202 mm', '11 mm' /\n");
    assert_int_equal(deck_case_go(&c), STEP_END);
    off[finer - 1] = fabs(bent(&c, 0.04) / theory - 1);
    print_message("curvature off by %.2e of Timoshenko's\n", off[finer - 1]);
    deck_case_close(&c);
  }
  finer = 1;
  assert_true(off[0] < 5e-2 && off[0] / off[1] > 3.5);
}

#define ENDS                                                                                       \
  "&region name = 'left' shape = 'rectangle' corner = '-1 mm', '-1 mm' size = '2 mm', '42 mm' /\n" \
  "&region name = 'right' shape = 'rectangle' corner = '199 mm', '-1 mm' size = '2 mm', '42 mm' "  \
  "/\n"                                                                                            \
  "&support region = 'left' fix = 'x' /\n&support region = 'right' fix = 'x' /\n"                  \
  "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' /\n"

/* Free across: -E alpha dT. Where it is warm does not matter, only the mean. */
static void a_held_bar_is_pressed(void **state) {
  (void)state;
  static const char *const temperature[] = {"393 K", "293 [K] + 1000 [K]*x/1 [m]"};
  for (int graded = 0; graded < 2; graded++) {
    deck_case c;
    open_bar(&c, ELEMENTS, temperature[graded], ENDS);
    assert_int_equal(deck_case_go(&c), STEP_END);
    const double load = deck_case_last(&c, "load"), theory = 30e9 * ALPHA * HOT * 0.04 * 0.01;
    print_message("%.10g N, theory %.10g N\n", load, theory);
    assert_true(fabs(fabs(load) / theory - 1) < (graded ? 1e-2 : 1e-8));
    deck_case_close(&c);
  }
}

/* --- solved ----------------------------------------------------------------------------------- */

#define FEET                                                                                       \
  "&region name = 'foot' shape = 'point' at = 0, 0 /\n"                                            \
  "&region name = 'toe' shape = 'point' at = '200 mm', 0 /\n"                                      \
  "&support region = 'foot' fix = 'xy' /\n&support region = 'toe' fix = 'y' /\n"

static void solve(int increments) {
  static char text[100];
  snprintf(text, sizeof text, "&static increments = %d /\n", increments);
  comes_to_rest = text;
}

/* K u = F with what the points push by: a mesh that only stands grows, one that is held is pressed,
   both to rounding, whether the heat comes at once or in parts. What is given to the held one as it
   warms up is what it stores; what was there from the start is let go. */
static void equations_are_solved_exactly(void **state) {
  (void)state;
  const double load = 30e9 * ALPHA * HOT * 0.04 * 0.01, held = load * ALPHA * HOT * 0.2 / 2,
               first = 2 * held / (1 - 0.2); /* nothing has moved */
  for (int parts = 1; parts < 5; parts += 3)
    for (int k = 0; k < 4; k++) { /* warm, warming up; standing, held */
      const bool warms = k % 2, is_held = k / 2;
      deck_case c;
      solve(parts);
      open_bar(&c, ELEMENTS, warms ? "293 [K] + 100 [K]*t/1 [s]" : "393 K",
               is_held ? FEET ENDS : FEET);
      assert_int_equal(deck_case_go(&c), STEP_END);
      const double stored = deck_case_last(&c, "energy/stored"),
                   rest = deck_case_last(&c, "energy/rest"),
                   taken = deck_case_last(&c, "energy/dissipated_damping");
      assert_true(deck_case_last(&c, "energy/imbalance") == 0);
      assert_true(fabs(rest - (warms && is_held ? held : 0)) < 1e-12 * held);
      assert_true(fabs(stored - (is_held ? held : 0)) < 1e-12 * held);
      assert_true(fabs(taken - (warms ? 0 : first - stored)) < 1e-12 * held);
      if (is_held)
        assert_true(fabs(fabs(deck_case_last(&c, "load")) / load - 1) < 1e-12);
      else
        assert_true(off_growth(&c, ALPHA * HOT) < 1e-12);
      deck_case_close(&c);
    }
}

/* Beside a body that was brought to rest: the same curvature; loads and heat add up. */
static void solved_and_relaxed_agree(void **state) {
  (void)state;
  static const char pulled[] = FEET "&region name = 'right' shape = 'rectangle' corner = '199 mm', "
                                    "'-1 mm' size = '2 mm', '42 mm' /\n"
                                    "&force region = 'right' component = 'x' total = '-2 kN' /\n";
  static const char *const meshes_of[] = {ELEMENTS, ELEMENTS " gauss = 1 hourglass = 0.05",
                                          ELEMENTS " setting = 'plane_strain'"};
  for (int k = 0; k < 3; k++) {
    double moved[2][2];
    for (int solved = 0; solved < 2; solved++) {
      deck_case c;
      comes_to_rest = "&relaxation increments = 1 tolerance = 1e-11 /\n";
      if (solved) solve(2);
      open_bar(&c, meshes_of[k], "293 [K] + 1000 [K]*y/1 [m]*(1 + x/100 [mm])", pulled);
      assert_int_equal(deck_case_go(&c), STEP_END);
      moved[solved][0] = bent(&c, 0.1);
      moved[solved][1] = moved_at(&c, 0, 0.2, 0.04);
      deck_case_close(&c);
    }
    print_message("bent by %.9g and %.9g um, drawn out by %.9g and %.9g um\n", 1e6 * moved[0][0],
                  1e6 * moved[1][0], 1e6 * moved[0][1], 1e6 * moved[1][1]);
    for (int n = 0; n < 2; n++)
      assert_true(fabs(moved[1][n] / moved[0][n] - 1) < 1e-6);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_free_mesh_grows_without_stress),
      cmocka_unit_test(a_gradient_across_bends_a_bar),
      cmocka_unit_test(two_layers_bend_as_timoshenko_says),
      cmocka_unit_test(a_held_bar_is_pressed),
      cmocka_unit_test(equations_are_solved_exactly),
      cmocka_unit_test(solved_and_relaxed_agree),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
