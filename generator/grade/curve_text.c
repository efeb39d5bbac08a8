#include "generator/grade/curve_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "dsl/base/units.h"
#include "generator/against/table_difference.h"
#include "generator/grade/mark_files.h"

enum { MOST_POINTS = 400, WIDTH = 440, HEIGHT = 260, MARGIN = 34 };

/* --- text ------------------------------------------------------------------------------------- */

/* Every so many rows, and the last. */
static void write_points(FILE *out, const drive_table *t, int way, int force) {
  const long every = (t->rows + MOST_POINTS - 1) / MOST_POINTS;
  const double *x = t->columns[way].values, *y = t->columns[force].values;
  for (long k = 0; k < t->rows; k++)
    if ((k % every == 0 || k == t->rows - 1) && isfinite(x[k]) && isfinite(y[k]))
      fprintf(out, "%.7g %.7g ", x[k], y[k]);
  fputc('\n', out);
}

char *curve_text(const drive_table *answer, const drive_table *reference) {
  char *text;
  size_t length;
  int way, force;
  driven_columns(reference, &way, &force);
  const drive_column *x = &reference->columns[way], *y = &reference->columns[force];
  const int own[] = {drive_column_find(answer, x->name), drive_column_find(answer, y->name)};
  FILE *out = must_open_text(&text, &length);
  fprintf(out, "%s\n%s [%s]\n", x->name, y->name, unit_is_pure(y->unit) ? "1" : y->unit);
  write_points(out, reference, way, force);
  if (own[0] >= 0 && own[1] >= 0) write_points(out, answer, own[0], own[1]);
  must_close_text(out);
  return text;
}

/* --- picture ---------------------------------------------------------------------------------- */

typedef struct points {
  double x[MOST_POINTS + 2], y[MOST_POINTS + 2];
  int count;
} points;

/* Pairs of numbers to the end of the line. Returns what follows. */
static const char *read_points(const char *text, points *p) {
  const char *stop = text + strcspn(text, "\n");
  p->count = 0;
  while (text < stop && p->count < MOST_POINTS + 2) {
    char *end;
    const double x = strtod(text, &end);
    if (end == text || end > stop) break;
    text = end;
    const double y = strtod(text, &end);
    if (end == text || end > stop) break;
    text = end;
    if (!isfinite(x) || !isfinite(y)) continue;
    p->x[p->count] = x;
    p->y[p->count++] = y;
  }
  return *stop ? stop + 1 : stop;
}

typedef struct frame {
  double low[2], high[2];
} frame;

static void widen(frame *f, const points *p) {
  for (int k = 0; k < p->count; k++) {
    f->low[0] = pl_fmin(f->low[0], p->x[k]);
    f->high[0] = pl_fmax(f->high[0], p->x[k]);
    f->low[1] = pl_fmin(f->low[1], p->y[k]);
    f->high[1] = pl_fmax(f->high[1], p->y[k]);
  }
}

static double along_x(const frame *f, double x) {
  return MARGIN + (WIDTH - 2 * MARGIN) * (x - f->low[0]) / (f->high[0] - f->low[0]);
}

static double along_y(const frame *f, double y) {
  return HEIGHT - MARGIN - (HEIGHT - 2 * MARGIN) * (y - f->low[1]) / (f->high[1] - f->low[1]);
}

static void put_line(const frame *f, const points *p, const char *style, FILE *out) {
  fprintf(out, "<polyline fill=\"none\" %s points=\"", style);
  for (int k = 0; k < p->count; k++)
    fprintf(out, "%.1f,%.1f ", along_x(f, p->x[k]), along_y(f, p->y[k]));
  fputs("\"/>", out);
}

/* A line of the text, written out. */
static const char *put_name(const char *text, int x, int y, FILE *out) {
  const size_t length = strcspn(text, "\n");
  char name[80];
  snprintf(name, sizeof name, "%.*s", (int)(length < 79 ? length : 79), text);
  fprintf(out, "<text x=\"%d\" y=\"%d\" font-size=\"12\">", x, y);
  xml_text(out, name);
  fputs("</text>", out);
  return text[length] ? text + length + 1 : text + length;
}

static void put_axes(const frame *f, FILE *out) {
  fprintf(out, "<path stroke=\"#999\" d=\"M%d,%.1fH%dM%.1f,%dV%d\"/>", MARGIN, along_y(f, 0),
          WIDTH - MARGIN, along_x(f, 0), MARGIN, HEIGHT - MARGIN);
  fprintf(out,
          "<g font-size=\"10\" fill=\"#555\"><text x=\"4\" y=\"%d\">%.3g</text><text x=\"4\" "
          "y=\"%d\">%.3g</text><text x=\"%d\" y=\"%d\">%.3g</text><text x=\"%d\" "
          "y=\"%d\">%.3g</text></g>",
          MARGIN, f->high[1], HEIGHT - MARGIN, f->low[1], MARGIN, HEIGHT - MARGIN + 14, f->low[0],
          WIDTH - 2 * MARGIN, HEIGHT - MARGIN + 14, f->high[0]);
}

void curve_svg(const char *text, FILE *out) {
  points *right = must_calloc(2, sizeof *right), *yours = right + 1;
  frame f = {{0, 0}, {0, 0}};
  const char *names = text;
  for (int k = 0; k < 2; k++)
    text += strcspn(text, "\n") + (text[strcspn(text, "\n")] == '\n');
  read_points(read_points(text, right), yours);
  widen(&f, right);
  widen(&f, yours);
  if (f.high[0] > f.low[0] && f.high[1] > f.low[1]) {
    fprintf(out, "<svg viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"both curves\">", WIDTH,
            HEIGHT);
    put_axes(&f, out);
    put_line(&f, right, "stroke=\"#1b6e3a\" stroke-width=\"2\" stroke-dasharray=\"6 4\"", out);
    put_line(&f, yours, "stroke=\"#b3261e\" stroke-width=\"2\"", out);
    put_name(put_name(names, WIDTH - 80, HEIGHT - 8, out), 4, 16, out);
    fprintf(out,
            "<text x=\"%d\" y=\"16\" font-size=\"12\" fill=\"#1b6e3a\">right</text>"
            "<text x=\"%d\" y=\"16\" font-size=\"12\" fill=\"#b3261e\">yours</text></svg>\n",
            WIDTH - 90, WIDTH - 45);
  }
  free(right);
}
