/* Waves in lattices of springs and dashpots against closed forms: the fastest wave, its step, and the speed of sound. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "runtime/analysis/step_limit.h"
#include "runtime/analysis/waves.h"
#include "tests/runtime/built_rows.h"

static const double stiffness = 5e6, spacing = 0.01; /* N/m, m */

#define PLANE(kind)                                                                                \
  "&simulation end_time = 1 /\n&lattice name = 'c' kind = '" kind                                  \
  "' spacing = 0.01 thickness = 0.1 rotation = 11 /\n&material lattice = 'c' model = 'm' /\n"      \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.05, 0.05 /\n"
#define SPACE(kind)                                                                                \
  "&simulation end_time = 1 /\n&lattice name = 'c' kind = '" kind                                  \
  "' spacing = 0.01 /\n&material lattice = 'c' model = 'm' /\n"                                    \
  "&body lattice = 'c' shape = 'box' corner = 0, 0, 0 size = 0.03, 0.03, 0.03 /\n"

/* Springs between nearest neighbours (N/m), and dashpots beside them (N s/m). */
static crystal springs(const rows *w, double k, double damping) {
  crystal c = crystal_new(w, w->dimensions, w->directions);
  c.damped = damping > 0;
  for (int n = 0; n < w->directions; n++) {
    wave_term *t = &c.terms[n];
    memcpy(t->R, w->chord[n], sizeof t->R);
    for (int p = 0; p < w->dimensions; p++)
      for (int q = 0; q < w->dimensions; q++) {
        const double part = w->chord[n][p] * w->chord[n][q] / (w->length[n] * w->length[n]);
        t->stiffness.self[p][q] = 2 * k * part;
        t->stiffness.forward[p][q] = t->stiffness.backward[p][q] = -k * part;
        t->damping.self[p][q] = 2 * damping * part;
        t->damping.forward[p][q] = t->damping.backward[p][q] = -damping * part;
      }
  }
  return c;
}

static const struct lattice_case {
  const char *deck;
  double square; /* m omega_max^2/k */
  double cell;   /* of one particle, in spacings */
} cases[] = {{PLANE("square"), 4, 1},
             {PLANE("hexagonal"), 6, 0.8660254037844386},
             {SPACE("cubic"), 4, 1},
             {SPACE("fcc"), 8, 0.7071067811865476}};
enum { CASES = sizeof cases / sizeof *cases };

static void the_fastest_wave_rules_the_step(void **state) {
  (void)state;
  for (int n = 0; n < CASES; n++) {
    built_rows b;
    step_limit l = {0};
    build_rows(&b, cases[n].deck);
    rows_set_density(b.rows, 2000);
    crystal c = springs(b.rows, stiffness, 0);
    const double omega = sqrt(cases[n].square * stiffness / b.rows->mass);
    waves_limit(&c, &l);
    assert_true(fabs(l.omega_max / omega - 1) < 1e-9);
    assert_true(fabs(l.limit * omega / 2 - 1) < 1e-9);
    assert_true(l.damping_ratio == 0);
    assert_string_equal(l.mode, "translation");
    crystal_free(&c);
    built_end(&b);
  }
}

/* Dashpots in proportion to the springs: xi = c omega/(2 k) of each wave; the fastest is the worst. */
static void dashpots_shorten_the_step(void **state) {
  (void)state;
  for (int n = 0; n < CASES; n++) {
    built_rows b;
    step_limit l = {0};
    build_rows(&b, cases[n].deck);
    rows_set_density(b.rows, 2000);
    const double omega = sqrt(cases[n].square * stiffness / b.rows->mass), xi = 0.3;
    crystal c = springs(b.rows, stiffness, 2 * xi * stiffness / omega);
    waves_limit(&c, &l);
    assert_true(fabs(l.omega_max / omega - 1) < 1e-9);
    assert_true(fabs(l.damping_ratio / xi - 1) < 1e-6);
    assert_true(fabs(l.limit / (2 / omega * (sqrt(1 + xi * xi) - xi)) - 1) < 1e-9);
    crystal_free(&c);
    built_end(&b);
  }
}

/* Long waves of the hexagonal lattice travel at sqrt(9 k s^2/(8 m)) in every direction, with an error that falls as the
   square of their number; and a wave is the same a reciprocal vector further. */
static void long_waves_travel_at_the_speed_of_sound(void **state) {
  (void)state;
  built_rows b;
  build_rows(&b, cases[1].deck);
  rows_set_density(b.rows, 2000);
  crystal c = springs(b.rows, stiffness, 0);
  const double speed = sqrt(9 * stiffness * spacing * spacing / (8 * b.rows->mass));
  for (int turn = 0; turn < 12; turn++) {
    const double x = cos(0.5 * turn), y = sin(0.5 * turn);
    double error[2];
    for (int fine = 0; fine < 2; fine++) {
      const double k = (fine ? 0.05 : 0.1) / spacing;
      error[fine] = 1 - waves_omega(&c, (double[]){k * x, k * y, 0}) / (speed * k);
    }
    assert_true(error[0] > 0 && error[0] < 1e-3);
    assert_true(fabs(error[0] / error[1] - 4) < 0.02);
    const double k[3] = {70 * x, 90 * y, 0};
    const double next[3] = {k[0] + c.reciprocal[0][0] - 2 * c.reciprocal[1][0],
                            k[1] + c.reciprocal[0][1] - 2 * c.reciprocal[1][1], 0};
    assert_true(fabs(waves_omega(&c, next) / waves_omega(&c, k) - 1) < 1e-11);
  }
  crystal_free(&c);
  built_end(&b);
}

/* The cell that the primitive vectors span is that of one particle, and all chords are whole multiples of them. */
static void primitive_vectors_span_one_particle(void **state) {
  (void)state;
  for (int n = 0; n < CASES; n++) {
    built_rows b;
    double a[3][3];
    build_rows(&b, cases[n].deck);
    lattice_primitive(b.rows, a);
    crystal c = crystal_new(b.rows, b.rows->dimensions, 0);
    const double size = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) +
                        a[0][1] * (a[1][2] * a[2][0] - a[1][0] * a[2][2]) +
                        a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    assert_true(fabs(fabs(size) / pow(spacing, b.rows->dimensions) / cases[n].cell - 1) < 1e-12);
    for (int k = 0; k < b.rows->directions; k++)
      for (int p = 0; p < b.rows->dimensions; p++) {
        double turns = 0;
        for (int d = 0; d < 3; d++)
          turns += b.rows->chord[k][d] * c.reciprocal[p][d] / (2 * acos(-1));
        assert_true(fabs(turns - round(turns)) < 1e-12);
      }
    crystal_free(&c);
    built_end(&b);
  }
}

static void lattices_without_waves_have_no_limit(void **state) {
  (void)state;
  built_rows b;
  step_limit l = {0};
  build_rows(&b, cases[1].deck);
  rows_set_density(b.rows, 2000);
  crystal c = springs(b.rows, 0, 0);
  waves_limit(&c, &l);
  assert_true(isinf(l.limit) && l.omega_max == 0);
  crystal_free(&c);
  c = springs(b.rows, -stiffness, 0); /* negative stiffness counts as none */
  waves_limit(&c, &l);
  assert_true(isinf(l.limit) && l.omega_max == 0);
  c.finite = false;
  waves_limit(&c, &l);
  assert_true(l.limit == 0);
  crystal_free(&c);
  built_end(&b);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_fastest_wave_rules_the_step),
      cmocka_unit_test(dashpots_shorten_the_step),
      cmocka_unit_test(long_waves_travel_at_the_speed_of_sound),
      cmocka_unit_test(primitive_vectors_span_one_particle),
      cmocka_unit_test(lattices_without_waves_have_no_limit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
