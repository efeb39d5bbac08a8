#include "runtime/filling/bar_line.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"

static double apart(const rows *w, long p, long q) {
  double from[3], to[3], square = 0;
  rows_place(w, w->particle_site[p], from);
  rows_place(w, w->particle_site[q], to);
  for (int a = 0; a < w->dimensions; a++)
    square += (to[a] - from[a]) * (to[a] - from[a]);
  return sqrt(square);
}

bar_line bar_line_of(const deck_bar *bar, const deck_link *link, const rows *w) {
  bar_line l = {.each = w->particle_count / bar->copies,
                .closed = bar->closed,
                .first = link->first,
                .every = link->every};
  l.at = must_calloc((size_t)l.each, sizeof *l.at);
  for (long p = 1; p < l.each; p++)
    l.at[p] = l.at[p - 1] + apart(w, p - 1, p);
  l.length = l.at[l.each - 1] + (l.closed ? apart(w, l.each - 1, 0) : 0);
  return l;
}

void bar_line_end(bar_line *l) {
  free(l->at);
}

bool bar_line_chooses(const bar_line *l, int32_t particle) {
  const long number = particle % l->each;
  return number >= l->first && (number - l->first) % l->every == 0;
}

int32_t bar_line_beside(const bar_line *l, int32_t particle, int step) {
  const long number = particle % l->each, beside = number + step;
  if (beside >= 0 && beside < l->each) return particle + step;
  return l->closed ? (int32_t)(particle - number + (beside + l->each) % l->each) : particle;
}

static double way_back(const bar_line *l, long number) {
  if (number >= l->every) return 0.5 * (l->at[number] - l->at[number - l->every]);
  if (!l->closed) return l->at[number];
  const long last = number + (l->each - 1 - number) / l->every * l->every;
  return 0.5 * (l->at[number] + l->length - l->at[last]);
}

static double way_on(const bar_line *l, long number) {
  const long next = number + l->every;
  if (next < l->each) return 0.5 * (l->at[next] - l->at[number]);
  if (!l->closed) return l->length - l->at[number];
  const long wrapped = l->first < l->every ? l->first : next - l->each;
  return 0.5 * (l->length - l->at[number] + l->at[wrapped]);
}

double bar_line_share(const bar_line *l, int32_t particle) {
  const long number = particle % l->each;
  return way_back(l, number) + way_on(l, number);
}
