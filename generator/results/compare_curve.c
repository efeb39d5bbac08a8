#include "generator/results/compare_curve.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "dsl/base/elementary.h"
#include "generator/kernel/document.h"
#include "generator/results/curve_gap.h"
#include "generator/results/measured.h"
#include "runtime/plot/canvas.h"
#include "runtime/plot/plot_curve.h"

enum { NEAR = 0, WRONG = 1, FAR = 2 };

static double largest_of(const double *values, long count) {
  double most = 0;
  for (long k = 0; k < count; k++)
    if (isfinite(values[k])) most = pl_fmax(most, fabs(values[k]));
  return most;
}

static double relative(double gap, double scale) {
  return gap == 0 ? 0 : scale > 0 ? gap / scale : INFINITY;
}

/* How values of x are shown: all in the unit that suits the largest of them. */
typedef struct scale_text {
  double factor;
  char unit_text[32];
} scale_text;

static scale_text scale_of(const measured *m, const plot_histories *h) {
  scale_text s;
  const char *in = readable_unit(h->x_unit, largest_of(m->x, m->count), &s.factor);
  const bool pure = unit_is_pure(in);
  snprintf(s.unit_text, sizeof s.unit_text, "%s%.30s", pure ? "" : " ", pure ? "" : in);
  return s;
}

static void print_span(const scale_text *s, double from, double to) {
  printf(" from %.4g to %.4g%s", from * s->factor + 0.0, to * s->factor + 0.0, s->unit_text);
}

static void print_place(const curve_request *q, const scale_text *s, const curve_gap *g) {
  printf("  %s = %.4g%s: %.6g and %.6g", q->x, g->x * s->factor + 0.0, s->unit_text, g->y + 0.0,
         g->low + 0.0);
  if (q->band) printf(" to %.6g", g->high + 0.0);
  putchar('\n');
}

/* The common range, and the table's where that is more. */
static void print_range(const curve_request *q, const scale_text *s, const measured *m,
                        const curve_gap *g) {
  double low = INFINITY, high = -INFINITY;
  for (long k = 0; k < m->count; k++)
    if (isfinite(m->x[k])) {
      low = pl_fmin(low, m->x[k]);
      high = pl_fmax(high, m->x[k]);
    }
  printf("  compared over %s", q->x);
  print_span(s, g->from, g->to);
  const bool whole = pl_fmin(g->from, g->to) <= low && pl_fmax(g->from, g->to) >= high;
  if (!whole) fputs("; the table goes", stdout);
  if (!whole) print_span(s, low, high);
  puts("\n  relative to the largest value of the table");
}

static void put_gap(json *w, const curve_request *q, const plot_histories *h, const curve_gap *g,
                    double scale) {
  json_object(w);
  json_put_text(w, "of", q->band ? "band" : "curve");
  json_put_text(w, "name", q->y);
  json_put_text(w, "unit", *h->y_unit ? h->y_unit : "1");
  json_put_bool(w, "different", relative(g->largest, scale) > q->tolerance);
  json_put_number(w, "gap", g->largest);
  json_put_number(w, "relative", relative(g->largest, scale));
  json_put_number(w, "relative_rms", relative(g->rms, scale));
  json_put_text(w, "over", q->x);
  json_put_text(w, "over_unit", *h->x_unit ? h->x_unit : "1");
  json_put_number(w, "from", g->from);
  json_put_number(w, "to", g->to);
  json_put_number(w, "x", g->x);
  json_put_array(w, "values"); /* computed; measured, or the band's ends */
  json_number(w, g->y);
  json_number(w, g->low);
  if (q->band) json_number(w, g->high);
  json_array_end(w);
  json_object_end(w);
}

static int report(const curve_request *q, const plot_histories *h, const measured *m,
                  const curve_gap *g, json *list) {
  const double scale = m->low ? pl_fmax(largest_of(m->low, m->count), largest_of(m->high, m->count))
                              : largest_of(m->y, m->count);
  const double most = relative(g->largest, scale);
  const bool over = most > q->tolerance;
  char title[128];
  if (list) put_gap(list, q, h, g, scale);
  snprintf(title, sizeof title, "%.60s [%.30s]%s", q->y, h->y_unit,
           q->band ? " out of the band" : "");
  printf("  %-34s %12s %12s %12s  where: computed and %s\n", "curve", "largest gap", "relative",
         "rms, rel.", q->band ? "band" : "measured");
  printf("%c %-34s %12.4g %12.4g %12.4g", over ? '*' : ' ', title, g->largest, most,
         relative(g->rms, scale));
  const scale_text s = scale_of(m, h);
  print_place(q, &s, g);
  print_range(q, &s, m, g);
  printf("%s: %s `%s` by %s %g\n", over ? "different" : "same",
         q->band ? "outside of the band of" : "apart from", m->label,
         over ? "more than" : "no more than", q->tolerance);
  return over ? FAR : NEAR;
}

static int measure(const curve_request *q, const plot_histories *h, const measured *m, json *list) {
  const curve_points points = {m->x, q->band ? m->low : m->y, q->band ? m->high : m->y, m->count};
  curve_gap g;
  if (curve_gap_find(h->x, h->y, h->count, &points, &g)) return report(q, h, m, &g, list);
  say_error("`%s` and `%s` have no range of `%s` in common", q->result, q->table, q->x);
  return WRONG;
}

/* A band decides alone: points of the same table are not looked at. */
static int compare_with(const curve_request *q, const plot_histories *h, json *list) {
  const measured_axes axes = {q->x, &q->y, 1, h->x_unit, h->y_unit};
  source_set sources = {NULL, 0};
  diagnostics said;
  measured m;
  diag_begin(&said, &sources);
  const bool good = measured_read(&m, "compare", q->table, q->band, &axes, &said);
  diag_print(&said, stderr);
  for (int k = 0; k < said.count && !good; k++)
    keep_error(said.items[k].message);
  const int status = good ? measure(q, h, &m, list) : WRONG;
  measured_free(&m);
  diag_clear(&said);
  source_clear(&sources);
  return status;
}

int compare_curve(const curve_request *given, json *list) {
  curve_request q = *given;
  plot_histories h;
  char error[1024];
  int status = WRONG;
  q.x = q.x ? q.x : "time";
  q.y = q.y ? q.y : "load";
  if (plot_histories_read(&h, q.result, q.x, q.y, error, sizeof error))
    status = compare_with(&q, &h, list);
  else
    say_error("%s", error);
  free(h.x);
  free(h.y);
  return status;
}
