#include "generator/study/study_info.h"

#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dsl/base/characters.h"
#include "dsl/base/units.h"
#include "generator/kernel/document.h"
#include "generator/study/study_table.h"
#include "runtime/base/ordinary_file.h"
#include "runtime/result/hdf5_tools.h"
#include "runtime/result/sealed_file.h"

enum { MOST_ROWS = 100000, MOST_COLUMNS = 10000 };

typedef struct table_file {
  arena *memory;
  study_table table;
  bool good;
} table_file;

/* A pipe would keep HDF5 waiting. What is sealed is a result: whether it is whole its own reader asks,
   before the library reads anything. */
static bool may_be_table(const char *path) {
  const char *why;
  const int handle = ordinary_file_open(path, O_RDONLY, &why);
  const bool good = handle >= 0 && sealed_file_state(handle) == SEAL_NONE;
  if (handle >= 0) close(handle);
  return good;
}

/* Closed by H5Fclose; negative: it is none. */
static hid_t open_table(const char *path) {
  h5_quiet();
  if (!may_be_table(path)) return -1;
  const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  if (file < 0) return file;
  if (h5_stays_inside(file) && h5_is_study_table(file)) return file;
  H5Fclose(file);
  return -1;
}

bool study_is_table(const char *path) {
  const hid_t file = open_table(path);
  if (file >= 0) H5Fclose(file);
  return file >= 0;
}

/* --- reading ---------------------------------------------------------------------------------- */

/* As many as there are rows; negative: none can be read. */
static int rows_of(hid_t set) {
  const hid_t space = H5Dget_space(set);
  const hssize_t count =
      H5Sget_simple_extent_ndims(space) == 1 ? H5Sget_simple_extent_npoints(space) : -1;
  H5Sclose(space);
  return count <= MOST_ROWS ? (int)count : -1;
}

static bool read_texts(arena *a, hid_t set, hid_t type, study_column *c, int rows) {
  char **texts = arena_alloc(a, ((size_t)rows + 1) * sizeof *texts);
  c->texts = arena_alloc(a, ((size_t)rows + 1) * sizeof *c->texts);
  if (H5Tis_variable_str(type) <= 0 || H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts) < 0)
    return false;
  for (int k = 0; k < rows; k++) {
    const char *text = texts[k] ? texts[k] : "";
    c->texts[k] = arena_text(a, text, strlen(text));
    H5free_memory(texts[k]);
  }
  return true;
}

static bool read_numbers(arena *a, hid_t set, study_column *c, int rows) {
  char unit_text[64];
  h5_read_attribute_text(set, "units", unit_text, sizeof unit_text);
  c->unit = *unit_text ? arena_text(a, unit_text, strlen(unit_text)) : "1";
  c->values = arena_alloc(a, ((size_t)rows + 1) * sizeof *c->values);
  return H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, c->values) >= 0;
}

/* "/table/energy:kinetic last" is the column "energy/kinetic last". */
static const char *column_name(arena *a, hid_t set) {
  static const char folder[] = "/table/";
  char path[1000] = "";
  const ssize_t length = H5Iget_name(set, path, sizeof path);
  if (length <= 0 || length >= (ssize_t)sizeof path || strncmp(path, folder, strlen(folder)) != 0)
    return NULL;
  for (char *c = path; *c; c++)
    if (*c == ':') *c = '/';
  return arena_text(a, path + strlen(folder), strlen(path) - strlen(folder));
}

static bool read_column(hid_t set, void *context) {
  table_file *t = context;
  const int rows = rows_of(set);
  study_column c = {.name = column_name(t->memory, set)};
  if (!c.name) return true; /* a curve */
  if (t->table.column_count == 0) t->table.rows = rows;
  t->good = rows >= 0 && rows == t->table.rows && t->table.column_count < MOST_COLUMNS;
  if (!t->good) return false;
  const hid_t type = H5Dget_type(set);
  t->good = H5Tget_class(type) == H5T_STRING ? read_texts(t->memory, set, type, &c, rows)
                                             : read_numbers(t->memory, set, &c, rows);
  H5Tclose(type);
  study_table_add(t->memory, &t->table, &c);
  return t->good;
}

static int by_name(const void *a, const void *b) {
  return strcmp(((const study_column *)a)->name, ((const study_column *)b)->name);
}

/* --- telling ---------------------------------------------------------------------------------- */

static const study_column *find_column(const study_table *t, const char *name) {
  for (int k = 0; k < t->column_count; k++)
    if (strcmp(t->columns[k].name, name) == 0) return &t->columns[k];
  return NULL;
}

static void print_column(const study_column *c, int rows) {
  double least = INFINITY, largest = -INFINITY;
  printf("  %s", name_shown(c->name));
  if (c->texts) {
    puts(": texts");
    return;
  }
  for (int k = 0; k < rows; k++) {
    if (c->values[k] < least) least = c->values[k];
    if (c->values[k] > largest) largest = c->values[k];
  }
  if (least <= largest)
    printf(": %.6g to %.6g%s%s\n", least, largest, unit_is_pure(c->unit) ? "" : " ",
           unit_is_pure(c->unit) ? "" : c->unit);
  else
    puts(": no values");
}

static void print_table(const char *path, const study_table *t) {
  const study_column *names = find_column(t, "case"), *ended = find_column(t, "ended");
  const size_t length = strlen(path);
  printf("The table of a study: %d case%s, whose results are in %.*s/\n\nColumns (/table/NAME)\n",
         t->rows, t->rows == 1 ? "" : "s",
         (int)(length > 3 && strcmp(path + length - 3, ".h5") == 0 ? length - 3 : length), path);
  for (int k = 0; k < t->column_count; k++)
    print_column(&t->columns[k], t->rows);
  puts("\nCases (curves: /cases/NAME/{time, x, y})");
  for (int k = 0; k < t->rows && names && names->texts; k++)
    printf("  %s%s%s\n", name_shown(names->texts[k]), ended && ended->texts ? ": " : "",
           ended && ended->texts ? name_shown(ended->texts[k]) : "");
}

bool study_info(const char *path, json *w) {
  table_file t = {.memory = arena_new(), .good = true};
  const hid_t file = open_table(path);
  const bool read = file >= 0 && h5_each_set(file, read_column, &t) && t.good;
  if (file >= 0) H5Fclose(file);
  if (!read) say_error("`%s` is a damaged table of a study", path);
  if (read) qsort(t.table.columns, (size_t)t.table.column_count, sizeof *t.table.columns, by_name);
  if (read && w) {
    json_put_text(w, "table", path);
    study_table_json(&t.table, "cases", w);
  } else if (read)
    print_table(path, &t.table);
  arena_free(t.memory);
  return read;
}
