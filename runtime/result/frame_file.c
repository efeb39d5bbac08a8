#include "runtime/result/frame_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dsl/base/arena.h"
#include "dsl/base/hash.h"
#include "runtime/base/ordinary_file.h"

static const char magic[24] = "perilat frames 2"; /* the digit is the version of the layout */

/* Magic, size of a record, length of the fingerprint; the fingerprint; then the records. */
typedef struct file_head {
  char magic[sizeof magic];
  uint64_t bytes, length;
} file_head;

struct frame_file {
  char *path, *fingerprint;
  int file;
  double *record;
  size_t numbers, bytes; /* of a record */
  off_t first;           /* where the records begin */
  frame_mark mark;
};

static bool fail(const frame_file *f, const char *what, char *error, size_t size) {
  snprintf(error, size, "cannot %s `%s`: %s", what, f->path, strerror(errno));
  return false;
}

static off_t end_of(const frame_file *f, int64_t frames) {
  return f->first + (off_t)f->bytes * (off_t)frames;
}

static bool write_all(int file, const void *data, size_t bytes) {
  const char *at = data;
  while (bytes > 0) {
    const ssize_t n = write(file, at, bytes);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    bytes -= (size_t)n;
  }
  return true;
}

static bool read_all(int file, void *data, size_t bytes, off_t from) {
  char *at = data;
  errno = 0;
  while (bytes > 0) {
    const ssize_t n = pread(file, at, bytes, from);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    from += n;
    bytes -= (size_t)n;
  }
  return true;
}

/* --- opening ---------------------------------------------------------------------------------- */

/* A run that ends removes the file, perhaps just before its lock came free. */
static bool has_its_name(int file, const char *path) {
  struct stat opened, named;
  return fstat(file, &opened) == 0 && lstat(path, &named) == 0 && opened.st_dev == named.st_dev &&
         opened.st_ino == named.st_ino;
}

/* The locked file, or -1 with a sentence. */
static int open_locked(const char *path, const char *result, bool there, char *error, size_t size) {
  for (;;) {
    const char *why;
    const int file = ordinary_file_open(path, O_RDWR | O_NOFOLLOW | (there ? 0 : O_CREAT), &why);
    if (file < 0) {
      snprintf(error, size, "cannot %s: `%s`: %s", there ? "resume" : "write the result", path,
               why);
      return -1;
    }
    if (flock(file, LOCK_EX | LOCK_NB) != 0) {
      snprintf(error, size,
               "another run is writing `%s`; wait for it, or give `result` another name in &output",
               result);
      close(file);
      return -1;
    }
    if (has_its_name(file, path)) return file;
    close(file);
  }
}

frame_file *frame_file_open(const char *result, const char *fingerprint, size_t numbers, bool there,
                            char *error, size_t size) {
  frame_file *f = must_calloc(1, sizeof *f);
  f->path = must_alloc(strlen(result) + sizeof FRAMES_ENDING);
  sprintf(f->path, "%s" FRAMES_ENDING, result);
  f->fingerprint = must_alloc(strlen(fingerprint) + 1);
  strcpy(f->fingerprint, fingerprint);
  f->numbers = numbers;
  f->bytes = numbers * sizeof *f->record;
  f->record = must_alloc(f->bytes + 1);
  f->first = (off_t)(sizeof(file_head) + strlen(fingerprint));
  f->file = open_locked(f->path, result, there, error, size);
  if (f->file >= 0) return f;
  frame_file_close(f);
  return NULL;
}

void frame_file_remove(frame_file *f) {
  unlink(f->path);
}

void frame_file_close(frame_file *f) {
  if (f->file >= 0) close(f->file);
  free(f->record);
  free(f->path);
  free(f->fingerprint);
  free(f);
}

/* --- beginning, resuming ---------------------------------------------------------------------- */

static file_head head_of(const frame_file *f) {
  file_head h = {.bytes = f->bytes, .length = strlen(f->fingerprint)};
  memcpy(h.magic, magic, sizeof magic);
  return h;
}

static frame_mark mark_of_none(const frame_file *f) {
  const file_head h = head_of(f);
  return (frame_mark){
      0, hash_more(hash_more(HASH_START, &h, sizeof h), f->fingerprint, strlen(f->fingerprint))};
}

bool frame_file_begin(frame_file *f, char *error, size_t size) {
  const file_head h = head_of(f);
  f->mark = mark_of_none(f);
  if (ftruncate(f->file, 0) == 0 && lseek(f->file, 0, SEEK_SET) == 0 &&
      write_all(f->file, &h, sizeof h) && write_all(f->file, f->fingerprint, (size_t)h.length))
    return true;
  return fail(f, "write", error, size);
}

static bool is_of_run(const frame_file *f) {
  const file_head h = head_of(f);
  file_head found;
  char *fingerprint = must_alloc((size_t)h.length + 1);
  const bool good = read_all(f->file, &found, sizeof found, 0) &&
                    memcmp(&found, &h, sizeof h) == 0 &&
                    read_all(f->file, fingerprint, (size_t)h.length, sizeof found) &&
                    memcmp(fingerprint, f->fingerprint, (size_t)h.length) == 0;
  free(fingerprint);
  return good;
}

bool frame_file_resume(frame_file *f, const frame_mark *mark, char *error, size_t size) {
  if (!is_of_run(f)) {
    snprintf(error, size, "`%s` does not hold the frames of the run to be resumed", f->path);
    return false;
  }
  if (mark->count > (lseek(f->file, 0, SEEK_END) - f->first) / (off_t)f->bytes) {
    snprintf(error, size, "`%s` holds fewer than the %lld frames that the checkpoint counts on",
             f->path, (long long)mark->count);
    return false;
  }
  const off_t end = end_of(f, mark->count);
  f->mark = *mark;
  if (!frame_file_each(f, NULL, NULL, error, size)) return false;
  return (ftruncate(f->file, end) == 0 && lseek(f->file, end, SEEK_SET) == end) ||
         fail(f, "write", error, size);
}

/* --- frames ----------------------------------------------------------------------------------- */

double *frame_file_record(frame_file *f) {
  return f->record;
}

bool frame_file_add(frame_file *f, char *error, size_t size) {
  const off_t end = end_of(f, f->mark.count);
  if (write_all(f->file, f->record, f->bytes)) {
    f->mark.count++;
    f->mark.sum = hash_words(f->mark.sum, f->record, f->numbers);
    return true;
  }
  fail(f, "write a frame to", error, size);
  if (ftruncate(f->file, end) == 0) lseek(f->file, end, SEEK_SET); /* drop what was written */
  return false;
}

frame_mark frame_file_mark(const frame_file *f) {
  return f->mark;
}

bool frame_file_sync(frame_file *f, char *error, size_t size) {
  return fsync(f->file) == 0 || fail(f, "bring to the disk", error, size);
}

bool frame_file_each(frame_file *f, frame_taker *take, void *context, char *error, size_t size) {
  uint64_t sum = mark_of_none(f).sum;
  bool read = true;
  for (int64_t k = 0; read && k < f->mark.count; k++) {
    read = read_all(f->file, f->record, f->bytes, end_of(f, k));
    if (read) sum = hash_words(sum, f->record, f->numbers);
    if (read && take && !take(context, k, f->record)) return false;
  }
  if (read && sum == f->mark.sum) return true;
  snprintf(error, size, "the frames in `%s` are damaged, or were changed since they were written",
           f->path);
  return false;
}
