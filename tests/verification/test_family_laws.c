/* Laws of families of models/ against theory: elastic constants of lattices, two particles as an
   oscillator, bonds that break, the cost of a crack, a yield surface, and concrete step by step. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/analysis/patch.h"
#include "runtime/analysis/stencil.h"
#include "tests/verification/case.h"

/* --- elastic constants ------------------------------------------------------------------------ */

/* D of an isotropic solid, in the order xx, yy, xy or xx, yy, zz, xy, yz, xz, shear strains as
   angles. */
static void isotropic(law_setting setting, double E, double nu, int size, double *D) {
  const double mu = E / (2 * (1 + nu));
  const double lambda =
      setting == SETTING_PLANE_STRESS ? E * nu / (1 - nu * nu) : E * nu / ((1 + nu) * (1 - 2 * nu));
  const int normal = size == 3 ? 2 : 3;
  for (int r = 0; r < size; r++)
    for (int c = 0; c < size; c++)
      D[r * size + c] =
          (r < normal && c < normal ? lambda : 0) + (r == c ? (r < normal ? 2 * mu : mu) : 0);
}

static const char *const plane_deck = "&simulation end_time = 1 /\n"
                                      "&lattice name = 'l' kind = 'hexagonal' spacing = '7 mm' "
                                      "thickness = '30 mm' rotation = 17 setting = '%s' /\n"
                                      "&body lattice = 'l' shape = 'disc' centre = 0, 0 radius = "
                                      "'40 mm' /\n&material lattice = 'l' model = 'x' /\n";
static const char *const space_deck =
    "&simulation end_time = 1 /\n"
    "&lattice name = 'l' kind = 'fcc' shells = 2 spacing = "
    "'7 mm' /\n&body lattice = 'l' shape = 'box' corner = 0, 0, 0 "
    "size = '40 mm', '40 mm', '40 mm' /\n"
    "&material lattice = 'l' model = 'x' /\n";

/* Long waves in the lattice with the law's own kernel against the isotropic solid: the largest
   entry that is off, over the largest. */
static double error_of_D(const char *model_name, const char *deck_text, law_setting setting,
                         double nu) {
  char text[1024];
  law_case c;
  deck_case k;
  double D[36], exact[36], worst = 0, largest = 0;
  snprintf(text, sizeof text, deck_text, law_setting_name(setting));
  assert_true(deck_case_lattice(&k, text));
  assert_true(law_case_open_in(&c, model_name, setting));
  *law_case_value(&c, "nu") = nu;
  k.lattice->mass = *law_case_value(&c, "rho") * k.lattice->volume;
  stencil s = stencil_new(c.compiled, c.parameters, k.lattice);
  stencil_elastic(&s, k.lattice, D);
  const int size = k.lattice->dimensions == 2 ? 3 : 6;
  isotropic(setting, *law_case_value(&c, "E"), nu, size, exact);
  for (int q = 0; q < size * size; q++) {
    worst = fmax(worst, fabs(D[q] - exact[q]));
    largest = fmax(largest, exact[q]);
  }
  stencil_free(&s);
  law_case_close(&c);
  deck_case_close(&k);
  return worst / largest;
}

static void lattices_have_the_stiffness_of_the_solid(void **state) {
  (void)state;
  static const double ratios[] = {0, 0.1, 0.2, 0.3, 0.45};
  static const char *const laws[] = {"splm_elastic", "splm_concrete"}; /* concrete: undamaged */
  for (int of = 0; of < 2; of++)
    for (int setting = SETTING_PLANE_STRESS; setting <= SETTING_SPACE; setting++)
      for (size_t k = 0; k < sizeof ratios / sizeof *ratios; k++) {
        const double error =
            error_of_D(laws[of], setting == SETTING_SPACE ? space_deck : plane_deck,
                       (law_setting)setting, ratios[k]);
        if (!(error < 1e-8))
          fail_msg("%s, %s, nu %g: D is off by %.3g", laws[of],
                   law_setting_name((law_setting)setting), ratios[k], error);
      }
}

/* --- two particles ---------------------------------------------------------------------------- */

/* Particles 0 and 1 of one row, bonded to each other alone, in the arrays that a pass wants; eight
   places of nothing before and behind. */
enum { PLACES = 24, FIRST = 8, MOST_FIELDS = 4, MOST_LINKS = 8 };
typedef struct pair {
  double u[3][PLACES], v[3][PLACES], force[3][PLACES], link[MOST_LINKS][PLACES];
  double field[2][MOST_FIELDS][2 * PLACES];
  uint64_t bonds[PLACES], held[PLACES];
  double uniforms[2 * 64];
  long offset[2];
} pair;

static void pair_open(pair *p, const law_case *c, double distance, double volume) {
  memset(p, 0, sizeof *p);
  p->bonds[FIRST] = 1;
  p->offset[0] = 1;
  p->offset[1] = -1;
  for (int k = 0; k < 2; k++) {
    const pl_bond_class b = {.size = sizeof(pl_bond_class),
                             .s = distance,
                             .spacing = distance,
                             .V = volume,
                             .shell = 1,
                             .n = 2,
                             .horizon = distance,
                             .weight = 1,
                             .chord = {k ? -distance : distance, 0, 0}};
    assert_true(c->compiled->uniform_count <= 64);
    c->compiled->prepare(c->compiled, c->parameters, &b,
                         p->uniforms + k * c->compiled->uniform_count);
  }
}

static void pair_forces(pair *p, const law_case *c) {
  const double *old[MOST_FIELDS];
  double *new_field[MOST_FIELDS], *link[MOST_LINKS], *force[3];
  pl_family f = {.size = sizeof(pl_family),
                 .count = 8,
                 .rows = 1,
                 .neighbours = 2,
                 .plane = PLACES,
                 .new_plane = PLACES,
                 .link_plane = PLACES,
                 .offset = p->offset,
                 .link_offset = p->offset,
                 .bonds = p->bonds + FIRST,
                 .held = p->held + FIRST,
                 .old_field = old,
                 .new_field = new_field,
                 .link = link,
                 .force = force,
                 .time_step = 1e-6};
  for (int k = 0; k < MOST_FIELDS; k++) {
    old[k] = p->field[0][k] + FIRST;
    new_field[k] = p->field[1][k] + FIRST;
  }
  for (int k = 0; k < MOST_LINKS; k++)
    link[k] = p->link[k] + FIRST;
  for (int d = 0; d < 3; d++) {
    f.displacement[d] = p->u[d] + FIRST;
    f.velocity[d] = p->v[d] + FIRST;
    force[d] = p->force[d] + FIRST;
  }
  for (int k = 0; k < c->compiled->step.pass_count; k++)
    c->compiled->step.pass[k](c->compiled, p->uniforms, &f);
  memcpy(p->field[0], p->field[1], sizeof p->field[0]);
}

/* Displacement of the left particle after `time`, its velocity in *velocity: velocity Verlet, so
   that both are of the same time. */
static double oscillate(const law_case *c, double time, int steps, double *velocity) {
  static pair p;
  pair_open(&p, c, 2, 2);
  const double mass = *law_case_value((law_case *)(uintptr_t)c, "rho") * 2, dt = time / steps;
  p.v[0][FIRST] = 1;
  p.v[0][FIRST + 1] = -1;
  for (int n = 0; n <= steps; n++) {
    pair_forces(&p, c);
    for (int k = 0; k < 2; k++) {
      const double kick = p.force[0][FIRST + k] / mass * dt;
      p.v[0][FIRST + k] += (n == 0 || n == steps ? 0.5 : 1) * kick;
      if (n < steps) p.u[0][FIRST + k] += dt * p.v[0][FIRST + k];
    }
  }
  *velocity = p.v[0][FIRST];
  assert_true(p.force[0][FIRST] == -p.force[0][FIRST + 1]);
  return p.u[0][FIRST];
}

/* Two particles of a linear peridynamic solid do not change shape: each is a mass on a spring of
   the bulk modulus, omega^2 = 9 K/rho. The amplitude is small against their distance. */
static void two_particles_oscillate(void **state) {
  (void)state;
  law_case c;
  assert_true(law_case_open_in(&c, "lps", SETTING_SPACE));
  const double K = 130e9, nu = 0.25, time = 5e-5;
  *law_case_value(&c, "nu") = nu;
  *law_case_value(&c, "E") = 3 * K * (1 - 2 * nu);
  *law_case_value(&c, "rho") = 7800;
  const double omega = sqrt(9 * K / 7800), u = sin(omega * time) / omega, v = cos(omega * time);
  assert_true(fabs(u - 4.693e-5) < 5e-9 && fabs(v - 0.8183) < 5e-5);
  double error[2];
  for (int k = 0; k < 2; k++) {
    double velocity;
    const double moved = oscillate(&c, time, k ? 400 : 200, &velocity);
    error[k] = fabs(moved - u) / u;
    assert_true(fabs(velocity - v) < 1e-4);
  }
  if (!(error[1] < 1e-5 && error[0] / error[1] > 3.5 && error[0] / error[1] < 4.5))
    fail_msg("errors %.3g and %.3g with half the step", error[0], error[1]);
  law_case_close(&c);
}

/* --- patches ---------------------------------------------------------------------------------- */

/* A periodic patch of a lattice with the compiled kernel of a law. */
typedef struct law_patch {
  law_case c;
  deck_case k;
  patch *p;
} law_patch;

/* `lattice`: what stands in the group &lattice. */
static void patch_open(law_patch *l, const char *model_name, law_setting setting,
                       const char *lattice, long x, long y) {
  char text[1024];
  const bool space = setting == SETTING_SPACE;
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n&lattice name = 'l' spacing = '5 mm' %s %s%s%s /\n"
           "&body lattice = 'l' shape = '%s' /\n&material lattice = 'l' model = 'x' /\n",
           lattice, space ? "" : "thickness = '20 mm' setting = '",
           space ? "" : law_setting_name(setting), space ? "" : "'",
           space ? "sphere' centre = 0, 0, 0 radius = '20 mm"
                 : "disc' centre = 0, 0 radius = '20 mm");
  assert_true(deck_case_lattice(&l->k, text));
  assert_true(law_case_open_in(&l->c, model_name, setting));
  l->k.lattice->mass = *law_case_value(&l->c, "rho") * l->k.lattice->volume;
  l->p = patch_new(l->c.compiled, l->c.parameters, l->k.lattice, (long[3]){x, y, 1}, 0, 0);
}

static void patch_close(law_patch *l) {
  patch_free(l->p);
  law_case_close(&l->c);
  deck_case_close(&l->k);
}

/* Every particle alike: the energy of one (J) after a step with this gradient. */
static double uniform_energy(law_patch *l, const double gradient[3][3]) {
  patch_deform(l->p, gradient, NULL, l->p->displacement);
  patch_step(l->p);
  patch_accept(l->p);
  patch_observe(l->p);
  return l->p->observed[0][l->p->inside[0]];
}

static double energy_of_stretch(law_patch *l, double S) {
  return uniform_energy(l, (const double[3][3]){{S, 0, 0}, {0, S, 0}, {0, 0, S}});
}

/* An output of the law at the first particle. */
static double output_of(const law_patch *l, const char *name) {
  for (int o = 0; o < l->c.compiled->output_count; o++)
    if (strcmp(l->c.compiled->outputs[o].name, name) == 0)
      return l->p->observed[1 + o][l->p->inside[0]];
  fail_msg("no output %s", name);
  return 0;
}

/* The same of a field, toward neighbour k (particles: 0). */
static double field_of(const law_patch *l, const char *name, int k) {
  for (int f = 0; f < l->c.compiled->field_count; f++)
    if (strcmp(l->c.compiled->fields[f].name, name) == 0)
      return l->p->field[f][k * l->p->size + l->p->inside[0]];
  fail_msg("no field %s", name);
  return 0;
}

static void is_near(const char *what, double value, double expected, double relative) {
  if (!(fabs(value - expected) <= relative * fabs(expected)))
    fail_msg("%s: %.12g, not %.12g (relative error %.3g)", what, value, expected,
             value / expected - 1);
}

static const char *const square_lattices[] = {
    "kind = 'square' horizon = 3.015", "kind = 'square' horizon = 4.015",
    "kind = 'square' horizon = 5.015", "kind = 'square' horizon = 6.015"};
static const char *const plane_lattices[] = {"kind = 'square' horizon = 3.015 rotation = 20",
                                             "kind = 'hexagonal'",
                                             "kind = 'hexagonal' horizon = 4"};
static const char *const space_lattices[] = {"kind = 'cubic' horizon = 3.015",
                                             "kind = 'fcc' shells = 2"};

/* Calls `test` for both plane settings and for space, on every lattice. */
static void on_all_lattices(void (*test)(law_setting setting, const char *lattice)) {
  for (size_t k = 0; k < sizeof plane_lattices / sizeof *plane_lattices; k++) {
    test(SETTING_PLANE_STRESS, plane_lattices[k]);
    test(SETTING_PLANE_STRAIN, plane_lattices[k]);
  }
  for (size_t k = 0; k < sizeof space_lattices / sizeof *space_lattices; k++)
    test(SETTING_SPACE, space_lattices[k]);
}

/* --- prototype microelastic brittle ----------------------------------------------------------- */

/* Energy density over E S^2 of an equal stretch of all bonds: 9 K/2E in space (Silling and Askari
   2005, eq 7). */
static double density_of_stretch(law_setting setting, double nu) {
  return setting == SETTING_SPACE          ? 1.5 / (1 - 2 * nu)
         : setting == SETTING_PLANE_STRESS ? 1 / (1 - nu)
                                           : 1 / ((1 + nu) * (1 - 2 * nu));
}

static void pmb_stores_and_breaks(law_setting setting, const char *lattice) {
  law_patch l;
  patch_open(&l, "pmb", setting, lattice, 1, 1);
  const double E = *law_case_value(&l.c, "E"), G_0 = *law_case_value(&l.c, "G_0");
  const double nu = setting == SETTING_PLANE_STRESS ? 1. / 3 : 0.25, S = 1e-6;
  const double horizon = rows_bond_class(l.k.lattice, 0).horizon;
  const double s_0 = sqrt(G_0 / (E * horizon) *
                          (setting == SETTING_SPACE          ? 5. / 6
                           : setting == SETTING_PLANE_STRESS ? 4 * acos(-1) / 9
                                                             : 5 * acos(-1) / 12));
  is_near(lattice, energy_of_stretch(&l, S),
          density_of_stretch(setting, nu) * E * S * S * l.k.lattice->volume, 1e-9);
  assert_true(energy_of_stretch(&l, s_0 * (1 - 1e-9)) > 0 && output_of(&l, "broken") == 0);
  assert_true(energy_of_stretch(&l, s_0 * (1 + 1e-9)) == 0 && output_of(&l, "broken") == 1);
  patch_close(&l);
}

static void bonds_of_pmb_store_and_break(void **state) {
  (void)state;
  on_all_lattices(pmb_stores_and_breaks);
}

/* One bond: c V V S, where c = 12 E/(sum of s V) and the sum has one term. */
static void a_bond_of_pmb_pulls(void **state) {
  (void)state;
  static pair p;
  law_case c;
  const double distance = 0.02, V = 3e-6, S = 1e-5;
  assert_true(law_case_open_in(&c, "pmb", SETTING_SPACE));
  pair_open(&p, &c, distance, V);
  p.u[0][FIRST + 1] = S * distance;
  pair_forces(&p, &c);
  is_near("force", p.force[0][FIRST], 12 * *law_case_value(&c, "E") / (distance * V) * V * V * S,
          1e-9);
  assert_true(p.force[0][FIRST + 1] == -p.force[0][FIRST]);
  law_case_close(&c);
}

/* Work per area of pulling two half planes apart until no bond is left. Within the patch the upper
   half of the sites moves by the opening; the period grows by as much, so that the halves stay
   together at its border. */
static double work_of_fracture(law_patch *l, long height, double last) {
  enum { STEPS = 6000 };
  patch *p = l->p;
  const double spacing = l->k.lattice->spacing, period = (double)height * spacing;
  double work = 0, before = 0, most = 0, at[3],
         *part[3] = {calloc((size_t)p->sites, sizeof(double)),
                     calloc((size_t)p->sites, sizeof(double))};
  for (int n = 1; n <= STEPS; n++) {
    const double opening = last * n / STEPS, growth = opening / period;
    double force = 0;
    for (long k = 0; k < p->inside_count; k++) {
      patch_position(p, p->inside[k], at);
      part[1][p->inside[k]] = (2 * at[1] < period ? 0 : opening) - growth * at[1];
    }
    patch_deform(p, (const double[3][3]){{0, 0, 0}, {0, growth, 0}, {0, 0, 0}}, part,
                 p->displacement);
    patch_step(p);
    patch_accept(p);
    for (long k = 0; k < p->inside_count; k++) {
      patch_position(p, p->inside[k], at);
      if (2 * at[1] >= period) force -= p->force[1][p->inside[k]];
    }
    work += (force + before) / 2 * last / STEPS;
    before = force;
    most = fmax(most, force);
  }
  assert_true(fabs(before) < 1e-6 * most); /* rounding */
  free(part[0]);
  free(part[1]);
  return work / (spacing * 0.02);
}

/* The formula for s_0 is that of a continuum; on a lattice the error depends on how the horizon
   cuts it, and is small where the horizon is large. */
static void a_crack_in_pmb_costs_G_0(void **state) {
  (void)state;
  double error[4];
  for (int k = 0; k < 4; k++) {
    law_patch l;
    patch_open(&l, "pmb", SETTING_PLANE_STRESS, square_lattices[k], 1, 16);
    const double horizon = rows_bond_class(l.k.lattice, 0).horizon;
    const double E = *law_case_value(&l.c, "E"), G_0 = *law_case_value(&l.c, "G_0");
    const double s_0 = sqrt(4 * acos(-1) * G_0 / (9 * E * horizon));
    /* the last to break is the longest of those that rise by one row only */
    const double last = 1.05 * s_0 * horizon * horizon / l.k.lattice->spacing;
    error[k] = work_of_fracture(&l, 16, last) / G_0 - 1;
    patch_close(&l);
  }
  for (int k = 0; k < 4; k++) {
    print_message("%s: error of G_0 %.4f\n", square_lattices[k], error[k]);
    assert_true(fabs(error[k]) < (k < 3 ? 0.05 : 0.01));
  }
}

/* --- linear peridynamic solid ----------------------------------------------------------------- */

static void lps_has_the_bulk_modulus(law_setting setting, const char *lattice) {
  law_patch l;
  patch_open(&l, "lps", setting, lattice, 1, 1);
  const double E = *law_case_value(&l.c, "E"), nu = 0.3, S = 1e-6;
  *law_case_value(&l.c, "nu") = nu;
  patch_prepare(l.p, l.c.parameters);
  is_near(lattice, energy_of_stretch(&l, S),
          density_of_stretch(setting, nu) * E * S * S * l.k.lattice->volume, 1e-9);
  patch_close(&l);
}

static void dilation_of_lps_has_the_bulk_modulus(void **state) {
  (void)state;
  on_all_lattices(lps_has_the_bulk_modulus);
}

/* Error of the energy of a shear along x and y, or along the diagonals. */
static double shear_error(law_setting setting, const char *lattice, bool diagonal) {
  law_patch l;
  const double half = 5e-8;
  patch_open(&l, "lps", setting, lattice, 1, 1);
  const double mu = *law_case_value(&l.c, "E") / (2 * (1 + *law_case_value(&l.c, "nu")));
  const double along = diagonal ? half : 0, across = diagonal ? 0 : half;
  const double W =
      uniform_energy(&l, (const double[3][3]){{along, across, 0}, {across, -along, 0}, {0, 0, 0}});
  const double exact = 2 * mu * half * half * l.k.lattice->volume;
  patch_close(&l);
  return W / exact - 1;
}

/* The mean over all directions is exact on any lattice. What the two shears differ by depends on
   how the horizon cuts the square lattice; it does not fall step by step, but it is small beside
   that of eight neighbours. */
static void shear_of_lps_is_right_in_the_mean(void **state) {
  (void)state;
  const double eight = shear_error(SETTING_PLANE_STRESS, "kind = 'square' shells = 2", false);
  assert_true(fabs(shear_error(SETTING_PLANE_STRESS, "kind = 'hexagonal'", false)) < 1e-6);
  assert_true(fabs(shear_error(SETTING_PLANE_STRAIN, "kind = 'hexagonal' horizon = 3", true)) <
              1e-6);
  is_near("eight neighbours", eight, 1. / 3, 1e-6);
  for (int k = 0; k < 4; k++) {
    const double error = shear_error(SETTING_PLANE_STRESS, square_lattices[k], false);
    print_message("%s: error of the shear modulus %.4f\n", square_lattices[k], error);
    assert_true(fabs(error) < 0.3 * fabs(eight));
    is_near("along the diagonals", shear_error(SETTING_PLANE_STRESS, square_lattices[k], true),
            -error, 1e-4);
  }
}

/* --- elastic, perfectly plastic solid --------------------------------------------------------- */

static void shear(double gamma, double gradient[3][3]) {
  memset(gradient, 0, 9 * sizeof(double));
  gradient[0][1] = gradient[1][0] = gamma / 2;
}

/* Shear stress: derivative of the stored energy with what has flowed as it is. */
static double shear_stress(law_patch *l, double gamma) {
  const double h = 1e-8;
  double W[2], gradient[3][3];
  for (int k = 0; k < 2; k++) {
    shear(gamma + (k ? h : -h), gradient);
    patch_deform(l->p, (const double(*)[3])gradient, NULL, l->p->displacement);
    patch_observe(l->p);
    W[k] = l->p->observed[0][l->p->inside[0]];
  }
  return (W[1] - W[0]) / (2 * h * l->k.lattice->volume);
}

/* Strains gamma from `from` to `to`; returns the work density. *stress: at the end. */
static double shear_along(law_patch *l, double from, double to, double *stress) {
  enum { STEPS = 200 };
  double work = 0, gradient[3][3];
  for (int n = 1; n <= STEPS; n++) {
    const double gamma = from + (to - from) * n / STEPS, before = *stress;
    shear(gamma, gradient);
    uniform_energy(l, (const double(*)[3])gradient);
    *stress = shear_stress(l, gamma);
    work += (before + *stress) / 2 * (to - from) / STEPS;
  }
  return work;
}

/* Sheared to four times the strain of first yield, back and forth. Returns the error of the yield
   stress against von Mises. */
static double error_of_yield(const char *lattice) {
  law_patch l;
  patch_open(&l, "eps", SETTING_SPACE, lattice, 1, 1);
  const double E = *law_case_value(&l.c, "E"), nu = *law_case_value(&l.c, "nu");
  const double tau_y = *law_case_value(&l.c, "sigma_y") / sqrt(3),
               gamma_y = tau_y * 2 * (1 + nu) / E;
  double stress = 0, yield;
  shear_along(&l, 0, 0.8 * gamma_y, &stress);
  const double modulus = stress / (0.8 * gamma_y);
  assert_true(output_of(&l, "plastic") == 0);
  shear_along(&l, 0.8 * gamma_y, 2 * gamma_y, &stress);
  assert_true(output_of(&l, "plastic") > 0);
  yield = stress;
  shear_along(&l, 2 * gamma_y, 4 * gamma_y, &stress);
  is_near("stress stays on the surface", stress, yield, 2e-4);
  shear_along(&l, 4 * gamma_y, -4 * gamma_y, &stress);
  is_near("and in the other direction", stress, -yield, 2e-4);
  const double there = shear_along(&l, -4 * gamma_y, 4 * gamma_y, &stress);
  const double back = shear_along(&l, 4 * gamma_y, -4 * gamma_y, &stress);
  /* a parallelogram, whose corners the steps round off a little */
  /* the norm of the force state is a multiple of the root of the energy */
  is_near("yield stress by the lattice's modulus", yield, tau_y * sqrt(modulus * 2 * (1 + nu) / E),
          2e-4);
  is_near("work of a cycle", there + back, 2 * yield * (8 * gamma_y - 2 * yield / modulus), 0.005);
  patch_close(&l);
  return yield / tau_y - 1;
}

static void eps_yields_in_shear(void **state) {
  (void)state;
  static const char *const lattices[] = {"kind = 'cubic' horizon = 2.015",
                                         "kind = 'cubic' horizon = 3.015",
                                         "kind = 'fcc' shells = 3"};
  for (size_t k = 0; k < sizeof lattices / sizeof *lattices; k++) {
    const double error = error_of_yield(lattices[k]);
    print_message("%s: error of the yield stress %.4f\n", lattices[k], error);
    assert_true(fabs(error) < 0.06);
  }
}

/* --- concrete --------------------------------------------------------------------------------- */

/* A family whose neighbours are all in its own state (Nikravesh 2017, eqs 3.18, 3.37, 3.43 to 3.48,
   3.61, 4.5, 4.10 to 4.17), hexagon in plane stress. */
typedef struct concrete {
  double E, nu, f_t, f_c, f_y, eps_ult, G_f, alpha, gamma, w_cr, s, t, V; /* of the law */
  double n[6][3];                                                         /* x^2, y^2, x y */
  double w_t, w_c, S_p[6], yielded;
  double sigma_1, energy; /* of the last step, with the new state */
} concrete;

/* Of a symmetric tensor xx, yy, xy and zz, no other shear. */
static double first_principal(const double a[3], double zz) {
  const double mean = (a[0] + a[1]) / 2, radius = hypot((a[0] - a[1]) / 2, a[2]);
  return fmax(mean + radius, zz);
}

static double second_invariant(const double a[3], double zz) {
  const double mean = (a[0] + a[1] + zz) / 3;
  const double x = a[0] - mean, y = a[1] - mean, z = zz - mean;
  return (x * x + y * y + z * z) / 2 + a[2] * a[2];
}

static void concrete_forces(const concrete *c, const double S[6], double S_e[6], double F[6],
                            double sigma[3]) {
  const double a = 2 * c->E * c->s * c->t / (sqrt(3) * (1 + c->nu));
  const double b = c->E * c->s * c->t * (1 - 3 * c->nu) / (6 * sqrt(3) * (c->nu * c->nu - 1));
  double d[6], dilatation = 0;
  memset(sigma, 0, 3 * sizeof *sigma);
  for (int k = 0; k < 6; k++) {
    S_e[k] = S[k] - (c->S_p[k] + c->S_p[(k + 3) % 6]) / 2;
    d[k] = 1 - (S_e[k] >= 0 ? c->w_t : c->w_c); /* two equal springs in series */
    dilatation += d[k] * S_e[k];
  }
  for (int k = 0; k < 6; k++) {
    F[k] = d[k] * a * S_e[k] + b * dilatation;
    for (int v = 0; v < 3; v++)
      sigma[v] += c->n[k][v] * c->s * F[k] / (2 * c->V);
  }
}

/* Least squares on a regular hexagon: sums of x^4, x^2 y^2 are 9/4 and 3/4. */
static void concrete_strain(const concrete *c, const double S[6], double eps[3], double *zz) {
  double sum[3] = {0, 0, 0};
  for (int k = 0; k < 6; k++)
    for (int v = 0; v < 3; v++)
      sum[v] += c->n[k][v] * S[k];
  eps[0] = (3 * sum[0] - sum[1]) / 6;
  eps[1] = (3 * sum[1] - sum[0]) / 6;
  eps[2] = sum[2] / (2 * 0.75); /* half the angle */
  *zz = -c->nu / (1 - c->nu) * (eps[0] + eps[1]);
}

static void concrete_flow(concrete *c, const double F[6], double f) {
  double mean = 0, size = 0;
  for (int k = 0; k < 6; k++)
    mean += F[k] / 6;
  for (int k = 0; k < 6; k++)
    size += (F[k] - mean) * (F[k] - mean);
  for (int k = 0; k < 6; k++)
    c->S_p[k] += c->f_y / c->E * f * (F[k] - mean) / sqrt(size);
  c->yielded = 1;
}

static double tensile_damage(const concrete *c, double eps_1) {
  const double last = 2 * c->G_f / (c->f_t * (c->alpha + c->gamma)), knee = c->alpha * last;
  const double opening = 2 * c->s * eps_1, ratio = c->f_t / (c->E * eps_1);
  if (opening <= knee) return 1 - ratio * (1 - (1 - c->gamma) * opening / knee);
  if (opening <= last) return 1 - c->gamma * ratio * (last - opening) / (last - knee);
  return 1;
}

static void concrete_step(concrete *c, const double S[6]) {
  double S_e[6], F[6], sigma[3], eps[3], zz;
  concrete_forces(c, S, S_e, F, sigma);
  concrete_strain(c, S, eps, &zz);
  const double eps_eff = sqrt(3 * second_invariant(eps, zz));
  const double F_eff = c->f_y + (c->f_c - c->f_y) * eps_eff / c->eps_ult;
  const double f = second_invariant(sigma, 0) / (F_eff * F_eff / 3) - 1;
  if (f >= 0) concrete_flow(c, F, f);
  if (first_principal(sigma, 0) >= c->f_t || c->w_t > 0)
    c->w_t = fmax(c->w_t, tensile_damage(c, fmax(first_principal(eps, zz), 1e-12)));
  if (c->yielded > 0 && eps_eff >= c->eps_ult) c->w_c = 1;
  if (c->w_t > c->w_cr) c->w_c = fmax(c->w_c, (sqrt(c->w_t) - sqrt(c->w_cr)) / (1 - sqrt(c->w_cr)));
  concrete_forces(c, S, S_e, F, sigma);
  c->sigma_1 = first_principal(sigma, 0);
  c->energy = 0;
  for (int k = 0; k < 6; k++)
    c->energy += c->s * F[k] * S_e[k] / 4;
}

static void concrete_open(concrete *c, law_patch *l) {
  memset(c, 0, sizeof *c);
  struct {
    double *to;
    const char *name;
  } values[] = {{&c->E, "E"},      {&c->nu, "nu"},       {&c->f_t, "f_t"},
                {&c->f_c, "f_c"},  {&c->f_y, "f_y"},     {&c->eps_ult, "eps_ult"},
                {&c->G_f, "G_f"},  {&c->alpha, "alpha"}, {&c->gamma, "gamma"},
                {&c->w_cr, "w_cr"}};
  for (size_t k = 0; k < sizeof values / sizeof *values; k++)
    *values[k].to = *law_case_value(&l->c, values[k].name);
  c->s = l->k.lattice->spacing;
  c->t = 0.02;
  c->V = l->k.lattice->volume;
}

/* A family strained along x, the sides held, from corner to corner; what it reached. */
static concrete concrete_along(const double *corners, int count) {
  enum { STEPS = 400 };
  law_patch l;
  concrete c;
  patch_open(&l, "splm_concrete", SETTING_PLANE_STRESS, "kind = 'hexagonal' rotation = 17", 1, 1);
  concrete_open(&c, &l);
  for (int n = 0; n < (count - 1) * STEPS; n++) {
    const double part = (double)(n % STEPS + 1) / STEPS, *corner = corners + n / STEPS;
    const double eps_x = corner[0] + (corner[1] - corner[0]) * part;
    double S[6];
    for (int k = 0; k < 6; k++) {
      const double *chord = rows_bond_class(l.k.lattice, k).chord;
      const double x = chord[0] / c.s, y = chord[1] / c.s;
      S[k] = hypot((1 + eps_x) * x, y) - 1;
      memcpy(c.n[k], (const double[3]){x * x, y * y, x * y}, sizeof c.n[k]);
    }
    const double energy =
        uniform_energy(&l, (const double[3][3]){{eps_x, 0, 0}, {0, 0, 0}, {0, 0, 0}});
    concrete_step(&c, S);
    const bool near = fabs(field_of(&l, "w_t", 0) - c.w_t) < 1e-9 &&
                      fabs(field_of(&l, "w_c", 0) - c.w_c) < 1e-9 &&
                      fabs(field_of(&l, "S_p", 1) - c.S_p[1]) < 1e-12 &&
                      fabs(output_of(&l, "sigma_1") - c.sigma_1) < 1e-6 * c.f_t &&
                      fabs(energy - c.energy) <= 1e-9 * c.E * 1e-6 * c.V;
    if (!near)
      fail_msg("strain %g: w_t %.12g and %.12g, w_c %.12g and %.12g, S_p %.12g and %.12g, stress "
               "%.12g and %.12g, energy %.12g and %.12g",
               eps_x, field_of(&l, "w_t", 0), c.w_t, field_of(&l, "w_c", 0), c.w_c,
               field_of(&l, "S_p", 1), c.S_p[1], output_of(&l, "sigma_1"), c.sigma_1, energy,
               c.energy);
  }
  patch_close(&l);
  return c;
}

static void concrete_follows_its_equations(void **state) {
  (void)state;
  static const double torn[] = {0, 1.5e-3, 2e-4, 2e-2, -1e-3};
  static const double yields[] = {0, -2e-3, 0, 4e-3, -1e-3}, crushed[] = {0, -2e-3, -5e-3, 0};
  concrete c = concrete_along(torn, 5);
  assert_true(c.w_t == 1 && c.w_c == 1 && c.yielded == 0);
  c = concrete_along(yields, 5);
  assert_true(c.w_t > 0.9 && c.w_t < 1 && c.yielded == 1);
  c = concrete_along(crushed, 4);
  assert_true(c.w_c == 1 && c.yielded == 1);
}

/* --- alone ------------------------------------------------------------------------------------ */

/* A law of families may divide by what a family has: a particle without bonds takes nothing from
   the ledger. */
static void a_particle_alone_stores_nothing(void **state) {
  (void)state;
  static const char *const models[] = {"lps", "pmb", "splm_elastic", "splm_concrete"};
  for (size_t k = 0; k < sizeof models / sizeof *models; k++) {
    deck_case c;
    char text[1024];
    snprintf(text, sizeof text,
             "&simulation end_time = '1 us' step_safety = 0.3 /\n"
             "&lattice name = 'l' kind = 'hexagonal' spacing = '5 mm' thickness = '20 mm' /\n"
             "&material lattice = 'l' model = '%s' /\n"
             "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '30 mm', '20 mm' /\n"
             "&body lattice = 'l' shape = 'point' at = '60 mm', 0 /\n"
             "&region name = 'base' shape = 'rectangle' corner = 0, 0 size = '70 mm', '1 mm' /\n"
             "&drive region = 'base' component = 'y' velocity = '-1 m/s' /\n&output sample = '0.2 "
             "us' /\n",
             models[k]);
    assert_true(deck_case_text(&c, text));
    assert_int_equal(deck_case_go(&c), STEP_END);
    const double *stored = deck_case_series(&c, "energy/stored");
    const double last = stored[simulation_history(c.simulation, NULL) - 1];
    if (!(last > 0)) fail_msg("%s stores %g J", models[k], last);
    deck_case_close(&c);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lattices_have_the_stiffness_of_the_solid),
      cmocka_unit_test(two_particles_oscillate),
      cmocka_unit_test(bonds_of_pmb_store_and_break),
      cmocka_unit_test(a_bond_of_pmb_pulls),
      cmocka_unit_test(a_crack_in_pmb_costs_G_0),
      cmocka_unit_test(dilation_of_lps_has_the_bulk_modulus),
      cmocka_unit_test(shear_of_lps_is_right_in_the_mean),
      cmocka_unit_test(a_particle_alone_stores_nothing),
      cmocka_unit_test(eps_yields_in_shear),
      cmocka_unit_test(concrete_follows_its_equations),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
