#include "generator/command/solver.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/terminal.h"
#include "generator/command/commands.h"
#include "generator/command/run_options.h"
#include "generator/kernel/document.h"

int perilat_solver_main(int argc, char **argv, const char *deck_name, const char *deck_text,
                        const built_in_law *laws, int law_count, const built_in_file *files,
                        int file_count) {
  run_options o = {.program = argv[0],
                   .deck_path = deck_name,
                   .deck_text = deck_text,
                   .laws = laws,
                   .law_count = law_count,
                   .files = files,
                   .file_count = file_count};
  signal(SIGXFSZ, SIG_IGN); /* as in perilat itself */
  terminal_begin();
  for (int a = 1; a < argc; a++)
    if (!strcmp(argv[a], "--help") || !strcmp(argv[a], "-h")) {
      printf("usage: %s [options]\n  runs the deck `%s` that it was built from\n\noptions:\n",
             argv[0], deck_name);
      options_print("solver", stdout);
      return end_output(0);
    }
  bool good = read_run_options(OF_SOLVER, argv[0], argc - 1, argv + 1, &o, NULL);
  int status = good ? run_as_asked(&o, NULL) : 1;
  free(o.overrides);
  return end_output(status);
}
