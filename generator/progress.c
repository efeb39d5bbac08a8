#include "generator/progress.h"

#include <stdio.h>
#include <unistd.h>

#include "runtime/clock.h"

enum { BAR_WIDTH = 24 };

void progress_begin(progress *p, double fraction) {
  *p = (progress){.terminal = isatty(STDERR_FILENO) == 1,
                  .begun = monotonic_seconds(),
                  .from = fraction,
                  .tenths = (int)(10 * fraction)};
}

static double seconds_of(const progress *p) {
  return monotonic_seconds() - p->begun;
}

static void show_bar(const progress *p, double fraction, const char *detail) {
  char bar[BAR_WIDTH + 1], left[32] = "";
  for (int k = 0; k < BAR_WIDTH; k++)
    bar[k] = k < (int)(fraction * BAR_WIDTH) ? '#' : '.';
  bar[BAR_WIDTH] = 0;
  double done = fraction - p->from;
  if (done > 0.005) {
    long s = (long)(seconds_of(p) * (1 - fraction) / done);
    snprintf(left, sizeof left, "%ld:%02ld left", s / 60, s % 60);
  }
  fprintf(stderr, "\r[%s] %3.0f %%  %s  %s\033[K", bar, 100 * fraction, detail, left);
  fflush(stderr);
}

void progress_show(progress *p, double fraction, const char *detail) {
  double now = monotonic_seconds();
  if (p->terminal) {
    if (now - p->last_shown < 0.2) return;
    p->last_shown = now;
    show_bar(p, fraction, detail);
  } else if ((int)(10 * fraction) > p->tenths) {
    p->tenths = (int)(10 * fraction);
    fprintf(stderr, "%3d %%  %s  (%.1f s)\n", 10 * p->tenths, detail, seconds_of(p));
  }
}

void progress_end(progress *p) {
  if (p->terminal) {
    fputs("\r\033[K", stderr);
    fflush(stderr);
  }
}
