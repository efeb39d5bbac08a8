/* The co-rotational bond against its definition in extended precision, and its forces against
   virtual work. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>

#include "dsl/semantics/builtins.h"
#include "generator/ir/interpret.h"
#include "generator/lower/kinematics.h"

#define PI 3.14159265358979323846264338327950288L

enum {
  VALUE_STRETCH,
  VALUE_RATE,
  VALUE_THETA_I,
  VALUE_THETA_J,
  VALUE_LENGTH,
  VALUE_E_X,
  VALUE_E_Y,
  VALUE_THETA_RATE_I,
  VALUE_THETA_RATE_J,
  VALUE_F_X,
  VALUE_F_Y,
  VALUE_MOMENT_I,
  VALUE_MOMENT_J,
  VALUE_COUNT
};

typedef struct bond_state {
  double u[2][2], phi[2], v[2][2], omega[2], chord[2];
  double N, M_i, M_j;
} bond_state;

/* --- random numbers --------------------------------------------------------------------------- */

static uint64_t seed = 88172645463325252u;

static double uniform(double low, double high) {
  seed ^= seed << 13;
  seed ^= seed >> 7;
  seed ^= seed << 17;
  return low + (high - low) * (double)(seed >> 11) * 0x1p-53;
}

/* Of either sign, with a size spread evenly over the decades. */
static double spread(double low, double high) {
  double size = exp(uniform(log(low), log(high)));
  return uniform(-1, 1) < 0 ? -size : size;
}

/* Ends displaced by up to `most` times the bond's length. */
static bond_state random_state(double most) {
  bond_state b;
  double angle = uniform(-3, 3), s = spread(1e-3, 1e-1);
  b.chord[0] = fabs(s) * cos(angle);
  b.chord[1] = fabs(s) * sin(angle);
  for (int end = 0; end < 2; end++) {
    for (int k = 0; k < 2; k++) {
      b.u[end][k] = s * spread(1e-12, most);
      b.v[end][k] = spread(1e-6, 10);
    }
    b.phi[end] = spread(1e-9, 1);
    b.omega[end] = spread(1e-3, 1e3);
  }
  b.N = spread(1, 1e6);
  b.M_i = spread(1e-3, 1e3);
  b.M_j = spread(1e-3, 1e3);
  return b;
}

/* --- evaluation on the interpreter ------------------------------------------------------------ */

/* N, M_i, M_j enter the graph as fields 0, 1, 2. */
static void evaluate(const bond_state *b, double *value) {
  ir *g = ir_new();
  bond_kinematics k = kinematics_bond(g, true, false);
  ir_node N = ir_input(g, IR_FROM_FIELD, 0, "N", ON_BOND);
  ir_node M_i = ir_input(g, IR_FROM_FIELD, 1, "M_i", ON_BOND);
  ir_node M_j = ir_input(g, IR_FROM_FIELD, 2, "M_j", ON_BOND);
  bond_forces f = kinematics_forces(g, &k, N, M_i, M_j);
  ir_node roots[VALUE_COUNT] = {k.stretch, k.stretch_rate, k.theta_i,      k.theta_j,      k.length,
                                k.e_x,     k.e_y,          k.theta_rate_i, k.theta_rate_j, f.f_x,
                                f.f_y,     f.moment_i,     f.moment_j};
  const double *ends[ENDS_COUNT] = {
      [ENDS_U_IX] = &b->u[0][0],           [ENDS_U_IY] = &b->u[0][1],
      [ENDS_PHI_I] = &b->phi[0],           [ENDS_U_JX] = &b->u[1][0],
      [ENDS_U_JY] = &b->u[1][1],           [ENDS_PHI_J] = &b->phi[1],
      [ENDS_V_IX] = &b->v[0][0],           [ENDS_V_IY] = &b->v[0][1],
      [ENDS_OMEGA_I] = &b->omega[0],       [ENDS_V_JX] = &b->v[1][0],
      [ENDS_V_JY] = &b->v[1][1],           [ENDS_OMEGA_J] = &b->omega[1],
      [ENDS_CLASS_CHORD_X] = &b->chord[0], [ENDS_CLASS_CHORD_Y] = &b->chord[1]};
  double s = sqrt(b->chord[0] * b->chord[0] + b->chord[1] * b->chord[1]);
  const double *quantities[QUANTITY_COUNT] = {[QUANTITY_S] = &s};
  const double *fields[] = {&b->N, &b->M_i, &b->M_j};
  interpreter_inputs in = {
      .values = {[IR_FROM_QUANTITY] = quantities, [IR_FROM_FIELD] = fields, [IR_FROM_ENDS] = ends}};
  double *out[VALUE_COUNT];
  for (int n = 0; n < VALUE_COUNT; n++)
    out[n] = value + n;
  interpreter *p = interpreter_new(g, roots, VALUE_COUNT);
  interpreter_run(p, &in, 1, out);
  interpreter_free(p);
  ir_free(g);
}

/* --- the definition, in extended precision ---------------------------------------------------- */

typedef struct exact_bond {
  long double stretch, theta[2], length, e[2];
} exact_bond;

static long double wrapped(long double angle) {
  return angle - 2 * PI * ceill((angle - PI) / (2 * PI));
}

/* `h`: time since the state, for rates by difference. */
static exact_bond exact(const bond_state *b, long double h) {
  exact_bond x;
  long double C[2] = {b->chord[0], b->chord[1]}, c[2], d[2];
  for (int k = 0; k < 2; k++) {
    d[k] = ((long double)b->u[1][k] + h * b->v[1][k]) - ((long double)b->u[0][k] + h * b->v[0][k]);
    c[k] = C[k] + d[k];
  }
  long double s = sqrtl(C[0] * C[0] + C[1] * C[1]);
  x.length = sqrtl(c[0] * c[0] + c[1] * c[1]);
  /* (L - s)/s would cancel, in extended precision too */
  x.stretch = (d[0] * (C[0] + c[0]) + d[1] * (C[1] + c[1])) / (s * (x.length + s));
  long double phi = atan2l(C[0] * d[1] - C[1] * d[0], C[0] * c[0] + C[1] * c[1]);
  for (int end = 0; end < 2; end++)
    x.theta[end] = wrapped((long double)b->phi[end] + h * b->omega[end] - phi);
  x.e[0] = c[0] / x.length;
  x.e[1] = c[1] / x.length;
  return x;
}

static void assert_near(double value, long double expected, double tolerance) {
  if (!(fabsl((long double)value - expected) <= (long double)tolerance))
    fail_msg("%.17g is not %.17Lg within %g (off by %Lg)", value, expected, tolerance,
             fabsl((long double)value - expected));
}

/* A displacement known to 1 ulp gives a stretch known to d/s times that: nothing may be lost to
   cancellation. */
static void small_displacements_lose_nothing(void **state) {
  (void)state;
  for (int n = 0; n < 20000; n++) {
    bond_state b = random_state(n % 2 ? 1e-3 : 0.4);
    double value[VALUE_COUNT], eps = 0x1p-52;
    evaluate(&b, value);
    exact_bond x = exact(&b, 0);
    double s = hypot(b.chord[0], b.chord[1]);
    double size = (fabs(b.u[0][0]) + fabs(b.u[0][1]) + fabs(b.u[1][0]) + fabs(b.u[1][1])) / s;
    assert_near(value[VALUE_STRETCH], x.stretch, 8 * eps * size);
    assert_near(value[VALUE_LENGTH], x.length, 4 * eps * s * (1 + size));
    assert_near(value[VALUE_E_X], x.e[0], 8 * eps);
    assert_near(value[VALUE_E_Y], x.e[1], 8 * eps);
    double angles = 8 * eps * (size + fabs(b.phi[0]) + fabs(b.phi[1]));
    assert_near(value[VALUE_THETA_I], x.theta[0], angles * 2);
    assert_near(value[VALUE_THETA_J], x.theta[1], angles * 2);
  }
}

/* The bond of a large family: 1/length, stretch, length. */
static void evaluate_near(const bond_state *b, double *value) {
  ir *g = ir_new();
  const family_kinematics k = kinematics_family(g, 2, false, true, false);
  const ir_node roots[] = {k.per_length, k.stretch, k.length};
  const double *ends[ENDS_COUNT] = {
      [ENDS_U_IX] = &b->u[0][0],           [ENDS_U_IY] = &b->u[0][1],
      [ENDS_U_JX] = &b->u[1][0],           [ENDS_U_JY] = &b->u[1][1],
      [ENDS_CLASS_CHORD_X] = &b->chord[0], [ENDS_CLASS_CHORD_Y] = &b->chord[1]};
  const double s = sqrt(b->chord[0] * b->chord[0] + b->chord[1] * b->chord[1]);
  const double *quantities[QUANTITY_COUNT] = {[QUANTITY_S] = &s};
  const interpreter_inputs in = {
      .values = {[IR_FROM_QUANTITY] = quantities, [IR_FROM_ENDS] = ends}};
  double *out[] = {value, value + 1, value + 2};
  interpreter *p = interpreter_new(g, roots, 3);
  interpreter_run(p, &in, 1, out);
  interpreter_free(p);
  ir_free(g);
}

/* On both sides of where the series ends, and with chords that turn: as good as displacements are.
   */
static void bonds_of_large_families_lose_nothing(void **state) {
  (void)state;
  int near = 0, far = 0;
  for (int n = 0; n < 4000; n++) {
    bond_state b = random_state(n % 2 ? 0.3 : 1e-2);
    if (n % 3 == 0) { /* turned, and stretched by up to a hundredth */
      const double turn = uniform(-3, 3), longer = 1 + uniform(-0.01, 0.01);
      b.u[1][0] =
          b.u[0][0] + longer * (cos(turn) * b.chord[0] - sin(turn) * b.chord[1]) - b.chord[0];
      b.u[1][1] =
          b.u[0][1] + longer * (sin(turn) * b.chord[0] + cos(turn) * b.chord[1]) - b.chord[1];
    }
    const exact_bond x = exact(&b, 0);
    const double s = hypot(b.chord[0], b.chord[1]);
    const double moved = hypot(b.u[1][0] - b.u[0][0], b.u[1][1] - b.u[0][1]) / s;
    double value[3];
    evaluate_near(&b, value);
    *(fabsl(x.stretch) < 1.0 / 256 ? &near : &far) += 1;
    assert_near(value[0] * s, s / x.length, 1e-15 * (1 + 4 * moved));
    assert_near(value[1], x.stretch, 1e-15 * (1 + 4 * moved) * moved);
    assert_near(value[2] / s, x.length / s, 1e-15 * (1 + 4 * moved));
  }
  assert_true(near > 1000 && far > 1000);
}

/* Nearly closed: 1/length has all its digits as long as the chord has any. */
static void closing_bonds_keep_their_direction(void **state) {
  (void)state;
  for (double left = 0x1p-2; left >= 0x1p-48; left /= 2) {
    bond_state b = {.chord = {0.5, 0.25}};
    b.u[1][0] = (left - 1) * b.chord[0];
    b.u[1][1] = (left - 1) * b.chord[1];
    const double length = left * hypot(0.5, 0.25);
    double value[3];
    evaluate_near(&b, value);
    assert_near(value[0] * length, 1, 8 * 0x1p-52);
    assert_near(value[1], left - 1, 8 * 0x1p-52);
    assert_near(value[2] / length, 1, 8 * 0x1p-52);
  }
}

/* Both sides of what is expected of rotations are as exact, also where one meets the other: a chord
   turned by about atan(1/16), ends by about half a turn. */
static void expected_and_far_rotations_meet(void **state) {
  (void)state;
  int near = 0, wrapped_ends = 0;
  for (int n = 0; n < 20000; n++) {
    bond_state b = random_state(1e-6);
    double value[VALUE_COUNT], turn = atan(1.0 / 16) * (1 + spread(1e-9, 1e-1));
    if (n % 2) turn = -turn;
    b.u[1][0] = b.u[0][0] + cos(turn) * b.chord[0] - sin(turn) * b.chord[1] - b.chord[0];
    b.u[1][1] = b.u[0][1] + sin(turn) * b.chord[0] + cos(turn) * b.chord[1] - b.chord[1];
    b.phi[0] = turn + (double)PI * (1 + spread(1e-9, 1e-1));
    b.phi[1] = turn + spread(1e-9, 1);
    evaluate(&b, value);
    exact_bond x = exact(&b, 0);
    assert_near(value[VALUE_THETA_I], x.theta[0], 8 * 0x1p-52 * (double)PI);
    assert_near(value[VALUE_THETA_J], x.theta[1], 8 * 0x1p-52);
    near += fabs(turn) < atan(1.0 / 16);
    wrapped_ends += value[VALUE_THETA_I] < 0;
  }
  assert_true(near > 5000 && near < 15000 && wrapped_ends > 5000 && wrapped_ends < 15000);
}

static void rates_are_time_derivatives(void **state) {
  (void)state;
  for (int n = 0; n < 2000; n++) {
    bond_state b = random_state(0.3);
    double value[VALUE_COUNT];
    evaluate(&b, value);
    double s = hypot(b.chord[0], b.chord[1]);
    double speed = (fabs(b.v[0][0]) + fabs(b.v[0][1]) + fabs(b.v[1][0]) + fabs(b.v[1][1])) / s;
    long double h = 1e-6L / (speed + 1);
    exact_bond before = exact(&b, -h), after = exact(&b, h);
    double scale = speed + fabs(b.omega[0]) + fabs(b.omega[1]);
    assert_near(value[VALUE_RATE], (after.stretch - before.stretch) / (2 * h), 1e-9 * scale);
    for (int end = 0; end < 2; end++)
      assert_near(value[VALUE_THETA_RATE_I + end],
                  wrapped(after.theta[end] - before.theta[end]) / (2 * h), 1e-9 * scale);
  }
}

/* Turned as a rigid body, by many turns: no stretch, no end rotation. */
static void rigid_rotation_gives_nothing(void **state) {
  (void)state;
  for (int n = 0; n < 2000; n++) {
    bond_state b = random_state(1e-9);
    double turn = n == 0 ? 14.0 : uniform(-100, 100), value[VALUE_COUNT];
    double at[2] = {uniform(-0.02, 0.02), uniform(-0.02, 0.02)};
    for (int end = 0; end < 2; end++) {
      double x = at[0] + end * b.chord[0], y = at[1] + end * b.chord[1];
      b.u[end][0] = x * cos(turn) - y * sin(turn) - x;
      b.u[end][1] = x * sin(turn) + y * cos(turn) - y;
      b.phi[end] = turn;
    }
    evaluate(&b, value);
    double s = hypot(b.chord[0], b.chord[1]);
    double rounding = 0x1p-52 * (20 + 0.3 / s + fabs(turn));
    assert_near(value[VALUE_STRETCH], 0, rounding);
    assert_near(value[VALUE_THETA_I], 0, rounding);
    assert_near(value[VALUE_THETA_J], 0, rounding);
  }
}

static void exchanging_the_ends_changes_no_bit(void **state) {
  (void)state;
  for (int n = 0; n < 5000; n++) {
    bond_state b = random_state(0.4), back = b;
    double one[VALUE_COUNT], other[VALUE_COUNT];
    for (int k = 0; k < 2; k++) {
      back.chord[k] = -b.chord[k];
      for (int end = 0; end < 2; end++) {
        back.u[end][k] = b.u[1 - end][k];
        back.v[end][k] = b.v[1 - end][k];
      }
      back.phi[k] = b.phi[1 - k];
    }
    back.M_i = b.M_j;
    back.M_j = b.M_i;
    evaluate(&b, one);
    evaluate(&back, other);
    assert_true(one[VALUE_STRETCH] == other[VALUE_STRETCH]);
    assert_true(one[VALUE_RATE] == other[VALUE_RATE]);
    assert_true(one[VALUE_THETA_I] == other[VALUE_THETA_J]);
    assert_true(one[VALUE_THETA_J] == other[VALUE_THETA_I]);
    assert_true(one[VALUE_F_X] == -other[VALUE_F_X]);
    assert_true(one[VALUE_F_Y] == -other[VALUE_F_Y]);
    assert_true(one[VALUE_MOMENT_I] == other[VALUE_MOMENT_J]);
  }
}

/* What the particles receive does no work in a rigid motion, and in any other minus that of N, M_i,
   M_j. */
static void forces_do_the_work_of_the_law(void **state) {
  (void)state;
  for (int n = 0; n < 2000; n++) {
    bond_state b = random_state(0.4);
    double value[VALUE_COUNT];
    evaluate(&b, value);
    double s = hypot(b.chord[0], b.chord[1]);
    long double power = (long double)value[VALUE_F_X] * (b.v[0][0] - b.v[1][0]) +
                        (long double)value[VALUE_F_Y] * (b.v[0][1] - b.v[1][1]) -
                        (long double)value[VALUE_MOMENT_I] * b.omega[0] -
                        (long double)value[VALUE_MOMENT_J] * b.omega[1];
    long double inner = (long double)b.N * value[VALUE_RATE] * s +
                        (long double)b.M_i * value[VALUE_THETA_RATE_I] +
                        (long double)b.M_j * value[VALUE_THETA_RATE_J];
    double speed = fabs(b.v[0][0]) + fabs(b.v[0][1]) + fabs(b.v[1][0]) + fabs(b.v[1][1]);
    double moments = fabs(b.M_i) + fabs(b.M_j), turning = fabs(b.omega[0]) + fabs(b.omega[1]);
    double scale = (fabs(b.N) + moments / value[VALUE_LENGTH]) * speed + moments * turning;
    assert_near((double)(power + inner), 0, 1e-14 * scale);
    /* moments about end i: both end moments and the force on j */
    double cx = value[VALUE_LENGTH] * value[VALUE_E_X], cy = value[VALUE_LENGTH] * value[VALUE_E_Y];
    double about_i = cy * value[VALUE_F_X] - cx * value[VALUE_F_Y] - value[VALUE_MOMENT_I] -
                     value[VALUE_MOMENT_J];
    assert_near(about_i, 0, 1e-14 * (moments + fabs(b.N) * s));
  }
}

static void divides_nothing(void **state) {
  (void)state;
  ir *g = ir_new();
  bond_kinematics k = kinematics_bond(g, true, false);
  ir_node N = ir_input(g, IR_FROM_FIELD, 0, "N", ON_BOND);
  bond_forces f = kinematics_forces(g, &k, N, N, N);
  ir_node roots[] = {k.stretch, k.stretch_rate, k.theta_i, k.theta_j, f.f_x, f.f_y};
  ir_cost cost = ir_count_cost(g, roots, 6, ON_PARTICLE, NULL);
  assert_int_equal(cost.divisions, 0); /* atan2 brings its own, where a chord turned far */
  assert_int_equal(cost.functions, 4); /* 1/L, atan2 and two wraps */
  ir_free(g);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(small_displacements_lose_nothing),
      cmocka_unit_test(bonds_of_large_families_lose_nothing),
      cmocka_unit_test(closing_bonds_keep_their_direction),
      cmocka_unit_test(expected_and_far_rotations_meet),
      cmocka_unit_test(rates_are_time_derivatives),
      cmocka_unit_test(rigid_rotation_gives_nothing),
      cmocka_unit_test(exchanging_the_ends_changes_no_bit),
      cmocka_unit_test(forces_do_the_work_of_the_law),
      cmocka_unit_test(divides_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
