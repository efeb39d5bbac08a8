#include "runtime/particles/gradation.h"

#include <math.h>
#include <stdio.h>

#include "dsl/base/elementary.h"
#include "dsl/semantics/formula.h"
#include "runtime/particles/site_marks.h"

#define RATIO_ROUNDING 1e-9
#define FILL_TOLERANCE 1e-3 /* of a box of a spacing: counts need no more */
enum { FIRST_SPLITS = 9 };  /* into 512 boxes, before any of them is looked at */

double particle_measure(int dimensions, double spacing) {
  return dimensions == 2 ? sqrt(0.75) * spacing * spacing : sqrt(0.5) * spacing * spacing * spacing;
}

double gradation_at(const gradation *g, const double at[3]) {
  double variables[FORMULA_VARIABLES] = {0};
  if (!g->graded) return g->spacing;
  for (int c = 0; c < g->dimensions; c++)
    variables[c] = at[c];
  return formula_value(g->graded, variables);
}

static bool is_size(double spacing) {
  return spacing > 0 && isfinite(spacing);
}

void gradation_slope(const gradation *g, const double at[3], double reach, double slope[3]) {
  for (int c = 0; c < 3; c++) {
    double low[3] = {at[0], at[1], at[2]}, high[3] = {at[0], at[1], at[2]};
    slope[c] = 0;
    if (c >= g->dimensions || !g->graded) continue;
    low[c] -= reach;
    high[c] += reach;
    const double below = gradation_at(g, low), above = gradation_at(g, high);
    if (is_size(below) && is_size(above)) slope[c] = (above - below) / (2 * reach);
  }
}

/* --- messages --------------------------------------------------------------------------------- */

static const char *place_text(const gradation *g, const double at[3], char text[80]) {
  const int length = snprintf(text, 80, "(%.6g, %.6g", 1e3 * at[0], 1e3 * at[1]);
  if (g->dimensions == 3)
    snprintf(text + length, 80 - (size_t)length, ", %.6g) mm", 1e3 * at[2]);
  else
    snprintf(text + length, 80 - (size_t)length, ") mm");
  return text;
}

static bool report_value(const gradation *g, const deck_lattice *l, const double at[3],
                         double spacing, diagnostics *d) {
  char text[80];
  const span where = deck_where(&l->item, "spacing");
  if (isfinite(spacing))
    diag_report(d, DIAG_OUT_OF_BOUNDS, where,
                "`spacing` is %.6g mm at %s: it must be greater than 0", 1e3 * spacing,
                place_text(g, at, text));
  else
    diag_report(d, DIAG_OUT_OF_BOUNDS, where, "`spacing` has no finite value at %s",
                place_text(g, at, text));
  diag_hint(d, "bound it, for example spacing = 'max(2 [mm], ...)'");
  return false;
}

static bool report_ratio(const gradation *g, const deck_lattice *l, diagnostics *d) {
  diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&l->item, "spacing"),
              "gradation beyond its ratio: the spacing goes from %.4g to %.4g mm, and the largest "
              "may be %g times the smallest",
              1e3 * g->least, 1e3 * g->most, GRADATION_MOST_RATIO);
  diag_hint(d, "bound it: spacing = 'min(..., %.4g [mm])', or make the smallest ones larger",
            1e3 * GRADATION_MOST_RATIO * g->least);
  return false;
}

static bool report_slope(const gradation *g, const deck_lattice *l, const double at[3],
                         double slope, diagnostics *d) {
  char text[80];
  diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&l->item, "spacing"),
              "too steep a gradation: at %s the spacing grows by %.3g of the distance, from a "
              "particle to the next one by about that part of itself; at most %g",
              place_text(g, at, text), slope, GRADATION_MOST_SLOPE);
  diag_hint(d, "spread it over a longer way, for example '2 [mm] + %g*abs(x)'",
            GRADATION_MOST_SLOPE / 2);
  return false;
}

/* --- looking through the solid ---------------------------------------------------------------- */

typedef struct look {
  gradation *g;
  const deck_lattice *lattice;
  const solid *solid;
  double size; /* of the solid */
  solid_workspace scratch;
  cell cell;
  diagnostics *d;
} look;

static bool note(look *k, const double at[3], double spacing) {
  gradation *g = k->g;
  if (!is_size(spacing)) return report_value(g, k->lattice, at, spacing, k->d);
  g->least = pl_fmin(g->least, spacing);
  g->most = pl_fmax(g->most, spacing);
  if (g->most > GRADATION_MOST_RATIO * (1 + RATIO_ROUNDING) * g->least)
    return report_ratio(g, k->lattice, k->d);
  return !site_too_many(k->lattice, g->count + 1, k->d) &&
         !site_too_many(k->lattice, k->size / particle_measure(g->dimensions, g->most), k->d);
}

/* Places all over the solid, so that what messages say of its range is not of the first boxes
   alone. */
static bool look_around(look *k) {
  enum { ALONG = 25 }; /* odd: middles are where formulas have their kinks */
  const solid *s = k->solid;
  const int layers = s->dimensions == 3 ? ALONG : 1;
  for (int n = 0; n < ALONG * ALONG * layers; n++) {
    const int step[3] = {n % ALONG, n / ALONG % ALONG, n / ALONG / ALONG};
    double at[3] = {0};
    for (int c = 0; c < s->dimensions; c++)
      at[c] = s->lower[c] + (s->upper[c] - s->lower[c]) * step[c] / (ALONG - 1);
    if (!solid_holds(s, at)) continue;
    const double spacing = gradation_at(k->g, at);
    if (!is_size(spacing)) return report_value(k->g, k->lattice, at, spacing, k->d);
    k->g->least = pl_fmin(k->g->least, spacing);
    k->g->most = pl_fmax(k->g->most, spacing);
  }
  return true;
}

static int longest_side(const solid *s, const double lower[3], const double upper[3]) {
  int longest = 0;
  for (int c = 1; c < s->dimensions; c++)
    if (upper[c] - lower[c] > upper[longest] - lower[longest]) longest = c;
  return longest;
}

static bool look_through(look *k, const double lower[3], const double upper[3], int splits);

static bool look_at_halves(look *k, const double lower[3], const double upper[3], int splits) {
  const int side = longest_side(k->solid, lower, upper);
  double middle[3] = {lower[0], lower[1], lower[2]}, end[3] = {upper[0], upper[1], upper[2]};
  middle[side] = end[side] = 0.5 * (lower[side] + upper[side]);
  return look_through(k, lower, end, splits - 1) && look_through(k, middle, upper, splits - 1);
}

/* Boxes no larger than a particle, by the spacing in the middle of what of the solid is in them. */
static bool look_through(look *k, const double lower[3], const double upper[3], int splits) {
  if (splits > 0) return look_at_halves(k, lower, upper, splits);
  const int dimensions = k->solid->dimensions, side = longest_side(k->solid, lower, upper);
  double at[3] = {0}, below[3] = {0}, above[3] = {0};
  for (int c = 0; c < dimensions; c++) {
    at[c] = 0.5 * (lower[c] + upper[c]);
    below[c] = lower[c] - at[c];
    above[c] = upper[c] - at[c];
  }
  cell_set_box(&k->cell, below, above);
  const cell_moments in = solid_fill(k->solid, &k->scratch, &k->cell, at, FILL_TOLERANCE);
  if (!(in.size > 0)) return true;
  for (int c = 0; c < dimensions; c++)
    at[c] += in.first[c] / in.size;
  const double spacing = gradation_at(k->g, at);
  if (!note(k, at, spacing)) return false;
  if (upper[side] - lower[side] > spacing) return look_at_halves(k, lower, upper, 1);
  k->g->count += in.size / particle_measure(dimensions, spacing);
  return true;
}

bool gradation_begin(gradation *g, const deck_lattice *l, const solid *s, double size,
                     diagnostics *d) {
  *g = (gradation){
      .dimensions = s->dimensions, .spacing = l->spacing, .graded = l->graded, .least = INFINITY};
  if (!l->graded) {
    g->least = g->most = l->spacing;
    g->count = size / particle_measure(s->dimensions, l->spacing);
    return true;
  }
  look k = {.g = g, .lattice = l, .solid = s, .size = size, .d = d};
  solid_workspace_begin(&k.scratch, s);
  cell_begin(&k.cell, s->dimensions);
  const bool good = look_around(&k) && look_through(&k, s->lower, s->upper, FIRST_SPLITS);
  cell_end(&k.cell);
  solid_workspace_end(&k.scratch);
  return good;
}

bool gradation_is_borne(gradation *g, const deck_lattice *l, double *const at[3], double *own,
                        long count, diagnostics *d) {
  for (long k = 0; k < count && g->graded; k++) {
    double here[3] = {0}, slope[3], square = 0;
    for (int c = 0; c < g->dimensions; c++)
      here[c] = at[c][k];
    const double spacing = own[k] = gradation_at(g, here);
    if (!is_size(spacing)) return report_value(g, l, here, spacing, d);
    g->least = pl_fmin(g->least, spacing);
    g->most = pl_fmax(g->most, spacing);
    gradation_slope(g, here, 0.5 * spacing, slope);
    for (int c = 0; c < g->dimensions; c++)
      square += slope[c] * slope[c];
    if (sqrt(square) > GRADATION_MOST_SLOPE * (1 + 1e-6))
      return report_slope(g, l, here, sqrt(square), d);
  }
  return g->most <= GRADATION_MOST_RATIO * (1 + RATIO_ROUNDING) * g->least || report_ratio(g, l, d);
}
