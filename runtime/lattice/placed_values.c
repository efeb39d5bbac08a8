#include "runtime/lattice/placed_values.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/semantics/formula.h"

static bool report(const rows *w, const double at[3], span where, diagnostics *d) {
  char text[ROWS_PLACE_TEXT];
  diag_report(d, DIAG_BAD_NUMBER, where, "this formula has no finite value at %s",
              rows_place_text(w->dimensions, at, text));
  return false;
}

static bool evaluate(const deck_placed *p, const rows *w, int64_t site, span where, double *value,
                     diagnostics *d) {
  double at[FORMULA_VARIABLES] = {0};
  rows_place(w, site, at);
  *value = p->formula ? formula_value(p->formula, at) : p->value;
  return isfinite(*value) || report(w, at, where, d);
}

double *placed_values(const deck_placed *p, const rows *w, const int32_t *particles, long count,
                      span where, diagnostics *d) {
  double *values = must_calloc((size_t)count + 1, sizeof *values);
  for (long k = 0; k < count; k++) {
    if (evaluate(p, w, w->particle_site[particles[k]], where, &values[k], d)) continue;
    free(values);
    return NULL;
  }
  return values;
}
