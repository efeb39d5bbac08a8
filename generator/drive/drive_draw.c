#include "generator/drive/drive_draw.h"

#include <stdio.h>

#include "runtime/plot/plot_curve.h"

bool drive_draw(const drive_input *in, const drive_table *t, const char *path, char *error,
                size_t size) {
  const drive_output *o = &in->output;
  const char *along = o->x ? o->x : t->columns[t->way].name;
  const char *up = o->y ? o->y : t->columns[t->force].name;
  int x = drive_column_find(t, along), y = drive_column_find(t, up);
  if (x < 0 || y < 0) {
    snprintf(error, size, "the table has no column `%s` to draw", x < 0 ? along : up);
    return false;
  }
  plot_curve_options options = {.output = path, .x = along, .y = up, .title = in->simulation.title};
  return plot_values(t->columns[x].values, t->columns[y].values, t->rows, t->columns[x].unit,
                     t->columns[y].unit, &options, error, size);
}
