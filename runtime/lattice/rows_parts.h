/* Inside of rows, for what builds them: rows.c for lattices, scattered.c for particles that stand anywhere. */
#ifndef PERILAT_RUNTIME_ROWS_PARTS_H
#define PERILAT_RUNTIME_ROWS_PARTS_H

#include "runtime/lattice/rows.h"

/* `count` zeros of `each` bytes, aligned; NULL without memory. */
void *rows_array(long count, size_t each);
/* The arrays over sites of rows whose size and dimensions are set; false without memory. */
bool rows_new_sites(rows *w);
/* width, height and depth; bond_count. */
void rows_find_extent(rows *w);
void rows_count_bonds(rows *w);
/* Cuts the bonds that the site owns and that cross the shape. Returns how many do, whether they were cut before or not. */
long rows_cut(rows *w, long site, const deck_shape *shape);

#endif
