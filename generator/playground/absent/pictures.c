/* Pictures and pages: the page draws its curves and shows marks itself. */
#include "generator/drive/drive_draw.h"
#include "generator/grade/mark_page.h"
#include "generator/kernel/document.h"
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

bool marks_page(const exercise *e, const marks *all, int count, const char *path) {
  (void)e, (void)all, (void)count;
  say_error("the playground shows marks in the page, not as `%s`", path);
  return false;
}
