#include <stdbool.h>
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

/* --- the tables ------------------------------------------------------------------------------- */

const command_entry commands[] = {
#define X(name, files, endings, purpose) {#name, files, endings, purpose},
    COMMANDS(X)
#undef X
};
const int command_count = (int)(sizeof commands / sizeof *commands);

const option_entry options[] = {
#define X(command, option, value, meaning) {#command, option, value, meaning},
    COMMAND_OPTIONS(X)
#undef X
};
enum { OPTION_COUNT = sizeof options / sizeof *options };
const int option_count = OPTION_COUNT;

int option_unknown_in(const char *program, const char *command, const char *given) {
  const char *names[OPTION_COUNT];
  int count = 0;
  for (int k = 0; k < OPTION_COUNT; k++)
    if (strcmp(options[k].command, command) == 0)
      names[count++] = options[k].name;
  const char *near = nearest_name(given, names, count);
  fprintf(stderr, "perilat: error: `%s` has no option `%s`", program, given);
  if (near)
    fprintf(stderr, "; did you mean `%s`?", near);
  fprintf(stderr, "\n  %s --help shows its usage\n", program);
  return 1;
}

int option_unknown(const char *command, const char *given) {
  char program[64];
  snprintf(program, sizeof program, "perilat %s", command);
  return option_unknown_in(program, command, given);
}

void options_print(const char *command, FILE *out) {
  size_t width = 0;
  for (int k = 0; k < OPTION_COUNT; k++) {
    size_t n = strlen(options[k].name) + 1 + strlen(options[k].value);
    if (strcmp(options[k].command, command) == 0 && n > width)
      width = n;
  }
  for (int k = 0; k < OPTION_COUNT; k++) {
    const option_entry *o = &options[k];
    if (strcmp(o->command, command) == 0)
      fprintf(out, "  %s %-*s  %s\n", o->name, (int)(width - strlen(o->name) - 1), o->value, o->meaning);
  }
}

void command_print(int k, FILE *out) {
  const char *name = commands[k].name;
  bool has_options = false;
  for (int o = 0; o < OPTION_COUNT; o++)
    has_options = has_options || strcmp(options[o].command, name) == 0;
  fprintf(out, "usage: perilat %s %s%s\n  %s\n", name, has_options ? "[options] " : "", commands[k].files,
          commands[k].purpose);
  if (has_options)
    fputs("\noptions:\n", out);
  options_print(name, out);
}
