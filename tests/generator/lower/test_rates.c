/* States that have a rate, step by step: linear ones are exact where what moves them goes evenly,
   whatever the step, and else of order 2; others are of order 1; none gains energy; and what cannot
   be solved is refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/law_text.h"

#define HEAD                                                                                       \
  "model m\nlaw central bond\nparameter k = 10 [MN] in (0, inf)\n"                                 \
  "parameter rho = 2323 [kg/m^3]\n"
#define TAIL "end model\n"
#define CHAIN                                                                                      \
  HEAD "parameter tau = 2 [s]\nstate v on bond = 0\nrate v = (stretch - v)/tau\n"                  \
       "force N = k*stretch + 2*k*(stretch - v)\n" TAIL
#define K 1e7 /* N */

static tested_law *must_open(const char *text) {
  tested_law *t = open_law(text);
  if (!t->plan) diag_print(&t->said, stderr);
  assert_non_null(t->plan);
  return t;
}

static void take(const tested_law *t, tested_state *x, double stretch, double dt) {
  x->stretch = stretch;
  x->dt = dt;
  evaluate_law(t, x, 0);
  memcpy(x->field, x->new_field, sizeof x->field);
}

/* --- exact ------------------------------------------------------------------------------------ */

/* Of v' = (c t - v)/tau from rest: c (t - tau (1 - exp(-t/tau))). */
static long double dashpot(long double c, long double tau, long double t) {
  const long double z = t / tau;
  if (z > 1e-3L) return c * (t + tau * expm1l(-z));
  return c * t * z * (0.5L - z * (1 / 6.0L - z * (1 / 24.0L - z / 120)));
}

/* Stretch that grows evenly, in steps of random length of all sizes about tau. */
static void an_even_way_is_exact(void **state) {
  (void)state;
  tested_law *t = must_open(CHAIN);
  uint64_t seed = 12345;
  double most = 0;
  for (int run = 0; run < 400; run++) {
    const double size = exp(random_uniform(&seed, log(1e-9), log(1e9)));
    tested_state x = {.stretch = 0};
    double time = 0;
    take(t, &x, 0, 0);
    for (int step = 0; step < 20; step++) {
      const double dt = size * random_uniform(&seed, 0.01, 2);
      time += dt;
      take(t, &x, 1e-4 * time, dt);
      const double exact = (double)dashpot(1e-4L, 2, time);
      most = fmax(most, fabs(x.field[0] - exact) / exact);
      assert_true(fabs(x.N - K * (3e-4 * time - 2 * exact)) <= 1e-14 * K * 3e-4 * time);
    }
  }
  print_message("an even way: off by %.2g at most\n", most);
  assert_true(most < 5e-15);
  close_law(t);
}

/* A stretch that comes at once and stays: the force relaxes as exp(-t/tau). */
static void what_is_held_relaxes_exactly(void **state) {
  (void)state;
  tested_law *t = must_open(CHAIN);
  uint64_t seed = 54321;
  double most = 0;
  for (int run = 0; run < 400; run++) {
    const double size = exp(random_uniform(&seed, log(1e-6), log(1e6)));
    tested_state x = {.stretch = 0};
    double time = 0;
    take(t, &x, 1e-3, 0);
    assert_true(x.N == 3e-3 * K);
    for (int step = 0; step < 20; step++) {
      const double dt = size * random_uniform(&seed, 0.01, 2);
      time += dt;
      take(t, &x, 1e-3, dt);
      most = fmax(most, fabs(x.N / (1e-3 * K) - 1 - 2 * exp(-time / 2)));
    }
  }
  print_message("what is held: off by %.2g at most\n", most);
  assert_true(most < 2e-14);
  close_law(t);
}

static void without_time_nothing_changes(void **state) {
  (void)state;
  tested_law *t = must_open(CHAIN);
  tested_state x = {.stretch = 0};
  take(t, &x, 1e-3, 0);
  take(t, &x, 2e-3, 0.7);
  const double v = x.field[0];
  assert_true(v > 0);
  take(t, &x, -5e-3, 0);
  assert_true(x.field[0] == v);
  /* and goes on from there as if it had been so */
  take(t, &x, -5e-3, 1.3);
  assert_true(fabs(x.field[0] - (-5e-3 + (v + 5e-3) * exp(-0.65))) < 1e-17);
  close_law(t);
}

static void what_is_not_damped_goes_on(void **state) {
  (void)state;
  tested_law *t = must_open(HEAD "state a on bond = 0\nrate a = 1/3 [s]\n"
                                 "state age on bond = 0 [s]\nage = previous(age) + dt\n"
                                 "state g on bond = 1\nrate g = g/5 [s]\n"
                                 "force N = k*(stretch - 0*a - 0*age/1 [s] - 0*g)\n" TAIL);
  tested_state x = {.field = {0, 0, 1}};
  take(t, &x, 0, 0);
  for (int step = 0; step < 50; step++)
    take(t, &x, 0, step % 2 ? 0.25 : 0.75);
  assert_true(fabs(x.field[0] - 25 / 3.0) < 1e-13);
  assert_true(x.field[1] == 25);
  assert_true(fabs(x.field[2] - exp(5)) < 1e-11);
  close_law(t);
}

/* --- order ------------------------------------------------------------------------------------ */

/* The largest difference of v from `exact` along a sine of period 1 s in so many steps. */
static double gap(const tested_law *t, int steps, const double *exact, int every) {
  tested_state x = {.stretch = 0};
  double most = 0;
  take(t, &x, 0, 0);
  for (int step = 1; step <= steps; step++) {
    take(t, &x, 1e-3 * sin(2 * M_PI * step / steps), 1.0 / steps);
    most = fmax(most, fabs(x.field[0] - exact[step * every]));
  }
  return most;
}

enum { FINE = 1 << 16 };

static void has_order(const char *text, double order) {
  tested_law *t = must_open(text);
  double *exact = malloc((FINE + 1) * sizeof *exact), before = 0;
  tested_state x = {.stretch = 0};
  take(t, &x, 0, 0);
  exact[0] = 0;
  for (int step = 1; step <= FINE; step++) {
    take(t, &x, 1e-3 * sin(2 * M_PI * step / FINE), 1.0 / FINE);
    exact[step] = x.field[0];
  }
  for (int steps = 64; steps <= 512; steps *= 2) {
    const double now = gap(t, steps, exact, FINE / steps);
    if (steps > 64) {
      print_message("  %4d steps: %.3g, order %.3f\n", steps, now, log2(before / now));
      assert_true(fabs(log2(before / now) - order) < 0.05);
    }
    before = now;
  }
  free(exact);
  close_law(t);
}

static void linear_rates_are_of_order_two(void **state) {
  (void)state;
  has_order(HEAD "state v on bond = 0\nrate v = (stretch - v)/0.1 [s]\n"
                 "force N = k*(2*stretch - v)\n" TAIL,
            2);
  /* with a time that changes, and a force that goes on by itself */
  has_order(HEAD "state v on bond = 0\nrate v = (stretch - v)*(1 + (stretch/5e-4)**2)/0.1 [s]\n"
                 "force N = k*(2*stretch - v)\n" TAIL,
            2);
}

static void other_rates_are_of_order_one(void **state) {
  (void)state;
  has_order(HEAD "state v on bond = 0\nx = (stretch - v)/1e-3\n"
                 "rate v = 1e-3*x*(1 + x**2)/0.1 [s]\nforce N = k*(2*stretch - v)\n" TAIL,
            1);
  has_order(HEAD "state v on bond = 0\nT = stretch - v\n"
                 "rate v = sign(T)*positive_part(abs(T) - 3e-4)/0.1 [s]\n"
                 "force N = k*(2*stretch - v)\n" TAIL,
            1);
}

/* x' = -x^3: x = x_0/sqrt(1 + 2 x_0^2 t). */
static void a_cube_falls_as_theory_says(void **state) {
  (void)state;
  tested_law *t =
      must_open(HEAD "state v on bond = 0\nrate v = 1e-3*((stretch - v)/1e-3)**3/1 [s]\n"
                     "force N = k*(2*stretch - v)\n" TAIL);
  const double exact = 1e-3 / sqrt(1 + 2.0);
  double before = 0;
  for (int steps = 100; steps <= 1600; steps *= 2) {
    tested_state x = {.stretch = 0};
    take(t, &x, 1e-3, 0);
    for (int k = 0; k < steps; k++)
      take(t, &x, 1e-3, 1.0 / steps);
    const double off = fabs(1e-3 - x.field[0] - exact);
    if (before > 0) assert_true(fabs(before / off - 2) < 0.05);
    before = off;
  }
  assert_true(before < 2e-4 * exact);
  close_law(t);
}

/* --- energy ----------------------------------------------------------------------------------- */

/* While the ends are held no step, however long, brings what is stored in the spring that relaxes
   above what it was, or to the other side. */
static void held_bonds_never_gain(void **state) {
  (void)state;
  static const char *const rates[] = {
      "(stretch - v)/2 [s]", "1e-3*((stretch - v)/1e-3)**3/1 [s]",
      "sign(stretch - v)*positive_part(abs(stretch - v) - 1e-4)/1 [s]",
      "1e-4*(exp((stretch - v)/1e-3) - exp((v - stretch)/1e-3))/1 [s]"};
  uint64_t seed = 777;
  for (size_t k = 0; k < sizeof rates / sizeof *rates; k++) {
    char text[1000];
    snprintf(text, sizeof text,
             HEAD "state v on bond = 0\nrate v = %s\nforce N = k*(stretch - v)\n" TAIL, rates[k]);
    tested_law *t = must_open(text);
    for (int run = 0; run < 1000; run++) {
      tested_state x = {.field = {random_uniform(&seed, -3e-3, 3e-3)}};
      const double stretch = random_uniform(&seed, -3e-3, 3e-3);
      double before = stretch - x.field[0];
      take(t, &x, stretch, 0);
      for (int step = 0; step < 6; step++) {
        take(t, &x, stretch, exp(random_uniform(&seed, log(1e-6), log(1e6))));
        const double now = stretch - x.field[0];
        assert_true(isfinite(now));
        assert_true(fabs(now) <= fabs(before) * (1 + 1e-13) + 1e-18);
        assert_true(now * before >= -1e-20);
        before = now;
      }
    }
    close_law(t);
  }
}

/* Around closed ways from rest, in a few steps or many, quickly or slowly: what is done is at least
   what is stored in the end. */
static void no_work_comes_out_of_a_chain(void **state) {
  (void)state;
  tested_law *t = must_open(CHAIN);
  uint64_t seed = 4242;
  for (int run = 0; run < 2000; run++) {
    const double dt = exp(random_uniform(&seed, log(1e-4), log(1e4)));
    const int steps = 4 + run % 60;
    tested_state x = {.stretch = 0};
    double work = 0, size = 0, stretch = 0, force = 0;
    take(t, &x, 0, 0);
    for (int step = 1; step <= steps; step++) {
      const double next = step == steps ? 0 : random_uniform(&seed, -1e-3, 1e-3);
      take(t, &x, next, dt);
      work += 0.5 * (force + x.N) * (next - stretch);
      size += fabs(force * (next - stretch));
      stretch = next;
      force = x.N;
    }
    assert_true(work >= -1e-12 * size);
  }
  close_law(t);
}

/* --- steep rates ------------------------------------------------------------------------------ */

/* Rates with kinks and jumps at rest, or steeper than any step is short: the step is that of
   implicit Euler while it is of some size, and of long steps the state goes toward rest, by no more
   than the rounding of the search beyond, and lacks at most a 2^15th of what the rate would have
   moved it by. */
static void steep_rates_come_to_rest(void **state) {
  (void)state;
  static const char *const rates[] = {"tanh((stretch - v)*1e6)*1e-3/1 [s]",
                                      "sign(stretch - v)*abs(stretch - v)**0.2*1e-3/1 [s]",
                                      "cbrt((stretch - v)*1e-6)/1 [s]",
                                      "sign(stretch - v)*sqrt(abs(stretch - v))*0.1/1 [s]",
                                      "(stretch - v)/1 [s] + sign(stretch - v)*1e-3/1 [s]",
                                      "(| 1e-3 when stretch > v\n | -1e-3 otherwise)/1 [s]"};
  for (size_t k = 0; k < sizeof rates / sizeof *rates; k++) {
    char text[1000];
    snprintf(text, sizeof text,
             HEAD "state v on bond = 0\nf = %s\nrate v = f\nforce N = k*(stretch - v)\n" TAIL,
             rates[k]);
    tested_law *t = must_open(text);
    for (double dt = 1e-4; dt < 1e5; dt *= 10) {
      tested_state x = {.stretch = 0};
      double before = 0;
      take(t, &x, 1e-3, 0);
      for (int step = 0; step < 200; step++) {
        take(t, &x, 1e-3, dt);
        const double v = x.field[0], rate = x.field[1];
        assert_true(v >= before - 1e-9 && v <= 1e-3 * (1 + 1e-6));
        if (dt <= 0.1 && v < 0.99e-3) /* the rate that is kept is f(v) */
          assert_true(fabs(v - before - dt * rate) <= 1e-5 * (v - before));
        before = v;
      }
      if (dt >= 100) assert_true(fabs(before - 1e-3) < 1e-9 + 1e-3 * dt / (1 << 15));
    }
    close_law(t);
  }
}

/* --- what is refused -------------------------------------------------------------------------- */

static void refused(const char *text, const char *wanted) {
  tested_law *t = open_law(text);
  char *said;
  size_t length;
  FILE *out = open_memstream(&said, &length);
  assert_null(t->plan);
  diag_print(&t->said, out);
  fclose(out);
  if (!strstr(said, wanted)) print_message("%s\n", said);
  assert_non_null(strstr(said, wanted));
  free(said);
  diag_clear(&t->said);
  source_clear(&t->sources);
  arena_free(t->memory);
  free(t);
}

static void what_couples_is_refused(void **state) {
  (void)state;
  refused("model m\nlaw state\nparameter k = 1 [MN]\nparameter rho = 1 [kg/m^3]\n"
          "state v[j] on neighbour = 0\nrate v[j] = (stretch[j] - sum(v[j]))/1 [s]\n"
          "force state F[j] = k*(stretch[j] - v[j])\nend model\n",
          "read `previous(...)` of the state");
  refused("model m\nlaw continuum\nparameter E = 1 [GPa]\nparameter rho = 1 [kg/m^3]\n"
          "state e on point = tensor 0\nrate e = norm(strain - e)*(strain - e)/1 [s]\n"
          "stress sigma = hooke(strain - e, E, 0.2)\nend model\n",
          "depends on others");
  refused(HEAD "state S on bond = 0\nrate S = 3*stretch_rate - S/1 [s]\nforce N = k*S\n" TAIL,
          "let the state be the strain that flows");
  refused("model m\nlaw continuum\nparameter E = 1 [GPa]\nparameter rho = 1 [kg/m^3]\n"
          "state e on point = tensor 0\nrate e = strain_rate\n"
          "stress sigma = hooke(e, E, 0.2)\nend model\n",
          "let the state be the strain that flows");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_even_way_is_exact),
      cmocka_unit_test(what_is_held_relaxes_exactly),
      cmocka_unit_test(without_time_nothing_changes),
      cmocka_unit_test(what_is_not_damped_goes_on),
      cmocka_unit_test(linear_rates_are_of_order_two),
      cmocka_unit_test(other_rates_are_of_order_one),
      cmocka_unit_test(a_cube_falls_as_theory_says),
      cmocka_unit_test(held_bonds_never_gain),
      cmocka_unit_test(no_work_comes_out_of_a_chain),
      cmocka_unit_test(steep_rates_come_to_rest),
      cmocka_unit_test(what_couples_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
