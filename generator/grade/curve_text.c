#include "generator/grade/curve_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/units.h"
#include "generator/against/table_difference.h"

enum { MOST_POINTS = CURVE_POINTS - 2 };

/* Every so many rows, and the last. */
static void write_points(FILE *out, const drive_table *t, int way, int force) {
  const long every = (t->rows + MOST_POINTS - 1) / MOST_POINTS;
  const double *x = t->columns[way].values, *y = t->columns[force].values;
  for (long k = 0; k < t->rows; k++)
    if ((k % every == 0 || k == t->rows - 1) && isfinite(x[k]) && isfinite(y[k]))
      fprintf(out, "%.7g %.7g ", x[k], y[k]);
  fputc('\n', out);
}

static void write_name(FILE *out, const drive_column *c) {
  fprintf(out, "%s\n%s\n", c->name, unit_is_pure(c->unit) ? "1" : c->unit);
}

char *curve_text(const drive_table *answer, const drive_table *reference) {
  char *text;
  size_t length;
  int way, force;
  driven_columns(reference, &way, &force);
  const drive_column *x = &reference->columns[way], *y = &reference->columns[force];
  const int own[] = {drive_column_find(answer, x->name), drive_column_find(answer, y->name)};
  FILE *out = must_open_text(&text, &length);
  write_name(out, x);
  write_name(out, y);
  write_points(out, reference, way, force);
  if (own[0] >= 0 && own[1] >= 0) write_points(out, answer, own[0], own[1]);
  must_close_text(out);
  return text;
}
