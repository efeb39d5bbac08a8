/* What a drive leaves: table, CSV, HDF5, picture. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "generator/drive.h"
#include "generator/version.h"
#include "runtime/hdf5_tools.h"
#include "runtime/plot.h"
#include "runtime/whole_file.h"

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
  if (column <= t->way || column == t->force) return true;
  for (long k = 0; k < t->rows; k++)
    if (t->columns[column].values[k] != 0) return true;
  return false;
}

enum { WIDTH = 13 };

static void print_row(const drive_table *t, long row, FILE *out) {
  char text[128];
  for (int c = 0; c < t->column_count; c++) {
    if (!is_worth_showing(t, c)) continue;
    heading(&t->columns[c], text, sizeof text);
    int width = (int)strlen(text) > WIDTH ? (int)strlen(text) : WIDTH;
    fprintf(out, " %*.6g", width, t->columns[c].values[row]);
  }
  fputc('\n', out);
}

static long row_of_largest_force(const drive_table *t) {
  const double *N = t->columns[t->force].values;
  long row = 0;
  for (long k = 1; k < t->rows; k++)
    if (fabs(N[k]) > fabs(N[row])) row = k;
  return row;
}

/* Marks `most` more rows, at corners of the path: every n-th where there are more. */
static void mark_corners(const drive_input *in, const drive_table *t, long most, bool *shown) {
  const double *time = t->columns[DRIVE_COLUMN_TIME].values;
  long corners, row = 0, unmarked = 0;
  double *at = drive_corners(in, &corners);
  long *rows = must_calloc((size_t)corners + 1, sizeof *rows);
  for (long k = 0; k < corners; k++) {
    while (row < t->rows - 1 &&
           time[row] < at[k] - 1e-12 * time[t->rows - 1]) /* as rows are kept apart */
      row++;
    if (!shown[row]) rows[unmarked++] = row;
  }
  for (long k = 0; most > 0 && k < unmarked; k += (unmarked + most - 1) / most)
    shown[rows[k]] = true;
  free(rows);
  free(at);
}

static long count_marked(const drive_table *t, const bool *shown) {
  long marked = 0;
  for (long k = 0; k < t->rows; k++)
    marked += shown[k];
  return marked;
}

/* Marks `more` rows, evenly spread between those that are marked; both ends are. */
static void mark_between(const drive_table *t, long more, bool *shown) {
  double share = (double)more / (double)(t->rows > 1 ? t->rows - 1 : 1), due = 0;
  for (long row = 0, next; row < t->rows - 1; row = next) {
    for (next = row + 1; !shown[next];)
      next++;
    due += share * (double)(next - row);
    const long here = (long)(due + 0.5) < next - row - 1 ? (long)(due + 0.5) : next - row - 1;
    for (long k = 1; k <= here; k++)
      shown[row + k * (next - row) / (here + 1)] = true;
    due -= (double)here;
  }
}

void drive_print(const drive_input *in, const drive_table *t, FILE *out) {
  char text[128];
  const long most = in->output.rows;
  if (most < 1 || t->rows < 1) return;
  bool *shown = must_calloc((size_t)t->rows, sizeof *shown);
  shown[t->rows - 1] = true;
  if (most > 1) shown[0] = true;
  if (most > 2) shown[row_of_largest_force(t)] = true;
  mark_corners(in, t, most - count_marked(t, shown), shown);
  const long left = most - count_marked(t, shown);
  if (left > 0) mark_between(t, left, shown);
  for (int c = 0; c < t->column_count; c++) {
    if (!is_worth_showing(t, c)) continue;
    heading(&t->columns[c], text, sizeof text);
    fprintf(out, " %*s", WIDTH, text);
  }
  fputc('\n', out);
  for (long k = 0; k < t->rows; k++)
    if (shown[k]) print_row(t, k, out);
  free(shown);
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

static bool cannot_write(const char *path, char *error, size_t size) {
  const int reason = errno;
  snprintf(error, size, "cannot write `%s`: %s", path,
           reason ? strerror(reason) : "the HDF5 library refused");
  return false;
}

bool drive_write_csv(const drive_table *t, const char *path, char *error, size_t size) {
  whole_file whole;
  if (!whole_file_begin(&whole, path)) return cannot_write(path, error, size);
  FILE *out = fopen(whole.working, "w");
  bool good = out && write_rows(t, out);
  good = out && fclose(out) == 0 && good;
  return whole_file_end(&whole, good) || cannot_write(path, error, size);
}

static bool write_particles(const drive_input *in, const drive_table *t, hid_t file) {
  const bool bond = !t->of_families;
  const double s = bond ? in->bond.spacing : in->particle.spacing, reference[4] = {0, 0, s, 0};
  const double thickness = bond ? in->bond.thickness : in->particle.thickness;
  const double one = sqrt(3) / 2 * s * s * thickness, volume[2] = {one, one};
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
              h5_attribute_text(file, "title", in->simulation.title) &&
              write_particles(in, t, file) && h5_make_group(file, "/history");
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
  whole_file whole;
  if (!whole_file_begin(&whole, path)) return cannot_write(path, error, size);
  h5_quiet();
  errno = 0;
  hid_t file = h5_create(whole.working);
  bool good = file >= 0 && write_file(in, t, file);
  good = file >= 0 && H5Fclose(file) >= 0 && good;
  return whole_file_end(&whole, good) || cannot_write(path, error, size);
}

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
