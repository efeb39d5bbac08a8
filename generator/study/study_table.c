#include "generator/study/study_table.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/characters.h"
#include "dsl/base/digits.h"
#include "dsl/base/units.h"
#include "generator/kernel/document.h"
#include "runtime/base/whole_file.h"
#include "runtime/result/hdf5_tools.h"

/* --- columns ---------------------------------------------------------------------------------- */

static study_column *add_column(arena *a, study_table *t, const char *name, const char *unit_text) {
  t->columns = arena_room(a, t->columns, t->column_count, sizeof *t->columns);
  study_column *c = &t->columns[t->column_count++];
  *c = (study_column){.name = name, .unit = unit_text};
  const size_t rows = (size_t)t->rows + 1;
  c->texts = unit_text ? NULL : arena_alloc(a, rows * sizeof *c->texts);
  c->values = unit_text ? arena_alloc(a, rows * sizeof *c->values) : NULL;
  return c;
}

/* Numbers in one unit are a column of numbers. */
static void add_key(arena *a, study_table *t, const study_row *rows, const char *key, int k) {
  const char *common = NULL, *own;
  double number;
  bool numbers = t->rows > 0;
  for (int r = 0; r < t->rows && numbers; r++) {
    numbers = study_split_number(rows[r].of->values[k], &number, &own) &&
              (!common || strcmp(common, own) == 0) && (!*own || unit_is_whole(own, strlen(own)));
    common = own;
  }
  study_column *c = add_column(a, t, key, !numbers ? NULL : *common ? common : "1");
  c->shown = true;
  for (int r = 0; r < t->rows; r++)
    if (!numbers)
      c->texts[r] = rows[r].of->values[k];
    else
      study_split_number(rows[r].of->values[k], &c->values[r], &own);
}

/* Of the first row that has a result. */
static const study_row *first_there(const study_row *rows, int count) {
  for (int r = 0; r < count; r++)
    if (rows[r].there) return &rows[r];
  return NULL;
}

static void add_monitor(arena *a, study_table *t, const study_row *rows, const study_history *h,
                        bool last) {
  study_column *c =
      add_column(a, t, arena_printf(a, "%s %s", h->name, last ? "last" : "peak"), h->unit);
  for (int r = 0; r < t->rows; r++) {
    const study_history *own = study_row_history(&rows[r], h->name);
    c->values[r] = !own ? NAN : last ? own->last : own->peak;
  }
}

static void add_histories(arena *a, study_table *t, const study_row *rows, const study_row *model) {
  for (int k = 0; k < model->history_count; k++) {
    const study_history *h = &model->histories[k];
    const bool energy = strncmp(h->name, "energy/", 7) == 0;
    if (strcmp(h->name, model->y_name) != 0 && !energy) add_monitor(a, t, rows, h, false);
    add_monitor(a, t, rows, h, true);
  }
}

typedef enum row_number { ROW_PEAK, ROW_AT, ROW_STEPS, ROW_STEP, ROW_WALL } row_number;

static double number_of(const study_row *row, row_number which) {
  switch (which) {
  case ROW_PEAK:
    return row->peak;
  case ROW_AT:
    return row->at;
  case ROW_STEPS:
    return row->steps;
  case ROW_STEP:
    return row->step;
  default:
    return row->wall;
  }
}

static void add_number(arena *a, study_table *t, const study_row *rows, const char *name,
                       const char *unit_text, row_number which, bool shown) {
  study_column *c = add_column(a, t, name, unit_text);
  c->shown = shown;
  for (int r = 0; r < t->rows; r++)
    c->values[r] = number_of(&rows[r], which);
}

study_table study_table_of(arena *a, const study_row *rows, int count, const char *const *keys,
                           int key_count) {
  study_table t = {.rows = count};
  const study_row *model = first_there(rows, count);
  study_column *names = add_column(a, &t, "case", NULL);
  for (int r = 0; r < count; r++)
    names->texts[r] = rows[r].of->name;
  for (int k = 0; k < key_count; k++)
    add_key(a, &t, rows, keys[k], k);
  if (model) {
    const char *y = model->y_name, *x = model->x_name;
    add_number(a, &t, rows, arena_printf(a, "%s peak", y), model->y_unit, ROW_PEAK, true);
    add_number(a, &t, rows, arena_printf(a, "%s at peak", x), model->x_unit, ROW_AT, true);
    add_histories(a, &t, rows, model);
  }
  add_number(a, &t, rows, "steps", "1", ROW_STEPS, true);
  add_number(a, &t, rows, "time step", "s", ROW_STEP, false);
  add_number(a, &t, rows, "wall", "s", ROW_WALL, true);
  study_column *status = add_column(a, &t, "status", "1"), *ended;
  for (int r = 0; r < count; r++)
    status->values[r] = rows[r].there || rows[r].of->state == STUDY_FAILED
                            ? (double)rows[r].of->status
                            : (double)NAN;
  ended = add_column(a, &t, "ended", NULL);
  ended->shown = true;
  for (int r = 0; r < count; r++)
    ended->texts[r] = rows[r].ended;
  return t;
}

void study_table_add(arena *a, study_table *t, const study_column *c) {
  t->columns = arena_room(a, t->columns, t->column_count, sizeof *t->columns);
  t->columns[t->column_count++] = *c;
}

/* --- as text ---------------------------------------------------------------------------------- */

static void title_of(const study_column *c, char *text, size_t size) {
  if (!c->unit || unit_is_pure(c->unit))
    snprintf(text, size, "%s", c->name);
  else
    snprintf(text, size, "%s [%s]", c->name, c->unit);
}

/* With six digits, or with all. */
static void cell_of(const study_column *c, int row, bool whole, char *text, size_t size) {
  char number[DIGITS_TEXT] = "";
  if (!c->texts && isfinite(c->values[row]) && whole) fewest_digits(c->values[row], number);
  if (!c->texts && isfinite(c->values[row]) && !whole)
    snprintf(number, sizeof number, "%.6g", c->values[row]);
  snprintf(text, size, "%s", c->texts ? c->texts[row] : number);
}

enum { CELL = 120 };

void study_table_print(const study_table *t, const bool *wanted, FILE *out) {
  for (int row = -1; row < t->rows; row++) {
    if (row >= 0 && wanted && !wanted[row]) continue;
    fputs(" ", out);
    for (int k = 0; k < t->column_count; k++) {
      const study_column *c = &t->columns[k];
      char cell[CELL];
      size_t width = 0;
      if (!c->shown) continue;
      title_of(c, cell, sizeof cell);
      width = strlen(cell);
      for (int r = 0; r < t->rows && k + 1 < t->column_count; r++) {
        cell_of(c, r, false, cell, sizeof cell);
        width = strlen(cell) > width ? strlen(cell) : width;
      }
      if (row < 0)
        title_of(c, cell, sizeof cell);
      else
        cell_of(c, row, false, cell, sizeof cell);
      fprintf(out, c->texts ? " %-*s" : " %*s", (int)width, name_shown(cell));
      fputs(" ", out);
    }
    fputc('\n', out);
  }
}

/* In quotes where a comma or a quote would be taken for the end. */
static void put_cell(FILE *out, const char *text) {
  if (!strpbrk(text, ",\"\n\r")) {
    fputs(text, out);
    return;
  }
  fputc('"', out);
  for (; *text; text++)
    fprintf(out, *text == '"' ? "\"\"" : "%c", *text);
  fputc('"', out);
}

static void put_rows(const study_table *t, FILE *out) {
  char cell[4096];
  for (int row = -1; row < t->rows; row++)
    for (int k = 0; k < t->column_count; k++) {
      if (row < 0)
        title_of(&t->columns[k], cell, sizeof cell);
      else
        cell_of(&t->columns[k], row, true, cell, sizeof cell);
      put_cell(out, cell);
      fputc(k + 1 < t->column_count ? ',' : '\n', out);
    }
}

static bool cannot_write(const char *path) {
  say_error("cannot write `%s`: %s", path, strerror(errno ? errno : EIO));
  return false;
}

bool study_table_csv(const study_table *t, const char *path) {
  whole_file file;
  FILE *out = whole_file_open(&file, path);
  if (!out) return cannot_write(path);
  put_rows(t, out);
  const bool written = fflush(out) == 0 && !ferror(out);
  const bool closed = fclose(out) == 0;
  return whole_file_end(&file, written && closed) ? true : cannot_write(path);
}

/* --- HDF5 ------------------------------------------------------------------------------------- */

/* A name in HDF5 has no slash. */
static void path_in(char *path, size_t size, const char *group, const char *name) {
  const int head = snprintf(path, size, "%s/", group);
  snprintf(path + head, size - (size_t)head, "%s", name);
  for (char *c = path + head; *c; c++)
    if (*c == '/') *c = ':';
}

static bool write_columns(hid_t file, const study_table *t) {
  const hsize_t shape[] = {(hsize_t)t->rows};
  char path[1000];
  bool good = h5_make_group(file, "/table");
  for (int k = 0; k < t->column_count && good; k++) {
    const study_column *c = &t->columns[k];
    path_in(path, sizeof path, "/table", c->name);
    good = c->texts ? h5_write_texts(file, path, c->texts, t->rows)
                    : h5_write_doubles(file, path, c->values, 1, shape, c->unit);
  }
  return good;
}

/* Which columns are shown, in their order, a line each. */
static bool write_shown(hid_t file, const study_table *t) {
  char *text = NULL;
  size_t length;
  FILE *out = must_open_text(&text, &length);
  for (int k = 0; k < t->column_count; k++)
    if (t->columns[k].shown) fprintf(out, "%s\n", t->columns[k].name);
  must_close_text(out);
  const bool good = h5_attribute_text(file, "shown", text);
  free(text);
  return good;
}

static bool write_curve(hid_t file, const study_row *row) {
  char group[1000], path[1100];
  if (!row->there) return true;
  const hsize_t shape[] = {(hsize_t)row->count};
  path_in(group, sizeof group, "/cases", row->of->name);
  if (!h5_make_group(file, group)) return false;
  const char *const names[] = {"time", "x", "y"}, *const units[] = {"s", row->x_unit, row->y_unit};
  const double *const values[] = {row->time, row->x, row->y};
  bool good = true;
  for (int k = 0; k < 3 && good; k++) {
    snprintf(path, sizeof path, "%s/%s", group, names[k]);
    good = h5_write_doubles(file, path, values[k], 1, shape, units[k]);
  }
  return good;
}

static bool write_file(const char *path, const study_table *t, const study_row *rows) {
  h5_quiet();
  const hid_t file = h5_create(path);
  if (file < 0) return false;
  bool good = write_columns(file, t) && write_shown(file, t) && h5_make_group(file, "/cases");
  for (int r = 0; r < t->rows && good; r++)
    good = write_curve(file, &rows[r]);
  for (int r = 0; r < t->rows && good; r++)
    if (rows[r].there) {
      good = h5_attribute_text(file, "x", rows[r].x_name) &&
             h5_attribute_text(file, "y", rows[r].y_name);
      break;
    }
  return H5Fclose(file) >= 0 && good;
}

bool study_table_hdf5(const study_table *t, const study_row *rows, const char *path) {
  whole_file file;
  errno = 0;
  if (!whole_file_begin(&file, path)) return cannot_write(path);
  const bool good = write_file(file.working, t, rows);
  errno = 0; /* the library's own */
  return whole_file_end(&file, good) && good ? true : cannot_write(path);
}

/* --- JSON ------------------------------------------------------------------------------------- */

void study_table_json(const study_table *t, const char *list, json *w) {
  json_put_array(w, "columns");
  for (int k = 0; k < t->column_count; k++) {
    json_object(w);
    json_put_text(w, "name", t->columns[k].name);
    json_put_text(w, "unit", t->columns[k].unit);
    json_object_end(w);
  }
  json_array_end(w);
  json_put_array(w, list);
  for (int row = 0; row < t->rows; row++) {
    json_object(w);
    for (int k = 0; k < t->column_count; k++)
      if (t->columns[k].texts)
        json_put_text(w, t->columns[k].name, t->columns[k].texts[row]);
      else
        json_put_number(w, t->columns[k].name, t->columns[k].values[row]);
    json_object_end(w);
  }
  json_array_end(w);
}
