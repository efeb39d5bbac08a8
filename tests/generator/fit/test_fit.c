/* Fits: residuals of curves, the search, and how well the data tell the parameters, against closed
   forms of linear problems, manufactured curves and counted intervals. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "generator/fit/fit_curve.h"
#include "generator/fit/fit_descent.h"
#include "generator/fit/fit_search.h"
#include "generator/fit/fit_uncertainty.h"
#include "runtime/base/random_number.h"

static void assert_near(double got, double exact, double tolerance) {
  if (!(fabs(got - exact) <= tolerance)) fail_msg("%.17g, not %.17g", got, exact);
}

/* --- residuals of a curve --------------------------------------------------------------------- */

/* The curve comes back from x = 2 to 1.5: at 2 it is first 1, at 2.5 on the way from there to 4. */
static void first_time_counts_and_ends_stand(void **unused) {
  (void)unused;
  const double x[] = {1, 2, 1.5, 4}, y[] = {0, 1, 3, 5.5}, nan = NAN;
  const double at[] = {0.5, 1.25, nan, 2, 2.5, 9}, m[] = {-8, 0, 0, 0, 0, 0};
  const curve_points measured = {at, m, m, 6};
  fit_curve c;
  double r[5];
  assert_true(fit_curve_begin(&c, &measured, 2));
  assert_int_equal(c.count, 5);
  fit_curve_residuals(&c, x, y, 4, r);
  const double factor = sqrt(2) / (8 * sqrt(5)), exact[] = {8, 0.25, 1, 4, 5.5};
  for (int k = 0; k < 5; k++)
    assert_near(r[k], factor * exact[k], 1e-15);
  fit_curve_residuals(&c, &nan, y, 1, r);
  assert_near(r[4], 10 * sqrt(2) / sqrt(5), 1e-14); /* no number at all: as a run that failed */
  fit_curve_failed(&c, r);
  assert_near(r[0], 10 * sqrt(2) / sqrt(5), 1e-14);
  fit_curve_free(&c);
}

static void curves_may_go_down_in_x(void **unused) {
  (void)unused;
  const double x[] = {0, -1, 0.5, -2}, y[] = {0, 1, 9, 2}, at[] = {-0.5, -1.5}, m[] = {1, 1};
  const curve_points measured = {at, m, m, 2};
  fit_curve c;
  double r[2];
  assert_true(fit_curve_begin(&c, &measured, 1));
  fit_curve_residuals(&c, x, y, 4, r);
  assert_near(r[0] * sqrt(2), -0.5, 1e-15);
  assert_near(r[1] * sqrt(2), 2 + 7.0 / 5 - 1, 1e-14);
  fit_curve_free(&c);
}

/* Widths 2, 4, 0.1, of mean 6.1/3: the narrowest counts as one of a tenth of that. */
static void a_band_weighs_by_its_width(void **unused) {
  (void)unused;
  const double at[] = {0, 1, 2}, low[] = {1, 6, 4.95}, high[] = {3, 10, 5.05}, y[] = {0, 0, 0};
  const curve_points band = {at, low, high, 3}, nothing = {at, y, y, 3}, none = {at, low, high, 0};
  fit_curve c;
  double r[3];
  assert_true(fit_curve_begin(&c, &band, 1));
  fit_curve_residuals(&c, at, y, 3, r);
  const double mean = 6.1 / 3, all = 1 / (10 * sqrt(3));
  assert_near(r[0], -2 * all * mean / 2, 1e-14);
  assert_near(r[1], -8 * all * mean / 4, 1e-14);
  assert_near(r[2], -5 * all / 0.1, 1e-14);
  fit_curve_free(&c);
  assert_false(fit_curve_begin(&c, &nothing, 1));
  assert_false(fit_curve_begin(&c, &none, 1));
}

/* --- problems --------------------------------------------------------------------------------- */

enum { POINTS = 40 };

typedef double curve_law(const double *p, double x);

typedef struct model {
  curve_law *law;
  double data[POINTS];
  const fit_parameter *parameter;
  int parameters, calls, computed, largest_batch;
  int fail_at; /* call that fails; 0: none */
} model;

static double place_of(int k) {
  return 0.05 + 0.1 * k;
}

/* Points out of the bounds fail the test. */
static bool evaluate(void *context, const double *points, int count, double *residuals) {
  model *m = context;
  m->computed += count;
  m->largest_batch = count > m->largest_batch ? count : m->largest_batch;
  for (int k = 0; k < count; k++) {
    const double *p = &points[k * m->parameters];
    for (int i = 0; i < m->parameters; i++)
      assert_true(p[i] >= m->parameter[i].lower && p[i] <= m->parameter[i].upper);
    for (int i = 0; i < POINTS; i++)
      residuals[k * POINTS + i] = m->law(p, place_of(i)) - m->data[i];
  }
  return ++m->calls != m->fail_at;
}

static model model_of(curve_law *law, const fit_parameter *parameter, int parameters,
                      const double *truth) {
  model m = {.law = law, .parameter = parameter, .parameters = parameters};
  for (int k = 0; k < POINTS; k++)
    m.data[k] = law(truth, place_of(k));
  return m;
}

static double normal(uint64_t *state) {
  const double u = random_unit(random_mix((*state)++)), v = random_unit(random_mix((*state)++));
  return sqrt(-2 * log(u)) * cos(2 * acos(-1) * v);
}

static void add_noise(model *m, double sigma, uint64_t seed) {
  uint64_t state = 1000 * seed;
  for (int k = 0; k < POINTS; k++)
    m->data[k] += sigma * normal(&state);
}

static fit_problem problem_of(model *m, fit_method method, double tolerance) {
  return (fit_problem){.parameter = m->parameter,
                       .parameters = m->parameters,
                       .residuals = POINTS,
                       .evaluate = evaluate,
                       .context = m,
                       .method = method,
                       .tolerance = tolerance,
                       .most_runs = 5000};
}

static double line(const double *p, double x) {
  return p[0] + p[1] * x;
}

/* Rises, has a peak of p[0] at p[1], and softens. */
static double softening(const double *p, double x) {
  return p[0] * x / p[1] * exp(1 - x / p[1]);
}

static double softening_of_three(const double *p, double x) {
  const double z = x / p[1];
  return p[0] * (z < 1 ? z * (2 - z) : exp(-(z - 1) / p[2]));
}

/* --- the search ------------------------------------------------------------------------------- */

static const fit_parameter peak_and_place[] = {{"f_t", 1, 5, 1.7}, {"w", 0.4, 3, 2.2}};

static void exact_parameters_come_back(void **unused) {
  (void)unused;
  static const fit_parameter three[] = {{"f_t", 1, 5, 2}, {"w", 0.4, 3, 1.9}, {"G", 0.2, 4, 3}};
  const double truth[] = {3.1, 1.13, 0.87};
  for (int parameters = 2; parameters <= 3; parameters++) {
    int runs[2];
    for (int method = FIT_BOBYQA; method <= FIT_NELDER_MEAD; method++) {
      const bool two = parameters == 2;
      model m = model_of(two ? softening : softening_of_three, two ? peak_and_place : three,
                         parameters, truth);
      const fit_problem p = problem_of(&m, (fit_method)method, 1e-9);
      fit_found f;
      fit_search(&p, &f);
      assert_true(f.end == FIT_FOUND && f.runs == m.computed);
      assert_int_equal(m.largest_batch, method == FIT_BOBYQA ? 2 * parameters + 1 : parameters + 1);
      for (int i = 0; i < parameters; i++)
        assert_near(f.best[i] / truth[i], 1, 1e-6);
      assert_true(f.squares < 1e-12);
      runs[method] = f.runs;
      fit_found_free(&f);
    }
    printf("  %d parameters to 1e-6: BOBYQA %d runs, Nelder and Mead %d\n", parameters, runs[0],
           runs[1]);
    assert_true(runs[FIT_BOBYQA] < runs[FIT_NELDER_MEAD]);
  }
}

static double decay(const double *p, double x) {
  return exp(-p[0] * x);
}

static void one_parameter_is_enough(void **unused) {
  (void)unused;
  static const fit_parameter one[] = {{"a", 0, 10, 10}};
  const double truth[] = {3.25};
  for (int method = FIT_BOBYQA; method <= FIT_NELDER_MEAD; method++) {
    model m = model_of(decay, one, 1, truth);
    const fit_problem p = problem_of(&m, (fit_method)method, 1e-10);
    fit_found f;
    fit_uncertainty u;
    fit_search(&p, &f);
    assert_true(f.end == FIT_FOUND);
    assert_near(f.best[0], 3.25, 1e-7);
    assert_true(fit_uncertainty_find(&p, &f, &u));
    assert_true(u.verdict[0] == FIT_TOLD && u.condition == 1 && u.runs == 2);
    fit_found_free(&f);
  }
}

/* At bounds, close to them, and where the best lies on one. */
static void starts_and_bounds_are_kept(void **unused) {
  (void)unused;
  const double truth[] = {3.1, 1.13};
  const double starts[][2] = {{1, 3}, {5, 0.4}, {1.001, 2.99999}, {1, 1}};
  for (int k = 0; k < 4; k++) {
    const fit_parameter near[] = {{"f_t", 1, 5, starts[k][0]}, {"w", 0.4, 3, starts[k][1]}};
    model m = model_of(softening, near, 2, truth);
    const fit_problem p = problem_of(&m, FIT_BOBYQA, 1e-9);
    fit_found f;
    fit_search(&p, &f);
    assert_true(f.end == FIT_FOUND);
    assert_near(f.best[0] / truth[0], 1, 1e-6);
    fit_found_free(&f);
  }
  const fit_parameter out[] = {{"f_t", 1, 2.9, 2}, {"w", 0.4, 3, 1}};
  model m = model_of(softening, out, 2, truth);
  const fit_problem p = problem_of(&m, FIT_BOBYQA, 1e-7);
  fit_found f;
  fit_uncertainty u;
  char text[256];
  fit_search(&p, &f);
  assert_true(f.end == FIT_FOUND && f.best[0] == 2.9);
  assert_true(fit_uncertainty_find(&p, &f, &u));
  assert_true(u.verdict[0] == FIT_AT_UPPER && u.verdict[1] == FIT_TOLD && u.runs == 4);
  assert_true(isnan(u.error[0]) && isnan(u.correlation[0][1]) && u.error[1] > 0);
  fit_verdict_text(&p, &u, 0, text, sizeof text);
  assert_string_equal(text, "at its upper bound");
  fit_verdict_text(&p, &u, 1, text, sizeof text);
  assert_string_equal(text, "");
  fit_found_free(&f);
}

/* A start that fits is the answer, to the bit. */
static void a_start_that_fits_stays(void **unused) {
  (void)unused;
  const fit_parameter exact[] = {{"f_t", 1, 5.3, 1.0001}, {"w", 0.4, 3, 1.13}};
  const double truth[] = {1.0001, 1.13};
  model m = model_of(softening, exact, 2, truth);
  const fit_problem p = problem_of(&m, FIT_BOBYQA, 1e-4);
  fit_found f;
  fit_search(&p, &f);
  assert_true(f.squares == 0 && f.best[0] == truth[0] && f.best[1] == truth[1]);
  fit_found_free(&f);
}

static double broken_curve(const double *p, double x) {
  return p[0] > 2 ? NAN : p[0] * x + p[1];
}

static void what_fails_ends_the_search(void **unused) {
  (void)unused;
  const double truth[] = {3.1, 1.13};
  for (int call = 1; call <= 6; call++) {
    model m = model_of(softening, peak_and_place, 2, truth);
    m.fail_at = call;
    const fit_problem p = problem_of(&m, FIT_BOBYQA, 1e-7);
    fit_found f;
    fit_uncertainty u;
    fit_search(&p, &f);
    assert_true(f.end == FIT_BROKEN && m.calls == call);
    assert_true((f.residuals == NULL) == (call == 1));
    m.fail_at = m.calls + 1;
    if (f.residuals) assert_false(fit_uncertainty_find(&p, &f, &u));
    fit_found_free(&f);
  }
  model m = model_of(broken_curve, peak_and_place, 2, (const double[]){1.5, 1});
  const fit_problem p = problem_of(&m, FIT_BOBYQA, 1e-7);
  fit_found f;
  fit_search(&p, &f);
  assert_true(f.end == FIT_BROKEN);
  fit_found_free(&f);
}

/* The same runs each time; with fewer allowed the search has the same beginning. */
static void the_search_is_the_same_each_time(void **unused) {
  (void)unused;
  const double truth[] = {3.1, 1.13};
  fit_found f[3];
  for (int k = 0; k < 3; k++) {
    model m = model_of(softening, peak_and_place, 2, truth);
    add_noise(&m, 0.05, 3);
    fit_problem p = problem_of(&m, FIT_BOBYQA, 1e-8);
    if (k == 2) p.most_runs = 11;
    fit_search(&p, &f[k]);
    assert_int_equal(f[k].runs, m.computed);
  }
  assert_memory_equal(f[0].best, f[1].best, 2 * sizeof(double));
  assert_true(f[0].runs == f[1].runs && f[0].squares == f[1].squares);
  assert_true(f[2].end == FIT_LIMIT && f[2].runs == 11 && f[2].squares > f[0].squares);
  for (int k = 0; k < 3; k++)
    fit_found_free(&f[k]);
}

/* --- the descent ------------------------------------------------------------------------------ */

static fit_found found_at(const fit_problem *p, double a, double b) {
  fit_found f = {.end = FIT_FOUND, .best = {a, b}, .residuals = malloc(POINTS * sizeof(double))};
  assert_true(p->evaluate(p->context, f.best, 1, f.residuals));
  for (int k = 0; k < POINTS; k++)
    f.squares += f.residuals[k] * f.residuals[k];
  return f;
}

/* A linear problem takes one step. Where the line is cut off by a bound, the other parameter is
   the closed form's with the first one held there. */
static void a_line_takes_one_step(void **unused) {
  (void)unused;
  const double truth[] = {1, 2};
  double mean = 0;
  for (int held = 0; held < 2; held++) {
    const fit_parameter box[] = {{"a", -10, 10, 4}, {"b", -3, held ? 1.5 : 7, 0}};
    model m = model_of(line, box, 2, truth);
    const fit_problem p = problem_of(&m, FIT_BOBYQA, 1e-4);
    fit_found f = found_at(&p, 4, 0);
    fit_descend(&p, &f);
    assert_true(f.end == FIT_FOUND && f.runs == m.computed - 1);
    for (int k = 0; k < POINTS && held; k++)
      mean += place_of(k) / POINTS;
    assert_near(f.best[1], held ? 1.5 : 2, 1e-12);
    assert_near(f.best[0], 1 + 0.5 * mean, 1e-12);
    if (!held) assert_true(f.squares < 1e-24);
    fit_found_free(&f);
  }
}

static double rough(const double *p, double x) {
  return softening(p, x) + 0.03 * sin(40 * (p[0] + p[1]) + 9 * x);
}

/* Peak and place make up for each other along a valley, and swings make its floor rough: the search
   stops on the way. */
static void rough_valleys_are_left(void **unused) {
  (void)unused;
  const double truth[] = {3.1, 1.13};
  double searched = 0, descended = 0;
  for (int start = 0; start < 9; start++) {
    const fit_parameter box[] = {{"f_t", 1, 5, 1.2 + 0.4 * start},
                                 {"w", 0.4, 3, 2.9 - 0.2 * start}};
    model m = model_of(rough, box, 2, truth);
    const fit_problem p = problem_of(&m, FIT_BOBYQA, 1e-3);
    fit_found f;
    fit_search(&p, &f);
    searched = pl_fmax(searched, f.squares);
    const double before = f.squares;
    fit_descend(&p, &f);
    assert_true(f.end == FIT_FOUND && f.runs == m.computed && f.squares <= before);
    descended = pl_fmax(descended, f.squares);
    fit_found_free(&f);
  }
  printf("  worst of nine starts: sum of squares %.3g searched, %.3g descended\n", searched,
         descended);
  assert_true(descended < 0.1 * searched);
}

static void a_descent_keeps_to_its_runs(void **unused) {
  (void)unused;
  const double truth[] = {3.1, 1.13};
  model m = model_of(softening, peak_and_place, 2, truth);
  fit_problem p = problem_of(&m, FIT_BOBYQA, 1e-4);
  p.most_runs = 17;
  fit_found f = found_at(&p, 2.5, 1.5);
  fit_descend(&p, &f);
  assert_true(f.runs == 16 && m.computed == 17 && f.squares > 0);
  fit_found_free(&f);
  for (int call = 2; call <= 4; call++) {
    m = model_of(softening, peak_and_place, 2, truth);
    m.fail_at = call;
    f = found_at(&p, 2.5, 1.5);
    fit_descend(&p, &f);
    assert_true(f.end == FIT_BROKEN && m.calls == call);
    fit_found_free(&f);
  }
}

/* --- uncertainty ------------------------------------------------------------------------------ */

/* A straight line: the textbook's formulas. */
static void a_line_has_its_closed_form(void **unused) {
  (void)unused;
  static const fit_parameter box[] = {{"a", -10, 10, 4}, {"b", -3, 7, 0}};
  const double truth[] = {1, 2}, t = 2.024394164575136; /* 38 degrees of freedom */
  model m = model_of(line, box, 2, truth);
  add_noise(&m, 0.1, 1);
  double x = 0, y = 0, xx = 0, xy = 0, squares = 0;
  for (int k = 0; k < POINTS; k++)
    x += place_of(k) / POINTS, y += m.data[k] / POINTS;
  for (int k = 0; k < POINTS; k++) {
    xx += (place_of(k) - x) * (place_of(k) - x);
    xy += (place_of(k) - x) * (m.data[k] - y);
  }
  const double b = xy / xx, a = y - b * x;
  for (int k = 0; k < POINTS; k++)
    squares += pow(m.data[k] - a - b * place_of(k), 2);
  const double s = sqrt(squares / (POINTS - 2));
  const double a_error = s * sqrt(1.0 / POINTS + x * x / xx), b_error = s / sqrt(xx);
  const fit_problem p = problem_of(&m, FIT_BOBYQA, 1e-9);
  fit_found f;
  fit_uncertainty u;
  fit_search(&p, &f);
  assert_true(fit_uncertainty_find(&p, &f, &u));
  assert_near(f.best[0], a, 1e-6);
  assert_near(f.best[1], b, 1e-6);
  assert_near(f.squares, squares, 1e-9);
  assert_near(u.sigma, s, 1e-9);
  assert_near(u.error[0], a_error, 1e-9);
  assert_near(u.error[1], b_error, 1e-9);
  assert_near(u.upper[0] - f.best[0], t * a_error, 1e-9);
  assert_near(f.best[1] - u.lower[1], t * b_error, 1e-9);
  assert_near(u.correlation[0][1], -x / sqrt(x * x + xx / POINTS), 1e-9);
  assert_near(u.sensitivity[0], 20 * sqrt(POINTS), 1e-9);
  assert_true(u.correlation[0][0] == 1 && u.verdict[0] == FIT_TOLD && u.verdict[1] == FIT_TOLD);
  assert_true(u.weak == 0 && u.runs == 4);
  fit_found_free(&f);
}

/* How often the 95 % interval holds the truth: 475 of 500, give or take 10 twice. */
static void intervals_hold_the_truth(void **unused) {
  (void)unused;
  const double truth[] = {3.1, 1.13};
  int inside[2] = {0};
  for (uint64_t seed = 1; seed <= 500; seed++) {
    model m = model_of(softening, peak_and_place, 2, truth);
    add_noise(&m, 0.15, seed);
    const fit_problem p = problem_of(&m, FIT_BOBYQA, 1e-7);
    fit_found f;
    fit_uncertainty u;
    fit_search(&p, &f);
    assert_true(fit_uncertainty_find(&p, &f, &u));
    for (int i = 0; i < 2; i++)
      inside[i] += u.lower[i] <= truth[i] && truth[i] <= u.upper[i];
    fit_found_free(&f);
  }
  printf("  95 %% intervals that hold the truth: %d and %d of 500\n", inside[0], inside[1]);
  for (int i = 0; i < 2; i++)
    assert_true(inside[i] >= 456 && inside[i] <= 494);
}

static double product(const double *p, double x) {
  return p[0] / p[1] * exp(-x) + p[2];
}

static double deaf(const double *p, double x) {
  return p[0] * x;
}

static void what_the_data_do_not_tell_is_said(void **unused) {
  (void)unused;
  static const fit_parameter pair[] = {{"a", 1, 5, 2}, {"b", 1, 5, 4}, {"c", -1, 1, 0.5}};
  const double truth[] = {3, 2, 0.2};
  char text[256];
  for (int noise = 0; noise < 2; noise++) {
    model m = model_of(product, pair, 3, truth);
    add_noise(&m, 0.01 * noise, 5);
    const fit_problem p = problem_of(&m, FIT_BOBYQA, 1e-7);
    fit_found f;
    fit_uncertainty u;
    fit_search(&p, &f);
    const double ratio = f.best[0] / f.best[1];
    assert_near(ratio, 1.5, 0.05);
    /* the search ends anywhere in the valley: at a bound, or inside of it */
    for (int inside = 0; inside < 2; inside++) {
      f.best[0] = inside ? 3 : 5;
      f.best[1] = f.best[0] / ratio;
      assert_true(fit_uncertainty_find(&p, &f, &u));
      assert_true((inside ? FIT_UNTOLD : FIT_AT_UPPER) == u.verdict[0]);
      assert_true(u.verdict[1] == FIT_UNTOLD && u.verdict[2] == FIT_TOLD && u.weak == 1);
      assert_true(u.condition > 1e3);
      assert_near(u.way[0][0] / u.way[0][1], ratio, 0.01);
      fit_verdict_text(&p, &u, 1, text, sizeof text);
      assert_string_equal(text, "cannot be told from the data; a change is made up for by `a`, "
                                "rising with it");
    }
    fit_found_free(&f);
  }
  model m = model_of(deaf, pair, 2, truth);
  const fit_problem p = problem_of(&m, FIT_BOBYQA, 1e-7);
  fit_found f;
  fit_uncertainty u;
  fit_search(&p, &f);
  assert_true(fit_uncertainty_find(&p, &f, &u));
  assert_true(u.verdict[0] == FIT_TOLD && u.verdict[1] == FIT_UNTOLD && u.sensitivity[1] == 0);
  fit_verdict_text(&p, &u, 1, text, sizeof text);
  assert_string_equal(text, "cannot be told from the data");
  fit_found_free(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(first_time_counts_and_ends_stand),
      cmocka_unit_test(curves_may_go_down_in_x),
      cmocka_unit_test(a_band_weighs_by_its_width),
      cmocka_unit_test(exact_parameters_come_back),
      cmocka_unit_test(one_parameter_is_enough),
      cmocka_unit_test(starts_and_bounds_are_kept),
      cmocka_unit_test(a_start_that_fits_stays),
      cmocka_unit_test(what_fails_ends_the_search),
      cmocka_unit_test(the_search_is_the_same_each_time),
      cmocka_unit_test(a_line_takes_one_step),
      cmocka_unit_test(rough_valleys_are_left),
      cmocka_unit_test(a_descent_keeps_to_its_runs),
      cmocka_unit_test(a_line_has_its_closed_form),
      cmocka_unit_test(intervals_hold_the_truth),
      cmocka_unit_test(what_the_data_do_not_tell_is_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
