/* What must become better as the discretisation becomes finer: the energy balance of an elastic
   beam with the time step, the deflection of an elastic cantilever with the spacing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/interaction.h"
#include "tests/verification/case.h"

/* --- time step -------------------------------------------------------------------------------- */

/* Largest imbalance over the external work at the end, of a driven elastic beam. */
static double imbalance(double safety, double zeta) {
  char text[2000];
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-3 step_safety = %g /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = 6.35e-3 thickness = 0.1524 /\n"
           "&material lattice = 'c' model = 'mplm_bilinear' S_t = 0.5 zeta = %g /\n"
           "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.2286, 0.067 /\n"
           "&region name = 'left' shape = 'point' at = 0, 0 /\n"
           "&region name = 'right' shape = 'point' at = 0.2286, 0 /\n"
           "&region name = 'top' shape = 'point' at = 0.1143, 0.065991136 /\n"
           "&support region = 'left' fix = 'xy' /\n&support region = 'right' fix = 'y' /\n"
           "&drive region = 'top' component = 'y' velocity = -0.02 rise = 0.5e-3 /\n"
           "&output frames = 0 sample = 1e-5 /\n",
           safety, zeta);
  deck_case c;
  assert_true(deck_case_text(&c, text));
  assert_int_equal(deck_case_go(&c), STEP_END);
  const long samples = simulation_history(c.simulation, NULL);
  const double *left_over = deck_case_series(&c, "energy/imbalance");
  const double external = deck_case_series(&c, "energy/external")[samples - 1];
  assert_true(external > 0 && deck_case_series(&c, "energy/dissipated_damage")[samples - 1] == 0);
  double largest = 0;
  for (long k = 0; k < samples; k++)
    largest = fmax(largest, fabs(left_over[k]));
  deck_case_close(&c);
  return largest / external;
}

/* Without the damper the bonds are linear, for which the ledger is exact at any step: only geometry
   is left, of second order. The damper knows the velocity of half a step before, which leaves first
   order. The drive is slow enough for stretches of 1e-5: where friction is stiff (0.05 |stretch|
   over 10 1/s times the step is more than about one) the sign of the rate alternates from step to
   step, and no rule integrates that. */
static void energy_balances_better_with_smaller_steps(void **state) {
  (void)state;
  static const double safeties[] = {0.8, 0.4, 0.2, 0.1};
  double plain[4], damped[4];
  for (int k = 0; k < 4; k++) {
    plain[k] = imbalance(safeties[k], 0);
    damped[k] = imbalance(safeties[k], 0.05);
    print_message(
        "%.1f of the stable step: imbalance %.2e undamped, %.2e damped, of the external work\n",
        safeties[k], plain[k], damped[k]);
  }
  for (int k = 1; k < 4; k++) {
    print_message("order %.2f undamped, %.2f damped\n", log2(plain[k - 1] / plain[k]),
                  log2(damped[k - 1] / damped[k]));
    assert_true(fabs(log2(plain[k - 1] / plain[k]) - 2) < 0.1);
    assert_true(fabs(log2(damped[k - 1] / damped[k]) - 1) < 0.1);
  }
}

/* --- spacing ---------------------------------------------------------------------------------- */

static const double depth = 0.1, thickness = 0.1;                 /* m */
static const double modulus = 30e9, ratio = 0.2, end_load = 1000; /* Pa, 1, N */

/* Displacement of a cantilever, clamped at x = 0, under a parabolic shear at x = length, in plane
   stress, with depth from -depth/2 to depth/2 (Timoshenko & Goodier 1951, article 20; in
   this form Augarde & Deeks 2008). */
static void exact(double length, double x, double y, double *ux, double *uy) {
  const double EI = modulus * thickness * depth * depth * depth / 12, nu = ratio;
  *ux =
      end_load * y / (6 * EI) * ((6 * length - 3 * x) * x + (2 + nu) * (y * y - depth * depth / 4));
  *uy = -end_load / (6 * EI) *
        (3 * nu * y * y * (length - x) + (4 + 5 * nu) * depth * depth * x / 4 +
         (3 * length - x) * x * x);
}

/* A cantilever of `row_count` rows; each row stands for its share of the depth, as its particles'
 * volume does. */
typedef struct cantilever {
  deck_case c;
  sweep *w;
  const rows *g;
  double s, length; /* m: spacing; clamped section to the load's centre */
  int32_t *held;    /* [particles] 1 where the exact motion is prescribed */
  double *load;     /* [3 * particles] N, N m */
  long unknowns;
} cantilever;

static void open_cantilever(cantilever *b, law_case *beam_law, int row_count) {
  char text[1000];
  memset(b, 0, sizeof *b);
  b->s = depth / row_count * 2 / sqrt(3);
  const double half = (row_count - 1) * sqrt(3) / 4 * b->s;
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = %.17g thickness = %.17g origin = 0, "
           "%.17g /\n"
           "&material lattice = 'c' model = 'mplm_bilinear' /\n"
           "&body lattice = 'c' shape = 'rectangle' corner = 0, %.17g size = %.17g, %.17g /\n",
           b->s, thickness, -half, -half, round(0.4 / b->s) * b->s, 2 * half);
  assert_true(deck_case_lattice(&b->c, text));
  b->c.lattice->mass = 2323 * b->c.lattice->volume;
  b->c.lattice->inertia = 0.1 * b->c.lattice->mass * b->s * b->s;
  assert_int_equal(b->c.lattice->row_count, row_count);
  b->g = b->c.lattice;
  b->length = b->g->width - b->s / 4; /* the loaded columns are half a spacing apart */
  b->w = interaction_new(b->g, beam_law->compiled, beam_law->parameters, 1e-7, 1, false, true);
  b->unknowns = 3 * b->g->particle_count;
  b->held = calloc((size_t)b->g->particle_count, sizeof *b->held);
  b->load = calloc((size_t)b->unknowns, sizeof *b->load);
}

static void close_cantilever(cantilever *b) {
  sweep_free(b->w);
  free(b->held);
  free(b->load);
  deck_case_close(&b->c);
}

/* The first columns follow the exact solution; the last carry the load. */
static void set_ends(cantilever *b) {
  double weight = 0;
  for (int pass_number = 0; pass_number < 2; pass_number++)
    for (long p = 0; p < b->g->particle_count; p++) {
      const double x = b->g->x[b->g->particle_site[p]], y = b->g->y[b->g->particle_site[p]];
      b->held[p] = x < 0.75 * b->s;
      if (x < b->g->width - 0.75 * b->s) continue;
      const double parabola = 1 - 4 * y * y / (depth * depth);
      if (pass_number == 0)
        weight += parabola;
      else
        b->load[3 * p + 1] = -end_load * parabola / weight;
    }
}

/* Forces K u on particles from the kernel: the even terms of its geometry cancel in the difference,
   and u is made so small (largest turn 1e-6 of a spacing) that the cubic ones are rounding. */
static void stiffness_times(cantilever *b, const double *u, double *product) {
  sweep *w = b->w;
  double size = 1e-300;
  for (long p = 0; p < b->g->particle_count; p++)
    for (int d = 0; d < 3; d++)
      size = fmax(size, fabs(u[3 * p + d]) / (d < 2 ? b->s : 1));
  for (int side = 1; side >= -1; side -= 2) {
    for (long p = 0; p < b->g->particle_count; p++)
      for (int d = 0; d < 3; d++)
        w->body->displacement[d][b->g->particle_site[p]] = side * 1e-6 / size * u[3 * p + d];
    sweep_observe(w);
    for (long p = 0; p < b->g->particle_count; p++)
      for (int d = 0; d < 3; d++) {
        const double half = -side * w->body->force[d][b->g->particle_site[p]] * size / 2e-6;
        product[3 * p + d] = side > 0 ? half : product[3 * p + d] + half;
      }
  }
}

static double dot(const double *a, const double *b, long count) {
  double sum = 0;
  for (long k = 0; k < count; k++)
    sum += a[k] * b[k];
  return sum;
}

/* Entries of held particles (their rotations stay free) to zero; the rest by the inverse of a
 * typical stiffness. */
static void precondition(const cantilever *b, const double *r, double *z) {
  for (long k = 0; k < b->unknowns; k++) {
    const bool fixed = k % 3 < 2 && b->held[k / 3];
    z[k] = fixed ? 0 : r[k] / (k % 3 < 2 ? 1 : 0.05 * b->s * b->s);
  }
}

/* K u = load by conjugate gradients, from the exact solution's values at the held particles.
 * Returns the iterations. */
static int solve(cantilever *b, double *u) {
  const long n = b->unknowns;
  double *r = calloc((size_t)n, sizeof *r), *z = calloc((size_t)n, sizeof *z);
  double *p = calloc((size_t)n, sizeof *p), *Kp = calloc((size_t)n, sizeof *Kp);
  stiffness_times(b, u, Kp);
  for (long k = 0; k < n; k++)
    r[k] = b->load[k] - Kp[k];
  precondition(b, r, z);
  memcpy(p, z, (size_t)n * sizeof *p);
  double rz = dot(r, z, n);
  const double target = 1e-16 * rz; /* residual by eight digits */
  int iterations = 0;
  while (rz > target && iterations < 20000) {
    stiffness_times(b, p, Kp);
    for (long k = 0; k < n; k++)
      if (k % 3 < 2 && b->held[k / 3]) Kp[k] = 0;
    const double step = rz / dot(p, Kp, n);
    for (long k = 0; k < n; k++) {
      u[k] += step * p[k];
      r[k] -= step * Kp[k];
    }
    precondition(b, r, z);
    const double before = rz;
    rz = dot(r, z, n);
    for (long k = 0; k < n; k++)
      p[k] = z[k] + rz / before * p[k];
    iterations++;
  }
  assert_true(rz <= target);
  free(r);
  free(z);
  free(p);
  free(Kp);
  return iterations;
}

/* Mean deflection of the loaded columns over the exact one, less 1. */
static double tip_error(law_case *beam_law, int row_count) {
  cantilever b;
  open_cantilever(&b, beam_law, row_count);
  set_ends(&b);
  double *u = calloc((size_t)b.unknowns, sizeof *u);
  for (long p = 0; p < b.g->particle_count; p++)
    if (b.held[p])
      exact(b.length, b.g->x[b.g->particle_site[p]], b.g->y[b.g->particle_site[p]], &u[3 * p],
            &u[3 * p + 1]);
  const int iterations = solve(&b, u);
  double sum = 0, expected = 0, loaded = 0;
  for (long p = 0; p < b.g->particle_count; p++) {
    if (b.load[3 * p + 1] == 0) continue;
    double ux, uy;
    exact(b.length, b.g->x[b.g->particle_site[p]], b.g->y[b.g->particle_site[p]], &ux, &uy);
    sum += u[3 * p + 1];
    expected += uy;
    loaded++;
  }
  print_message("cantilever, %2d rows, spacing %.3f mm: deflection %.5f of theory's %.4g mm (%ld "
                "particles, %d "
                "iterations)\n",
                row_count, 1e3 * b.s, sum / expected, 1e3 * expected, b.g->particle_count,
                iterations);
  free(u);
  close_cantilever(&b);
  return sum / expected - 1;
}

/* The outermost rows lack the bonds to a further row, so that the beam is too soft by O(s/depth):
   first order. What first order leaves, after extrapolation, is of second order in s/depth = 0.036:
   1e-3. */
static void a_cantilever_converges_to_theory(void **state) {
  (void)state;
  static const int row_counts[] = {8, 16, 32};
  law_case c;
  double error[3];
  assert_true(law_case_open(&c, "mplm_bilinear"));
  *law_case_value(&c, "nu") = ratio;
  *law_case_value(&c, "S_t") = 0.5;
  for (int k = 0; k < 3; k++)
    error[k] = tip_error(&c, row_counts[k]);
  law_case_close(&c);
  const double extrapolated = 2 * error[2] - error[1];
  print_message("cantilever: orders %.2f, %.2f; extrapolated error %.1e\n",
                log2(error[0] / error[1]), log2(error[1] / error[2]), extrapolated);
  assert_true(fabs(log2(error[0] / error[1]) - 1) < 0.1);
  assert_true(fabs(log2(error[1] / error[2]) - 1) < 0.1);
  assert_true(error[2] > 0 && error[2] < 0.02);
  assert_true(fabs(extrapolated) < 1e-3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(energy_balances_better_with_smaller_steps),
      cmocka_unit_test(a_cantilever_converges_to_theory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
