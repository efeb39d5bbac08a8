#include "runtime/lattice/parameter_planes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/base/hash.h"
#include "dsl/semantics/formula.h"
#include "runtime/base/quantity.h"
#include "runtime/deck/deck_formula.h"
#include "runtime/lattice/placed_values.h"
#include "runtime/lattice/random_field.h"
#include "runtime/lattice/rows_select.h"

/* --- places of values ------------------------------------------------------------------------- */

/* Where the law reads values. */
typedef struct value_places {
  const rows *rows;
  const pl_law *law;
  const unsigned char *own; /* [size] 1 at the particles that are the law's; NULL: all */
  rows_bond *bonds;         /* NULL: on particles */
  long count;               /* particles or bonds */
} value_places;

/* A particle (partner < 0), or a bond from its owner to the partner, whose value stands at the
   owner and in laws of families at the other end, too (`back`; else < 0). */
typedef struct value_place {
  int64_t site, partner, at, back;
  int direction;
} value_place;

static bool on_particles(const value_places *p) {
  return p->bonds == NULL;
}

static value_places places_new(const rows *w, const unsigned char *own, const pl_law *law) {
  const bool particles = law->varying_place == PL_ON_PARTICLE || law->kind == PL_CONTINUUM;
  return (value_places){.rows = w,
                        .law = law,
                        .own = own,
                        .bonds = particles ? NULL : rows_bonds(w),
                        .count = particles ? w->particle_count : w->bond_count};
}

/* Whatever the law reads. */
static value_places places_of_particles(const value_places *p) {
  return (value_places){
      .rows = p->rows, .law = p->law, .own = p->own, .count = p->rows->particle_count};
}

static value_place place_of(const value_places *p, long m) {
  const rows *w = p->rows;
  if (on_particles(p)) {
    const int64_t site = w->particle_site[m];
    return (value_place){.site = site, .partner = -1, .at = site, .back = -1};
  }
  const rows_bond *b = &p->bonds[m];
  const int direction = (int)(b->slot / w->size);
  const int64_t partner = w->particle_site[b->j];
  const bool both = p->law->kind == PL_STATE;
  return (value_place){.site = w->particle_site[b->i],
                       .partner = partner,
                       .at = b->slot,
                       .back = both ? (direction + w->directions) * w->size + partner : -1,
                       .direction = direction};
}

/* The law reads the value there: of a bond that is one of its own, of a particle where it is. */
static bool is_read(const value_places *p, const value_place *at) {
  return at->partner >= 0 || !p->own || p->own[at->site];
}

/* Site arrays of a plane. */
static long planes_of(const value_places *p) {
  if (on_particles(p)) return 1;
  return p->law->kind == PL_STATE ? 2 * p->rows->directions : p->rows->directions;
}

static void put(double *plane, const value_place *at, double value) {
  plane[at->at] = value;
  if (at->back >= 0) plane[at->back] = value;
}

/* --- random fields ---------------------------------------------------------------------------- */

typedef struct field_source {
  const deck_field *field; /* NULL: the values of regions */
  const rows *rows;
  random_distribution distribution;
  uint64_t seed;
  random_waves *waves; /* NULL without correlation */
  bool of_particles;   /* a bond has the mean of its ends */
} field_source;

/* The number that belongs to a site and a direction, from the site's place in the infinite lattice:
   the row and layer it is in, and its column along the lattice vectors. */
static double normal_of(const field_source *s, int64_t site, int direction) {
  const bravais *b = &s->rows->infinite;
  double at[3], number[3];
  rows_place(s->rows, site, at);
  if (s->rows->list) return random_normal_of_place(s->seed, at);
  bravais_coordinates(b, at, number);
  const int64_t row = llround(number[1]), layer = llround(number[2]);
  const int64_t halves = b->shift_by[0] * row + b->shift_by[1] * layer;
  const int64_t column = llround(number[0] - 0.5 * (double)halves);
  return random_normal_of_site(s->seed, column, row, layer, direction);
}

static double field_of_particle(const field_source *s, int64_t site) {
  double at[3];
  rows_place(s->rows, site, at);
  return random_quantile(&s->distribution,
                         s->waves ? random_waves_at(s->waves, at) : normal_of(s, site, -1));
}

static double normal_of_bond(const field_source *s, const value_place *b) {
  double at[3], end[3];
  rows_place(s->rows, b->site, at);
  rows_place(s->rows, b->partner, end);
  if (!s->waves && s->rows->list) return random_normal_between(s->seed, at, end);
  if (!s->waves) return normal_of(s, b->site, b->direction);
  for (int c = 0; c < 3; c++)
    at[c] = 0.5 * (at[c] + end[c]);
  return random_waves_at(s->waves, at);
}

static double field_value(const field_source *s, const value_place *at) {
  if (at->partner < 0) return field_of_particle(s, at->site);
  if (s->of_particles)
    return 0.5 * (field_of_particle(s, at->site) + field_of_particle(s, at->partner));
  return random_quantile(&s->distribution, normal_of_bond(s, at));
}

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

static bool is_density(const pl_law *law, const pl_parameter *p) {
  return law->density >= 0 && p == &law->parameters[law->density];
}

static bool place_fits(const deck_field *f, const value_places *p, const pl_parameter *of,
                       diagnostics *d) {
  const bool density = is_density(p->law, of);
  if (!(on_particles(p) || density) || f->on != FIELD_ON_BONDS) return true;
  if (density) {
    diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&f->item, "on"),
                "`%s` is the density of the particles: bonds have no mass", of->name);
    diag_hint(d, "leave `on` away, or write on = 'particle'");
    return false;
  }
  diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&f->item, "on"),
              "the law `%s` reads whole families: its parameters have values on particles",
              p->law->name);
  diag_hint(d, "leave `on` away, or write on = 'particle'");
  return false;
}

static bool open_source(const deck_field *f, const value_places *places, const pl_parameter *p,
                        double *own, field_source *s, diagnostics *d) {
  char error[128];
  if (!units_fit(f, p, d) || !place_fits(f, places, p, d)) return false;
  *s = (field_source){.field = f,
                      .rows = places->rows,
                      .seed = random_seed_of(f),
                      .of_particles = f->on == FIELD_ON_PARTICLES || is_density(places->law, p)};
  if (!random_distribution_of(f, *own, &s->distribution, error, sizeof error)) {
    diag_report(d, DIAG_BAD_VALUE, f->item.where, "%s", error);
    return false;
  }
  *own = random_distribution_mean(&s->distribution);
  if (f->correlation_length > 0) s->waves = random_waves_new(s->seed, f->correlation_length);
  return true;
}

/* --- where values come from ------------------------------------------------------------------- */

typedef struct value_sources {
  const value_places *places;
  const deck_material *whole; /* of the law where no region says otherwise */
  const unsigned char *own;   /* [size] 1 where a particle is of the law; NULL: everywhere */
  const double *parameters;
  field_source *field; /* [varying] */
  const regional_values *regional;
  /* [varying] for the material without region, then for each with one: NULL where it is a number */
  const deck_assignment **placed;
  double **of_file; /* the same: [size] what a file says; NULL where none does */
  int regions;
  int *region_of;        /* [size] number in `regional`, or -1: the material without region; NULL */
  const double *density; /* [size] of particles, once it is known; NULL where all have one */
  double time;           /* s */
} value_sources;

/* Position of a parameter in law->varying, or -1 after a message. */
static int find_plane(const pl_law *law, const char *name, span where, diagnostics *d) {
  for (int k = 0; k < law->varying_count; k++)
    if (strcasecmp(law->parameters[law->varying[k]].name, name) == 0) return k;
  diag_report(d, DIAG_NOT_SUPPORTED, where,
              "the kernel of `%s` was made for a `%s` that is the same everywhere", law->name,
              name);
  diag_hint(d, "use `perilat run`, or build the solver from this deck again");
  return -1;
}

static bool open_fields(const deck *k, int lattice, double *parameters, value_sources *s,
                        diagnostics *d) {
  const pl_law *law = s->places->law;
  bool good = true;
  for (int i = 0; i < k->field_count; i++) {
    const deck_field *f = &k->fields[i];
    if (!f->random || strcmp(f->lattice, k->lattices[lattice].name) != 0 || s->whole->region ||
        s->whole->between[0])
      continue;
    const int plane = find_plane(law, f->parameter, deck_where(&f->item, "parameter"), d);
    if (plane < 0) {
      good = false;
      continue;
    }
    const int p = law->varying[plane];
    good =
        open_source(f, s->places, &law->parameters[p], &parameters[p], &s->field[plane], d) && good;
  }
  return good;
}

static bool take_placed(value_sources *s, int region, const deck_assignment *a, diagnostics *d) {
  const pl_law *law = s->places->law;
  const int plane = find_plane(law, a->name, a->value_where, d);
  if (plane < 0) return false;
  s->placed[(region + 1) * law->varying_count + plane] = a;
  const deck_field *f = s->field[plane].field;
  if (!f) return true;
  diag_report(d, DIAG_CONFLICT, f->item.where,
              "`%s` differs at random, and the material gives it by a %s", a->name,
              a->placed->path ? "file" : "formula");
  diag_note(d, a->value_where, "the %s", a->placed->path ? "file" : "formula");
  return false;
}

static bool open_placed(int regions, value_sources *s, diagnostics *d) {
  bool good = true;
  for (int region = -1; region < regions; region++) {
    const deck_material *m = region < 0 ? s->whole : s->regional[region].material;
    for (int n = 0; n < m->assignment_count; n++)
      if (m->assignments[n].placed) good = take_placed(s, region, &m->assignments[n], d) && good;
  }
  return good;
}

/* One of a plane; or NULL. */
static const deck_assignment *any_placed(const value_sources *s, int regions, int plane) {
  for (int region = 0; region <= regions; region++) {
    const deck_assignment *a = s->placed[region * s->places->law->varying_count + plane];
    if (a) return a;
  }
  return NULL;
}

static bool report_two_materials(const value_sources *s, const regional_values *first,
                                 const regional_values *second, int64_t site, diagnostics *d) {
  double at[3];
  char text[ROWS_PLACE_TEXT];
  rows_place(s->places->rows, site, at);
  diag_report(d, DIAG_CONFLICT, deck_where(&second->material->item, "region"),
              "the particle at %s has two materials: it is in the region `%s`, too",
              rows_place_text(s->places->rows->dimensions, at, text), first->material->region);
  diag_note(d, deck_where(&first->material->item, "region"), "its first material is given here");
  diag_hint(d, "give the regions shapes that have no particle in common");
  return false;
}

/* Fills region_of; false after a message. */
static bool take_region(const deck *k, int number, value_sources *s, diagnostics *d) {
  const rows *w = s->places->rows;
  const regional_values *v = &s->regional[number];
  const int region = deck_find_region(k, v->material->region);
  int32_t *particles;
  const long count = rows_select(w, &k->regions[region].shape, &particles);
  bool good = true;
  for (long n = 0; n < count && good; n++) {
    int *own = &s->region_of[w->particle_site[particles[n]]];
    if (*own >= 0)
      good = report_two_materials(s, &s->regional[*own], v, w->particle_site[particles[n]], d);
    *own = number;
  }
  free(particles);
  return good;
}

static const deck_assignment *given_by(const deck_material *m, const char *name) {
  for (int n = 0; n < m->assignment_count; n++)
    if (strcasecmp(m->assignments[n].name, name) == 0) return &m->assignments[n];
  return NULL;
}

/* The region says no more of it than the material of its lattice. */
static bool repeats(const value_sources *s, const deck_material *m, const pl_parameter *p) {
  const deck_assignment *own = given_by(m, p->name);
  const deck_assignment *whole = given_by(s->whole, p->name);
  return !own || own->value == (whole ? whole->value : p->initial);
}

/* What differs must differ in the kernel, too. */
static bool region_fits(const value_sources *s, const regional_values *v, diagnostics *d) {
  const pl_law *law = s->places->law;
  for (int p = 0; p < law->parameter_count; p++) {
    const double own = v->parameters[p], other = s->parameters[p];
    if (own == other) continue;
    const char *name = law->parameters[p].name;
    const int plane = find_plane(law, name, v->material->item.where, d);
    if (plane < 0) return false;
    if (!s->field[plane].field || repeats(s, v->material, &law->parameters[p])) continue;
    diag_report(d, DIAG_CONFLICT, s->field[plane].field->item.where,
                "`%s` differs at random, and the material of the region `%s` gives it a value",
                name, v->material->region);
    diag_hint(d, "one of both: a &field of the whole lattice, or values by region");
    return false;
  }
  return true;
}

static bool open_regions(const deck *k, int count, value_sources *s, diagnostics *d) {
  bool good = true;
  if (count == 0) return true;
  s->region_of = must_calloc((size_t)s->places->rows->size, sizeof *s->region_of);
  for (long q = 0; q < s->places->rows->size; q++)
    s->region_of[q] = -1;
  for (int n = 0; n < count; n++)
    good = region_fits(s, &s->regional[n], d) && take_region(k, n, s, d) && good;
  return good;
}

/* Of a region, or without one (-1), as far as the law asks for their values. */
static long particles_in(const value_sources *s, int region, int32_t *particles) {
  const rows *w = s->places->rows;
  long count = 0;
  for (long p = 0; p < w->particle_count; p++) {
    const long site = w->particle_site[p];
    if ((s->region_of ? s->region_of[site] : -1) == region &&
        (!s->own || s->own[site] || (!on_particles(s->places) && rows_degree(w, site) > 0)))
      particles[count++] = (int32_t)p;
  }
  return count;
}

static bool read_file(value_sources *s, int region, int plane, int32_t *particles, diagnostics *d) {
  const pl_law *law = s->places->law;
  const rows *w = s->places->rows;
  const int number = (region + 1) * law->varying_count + plane;
  const deck_assignment *a = s->placed[number];
  if (!a || !a->placed->path) return true;
  const deck_placed from = placed_of_parameter(a, &law->parameters[law->varying[plane]]);
  const long count = particles_in(s, region, particles);
  double *values = placed_values(&from, w, particles, count, a->value_where, d);
  if (!values) return false;
  s->of_file[number] = must_alloc((size_t)w->size * sizeof(double));
  for (long q = 0; q < w->size; q++)
    s->of_file[number][q] =
        (region < 0 ? s->parameters : s->regional[region].parameters)[law->varying[plane]];
  for (long p = 0; p < count; p++)
    s->of_file[number][w->particle_site[particles[p]]] = values[p];
  free(values);
  return true;
}

static bool read_files(value_sources *s, diagnostics *d) {
  int32_t *particles = must_calloc((size_t)s->places->rows->particle_count + 1, sizeof *particles);
  bool good = true;
  for (int region = -1; region < s->regions; region++)
    for (int plane = 0; plane < s->places->law->varying_count; plane++)
      good = read_file(s, region, plane, particles, d) && good;
  free(particles);
  return good;
}

static double value_of_material(const value_sources *s, int plane, int64_t site) {
  const pl_law *law = s->places->law;
  const int region = s->region_of ? s->region_of[site] : -1;
  const int number = (region + 1) * law->varying_count + plane;
  double at[FORMULA_VARIABLES] = {[FORMULA_T] = s->time};
  if (s->of_file[number]) return s->of_file[number][site];
  if (!s->placed[number])
    return (region < 0 ? s->parameters : s->regional[region].parameters)[law->varying[plane]];
  const deck_placed *from = s->placed[number]->placed;
  if (from->in_time) return time_function_at(from->in_time, s->time);
  rows_place(s->places->rows, site, at);
  return formula_value(from->formula, at);
}

static double value_of(const value_sources *s, int plane, const value_place *at) {
  const pl_law *law = s->places->law;
  if (s->density && law->varying[plane] == law->density)
    return at->partner < 0 ? s->density[at->site]
                           : 0.5 * (s->density[at->site] + s->density[at->partner]);
  if (s->field[plane].field) return field_value(&s->field[plane], at);
  const double mine = value_of_material(s, plane, at->site);
  return at->partner < 0 ? mine : 0.5 * (mine + value_of_material(s, plane, at->partner));
}

static void fill_plane(const value_sources *s, int plane, double *values) {
  const value_places *p = s->places;
  const double mean = s->parameters[p->law->varying[plane]];
  for (long q = 0; q < planes_of(p) * p->rows->size; q++)
    values[q] = mean;
#pragma omp parallel for schedule(static)
  for (long m = 0; m < p->count; m++) {
    const value_place at = place_of(p, m);
    if (is_read(p, &at)) put(values, &at, value_of(s, plane, &at));
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

/* "in the bond from (x, y) mm to (x, y) mm", perhaps " at 2 ms" */
static void name_place(const value_sources *s, const value_place *at, char *text, size_t size) {
  const rows *w = s->places->rows;
  char ends[2][ROWS_PLACE_TEXT], when[TIME_TEXT + 8] = "", shown[TIME_TEXT];
  double here[3];
  if (s->time > 0) snprintf(when, sizeof when, " at %s", time_text(s->time, 4, shown));
  rows_place(w, at->site, here);
  rows_place_text(w->dimensions, here, ends[0]);
  if (at->partner < 0) {
    snprintf(text, size, "in the particle at %s%s", ends[0], when);
    return;
  }
  rows_place(w, at->partner, here);
  snprintf(text, size, "in the bond from %s to %s%s", ends[0],
           rows_place_text(w->dimensions, here, ends[1]), when);
}

/* The group of the deck that a value comes from; where it is of no plane, the first one. */
static span where_of(const value_sources *s, int plane) {
  for (int k = plane < 0 ? 0 : plane; k < s->places->law->varying_count; k++) {
    const deck_assignment *by_place = any_placed(s, s->regions, k);
    if (s->field[k].field) return s->field[k].field->item.where;
    if (by_place) return by_place->value_where;
  }
  return s->regional[0].material->item.where;
}

static void report_fault(const value_sources *s, long number, const bounds_of *b, int fault,
                         long count, diagnostics *d) {
  const pl_law *law = s->places->law;
  const char *in = law->parameters[fault].unit;
  const bool pure = !in || !*in || strcmp(in, "1") == 0;
  const value_place at = place_of(s->places, number);
  const int plane = plane_of(law, fault);
  char text[3 * ROWS_PLACE_TEXT];
  name_place(s, &at, text, sizeof text);
  if (!isfinite(b->values[fault])) {
    diag_report(d, DIAG_BAD_NUMBER, where_of(s, plane),
                "`%s` has no finite value %s; %ld of %ld %s are out of range",
                law->parameters[fault].name, text, count, s->places->count,
                on_particles(s->places) ? "particles" : "bonds");
    return;
  }
  diag_report(d, DIAG_OUT_OF_BOUNDS, where_of(s, plane),
              "`%s` = %.6g%s%s %s is not in %c%.6g, %.6g%c, the range of the law `%s`; so are %ld "
              "of %ld %s",
              law->parameters[fault].name, b->values[fault], pure ? "" : " ", pure ? "" : in, text,
              b->low_open[fault] ? '(' : '[', b->lower[fault], b->upper[fault],
              b->high_open[fault] ? ')' : ']', law->name, count, s->places->count,
              on_particles(s->places) ? "particles" : "bonds");
  if (plane < 0 || s->field[plane].field)
    diag_hint(d, "take a distribution that stays inside, a smaller `cv`, or clip = .true. for the "
                 "nearest allowed value");
}

/* The same after clipping, where the deck wants it. */
static int fault_left(parameter_planes *r, const value_sources *s, const value_place *at,
                      bounds_of *b) {
  const pl_law *law = s->places->law;
  int fault = first_fault(law, b);
  for (int tries = 0; fault >= 0 && tries < r->count; tries++) {
    const int plane = plane_of(law, fault);
    const deck_field *f = plane < 0 ? NULL : s->field[plane].field;
    if (!f || !f->clip || !r->value[plane] || isnan(b->values[fault])) break;
    b->values[fault] = clipped(b, fault, s->parameters[fault]);
    put(r->value[plane], at, b->values[fault]);
    fault = first_fault(law, b);
  }
  return fault;
}

/* Clips where the deck wants it; false after a message when values stay out of the law's ranges. A
   range may depend on other parameters: those of the same place. */
static bool check_values(parameter_planes *r, const value_sources *s, diagnostics *d) {
  const pl_law *law = s->places->law;
  bounds_of b = bounds_new(law, s->parameters), first = bounds_new(law, s->parameters);
  long faults = 0, first_place = -1;
  int first_parameter = -1;
  for (long m = 0; m < s->places->count; m++) {
    const value_place at = place_of(s->places, m);
    if (!is_read(s->places, &at)) continue;
    for (int k = 0; k < r->count; k++)
      if (r->value[k]) b.values[law->varying[k]] = r->value[k][at.at];
    const int fault = fault_left(r, s, &at, &b);
    if (fault < 0 || faults++ > 0) continue;
    first_place = m;
    first_parameter = fault;
    memcpy(first.values, b.values, (size_t)law->parameter_count * sizeof(double));
  }
  if (faults) {
    first_fault(law, &first);
    report_fault(s, first_place, &first, first_parameter, faults, d);
  }
  bounds_free(&b);
  bounds_free(&first);
  return faults == 0;
}

/* --- the planes ------------------------------------------------------------------------------- */

/* Of the values at hand and those seen before. */
static void find_extremes(parameter_planes *r, const value_sources *s) {
  for (int k = 0; k < r->count; k++) {
    const int parameter = s->places->law->varying[k];
    const bool density = r->density && parameter == s->places->law->density;
    const value_places particles = places_of_particles(s->places);
    const value_places *p = density ? &particles : s->places;
    const double *values = density ? r->density : r->value[k];
    double low = INFINITY, high = -INFINITY;
    for (long m = 0; m < p->count; m++) {
      const value_place at = place_of(p, m);
      const double value = values[at.at];
      if (!is_read(p, &at)) continue;
      low = pl_fmin(low, value);
      high = pl_fmax(high, value);
    }
    r->smallest[k] = pl_fmin(r->smallest[k], p->count ? low : s->parameters[parameter]);
    r->largest[k] = pl_fmax(r->largest[k], p->count ? high : s->parameters[parameter]);
  }
}

static double *new_plane(parameter_planes *r, const value_places *p) {
  const size_t bytes = (size_t)planes_of(p) * (size_t)p->rows->size * sizeof(double);
  r->bytes += bytes;
  return must_align(PL_ALIGNMENT, bytes);
}

int parameter_planes_of(const pl_law *law) {
  int count = law->varying_count;
  while (count > 0 && plane_of(law, law->varying[count - 1]) < count - 1)
    count--;
  return count;
}

static parameter_planes *planes_new(const value_places *p) {
  const size_t count = (size_t)p->law->varying_count + 1;
  parameter_planes *r = must_calloc(1, sizeof *r);
  r->count = parameter_planes_of(p->law);
  r->all = p->law->varying_count;
  r->plane_size = (size_t)planes_of(p) * (size_t)p->rows->size;
  r->value = must_calloc(count, sizeof *r->value);
  r->smallest = must_calloc(count, sizeof *r->smallest);
  r->largest = must_calloc(count, sizeof *r->largest);
  r->source = must_calloc(count, sizeof *r->source);
  for (int k = 0; k < r->count; k++) {
    r->smallest[k] = INFINITY;
    r->largest[k] = -INFINITY;
  }
  return r;
}

/* Of particles, whatever the law's bonds read; false after a message. */
static bool find_density(parameter_planes *r, value_sources *s, diagnostics *d) {
  const int plane = plane_of(s->places->law, s->places->law->density);
  const value_places particles = places_of_particles(s->places);
  value_sources of = *s;
  if (plane < 0) return true;
  of.places = &particles;
  parameter_planes *alone = planes_new(&particles);
  alone->value[plane] = r->density = new_plane(r, &particles);
  fill_plane(&of, plane, r->density);
  const bool good = check_values(alone, &of, d);
  alone->value[plane] = NULL;
  parameter_planes_free(alone);
  s->density = r->density;
  return good;
}

static plane_source source_of(const value_sources *s, int plane) {
  const deck_assignment *by_place = any_placed(s, s->regions, plane);
  if (s->field[plane].field) return PLANE_AT_RANDOM;
  if (!by_place) return PLANE_BY_REGIONS;
  return by_place->placed->path ? PLANE_BY_FILE : PLANE_BY_FORMULA;
}

static void sources_free(value_sources *s) {
  for (int k = 0; k < (s->regions + 1) * s->places->law->varying_count; k++)
    free(s->of_file[k]);
  free(s->of_file);
  for (int k = 0; k < s->places->law->varying_count; k++)
    random_waves_free(s->field[k].waves);
  free(s->field);
  free(s->placed);
  free(s->region_of);
}

/* --- what changes in time --------------------------------------------------------------------- */

typedef struct changing_plane {
  int plane, before; /* `before`: where it stands as it was a step ago; -1: nowhere */
  bool everywhere;   /* the same at all places */
  double last;       /* of these: the value at hand */
} changing_plane;

struct plane_clock {
  value_places places;
  value_sources sources;
  changing_plane *planes; /* [count] */
  int count;
  double *mine; /* [size] of particles */
};

static bool is_everywhere(const deck_placed *p) {
  for (int k = FORMULA_X; k <= FORMULA_Z; k++)
    if (!p->in_time && formula_reads(p->formula, k)) return false;
  return true;
}

/* A parameter that stands twice. */
static int plane_before(const pl_law *law, int plane) {
  for (int k = plane + 1; k < law->varying_count; k++)
    if (law->varying[k] == law->varying[plane]) return k;
  return -1;
}

static void find_changing(struct plane_clock *c) {
  const value_sources *s = &c->sources;
  const int planes = c->places.law->varying_count;
  c->planes = must_calloc((size_t)planes + 1, sizeof *c->planes);
  for (int k = 0; k < planes; k++) {
    bool any = false;
    for (int region = 0; region <= s->regions && !any; region++) {
      const deck_assignment *a = s->placed[region * planes + k];
      any = a && deck_placed_changes(a->placed);
    }
    if (!any || s->field[k].field) continue;
    const deck_assignment *whole = s->placed[k];
    c->planes[c->count++] =
        (changing_plane){.plane = k,
                         .before = plane_before(c->places.law, k),
                         .everywhere = s->regions == 0 && is_everywhere(whole->placed),
                         .last = NAN};
  }
  if (c->count) c->mine = must_calloc((size_t)c->places.rows->size, sizeof *c->mine);
}

static bool fill_everywhere(parameter_planes *r, struct plane_clock *c, changing_plane *p) {
  const rows *w = c->places.rows;
  const double value = value_of_material(&c->sources, p->plane, w->particle_site[0]);
  if (value == p->last) return false;
  p->last = value;
  for (size_t q = 0; q < r->plane_size; q++)
    r->value[p->plane][q] = value;
  return true;
}

/* As fill_plane: a bond has the mean of its ends. */
static void fill_again(const parameter_planes *r, struct plane_clock *c, const changing_plane *p) {
  const rows *w = c->places.rows;
  for (long n = 0; n < w->particle_count; n++) {
    const int64_t site = w->particle_site[n];
    c->mine[site] = value_of_material(&c->sources, p->plane, site);
  }
  for (long m = 0; m < c->places.count; m++) {
    const value_place at = place_of(&c->places, m);
    if (!is_read(&c->places, &at)) continue;
    const double mine = c->mine[at.site];
    put(r->value[p->plane], &at, at.partner < 0 ? mine : 0.5 * (mine + c->mine[at.partner]));
  }
}

bool parameter_planes_go_to(parameter_planes *p, double time) {
  if (!p || !p->changing || p->time == time) return false;
  struct plane_clock *c = p->clock;
  bool other = false;
  p->time = c->sources.time = time;
  for (int k = 0; k < c->count && c->places.rows->particle_count > 0; k++) {
    if (c->planes[k].everywhere) {
      other = fill_everywhere(p, c, &c->planes[k]) || other;
    } else {
      fill_again(p, c, &c->planes[k]);
      other = true;
    }
  }
  return other;
}

bool parameter_planes_turn(parameter_planes *p) {
  if (!p || !p->changing || p->before == p->time) return false;
  p->before = p->time;
  for (int k = 0; k < p->clock->count; k++) {
    const changing_plane *of = &p->clock->planes[k];
    if (of->before >= 0)
      memcpy(p->value[of->before], p->value[of->plane], p->plane_size * sizeof(double));
  }
  return p->all > p->count;
}

plane_change parameter_planes_change(const parameter_planes *p, int plane) {
  for (int k = 0; p->changing && k < p->clock->count; k++)
    if (p->clock->planes[k].plane == plane)
      return p->clock->planes[k].everywhere ? PLANE_CHANGES_ALIKE : PLANE_CHANGES;
  return PLANE_STAYS;
}

static int add_corners(const time_function *f, double end, double *times, int count) {
  for (int k = 0; f && k < f->count; k++)
    if (f->times[k] < end) times[count++] = f->times[k];
  return count;
}

int parameter_planes_times(const parameter_planes *p, double end, double **times) {
  enum { EVENLY = 16 };
  const value_sources *s = p && p->changing ? &p->clock->sources : NULL;
  const int most = s ? (s->regions + 1) * s->places->law->varying_count : 0;
  size_t room = EVENLY + 1;
  for (int k = 0; k < most; k++)
    if (s->placed[k] && s->placed[k]->placed->in_time)
      room += (size_t)s->placed[k]->placed->in_time->count;
  *times = must_calloc(room, sizeof **times);
  int count = 0;
  for (int k = 0; s && k <= EVENLY; k++)
    (*times)[count++] = end * k / EVENLY;
  for (int k = 0; k < most; k++)
    if (s->placed[k]) count = add_corners(s->placed[k]->placed->in_time, end, *times, count);
  return count;
}

/* At the times that are looked at, and at last at the start. */
static bool check_in_time(parameter_planes *r, struct plane_clock *c, double end, diagnostics *d) {
  double *times;
  const int count = parameter_planes_times(r, end, &times);
  bool good = true;
  for (int k = 0; k < count && good; k++) {
    parameter_planes_go_to(r, times[k]);
    good = check_values(r, &c->sources, d);
    if (good) find_extremes(r, &c->sources);
  }
  free(times);
  parameter_planes_go_to(r, 0);
  r->before = NAN;
  parameter_planes_turn(r);
  return good;
}

static void clock_free(struct plane_clock *c) {
  if (!c) return;
  sources_free(&c->sources);
  free(c->places.bonds);
  free(c->planes);
  free(c->mine);
  free(c);
}

static void take_clock(parameter_planes *r, struct plane_clock *c) {
  find_changing(c);
  r->changing = c->count > 0;
  r->clock = c;
}

/* --- all of them ------------------------------------------------------------------------------ */

static struct plane_clock *open_sources(const deck_material *whole, const rows *w,
                                        const unsigned char *own, const pl_law *law,
                                        const regional_values *regional, int regional_count) {
  struct plane_clock *c = must_calloc(1, sizeof *c);
  const size_t planes = (size_t)law->varying_count + 1,
               most = (size_t)(regional_count + 1) * planes;
  c->places = places_new(w, own, law);
  c->sources = (value_sources){.places = &c->places,
                               .whole = whole,
                               .own = own,
                               .regional = regional,
                               .regions = regional_count,
                               .field = must_calloc(planes, sizeof *c->sources.field),
                               .placed = must_calloc(most, sizeof *c->sources.placed),
                               .of_file = must_calloc(most, sizeof *c->sources.of_file)};
  return c;
}

parameter_planes *parameter_planes_new(const deck *k, int lattice, const deck_material *whole,
                                       const rows *w, const unsigned char *own, const pl_law *law,
                                       double *parameters, const regional_values *regional,
                                       int regional_count, diagnostics *d) {
  struct plane_clock *c = open_sources(whole, w, own, law, regional, regional_count);
  value_sources *s = &c->sources;
  parameter_planes *r = planes_new(&c->places);
  s->parameters = parameters;
  bool good = open_fields(k, lattice, parameters, s, d);
  good = open_placed(regional_count, s, d) && good;
  good = open_regions(k, regional_count, s, d) && good && read_files(s, d) && find_density(r, s, d);
  for (int n = 0; good && n < r->count; n++) {
    r->source[n] = source_of(s, n);
    r->value[n] = new_plane(r, &c->places);
    fill_plane(s, n, r->value[n]);
  }
  for (int n = r->count; good && n < r->all; n++) {
    r->value[n] = new_plane(r, &c->places);
    memcpy(r->value[n], r->value[plane_of(law, law->varying[n])], r->plane_size * sizeof(double));
  }
  good = good && check_values(r, s, d);
  if (good) find_extremes(r, s);
  if (good) take_clock(r, c);
  good = good && check_in_time(r, c, k->simulation.end_time, d);
  if (!r->changing) {
    clock_free(c);
    r->clock = NULL;
  }
  if (good) return r;
  parameter_planes_free(r);
  return NULL;
}

uint64_t parameter_planes_fingerprint(const parameter_planes *p) {
  uint64_t hash = HASH_START;
  bool any = false;
  for (int k = 0; p && k < p->count; k++) {
    if (p->source[k] != PLANE_BY_FILE) continue;
    hash = hash_words(hash, p->value[k], p->plane_size);
    any = true;
  }
  return !any ? 0 : hash ? hash : 1;
}

void parameter_planes_free(parameter_planes *p) {
  if (!p) return;
  for (int k = 0; k < p->all; k++)
    free(p->value[k]);
  free(p->value);
  free(p->density);
  free(p->smallest);
  free(p->largest);
  free(p->source);
  clock_free(p->clock);
  free(p);
}
