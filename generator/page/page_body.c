#include "generator/page/page_body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "generator/page/body_regions.h"
#include "generator/page/html.h"
#include "runtime/plot/plot_frame.h"
#include "runtime/result/result_read.h"

enum { WIDTH = 1000, MARGIN = 46, MOST_HEIGHT = 620, MOST_BONDS = 4000, MOST_MARKS = 14 };

typedef struct picture {
  FILE *out;
  const page_result *p;
  plot_frame frame;
  double *places; /* [particles][dimensions] m: of all particles, not of those that are seen */
  long particles;
  int dimensions;
  double left, top, scale, height;
} picture;

/* --- places ----------------------------------------------------------------------------------- */

static void fit(picture *w) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (long k = 0; k < w->frame.particles; k++)
    for (int c = 0; c < 2; c++) {
      low[c] = pl_fmin(low[c], w->frame.reference[2 * k + c]);
      high[c] = pl_fmax(high[c], w->frame.reference[2 * k + c]);
    }
  const double wide = pl_fmax(high[0] - low[0], 1e-12), tall = high[1] - low[1];
  w->scale =
      pl_fmin((WIDTH - 2 * MARGIN) / wide, (MOST_HEIGHT - 2 * MARGIN) / pl_fmax(tall, 1e-12));
  w->left = low[0] - (WIDTH / w->scale - wide) / 2;
  w->top = high[1] + MARGIN / w->scale;
  w->height = tall * w->scale + 2 * MARGIN;
}

static double at_x(const picture *w, double x) {
  return (x - w->left) * w->scale;
}
static double at_y(const picture *w, double y) {
  return (w->top - y) * w->scale;
}

/* Of a place in the plane or in space, as it is seen. */
static void seen_at(const picture *w, const double *at, double to[2]) {
  double plane[2] = {at[0], at[1]};
  for (int c = 0; c < 2 && w->dimensions == 3; c++)
    plane[c] =
        w->frame.axes[0][c] * at[0] + w->frame.axes[1][c] * at[1] + w->frame.axes[2][c] * at[2];
  to[0] = at_x(w, plane[0]);
  to[1] = at_y(w, plane[1]);
}

/* --- the body --------------------------------------------------------------------------------- */

static void put_bonds(const picture *w) {
  const plot_frame *f = &w->frame;
  fprintf(w->out, "<path class=\"bond\" stroke-width=\"%.2f\" d=\"",
          pl_fmax(0.5, 0.1 * f->spacing * w->scale));
  for (long b = 0; b < f->bonds; b++) {
    const double *i = f->reference + 2 * f->pairs[2 * b],
                 *j = f->reference + 2 * f->pairs[2 * b + 1];
    fprintf(w->out, "M%.1f %.1fL%.1f %.1f", at_x(w, i[0]), at_y(w, i[1]), at_x(w, j[0]),
            at_y(w, j[1]));
  }
  fputs("\"/>\n", w->out);
}

/* Quarters of the mean spacing, which graded particles are drawn by; all others have 4 of them. */
enum { MOST_QUARTERS = 24 };
static int quarters_of(const plot_frame *f, long particle) {
  const double quarters = f->size ? 4 * f->size[particle] : 4;
  return quarters < 1 ? 1 : quarters > MOST_QUARTERS ? MOST_QUARTERS : (int)(quarters + 0.5);
}

/* Particles of a size, as one path; `bonds`: of each, [particles]. */
static void put_dots(const picture *w, const int32_t *bonds, int32_t most, int quarters) {
  const plot_frame *f = &w->frame;
  bool any = false;
  for (long k = 0; k < f->particles; k++) {
    if ((bonds[k] >= most && most > 0) || quarters_of(f, k) != quarters) continue;
    if (!any)
      fprintf(w->out, "<path class=\"bond\" stroke-width=\"%.2f\" stroke-linecap=\"round\" d=\"",
              pl_fmax(1.2, 0.15 * quarters * f->spacing * w->scale));
    fprintf(w->out, "M%.1f %.1fh0", at_x(w, f->reference[2 * k]), at_y(w, f->reference[2 * k + 1]));
    any = true;
  }
  if (any) fputs("\"/>\n", w->out);
}

/* Many bonds are not told apart: the particles that have fewer than others, on the edge. */
static void put_edge(const picture *w) {
  const plot_frame *f = &w->frame;
  int32_t *bonds = must_calloc((size_t)f->particles + 1, sizeof *bonds), most = 0;
  for (long k = 0; k < 2 * f->bonds; k++)
    if (++bonds[f->pairs[k]] > most) most = bonds[f->pairs[k]];
  for (int n = f->size ? 1 : 4; n <= (f->size ? MOST_QUARTERS : 4); n++)
    put_dots(w, bonds, most, n);
  free(bonds);
}

static void put_meshes(const picture *w) {
  const plot_frame *f = &w->frame;
  for (int n = 0; n < f->meshes.count; n++) {
    const plot_mesh *m = &f->meshes.items[n];
    long count = 0;
    int32_t *outline = plot_mesh_outline(m, &count);
    if (m->cell_count <= MOST_BONDS) {
      fputs("<path class=\"cell\" stroke-width=\"0.6\" d=\"", w->out);
      for (long k = 0; k < 4 * m->cell_count; k++) {
        const double *at = f->reference + 2 * m->cells[k];
        fprintf(w->out, "%c%.1f %.1f%s", k % 4 ? 'L' : 'M', at_x(w, at[0]), at_y(w, at[1]),
                k % 4 == 3 ? "Z" : "");
      }
      fputs("\"/>\n", w->out);
    }
    fputs("<path class=\"region-line\" d=\"", w->out);
    for (long k = 0; k < 2 * count; k++) {
      const double *at = f->reference + 2 * outline[k];
      fprintf(w->out, "%c%.1f %.1f", k % 2 ? 'L' : 'M', at_x(w, at[0]), at_y(w, at[1]));
    }
    fputs("\"/>\n", w->out);
    free(outline);
  }
  for (int n = 0; n < f->meshes.crack_count; n++) {
    const plot_crack *k = &f->meshes.cracks[n];
    fputs("<path class=\"crack\" d=\"", w->out);
    for (long i = 0; i < k->count; i++)
      fprintf(w->out, "%c%.1f %.1f", i ? 'L' : 'M', at_x(w, k->points[2 * i]),
              at_y(w, k->points[2 * i + 1]));
    fputs("\"/>\n", w->out);
  }
}

/* --- regions ---------------------------------------------------------------------------------- */

static void put_polygon(const picture *w, const double *points, int count) {
  fputs("<path class=\"region\" d=\"", w->out);
  for (int k = 0; k < count; k++)
    fprintf(w->out, "%c%.1f %.1f", k ? 'L' : 'M', at_x(w, points[2 * k]),
            at_y(w, points[2 * k + 1]));
  fputs("Z\"/>\n", w->out);
}

static void put_outline(const picture *w, const deck_shape *s) {
  if (w->dimensions != 2 || s->members) return;
  if (s->kind == SHAPE_RECTANGLE) {
    const double c = pl_cos(s->rotation), n = pl_sin(s->rotation), *at = s->corner;
    double points[8];
    for (int k = 0; k < 4; k++) {
      const double x = k == 1 || k == 2 ? s->size[0] : 0, y = k >= 2 ? s->size[1] : 0;
      points[2 * k] = at[0] + c * x - n * y;
      points[2 * k + 1] = at[1] + n * x + c * y;
    }
    put_polygon(w, points, 4);
  } else if (s->kind == SHAPE_POLYGON && s->points)
    put_polygon(w, s->points, s->point_count);
  else if (s->kind == SHAPE_DISC)
    fprintf(w->out, "<circle class=\"region\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>\n",
            at_x(w, s->centre[0]), at_y(w, s->centre[1]), s->radius * w->scale);
}

/* Held along x: a short way to the left and a bar; along y below; turning: a square. */
static void put_held(const picture *w, const double at[2], int fix) {
  fputs("<path class=\"held\" d=\"", w->out);
  if (fix & FIX_X) fprintf(w->out, "M%.1f %.1fh-11m0 -6v12", at[0], at[1]);
  if (fix & FIX_Y) fprintf(w->out, "M%.1f %.1fv11m-6 0h12", at[0], at[1]);
  if (fix & ~(FIX_X | FIX_Y)) fprintf(w->out, "M%.1f %.1fh8v8h-8z", at[0] - 4, at[1] - 4);
  fputs("\"/>\n", w->out);
}

/* An arrow that ends at the particle, or a ring for what turns. */
static void put_arrow(const picture *w, const double at[2], int component, double sign,
                      const char *class) {
  enum { LENGTH = 26 };
  double way[2] = {0, 0};
  if (component < w->dimensions) {
    for (int c = 0; c < 2; c++)
      way[c] = w->dimensions == 2 ? component == c : w->frame.axes[component][c];
    way[1] = -way[1];
  }
  const double length = pl_hypot(way[0], way[1]);
  if (!(length > 0)) {
    fprintf(w->out, "<circle class=\"%s ring\" cx=\"%.1f\" cy=\"%.1f\" r=\"8\"/>\n", class, at[0],
            at[1]);
    return;
  }
  const double x = sign * way[0] / length, y = sign * way[1] / length;
  fprintf(w->out,
          "<path class=\"%s\" d=\"M%.1f %.1fL%.1f %.1fM%.1f %.1fL%.1f %.1fL%.1f %.1fZ\"/>\n", class,
          at[0] - LENGTH * x, at[1] - LENGTH * y, at[0] - 7 * x, at[1] - 7 * y, at[0] - x,
          at[1] - y, at[0] - 9 * x - 4 * y, at[1] - 9 * y + 4 * x, at[0] - 9 * x + 4 * y,
          at[1] - 9 * y - 4 * x);
}

static double sign_of(const time_function *f) {
  double value = f->value;
  if (f->shape == TIME_TABLE)
    for (int k = 0; k < f->count; k++)
      if (k == 0 || fabs(f->values[k]) > fabs(value)) value = f->values[k];
  return value < 0 ? -1 : 1;
}

static bool acts_on(const char *region, const deck_region *r) {
  return region && r->name && strcmp(region, r->name) == 0;
}

static void put_actions(const picture *w, const deck_region *r, const double at[2]) {
  const deck *k = w->p->deck;
  for (int n = 0; n < k->support_count; n++)
    if (acts_on(k->supports[n].region, r)) put_held(w, at, k->supports[n].fix);
  for (int n = 0; n < k->drive_count; n++)
    if (acts_on(k->drives[n].region, r))
      put_arrow(w, at, k->drives[n].component, sign_of(&k->drives[n].motion), "driven");
  for (int n = 0; n < k->force_count; n++)
    if (acts_on(k->forces[n].region, r))
      put_arrow(w, at, k->forces[n].component, sign_of(&k->forces[n].force), "loaded");
}

/* Of many particles some, evenly; the number of the region stands at the middle one. */
static void put_region(const picture *w, int region, int number) {
  const deck_region *r = &w->p->deck->regions[region];
  long count = 0;
  long *found = body_region_particles(w->p, region, w->places, w->particles, w->dimensions,
                                      w->frame.spacing, &count);
  const long stride = 1 + (count - 1) / MOST_MARKS;
  put_outline(w, &r->shape);
  for (long k = 0; k < count; k += stride) {
    double at[2];
    seen_at(w, w->places + w->dimensions * found[k], at);
    put_actions(w, r, at);
  }
  if (count > 0) {
    double at[2];
    seen_at(w, w->places + w->dimensions * found[count / 2], at);
    fprintf(w->out, "<circle class=\"place\" cx=\"%.1f\" cy=\"%.1f\" r=\"3\"/>", at[0], at[1]);
    fprintf(w->out, "<text class=\"number\" x=\"%.1f\" y=\"%.1f\">%d</text>\n", at[0] + 6,
            at[1] - 7, number);
  }
  free(found);
}

/* What is done in each region, by its number in the picture. */
static void put_list(FILE *out, const page_result *p, int dimensions) {
  fputs("<ol class=\"regions\">\n", out);
  for (int k = 0; k < p->deck->region_count; k++) {
    fputs("<li><strong>", out);
    html_text(out, p->deck->regions[k].name ? p->deck->regions[k].name : "");
    fputs("</strong> ", out);
    body_region_words(out, p, k, dimensions);
    fputs("</li>\n", out);
  }
  fputs("</ol>\n", out);
}

/* --- the section ------------------------------------------------------------------------------ */

static bool open_picture(picture *w) {
  char none[512];
  const plot_map_options o = {
      .frame = 0, .field = "displacement", .component = -1, .factor = 0, .slice_axis = -1};
  if (!plot_frame_take(&w->frame, w->p->file, w->p->path, &o, none, sizeof none)) return false;
  w->places = result_read_reference(w->p->file, &w->particles, &w->dimensions);
  return w->places != NULL;
}

static void put_picture(picture *w) {
  fit(w);
  fprintf(w->out,
          "<svg class=\"body\" viewBox=\"0 0 %d %.0f\" role=\"img\" aria-label=\"the body at the "
          "beginning\">\n",
          WIDTH, w->height);
  put_meshes(w);
  if (w->frame.bonds > 0 && w->frame.bonds <= MOST_BONDS)
    put_bonds(w);
  else if (w->frame.meshes.count == 0)
    put_edge(w);
  for (int k = 0; w->p->deck && k < w->p->deck->region_count; k++)
    put_region(w, k, k + 1);
  fputs("</svg>\n", w->out);
}

void page_body(FILE *out, const page_result *p) {
  picture w = {.out = out, .p = p};
  if (p->frames > 0 && open_picture(&w)) {
    fputs("<section><h2>The body</h2>\n<figure>", out);
    put_picture(&w);
    fputs("</figure>\n", out);
    if (p->deck && p->deck->region_count > 0) put_list(out, p, w.dimensions);
    fputs("</section>\n", out);
  }
  plot_frame_free(&w.frame);
  free(w.places);
}
