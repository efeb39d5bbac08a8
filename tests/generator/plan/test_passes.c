/* The passes of the bilinear micropolar law against the law written by hand, against theory (work,
   balance, rigid rotation) and against each other. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <float.h>

#include "generator/emit/plan_dump.h"
#include "generator/ir/interpret.h"
#include "tests/generator/law_text.h"

#define MODEL SOURCE_DIR "/models/mplm_bilinear.plm"

static uint64_t seed = 42;

static double uniform(double low, double high) {
  return random_uniform(&seed, low, high);
}
static double spread(double low, double high) {
  return random_spread(&seed, low, high);
}

static tested_law *must_open_model(void) {
  tested_law *t = open_law_file(MODEL);
  assert_non_null(t);
  assert_non_null(t->plan);
  return t;
}

static void assert_near(double value, double expected, double tolerance, const char *what) {
  if (!(fabs(value - expected) <= tolerance))
    fail_msg("%s: %.17g is not %.17g within %g", what, value, expected, tolerance);
}

/* --- the law by hand (Asadollahi 2014, eqs 2.49 and 3.1-3.15) --------------------------------- */

typedef struct hand_law {
  double N, M_i, M_j, omega, EA, EI;
  int line; /* of the damage rule */
} hand_law;

static const double E_modulus = 30e9, poisson = 0.2, S_t = 1.18e-4, alpha1 = 0.13, alpha2 = 20,
                    alpha3 = 415, beta = 0.1, zeta = 0.05, rate_0 = 10;

static hand_law by_hand(const tested_state *x) {
  pl_bond_class b = tested_bond();
  hand_law h;
  h.EA = E_modulus * b.s * b.t / (sqrt(3) * (1 - poisson));
  h.EI =
      E_modulus * pow(b.s, 3) * b.t * (1 - 3 * poisson) / (12 * sqrt(3) * (1 - poisson * poisson));
  double curvature_i = 2 / b.s * (2 * x->theta_i + x->theta_j);
  double curvature_j = 2 / b.s * (2 * x->theta_j + x->theta_i);
  double eps = x->stretch + beta * b.s * fmax(fabs(curvature_i), fabs(curvature_j));
  double rule;
  if (eps <= S_t) {
    rule = 0;
    h.line = 0;
  } else if (eps <= alpha2 * S_t) {
    rule = (alpha2 - alpha1) / (alpha2 - 1) * (eps - S_t) / eps;
    h.line = 1;
  } else if (eps <= alpha3 * S_t) {
    rule = 1 - alpha1 / (alpha3 - alpha2) * (alpha3 * S_t - eps) / eps;
    h.line = 2;
  } else {
    rule = 1;
    h.line = 3;
  }
  h.omega = fmin(fmax(x->field[0], rule), 1);
  double elastic = (1 - h.omega) * h.EA * x->stretch, ratio = x->rate / rate_0;
  h.N = elastic + zeta * fabs(elastic) * ratio / (1 + fabs(ratio));
  h.M_i = (1 - h.omega) * 2 * h.EI / b.s * (2 * x->theta_i + x->theta_j);
  h.M_j = (1 - h.omega) * 2 * h.EI / b.s * (2 * x->theta_j + x->theta_i);
  return h;
}

static tested_state random_law_state(void) {
  tested_state x = {.stretch = spread(1e-7, 0.1),
                    .rate = spread(1e-3, 1e6),
                    .theta_i = spread(1e-7, 0.1),
                    .theta_j = spread(1e-7, 0.1)};
  x.field[0] = uniform(-0.5, 1);
  x.field[0] = x.field[0] > 0 ? x.field[0] : 0;
  return x;
}

static void states_are_those_of_the_law_by_hand(void **state) {
  (void)state;
  tested_law *t = must_open_model();
  int reached[4] = {0}, from_old = 0;
  for (int n = 0; n < 100000; n++) {
    tested_state x = random_law_state();
    evaluate_law(t, &x, 0);
    hand_law h = by_hand(&x);
    reached[h.line]++;
    from_old += h.omega == x.field[0] && h.line > 0;
    /* 1 - omega is all that omega leaves of a force: its rounding is the force's */
    double rest = 4 * DBL_EPSILON / fmax(1 - h.omega, 4 * DBL_EPSILON) + 1e-13;
    assert_near(x.new_field[0], h.omega, 1e-13 * h.omega, "omega");
    assert_near(x.N, h.N, rest * fabs(h.N) + 1e-300, "N");
    double moments = fabs(h.M_i) + fabs(h.M_j);
    assert_near(x.M_i, h.M_i, rest * moments + 1e-300, "M_i");
    assert_near(x.M_j, h.M_j, rest * moments + 1e-300, "M_j");
  }
  for (int line = 0; line < 4; line++)
    assert_true(reached[line] > 1000);
  assert_true(from_old > 1000);
  close_law(t);
}

/* A bond seen with its ends exchanged: the same force, the moments exchanged. Mirrored: the same
   force, opposite moments. */
static void ends_and_mirror_images_agree(void **state) {
  (void)state;
  tested_law *t = must_open_model();
  for (int n = 0; n < 20000; n++) {
    tested_state x = random_law_state(), swapped = x, mirrored = x;
    swapped.theta_i = x.theta_j;
    swapped.theta_j = x.theta_i;
    mirrored.theta_i = -x.theta_i;
    mirrored.theta_j = -x.theta_j;
    evaluate_law(t, &x, 0);
    evaluate_law(t, &swapped, 0);
    evaluate_law(t, &mirrored, 0);
    assert_true(x.N == swapped.N && x.M_i == swapped.M_j && x.M_j == swapped.M_i);
    assert_true(x.N == mirrored.N && x.M_i == -mirrored.M_i && x.M_j == -mirrored.M_j);
    assert_true(x.new_field[0] == swapped.new_field[0] && x.new_field[0] == mirrored.new_field[0]);
  }
  close_law(t);
}

/* --- tangent ---------------------------------------------------------------------------------- */

static double *input_of(tested_state *x, int k) {
  double *const inputs[] = {&x->stretch, &x->rate, &x->theta_i, &x->theta_j};
  return inputs[k];
}

static double result_of(const tested_state *x, int k) {
  return k == 0 ? x->N : k == 1 ? x->M_i : x->M_j;
}

/* Which side of every kink a state is on: case line, growing or resting damage, the larger
   curvature, signs. */
static int side_of(const tested_state *x) {
  hand_law h = by_hand(x);
  double a = 2 * x->theta_i + x->theta_j, b = 2 * x->theta_j + x->theta_i;
  return h.line + 4 * (h.omega > x->field[0]) + 8 * (fabs(a) > fabs(b)) + 16 * (a > 0) +
         32 * (b > 0) + 64 * (x->stretch > 0) + 128 * (x->rate > 0);
}

/* The scale over which the results vary: the micropolar stretch, the damper's rate. */
static double step_of(const tested_state *x, int input) {
  if (input == 1) return 1e-4 * (fabs(x->rate) + rate_0);
  double a = fabs(2 * x->theta_i + x->theta_j), b = fabs(2 * x->theta_j + x->theta_i);
  double eps = fabs(x->stretch + 2 * beta * fmax(a, b));
  return 1e-4 * fmin(fabs(*input_of((tested_state *)x, input)), eps);
}

static void the_tangent_is_the_slope(void **state) {
  (void)state;
  tested_law *t = must_open_model();
  int compared = 0;
  for (int n = 0; n < 20000; n++) {
    tested_state x = random_law_state();
    evaluate_law(t, &x, 1);
    hand_law at = by_hand(&x);
    double size = fabs(x.stretch) + fabs(x.theta_i) + fabs(x.theta_j);
    for (int q = 0; q < 4; q++) {
      tested_state low = x, high = x;
      double h = step_of(&x, q);
      *input_of(&low, q) -= h;
      *input_of(&high, q) += h;
      if (side_of(&low) != side_of(&high)) continue;
      evaluate_law(t, &low, 0);
      evaluate_law(t, &high, 0);
      double moved = *input_of(&high, q) - *input_of(&low, q);
      for (int k = 0; k < 3; k++) {
        double slope = (result_of(&high, k) - result_of(&low, k)) / moved;
        /* the difference sees the rounding of the results and the third derivative, (h/scale)^2 =
         * 1e-8 */
        double stiffness = k == 0 ? at.EA : 12 * at.EI / tested_bond().s;
        double scale = stiffness * size / (q == 1 ? rate_0 : 1e4 * h);
        double tolerance = 1e-14 * stiffness * size / h + 1e-7 * fabs(slope) + 1e-9 * scale;
        assert_near(x.tangent[4 * k + q], slope, tolerance, "tangent");
        compared++;
      }
    }
  }
  assert_true(compared > 150000);
  close_law(t);
}

/* --- strips ----------------------------------------------------------------------------------- */

enum { MOST_BONDS = 200, PLANES = 4, DOF = 3 };

/* Bonds of one direction with all their arrays. */
typedef struct bonds {
  double u[2][DOF][MOST_BONDS], v[2][DOF][MOST_BONDS];
  int64_t flags[MOST_BONDS];
  double omega[MOST_BONDS], force[PLANES][MOST_BONDS], lost[2][MOST_BONDS], observed[1][MOST_BONDS];
  double *field_at[1], *force_at[PLANES], *observed_at[1];
  pl_strip strip;
} bonds;

static void connect(bonds *b, int count) {
  b->field_at[0] = b->omega;
  b->observed_at[0] = b->observed[0];
  for (int k = 0; k < PLANES; k++)
    b->force_at[k] = b->force[k];
  b->strip = (pl_strip){.size = sizeof(pl_strip),
                        .count = count,
                        .direction = 2,
                        .flags = b->flags,
                        .field = b->field_at,
                        .force = b->force_at,
                        .observed = b->observed_at,
                        .dissipated_state = b->lost[0],
                        .dissipated_rate = b->lost[1],
                        .time_step = 3e-7};
  for (int k = 0; k < DOF; k++) {
    b->strip.displacement_i[k] = b->u[0][k];
    b->strip.displacement_j[k] = b->u[1][k];
    b->strip.velocity_i[k] = b->v[0][k];
    b->strip.velocity_j[k] = b->v[1][k];
  }
}

static bonds *random_bonds(int count, double most) {
  bonds *b = calloc(1, sizeof *b);
  pl_bond_class c = tested_bond();
  for (int n = 0; n < count; n++) {
    for (int end = 0; end < 2; end++) {
      for (int k = 0; k < DOF; k++) {
        b->u[end][k][n] = spread(1e-9, most) * (k < 2 ? c.s : 1);
        b->v[end][k][n] = spread(1e-6, 1);
      }
    }
    b->omega[n] = fmax(0, uniform(-0.5, 1));
    b->flags[n] = PL_PRESENT(2);
    for (int k = 0; k < PLANES; k++)
      b->force[k][n] = NAN; /* everything must be written */
    b->observed[0][n] = NAN;
  }
  connect(b, count);
  return b;
}

static bonds *copy_bonds(const bonds *b) {
  bonds *c = malloc(sizeof *c);
  *c = *b;
  connect(c, (int)b->strip.count);
  return c;
}

static void absent_and_protected_bonds_stay_as_they_are(void **state) {
  (void)state;
  tested_law *t = must_open_model();
  bonds *b = random_bonds(MOST_BONDS, 0.01);
  for (int n = 0; n < MOST_BONDS; n++)
    b->flags[n] =
        (n % 3 ? PL_PRESENT(2) : PL_PRESENT(1)) | (n % 4 ? 0 : PL_PROTECTED(2)) | PL_PROTECTED(1);
  bonds *before = copy_bonds(b);
  t->kernel->rows_ledger(t->kernel, t->uniforms, &b->strip);
  int grown = 0;
  for (int n = 0; n < MOST_BONDS; n++) {
    bool absent = n % 3 == 0, guarded = n % 4 == 0;
    grown += b->omega[n] > before->omega[n];
    if (absent || guarded) assert_true(b->omega[n] == before->omega[n]);
    if (guarded) assert_true(b->lost[0][n] == 0);
    for (int k = 0; k < PLANES; k++)
      assert_true(absent ? b->force[k][n] == 0 : b->force[k][n] != 0);
    if (absent) assert_true(b->lost[0][n] == 0 && b->lost[1][n] == 0);
  }
  assert_true(grown > 20);
  /* a protected bond's force is that of the damage it has */
  bonds *again = copy_bonds(before);
  for (int n = 0; n < MOST_BONDS; n++)
    again->flags[n] = PL_PRESENT(2) | PL_PROTECTED(2);
  t->kernel->rows(t->kernel, t->uniforms, &again->strip);
  bonds *broken = copy_bonds(before);
  for (int n = 0; n < MOST_BONDS; n++)
    broken->omega[n] = 1;
  t->kernel->rows(t->kernel, t->uniforms, &broken->strip);
  for (int n = 0; n < MOST_BONDS; n++) {
    assert_true(broken->force[0][n] == 0 && broken->force[2][n] == 0);
    assert_true(again->force[0][n] != 0 && again->omega[n] == before->omega[n]);
  }
  free(b), free(before), free(again), free(broken);
  close_law(t);
}

/* What the particles receive is minus the gradient of the stored energy, at frozen damage and
   without rate. */
static void forces_are_the_slope_of_the_energy(void **state) {
  (void)state;
  tested_law *t = must_open_model();
  bonds *b = random_bonds(MOST_BONDS, 0.3);
  for (int n = 0; n < MOST_BONDS; n++) {
    b->flags[n] |= PL_PROTECTED(2);
    for (int k = 0; k < DOF; k++)
      b->v[0][k][n] = b->v[1][k][n] = 0;
  }
  t->kernel->rows(t->kernel, t->uniforms, &b->strip);
  t->kernel->rows_observe(t->kernel, t->uniforms, &b->strip);
  pl_bond_class c = tested_bond();
  double EA = E_modulus * c.s * c.t / (sqrt(3) * (1 - poisson));
  for (int end = 0; end < 2; end++)
    for (int k = 0; k < DOF; k++) {
      double h = 1e-5 * (k < 2 ? c.s : 1);
      bonds *low = copy_bonds(b), *high = copy_bonds(b);
      for (int n = 0; n < MOST_BONDS; n++) {
        low->u[end][k][n] -= h;
        high->u[end][k][n] += h;
      }
      t->kernel->rows_observe(t->kernel, t->uniforms, &low->strip);
      t->kernel->rows_observe(t->kernel, t->uniforms, &high->strip);
      for (int n = 0; n < MOST_BONDS; n++) {
        double slope = (high->observed[0][n] - low->observed[0][n]) / (2 * h);
        double force = k == 2 ? -b->force[2 + end][n] : (end ? -1 : 1) * b->force[k][n];
        /* rounding of the energy (up to EA s/10) over h, and the curvature of the rotation */
        assert_near(force, -slope, 1e-8 * (k < 2 ? EA : EA * c.s), "force");
      }
      free(low), free(high);
    }
  free(b);
  close_law(t);
}

/* A patch turned as a rigid body by 14 rad: forces of 1e-12 EA (what rounding leaves). */
static void a_rigid_rotation_gives_no_force(void **state) {
  (void)state;
  tested_law *t = must_open_model();
  bonds *b = random_bonds(MOST_BONDS, 1e-9);
  pl_bond_class c = tested_bond();
  double turn = 14, EA = E_modulus * c.s * c.t / (sqrt(3) * (1 - poisson));
  for (int n = 0; n < MOST_BONDS; n++)
    for (int end = 0; end < 2; end++) {
      double x = c.chord[0] * (n % 15 + end), y = c.chord[1] * (n % 15 + end);
      b->omega[n] = 0;
      b->u[end][0][n] = x * cos(turn) - y * sin(turn) - x;
      b->u[end][1][n] = x * sin(turn) + y * cos(turn) - y;
      b->u[end][2][n] = turn;
    }
  t->kernel->rows(t->kernel, t->uniforms, &b->strip);
  for (int n = 0; n < MOST_BONDS; n++) {
    assert_true(b->omega[n] == 0);
    for (int k = 0; k < PLANES; k++)
      assert_near(b->force[k][n], 0, 1e-12 * EA * (k < 2 ? 1 : c.s), "force");
  }
  free(b);
  close_law(t);
}

static void the_ledger_changes_no_bit_and_counts_losses(void **state) {
  (void)state;
  tested_law *t = must_open_model();
  bonds *b = random_bonds(MOST_BONDS, 0.02), *plain = copy_bonds(b), *before = copy_bonds(b);
  t->kernel->rows_observe(t->kernel, t->uniforms, &before->strip);
  t->kernel->rows(t->kernel, t->uniforms, &plain->strip);
  t->kernel->rows_ledger(t->kernel, t->uniforms, &b->strip);
  t->kernel->rows_observe(t->kernel, t->uniforms, &b->strip);
  int losing = 0;
  for (int n = 0; n < MOST_BONDS; n++) {
    assert_true(b->omega[n] == plain->omega[n]);
    for (int k = 0; k < PLANES; k++)
      assert_true(b->force[k][n] == plain->force[k][n]);
    double had = before->observed[0][n], kept = b->observed[0][n];
    assert_near(b->lost[0][n], had - kept, 1e-15 * had, "dissipated by damage");
    assert_true(b->lost[0][n] >= 0 && b->lost[1][n] >= 0);
    losing += b->lost[0][n] > 0;
  }
  assert_true(losing > 20);
  free(b), free(plain), free(before);
  close_law(t);
}

/* More callers than workers: each strip comes out as if it were alone. */
static void many_threads_give_the_same_bits(void **state) {
  (void)state;
  enum { STRIPS = 64 };
  tested_law *t = must_open_model();
  bonds *alone[STRIPS], *together[STRIPS];
  for (int k = 0; k < STRIPS; k++) {
    alone[k] = random_bonds(MOST_BONDS - k, 0.02);
    together[k] = copy_bonds(alone[k]);
    t->kernel->rows(t->kernel, t->uniforms, &alone[k]->strip);
  }
#pragma omp parallel for num_threads(16) schedule(dynamic)
  for (int k = 0; k < STRIPS; k++)
    t->kernel->rows(t->kernel, t->uniforms, &together[k]->strip);
  for (int k = 0; k < STRIPS; k++) {
    size_t bytes = (size_t)alone[k]->strip.count * sizeof(double);
    for (int plane = 0; plane < PLANES; plane++)
      assert_memory_equal(alone[k]->force[plane], together[k]->force[plane], bytes);
    assert_memory_equal(alone[k]->omega, together[k]->omega, bytes);
    free(alone[k]), free(together[k]);
  }
  close_law(t);
}

/* --- the plan itself -------------------------------------------------------------------------- */

static void bounds_follow_the_parameters(void **state) {
  (void)state;
  tested_law *t = must_open_model();
  double lower[16], upper[16];
  unsigned char low_open[16], high_open[16];
  int alpha2_at = -1, alpha3_at = -1, nu_at = -1;
  for (int k = 0; k < t->kernel->parameter_count; k++) {
    alpha2_at = strcmp(t->kernel->parameters[k].name, "alpha2") ? alpha2_at : k;
    alpha3_at = strcmp(t->kernel->parameters[k].name, "alpha3") ? alpha3_at : k;
    nu_at = strcmp(t->kernel->parameters[k].name, "nu") ? nu_at : k;
  }
  t->parameters[alpha2_at] = 31;
  t->kernel->bounds(t->kernel, t->parameters, lower, upper, low_open, high_open);
  assert_true(lower[alpha3_at] == 31 && low_open[alpha3_at] && isinf(upper[alpha3_at]));
  assert_true(lower[nu_at] == 0 && !low_open[nu_at] && !high_open[nu_at]);
  assert_near(upper[nu_at], 1.0 / 3, 1e-16, "upper bound of nu");
  close_law(t);
}

/* What strips read of parameters and bond class has been computed before; no strip divides by it.
 */
static void uniform_values_are_hoisted(void **state) {
  (void)state;
  tested_law *t = must_open_model();
  const ir *g = t->plan->graph;
  unsigned char *hoisted = calloc((size_t)ir_count(g), 1);
  for (int k = 0; k < t->plan->uniform_count; k++)
    hoisted[t->plan->uniforms[k]] = 1;
  const segment *rows = plan_segment(t->plan, PROGRAM_STEP);
  for (int r = 0; r < rows->root_count; r++) {
    unsigned char *needed = calloc((size_t)ir_count(g), 1);
    ir_mark(g, &rows->roots[r].node, 1, needed);
    for (ir_node n = 0; n < ir_count(g); n++)
      for (int k = 0; needed[n] && k < ir_arity(ir_operation(g, n)); k++) {
        ir_node from = ir_operand(g, n, k);
        bool uniform_operand = ir_place(g, from) <= ON_BODY && ir_operation(g, from) != IR_CONSTANT;
        if (ir_place(g, n) <= ON_BODY || !uniform_operand) continue;
        assert_true(hoisted[from]);
        assert_false(ir_operation(g, n) == IR_DIV && k == 1);
      }
    free(needed);
  }
  free(hoisted);
  /* a root, 1/(L s (L + s)), 1/eps_mp, and the damper's */
  assert_true(t->plan->divisions_per_bond <= 4);
  close_law(t);
}

static void the_dump_names_passes_and_hoisted_values(void **state) {
  (void)state;
  tested_law *t = must_open_model();
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  plan_dump(t->plan, out);
  plan_dump_ir(t->plan, out);
  fclose(out);
  static const char *const expected[] = {
      "kernel of mplm_bilinear: micropolar bond",
      "pass rows\n",
      "pass rows_observe\n",
      "pass tangent\n",
      "pass bounds\n",
      " EA\n",
      "writes       force x, force y, end moment i, end moment j, field omega",
      "lost to rates",
      "stored energy",
      "lower bound of alpha3",
      "div %",
      "; eps_mp (line ",
      "end moment i = %"};
  for (size_t k = 0; k < sizeof expected / sizeof *expected; k++)
    if (!strstr(text, expected[k])) fail_msg("the dump does not say `%s`:\n%s", expected[k], text);
  free(text);
  close_law(t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(states_are_those_of_the_law_by_hand),
      cmocka_unit_test(ends_and_mirror_images_agree),
      cmocka_unit_test(the_tangent_is_the_slope),
      cmocka_unit_test(absent_and_protected_bonds_stay_as_they_are),
      cmocka_unit_test(forces_are_the_slope_of_the_energy),
      cmocka_unit_test(a_rigid_rotation_gives_no_force),
      cmocka_unit_test(the_ledger_changes_no_bit_and_counts_losses),
      cmocka_unit_test(many_threads_give_the_same_bits),
      cmocka_unit_test(bounds_follow_the_parameters),
      cmocka_unit_test(uniform_values_are_hoisted),
      cmocka_unit_test(the_dump_names_passes_and_hoisted_values),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
