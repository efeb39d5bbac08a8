#include "generator/page/diagram.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/elementary.h"
#include "dsl/base/units.h"
#include "generator/page/html.h"
#include "runtime/plot/plot_axes.h"

typedef struct drawing {
  const diagram *d;
  FILE *out;
  axis x, y;
  double more; /* room to the left, for long numbers */
} drawing;

enum {
  LETTER = 30,
  LETTER_WIDTH = 18,
  NUMBER_GAP = 14
}; /* of the numbers, where they are largest (page.css) */

static void widen(const double *values, long count, double *low, double *high) {
  for (long k = 0; k < count; k++)
    if (isfinite(values[k])) {
      *low = pl_fmin(*low, values[k]);
      *high = pl_fmax(*high, values[k]);
    }
}

/* Only whole values without a unit: nothing stands between two counts. */
static bool counts(const diagram *d, bool along_x) {
  for (int k = 0; k < d->count; k++) {
    const double *values = along_x ? d->curves[k].x : d->curves[k].y;
    for (long n = 0; n < d->curves[k].count; n++)
      if (isfinite(values[n]) && values[n] != floor(values[n])) return false;
  }
  return unit_is_pure(along_x ? d->x_unit : d->y_unit);
}

static void take_whole_steps(axis *a) {
  if (a->factor != 1 || a->step >= 1) return;
  a->step = 1;
  a->low = floor(a->low);
  a->high = ceil(a->high);
}

static int print_number(char *text, size_t size, const axis *a, long k) {
  const double shown = a->low + (double)k * a->step;
  return snprintf(text, size, "%.6g", fabs(shown) < 1e-9 * a->step ? 0 : shown);
}

static long step_count(const axis *a) {
  return lround((a->high - a->low) / a->step);
}

/* The axis' name stands to the left of its longest number. */
static void make_room(drawing *w) {
  char text[40];
  int most = 0;
  for (long k = 0; k <= step_count(&w->y); k++) {
    const int length = print_number(text, sizeof text, &w->y, k);
    if (length > most) most = length;
  }
  w->more = pl_fmax(0, NUMBER_GAP + most * LETTER_WIDTH + 1.4 * LETTER - DIAGRAM_LEFT);
}

static bool choose_axes(drawing *w) {
  const diagram *d = w->d;
  double low[2] = {INFINITY, d->stacked ? 0 : INFINITY},
         high[2] = {-INFINITY, d->stacked ? 0 : -INFINITY};
  char none[256];
  for (int k = 0; k < d->count; k++) {
    widen(d->curves[k].x, d->curves[k].count, &low[0], &high[0]);
    widen(d->curves[k].y, d->curves[k].count, &low[1], &high[1]);
  }
  if (!axis_set(&w->x, d->x_name, d->x_unit, NULL, low[0], high[0], none, sizeof none) ||
      !axis_set(&w->y, d->y_name, d->y_unit, NULL, low[1], high[1], none, sizeof none))
    return false;
  if (counts(d, true)) take_whole_steps(&w->x);
  if (counts(d, false)) take_whole_steps(&w->y);
  make_room(w);
  return true;
}

/* --- axes ------------------------------------------------------------------------------------- */

static void put_number(const drawing *w, const axis *a, long k, double x, double y,
                       const char *side) {
  char text[40];
  print_number(text, sizeof text, a, k);
  fprintf(w->out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s</text>\n", x, y, side, text);
}

static void put_grid(const drawing *w) {
  const axis *x = &w->x, *y = &w->y;
  const long nx = step_count(x), ny = step_count(y);
  fputs("<path class=\"grid\" d=\"", w->out);
  for (long k = 0; k <= nx; k++)
    fprintf(w->out, "M%.1f %dV%d", axis_along_x(x, (x->low + (double)k * x->step) / x->factor),
            DIAGRAM_TOP, DIAGRAM_BOTTOM);
  for (long k = 0; k <= ny; k++)
    fprintf(w->out, "M%d %.1fH%d", DIAGRAM_LEFT,
            axis_along_y(y, (y->low + (double)k * y->step) / y->factor), DIAGRAM_RIGHT);
  fputs("\"/>\n<path class=\"axis\" d=\"", w->out);
  if (y->low < 0 && y->high > 0)
    fprintf(w->out, "M%d %.1fH%d", DIAGRAM_LEFT, axis_along_y(y, 0), DIAGRAM_RIGHT);
  fprintf(w->out, "M%d %dV%dH%d\"/>\n", DIAGRAM_LEFT, DIAGRAM_TOP, DIAGRAM_BOTTOM, DIAGRAM_RIGHT);
  for (long k = 0; k <= nx; k++) {
    const double shown = x->low + (double)k * x->step;
    if (nx <= 8 || k % 2 == 0)
      put_number(w, x, k, axis_along_x(x, shown / x->factor), DIAGRAM_BOTTOM + 34, "middle");
  }
  for (long k = 0; k <= ny; k++) {
    const double shown = y->low + (double)k * y->step;
    if (ny <= 8 || k % 2 == 0)
      put_number(w, y, k, DIAGRAM_LEFT - NUMBER_GAP, axis_along_y(y, shown / y->factor) + 9, "end");
  }
}

static void put_name(const drawing *w, const axis *a) {
  html_text(w->out, a->name);
  if (unit_is_pure(a->unit_text)) return;
  fputs(" [", w->out);
  html_unit(w->out, a->unit_text);
  fputc(']', w->out);
}

static void put_names(const drawing *w) {
  const double middle = (DIAGRAM_TOP + DIAGRAM_BOTTOM) / 2.0;
  fprintf(w->out, "<text class=\"name\" x=\"%d\" y=\"%d\" text-anchor=\"end\">", DIAGRAM_RIGHT,
          DIAGRAM_HEIGHT - 22);
  put_name(w, &w->x);
  fprintf(w->out,
          "</text>\n<text class=\"name\" x=\"%.0f\" y=\"%.0f\" text-anchor=\"middle\" "
          "transform=\"rotate(-90 %.0f %.0f)\">",
          LETTER - w->more, middle, LETTER - w->more, middle);
  put_name(w, &w->y);
  fputs("</text>\n", w->out);
}

/* --- curves ----------------------------------------------------------------------------------- */

/* Samples one after the other that stand in the same column of the picture, a unit wide: of many
   the first, the least, the largest and the last are seen. */
typedef struct column {
  long first, least, most, last; /* first negative: empty */
  double number;
} column;

typedef struct line {
  const drawing *w;
  const double *x, *y; /* SI */
  bool pen;            /* the curve goes on from a point */
  column here;
} line;

static void put_point(line *l, long k) {
  fprintf(l->w->out, "%c%.1f %.1f", l->pen ? 'L' : 'M', axis_along_x(&l->w->x, l->x[k]),
          axis_along_y(&l->w->y, l->y[k]));
  l->pen = true;
}

/* In the order in which they were taken, which may run backwards. */
static void flush(line *l) {
  const column c = l->here;
  if (c.first < 0) return;
  const bool ahead = labs(c.least - c.first) < labs(c.most - c.first);
  const long order[] = {c.first, ahead ? c.least : c.most, ahead ? c.most : c.least, c.last};
  for (int n = 0; n < 4; n++)
    if (n == 0 || order[n] != order[n - 1]) put_point(l, order[n]);
  l->here.first = -1;
}

static void take(line *l, long k) {
  const double number = floor(axis_along_x(&l->w->x, l->x[k]));
  if (l->here.first >= 0 && number != l->here.number) flush(l);
  column *c = &l->here;
  if (c->first < 0) *c = (column){k, k, k, k, number};
  if (l->y[k] < l->y[c->least]) c->least = k;
  if (l->y[k] > l->y[c->most]) c->most = k;
  c->last = k;
}

/* What is no number is left out, and a curve begins anew behind it, unless it is `joined`, as the
   edge of an area is. */
static void put_points(const drawing *w, const double *x, const double *y, long count,
                       bool backwards, bool joined) {
  line l = {.w = w, .x = x, .y = y, .pen = joined && backwards, .here = {.first = -1}};
  for (long n = 0; n < count; n++) {
    const long k = backwards ? count - 1 - n : n;
    if (isfinite(x[k]) && isfinite(y[k])) {
      take(&l, k);
      continue;
    }
    flush(&l);
    l.pen = l.pen && joined;
  }
  flush(&l);
}

static void put_curve(const drawing *w, const diagram_curve *c) {
  fprintf(w->out, "<path class=\"curve ink%d dash%d\" d=\"", c->ink % 8, c->ink / 8 % 4);
  put_points(w, c->x, c->y, c->count, false, false);
  fputs("\"/>\n", w->out);
}

/* Between the curve and the one below it, or zero. */
static void put_area(const drawing *w, const diagram_curve *c, const diagram_curve *below) {
  fprintf(w->out, "<path class=\"area ink%d\" d=\"", c->ink % 8);
  put_points(w, c->x, c->y, c->count, false, true);
  if (below)
    put_points(w, below->x, below->y, below->count, true, true);
  else if (c->count > 0)
    fprintf(w->out, "L%.1f %.1fL%.1f %.1f", axis_along_x(&w->x, c->x[c->count - 1]),
            axis_along_y(&w->y, 0), axis_along_x(&w->x, c->x[0]), axis_along_y(&w->y, 0));
  fputs("Z\"/>\n", w->out);
}

/* Of each curve with data its ink, its result and the name of its series; what they are drawn
   over. */
static void put_series(const drawing *w) {
  if (!w->d->over) return;
  fputs(" data-over=\"", w->out);
  html_text(w->out, w->d->over);
  fputs("\" data-series=\"", w->out);
  for (int k = 0; k < w->d->count; k++) {
    const diagram_curve *c = &w->d->curves[k];
    if (!c->series) continue;
    fprintf(w->out, "%d:%s:", c->ink % 8, c->of);
    html_text(w->out, c->series);
    fputc(';', w->out);
  }
  fputc('"', w->out);
}

/* Where shown values stand: the script moves its dot and reads the pointer by them. */
static void put_head(const drawing *w) {
  const axis *x = &w->x, *y = &w->y;
  fprintf(w->out,
          "<svg class=\"diagram%s\" viewBox=\"%.0f %d %.0f %d\" role=\"img\" "
          "data-x=\"%.17g %.17g %.17g\" data-y=\"%.17g %.17g %.17g\" data-x-unit=\"",
          w->d->large ? " large" : "", -w->more, DIAGRAM_TOP - 20, DIAGRAM_WIDTH + w->more,
          DIAGRAM_HEIGHT - DIAGRAM_TOP + 20, x->low, x->high, x->factor, y->low, y->high,
          y->factor);
  html_text(w->out, x->unit_text);
  fputs("\" data-y-unit=\"", w->out);
  html_text(w->out, y->unit_text);
  fputc('"', w->out);
  put_series(w);
  fputs(" aria-label=\"", w->out);
  html_text(w->out, w->d->title);
  fputs("\">\n", w->out);
}

bool diagram_svg(FILE *out, const diagram *d) {
  drawing w = {.d = d, .out = out};
  if (!choose_axes(&w)) return false;
  put_head(&w);
  put_grid(&w);
  put_names(&w);
  for (int k = 0; k < d->count; k++)
    if (d->stacked)
      put_area(&w, &d->curves[k], k ? &d->curves[k - 1] : NULL);
    else
      put_curve(&w, &d->curves[k]);
  fputs("</svg>\n", out);
  return true;
}

void diagram_legend(FILE *out, const diagram *d) {
  fputs("<ul class=\"legend\">", out);
  for (int k = 0; k < d->count; k++) {
    const diagram_curve *c = &d->curves[d->stacked ? d->count - 1 - k : k];
    if (!c->label) continue;
    fprintf(out, "<li><span class=\"ink%d dash%d\"></span>", c->ink % 8, c->ink / 8 % 4);
    html_text(out, c->label);
    fputs("</li>", out);
  }
  fputs("</ul>\n", out);
}
