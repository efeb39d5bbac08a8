#include "generator/results/compare_results.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/characters.h"
#include "dsl/base/elementary.h"
#include "generator/kernel/document.h"
#include "generator/results/result_table.h"
#include "runtime/base/quantity.h"
#include "runtime/result/result_fields.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_names.h"
#include "runtime/result/result_read.h"

enum { SAME = 0, WRONG = 1, DIFFERENT = 2 };

typedef struct comparison_run {
  const results_request *request;
  result_file *files[2];
  int compared, different;
  bool wrong;     /* something asked for is not there */
  const char *of; /* what is compared now: "history", "frames" */
  json *list;     /* of the document, for each quantity; or NULL */
} comparison_run;

/* The largest difference of a quantity so far, and the largest value as its measure. */
typedef struct gap {
  double largest, scale;
  long frame, row; /* where it is */
} gap;

static const gap no_gap = {0, 0, -1, -1};

/* Two values that are no numbers are the same; one alone differs without bound. */
static void widen(gap *g, double a, double b, long frame, long row) {
  const bool differ = a != b && !(isnan(a) && isnan(b));
  const double d = differ ? fabs(a - b) : 0;
  if (!isnan(a)) g->scale = pl_fmax(g->scale, fabs(a));
  if (!isnan(b)) g->scale = pl_fmax(g->scale, fabs(b));
  if (!differ || (g->row >= 0 && !(isnan(d) ? !isnan(g->largest) : d > g->largest))) return;
  g->largest = d;
  g->frame = frame;
  g->row = row;
}

static double relative(const gap *g) {
  if (g->row < 0) return 0;
  return g->scale > 0 && isfinite(g->largest) && isfinite(g->scale) ? g->largest / g->scale
                                                                    : INFINITY;
}

/* What is found of one quantity. */
typedef struct finding {
  const char *name, *unit; /* "" where it has none */
  gap gap;
  const char *incomparable; /* how the two are unlike, or NULL */
  char place[256];          /* of the largest gap, in words */
  double time, values[2];   /* there; NAN where there are none */
  long frame;               /* or -1 */
  const char *at;           /* "sample", "particle", "bond", "point": the gap's row; or NULL */
} finding;

static finding finding_of(const char *name, const char *unit_text, const gap *g) {
  return (finding){.name = name,
                   .unit = unit_text,
                   .gap = g ? *g : no_gap,
                   .time = NAN,
                   .values = {NAN, NAN},
                   .frame = -1};
}

static bool is_different(const comparison_run *c, const finding *f) {
  return f->incomparable || relative(&f->gap) > c->request->tolerance;
}

static void print_finding(const comparison_run *c, const finding *f) {
  char title[128];
  if (f->incomparable) {
    printf("* %-34s %s\n", name_shown(f->name), f->incomparable);
    return;
  }
  snprintf(title, sizeof title, "%s [%s]", name_shown(f->name),
           *f->unit ? name_shown(f->unit) : "1");
  printf("%c %-34s %12.4g %12.4g%s\n", is_different(c, f) ? '*' : ' ', title, f->gap.largest,
         relative(&f->gap), f->place);
}

static void put_finding(const comparison_run *c, const finding *f) {
  json *w = c->list;
  json_object(w);
  json_put_text(w, "of", c->of);
  json_put_text(w, "name", f->name);
  json_put_text(w, "unit", f->incomparable ? NULL : *f->unit ? f->unit : "1");
  json_put_bool(w, "different", is_different(c, f));
  json_put_text(w, "incomparable", f->incomparable);
  json_put_number(w, "gap", f->incomparable ? NAN : f->gap.largest);
  json_put_number(w, "relative", f->incomparable ? NAN : relative(&f->gap));
  json_put_number(w, "time", f->time);
  json_put_number(w, "frame", f->frame >= 0 ? (double)f->frame : NAN);
  json_put_text(w, "at", f->at);
  json_put_number(w, "index", f->at ? (double)f->gap.row : NAN);
  json_put_array(w, "values");
  json_number(w, f->values[0]);
  json_number(w, f->values[1]);
  json_array_end(w);
  json_object_end(w);
}

static void report(comparison_run *c, const finding *f) {
  c->compared++;
  c->different += is_different(c, f);
  print_finding(c, f);
  if (c->list) put_finding(c, f);
}

static void report_unlike(comparison_run *c, const char *name, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static void report_unlike(comparison_run *c, const char *name, const char *format, ...) {
  char text[512];
  va_list values;
  va_start(values, format);
  vsnprintf(text, sizeof text, format, values);
  va_end(values);
  finding f = finding_of(name, "", NULL);
  f.incomparable = text;
  report(c, &f);
}

/* --- histories -------------------------------------------------------------------------------- */

typedef struct time_axis {
  double *time[2];
  long count[2];
  bool same;    /* sample by sample, to rounding */
  double until; /* s: what both have */
} time_axis;

static bool read_axis(comparison_run *c, time_axis *x) {
  char error[1024], unit_text[64];
  for (int k = 0; k < 2; k++) {
    x->time[k] = result_read_series(c->files[k], "time", &x->count[k], unit_text, sizeof unit_text,
                                    error, sizeof error);
    if (!x->time[k] || x->count[k] == 0) {
      say_error("%s", x->time[k] ? "a result has no samples" : error);
      return false;
    }
  }
  const double end[2] = {x->time[0][x->count[0] - 1], x->time[1][x->count[1] - 1]};
  x->until = pl_fmin(end[0], end[1]);
  x->same = x->count[0] == x->count[1];
  for (long n = 0; x->same && n < x->count[0]; n++)
    x->same = fabs(x->time[0][n] - x->time[1][n]) <= 1e-9 * pl_fmax(end[0], end[1]);
  return true;
}

/* Value of the second result's history at time t, on the straight line between its samples. */
static double value_at(const time_axis *x, const double *values, double t, long *from) {
  const double *time = x->time[1];
  const long last = x->count[1] - 1;
  while (*from < last && time[*from + 1] < t)
    ++*from;
  if (*from == last || t <= time[*from]) return values[*from];
  const double part = (t - time[*from]) / (time[*from + 1] - time[*from]);
  return part >= 1 ? values[*from + 1] : values[*from] + part * (values[*from + 1] - values[*from]);
}

static gap gap_of_series(const time_axis *x, const double *a, const double *b) {
  gap g = no_gap;
  long from = 0;
  for (long n = 0; n < x->count[0]; n++) {
    if (x->time[0][n] > x->until * (1 + 1e-9)) break;
    widen(&g, a[n], x->same ? b[n] : value_at(x, b, x->time[0][n], &from), 0, n);
  }
  return g;
}

static bool is_energy(const char *name) {
  return strncmp(name, "energy/", 7) == 0;
}

/* Largest of all energies in either result, J. */
static double largest_energy(const comparison_run *c) {
  double most = 0;
  char error[1024];
  for (int k = 0; k < 2; k++) {
    result_names names = result_members(c->files[k], "/history");
    for (int n = 0; n < names.count; n++) {
      table_values v;
      if (!is_energy(names.items[n]) ||
          !table_read(c->files[k], names.items[n], -1, &v, error, sizeof error))
        continue;
      for (long i = 0; i < v.count; i++)
        if (isfinite(v.values[i])) most = pl_fmax(most, fabs(v.values[i]));
      free(v.values);
    }
    result_names_free(&names);
  }
  return most;
}

static void locate_sample(finding *f, const time_axis *x, const double *a, const double *b) {
  const long row = f->gap.row;
  f->at = "sample";
  f->time = x->time[0][row];
  f->values[0] = a[row];
  f->values[1] = x->same ? b[row] : value_at(x, b, f->time, &(long){0});
  char when[TIME_TEXT];
  snprintf(f->place, sizeof f->place, "  t = %s: %.9g and %.9g", time_text(f->time, 6, when),
           f->values[0], f->values[1]);
}

/* A series that is not checked in one of the results says nothing about the other's. */
static bool is_checked(comparison_run *c, const char *name) {
  char why[2][256];
  for (int k = 0; k < 2; k++)
    result_read_unchecked(c->files[k], name, why[k], sizeof why[k]);
  if (!*why[0] && !*why[1]) return true;
  if (*why[0] && *why[1]) {
    printf("  %-34s not checked in either: %s\n", name_shown(name), name_shown(why[0]));
    return false;
  }
  report_unlike(c, name, "not checked in %s: %s", c->request->results[!*why[0]],
                name_shown(why[!*why[0]]));
  return false;
}

static void compare_history(comparison_run *c, const time_axis *x, const char *name,
                            double energy) {
  char error[1024];
  if (!is_checked(c, name)) return;
  table_values a, b = {.values = NULL};
  const bool good = table_read(c->files[0], name, -1, &a, error, sizeof error) &&
                    table_read(c->files[1], name, -1, &b, error, sizeof error);
  if (!good || a.count != x->count[0] || b.count != x->count[1]) {
    say_error("%s", good ? "a history has not as many values as times" : error);
    c->wrong = true;
  } else if (strcmp(a.unit, b.unit) != 0) {
    report_unlike(c, name, "[%s] and [%s]: not the same unit", name_shown(a.unit),
                  name_shown(b.unit));
  } else {
    gap g = gap_of_series(x, a.values, b.values);
    if (is_energy(name)) g.scale = pl_fmax(g.scale, energy);
    finding f = finding_of(name, a.unit, &g);
    if (g.row >= 0) locate_sample(&f, x, a.values, b.values);
    report(c, &f);
  }
  free(a.values);
  free(b.values);
}

static void compare_ends(comparison_run *c, const time_axis *x) {
  if (x->same) return;
  gap g = no_gap;
  const long last[2] = {x->count[0] - 1, x->count[1] - 1};
  widen(&g, x->time[0][last[0]], x->time[1][last[1]], 0, 0);
  finding f = finding_of("time", "s", &g);
  for (int k = 0; k < 2; k++)
    f.values[k] = x->time[k][last[k]];
  char ends[2][TIME_TEXT];
  snprintf(f.place, sizeof f.place,
           "  %ld samples to %s and %ld to %s; compared at the times of the first", x->count[0],
           time_text(f.values[0], 6, ends[0]), x->count[1], time_text(f.values[1], 6, ends[1]));
  report(c, &f);
}

typedef void compare_one(comparison_run *c, const char *name, void *context);

/* The full name of what is asked for, which must be the same in both. False after a message. */
static bool find_in_both(comparison_run *c, const char *group, const char *asked, char *name,
                         size_t size) {
  char other[256], error[1024];
  bool good = result_find(c->files[0], group, asked, name, size, error, sizeof error) &&
              result_find(c->files[1], group, asked, other, sizeof other, error, sizeof error);
  if (good && strcmp(name, other) != 0) {
    snprintf(error, sizeof error, "`%.250s` is `%s` in the first result and `%s` in the second",
             asked, name, other);
    good = false;
  }
  if (!good) say_error("%s", error);
  return good;
}

static void each_asked(comparison_run *c, const char *group, const char *const *asked, int count,
                       compare_one *compare, void *context) {
  for (int k = 0; k < count; k++) {
    char name[256];
    if (find_in_both(c, group, asked[k], name, sizeof name))
      compare(c, name, context);
    else
      c->wrong = true;
  }
}

static bool has_name(const result_names *n, const char *name) {
  return name_index_at(&n->whole, name) != NULL;
}

/* Names that both have; what only one has is reported. */
static void each_name(comparison_run *c, const char *group, compare_one *compare, void *context) {
  result_names names[2];
  for (int n = 0; n < 2; n++)
    names[n] = result_members(c->files[n], group);
  for (int k = 0; k < names[0].count; k++)
    if (has_name(&names[1], names[0].items[k]))
      compare(c, names[0].items[k], context);
    else
      report_unlike(c, names[0].items[k], "only in %s", c->request->results[0]);
  for (int k = 0; k < names[1].count; k++)
    if (!has_name(&names[0], names[1].items[k]))
      report_unlike(c, names[1].items[k], "only in %s", c->request->results[1]);
  for (int n = 0; n < 2; n++)
    result_names_free(&names[n]);
}

typedef struct history_context {
  time_axis axis;
  double energy;
} history_context;

static void compare_one_history(comparison_run *c, const char *name, void *context) {
  const history_context *h = context;
  compare_history(c, &h->axis, name, h->energy);
}

static void compare_histories(comparison_run *c) {
  c->of = "history";
  history_context h = {.axis = {.until = 0}};
  if (read_axis(c, &h.axis)) {
    h.energy = largest_energy(c);
    printf("  %-34s %12s %12s  where\n", "history", "largest gap", "relative");
    compare_ends(c, &h.axis);
    if (c->request->history_count)
      each_asked(c, "/history", c->request->histories, c->request->history_count,
                 compare_one_history, &h);
    else
      each_name(c, "/history", compare_one_history, &h);
  } else
    c->wrong = true;
  for (int k = 0; k < 2; k++)
    free(h.axis.time[k]);
}

/* --- frames ----------------------------------------------------------------------------------- */

typedef struct frame_context {
  double *reference[2], *time[2];
  int32_t *bonds;
  long particles[2], bond_count, frames[2];
  int dimensions[2];
} frame_context;

static bool same_particles(const frame_context *x) {
  if (!x->reference[0] || !x->reference[1] || x->particles[0] != x->particles[1] ||
      x->dimensions[0] != x->dimensions[1])
    return false;
  double extent = 0, apart = 0;
  for (long n = 0; n < x->dimensions[0] * x->particles[0]; n++) {
    extent = pl_fmax(extent, fabs(x->reference[0][n]));
    apart = pl_fmax(apart, fabs(x->reference[0][n] - x->reference[1][n]));
  }
  return apart <= 1e-9 * extent;
}

/* Half way between two particles, or where one stands. */
static void write_middle(char *text, size_t size, const frame_context *x, long i, long j) {
  const int n = x->dimensions[0];
  size_t used = 0;
  for (int c = 0; c < n && used < size; c++)
    used += (size_t)snprintf(text + used, size - used, "%s%.6g%s", c ? ", " : "(",
                             500 * (x->reference[0][n * i + c] + x->reference[0][n * j + c]),
                             c == n - 1 ? ") mm" : "");
}

static bool same_instant(const frame_context *x, long frame) {
  const double a = x->time[0][frame], b = x->time[1][frame];
  return fabs(a - b) <= 1e-9 * pl_fmax(fabs(a), fabs(b));
}

/* Frames are compared by number: of runs that end at other times they are not of one instant. */
static int write_instant(char *text, size_t size, const frame_context *x, long frame) {
  char a[TIME_TEXT], b[TIME_TEXT];
  time_text(x->time[0][frame], 6, a);
  time_text(x->time[1][frame], 6, b);
  return same_instant(x, frame) ? snprintf(text, size, "  frame %ld, t = %s, ", frame, a)
                                : snprintf(text, size, "  frame %ld, t = %s and %s, ", frame, a, b);
}

static void locate_row(finding *f, const frame_context *x) {
  const gap *g = &f->gap;
  const bool on_bonds = table_on_bonds(f->name);
  const bool placed = !on_bonds || (x->bonds && g->row < x->bond_count);
  const int32_t own[2] = {(int32_t)g->row, (int32_t)g->row};
  const int32_t *ends = on_bonds && placed ? &x->bonds[2 * g->row] : own;
  f->frame = g->frame;
  f->at = on_bonds ? "bond" : "particle";
  f->time = x->time[0][g->frame];
  int n = write_instant(f->place, sizeof f->place, x, g->frame);
  if (!placed) return;
  n += snprintf(f->place + n, sizeof f->place - (size_t)n, "%s %ld at ", f->at, g->row);
  write_middle(f->place + n, sizeof f->place - (size_t)n, x, ends[0], ends[1]);
}

/* One field in all frames that both have. */
static void compare_field(comparison_run *c, const char *name, void *context) {
  const frame_context *x = context;
  const long frames = x->frames[0] < x->frames[1] ? x->frames[0] : x->frames[1];
  gap g = no_gap;
  char unit_text[64] = "";
  for (long f = 0; f < frames; f++) {
    char error[1024];
    table_values a, b = {.values = NULL};
    const bool good = table_read(c->files[0], name, f, &a, error, sizeof error) &&
                      table_read(c->files[1], name, f, &b, error, sizeof error);
    const bool fit =
        good && a.count == b.count && a.components == b.components && strcmp(a.unit, b.unit) == 0;
    for (long n = 0; fit && n < a.count * a.components; n++)
      widen(&g, a.values[n], b.values[n], f, n / a.components);
    if (good) memcpy(unit_text, a.unit, sizeof unit_text);
    free(a.values);
    free(b.values);
    if (fit) continue;
    if (good) {
      report_unlike(c, name, "not of the same size and unit");
    } else {
      say_error("%s", error);
      c->wrong = true;
    }
    return;
  }
  finding found = finding_of(name, unit_text, &g);
  if (g.row >= 0) locate_row(&found, x);
  report(c, &found);
}

/* Points of a crack in all frames that both have. */
static void compare_path(comparison_run *c, const char *crack, const frame_context *x) {
  char error[1024], name[300];
  long frames[2] = {0, 0}, most[2] = {0, 0};
  double *points[2];
  for (int k = 0; k < 2; k++)
    points[k] = result_read_path(c->files[k], crack, &frames[k], &most[k], error, sizeof error);
  snprintf(name, sizeof name, "cracks/%.250s/points", crack);
  gap g = no_gap;
  const long both = frames[0] < frames[1] ? frames[0] : frames[1];
  for (long f = 0; points[0] && points[1] && f < both; f++)
    for (long n = 0; n < 2 * most[0] || n < 2 * most[1]; n++)
      widen(&g, n < 2 * most[0] ? points[0][2 * most[0] * f + n] : NAN,
            n < 2 * most[1] ? points[1][2 * most[1] * f + n] : NAN, f, n / 2);
  if (points[0] && points[1]) {
    finding found = finding_of(name, "m", &g);
    if (g.row >= 0) {
      found.frame = g.frame;
      found.at = "point";
      found.time = x->time[0][g.frame];
      const int used = write_instant(found.place, sizeof found.place, x, g.frame);
      snprintf(found.place + used, sizeof found.place - (size_t)used, "point %ld", g.row);
    }
    report(c, &found);
  } else {
    say_error("%s", error);
    c->wrong = true;
  }
  free(points[0]);
  free(points[1]);
}

/* Cracks of meshes. */
static void compare_paths(comparison_run *c, const frame_context *x) {
  for (int k = 0; k < 2; k++) {
    result_names cracks = result_list(c->files[k], "/cracks");
    for (int n = 0; n < cracks.count; n++) {
      const char *crack = cracks.items[n];
      char name[300];
      if (!result_has_path(c->files[k], crack)) continue;
      snprintf(name, sizeof name, "cracks/%.250s/points", crack);
      if (!result_has_path(c->files[1 - k], crack))
        report_unlike(c, name, "only in %s", c->request->results[k]);
      else if (k == 0)
        compare_path(c, crack, x);
    }
    result_names_free(&cracks);
  }
}

static void compare_frame_times(comparison_run *c, const frame_context *x) {
  gap g = no_gap;
  for (long f = 0; f < x->frames[0] && f < x->frames[1]; f++)
    widen(&g, x->time[0][f], x->time[1][f], f, f);
  if (relative(&g) > 1e-9) {
    finding f = finding_of("time of frames", "s", &g);
    f.frame = g.frame;
    for (int k = 0; k < 2; k++)
      f.values[k] = x->time[k][g.frame];
    char times[2][TIME_TEXT];
    snprintf(f.place, sizeof f.place, "  frame %ld: %s and %s", g.frame,
             time_text(f.values[0], 6, times[0]), time_text(f.values[1], 6, times[1]));
    report(c, &f);
  }
  if (x->frames[0] == x->frames[1]) return;
  report_unlike(c, "number of frames", "%ld and %ld; the first %ld are compared", x->frames[0],
                x->frames[1], x->frames[0] < x->frames[1] ? x->frames[0] : x->frames[1]);
}

static void compare_frames(comparison_run *c) {
  c->of = "frames";
  frame_context x = {.bond_count = 0};
  for (int k = 0; k < 2; k++) {
    x.reference[k] = result_read_reference(c->files[k], &x.particles[k], &x.dimensions[k]);
    x.time[k] = result_read_frame_times(c->files[k], &x.frames[k]);
    x.frames[k] = x.time[k] ? x.frames[k] : 0;
  }
  x.bonds = result_read_bonds(c->files[0], NULL, &x.bond_count);
  printf("  %-34s %12s %12s  where\n", "field of frames", "largest gap", "relative");
  if (same_particles(&x)) {
    compare_frame_times(c, &x);
    if (c->request->field_count)
      each_asked(c, "/frames", c->request->fields, c->request->field_count, compare_field, &x);
    else
      each_name(c, "/frames", compare_field, &x);
    if (!c->request->field_count) compare_paths(c, &x);
  } else {
    report_unlike(c, "particles", "%ld and %ld, or at other places: no frames are compared",
                  x.particles[0], x.particles[1]);
  }
  for (int k = 0; k < 2; k++) {
    free(x.reference[k]);
    free(x.time[k]);
  }
  free(x.bonds);
}

/* --- both ------------------------------------------------------------------------------------- */

static int conclude(const comparison_run *c) {
  const double tolerance = c->request->tolerance;
  if (c->wrong) return WRONG;
  if (c->different == 0)
    printf("same: %d quantit%s, none differs by more than %g\n", c->compared,
           c->compared == 1 ? "y" : "ies", tolerance);
  else
    printf("different: %d of %d quantit%s (marked *) by more than %g\n", c->different, c->compared,
           c->compared == 1 ? "y" : "ies", tolerance);
  return c->different ? DIFFERENT : SAME;
}

int compare_results(const results_request *q, json *list) {
  comparison_run c = {.request = q, .list = list};
  for (int k = 0; k < 2; k++)
    c.files[k] = table_open("perilat compare", q->results[k]);
  if (c.files[0] && c.files[1]) {
    const bool all = !q->history_count && !q->field_count;
    if (all || q->history_count) compare_histories(&c);
    if (all || q->field_count) compare_frames(&c);
  }
  for (int k = 0; k < 2; k++)
    c.wrong = !(c.files[k] && table_close(c.files[k], !c.wrong));
  return conclude(&c);
}
