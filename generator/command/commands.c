#include "generator/command/commands.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "dsl/base/diagnostics.h"
#include "generator/kernel/document.h"
#include "generator/kernel/standard_input.h"

int option_flag(char **argv, int *at, const char *name) {
  if (strcmp(argv[*at], name) != 0) return 0;
  ++*at;
  return 1;
}

/* Files and numbers may begin with a `-`. */
static bool is_option(const char *given) {
  for (int k = 0; k < option_count; k++)
    if (strcmp(given, option_table[k].name) == 0) return true;
  return false;
}

const char *option_value(int argc, char **argv, int *at, const char *name, int *bad) {
  const char *given = argv[*at];
  size_t n = strlen(name);
  if (strncmp(given, name, n) != 0) return NULL;
  if (given[n] == '=') {
    ++*at;
    return given + n + 1;
  }
  if (given[n] != 0) return NULL;
  if (*at + 1 >= argc || is_option(argv[*at + 1])) {
    say_error("`%s` needs a value", name);
    *bad = 1;
    ++*at;
    return "";
  }
  *at += 2;
  return argv[*at - 1];
}

/* --- the tables ------------------------------------------------------------------------------- */

const command_entry command_table[] = {
#define X(name, files, endings, purpose, status) {#name, files, endings, purpose, status},
    COMMANDS(X)
#undef X
};
const int command_count = (int)(sizeof command_table / sizeof *command_table);

const option_entry option_table[] = {
#define X(command, option, value, meaning) {#command, option, value, meaning},
    COMMAND_OPTIONS(X)
#undef X
};
enum { OPTION_COUNT = sizeof option_table / sizeof *option_table };
const int option_count = OPTION_COUNT;

bool is_option_like(const char *given) {
  return given[0] == '-' && !is_standard_input(given);
}

int option_unknown_in(const char *program, const char *command, const char *given) {
  if (is_standard_input(given)) {
    say_error("`%s` does not read the standard input; give it a file", program);
    return 1;
  }
  const char *names[OPTION_COUNT];
  int count = 0;
  for (int k = 0; k < OPTION_COUNT; k++)
    if (strcmp(option_table[k].command, command) == 0) names[count++] = option_table[k].name;
  const char *near = nearest_name(given, names, count);
  fprintf(stderr, "perilat: error: `%s` has no option `%s`", program, given);
  if (near) fprintf(stderr, "; did you mean `%s`?", near);
  fprintf(stderr, "\n  %s --help shows its usage\n", program);
  return 1;
}

int option_unknown(const char *command, const char *given) {
  char program[64];
  snprintf(program, sizeof program, "perilat %s", command);
  return option_unknown_in(program, command, given);
}

bool command_has_options(const char *command) {
  for (int k = 0; k < OPTION_COUNT; k++)
    if (strcmp(option_table[k].command, command) == 0) return true;
  return false;
}

void options_print(const char *command, FILE *out) {
  size_t width = 0;
  for (int k = 0; k < OPTION_COUNT; k++) {
    size_t n = strlen(option_table[k].name) + 1 + strlen(option_table[k].value);
    if (strcmp(option_table[k].command, command) == 0 && n > width) width = n;
  }
  for (int k = 0; k < OPTION_COUNT; k++) {
    const option_entry *o = &option_table[k];
    if (strcmp(o->command, command) == 0)
      fprintf(out, "  %s %-*s  %s\n", o->name, (int)(width - strlen(o->name) - 1), o->value,
              o->meaning);
  }
}

void command_print(int k, FILE *out) {
  const command_entry *c = &command_table[k];
  const bool has_options = command_has_options(c->name);
  fprintf(out, "usage: perilat %s %s%s\n  %s\n", c->name, has_options ? "[options] " : "", c->files,
          c->purpose);
  if (has_options) fputs("\noptions:\n", out);
  options_print(c->name, out);
  fprintf(out, "\nExit status: %s.\n", c->status);
}
