#include "runtime/lattice/list_ways.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/hash.h"

/* Ways, and where each is found by what it says. */
enum { SLOTS = 1 << 14, MOST = SLOTS / 2 };
typedef struct known {
  pl_way *way;
  int count;
  int32_t slot[SLOTS]; /* 1 + the way, or 0 */
} known;

static pl_way way_of(const rows *w, long site, int number) {
  const neighbour_list *l = w->list;
  const long slot = number * w->size + site;
  pl_way way = {.to = l->neighbour[slot], .length = l->length[slot]};
  for (int a = 0; a < w->dimensions; a++)
    way.chord[a] = l->chord[a][slot];
  return way;
}

static bool are_one(const pl_way *a, const pl_way *b) {
  return memcmp(a, b, sizeof *a) == 0;
}

/* PL_OWN_WAYS when there are too many. */
static int32_t number_way(known *all, const pl_way *way) {
  unsigned at = (unsigned)(hash_more(HASH_START, way, sizeof *way) % SLOTS);
  while (all->slot[at] && !are_one(&all->way[all->slot[at] - 1], way))
    at = (at + 1) % SLOTS;
  if (all->slot[at]) return all->slot[at] - 1;
  if (all->count == MOST) return PL_OWN_WAYS;
  all->way[all->count] = *way;
  all->slot[at] = ++all->count;
  return all->slot[at] - 1;
}

static bool leads_to_sites(const rows *w, long site, const pl_way *way) {
  return site + way->to >= 0 && site + way->to + PL_LANES <= w->size;
}

static int32_t look_at(const rows *w, known *all, long site, int number) {
  pl_way way = {0};
  bool found = false;
  for (long q = site; q < site + PL_LANES; q++) {
    if (!rows_has_neighbour(w, q, number)) continue;
    const pl_way here = way_of(w, q, number);
    if (found && !are_one(&here, &way)) return PL_OWN_WAYS;
    way = here;
    found = true;
  }
  if (!found) return PL_NO_WAY;
  return leads_to_sites(w, site, &way) ? number_way(all, &way) : PL_OWN_WAYS;
}

void list_ways_find(rows *w, const unsigned char *is_line) {
  neighbour_list *l = w->list;
  known *all = must_calloc(1, sizeof *all);
  const long words = w->size / PL_LANES;
  all->way = must_calloc(MOST, sizeof *all->way);
  l->alike = rows_array(2 * w->directions * words, sizeof *l->alike);
  for (long n = 0; l->alike && n < words; n++)
    for (int k = 0; k < 2 * w->directions; k++)
      l->alike[n * 2 * w->directions + k] =
          is_line[n * PL_LANES / w->pitch] ? look_at(w, all, n * PL_LANES, k) : PL_OWN_WAYS;
  l->way = must_realloc(all->way, ((size_t)all->count + 1) * sizeof *l->way);
  if (!l->alike) {
    free(l->way);
    l->way = NULL;
  }
  free(all);
}

double list_ways_share(const rows *w) {
  const int numbers = 2 * w->directions;
  double alike = 0, all = 0;
  for (long q = 0; w->list && w->list->way && q < w->size; q++)
    for (int k = 0; k < numbers; k++) {
      if (!rows_has_neighbour(w, q, k)) continue;
      alike += w->list->alike[q / PL_LANES * numbers + k] >= 0;
      all++;
    }
  return all > 0 ? alike / all : 0;
}
