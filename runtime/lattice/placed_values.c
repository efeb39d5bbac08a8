#include "runtime/lattice/placed_values.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/semantics/formula.h"
#include "runtime/lattice/place_grid.h"

deck_placed placed_of_parameter(const deck_assignment *a, const pl_parameter *p) {
  deck_placed placed = *a->placed;
  placed.unit_text = p->unit && *p->unit ? p->unit : "1";
  return placed;
}

static bool report(const rows *w, const double at[3], const char *what, span where,
                   diagnostics *d) {
  char text[ROWS_PLACE_TEXT];
  diag_report(d, DIAG_BAD_NUMBER, where, "%s %s", what, rows_place_text(w->dimensions, at, text));
  return false;
}

static bool evaluate(const deck_placed *p, const rows *w, int64_t site, span where, double *value,
                     diagnostics *d) {
  double at[FORMULA_VARIABLES] = {0};
  rows_place(w, site, at);
  *value = p->formula ? formula_value(p->formula, at) : p->value;
  return isfinite(*value) || report(w, at, "this formula has no finite value at", where, d);
}

static bool look_up(const place_table *t, const rows *w, const int32_t *particles, long count,
                    span where, double *values, diagnostics *d) {
  for (long k = 0; k < count; k++) {
    double at[3];
    rows_place(w, w->particle_site[particles[k]], at);
    /* a little more: places of results are rounded */
    const double within = (0.5 + 1e-6) * rows_spacing(w, w->particle_site[particles[k]]);
    const long nearest = place_table_nearest(t, at, within);
    if (nearest < 0)
      return report(w, at, "the file has no value within half a spacing of the particle at", where,
                    d);
    values[k] = t->value[nearest];
    if (!isfinite(values[k]))
      return report(w, at, "the file has no finite value for the particle at", where, d);
  }
  return true;
}

static bool interpolate(const place_table *t, const rows *w, const int32_t *particles, long count,
                        span where, double *values, diagnostics *d) {
  place_grid g;
  bool good = place_grid_open(&g, t, where, d);
  for (long k = 0; k < count && good; k++) {
    double at[3];
    rows_place(w, w->particle_site[particles[k]], at);
    good = place_grid_holds(&g, at) ||
           report(w, at, "the grid of the file does not reach to the particle at", where, d);
    values[k] = good ? place_grid_at(&g, at) : 0;
    if (good && !isfinite(values[k]))
      good = report(w, at, "the file has no finite value for the particle at", where, d);
  }
  place_grid_free(&g);
  return good;
}

static bool from_file(const deck_placed *p, const rows *w, const int32_t *particles, long count,
                      span where, double *values, diagnostics *d) {
  place_table t;
  const bool good = place_table_read(&t, p, w->dimensions, rows_largest_spacing(w), where, d) &&
                    (p->grid ? interpolate : look_up)(&t, w, particles, count, where, values, d);
  place_table_free(&t);
  return good;
}

static bool from_deck(const deck_placed *p, const rows *w, const int32_t *particles, long count,
                      span where, double *values, diagnostics *d) {
  for (long k = 0; k < count; k++)
    if (!evaluate(p, w, w->particle_site[particles[k]], where, &values[k], d)) return false;
  return true;
}

double *placed_values(const deck_placed *p, const rows *w, const int32_t *particles, long count,
                      span where, diagnostics *d) {
  double *values = must_calloc((size_t)count + 1, sizeof *values);
  if ((p->path ? from_file : from_deck)(p, w, particles, count, where, values, d)) return values;
  free(values);
  return NULL;
}
