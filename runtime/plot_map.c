/* Map of one 2D frame: bonds and particles where they have moved to. Damage is shown in the classes of Asadollahi
   (2014, table 4.3): up to 0.3 yellow, 0.6 orange, 0.8 brown, below 1 red; separated bonds as black crack lines. Other
   fields colour the particles or the bonds by their value. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/arena.h"
#include "runtime/canvas.h"
#include "runtime/plot.h"
#include "runtime/result.h"

enum { WIDTH = 1500, MARGIN = 40, HEAD = 64, FOOT = 84, LEAST_HEIGHT = 300, MOST_HEIGHT = 1500 };

static const struct {
  double up_to;
  colour ink;
  const char *text;
} classes[] = {{0.0, {0.80, 0.82, 0.85}, "sound"},     {0.3, {0.95, 0.80, 0.10}, "0 - 0.3"},
               {0.6, {0.95, 0.50, 0.05}, "0.3 - 0.6"}, {0.8, {0.55, 0.30, 0.10}, "0.6 - 0.8"},
               {1.0, {0.85, 0.05, 0.05}, "0.8 - 1"},   {INFINITY, {0, 0, 0}, "separated"}};
enum { CLASSES = sizeof classes / sizeof *classes, SEPARATED = CLASSES - 1 };

typedef struct map {
  long particles, bonds;
  double *reference, *moved, *damage; /* damage: per bond, NULL without */
  int32_t *pairs;
  double *values; /* of the particles, or of the bonds; NULL: a map of damage */
  long value_count;
  bool of_bonds;
  int components;
  char unit_text[64], title[512];
  double time, factor, spacing;
  double left, bottom, scale, height; /* picture: x = MARGIN + (X - left) * scale */
} map;

static void map_free(map *m) {
  free(m->reference);
  free(m->moved);
  free(m->values);
  free(m->damage);
  free(m->pairs);
}

static double bond_length(const map *m, long b) {
  const double *i = &m->reference[2 * m->pairs[2 * b]], *j = &m->reference[2 * m->pairs[2 * b + 1]];
  return hypot(j[0] - i[0], j[1] - i[1]);
}

/* Displacements times factor; a factor is chosen so that the largest relative one is a twentieth of the body. */
static void move_particles(map *m, const double *displacement, double wanted) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, mean[2] = {0, 0},
         largest = 0;
  for (long p = 0; p < m->particles; p++)
    for (int c = 0; c < 2; c++) {
      low[c] = fmin(low[c], m->reference[2 * p + c]);
      high[c] = fmax(high[c], m->reference[2 * p + c]);
      mean[c] += displacement[2 * p + c] / (double)m->particles;
    }
  for (long p = 0; p < 2 * m->particles; p++)
    largest = fmax(largest, fabs(displacement[p] - mean[p % 2]));
  m->factor = wanted;
  if (wanted < 0) {
    double raw = largest > 0 ? 0.05 * fmax(high[0] - low[0], high[1] - low[1]) / largest : 1;
    m->factor = raw < 1 ? 1 : fmin(nice_step(raw, 1), 1e4);
  }
  m->moved = must_calloc((size_t)m->particles * 2 + 1, sizeof *m->moved);
  for (long p = 0; p < 2 * m->particles; p++)
    m->moved[p] = m->reference[p] + m->factor * displacement[p];
}

static bool read_values(result_file *f, map *m, const plot_map_options *o, char *error,
                        size_t size) {
  char name[512];
  if (!result_find(f, "/frames", o->field, name, sizeof name, error, size)) return false;
  m->values = result_read_frame(f, name, o->frame, &m->value_count, &m->components, m->unit_text,
                                sizeof m->unit_text, error, size);
  if (!m->values) return false;
  m->of_bonds = strchr(name, '/') != NULL;
  if (m->value_count != (m->of_bonds ? m->bonds : m->particles)) {
    snprintf(error, size, "`%s` does not have a value for each %s", name,
             m->of_bonds ? "bond" : "particle");
    return false;
  }
  if (o->component >= m->components) {
    snprintf(error, size, "`%s` has %d component%s, numbered from 0; there is no component %d",
             o->field, m->components, m->components == 1 ? "" : "s", o->component);
    return false;
  }
  return true;
}

/* Maps of other fields show separated bonds, too, where the result knows them. */
static bool read_damage(result_file *f, map *m, const char *path, const plot_map_options *o,
                        char *error, size_t size) {
  long count = 0;
  m->damage = result_read_damage(f, o->frame, &count, error, size);
  if (m->damage && count == m->bonds) return true;
  free(m->damage);
  m->damage = NULL;
  if (strcmp(o->field, "damage") != 0) return true;
  if (!error[0])
    snprintf(error, size,
             "`%s` holds no damage of bonds: write fields = 'displacement', 'damage' in &output "
             "and run again "
             "(a law without a damage has none to store)",
             path);
  return false;
}

/* NULL with a sentence that says how to store them when they are not there. */
static double *read_displacements(result_file *f, const map *m, const char *path, long frame,
                                  char *error, size_t size) {
  char unit_text[64];
  long count = 0;
  int components = 0;
  result_names fields = result_members(f, "/frames");
  const bool stored = result_names_find(&fields, "displacement") >= 0;
  result_names_free(&fields);
  if (!stored) {
    snprintf(error, size,
             "a map needs displacements, and `%s` holds none: add 'displacement' to `fields` in "
             "&output and run again",
             path);
    return NULL;
  }
  double *u = result_read_frame(f, "displacement", frame, &count, &components, unit_text,
                                sizeof unit_text, error, size);
  if (u && count == m->particles && components == 2) return u;
  if (u) snprintf(error, size, "the displacements in `%s` are not those of its particles", path);
  free(u);
  return NULL;
}

static bool read_map(result_file *f, const char *path, map *m, const plot_map_options *o,
                     char *error, size_t size) {
  m->reference = result_read_reference(f, &m->particles);
  m->pairs = result_read_bonds(f, NULL, &m->bonds);
  if (!m->reference || !m->pairs || m->particles == 0) {
    snprintf(error, size, "`%s` holds no lattice (particles and bonds) to draw", path);
    return false;
  }
  double *u = read_displacements(f, m, path, o->frame, error, size);
  if (!u) return false;
  move_particles(m, u, o->factor);
  free(u);
  long frames = 0;
  double *times = result_read_frame_times(f, &frames);
  long k = o->frame < 0 ? frames + o->frame : o->frame;
  m->time = times && k >= 0 && k < frames ? times[k] : NAN;
  free(times);
  for (long b = 0; b < m->bonds; b++)
    m->spacing = b == 0 ? bond_length(m, 0) : fmin(m->spacing, bond_length(m, b));
  char *title = result_read_title(f);
  snprintf(m->title, sizeof m->title, "%s", o->title ? o->title : title);
  free(title);
  return read_damage(f, m, path, o, error, size) &&
         (strcmp(o->field, "damage") == 0 || read_values(f, m, o, error, size));
}

/* --- drawing ---------------------------------------------------------------------------------- */

static bool fit_picture(map *m, char *error, size_t size) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (long p = 0; p < m->particles; p++)
    for (int c = 0; c < 2; c++) {
      low[c] = fmin(low[c], m->moved[2 * p + c] - m->spacing);
      high[c] = fmax(high[c], m->moved[2 * p + c] + m->spacing);
    }
  if (!(high[0] - low[0] < 1e12) || !(high[1] - low[1] < 1e12) || !(high[0] > low[0])) {
    snprintf(error, size, "the frame's displacements are not finite or too large to draw");
    return false;
  }
  m->scale = fmin((WIDTH - 2 * MARGIN) / (high[0] - low[0]),
                  (MOST_HEIGHT - HEAD - FOOT) / (high[1] - low[1]));
  m->left = low[0] - ((WIDTH - 2 * MARGIN) / m->scale - (high[0] - low[0])) / 2;
  m->height = fmax(LEAST_HEIGHT, HEAD + FOOT + (high[1] - low[1]) * m->scale);
  m->bottom = low[1];
  return true;
}

static double at_x(const map *m, double x) {
  return MARGIN + (x - m->left) * m->scale;
}
static double at_y(const map *m, double y) {
  return m->height - FOOT - (y - m->bottom) * m->scale;
}

static int class_of(double damage) {
  if (damage >= 1) return SEPARATED;
  int k = 0;
  while (k < SEPARATED - 1 && damage > classes[k].up_to)
    k++;
  return k;
}

static int class_of_bond(const map *m, long b) {
  return m->damage ? class_of(m->damage[b]) : 0;
}

static void stroke_bond(canvas *c, const map *m, long b) {
  const double *i = &m->moved[2 * m->pairs[2 * b]], *j = &m->moved[2 * m->pairs[2 * b + 1]];
  cairo_move_to(c->cr, at_x(m, i[0]), at_y(m, i[1]));
  cairo_line_to(c->cr, at_x(m, j[0]), at_y(m, j[1]));
}

/* A separated bond: the edge between the two particles' cells, across the middle of the bond. */
static void stroke_crack(canvas *c, const map *m, long b) {
  const double *i = &m->moved[2 * m->pairs[2 * b]], *j = &m->moved[2 * m->pairs[2 * b + 1]];
  double x = (i[0] + j[0]) / 2, y = (i[1] + j[1]) / 2, dx = j[0] - i[0], dy = j[1] - i[1];
  double half = 0.5 / sqrt(3) * m->spacing / fmax(hypot(dx, dy), 1e-300);
  cairo_move_to(c->cr, at_x(m, x - dy * half), at_y(m, y + dx * half));
  cairo_line_to(c->cr, at_x(m, x + dy * half), at_y(m, y - dx * half));
}

static void draw_bonds(canvas *c, const map *m, bool coloured) {
  double thin = fmax(0.4, 0.12 * m->spacing * m->scale);
  for (int k = 0; k < CLASSES; k++) { /* the worse above the better */
    if (!coloured && k != SEPARATED) continue;
    canvas_colour(c, classes[k].ink);
    cairo_set_line_width(c->cr, k == 0 ? 0.6 * thin : k == SEPARATED ? 1.6 * thin : 1.4 * thin);
    cairo_set_line_cap(c->cr, CAIRO_LINE_CAP_ROUND);
    for (long b = 0; b < m->bonds; b++) {
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
  double at = fmin(fmax(v, 0), 1) * 4;
  int k = at >= 4 ? 3 : (int)at;
  double w = at - k;
  return (colour){stops[k].r + w * (stops[k + 1].r - stops[k].r),
                  stops[k].g + w * (stops[k + 1].g - stops[k].g),
                  stops[k].b + w * (stops[k + 1].b - stops[k].b)};
}

static double value_of(const map *m, long k, int component) {
  const double *v = &m->values[k * m->components];
  if (component >= 0 || m->components == 1) return v[component >= 0 ? component : 0];
  double sum = 0;
  for (int c = 0; c < m->components; c++)
    sum += v[c] * v[c];
  return sqrt(sum);
}

/* Place in the colour bar, 0 to 1; what is no number stands with the lowest. */
static double place_of(double value, double low, double high) {
  return high > low ? fmin(fmax((value - low) / (high - low), 0), 1) : 0;
}

static void draw_particles(canvas *c, const map *m, int component, double low, double high) {
  const bool coloured = m->values && !m->of_bonds;
  double radius = fmax(0.7, (coloured ? 0.5 : 0.1) * m->spacing * m->scale);
  for (long p = 0; p < m->particles; p++) {
    canvas_colour(c, coloured ? shade(place_of(value_of(m, p, component), low, high))
                              : (colour){0.45, 0.48, 0.52});
    cairo_arc(c->cr, at_x(m, m->moved[2 * p]), at_y(m, m->moved[2 * p + 1]), radius, 0, 2 * M_PI);
    cairo_fill(c->cr);
  }
}

static bool is_separated(const map *m, long b) {
  return m->damage && m->damage[b] >= 1;
}

enum { SHADES = 64 };
static int shade_of(double value, double low, double high) {
  return (int)fmin(SHADES * place_of(value, low, high), SHADES - 1);
}

/* Bonds by their value, higher ones above lower ones; separated ones as thin lines across their crack. */
static void draw_bond_values(canvas *c, const map *m, int component, double low, double high) {
  const double wide = fmax(0.8, 0.22 * m->spacing * m->scale);
  cairo_set_line_cap(c->cr, CAIRO_LINE_CAP_ROUND);
  for (int k = 0; k < 2 * SHADES; k++) {
    const bool separated = k < SHADES;
    canvas_colour(c, shade((k % SHADES + 0.5) / SHADES));
    cairo_set_line_width(c->cr, separated ? 0.3 * wide : wide);
    for (long b = 0; b < m->bonds; b++)
      if (is_separated(m, b) == separated &&
          shade_of(value_of(m, b, component), low, high) == k % SHADES)
        stroke_bond(c, m, b);
    cairo_stroke(c->cr);
  }
}

static void draw_head(canvas *c, const map *m) {
  char text[256];
  snprintf(text, sizeof text, "t = %.5g ms, displacements x %.6g", 1e3 * m->time, m->factor);
  double right = canvas_text_width(c, 19, text);
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  canvas_text_within(c, MARGIN, 40, 24, WIDTH - 2 * MARGIN - right - 30, m->title);
  canvas_text(c, WIDTH - MARGIN, 40, 19, ANCHOR_RIGHT, text);
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
  bool occurs[CLASSES] = {m->bonds == 0};
  for (long b = 0; b < m->bonds; b++)
    occurs[class_of_bond(m, b)] = true;
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
  canvas_text(c, x, y, 18, ANCHOR_RIGHT, "damage of bonds:");
}

static void draw_value_legend(canvas *c, const map *m, const plot_map_options *o, double low,
                              double high) {
  double width = 360, x = WIDTH - MARGIN - width, y = m->height - 50, factor;
  for (int k = 0; k < 180; k++) {
    canvas_colour(c, shade(k / 179.0));
    cairo_rectangle(c->cr, x + 2 * k, y, 2.5, 14);
    cairo_fill(c->cr);
  }
  const char *shown = readable_unit(m->unit_text, fmax(fabs(low), fabs(high)), &factor);
  char text[256];
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  snprintf(text, sizeof text, "%.4g", low * factor);
  canvas_text(c, x, y + 34, 18, ANCHOR_LEFT, text);
  snprintf(text, sizeof text, "%.4g", high * factor);
  canvas_text(c, x + width, y + 34, 18, ANCHOR_RIGHT, text);
  const char *part = m->components == 1  ? ""
                     : o->component == 0 ? " x"
                     : o->component == 1 ? " y"
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
  for (long k = 0; k < m->value_count; k++) {
    const double v = value_of(m, k, component);
    if (!isfinite(v)) continue;
    *low = fmin(*low, v);
    *high = fmax(*high, v);
  }
  return *low <= *high;
}

static void draw_crack_legend(canvas *c, const map *m) {
  const double x = MARGIN + 300, y = m->height - 34;
  bool any = false;
  for (long b = 0; b < m->bonds; b++)
    any = any || is_separated(m, b);
  if (!any) return;
  canvas_colour(c, classes[SEPARATED].ink);
  canvas_line(c, x, y, x + 28, y, 5);
  canvas_text(c, x + 36, y + 6, 18, ANCHOR_LEFT, classes[SEPARATED].text);
}

static void draw_field(canvas *c, const map *m, const plot_map_options *o, double low,
                       double high) {
  if (m->of_bonds) draw_bond_values(c, m, o->component, low, high);
  draw_particles(c, m, o->component, low, high);
  if (m->damage) draw_bonds(c, m, false);
  draw_crack_legend(c, m);
  draw_value_legend(c, m, o, low, high);
}

static bool draw_map(map *m, const plot_map_options *o, char *error, size_t size) {
  double low = 0, high = 0;
  if (!fit_picture(m, error, size)) return false;
  if (m->values && !range_of(m, o->component, &low, &high)) {
    snprintf(error, size, "`%s` holds no finite value to draw", o->field);
    return false;
  }
  canvas c;
  if (!canvas_open(&c, o->output, WIDTH, m->height, error, size)) return false;
  draw_head(&c, m);
  draw_scale_bar(&c, m);
  if (m->values) {
    draw_field(&c, m, o, low, high);
  } else {
    draw_bonds(&c, m, true);
    draw_particles(&c, m, o->component, low, high);
    draw_damage_legend(&c, m);
  }
  return canvas_close(&c, error, size);
}

bool plot_map(const char *path, const plot_map_options *o, char *error, size_t size) {
  result_file *f = result_read(path, error, size);
  if (!f) return false;
  map m = {.particles = 0};
  bool good = read_map(f, path, &m, o, error, size);
  result_read_close(f);
  good = good && draw_map(&m, o, error, size);
  map_free(&m);
  return good;
}
