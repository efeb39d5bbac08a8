/* Random fields against theory: mean, cv and distribution, independence, correlation over distance;
   the same values whatever the threads and the body; what the law does not allow. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <omp.h>
#include <unistd.h>

#include "runtime/deck/deck_read.h"
#include "runtime/filling/lattice.h"
#include "runtime/lattice/parameter_planes.h"
#include "runtime/lattice/random_field.h"
#include "runtime/analysis/material.h"
#include "tests/runtime/small_run.h"

/* With a probability of 0.001 the Kolmogorov distance of n values is more than 1.95/sqrt(n), and a
   mean further than 3.3 standard errors. The seeds are fixed: a test that passes goes on passing.
 */
static const double kolmogorov = 1.95, standard_errors = 3.3;

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double normal_below(double z) {
  return 0.5 * erfc(-z / sqrt(2));
}

/* --- one distribution --- */

typedef struct expected {
  const char *name;
  deck_field field;
  double mean, cv;
  double (*below)(double x); /* probability of a smaller value */
} expected;

static double uniform_below(double x) {
  return fmin(fmax((x - 2) / 3, 0), 1);
}

static double normal_field_below(double x) {
  return normal_below((x - 4) / 1.2);
}

static double lognormal_below(double x) {
  const double sigma = sqrt(log(1 + 0.25)), mu = log(4) - sigma * sigma / 2;
  return normal_below((log(x) - mu) / sigma);
}

static double weibull_below(double x) {
  return 1 - exp(-pow(x / 5, 2));
}

/* Weibull with exponent 1 is the exponential distribution: cv = 1. */
static double exponential_below(double x) {
  return 1 - exp(-x / 3);
}

static const expected cases[] = {
    {"uniform",
     {.kind = FIELD_UNIFORM,
      .low = {.given = true, .value = 2},
      .high = {.given = true, .value = 5}},
     3.5,
     0.8660254037844386 / 3.5,
     uniform_below},
    {"uniform by cv",
     {.kind = FIELD_UNIFORM, .mean = {.given = true, .value = 3.5}, .cv = 0.8660254037844386 / 3.5},
     3.5,
     0.8660254037844386 / 3.5,
     uniform_below},
    {"normal", {.kind = FIELD_NORMAL, .cv = 0.3}, 4, 0.3, normal_field_below},
    {"lognormal", {.kind = FIELD_LOGNORMAL, .cv = 0.5}, 4, 0.5, lognormal_below},
    /* exponent 2 (Rayleigh): mean = 5 sqrt(pi)/2, cv = sqrt(4/pi - 1) */
    {"weibull",
     {.kind = FIELD_WEIBULL, .shape = 2, .scale = {.given = true, .value = 5}},
     4.4311346272637895,
     0.5227232008770632,
     weibull_below},
    {"weibull by cv",
     {.kind = FIELD_WEIBULL, .mean = {.given = true, .value = 3}, .cv = 1},
     3,
     1,
     exponential_below},
};

static void check_values(const char *name, double *values, long n, double mean, double cv,
                         double (*below)(double)) {
  double sum = 0, square = 0, distance = 0, fourth = 0;
  for (long k = 0; k < n; k++)
    sum += values[k] / (double)n;
  for (long k = 0; k < n; k++) {
    const double d = values[k] - sum;
    square += d * d / (double)n;
    fourth += d * d * d * d / (double)n;
  }
  qsort(values, (size_t)n, sizeof *values, ascending);
  for (long k = 0; k < n; k++) {
    const double p = below(values[k]);
    distance = fmax(distance, fmax(p - (double)k / (double)n, (double)(k + 1) / (double)n - p));
  }
  const double mean_error = (sum - mean) / sqrt(square / (double)n);
  const double variance = mean * mean * cv * cv;
  const double variance_error = (square - variance) / sqrt((fourth - square * square) / (double)n);
  print_message("%-14s mean %.5f of theory, cv %.5f of theory, Kolmogorov %.2f/sqrt(n)\n", name,
                sum / mean, sqrt(square) / sum / cv, distance * sqrt((double)n));
  assert_true(fabs(mean_error) < standard_errors);
  assert_true(fabs(variance_error) < standard_errors);
  assert_true(distance * sqrt((double)n) < kolmogorov);
}

static void values_follow_their_distribution(void **state) {
  (void)state;
  enum { SIDE = 200 };
  double *values = must_calloc((size_t)SIDE * SIDE * 3, sizeof *values);
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    random_distribution r;
    char error[128];
    assert_true(random_distribution_of(&cases[c].field, 4, &r, error, sizeof error));
    assert_true(fabs(random_distribution_mean(&r) / cases[c].mean - 1) < 1e-12);
    const double cv = random_distribution_deviation(&r) / random_distribution_mean(&r);
    assert_true(fabs(cv / cases[c].cv - 1) < 1e-10);
    long n = 0;
    for (int a = 0; a < SIDE; a++)
      for (int b = 0; b < SIDE; b++)
        for (int k = 0; k < 3; k++)
          values[n++] = random_quantile(&r, random_normal_of_site(42 + c, a - 50, b - 150, 0, k));
    check_values(cases[c].name, values, n, cases[c].mean, cases[c].cv, cases[c].below);
  }
  free(values);
}

/* The quantile is the inverse of the probability, far into both tails. */
static void quantiles_invert_the_distribution(void **state) {
  (void)state;
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    random_distribution r;
    char error[128];
    assert_true(random_distribution_of(&cases[c].field, 4, &r, error, sizeof error));
    for (double z = -5; z <= 5; z += 0.25) {
      const double p = cases[c].below(random_quantile(&r, z)), wanted = normal_below(z);
      assert_true(fabs(p - wanted) < 1e-14 + 1e-10 * wanted);
    }
  }
}

static void impossible_distributions_are_refused(void **state) {
  (void)state;
  const deck_field bad[] = {
      {.kind = FIELD_LOGNORMAL, .cv = 0.1, .mean = {.given = true, .value = -1}},
      {.kind = FIELD_WEIBULL, .cv = 0.1, .mean = {.given = true, .value = 0}},
      {.kind = FIELD_NORMAL, .cv = 0.1, .mean = {.given = true, .value = 0}},
      {.kind = FIELD_WEIBULL, .shape = 2, .scale = {.given = true, .value = -3}},
      {.kind = FIELD_WEIBULL, .shape = 1e-3},
  };
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    random_distribution r;
    char error[128] = "";
    assert_false(random_distribution_of(&bad[k], 4, &r, error, sizeof error));
    assert_true(strlen(error) > 10);
  }
}

/* --- independence --- */

static double correlation(double (*first)(int, int), double (*second)(int, int)) {
  enum { SIDE = 300 };
  double sum = 0, a2 = 0, b2 = 0;
  for (int a = 0; a < SIDE; a++)
    for (int b = 0; b < SIDE; b++) {
      const double x = first(a, b), y = second(a, b);
      sum += x * y;
      a2 += x * x;
      b2 += y * y;
    }
  return SIDE * sum / sqrt(a2 * b2); /* times sqrt(n) */
}

static double here(int a, int b) {
  return random_normal_of_site(7, a, b, 0, 0);
}
static double right(int a, int b) {
  return random_normal_of_site(7, a + 1, b, 0, 0);
}
static double above(int a, int b) {
  return random_normal_of_site(7, a, b + 1, 0, 0);
}
static double mirrored(int a, int b) {
  return random_normal_of_site(7, b, a, 0, 0);
}
static double other_direction(int a, int b) {
  return random_normal_of_site(7, a, b, 0, 1);
}
static double particle(int a, int b) {
  return random_normal_of_site(7, a, b, 0, -1);
}
static double other_seed(int a, int b) {
  return random_normal_of_site(8, a, b, 0, 0);
}
static double other_layer(int a, int b) {
  return random_normal_of_site(7, a, b, 1, 0);
}

static void neighbours_directions_and_seeds_are_independent(void **state) {
  (void)state;
  double (*const others[])(int, int) = {right,    above,      mirrored,   other_direction,
                                        particle, other_seed, other_layer};
  assert_true(fabs(correlation(here, here) - 300) < 1e-9);
  for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
    const double r = correlation(here, others[k]);
    /* the mirror pairs are counted twice: their spread is sqrt(2) larger */
    assert_true(fabs(r) < (others[k] == mirrored ? sqrt(2) : 1) * standard_errors);
  }
  deck_field e = {.parameter = "E", .seed = 3}, f = {.parameter = "e", .seed = 3},
             g = {.parameter = "S_t", .seed = 3}, h = {.parameter = "E", .seed = 4};
  assert_true(random_seed_of(&e) == random_seed_of(&f));
  assert_true(random_seed_of(&e) != random_seed_of(&g) && random_seed_of(&e) != random_seed_of(&h));
}

/* --- correlation over distance --- */

/* Over many seeds: z(0) z(r) has the mean exp(-(r/L)^2) and a spread of at most sqrt(2). */
static void correlation_falls_with_distance(void **state) {
  (void)state;
  enum { SEEDS = 20000, LAGS = 5 };
  static const double lags[LAGS] = {0, 0.25, 0.5, 1, 2};
  const double L = 0.02;
  double along[LAGS] = {0}, across[LAGS] = {0}, upward[LAGS] = {0},
         *values = must_calloc(SEEDS, sizeof *values);
  for (int seed = 0; seed < SEEDS; seed++) {
    random_waves *w = random_waves_new((uint64_t)seed, L);
    const double z = random_waves_at(w, (double[3]){0.3, -0.7, 0});
    values[seed] = z;
    for (int k = 0; k < LAGS; k++) {
      const double r = lags[k] * L;
      along[k] += z * random_waves_at(w, (double[3]){0.3 + r, -0.7, 0}) / SEEDS;
      across[k] += z * random_waves_at(w, (double[3]){0.3, -0.7 + r, 0}) / SEEDS;
      upward[k] += z * random_waves_at(w, (double[3]){0.3, -0.7, r}) / SEEDS;
    }
    random_waves_free(w);
  }
  for (int k = 0; k < LAGS; k++) {
    const double rho = exp(-lags[k] * lags[k]), spread = sqrt((1 + rho * rho) / SEEDS);
    print_message("correlation at %.2f L: %.4f, %.4f, %.4f, theory %.4f +- %.4f\n", lags[k],
                  along[k], across[k], upward[k], rho, spread);
    assert_true(fabs(along[k] - rho) < standard_errors * spread);
    assert_true(fabs(across[k] - rho) < standard_errors * spread);
    assert_true(fabs(upward[k] - rho) < standard_errors * spread);
  }
  double distance = 0;
  qsort(values, SEEDS, sizeof *values, ascending);
  for (int k = 0; k < SEEDS; k++)
    distance = fmax(distance, fabs(normal_below(values[k]) - (k + 0.5) / SEEDS));
  print_message("waves at one place: Kolmogorov %.2f/sqrt(n)\n", distance * sqrt(SEEDS));
  assert_true(distance * sqrt(SEEDS) < kolmogorov);
  free(values);
}

/* --- on lattices --- */

#define HEAD "&simulation end_time = 1e-3 /\n&material lattice = 'c' model = 'm' E = '30 GPa' /\n"
#define LATTICE                                                                                    \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = %g /\n"        \
  "&body lattice = 'c' shape = 'rectangle' corner = %g, %g size = %g, %g /\n"

static const int varying_E[] = {ELASTIC_E};

typedef struct sample {
  small_run run;
  rows *lattice;
  rows_bond *bonds;
  parameter_planes *fields;
} sample;

/* Of a law whose E differs; fields stay NULL after an error, which is in run.said. */
static void sample_read(sample *s, const char *text, pl_law law) {
  memset(s, 0, sizeof *s);
  law.varying = varying_E;
  law.varying_count = 1;
  small_run *r = &s->run;
  r->memory = arena_new();
  diag_begin(&r->said, &r->sources);
  const int file = source_add(&r->sources, "deck.nml", text, strlen(text));
  r->deck = deck_read(r->memory, &r->sources, file, NULL, 0, &r->said);
  if (!r->deck) return;
  assert_true(material_parameters(&r->deck->materials[0], &law, r->parameters, &r->said));
  s->lattice = lattice_build(r->deck, 0, &r->said);
  s->bonds = rows_bonds(s->lattice);
  s->fields = parameter_planes_new(r->deck, 0, &r->deck->materials[0], s->lattice, NULL, &law,
                                   r->parameters, NULL, 0, &r->said);
}

/* A body with a field of E. */
static void sample_open(sample *s, const char *field, double turn, double x, double y, double width,
                        double height, const char *more) {
  char text[2048];
  snprintf(text, sizeof text, HEAD LATTICE "&field parameter = 'E' %s /\n%s", turn, x, y, width,
           height, field, more);
  sample_read(s, text, elastic_bar);
}

static void sample_close(sample *s) {
  parameter_planes_free(s->fields);
  free(s->bonds);
  if (s->lattice) rows_free(s->lattice);
  diag_clear(&s->run.said);
  source_clear(&s->run.sources);
  arena_free(s->run.memory);
}

static void must_be_good(const sample *s) {
  if (!s->fields) small_print(&s->run);
  assert_non_null(s->fields);
}

static double value_at(const sample *s, long bond) {
  return s->fields->value[0][s->bonds[bond].slot];
}

static double lognormal_E_below(double x) {
  const double sigma = sqrt(log(1 + 0.04)), mu = log(30e9) - sigma * sigma / 2;
  return normal_below((log(x) - mu) / sigma);
}

static void bonds_of_a_lattice_follow_the_distribution(void **state) {
  (void)state;
  sample s;
  sample_open(&s, "distribution = 'lognormal' cv = 0.2", 17, 0, 0, 2, 1, "");
  must_be_good(&s);
  const long n = s.lattice->bond_count;
  double *values = must_calloc((size_t)n, sizeof *values), low = INFINITY, high = 0;
  for (long m = 0; m < n; m++) {
    values[m] = value_at(&s, m);
    low = fmin(low, values[m]);
    high = fmax(high, values[m]);
  }
  assert_true(s.fields->smallest[0] == low && s.fields->largest[0] == high);
  assert_true(fabs(s.run.parameters[ELASTIC_E] / 30e9 - 1) < 1e-14);
  check_values("bonds", values, n, 30e9, 0.2, lognormal_E_below);
  free(values);
  sample_close(&s);
}

/* Mean of two independent values: half the variance; two bonds that share a particle: correlation
   one half. */
static void bonds_share_the_values_of_particles(void **state) {
  (void)state;
  sample s;
  sample_open(&s, "on = 'particle' distribution = 'normal' cv = 0.1", 0, 0, 0, 2, 2, "");
  must_be_good(&s);
  const rows *w = s.lattice;
  double variance = 0, product = 0;
  long n = 0, pairs = 0;
  for (long m = 0; m < w->bond_count; m++) {
    const double d = (value_at(&s, m) - 30e9) / 3e9;
    variance += d * d;
    n++;
    if (s.bonds[m].slot / w->size)
      continue; /* the next bond of the same row begins where this ends */
    const int64_t next = s.bonds[m].slot + 1;
    if (!rows_has_bond(w, next, 0)) continue;
    product += d * (s.fields->value[0][next] - 30e9) / 3e9;
    pairs++;
  }
  variance /= (double)n;
  product /= (double)pairs;
  print_message("values of particles: variance %.4f of theory, covariance %.4f of theory\n",
                2 * variance, 4 * product);
  /* the 120 000 bonds hang together over 47 000 particles */
  assert_true(fabs(2 * variance - 1) < 0.03);
  assert_true(fabs(4 * product - 1) < 0.05);
  sample_close(&s);
}

/* Bonds at the same place have the same bits in a smaller, a notched and a shifted body. */
static void values_belong_to_places(void **state) {
  (void)state;
  static const char *const fields[] = {
      "distribution = 'weibull' cv = 0.3", "on = 'particle' distribution = 'weibull' cv = 0.3",
      "distribution = 'weibull' cv = 0.3 correlation_length = '30 mm'"};
  for (int f = 0; f < 3; f++) {
    sample large, small;
    sample_open(&large, fields[f], 11, 0, 0, 0.5, 0.4, "");
    sample_open(&small, fields[f], 11, 0.1, 0.05, 0.3, 0.2,
                "&notch lattice = 'c' shape = 'disc' centre = 0.2, 0.1 radius = 0.03 /\n");
    must_be_good(&large);
    must_be_good(&small);
    long found = 0;
    for (long m = 0; m < small.lattice->bond_count; m++)
      for (long n = 0; n < large.lattice->bond_count; n++) {
        const rows *a = small.lattice, *b = large.lattice;
        const rows_bond *p = &small.bonds[m], *q = &large.bonds[n];
        if (p->slot / a->size != q->slot / b->size) continue;
        const int64_t i = a->particle_site[p->i], j = b->particle_site[q->i];
        if (hypot(a->x[i] - b->x[j], a->y[i] - b->y[j]) > 1e-9) continue;
        /* waves see places, which are rounded differently: 1e-16 of the body's size */
        const double x = value_at(&small, m), y = value_at(&large, n);
        assert_true(f < 2 ? x == y : fabs(x / y - 1) < 1e-10);
        found++;
      }
    assert_int_equal(found, small.lattice->bond_count);
    sample_close(&large);
    sample_close(&small);
  }
}

static void threads_give_the_same_bits(void **state) {
  (void)state;
  const int before = omp_get_max_threads();
  sample s[2];
  for (int k = 0; k < 2; k++) {
    omp_set_num_threads(k ? 5 : 1);
    sample_open(&s[k], "distribution = 'uniform' cv = 0.3 correlation_length = 0.05", 0, 0, 0, 0.3,
                0.3, "");
    must_be_good(&s[k]);
  }
  omp_set_num_threads(before);
  assert_memory_equal(s[0].fields->value[0], s[1].fields->value[0],
                      (size_t)s[0].lattice->size * 3 * sizeof(double));
  for (int k = 0; k < 2; k++)
    sample_close(&s[k]);
}

/* Neighbouring bonds in a correlated field differ little: over r << L by sqrt(2) r/L deviations. */
static double roughness(int seed) {
  sample s;
  char text[128];
  snprintf(text, sizeof text, "distribution = 'normal' cv = 0.1 correlation_length = 0.1 seed = %d",
           seed);
  sample_open(&s, text, 0, 0, 0, 1, 1, "");
  must_be_good(&s);
  const rows *w = s.lattice;
  double square = 0;
  long pairs = 0;
  for (long m = 0; m < w->bond_count; m++) {
    const int64_t slot = s.bonds[m].slot;
    if (slot / w->size || !rows_has_bond(w, slot + 1, 0)) continue;
    const double d = (s.fields->value[0][slot + 1] - s.fields->value[0][slot]) / 3e9;
    square += d * d;
    pairs++;
  }
  sample_close(&s);
  return square / (double)pairs / (2 * (1 - exp(-0.01)));
}

static void correlated_fields_are_smooth(void **state) {
  (void)state;
  enum { SEEDS = 12 };
  double mean = 0, square = 0;
  for (int seed = 1; seed <= SEEDS; seed++) {
    const double r = roughness(seed);
    mean += r / SEEDS;
    square += r * r / SEEDS;
  }
  const double spread = sqrt((square - mean * mean) / (SEEDS - 1));
  print_message("neighbours in correlated fields: %.3f +- %.3f of the theoretical variance\n", mean,
                spread);
  assert_true(fabs(mean - 1) < standard_errors * spread && spread < 0.1);
}

/* --- laws of families ---

   A `law state` has its values on particles, a law of bonds as one of families on bonds, at both
   ends: on any lattice and on none. */

#define SQUARE                                                                                     \
  "&lattice name = 'c' kind = 'square' spacing = 0.01 thickness = 0.1 horizon = 1.5 /\n"           \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.6, 0.6 /\n"
#define FCC                                                                                        \
  "&lattice name = 'c' kind = 'fcc' spacing = 0.01 shells = 2 /\n"                                 \
  "&body lattice = 'c' shape = 'box' corner = 3*0 size = 3*0.2 /\n"
#define NOISE                                                                                      \
  "&lattice name = 'c' kind = 'blue_noise' spacing = 0.01 thickness = 0.1 /\n"                     \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.6, 0.6 /\n"

static void write_table(const char *path, const char *text) {
  FILE *out = fopen(path, "w");
  assert_non_null(out);
  fputs(text, out);
  assert_int_equal(fclose(out), 0);
}

static void family_open(sample *s, const char *lattice, const char *field, bool pairwise) {
  char text[2048];
  snprintf(text, sizeof text, HEAD "%s&field parameter = 'E' %s /\n", lattice, field);
  pl_law law = elastic_bar;
  law.kind = PL_STATE;
  law.pairwise = pairwise;
  law.varying_place = pairwise ? PL_ON_BOND : PL_ON_PARTICLE;
  sample_read(s, text, law);
}

static void particles_follow_the_distribution(void **state) {
  (void)state;
  static const char *const lattices[] = {SQUARE, FCC, NOISE};
  static const char *const names[] = {"square", "fcc", "blue noise"};
  for (int l = 0; l < 3; l++) {
    sample s;
    family_open(&s, lattices[l], "distribution = 'lognormal' cv = 0.2", false);
    must_be_good(&s);
    const long n = s.lattice->particle_count;
    double *values = must_calloc((size_t)n, sizeof *values);
    for (long p = 0; p < n; p++)
      values[p] = s.fields->value[0][s.lattice->particle_site[p]];
    for (long q = 0; q < s.lattice->size; q++) /* where no particle is, too */
      assert_true(s.fields->value[0][q] > 0);
    check_values(names[l], values, n, 30e9, 0.2, lognormal_E_below);
    free(values);
    sample_close(&s);
  }
}

static void bonds_of_families_have_one_value_at_both_ends(void **state) {
  (void)state;
  static const char *const lattices[] = {SQUARE, FCC, NOISE};
  static const char *const names[] = {"square", "fcc", "blue noise"};
  for (int l = 0; l < 3; l++) {
    sample s;
    family_open(&s, lattices[l], "distribution = 'lognormal' cv = 0.2", true);
    must_be_good(&s);
    const rows *w = s.lattice;
    double *values = must_calloc((size_t)w->bond_count, sizeof *values);
    for (long m = 0; m < w->bond_count; m++) {
      const long back = s.bonds[m].slot / w->size + w->directions;
      values[m] = value_at(&s, m);
      assert_true(values[m] == s.fields->value[0][back * w->size + w->particle_site[s.bonds[m].j]]);
    }
    check_values(names[l], values, w->bond_count, 30e9, 0.2, lognormal_E_below);
    free(values);
    sample_close(&s);
  }
}

/* Particles on no lattice in another order, and fewer of them, have the values of their places. */
static void values_belong_to_places_without_lattice(void **state) {
  (void)state;
  sample large, small;
  static const char field[] = "on = 'particle' distribution = 'weibull' cv = 0.3";
  enum { POINTS = 400 };
  char all[64 + 40 * POINTS], half[64 + 40 * POINTS];
  size_t a = 0, h = 0;
  a += (size_t)snprintf(all, sizeof all, "x, y, volume\n");
  h += (size_t)snprintf(half, sizeof half, "x, y, volume\n");
  for (int k = 0; k < POINTS; k++) {
    const double x = 0.01 * (k % 20) + 1e-3 * sin(3.0 * k), y = 0.01 * (k / 20);
    a += (size_t)snprintf(all + a, sizeof all - a, "%.9f, %.9f, 1e-5\n", x, y);
  }
  for (int k = POINTS - 1; k >= POINTS / 2; k--) {
    const double x = 0.01 * (k % 20) + 1e-3 * sin(3.0 * k), y = 0.01 * (k / 20);
    h += (size_t)snprintf(half + h, sizeof half - h, "%.9f, %.9f, 1e-5\n", x, y);
  }
  write_table("all_places.csv", all);
  write_table("half_places.csv", half);
  family_open(&large,
              "&lattice name = 'c' kind = 'particles' file = 'all_places.csv' thickness = 0.1 /\n",
              field, false);
  family_open(&small,
              "&lattice name = 'c' kind = 'particles' file = 'half_places.csv' thickness = 0.1 /\n",
              field, false);
  must_be_good(&large);
  must_be_good(&small);
  for (long p = 0; p < small.lattice->particle_count; p++) {
    const long other = POINTS - 1 - p;
    assert_true(small.fields->value[0][small.lattice->particle_site[p]] ==
                large.fields->value[0][large.lattice->particle_site[other]]);
  }
  sample_close(&large);
  sample_close(&small);
  unlink("all_places.csv");
  unlink("half_places.csv");
}

static void families_have_no_values_on_bonds(void **state) {
  (void)state;
  sample s;
  family_open(&s, SQUARE, "on = 'bond' distribution = 'normal' cv = 0.1", false);
  assert_null(s.fields);
  assert_true(s.run.said.items[0].code == DIAG_NOT_SUPPORTED &&
              strstr(s.run.said.items[0].message, "have values on particles"));
  sample_close(&s);
}

static void clipped_values_stand_at_both_ends(void **state) {
  (void)state;
  sample s;
  family_open(&s, SQUARE, "distribution = 'normal' cv = 0.8 clip = .true.", true);
  must_be_good(&s);
  const rows *w = s.lattice;
  long clipped = 0;
  for (long m = 0; m < w->bond_count; m++) {
    const long back = s.bonds[m].slot / w->size + w->directions;
    assert_true(value_at(&s, m) > 0);
    assert_true(value_at(&s, m) ==
                s.fields->value[0][back * w->size + w->particle_site[s.bonds[m].j]]);
    clipped += value_at(&s, m) < 1e5;
  }
  assert_true(clipped > w->bond_count / 20 && clipped < w->bond_count / 5);
  sample_close(&s);
}

/* --- what is not allowed --- */

/* The quantile of the waves at the middle of the bond. */
static void a_bond_has_the_value_of_its_middle(void **state) {
  (void)state;
  sample s;
  random_distribution d;
  char error[128];
  sample_open(&s, "distribution = 'weibull' cv = 0.3 correlation_length = '30 mm'", 11, 0, 0, 0.3,
              0.2, "");
  must_be_good(&s);
  const deck_field *f = &s.run.deck->fields[0];
  assert_true(random_distribution_of(f, 30e9, &d, error, sizeof error));
  random_waves *w = random_waves_new(random_seed_of(f), 0.03);
  const rows *g = s.lattice;
  for (long m = 0; m < g->bond_count; m++) {
    const int64_t i = g->particle_site[s.bonds[m].i], j = g->particle_site[s.bonds[m].j];
    const double middle[3] = {0.5 * (g->x[i] + g->x[j]), 0.5 * (g->y[i] + g->y[j]), 0};
    assert_true(fabs(value_at(&s, m) / random_quantile(&d, random_waves_at(w, middle)) - 1) < 1e-9);
  }
  random_waves_free(w);
  sample_close(&s);
}

static void expect_refusal(const char *field, diag_code code, const char *text) {
  sample s;
  sample_open(&s, field, 0, 0, 0, 0.2, 0.2, "");
  bool said = false;
  for (int k = 0; k < s.run.said.count; k++)
    said |= s.run.said.items[k].code == code && strstr(s.run.said.items[k].message, text);
  if (!said || s.fields) {
    print_error("expected \"%s\" of %s\n", text, field);
    small_print(&s.run);
    fail();
  }
  sample_close(&s);
}

static void forbidden_values_are_told_with_their_place(void **state) {
  (void)state;
  expect_refusal("distribution = 'normal' cv = 0.8", DIAG_OUT_OF_BOUNDS,
                 "mm is not in (0, inf), the range of the law `elastic_bar`; so are");
  expect_refusal("distribution = 'uniform' low = '-1 GPa' high = '40 GPa'", DIAG_OUT_OF_BOUNDS,
                 "`E` = -");
  expect_refusal("distribution = 'normal' mean = '3 mm' cv = 0.1", DIAG_UNITS,
                 "`mean` of a field of `E` needs");
  expect_refusal("distribution = 'lognormal' mean = -3 cv = 0.1", DIAG_BAD_VALUE, "positive mean");
  expect_refusal("distribution = 'normal'", DIAG_MISSING_KEY, "a normal distribution needs `cv`");
  expect_refusal("distribution = 'weibull'", DIAG_MISSING_KEY, "needs `shape` or `cv`");
  expect_refusal("distribution = 'uniform' low = 1", DIAG_MISSING_KEY, "belong together");
  expect_refusal("distribution = 'uniform' low = 2 high = 1", DIAG_OUT_OF_BOUNDS, "larger than");
  expect_refusal("distribution = 'uniform' low = 2 high = 3 cv = 0.1", DIAG_CONFLICT, "exclude");
  expect_refusal("distribution = 'weibull' shape = 2 cv = 0.1", DIAG_CONFLICT, "exclude");
  expect_refusal("distribution = 'normal' shape = 2 cv = 0.1", DIAG_UNKNOWN_KEY,
                 "`shape` does not go with a normal distribution");
  expect_refusal("distribution = 'normal' cv = 0.1 /\n&field parameter = 'e' cv = 0.2 distribution "
                 "= 'normal'",
                 DIAG_CONFLICT, "`e` has a random field already");
}

/* About a tenth of the values would be negative. */
static void clipping_moves_values_to_the_bound(void **state) {
  (void)state;
  sample s;
  sample_open(&s, "distribution = 'normal' cv = 0.8 clip = .true.", 0, 0, 0, 1, 1, "");
  must_be_good(&s);
  long at_bound = 0;
  for (long m = 0; m < s.lattice->bond_count; m++) {
    assert_true(value_at(&s, m) >= 30e3 * (1 - 1e-12)); /* a millionth of the mean inside */
    at_bound += value_at(&s, m) < 31e3;
  }
  const double n = (double)s.lattice->bond_count, p = normal_below(-1 / 0.8);
  assert_true(fabs((double)at_bound - n * p) < standard_errors * sqrt(n * p * (1 - p)));
  sample_close(&s);
}

static void a_kernel_without_the_parameter_is_refused(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &elastic_bar,
             HEAD "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
                  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.1 /\n"
                  "&field parameter = 'E' distribution = 'normal' cv = 0.1 /\n");
  assert_null(r.simulation);
  assert_int_equal(r.said.items[0].code, DIAG_NOT_SUPPORTED);
  assert_non_null(strstr(r.said.items[0].message, "the same everywhere"));
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(values_follow_their_distribution),
      cmocka_unit_test(quantiles_invert_the_distribution),
      cmocka_unit_test(impossible_distributions_are_refused),
      cmocka_unit_test(neighbours_directions_and_seeds_are_independent),
      cmocka_unit_test(correlation_falls_with_distance),
      cmocka_unit_test(bonds_of_a_lattice_follow_the_distribution),
      cmocka_unit_test(bonds_share_the_values_of_particles),
      cmocka_unit_test(values_belong_to_places),
      cmocka_unit_test(threads_give_the_same_bits),
      cmocka_unit_test(correlated_fields_are_smooth),
      cmocka_unit_test(a_bond_has_the_value_of_its_middle),
      cmocka_unit_test(forbidden_values_are_told_with_their_place),
      cmocka_unit_test(clipping_moves_values_to_the_bound),
      cmocka_unit_test(particles_follow_the_distribution),
      cmocka_unit_test(bonds_of_families_have_one_value_at_both_ends),
      cmocka_unit_test(values_belong_to_places_without_lattice),
      cmocka_unit_test(families_have_no_values_on_bonds),
      cmocka_unit_test(clipped_values_stand_at_both_ends),
      cmocka_unit_test(a_kernel_without_the_parameter_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
