#include "generator/study/study_read.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "generator/kernel/document.h"
#include "runtime/base/ordinary_file.h"
#include "runtime/result/hdf5_tools.h"
#include "runtime/result/sealed_file.h"

enum { MOST_ROWS = 100000, MOST_COLUMNS = 10000, MOST_SAMPLES = 100000000 };

typedef struct table_file {
  arena *memory;
  study_table table;
  bool good;
} table_file;

/* A pipe would keep HDF5 waiting. What is sealed is a result: whether it is whole its own reader
   asks, before the library reads anything. */
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

/* As people are shown them, then by name. */
static int by_place(const void *a, const void *b) {
  const study_column *p = a, *q = b;
  if (p->place != q->place) return p->place < q->place ? -1 : 1;
  return strcmp(p->name, q->name);
}

/* Which columns are shown, and in which order, an attribute says. */
static void find_places(hid_t file, study_table *t) {
  enum { LONGEST = 60000 };
  char *shown = must_calloc(LONGEST, 1);
  h5_read_attribute_text(file, "shown", shown, LONGEST);
  for (int k = 0; k < t->column_count; k++) {
    study_column *c = &t->columns[k];
    c->place = t->column_count;
    int at = 0;
    for (const char *line = shown; *line; at++) {
      const size_t length = strcspn(line, "\n");
      if (strlen(c->name) == length && memcmp(c->name, line, length) == 0) {
        c->shown = true;
        c->place = at;
      }
      line += length + (line[length] == '\n');
    }
  }
  free(shown);
  qsort(t->columns, (size_t)t->column_count, sizeof *t->columns, by_place);
}

/* --- curves ----------------------------------------------------------------------------------- */

/* NULL: there is none of that many values. */
static const double *read_values(arena *a, hid_t file, const char *group, const char *name,
                                 long *count, const char **unit_text) {
  char path[1200], found[64];
  snprintf(path, sizeof path, "%s/%s", group, name);
  const hid_t set =
      H5Lexists(file, group, H5P_DEFAULT) > 0 && H5Lexists(file, path, H5P_DEFAULT) > 0
          ? H5Dopen2(file, path, H5P_DEFAULT)
          : -1;
  if (set < 0) return NULL;
  const hid_t space = H5Dget_space(set);
  const hssize_t size =
      H5Sget_simple_extent_ndims(space) == 1 ? H5Sget_simple_extent_npoints(space) : -1;
  H5Sclose(space);
  double *values = NULL;
  if (size >= 0 && size <= MOST_SAMPLES && (*count < 0 || size == *count)) {
    values = arena_alloc(a, ((size_t)size + 1) * sizeof *values);
    if (H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) values = NULL;
    *count = (long)size;
  }
  h5_read_attribute_text(set, "units", found, sizeof found);
  *unit_text = *found ? arena_text(a, found, strlen(found)) : "1";
  H5Dclose(set);
  return values;
}

static void read_curve(arena *a, hid_t file, const char *name, study_curve *c) {
  char group[1000];
  const char *none;
  snprintf(group, sizeof group, "/cases/%.900s", name);
  for (char *at = group + strlen("/cases/"); *at; at++)
    if (*at == '/') *at = ':';
  *c = (study_curve){.name = name, .count = -1, .x_unit = "1", .y_unit = "1"};
  c->x = read_values(a, file, group, "x", &c->count, &c->x_unit);
  c->y = c->x ? read_values(a, file, group, "y", &c->count, &c->y_unit) : NULL;
  c->time = c->y ? read_values(a, file, group, "time", &c->count, &none) : NULL;
  if (!c->time) c->count = 0;
}

static const char *attribute_of(arena *a, hid_t file, const char *name) {
  char text[300];
  h5_read_attribute_text(file, name, text, sizeof text);
  return arena_text(a, text, strlen(text));
}

static void read_curves(arena *a, hid_t file, study_reading *r) {
  const study_column *names = study_reading_column(r, "case");
  r->x_name = attribute_of(a, file, "x");
  r->y_name = attribute_of(a, file, "y");
  study_curve *curves = arena_alloc(a, ((size_t)r->table.rows + 1) * sizeof *curves);
  for (int k = 0; k < r->table.rows && names && names->texts; k++)
    read_curve(a, file, names->texts[k], &curves[r->curve_count++]);
  r->curves = curves;
}

const study_column *study_reading_column(const study_reading *r, const char *name) {
  for (int k = 0; k < r->table.column_count; k++)
    if (strcmp(r->table.columns[k].name, name) == 0) return &r->table.columns[k];
  return NULL;
}

bool study_read(arena *a, const char *path, study_reading *r) {
  table_file t = {.memory = a, .good = true};
  const hid_t file = open_table(path);
  const bool read = file >= 0 && h5_each_set(file, read_column, &t) && t.good;
  *r = (study_reading){.curve_count = 0};
  if (read) {
    find_places(file, &t.table);
    r->table = t.table;
    read_curves(a, file, r);
  } else
    say_error("`%s` is a damaged table of a study", path);
  if (file >= 0) H5Fclose(file);
  return read;
}
