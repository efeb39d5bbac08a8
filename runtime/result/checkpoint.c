#include "runtime/result/checkpoint.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/hash.h"
#include "runtime/base/ordinary_file.h"
#include "runtime/base/whole_file.h"

static const char magic[8] = "PLATCKP2"; /* the digit is the version of the layout */

typedef struct stream { /* a file and the checksum of what has passed */
  FILE *file;
  const char *path;
  uint64_t sum;
  char *error;
  size_t error_size;
} stream;

static bool fail(stream *s, const char *what) {
  snprintf(s->error, s->error_size, "%s: %s", s->path, what);
  return false;
}

/* --- writing ---------------------------------------------------------------------------------- */

static bool put(stream *s, const void *data, size_t bytes) {
  if (bytes == 0) return true; /* an empty array may have no address */
  s->sum = hash_more(s->sum, data, bytes);
  if (fwrite(data, 1, bytes, s->file) == bytes) return true;
  return fail(s, strerror(errno));
}

static bool put_size(stream *s, size_t bytes) {
  const uint64_t n = bytes;
  return put(s, &n, sizeof n);
}

static bool put_all(stream *s, const char *fingerprint, const checkpoint_part *parts, int count) {
  bool good = put(s, magic, sizeof magic) && put_size(s, strlen(fingerprint)) &&
              put(s, fingerprint, strlen(fingerprint)) && put_size(s, (size_t)count);
  for (int k = 0; good && k < count; k++)
    good = put_size(s, parts[k].bytes);
  for (int k = 0; good && k < count; k++)
    good = put(s, parts[k].data, parts[k].bytes);
  const uint64_t sum = s->sum;
  return good && put(s, &sum, sizeof sum);
}

static bool write_working(stream *s, const char *fingerprint, const checkpoint_part *parts,
                          int count) {
  s->file = fopen(s->path, "wb");
  if (!s->file) return fail(s, strerror(errno));
  bool good = put_all(s, fingerprint, parts, count);
  if (good && fflush(s->file) != 0) good = fail(s, strerror(errno));
  if (fclose(s->file) != 0 && good) good = fail(s, strerror(errno));
  return good;
}

bool checkpoint_write(const char *path, const char *fingerprint, const checkpoint_part *parts,
                      int count, char *error, size_t size) {
  whole_file whole;
  stream s = {.path = path, .sum = HASH_START, .error = error, .error_size = size};
  if (!whole_file_begin(&whole, path)) return fail(&s, strerror(errno));
  s.path = whole.working;
  const bool good = write_working(&s, fingerprint, parts, count);
  s.path = path;
  return whole_file_end_on_disk(&whole, good) || (good && fail(&s, strerror(errno)));
}

/* --- reading ---------------------------------------------------------------------------------- */

static bool get(stream *s, void *data, size_t bytes) {
  if (bytes == 0) return true;
  if (fread(data, 1, bytes, s->file) != bytes) return fail(s, "the checkpoint is cut short");
  s->sum = hash_more(s->sum, data, bytes);
  return true;
}

static bool open_file(stream *s) {
  const char *why;
  const int file = ordinary_file_open(s->path, O_RDONLY | O_NOFOLLOW, &why);
  if (file < 0) return fail(s, why);
  s->file = fdopen(file, "rb");
  return s->file || fail(s, strerror(errno));
}

static off_t left_of(stream *s) {
  const off_t at = ftello(s->file);
  fseeko(s->file, 0, SEEK_END);
  const off_t left = ftello(s->file) - at;
  fseeko(s->file, at, SEEK_SET);
  return left;
}

static bool get_magic(stream *s) {
  char found[sizeof magic];
  if (!get(s, found, sizeof found)) return false;
  if (memcmp(found, magic, sizeof magic - 1) != 0)
    return fail(s, "this is not a checkpoint of perilat");
  if (found[sizeof magic - 1] != magic[sizeof magic - 1])
    return fail(s, "the checkpoint was written by another version of perilat");
  return true;
}

/* malloc'ed; NULL where the file ends before it does. */
static char *get_fingerprint(stream *s) {
  uint64_t length;
  if (!get(s, &length, sizeof length)) return NULL;
  if (length > (uint64_t)left_of(s)) {
    fail(s, "the checkpoint is cut short");
    return NULL;
  }
  char *found = must_calloc((size_t)length + 1, 1);
  if (get(s, found, (size_t)length)) {
    if (strlen(found) == length) return found;
    fail(s, "this is not a checkpoint of perilat");
  }
  free(found);
  return NULL;
}

/* Everything before the parts' sizes. */
static bool get_head(stream *s, const char *fingerprint, uint64_t *count) {
  char *found = get_magic(s) ? get_fingerprint(s) : NULL;
  if (!found) return false;
  bool good = strcmp(found, fingerprint) == 0 ||
              fail(s, "the checkpoint belongs to another deck, law or kernel");
  free(found);
  return good && get(s, count, sizeof *count);
}

char *checkpoint_fingerprint(const char *path) {
  char unsaid[512];
  stream s = {.path = path, .sum = HASH_START, .error = unsaid, .error_size = sizeof unsaid};
  char *found = open_file(&s) && get_magic(&s) ? get_fingerprint(&s) : NULL;
  if (s.file) fclose(s.file);
  return found;
}

/* Reads to the end: the last eight bytes must be the sum of all before. */
static bool check_whole(stream *s) {
  unsigned char block[1 << 16];
  fseeko(s->file, 0, SEEK_END);
  off_t left = ftello(s->file) - (off_t)sizeof(uint64_t);
  rewind(s->file);
  s->sum = HASH_START;
  if (left < 0) return fail(s, "the checkpoint is cut short");
  while (left > 0) {
    const size_t bytes = left > (off_t)sizeof block ? sizeof block : (size_t)left;
    if (!get(s, block, bytes)) return false;
    left -= (off_t)bytes;
  }
  const uint64_t sum = s->sum;
  uint64_t found;
  if (!get(s, &found, sizeof found)) return false;
  if (found != sum) return fail(s, "the checkpoint is damaged (its checksum is wrong)");
  rewind(s->file);
  return true;
}

static bool get_parts(stream *s, const char *fingerprint, const checkpoint_part *parts, int count) {
  uint64_t found, bytes;
  if (!get_head(s, fingerprint, &found)) return false;
  bool fits = found == (uint64_t)count;
  off_t all = (off_t)sizeof(uint64_t); /* parts and checksum */
  for (int k = 0; fits && k < count; k++) {
    if (!get(s, &bytes, sizeof bytes)) return false;
    fits = bytes == parts[k].bytes;
    all += (off_t)parts[k].bytes;
  }
  fits = fits && left_of(s) == all;
  if (!fits) return fail(s, "the checkpoint holds a state of another size");
  for (int k = 0; k < count; k++)
    if (!get(s, parts[k].data, parts[k].bytes)) return false;
  return true;
}

/* A file's magic and fingerprint are looked at first: "another deck" says more than "damaged". */
static bool open_checked(stream *s, const char *fingerprint) {
  uint64_t count;
  if (!open_file(s)) return false;
  if (!get_head(s, fingerprint, &count)) return false;
  rewind(s->file);
  return check_whole(s);
}

bool checkpoint_read(const char *path, const char *fingerprint, const checkpoint_part *parts,
                     int count, char *error, size_t size) {
  stream s = {.path = path, .sum = HASH_START, .error = error, .error_size = size};
  const bool good = open_checked(&s, fingerprint) && get_parts(&s, fingerprint, parts, count);
  if (s.file) fclose(s.file);
  return good;
}

static bool peek(stream *s, const char *fingerprint, void *data, size_t bytes) {
  uint64_t count, first;
  if (!get_head(s, fingerprint, &count)) return false;
  if (count < 1 || !get(s, &first, sizeof first)) return fail(s, "the checkpoint holds nothing");
  if (first != bytes || fseeko(s->file, (off_t)((count - 1) * sizeof first), SEEK_CUR) != 0)
    return fail(s, "the checkpoint holds a state of another size");
  return get(s, data, bytes);
}

bool checkpoint_peek(const char *path, const char *fingerprint, void *data, size_t bytes,
                     char *error, size_t size) {
  stream s = {.path = path, .sum = HASH_START, .error = error, .error_size = size};
  const bool good = open_checked(&s, fingerprint) && peek(&s, fingerprint, data, bytes);
  if (s.file) fclose(s.file);
  return good;
}
