#include "runtime/continuum/crack_paths.h"

#include <string.h>

/* The crack's tip at that end; NULL: that end is none. */
static const mesh_tip *tip_at(const tips *t, const deck_crack *c, bool start) {
  for (int n = 0; n < t->count; n++)
    if (t->items[n].of == c && t->items[n].at_start == start) return &t->items[n];
  return NULL;
}

/* A look begins a leg at most, and the first leg may go on along the crack. */
int crack_path_most(const tips *t, const deck_crack *c, int64_t steps) {
  const int64_t looks = steps / t->planned[0] + 1;
  const int legs = looks < TIPS_MOST_PIECES ? (int)looks : TIPS_MOST_PIECES;
  int most = c->point_count;
  for (int start = 0; start < 2; start++) {
    const mesh_tip *p = tip_at(t, c, start);
    if (p && p->law) most += legs;
  }
  return most;
}

static void turn_round(double (*at)[2], int count) {
  for (int a = 0, b = count - 1; a < b; a++, b--) {
    const double kept[2] = {at[a][0], at[a][1]};
    memcpy(at[a], at[b], sizeof kept);
    memcpy(at[b], kept, sizeof kept);
  }
}

int crack_path(const tips *t, const deck_crack *c, double (*at)[2], int most) {
  const mesh_tip *start = tip_at(t, c, true), *end = tip_at(t, c, false);
  int count = start ? tip_path(t, start->number, at, most) : 0;
  turn_round(at, count);
  for (int k = count > 0; k < c->point_count && count < most; k++)
    memcpy(at[count++], c->points + 2 * k, sizeof *at);
  if (!end || count == 0) return count;
  const int grown = tip_path(t, end->number, at + count - 1, most - count + 1);
  return grown > 0 ? count - 1 + grown : count;
}
