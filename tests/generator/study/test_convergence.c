/* Convergence of manufactured sequences: order, limit, bar and verdict. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "generator/study/convergence.h"
#include "runtime/base/random_number.h"

enum { MOST = 8, RUNS = 6 };

static void assert_near(double got, double exact, double tolerance) {
  if (!(fabs(got - exact) <= tolerance)) fail_msg("%.17g, not %.17g", got, exact);
}

/* As many sizes as there are, one value each; in the order given. */
static convergence found(int count, const double *sizes, const double *values) {
  convergence_level levels[MOST];
  char names[MOST][32];
  convergence c;
  for (int k = 0; k < count; k++) {
    snprintf(names[k], sizeof names[k], "%g mm", sizes[k]);
    levels[k] =
        (convergence_level){.size = sizes[k], .name = names[k], .values = &values[k], .count = 1};
  }
  convergence_find(levels, count, &c);
  return c;
}

static void refused(int count, const double *sizes, const double *values, const char *part) {
  const convergence c = found(count, sizes, values);
  if (c.converged || !strstr(c.reason, part))
    fail_msg("%d, `%s`, not `%s`", c.converged, c.reason, part);
  assert_true(isnan(c.value) && isnan(c.error));
}

static void orders_of_any_ratio_are_recovered(void **unused) {
  (void)unused;
  const double orders[] = {1, 1.5, 2, 0.7},
               ratios[][4] = {{4, 2, 1, 0.5}, {5, 3, 2.5, 0.3}, {0.7, 11, 2, 3}};
  for (int o = 0; o < 4; o++)
    for (int r = 0; r < 3; r++)
      for (int count = 3; count <= 4; count++) {
        double values[4];
        for (int k = 0; k < count; k++)
          values[k] = 57.3 - 4.1 * pow(ratios[r][k], orders[o]);
        const convergence c = found(count, ratios[r], values);
        assert_true(c.converged && !*c.reason);
        assert_near(c.order, orders[o], 1e-9);
        assert_near(c.value, 57.3, 1e-9 * 57.3);
        assert_true(c.scatter == 0 && c.error > 0);
      }
}

/* With nothing else the bar is 1.25 times what is left at the finest size. */
static void the_bar_is_the_grid_convergence_index(void **unused) {
  (void)unused;
  const double sizes[] = {1, 2, 4}, values[] = {10.25, 11, 14}; /* 10 + h^2/4 */
  const convergence c = found(3, sizes, values);
  assert_near(c.order, 2, 1e-12);
  assert_near(c.error, 1.25 * 0.25, 1e-12);
  const double cubic[] = {11, 18, 74}; /* 10 + h^3: the limit of order 2 is not far enough down */
  const convergence d = found(3, sizes, cubic);
  assert_true(d.converged && fabs(d.order - 3) < 1e-9);
  assert_true(fabs(d.value - 10) < d.error);
}

static void what_does_not_settle_is_said(void **unused) {
  (void)unused;
  const double sizes[] = {20, 10, 5, 2.5};
  refused(3, sizes, (const double[]){60, 57, 58},
          "changes sign between sizes (+1 from 10 mm to 5 mm)");
  refused(4, sizes, (const double[]){2, 0.5, 1.25, 0.875}, "oscillates");
  refused(3, sizes, (const double[]){60, 57, 53}, "do not fall: order -0.42");
  refused(3, sizes, (const double[]){60, 57, 54}, "do not fall: order");
  refused(3, sizes, (const double[]){60, 57, 54.3}, "too slowly for a limit: order 0.15");
  refused(3, sizes, (const double[]){60, 57, 56.99}, "order 8.2, more than 4");
  refused(3, sizes, (const double[]){60, 57, 57}, "more than 4");
  refused(2, sizes, (const double[]){60, 57}, "2 sizes of 3 at least");
  refused(1, sizes, (const double[]){60}, "1 size of 3 at least");
  refused(0, sizes, (const double[]){60}, "0 sizes");
  refused(3, sizes, (const double[]){60, NAN, 57}, "a run at 10 mm has no value");
  refused(3, sizes, (const double[]){60, 57, INFINITY}, "a run at 5 mm has no value");
  refused(3, (const double[]){20, 10, 20}, (const double[]){60, 59, 57},
          "20 mm and 20 mm are the same size");
  refused(3, (const double[]){20, 0, 5}, (const double[]){60, 59, 57}, "0 mm is no size");
}

static void exact_answers_are_converged(void **unused) {
  (void)unused;
  const double sizes[] = {20, 10, 5}, same[] = {7e9, 7e9, 7e9},
               nearly[] = {7e9, 7.0000000003e9, 7e9};
  convergence c = found(3, sizes, same);
  assert_true(c.converged && isnan(c.order) && c.value == 7e9 && c.error == 0);
  assert_non_null(strstr(c.reason, "order is unknown"));
  c = found(3, sizes, nearly);
  assert_true(c.converged && isnan(c.order) && c.error >= 0.3);
  c = found(3, sizes, (const double[]){0, 0, 0});
  assert_true(c.converged && c.value == 0);
}

static void sizes_may_be_extreme(void **unused) {
  (void)unused;
  const double scales[] = {1e-300, 1e-9, 1, 1e9, 1e300};
  for (int s = 0; s < 5; s++) {
    const double h[] = {scales[s], 10 * scales[s], 2 * scales[s]};
    const convergence c = found(3, h, (const double[]){-1e-12 * 1, -1e-12 * 100, -1e-12 * 4});
    assert_true(c.converged);
    assert_near(c.order, 2, 1e-9);
    assert_true(fabs(c.value) < 1e-21);
  }
  const double wide[] = {1, 1e3, 1e6}, values[] = {3 + 1e-3, 4, 1003};
  const convergence c = found(3, wide, values);
  assert_true(c.converged && fabs(c.order - 1) < 1e-9 && fabs(c.value - 3) < 1e-9);
}

/* --- random cases ----------------------------------------------------------------------------- */

typedef struct random_case {
  double sizes[MOST], values[MOST][RUNS], exact;
  int count, runs;
} random_case;

static double uniform(uint64_t *state, double low, double high) {
  return low + (high - low) * random_unit(random_mix((*state)++));
}

static double normal(uint64_t *state) {
  const double u = uniform(state, 0, 1), v = uniform(state, 0, 1);
  return sqrt(-2 * log(u)) * cos(2 * acos(-1) * v);
}

static convergence found_in(const random_case *r) {
  convergence_level levels[MOST];
  convergence c;
  for (int k = 0; k < r->count; k++)
    levels[k] = (convergence_level){
        .size = r->sizes[k], .name = "h", .values = r->values[k], .count = r->runs};
  convergence_find(levels, r->count, &c);
  return c;
}

/* Order p and, up to `next` of it at the coarsest size, order p + 1; with noise. */
static random_case drawn(uint64_t *state, double next, double noise, int runs) {
  static const double orders[] = {1, 1.5, 2};
  random_case r = {
      .exact = uniform(state, -5, 5), .count = (int)uniform(state, 3, 6), .runs = runs};
  const double p = orders[(int)uniform(state, 0, 3)], size = uniform(state, 0.5, 2);
  const double more = uniform(state, -next, next);
  double h = 1;
  for (int k = 0; k < r.count; k++) {
    r.sizes[k] = 17 * h;
    for (int i = 0; i < runs; i++)
      r.values[k][i] = r.exact + size * (pow(h, p) + more * pow(h, p + 1)) + noise * normal(state);
    h /= uniform(state, 1.4, 2.2);
  }
  return r;
}

typedef struct tally {
  int converged, inside;
  double error, miss; /* sums */
} tally;

static tally tally_of(const char *what, int cases, double next, double noise, int runs) {
  uint64_t state = 7;
  tally t = {0};
  for (int k = 0; k < cases; k++) {
    const random_case r = drawn(&state, next, noise, runs);
    const convergence c = found_in(&r);
    if (!c.converged) continue;
    t.converged++;
    t.inside += fabs(c.value - r.exact) <= c.error;
    t.error += c.error;
    t.miss += fabs(c.value - r.exact);
  }
  printf("  %-38s %5d of %d converged, %5d hold the truth; bar %.1f times the miss\n", what,
         t.converged, cases, t.inside, t.error / t.miss);
  return t;
}

static void the_bar_holds_the_truth(void **unused) {
  (void)unused;
  const tally higher = tally_of("higher order up to 0.3", 3000, 0.3, 0, 1);
  assert_true(higher.converged > 2900 && higher.inside == higher.converged);
  const tally noisy = tally_of("noise 1 % of the error, six seeds", 3000, 0.1, 0.01, RUNS);
  assert_true(noisy.converged > 2900 && noisy.inside >= 0.995 * noisy.converged);
}

/* --- orientations ----------------------------------------------------------------------------- */

/* Each settles, to a limit of its own: the mean does, too, and the bar has the spread. */
static void orientations_widen_the_bar(void **unused) {
  (void)unused;
  const double sizes[] = {20, 10, 5}, offset[] = {-1, 0, 1};
  random_case r = {.count = 3, .runs = 3};
  for (int k = 0; k < 3; k++) {
    r.sizes[k] = sizes[k];
    for (int i = 0; i < 3; i++)
      r.values[k][i] = 57 + 0.01 * sizes[k] * sizes[k] + offset[i];
  }
  const convergence c = found_in(&r);
  assert_true(c.converged);
  assert_near(c.order, 2, 1e-9);
  assert_near(c.value, 57, 1e-9);
  assert_near(c.scatter, 4.302652729911275 / sqrt(3), 1e-9);
  assert_near(c.discretisation, 1.25 * 0.25, 1e-9);
  assert_near(c.error, hypot(c.scatter, c.discretisation), 1e-12);
}

/* Three orientations with limits of their own, each with four seeds that differ little: the twelve
   runs are no twelve draws of orientations, however many seeds there are. */
static void runs_that_share_an_orientation(void **unused) {
  (void)unused;
  static const int orientation[] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2},
                   seed[] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
  const int *const shared[] = {orientation, seed};
  const double sizes[] = {20, 10, 5}, seeds[] = {-1e-3, 2e-3, 1e-3, -2e-3};
  double values[3][12];
  convergence_level levels[3];
  for (int k = 0; k < 3; k++) {
    for (int i = 0; i < 12; i++)
      values[k][i] = 57 + 0.01 * sizes[k] * sizes[k] + orientation[i] - 1 + seeds[seed[i]];
    levels[k] = (convergence_level){.size = sizes[k], .values = values[k], .count = 12};
  }
  convergence alone, crossed;
  convergence_find(levels, 3, &alone);
  levels[0].shared = shared;
  levels[0].shared_count = 2;
  convergence_find(levels, 3, &crossed);
  assert_true(alone.converged && crossed.converged);
  assert_near(crossed.value, 57, 1e-9);
  assert_near(crossed.scatter, 4.302652729911275 / sqrt(3), 1e-9);
  assert_true(alone.scatter < 0.3 * crossed.scatter);
}

static void scatter_as_large_as_the_changes(void **unused) {
  (void)unused;
  const convergence_level levels[] = {
      {.size = 5, .name = "5 mm", .values = (const double[]){57.2, 56.1, 57.9}, .count = 3},
      {.size = 20, .name = "20 mm", .values = (const double[]){60, 60.1, 59.8}, .count = 3},
      {.size = 10, .name = "10 mm", .values = (const double[]){56.5, 58.2, 57.0}, .count = 3}};
  convergence c;
  convergence_find(levels, 3, &c);
  assert_false(c.converged);
  assert_non_null(strstr(c.reason, "scatter as much as the sizes differ: from 10 mm to 5 mm"));
  convergence_level uneven[] = {levels[0], levels[1], levels[2]};
  uneven[1].count = 2;
  convergence_find(uneven, 3, &c);
  assert_non_null(strstr(c.reason, "5 mm has 3 values and 20 mm has 2"));
  uneven[1].count = 0;
  convergence_find(uneven, 3, &c);
  assert_non_null(strstr(c.reason, "a run at 20 mm has no value"));
}

/* Five sizes with a wiggle: the fit goes on, its bar is wider. */
static void noise_of_many_sizes_is_fitted(void **unused) {
  (void)unused;
  const double sizes[] = {20, 14, 10, 7, 5}, clean[] = {61, 58.96, 58, 57.49, 57.25},
               noisy[] = {61, 58.8, 58.1, 57.4, 57.45};
  const convergence c = found(5, sizes, clean), n = found(5, sizes, noisy);
  assert_true(c.converged && n.converged);
  assert_near(c.order, 2, 1e-2);
  assert_true(fabs(n.value - 57) < n.error && n.error > 1.5 * c.error);
  refused(5, sizes, (const double[]){57.6, 57.3, 57.9, 57.5, 57.0}, "oscillates");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(orders_of_any_ratio_are_recovered),
      cmocka_unit_test(the_bar_is_the_grid_convergence_index),
      cmocka_unit_test(what_does_not_settle_is_said),
      cmocka_unit_test(exact_answers_are_converged),
      cmocka_unit_test(sizes_may_be_extreme),
      cmocka_unit_test(the_bar_holds_the_truth),
      cmocka_unit_test(orientations_widen_the_bar),
      cmocka_unit_test(runs_that_share_an_orientation),
      cmocka_unit_test(scatter_as_large_as_the_changes),
      cmocka_unit_test(noise_of_many_sizes_is_fitted),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
