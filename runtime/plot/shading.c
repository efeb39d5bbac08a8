#include "runtime/plot/shading.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/plot/colour_scale.h"

shading shading_new(const canvas *c, double left, double top, double width, double height) {
  const double fineness = c->is_png ? 1 : 2;
  shading s = {.left = floor(left), .top = floor(top), .fineness = fineness};
  s.width = (int)ceil(width * fineness) + 2;
  s.height = (int)ceil(height * fineness) + 2;
  const size_t pixels = (size_t)s.width * (size_t)s.height;
  s.values = must_alloc(pixels * sizeof *s.values);
  for (size_t k = 0; k < pixels; k++)
    s.values[k] = NAN;
  return s;
}

void shading_free(shading *s) {
  free(s->values);
}

/* Twice the area of a, b, c. */
static double area(const double a[2], const double b[2], const double c[2]) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static int within(double at, int most) {
  return (int)pl_fmin(pl_fmax(at, 0), most);
}

/* Pixels whose middles lie in the triangle, its sides included. */
static void fill_triangle(shading *s, const double *p[3], const double value[3]) {
  const double whole = area(p[0], p[1], p[2]);
  double low[2], high[2];
  if (!(fabs(whole) > 0) || !isfinite(whole)) return;
  for (int a = 0; a < 2; a++) {
    low[a] = pl_fmin(p[0][a], pl_fmin(p[1][a], p[2][a]));
    high[a] = pl_fmax(p[0][a], pl_fmax(p[1][a], p[2][a]));
  }
  for (int y = within(floor(low[1] - 0.5), s->height); y < within(ceil(high[1] + 0.5), s->height);
       y++)
    for (int x = within(floor(low[0] - 0.5), s->width); x < within(ceil(high[0] + 0.5), s->width);
         x++) {
      const double at[2] = {x + 0.5, y + 0.5};
      const double share[3] = {area(p[1], p[2], at) / whole, area(p[2], p[0], at) / whole,
                               area(p[0], p[1], at) / whole};
      if (share[0] < -1e-9 || share[1] < -1e-9 || share[2] < -1e-9) continue;
      s->values[(size_t)y * (size_t)s->width + (size_t)x] =
          (float)(share[0] * value[0] + share[1] * value[1] + share[2] * value[2]);
    }
}

void shading_fill(shading *s, const double at[4][2], const double value[4]) {
  double there[4][2];
  for (int k = 0; k < 4; k++) {
    there[k][0] = (at[k][0] - s->left) * s->fineness;
    there[k][1] = (at[k][1] - s->top) * s->fineness;
  }
  const double *first[3] = {there[0], there[1], there[2]},
               *second[3] = {there[0], there[2], there[3]};
  fill_triangle(s, first, (const double[3]){value[0], value[1], value[2]});
  fill_triangle(s, second, (const double[3]){value[0], value[2], value[3]});
}

static uint32_t pixel_of(double value, double low, double high) {
  const int step = scale_step(value, low, high, CELL_STEPS);
  const colour k = step < 0 ? scale_no_value : scale_colour((step + 0.5) / CELL_STEPS);
  return 0xFF000000u | (uint32_t)lround(255 * k.r) << 16 | (uint32_t)lround(255 * k.g) << 8 |
         (uint32_t)lround(255 * k.b);
}

void shading_paint(canvas *c, const shading *s, double low, double high) {
  cairo_surface_t *image = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, s->width, s->height);
  if (cairo_surface_status(image) == CAIRO_STATUS_SUCCESS) {
    unsigned char *data = cairo_image_surface_get_data(image);
    const int stride = cairo_image_surface_get_stride(image);
    for (int y = 0; y < s->height; y++) {
      uint32_t *row = (uint32_t *)(void *)(data + (ptrdiff_t)y * stride);
      for (int x = 0; x < s->width; x++) {
        const float v = s->values[(size_t)y * (size_t)s->width + (size_t)x];
        row[x] = isnan(v) ? 0 : pixel_of(v, low, high);
      }
    }
    cairo_surface_mark_dirty(image);
    cairo_save(c->cr);
    cairo_translate(c->cr, s->left, s->top);
    cairo_scale(c->cr, 1 / s->fineness, 1 / s->fineness);
    cairo_set_source_surface(c->cr, image, 0, 0);
    cairo_pattern_set_filter(cairo_get_source(c->cr), CAIRO_FILTER_NEAREST);
    cairo_paint(c->cr);
    cairo_restore(c->cr);
  }
  cairo_surface_destroy(image);
}
