/* Rows for particles of a list most of whose bonds go common ways (bond_ways.h): lines along one of
   these ways, cut where they are too long. Neighbours of a number then stand side by side, as on a
   lattice. */
#ifndef PERILAT_RUNTIME_LIST_LINES_H
#define PERILAT_RUNTIME_LIST_LINES_H

#include "runtime/lattice/bond_ways.h"

typedef struct list_lines {
  int32_t *order;   /* [particles] line after line */
  int32_t *length;  /* [count] particles of each */
  long count, most; /* lines; particles of a row */
  long rows, pitch; /* of so many sites, of which one is absent */
} list_lines;

/* Of the most common ways that which leaves the fewest sites absent. */
list_lines list_lines_find(const bond_ways *w, const point_cloud *points, double spacing);
void list_lines_free(list_lines *l);

/* Whether steps take less time than in rows along a curve, where so many particles stand aside. */
bool list_lines_pay(const list_lines *l, long particles, long aside);

/* site[particles], of the particles in that order. Those with bonds of numbers from `common` on,
   highest[particles], stand aside: together, in rows between those of lines near them.
   is_line[rows] says which are which; to be freed. Returns how many rows there are. */
long list_lines_place(const list_lines *l, const int32_t *highest, int common, int32_t *site,
                      unsigned char **is_line);

#endif
