/* The stable time step against theory and against what a lattice does at steps just below and just
 * above it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "runtime/analysis/stability.h"
#include "runtime/filling/lattice.h"
#include "runtime/lattice/rows.h"

/* --- laws written by hand: the linear micropolar bond, with dampers --------------------------- */

enum { E_, NU, ZETA, OMEGA_N, DAMPER, DAMAGE_AT, PARAMETERS };
enum { NONE, VISCOUS, FRICTION, CONSTANT };
enum { S, EA, EI, DASHPOT, UNIFORMS };

static const double rate_0 = 10; /* 1/s */

/* Rigidities of the hexagonal lattice in plane stress (Asadollahi 2014, eq 2.49). */
static double axial_rigidity(double e, double nu, double s, double t) {
  return e * s * t / (sqrt(3) * (1 - nu));
}

static double bending_rigidity(double e, double nu, double s, double t) {
  return e * s * s * s * t * (1 - 3 * nu) / (12 * sqrt(3) * (1 - nu * nu));
}

/* uniforms: the four, then the parameters */
static void prepare(const pl_law *law, const double *p, const pl_bond_class *b, double *u) {
  (void)law;
  u[S] = b->s;
  u[EA] = axial_rigidity(p[E_], p[NU], b->s, b->t);
  u[EI] = bending_rigidity(p[E_], p[NU], b->s, b->t);
  u[DASHPOT] = 2 * p[ZETA] * b->mass_i * p[OMEGA_N] * b->s; /* N s: by stretch rate */
  memcpy(u + UNIFORMS, p, PARAMETERS * sizeof *p);
}

static double damping_force(const double *u, double elastic, double rate) {
  const double *p = u + UNIFORMS, sign = rate / rate_0 / (1 + fabs(rate / rate_0));
  if (p[DAMPER] == VISCOUS) return u[DASHPOT] * rate;
  if (p[DAMPER] == FRICTION) return p[ZETA] * fabs(elastic) * sign;
  if (p[DAMPER] == CONSTANT) return p[ZETA] * u[EA] * sign;
  return 0;
}

static double damping_slope(const double *u, double elastic, double rate) {
  const double *p = u + UNIFORMS, rise = 1 + fabs(rate / rate_0);
  if (p[DAMPER] == VISCOUS) return u[DASHPOT];
  if (p[DAMPER] == FRICTION) return p[ZETA] * fabs(elastic) / rate_0 / (rise * rise);
  if (p[DAMPER] == CONSTANT) return p[ZETA] * u[EA] / rate_0 / (rise * rise);
  return 0;
}

static void states(const pl_law *law, const double *u, const pl_states *s) {
  (void)law;
  for (long k = 0; k < s->count; k++) {
    const double elastic = u[EA] * s->in[0][k], bend = 2 * u[EI] / u[S];
    s->out[0][k] = elastic + damping_force(u, elastic, s->in[1][k]);
    s->out[1][k] = bend * (2 * s->in[2][k] + s->in[3][k]);
    s->out[2][k] = bend * (2 * s->in[3][k] + s->in[2][k]);
    s->new_field[0][k] = fmax(s->field[0][k], s->in[0][k] > u[UNIFORMS + DAMAGE_AT] ? 0.5 : 0);
  }
}

static void tangent(const pl_law *law, const double *u, const pl_states *s) {
  (void)law;
  for (long k = 0; k < s->count; k++) {
    const double bend = 2 * u[EI] / u[S];
    const double t[12] = {u[EA],    damping_slope(u, u[EA] * s->in[0][k], s->in[1][k]),
                          0,        0,
                          0,        0,
                          2 * bend, bend,
                          0,        0,
                          bend,     2 * bend};
    for (int c = 0; c < 12; c++)
      s->out[c][k] = t[c];
  }
}

static const pl_field fields[] = {{"omega", "1", "", 0, PL_FIELD_DAMAGE, PL_ON_BOND}};

static const pl_law micropolar = {.abi = PL_KERNEL_ABI,
                                  .size = sizeof(pl_law),
                                  .kind = PL_MICROPOLAR,
                                  .dimensions = 2,
                                  .dof = 3,
                                  .force_planes = 4,
                                  .name = "linear_micropolar",
                                  .parameter_count = PARAMETERS,
                                  .density = -1,
                                  .field_count = 1,
                                  .fields = fields,
                                  .uniform_count = UNIFORMS + PARAMETERS,
                                  .prepare = prepare,
                                  .states = states,
                                  .tangent = tangent};

/* --- the lattice ------------------------------------------------------------------------------ */

static const double modulus = 30e9, density = 2323, spacing = 6.35e-3, thickness = 0.1524;
static const double poisson[] = {0, 0.1, 0.2, 1.0 / 3};

static double pi(void) {
  return acos(-1);
}
static double bar_speed(void) {
  return sqrt(modulus / density);
}

static rows *lattice(double rotation) {
  deck_lattice l = {.name = "concrete",
                    .kind = "hexagonal",
                    .spacing = spacing,
                    .rotation = rotation,
                    .thickness = thickness,
                    .stiffness_thickness = thickness,
                    .mass_thickness = thickness};
  deck_body body = {.lattice = "concrete",
                    .shape = {.kind = SHAPE_RECTANGLE, .size = {10 * spacing, 10 * spacing}}};
  const deck k = {.lattices = &l, .lattice_count = 1, .bodys = &body, .body_count = 1};
  source_set sources = {NULL, 0};
  diagnostics d;
  diag_begin(&d, &sources);
  rows *w = lattice_build(&k, 0, &d);
  assert_non_null(w);
  diag_clear(&d);
  w->mass = density * w->volume;
  w->inertia = 0.4 * w->mass * spacing * spacing / 4;
  return w;
}

typedef struct material {
  double values[PARAMETERS];
} material;

static material elastic(double nu) {
  return (material){{[E_] = modulus, [NU] = nu, [DAMAGE_AT] = 1e-4}};
}

static step_limit limit_of(const pl_law *law, const material *m, double rotation) {
  rows *w = lattice(rotation);
  step_limit out = {0};
  stability_limit(law, m->values, NULL, w, &out);
  rows_free(w);
  return out;
}

static double rotation_mode(double nu) { /* omega s/c of all particles turning alike */
  return sqrt(20 * (1 - 3 * nu) / (1 - nu * nu));
}

static double closed_form(double nu) {
  return fmax(rotation_mode(nu), 2 * sqrt(2 / (1 - nu)));
}

/* --- theory ----------------------------------------------------------------------------------- */

static void published_frequencies(void **unused) {
  (void)unused;
  static const double expected[] = {4.472, 3.761, 2.887, 2.449};
  for (int k = 0; k < 4; k++) {
    const material m = elastic(poisson[k]);
    const step_limit l = limit_of(&micropolar, &m, 0);
    const double omega = l.omega_max * spacing / bar_speed();
    print_message("nu %.4f: omega s/c %.12f, %s; closed form %.6f; limit %.4e s\n", poisson[k],
                  omega, l.mode, closed_form(poisson[k]), l.limit);
    assert_true(fabs(omega - expected[k]) < 5e-4);
    assert_true(l.limit == stability_rounded(2 / l.omega_max));
    assert_true(l.damping_ratio == 0);
  }
}

/* Rotations alone rule while their frequency is the larger; the closed form bounds every case from
 * above. */
static void closed_form_bounds(void **unused) {
  (void)unused;
  for (int k = 0; k <= 60; k++) {
    const double nu = k / 180.0;
    const material m = elastic(nu);
    const step_limit l = limit_of(&micropolar, &m, 0);
    const double omega = l.omega_max * spacing / bar_speed();
    assert_true(omega <= closed_form(nu) * (1 + 1e-12));
    assert_true(omega >= rotation_mode(nu) * (1 - 1e-12));
    if (nu < 0.17) {
      assert_true(fabs(omega / rotation_mode(nu) - 1) < 1e-12);
      assert_string_equal(l.mode, "rotation");
    }
  }
  const material central = elastic(1.0 / 3);
  const step_limit l = limit_of(&micropolar, &central, 0);
  assert_true(fabs(l.omega_max * spacing / bar_speed() / sqrt(6) - 1) < 1e-12);
  assert_string_equal(l.mode, "translation");
}

static void turning_the_lattice_changes_nothing(void **unused) {
  (void)unused;
  static const double angles[] = {17, 23.7, 90, 200};
  for (int k = 0; k < 4; k++) {
    material m = elastic(0.22);
    const double plain = limit_of(&micropolar, &m, 0).omega_max;
    const double turned = limit_of(&micropolar, &m, angles[k] * pi() / 180).omega_max;
    assert_true(fabs(turned / plain - 1) < 1e-11);
  }
}

/* nu = 1/3 has no bending: the fastest long wave is longitudinal, sqrt(E/(rho (1 - nu^2))), in
 * every direction. */
static void long_waves_travel_at_the_speed_of_sound(void **unused) {
  (void)unused;
  const double nu = 1.0 / 3, speed = bar_speed() / sqrt(1 - nu * nu), k = 1e-3 / spacing;
  const material m = elastic(nu);
  pl_law central = micropolar;
  central.kind = PL_CENTRAL;
  central.dof = 2;
  central.force_planes = 2;
  rows *w = lattice(0.3);
  for (int n = 0; n < 12; n++) {
    const double a = n * pi() / 6 + 0.1;
    const double with = stability_omega(&micropolar, m.values, w, k * cos(a), k * sin(a));
    const double without = stability_omega(&central, m.values, w, k * cos(a), k * sin(a));
    assert_true(fabs(with / (speed * k) - 1) < 1e-6);
    assert_true(fabs(without / (speed * k) - 1) < 1e-6);
  }
  const double still = stability_omega(&micropolar, elastic(0.1).values, w, 0, 0);
  assert_true(fabs(still * spacing / bar_speed() / rotation_mode(0.1) - 1) < 1e-13);
  rows_free(w);
  assert_true(fabs(limit_of(&central, &m, 0).omega_max * spacing / bar_speed() / sqrt(6) - 1) <
              1e-12);
}

/* --- a lattice that moves --------------------------------------------------------------------- */

enum { SIDE = 6, PARTICLES = SIDE * SIDE }; /* periodic; carries the waves of G, K and M */

typedef struct patch {
  double u[PARTICLES][3], v[PARTICLES][3], force[PARTICLES][3];
  double mass[3], uniforms[UNIFORMS + PARAMETERS];
} patch;

static uint64_t state;

static double uniform(double low, double high) {
  state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return low + (high - low) * (double)(state >> 11) / 9007199254740992.0;
}

/* Finite rotations, force and moments as they act: nothing of this is shared with the analysis of
 * waves. */
static void act(patch *p, int i, int j, const double chord[2]) {
  const double du[2] = {p->u[j][0] - p->u[i][0], p->u[j][1] - p->u[i][1]};
  const double x = chord[0] + du[0], y = chord[1] + du[1], length = hypot(x, y), s = spacing;
  const double turn = atan2(chord[0] * du[1] - chord[1] * du[0], chord[0] * x + chord[1] * y);
  const double e[2] = {x / length, y / length};
  const double longer = 2 * (chord[0] * du[0] + chord[1] * du[1]) + du[0] * du[0] + du[1] * du[1];
  const double rate = (e[0] * (p->v[j][0] - p->v[i][0]) + e[1] * (p->v[j][1] - p->v[i][1])) / s;
  const double elastic_force = p->uniforms[EA] * longer / (s * (length + s));
  const double n = elastic_force + damping_force(p->uniforms, elastic_force, rate);
  const double ti = p->u[i][2] - turn, tj = p->u[j][2] - turn, bend = 2 * p->uniforms[EI] / s;
  const double mi = bend * (2 * ti + tj), mj = bend * (2 * tj + ti), shear = (mi + mj) / length;
  const double f[2] = {n * e[0] + shear * e[1], n * e[1] - shear * e[0]};
  for (int c = 0; c < 2; c++) {
    p->force[i][c] += f[c];
    p->force[j][c] -= f[c];
  }
  p->force[i][2] -= mi;
  p->force[j][2] -= mj;
}

static void forces(patch *p) {
  const double h = spacing * sqrt(3) / 2;
  const double chords[3][2] = {{spacing, 0}, {spacing / 2, h}, {-spacing / 2, h}};
  static const int steps[3][2] = {{1, 0}, {0, 1}, {SIDE - 1, 1}};
  memset(p->force, 0, sizeof p->force);
  for (int i = 0; i < PARTICLES; i++) {
    for (int k = 0; k < 3; k++) {
      const int column = (i % SIDE + steps[k][0]) % SIDE, row = (i / SIDE + steps[k][1]) % SIDE;
      act(p, i, row * SIDE + column, chords[k]);
    }
  }
}

/* Growth of the largest velocity (rotations times s) after so many steps, or as soon as it passes
 * 1e6. */
static double growth(const material *m, double dt, int steps) {
  static const double quiet = 1e-7; /* m/s: the response stays linear up to 1e6 times this */
  patch *p = test_calloc(1, sizeof *p);
  const double volume = sqrt(3) / 2 * spacing * spacing * thickness;
  const double mass = density * volume, inertia = 0.4 * mass * spacing * spacing / 4;
  const pl_bond_class b = {
      .size = sizeof(pl_bond_class), .s = spacing, .t = thickness, .mass_i = mass, .mass_j = mass};
  double largest = 0;
  prepare(&micropolar, m->values, &b, p->uniforms);
  for (int i = 0; i < PARTICLES; i++)
    for (int c = 0; c < 3; c++)
      p->v[i][c] = uniform(-quiet, quiet) / (c == 2 ? spacing : 1);
  for (int step = 0; step < steps && largest < 1e6 * quiet; step++) {
    forces(p);
    largest = 0;
    for (int i = 0; i < PARTICLES; i++) {
      for (int c = 0; c < 3; c++) {
        p->v[i][c] += dt * p->force[i][c] / (c == 2 ? inertia : mass);
        p->u[i][c] += dt * p->v[i][c];
        largest = fmax(largest, fabs(p->v[i][c]) * (c == 2 ? spacing : 1));
      }
    }
  }
  test_free(p);
  return largest / quiet;
}

static void check_limit(const material *m, const step_limit *l) {
  state = 11;
  const double below = growth(m, 0.999 * l->limit, 30000),
               above = growth(m, 1.001 * l->limit, 30000);
  print_message("  velocities grow by %.3g at 0.999 of the limit, by %.3g at 1.001\n", below,
                above);
  assert_true(below < 100);
  assert_true(above > 1e5);
}

static void lattices_bear_the_limit_and_no_more(void **unused) {
  (void)unused;
  for (int k = 0; k < 4; k++) {
    const material m = elastic(poisson[k]);
    const step_limit l = limit_of(&micropolar, &m, 0);
    print_message("nu %.4f: limit %.6e s\n", poisson[k], l.limit);
    check_limit(&m, &l);
  }
}

/* --- damping ---------------------------------------------------------------------------------- */

/* N += 2 zeta m omega_n dL/dt with omega_n of the closed form (Gerstle et al. 2013, eq 18). */
static material damped(double nu, int damper, double zeta) {
  material m = elastic(nu);
  m.values[ZETA] = zeta;
  m.values[DAMPER] = damper;
  m.values[OMEGA_N] = closed_form(nu) * bar_speed() / spacing;
  return m;
}

static void dashpots_shorten_the_step(void **unused) {
  (void)unused;
  static const double zetas[] = {0.01, 0.1, 0.5};
  for (int k = 0; k < 4; k++) {
    for (int z = 0; z < 3; z++) {
      const material m = damped(poisson[k], VISCOUS, zetas[z]);
      const step_limit l = limit_of(&micropolar, &m, 0);
      const double part = l.limit * l.omega_max / 2;
      print_message("nu %.4f, zeta %.2f: limit %.4f of the undamped, xi %.4f = %.2f zeta, %s\n",
                    poisson[k], zetas[z], part, l.damping_ratio, l.damping_ratio / zetas[z],
                    l.mode);
      assert_true(part < 1 + 1e-12);
      check_limit(&m, &l);
    }
  }
}

/* nu = 1/3: dampers are to speeds what the bonds are to displacements, C = (2 zeta m omega_n s/EA)
   K, so that every mode has xi = zeta omega_n omega m s/EA; the fastest one, omega = sqrt(6 EA/(m
   s)), rules. */
static void modal_ratio_of_proportional_damping(void **unused) {
  (void)unused;
  const double nu = 1.0 / 3, zeta = 0.07;
  const material m = damped(nu, VISCOUS, zeta);
  const step_limit l = limit_of(&micropolar, &m, 0);
  const double mass = density * sqrt(3) / 2 * spacing * spacing * thickness;
  const double bond = axial_rigidity(modulus, nu, spacing, thickness) / spacing;
  const double xi = zeta * m.values[OMEGA_N] * sqrt(6 * bond / mass) * mass / bond;
  assert_true(fabs(l.damping_ratio / xi - 1) < 1e-9);
  const double limit = 2 / l.omega_max * (sqrt(1 + xi * xi) - xi);
  assert_true(fabs(l.limit / limit - 1) < 1e-9);
}

static void friction_is_exempt(void **unused) {
  (void)unused;
  const material m = damped(0.2, FRICTION, 0.05), plain = elastic(0.2);
  const step_limit l = limit_of(&micropolar, &m, 0), undamped = limit_of(&micropolar, &plain, 0);
  assert_true(l.limit == undamped.limit && l.damping_ratio == 0);
}

/* Bounded, but not by the elastic force: its slope at rest, zeta EA/rate_0, counts like that of a
 * dashpot. */
static void constant_damper_counts(void **unused) {
  (void)unused;
  const material m = damped(0.2, CONSTANT, 0.05);
  material dashpot = damped(0.2, VISCOUS, 1);
  const double mass = density * sqrt(3) / 2 * spacing * spacing * thickness;
  const double slope = 0.05 * axial_rigidity(modulus, 0.2, spacing, thickness) / rate_0;
  dashpot.values[OMEGA_N] = slope / (2 * mass * spacing);
  const step_limit l = limit_of(&micropolar, &m, 0), same = limit_of(&micropolar, &dashpot, 0);
  assert_true(fabs(l.limit / same.limit - 1) < 1e-12);
  assert_true(l.limit < 0.5 * 2 / l.omega_max);
}

/* --- laws that are not what they should be ---------------------------------------------------- */

static void odd_laws_do_no_harm(void **unused) {
  (void)unused;
  material m = elastic(0.2);
  m.values[E_] = 0;
  step_limit l = limit_of(&micropolar, &m, 0);
  assert_true(isinf(l.limit) && l.omega_max == 0);
  m.values[E_] = NAN;
  l = limit_of(&micropolar, &m, 0);
  assert_true(l.limit == 0);
}

/* Standing translations of a central law have neither stiffness nor damping, and no ratio of the
   two; the fastest wave rules all the same, with the frequency and the ratio of the closed form. */
static void modes_without_stiffness_do_not_rule(void **unused) {
  (void)unused;
  const double nu = 1.0 / 3, zeta = 0.2;
  pl_law central = micropolar;
  central.kind = PL_CENTRAL;
  central.dof = 2;
  const material m = damped(nu, VISCOUS, zeta);
  const step_limit l = limit_of(&central, &m, 0);
  const double mass = density * sqrt(3) / 2 * spacing * spacing * thickness;
  const double bond = axial_rigidity(modulus, nu, spacing, thickness) / spacing;
  const double omega = sqrt(6 * bond / mass), xi = zeta * m.values[OMEGA_N] * omega * mass / bond;
  assert_true(fabs(l.omega_max / omega - 1) < 1e-9);
  assert_true(fabs(l.damping_ratio / xi - 1) < 1e-9);
  assert_true(fabs(l.limit / (2 / omega * (sqrt(1 + xi * xi) - xi)) - 1) < 1e-9);
  assert_string_equal(l.mode, "translation");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(published_frequencies),
      cmocka_unit_test(closed_form_bounds),
      cmocka_unit_test(turning_the_lattice_changes_nothing),
      cmocka_unit_test(long_waves_travel_at_the_speed_of_sound),
      cmocka_unit_test(lattices_bear_the_limit_and_no_more),
      cmocka_unit_test(dashpots_shorten_the_step),
      cmocka_unit_test(modal_ratio_of_proportional_damping),
      cmocka_unit_test(friction_is_exempt),
      cmocka_unit_test(constant_damper_counts),
      cmocka_unit_test(odd_laws_do_no_harm),
      cmocka_unit_test(modes_without_stiffness_do_not_rule),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
