/* Map of one frame, or of several side by side: bonds and particles where they have moved to.
   Damage is shown in the classes of damage_classes.h; separated bonds as black crack lines. Two
   damages are shown in two colours each, as Gerstle et al. (2013, figure 5) do. Other fields colour
   the particles or the bonds by their value. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/quantity.h"
#include "runtime/plot/canvas.h"
#include "runtime/plot/colour_scale.h"
#include "runtime/plot/damage_classes.h"
#include "runtime/plot/plot_cells.h"
#include "runtime/plot/plot_frame.h"
#include "runtime/plot/plot_map.h"

enum {
  WIDTH = 1500,
  MARGIN = 40,
  HEAD = 64,
  FOOT = 84,
  AXES = 76,  /* above the foot: the axes of a body in space */
  LINES = 20, /* above the foot: samples of cracks */
  GAP = 28,   /* between panels */
  CAPTION = 30,
  LEAST_HEIGHT = 300,
  MOST_HEIGHT = 1500
};

enum { CLASSES = DAMAGE_CLASSES, KINDS = 5, SEPARATED = CLASSES - 1 };
static const damage_class kinds[KINDS] = {{0.0, {0.80, 0.82, 0.85}, "sound", 0},
                                          {1.0, {0.95, 0.80, 0.10}, " below 1", 0},
                                          {1.0, {0.35, 0.70, 0.95}, " below 1", 1},
                                          {INFINITY, {0.05, 0.20, 0.65}, " = 1", 1},
                                          {INFINITY, {0, 0, 0}, " = 1", 0}};
enum { NO_CLASS = -1 };

/* Bonds of laws without damage, as of bars. */
static const colour plain_ink = {0.45, 0.48, 0.52};

static const colour mark_ink = {0.05, 0.25, 0.80};

typedef struct map { /* a panel */
  plot_frame frame;
  map_place at;
  char caption[128];
} map;

typedef struct sheet {
  map *panels;
  int count, columns;
  double low[2], high[2];       /* what all panels show, m */
  double scale, height, foot;   /* of the picture, below the panels */
  double caption;               /* above each panel; 0: a single one has none */
  double least, most;           /* of the values that have colours */
  double levels[CONTOURS_MOST]; /* [level_count] lines of equal value; none: filled cells */
  int level_count;
} sheet;

/* --- drawing ---------------------------------------------------------------------------------- */

/* Beside the bodies no more than a fifth of them. */
static void add_stamps(sheet *s) {
  const double most = 0.2 * pl_fmax(s->high[0] - s->low[0], s->high[1] - s->low[1]);
  double low[2], high[2];
  for (int c = 0; c < 2; c++) {
    low[c] = s->low[c];
    high[c] = s->high[c];
  }
  for (int k = 0; k < s->count; k++)
    plot_stamps_reach(&s->panels[k].frame.stamps, s->panels[k].frame.factor, low, high);
  for (int c = 0; c < 2; c++) {
    const double line = low[c] < s->low[c] || high[c] > s->high[c] ? 0.02 * most : 0;
    s->low[c] = pl_fmax(low[c] - line, s->low[c] - most);
    s->high[c] = pl_fmin(high[c] + line, s->high[c] + most);
  }
}

static void add_extent(const plot_frame *f, sheet *s) {
  for (long p = 0; p < f->particles; p++)
    for (int c = 0; c < 2; c++) {
      s->low[c] = pl_fmin(s->low[c], f->moved[2 * p + c] - f->spacing);
      s->high[c] = pl_fmax(s->high[c], f->moved[2 * p + c] + f->spacing);
    }
}

static int rows_of(const sheet *s, int columns) {
  return (s->count + columns - 1) / columns;
}

/* Pixels a metre with so many columns. */
static double scale_with(const sheet *s, int columns) {
  const int rows = rows_of(s, columns);
  const double width = (WIDTH - 2 * MARGIN - (columns - 1) * GAP) / (double)columns,
               height = (MOST_HEIGHT - HEAD - s->foot - (rows - 1) * GAP) / rows - s->caption;
  return pl_fmin(width / (s->high[0] - s->low[0]), height / (s->high[1] - s->low[1]));
}

/* As many columns as let the panels be largest, or nearly so; each in the middle of its part of the
   picture. */
static void place_panels(sheet *s) {
  for (int columns = 1; columns <= s->count; columns++) {
    const double scale = scale_with(s, columns);
    if (columns > 1 && scale < 0.95 * s->scale) continue;
    s->scale = scale;
    s->columns = columns;
  }
  const int rows = rows_of(s, s->columns);
  const double high = (s->high[1] - s->low[1]) * s->scale + s->caption,
               part = (WIDTH - 2 * MARGIN + GAP) / (double)s->columns - GAP,
               indent = (part - (s->high[0] - s->low[0]) * s->scale) / 2;
  s->height = pl_fmax(LEAST_HEIGHT, HEAD + s->foot + rows * high + (rows - 1) * GAP);
  for (int k = 0; k < s->count; k++) {
    map *m = &s->panels[k];
    const int column = k % s->columns, below = rows - 1 - k / s->columns;
    m->at = (map_place){.left = s->low[0],
                        .bottom = s->low[1],
                        .scale = s->scale,
                        .origin_x = MARGIN + column * (part + GAP) + indent,
                        .origin_y = s->height - s->foot - below * (high + GAP)};
  }
}

static bool fit_picture(sheet *s, char *error, size_t size) {
  for (int c = 0; c < 2; c++) {
    s->low[c] = INFINITY;
    s->high[c] = -INFINITY;
  }
  for (int k = 0; k < s->count; k++)
    add_extent(&s->panels[k].frame, s);
  add_stamps(s);
  if (!(s->high[0] - s->low[0] < 1e12) || !(s->high[1] - s->low[1] < 1e12) ||
      !(s->high[0] > s->low[0])) {
    snprintf(error, size, "the frame's displacements are not finite or too large to draw");
    return false;
  }
  s->foot = FOOT + (s->panels[0].frame.dimensions == 3 ? AXES : 0) +
            (s->panels[0].frame.meshes.crack_count > 0 ? LINES : 0);
  s->caption = s->count > 1 ? CAPTION : 0;
  place_panels(s);
  return true;
}

static double at_x(const map *m, double x) {
  return m->at.origin_x + (x - m->at.left) * m->at.scale;
}
static double at_y(const map *m, double y) {
  return m->at.origin_y - (y - m->at.bottom) * m->at.scale;
}

static const damage_class *classes_of(const map *m) {
  return m->frame.second ? kinds : damage_classes;
}
static int class_count(const map *m) {
  return m->frame.second ? KINDS : CLASSES;
}

/* In the table of the map. */
static int class_of_bond(const map *m, long b) {
  if (!m->frame.damage) return 0;
  const double damage = m->frame.damage[b];
  if (isnan(damage)) return NO_CLASS;
  if (!m->frame.second) return damage_class_of(damage);
  if (!(damage > 0)) return 0;
  const bool second = m->frame.second[b] > 0;
  return damage >= 1 ? second ? KINDS - 2 : KINDS - 1 : second ? 2 : 1;
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

static void draw_class(canvas *c, const map *m, int k) {
  const double thin = pl_fmax(0.4, 0.12 * m->frame.spacing * m->at.scale);
  const int separated = class_count(m) - 1;
  canvas_colour(c, k == NO_CLASS ? plain_ink : classes_of(m)[k].ink);
  cairo_set_line_width(c->cr, k == 0 ? 0.6 * thin : k == separated ? 1.6 * thin : 1.4 * thin);
  cairo_set_line_cap(c->cr, CAIRO_LINE_CAP_ROUND);
  for (long b = 0; b < m->frame.bonds; b++) {
    if (class_of_bond(m, b) != k) continue;
    if (k == separated)
      stroke_crack(c, m, b);
    else
      stroke_bond(c, m, b);
  }
  cairo_stroke(c->cr);
}

/* The worse above the better, what has no damage between. */
static void draw_bonds(canvas *c, const map *m, bool coloured) {
  if (coloured) {
    draw_class(c, m, 0);
    draw_class(c, m, NO_CLASS);
  }
  const int separated = class_count(m) - 1;
  for (int k = coloured ? 1 : separated; k <= separated; k++)
    draw_class(c, m, k);
}

static colour particle_colour(const map *m, long p, int component, double low, double high) {
  const double value = plot_frame_value(&m->frame, p, component);
  if (m->frame.of_damage) return damage_classes[damage_class_of(value)].ink;
  return isnan(value) ? scale_no_value : scale_colour(scale_part(value, low, high));
}

static void draw_particle(canvas *c, const map *m, long p, colour ink, double radius, bool edge) {
  canvas_colour(c, ink);
  cairo_arc(c->cr, at_x(m, m->frame.moved[2 * p]), at_y(m, m->frame.moved[2 * p + 1]), radius, 0,
            2 * M_PI);
  cairo_fill_preserve(c->cr);
  if (edge) {
    canvas_colour(c, (colour){0.25, 0.25, 0.28});
    cairo_set_line_width(c->cr, pl_fmin(0.08 * radius, 1.5));
    cairo_stroke(c->cr);
  }
  cairo_new_path(c->cr);
}

/* A particle that is seen in a view of a surface, but has no value. */
static bool is_dot(const map *m, long p, int component) {
  return m->frame.surface && isnan(plot_frame_value(&m->frame, p, component));
}

static double half_spacing(const map *m, long p) {
  return 0.5 * m->at.scale * plot_frame_spacing(&m->frame, p);
}

/* In the plane the more damaged above the less damaged; in a view of a surface those in front above
   those behind, each with an edge to stand out by, above dots, so that nothing hides a bar
   inside. */
static void draw_particles(canvas *c, const map *m, int component, double low, double high) {
  enum { DOTS, BALLS, PASSES };
  const bool coloured = m->frame.values && !m->frame.of_bonds;
  const unsigned char *nodes = m->frame.nodes; /* cells show their values */
  const bool by_class = coloured && m->frame.of_damage && !m->frame.surface;
  cairo_new_path(c->cr);
  for (int k = 0; k < (by_class ? CLASSES : PASSES); k++)
    for (long p = 0; p < m->frame.particles; p++) {
      const bool ball = coloured && !is_dot(m, p, component);
      if (nodes && nodes[p]) continue;
      if ((by_class ? damage_class_of(m->frame.values[p]) : ball ? BALLS : DOTS) != k) continue;
      draw_particle(c, m, p, coloured ? particle_colour(m, p, component, low, high) : plain_ink,
                    pl_fmax(0.7, (ball ? 1 : 0.2) * half_spacing(m, p)), ball && m->frame.surface);
    }
}

static bool is_separated(const map *m, long b) {
  return m->frame.damage && m->frame.damage[b] >= 1;
}

/* Those of one shade, separated or not. */
static void draw_bonds_of(canvas *c, const map *m, int component, double low, double high,
                          int wanted, bool separated) {
  for (long b = 0; b < m->frame.bonds; b++)
    if (is_separated(m, b) == separated &&
        scale_step(plot_frame_value(&m->frame, b, component), low, high, SCALE_STEPS) == wanted)
      stroke_bond(c, m, b);
  cairo_stroke(c->cr);
}

/* Bonds by their value, higher ones above lower ones; separated ones as thin lines across their
   crack. */
static void draw_bond_values(canvas *c, const map *m, int component, double low, double high) {
  const double wide = pl_fmax(0.8, 0.22 * m->frame.spacing * m->at.scale);
  cairo_set_line_cap(c->cr, CAIRO_LINE_CAP_ROUND);
  cairo_set_line_width(c->cr, 0.3 * wide);
  canvas_colour(c, scale_no_value);
  draw_bonds_of(c, m, component, low, high, -1, false);
  for (int k = 0; k < 2 * SCALE_STEPS; k++) {
    const bool separated = k < SCALE_STEPS;
    canvas_colour(c, scale_colour((k % SCALE_STEPS + 0.5) / SCALE_STEPS));
    cairo_set_line_width(c->cr, separated ? 0.3 * wide : wide);
    draw_bonds_of(c, m, component, low, high, k % SCALE_STEPS, separated);
  }
}

/* --- meshes ----------------------------------------------------------------------------------- */

/* Cells, their outline and their cracks; cells without values, too. */
static void draw_meshes(canvas *c, const map *m, const sheet *s, int component) {
  const plot_frame *f = &m->frame;
  double *values = NULL;
  if (f->meshes.count == 0) return;
  if (f->values && !f->of_bonds) values = must_calloc((size_t)f->particles + 1, sizeof *values);
  for (long p = 0; values && p < f->particles; p++)
    values[p] = plot_frame_value(f, p, component);
  const mesh_view v = {f->reference, f->moved, values, f->of_cells};
  if (values && s->level_count > 0)
    plot_cells_contours(c, &f->meshes, &v, &m->at, s->levels, s->level_count);
  else if (values)
    plot_cells_fill(c, &f->meshes, &v, &m->at, s->least, s->most);
  plot_cells_outline(c, &f->meshes, &v, &m->at);
  plot_cells_cracks(c, &f->meshes, &v, &m->at);
  free(values);
}

/* --- marks ------------------------------------------------------------------------------------ */

static void draw_mark(canvas *c, double x, double y, double radius) {
  cairo_new_path(c->cr);
  cairo_arc(c->cr, x, y, radius, 0, 2 * M_PI);
  canvas_colour(c, mark_ink);
  cairo_fill_preserve(c->cr);
  canvas_colour(c, (colour){1, 1, 1});
  cairo_set_line_width(c->cr, pl_fmax(0.5, 0.25 * radius));
  cairo_stroke(c->cr);
}

/* On particles, or on the middle of bonds. */
static void draw_marks(canvas *c, const map *m) {
  const double radius = pl_fmax(1.6, 0.22 * m->frame.spacing * m->at.scale);
  const long count = m->frame.marks_on_bonds ? m->frame.bonds : m->frame.particles;
  for (long k = 0; m->frame.marked && k < count; k++) {
    if (!(m->frame.marked[k] > 0)) continue;
    const int32_t *ends = &m->frame.pairs[2 * k];
    const double *i = &m->frame.moved[2 * (m->frame.marks_on_bonds ? ends[0] : k)],
                 *j = &m->frame.moved[2 * (m->frame.marks_on_bonds ? ends[1] : k)];
    draw_mark(c, at_x(m, (i[0] + j[0]) / 2), at_y(m, (i[1] + j[1]) / 2), radius);
  }
}

static bool has_mark(const map *m) {
  const long count = m->frame.marks_on_bonds ? m->frame.bonds : m->frame.particles;
  for (long k = 0; m->frame.marked && k < count; k++)
    if (m->frame.marked[k] > 0) return true;
  return false;
}

static void draw_mark_legend(canvas *c, const sheet *s, const char *mark) {
  const double x = MARGIN + 300, y = s->height - 64;
  char text[256];
  bool any = false;
  for (int k = 0; k < s->count; k++)
    any = any || has_mark(&s->panels[k]);
  if (!mark) return;
  snprintf(text, sizeof text, "%.200s%s", mark, any ? "" : ": nowhere");
  draw_mark(c, x + 14, y, 7);
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  canvas_text(c, x + 36, y + 6, 18, ANCHOR_LEFT, text);
}

/* --- head and foot ---------------------------------------------------------------------------- */

static void say_when(const plot_frame *f, char *text, size_t size) {
  char shown[TIME_TEXT];
  if (!isnan(f->frequency))
    snprintf(text, size, "mode %.0f: %.5g Hz", f->time, f->frequency);
  else if (f->increment < 0)
    snprintf(text, size, "t = %s", time_text(f->time, 5, shown));
  else
    snprintf(text, size, "increment %ld", f->increment);
}

static void draw_head(canvas *c, const sheet *s) {
  const plot_frame *f = &s->panels[0].frame;
  char text[256], when[64];
  say_when(f, when, sizeof when);
  snprintf(text, sizeof text, "%s%s%sdisplacements x %.6g", f->view, s->count > 1 ? "" : when,
           s->count > 1 ? "" : ", ", f->factor);
  double right = canvas_text_width(c, 19, text);
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  canvas_text_within(c, MARGIN, 40, 24, WIDTH - 2 * MARGIN - right - 30, f->title);
  canvas_text(c, WIDTH - MARGIN, 40, 19, ANCHOR_RIGHT, text);
}

static void draw_captions(canvas *c, const sheet *s) {
  const double high = (s->high[1] - s->low[1]) * s->scale,
               wide = (s->high[0] - s->low[0]) * s->scale;
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  for (int k = 0; k < s->count && s->count > 1; k++)
    canvas_text_within(c, s->panels[k].at.origin_x, s->panels[k].at.origin_y - high - 10, 18, wide,
                       s->panels[k].caption);
}

/* Arms of one length along x, y and z, as the body is seen; those toward the eye are left out. */
static void draw_axes(canvas *c, const sheet *s) {
  enum { ARM = 44 };
  const plot_frame *f = &s->panels[0].frame;
  const double x = MARGIN + 6, y = s->height - FOOT - 14;
  if (f->dimensions != 3) return;
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  for (int k = 0; k < 3; k++) {
    const double across = f->axes[k][0], up = f->axes[k][1];
    if (pl_hypot(across, up) < 0.1) continue;
    canvas_line(c, x, y, x + ARM * across, y - ARM * up, 2);
    canvas_text(c, x + (ARM + 12) * across, y - (ARM + 12) * up + 6, 18, ANCHOR_CENTRE,
                (char[]){"xyz"[k], 0});
  }
  canvas_text(c, x + 96, y, 18, ANCHOR_LEFT, f->extents);
}

static void draw_scale_bar(canvas *c, const sheet *s) {
  double length = nice_step((WIDTH - 2 * MARGIN) / (s->scale * s->columns), 6), y = s->height - 34;
  char text[64];
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  canvas_line(c, MARGIN, y, MARGIN + length * s->scale, y, 3);
  snprintf(text, sizeof text, "%.6g mm", 1e3 * length);
  canvas_text(c, MARGIN, y + 24, 18, ANCHOR_LEFT, text);
}

/* The classes that occur. */
static void find_classes(const map *m, bool occurs[CLASSES]) {
  for (long b = 0; b < m->frame.bonds; b++)
    if (class_of_bond(m, b) != NO_CLASS) occurs[class_of_bond(m, b)] = true;
  for (long p = 0; m->frame.of_damage && m->frame.values && p < m->frame.value_count; p++)
    occurs[damage_class_of(m->frame.values[p])] = true;
}

static void draw_damage_legend(canvas *c, const sheet *s) {
  double x = WIDTH - MARGIN, y = s->height - 30;
  bool occurs[CLASSES] = {s->panels[0].frame.bonds == 0};
  for (int k = 0; k < s->count; k++)
    find_classes(&s->panels[k], occurs);
  for (int k = class_count(s->panels) - 1; k >= 0; k--) {
    const damage_class *of = &classes_of(s->panels)[k];
    char text[128];
    if (!occurs[k]) continue;
    snprintf(text, sizeof text, "%s%s",
             k && s->panels[0].frame.second ? s->panels[0].frame.damages[of->of] : "", of->text);
    x -= canvas_text_width(c, 18, text);
    canvas_colour(c, (colour){0.1, 0.1, 0.1});
    canvas_text(c, x, y, 18, ANCHOR_LEFT, text);
    x -= 36;
    canvas_colour(c, of->ink);
    canvas_line(c, x, y - 6, x + 28, y - 6, k == 0 ? 4 : 5);
    x -= 22;
  }
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  canvas_text(c, x, y, 18, ANCHOR_RIGHT, s->panels[0].frame.damage_of);
}

/* "stress_yy [MPa]"; which component of a vector. */
static void name_values(const plot_frame *f, int component, const char *unit_text, char *text,
                        size_t size) {
  const char *part = f->components == 1 ? ""
                     : component == 0   ? " x"
                     : component == 1   ? " y"
                     : component == 2   ? " z"
                                        : " (size)";
  const bool pure = strcmp(unit_text, "1") == 0;
  snprintf(text, size, "%s%s%s%s%s", f->shown, part, pure ? "" : " [", pure ? "" : unit_text,
           pure ? "" : "]");
}

static void draw_value_legend(canvas *c, const sheet *s, const plot_map_options *o) {
  const plot_frame *f = &s->panels[0].frame;
  double width = 360, x = WIDTH - MARGIN - width, y = s->height - 50, factor;
  const int steps = f->meshes.count > 0 ? CELL_STEPS : 180;
  for (int k = 0; k < steps; k++) {
    canvas_colour(c, scale_colour(f->meshes.count > 0 ? (k + 0.5) / steps : k / 179.0));
    cairo_rectangle(c->cr, x + width / steps * k, y, width / steps + 0.5, 14);
    cairo_fill(c->cr);
  }
  const char *shown = readable_unit(f->unit_text, pl_fmax(fabs(s->least), fabs(s->most)), &factor);
  char text[512];
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  snprintf(text, sizeof text, "%s%.4g", o->range ? "\u2264 " : "", s->least * factor);
  canvas_text(c, x, y + 34, 18, ANCHOR_LEFT, text);
  snprintf(text, sizeof text, "%s%.4g", o->range ? "\u2265 " : "", s->most * factor);
  canvas_text(c, x + width, y + 34, 18, ANCHOR_RIGHT, text);
  name_values(f, o->component, shown, text, sizeof text);
  canvas_text(c, x - 14, y + 13, 18, ANCHOR_RIGHT, text);
}

/* A sample of each line above its value. */
static void draw_level_legend(canvas *c, const sheet *s, const plot_map_options *o) {
  const plot_frame *f = &s->panels[0].frame;
  const double step = pl_fmin(72, 1000.0 / s->level_count);
  double x = WIDTH - MARGIN - step * s->level_count, factor;
  const double y = s->height - 44;
  const char *shown = readable_unit(f->unit_text, pl_fmax(fabs(s->least), fabs(s->most)), &factor);
  char text[512];
  name_values(f, o->component, shown, text, sizeof text);
  canvas_colour(c, (colour){0.1, 0.1, 0.1});
  canvas_text(c, x - 14, y + 22, 18, ANCHOR_RIGHT, text);
  for (int k = 0; k < s->level_count; k++, x += step) {
    canvas_colour(c, contour_colour(k, s->level_count));
    canvas_line(c, x + 0.1 * step, y, x + 0.9 * step, y, 5);
    canvas_colour(c, (colour){0.1, 0.1, 0.1});
    snprintf(text, sizeof text, "%.4g", s->levels[k] * factor + 0.0);
    if (step >= 50 || k % 2 == 0) canvas_text(c, x + step / 2, y + 22, 16, ANCHOR_CENTRE, text);
  }
}

static void widen(double value, double *low, double *high) {
  if (!isfinite(value)) return;
  *low = pl_fmin(*low, value);
  *high = pl_fmax(*high, value);
}

/* Least and largest value that is drawn; false when none is a number. */
static bool range_of(const sheet *s, int component, double *low, double *high) {
  *low = INFINITY;
  *high = -INFINITY;
  for (int n = 0; n < s->count; n++) {
    const plot_frame *f = &s->panels[n].frame;
    for (long k = 0; k < f->value_count; k++)
      if (!f->of_cells || !f->nodes[k]) widen(plot_frame_value(f, k, component), low, high);
    for (long c = 0; f->of_cells && c < plot_meshes_cells(&f->meshes); c++)
      widen(f->of_cells[c], low, high);
  }
  return *low <= *high;
}

static void draw_crack_legend(canvas *c, const sheet *s) {
  const double x = MARGIN + 300, y = s->height - 34;
  const map *last = &s->panels[s->count - 1]; /* where most has grown */
  if (last->frame.meshes.crack_count > 0)
    plot_cells_crack_legend(c, &last->frame.meshes, MARGIN, s->height - 66);
  bool any = false;
  for (int n = 0; n < s->count; n++)
    for (long b = 0; b < s->panels[n].frame.bonds; b++)
      any = any || is_separated(&s->panels[n], b);
  if (!any) return;
  canvas_colour(c, damage_classes[SEPARATED].ink);
  canvas_line(c, x, y, x + 28, y, 5);
  canvas_text(c, x + 36, y + 6, 18, ANCHOR_LEFT, damage_classes[SEPARATED].text);
}

/* --- the picture ------------------------------------------------------------------------------ */

static void draw_field(canvas *c, const map *m, const plot_map_options *o, const sheet *s) {
  if (m->frame.of_bonds) draw_bond_values(c, m, o->component, s->least, s->most);
  draw_meshes(c, m, s, o->component);
  draw_particles(c, m, o->component, s->least, s->most);
  if (m->frame.damage) draw_bonds(c, m, false);
}

static void draw_damage(canvas *c, const map *m, const plot_map_options *o, const sheet *s) {
  draw_meshes(c, m, s, o->component);
  if (m->frame.damage) draw_bonds(c, m, true); /* damage of particles says nothing of bonds */
  draw_particles(c, m, o->component, 0, 0);
}

/* "LOW,HIGH", in the unit of the values. */
static bool read_range(sheet *s, const char *range, char *error, size_t size) {
  const char *unit_text = s->panels[0].frame.unit_text, *comma = strchr(range, ',');
  if (comma && quantity_read(range, (size_t)(comma - range), unit_text, &s->least) &&
      quantity_read(comma + 1, strlen(comma + 1), unit_text, &s->most) && s->least < s->most)
    return true;
  snprintf(error, size, "--range needs two ascending values in a unit of `%s`, not `%s`", unit_text,
           range);
  return false;
}

/* Which values have colours, or lines. */
static bool choose_values(sheet *s, const plot_map_options *o, char *error, size_t size) {
  if (!range_of(s, o->component, &s->least, &s->most)) {
    snprintf(error, size, "`%s` holds no finite value to draw", o->field);
    return false;
  }
  if (o->contours > 0 && s->panels[0].frame.meshes.count == 0) {
    snprintf(error, size, "--contours is of meshes: leave it out of a map of particles or bonds");
    return false;
  }
  if (o->range && !read_range(s, o->range, error, size)) return false;
  if (o->contours > 0) s->level_count = contour_levels(s->least, s->most, o->contours, s->levels);
  if (o->contours == 0 || s->level_count > 0) return true;
  snprintf(error, size, "`%s` is the same everywhere: there are no lines of equal value", o->field);
  return false;
}

static void draw_legend(canvas *c, const sheet *s, const plot_map_options *o, bool measured) {
  if (!measured)
    draw_damage_legend(c, s);
  else if (s->level_count > 0)
    draw_level_legend(c, s, o);
  else
    draw_value_legend(c, s, o);
  if (measured) draw_crack_legend(c, s);
  draw_mark_legend(c, s, o->mark);
}

static bool draw_sheet(sheet *s, const plot_map_options *o, char *error, size_t size) {
  if (!fit_picture(s, error, size)) return false;
  const bool measured = s->panels[0].frame.values && !s->panels[0].frame.of_damage;
  if (measured && !choose_values(s, o, error, size)) return false;
  canvas c;
  if (!canvas_open(&c, o->output, WIDTH, s->height, error, size)) return false;
  draw_head(&c, s);
  draw_captions(&c, s);
  draw_scale_bar(&c, s);
  draw_axes(&c, s);
  for (int k = 0; k < s->count; k++) {
    const plot_frame *f = &s->panels[k].frame;
    plot_stamps_draw(&c, &f->stamps, f->factor, &s->panels[k].at, s->low, s->high);
    if (measured)
      draw_field(&c, &s->panels[k], o, s);
    else
      draw_damage(&c, &s->panels[k], o, s);
    draw_marks(&c, &s->panels[k]);
  }
  draw_legend(&c, s, o, measured);
  return canvas_close(&c, error, size);
}

/* All panels, with one factor. Their captions. */
static bool read_panels(sheet *s, const char *path, const plot_map_options *o, double factor,
                        char *error, size_t size) {
  bool good = true;
  for (int k = 0; good && k < s->count; k++) {
    map *m = &s->panels[k];
    plot_map_options one = *o;
    if (o->frames) one.frame = o->frames[k];
    one.factor = factor;
    plot_frame_free(&m->frame);
    good = plot_frame_read(&m->frame, path, &one, error, size);
    if (o->captions)
      snprintf(m->caption, sizeof m->caption, "%s", o->captions[k]);
    else
      say_when(&m->frame, m->caption, sizeof m->caption);
  }
  return good;
}

/* The smallest of the factors that the panels would have alone. */
static double common_factor(const sheet *s) {
  double least = INFINITY;
  for (int k = 0; k < s->count; k++)
    least = pl_fmin(least, s->panels[k].frame.factor);
  return least;
}

bool plot_map(const char *path, const plot_map_options *o, char *error, size_t size) {
  sheet s = {.count = o->frames ? o->frame_count : 1};
  s.panels = must_calloc((size_t)s.count, sizeof *s.panels);
  bool good = read_panels(&s, path, o, o->factor, error, size);
  if (good && s.count > 1 && o->factor < 0)
    good = read_panels(&s, path, o, common_factor(&s), error, size);
  good = good && draw_sheet(&s, o, error, size);
  for (int k = 0; k < s.count; k++)
    plot_frame_free(&s.panels[k].frame);
  free(s.panels);
  return good;
}
