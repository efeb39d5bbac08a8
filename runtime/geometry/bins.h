/* Points sorted into equal boxes, so that those near a place are found without asking all. Lengths in m. */
#ifndef PERILAT_RUNTIME_BINS_H
#define PERILAT_RUNTIME_BINS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct bins {
  int dimensions;
  double lower[3], size; /* of a box */
  int count[3];          /* boxes along each axis; 1 along z in the plane */
  int64_t *first;        /* [boxes + 1] places in `point` */
  int64_t *point;        /* numbers of the points, box by box; ascending in each */
} bins;

/* From where to where coordinates reach, so that boxes of equal size have about as many each: of more than a thousand, the few
   that lie far from all others may be left out. */
void bins_range(const double *x, long count, double range[2]);

/* Boxes of about that size; larger ones where there would be many more boxes than points. at[2] is NULL in the plane.
   Points are finite; those out of all boxes are in the nearest. */
void bins_begin(bins *b, int dimensions, double *const at[3], long points, double size);
void bins_end(bins *b);
/* The box that holds the place, or the nearest. */
void bins_box(const bins *b, const double at[3], int box[3]);
/* Points in a box: the first and one past the last place in `point`; none where there is no such box. */
bool bins_points(const bins *b, const int box[3], int64_t *from, int64_t *to);

#endif
