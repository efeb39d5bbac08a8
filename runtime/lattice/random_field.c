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

/* --- on a lattice ----------------------------------------------------------------------------- */

typedef struct field_source {
  const deck_field *field;
  const rows *rows;
  random_distribution distribution;
  uint64_t seed;
  random_waves *waves; /* NULL without correlation */
} field_source;

/* The number that belongs to a site and a direction, from the site's place in the infinite lattice:
   the row and layer it is in, and its column along the lattice vectors. */
static double normal_of(const field_source *s, int64_t site, int direction) {
  const bravais *b = &s->rows->infinite;
  double at[3], number[3];
  rows_place(s->rows, site, at);
  bravais_coordinates(b, at, number);
  const int64_t row = llround(number[1]), layer = llround(number[2]);
  const int64_t halves = b->shift_by[0] * row + b->shift_by[1] * layer;
  const int64_t column = llround(number[0] - 0.5 * (double)halves);
  return random_normal_of_site(s->seed, column, row, layer, direction);
}

static double value_of_particle(const field_source *s, int64_t site) {
  double at[3];
  rows_place(s->rows, site, at);
  return random_quantile(&s->distribution,
                         s->waves ? random_waves_at(s->waves, at) : normal_of(s, site, -1));
}

static double value_of_bond(const field_source *s, int64_t site, int64_t partner, int direction) {
  double at[3], end[3];
  if (s->field->on_particles)
    return 0.5 * (value_of_particle(s, site) + value_of_particle(s, partner));
  rows_place(s->rows, site, at);
  rows_place(s->rows, partner, end);
  for (int c = 0; c < 3; c++)
    at[c] = 0.5 * (at[c] + end[c]);
  return random_quantile(&s->distribution,
                         s->waves ? random_waves_at(s->waves, at) : normal_of(s, site, direction));
}

static void ends_of(const rows *w, const rows_bond *b, int64_t *site, int64_t *partner) {
  *site = w->particle_site[b->i];
  *partner = w->particle_site[b->j];
}

static void fill_plane(const field_source *s, const rows_bond *bonds, double *plane) {
  const rows *w = s->rows;
  const double mean = random_distribution_mean(&s->distribution);
  for (long q = 0; q < w->directions * w->size; q++)
    plane[q] = mean;
#pragma omp parallel for schedule(static)
  for (long m = 0; m < w->bond_count; m++) {
    int64_t site, partner;
    ends_of(w, &bonds[m], &site, &partner);
    plane[bonds[m].slot] = value_of_bond(s, site, partner, (int)(bonds[m].slot / w->size));
  }
}

/* --- what the law allows ---------------------------------------------------------------------- */

typedef struct bounds_of {
  double *values, *lower, *upper; /* [parameters] */
  unsigned char *low_open, *high_open;
} bounds_of;

static bounds_of bounds_new(const pl_law *law, const double *parameters) {
  const size_t n = (size_t)law->parameter_count + 1;
  bounds_of b = {must_calloc(n, sizeof(double)), must_calloc(n, sizeof(double)),
                 must_calloc(n, sizeof(double)), must_calloc(n, 1), must_calloc(n, 1)};
  memcpy(b.values, parameters, (n - 1) * sizeof(double));
  return b;
}

static void bounds_free(bounds_of *b) {
  free(b->values);
  free(b->lower);
  free(b->upper);
  free(b->low_open);
  free(b->high_open);
}

static bool is_allowed(const bounds_of *b, int p) {
  const double v = b->values[p];
  return isfinite(v) && (b->low_open[p] ? v > b->lower[p] : v >= b->lower[p]) &&
         (b->high_open[p] ? v < b->upper[p] : v <= b->upper[p]);
}

/* The nearest allowed value; a millionth inside an end that does not belong to the range. */
static double clipped(const bounds_of *b, int p, double mean) {
  const double step = 1e-6 * fabs(mean), v = b->values[p];
  const double low = b->lower[p] + (b->low_open[p] ? step : 0),
               high = b->upper[p] - (b->high_open[p] ? step : 0);
  return v < low ? low : v > high ? high : v;
}

/* First parameter out of its range at the values at hand, or -1. */
static int first_fault(const pl_law *law, bounds_of *b) {
  law->bounds(law, b->values, b->lower, b->upper, b->low_open, b->high_open);
  for (int p = 0; p < law->parameter_count; p++)
    if (!is_allowed(b, p)) return p;
  return -1;
}

static int plane_of(const pl_law *law, int parameter) {
  for (int k = 0; k < law->varying_count; k++)
    if (law->varying[k] == parameter) return k;
  return -1;
}

static void report_fault(const rows *w, const rows_bond *bond, const pl_law *law,
                         const field_source *sources, const bounds_of *b, int fault, long count,
                         diagnostics *d) {
  int64_t site, partner;
  ends_of(w, bond, &site, &partner);
  const int plane = plane_of(law, fault);
  const deck_field *f = sources[plane < 0 ? 0 : plane].field;
  const char *in = law->parameters[fault].unit;
  const bool pure = !in || !*in || strcmp(in, "1") == 0;
  double ends[2][3];
  char texts[2][ROWS_PLACE_TEXT];
  rows_place(w, site, ends[0]);
  rows_place(w, partner, ends[1]);
  diag_report(
      d, DIAG_OUT_OF_BOUNDS, f->item.where,
      "`%s` = %.6g%s%s in the bond from %s to %s is not in %c%.6g, %.6g%c, the range of the "
      "law `%s`; so are %ld of %ld bonds",
      law->parameters[fault].name, b->values[fault], pure ? "" : " ", pure ? "" : in,
      rows_place_text(w->dimensions, ends[0], texts[0]),
      rows_place_text(w->dimensions, ends[1], texts[1]), b->low_open[fault] ? '(' : '[',
      b->lower[fault], b->upper[fault], b->high_open[fault] ? ')' : ']', law->name, count,
      w->bond_count);
  diag_hint(d, "take a distribution that stays inside, a smaller `cv`, or clip = .true. for the "
               "nearest allowed value");
}

/* Clips where the deck wants it; false after a message when values stay out of the law's ranges. A
   range may depend on other parameters: those of the same bond. */
static bool check_bonds(random_fields *r, const rows *w, const rows_bond *bonds, const pl_law *law,
                        const field_source *sources, const double *parameters, diagnostics *d) {
  bounds_of b = bounds_new(law, parameters), first = bounds_new(law, parameters);
  long faults = 0, first_bond = -1;
  int first_parameter = -1;
  for (long m = 0; m < w->bond_count; m++) {
    for (int k = 0; k < r->count; k++)
      b.values[law->varying[k]] = r->value[k][bonds[m].slot];
    int fault = first_fault(law, &b);
    for (int tries = 0; fault >= 0 && tries < r->count; tries++) {
      const int plane = plane_of(law, fault);
      if (plane < 0 || !sources[plane].field->clip || isnan(b.values[fault])) break;
      b.values[fault] = clipped(&b, fault, parameters[fault]);
      r->value[plane][bonds[m].slot] = b.values[fault];
      fault = first_fault(law, &b);
    }
    if (fault >= 0 && faults++ == 0) {
      first_bond = m;
      first_parameter = fault;
      memcpy(first.values, b.values, (size_t)law->parameter_count * sizeof(double));
    }
  }
  if (faults) {
    first_fault(law, &first);
    report_fault(w, &bonds[first_bond], law, sources, &first, first_parameter, faults, d);
  }
  bounds_free(&b);
  bounds_free(&first);
  return faults == 0;
}

static void find_extremes(random_fields *r, const rows *w, const rows_bond *bonds,
                          const double *parameters, const pl_law *law) {
  for (int k = 0; k < r->count; k++) {
    double low = INFINITY, high = -INFINITY;
    for (long m = 0; m < w->bond_count; m++) {
      low = pl_fmin(low, r->value[k][bonds[m].slot]);
      high = pl_fmax(high, r->value[k][bonds[m].slot]);
    }
    r->smallest[k] = w->bond_count ? low : parameters[law->varying[k]];
    r->largest[k] = w->bond_count ? high : parameters[law->varying[k]];
  }
}

/* --- all fields of a lattice ------------------------------------------------------------------ */

static bool fits(const deck_field *f, const deck_number *n, const char *key, const pl_parameter *p,
                 diagnostics *d) {
  const char *bad;
  size_t bad_length;
  unit wanted = {.dim = DIMENSIONLESS, .factor = 1};
  if (p->unit && *p->unit) (void)unit_parse(p->unit, strlen(p->unit), &wanted, &bad, &bad_length);
  if (!n->given || !n->has_unit || dim_equal(n->dim, wanted.dim)) return true;
  char given[80], needed[80];
  dim_describe(n->dim, given, sizeof given);
  dim_describe(wanted.dim, needed, sizeof needed);
  diag_report(d, DIAG_UNITS, deck_where(&f->item, key),
              "`%s` of a field of `%s` needs %s, this is %s", key, p->name, needed, given);
  return false;
}

static bool units_fit(const deck_field *f, const pl_parameter *p, diagnostics *d) {
  const bool mean = fits(f, &f->mean, "mean", p, d), low = fits(f, &f->low, "low", p, d);
  const bool high = fits(f, &f->high, "high", p, d), scale = fits(f, &f->scale, "scale", p, d);
  return mean && low && high && scale;
}

/* Position of the field's parameter in law->varying, or -1 after a message. */
static int find_plane(const deck_field *f, const pl_law *law, diagnostics *d) {
  for (int k = 0; k < law->varying_count; k++)
    if (strcasecmp(law->parameters[law->varying[k]].name, f->parameter) == 0) return k;
  diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&f->item, "parameter"),
              "the kernel of `%s` was made for a `%s` that is the same in all bonds", law->name,
              f->parameter);
  diag_hint(d, "use `perilat run`, or build the solver from this deck again");
  return -1;
}

static bool open_source(const deck_field *f, const rows *w, const pl_parameter *p, double *own,
                        field_source *s, diagnostics *d) {
  char error[128];
  if (!units_fit(f, p, d)) return false;
  *s = (field_source){.field = f, .rows = w, .seed = random_seed_of(f)};
  if (!random_distribution_of(f, *own, &s->distribution, error, sizeof error)) {
    diag_report(d, DIAG_BAD_VALUE, f->item.where, "%s", error);
    return false;
  }
  *own = random_distribution_mean(&s->distribution);
  if (f->correlation_length > 0) s->waves = random_waves_new(s->seed, f->correlation_length);
  return true;
}

static bool open_sources(const deck *k, int lattice, const rows *w, const pl_law *law,
                         double *parameters, field_source *sources, diagnostics *d) {
  bool good = true;
  for (int i = 0; i < k->field_count; i++) {
    const deck_field *f = &k->fields[i];
    if (strcmp(f->lattice, k->lattices[lattice].name) != 0) continue;
    const int plane = find_plane(f, law, d);
    if (plane < 0) {
      good = false;
      continue;
    }
    const int p = law->varying[plane];
    good = open_source(f, w, &law->parameters[p], &parameters[p], &sources[plane], d) && good;
  }
  return good;
}

static double *new_plane(random_fields *r, const rows *w) {
  const size_t bytes = (size_t)w->directions * (size_t)w->size * sizeof(double);
  r->bytes += bytes;
  return must_align(PL_ALIGNMENT, bytes);
}

random_fields *random_fields_new(const deck *k, int lattice, const rows *w, const pl_law *law,
                                 double *parameters, diagnostics *d) {
  const size_t count = (size_t)law->varying_count;
  random_fields *r = must_calloc(1, sizeof *r);
  field_source *sources = must_calloc(count + 1, sizeof *sources);
  rows_bond *bonds = rows_bonds(w);
  r->count = law->varying_count;
  r->value = must_calloc(count + 1, sizeof *r->value);
  r->smallest = must_calloc(count + 1, sizeof *r->smallest);
  r->largest = must_calloc(count + 1, sizeof *r->largest);
  bool good = open_sources(k, lattice, w, law, parameters, sources, d);
  for (int n = 0; good && n < r->count; n++) {
    r->value[n] = new_plane(r, w);
    if (sources[n].field)
      fill_plane(&sources[n], bonds, r->value[n]);
    else /* a kernel made for more fields than this deck has */
      for (long q = 0; q < w->directions * w->size; q++)
        r->value[n][q] = parameters[law->varying[n]];
  }
  good = good && check_bonds(r, w, bonds, law, sources, parameters, d);
  if (good) find_extremes(r, w, bonds, parameters, law);
  for (size_t n = 0; n < count; n++)
    random_waves_free(sources[n].waves);
  free(sources);
  free(bonds);
  if (good) return r;
  random_fields_free(r);
  return NULL;
}

void random_fields_free(random_fields *f) {
  if (!f) return;
  for (int k = 0; k < f->count; k++)
    free(f->value[k]);
  free(f->value);
  free(f->smallest);
  free(f->largest);
  free(f);
}
