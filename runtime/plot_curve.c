/* Curves of histories: several results in one picture. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"
#include "dsl/units.h"
#include "runtime/canvas.h"
#include "runtime/plot.h"
#include "runtime/result.h"

enum { WIDTH = 1200, HEIGHT = 800, LEFT = 120, RIGHT = 40, TOP = 70, BOTTOM = 95, MOST_CURVES = 64 };

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

static const colour palette[] = {{0.00, 0.27, 0.55}, {0.80, 0.25, 0.05}, {0.10, 0.50, 0.20}, {0.55, 0.20, 0.60},
                                 {0.85, 0.55, 0.00}, {0.05, 0.55, 0.60}, {0.45, 0.30, 0.15}, {0.40, 0.40, 0.40}};
enum { PALETTE = sizeof palette / sizeof *palette };

static void label_of(const char *path, char *label, size_t size) {
  const char *slash = strrchr(path, '/');
  const char *name = slash ? slash + 1 : path;
  const char *dot = strrchr(name, '.');
  snprintf(label, size, "%.*s", (int)(dot ? dot - name : (long)strlen(name)), name);
}

static bool read_curve(const char *path, const plot_curve_options *o, curve *c, char *x_unit, char *y_unit, char *title,
                       size_t title_size, char *error, size_t size) {
  result_file *f = result_read(path, error, size);
  if (!f)
    return false;
  long count_y = 0;
  c->x = result_read_series(f, o->x, &c->count, x_unit, 64, error, size);
  c->y = c->x ? result_read_series(f, o->y, &count_y, y_unit, 64, error, size) : NULL;
  char *t = result_read_title(f);
  snprintf(title, title_size, "%s", t);
  free(t);
  result_read_close(f);
  if (c->x && c->y && count_y < c->count)
    c->count = count_y;
  return c->x && c->y;
}

/* Shown unit and the factor from SI; the user's unit must fit the history's. */
static bool choose_unit(axis *a, const char *si_unit, const char *wanted, double largest, char *error, size_t size) {
  if (!wanted) {
    snprintf(a->unit_text, sizeof a->unit_text, "%s", readable_unit(si_unit, largest, &a->factor));
    return true;
  }
  unit shown, si;
  const char *bad;
  size_t bad_length;
  if (!unit_parse(wanted, strlen(wanted), &shown, &bad, &bad_length) ||
      !unit_parse(si_unit, strlen(si_unit), &si, &bad, &bad_length) || !dim_equal(shown.dim, si.dim)) {
    snprintf(error, size, "`%s` is in %s; it cannot be shown in `%s`", a->name, si_unit, wanted);
    return false;
  }
  snprintf(a->unit_text, sizeof a->unit_text, "%s", wanted);
  a->factor = si.factor / shown.factor;
  return true;
}

static void range_of(const curve *curves, int count, bool of_x, double *low, double *high) {
  *low = INFINITY;
  *high = -INFINITY;
  for (int c = 0; c < count; c++)
    for (long k = 0; k < curves[c].count; k++) {
      double v = of_x ? curves[c].x[k] : curves[c].y[k];
      if (isfinite(v)) {
        *low = fmin(*low, v);
        *high = fmax(*high, v);
      }
    }
}

static bool set_axis(axis *a, const char *name, const char *si_unit, const char *wanted, double low, double high,
                     char *error, size_t size) {
  a->name = name;
  if (!(low <= high)) {
    snprintf(error, size, "`%s` holds no finite value to draw", name);
    return false;
  }
  if (!choose_unit(a, si_unit, wanted, fmax(fabs(low), fabs(high)), error, size))
    return false;
  low *= a->factor;
  high *= a->factor;
  if (low > 0 && low < 0.3 * high)
    low = 0;
  if (!(high - low > 1e-12 * fmax(fabs(high), 1e-300))) {
    high = low + (fabs(low) > 0 ? fabs(low) : 1);
  }
  a->step = nice_step(high - low, 5);
  a->low = a->step * floor(low / a->step + 1e-9);
  a->high = a->step * ceil(high / a->step - 1e-9);
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
  canvas_line(c, LEFT, HEIGHT - BOTTOM, WIDTH - RIGHT, HEIGHT - BOTTOM, 1.5);
  canvas_line(c, LEFT, TOP, LEFT, HEIGHT - BOTTOM, 1.5);
}

static void draw_names(canvas *c, const axis *x, const axis *y, const char *title) {
  char text[512];
  snprintf(text, sizeof text, "%s [%s]", x->name, x->unit_text);
  canvas_text(c, LEFT + (WIDTH - LEFT - RIGHT) / 2.0, HEIGHT - 26, 22, ANCHOR_CENTRE, text);
  snprintf(text, sizeof text, "%s [%s]", y->name, y->unit_text);
  canvas_text_upward(c, 36, TOP + (HEIGHT - TOP - BOTTOM) / 2.0, 22, text);
  canvas_text(c, LEFT, 42, 24, ANCHOR_LEFT, title);
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

static void draw_legend(canvas *c, const curve *curves, int count) {
  double widest = 0;
  for (int k = 0; k < count; k++)
    widest = fmax(widest, canvas_text_width(c, 19, curves[k].label));
  double left = WIDTH - RIGHT - 20 - widest - 50, top = TOP + 14;
  cairo_set_source_rgba(c->cr, 1, 1, 1, 0.85);
  cairo_rectangle(c->cr, left - 10, top - 6, widest + 70, 26.0 * count + 10);
  cairo_fill(c->cr);
  for (int k = 0; k < count; k++) {
    double y = top + 26.0 * k + 14;
    canvas_colour(c, palette[k % PALETTE]);
    canvas_line(c, left, y - 6, left + 36, y - 6, 3);
    canvas_colour(c, (colour){0.1, 0.1, 0.1});
    canvas_text(c, left + 46, y, 19, ANCHOR_LEFT, curves[k].label);
  }
}

static bool draw_all(const curve *curves, int count, const plot_curve_options *o, const char *x_unit, const char *y_unit,
                     const char *title, char *error, size_t size) {
  axis x = {.name = NULL}, y = {.name = NULL};
  double low, high;
  range_of(curves, count, true, &low, &high);
  if (!set_axis(&x, o->x, x_unit, o->x_unit, low, high, error, size))
    return false;
  range_of(curves, count, false, &low, &high);
  if (!set_axis(&y, o->y, y_unit, o->y_unit, low, high, error, size))
    return false;
  canvas c;
  if (!canvas_open(&c, o->output, WIDTH, HEIGHT, error, size))
    return false;
  draw_axes(&c, &x, &y);
  draw_names(&c, &x, &y, title);
  cairo_save(c.cr);
  cairo_rectangle(c.cr, LEFT, TOP - 4, WIDTH - LEFT - RIGHT + 4, HEIGHT - TOP - BOTTOM + 8);
  cairo_clip(c.cr);
  for (int k = 0; k < count; k++)
    draw_curve(&c, &curves[k], &x, &y, palette[k % PALETTE]);
  cairo_restore(c.cr);
  if (count > 1 || o->labels)
    draw_legend(&c, curves, count);
  return canvas_close(&c, error, size);
}

bool plot_curve(const char *const *results, int result_count, const plot_curve_options *given, char *error, size_t size) {
  if (result_count > MOST_CURVES) {
    snprintf(error, size, "%d results are more than the %d that one picture shows", result_count, MOST_CURVES);
    return false;
  }
  plot_curve_options o = *given;
  o.x = o.x ? o.x : "time";
  o.y = o.y ? o.y : "load";
  curve curves[MOST_CURVES] = {{NULL, NULL, 0, ""}};
  char x_unit[64] = "1", y_unit[64] = "1", first_x[64] = "", first_y[64] = "", title[512] = "";
  bool good = true;
  for (int k = 0; good && k < result_count; k++) {
    good = read_curve(results[k], &o, &curves[k], x_unit, y_unit, title, sizeof title, error, size);
    if (k == 0) {
      memcpy(first_x, x_unit, sizeof first_x);
      memcpy(first_y, y_unit, sizeof first_y);
    } else if (good && (strcmp(first_x, x_unit) || strcmp(first_y, y_unit))) {
      snprintf(error, size, "`%s` holds `%s` and `%s` in other units than `%s`", results[k], o.x, o.y, results[0]);
      good = false;
    }
    if (o.labels)
      snprintf(curves[k].label, sizeof curves[k].label, "%s", o.labels[k]);
    else
      label_of(results[k], curves[k].label, sizeof curves[k].label);
  }
  char several[1100];
  snprintf(several, sizeof several, "%s against %s", o.y, o.x);
  const char *shown = o.title ? o.title : result_count > 1 || !title[0] ? several : title;
  good = good && draw_all(curves, result_count, &o, first_x, first_y, shown, error, size);
  for (int k = 0; k < result_count; k++) {
    free(curves[k].x);
    free(curves[k].y);
  }
  return good;
}
