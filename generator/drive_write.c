/* What a drive leaves: table, CSV, HDF5, picture. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "generator/drive.h"
#include "generator/version.h"
#include "runtime/hdf5_tools.h"
#include "runtime/plot.h"

static bool is_pure(const char *unit_text) {
  return !*unit_text || strcmp(unit_text, "1") == 0;
}

static void heading(const drive_column *c, char *text, size_t size) {
  if (is_pure(c->unit))
    snprintf(text, size, "%s", c->name);
  else
    snprintf(text, size, "%s [%s]", c->name, c->unit);
}

/* Columns that are 0 throughout, such as the moments of a central law, are left out. */
static bool is_worth_showing(const drive_table *t, int column) {
  if (column <= DRIVE_COLUMN_STRETCH || column == DRIVE_COLUMN_N) return true;
  for (long k = 0; k < t->rows; k++)
    if (t->columns[column].values[k] != 0) return true;
  return false;
}

void drive_print(const drive_table *t, long most, FILE *out) {
  enum { WIDTH = 13 };
  char text[128];
  if (most < 1 || t->rows < 1) return;
  for (int c = 0; c < t->column_count; c++) {
    if (!is_worth_showing(t, c)) continue;
    heading(&t->columns[c], text, sizeof text);
    fprintf(out, " %*s", WIDTH, text);
  }
  fputc('\n', out);
  long shown = most < t->rows ? most : t->rows;
  for (long k = 0; k < shown; k++) {
    long row = shown > 1 ? k * (t->rows - 1) / (shown - 1) : t->rows - 1;
    for (int c = 0; c < t->column_count; c++) {
      if (!is_worth_showing(t, c)) continue;
      heading(&t->columns[c], text, sizeof text);
      int width = (int)strlen(text) > WIDTH ? (int)strlen(text) : WIDTH;
      fprintf(out, " %*.6g", width, t->columns[c].values[row]);
    }
    fputc('\n', out);
  }
}

static bool write_rows(const drive_table *t, FILE *out) {
  char text[128];
  for (int c = 0; c < t->column_count; c++) {
    heading(&t->columns[c], text, sizeof text);
    fprintf(out, "%s%s", c ? "," : "", text);
  }
  for (long k = 0; k < t->rows; k++)
    for (int c = 0; c < t->column_count; c++)
      fprintf(out, "%s%.17g", c ? "," : "\n", t->columns[c].values[k]);
  return fputc('\n', out) != EOF && !ferror(out);
}

bool drive_write_csv(const drive_table *t, const char *path, char *error, size_t size) {
  char working[4200];
  snprintf(working, sizeof working, "%.4096s.part", path);
  FILE *out = fopen(working, "w");
  bool good = out && write_rows(t, out);
  good = out && fclose(out) == 0 && good;
  good = good && rename(working, path) == 0;
  if (good) return true;
  snprintf(error, size, "cannot write `%s`: %s", path, strerror(errno));
  unlink(working);
  return false;
}

static bool write_particles(const drive_input *in, hid_t file) {
  const double s = in->bond.spacing, reference[4] = {0, 0, s, 0};
  const double one = sqrt(3) / 2 * s * s * in->bond.thickness, volume[2] = {one, one};
  const int32_t body[2] = {0, 0};
  const hsize_t extent[2] = {2, 2};
  return h5_make_group(file, "/particles") &&
         h5_write_doubles(file, "/particles/reference", reference, 2, extent, "m") &&
         h5_write_integers(file, "/particles/body", body, 1, extent) &&
         h5_write_doubles(file, "/particles/volume", volume, 1, extent, "m^3");
}

static bool write_file(const drive_input *in, const drive_table *t, hid_t file) {
  char name[256];
  bool good = h5_attribute_text(file, "perilat_version", perilat_version) &&
              h5_attribute_text(file, "title", in->simulation.title) && write_particles(in, file) &&
              h5_make_group(file, "/history");
  const hsize_t rows = (hsize_t)t->rows;
  for (int c = 0; good && c < t->column_count; c++) {
    snprintf(name, sizeof name, "/history/%s", t->columns[c].name);
    good = h5_write_doubles(file, name, t->columns[c].values, 1, &rows,
                            is_pure(t->columns[c].unit) ? "1" : t->columns[c].unit);
  }
  return good;
}

bool drive_write_hdf5(const drive_input *in, const drive_table *t, const char *path, char *error,
                      size_t size) {
  char working[4200];
  snprintf(working, sizeof working, "%.4096s.part", path);
  h5_quiet();
  hid_t file = h5_create(working);
  bool good = file >= 0 && write_file(in, t, file);
  good = file >= 0 && H5Fclose(file) >= 0 && good;
  good = good && rename(working, path) == 0;
  if (good) return true;
  snprintf(error, size, "cannot write `%s`%s%s", path, errno ? ": " : "",
           errno ? strerror(errno) : "");
  unlink(working);
  return false;
}

bool drive_draw(const drive_input *in, const drive_table *t, const char *path, char *error,
                size_t size) {
  const drive_output *o = &in->output;
  int x = drive_column_find(t, o->x), y = drive_column_find(t, o->y);
  if (x < 0 || y < 0) {
    snprintf(error, size, "the table has no column `%s` to draw", x < 0 ? o->x : o->y);
    return false;
  }
  plot_curve_options options = {
      .output = path, .x = o->x, .y = o->y, .title = in->simulation.title};
  return plot_values(t->columns[x].values, t->columns[y].values, t->rows, t->columns[x].unit,
                     t->columns[y].unit, &options, error, size);
}
