#include "generator/run/progress.h"

#include <stdio.h>
#include <string.h>

#include "dsl/base/terminal.h"
#include "runtime/base/clock.h"

static const char full_bar[] = "########################", empty_bar[] = "........................";
enum { BAR_WIDTH = sizeof full_bar - 1, NARROW = 80 };

void progress_begin(progress *p, double fraction) {
  *p = (progress){.terminal = terminal_is_able(stderr),
                  .begun = monotonic_seconds(),
                  .from = fraction,
                  .tenths = (int)(10 * fraction)};
}

static double seconds_of(const progress *p) {
  return monotonic_seconds() - p->begun;
}

/* "1:05 left", empty where it cannot be told yet. */
static void time_left(const progress *p, double fraction, char *text, size_t size) {
  const double done = fraction - p->from;
  const long s = done > 0.005 ? (long)(seconds_of(p) * (1 - fraction) / done) : -1;
  snprintf(text, size, s < 0 ? "" : "  %ld:%02ld left", s / 60, s % 60);
}

/* One column less than there are: a full line would begin another one. The detail is cut, and where
   the terminal is narrow there is no bar. */
static void show_line(const progress *p, double fraction, const char *detail) {
  char bar[BAR_WIDTH + 4] = "", left[40], line[400];
  const int columns = terminal_columns(stderr), room = columns - 1;
  time_left(p, fraction, left, sizeof left);
  const int done = (int)(fraction * BAR_WIDTH);
  if (columns >= NARROW) snprintf(bar, sizeof bar, "[%.*s%s] ", done, full_bar, empty_bar + done);
  const int used = snprintf(line, sizeof line, "%s%3.0f %%", bar, 100 * fraction);
  const int free_room = room - used - 2 - (int)strlen(left);
  snprintf(line + used, sizeof line - (size_t)used, "  %.*s%s", free_room > 0 ? free_room : 0,
           detail, left);
  terminal_control(stderr, "\r");
  fprintf(stderr, "%.*s", room, line);
  terminal_control(stderr, "\033[K");
}

void progress_show(progress *p, double fraction, const char *detail) {
  double now = monotonic_seconds();
  if (p->terminal) {
    if (now - p->last_shown < 0.2) return;
    p->last_shown = now;
    show_line(p, fraction, detail);
  } else if ((int)(10 * fraction) > p->tenths) {
    p->tenths = (int)(10 * fraction);
    fprintf(stderr, "%3.0f %%  %s  (%.1f s)\n", 100 * fraction, detail, seconds_of(p));
  }
}

void progress_end(progress *p) {
  if (p->terminal) terminal_control(stderr, "\r\033[K");
}
