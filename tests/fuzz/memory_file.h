/* A file in memory, with a path, so that a file's bytes can be tried by the thousand. */
#ifndef PERILAT_TESTS_MEMORY_FILE_H
#define PERILAT_TESTS_MEMORY_FILE_H

#include <string.h>
#include <unistd.h>

#include "tests/fuzz/recipe.h"

typedef struct memory_file {
  int handle;
  char path[64];
} memory_file;

/* In shared memory where there is such a folder: no disk, but a name (HDF5 wants to resolve it). */
static inline memory_file memory_file_new(void) {
  memory_file f = {.path = "/dev/shm/perilat_fuzz_XXXXXX"};
  f.handle = mkstemp(f.path);
  if (f.handle < 0) {
    strcpy(f.path, "/tmp/perilat_fuzz_XXXXXX");
    f.handle = mkstemp(f.path);
  }
  MUST(f.handle >= 0);
  return f;
}

static inline void memory_file_free(const memory_file *f) {
  close(f->handle);
  unlink(f->path);
}

static inline void memory_file_set(const memory_file *f, const void *bytes, size_t size) {
  MUST(ftruncate(f->handle, 0) == 0);
  MUST(pwrite(f->handle, bytes, size, 0) == (ssize_t)size);
}

/* malloc'ed */
static inline uint8_t *file_bytes(const char *path, size_t *size) {
  FILE *in = fopen(path, "rb");
  MUST(in && fseek(in, 0, SEEK_END) == 0);
  *size = (size_t)ftell(in);
  rewind(in);
  uint8_t *bytes = malloc(*size + 1);
  MUST(bytes && fread(bytes, 1, *size, in) == *size);
  fclose(in);
  return bytes;
}

/* Changes of a file that was right: first what is cut off its end, then places and what is written
   there. The number of bytes left is returned. */
static inline size_t recipe_damage(recipe *r, uint8_t *bytes, size_t size) {
  const size_t cut = (size_t)recipe_number(r, 2) % (size + 1);
  size_t left = size - cut;
  while (r->at < r->end && left) {
    const size_t from = (size_t)recipe_number(r, 3) % left;
    const int width = 1 + (int)(recipe_byte(r) & 7);
    for (int k = 0; k < width && from + (size_t)k < left; k++)
      bytes[from + (size_t)k] = (uint8_t)recipe_byte(r);
  }
  return left;
}

#endif
