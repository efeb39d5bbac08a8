/* Laws by correspondence against the solid that they are made of: the stress of a uniform
   deformation, rotations, balance inside, the motion that the gradient does not see, waves, the
   energy of a free body, E and nu of a bar. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/analysis/stencil.h"
#include "runtime/interaction/bond_forces.h"
#include "tests/verification/case.h"

static const double E = 30e9, NU = 0.2;

#define HEAD  "&simulation end_time = 1e-4 /\n&output sample = 1e-5 /\n"
#define PLATE "&body lattice = 'l' shape = 'disc' centre = 0, 0 radius = 0.08 /\n"
#define BALL  "&body lattice = 'l' shape = 'sphere' centre = 3*0 radius = 0.05 /\n"
#define PLANE(kind)                                                                                \
  HEAD "&lattice name = 'l' spacing = 0.01 thickness = 0.02 kind = " kind " /\n" PLATE
#define SPACE(kind) HEAD "&lattice name = 'l' spacing = 0.01 kind = " kind " /\n" BALL
#define OF(keys)    "&material lattice = 'l' model = 'correspondence' " keys " /\n"

typedef struct body_case {
  deck_case deck;
  sweep *w;
  const rows *g;
  bond_forces *forces;
  double *force[3]; /* [size] on the particles, N */
} body_case;

static void open_case(body_case *c, const char *text) {
  deck_case_open(&c->deck, text);
  c->w = simulation_state(c->deck.simulation, 0);
  c->g = c->w->body->lattice;
  c->forces = bond_forces_new(c->w);
  for (int d = 0; d < 3; d++)
    c->force[d] = calloc((size_t)c->g->size, sizeof(double));
}

static void close_case(body_case *c) {
  for (int d = 0; d < 3; d++)
    free(c->force[d]);
  bond_forces_free(c->forces);
  deck_case_close(&c->deck);
}

static void add_force(void *to, const bond_force *b) {
  body_case *c = to;
  for (int d = 0; d < c->g->dimensions; d++) {
    c->force[d][b->owner] += b->on_owner[d];
    c->force[d][b->partner] += b->on_partner[d];
  }
}

static void find_forces(body_case *c) {
  for (int d = 0; d < 3; d++)
    memset(c->force[d], 0, (size_t)c->g->size * sizeof(double));
  bond_forces_find(c->forces, -1);
  bond_forces_each(c->forces, NULL, add_force, c);
}

/* u = (F - 1) x */
static void deform(body_case *c, double F[3][3]) {
  for (long q = 0; q < c->g->size; q++) {
    double at[3];
    rows_place(c->g, q, at);
    for (int a = 0; a < c->g->dimensions && c->g->present[q]; a++) {
      c->w->body->displacement[a][q] = 0;
      for (int b = 0; b < c->g->dimensions; b++)
        c->w->body->displacement[a][q] += (F[a][b] - (a == b)) * at[b];
    }
  }
}

/* P = F S of S = hooke(e), e = (F^T F - 1)/2; in plane stress without the third direction. */
static void stress_of(double F[3][3], int dimensions, double P[3][3]) {
  double e[3][3] = {{0}}, S[3][3], sum = 0;
  const double lambda =
      dimensions == 2 ? E * NU / (1 - NU * NU) : E * NU / ((1 + NU) * (1 - 2 * NU));
  for (int a = 0; a < dimensions; a++)
    for (int b = 0; b < dimensions; b++) {
      for (int k = 0; k < dimensions; k++)
        e[a][b] += F[k][a] * F[k][b] / 2;
      e[a][b] -= a == b ? 0.5 : 0;
      sum += a == b ? e[a][b] : 0;
    }
  for (int a = 0; a < dimensions; a++)
    for (int b = 0; b < dimensions; b++)
      S[a][b] = E / (1 + NU) * e[a][b] + (a == b ? lambda * sum : 0);
  for (int a = 0; a < dimensions; a++)
    for (int b = 0; b < dimensions; b++) {
      P[a][b] = 0;
      for (int k = 0; k < dimensions; k++)
        P[a][b] += F[a][k] * S[k][b];
    }
}

/* Of the whole body, from the work of its forces: -sum(f x) over its volume. */
static void stress_of_body(const body_case *c, double P[3][3]) {
  double volume = 0, at[3];
  memset(P, 0, 9 * sizeof(double));
  for (long q = 0; q < c->g->size; q++) {
    if (!c->g->present[q]) continue;
    rows_place(c->g, q, at);
    volume += rows_stressed_volume(c->g, q);
    for (int a = 0; a < c->g->dimensions; a++)
      for (int b = 0; b < c->g->dimensions; b++)
        P[a][b] -= c->force[a][q] * at[b];
  }
  for (int a = 0; a < 9; a++)
    P[a / 3][a % 3] /= volume;
}

static double largest(const body_case *c, double inside) {
  double most = 0, at[3];
  for (long q = 0; q < c->g->size; q++) {
    rows_place(c->g, q, at);
    const double r = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
    for (int d = 0; d < c->g->dimensions && c->g->present[q] && r < inside; d++)
      most = fmax(most, fabs(c->force[d][q]));
  }
  return most;
}

typedef struct sample_case {
  const char *deck;
  double inside; /* m: where families of families are whole, lattices only */
} sample_case;

static const sample_case samples[] = {
    {PLANE("'hexagonal' rotation = 17") OF(""), 0.05},
    {PLANE("'hexagonal' horizon = 3") OF("G = 0"), 0.02},
    {PLANE("'square' horizon = 1.5") OF(""), 0.04},
    {PLANE("'blue_noise' seed = 4") OF(""), 0},
    {SPACE("'fcc' shells = 2 rotation = 30 axis = 1, 2, 0") OF(""), 0.015},
    {SPACE("'cubic' shells = 2") OF(""), 0.015},
    {SPACE("'blue_noise' setting = 'space' seed = 4") OF("G = 1"), 0},
};

/* Whatever the family, at edges, too. Inside of a lattice no particle is drawn anywhere. */
static void a_uniform_deformation_has_the_stress_of_the_solid(void **state) {
  (void)state;
  double F[3][3] = {{1.1, 0.2, -0.1}, {-0.05, 0.9, 0.15}, {0.05, 0.1, 1.05}};
  for (size_t n = 0; n < sizeof samples / sizeof *samples; n++) {
    body_case c;
    double P[3][3], found[3][3], off = 0, size = 0;
    open_case(&c, samples[n].deck);
    const int dimensions = c.g->dimensions;
    deform(&c, F);
    find_forces(&c);
    stress_of(F, dimensions, P);
    stress_of_body(&c, found);
    for (int a = 0; a < dimensions; a++)
      for (int b = 0; b < dimensions; b++) {
        size = fmax(size, fabs(P[a][b]));
        off = fmax(off, fabs(P[a][b] - found[a][b]));
      }
    print_message("P off by %.2g, force inside %.2g of that at the edge\n", off / size,
                  largest(&c, samples[n].inside) / largest(&c, 1));
    assert_true(off < 1e-12 * size);
    assert_true(largest(&c, samples[n].inside) < 1e-11 * largest(&c, 1));
    close_case(&c);
  }
}

static void turned_bodies_feel_nothing(void **state) {
  (void)state;
  double strained[3][3] = {{1.001, 0, 0}, {0, 1, 0}, {0, 0, 1}},
         turned[3][3] = {{cos(2), -sin(2), 0}, {sin(2), cos(2), 0}, {0, 0, 1}};
  for (size_t n = 0; n < sizeof samples / sizeof *samples; n++) {
    body_case c;
    open_case(&c, samples[n].deck);
    deform(&c, strained);
    find_forces(&c);
    const double size = largest(&c, 1);
    deform(&c, turned);
    find_forces(&c);
    assert_true(largest(&c, 1) < 1e-10 * size);
    close_case(&c);
  }
}

/* The law of which only the energy is given. */
#define BY_ENERGY                                                                                  \
  "&material lattice = 'l' model = '../tests/generator/families/gradients.plm' Y = '30 GPa' nu = " \
  "0.2 /\n&field name = 'T' value = '300 [K] + 50 [K]*x/1 [m] - 20 [K]*y/1 [m]' /\n"

/* Derived from the energy, the forces have the stress of the solid; V Y/10 of the square of the
   mean stretch m adds m Y/5 mean(e X/L) to it, e the present directions. Gradients of what is
   linear are exact everywhere, so that theirs are 0. */
static void an_energy_alone_gives_the_same(void **state) {
  (void)state;
  static const char *const decks[] = {PLANE("'hexagonal' horizon = 2") BY_ENERGY,
                                      PLANE("'blue_noise' seed = 4") BY_ENERGY};
  double F[3][3] = {{1.1, 0.2, 0}, {-0.05, 0.9, 0}, {0, 0, 1}};
  for (int n = 0; n < 2; n++) {
    body_case c;
    double P[3][3], found[3][3], volume = 0;
    open_case(&c, decks[n]);
    deform(&c, F);
    find_forces(&c);
    stress_of(F, 2, P);
    stress_of_body(&c, found);
    double more[2][2] = {{0}};
    for (long q = 0; q < c.g->size; q++) {
      double mean = 0, part[2][2] = {{0}};
      int bonds = 0;
      if (!c.g->present[q]) continue;
      for (int k = 0; k < 2 * c.g->directions; k++) {
        double X[3], x[2], length;
        if (!rows_has_neighbour(c.g, q, k)) continue;
        const double s = rows_chord(c.g, q, k, X);
        for (int a = 0; a < 2; a++)
          x[a] = F[a][0] * X[0] + F[a][1] * X[1];
        length = hypot(x[0], x[1]);
        mean += length / s - 1;
        for (int a = 0; a < 4; a++)
          part[a / 2][a % 2] += x[a / 2] / length * X[a % 2] / s;
        bonds++;
      }
      for (int a = 0; a < 4; a++)
        more[a / 2][a % 2] +=
            rows_stressed_volume(c.g, q) * E / 5 * mean / bonds * part[a / 2][a % 2] / bonds;
      volume += rows_stressed_volume(c.g, q);
    }
    for (int a = 0; a < 4; a++)
      assert_true(fabs(P[a / 2][a % 2] + more[a / 2][a % 2] / volume - found[a / 2][a % 2]) <
                  1e-12 * P[0][0]);
    static const double expected[] = {50, -20, 0, 1, 0}, size[] = {50, 50, 50 / 0.01, 1, 1};
    double *values = calloc((size_t)c.g->size, sizeof *values);
    sweep_observe(c.w);
    for (int k = 0; k < 5; k++) {
      sweep_output(c.w, k, values);
      for (long q = 0; q < c.g->size; q++)
        if (c.g->present[q]) assert_true(fabs(values[q] - expected[k]) < 1e-10 * size[k]);
    }
    free(values);
    close_case(&c);
  }
}

/* --- what the gradient does not see ----------------------------------------------------------- */

/* Rows of a hexagon that move by turns, here those along x: each particle has 4 neighbours of the
   other kind, which is 2 a away, at z = -2 a, and 2 of its own. The gradient is 0, and
   f = -4 (2 c V^2)(2 a), c = G E/(6 s^2 V), which is -8/3 G E V a/s^2. Without G there is no
   force. */
static void rows_by_turns_cost_what_G_says(void **state) {
  (void)state;
  static const double s = 0.01, t = 0.02, a = 1e-6;
  static const double G[] = {0, 0.2, 1};
  for (int n = 0; n < 3; n++) {
    body_case c;
    char text[1000];
    double at[3], worst = 0;
    snprintf(text, sizeof text, PLANE("'hexagonal'") OF("G = %g"), G[n]);
    open_case(&c, text);
    for (long q = 0; q < c.g->size; q++) {
      rows_place(c.g, q, at);
      const long row = lround(at[1] / (sqrt(3) / 2 * s));
      c.w->body->displacement[0][q] = c.g->present[q] ? (row % 2 ? -a : a) : 0;
    }
    find_forces(&c);
    const double V = sqrt(3) / 2 * s * s * t, one = 8.0 / 3 * E * V * a / (s * s);
    long inside = 0;
    for (long q = 0; q < c.g->size; q++) {
      rows_place(c.g, q, at);
      if (!c.g->present[q] || hypot(at[0], at[1]) > 0.05) continue;
      inside++;
      const double sign = c.w->body->displacement[0][q] / a;
      worst = fmax(worst, fabs(c.force[0][q] + sign * G[n] * one) + fabs(c.force[1][q]));
    }
    assert_true(inside > 50);
    assert_true(worst < 1e-10 * one);
    close_case(&c);
  }
}

/* Along the rows of a hexagon of nearest neighbours: with a = k s the gradient of a wave of u along
   x is i g u, g = 2/(3 s) (sin a + sin(a/2)), and the springs see what models/README.md says. At
   the end of the zone across the rows g is 0. */
static void waves_are_those_of_the_page(void **state) {
  (void)state;
  static const double s = 0.01, rho = 2323, waves[] = {40, 20, 10, 4};
  static const double G[] = {0, 0.2, 1};
  for (int n = 0; n < 3; n++) {
    body_case c;
    char text[1000];
    snprintf(text, sizeof text, PLANE("'hexagonal'") OF("G = %g"), G[n]);
    open_case(&c, text);
    crystal waves_in = stencil_crystal(c.deck.law.law, c.deck.law.parameters, c.g);
    for (int q = 0; q < 4; q++) {
      const double a = 2 * acos(-1) / waves[q], g = 2 / (3 * s) * (sin(a) + sin(a / 2));
      const double springs = G[n] * E / (6 * rho * s * s) *
                             (4 * (1 - cos(a)) + 8 * (1 - cos(a / 2)) - 3 * s * s * g * g);
      const double exact = sqrt(E / (1 - NU * NU) / rho * g * g + springs),
                   found = waves_omega(&waves_in, (const double[3]){a / s, 0, 0});
      print_message("G %g, wave of %2.0f spacings: %+.2f %%\n", G[n], waves[q],
                    100 * (exact / (a / s) / sqrt(E / (1 - NU * NU) / rho) - 1));
      assert_true(fabs(found / exact - 1) < 1e-6);
    }
    const double end[3] = {0, 2 * acos(-1) / sqrt(3) / s, 0};
    const double by_turns = waves_omega(&waves_in, end), theory = sqrt(8 * G[n] / 3 * E / rho) / s;
    assert_true(fabs(by_turns - theory) < 1e-3 * sqrt(E / rho) / s);
    crystal_free(&waves_in);
    close_case(&c);
  }
}

/* --- in time ---------------------------------------------------------------------------------- */

static const char *const ringing =
    "&simulation end_time = '0.2 ms' step = '%g us' /\n"
    "&lattice name = 'l' kind = '%s' spacing = '10 mm' thickness = '10 mm' horizon = 1.5 /\n"
    "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '200 mm', '100 mm' /\n"
    "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 3, 3 /\n"
    "&initial_displacement region = 'all' component = 'x' "
    "value = '%g [mm]*cos(180 [deg]*x/0.2 [m])' /\n&output sample = '20 us' losses = .true. /\n"
    "&material lattice = 'l' model = '%s' /\n";

/* Of the largest energy: of a plate of large strains, 6 %, that rings, and of one that loses most
   of its stiffness and energy. */
static double imbalance(const char *kind, bool softens, double step) {
  deck_case c;
  char text[2000];
  snprintf(text, sizeof text, ringing, step, kind, softens ? 0.2 : 4.0,
           softens ? "../tests/generator/families/softening_solid.plm" : "correspondence");
  deck_case_open(&c, text);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double lost = deck_case_last(&c, "energy/dissipated_damage");
  assert_true(softens ? lost > 0.5 * deck_case_largest(&c, "energy/stored") : lost == 0);
  const double found =
      deck_case_largest(&c, "energy/imbalance") / deck_case_largest(&c, "energy/stored");
  deck_case_close(&c);
  return found;
}

/* The error is that of the steps: of the second order in them. */
static void free_bodies_keep_their_energy(void **state) {
  (void)state;
  static const char *const kinds[] = {"hexagonal", "square", "hexagonal"};
  for (int k = 0; k < 3; k++) {
    const double coarse = imbalance(kinds[k], k == 2, 0.8), fine = imbalance(kinds[k], k == 2, 0.4);
    print_message("%s: imbalance %.3g, with half the step %.3g\n", kinds[k], coarse, fine);
    assert_true(fine < 1e-4);
    assert_true(coarse / fine > 3.5 && coarse / fine < 4.5);
  }
}

/* --- a bar ------------------------------------------------------------------------------------ */

static const char *const bar =
    "&simulation end_time = 1 /\n&relaxation increments = 1 tolerance = 1e-7 /\n"
    "&lattice name = 'l' kind = 'hexagonal' spacing = '%g mm' thickness = '10 mm' rotation = 15 /\n"
    "&body lattice = 'l' shape = 'rectangle' corner = 0, -0.05 size = 0.3, 0.1 /\n"
    "&region name = 'left' shape = 'rectangle' corner = -1, -1 size = 1.03, 2 /\n"
    "&region name = 'right' shape = 'rectangle' corner = 0.27, -1 size = 1, 2 /\n"
    "&region name = 'middle' shape = 'rectangle' corner = 0.1, -0.03 size = 0.1, 0.06 /\n"
    "&region name = 'pin' shape = 'point' at = 0, 0 /\n"
    "&support region = 'left' fix = 'x' /\n&support region = 'pin' fix = 'y' /\n"
    "&drive region = 'right' component = 'x' displacement = '3 um' /\n"
    "&monitor name = 'N' kind = 'force' at = 0.15, 0 normal = 1, 0 component = 'x' /\n"
    "&monitor name = 'e_x' kind = 'strain' region = 'middle' component = 'xx' /\n"
    "&monitor name = 'e_y' kind = 'strain' region = 'middle' component = 'yy' /\n" OF("nu = 0.3");

/* The edges of the turned lattice are ragged, and families there are cut: what E lacks falls with
   the spacing. */
static void a_bar_has_E_and_nu(void **state) {
  (void)state;
  double before = INFINITY;
  for (double h = 20; h > 4; h /= 2) {
    deck_case c;
    char text[2000];
    snprintf(text, sizeof text, bar, h);
    deck_case_open(&c, text);
    assert_int_equal(deck_case_go(&c), STEP_END);
    const double e = deck_case_last(&c, "e_x"), nu = -deck_case_last(&c, "e_y") / e,
                 off = 1 - deck_case_last(&c, "N") / (0.1 * 0.01) / e / E;
    print_message("spacing %g mm: E %+.2f %%, nu %.4f\n", h, -100 * off, nu);
    assert_true(off > 0 && off < 0.65 * before);
    assert_true(fabs(nu - 0.3) < 4e-4 * h);
    before = off;
    deck_case_close(&c);
  }
  assert_true(before < 0.03);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_uniform_deformation_has_the_stress_of_the_solid),
      cmocka_unit_test(turned_bodies_feel_nothing),
      cmocka_unit_test(an_energy_alone_gives_the_same),
      cmocka_unit_test(rows_by_turns_cost_what_G_says),
      cmocka_unit_test(waves_are_those_of_the_page),
      cmocka_unit_test(free_bodies_keep_their_energy),
      cmocka_unit_test(a_bar_has_E_and_nu),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
