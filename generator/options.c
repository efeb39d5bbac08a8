#include <stdio.h>
#include <string.h>

#include "dsl/diagnostics.h"
#include "generator/commands.h"

int option_flag(char **argv, int *at, const char *name) {
  if (strcmp(argv[*at], name) != 0)
    return 0;
  ++*at;
  return 1;
}

const char *option_value(int argc, char **argv, int *at, const char *name, int *bad) {
  const char *given = argv[*at];
  size_t n = strlen(name);
  if (strncmp(given, name, n) != 0)
    return NULL;
  if (given[n] == '=') {
    ++*at;
    return given + n + 1;
  }
  if (given[n] != 0)
    return NULL;
  if (*at + 1 >= argc) {
    fprintf(stderr, "perilat: error: `%s` needs a value\n", name);
    *bad = 1;
    ++*at;
    return "";
  }
  *at += 2;
  return argv[*at - 1];
}

int option_unknown(const char *program, const char *given, const char *const *options, int count) {
  fprintf(stderr, "perilat: error: `%s` has no option `%s`", program, given);
  const char *near = nearest_name(given, options, count);
  if (near)
    fprintf(stderr, "; did you mean `%s`?", near);
  fprintf(stderr, "\n  %s --help shows its usage\n", program);
  return 1;
}
