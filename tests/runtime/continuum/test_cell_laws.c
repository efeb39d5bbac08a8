/* Several laws in one mesh: whose a cell is, the same law by both ways side by side, closed forms
   of bars of two materials, ledgers, threads, resuming, cracks beside laws that are not linear. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "laws_run.h"
#include "runtime/continuum/cell_laws.h"
#include "runtime/continuum/cells.h"
#include "runtime/continuum/cells_engine.h"
#include "runtime/continuum/tip_laws.h"
#include "softening_law.h"

#define PLATE(method) BARE(method) "&output sample = '1 us' /\n"
#define BARE(method)                                                                               \
  "&mesh name = 'plate' size = 0.2, 0.1 nodes = 21, 11 thickness = '20 mm' method = " method       \
  " /\n"                                                                                           \
  "&zone mesh = 'plate' method = 'finite_elements' shape = 'rectangle' corner = 0, 0 "             \
  "size = 0.03, 0.1 /\n"                                                                           \
  "&region name = 'left' shape = 'segment' from = 0, 0 to = 0, 0.1 /\n"                            \
  "&region name = 'end' shape = 'segment' from = 0.2, 0 to = 0.2, 0.1 /\n"                         \
  "&region name = 'right' lattice = 'plate' shape = 'rectangle' corner = 0.1, 0 size = 0.1, 0.1 "  \
  "/\n"                                                                                            \
  "&region name = 'disc' lattice = 'plate' shape = 'disc' centre = 0.1, 0.05 radius = 0.03 /\n"    \
  "&support region = 'left' fix = 'x', 'y' /\n"                                                    \
  "&traction mesh = 'plate' from = 0.2, 0 to = 0.2, 0.1 component = 'x' stress = '1 MPa' /\n"      \
  "&monitor name = 'u' kind = 'displacement' region = 'end' component = 'x' /\n"                   \
  "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' /\n"                   \
  "&monitor name = 's' kind = 'stress' at = 0.153, 0.041 component = 'xx' /\n"
#define FREE  PLATE("'element_free' support = 2.6")
#define ONE   PLATE("'finite_elements' gauss = 1 hourglass = 0.2")
#define HOOKE "&material mesh = 'plate' model = 'hooke' nu = 0.3 /\n"
#define RUN   "&simulation end_time = '0.1 ms' step_safety = 0.5 /\n&newmark beta_1 = 0.8 /\n"

static pl_law bent; /* Hooke's, asked point by point */

static int set_up(void **state) {
  (void)state;
  bent = hooke_law;
  bent.linear = 0;
  return 0;
}

static bool says(const small_run *r, const char *text) {
  for (int k = 0; k < r->said.count; k++)
    if (strstr(r->said.items[k].message, text)) return true;
  return false;
}

static void agree(const laws_run *a, const laws_run *b, const char *name, double tolerance) {
  const double *x = small_values(&a->r, name), *y = small_values(&b->r, name),
               largest = small_largest(&a->r, name);
  const long count = simulation_history(a->r.simulation, NULL);
  assert_int_equal(count, simulation_history(b->r.simulation, NULL));
  assert_true(largest > 0);
  for (long k = 0; k < count; k++)
    if (!(fabs(x[k] - y[k]) <= tolerance * largest))
      fail_msg("%s: %.17g, %.17g of %.3g", name, x[k], y[k], largest);
}

/* --- whose a cell is -------------------------------------------------------------------------- */

static void a_cell_is_of_the_region_with_its_corners(void **state) {
  (void)state;
  laws_run c;
  const pl_law *const laws[] = {&hooke_law, &hooke_law, &hooke_law};
  laws_open(&c, laws,
            RUN FREE HOOKE "&material mesh = 'plate' region = 'right' model = 'hooke' E = 1e9 /\n"
                           "&material mesh = 'plate' region = 'disc' model = 'hooke' E = 2e9 /\n");
  if (!c.r.simulation) small_print(&c.r);
  assert_non_null(c.r.simulation);
  const cells *of = simulation_cells(c.r.simulation, 0);
  assert_int_equal(of->where.count, 3);
  for (int cell = 0; cell < mesh_cell_count(&of->mesh); cell++) {
    int corner[4], right = 0, disc = 0;
    mesh_corners(&of->mesh, cell, corner);
    for (int k = 0; k < 4; k++) {
      double at[2];
      mesh_place(&of->mesh, corner[k], at);
      right += at[0] > 0.0999;
      disc += hypot(at[0] - 0.1, at[1] - 0.05) < 0.03 + 1e-6;
    }
    assert_int_equal(cell_laws_at(&of->where, cell), disc == 4 ? 2 : right == 4 ? 1 : 0);
  }
  small_close(&c.r);
}

static void refused(const pl_law *const *laws, const char *text, const char *message) {
  laws_run c;
  laws_open(&c, laws, text);
  assert_null(c.r.simulation);
  if (!says(&c.r, message)) small_print(&c.r);
  assert_true(says(&c.r, message));
  small_close(&c.r);
}

static void what_cannot_be_is_refused(void **state) {
  (void)state;
  const pl_law *const linear[] = {&hooke_law, &hooke_law, &hooke_law}, *const mixed[] = {&hooke_law,
                                                                                         &bent,
                                                                                         &bent};
  refused(linear,
          RUN FREE HOOKE
          "&region name = 'thin' lattice = 'plate' shape = 'segment' from = 0.1, 0 to = 0.1, 0.1 "
          "/\n&material mesh = 'plate' region = 'thin' model = 'hooke' E = 1e9 /\n",
          "the region `thin` holds no cell of `plate`");
  refused(linear,
          RUN FREE HOOKE "&material mesh = 'plate' region = 'disc' model = 'hooke' E = 2e9 /\n"
                         "&region name = 'most' lattice = 'plate' shape = 'rectangle' corner = "
                         "0.05, 0 size = 0.1, 0.1 /\n"
                         "&material mesh = 'plate' region = 'most' model = 'hooke' E = 1e9 /\n",
          "all of its cells are in regions of later materials");
  refused(mixed,
          "&simulation /\n&static /\n" FREE HOOKE
          "&material mesh = 'plate' region = 'right' model = 'bent' /\n",
          "`&static` solves equations of linear laws alone");
  refused(linear,
          RUN FREE HOOKE "&material mesh = 'plate' between = 'disc', 'right' model = 'hooke' /\n",
          "cannot have a material between two regions");
}

/* --- both ways side by side ------------------------------------------------------------------- */

static void both_ways_agree_side_by_side(void **state) {
  (void)state;
  static const char *const names[] = {
      "u", "load", "s", "energy/kinetic", "energy/stored", "energy/dissipated_damping",
  };
  const char *text =
      RUN FREE HOOKE "&material mesh = 'plate' region = 'right' model = 'hooke' nu = 0.3 /\n";
  const pl_law *const linear[] = {&hooke_law, &hooke_law}, *const right[] = {&hooke_law, &bent},
                      *const left[] = {&bent, &hooke_law}, *const points[] = {&bent, &bent};
  laws_run a, b;
  laws_go(&a, linear, text);
  for (int k = 0; k < 3; k++) {
    laws_go(&b, k == 0 ? right : k == 1 ? left : points, text);
    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
      agree(&a, &b, names[n], 1e-10);
    assert_true(small_largest(&b.r, "energy/imbalance") <
                1e-11 * small_largest(&b.r, "energy/external"));
    const double stored = small_last(&b.r, "plate.right/stored");
    assert_true(stored > 0 && stored < small_last(&b.r, "energy/stored"));
    small_close(&b.r);
  }
  small_close(&a.r);
}

/* What the engine says of the second law in the state observed last. */
static void check_stored_by(const laws_run *c) {
  const double stored = cells_stored_by(c->r.simulation->bodies[0].laws[1].state),
               last = small_last(&c->r, "plate.right/stored");
  assert_true(stored > 0 && fabs(stored / last - 1) < 1e-12);
}

/* Whichever of the two is asked point by point. */
static void each_law_knows_what_it_stores(void **state) {
  (void)state;
  static const char *const decks[] = {
      RUN FREE HOOKE "&material mesh = 'plate' region = 'right' model = 'hooke' nu = 0.3 /\n",
      RUN ONE HOOKE "&material mesh = 'plate' region = 'right' model = 'hooke' nu = 0.3 /\n"};
  const pl_law *const right[] = {&hooke_law, &bent}, *const left[] = {&bent, &hooke_law},
                      *const linear[] = {&hooke_law, &hooke_law};
  for (int k = 0; k < 2; k++) {
    laws_run a, b, c;
    laws_go(&a, right, decks[k]);
    laws_go(&b, left, decks[k]);
    laws_go(&c, linear, decks[k]);
    agree(&a, &b, "plate.right/stored", 1e-10);
    agree(&a, &c, "plate.right/stored", 1e-10);
    check_stored_by(&a);
    check_stored_by(&b);
    check_stored_by(&c);
    small_close(&a.r);
    small_close(&b.r);
    small_close(&c.r);
  }
}

/* --- closed forms ----------------------------------------------------------------------------- */

/* Two bars in a row without Poisson's ratio: u = s (l1/E1 + l2/E2). */
static void bars_in_a_row(void **state) {
  (void)state;
  laws_run c;
  const pl_law *const laws[] = {&hooke_law, &hooke_law};
  const char *methods[] = {"&simulation /\n&static /\n" PLATE("'finite_elements'"),
                           "&simulation /\n&static /\n" FREE};
  for (int k = 0; k < 2; k++) {
    char text[4096];
    snprintf(text, sizeof text, "%s%s", methods[k],
             "&material mesh = 'plate' model = 'hooke' nu = 1e-12 E = 30e9 /\n"
             "&material mesh = 'plate' region = 'right' model = 'hooke' nu = 1e-12 E = 10e9 /\n");
    laws_go(&c, laws, text);
    const double u = 1e6 * (0.1 / 30e9 + 0.1 / 10e9), found = small_last(&c.r, "u");
    print_message("bars in a row: %.3g of the elongation off\n", found / u - 1);
    /* element-free functions do not bend at a border of materials */
    assert_true(fabs(found / u - 1) < (k ? 1e-2 : 1e-9));
    if (k == 0) assert_true(fabs(small_last(&c.r, "s") - 1e6) < 1);
    small_close(&c.r);
  }
}

/* Each law has its density: masses of nodes sum to those of the halves. */
static void masses_are_of_their_laws(void **state) {
  (void)state;
  laws_run c;
  const pl_law *const laws[] = {&hooke_law, &bent};
  laws_open(&c, laws,
            RUN FREE "&material mesh = 'plate' model = 'hooke' rho = 1000 /\n"
                     "&material mesh = 'plate' region = 'right' model = 'bent' rho = 8000 /\n");
  assert_non_null(c.r.simulation);
  const rows *w = simulation_rows(c.r.simulation, 0);
  double mass = 0, first = 0;
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    mass += w->site_mass[site];
    first += w->x[site] * w->site_mass[site];
  }
  const double half = 0.1 * 0.1 * 0.02;
  assert_true(fabs(mass / (9000 * half) - 1) < 1e-12);
  assert_true(fabs(first / (half * (1000 * 0.05 + 8000 * 0.15)) - 1) < 1e-3);
  small_close(&c.r);
}

/* The step is that of the stiffer law, wherever it stands. */
static void the_stiffest_law_rules_the_step(void **state) {
  (void)state;
  double limit[3];
  const pl_law *const laws[][2] = {
      {&hooke_law, &bent}, {&hooke_law, &hooke_law}, {&bent, &hooke_law}};
  for (int k = 0; k < 3; k++) {
    laws_run c;
    laws_open(&c, laws[k],
              RUN PLATE("'finite_elements'") "&material mesh = 'plate' model = 'hooke' E = 10e9 /\n"
                                             "&material mesh = 'plate' region = 'right' model = "
                                             "'hooke' E = 90e9 /\n");
    assert_non_null(c.r.simulation);
    limit[k] = simulation_step_limit(c.r.simulation)->limit;
    small_close(&c.r);
  }
  assert_true(limit[0] == limit[1] && limit[1] == limit[2]);
  laws_run c;
  laws_open(
      &c, laws[0],
      RUN PLATE(
          "'finite_elements'") "&material mesh = 'plate' model = 'hooke' /\n"
                               "&material mesh = 'plate' region = 'right' model = 'hooke' /\n");
  const double alike = simulation_step_limit(c.r.simulation)->limit;
  assert_true(fabs(alike / limit[0] / sqrt(3.0) - 1) < 0.05);
  small_close(&c.r);
}

/* --- states ----------------------------------------------------------------------------------- */

#define SOFT                                                                                       \
  FREE "&material mesh = 'plate' model = 'softening' k = 3e-4 /\n"                                 \
       "&material mesh = 'plate' region = 'right' model = 'softening' k = 5e-4 tau = '1 us' /\n"   \
       "&material mesh = 'plate' region = 'disc' model = 'hooke' E = 20e9 /\n"
static const pl_law *const soft[] = {&softening_law, &softening_law, &hooke_law};

static void ledgers_balance(void **state) {
  (void)state;
  double part[2];
  for (int k = 0; k < 2; k++) {
    char text[8192];
    laws_run c;
    snprintf(text, sizeof text, "&simulation end_time = '0.15 ms' step_safety = %s /\n%s",
             k ? "0.2" : "0.4", SOFT);
    laws_go(&c, soft, text);
    part[k] = small_largest(&c.r, "energy/imbalance") / small_largest(&c.r, "energy/external");
    assert_true(small_last(&c.r, "plate.right/dissipated_damage") > 0);
    assert_true(small_last(&c.r, "energy/dissipated_damage") >
                small_last(&c.r, "plate.right/dissipated_damage"));
    small_close(&c.r);
  }
  print_message("imbalance %.3g, %.3g\n", part[0], part[1]);
  assert_true(part[0] < 0.02 && part[1] < 0.65 * part[0]);
}

static void threads_change_no_bit(void **state) {
  (void)state;
  laws_run c[LAWS_RUN_THREADS];
  laws_go_with_threads(c, soft, "end_time = '0.15 ms'", SOFT);
  for (int k = 0; k < LAWS_RUN_THREADS; k++)
    small_close(&c[k].r);
}

static void a_resumed_run_is_the_same(void **state) {
  (void)state;
  laws_run r, s;
  laws_resume(&r, &s, soft, "&simulation end_time = '0.15 ms' /\n&newmark beta_1 = 0.7 /\n" SOFT,
              81);
  assert_true(small_last(&r.r, "energy/dissipated_damage") > 0);
  small_close(&r.r);
  small_close(&s.r);
}

/* --- fields ----------------------------------------------------------------------------------- */

/* Nodes have the fields of the laws around; between two of them the mean. */
static void nodes_show_their_laws(void **state) {
  (void)state;
  enum { NODES = 21 * 11 };
  laws_run c;
  double E[NODES], omega[NODES], k[NODES], press[NODES];
  const pl_law *const laws[] = {&hooke_law, &softening_law};
  laws_go(
      &c, laws,
      "&simulation end_time = '0.1 ms' /\n"
      "&mesh name = 'plate' size = 0.2, 0.1 nodes = 21, 11 thickness = '20 mm' method = "
      "'finite_elements' /\n"
      "&region name = 'left' shape = 'segment' from = 0, 0 to = 0, 0.1 /\n"
      "&region name = 'right' lattice = 'plate' shape = 'rectangle' corner = 0.1, 0 size = 0.1, "
      "0.1 /\n"
      "&support region = 'left' fix = 'x', 'y' /\n"
      "&traction mesh = 'plate' from = 0.2, 0 to = 0.2, 0.1 component = 'x' stress = '1 MPa' /\n"
      "&output frames = 1 fields = 'E', 'omega', 'k', 'press' /\n"
      "&material mesh = 'plate' model = 'hooke' E = 30e9 /\n"
      "&material mesh = 'plate' region = 'right' model = 'softening' k = 3e-4 E = 10e9 /\n");
  laws_field(&c, "E", E);
  laws_field(&c, "omega", omega);
  laws_field(&c, "k", k);
  laws_field(&c, "press", press);
  for (int n = 0; n < NODES; n++) {
    const int i = n % 21;
    assert_true(fabs(E[n] - (i < 10 ? 30e9 : i == 10 ? 20e9 : 10e9)) < 1);
    assert_true(i < 10 ? isnan(k[n]) : k[n] == 3e-4);
    assert_true(i < 10 ? omega[n] == 0 : omega[n] > 0);
    assert_true(i < 10 ? isnan(press[n]) : isfinite(press[n]));
  }
  small_close(&c.r);
}

/* Stress is continuous where it has to be: of a bar in a row of two the mean of both sides. */
static void stresses_are_of_both_sides(void **state) {
  (void)state;
  enum { NODES = 21 * 11 };
  double stress[NODES];
  const pl_law *const laws[][2] = {{&hooke_law, &hooke_law}, {&hooke_law, &bent}};
  for (int n = 0; n < 2; n++) {
    laws_run c;
    laws_go(
        &c, laws[n],
        n ? "&simulation end_time = 1 /\n&relaxation increments = 1 tolerance = 1e-9 /\n"
            "&output fields = 'stress_xx' frames = 1 /\n" BARE(
                "'finite_elements'") "&material mesh = 'plate' model = 'hooke' nu = 1e-12 E = 30e9 "
                                     "/\n"
                                     "&material mesh = 'plate' region = 'right' model = 'bent' nu "
                                     "= 1e-12 E = 10e9 /\n"
          : "&simulation /\n&static /\n"
            "&output fields = 'stress_xx' frames = 1 /\n" BARE(
                "'finite_elements'") "&material mesh = 'plate' model = 'hooke' nu = 1e-12 E = 30e9 "
                                     "/\n"
                                     "&material mesh = 'plate' region = 'right' model = 'hooke' nu "
                                     "= 1e-12 E = 10e9 /\n");
    laws_field(&c, "stress_xx", stress);
    for (int k = 0; k < NODES; k++)
      assert_true(fabs(stress[k] - 1e6) < 1e6 * (n ? 1e-6 : 1e-9));
    small_close(&c.r);
  }
}

/* Hooke's law that breaks down. */
static void poisoned_step(const pl_law *law, const double *uniforms, const pl_points *p) {
  hooke_step(law, uniforms, p);
  for (long q = 0; q < p->count; q++)
    if (p->strain[0][q] > 1e-5) p->stress[0][q] = NAN;
}

static void a_bad_point_is_of_its_law(void **state) {
  (void)state;
  pl_law poisoned = bent;
  poisoned.point_step = poisoned_step;
  const pl_law *const laws[] = {&bent, &hooke_law, &poisoned};
  laws_run c;
  laws_open(&c, laws,
            RUN FREE HOOKE "&material mesh = 'plate' region = 'right' model = 'hooke' nu = 0.3 /\n"
                           "&material mesh = 'plate' region = 'disc' model = 'hooke' nu = 0.3 /\n");
  assert_non_null(c.r.simulation);
  assert_int_equal(small_go(&c.r), STEP_BAD);
  const bad_state bad = simulation_bad(c.r.simulation);
  assert_int_equal(bad.interaction, 2);
  assert_non_null(bad.point);
  assert_true(hypot(bad.point->at[0] - 0.1, bad.point->at[1] - 0.05) < 0.03);
  assert_true(isnan(bad.point->stress[0]) && bad.point->strain[0] > 1e-5);
  small_close(&c.r);
}

/* --- cracks ----------------------------------------------------------------------------------- */

#define CRACKED                                                                                    \
  "&mesh name = 'plate' size = 0.2, 0.1 nodes = 41, 21 thickness = 0.01 method = 'element_free' "  \
  "/\n&zone mesh = 'plate' method = 'finite_elements' shape = 'rectangle' corner = 0.14, 0 size "  \
  "= 0.06, 0.1 /\n"                                                                                \
  "&region name = 'right' lattice = 'plate' shape = 'rectangle' corner = 0.15, 0 size = 0.05, "    \
  "0.1 /\n"                                                                                        \
  "&traction mesh = 'plate' from = 0, 0.1 to = 0.2, 0.1 component = 'y' stress = '5 MPa' /\n"      \
  "&traction mesh = 'plate' from = 0, 0 to = 0.2, 0 component = 'y' stress = '-5 MPa' /\n"         \
  "&tips half_size = 2 check_steps = 10 updates = 5 segment = 1000 /\n"                            \
  "&simulation end_time = '0.15 ms' step_safety = 0.5 /\n"                                         \
  "&material mesh = 'plate' model = 'hooke' /\n"                                                   \
  "&material mesh = 'plate' region = 'right' model = 'hooke' /\n"
#define GROWS " grows = .true. model = 'fracture' K_Ic = 1e5 v = 300 /\n"

/* Beside elements whose points are asked a crack does what it does where all is assembled. */
static void a_crack_runs_beside_another_law(void **state) {
  (void)state;
  static const char *const names[] = {"c/K_I", "c/length", "energy/dissipated_damage",
                                      "energy/stored"};
  const pl_law *const linear[] = {&hooke_law, &hooke_law}, *const mixed[] = {&hooke_law, &bent};
  const char *text =
      CRACKED "&crack name = 'c' mesh = 'plate' points = 0, 0.0512, 0.05, 0.0512" GROWS;
  static laws_run a, b;
  laws_go(&a, linear, text);
  laws_go(&b, mixed, text);
  assert_true(small_last(&a.r, "c/length") > 0.06);
  for (size_t n = 0; n < sizeof names / sizeof *names; n++)
    agree(&a, &b, names[n], 1e-8);
  assert_true(small_largest(&b.r, "energy/imbalance") <
              1e-10 * small_largest(&b.r, "energy/external"));
  small_close(&a.r);
  small_close(&b.r);
}

static void cracks_want_linear_laws(void **state) {
  (void)state;
  const pl_law *const mixed[] = {&hooke_law, &bent}, *const other[] = {&bent, &hooke_law};
  laws_run c;
  refused(other, CRACKED "&crack name = 'c' mesh = 'plate' points = 0, 0.0512, 0.05, 0.0512 /\n",
          "a law that is not linear is for finite elements");
  for (int half_size = 2; half_size <= 3; half_size++) {
    char text[4096] =
        CRACKED "&crack name = 'c' mesh = 'plate' points = 0, 0.0512, 0.1389, 0.0512 /\n";
    strchr(strstr(text, "half_size"), '=')[2] = (char)('0' + half_size);
    laws_open(&c, mixed, text);
    assert_non_null(c.r.simulation);
    assert_int_equal(says(&c.r, "reaches into another material"), half_size == 3);
    small_close(&c.r);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_cell_is_of_the_region_with_its_corners),
                                     cmocka_unit_test(what_cannot_be_is_refused),
                                     cmocka_unit_test(both_ways_agree_side_by_side),
                                     cmocka_unit_test(each_law_knows_what_it_stores),
                                     cmocka_unit_test(bars_in_a_row),
                                     cmocka_unit_test(masses_are_of_their_laws),
                                     cmocka_unit_test(the_stiffest_law_rules_the_step),
                                     cmocka_unit_test(ledgers_balance),
                                     cmocka_unit_test(threads_change_no_bit),
                                     cmocka_unit_test(a_resumed_run_is_the_same),
                                     cmocka_unit_test(nodes_show_their_laws),
                                     cmocka_unit_test(stresses_are_of_both_sides),
                                     cmocka_unit_test(a_bad_point_is_of_its_law),
                                     cmocka_unit_test(a_crack_runs_beside_another_law),
                                     cmocka_unit_test(cracks_want_linear_laws)};
  return cmocka_run_group_tests(tests, set_up, NULL);
}
