/* Curves of histories: several results in one picture. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/characters.h"
#include "dsl/base/elementary.h"
#include "dsl/base/units.h"
#include "runtime/plot/colour_scale.h"
#include "runtime/plot/plot_axes.h"
#include "runtime/plot/plot_beside.h"
#include "runtime/plot/plot_curve.h"
#include "runtime/result/result_file.h"
#include "runtime/result/result_read.h"

enum { MOST_CURVES = 64 };

typedef struct curve {
  double *x, *y;
  long count;
  char label[256];
} curve;

static void label_of(const char *path, char *label, size_t size) {
  const char *slash = strrchr(path, '/');
  const char *name = slash ? slash + 1 : path;
  const char *dot = strrchr(name, '.');
  snprintf(label, size, "%.*s", (int)(dot ? dot - name : (long)strlen(name)), name);
}

/* A series that says nothing, and why, is no curve. */
static bool is_checked(result_file *f, const char *name, char *error, size_t size) {
  char why[256];
  result_read_unchecked(f, name, why, sizeof why);
  if (*why) snprintf(error, size, "`%s` is not checked: %s", name, name_shown(why));
  return !*why;
}

static bool read_curve(result_file *f, const char *x, const char *y, curve *c, char *x_unit,
                       char *y_unit, char *error, size_t size) {
  long count_y = 0;
  if (!is_checked(f, x, error, size) || !is_checked(f, y, error, size)) return false;
  c->x = result_read_series(f, x, &c->count, x_unit, 64, error, size);
  c->y = c->x ? result_read_series(f, y, &count_y, y_unit, 64, error, size) : NULL;
  if (c->x && c->y && count_y < c->count) c->count = count_y;
  return c->x && c->y;
}

static void range_of(const curve *curves, int count, const plot_curve_options *o, bool of_x,
                     double *low, double *high) {
  *low = INFINITY;
  *high = -INFINITY;
  for (int c = 0; c < count; c++)
    for (long k = 0; k < curves[c].count; k++) {
      double v = of_x ? curves[c].x[k] : curves[c].y[k];
      const bool beyond = !of_x && o->y_most > 0 && fabs(v) > o->y_most;
      if (isfinite(v) && !beyond) {
        *low = pl_fmin(*low, v);
        *high = pl_fmax(*high, v);
      }
    }
  for (int b = 0; b < o->beside_count; b++)
    beside_range(&o->beside[b], of_x, low, high);
}

static void draw_curve(canvas *c, const curve *k, const axis *x, const axis *y, colour ink) {
  canvas_colour(c, ink);
  cairo_set_line_width(c->cr, 2);
  cairo_set_line_join(c->cr, CAIRO_LINE_JOIN_ROUND);
  bool pen_down = false;
  for (long q = 0; q < k->count; q++) {
    if (!isfinite(k->x[q]) || !isfinite(k->y[q])) {
      pen_down = false;
      continue;
    }
    double px = axis_along_x(x, k->x[q]), py = axis_along_y(y, k->y[q]);
    if (pen_down)
      cairo_line_to(c->cr, px, py);
    else
      cairo_move_to(c->cr, px, py);
    pen_down = true;
  }
  cairo_stroke(c->cr);
}

/* --- legend ----------------------------------------------------------------------------------- */

typedef struct diagram {
  const curve *curves;
  int count;
  const plot_curve_options *o;
  axis x, y;
} diagram;

typedef struct box {
  double left, top, width, height;
} box;

static long points_in(const diagram *g, box b, const double *x, const double *y, long count) {
  long inside = 0;
  for (long k = 0; x && y && k < count; k++) {
    const double px = axis_along_x(&g->x, x[k]), py = axis_along_y(&g->y, y[k]);
    inside += px > b.left && px < b.left + b.width && py > b.top && py < b.top + b.height;
  }
  return inside;
}

/* A line across the picture, or the lower end of a band, passes through the rectangle. */
static bool level_in(const diagram *g, box b, const double *y) {
  const double py = y ? axis_along_y(&g->y, *y) : -1;
  return py > b.top && py < b.top + b.height;
}

/* What a rectangle of the picture would cover. */
static long samples_in(const diagram *g, box b) {
  enum { WIDE = 20 }; /* as many samples as a line across is worth */
  long inside = 0;
  for (int c = 0; c < g->count; c++)
    inside += points_in(g, b, g->curves[c].x, g->curves[c].y, g->curves[c].count);
  for (int k = 0; k < g->o->beside_count; k++) {
    const plot_beside *s = &g->o->beside[k];
    if (!s->x) inside += WIDE * (level_in(g, b, s->y) + level_in(g, b, s->low));
    inside += points_in(g, b, s->x, s->y, s->count) + points_in(g, b, s->x, s->low, s->count) +
              points_in(g, b, s->x, s->high, s->count);
  }
  return inside;
}

static const char *label_at(const diagram *g, int k) {
  return k < g->count ? g->curves[k].label : g->o->beside[k - g->count].label;
}

/* In the corner where it covers least; the upper right one when it can be had. */
static box place_legend(const diagram *g, double width, double height) {
  const double lefts[] = {DIAGRAM_RIGHT - width - 10, DIAGRAM_LEFT + 14},
               tops[] = {DIAGRAM_TOP + 8, DIAGRAM_BOTTOM - height - 10};
  box best = {lefts[0], tops[0], width, height};
  long least = samples_in(g, best);
  for (int corner = 1; corner < 4; corner++) {
    const box b = {lefts[corner % 2], tops[corner / 2], width, height};
    const long inside = samples_in(g, b);
    if (inside >= least) continue;
    least = inside;
    best = b;
  }
  return best;
}

static void draw_legend(canvas *c, const diagram *g) {
  enum { LINE = 26 };
  const int count = g->count + g->o->beside_count;
  if (LINE * count + 18 > DIAGRAM_BOTTOM - DIAGRAM_TOP) return; /* it would hide all */
  double widest = 0;
  for (int k = 0; k < count; k++)
    widest = pl_fmax(widest, canvas_text_width(c, 19, label_at(g, k)));
  const box b = place_legend(g, pl_fmin(widest, 500) + 70, LINE * count + 10);
  cairo_set_source_rgba(c->cr, 1, 1, 1, 0.85);
  cairo_rectangle(c->cr, b.left, b.top, b.width, b.height);
  cairo_fill(c->cr);
  for (int k = 0; k < count; k++) {
    const double line = b.top + LINE * k + 20;
    canvas_colour(c, scale_ink(k, g->count));
    if (k < g->count)
      canvas_line(c, b.left + 10, line - 6, b.left + 46, line - 6, 3);
    else
      beside_draw_sample(c, &g->o->beside[k - g->count], k - g->count, b.left + 10, line - 6);
    canvas_colour(c, (colour){0.1, 0.1, 0.1});
    canvas_text_within(c, b.left + 56, line, 19, 500, label_at(g, k));
  }
}

/* --- the picture ------------------------------------------------------------------------------ */

/* Within the frame, and half a line more. */
static void draw_inside(canvas *c, const diagram *g) {
  const plot_curve_options *o = g->o;
  cairo_save(c->cr);
  cairo_rectangle(c->cr, DIAGRAM_LEFT - 1, DIAGRAM_TOP - 1, DIAGRAM_RIGHT - DIAGRAM_LEFT + 2,
                  DIAGRAM_BOTTOM - DIAGRAM_TOP + 2);
  cairo_clip(c->cr);
  for (int k = 0; k < o->beside_count; k++)
    beside_draw_band(c, &o->beside[k], k, &g->x, &g->y);
  for (int k = 0; k < g->count; k++)
    draw_curve(c, &g->curves[k], &g->x, &g->y, scale_ink(k, g->count));
  for (int k = 0; k < o->beside_count; k++)
    beside_draw_points(c, &o->beside[k], k, &g->x, &g->y);
  cairo_restore(c->cr);
}

static bool draw_all(const curve *curves, int count, const plot_curve_options *o,
                     const char *x_unit, const char *y_unit, const char *title, char *error,
                     size_t size) {
  diagram g = {.curves = curves, .count = count, .o = o};
  double low, high;
  range_of(curves, count, o, true, &low, &high);
  if (!axis_set(&g.x, o->x, x_unit, o->x_unit, low, high, error, size)) return false;
  range_of(curves, count, o, false, &low, &high);
  if (!axis_set(&g.y, o->y, y_unit, o->y_unit, low, high, error, size)) return false;
  canvas c;
  if (!canvas_open(&c, o->output, DIAGRAM_WIDTH, DIAGRAM_HEIGHT, error, size)) return false;
  axes_draw(&c, &g.x, &g.y, title);
  draw_inside(&c, &g);
  if (count + o->beside_count > 1 || o->labels) draw_legend(&c, &g);
  return canvas_close(&c, error, size);
}

/* What all curves of a picture have in common. */
typedef struct curve_set {
  const plot_curve_options *o;
  const char *const *results;
  int result_count;
  curve curves[MOST_CURVES];
  int count;
  char x_unit[64], y_unit[64], title[512]; /* title: what those of all results begin with */
  size_t group;                            /* length of what all names begin with: "energy/" */
} curve_set;

/* Keeps what both titles begin with, up to a comma or colon: "Prism" of "Prism, 0 degrees" and
   "Prism, 15 degrees". */
static void common_title(char *title, const char *other) {
  size_t same = 0, whole = 0;
  for (;; same++) {
    const bool ends[] = {!title[same] || strchr(",:;", title[same]),
                         !other[same] || strchr(",:;", other[same])};
    if (ends[0] && ends[1]) whole = same;
    if (title[same] != other[same] || !title[same]) break;
  }
  title[whole] = 0;
}

/* "beam", "stored" or "beam: stored": what tells the curves apart, and what the user wants said. */
static void label_curve(const curve_set *s, int from, int y, curve *c) {
  char name[sizeof c->label / 2] = "";
  const bool named = s->o->labels || s->result_count > 1 || s->o->y_count == 1,
             several = s->o->y_count > 1;
  if (s->o->labels)
    snprintf(name, sizeof name, "%s", s->o->labels[from]);
  else if (named)
    label_of(s->results[from], name, sizeof name);
  snprintf(c->label, sizeof c->label, "%s%s%.120s", name, named && several ? ": " : "",
           several ? s->o->ys[y] + s->group : "");
}

static bool units_fit(curve_set *s, int from, const char *y, const char *x_unit, const char *y_unit,
                      char *error, size_t size) {
  if (s->count == 1) {
    snprintf(s->x_unit, sizeof s->x_unit, "%s", x_unit);
    snprintf(s->y_unit, sizeof s->y_unit, "%s", y_unit);
    return true;
  }
  if (strcmp(s->x_unit, x_unit) != 0)
    snprintf(error, size, "`%s` holds `%s` in another unit (%s) than `%s` (%s)", s->results[from],
             s->o->x, name_shown(x_unit), s->results[0], name_shown(s->x_unit));
  else if (strcmp(s->y_unit, y_unit) != 0)
    snprintf(error, size,
             "`%s` of `%s` is %s%s, but `%s` of `%s` is %s%s; curves of one picture have one unit",
             y, s->results[from], unit_is_pure(y_unit) ? "" : "in ",
             unit_is_pure(y_unit) ? "a pure number" : name_shown(y_unit), s->o->ys[0],
             s->results[0], unit_is_pure(s->y_unit) ? "" : "in ",
             unit_is_pure(s->y_unit) ? "a pure number" : name_shown(s->y_unit));
  else
    return true;
  return false;
}

/* The curves of one result. */
static bool add_curves(curve_set *s, int from, char *error, size_t size) {
  result_file *f = result_read(s->results[from], error, size);
  if (!f) return false;
  char *title = result_read_title(f);
  if (from == 0) snprintf(s->title, sizeof s->title, "%s", title);
  common_title(s->title, title);
  free(title);
  bool good = true;
  for (int y = 0; good && y < s->o->y_count; y++) {
    char x_unit[64] = "1", y_unit[64] = "1";
    curve *c = &s->curves[s->count++];
    label_curve(s, from, y, c);
    good = read_curve(f, s->o->x, s->o->ys[y], c, x_unit, y_unit, error, size) &&
           units_fit(s, from, s->o->ys[y], x_unit, y_unit, error, size);
  }
  if (result_trouble(f)) {
    snprintf(error, size, "%s", result_trouble(f));
    good = false;
  }
  result_read_close(f);
  return good;
}

/* Length of the "energy/" that all names begin with; the axis says it, the legend need not. */
static size_t group_of(const plot_curve_options *o) {
  const size_t group = strcspn(o->ys[0], "/") + 1;
  if (o->y_count < 2 || !strchr(o->ys[0], '/')) return 0;
  for (int y = 1; y < o->y_count; y++)
    if (strncmp(o->ys[y], o->ys[0], group) != 0) return 0;
  return group;
}

static bool is_named_before(const plot_curve_options *o, int y) {
  for (int k = 0; k < y; k++)
    if (strcmp(o->ys[k], o->ys[y]) == 0) return true;
  return false;
}

/* "load, load_bottom", or the group's name. */
static void join_names(const plot_curve_options *o, size_t group, char *text, size_t size) {
  if (group > 0) {
    snprintf(text, size, "%.*s", (int)group - 1, o->ys[0]);
    return;
  }
  size_t used = 0;
  text[0] = 0;
  for (int y = 0; y < o->y_count && used < size; y++)
    if (!is_named_before(o, y))
      used += (size_t)snprintf(text + used, size - used, "%s%s", y ? ", " : "", o->ys[y]);
}

bool plot_curve(const char *const *results, int result_count, const plot_curve_options *given,
                char *error, size_t size) {
  plot_curve_options o = *given;
  o.x = o.x ? o.x : "time";
  o.y = o.y ? o.y : "load";
  if (o.y_count == 0) {
    o.ys = &o.y;
    o.y_count = 1;
  }
  if (result_count > MOST_CURVES / o.y_count) {
    snprintf(error, size,
             "%d results with %d histories are more than the %d curves that one picture shows",
             result_count, o.y_count, MOST_CURVES);
    return false;
  }
  char names[400];
  curve_set s = {.o = &o, .results = results, .result_count = result_count, .group = group_of(&o)};
  join_names(&o, s.group, names, sizeof names);
  bool good = true;
  for (int k = 0; good && k < result_count; k++)
    good = add_curves(&s, k, error, size);
  o.y = names;
  const char *shown = o.title ? o.title : s.title;
  good = good && draw_all(s.curves, s.count, &o, s.x_unit, s.y_unit, shown, error, size);
  for (int k = 0; k < s.count; k++) {
    free(s.curves[k].x);
    free(s.curves[k].y);
  }
  return good;
}

bool plot_histories_read(plot_histories *h, const char *path, const char *x, const char *y,
                         char *error, size_t size) {
  result_file *f = result_read(path, error, size);
  curve c = {.x = NULL};
  *h = (plot_histories){.x_unit = "1", .y_unit = "1"};
  const bool good = f && read_curve(f, x, y, &c, h->x_unit, h->y_unit, error, size);
  if (f) result_read_close(f);
  h->x = c.x;
  h->y = c.y;
  h->count = c.count;
  return good;
}

bool plot_series_draw(const plot_series *series, int count, const char *x_unit, const char *y_unit,
                      const plot_curve_options *o, char *error, size_t size) {
  curve *curves = must_calloc((size_t)count + 1, sizeof *curves);
  for (int k = 0; k < count; k++) {
    const size_t bytes = (size_t)series[k].count * sizeof(double);
    curve *c = &curves[k];
    *c = (curve){.x = must_alloc(bytes + 1), .y = must_alloc(bytes + 1), .count = series[k].count};
    memcpy(c->x, series[k].x, bytes);
    memcpy(c->y, series[k].y, bytes);
    snprintf(c->label, sizeof c->label, "%s", series[k].label ? series[k].label : "");
  }
  const char *title = o->title ? o->title : "";
  const bool good = draw_all(curves, count, o, x_unit, y_unit, title, error, size);
  for (int k = 0; k < count; k++) {
    free(curves[k].x);
    free(curves[k].y);
  }
  free(curves);
  return good;
}

bool plot_values(const double *x, const double *y, long count, const char *x_unit,
                 const char *y_unit, const plot_curve_options *o, char *error, size_t size) {
  const plot_series one = {x, y, count, NULL};
  return plot_series_draw(&one, 1, x_unit, y_unit, o, error, size);
}
