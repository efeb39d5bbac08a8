#include "generator/study/study_row.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "generator/kernel/document.h"
#include "generator/kernel/model.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_read.h"

/* malloc'ed; NULL after a message. */
static double *read_series(arena *a, result_file *f, const char *name, long *count,
                           const char **unit_text) {
  char error[2048], own_unit[64];
  double *read = result_read_series(f, name, count, own_unit, sizeof own_unit, error, sizeof error);
  if (!read) say_error("%s", error);
  *unit_text = read ? arena_text(a, own_unit, strlen(own_unit)) : NULL;
  return read;
}

static const double *series_of(arena *a, result_file *f, const char *name, long *count,
                               const char **unit_text) {
  double *read = read_series(a, f, name, count, unit_text);
  if (!read) return NULL;
  double *kept = arena_alloc(a, ((size_t)*count + 1) * sizeof *kept);
  if (*count) memcpy(kept, read, (size_t)*count * sizeof *kept);
  free(read);
  return kept;
}

static long peak_of(const double *values, long count) {
  long most = -1;
  for (long k = 0; k < count; k++)
    if (isfinite(values[k]) && (most < 0 || fabs(values[k]) > fabs(values[most]))) most = k;
  return most;
}

static bool read_history(arena *a, result_file *f, const study_row *row, const char *name,
                         study_history *h) {
  long count = 0;
  const char *unit_text;
  double *values = read_series(a, f, name, &count, &unit_text);
  if (!values) return false;
  const long most = peak_of(values, count);
  *h = (study_history){.name = arena_text(a, name, strlen(name)),
                       .unit = unit_text,
                       .peak = most < 0 ? NAN : values[most],
                       .peak_time = most < 0 || most >= row->count ? NAN : row->time[most],
                       .last = count ? values[count - 1] : NAN};
  free(values);
  return true;
}

static bool read_histories(arena *a, result_file *f, study_row *row) {
  result_names names = result_members(f, "/history");
  study_history *all = arena_alloc(a, ((size_t)names.count + 1) * sizeof *all);
  bool good = true;
  for (int k = 0; k < names.count && good; k++)
    good = read_history(a, f, row, names.items[k], &all[row->history_count++]);
  row->histories = all;
  result_names_free(&names);
  return good;
}

/* A monitor stands in no folder. */
static const char *usual_y(const study_row *row) {
  const char *first = NULL;
  for (int k = 0; k < row->history_count; k++) {
    const char *name = row->histories[k].name;
    if (strcmp(name, "load") == 0) return name;
    if (!first && !strchr(name, '/')) first = name;
  }
  return first ? first : "load";
}

static bool name_of(arena *a, result_file *f, const char *given, const char **name) {
  char found[512], error[2048];
  if (strcmp(given, "time") == 0)
    *name = "time";
  else if (result_find(f, "/history", given, found, sizeof found, error, sizeof error))
    *name = arena_text(a, found, strlen(found));
  else
    say_error("%s", error);
  return *name != NULL;
}

static bool read_curve(arena *a, result_file *f, const char *x, const char *y, study_row *row) {
  long counts[2] = {0, 0};
  if (!name_of(a, f, x ? x : "time", &row->x_name) ||
      !name_of(a, f, y ? y : usual_y(row), &row->y_name))
    return false;
  row->x = series_of(a, f, row->x_name, &counts[0], &row->x_unit);
  row->y = row->x ? series_of(a, f, row->y_name, &counts[1], &row->y_unit) : NULL;
  if (!row->y) return false;
  for (int k = 0; k < 2; k++)
    row->count = counts[k] < row->count ? counts[k] : row->count;
  const long most = peak_of(row->y, row->count);
  row->peak = most < 0 ? NAN : row->y[most];
  row->at = most < 0 ? NAN : row->x[most];
  return true;
}

static bool read_row(arena *a, result_file *f, const char *x, const char *y, study_row *row) {
  char *ended = result_read_words(f, "ended");
  const char *unit_text;
  row->there = true;
  row->ended = arena_text(a, ended, strlen(ended));
  free(ended);
  row->steps = result_read_number(f, "steps");
  row->step = result_read_number(f, "dt");
  row->wall = result_read_number(f, "wall_seconds");
  row->time = series_of(a, f, "time", &row->count, &unit_text);
  return row->time && read_histories(a, f, row) && read_curve(a, f, x, y, row);
}

/* The first error of its log, without what stands before. */
static const char *first_error(arena *a, const study_case *c) {
  enum { MOST = 1 << 20 };
  char error[1024];
  size_t length;
  char *text = read_text_file(c->log, MOST, &length, error, sizeof error);
  const char *at = text ? strstr(text, "error: ") : NULL, *words = "no result";
  if (at) words = arena_text(a, at + strlen("error: "), strcspn(at + strlen("error: "), "\n"));
  if (c->status > 128) words = arena_printf(a, "ended by signal %d", c->status - 128);
  free(text);
  return words;
}

bool study_row_read(arena *a, const study_case *c, const char *x, const char *y, study_row *row) {
  char error[2048];
  *row = (study_row){.of = c, .steps = NAN, .step = NAN, .wall = NAN, .peak = NAN, .at = NAN};
  result_file *f = c->state == STUDY_DONE ? result_read(c->result, error, sizeof error) : NULL;
  if (c->state == STUDY_DONE && !f) say_error("%s", error);
  if (!f) {
    row->ended = c->state == STUDY_WAITING ? "not run" : first_error(a, c);
    return c->state != STUDY_DONE;
  }
  const bool good = read_row(a, f, x, y, row);
  result_read_close(f);
  return good;
}

const study_history *study_row_history(const study_row *row, const char *name) {
  for (int k = 0; k < row->history_count; k++)
    if (strcmp(row->histories[k].name, name) == 0) return &row->histories[k];
  return NULL;
}
