/* Along the line of a bar, of which there may be copies: which particles follow each other, which
   of them a link chooses, and how much of the bar each of these stands for. */
#ifndef PERILAT_RUNTIME_BAR_LINE_H
#define PERILAT_RUNTIME_BAR_LINE_H

#include "runtime/deck/deck.h"
#include "runtime/lattice/rows.h"

typedef struct bar_line {
  long each; /* particles of a copy */
  bool closed;
  double length;     /* m, of a copy */
  double *at;        /* [each] m along the line from its first particle */
  long first, every; /* of each copy a link chooses the numbers first, first + every, ... */
} bar_line;

/* Of the bar's rows as a link of the deck sees them; to be ended. */
bar_line bar_line_of(const deck_bar *bar, const deck_link *link, const rows *w);
void bar_line_end(bar_line *l);

bool bar_line_chooses(const bar_line *l, int32_t particle);
/* The next particle of the same copy, or the one before (step -1); at an end itself. */
int32_t bar_line_beside(const bar_line *l, int32_t particle, int step);
/* m: half way to the chosen ones on either side, at an end of the bar up to that. A chosen one with
   `every` or more before it that are left out stands for no more of these than where there is one.
   */
double bar_line_share(const bar_line *l, int32_t particle);

#endif
