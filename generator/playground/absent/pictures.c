/* Cairo: the page draws its curves itself. */
#include "generator/drive/drive_draw.h"
#include "runtime/plot/plot_curve.h"

static bool refuse(char *error, size_t size) {
  snprintf(error, size, "the playground draws its pictures in the page");
  return false;
}

bool drive_draw(const drive_input *in, const drive_table *t, const char *path, char *error,
                size_t size) {
  (void)in, (void)t, (void)path;
  return refuse(error, size);
}

bool plot_series_draw(const plot_series *series, int count, const char *x_unit, const char *y_unit,
                      const plot_curve_options *o, char *error, size_t size) {
  (void)series, (void)count, (void)x_unit, (void)y_unit, (void)o;
  return refuse(error, size);
}
