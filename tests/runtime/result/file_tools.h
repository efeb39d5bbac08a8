/* Whole files as bytes, for tests. Include after cmocka.h. */
#ifndef PERILAT_TESTS_FILE_TOOLS_H
#define PERILAT_TESTS_FILE_TOOLS_H

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

/* malloc'ed */
static inline unsigned char *read_file(const char *name, size_t *size) {
  struct stat about;
  FILE *in = fopen(name, "rb");
  assert_non_null(in);
  assert_int_equal(fstat(fileno(in), &about), 0);
  unsigned char *bytes = malloc((size_t)about.st_size + 1);
  *size = fread(bytes, 1, (size_t)about.st_size, in);
  fclose(in);
  return bytes;
}

static inline void write_file(const char *name, const void *bytes, size_t size) {
  FILE *out = fopen(name, "wb");
  assert_non_null(out);
  assert_int_equal(fwrite(bytes, 1, size, out), size);
  assert_int_equal(fclose(out), 0);
}

#endif
