#include "runtime/plot/plot_cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/plot/colour_scale.h"
#include "runtime/plot/shading.h"

static void place(const map_place *m, const double at[2], double shown[2]) {
  shown[0] = m->origin_x + (at[0] - m->left) * m->scale;
  shown[1] = m->origin_y - (at[1] - m->bottom) * m->scale;
}

/* Parts of a cell that are about `size` on the canvas. */
static int parts_of(const plot_mesh *m, const map_place *at, double size, int most) {
  return (int)pl_fmin(pl_fmax(ceil(m->size * at->scale / size), 1), most);
}

/* --- values ----------------------------------------------------------------------------------- */

typedef struct filling {
  shading image;
  const map_place *at;
} filling;

static void fill_part(void *context, const double at[4][2], const double value[4]) {
  filling *f = context;
  double shown[4][2];
  for (int k = 0; k < 4; k++)
    place(f->at, at[k], shown[k]);
  shading_fill(&f->image, (const double(*)[2])shown, value);
}

/* What the moved cells cover, m. */
static void find_box(const plot_mesh *m, const mesh_view *v, double low[2], double high[2]) {
  low[0] = low[1] = INFINITY;
  high[0] = high[1] = -INFINITY;
  for (long k = 0; k < 4 * m->cell_count; k++)
    for (int a = 0; a < 2; a++) {
      low[a] = pl_fmin(low[a], v->moved[2 * m->cells[k] + a]);
      high[a] = pl_fmax(high[a], v->moved[2 * m->cells[k] + a]);
    }
}

static void fill_mesh(canvas *c, const plot_mesh *m, const mesh_view *v, const map_place *at,
                      double low, double high) {
  double lower[2], upper[2], corner[2];
  find_box(m, v, lower, upper);
  place(at, (const double[2]){lower[0], upper[1]}, corner);
  const double width = (upper[0] - lower[0]) * at->scale,
               height = (upper[1] - lower[1]) * at->scale;
  if (!(width > 0 && width < 1e4 && height > 0 && height < 1e4)) return;
  filling f = {shading_new(c, corner[0], corner[1], width, height), at};
  plot_mesh_parts(m, v, parts_of(m, at, 6, 8), parts_of(m, at, 2, 32), fill_part, &f);
  shading_paint(c, &f.image, low, high);
  shading_free(&f.image);
}

void plot_cells_fill(canvas *c, const plot_meshes *m, const mesh_view *v, const map_place *at,
                     double low, double high) {
  for (int k = 0; k < m->count; k++)
    fill_mesh(c, &m->items[k], v, at, low, high);
}

/* --- lines of equal value --------------------------------------------------------------------- */

static double step_of(double range, int wanted) {
  double best = 0;
  for (double least = 0.4 * wanted; least < 3 * wanted + 2; least += 0.2) {
    const double step = nice_step(range, (int)pl_fmax(least, 1));
    if (best == 0 || fabs(range / step - wanted) < fabs(range / best - wanted)) best = step;
  }
  return best;
}

int contour_levels(double low, double high, int wanted, double levels[CONTOURS_MOST]) {
  int count = 0;
  if (!(high > low) || wanted < 1) return 0;
  const double step = step_of(high - low, wanted), from = ceil(low / step);
  for (int k = 0; count < CONTOURS_MOST && (from + k) * step < high; k++)
    if ((from + k) * step > low) levels[count++] = (from + k) * step;
  return count;
}

typedef struct isoline {
  canvas *canvas;
  const map_place *at;
  double level;
} isoline;

/* Where the side a -> b has the level; false: nowhere. */
static bool cross_side(const isoline *l, const double a[2], double at_a, const double b[2],
                       double at_b, double there[2]) {
  if ((at_a >= l->level) == (at_b >= l->level)) return false;
  const double part = (l->level - at_a) / (at_b - at_a);
  const double at[2] = {a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])};
  place(l->at, at, there);
  return isfinite(there[0]) && isfinite(there[1]);
}

static void cross_triangle(const isoline *l, const double *p[3], const double value[3]) {
  double ends[3][2];
  int count = 0;
  for (int k = 0; k < 3; k++)
    count += cross_side(l, p[k], value[k], p[(k + 1) % 3], value[(k + 1) % 3], ends[count]);
  if (count < 2) return;
  cairo_move_to(l->canvas->cr, ends[0][0], ends[0][1]);
  cairo_line_to(l->canvas->cr, ends[1][0], ends[1][1]);
}

/* Four triangles around the middle: two would favour a diagonal. */
static void cross_part(void *context, const double at[4][2], const double value[4]) {
  const isoline *l = context;
  double middle[2] = {0, 0}, mean = 0;
  for (int k = 0; k < 4; k++) {
    middle[0] += 0.25 * at[k][0];
    middle[1] += 0.25 * at[k][1];
    mean += 0.25 * value[k];
  }
  for (int k = 0; k < 4; k++) {
    const double *p[3] = {at[k], at[(k + 1) % 4], middle};
    cross_triangle(l, p, (const double[3]){value[k], value[(k + 1) % 4], mean});
  }
}

/* Without the yellow, which is faint on white. */
colour contour_colour(int k, int count) {
  return scale_colour(0.92 * k / pl_fmax(count - 1, 1));
}

void plot_cells_contours(canvas *c, const plot_meshes *m, const mesh_view *v, const map_place *at,
                         const double *levels, int count) {
  cairo_set_line_width(c->cr, 2);
  cairo_set_line_cap(c->cr, CAIRO_LINE_CAP_ROUND);
  for (int n = 0; n < count; n++) {
    isoline l = {c, at, levels[n]};
    canvas_colour(c, contour_colour(n, count));
    for (int k = 0; k < m->count; k++)
      plot_mesh_parts(&m->items[k], v, parts_of(&m->items[k], at, 8, 4),
                      parts_of(&m->items[k], at, 4, 16), cross_part, &l);
    cairo_stroke(c->cr);
  }
}

/* --- lines ------------------------------------------------------------------------------------ */

static void trace_line(canvas *c, const map_place *at, const double from[2], const double to[2]) {
  double a[2], b[2];
  place(at, from, a);
  place(at, to, b);
  cairo_move_to(c->cr, a[0], a[1]);
  cairo_line_to(c->cr, b[0], b[1]);
}

/* The first crack between the ends, and the part of the way up to it; NULL: there is none. */
static const crack_piece *piece_between(const plot_mesh *m, const double a[2], const double b[2],
                                        double *part) {
  for (int k = 0; k < m->lines.count; k++) {
    const crack_piece *p = &m->lines.pieces[k];
    const double u[2] = {p->b[0] - p->a[0], p->b[1] - p->a[1]};
    if (!crack_piece_hides(p, a, b)) continue;
    const double at_a = u[0] * (a[1] - p->a[1]) - u[1] * (a[0] - p->a[0]),
                 at_b = u[0] * (b[1] - p->a[1]) - u[1] * (b[0] - p->a[0]);
    *part = at_a / (at_a - at_b);
    return p;
  }
  return NULL;
}

/* A side of a cell; where a crack cuts it, up to the two faces. */
static void trace_side(canvas *c, const plot_mesh *m, const mesh_view *v, const map_place *at,
                       int32_t i, int32_t j) {
  const double *a = v->reference + 2 * i, *b = v->reference + 2 * j;
  double part, faces[2][2];
  if (!piece_between(m, a, b, &part)) {
    trace_line(c, at, v->moved + 2 * i, v->moved + 2 * j);
    return;
  }
  const double cut[2] = {a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])};
  for (int k = 0; k < 2; k++) {
    const double toward = k ? 1e-3 : -1e-3,
                 side[2] = {toward * (b[0] - a[0]), toward * (b[1] - a[1])};
    plot_mesh_face(m, v, cut, side, faces[k]);
    trace_line(c, at, v->moved + 2 * (k ? j : i), faces[k]);
  }
}

void plot_cells_outline(canvas *c, const plot_meshes *m, const mesh_view *v, const map_place *at) {
  canvas_colour(c, (colour){0.35, 0.35, 0.38});
  cairo_set_line_width(c->cr, 1.2);
  for (int k = 0; k < m->count; k++) {
    long count;
    int32_t *sides = plot_mesh_outline(&m->items[k], &count);
    for (long n = 0; n < count; n++)
      trace_side(c, &m->items[k], v, at, sides[2 * n], sides[2 * n + 1]);
    cairo_stroke(c->cr);
    free(sides);
  }
}

static const plot_mesh *mesh_of(const plot_meshes *m, const plot_crack *k) {
  for (int n = 0; n < m->count; n++)
    if (strcmp(m->items[n].name, k->mesh) == 0) return &m->items[n];
  return NULL;
}

typedef struct tracing {
  canvas *c;
  const map_place *at;
  bool begun;
} tracing;

static void trace_point(void *context, const double moved[2]) {
  tracing *t = context;
  double shown[2];
  place(t->at, moved, shown);
  if (t->begun)
    cairo_line_to(t->c->cr, shown[0], shown[1]);
  else
    cairo_move_to(t->c->cr, shown[0], shown[1]);
  t->begun = true;
}

static void draw_legs(canvas *c, const plot_mesh *m, const mesh_view *v, const map_place *at,
                      const plot_crack *k, long from, long to, double width) {
  if (to <= from || !(m->size > 0)) return;
  for (int side = 1; side >= -1; side -= 2)
    plot_mesh_crack_face(m, v, k, from, to, side, trace_point, &(tracing){c, at, false});
  cairo_set_line_width(c->cr, width);
  cairo_stroke(c->cr);
}

static void draw_cracks(canvas *c, const plot_meshes *m, const mesh_view *v, const map_place *at,
                        double wider) {
  for (int n = 0; n < m->crack_count; n++) {
    const plot_crack *k = &m->cracks[n];
    const plot_mesh *of = mesh_of(m, k);
    if (!of || k->count < 2) continue;
    draw_legs(c, of, v, at, k, 0, k->first, CRACK_GROWN_WIDTH + wider);
    draw_legs(c, of, v, at, k, k->last, k->count - 1, CRACK_GROWN_WIDTH + wider);
    draw_legs(c, of, v, at, k, k->first, k->last, CRACK_BEGUN_WIDTH + wider);
  }
}

void plot_cells_cracks(canvas *c, const plot_meshes *m, const mesh_view *v, const map_place *at) {
  cairo_set_line_cap(c->cr, CAIRO_LINE_CAP_BUTT);
  cairo_set_line_join(c->cr, CAIRO_LINE_JOIN_ROUND);
  canvas_colour(c, (colour){1, 1, 1});
  draw_cracks(c, m, v, at, 2.4);
  canvas_colour(c, (colour){0, 0, 0});
  draw_cracks(c, m, v, at, 0);
}

bool plot_cells_grown(const plot_meshes *m) {
  bool grown = false;
  for (int n = 0; n < m->crack_count; n++)
    grown = grown || m->cracks[n].first > 0 || m->cracks[n].last < m->cracks[n].count - 1;
  return grown;
}

void plot_cells_crack_legend(canvas *c, const plot_meshes *m, double x, double y) {
  const bool grown = plot_cells_grown(m);
  const char *begun = grown ? "crack at the beginning" : "crack";
  if (m->crack_count == 0) return;
  canvas_colour(c, (colour){0, 0, 0});
  canvas_line(c, x, y - 6, x + 28, y - 6, CRACK_BEGUN_WIDTH);
  canvas_text(c, x + 36, y, 18, ANCHOR_LEFT, begun);
  if (!grown) return;
  x += 36 + canvas_text_width(c, 18, begun) + 24;
  canvas_line(c, x, y - 6, x + 28, y - 6, CRACK_GROWN_WIDTH);
  canvas_text(c, x + 36, y, 18, ANCHOR_LEFT, "grown");
}
