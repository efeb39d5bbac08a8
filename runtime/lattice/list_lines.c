#include "runtime/lattice/list_lines.h"

#include <stdlib.h>

#include "dsl/base/arena.h"
#include "runtime/kernel.h"

enum { LONGEST = 4096, LEAST = 64 }; /* particles of a row */
enum { MOST_TRIED = 3 };

void list_lines_free(list_lines *l) {
  free(l->order);
  free(l->length);
}

/* Rows of so many particles at most. */
static void cut_lines(list_lines *l, long most) {
  l->most = most;
  l->pitch = (most + PL_LANES) / PL_LANES * PL_LANES;
  l->rows = 0;
  for (long k = 0; k < l->count; k++)
    l->rows += (l->length[k] + most - 1) / most;
}

static long sites_of(const list_lines *l) {
  return l->rows * l->pitch;
}

/* As long as the longest line, or shorter where that leaves too many sites absent. */
static void choose_row(list_lines *l, long particles) {
  long longest = 0;
  for (long k = 0; k < l->count; k++)
    longest = l->length[k] > longest ? l->length[k] : longest;
  cut_lines(l, longest < LONGEST ? longest : LONGEST);
  while (l->most > LEAST && 2 * sites_of(l) > 3 * particles)
    cut_lines(l, l->most > 2 * LEAST ? l->most / 2 / LEAST * LEAST : LEAST);
}

static list_lines lines_along(const bond_ways *w, int way, const point_cloud *points,
                              double spacing) {
  list_lines l = {.order = must_alloc(((size_t)points->count + 1) * sizeof *l.order)};
  l.count = bond_ways_lines(w, way, points, spacing, l.order, &l.length);
  choose_row(&l, points->count);
  return l;
}

/* Ways as common as another one are like it, in another direction of the body. */
list_lines list_lines_find(const bond_ways *w, const point_cloud *points, double spacing) {
  list_lines best = lines_along(w, 0, points, spacing);
  for (int way = 1, tried = 1; way < w->common && tried < MOST_TRIED; way++) {
    if (w->bonds[way] == w->bonds[way - 1]) continue;
    list_lines l = lines_along(w, way, points, spacing);
    const bool better = sites_of(&l) < sites_of(&best);
    list_lines_free(better ? &best : &l);
    if (better) best = l;
    tried++;
  }
  return best;
}

/* In times of a particle in a row along a curve, from `splm_concrete` with exact edges on bodies of
   15 to 160 spacings: one in a line, one aside, a row by itself, and an end of it where neighbours
   stand aside. */
bool list_lines_pay(const list_lines *l, long particles, long aside) {
  const double in_line = 0.44, stands_aside = 2.1, row = 3, end = 7;
  const double ends = aside < 2 * l->rows ? (double)aside : 2 * (double)l->rows;
  const double cost = in_line * (double)(particles - aside) + stands_aside * (double)aside +
                      row * (double)l->rows + end * ends;
  return cost < (double)particles && sites_of(l) <= 2 * particles;
}

/* --- places ----------------------------------------------------------------------------------- */

enum { MANY_ASIDE = 128 }; /* are worth a row of their own */

typedef struct aside {
  int32_t highest, particle;
} aside;

typedef struct placing {
  const list_lines *l;
  const int32_t *highest;
  int common;
  int32_t *site;
  unsigned char *is_line;
  long row;
  aside *waiting;
  long waiting_count;
} placing;

/* Those of a line that stand in it. */
static void place_line(placing *p, long first, long end) {
  long q = 0;
  for (long r = first; r < end; r++) {
    if (p->highest[r] >= p->common) {
      p->waiting[p->waiting_count++] = (aside){p->highest[r], (int32_t)r};
      continue;
    }
    p->is_line[p->row] = 1;
    p->site[r] = (int32_t)(p->row * p->l->pitch + q++);
    if (q < p->l->most) continue;
    p->row++;
    q = 0;
  }
  p->row += q > 0;
}

static int by_highest(const void *a, const void *b) {
  const aside *p = a, *q = b;
  if (p->highest != q->highest) return p->highest < q->highest ? -1 : 1;
  return p->particle < q->particle ? -1 : p->particle > q->particle;
}

/* Those that need as many numbers together: loops leave out the numbers that none has. */
static void place_aside(placing *p) {
  qsort(p->waiting, (size_t)p->waiting_count, sizeof *p->waiting, by_highest);
  for (long k = 0; k < p->waiting_count; k++)
    p->site[p->waiting[k].particle] =
        (int32_t)((p->row + k / p->l->most) * p->l->pitch + k % p->l->most);
  p->row += (p->waiting_count + p->l->most - 1) / p->l->most;
  p->waiting_count = 0;
}

long list_lines_place(const list_lines *l, const int32_t *highest, int common, int32_t *site,
                      unsigned char **is_line) {
  long first = 0;
  for (long k = 0; k < l->count; k++)
    first += l->length[k];
  placing p = {.l = l, .highest = highest, .common = common, .site = site};
  p.is_line = *is_line = must_calloc((size_t)(first + l->count) + 1, 1);
  p.waiting = must_alloc(((size_t)first + 1) * sizeof *p.waiting);
  first = 0;
  for (long k = 0; k < l->count; k++) {
    place_line(&p, first, first + l->length[k]);
    first += l->length[k];
    if (p.waiting_count >= MANY_ASIDE) place_aside(&p);
  }
  place_aside(&p);
  free(p.waiting);
  return p.row;
}
