/* Map of one frame: bonds and particles where they have moved to. Damage is shown in the classes of Asadollahi
   (2014, table 4.3): up to 0.3 yellow, 0.6 orange, 0.8 brown, below 1 red; separated bonds as black crack lines. Other
   fields colour the particles or the bonds by their value. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"
#include "dsl/elementary.h"
#include "runtime/canvas.h"
#include "runtime/plot_frame.h"

enum {
  WIDTH = 1500,
  MARGIN = 40,
  HEAD = 64,
  FOOT = 84,
  AXES = 76, /* above the foot: the axes of a body in space */
  LEAST_HEIGHT = 300,
  MOST_HEIGHT = 1500
};

static const struct {
  double up_to;
  colour ink;
  const char *text;
} classes[] = {{0.0, {0.80, 0.82, 0.85}, "sound"},     {0.3, {0.95, 0.80, 0.10}, "0 - 0.3"},
               {0.6, {0.95, 0.50, 0.05}, "0.3 - 0.6"}, {0.8, {0.55, 0.30, 0.10}, "0.6 - 0.8"},
               {1.0, {0.85, 0.05, 0.05}, "0.8 - 1"},   {INFINITY, {0, 0, 0}, "separated"}};
enum { CLASSES = sizeof classes / sizeof *classes, SEPARATED = CLASSES - 1 };

typedef struct map {
  plot_frame frame;
  double left, bottom, scale, height; /* picture: x = MARGIN + (X - left) * scale */
  double foot;                        /* below the body */
} map;

/* --- drawing ---------------------------------------------------------------------------------- */

static bool fit_picture(map *m, char *error, size_t size) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (long p = 0; p < m->frame.particles; p++)
    for (int c = 0; c < 2; c++) {
      low[c] = pl_fmin(low[c], m->frame.moved[2 * p + c] - m->frame.spacing);
      high[c] = pl_fmax(high[c], m->frame.moved[2 * p + c] + m->frame.spacing);
    }
  if (!(high[0] - low[0] < 1e12) || !(high[1] - low[1] < 1e12) || !(high[0] > low[0])) {
    snprintf(error, size, "the frame's displacements are not finite or too large to draw");
    return false;
  }
  m->foot = FOOT + (m->frame.dimensions == 3 ? AXES : 0);
  m->scale = pl_fmin((WIDTH - 2 * MARGIN) / (high[0] - low[0]),
                     (MOST_HEIGHT - HEAD - m->foot) / (high[1] - low[1]));
  m->left = low[0] - ((WIDTH - 2 * MARGIN) / m->scale - (high[0] - low[0])) / 2;
  m->height = pl_fmax(LEAST_HEIGHT, HEAD + m->foot + (high[1] - low[1]) * m->scale);
  m->bottom = low[1];
  return true;
}

static double at_x(const map *m, double x) {
  return MARGIN + (x - m->left) * m->scale;
}
static double at_y(const map *m, double y) {
  return m->height - m->foot - (y - m->bottom) * m->scale;
}

static int class_of(double damage) {
  if (damage >= 1) return SEPARATED;
  int k = 0;
  while (k < SEPARATED - 1 && damage > classes[k].up_to)
    k++;
  return k;
}

static int class_of_bond(const map *m, long b) {
  return m->frame.damage ? class_of(m->frame.damage[b]) : 0;
}

static void stroke_bond(canvas *c, const map *m, long b) {
  const double *i = &m->frame.moved[2 * m->frame.pairs[2 * b]],
               *j = &m->frame.moved[2 * m->frame.pairs[2 * b + 1]];
  cairo_move_to(c->cr, at_x(m, i[0]), at_y(m, i[1]));
  cairo_line_to(c->cr, at_x(m, j[0]), at_y(m, j[1]));
}

/* A separated bond: the edge between the two particles' cells, across the middle of the bond. */
static void stroke_crack(canvas *c, const map *m, long b) {
  const double *i = &m->frame.moved[2 * m->frame.pairs[2 * b]],
               *j = &m->frame.moved[2 * m->frame.pairs[2 * b + 1]];
  double x = (i[0] + j[0]) / 2, y = (i[1] + j[1]) / 2, dx = j[0] - i[0], dy = j[1] - i[1];
  double half = 0.5 / sqrt(3) * m->frame.spacing / pl_fmax(pl_hypot(dx, dy), 1e-300);
  cairo_move_to(c->cr, at_x(m, x - dy * half), at_y(m, y + dx * half));
  cairo_line_to(c->cr, at_x(m, x + dy * half), at_y(m, y - dx * half));
}

static void draw_bonds(canvas *c, const map *m, bool coloured) {
  double thin = pl_fmax(0.4, 0.12 * m->frame.spacing * m->scale);
  for (int k = 0; k < CLASSES; k++) { /* the worse above the better */
    if (!coloured && k != SEPARATED) continue;
    canvas_colour(c, classes[k].ink);
    cairo_set_line_width(c->cr, k == 0 ? 0.6 * thin : k == SEPARATED ? 1.6 * thin : 1.4 * thin);
    cairo_set_line_cap(c->cr, CAIRO_LINE_CAP_ROUND);
    for (long b = 0; b < m->frame.bonds; b++) {
      if (class_of_bond(m, b) != k) continue;
      if (k == SEPARATED)
        stroke_crack(c, m, b);
      else
        stroke_bond(c, m, b);
    }
    cairo_stroke(c->cr);
  }
}

/* Dark blue - green - yellow; equal steps look equal, also in grey. */
static colour shade(double v) {
  static const colour stops[] = {{0.27, 0.00, 0.33},
                                 {0.23, 0.32, 0.55},
                                 {0.13, 0.57, 0.55},
                                 {0.37, 0.79, 0.38},
                                 {0.99, 0.91, 0.14}};
  double at = pl_fmin(pl_fmax(v, 0), 1) * 4;
  int k = at >= 4 ? 3 : (int)at;
  double w = at - k;
  return (colour){stops[k].r + w * (stops[k + 1].r - stops[k].r),
                  stops[k].g + w * (stops[k + 1].g - stops[k].g),
                  stops[k].b + w * (stops[k + 1].b - stops[k].b)};
}

/* Place in the colour bar, 0 to 1; what is no number stands with the lowest. */
static double place_of(double value, double low, double high) {
  return high > low ? pl_fmin(pl_fmax((value - low) / (high - low), 0), 1) : 0;
}

static colour particle_colour(const map *m, long p, int component, double low, double high) {
  const double value = plot_frame_value(&m->frame, p, component);
  return m->frame.of_damage ? classes[class_of(value)].ink : shade(place_of(value, low, high));
}

static void draw_particle(canvas *c, const map *m, long p, colour ink, double radius) {
  canvas_colour(c, ink);
  cairo_arc(c->cr, at_x(m, m->frame.moved[2 * p]), at_y(m, m->frame.moved[2 * p + 1]), radius, 0,
            2 * M_PI);
  cairo_fill_preserve(c->cr);
  if (m->frame.surface) { /* an edge, so that those in front stand out */
    canvas_colour(c, (colour){0.25, 0.25, 0.28});
    cairo_set_line_width(c->cr, pl_fmin(0.08 * radius, 1.5));
    cairo_stroke(c->cr);
  }
  cairo_new_path(c->cr);
}

/* In the plane the more damaged above the less damaged; in a view of a surface those in front above those behind. */
static void draw_particles(canvas *c, const map *m, int component, double low, double high) {
  const bool coloured = m->frame.values && !m->frame.of_bonds;
  const bool by_class = coloured && m->frame.of_damage && !m->frame.surface;
  const double radius = pl_fmax(0.7, (coloured ? 0.5 : 0.1) * m->frame.spacing * m->scale);
  const colour plain = {0.45, 0.48, 0.52};
  cairo_new_path(c->cr);
  for (int k = 0; k < (by_class ? CLASSES : 1); k++)
    for (long p = 0; p < m->frame.particles; p++)
      if (!by_class || class_of(m->frame.values[p]) == k)
        draw_particle(c, m, p, coloured ? particle_colour(m, p, component, low, high) : plain,
                      radius);
}

static bool is_separated(const map *m, long b) {
  return m->frame.damage && m->frame.damage[b] >= 1;
}

enum { SHADES = 64 };
static int shade_of(double value, double low, double high) {
  return (int)pl_fmin(SHADES * place_of(value, low, high), SHADES - 1);
}

/* Bonds by their value, higher ones above lower ones; separated ones as thin lines across their crack. */
static void draw_bond_values(canvas *c, const map *m, int component, double low, double high) {
  const double wide = pl_fmax(0.8, 0.22 * m->frame.spacing * m->scale);
  cairo_set_line_cap(c->cr, CAIRO_LINE_CAP_ROUND);
  for (int k = 0; k < 2 * SHADES; k++) {
    const bool separated = k < SHADES;
    canvas_colour(c, shade((k % SHADES + 0.5) / SHADES));
    cairo_set_line_width(c->cr, separated ? 0.3 * wide : wide);
    for (long b = 0; b < m->frame.bonds; b++)
      if (is_separated(m, b) == separated &&
          shade_of(plot_frame_value(&m->frame, b, component), low, high) == k % SHADES)
        stroke_bond(c, m, b);
    cairo_stroke(c->cr);
  }
}

static void draw_head(canvas *c, const map *m) {
  char text[256], when[64];
  if (m->frame.increment < 0)
    snprintf(when, sizeof when, "t = %.5g ms", 1e3 * m->frame.time);
  else
    snprintf(when, sizeof when, "increment %ld", m->frame.increment);
  snprintf(text, sizeof text, "%s%s, displacements x %.6g", m->frame.view, when, m->frame.factor);
  double right = canvas_text_width(c, 19, text);
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  canvas_text_within(c, MARGIN, 40, 24, WIDTH - 2 * MARGIN - right - 30, m->frame.title);
  canvas_text(c, WIDTH - MARGIN, 40, 19, ANCHOR_RIGHT, text);
}

/* Arms of one length along x, y and z, as the body is seen; those toward the eye are left out. */
static void draw_axes(canvas *c, const map *m) {
  enum { ARM = 44 };
  const double x = MARGIN + 6, y = m->height - FOOT - 14;
  if (m->frame.dimensions != 3) return;
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  for (int k = 0; k < 3; k++) {
    const double across = m->frame.axes[k][0], up = m->frame.axes[k][1];
    if (pl_hypot(across, up) < 0.1) continue;
    canvas_line(c, x, y, x + ARM * across, y - ARM * up, 2);
    canvas_text(c, x + (ARM + 12) * across, y - (ARM + 12) * up + 6, 18, ANCHOR_CENTRE,
                (char[]){"xyz"[k], 0});
  }
  canvas_text(c, x + 96, y, 18, ANCHOR_LEFT, m->frame.extents);
}

static void draw_scale_bar(canvas *c, const map *m) {
  double length = nice_step((WIDTH - 2 * MARGIN) / m->scale, 6), y = m->height - 34;
  char text[64];
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  canvas_line(c, MARGIN, y, MARGIN + length * m->scale, y, 3);
  snprintf(text, sizeof text, "%.6g mm", 1e3 * length);
  canvas_text(c, MARGIN, y + 24, 18, ANCHOR_LEFT, text);
}

/* The classes that occur. */
static void draw_damage_legend(canvas *c, const map *m) {
  double x = WIDTH - MARGIN, y = m->height - 30;
  bool occurs[CLASSES] = {m->frame.bonds == 0};
  for (long b = 0; b < m->frame.bonds; b++)
    occurs[class_of_bond(m, b)] = true;
  for (long p = 0; m->frame.of_damage && m->frame.values && p < m->frame.value_count; p++)
    occurs[class_of(m->frame.values[p])] = true;
  for (int k = CLASSES - 1; k >= 0; k--) {
    if (!occurs[k]) continue;
    x -= canvas_text_width(c, 18, classes[k].text);
    canvas_colour(c, (colour){0.1, 0.1, 0.1});
    canvas_text(c, x, y, 18, ANCHOR_LEFT, classes[k].text);
    x -= 36;
    canvas_colour(c, classes[k].ink);
    canvas_line(c, x, y - 6, x + 28, y - 6, k == 0 ? 4 : 5);
    x -= 22;
  }
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  canvas_text(c, x, y, 18, ANCHOR_RIGHT, m->frame.damage_of);
}

static void draw_value_legend(canvas *c, const map *m, const plot_map_options *o, double low,
                              double high) {
  double width = 360, x = WIDTH - MARGIN - width, y = m->height - 50, factor;
  for (int k = 0; k < 180; k++) {
    canvas_colour(c, shade(k / 179.0));
    cairo_rectangle(c->cr, x + 2 * k, y, 2.5, 14);
    cairo_fill(c->cr);
  }
  const char *shown = readable_unit(m->frame.unit_text, pl_fmax(fabs(low), fabs(high)), &factor);
  char text[256];
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  snprintf(text, sizeof text, "%.4g", low * factor);
  canvas_text(c, x, y + 34, 18, ANCHOR_LEFT, text);
  snprintf(text, sizeof text, "%.4g", high * factor);
  canvas_text(c, x + width, y + 34, 18, ANCHOR_RIGHT, text);
  const char *part = m->frame.components == 1 ? ""
                     : o->component == 0      ? " x"
                     : o->component == 1      ? " y"
                     : o->component == 2      ? " z"
                                              : " (size)";
  const bool pure = strcmp(shown, "1") == 0;
  snprintf(text, sizeof text, "%s%s%s%s%s", o->field, part, pure ? "" : " [", pure ? "" : shown,
           pure ? "" : "]");
  canvas_text(c, x - 14, y + 13, 18, ANCHOR_RIGHT, text);
}

/* Least and largest value that is drawn; false when none is a number. */
static bool range_of(const map *m, int component, double *low, double *high) {
  *low = INFINITY;
  *high = -INFINITY;
  for (long k = 0; k < m->frame.value_count; k++) {
    const double v = plot_frame_value(&m->frame, k, component);
    if (!isfinite(v)) continue;
    *low = pl_fmin(*low, v);
    *high = pl_fmax(*high, v);
  }
  return *low <= *high;
}

static void draw_crack_legend(canvas *c, const map *m) {
  const double x = MARGIN + 300, y = m->height - 34;
  bool any = false;
  for (long b = 0; b < m->frame.bonds; b++)
    any = any || is_separated(m, b);
  if (!any) return;
  canvas_colour(c, classes[SEPARATED].ink);
  canvas_line(c, x, y, x + 28, y, 5);
  canvas_text(c, x + 36, y + 6, 18, ANCHOR_LEFT, classes[SEPARATED].text);
}

static void draw_field(canvas *c, const map *m, const plot_map_options *o, double low,
                       double high) {
  if (m->frame.of_bonds) draw_bond_values(c, m, o->component, low, high);
  draw_particles(c, m, o->component, low, high);
  if (m->frame.damage) draw_bonds(c, m, false);
  draw_crack_legend(c, m);
  draw_value_legend(c, m, o, low, high);
}

static bool draw_map(map *m, const plot_map_options *o, char *error, size_t size) {
  double low = 0, high = 0;
  if (!fit_picture(m, error, size)) return false;
  const bool measured = m->frame.values && !m->frame.of_damage;
  if (measured && !range_of(m, o->component, &low, &high)) {
    snprintf(error, size, "`%s` holds no finite value to draw", o->field);
    return false;
  }
  canvas c;
  if (!canvas_open(&c, o->output, WIDTH, m->height, error, size)) return false;
  draw_head(&c, m);
  draw_scale_bar(&c, m);
  draw_axes(&c, m);
  if (measured) {
    draw_field(&c, m, o, low, high);
  } else {
    if (m->frame.damage) draw_bonds(&c, m, true); /* damage of particles says nothing of bonds */
    draw_particles(&c, m, o->component, low, high);
    draw_damage_legend(&c, m);
  }
  return canvas_close(&c, error, size);
}

bool plot_map(const char *path, const plot_map_options *o, char *error, size_t size) {
  map m = {.scale = 1};
  const bool good = plot_frame_read(&m.frame, path, o, error, size) && draw_map(&m, o, error, size);
  plot_frame_free(&m.frame);
  return good;
}
