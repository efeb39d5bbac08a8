#include "generator/against/table_difference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"

/* What is no more than rounding, of a ratio; what is little beside the largest of its kind. */
static const double exact = 1e-6, little = 1e-2;
/* A value that says something, in parts of the scale. */
static const double worth = 1e-3;

/* --- ratios ----------------------------------------------------------------------------------- */

static const struct {
  double ratio;
  const char *words;
  bool closed; /* a root, pi or a logarithm stands in it */
} known_ratios[] = {{2, "twice", false},
                    {0.5, "half", false},
                    {3, "three times", false},
                    {1. / 3, "a third of", false},
                    {4, "four times", false},
                    {0.25, "a quarter of", false},
                    {1.5, "one and a half times", false},
                    {2. / 3, "two thirds of", false},
                    {0.86602540378443865, "sqrt(3)/2 times", true},
                    {1.1547005383792515, "2/sqrt(3) times", true},
                    {1.7320508075688773, "sqrt(3) times", true},
                    {0.57735026918962576, "1/sqrt(3) times", true},
                    {1.4142135623730951, "sqrt(2) times", true},
                    {0.70710678118654752, "1/sqrt(2) times", true},
                    {M_PI, "pi times", true},
                    {2 * M_PI, "2 pi times", true},
                    {1 / (2 * M_PI), "1/(2 pi) times", true},
                    {2.3025850929940457, "ln(10) times", true},
                    {0.43429448190325183, "1/ln(10) times", true},
                    {10, "ten times", false},
                    {0.1, "a tenth of", false},
                    {100, "a hundred times", false},
                    {0.01, "a hundredth of", false},
                    {1000, "a thousand times", false},
                    {1e-3, "a thousandth of", false},
                    {1e6, "a million times", false},
                    {1e-6, "a millionth of", false},
                    {0, "0 instead of", false}};

/* Which it is, or how many there are. */
static size_t known_ratio(double ratio) {
  const double within = 2e-3;
  size_t k = 0;
  while (k < sizeof known_ratios / sizeof *known_ratios &&
         !(fabs(ratio - known_ratios[k].ratio) <= within * known_ratios[k].ratio + 1e-9))
    k++;
  return k;
}

const char *ratio_words(double ratio) {
  const size_t k = known_ratio(ratio);
  return k < sizeof known_ratios / sizeof *known_ratios ? known_ratios[k].words : NULL;
}

/* What a fraction may be multiplied with: over or under its line. */
static const struct {
  double value;
  const char *text;
  bool is_small; /* goes with fractions of larger numbers, too */
} factors[] = {{1, "", true},
               {1.7320508075688773, "sqrt(3)", true},
               {1.4142135623730951, "sqrt(2)", false},
               {M_PI, "pi", false},
               {2 / M_2_SQRTPI, "sqrt(pi)", false},
               {M_PI * 1.7320508075688773, "pi sqrt(3)", false}};
enum { MOST_WHOLE = 16, MOST_WITH_ROOT = 9 };

/* "3", "sqrt(3)", "3 sqrt(3)"; in brackets where it is a product below a line. */
static void write_multiple(int n, const char *root, bool below, char *text, size_t size) {
  if (!*root)
    snprintf(text, size, "%d", n);
  else if (n == 1)
    snprintf(text, size, below && strchr(root, ' ') ? "(%s)" : "%s", root);
  else
    snprintf(text, size, below ? "(%d %s)" : "%d %s", n, root);
}

static void write_fraction(int p, int q, const char *root, bool under, char *text, size_t size) {
  char above[40], below[40];
  write_multiple(p, under ? "" : root, false, above, sizeof above);
  write_multiple(q, under ? root : "", true, below, sizeof below);
  if (strcmp(below, "1") == 0)
    snprintf(text, size, "%s", above);
  else
    snprintf(text, size, "%s/%s", above, below);
}

/* The simplest one is written. */
bool ratio_formula(double ratio, char *text, size_t size) {
  const double within = 5e-6;
  int best = 1000;
  if (fabs(10 * ratio - rint(10 * ratio)) <= within * 10 * ratio) return false;
  for (size_t k = 0; k < 2 * sizeof factors / sizeof *factors; k++) {
    const bool under = k % 2 == 1;
    const double factor = under ? 1 / factors[k / 2].value : factors[k / 2].value;
    const int most = factors[k / 2].is_small ? MOST_WHOLE : MOST_WITH_ROOT;
    for (int q = 1; q <= most && (k != 1); q++) {
      const double p = rint(ratio / factor * q);
      if (!(p >= 1 && p <= most) || !(fabs(ratio - p / q * factor) <= within * ratio)) continue;
      if ((int)p + q >= best) continue;
      best = (int)p + q;
      write_fraction((int)p, q, factors[k / 2].text, under, text, size);
    }
  }
  return best < 1000;
}

bool ratio_is_known(double ratio) {
  char text[64];
  return ratio_words(ratio) || ratio_formula(ratio, text, sizeof text);
}

bool ratio_is_closed(double ratio) {
  const size_t k = known_ratio(ratio);
  char text[64];
  if (k < sizeof known_ratios / sizeof *known_ratios) return known_ratios[k].closed;
  return ratio_formula(ratio, text, sizeof text) && (strstr(text, "sqrt") || strstr(text, "pi"));
}

bool ratio_is_rounding(double ratio) {
  return fabs(ratio - 1) <= 5e-3;
}

/* --- columns ---------------------------------------------------------------------------------- */

typedef enum quantity_kind { FORCES, MOMENTS, STRESSES, STATES, STRAINS, ENERGIES, KINDS } kind;

static bool begins(const char *name, const char *with) {
  return strncmp(name, with, strlen(with)) == 0;
}

/* KINDS: it is prescribed, the law's own, or follows from others. */
static kind kind_of_column(const drive_table *t, int c) {
  static const char *const energies[] = {"stored", "dissipated_damage", "dissipated_damping",
                                         "external"};
  const char *name = t->columns[c].name;
  if (c >= t->law_column) {
    const bool families = t->of == DRIVE_OF_FAMILIES;
    for (size_t k = 0; k < sizeof energies / sizeof *energies; k++)
      if (strcmp(name, energies[k]) == 0) return ENERGIES;
    return families && strcmp(name, "dissipated") == 0 ? ENERGIES : KINDS;
  }
  if (strcmp(name, "N") == 0) return FORCES;
  if (begins(name, "M_") || strcmp(name, "T") == 0) return MOMENTS;
  if (begins(name, "stress_")) return STRESSES;
  if (begins(name, "F_")) return STATES;
  return begins(name, "strain_") && !begins(name, "strain_rate") ? STRAINS : KINDS;
}

column_role column_role_of(const drive_table *t, int column) {
  const kind of = kind_of_column(t, column);
  return of == KINDS ? COLUMN_ASIDE : of == ENERGIES ? COLUMN_ENERGY : COLUMN_ANSWER;
}

static bool is_skipped(const unsigned char *skip, long row, bool energy) {
  return skip && skip[row] & (energy ? SKIP_ENERGY : SKIP_ANSWER);
}

static double largest(const double *values, long rows) {
  double most = 0;
  for (long k = 0; k < rows; k++)
    if (isfinite(values[k])) most = pl_fmax(most, fabs(values[k]));
  return most;
}

void column_scales(const drive_table *t, double *scales) {
  double of_kind[KINDS + 1] = {0};
  for (int c = 0; c < t->column_count; c++) {
    const kind of = kind_of_column(t, c);
    of_kind[of] = pl_fmax(of_kind[of], largest(t->columns[c].values, t->rows));
  }
  for (int c = 0; c < t->column_count; c++)
    scales[c] = of_kind[kind_of_column(t, c)];
}

/* The next column, or turn, of the same sort that moves most; -1: none does. */
static int most_moved(const drive_table *t) {
  int best = -1;
  double most = 0;
  for (int c = 1; c < t->law_column; c++) {
    const char *name = t->columns[c].name;
    const bool moves = begins(name, "strain_") ? !begins(name, "strain_rate")
                                               : begins(name, "theta_") || !strcmp(name, "twist");
    const double size = moves ? largest(t->columns[c].values, t->rows) : 0;
    if (size <= most) continue;
    most = size;
    best = c;
  }
  return best;
}

void driven_columns(const drive_table *t, int *way, int *force) {
  char answer[80];
  *way = t->way;
  *force = t->force;
  if (largest(t->columns[t->way].values, t->rows) > 0) return;
  const int moved = most_moved(t);
  if (moved < 0) return;
  const char *name = t->columns[moved].name;
  snprintf(answer, sizeof answer, "%s%s", begins(name, "theta_") ? "M_" : "stress_",
           begins(name, "twist") ? "" : strchr(name, '_') + 1);
  const int other = drive_column_find(t, begins(name, "twist") ? "T" : answer);
  *way = moved;
  *force = other < 0 ? t->force : other;
}

static void match_columns(table_difference *d, const drive_table *answer,
                          const drive_table *reference, bool energies) {
  const int count = reference->column_count;
  double *scales = must_calloc((size_t)count + 1, sizeof *scales);
  column_scales(reference, scales);
  d->columns = must_calloc((size_t)count + 1, sizeof *d->columns);
  for (int c = 0; c < count; c++) {
    const column_role role = column_role_of(reference, c);
    const int other = drive_column_find(answer, reference->columns[c].name);
    if (role == COLUMN_ASIDE || other < 0 || (role == COLUMN_ENERGY && !energies)) continue;
    column_difference *q = &d->columns[d->column_count++];
    *q = (column_difference){.name = reference->columns[c].name,
                             .unit = reference->columns[c].unit,
                             .answer = answer->columns[other].values,
                             .reference = reference->columns[c].values,
                             .energy = role == COLUMN_ENERGY,
                             .scale = scales[c],
                             .first = -1};
    q->minor =
        pl_fmax(largest(q->answer, d->rows), largest(q->reference, d->rows)) < little * q->scale;
    if (q->scale == 0) q->scale = largest(q->answer, d->rows);
  }
  free(scales);
}

static double gap(const column_difference *q, long row) {
  return q->scale > 0 ? fabs(q->answer[row] - q->reference[row]) / q->scale : 0;
}

static void measure(table_difference *d, const unsigned char *skip) {
  for (int c = 0; c < d->column_count; c++) {
    column_difference *q = &d->columns[c];
    for (long k = 0; k < d->rows; k++) {
      if (is_skipped(skip, k, q->energy)) continue;
      const double apart = gap(q, k);
      q->worst = apart > q->worst ? apart : q->worst;
      if (apart <= d->tolerance) continue;
      q->first = q->first < 0 ? k : q->first;
      q->differing++;
    }
  }
}

/* --- which kind ------------------------------------------------------------------------------- */

/* What a search goes over: the rows of a path, and which of them count. */
typedef struct search {
  table_difference *d;
  const column_difference *q; /* that is spoken of */
  const drive_table *reference;
  const unsigned char *skip;
  int way, force; /* columns */
} search;

static bool counts(const search *s, long row) {
  return !is_skipped(s->skip, row, s->q->energy);
}

/* The one factor between answer and reference in the rows of `side` (NULL: all); NaN: there is
   none, or too few rows tell it. */
static double common_ratio(const search *s, const bool *side) {
  const column_difference *q = s->q;
  double ab = 0, bb = 0, most = 0;
  long told = 0;
  for (long k = 0; k < s->d->rows; k++) {
    if (!counts(s, k) || (side && !side[k])) continue;
    const double a = q->answer[k] / q->scale, b = q->reference[k] / q->scale;
    ab += a * b;
    bb += b * b;
    most = pl_fmax(most, fabs(a));
    told += fabs(b) > worth;
  }
  if (told < 2) return NAN;
  const double ratio = ab / bb;
  const double allowed = pl_fmax(exact, s->d->tolerance) * pl_fmax(most, 1);
  for (long k = 0; k < s->d->rows; k++)
    if (counts(s, k) && (!side || side[k]) &&
        !(fabs(q->answer[k] - ratio * q->reference[k]) <= allowed * q->scale))
      return NAN;
  return fabs(ratio) < exact ? 0 : ratio;
}

/* The answer in each row is that of the reference in the row before (later = 1) or after (-1): its
   value, or what it is in parts of the way. The shift must explain far more than it leaves. */
static bool is_shifted(const search *s, int later, bool of_way) {
  const column_difference *q = s->q;
  const double *way = s->reference->columns[s->way].values;
  const double far = largest(way, s->d->rows), allowed = pl_fmax(exact, s->d->tolerance);
  double most = 0; /* that the shift explains */
  long told = 0;
  for (long k = 1; k < s->d->rows - 1; k++) {
    const long other = k - later;
    if (!counts(s, k) || !counts(s, other)) continue;
    if (of_way && (fabs(way[other]) <= worth * far || way[other] * way[k] < 0)) continue;
    const double expected =
        of_way ? q->reference[other] / way[other] * way[k] : q->reference[other];
    if (!(fabs(q->answer[k] - expected) <= allowed * q->scale)) return false;
    told += gap(q, k) > s->d->tolerance;
    most = pl_fmax(most, gap(q, k));
  }
  return told >= 2 && most > 20 * allowed;
}

static const double *column_values(const drive_table *t, const char *name) {
  const int c = drive_column_find(t, name);
  return c < 0 ? NULL : t->columns[c].values;
}

static double total_ratio(double answer, double reference, double scale) {
  return fabs(reference) > worth * scale ? answer / reference : NAN;
}

static double signed_peak(const double *values, long rows) {
  double best = 0;
  for (long k = 0; k < rows; k++)
    if (fabs(values[k]) > fabs(best)) best = values[k];
  return best;
}

static void find_totals(search *s, const drive_table *answer) {
  static const char *const names[TOTAL_COUNT] = {
      [TOTAL_DISSIPATED] = "dissipated", [TOTAL_WORK] = "external"};
  const drive_table *reference = s->reference;
  const long rows = s->d->rows;
  double scale = 0;
  for (int k = 0; k < TOTAL_COUNT; k++) {
    const double *r = names[k] ? column_values(reference, names[k]) : NULL;
    if (r) scale = pl_fmax(scale, largest(r, rows));
  }
  for (int k = 0; k < TOTAL_COUNT; k++) {
    const double *a = names[k] ? column_values(answer, names[k]) : NULL,
                 *r = names[k] ? column_values(reference, names[k]) : NULL;
    s->d->totals[k] = a && r ? total_ratio(a[rows - 1], r[rows - 1], scale) : NAN;
  }
  const int same = drive_column_find(answer, reference->columns[s->force].name);
  const double *a = answer->columns[same < 0 ? answer->force : same].values,
               *r = reference->columns[s->force].values;
  s->d->totals[TOTAL_PEAK] = total_ratio(signed_peak(a, rows), signed_peak(r, rows), 0);
}

/* The row in which energy is lost first, of what it has taken until then; -1: none is. */
static long losing_row(const drive_table *t, long rows) {
  const double *lost = column_values(t, "dissipated_damage"), *stored = column_values(t, "stored");
  lost = lost ? lost : column_values(t, "dissipated");
  double most = 0;
  for (long k = 0; k < rows && lost && stored; k++) {
    most = pl_fmax(most, fabs(stored[k]));
    if (lost[k] > worth * most) return k;
  }
  return -1;
}

/* Where a law begins to yield or to break, in the force that is driven. */
static void find_beginnings(search *s, const drive_table *answer) {
  const drive_column *force = &s->reference->columns[s->force];
  const int same = drive_column_find(answer, force->name);
  if (same < 0) return;
  const double *values[2] = {answer->columns[same].values, force->values};
  const long row[2] = {losing_row(answer, s->d->rows), losing_row(s->reference, s->d->rows)};
  if (labs(row[0] - row[1]) < 2 && (row[0] < 0) == (row[1] < 0)) return;
  for (int k = 0; k < 2; k++)
    s->d->begins[k] = row[k] < 0 ? NAN : fabs(signed_peak(values[k], row[k]));
  s->d->begins_of = force->name;
  s->d->begins_unit = force->unit;
}

static void find_larger(search *s) {
  long larger = 0, smaller = 0;
  for (long k = 0; k < s->d->rows; k++) {
    if (!counts(s, k) || gap(s->q, k) <= s->d->tolerance) continue;
    const double a = s->q->answer[k], b = s->q->reference[k];
    larger += fabs(a) > fabs(b) && a * b >= 0;
    smaller += fabs(a) < fabs(b) && a * b >= 0;
  }
  s->d->larger = larger == s->q->differing ? 1 : smaller == s->q->differing ? -1 : 0;
}

static bool is_same(double ratio) {
  return fabs(ratio - 1) <= 2e-3;
}

/* A total that is a known multiple: the energies where the peak agrees, else the peak. */
static bool total_tells(search *s) {
  static const difference_total order[] = {TOTAL_PEAK, TOTAL_DISSIPATED, TOTAL_WORK};
  for (size_t k = 0; k < sizeof order / sizeof *order; k++) {
    const double ratio = s->d->totals[order[k]];
    if (isnan(ratio) || is_same(ratio)) continue;
    if (!ratio_words(ratio)) return false;
    s->d->total = order[k];
    return true;
  }
  return false;
}

/* --- one side --------------------------------------------------------------------------------- */

/* Rows of a side. What a law has lost counts from the row before. */
static void mark_side(const search *s, difference_side side, bool *in) {
  const drive_table *t = s->reference;
  const double *way = t->columns[s->way].values, *lost = column_values(t, "dissipated_damage");
  const double *stored = column_values(t, "stored");
  lost = lost ? lost : column_values(t, "dissipated");
  const double energy =
      pl_fmax(stored ? largest(stored, s->d->rows) : 0, lost ? largest(lost, s->d->rows) : 0);
  double reached = 0, farthest = 0;
  for (long k = 0; k < s->d->rows; k++) {
    const double before = k ? way[k - 1] : 0, size = fabs(way[k]);
    const bool falls = way[k] * (way[k] - before) < 0, beyond = size >= reached * (1 - 1e-12),
               damaged = lost && k && lost[k] > 1e-9 * energy;
    const bool is[SIDE_COUNT] = {[SIDE_SHORTENED] = way[k] < 0,
                                 [SIDE_CLOSED] = way[k] < 0 && damaged,
                                 [SIDE_STRETCHED] = way[k] > 0,
                                 [SIDE_OPENED] = way[k] > 0 && damaged,
                                 [SIDE_UNLOADING] = falls,
                                 [SIDE_RELOADING] = !falls && !beyond,
                                 [SIDE_UNLOADED] = !beyond && way[k] * farthest >= 0,
                                 [SIDE_BEYOND] = beyond,
                                 [SIDE_DAMAGED] = damaged,
                                 [SIDE_SOUND] = !damaged};
    in[k] = is[side];
    farthest = beyond ? way[k] : farthest;
    reached = pl_fmax(reached, size);
  }
}

/* How much of a side differs, where nothing else does and something else is told; else 0. */
static double share_of(const search *s, const bool *in) {
  long inside = 0, differing = 0, agreeing = 0;
  for (long k = 0; k < s->d->rows; k++) {
    if (!counts(s, k)) continue;
    const bool differs = gap(s->q, k) > s->d->tolerance,
               told = fabs(s->q->reference[k]) > worth * s->q->scale;
    if (differs && !in[k]) return 0;
    inside += in[k] && (differs || told);
    differing += differs;
    agreeing += !in[k] && told;
  }
  return agreeing >= 2 && inside ? (double)differing / (double)inside : 0;
}

/* A strain along an axis or a stretch has a side on which it is stretched; a shear or a turn has
   none. */
static bool has_length(const search *s, difference_side side) {
  const char *name = s->reference->columns[s->way].name;
  const size_t n = strlen(name);
  return side > SIDE_OPENED || strcmp(name, "stretch") == 0 ||
         (begins(name, "strain_") && name[n - 1] == name[n - 2]);
}

/* The side that the differing states fill best, at least half. */
static bool side_tells(search *s) {
  bool *in = must_calloc((size_t)s->d->rows + 1, sizeof *in);
  double best = 0.5;
  bool found = false;
  for (int side = 0; side < SIDE_COUNT; side++) {
    if (!has_length(s, (difference_side)side)) continue;
    mark_side(s, (difference_side)side, in);
    const double share = share_of(s, in);
    if (share < best + (found ? 1e-9 : 0)) continue;
    best = share;
    found = true;
    s->d->side = (difference_side)side;
    s->d->ratio = common_ratio(s, in);
  }
  free(in);
  return found;
}

/* --- the whole -------------------------------------------------------------------------------- */

static difference_kind classify(search *s) {
  if (s->q->minor) return DIFFERENCE_STATE;
  const double ratio = common_ratio(s, NULL);
  s->d->ratio = ratio;
  if (fabs(ratio + 1) <= exact) return DIFFERENCE_SIGN;
  if (!isnan(ratio)) return DIFFERENCE_RATIO;
  for (int of_way = 0; of_way < 2; of_way++) {
    if (is_shifted(s, 1, of_way)) return DIFFERENCE_LATE;
    if (is_shifted(s, -1, of_way)) return DIFFERENCE_EARLY;
  }
  const bool on_a_side = side_tells(s);
  if (on_a_side && (ratio_words(fabs(s->d->ratio)) || fabs(s->d->ratio + 1) <= exact))
    return DIFFERENCE_SIDE;
  if (total_tells(s)) return DIFFERENCE_TOTAL;
  return on_a_side ? DIFFERENCE_SIDE : DIFFERENCE_STATE;
}

/* The answer ends, for want of a number, where the reference goes on. */
static bool ends_early(table_difference *d, const drive_table *answer,
                       const drive_table *reference) {
  const long row = answer->bad_row;
  if (row < 0 || (reference->bad_row >= 0 && reference->bad_row <= row)) return false;
  d->kind = DIFFERENCE_NO_NUMBER;
  d->row = row;
  for (int c = 0; c < answer->column_count && !d->bad; c++)
    if (!isfinite(answer->columns[c].values[row])) d->bad = answer->columns[c].name;
  return true;
}

/* The first that differs, of what is not little where there is such a one. */
static bool choose_column(table_difference *d) {
  int first = -1;
  for (int c = 0; c < d->column_count; c++) {
    const column_difference *q = &d->columns[c];
    if (q->first >= 0 && (first < 0 || (d->columns[first].minor && !q->minor && !q->energy)))
      first = c;
  }
  d->of = first < 0 ? 0 : first;
  return first >= 0;
}

void table_difference_find(table_difference *d, const drive_table *answer,
                           const drive_table *reference, double tolerance,
                           const unsigned char *skip, bool energies) {
  *d = (table_difference){.tolerance = tolerance, .row = -1, .ratio = NAN, .begins = {NAN, NAN}};
  d->rows = answer->rows < reference->rows ? answer->rows : reference->rows;
  if (reference->bad_row >= 0 && reference->bad_row < d->rows) d->rows = reference->bad_row;
  for (int k = 0; k < TOTAL_COUNT; k++)
    d->totals[k] = NAN;
  for (long k = 0; k < d->rows; k++)
    d->skipped += is_skipped(skip, k, false);
  if (ends_early(d, answer, reference)) return;
  match_columns(d, answer, reference, energies);
  measure(d, skip);
  if (!choose_column(d)) return;
  search s = {.d = d, .q = &d->columns[d->of], .reference = reference, .skip = skip};
  driven_columns(reference, &s.way, &s.force);
  d->row = s.q->first;
  find_totals(&s, answer);
  find_beginnings(&s, answer);
  find_larger(&s);
  d->kind = classify(&s);
}

void table_difference_free(table_difference *d) {
  free(d->columns);
  *d = (table_difference){.row = -1};
}
