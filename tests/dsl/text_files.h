/* Files and commands for the tests of texts. */
#ifndef PERILAT_TESTS_TEXT_FILES_H
#define PERILAT_TESTS_TEXT_FILES_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include "dsl/base/arena.h"

static inline char *read_whole(FILE *in, size_t *length) {
  size_t room = 1 << 16, used = 0, n;
  char *text = must_alloc(room);
  while ((n = fread(text + used, 1, room - used - 1, in)) > 0) {
    used += n;
    if (used + 1 == room) text = must_realloc(text, room *= 2);
  }
  text[used] = 0;
  *length = used;
  return text;
}

/* NULL when there is no such file. */
static inline char *read_file(const char *path, size_t *length) {
  FILE *f = fopen(path, "rb");
  *length = 0;
  if (!f) return NULL;
  char *text = read_whole(f, length);
  fclose(f);
  return text;
}

static inline void write_file(const char *path, const char *text) {
  FILE *f = fopen(path, "wb");
  assert_non_null(f);
  fputs(text, f);
  assert_int_equal(fclose(f), 0);
}

/* What a shell command prints on its standard output, to be freed; its exit status in *status. */
static inline char *run_command(const char *command, int *status) {
  FILE *pipe = popen(command, "r");
  assert_non_null(pipe);
  size_t length;
  char *text = read_whole(pipe, &length);
  int ended = pclose(pipe);
  *status = WIFEXITED(ended) ? WEXITSTATUS(ended) : -1;
  return text;
}

/* With PERILAT_BLESS=1 in the environment the file is rewritten instead; read what changed. */
static inline void assert_golden(const char *path, const char *found) {
  const char *bless = getenv("PERILAT_BLESS");
  if (bless && strcmp(bless, "1") == 0) write_file(path, found);
  size_t length;
  char *expected = read_file(path, &length);
  if (!expected) fail_msg("there is no %s", path);
  if (strcmp(expected, found) != 0) fail_msg("%s\n--- found\n%s", path, found);
  free(expected);
}

#endif
