#include "runtime/lattice/random_field.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/random_number.h"
#include "runtime/base/special_functions.h"

/* --- numbers from places ---------------------------------------------------------------------- */

/* Box and Muller (1958). */
static double normal_number(uint64_t key) {
  const double radius = sqrt(-2 * pl_log(random_unit(random_mix(key))));
  const double turn = random_unit(random_mix(key ^ UINT64_C(0x5851f42d4c957f2d)));
  return radius * special_cosine_of_turns(turn);
}

double random_normal_of_site(uint64_t seed, int64_t a, int64_t b, int64_t c, int direction) {
  const uint64_t of_layer = seed + (uint64_t)c * UINT64_C(0xd1342543de82ef95);
  return normal_number(random_mix(random_mix(random_mix(of_layer) ^ (uint64_t)a) ^ (uint64_t)b) ^
                       (uint64_t)(direction + 1));
}

static uint64_t key_of_place(uint64_t seed, const double at[3]) {
  for (int c = 0; c < 3; c++) {
    const double here = at[c] + 0.0; /* no minus before zeros */
    uint64_t bits;
    memcpy(&bits, &here, sizeof bits);
    seed = random_mix(seed ^ bits);
  }
  return seed;
}

double random_normal_of_place(uint64_t seed, const double at[3]) {
  return normal_number(key_of_place(seed, at));
}

double random_normal_between(uint64_t seed, const double at[3], const double end[3]) {
  return normal_number(random_mix(key_of_place(seed, at) + key_of_place(seed, end)));
}

uint64_t random_seed_of(const deck_field *f) {
  uint64_t seed = random_mix((uint64_t)f->seed);
  for (const char *c = f->parameter; *c; c++)
    seed = random_mix(seed ^ (uint64_t)(unsigned char)tolower((unsigned char)*c));
  return seed;
}

/* --- waves ------------------------------------------------------------------------------------ */

enum { WAVES = 512 };

struct random_waves {
  double k[3][WAVES], phase[WAVES]; /* turns/m, turns */
};

random_waves *random_waves_new(uint64_t seed, double correlation_length) {
  random_waves *w = must_alloc(sizeof *w);
  /* E cos(k.r) = exp(-(r/L)^2) */
  const double spread = sqrt(2) / (2 * M_PI * correlation_length);
  for (int m = 0; m < WAVES; m++) {
    const uint64_t key = random_mix(seed ^ random_mix((uint64_t)m));
    /* normal components: |k| has the probability exp(-k^2/2) of more; one wave in each of equally
     * probable rings */
    const double radius =
        spread * sqrt(-2 * pl_log((m + random_unit(random_mix(key ^ 1))) / WAVES));
    const double angle = 2 * M_PI * random_unit(random_mix(key ^ 2));
    w->k[0][m] = radius * pl_cos(angle);
    w->k[1][m] = radius * pl_sin(angle);
    w->k[2][m] = spread * normal_number(random_mix(key ^ 4));
    w->phase[m] = random_unit(random_mix(key ^ 3));
  }
  return w;
}

void random_waves_free(random_waves *w) {
  free(w);
}

/* Added in halves, as vectors add. */
double random_waves_at(const random_waves *w, const double at[3]) {
  double wave[WAVES];
  for (int m = 0; m < WAVES; m++)
    wave[m] = special_cosine_of_turns(w->k[0][m] * at[0] + w->k[1][m] * at[1] + w->k[2][m] * at[2] +
                                      w->phase[m]);
  for (int half = WAVES / 2; half > 0; half /= 2)
    for (int m = 0; m < half; m++)
      wave[m] += wave[m + half];
  return sqrt(2.0 / WAVES) * wave[0];
}

/* --- distributions ---------------------------------------------------------------------------- */

/* Coefficient of variation of a Weibull distribution. */
static double weibull_cv(double shape) {
  const double ratio = special_log_gamma(2 / shape) - 2 * special_log_gamma(1 / shape);
  return sqrt(special_expm1(ratio));
}

/* The cv falls with the shape, by bisection of its logarithm. */
static double weibull_shape(double cv) {
  double low = pl_log(0.05), high = pl_log(1e4);
  for (int n = 0; n < 100; n++) {
    const double middle = 0.5 * (low + high);
    if (weibull_cv(pl_exp(middle)) > cv)
      low = middle;
    else
      high = middle;
  }
  return pl_exp(0.5 * (low + high));
}

static bool refuse(char *error, size_t size, const char *text) {
  snprintf(error, size, "%s", text);
  return false;
}

bool random_distribution_of(const deck_field *f, double own, random_distribution *out, char *error,
                            size_t size) {
  const double mean = f->mean.given ? f->mean.value : own, deviation = fabs(mean) * f->cv;
  *out = (random_distribution){.kind = f->kind};
  if (f->kind != FIELD_NORMAL && !f->low.given && !f->scale.given && !(mean > 0) &&
      f->kind != FIELD_UNIFORM)
    return refuse(error, size, "a lognormal or Weibull distribution has a positive mean");
  if (f->cv > 0 && mean == 0) return refuse(error, size, "a mean of 0 has no `cv`");
  switch (f->kind) {
  case FIELD_UNIFORM:
    out->a = f->low.given ? f->low.value : mean - sqrt(3) * deviation;
    out->b = f->low.given ? f->high.value : mean + sqrt(3) * deviation;
    break;
  case FIELD_NORMAL:
    out->a = mean;
    out->b = deviation;
    break;
  case FIELD_LOGNORMAL:
    out->b = sqrt(special_log1p(f->cv * f->cv));
    out->a = pl_log(mean) - 0.5 * out->b * out->b;
    break;
  case FIELD_WEIBULL:
    out->b = f->shape > 0 ? f->shape : weibull_shape(f->cv);
    out->a = f->scale.given ? f->scale.value : mean / special_gamma(1 / out->b);
    if (!(out->a > 0))
      return refuse(error, size, "the scale of a Weibull distribution is positive");
    break;
  }
  if (!isfinite(out->a) || !isfinite(out->b) ||
      (f->kind == FIELD_WEIBULL && (out->b < 0.05 || out->b > 1e4)))
    return refuse(error, size, "there is no such distribution");
  return true;
}

double random_distribution_mean(const random_distribution *r) {
  switch (r->kind) {
  case FIELD_UNIFORM:
    return 0.5 * (r->a + r->b);
  case FIELD_NORMAL:
    return r->a;
  case FIELD_LOGNORMAL:
    return pl_exp(r->a + 0.5 * r->b * r->b);
  default:
    return r->a * special_gamma(1 / r->b);
  }
}

double random_distribution_deviation(const random_distribution *r) {
  switch (r->kind) {
  case FIELD_UNIFORM:
    return (r->b - r->a) / sqrt(12);
  case FIELD_NORMAL:
    return r->b;
  case FIELD_LOGNORMAL:
    return random_distribution_mean(r) * sqrt(special_expm1(r->b * r->b));
  default:
    return random_distribution_mean(r) * weibull_cv(r->b);
  }
}

/* -log(1 - Phi(z)), without cancellation on either side. */
static double hazard(double z) {
  return z < 0 ? -special_log1p(-special_normal_above(-z)) : -pl_log(special_normal_above(z));
}

double random_quantile(const random_distribution *r, double z) {
  switch (r->kind) {
  case FIELD_UNIFORM:
    return r->a + (r->b - r->a) * special_normal_above(-z);
  case FIELD_NORMAL:
    return r->a + r->b * z;
  case FIELD_LOGNORMAL:
    return pl_exp(r->a + r->b * z);
  default:
    return r->a * pl_pow(hazard(z), 1 / r->b);
  }
}
