#include "generator/kernel/standard_input.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

enum { LONGEST = 16 << 20 }; /* B: no text is longer */

bool is_standard_input(const char *path) {
  return strcmp(path, "-") == 0;
}

static char *read_all(size_t *length) {
  size_t room = 1 << 16, got;
  char *text = must_alloc(room);
  *length = 0;
  while ((got = fread(text + *length, 1, room - *length - 1, stdin)) > 0 && *length < LONGEST) {
    *length += got;
    if (*length + 1 == room) text = must_realloc(text, room *= 2);
  }
  text[*length] = 0;
  return text;
}

const char *standard_input(size_t *length, const char **why) {
  static char *text;
  static size_t read;
  static int failed;
  if (!text) {
    errno = 0;
    text = read_all(&read);
    failed = ferror(stdin) ? errno : 0;
  }
  *length = read;
  *why = failed ? strerror(failed) : NULL;
  return failed ? NULL : text;
}
