#include "runtime/particle_set.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"
#include "runtime/blue_noise.h"
#include "runtime/shape.h"
#include "runtime/site_marks.h"
#include "runtime/solid.h"
#include "runtime/voronoi.h"

/* Of a cell that a curved or turned surface cuts; in space a section of sections costs more. */
static const double cell_tolerance[] = {[2] = 1e-9, [3] = 1e-4};
#define SIZE_TOLERANCE(dimensions) (0.1 * cell_tolerance[dimensions])

double particle_measure(int dimensions, double spacing) {
  return dimensions == 2 ? sqrt(0.75) * spacing * spacing : sqrt(0.5) * spacing * spacing * spacing;
}

double particle_spacing(int dimensions, double measure) {
  return dimensions == 2 ? sqrt(measure / sqrt(0.75)) : cbrt(measure / sqrt(0.5));
}

static particle_set *set_new(int dimensions, long count) {
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
  free(set);
}

static voronoi_points points_of(const particle_set *set) {
  return (voronoi_points){
      set->dimensions, set->count, {set->at[0], set->at[1], set->at[2]}, set->spacing};
}

typedef struct maker {
  const deck *deck;
  const deck_lattice *lattice;
  int number; /* of the lattice */
  solid solid;
  double size; /* of the solid */
  diagnostics *d;
} maker;

static void measure_cells(const maker *m, particle_set *set) {
  const voronoi_points p = points_of(set);
  voronoi_measure(&p, &m->solid, m->size, cell_tolerance[set->dimensions], set->volume, NULL);
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

/* Boxes of the bodies' common box are kept while it is filled: their number is what memory must bear. */
static bool few_enough(const maker *m, double measure) {
  double box = 1;
  for (int c = 0; c < m->solid.dimensions; c++)
    box *= m->solid.upper[c] - m->solid.lower[c];
  return !site_too_many(m->lattice, box / measure, m->d);
}

static bool report_nothing_left(const maker *m, double measure) {
  const bool plane = m->solid.dimensions == 2;
  diag_report(m->d, DIAG_EMPTY_REGION, m->lattice->item.where,
              m->size > 0 ? "the bodies of lattice '%s' are smaller than one particle"
                          : "the notches remove all of lattice '%s'",
              m->lattice->name);
  if (m->size > 0)
    diag_hint(m->d, "they have %.6g %s, a particle has %.6g: check the units of lengths",
              m->size * (plane ? 1e6 : 1e9), plane ? "mm^2" : "mm^3",
              measure * (plane ? 1e6 : 1e9));
  return false;
}

static particle_set *fill(maker *m) {
  const int dimensions = m->solid.dimensions;
  const double measure = particle_measure(dimensions, m->lattice->spacing);
  if (!has_body(m) || !few_enough(m, measure)) return NULL;
  m->size = solid_size(&m->solid, SIZE_TOLERANCE(dimensions));
  const long count = lround(m->size / measure);
  if (count < 1 && !report_nothing_left(m, measure)) return NULL;
  particle_set *set = set_new(dimensions, count);
  set->spacing = m->lattice->spacing;
  voronoi_points p = points_of(set);
  blue_noise_fill(&p, &m->solid, m->size, (uint64_t)m->lattice->seed);
  measure_cells(m, set);
  if (bodies_have_particles(m, set)) return set;
  particle_set_free(set);
  return NULL;
}

particle_set *particle_set_make(const deck *k, int lattice, diagnostics *d) {
  maker m = {.deck = k, .lattice = &k->lattices[lattice], .number = lattice, .d = d};
  solid_begin(&m.solid, k, lattice);
  particle_set *set = fill(&m);
  solid_end(&m.solid);
  return set;
}
