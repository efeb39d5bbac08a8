/* Lowering: what each construct of the language computes, against the same formulas in C. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/law_text.h"

#define CENTRAL(rules)                                                                             \
  "model m\n  law central bond\n"                                                                  \
  "  parameter k = 1000 [N] in (0, inf)\n" rules "end model\n"
#define MICROPOLAR(rules)                                                                          \
  "model m\n  law micropolar bond\n"                                                               \
  "  parameter k = 1000 [N] in (0, inf)\n  parameter c = 2 [N*m] in (0, inf)\n" rules              \
  "end model\n"

static void assert_close(double value, double expected) {
  double scale = fabs(expected) > 1e-300 ? fabs(expected) : 1;
  if (!(fabs(value - expected) <= 1e-13 * scale)) fail_msg("%.17g is not %.17g", value, expected);
}

static tested_law *must_open(const char *text) {
  tested_law *t = open_law(text);
  if (!t->plan) {
    diag_print(&t->said, stderr);
    fail_msg("the law was not planned");
  }
  return t;
}

/* N of a central law at a stretch and a rate. */
static double force_of(const tested_law *t, double stretch, double rate) {
  tested_state x = {.stretch = stretch, .rate = rate};
  evaluate_law(t, &x, 0);
  return x.N;
}

static void the_first_true_case_wins(void **state) {
  (void)state;
  tested_law *t =
      must_open(CENTRAL("  force N = | 1 [N]          when stretch > 0.3\n"
                        "            | 2 [N]          when stretch > 0.1\n"
                        "            | k*stretch      when stretch > 0 and not (stretch > 0.05)\n"
                        "            | -k             otherwise\n"));
  assert_close(force_of(t, 0.4, 0), 1);
  assert_close(force_of(t, 0.3, 0), 2);
  assert_close(force_of(t, 0.07, 0), -1000);
  assert_close(force_of(t, 0.04, 0), 40);
  assert_close(force_of(t, -0.04, 0), -1000);
  close_law(t);
}

static void functions_are_expanded(void **state) {
  (void)state;
  tested_law *t = must_open(CENTRAL("  function twice(x) = 2*x\n"
                                    "  function hinge(x, y) = | x when x >= y\n"
                                    "                         | twice(y) - twice(x)/2 otherwise\n"
                                    "  force N = k*hinge(stretch, twice(0.1))\n"));
  assert_close(force_of(t, 0.25, 0), 250);
  assert_close(force_of(t, 0.05, 0), 1000 * (0.4 - 0.05));
  close_law(t);
}

static void built_in_functions_mean_what_they_say(void **state) {
  (void)state;
  tested_law *t =
      must_open(CENTRAL("  a = soft_sign(stretch) + 10*positive_part(stretch) + 100*abs(stretch)\n"
                        "  b = max(stretch, 0.1, -stretch) - min(stretch, 0.1) + sign(stretch)\n"
                        "  d = sqrt(1 + stretch) + stretch**2 + (1 + stretch)**0.7 + exp(stretch)\n"
                        "  force N = k*(a + b + d) + 2 [kN]*tanh(stretch_rate*1 [ms])\n"));
  for (int n = 0; n < 2; n++) {
    double x = n ? -0.3 : 0.7, rate = 450;
    double a = x / (1 + fabs(x)) + 10 * fmax(x, 0) + 100 * fabs(x);
    double b = fmax(fmax(x, 0.1), -x) - fmin(x, 0.1) + (x > 0 ? 1 : -1);
    double d = sqrt(1 + x) + x * x + pow(1 + x, 0.7) + exp(x);
    assert_close(force_of(t, x, rate), 1000 * (a + b + d) + 2000 * tanh(0.45));
  }
  close_law(t);
}

static void damage_grows_and_stays_below_one(void **state) {
  (void)state;
  tested_law *t = must_open(CENTRAL("  damage d = 10*stretch\n  force N = (1 - d)*k*stretch\n"));
  tested_state x = {.stretch = 0.03, .field = {0.1}};
  evaluate_law(t, &x, 0);
  assert_close(x.new_field[0], 0.3);
  assert_close(x.N, 0.7 * 30); /* the force uses the new damage */
  x.stretch = 0.005;
  evaluate_law(t, &x, 0);
  assert_close(x.new_field[0], 0.1);
  x.stretch = 7;
  evaluate_law(t, &x, 0);
  assert_true(x.new_field[0] == 1);
  x.stretch = NAN; /* must be found, not clamped away */
  evaluate_law(t, &x, 0);
  assert_true(isnan(x.new_field[0]));
  close_law(t);
}

static void names_above_a_rule_read_the_last_step(void **state) {
  (void)state;
  tested_law *t = must_open(CENTRAL("  state x on bond = 0.5\n"
                                    "  above = x\n"
                                    "  x = x + stretch\n"
                                    "  below = x\n"
                                    "  force N = k*(above + 10*below + 100*previous(x))\n"));
  assert_close(t->kernel->fields[0].initial, 0.5);
  tested_state s = {.stretch = 0.25, .field = {2}};
  evaluate_law(t, &s, 0);
  assert_close(s.new_field[0], 2.25);
  assert_close(s.N, 1000 * (2 + 22.5 + 200));
  close_law(t);
}

/* A bar that yields at a force k/100, with the overstress taken back by one increment a step. */
static void flow_adds_one_increment(void **state) {
  (void)state;
  tested_law *t = must_open(CENTRAL("  state p = 0\n"
                                    "  trial = k*(stretch - p)\n"
                                    "  f = abs(trial)/(k/100) - 1\n"
                                    "  flow p by (abs(trial) - k/100)/k*sign(trial) when f >= 0\n"
                                    "  force N = k*(stretch - p)\n"));
  tested_state x = {.stretch = 0.013, .field = {0.001}};
  evaluate_law(t, &x, 0);
  assert_close(x.new_field[0], 0.003);
  assert_close(x.N, 10);
  x.stretch = 0.0105;
  evaluate_law(t, &x, 0);
  assert_close(x.new_field[0], 0.001);
  assert_close(x.N, 9.5);
  x.stretch = -0.02;
  evaluate_law(t, &x, 0);
  assert_close(x.new_field[0], -0.01);
  assert_close(x.N, -10);
  close_law(t);
}

static void options_are_decided(void **state) {
  (void)state;
  const char *text = CENTRAL("  option form = linear | square\n"
                             "  force N = | k*stretch    when form == linear and plane_stress\n"
                             "            | k*stretch**2 when form /= linear and not plane_strain\n"
                             "            | 0 otherwise\n");
  tested_law *t = must_open(text);
  assert_close(force_of(t, 0.5, 0), 500);
  close_law(t);
  law_choice choice = {"form", "square"};
  t = open_law_chosen(text, &choice, 1);
  assert_non_null(t->plan);
  assert_close(force_of(t, 0.5, 0), 250);
  close_law(t);
}

static void forces_follow_from_an_energy(void **state) {
  (void)state;
  tested_law *t =
      must_open(MICROPOLAR("  damage d = abs(stretch)\n"
                           "  energy W = (1 - d)*(k*s*stretch**2/2 + c*(theta_i:theta_i + "
                           "theta_i:theta_j + theta_j:theta_j))\n"));
  tested_state x = {.stretch = 0.2, .theta_i = 0.03, .theta_j = -0.05};
  evaluate_law(t, &x, 0);
  assert_close(x.N, 0.8 * 1000 * 0.2); /* at fixed damage: no term from d(stretch) */
  assert_close(x.M_i, 0.8 * 2 * (2 * 0.03 - 0.05));
  assert_close(x.M_j, 0.8 * 2 * (0.03 - 2 * 0.05));
  close_law(t);
}

static void a_shear_force_gives_equal_moments(void **state) {
  (void)state;
  tested_law *t =
      must_open(MICROPOLAR("  force N = k*stretch\n  force V = k*(theta_i + theta_j)\n"));
  tested_state x = {.stretch = 0.2, .theta_i = 0.03, .theta_j = -0.05};
  evaluate_law(t, &x, 1);
  double length = 1.2 * tested_bond().s;
  assert_close(x.M_i, 1000 * -0.02 * length / 2);
  assert_true(x.M_i == x.M_j);
  assert_close(x.tangent[4], 1000 * -0.02 * tested_bond().s / 2); /* dM_i/dstretch: L follows */
  close_law(t);
}

static void diff_is_the_derivative(void **state) {
  (void)state;
  tested_law *t =
      must_open(CENTRAL("  parameter a = 3 in (0, inf)\n"
                        "  damage d = stretch/2\n"
                        "  y = 2*stretch\n"
                        "  w = (1 - d)**2*y**3*a\n"
                        "  output by_quantity = diff(w, stretch)\n"
                        "  output by_parameter = diff(w, a)\n"
                        "  output by_damage = diff(w, d)\n"
                        "  force N = k*(diff(w, stretch) + 10*diff(w, a) + 100*diff(w, d))\n"));
  double x = 0.4, d = 0.2, y = 0.8, g = (1 - d) * (1 - d);
  double expected = g * 3 * y * y * 2 * 3 + 10 * g * y * y * y - 100 * 2 * (1 - d) * y * y * y * 3;
  assert_close(force_of(t, x, 0), 1000 * expected);
  close_law(t);
}

static void bending_norm_is_the_size(void **state) {
  (void)state;
  tested_law *t = must_open(MICROPOLAR("  force N = k*norm(2*theta_i + theta_j)\n"
                                       "  moment M_i = c*theta_i\n  moment M_j = c*theta_j\n"));
  tested_state x = {.theta_i = -0.03, .theta_j = 0.01};
  evaluate_law(t, &x, 0);
  assert_close(x.N, 50);
  close_law(t);
}

/* A slider with nonlinear hardening is returned to its limit within one step: N = k (stretch - p)
   and |N| = N_y (1 + (p/p_0)^2), whatever the overshoot. */
static void a_returned_flow_ends_on_the_limit(void **state) {
  (void)state;
  tested_law *t = must_open(CENTRAL("  state p on bond = 0\n  N_t = k*(stretch - p)\n"
                                    "  yield f = abs(N_t)/(0.001*k*(1 + (p/0.01)**2)) - 1\n"
                                    "  flow p along sign(N_t) returned when f >= 0\n"
                                    "  force N = k*(stretch - p)\n"));
  const double stretches[] = {0.0011, 0.002, 0.01, -0.004, 0.05};
  for (size_t q = 0; q < sizeof stretches / sizeof *stretches; q++) {
    tested_state x = {.stretch = stretches[q]};
    evaluate_law(t, &x, 0);
    const double limit = 0.001 * (1 + pow(x.new_field[0] / 0.01, 2));
    const double elastic = fabs(stretches[q] - x.new_field[0]);
    if (!(fabs(elastic / limit - 1) < 1e-12))
      fail_msg("at stretch %g the limit is missed by %.3g", stretches[q], elastic / limit - 1);
  }
  tested_state below = {.stretch = 0.0005};
  evaluate_law(t, &below, 0);
  assert_true(below.new_field[0] == 0);
  close_law(t);
}

/* Of the reference bond, 17 degrees from x and 6.35 mm long. */
static void the_direction_is_a_unit_vector(void **state) {
  (void)state;
  tested_law *t =
      must_open(CENTRAL("  force N = k*(norm(3*direction) + (direction : direction))*stretch\n"));
  assert_close(force_of(t, 0.01, 0), 40);
  close_law(t);
}

static const char tensor_output[] =
    "model m\n  law state\n  for space\n  parameter a = 1 [N] in (0, inf)\n"
    "  strain eps = fit(stretch)\n  force state F[j] = a*stretch[j]\n  output e = eps\nend model\n";

static void what_is_not_compiled_yet_is_said(void **state) {
  (void)state;
  tested_law *t = open_law(tensor_output);
  assert_non_null(t->law);
  assert_null(t->plan);
  assert_int_equal(t->said.items[t->said.count - 1].code, DIAG_NOT_SUPPORTED);
  close_law(t);
}

/* Not even by a state whose rule stands above, or where only the energy is given. */
static void a_rest_stretch_that_moves_with_the_bond_is_refused(void **state) {
  (void)state;
  static const struct {
    const char *kind, *rest;
  } laws[] = {{"micropolar bond", "norm(theta_i)*norm(theta_j)"},
              {"micropolar bond\n  for space", "norm(theta_i)"},
              {"micropolar bond\n  for space", "1e-3*twist**2"},
              {"central bond", "1e-3*(length/s - 1)"},
              {"central bond", "stretch_rate*1 [s]"},
              {"central bond", "x"}};
  for (size_t k = 0; k < sizeof laws / sizeof *laws; k++) {
    char text[600];
    const bool state_above = strcmp(laws[k].rest, "x") == 0;
    snprintf(text, sizeof text,
             "model m\n  law %s\n  parameter k = 50 [MN] in (0, inf)\n%s"
             "  rest stretch = %s\n  energy W = s*k*stretch**2/2\nend model\n",
             laws[k].kind, state_above ? "  state x on bond = 0\n  x = length/s - 1\n" : "",
             laws[k].rest);
    tested_law *t = open_law(text);
    assert_non_null(t->law);
    if (t->plan) fail_msg("`%s` is not refused", laws[k].rest);
    assert_non_null(strstr(t->said.items[t->said.count - 1].message, "own motion"));
    close_law(t);
  }
}

/* What cannot be compiled is never taken for a bound of 0. */
static void a_bound_that_cannot_be_compiled_is_said(void **state) {
  (void)state;
  tested_law *t = open_law(tensor_output);
  ir *g = ir_new();
  const expr *neighbours = t->law->rules[t->law->rule_count - 1]->value;
  const int errors = t->said.errors;
  assert_int_equal(lower_bound(g, t->law, neighbours, 0, &t->said), IR_NONE);
  assert_int_equal(t->said.errors, errors + 1);
  assert_int_equal(t->said.items[t->said.count - 1].code, DIAG_NOT_SUPPORTED);

  ir_node open = lower_bound(g, t->law, NULL, INFINITY, &t->said);
  assert_true(ir_value(g, open) == INFINITY);
  assert_int_equal(t->said.errors, errors + 1);
  ir_free(g);
  close_law(t);
}

/* Each function calls the one before twice: 1024 calls, but of few different values. */
static void repeated_calls_are_expanded_once(void **state) {
  (void)state;
  char text[8192] = "model m\n  law central bond\n  parameter k = 1 [N] in (0, inf)\n"
                    "  function f0(x) = x + 1\n";
  for (int n = 1; n <= 10; n++)
    snprintf(text + strlen(text), 100, "  function f%d(x) = (f%d(x) + f%d(x))/2\n", n, n - 1,
             n - 1);
  strcat(text, "  force N = k*f10(stretch)\nend model\n");
  tested_law *t = must_open(text);
  assert_close(force_of(t, 0.25, 0), 1.25);
  assert_true(ir_count(t->plan->graph) < 400);
  close_law(t);
}

/* --- energy ----------------------------------------------------------------------------------- */

typedef struct observed_bond {
  double stored, rate_lost, state_lost, field[MOST_FIELDS];
} observed_bond;

typedef struct end_rotation {
  double angle, rate; /* rad, rad/s */
} end_rotation;

/* One bond along its chord, stretched, its ends turned. The stored energy is that after the step.
   */
static observed_bond observe_turned(const tested_law *t, double stretch, double rate, double field,
                                    end_rotation i, end_rotation j) {
  pl_bond_class bond = tested_bond();
  double zero[8] = {0}, u[2][8] = {{0}}, v[2][8] = {{0}}, fields[MOST_FIELDS][8], planes[4][8];
  double observed[8][8], lost[2][8] = {{0}};
  int64_t flags[8] = {PL_PRESENT(0)};
  double *field_at[MOST_FIELDS], *plane_at[4], *observed_at[8];
  for (int k = 0; k < MOST_FIELDS; k++) {
    field_at[k] = fields[k];
    fields[k][0] = k ? 0 : field;
  }
  for (int k = 0; k < 4; k++)
    plane_at[k] = planes[k];
  for (int k = 0; k < 8; k++)
    observed_at[k] = observed[k];
  for (int k = 0; k < 2; k++) {
    u[k][0] = stretch * bond.chord[k];
    v[k][0] = rate * bond.chord[k];
  }
  pl_strip s = {.size = sizeof(pl_strip),
                .count = 1,
                .flags = flags,
                .displacement_i = {zero, zero, &i.angle},
                .velocity_i = {zero, zero, &i.rate},
                .displacement_j = {u[0], u[1], &j.angle},
                .velocity_j = {v[0], v[1], &j.rate},
                .field = field_at,
                .force = plane_at,
                .dissipated_state = lost[0],
                .dissipated_rate = lost[1],
                .observed = observed_at,
                .time_step = 1e-6};
  t->kernel->rows_ledger(t->kernel, t->uniforms, &s);
  t->kernel->rows_observe(t->kernel, t->uniforms, &s);
  observed_bond o = {.stored = observed[0][0], .state_lost = lost[0][0], .rate_lost = lost[1][0]};
  for (int k = 0; k < MOST_FIELDS; k++)
    o.field[k] = fields[k][0];
  return o;
}

static observed_bond observe(const tested_law *t, double stretch, double rate, double field) {
  return observe_turned(t, stretch, rate, field, (end_rotation){0, 0}, (end_rotation){0, 0});
}

static void assert_near(double value, double expected, double tolerance) {
  if (!(fabs(value - expected) <= tolerance))
    fail_msg("%.17g is not %.17g within %g", value, expected, tolerance);
}

static void stored_energy_of_each_kind(void **state) {
  (void)state;
  double s = tested_bond().s, x = 0.013;
  tested_law *t = must_open(CENTRAL("  force N = | k*stretch when stretch > 0\n"
                                    "            | 3*k*stretch otherwise\n"));
  assert_near(observe(t, x, 0, 0).stored, 1000 * s * x * x / 2, 1e-13);
  assert_near(observe(t, -x, 0, 0).stored, 3000 * s * x * x / 2, 1e-13);
  close_law(t);
  t = must_open(CENTRAL("  state p = 0\n  p = previous(p)\n  force N = k*(stretch - p)\n"));
  assert_near(observe(t, x, 0, 0.004).stored, 1000 * s * 0.009 * 0.009 / 2, 1e-13);
  close_law(t);
  t = must_open(CENTRAL("  force N = k*(stretch - stretch**2 + 5*stretch**3)\n"));
  assert_near(observe(t, x, 0, 0).stored,
              1000 * s * (x * x / 2 - x * x * x / 3 + 5 * x * x * x * x / 4), 1e-13);
  close_law(t);
  t = must_open(CENTRAL("  energy W = k*s*stretch**4\n"));
  assert_near(observe(t, x, 0, 0).stored, 1000 * s * x * x * x * x, 1e-15);
  close_law(t);
}

/* Without derivative in the stretch the fully damaged bond holds nothing: no 0/0. */
static void a_broken_affine_bond_holds_nothing(void **state) {
  (void)state;
  tested_law *t = must_open(CENTRAL("  damage d = 0\n  state p = 0.01\n  p = previous(p)\n"
                                    "  force N = (1 - d)*k*(stretch - p)\n"));
  assert_true(observe(t, 0.02, 0, 1).stored == 0);
  close_law(t);
}

static void losses_are_what_they_should_be(void **state) {
  (void)state;
  double s = tested_bond().s, x = 0.05, rate = 7;
  tested_law *t = must_open(CENTRAL(
      "  parameter eta = 2 [N*s] in (0, inf)\n"
      "  damage d = 10*stretch\n  N_el = (1 - d)*k*stretch\n"
      "  force N = N_el + eta*stretch_rate + 0.1*abs(N_el)*soft_sign(stretch_rate/(10 [1/s]))\n"));
  observed_bond o = observe(t, x, rate, 0.2);
  assert_near(o.field[0], 0.5, 1e-14);
  assert_near(o.stored, 0.5 * 1000 * s * x * x / 2, 1e-14);
  assert_near(o.state_lost, 0.3 * 1000 * s * x * x / 2, 1e-14);
  double damper = 2 * rate + 0.1 * 0.5 * 1000 * x * (0.7 / 1.7);
  assert_near(o.rate_lost, damper * rate * s * 1e-6, 1e-18);
  close_law(t);
}

/* Of a spring with a stress-free stretch s N^2/(2 k), of linear moments half of moment times
   rotation. */
static void bending_is_stored_beside_an_affine_force(void **state) {
  (void)state;
  tested_law *t = must_open(MICROPOLAR("  state p = 0\n  p = previous(p)\n"
                                       "  force N = k*(stretch - p)\n"
                                       "  moment M_i = 0.5*k*s*(2*theta_i + theta_j)\n"
                                       "  moment M_j = 0.5*k*s*(2*theta_j + theta_i)\n"));
  const double s = tested_bond().s, a = 0.02, b = -0.005;
  const observed_bond o =
      observe_turned(t, 0.013, 0, 0.004, (end_rotation){a, 0}, (end_rotation){b, 0});
  assert_near(o.stored, 1000 * s * (0.009 * 0.009 / 2 + 0.5 * (a * a + a * b + b * b)), 1e-13);
  close_law(t);
}

/* Each moment works with the rate of its own end. */
static void viscous_moments_take_the_rate_of_their_end(void **state) {
  (void)state;
  tested_law *t =
      must_open(MICROPOLAR("  force N = k*stretch\n"
                           "  moment M_i = k*s*theta_i*(1 + stretch_rate/(100 [1/s]))\n"
                           "  moment M_j = k*s*theta_j*(1 + stretch_rate/(100 [1/s]))\n"));
  const double s = tested_bond().s, a = 0.02, b = -0.005, rate = 7;
  const observed_bond o =
      observe_turned(t, 0.013, rate, 0, (end_rotation){a, 3}, (end_rotation){b, 11});
  assert_near(o.rate_lost, 1000 * s * rate / 100 * (3 * a + 11 * b) * 1e-6, 1e-18);
  close_law(t);
}

/* Of a bond of length L whose bar is turned by theta against it: slip = L cos(theta) - s, gap = -L
   sin(theta). N and V are what their work gives, at any angle. */
static void slip_and_gap_are_those_of_the_bar(void **state) {
  (void)state;
  static const char head[] = "model m\n  law slip bond\n  parameter a = 3 [MN/m] in (0, inf)\n"
                             "  parameter b = 7 [MN/m] in (0, inf)\n";
  static const char *const given[] = {
      "  force N = a*slip\n  force V = b*gap\nend model\n",
      "  energy W = a/2*slip**2 + b/2*(gap:gap)\nend model\n",
      "  force N = a*slip\n  force V = b*gap\n  energy W = a/2*slip**2 + b/2*norm(gap)**2\n"
      "end model\n"};
  const double s = tested_bond().s, angles[] = {0, 1e-7, 0.02, -0.7, 2};
  for (size_t k = 0; k < sizeof given / sizeof *given; k++) {
    char text[1024];
    snprintf(text, sizeof text, "%s%s", head, given[k]);
    tested_law *t = must_open(text);
    for (size_t n = 0; n < sizeof angles / sizeof *angles; n++) {
      const double theta = angles[n], stretch = 0.01 * (1 + (double)n), L = s * (1 + stretch);
      const double along = 3e6 * (s * stretch - 2 * L * pow(sin(theta / 2), 2)),
                   across = -7e6 * L * sin(theta);
      /* end j has turned further than end i: the bar's tangent is the mean */
      tested_state x = {.stretch = stretch, .theta_i = 0.8 * theta, .theta_j = 1.2 * theta};
      evaluate_law(t, &x, 0);
      assert_close(x.N, along * cos(theta) - across * sin(theta));
      assert_close(x.M_i, -0.5 * L * (along * sin(theta) + across * cos(theta)));
      assert_close(x.M_j, x.M_i);
    }
    close_law(t);
  }
}

/* Its rate is that of the bond's length. */
static void slip_has_a_rate(void **state) {
  (void)state;
  tested_law *t = must_open("model m\n  law slip bond\n  parameter c = 4 [kN*s/m] in (0, inf)\n"
                            "  force N = c*slip_rate\n  force V = 0*gap*1 [N/m]\nend model\n");
  tested_state x = {.stretch = 0.1, .rate = 30};
  evaluate_law(t, &x, 0);
  assert_close(x.N, 4000 * 30 * tested_bond().s);
  close_law(t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_first_true_case_wins),
      cmocka_unit_test(slip_and_gap_are_those_of_the_bar),
      cmocka_unit_test(slip_has_a_rate),
      cmocka_unit_test(functions_are_expanded),
      cmocka_unit_test(built_in_functions_mean_what_they_say),
      cmocka_unit_test(damage_grows_and_stays_below_one),
      cmocka_unit_test(names_above_a_rule_read_the_last_step),
      cmocka_unit_test(flow_adds_one_increment),
      cmocka_unit_test(options_are_decided),
      cmocka_unit_test(forces_follow_from_an_energy),
      cmocka_unit_test(a_shear_force_gives_equal_moments),
      cmocka_unit_test(diff_is_the_derivative),
      cmocka_unit_test(bending_norm_is_the_size),
      cmocka_unit_test(a_returned_flow_ends_on_the_limit),
      cmocka_unit_test(the_direction_is_a_unit_vector),
      cmocka_unit_test(what_is_not_compiled_yet_is_said),
      cmocka_unit_test(a_rest_stretch_that_moves_with_the_bond_is_refused),
      cmocka_unit_test(a_bound_that_cannot_be_compiled_is_said),
      cmocka_unit_test(repeated_calls_are_expanded_once),
      cmocka_unit_test(stored_energy_of_each_kind),
      cmocka_unit_test(a_broken_affine_bond_holds_nothing),
      cmocka_unit_test(losses_are_what_they_should_be),
      cmocka_unit_test(bending_is_stored_beside_an_affine_force),
      cmocka_unit_test(viscous_moments_take_the_rate_of_their_end),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
