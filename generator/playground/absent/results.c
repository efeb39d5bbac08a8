/* HDF5: a page writes no result files and reads none. What runs keep in memory is enough for it. */
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

result *result_open(const result_header *header, bool resume, char *error, size_t size) {
  (void)header, (void)resume;
  refuse(error, size);
  return NULL;
}

bool result_begin(result *r, char *error, size_t size) {
  (void)r;
  return refuse(error, size);
}

bool result_resume(result *r, const frame_mark *mark, char *error, size_t size) {
  (void)r, (void)mark;
  return refuse(error, size);
}

bool result_frame(result *r, double time, const double *const *values, char *error, size_t size) {
  (void)r, (void)time, (void)values;
  return refuse(error, size);
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
  (void)r, (void)e;
  return refuse(error, size);
}

void result_discard(result *r) {
  (void)r;
}

void result_close(result *r) {
  (void)r;
}

/* --- read ------------------------------------------------------------------------------------- */

result_file *result_read(const char *path, char *error, size_t size) {
  (void)path;
  refuse(error, size);
  return NULL;
}

void result_read_close(result_file *f) {
  (void)f;
}

const char *result_trouble(const result_file *f) {
  (void)f;
  return NULL;
}

result_names result_list(result_file *f, const char *group) {
  (void)f, (void)group;
  return (result_names){.count = 0};
}

double *result_read_series(result_file *f, const char *name, long *count, char *unit,
                           size_t unit_size, char *error, size_t size) {
  (void)f, (void)name, (void)count, (void)unit, (void)unit_size;
  refuse(error, size);
  return NULL;
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
