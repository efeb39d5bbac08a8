#include "runtime/plot/plot_beside.h"

#include <math.h>

#include "dsl/base/elementary.h"

/* Tables are told from each other by the shape of their points, too. */
enum { CIRCLE, SQUARE, DIAMOND, TRIANGLE, MARKS };
#define MARK_SIZE   4.5 /* half of its width */
#define MARKS_APART 17.0

static const colour inks[] = {
    {0.10, 0.10, 0.10}, {0.62, 0.10, 0.32}, {0.10, 0.42, 0.42}, {0.45, 0.30, 0.15}};
enum { INKS = sizeof inks / sizeof *inks };

static colour ink_of(int number) {
  return inks[number % INKS];
}

/* --- range ------------------------------------------------------------------------------------ */

static void widen(const double *values, long count, double *low, double *high) {
  for (long k = 0; values && k < count; k++)
    if (isfinite(values[k])) {
      *low = pl_fmin(*low, values[k]);
      *high = pl_fmax(*high, values[k]);
    }
}

void beside_range(const plot_beside *b, bool of_x, double *low, double *high) {
  const double *of_y[] = {b->y, b->low, b->high};
  if (of_x) widen(b->x, b->count, low, high);
  for (int k = 0; !of_x && k < 3; k++)
    widen(of_y[k], b->count, low, high);
}

/* --- bands ------------------------------------------------------------------------------------ */

static bool in_band(const plot_beside *b, long k) {
  return isfinite(b->low[k]) && isfinite(b->high[k]) && (!b->x || isfinite(b->x[k]));
}

/* Rows from `from` on that follow each other without a gap. */
static long band_end(const plot_beside *b, long from) {
  long to = from;
  while (to < b->count && in_band(b, to))
    to++;
  return to;
}

static void trace_band(canvas *c, const plot_beside *b, long from, long to, const axis *x,
                       const axis *y) {
  cairo_new_sub_path(c->cr); /* else a line leads here from where the part before began */
  for (long k = from; k < to; k++)
    cairo_line_to(c->cr, axis_along_x(x, b->x[k]), axis_along_y(y, b->low[k]));
  for (long k = to; k-- > from;)
    cairo_line_to(c->cr, axis_along_x(x, b->x[k]), axis_along_y(y, b->high[k]));
  cairo_close_path(c->cr);
}

static void shade_path(canvas *c, colour ink) {
  cairo_set_source_rgba(c->cr, ink.r, ink.g, ink.b, 0.16);
  cairo_fill_preserve(c->cr);
  cairo_set_source_rgba(c->cr, ink.r, ink.g, ink.b, 0.45);
  cairo_set_line_width(c->cr, 1);
  cairo_stroke(c->cr);
}

void beside_draw_band(canvas *c, const plot_beside *b, int number, const axis *x, const axis *y) {
  if (!b->low) return;
  cairo_new_path(c->cr);
  if (!b->x) {
    const double top = axis_along_y(y, b->high[0]), bottom = axis_along_y(y, b->low[0]);
    cairo_rectangle(c->cr, DIAGRAM_LEFT, top, DIAGRAM_RIGHT - DIAGRAM_LEFT, bottom - top);
  }
  for (long from = 0, to; b->x && from < b->count; from = to + 1) {
    to = band_end(b, from);
    if (to > from) trace_band(c, b, from, to, x, y);
  }
  shade_path(c, ink_of(number));
}

/* --- points and lines ------------------------------------------------------------------------- */

static void draw_mark(canvas *c, int number, double x, double y) {
  const double r = MARK_SIZE;
  cairo_new_path(c->cr);
  switch (number % MARKS) {
  case CIRCLE:
    cairo_arc(c->cr, x, y, r, 0, 2 * M_PI);
    break;
  case SQUARE:
    cairo_rectangle(c->cr, x - r, y - r, 2 * r, 2 * r);
    break;
  case DIAMOND:
    for (int k = 0; k < 4; k++)
      cairo_line_to(c->cr,
                    x + (k == 0   ? r
                         : k == 2 ? -r
                                  : 0) *
                            1.25,
                    y + (k == 1   ? r
                         : k == 3 ? -r
                                  : 0) *
                            1.25);
    cairo_close_path(c->cr);
    break;
  default:
    cairo_move_to(c->cr, x, y - 1.3 * r);
    cairo_line_to(c->cr, x + 1.2 * r, y + r);
    cairo_line_to(c->cr, x - 1.2 * r, y + r);
    cairo_close_path(c->cr);
  }
  cairo_set_source_rgb(c->cr, 1, 1, 1);
  cairo_fill_preserve(c->cr);
  canvas_colour(c, ink_of(number));
  cairo_set_line_width(c->cr, 1.7);
  cairo_stroke(c->cr);
}

static bool is_point(const plot_beside *b, long k) {
  return isfinite(b->x[k]) && isfinite(b->y[k]);
}

/* A thin line through all points. */
static void join_points(canvas *c, const plot_beside *b, int number, const axis *x, const axis *y) {
  bool pen_down = false;
  cairo_new_path(c->cr);
  for (long k = 0; k < b->count; k++) {
    const bool here = is_point(b, k);
    if (here && pen_down)
      cairo_line_to(c->cr, axis_along_x(x, b->x[k]), axis_along_y(y, b->y[k]));
    else if (here)
      cairo_move_to(c->cr, axis_along_x(x, b->x[k]), axis_along_y(y, b->y[k]));
    pen_down = here;
  }
  const colour ink = ink_of(number);
  cairo_set_source_rgba(c->cr, ink.r, ink.g, ink.b, 0.7);
  cairo_set_line_width(c->cr, 1.1);
  cairo_stroke(c->cr);
}

/* Marks do not touch: of crowded points some have none. */
static void mark_points(canvas *c, const plot_beside *b, int number, const axis *x, const axis *y) {
  double last_x = -INFINITY, last_y = -INFINITY;
  for (long k = 0; k < b->count; k++) {
    if (!is_point(b, k)) continue;
    const double px = axis_along_x(x, b->x[k]), py = axis_along_y(y, b->y[k]);
    if (pl_hypot(px - last_x, py - last_y) < MARKS_APART) continue;
    draw_mark(c, number, last_x = px, last_y = py);
  }
}

static void draw_level(canvas *c, double left, double right, double at, int number) {
  canvas_colour(c, ink_of(number));
  cairo_set_dash(c->cr, (const double[]){9, 5}, 2, 0);
  canvas_line(c, left, at, right, at, 1.8);
  cairo_set_dash(c->cr, NULL, 0, 0);
}

void beside_draw_points(canvas *c, const plot_beside *b, int number, const axis *x, const axis *y) {
  if (!b->y) return;
  if (!b->x) {
    draw_level(c, DIAGRAM_LEFT, DIAGRAM_RIGHT, axis_along_y(y, b->y[0]), number);
    return;
  }
  join_points(c, b, number, x, y);
  mark_points(c, b, number, x, y);
}

void beside_draw_sample(canvas *c, const plot_beside *b, int number, double left, double middle) {
  enum { LENGTH = 36, HALF = 8 };
  cairo_new_path(c->cr);
  if (b->low) {
    cairo_rectangle(c->cr, left, middle - HALF, LENGTH, 2 * HALF);
    shade_path(c, ink_of(number));
  }
  if (b->y && !b->x) draw_level(c, left, left + LENGTH, middle, number);
  if (!b->y || !b->x) return;
  canvas_colour(c, ink_of(number));
  canvas_line(c, left, middle, left + LENGTH, middle, 1.1);
  draw_mark(c, number, left + LENGTH / 2.0, middle);
}
