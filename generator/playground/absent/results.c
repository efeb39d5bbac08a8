/* HDF5: a page writes no result files. Of what a run would write it keeps the histories, under the
   name of the file, until the next run of that name. */
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/drive/drive_hdf5.h"
#include "runtime/result/result.h"
#include "runtime/result/result_fields.h"
#include "runtime/result/result_find.h"
#include "runtime/result/result_read.h"

static bool refuse(char *error, size_t size) {
  snprintf(error, size, "there are no result files in the playground");
  return false;
}

bool drive_write_hdf5(const drive_input *in, const drive_table *t, const char *path, char *error,
                      size_t size) {
  (void)in, (void)t, (void)path;
  return refuse(error, size);
}

/* --- written ---------------------------------------------------------------------------------- */

typedef struct kept_series {
  char *name, *unit;
  double *values;
} kept_series;

/* A run's, while it goes on and when it has ended. */
struct result {
  result *next;
  char *path;
  kept_series *series;
  int series_count;
  long history_count;
};

static result *ended;

static double *copy_of(const double *values, long count) {
  double *copy = must_calloc((size_t)count + 1, sizeof *copy);
  memcpy(copy, values, (size_t)count * sizeof *copy);
  return copy;
}

static void forget(result *r) {
  for (int k = 0; k < r->series_count; k++) {
    free(r->series[k].name);
    free(r->series[k].unit);
    free(r->series[k].values);
  }
  free(r->series);
  free(r->path);
  free(r);
}

static result **find(const char *path) {
  result **at = &ended;
  while (*at && strcmp((*at)->path, path) != 0)
    at = &(*at)->next;
  return at;
}

result *result_open(const result_header *header, bool resume, char *error, size_t size) {
  if (resume) {
    refuse(error, size);
    return NULL;
  }
  result *r = must_calloc(1, sizeof *r);
  r->path = must_copy(header->path);
  return r;
}

bool result_begin(result *r, char *error, size_t size) {
  (void)r, (void)error, (void)size;
  return true;
}

bool result_resume(result *r, const frame_mark *mark, char *error, size_t size) {
  (void)r, (void)mark;
  return refuse(error, size);
}

bool result_frame(result *r, double time, const double *const *values, char *error, size_t size) {
  (void)r, (void)time, (void)values, (void)error, (void)size;
  return true;
}

frame_mark result_mark(const result *r) {
  (void)r;
  return (frame_mark){0, 0};
}

bool result_frames_hold(const result *r) {
  (void)r;
  return false;
}

bool result_sync(result *r, char *error, size_t size) {
  (void)r;
  return refuse(error, size);
}

void result_sidecar(const char *path, char *sidecar, size_t size) {
  snprintf(sidecar, size, "%s", path);
}

bool result_finish(result *r, const result_ending *e, char *error, size_t size) {
  (void)error, (void)size;
  result **before = find(r->path), *whole = must_calloc(1, sizeof *whole);
  whole->path = must_copy(r->path);
  whole->history_count = e->history_count;
  whole->series_count = e->series_count;
  whole->series = must_calloc((size_t)e->series_count + 1, sizeof *whole->series);
  for (int k = 0; k < e->series_count; k++)
    whole->series[k] = (kept_series){must_copy(e->series[k].name), must_copy(e->series[k].unit),
                                     copy_of(e->series[k].values, e->history_count)};
  result *old = *before;
  whole->next = old ? old->next : NULL;
  *before = whole;
  if (old) forget(old);
  return true;
}

void result_discard(result *r) {
  (void)r;
}

void result_close(result *r) {
  forget(r);
}

/* --- read ------------------------------------------------------------------------------------- */

struct result_file {
  const result *of;
};

result_file *result_read(const char *path, char *error, size_t size) {
  const result *found = *find(path);
  if (!found) {
    snprintf(error, size, "no run of this page is named `%s`", path);
    return NULL;
  }
  result_file *f = must_alloc(sizeof *f);
  f->of = found;
  return f;
}

void result_read_close(result_file *f) {
  free(f);
}

const char *result_trouble(const result_file *f) {
  (void)f;
  return NULL;
}

double *result_read_series(result_file *f, const char *name, long *count, char *unit,
                           size_t unit_size, char *error, size_t size) {
  for (int k = 0; k < f->of->series_count; k++) {
    const kept_series *s = &f->of->series[k];
    if (strcmp(s->name, name) != 0) continue;
    *count = f->of->history_count;
    snprintf(unit, unit_size, "%s", s->unit);
    return copy_of(s->values, *count);
  }
  snprintf(error, size, "the run has no history `%s`", name);
  return NULL;
}

result_names result_list(result_file *f, const char *group) {
  (void)f, (void)group;
  return (result_names){.count = 0};
}

double *result_read_reference(result_file *f, long *particles, int *dimensions) {
  (void)f, (void)particles, (void)dimensions;
  return NULL;
}

double *result_read_volume(result_file *f, long *particles) {
  (void)f, (void)particles;
  return NULL;
}

double *result_read_frame_times(result_file *f, long *frames) {
  (void)f, (void)frames;
  return NULL;
}

double *result_read_frame(result_file *f, const char *field, long frame, long *count,
                          int *components, char *unit, size_t unit_size, char *error, size_t size) {
  (void)f, (void)field, (void)frame, (void)count, (void)components, (void)unit, (void)unit_size;
  refuse(error, size);
  return NULL;
}

int32_t *result_read_bonds(result_file *f, const char *interaction, long *bonds) {
  (void)f, (void)interaction, (void)bonds;
  return NULL;
}

void *result_read_table(result_file *f, const char *path, bool integers, int least, int most,
                        long *rows_read, int *columns) {
  (void)f, (void)path, (void)integers, (void)least, (void)most;
  *rows_read = 0;
  *columns = 1;
  return NULL;
}

char *result_read_text(result_file *f, const char *path) {
  (void)f, (void)path;
  return NULL;
}
