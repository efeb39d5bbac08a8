#include "runtime/plot/plot_paths.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/plot/colour_scale.h"
#include "runtime/plot/plot_cells.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_read.h"

enum { WIDE = 1100, HIGH = 620, WITH_LEGEND = 1240, SIDE = 40, TOP = 64, BOTTOM = 64, LINE = 28 };

typedef struct path_set { /* of a result */
  plot_meshes meshes;
  double *reference; /* [particles][2] m */
  double time;
  char label[256], title[512];
} path_set;

/* "m30" of "runs/m30.h5". */
static void name_of(const char *path, char *name, size_t size) {
  const char *slash = strrchr(path, '/'), *file = slash ? slash + 1 : path;
  const char *dot = strrchr(file, '.');
  snprintf(name, size, "%.*s", dot ? (int)(dot - file) : (int)strlen(file), file);
}

static double time_of(result_file *f, long frame) {
  long frames = 0;
  double *times = result_read_frame_times(f, &frames);
  const long k = frame < 0 ? frames + frame : frame;
  const double time = times && k >= 0 && k < frames ? times[k] : NAN;
  free(times);
  return time;
}

static bool read_set(path_set *s, const char *path, const plot_paths_options *o, char *error,
                     size_t size) {
  long particles;
  int dimensions;
  result_file *f = result_read(path, error, size);
  if (!f) return false;
  bool good = plot_meshes_read(&s->meshes, f, o->frame, error, size);
  if (good && s->meshes.crack_count == 0) {
    snprintf(error, size, "`%s` holds no cracks of a mesh, which a deck has with &crack%s", path,
             s->meshes.count > 0 ? ", in at least one frame" : "");
    good = false;
  }
  s->reference = good ? result_read_reference(f, &particles, &dimensions) : NULL;
  char *title = result_read_title(f);
  snprintf(s->title, sizeof s->title, "%s", title);
  free(title);
  s->time = time_of(f, o->frame);
  if (result_trouble(f)) {
    snprintf(error, size, "%s", result_trouble(f));
    good = false;
  }
  result_read_close(f);
  return good && s->reference;
}

typedef struct picture {
  path_set *sets; /* [count] */
  int count;
  double low[2], high[2]; /* of all meshes, m */
  map_place at;
  double width, height;
} picture;

static void find_extent(picture *p) {
  for (int a = 0; a < 2; a++) {
    p->low[a] = INFINITY;
    p->high[a] = -INFINITY;
  }
  for (int n = 0; n < p->count; n++)
    for (int k = 0; k < p->sets[n].meshes.count; k++) {
      const plot_mesh *m = &p->sets[n].meshes.items[k];
      for (long c = 0; c < 4 * m->cell_count; c++)
        for (int a = 0; a < 2; a++) {
          p->low[a] = pl_fmin(p->low[a], p->sets[n].reference[2 * m->cells[c] + a]);
          p->high[a] = pl_fmax(p->high[a], p->sets[n].reference[2 * m->cells[c] + a]);
        }
    }
}

/* As large as there is room for; the legend stands to the right of what is high, else below. */
static bool lay_out(picture *p, double legend, char *error, size_t size) {
  find_extent(p);
  const double wide = p->high[0] - p->low[0], high = p->high[1] - p->low[1];
  if (!(wide > 0 && wide < 1e12 && high > 0 && high < 1e12)) {
    snprintf(error, size, "the meshes have no finite extent to draw");
    return false;
  }
  const double scale = pl_fmin(WIDE / wide, HIGH / high);
  p->at = (map_place){.left = p->low[0],
                      .bottom = p->low[1],
                      .scale = scale,
                      .origin_x = SIDE,
                      .origin_y = TOP + high * scale};
  const bool beside = wide * scale + 60 + legend <= WITH_LEGEND;
  p->width = 2 * SIDE + pl_fmax(wide * scale + (beside ? 60 + legend : 0), 700);
  p->height = TOP + high * scale + BOTTOM + (beside ? 0 : LINE * (p->count + 1));
  return true;
}

static void draw_outline(canvas *c, const picture *p, const path_set *s) {
  const mesh_view v = {s->reference, s->reference, NULL, NULL};
  plot_cells_outline(c, &s->meshes, &v, &p->at);
}

/* Legs from one point to another. */
static void draw_legs(canvas *c, const picture *p, const plot_crack *k, long from, long to,
                      double width) {
  if (to <= from) return;
  for (long n = from; n <= to; n++) {
    const double x = p->at.origin_x + (k->points[2 * n] - p->at.left) * p->at.scale,
                 y = p->at.origin_y - (k->points[2 * n + 1] - p->at.bottom) * p->at.scale;
    if (n == from)
      cairo_move_to(c->cr, x, y);
    else
      cairo_line_to(c->cr, x, y);
  }
  cairo_set_line_width(c->cr, width);
  cairo_stroke(c->cr);
}

static const colour begun_ink = {0.1, 0.1, 0.1};

static void draw_paths(canvas *c, const picture *p) {
  cairo_set_line_join(c->cr, CAIRO_LINE_JOIN_ROUND);
  for (int n = 0; n < p->count; n++)
    for (int k = 0; k < p->sets[n].meshes.crack_count; k++) {
      const plot_crack *path = &p->sets[n].meshes.cracks[k];
      if (path->count < 2) continue;
      canvas_colour(c, begun_ink);
      draw_legs(c, p, path, path->first, path->last, CRACK_BEGUN_WIDTH);
      canvas_colour(c, scale_ink(n, p->count));
      draw_legs(c, p, path, 0, path->first, CRACK_GROWN_WIDTH);
      draw_legs(c, p, path, path->last, path->count - 1, CRACK_GROWN_WIDTH);
    }
}

static double sample(canvas *c, double x, double y, colour ink, double width, const char *text) {
  canvas_colour(c, ink);
  canvas_line(c, x, y - 6, x + 36, y - 6, width);
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  canvas_text(c, x + 46, y, 18, ANCHOR_LEFT, text);
  return y + LINE;
}

static double legend_width(const picture *p) {
  size_t longest = strlen("crack at the beginning");
  for (int n = 0; n < p->count; n++)
    if (strlen(p->sets[n].label) > longest) longest = strlen(p->sets[n].label);
  return 46 + 10.0 * (double)longest;
}

static void draw_legend(canvas *c, const picture *p) {
  const double right = SIDE + (p->high[0] - p->low[0]) * p->at.scale;
  const bool beside = right + 60 + legend_width(p) <= p->width;
  const double x = beside ? right + 60 : SIDE;
  double y = beside ? TOP + 16 : p->at.origin_y + BOTTOM + 20;
  y = sample(c, x, y, begun_ink, CRACK_BEGUN_WIDTH, "crack at the beginning");
  for (int n = 0; n < p->count; n++)
    y = sample(c, x, y, scale_ink(n, p->count), CRACK_GROWN_WIDTH, p->sets[n].label);
}

static void draw_scale_bar(canvas *c, const picture *p) {
  const double length = nice_step(p->high[0] - p->low[0], 5), y = p->at.origin_y + 34;
  char text[64];
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  canvas_line(c, SIDE, y, SIDE + length * p->at.scale, y, 3);
  snprintf(text, sizeof text, "%.6g mm", 1e3 * length);
  canvas_text(c, SIDE + length * p->at.scale + 12, y + 6, 18, ANCHOR_LEFT, text);
}

static bool draw(picture *p, const plot_paths_options *o, char *error, size_t size) {
  canvas c;
  if (!lay_out(p, legend_width(p), error, size)) return false;
  if (!canvas_open(&c, o->output, ceil(p->width), ceil(p->height), error, size)) return false;
  canvas_colour(&c, (colour){0.1, 0.1, 0.1});
  canvas_text_within(&c, SIDE, 40, 24, p->width - 2 * SIDE, o->title ? o->title : p->sets[0].title);
  for (int n = 0; n < p->count; n++)
    draw_outline(&c, p, &p->sets[n]);
  draw_paths(&c, p);
  draw_legend(&c, p);
  draw_scale_bar(&c, p);
  return canvas_close(&c, error, size);
}

bool plot_paths(const char *const *results, int count, const plot_paths_options *o, char *error,
                size_t size) {
  picture p = {.sets = must_calloc((size_t)count + 1, sizeof *p.sets), .count = count};
  bool good = true;
  for (int n = 0; n < count && good; n++) {
    good = read_set(&p.sets[n], results[n], o, error, size);
    if (o->labels)
      snprintf(p.sets[n].label, sizeof p.sets[n].label, "%s", o->labels[n]);
    else
      name_of(results[n], p.sets[n].label, sizeof p.sets[n].label);
  }
  good = good && draw(&p, o, error, size);
  for (int n = 0; n < count; n++) {
    plot_meshes_free(&p.sets[n].meshes);
    free(p.sets[n].reference);
  }
  free(p.sets);
  return good;
}
