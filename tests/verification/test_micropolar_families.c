/* Micropolar laws of bonds off the hexagon and in space, with their compiled kernels: the isotropic
   lattices of mplm_space and mplm_concrete_space, rigid and spinning bodies, the stable step of a
   body, cantilevers against theory. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <unistd.h>

#include "runtime/analysis/implied.h"
#include "runtime/analysis/stability.h"
#include "runtime/analysis/stencil.h"
#include "runtime/filling/lattice.h"
#include "runtime/simulation/simulation_save.h"
#include "tests/runtime/rigid_motion.h"
#include "tests/verification/cantilever.h"

#define SPACE_DECK                                                                                 \
  "&simulation end_time = %g step_safety = %g /\n"                                                 \
  "&lattice name = 'c' kind = 'fcc' shells = 2 spacing = 0.01 rotation = %g axis = 1, 2, 3 /\n"    \
  "&material lattice = 'c' model = '%s' E = 30e9 nu = %g /\n"                                      \
  "&body lattice = 'c' shape = 'sphere' centre = 0, 0, 0 radius = 0.025 /\n"                       \
  "&output frames = 0 fields = 'force' /\n"
#define PLANE_DECK                                                                                 \
  "&simulation end_time = %g step_safety = %g /\n"                                                 \
  "&lattice name = 'c' kind = 'square' thickness = 0.1 spacing = 0.01 rotation = %g /\n"           \
  "&material lattice = 'c' model = '%s' E = 30e9 nu = %g /\n"                                      \
  "&body lattice = 'c' shape = 'disc' centre = 0, 0 radius = 0.055 /\n"                            \
  "&output frames = 0 fields = 'force' /\n"

static const double spacing = 0.01, E = 30e9; /* m, Pa */

static void open_law_body(deck_case *c, int dimensions, const char *name, double end, double safety,
                          double turn, double nu) {
  char text[1024];
  snprintf(text, sizeof text, dimensions == 3 ? SPACE_DECK : PLANE_DECK, end, safety, turn, name,
           nu);
  assert_true(deck_case_text(c, text));
  assert_int_equal(c->law.law->dof, dimensions == 3 ? 6 : 3);
}

static void open_body(deck_case *c, int dimensions, double end, double safety, double turn,
                      double nu) {
  open_law_body(c, dimensions, dimensions == 3 ? "mplm_space" : "elastic_micropolar", end, safety,
                turn, nu);
}

/* --- elastic constants ------------------------------------------------------------------------ */

static double error_of_D(const pl_law *of, const double *parameters, const rows *g, double nu) {
  const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
  double D[36], worst = 0;
  stencil s = stencil_new(of, parameters, g);
  stencil_elastic(&s, g, D);
  stencil_free(&s);
  for (int i = 0; i < 36; i++) {
    const int p = i / 6, q = i % 6;
    const double hooke = (p < 3 && q < 3 ? lambda : 0) + (p == q ? (p < 3 ? 2 * mu : mu) : 0);
    worst = fmax(worst, fabs(D[i] - hooke) / E);
  }
  return worst;
}

/* All 36 elastic constants and with them E, nu and G in every direction, of the lattice in three
   orientations, as compiled and as interpreted. */
static void is_isotropic(const char *name) {
  static const double ratios[] = {0, 0.1, 0.2, 0.25}, turns[] = {0, 17, 63};
  double worst = 0, moduli = 0;
  for (int k = 0; k < 12; k++) {
    const double nu = ratios[k % 4];
    deck_case c;
    implied_elasticity e;
    open_law_body(&c, 3, name, 1e-4, 0.5, turns[k / 4], nu);
    const rows *g = simulation_rows(c.simulation, 0);
    pl_law *interpreted = plan_interpreted(c.model.plan);
    worst = fmax(worst, error_of_D(c.law.law, c.law.parameters, g, nu));
    worst = fmax(worst, error_of_D(interpreted, c.law.parameters, g, nu));
    assert_true(implied_elastic(c.law.law, c.law.parameters, g, &e));
    for (int a = 0; a < 2; a++)
      moduli = fmax(moduli, fmax(fabs(e.E[a] / E - 1), fabs(e.nu[a] - nu)));
    moduli = fmax(moduli, fabs(e.G / (E / (2 * (1 + nu))) - 1));
    plan_interpreted_free(interpreted);
    deck_case_close(&c);
  }
  print_message("%s: D to %.1e of E, E, nu and G to %.1e\n", name, worst, moduli);
  assert_true(worst < 1e-10 && moduli < 1e-10);
}

static void the_lattice_in_space_is_isotropic(void **state) {
  (void)state;
  is_isotropic("mplm_space");
  is_isotropic("mplm_concrete_space");
}

/* The hexagon with bonds to more than the nearest: all share one axial rigidity, 2 sqrt(3) E s^2 t
   over (1 - nu) and the sum of their lengths, and are as stiff across as (1 - 3 nu)/(1 + nu) of
   that along. A family of six directions is isotropic, so that K and G need no more. */
static void larger_horizons_hold_the_moduli(void **state) {
  (void)state;
  static const char *const laws[] = {"elastic_micropolar", "mplm_bilinear", "mplm_concrete"};
  static const char *const horizons[] = {"1.5", "1.7321", "1.9", "2", "2.646", "2.9", "3", "3.46"};
  static const int neighbours[] = {6, 12, 12, 18, 30, 30, 36, 36};
  double worst = 0;
  for (int k = 0; k < 3 * 8 * 2 * 4; k++) {
    const int law_number = k / 64, reach = k / 8 % 8, strain = k / 4 % 2;
    const double nu = k % 4 / (strain ? 12.0 : 9.0), turn = 17 * (k % 3);
    char text[1024];
    deck_case c;
    implied_elasticity e;
    snprintf(text, sizeof text,
             "&simulation end_time = 1e-4 /\n"
             "&lattice name = 'c' kind = 'hexagonal' horizon = %s thickness = 0.1 spacing = 0.01 "
             "rotation = %g setting = '%s' /\n"
             "&material lattice = 'c' model = '%s' E = 30e9 nu = %.17g /\n"
             "&body lattice = 'c' shape = 'disc' centre = 0, 0 radius = 0.055 /\n",
             horizons[reach], turn, strain ? "plane_strain" : "plane_stress", laws[law_number], nu);
    deck_case_open(&c, text);
    const rows *g = simulation_rows(c.simulation, 0);
    const double E_p = strain ? E / (1 - nu * nu) : E, nu_p = strain ? nu / (1 - nu) : nu;
    assert_int_equal(2 * g->directions, neighbours[reach]);
    assert_true(implied_elastic(c.law.law, c.law.parameters, g, &e));
    for (int a = 0; a < 2; a++) {
      worst = fmax(worst, fabs(e.E[a] / E_p - 1));
      worst = fmax(worst, fabs(e.nu[a] - nu_p));
    }
    worst = fmax(worst, fabs(e.G / (E_p / (2 * (1 + nu_p))) - 1));
    deck_case_close(&c);
  }
  print_message("6 to 36 neighbours on the hexagon: E, nu and G to %.1e\n", worst);
  assert_true(worst < 1e-10);
}

/* Eq 18 of Gerstle et al. (2013) asks for the largest frequency: m omega_n^2 = max(9 k_n + 6 k_s,
   50 k_s) is that of all waves without dampers; with them, dt = 2/omega_n (root(1 + xi^2) - xi). */
static void the_fastest_wave_is_that_of_the_damper(void **state) {
  (void)state;
  static const double ratios[] = {0, 0.05, 0.1, 0.15, 0.17, 0.18, 0.2, 0.22, 0.25};
  for (int k = 0; k < 9; k++) {
    const double nu = ratios[k], lambda = E * nu / ((1 + nu) * (1 - 2 * nu)),
                 mu = E / (2 * (1 + nu));
    const double k_s = 2 * sqrt(2) / 5 * spacing * (mu - lambda),
                 k_n = k_s + sqrt(2) * spacing * lambda,
                 m = 2323 * spacing * spacing * spacing / sqrt(2);
    const double expected = sqrt(fmax(9 * k_n + 6 * k_s, 50 * k_s) / m);
    deck_case c;
    step_limit limit;
    open_law_body(&c, 3, "mplm_concrete_space", 1e-4, 0.5, 17, nu);
    for (int p = 0; p < c.law.law->parameter_count; p++)
      if (strcmp(c.law.law->parameters[p].name, "zeta") == 0) c.law.parameters[p] = 0;
    stability_limit(c.law.law, c.law.parameters, NULL, simulation_rows(c.simulation, 0), &limit);
    print_message("nu = %g: %.9g rad/s, %.9g by the lattice\n", nu, expected, limit.omega_max);
    assert_true(fabs(limit.omega_max / expected - 1) < 1e-6);
    deck_case_close(&c);
  }
}

/* --- bodies that turn ------------------------------------------------------------------------- */

static double axial_rigidity(int dimensions) {
  return dimensions == 3 ? E * spacing * spacing : E * spacing * 0.1 / (sqrt(3) * 0.8);
}

/* Over EA; moments over EA times the spacing. */
static double largest_force(sweep *w) {
  const body *b = w->body;
  double most = 0;
  sweep_find_forces(w);
  for (int d = 0; d < b->dof; d++)
    for (long p = 0; p < b->lattice->particle_count; p++)
      most = fmax(most, fabs(b->force[d][b->lattice->particle_site[p]]) /
                            (d < b->dimensions ? 1 : spacing));
  return most / axial_rigidity(b->dimensions);
}

/* 0.05 m are rounded to 7e-18 m; a few such roundings, and those of the angle. */
static void a_rigid_motion_leaves_no_force(void **state) {
  (void)state;
  static const double angles[] = {1e-12, 1e-6, 0.3, 1.5707963267948966, 3.1, 3.15, 14, -14};
  for (int dimensions = 2; dimensions <= 3; dimensions++) {
    deck_case c;
    double worst = 0;
    open_body(&c, dimensions, 1e-4, 0.5, 17, 0.2);
    sweep *w = simulation_state(c.simulation, 0);
    body *b = w->body;
    for (int n = 0; n < 8; n++) {
      rigid_turn(b, angles[n], 0.01);
      worst = fmax(worst, largest_force(w));
    }
    print_message("%dD: largest force in a rigid motion %.1e EA\n", dimensions, worst);
    assert_true(worst < 1e-12);
    /* the test can see a deformation */
    b->displacement[b->dof - 1][b->lattice->particle_site[3]] += 1e-9;
    assert_true(largest_force(w) > 1e-11);
    deck_case_close(&c);
  }
}

typedef struct drifts {
  double momenta, energy; /* relative */
  double turned;          /* rad */
} drifts;

/* Spins about an oblique axis at 1000 rad/s, 25 m/s at the rim, flies and breathes. */
static drifts spin(int dimensions, double safety) {
  const double rate = 1000, end = 4 / rate;
  deck_case c;
  drifts d = {0, 0, 0};
  open_body(&c, dimensions, end, safety, 17, 0.1);
  body *b = simulation_state(c.simulation, 0)->body;
  rigid_spin(b, rate, 2, 0.01);
  const momenta before = momenta_of(b);
  while (simulation_advance(c.simulation, 400, NULL) == STEP_OK) {
    const momenta now = momenta_of(b);
    d.momenta = fmax(d.momenta, momenta_apart(&now, &before));
  }
  const double *imbalance = deck_case_series(&c, "energy/imbalance"),
               *kinetic = deck_case_series(&c, "energy/kinetic");
  for (long k = simulation_history(c.simulation, NULL) - 1; k >= 0; k--)
    d.energy = fmax(d.energy, fabs(imbalance[k]) / kinetic[0]);
  for (int a = dimensions; a < b->dof; a++)
    d.turned = hypot(d.turned, b->displacement[a][b->lattice->particle_site[0]]);
  deck_case_close(&c);
  return d;
}

/* Roundings of 1e4 kicks a particle; energy up to an error of the second order in the step. */
static void a_spinning_body_conserves(void **state) {
  (void)state;
  for (int dimensions = 2; dimensions <= 3; dimensions++) {
    double energy[2];
    for (int fine = 0; fine < 2; fine++) {
      const drifts d = spin(dimensions, fine ? 0.2 : 0.4);
      print_message("%dD, spin through %.3f rad: momenta %.1e, energy %.1e\n", dimensions, d.turned,
                    d.momenta, d.energy);
      assert_true(fabs(d.turned - 4) < 0.05);
      assert_true(d.momenta < 1e-12);
      energy[fine] = d.energy;
    }
    assert_true(energy[0] < 1e-4 && energy[0] > 3 * energy[1]);
  }
}

/* --- bits ------------------------------------------------------------------------------------- */

/* A bar twisted and pulled; in the plane a plate that cracks. */
static void open_loaded(deck_case *c, int dimensions, int threads) {
  char text[2048];
  const int space = snprintf(
      text, sizeof text,
      "&simulation end_time = 1e-4 threads = %d /\n"
      "&lattice name = 'c' kind = 'fcc' shells = 2 spacing = 0.01 origin = 0, 0, 0 /\n"
      "&material lattice = 'c' model = 'mplm_space' /\n"
      "&body lattice = 'c' shape = 'box' corner = 0, 0, 0 size = 0.05, 0.05, 0.09 /\n"
      "&region name = 'foot' shape = 'box' corner = -1, -1, -1 size = 2, 2, 1.001 /\n"
      "&region name = 'top' shape = 'box' corner = -1, -1, 0.08 size = 2, 2, 1 /\n"
      "&support region = 'foot' fix = 'xyz', 'rotation' /\n"
      "&drive region = 'top' component = 'rotation_z' velocity = 20 rise = 5e-5 /\n"
      "&force region = 'top' component = 'rotation_x' moment = 50 /\n"
      "&monitor name = 'held' kind = 'reaction' region = 'foot' component = 'rotation_z' /\n"
      "&output frames = 0 sample = 5e-6 /\n",
      threads);
  if (dimensions == 2)
    snprintf(text, sizeof text,
             "&simulation end_time = 2e-4 threads = %d /\n"
             "&lattice name = 'c' kind = 'square' spacing = 0.01 thickness = 0.1 /\n"
             "&material lattice = 'c' model = 'mplm_bilinear' /\n"
             "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.2, 0.3 /\n"
             "&notch lattice = 'c' shape = 'segment' from = 0, 0.155 to = 0.08, 0.155 /\n"
             "&region name = 'foot' shape = 'rectangle' corner = 0, 0 size = 1, 0.001 /\n"
             "&region name = 'top' shape = 'rectangle' corner = 0, 0.295 size = 1, 1 /\n"
             "&support region = 'foot' fix = 'xy', 'rotation' /\n"
             "&drive region = 'top' component = 'y' velocity = 0.5 rise = 2e-5 /\n"
             "&monitor name = 'held' kind = 'reaction' region = 'foot' component = 'rotation' /\n"
             "&output frames = 0 sample = 5e-6 /\n",
             threads);
  assert_true(space > 0 && space < (int)sizeof text);
  assert_true(deck_case_text(c, text));
}

static void same_bits(const deck_case *a, const deck_case *b) {
  const sweep *x = simulation_state(a->simulation, 0), *y = simulation_state(b->simulation, 0);
  const long size = x->body->lattice->size;
  for (int d = 0; d < x->body->dof; d++) {
    assert_memory_equal(x->body->displacement[d], y->body->displacement[d], (size_t)size * 8);
    assert_memory_equal(x->body->velocity[d], y->body->velocity[d], (size_t)size * 8);
  }
  for (int f = 0; f < x->law->field_count; f++)
    assert_memory_equal(x->field[f], y->field[f],
                        (size_t)(sweep_planes(x, x->law->fields[f].place) * size) * 8);
  const long samples = simulation_history(a->simulation, NULL);
  assert_int_equal(simulation_history(b->simulation, NULL), samples);
  assert_memory_equal(deck_case_series(a, "held"), deck_case_series(b, "held"),
                      (size_t)samples * 8);
}

static void neither_threads_nor_a_stop_change_bits(void **state) {
  (void)state;
  static const char path[] = "test_micropolar_families.state";
  for (int dimensions = 2; dimensions <= 3; dimensions++) {
    deck_case one, some;
    char error[200];
    frame_mark frames = {0, 0};
    open_loaded(&one, dimensions, 1);
    assert_int_equal(deck_case_go(&one), STEP_END);
    const sweep *w = simulation_state(one.simulation, 0);
    const long bonds = w->body->lattice->directions * w->body->lattice->size;
    assert_true(dimensions == 3 || w->field[0][largest_of(w->field[0], bonds)] > 0.5);
    for (int threads = 2; threads <= 3; threads++) {
      open_loaded(&some, dimensions, threads);
      assert_int_equal(simulation_threads(some.simulation), threads);
      assert_int_equal(deck_case_go(&some), STEP_END);
      same_bits(&one, &some);
      deck_case_close(&some);
    }
    open_loaded(&some, dimensions, 2);
    simulation_advance(some.simulation, simulation_step_count(some.simulation) / 3, NULL);
    assert_true(simulation_save(some.simulation, path, "deck", &frames, error, sizeof error));
    deck_case_close(&some);
    open_loaded(&some, dimensions, 3);
    assert_true(simulation_restore(some.simulation, path, "deck", &frames, error, sizeof error));
    assert_int_equal(deck_case_go(&some), STEP_END);
    same_bits(&one, &some);
    deck_case_close(&some);
    deck_case_close(&one);
  }
  unlink(path);
}

/* --- cantilevers ------------------------------------------------------------------------------ */

static const double depth = 0.1, width = 0.05, end_load = 1000; /* m, N */
static double bending, shear;                                   /* EI, GI: N m^2 */

/* A beam clamped at x = 0 under a parabolic shear at x = length, of a material that does not
   contract across: the mean rotation of the section at x = 0 is none, so that the deflection is
   Timoshenko's, F l^3/(3 EI) + F l/(5/6 GA). */
static void without_contraction(double length, double x, double y, double *ux, double *uy) {
  const double c = depth / 2, slip = end_load * c * c / (10 * shear);
  *ux = end_load * y * (length * x - x * x / 2) / bending + end_load * y * y * y / (6 * shear) -
        slip * y;
  *uy = -end_load * (length * x * x / 2 - x * x * x / 6) / bending - 4 * slip * x;
}

/* In the plane on the square lattice, in space on FCC-18; `layers` over the depth. */
static double tip_error(int dimensions, int layers) {
  cantilever b = {.s = dimensions == 2 ? depth / layers : sqrt(2) * depth / layers};
  char text[1024];
  implied_elasticity e;
  const double step = depth / layers, half = (layers - 1) * step / 2;
  const double deep = dimensions == 2 ? 0.1 : width, long_side = 4 * depth;
  if (dimensions == 2)
    snprintf(text, sizeof text,
             "&simulation end_time = 1 /\n"
             "&lattice name = 'c' kind = 'square' spacing = %.17g thickness = 0.1 "
             "origin = 0, %.17g /\n&material lattice = 'c' model = 'elastic_micropolar' /\n"
             "&body lattice = 'c' shape = 'rectangle' corner = 0, %.17g size = %.17g, %.17g /\n",
             b.s, -half, -half, long_side, 2 * half);
  else
    snprintf(text, sizeof text,
             "&simulation end_time = 1 /\n&lattice name = 'c' kind = 'fcc' shells = 2 "
             "spacing = %.17g origin = 0, %.17g, 0 /\n"
             "&material lattice = 'c' model = 'mplm_space' nu = 0 /\n"
             "&body lattice = 'c' shape = 'box' corner = 0, %.17g, 0 size = %.17g, %.17g, "
             "%.17g /\n",
             b.s, -half, -half, long_side, 2 * half, width - step);
  assert_true(deck_case_text(&b.c, text));
  b.c.lattice = lattice_build(b.c.deck, 0, &b.c.said);
  rows_set_density(b.c.lattice, 2323);
  assert_true(implied_elastic(b.c.law.law, b.c.law.parameters, b.c.lattice, &e));
  const double inertia = deep * depth * depth * depth / 12;
  bending = e.E[0] * inertia;
  shear = e.G * inertia;
  cantilever_open(&b, b.c.law.law, b.c.law.parameters);
  const double back = dimensions == 2 ? 0 : step; /* two sections of FCC hold a whole cell */
  b.length = b.g->width - back / 2;
  cantilever_ends(&b, back + 0.25 * step, b.g->width - back - 0.25 * step, end_load, depth);
  const double error = cantilever_error(&b, without_contraction);
  cantilever_close(&b);
  return error;
}

static double order(const double error[3], const int layers[3], int k) {
  return log(error[k] / error[k + 1]) / log((double)layers[k + 1] / layers[k]);
}

/* The square lattice has all bonds that its edges need: rows that stand for their share of the
   depth are off by one part in the square of their number. The face-centred one lacks bonds at its
   four faces, and is too soft by the first order; what that leaves is of the second. */
static void cantilevers_converge_to_theory(void **state) {
  (void)state;
  static const int layers[3] = {4, 8, 12};
  for (int dimensions = 2; dimensions <= 3; dimensions++) {
    double error[3];
    for (int k = 0; k < 3; k++)
      error[k] = tip_error(dimensions, layers[k]);
    const double first = order(error, layers, 0), second = order(error, layers, 1);
    const double extrapolated = 3 * error[2] - 2 * error[1];
    print_message("%dD: orders %.2f, %.2f; without the first order %.1e\n", dimensions, first,
                  second, extrapolated);
    assert_true(error[2] > 0 && error[2] < (dimensions == 2 ? 0.005 : 0.2));
    assert_true(fabs(first - (dimensions == 2 ? 2 : 1)) < 0.2);
    assert_true(fabs(second - (dimensions == 2 ? 2 : 1)) < 0.2);
    assert_true(dimensions == 2 || fabs(extrapolated) < 0.01);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_lattice_in_space_is_isotropic),
      cmocka_unit_test(larger_horizons_hold_the_moduli),
      cmocka_unit_test(the_fastest_wave_is_that_of_the_damper),
      cmocka_unit_test(a_rigid_motion_leaves_no_force),
      cmocka_unit_test(a_spinning_body_conserves),
      cmocka_unit_test(neither_threads_nor_a_stop_change_bits),
      cmocka_unit_test(cantilevers_converge_to_theory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
