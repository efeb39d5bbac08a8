/* Runs the program on a terminal of its own, of so many columns, and reads what it shows there. */
#ifndef PERILAT_TESTS_PSEUDO_TERMINAL_H
#define PERILAT_TESTS_PSEUDO_TERMINAL_H

#include <fcntl.h>
#include <stdlib.h>
#include <sys/ioctl.h>

#include "tests/generator/command_tools.h"

/* Both outputs of a line of shell in the workplace, where $P is the program; to be freed.
 * `settings`: "TERM=xterm". */
static inline char *on_terminal(const workplace *w, int columns, const char *settings,
                                const char *line) {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  assert_true(terminal >= 0 && grantpt(terminal) == 0 && unlockpt(terminal) == 0);
  const struct winsize size = {.ws_row = 24, .ws_col = (unsigned short)columns};
  const int shown = open(ptsname(terminal), O_RDWR | O_NOCTTY);
  assert_true(shown >= 0 && ioctl(shown, TIOCSWINSZ, &size) == 0);
  char whole[4000];
  snprintf(whole, sizeof whole,
           "cd '%s' && unset TERM NO_COLOR COLUMNS && export %s PERILAT_MODELS='" SOURCE_DIR
           "/models' P='" PERILAT_PROGRAM "' && (%s) > %s 2>&1",
           w->folder, settings, line, ptsname(terminal));
  FILE *running = popen(whole, "r"); /* its output is the terminal's */
  assert_non_null(running);
  close(shown);
  char *text = NULL;
  size_t length = 0;
  FILE *out = open_memstream(&text, &length);
  char bytes[4096];
  for (ssize_t n; (n = read(terminal, bytes, sizeof bytes)) > 0;) /* until nobody has it open */
    fwrite(bytes, 1, (size_t)n, out);
  fclose(out);
  pclose(running);
  close(terminal);
  return text;
}

#endif
