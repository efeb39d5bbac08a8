#include "runtime/result.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "dsl/arena.h"
#include "runtime/hdf5_tools.h"
#include "runtime/xdmf.h"

#define FRAMES_MAGIC "perilat frames 1\n"
enum { MAGIC_LENGTH = sizeof FRAMES_MAGIC - 1, COMPRESSION_LEVEL = 4, PATH_LENGTH = 4096 };

struct result {
  result_header header;
  char path[PATH_LENGTH], working[PATH_LENGTH];
  int file; /* working file: magic, record length, then records of time and all fields */
  long frames;
  size_t record; /* bytes of one frame */
};

static off_t frame_offset(const result *r, long frame) {
  return (off_t)(MAGIC_LENGTH + sizeof(uint64_t) + (size_t)frame * r->record);
}

static bool write_all(int file, const void *data, size_t size) {
  const char *at = data;
  while (size > 0) {
    ssize_t n = write(file, at, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    size -= (size_t)n;
  }
  return true;
}

static bool read_all(int file, void *data, size_t size, off_t offset) {
  char *at = data;
  while (size > 0) {
    ssize_t n = pread(file, at, size, offset);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    offset += n;
    size -= (size_t)n;
  }
  return true;
}

/* --- working file ----------------------------------------------------------------------------- */

static bool start_working(result *r, char *error, size_t size) {
  uint64_t record = r->record;
  if (ftruncate(r->file, 0) == 0 && write_all(r->file, FRAMES_MAGIC, MAGIC_LENGTH) &&
      write_all(r->file, &record, sizeof record))
    return true;
  snprintf(error, size, "cannot write `%s`: %s", r->working, strerror(errno));
  return false;
}

static bool keep_working_frames(result *r, long frames, char *error, size_t size) {
  char magic[MAGIC_LENGTH];
  uint64_t record = 0;
  off_t end = frame_offset(r, frames);
  if (!read_all(r->file, magic, MAGIC_LENGTH, 0) ||
      memcmp(magic, FRAMES_MAGIC, MAGIC_LENGTH) != 0 ||
      !read_all(r->file, &record, sizeof record, MAGIC_LENGTH) || record != r->record) {
    snprintf(error, size, "`%s` does not hold the frames of the run to be resumed", r->working);
    return false;
  }
  if (lseek(r->file, 0, SEEK_END) < end) {
    snprintf(error, size, "`%s` holds fewer than the %ld frames that the checkpoint counts on",
             r->working, frames);
    return false;
  }
  r->frames = frames;
  if (ftruncate(r->file, end) == 0 && lseek(r->file, end, SEEK_SET) == end) return true;
  snprintf(error, size, "cannot write `%s`: %s", r->working, strerror(errno));
  return false;
}

static bool lock_working(result *r, char *error, size_t size) {
  if (flock(r->file, LOCK_EX | LOCK_NB) == 0) return true;
  snprintf(error, size,
           "another run is writing `%s`; wait for it, or give `result` another name in &output",
           r->path);
  return false;
}

result *result_open(const result_header *header, long resume_frames, char *error, size_t size) {
  result *r = must_calloc(1, sizeof *r);
  r->header = *header;
  if (snprintf(r->path, sizeof r->path, "%s", header->path) >= PATH_LENGTH - 16) {
    snprintf(error, size, "the result's path is too long");
    free(r);
    return NULL;
  }
  snprintf(r->working, sizeof r->working, "%.4080s.frames", header->path);
  r->header.path = r->path;
  r->record = sizeof(double);
  for (int k = 0; k < header->field_count; k++)
    r->record +=
        sizeof(double) * (size_t)header->fields[k].count * (size_t)header->fields[k].components;
  r->file = open(r->working, resume_frames >= 0 ? O_RDWR : O_RDWR | O_CREAT, 0666);
  if (r->file < 0) {
    snprintf(error, size, "cannot %s: `%s`: %s", resume_frames >= 0 ? "resume" : "write the result",
             r->working, strerror(errno));
    free(r);
    return NULL;
  }
  bool locked = lock_working(r, error, size);
  if (locked && (resume_frames >= 0 ? keep_working_frames(r, resume_frames, error, size)
                                    : start_working(r, error, size)))
    return r;
  if (locked && resume_frames < 0) unlink(r->working);
  close(r->file);
  free(r);
  return NULL;
}

bool result_frame(result *r, double time, const double *const *values, char *error, size_t size) {
  bool good = write_all(r->file, &time, sizeof time);
  for (int k = 0; good && k < r->header.field_count; k++) {
    const result_field *f = &r->header.fields[k];
    good = write_all(r->file, values[k], sizeof(double) * (size_t)f->count * (size_t)f->components);
  }
  if (good) {
    r->frames++;
    return true;
  }
  snprintf(error, size, "cannot write a frame to `%s`: %s", r->working, strerror(errno));
  if (ftruncate(r->file, frame_offset(r, r->frames)) == 0) /* drop the part that was written */
    lseek(r->file, frame_offset(r, r->frames), SEEK_SET);
  return false;
}

long result_frame_count(const result *r) {
  return r->frames;
}

bool result_sync(result *r, char *error, size_t size) {
  if (fsync(r->file) == 0) return true;
  snprintf(error, size, "cannot write `%s` to the disk: %s", r->working, strerror(errno));
  return false;
}

void result_discard(result *r) {
  unlink(r->working);
}

void result_close(result *r) {
  close(r->file);
  free(r);
}

/* --- the HDF5 file ---------------------------------------------------------------------------- */

static bool write_particles(hid_t file, const result_header *h) {
  hsize_t places[2] = {(hsize_t)h->particle_count, (hsize_t)h->dimensions};
  hsize_t one[1] = {(hsize_t)h->particle_count};
  hsize_t bonds[2] = {(hsize_t)h->bond_count, 2};
  char name[256];
  snprintf(name, sizeof name, "/bonds/%s", h->interaction);
  return h5_make_group(file, "/particles") && h5_make_group(file, "/bonds") &&
         h5_write_doubles(file, "/particles/reference", h->reference, 2, places, "m") &&
         h5_write_doubles(file, "/particles/volume", h->volume, 1, one, "m^3") &&
         h5_write_integers(file, "/particles/body", h->body, 1, one) &&
         (!h->resolved || h5_write_integers(file, "/particles/resolved", h->resolved, 1, one)) &&
         h5_write_integers(file, name, h->bonds, 2, bonds);
}

static bool write_texts(hid_t file, const char *group, const result_text *texts, int count) {
  bool good = h5_make_group(file, group);
  for (int k = 0; good && k < count; k++) {
    char name[512];
    snprintf(name, sizeof name, "%s/%s", group, texts[k].name);
    good = H5Lexists(file, name, H5P_DEFAULT) > 0 || h5_write_text(file, name, texts[k].text);
  }
  return good;
}

static bool write_input(hid_t file, const result_header *h) {
  return h5_make_group(file, "/input") && h5_write_text(file, "/input/deck", h->deck_text) &&
         (!h->overrides || !*h->overrides || h5_write_text(file, "/input/set", h->overrides)) &&
         write_texts(file, "/input/models", h->models, h->model_count) &&
         write_texts(file, "/input/kernels", h->kernels, h->kernel_count) &&
         (h->file_count == 0 || write_texts(file, "/input/files", h->files, h->file_count));
}

static bool write_verdict(hid_t file, const char *name, const result_series *s) {
  if (!s->judges) return true;
  hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
  const bool good = set >= 0 && h5_attribute_integer(set, "checked", s->unchecked == NULL) &&
                    (!s->unchecked || h5_attribute_text(set, "unchecked", s->unchecked));
  if (set >= 0) H5Dclose(set);
  return good;
}

static bool write_history(hid_t file, const double *time, long count, const result_series *series,
                          int series_count) {
  hsize_t n[1] = {(hsize_t)count};
  bool good = h5_make_group(file, "/history") && h5_make_group(file, "/history/energy") &&
              h5_write_doubles(file, "/history/time", time, 1, n, "s");
  for (int k = 0; good && k < series_count; k++) {
    char name[512];
    snprintf(name, sizeof name, "/history/%s", series[k].name);
    good = h5_write_doubles(file, name, series[k].values, 1, n, series[k].unit) &&
           write_verdict(file, name, &series[k]);
  }
  return good;
}

/* One field of all frames, a frame at a time, out of the working file. `skip` bytes of a record stand before it. */
static bool write_field(hid_t file, const result *r, const result_field *f, size_t skip,
                        double *buffer) {
  char name[512];
  if (f->interaction)
    snprintf(name, sizeof name, "/frames/%s/%s", f->interaction, f->name);
  else
    snprintf(name, sizeof name, "/frames/%s", f->name);
  hsize_t shape[3] = {(hsize_t)r->frames, (hsize_t)f->count, (hsize_t)f->components};
  hid_t set = h5_make_frames(file, name, f->interaction ? 2 : 3, shape, f->unit, COMPRESSION_LEVEL);
  size_t bytes = sizeof(double) * (size_t)f->count * (size_t)f->components;
  bool good = set >= 0 && h5_attribute_text(set, "kind", f->kind);
  for (long frame = 0; good && frame < r->frames; frame++)
    good = read_all(r->file, buffer, bytes, frame_offset(r, frame) + (off_t)skip) &&
           h5_write_frame(set, frame, f->interaction ? 2 : 3, shape, buffer);
  if (set >= 0) good = H5Dclose(set) >= 0 && good;
  return good;
}

static bool write_frames(hid_t file, const result *r) {
  const result_header *h = &r->header;
  double *buffer = must_alloc(r->record);
  double *times = must_calloc((size_t)r->frames + 1, sizeof *times);
  bool good = h5_make_group(file, "/frames");
  for (long frame = 0; good && frame < r->frames; frame++)
    good = read_all(r->file, &times[frame], sizeof(double), frame_offset(r, frame));
  hsize_t n[1] = {(hsize_t)r->frames};
  good = good && h5_write_doubles(file, "/frames/time", times, 1, n, "s");
  size_t skip = sizeof(double);
  for (int k = 0; good && k < h->field_count; k++) {
    char group[512];
    snprintf(group, sizeof group, "/frames/%s",
             h->fields[k].interaction ? h->fields[k].interaction : "");
    good = (!h->fields[k].interaction || h5_make_group(file, group)) &&
           write_field(file, r, &h->fields[k], skip, buffer);
    skip += sizeof(double) * (size_t)h->fields[k].count * (size_t)h->fields[k].components;
  }
  free(buffer);
  free(times);
  return good;
}

static bool write_attributes(hid_t file, const result_header *h, double dt, long steps) {
  return h5_attribute_text(file, "perilat_version", h->version) &&
         h5_attribute_text(file, "started", h->started) &&
         h5_attribute_text(file, "title", h->title) &&
         h5_attribute_text(file, "kernel_key", h->kernel_key) &&
         h5_attribute_double(file, "dt", dt) && h5_attribute_integer(file, "steps", steps);
}

static bool fail(const char *temporary, const char *path, char *error, size_t size) {
  int reason = errno;
  unlink(temporary);
  snprintf(error, size, "cannot write the result `%s`: %s", path,
           reason ? strerror(reason) : "the HDF5 library refused");
  return false;
}

bool result_finish(result *r, double dt, long steps, const double *time, long history_count,
                   const result_series *series, int series_count, bool keep_working, char *error,
                   size_t size) {
  char temporary[PATH_LENGTH + 16];
  snprintf(temporary, sizeof temporary, "%s.part", r->path);
  h5_quiet();
  errno = 0;
  hid_t file = h5_create(temporary);
  if (file < 0) return fail(temporary, r->path, error, size);
  bool good = write_attributes(file, &r->header, dt, steps) && write_input(file, &r->header) &&
              write_particles(file, &r->header) &&
              write_history(file, time, history_count, series, series_count) &&
              write_frames(file, r) && H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0;
  good = H5Fclose(file) >= 0 && good;
  good = good && sync_file(temporary) && rename(temporary, r->path) == 0;
  if (!good) return fail(temporary, r->path, error, size);
  if (!xdmf_write(&r->header, r->file, r->frames, r->record, frame_offset(r, 0), error, size))
    return false;
  if (!keep_working) unlink(r->working);
  return true;
}
