#include "runtime/result/result_read.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/characters.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_sets.h"

void result_read_unchecked(result_file *f, const char *name, char *why, size_t size) {
  char error[2048];
  hid_t set = result_set_named(f, "/history", name, error, sizeof error);
  if (size > 0) *why = 0;
  if (set < 0) return;
  h5_read_attribute_text(set, "unchecked", why, size);
  H5Dclose(set);
}

double *result_read_series(result_file *f, const char *name, long *count, char *unit_text,
                           size_t unit_size, char *error, size_t size) {
  hid_t set = result_set_named(f, "/history", name, error, size);
  if (set < 0) return NULL;
  hsize_t shape[3];
  double *values = result_set_read(f, set, H5T_NATIVE_DOUBLE, sizeof *values, 1, shape);
  if (values) {
    *count = (long)shape[0];
    h5_read_attribute_text(set, "units", unit_text, unit_size);
  } else
    snprintf(error, size, "%s", f->trouble);
  H5Dclose(set);
  return values;
}

void *result_read_table(result_file *f, const char *path, bool integers, int least, int most,
                        long *rows_read, int *columns) {
  const int rank = most > 1 ? 2 : 1;
  hid_t set = result_set_open(f, path);
  hsize_t shape[3] = {0, 0, 0};
  const hid_t type = integers ? H5T_NATIVE_INT32 : H5T_NATIVE_DOUBLE;
  const size_t width = integers ? sizeof(int32_t) : sizeof(double);
  void *values = set >= 0 ? result_set_read(f, set, type, width, rank, shape) : NULL;
  if (values && rank == 2 && (shape[1] < (hsize_t)least || shape[1] > (hsize_t)most)) {
    result_set_report(f, set);
    free(values);
    values = NULL;
  }
  *rows_read = values ? (long)shape[0] : 0;
  *columns = values && rank == 2 ? (int)shape[1] : 1;
  if (set >= 0) H5Dclose(set);
  return values;
}

double *result_read_reference(result_file *f, long *particles, int *dimensions) {
  return result_read_table(f, "/particles/reference", false, 2, 3, particles, dimensions);
}

double *result_read_volume(result_file *f, long *particles) {
  int columns;
  return result_read_table(f, "/particles/volume", false, 1, 1, particles, &columns);
}

double *result_read_spacing(result_file *f, long *particles) {
  int columns;
  result_names all = result_members(f, "/particles");
  const bool graded = result_names_find(&all, "spacing") >= 0;
  result_names_free(&all);
  return graded ? result_read_table(f, "/particles/spacing", false, 1, 1, particles, &columns)
                : NULL;
}

double *result_read_frame_times(result_file *f, long *frames) {
  int columns;
  return result_read_table(f, "/frames/time", false, 1, 1, frames, &columns);
}

/* Cracks, and lines of monitors that cracks cut. */
static void say_no_cracks(result_file *f, const char *name, char *error, size_t size) {
  result_names there = result_list(f, "/cracks");
  int n = snprintf(error, size, "`%s` has no crack, and no cracks of a monitor, `%s`", f->path,
                   name_shown(name));
  for (int k = 0; k < there.count && n > 0 && (size_t)n < size; k++)
    n += snprintf(error + n, size - (size_t)n, "%s`%s`", k ? ", " : "; it has ",
                  name_shown(there.items[k]));
  if (there.count == 0 && n > 0 && (size_t)n < size)
    snprintf(error + n, size - (size_t)n,
             ": it holds them where the deck has a &crack, or a monitor of the kind 'crack_width'");
  result_names_free(&there);
}

/* "/cracks/notch/points" */
static void name_path(const char *crack, char path[600]) {
  snprintf(path, 600, "/cracks/%.500s/points", crack);
}

bool result_has_path(result_file *f, const char *crack) {
  char path[600];
  name_path(crack, path);
  const hid_t set = strchr(crack, '/') ? -1 : result_set_open(f, path);
  if (set >= 0) H5Dclose(set);
  return set >= 0;
}

/* [frames][most][2]. */
static double *read_pairs(result_file *f, const char *path, const char *name, long *frames,
                          long *most, char *error, size_t size) {
  hsize_t shape[3] = {0, 0, 0};
  const hid_t set = strchr(name, '/') ? -1 : result_set_open(f, path);
  if (set < 0) {
    say_no_cracks(f, name, error, size);
    return NULL;
  }
  double *values = result_set_read(f, set, H5T_NATIVE_DOUBLE, sizeof *values, 3, shape);
  if (values && shape[2] != 2) {
    result_set_report(f, set);
    free(values);
    values = NULL;
  }
  if (!values) snprintf(error, size, "%s", f->trouble);
  *frames = (long)shape[0];
  *most = (long)shape[1];
  H5Dclose(set);
  return values;
}

double *result_read_cracks(result_file *f, const char *monitor, long *frames, long *most,
                           char *error, size_t size) {
  char path[512];
  snprintf(path, sizeof path, "/cracks/%.500s", monitor);
  return read_pairs(f, path, monitor, frames, most, error, size);
}

double *result_read_path(result_file *f, const char *crack, long *frames, long *most, char *error,
                         size_t size) {
  char path[600];
  name_path(crack, path);
  return read_pairs(f, path, crack, frames, most, error, size);
}

char *result_read_text(result_file *f, const char *path) {
  hid_t set = result_set_open(f, path);
  if (set < 0) return NULL;
  char *text = h5_read_text(set);
  if (!text) result_set_report(f, set);
  H5Dclose(set);
  return text;
}

char *result_read_words(result_file *f, const char *name) {
  char words[1024];
  h5_read_attribute_text(f->file, name, words, sizeof words);
  char *copy = must_calloc(strlen(words) + 1, 1);
  return strcpy(copy, words);
}

double result_read_number(result_file *f, const char *name) {
  double value = NAN;
  if (H5Aexists(f->file, name) <= 0) return value;
  const hid_t a = H5Aopen(f->file, name, H5P_DEFAULT), space = a >= 0 ? H5Aget_space(a) : -1;
  if (space < 0 || H5Sget_simple_extent_npoints(space) != 1 ||
      H5Aread(a, H5T_NATIVE_DOUBLE, &value) < 0)
    value = NAN;
  if (space >= 0) H5Sclose(space);
  if (a >= 0) H5Aclose(a);
  return value;
}

char *result_read_title(result_file *f) {
  return result_read_words(f, "title");
}
