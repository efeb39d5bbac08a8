/* Progress of a long run: on a terminal one line, cut to its width, with the time left; a line
   every tenth otherwise. Writes to stderr. */
#ifndef PERILAT_GENERATOR_PROGRESS_H
#define PERILAT_GENERATOR_PROGRESS_H

#include <stdbool.h>

typedef struct progress {
  bool terminal;
  double begun;      /* s, monotonic */
  double from;       /* fraction at the start (a resumed run) */
  double last_shown; /* s */
  int tenths;        /* lines printed so far */
} progress;

void progress_begin(progress *p, double fraction);
/* `detail`: e.g. "t = 25 ms, load 3.1 kN, peak 11.0 kN". Shown at most five times a second. */
void progress_show(progress *p, double fraction, const char *detail);
void progress_end(progress *p);

#endif
