#include "runtime/lattice/place_grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/lattice/rows.h"

static const double ROUNDING = 1e-9; /* of the extent of an axis */

static int ascending(const void *p, const void *q) {
  const double a = *(const double *)p, b = *(const double *)q;
  return (a > b) - (a < b);
}

static double extent(const double *axis, long count) {
  return count > 1 ? axis[count - 1] - axis[0] : 0;
}

/* The coordinates that there are, each once. */
static long take_axis(const double *at, long count, double *axis) {
  long kept = 0;
  if (count == 0) return 0;
  memcpy(axis, at, (size_t)count * sizeof *axis);
  qsort(axis, (size_t)count, sizeof *axis, ascending);
  const double apart = ROUNDING * extent(axis, count);
  for (long k = 0; k < count; k++)
    if (kept == 0 || axis[k] > axis[kept - 1] + apart) axis[kept++] = axis[k];
  return kept;
}

/* The last coordinate that is not above x, but never the last of several. */
static long below(const double *axis, long count, double x) {
  long low = 0, high = count - 1;
  while (high - low > 1) {
    const long middle = (low + high) / 2;
    if (axis[middle] <= x)
      low = middle;
    else
      high = middle;
  }
  return low;
}

static long nearest(const double *axis, long count, double x) {
  const long k = below(axis, count, x);
  return k + 1 < count && fabs(axis[k + 1] - x) < fabs(axis[k] - x) ? k + 1 : k;
}

static bool report(const place_grid *g, long node, const char *what, span where, diagnostics *d) {
  char text[ROWS_PLACE_TEXT];
  double at[3] = {0};
  for (int c = 0; c < g->dimensions; c++) {
    at[c] = g->axis[c][node % g->count[c]];
    node /= g->count[c];
  }
  diag_report(d, DIAG_BAD_VALUE, where, "the places of the file are no rectangular grid: %s at %s",
              what, rows_place_text(g->dimensions, at, text));
  diag_hint(d, "each of its coordinates x goes with each y, in space with each z, once");
  return false;
}

static bool take_values(place_grid *g, const place_table *t, unsigned char *seen, span where,
                        diagnostics *d) {
  const long nodes = g->count[0] * g->count[1] * g->count[2];
  for (long n = 0; n < t->count; n++) {
    long node = 0;
    for (int c = g->dimensions - 1; c >= 0; c--)
      node = node * g->count[c] + nearest(g->axis[c], g->count[c], t->at[c][n]);
    if (seen[node]++) return report(g, node, "there are two values", where, d);
    g->value[node] = t->value[n];
  }
  for (long n = 0; n < nodes; n++)
    if (!seen[n]) return report(g, n, "there is no value", where, d);
  return true;
}

bool place_grid_open(place_grid *g, const place_table *t, span where, diagnostics *d) {
  double nodes = 1;
  *g = (place_grid){.dimensions = t->dimensions, .count = {1, 1, 1}};
  for (int c = 0; c < t->dimensions; c++) {
    g->axis[c] = must_calloc((size_t)t->count + 1, sizeof(double));
    g->count[c] = take_axis(t->at[c], t->count, g->axis[c]);
    nodes *= (double)g->count[c];
  }
  if (t->count == 0) {
    diag_report(d, DIAG_BAD_VALUE, where, "the file has no values");
    return false;
  }
  /* scattered places would make a grid of their square: enough of it to name a node that lacks */
  const bool many = nodes > 64.0 * (double)t->count;
  if (many) g->count[0] = g->count[1] = g->count[2] = 1;
  const size_t room = many ? 1 : (size_t)nodes;
  unsigned char *seen = must_calloc(room, 1);
  g->value = must_calloc(room, sizeof *g->value);
  if (many) {
    diag_report(d, DIAG_BAD_VALUE, where, "the places of the file are no rectangular grid");
    diag_hint(d, "each of its coordinates x goes with each y, in space with each z, once");
  }
  const bool good = !many && take_values(g, t, seen, where, d);
  free(seen);
  return good;
}

void place_grid_free(place_grid *g) {
  for (int c = 0; c < 3; c++)
    free(g->axis[c]);
  free(g->value);
}

bool place_grid_holds(const place_grid *g, const double at[3]) {
  for (int c = 0; c < g->dimensions; c++) {
    const double *axis = g->axis[c], slack = 1e-6 * extent(axis, g->count[c]);
    if (g->count[c] > 1 && (at[c] < axis[0] - slack || at[c] > axis[g->count[c] - 1] + slack))
      return false;
  }
  return true;
}

double place_grid_at(const place_grid *g, const double at[3]) {
  long low[3] = {0};
  double part[3] = {0}, sum = 0;
  for (int c = 0; c < g->dimensions; c++) {
    if (g->count[c] == 1) continue;
    low[c] = below(g->axis[c], g->count[c], at[c]);
    const double *pair = g->axis[c] + low[c];
    part[c] = (at[c] - pair[0]) / (pair[1] - pair[0]);
    part[c] = part[c] < 0 ? 0 : part[c] > 1 ? 1 : part[c];
  }
  for (int corner = 0; corner < 8; corner++) {
    double weight = 1;
    long node = 0;
    for (int c = 2; c >= 0; c--) {
      const int up = corner >> c & 1;
      weight *= up ? part[c] : 1 - part[c];
      node = node * g->count[c] + (up && weight != 0 ? low[c] + 1 : low[c]);
    }
    if (weight != 0) sum += weight * g->value[node];
  }
  return sum;
}
