/* perilat: one program, one subcommand a task. */
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "dsl/base/diagnostics.h"
#include "dsl/base/terminal.h"
#include "generator/command/commands.h"
#include "generator/command/completion.h"
#include "generator/command/manual.h"
#include "generator/kernel/document.h"
#include "generator/kernel/version.h"

/* In the order of `command_table`. */
static int (*const run[])(int argc, char **argv) = {
#define X(name, files, endings, purpose, status) command_##name,
    COMMANDS(X)
#undef X
};
enum { COMMAND_COUNT = sizeof run / sizeof *run };

static int print_help(FILE *out) {
  fputs("perilat: compiler and simulator for particle-lattice material laws\n\n"
        "usage: perilat COMMAND ...\n\n",
        out);
  for (int k = 0; k < COMMAND_COUNT; k++)
    fprintf(out, "  %-7s  %s\n           perilat %s %s\n", command_table[k].name,
            command_table[k].purpose, command_table[k].name, command_table[k].files);
  fputs("\n  perilat COMMAND --help   usage and options of one command\n"
        "  perilat --version\n\n"
        "Exit status: " COMMAND_STATUS ".\n",
        out);
  return 0;
}

static int unknown_command(const char *name) {
  const char *names[COMMAND_COUNT];
  for (int k = 0; k < COMMAND_COUNT; k++)
    names[k] = command_table[k].name;
  const char *near = nearest_name(name, names, COMMAND_COUNT);
  fprintf(stderr, "perilat: error: there is no command `%s`", name);
  if (near) fprintf(stderr, "; did you mean `%s`?", near);
  fputs("\n  perilat --help lists the commands\n", stderr);
  return 1;
}

static int dispatch(int argc, char **argv) {
  if (argc < 2) {
    print_help(stderr);
    return 1;
  }
  if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h") ||
      (argc == 2 && !strcmp(argv[1], "help")))
    return print_help(stdout);
  if (!strcmp(argv[1], "--version")) {
    printf("perilat %s\n", perilat_version);
    return 0;
  }
  if (argc == 3 && !strcmp(argv[1], "--write-manual")) /* these two are for the build */
    return manual_write(argv[2]);
  if (argc == 3 && !strcmp(argv[1], "--write-completion")) return completion_write(argv[2]);
  for (int k = 0; k < COMMAND_COUNT; k++) {
    if (strcmp(argv[1], command_table[k].name) != 0) continue;
    for (int a = 2; a < argc; a++)
      if (!strcmp(argv[a], "--help") || !strcmp(argv[a], "-h")) {
        command_print(k, stdout);
        return 0;
      }
    return run[k](argc - 2, argv + 2);
  }
  return unknown_command(argv[1]);
}

int main(int argc, char **argv) {
  signal(SIGXFSZ,
         SIG_IGN); /* a limit on file sizes then is an error of the write, like a full disk */
  terminal_begin();
  int status = dispatch(argc, argv);
  diag_print_topics(stderr);
  return end_output(status);
}
