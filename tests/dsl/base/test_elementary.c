/* The elementary functions against the library's long double ones, whose 64-bit mantissa makes them
 * exact here. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "dsl/base/elementary.h"

enum { SAMPLES = 200000, STRIP = 512 };

static uint64_t next_random(uint64_t *state) { /* splitmix64 (Steele, Lea, Flood 2014) */
  uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return z ^ (z >> 31);
}

static double uniform(uint64_t *state, double low, double high) {
  return low + (high - low) * ((double)(next_random(state) >> 11) * 0x1p-53);
}

/* Random sign and mantissa, exponent of 2 uniform between the limits. */
static double log_uniform(uint64_t *state, int low, int high) {
  const double mantissa = uniform(state, 1.0, 2.0);
  const int exponent = low + (int)(next_random(state) % (uint64_t)(high - low + 1));
  return ldexp(next_random(state) & 1 ? mantissa : -mantissa, exponent);
}

static const long double pi = 3.14159265358979323846264338327950288L; /* to 64 bits */

/* Distance of `got` from the exact value in units of the last place of the exact value. */
static double ulps(double got, long double exact) {
  const double rounded = (double)exact;
  if (isnan(got) || isnan(rounded)) return isnan(got) && isnan(rounded) ? 0.0 : INFINITY;
  if (got == rounded) {
    if (isinf(got) || got == 0.0) return 0.0;
  } else if (isinf(got) || isinf(rounded)) {
    return INFINITY;
  }
  const int exponent = exact == 0.0L ? -1074 : ilogbl(exact) - 52;
  const long double unit = ldexpl(1.0L, exponent < -1074 ? -1074 : exponent);
  return (double)fabsl(((long double)got - exact) / unit);
}

static void check_worst(const char *name, double worst, double bound, double at, double also) {
  printf("  %-24s %.3f ulp at %a, %a\n", name, worst, at, also);
  if (!(worst <= bound)) fail_msg("%s: %.3f ulp at %a, %a", name, worst, at, also);
}

#define ONE_ARGUMENT(name, bound, sample, exact)                                                   \
  do {                                                                                             \
    uint64_t state = 1;                                                                            \
    double worst = 0.0, place = 0.0;                                                               \
    for (int k = 0; k < SAMPLES; k++) {                                                            \
      const double x = sample;                                                                     \
      const double error = ulps(pl_##name(x), exact((long double)x));                              \
      if (!(error <= worst)) worst = error, place = x;                                             \
    }                                                                                              \
    check_worst(#name " " #sample, worst, bound, place, 0.0);                                      \
  } while (0)

#define TWO_ARGUMENTS(name, bound, first, second, exact)                                           \
  do {                                                                                             \
    uint64_t state = 2;                                                                            \
    (void)state;                                                                                   \
    double worst = 0.0, place = 0.0, other = 0.0;                                                  \
    for (int k = 0; k < SAMPLES; k++) {                                                            \
      const double x = first, y = second;                                                          \
      const double error = ulps(pl_##name(x, y), exact((long double)x, (long double)y));           \
      if (!(error <= worst)) worst = error, place = x, other = y;                                  \
    }                                                                                              \
    check_worst(#name " " #first, worst, bound, place, other);                                     \
  } while (0)

static void exp_and_log(void **unused) {
  (void)unused;
  ONE_ARGUMENT(exp, 1.0, uniform(&state, -708.0, 709.7), expl);
  ONE_ARGUMENT(exp, 1.0, uniform(&state, -1.0, 1.0), expl);
  ONE_ARGUMENT(exp, 1.0, uniform(&state, -745.0, -708.0), expl);
  ONE_ARGUMENT(exp, 1.0, log_uniform(&state, -80, 9), expl);
  ONE_ARGUMENT(log, 1.5, fabs(log_uniform(&state, -1022, 1023)), logl);
  ONE_ARGUMENT(log, 1.5, fabs(log_uniform(&state, -1074, -1023)), logl);
  ONE_ARGUMENT(log, 1.5, uniform(&state, 0.3, 3.0), logl);
  ONE_ARGUMENT(log, 1.5, 1.0 + log_uniform(&state, -52, -4), logl);
  ONE_ARGUMENT(log10, 1.2, fabs(log_uniform(&state, -1022, 1023)), log10l);
  ONE_ARGUMENT(log10, 1.2, fabs(log_uniform(&state, -1074, -1023)), log10l);
  ONE_ARGUMENT(log10, 1.2, uniform(&state, 0.3, 3.0), log10l);
  ONE_ARGUMENT(log10, 1.2, 1.0 + log_uniform(&state, -52, -4), log10l);
}

static void logarithms_of_powers_of_ten_are_whole(void **unused) {
  (void)unused;
  for (int k = -308; k <= 308; k++) {
    char text[16];
    snprintf(text, sizeof text, "1e%d", k);
    assert_true(pl_log10(strtod(text, NULL)) == k);
  }
}

static long double one_over_root(long double x) {
  return 1 / sqrtl(x);
}

static void powers(void **unused) {
  (void)unused;
  TWO_ARGUMENTS(pow, 1.5, uniform(&state, 0.01, 100.0), uniform(&state, -150.0, 150.0), powl);
  TWO_ARGUMENTS(pow, 1.5, fabs(log_uniform(&state, -1022, 1023)), uniform(&state, -1.0, 1.0), powl);
  TWO_ARGUMENTS(pow, 1.5, fabs(log_uniform(&state, -1074, 1023)), log_uniform(&state, -40, 4),
                powl);
  TWO_ARGUMENTS(pow, 1.5, 1.0 + log_uniform(&state, -40, -3), log_uniform(&state, 2, 48), powl);
  TWO_ARGUMENTS(pow, 1.5, log_uniform(&state, -12, 12), rint(uniform(&state, -60.0, 60.0)), powl);
  ONE_ARGUMENT(cbrt, 0.6, log_uniform(&state, -1074, 1023), cbrtl);
  ONE_ARGUMENT(cbrt, 0.6, uniform(&state, -10.0, 10.0), cbrtl);
  ONE_ARGUMENT(sqrt, 0.501, fabs(log_uniform(&state, -1074, 1023)), sqrtl);
  ONE_ARGUMENT(inverse_root, 1.0, fabs(log_uniform(&state, -1022, 1023)), one_over_root);
  ONE_ARGUMENT(inverse_root, 1.0, uniform(&state, 1.0, 4.0), one_over_root);
}

static void magnitudes(void **unused) {
  (void)unused;
  TWO_ARGUMENTS(hypot, 1.25, uniform(&state, -1.0, 1.0), uniform(&state, -1.0, 1.0), hypotl);
  TWO_ARGUMENTS(hypot, 1.25, log_uniform(&state, -1074, 1023), log_uniform(&state, -1074, 1023),
                hypotl);
  TWO_ARGUMENTS(hypot, 1.25, log_uniform(&state, -1074, -1000), log_uniform(&state, -1074, -1000),
                hypotl);
  TWO_ARGUMENTS(hypot, 1.25, log_uniform(&state, 1000, 1023), log_uniform(&state, 1000, 1023),
                hypotl);
  assert_true(pl_hypot(3, -4) == 5 && pl_hypot(0.1, 0) == 0.1 &&
              pl_hypot(0, -0x1p-1074) == 0x1p-1074);
}

static void angles(void **unused) {
  (void)unused;
  ONE_ARGUMENT(sin, 1.0, uniform(&state, -7.0, 7.0), sinl);
  ONE_ARGUMENT(sin, 1.0, uniform(&state, -1e5, 1e5), sinl);
  ONE_ARGUMENT(sin, 1.0, log_uniform(&state, -1000, 3), sinl);
  ONE_ARGUMENT(sin, 1.0, rint(uniform(&state, -6e4, 6e4)) * (M_PI / 2), sinl); /* near its zeros */
  ONE_ARGUMENT(cos, 1.0, uniform(&state, -7.0, 7.0), cosl);
  ONE_ARGUMENT(cos, 1.0, uniform(&state, -1e5, 1e5), cosl);
  ONE_ARGUMENT(cos, 1.0, rint(uniform(&state, -6e4, 6e4)) * (M_PI / 2), cosl);
  ONE_ARGUMENT(sin, 1.0, uniform(&state, -0x1p30, 0x1p30), sinl);
  ONE_ARGUMENT(tan, 2.5, uniform(&state, -7.0, 7.0), tanl);
  ONE_ARGUMENT(tan, 2.5, uniform(&state, -1e5, 1e5), tanl);
  ONE_ARGUMENT(tan, 2.5, log_uniform(&state, -1000, 3), tanl);
  ONE_ARGUMENT(tanh, 2.0, uniform(&state, -25.0, 25.0), tanhl);
  ONE_ARGUMENT(tanh, 2.0, uniform(&state, -1.5, 1.5), tanhl);
  ONE_ARGUMENT(tanh, 2.0, log_uniform(&state, -1000, 5), tanhl);
}

static void arcs(void **unused) {
  (void)unused;
  ONE_ARGUMENT(asin, 1.3, uniform(&state, -1.0, 1.0), asinl);
  ONE_ARGUMENT(asin, 1.3, log_uniform(&state, -1074, -1), asinl);
  ONE_ARGUMENT(asin, 1.3, 1.0 - fabs(log_uniform(&state, -53, -1)), asinl);
  ONE_ARGUMENT(acos, 1.0, uniform(&state, -1.0, 1.0), acosl);
  ONE_ARGUMENT(acos, 1.0, log_uniform(&state, -1074, -1), acosl);
  ONE_ARGUMENT(acos, 1.0, 1.0 - fabs(log_uniform(&state, -53, -1)), acosl);
  ONE_ARGUMENT(acos, 1.0, fabs(log_uniform(&state, -53, -1)) - 1.0, acosl);
}

static void hyperbolic(void **unused) {
  (void)unused;
  ONE_ARGUMENT(sinh, 1.2, uniform(&state, -2.0, 2.0), sinhl);
  ONE_ARGUMENT(sinh, 1.2, uniform(&state, -711.0, 711.0), sinhl);
  ONE_ARGUMENT(sinh, 1.2, log_uniform(&state, -1074, 9), sinhl);
  ONE_ARGUMENT(cosh, 1.2, uniform(&state, -2.0, 2.0), coshl);
  ONE_ARGUMENT(cosh, 1.2, uniform(&state, -711.0, 711.0), coshl);
  ONE_ARGUMENT(cosh, 1.2, log_uniform(&state, -1074, 9), coshl);
}

static void chord_rotation(void **unused) {
  (void)unused;
  TWO_ARGUMENTS(atan2, 1.5, uniform(&state, -1.0, 1.0), uniform(&state, -1.0, 1.0), atan2l);
  TWO_ARGUMENTS(atan2, 1.5, log_uniform(&state, -60, 3), log_uniform(&state, -3, 3), atan2l);
  TWO_ARGUMENTS(atan2, 1.5, log_uniform(&state, -1074, 1023), log_uniform(&state, -1074, 1023),
                atan2l);
  /* every direction, and small rotations of a chord of 6 mm: relative to the angle itself */
  TWO_ARGUMENTS(atan2, 1.5, sin(k * (2 * M_PI / SAMPLES)), cos(k * (2 * M_PI / SAMPLES)), atan2l);
  TWO_ARGUMENTS(atan2, 0.75, log_uniform(&state, -60, -20), uniform(&state, 4e-5, 8e-5), atan2l);
  TWO_ARGUMENTS(atan2, 0.75, 1e-12 * uniform(&state, -1, 1), uniform(&state, 0.5, 2.0), atan2l);
}

/* x less whole turns of 2 (pi + pi_rest): remainderl is exact for the first part. */
static long double wrap_exactly(double x) {
  const long double pi_rest = -5.016557612668332023557327e-20L;
  const long double rest = remainderl((long double)x, 2 * pi);
  return rest - 2 * rintl(((long double)x - rest) / (2 * pi)) * pi_rest;
}

static void wrapping(void **unused) {
  (void)unused;
  uint64_t state = 3;
  double worst = 0.0;
  for (int k = 0; k < SAMPLES; k++) {
    double x = uniform(&state, -1e4, 1e4);
    if (k % 3 == 0)
      x = (2 * rint(x / 6) + 1) * M_PI + log_uniform(&state, -55, -1); /* at the cut */
    if (k % 3 == 1) x = 2 * rint(x / 7) * M_PI + log_uniform(&state, -55, -1);
    const long double exact = wrap_exactly(x);
    long double error = fabsl((long double)pl_wrap_angle(x) - exact);
    if (error > 6.0L) error = fabsl(error - 2 * pi); /* the other side of the cut */
    if (error > worst) worst = (double)error;
    assert_true(fabs(pl_wrap_angle(x)) <= M_PI);
    x = uniform(&state, -M_PI, M_PI);
    assert_true(pl_wrap_angle(x) == x);
  }
  printf("  wrap_angle               %.2e rad\n", worst);
  assert_true(worst <= 5e-16);
  assert_true(pl_wrap_angle(M_PI) == M_PI && pl_wrap_angle(-M_PI) == -M_PI);
  assert_true(pl_wrap_angle(nextafter(M_PI, 4.0)) < -3.14159);
  assert_true(pl_wrap_angle(1e-300) == 1e-300);
  assert_true(isnan(pl_wrap_angle(NAN)) && isnan(pl_wrap_angle(INFINITY)));
}

static const double corners[] = {0.0,
                                 -0.0,
                                 1.0,
                                 -1.0,
                                 0.5,
                                 -0.5,
                                 2.0,
                                 -2.0,
                                 3.0,
                                 -3.0,
                                 1e-310,
                                 -1e-310,
                                 1e308,
                                 -1e308,
                                 INFINITY,
                                 -INFINITY,
                                 NAN,
                                 0x1p52,
                                 -0x1p53,
                                 0x1p60,
                                 1.5,
                                 DBL_MAX,
                                 DBL_MIN,
                                 5e-324,
                                 0x1.fffffffffffffp51,
                                 0x1.fffffffffffffp52,
                                 -1e-5};
enum { CORNERS = sizeof corners / sizeof *corners };

/* Same value, sign of zero and NaN-ness, to two ulp. */
static void assert_corner(const char *name, double got, double expected, double x, double y) {
  const bool fits = ulps(got, (long double)expected) <= 2.0 &&
                    (isnan(expected) || signbit(got) == signbit(expected));
  if (!fits) fail_msg("%s(%a, %a) = %a, not %a", name, x, y, got, expected);
}

static void corner_values(void **unused) {
  (void)unused;
  for (int i = 0; i < CORNERS; i++) {
    const double x = corners[i];
    assert_corner("exp", pl_exp(x), exp(x), x, 0);
    assert_corner("log", pl_log(x), x == 0.0 ? -INFINITY : log(x), x, 0);
    assert_corner("log10", pl_log10(x), x == 0.0 ? -INFINITY : log10(x), x, 0);
    assert_corner("asin", pl_asin(x), asin(x), x, 0);
    assert_corner("acos", pl_acos(x), acos(x), x, 0);
    assert_corner("sinh", pl_sinh(x), sinh(x), x, 0);
    assert_corner("cosh", pl_cosh(x), cosh(x), x, 0);
    assert_corner("cbrt", pl_cbrt(x), cbrt(x), x, 0);
    assert_corner("tanh", pl_tanh(x), tanh(x), x, 0);
    assert_corner("sqrt", pl_sqrt(x), sqrt(x), x, 0);
    const bool in_range = fabs(x) <= 0x1p30;
    assert_corner("sin", pl_sin(x), in_range ? sin(x) : NAN, x, 0);
    assert_corner("cos", pl_cos(x), in_range ? cos(x) : NAN, x, 0);
    assert_corner("tan", pl_tan(x), in_range ? tan(x) : NAN, x, 0);
    for (int j = 0; j < CORNERS; j++) {
      const double y = corners[j];
      assert_corner("atan2", pl_atan2(x, y), atan2(x, y), x, y);
      assert_corner("pow", pl_pow(x, y), pow(x, y), x, y);
      assert_corner("hypot", pl_hypot(x, y), hypot(x, y), x, y);
    }
  }
}

static void selects(void **unused) {
  (void)unused;
  assert_true(pl_min(1.0, 2.0) == 1.0 && pl_min(2.0, 1.0) == 1.0);
  assert_true(pl_max(1.0, 2.0) == 2.0 && pl_max(2.0, 1.0) == 2.0);
  assert_true(isnan(pl_min(NAN, 1.0)) && isnan(pl_min(1.0, NAN)));
  assert_true(isnan(pl_max(NAN, 1.0)) && isnan(pl_max(1.0, NAN)));
  assert_true(pl_max(-INFINITY, 3.0) == 3.0 && pl_min(INFINITY, 3.0) == 3.0);
  assert_true(pl_fmin(1.0, 2.0) == 1.0 && pl_fmin(2.0, 1.0) == 1.0 && pl_fmax(1.0, 2.0) == 2.0);
  assert_true(pl_fmax(2.0, 1.0) == 2.0 && pl_fmin(NAN, 1.0) == 1.0 && pl_fmin(1.0, NAN) == 1.0);
  assert_true(pl_fmax(NAN, 1.0) == 1.0 && pl_fmax(1.0, NAN) == 1.0 && isnan(pl_fmax(NAN, NAN)));
  assert_true(signbit(pl_fmin(-0.0, 0.0)) && !signbit(pl_fmin(0.0, -0.0)));
  assert_true(signbit(pl_fmax(-0.0, 0.0)) && !signbit(pl_fmax(0.0, -0.0)));
  assert_true(pl_sign(-3.0) == -1.0 && pl_sign(0.0) == 0.0 && pl_sign(1e-320) == 1.0);
  assert_true(isnan(pl_sign(NAN)));
  assert_true(pl_abs(-0.0) == 0.0 && !signbit(pl_abs(-0.0)) && pl_abs(-3.5) == 3.5);
}

/* Odd functions are odd to the bit, so that mirrored runs stay mirrored. */
static void symmetry(void **unused) {
  (void)unused;
  uint64_t state = 5;
  for (int k = 0; k < SAMPLES; k++) {
    const double x = log_uniform(&state, -30, 8), y = log_uniform(&state, -30, 8);
    assert_true(pl_sin(-x) == -pl_sin(x) && pl_cos(-x) == pl_cos(x) && pl_tan(-x) == -pl_tan(x));
    assert_true(pl_tanh(-x) == -pl_tanh(x) && pl_cbrt(-x) == -pl_cbrt(x));
    assert_true(pl_sinh(-x) == -pl_sinh(x) && pl_cosh(-x) == pl_cosh(x));
    assert_true(pl_asin(-pl_tanh(x)) == -pl_asin(pl_tanh(x)));
    assert_true(pl_atan2(-y, x) == -pl_atan2(y, x) && pl_wrap_angle(-x) == -pl_wrap_angle(x));
  }
}

/* --- the compiler's report: every function vectorises ----------------------------------------- */

static const char *const one_argument[] = {
    "abs",  "sqrt",       "sign",         "exp",   "log",  "cbrt", "sin",  "cos", "tan",
    "tanh", "wrap_angle", "inverse_root", "log10", "asin", "acos", "sinh", "cosh"};
static const char *const two_arguments[] = {"min", "max", "pow", "hypot", "atan2"};
enum {
  ONES = sizeof one_argument / sizeof *one_argument,
  TWOS = sizeof two_arguments / sizeof *two_arguments
};

static void write_loops(FILE *c) {
  fprintf(c, "#include \"dsl/base/elementary.h\"\n");
  for (int k = 0; k < ONES; k++)
    fprintf(c,
            "void f%d(int n, const double *restrict a, double *restrict o)"
            " { for (int i = 0; i < n; i++) o[i] = pl_%s(a[i]); }\n",
            k, one_argument[k]);
  for (int k = 0; k < TWOS; k++)
    fprintf(
        c,
        "void g%d(int n, const double *restrict a, const double *restrict b, double *restrict o)"
        " { for (int i = 0; i < n; i++) o[i] = pl_%s(a[i], b[i]); }\n",
        k, two_arguments[k]);
}

static void loops_vectorise(void **unused) {
  (void)unused;
#if !defined(__x86_64__)
  skip();
#endif
  if (system("gcc --version > /dev/null 2>&1") != 0) skip();
  char folder[] = "/tmp/perilat_elementary_XXXXXX", path[64], command[512];
  assert_non_null(mkdtemp(folder));
  snprintf(path, sizeof path, "%s/loops.c", folder);
  FILE *c = fopen(path, "w");
  assert_non_null(c);
  write_loops(c);
  fclose(c);
  const char *const processors[] = {"haswell", "skylake-avx512"};
  for (int k = 0; k < 2; k++) {
    snprintf(
        command, sizeof command,
        "gcc -std=gnu11 -O3 -march=%s -fno-math-errno -fno-trapping-math -ffp-contract=off -I'%s' "
        "-fopt-info-vec-optimized -c %s -o %s/loops.o 2>&1 | grep 'loop vectorized' | cut -d: -f2 "
        "| "
        "sort -u | wc -l",
        processors[k], SOURCE_DIR, path, folder);
    FILE *report = popen(command, "r");
    assert_non_null(report);
    int loops = 0;
    assert_int_equal(fscanf(report, "%d", &loops), 1);
    pclose(report);
    assert_int_equal(loops, ONES + TWOS);
  }
  snprintf(command, sizeof command, "rm -r %s", folder);
  assert_int_equal(system(command), 0);
}

/* Vector and scalar code of the same function give the same bits. */
static void lanes_agree(void **unused) {
  (void)unused;
  uint64_t state = 7;
  static double x[STRIP], y[STRIP], strip[11][STRIP];
  for (int k = 0; k < STRIP; k++) {
    x[k] = log_uniform(&state, -20, 6);
    y[k] = log_uniform(&state, -20, 6);
  }
  for (int k = 0; k < STRIP; k++) {
    strip[0][k] = pl_exp(x[k]);
    strip[1][k] = pl_sin(x[k]);
    strip[2][k] = pl_atan2(x[k], y[k]);
    strip[3][k] = pl_pow(pl_abs(x[k]), y[k]);
    strip[4][k] = pl_cbrt(x[k]);
    strip[5][k] = pl_wrap_angle(x[k]);
    strip[6][k] = pl_log10(pl_abs(x[k]));
    strip[7][k] = pl_asin(pl_tanh(x[k]));
    strip[8][k] = pl_acos(pl_tanh(x[k]));
    strip[9][k] = pl_sinh(x[k]);
    strip[10][k] = pl_cosh(x[k]);
  }
  for (int k = 0; k < STRIP; k++) {
    volatile double a = x[k], b = y[k]; /* one at a time */
    assert_true(pl_exp(a) == strip[0][k] && pl_sin(a) == strip[1][k]);
    assert_true(pl_atan2(a, b) == strip[2][k] && pl_pow(pl_abs(a), b) == strip[3][k]);
    assert_true(pl_cbrt(a) == strip[4][k] && pl_wrap_angle(a) == strip[5][k]);
    assert_true(pl_log10(pl_abs(a)) == strip[6][k] && pl_sinh(a) == strip[9][k]);
    assert_true(pl_asin(pl_tanh(a)) == strip[7][k] && pl_acos(pl_tanh(a)) == strip[8][k]);
    assert_true(pl_cosh(a) == strip[10][k]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(exp_and_log),    cmocka_unit_test(powers),
      cmocka_unit_test(magnitudes),     cmocka_unit_test(angles),
      cmocka_unit_test(chord_rotation), cmocka_unit_test(wrapping),
      cmocka_unit_test(corner_values),  cmocka_unit_test(selects),
      cmocka_unit_test(symmetry),       cmocka_unit_test(loops_vectorise),
      cmocka_unit_test(lanes_agree),    cmocka_unit_test(arcs),
      cmocka_unit_test(hyperbolic),     cmocka_unit_test(logarithms_of_powers_of_ten_are_whole),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
