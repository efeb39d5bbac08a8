/* Curves of histories: several results in one picture. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"
#include "dsl/characters.h"
#include "dsl/elementary.h"
#include "dsl/powers.h"
#include "dsl/units.h"
#include "runtime/canvas.h"
#include "runtime/plot.h"
#include "runtime/result.h"

enum {
  WIDTH = 1200,
  HEIGHT = 800,
  LEFT = 120,
  RIGHT = 40,
  TOP = 70,
  BOTTOM = 95,
  MOST_CURVES = 64
};

typedef struct curve {
  double *x, *y;
  long count;
  char label[256];
} curve;

typedef struct axis {
  const char *name;
  char unit_text[64];
  double low, high, step, factor; /* shown values; shown = SI * factor */
} axis;

static const colour palette[] = {{0.00, 0.27, 0.55}, {0.80, 0.25, 0.05}, {0.10, 0.50, 0.20},
                                 {0.55, 0.20, 0.60}, {0.85, 0.55, 0.00}, {0.05, 0.55, 0.60},
                                 {0.45, 0.30, 0.15}, {0.40, 0.40, 0.40}};
enum { PALETTE = sizeof palette / sizeof *palette };

static void label_of(const char *path, char *label, size_t size) {
  const char *slash = strrchr(path, '/');
  const char *name = slash ? slash + 1 : path;
  const char *dot = strrchr(name, '.');
  snprintf(label, size, "%.*s", (int)(dot ? dot - name : (long)strlen(name)), name);
}

static bool read_curve(result_file *f, const char *x, const char *y, curve *c, char *x_unit,
                       char *y_unit, char *error, size_t size) {
  long count_y = 0;
  c->x = result_read_series(f, x, &c->count, x_unit, 64, error, size);
  c->y = c->x ? result_read_series(f, y, &count_y, y_unit, 64, error, size) : NULL;
  if (c->x && c->y && count_y < c->count) c->count = count_y;
  if (strcmp(x, "time") == 0 && result_is_quasi_static(f)) snprintf(x_unit, 64, "1");
  return c->x && c->y;
}

/* Shown unit and the factor from SI; the user's unit must fit the history's. */
static bool choose_unit(axis *a, const char *si_unit, const char *wanted, double largest,
                        char *error, size_t size) {
  if (!wanted) {
    snprintf(a->unit_text, sizeof a->unit_text, "%s", readable_unit(si_unit, largest, &a->factor));
    return true;
  }
  unit shown, si;
  const char *bad;
  size_t bad_length;
  if (!unit_parse(wanted, strlen(wanted), &shown, &bad, &bad_length) ||
      !unit_parse(si_unit, strlen(si_unit), &si, &bad, &bad_length) ||
      !dim_equal(shown.dim, si.dim)) {
    snprintf(error, size, "`%s` is in %s; it cannot be shown in `%s`", a->name, name_shown(si_unit),
             wanted);
    return false;
  }
  snprintf(a->unit_text, sizeof a->unit_text, "%s", wanted);
  a->factor = si.factor / shown.factor;
  return true;
}

/* A power of ten in front of the unit where numbers would have many digits. */
static void shorten_numbers(axis *a, double largest) {
  double shown = largest * a->factor;
  if (!(shown > 0) || (shown < 1e5 && shown >= 1e-2)) return;
  int power = 3 * (int)floor(decade_of(shown) / 3.0);
  char symbol[sizeof a->unit_text];
  memcpy(symbol, a->unit_text, sizeof symbol);
  bool pure = strcmp(symbol, "1") == 0;
  snprintf(a->unit_text, sizeof a->unit_text, "1e%d%s%.50s", power, pure ? "" : " ",
           pure ? "" : symbol);
  a->factor /= power_of(10, power);
}

static void range_of(const curve *curves, int count, bool of_x, double *low, double *high) {
  *low = INFINITY;
  *high = -INFINITY;
  for (int c = 0; c < count; c++)
    for (long k = 0; k < curves[c].count; k++) {
      double v = of_x ? curves[c].x[k] : curves[c].y[k];
      if (isfinite(v)) {
        *low = pl_fmin(*low, v);
        *high = pl_fmax(*high, v);
      }
    }
}

/* An end beyond zero by what cannot be seen (2 pixels) is zero: an axis does not get a step for it. */
static double without_noise(double end, double range) {
  return fabs(end) < 2e-3 * range ? 0 : end;
}

static bool set_axis(axis *a, const char *name, const char *si_unit, const char *wanted, double low,
                     double high, char *error, size_t size) {
  a->name = name;
  if (!(low <= high)) {
    snprintf(error, size, "`%s` holds no finite value to draw", name);
    return false;
  }
  if (!choose_unit(a, si_unit, wanted, pl_fmax(fabs(low), fabs(high)), error, size)) return false;
  if (!wanted) shorten_numbers(a, pl_fmax(fabs(low), fabs(high)));
  const double range = high - low;
  low = without_noise(low, range) * a->factor;
  high = without_noise(high, range) * a->factor;
  if (low > 0 && low < 0.3 * high) low = 0;
  if (!(high - low > 1e-12 * pl_fmax(fabs(high), 1e-300))) {
    high = low + (fabs(low) > 0 ? fabs(low) : 1);
  }
  a->step = nice_step(high - low, 5);
  a->low = a->step * floor(low / a->step + 1e-3); /* a thousandth of a step is not seen */
  a->high = a->step * ceil(high / a->step - 1e-3);
  return true;
}

static double along_x(const axis *a, double shown) {
  return LEFT + (shown - a->low) / (a->high - a->low) * (WIDTH - LEFT - RIGHT);
}
static double along_y(const axis *a, double shown) {
  return HEIGHT - BOTTOM - (shown - a->low) / (a->high - a->low) * (HEIGHT - TOP - BOTTOM);
}

static void draw_axes(canvas *c, const axis *x, const axis *y) {
  const colour grid = {0.88, 0.88, 0.88}, ink = {0.1, 0.1, 0.1};
  char text[64];
  long nx = lround((x->high - x->low) / x->step), ny = lround((y->high - y->low) / y->step);
  for (long k = 0; k <= nx; k++) {
    double v = x->low + (double)k * x->step, at = along_x(x, v);
    canvas_colour(c, grid);
    canvas_line(c, at, TOP, at, HEIGHT - BOTTOM, 1);
    canvas_colour(c, ink);
    snprintf(text, sizeof text, "%.6g", fabs(v) < 1e-9 * x->step ? 0 : v);
    canvas_text(c, at, HEIGHT - BOTTOM + 26, 19, ANCHOR_CENTRE, text);
  }
  for (long k = 0; k <= ny; k++) {
    double v = y->low + (double)k * y->step, at = along_y(y, v);
    canvas_colour(c, grid);
    canvas_line(c, LEFT, at, WIDTH - RIGHT, at, 1);
    canvas_colour(c, ink);
    snprintf(text, sizeof text, "%.6g", fabs(v) < 1e-9 * y->step ? 0 : v);
    canvas_text(c, LEFT - 12, at + 7, 19, ANCHOR_RIGHT, text);
  }
  canvas_colour(c, (colour){0.6, 0.6, 0.6}); /* where something is zero, inside of the frame */
  if (x->low < 0 && x->high > 0)
    canvas_line(c, along_x(x, 0), TOP, along_x(x, 0), HEIGHT - BOTTOM, 1);
  if (y->low < 0 && y->high > 0)
    canvas_line(c, LEFT, along_y(y, 0), WIDTH - RIGHT, along_y(y, 0), 1);
  canvas_colour(c, ink);
  canvas_line(c, LEFT, HEIGHT - BOTTOM, WIDTH - RIGHT, HEIGHT - BOTTOM, 1.5);
  canvas_line(c, LEFT, TOP, LEFT, HEIGHT - BOTTOM, 1.5);
}

static bool is_pure(const char *unit_text) {
  return strcmp(unit_text, "1") == 0;
}

static void name_axis(const axis *a, char *text, size_t size) {
  const bool pure = is_pure(a->unit_text);
  snprintf(text, size, "%.400s%s%s%s", a->name, pure ? "" : " [", pure ? "" : a->unit_text,
           pure ? "" : "]");
}

static void draw_names(canvas *c, const axis *x, const axis *y, const char *title) {
  char text[512];
  name_axis(x, text, sizeof text);
  canvas_text(c, LEFT + (WIDTH - LEFT - RIGHT) / 2.0, HEIGHT - 26, 22, ANCHOR_CENTRE, text);
  name_axis(y, text, sizeof text);
  canvas_text_upward(c, 36, TOP + (HEIGHT - TOP - BOTTOM) / 2.0, 22, HEIGHT - TOP - BOTTOM, text);
  canvas_text_within(c, LEFT, 42, 24, WIDTH - LEFT - RIGHT, title);
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
    double px = along_x(x, k->x[q] * x->factor), py = along_y(y, k->y[q] * y->factor);
    if (pen_down)
      cairo_line_to(c->cr, px, py);
    else
      cairo_move_to(c->cr, px, py);
    pen_down = true;
  }
  cairo_stroke(c->cr);
}

/* Samples of all curves in a rectangle of the picture. */
static long samples_in(const curve *curves, int count, const axis *x, const axis *y, double left,
                       double top, double width, double height) {
  long inside = 0;
  for (int c = 0; c < count; c++)
    for (long k = 0; k < curves[c].count; k++) {
      double px = along_x(x, curves[c].x[k] * x->factor),
             py = along_y(y, curves[c].y[k] * y->factor);
      inside += px > left && px < left + width && py > top && py < top + height;
    }
  return inside;
}

/* In the corner where it covers least; the upper right one when it can be had. */
static void draw_legend(canvas *c, const curve *curves, int count, const axis *x, const axis *y) {
  enum { LINE = 26 };
  double widest = 0;
  for (int k = 0; k < count; k++)
    widest = pl_fmax(widest, canvas_text_width(c, 19, curves[k].label));
  const double width = pl_fmin(widest, 500) + 70, height = LINE * count + 10;
  const double lefts[] = {WIDTH - RIGHT - width - 10, LEFT + 14},
               tops[] = {TOP + 8, HEIGHT - BOTTOM - height - 10};
  double left = lefts[0], top = tops[0];
  long least = samples_in(curves, count, x, y, left, top, width, height);
  for (int corner = 1; corner < 4; corner++) {
    long inside =
        samples_in(curves, count, x, y, lefts[corner % 2], tops[corner / 2], width, height);
    if (inside >= least) continue;
    least = inside;
    left = lefts[corner % 2];
    top = tops[corner / 2];
  }
  cairo_set_source_rgba(c->cr, 1, 1, 1, 0.85);
  cairo_rectangle(c->cr, left, top, width, height);
  cairo_fill(c->cr);
  for (int k = 0; k < count; k++) {
    double line = top + LINE * k + 20;
    canvas_colour(c, palette[k % PALETTE]);
    canvas_line(c, left + 10, line - 6, left + 46, line - 6, 3);
    canvas_colour(c, (colour){0.1, 0.1, 0.1});
    canvas_text_within(c, left + 56, line, 19, 500, curves[k].label);
  }
}

static bool draw_all(const curve *curves, int count, const plot_curve_options *o,
                     const char *x_unit, const char *y_unit, const char *title, char *error,
                     size_t size) {
  axis x = {.name = NULL}, y = {.name = NULL};
  double low, high;
  range_of(curves, count, true, &low, &high);
  if (!set_axis(&x, o->x, x_unit, o->x_unit, low, high, error, size)) return false;
  range_of(curves, count, false, &low, &high);
  if (!set_axis(&y, o->y, y_unit, o->y_unit, low, high, error, size)) return false;
  canvas c;
  if (!canvas_open(&c, o->output, WIDTH, HEIGHT, error, size)) return false;
  draw_axes(&c, &x, &y);
  draw_names(&c, &x, &y, title);
  cairo_save(c.cr);
  cairo_rectangle(c.cr, LEFT - 1, TOP - 1, WIDTH - LEFT - RIGHT + 2, HEIGHT - TOP - BOTTOM + 2);
  cairo_clip(c.cr); /* the frame, and half a line more */
  for (int k = 0; k < count; k++)
    draw_curve(&c, &curves[k], &x, &y, palette[k % PALETTE]);
  cairo_restore(c.cr);
  if (count > 1 || o->labels) draw_legend(&c, curves, count, &x, &y);
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

/* Keeps what both titles begin with, up to a comma or colon: "Prism" of "Prism, 0 degrees" and "Prism, 15 degrees". */
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
             y, s->results[from], is_pure(y_unit) ? "" : "in ",
             is_pure(y_unit) ? "a pure number" : name_shown(y_unit), s->o->ys[0], s->results[0],
             is_pure(s->y_unit) ? "" : "in ",
             is_pure(s->y_unit) ? "a pure number" : name_shown(s->y_unit));
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

bool plot_values(const double *x, const double *y, long count, const char *x_unit,
                 const char *y_unit, const plot_curve_options *o, char *error, size_t size) {
  size_t bytes = (size_t)count * sizeof(double);
  curve c = {.x = must_alloc(bytes + 1), .y = must_alloc(bytes + 1), .count = count};
  memcpy(c.x, x, bytes);
  memcpy(c.y, y, bytes);
  bool good = draw_all(&c, 1, o, x_unit, y_unit, o->title ? o->title : "", error, size);
  free(c.x);
  free(c.y);
  return good;
}
