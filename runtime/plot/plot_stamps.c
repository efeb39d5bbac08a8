#include "runtime/plot/plot_stamps.h"

#include <stdio.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_read.h"

static const colour solid_ink = {0.84, 0.85, 0.87}, edge_ink = {0.45, 0.48, 0.52};

static double *table(result_file *f, const char *stamp, const char *what, long *count) {
  char path[600];
  int columns;
  snprintf(path, sizeof path, "/stamps/%.400s/%s", stamp, what);
  return result_read_table(f, path, false, 2, 2, count, &columns);
}

/* A stamp in space has no outline. */
static bool read_stamp(plot_stamps *s, result_file *f, const char *name, long frame) {
  plot_stamp p = {.count = 0};
  long frames = 0;
  p.outline = table(f, name, "outline", &p.count);
  if (!p.outline) return true;
  double *ways = table(f, name, "place", &frames);
  if (frame < 0) frame += frames;
  const bool good = ways && frame >= 0 && frame < frames && p.count > 0;
  for (int c = 0; c < 2 && good; c++)
    p.way[c] = ways[2 * frame + c];
  free(ways);
  if (good)
    s->items[s->count++] = p;
  else
    free(p.outline);
  return good;
}

bool plot_stamps_read(plot_stamps *s, result_file *f, long frame) {
  result_names names = result_list(f, "/stamps");
  bool good = true;
  *s = (plot_stamps){.count = 0};
  s->items = must_calloc((size_t)names.count + 1, sizeof *s->items);
  for (int k = 0; k < names.count && good; k++)
    good = read_stamp(s, f, names.items[k], frame);
  result_names_free(&names);
  return good;
}

void plot_stamps_free(plot_stamps *s) {
  for (int k = 0; k < s->count; k++)
    free(s->items[k].outline);
  free(s->items);
  *s = (plot_stamps){.count = 0};
}

static double place_of(const plot_stamp *s, long corner, int component, double factor) {
  return s->outline[2 * corner + component] + factor * s->way[component];
}

void plot_stamps_reach(const plot_stamps *s, double factor, double low[2], double high[2]) {
  for (int n = 0; n < s->count; n++)
    for (long k = 0; k < s->items[n].count; k++)
      for (int c = 0; c < 2; c++) {
        const double here = place_of(&s->items[n], k, c, factor);
        low[c] = pl_fmin(low[c], here);
        high[c] = pl_fmax(high[c], here);
      }
}

static double at_x(const map_place *m, double x) {
  return m->origin_x + (x - m->left) * m->scale;
}
static double at_y(const map_place *m, double y) {
  return m->origin_y - (y - m->bottom) * m->scale;
}

static void draw_stamp(canvas *c, const plot_stamp *s, double factor, const map_place *m) {
  for (long k = 0; k < s->count; k++) {
    cairo_line_to(c->cr, at_x(m, place_of(s, k, 0, factor)), at_y(m, place_of(s, k, 1, factor)));
  }
  cairo_close_path(c->cr);
  canvas_colour(c, solid_ink);
  cairo_fill_preserve(c->cr);
  canvas_colour(c, edge_ink);
  cairo_set_line_width(c->cr, 1.5);
  cairo_stroke(c->cr);
}

void plot_stamps_draw(canvas *c, const plot_stamps *s, double factor, const map_place *m,
                      const double low[2], const double high[2]) {
  if (s->count == 0) return;
  cairo_save(c->cr);
  cairo_rectangle(c->cr, at_x(m, low[0]), at_y(m, high[1]), (high[0] - low[0]) * m->scale,
                  (high[1] - low[1]) * m->scale);
  cairo_clip(c->cr);
  cairo_new_path(c->cr);
  for (int k = 0; k < s->count; k++)
    draw_stamp(c, &s->items[k], factor, m);
  cairo_restore(c->cr);
}
