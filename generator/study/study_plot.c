#include "generator/study/study_plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/units.h"
#include "generator/kernel/document.h"
#include "generator/study/study_read.h"

enum { MOST_SERIES = 64 };

typedef struct point {
  const char *group; /* the case without what is along x */
  double x, y;
} point;

/* "horizon=1.5" of "horizon=1.5,rotation=30" and "rotation". */
static const char *group_of(arena *a, const char *name, const char *key) {
  const char *own = arena_printf(a, "%s=", key), *group = "";
  for (const char *part = name; *part;) {
    const size_t length = strcspn(part, ",");
    if (strncmp(part, own, strlen(own)) != 0)
      group = arena_printf(a, "%s%s%.*s", group, *group ? ", " : "", (int)length, part);
    part += length + (part[length] == ',');
  }
  return group;
}

static int by_group(const void *p, const void *q) {
  const point *a = p, *b = q;
  const int groups = strcmp(a->group, b->group);
  return groups ? groups : (a->x > b->x) - (a->x < b->x);
}

/* Keys may be named by their group, too: columns have that only where they need it. */
static const study_column *numbers_named(const study_reading *r, const char *path,
                                         const char *name) {
  const char *dot = strrchr(name, '.');
  const study_column *c = study_reading_column(r, name);
  if (!c && dot) c = study_reading_column(r, dot + 1);
  if (c && c->unit) return c;
  say_error(c ? "column `%s` of `%s` holds texts, not numbers"
              : "there is no column `%s` in `%s`, which `perilat info` lists",
            name, path);
  return NULL;
}

/* Table values to SI. */
static double in_SI(const char *unit_text) {
  unit u;
  const char *bad;
  size_t bad_length;
  return unit_parse(unit_text, strlen(unit_text), &u, &bad, &bad_length) ? u.factor : 1;
}

static int take_points(arena *a, const study_reading *r, const study_column *x,
                       const study_column *y, point *points) {
  const study_column *names = study_reading_column(r, "case");
  int count = 0;
  for (int k = 0; k < r->table.rows; k++)
    if (isfinite(x->values[k]) && isfinite(y->values[k]))
      points[count++] = (point){names && names->texts ? group_of(a, names->texts[k], x->name) : "",
                                in_SI(x->unit) * x->values[k], in_SI(y->unit) * y->values[k]};
  qsort(points, (size_t)count, sizeof *points, by_group);
  return count;
}

/* Points of a group stand together. */
static int groups_of(const point *points, int count) {
  int groups = 0;
  for (int k = 0; k < count; k++)
    groups += k == 0 || strcmp(points[k].group, points[k - 1].group) != 0;
  return groups;
}

/* Shown in the units of the table, unless others are asked for. */
static bool draw_points(arena *a, const point *points, int count, const study_column *x,
                        const study_column *y, const plot_curve_options *asked, int label_count) {
  plot_curve_options shown = *asked, *o = &shown;
  plot_series series[MOST_SERIES];
  double *along = arena_alloc(a, ((size_t)count + 1) * sizeof *along);
  double *up = arena_alloc(a, ((size_t)count + 1) * sizeof *up);
  char error[1024];
  const int groups = groups_of(points, count);
  int made = 0;
  if (!o->x_unit && !unit_is_pure(x->unit)) o->x_unit = x->unit;
  for (int k = 0; k < count; k++) {
    along[k] = points[k].x;
    up[k] = points[k].y;
    if (k == 0 || strcmp(points[k].group, points[k - 1].group) != 0) {
      if (made == MOST_SERIES) break;
      const char *label = made < label_count ? o->labels[made] : points[k].group;
      series[made++] = (plot_series){&along[k], &up[k], 0, label};
    }
    series[made - 1].count++;
  }
  if (label_count > 0 && label_count != made) {
    say_error("%d labels for %d curves; give one --label a curve", label_count, made);
    return false;
  }
  if (groups > made)
    fprintf(stderr, "perilat: warning: of %d curves the first %d are drawn\n", groups, made);
  const bool good = plot_series_draw(series, made, x->unit, y->unit, o, error, sizeof error);
  if (!good) say_error("%s", error);
  return good;
}

bool study_plot(const char *path, const plot_curve_options *o, int label_count) {
  arena *a = arena_new();
  study_reading r;
  bool good = study_read(a, path, &r);
  const study_column *x = good ? numbers_named(&r, path, o->x) : NULL;
  const study_column *y = x ? numbers_named(&r, path, o->y) : NULL;
  good = x && y;
  if (good) {
    point *points = arena_alloc(a, ((size_t)r.table.rows + 1) * sizeof *points);
    const int count = take_points(a, &r, x, y, points);
    good = count > 0 && draw_points(a, points, count, x, y, o, label_count);
    if (count == 0) say_error("no case of `%s` has numbers in `%s`", path, o->y);
  }
  arena_free(a);
  return good;
}
