#include "runtime/plot/plot_axes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "dsl/base/characters.h"
#include "dsl/base/elementary.h"
#include "dsl/base/powers.h"
#include "dsl/base/units.h"

/* Shown unit and the factor from SI; the user's unit must fit the history's. */
static bool choose_unit(axis *a, const char *si_unit, const char *wanted, double largest,
                        char *error, size_t size) {
  if (!wanted) {
    snprintf(a->unit_text, sizeof a->unit_text, "%s", readable_unit(si_unit, largest, &a->factor));
    return true;
  }
  unit shown, si;
  const char *bad;
  size_t bad_length;
  if (!unit_parse(wanted, strlen(wanted), &shown, &bad, &bad_length) ||
      !unit_parse(si_unit, strlen(si_unit), &si, &bad, &bad_length) ||
      !dim_equal(shown.dim, si.dim)) {
    snprintf(error, size, "`%s` is in %s; it cannot be shown in `%s`", a->name, name_shown(si_unit),
             wanted);
    return false;
  }
  snprintf(a->unit_text, sizeof a->unit_text, "%s", wanted);
  a->factor = si.factor / shown.factor;
  return true;
}

/* A power of ten in front of the unit where numbers would have many digits. */
static void shorten_numbers(axis *a, double largest) {
  double shown = largest * a->factor;
  if (!(shown > 0) || (shown < 1e5 && shown >= 1e-2)) return;
  int power = 3 * (int)floor(decade_of(shown) / 3.0);
  char symbol[sizeof a->unit_text];
  memcpy(symbol, a->unit_text, sizeof symbol);
  bool pure = unit_is_pure(symbol);
  snprintf(a->unit_text, sizeof a->unit_text, "1e%d%s%.50s", power, pure ? "" : " ",
           pure ? "" : symbol);
  a->factor /= power_of(10, power);
}

/* An end beyond zero by what cannot be seen (2 pixels) is zero: an axis does not get a step for
   it. */
static double without_noise(double end, double range) {
  return fabs(end) < 2e-3 * range ? 0 : end;
}

bool axis_set(axis *a, const char *name, const char *si_unit, const char *wanted, double low,
              double high, char *error, size_t size) {
  a->name = name;
  if (!(low <= high)) {
    snprintf(error, size, "`%s` holds no finite value to draw", name);
    return false;
  }
  if (!choose_unit(a, si_unit, wanted, pl_fmax(fabs(low), fabs(high)), error, size)) return false;
  if (!wanted) shorten_numbers(a, pl_fmax(fabs(low), fabs(high)));
  const double range = high - low;
  low = without_noise(low, range) * a->factor;
  high = without_noise(high, range) * a->factor;
  if (low > 0 && low < 0.3 * high) low = 0;
  if (!(high - low > 1e-12 * pl_fmax(fabs(high), 1e-300))) {
    high = low + (fabs(low) > 0 ? fabs(low) : 1);
  }
  a->step = nice_step(high - low, 5);
  a->low = a->step * floor(low / a->step + 1e-3); /* a thousandth of a step is not seen */
  a->high = a->step * ceil(high / a->step - 1e-3);
  return true;
}

static double shown_along_x(const axis *a, double shown) {
  return DIAGRAM_LEFT + (shown - a->low) / (a->high - a->low) * (DIAGRAM_RIGHT - DIAGRAM_LEFT);
}

static double shown_along_y(const axis *a, double shown) {
  return DIAGRAM_BOTTOM - (shown - a->low) / (a->high - a->low) * (DIAGRAM_BOTTOM - DIAGRAM_TOP);
}

double axis_along_x(const axis *a, double value) {
  return shown_along_x(a, value * a->factor);
}

double axis_along_y(const axis *a, double value) {
  return shown_along_y(a, value * a->factor);
}

static void draw_axes(canvas *c, const axis *x, const axis *y) {
  const colour grid = {0.88, 0.88, 0.88}, ink = {0.1, 0.1, 0.1};
  char text[64];
  long nx = lround((x->high - x->low) / x->step), ny = lround((y->high - y->low) / y->step);
  for (long k = 0; k <= nx; k++) {
    double v = x->low + (double)k * x->step, at = shown_along_x(x, v);
    canvas_colour(c, grid);
    canvas_line(c, at, DIAGRAM_TOP, at, DIAGRAM_BOTTOM, 1);
    canvas_colour(c, ink);
    snprintf(text, sizeof text, "%.6g", fabs(v) < 1e-9 * x->step ? 0 : v);
    canvas_text(c, at, DIAGRAM_BOTTOM + 26, 19, ANCHOR_CENTRE, text);
  }
  for (long k = 0; k <= ny; k++) {
    double v = y->low + (double)k * y->step, at = shown_along_y(y, v);
    canvas_colour(c, grid);
    canvas_line(c, DIAGRAM_LEFT, at, DIAGRAM_RIGHT, at, 1);
    canvas_colour(c, ink);
    snprintf(text, sizeof text, "%.6g", fabs(v) < 1e-9 * y->step ? 0 : v);
    canvas_text(c, DIAGRAM_LEFT - 12, at + 7, 19, ANCHOR_RIGHT, text);
  }
  canvas_colour(c, (colour){0.6, 0.6, 0.6}); /* where something is zero, inside of the frame */
  if (x->low < 0 && x->high > 0)
    canvas_line(c, shown_along_x(x, 0), DIAGRAM_TOP, shown_along_x(x, 0), DIAGRAM_BOTTOM, 1);
  if (y->low < 0 && y->high > 0)
    canvas_line(c, DIAGRAM_LEFT, shown_along_y(y, 0), DIAGRAM_RIGHT, shown_along_y(y, 0), 1);
  canvas_colour(c, ink);
  canvas_line(c, DIAGRAM_LEFT, DIAGRAM_BOTTOM, DIAGRAM_RIGHT, DIAGRAM_BOTTOM, 1.5);
  canvas_line(c, DIAGRAM_LEFT, DIAGRAM_TOP, DIAGRAM_LEFT, DIAGRAM_BOTTOM, 1.5);
}

static void name_axis(const axis *a, char *text, size_t size) {
  const bool pure = unit_is_pure(a->unit_text);
  snprintf(text, size, "%.400s%s%s%s", a->name, pure ? "" : " [", pure ? "" : a->unit_text,
           pure ? "" : "]");
}

static void draw_names(canvas *c, const axis *x, const axis *y, const char *title) {
  char text[512];
  name_axis(x, text, sizeof text);
  canvas_text(c, (DIAGRAM_LEFT + DIAGRAM_RIGHT) / 2.0, DIAGRAM_HEIGHT - 26, 22, ANCHOR_CENTRE,
              text);
  name_axis(y, text, sizeof text);
  canvas_text_upward(c, 36, DIAGRAM_TOP + (DIAGRAM_BOTTOM - DIAGRAM_TOP) / 2.0, 22,
                     DIAGRAM_BOTTOM - DIAGRAM_TOP, text);
  canvas_text_within(c, DIAGRAM_LEFT, 42, 24, DIAGRAM_RIGHT - DIAGRAM_LEFT, title);
}

void axes_draw(canvas *c, const axis *x, const axis *y, const char *title) {
  draw_axes(c, x, y);
  draw_names(c, x, y, title);
}
