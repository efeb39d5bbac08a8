#include "runtime/particles/particle_set.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/geometry/shape.h"
#include "runtime/particles/blue_noise.h"
#include "runtime/particles/gradation.h"
#include "runtime/particles/particle_table.h"
#include "runtime/particles/site_marks.h"
#include "runtime/particles/solid.h"
#include "runtime/particles/voronoi.h"

/* Of a cell that a curved or turned surface cuts; in space a section of sections costs more. */
static const double cell_tolerance[] = {[2] = 1e-9, [3] = 1e-4};
#define SIZE_TOLERANCE(dimensions) (0.1 * cell_tolerance[dimensions])

#define NEAREST 1e-3 /* spacings: particles nearer to each other are one by mistake */

static double spacing_for(int dimensions, double measure) {
  return dimensions == 2 ? sqrt(measure / sqrt(0.75)) : pl_cbrt(measure / sqrt(0.5));
}

particle_set *particle_set_new(int dimensions, long count) {
  particle_set *set = must_calloc(1, sizeof *set);
  set->dimensions = dimensions;
  set->count = count;
  for (int c = 0; c < dimensions; c++)
    set->at[c] = must_calloc((size_t)count + 1, sizeof(double));
  set->volume = must_calloc((size_t)count + 1, sizeof(double));
  return set;
}

void particle_set_free(particle_set *set) {
  if (!set) return;
  for (int c = 0; c < 3; c++)
    free(set->at[c]);
  free(set->volume);
  free(set->own);
  free(set);
}

static voronoi_points points_of(const particle_set *set) {
  return (voronoi_points){
      set->dimensions, set->count, {set->at[0], set->at[1], set->at[2]}, set->spacing, set->own};
}

typedef struct maker {
  const deck *deck;
  const deck_lattice *lattice;
  solid solid;
  double size; /* of the solid */
  diagnostics *d;
} maker;

static void measure_cells(const maker *m, particle_set *set) {
  const voronoi_points p = points_of(set);
  voronoi_measure(&p, &m->solid, cell_tolerance[set->dimensions], set->volume, NULL);
}

/* --- bodies ----------------------------------------------------------------------------------- */

static bool body_has_particle(const deck_shape *shape, const particle_set *set, double tolerance) {
  for (long k = 0; k < set->count; k++) {
    const double at[3] = {set->at[0][k], set->at[1][k], set->dimensions == 3 ? set->at[2][k] : 0};
    if (shape_contains(shape, at, tolerance)) return true;
  }
  return false;
}

/* A body that holds nothing is a slip: a wrong unit, say. */
static bool bodies_have_particles(const maker *m, const particle_set *set) {
  bool sound = true;
  for (int n = 0; n < m->deck->body_count; n++) {
    const deck_body *body = &m->deck->bodys[n];
    if (!site_of_lattice(m->lattice, body->lattice)) continue;
    if (body_has_particle(&body->shape, set, SITE_OUTLINE_TOLERANCE * set->spacing)) continue;
    diag_report(m->d, DIAG_EMPTY_REGION, body->item.where,
                "the body contains no particle of lattice '%s'", m->lattice->name);
    diag_hint(m->d, "its extent is less than the spacing of %.6g mm, or a length has a wrong unit",
              1e3 * set->spacing);
    sound = false;
  }
  return sound;
}

static bool has_body(const maker *m) {
  if (m->solid.body_count > 0) return true;
  diag_report(m->d, DIAG_EMPTY_REGION, m->lattice->item.where, "lattice '%s' has no body",
              m->lattice->name);
  diag_hint(m->d, "add a group &body with lattice = '%s'", m->lattice->name);
  return false;
}

/* --- blue noise ------------------------------------------------------------------------------- */

/* Boxes of the bodies' common box are kept while it is filled: their number is what memory must
   bear. Across a thin body there is one. */
static bool few_enough(const maker *m, double spacing, double measure) {
  double box = 1;
  for (int c = 0; c < m->solid.dimensions; c++)
    box *= pl_fmax(m->solid.upper[c] - m->solid.lower[c], spacing);
  return !site_too_many(m->lattice, box / measure, m->d);
}

static void report_nothing_left(const maker *m, double measure) {
  const bool plane = m->solid.dimensions == 2;
  diag_report(m->d, DIAG_EMPTY_REGION, m->lattice->item.where,
              m->size > 0 ? "the bodies of lattice '%s' are smaller than one particle"
                          : "the notches remove all of lattice '%s'",
              m->lattice->name);
  if (m->size > 0)
    diag_hint(m->d, "they have %.6g %s, a particle has %.6g: check the units of lengths",
              m->size * (plane ? 1e6 : 1e9), plane ? "mm^2" : "mm^3",
              measure * (plane ? 1e6 : 1e9));
}

/* The smallest spacing becomes that of the set. */
static particle_set *new_filled(const gradation *g, long count) {
  particle_set *set = particle_set_new(g->dimensions, count);
  set->spacing = g->least;
  if (g->graded) set->own = must_calloc((size_t)count + 1, sizeof *set->own);
  return set;
}

static particle_set *fill(maker *m) {
  const int dimensions = m->solid.dimensions;
  gradation g;
  if (!has_body(m)) return NULL;
  if (!m->lattice->graded &&
      !few_enough(m, m->lattice->spacing, particle_measure(dimensions, m->lattice->spacing)))
    return NULL;
  m->size = solid_size(&m->solid, SIZE_TOLERANCE(dimensions));
  if (!gradation_begin(&g, m->lattice, &m->solid, m->size, m->d)) return NULL;
  const double measure = particle_measure(dimensions, g.least);
  if (m->lattice->graded && m->size > 0 && !few_enough(m, g.least, measure)) return NULL;
  const long count = lround(g.count);
  if (count < 1) {
    report_nothing_left(m, measure);
    return NULL;
  }
  particle_set *set = new_filled(&g, count);
  voronoi_points p = points_of(set);
  blue_noise_fill(&p, &m->solid, &g, (uint64_t)m->lattice->seed);
  measure_cells(m, set);
  if (gradation_is_borne(&g, m->lattice, set->at, set->own, count, m->d) &&
      bodies_have_particles(m, set)) {
    set->spacing = g.least;
    return set;
  }
  particle_set_free(set);
  return NULL;
}

/* --- particles from a file -------------------------------------------------------------------- */

static void place_in_table(const particle_table *t, long k, double at[3]) {
  at[2] = 0;
  for (int c = 0; c < t->dimensions; c++)
    at[c] = t->at[c][k];
}

static bool any_body_holds(const maker *m, const double *at, double tolerance) {
  for (int n = 0; n < m->solid.body_count; n++)
    if (shape_contains(m->solid.bodies[n], at, tolerance)) return true;
  return false;
}

/* Particles on slits go, too. */
static bool any_notch_holds(const maker *m, const double *at, double tolerance) {
  for (int n = 0; n < m->deck->notch_count; n++) {
    const deck_notch *notch = &m->deck->notchs[n];
    if (site_of_lattice(m->lattice, notch->lattice) && shape_contains(&notch->shape, at, tolerance))
      return true;
  }
  return false;
}

static void warn_outside(const maker *m, particle_table *t, long outside, long first) {
  const span where = deck_where(&m->lattice->item, "file");
  diag_report(m->d, DIAG_DECK_WARNING, where,
              "%ld of the %ld particles lie outside of the bodies of lattice '%s' and are left out",
              outside, t->count, m->lattice->name);
  diag_note(m->d, particle_table_where(t, first, where, m->d), "this is the first of them");
}

static void keep(particle_table *t, long from, long to) {
  for (int c = 0; c < t->dimensions; c++)
    t->at[c][to] = t->at[c][from];
  if (t->volume) t->volume[to] = t->volume[from];
  if (t->spacing) t->spacing[to] = t->spacing[from];
  t->row[to] = t->row[from];
}

/* What is outside of the bodies and in notches goes. Without bodies all are meant. */
static bool leave_out(const maker *m, particle_table *t, double spacing) {
  const double tolerance = SITE_OUTLINE_TOLERANCE * spacing;
  long outside = 0, first = 0, kept = 0;
  bool *stays = must_alloc((size_t)t->count * sizeof *stays);
  for (long k = 0; k < t->count; k++) {
    double at[3];
    place_in_table(t, k, at);
    const bool in = m->solid.body_count == 0 || any_body_holds(m, at, tolerance);
    if (!in && outside++ == 0) first = k;
    stays[k] = in && !any_notch_holds(m, at, tolerance);
    kept += stays[k];
  }
  if (outside > 0 && kept > 0) warn_outside(m, t, outside, first);
  kept = 0;
  for (long k = 0; k < t->count; k++)
    if (stays[k]) keep(t, k, kept++);
  free(stays);
  t->count = kept;
  if (kept > 0) return true;
  diag_report(m->d, DIAG_EMPTY_REGION, deck_where(&m->lattice->item, "file"),
              outside > 0 ? "no particle of `%s` lies in the bodies of lattice '%s'"
                          : "the notches remove every particle of `%s` from lattice '%s'",
              m->lattice->file, m->lattice->name);
  if (outside > 0) diag_hint(m->d, "check the units in the file's first line: without one it is m");
  return false;
}

/* Laws, horizons and contacts would take the particles of a graded result for alike. */
static bool are_of_one_size(const maker *m, const particle_table *t) {
  double least = INFINITY, most = 0;
  for (long k = 0; t->spacing && k < t->count; k++) {
    least = pl_fmin(least, t->spacing[k]);
    most = pl_fmax(most, t->spacing[k]);
  }
  if (!t->spacing || most <= least * (1 + 1e-6)) return true;
  diag_report(m->d, DIAG_CONFLICT, deck_where(&m->lattice->item, "file"),
              "the particles of `%s` are graded, with spacings from %.4g to %.4g mm: those of "
              "kind = 'particles' are of one size",
              m->lattice->file, 1e3 * least, 1e3 * most);
  diag_hint(m->d, "kind = 'blue_noise' with the formula of `spacing`, the `seed` and the bodies of "
                  "that run gives the same particles");
  return false;
}

static bool can_be_stored(const maker *m, const particle_table *t) {
  if ((double)t->count <= SITE_MOST) return true;
  diag_report(m->d, DIAG_OUT_OF_BOUNDS, deck_where(&m->lattice->item, "file"),
              "`%s` holds %ld particles; the most that can be stored are %.0e", m->lattice->file,
              t->count, SITE_MOST);
  return false;
}

static double mean_of(const double *x, long count) {
  double sum = 0;
  for (long k = 0; k < count; k++)
    sum += x[k];
  return sum / (double)count;
}

/* Of the deck, or of particles as large as those of the table in the mean. */
static double spacing_of(const maker *m, const particle_table *t) {
  if (m->lattice->spacing > 0) return m->lattice->spacing;
  const double measure = t->volume ? mean_of(t->volume, t->count) : m->size / (double)t->count;
  return spacing_for(t->dimensions, measure);
}

static bool all_apart(const maker *m, particle_table *t, double spacing) {
  const voronoi_points p = {t->dimensions, t->count, {t->at[0], t->at[1], t->at[2]}, spacing, NULL};
  char first[PARTICLE_TABLE_TEXT], second[PARTICLE_TABLE_TEXT];
  long pair[2];
  if (!voronoi_too_near(&p, NEAREST * spacing, pair)) return true;
  const span where = deck_where(&m->lattice->item, "file");
  diag_report(m->d, DIAG_CONFLICT, particle_table_where(t, pair[1], where, m->d),
              "%s and %s are less than %g spacings of %.6g mm apart",
              particle_table_name(t, pair[0], first), particle_table_name(t, pair[1], second),
              NEAREST, 1e3 * spacing);
  diag_note(m->d, particle_table_where(t, pair[0], where, m->d), "the other one is here");
  return false;
}

static bool has_bounds(const maker *m, const particle_table *t) {
  if (t->volume || m->solid.body_count > 0) return true;
  diag_report(m->d, DIAG_MISSING_KEY, deck_where(&m->lattice->item, "file"),
              "`%s` gives no volumes, and without a &body nothing bounds the particles' cells",
              m->lattice->file);
  diag_hint(m->d,
            "add a column `volume [mm^3]`, or a &body with lattice = '%s' that cuts the cells",
            m->lattice->name);
  return false;
}

static bool cells_are_filled(const maker *m, const particle_set *set, particle_table *t) {
  for (long k = 0; k < set->count; k++) {
    if (set->volume[k] > 0) continue;
    diag_report(m->d, DIAG_EMPTY_REGION,
                particle_table_where(t, k, deck_where(&m->lattice->item, "file"), m->d),
                "the cell of this particle has no part in the bodies of lattice '%s'",
                m->lattice->name);
    return false;
  }
  return true;
}

/* The table's columns become the set's. */
static particle_set *take_table(maker *m, particle_table *t, double spacing) {
  particle_set *set = must_calloc(1, sizeof *set);
  *set = (particle_set){.dimensions = t->dimensions, .count = t->count, .spacing = spacing};
  for (int c = 0; c < t->dimensions; c++) {
    set->at[c] = t->at[c];
    t->at[c] = NULL;
  }
  set->volume = t->volume;
  t->volume = NULL;
  if (!set->volume) {
    set->volume = must_calloc((size_t)set->count + 1, sizeof *set->volume);
    measure_cells(m, set);
  }
  if (!(m->lattice->spacing > 0))
    set->spacing = spacing_for(set->dimensions, mean_of(set->volume, set->count));
  if (cells_are_filled(m, set, t) && bodies_have_particles(m, set)) return set;
  particle_set_free(set);
  return NULL;
}

static particle_set *from_table(maker *m, particle_table *t) {
  if (!has_bounds(m, t)) return NULL;
  m->size = solid_size(&m->solid, SIZE_TOLERANCE(t->dimensions));
  if (m->solid.body_count > 0 && m->size <= 0) {
    report_nothing_left(m, 0);
    return NULL;
  }
  if (!leave_out(m, t, spacing_of(m, t)) || !can_be_stored(m, t) || !are_of_one_size(m, t))
    return NULL;
  const double spacing = spacing_of(m, t);
  return all_apart(m, t, spacing) ? take_table(m, t, spacing) : NULL;
}

static particle_set *load(maker *m) {
  const deck_lattice *l = m->lattice;
  particle_table t;
  particle_set *set = NULL;
  if (particle_table_read(&t, deck_file_path(m->deck->name, l->file), m->solid.dimensions,
                          l->mass_thickness, deck_where(&l->item, "file"), m->d))
    set = from_table(m, &t);
  particle_table_free(&t);
  return set;
}

particle_set *particle_set_make(const deck *k, int lattice, diagnostics *d) {
  maker m = {.deck = k, .lattice = &k->lattices[lattice], .d = d};
  solid_begin(&m.solid, k, lattice);
  particle_set *set = strcmp(m.lattice->kind, "particles") == 0 ? load(&m) : fill(&m);
  solid_end(&m.solid);
  return set;
}

void particle_set_measure(particle_set *set, const deck *k, int lattice) {
  maker m = {.deck = k, .lattice = &k->lattices[lattice]};
  solid_begin(&m.solid, k, lattice);
  measure_cells(&m, set);
  solid_end(&m.solid);
}
