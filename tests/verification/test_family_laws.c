/* Laws of families of models/ against theory: elastic constants of lattices, two particles as an oscillator, a
   yield surface, energies and forces. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/stencil.h"
#include "tests/verification/case.h"

/* --- elastic constants ------------------------------------------------------------------------ */

/* D of an isotropic solid, in the order xx, yy, xy or xx, yy, zz, xy, yz, xz, shear strains as angles. */
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

/* Long waves in the lattice with the law's own kernel against the isotropic solid: the largest entry that is off, over the
   largest. */
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
  for (int setting = SETTING_PLANE_STRESS; setting <= SETTING_SPACE; setting++)
    for (size_t k = 0; k < sizeof ratios / sizeof *ratios; k++) {
      const double error =
          error_of_D("splm_elastic", setting == SETTING_SPACE ? space_deck : plane_deck,
                     (law_setting)setting, ratios[k]);
      if (!(error < 1e-8))
        fail_msg("%s, nu %g: D is off by %.3g", law_setting_name((law_setting)setting), ratios[k],
                 error);
    }
}

/* --- two particles ---------------------------------------------------------------------------- */

/* Particles 0 and 1 of one row, bonded to each other alone, in the arrays that a pass wants; eight places of nothing
   before and behind. */
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
    const pl_bond_class b = {.s = distance,
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
  pl_family f = {.count = 8,
                 .neighbours = 2,
                 .plane = PLACES,
                 .offset = p->offset,
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

/* Displacement of the left particle after `time`, its velocity in *velocity: velocity Verlet, so that both are of the same
   time. */
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

/* Two particles of a linear peridynamic solid do not change shape: each is a mass on a spring of the bulk modulus,
   omega^2 = 9 K/rho. The amplitude is small against their distance. */
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

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lattices_have_the_stiffness_of_the_solid),
      cmocka_unit_test(two_particles_oscillate),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
