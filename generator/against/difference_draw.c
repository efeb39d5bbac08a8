#include "generator/against/difference_draw.h"

#include <stdio.h>

#include "runtime/plot/plot_curve.h"

bool difference_draw(const drive_input *in, const drive_table *answer, const drive_table *reference,
                     const char *const labels[2], const char *path, char *error, size_t size) {
  const drive_output *o = &in->output;
  const char *along = o->x ? o->x : reference->columns[reference->way].name;
  const char *up = o->y ? o->y : reference->columns[reference->force].name;
  const drive_table *tables[] = {reference, answer};
  plot_series series[2];
  const char *x_unit = "1", *y_unit = "1";
  for (int k = 0; k < 2; k++) {
    const drive_table *t = tables[k];
    const int x = drive_column_find(t, along), y = drive_column_find(t, up);
    if (x < 0 || y < 0) {
      snprintf(error, size, "the table has no column `%s` to draw", x < 0 ? along : up);
      return false;
    }
    series[k] = (plot_series){t->columns[x].values, t->columns[y].values, t->rows, labels[1 - k]};
    x_unit = t->columns[x].unit;
    y_unit = t->columns[y].unit;
  }
  const plot_curve_options options = {
      .output = path, .x = along, .y = up, .title = in->simulation.title};
  return plot_series_draw(series, 2, x_unit, y_unit, &options, error, size);
}
