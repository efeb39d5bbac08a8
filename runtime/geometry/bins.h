/* Equal boxes over nearly all of many points, and points sorted into them, so that those near a
   place are found without asking all. Lengths in m.

   Eight points, numbered as they came, in 3 x 2 boxes; `first` says where each box begins in
   `point`:

       +-----+-----+-----+
       | 6   |     | 1 4 |      box     0  1  2    3  4  5
       +-----+-----+-----+      first   0  2  2 5  6  6  8
       | 0 3 |     |2 5 7|      point   0 3  2 5 7  6  1 4
       +-----+-----+-----+ */
#ifndef PERILAT_RUNTIME_BINS_H
#define PERILAT_RUNTIME_BINS_H

#include <stdint.h>

typedef struct boxes {
  int dimensions;
  double lower[3], size; /* of a box */
  int count[3];          /* along each axis; 1 along z in the plane */
} boxes;

/* The box that holds the place, or the nearest. */
void boxes_home(const boxes *b, const double at[3], int box[3]);
/* The same along one axis. */
int boxes_along(const boxes *b, int axis, double x);
/* Boxes are numbered along x first, then y, then z; -1 where there is no such box. */
int64_t boxes_number(const boxes *b, const int box[3]);
int64_t boxes_all(const boxes *b);

typedef struct bins {
  boxes boxes;
  int32_t *first; /* [boxes + 1] places in `point` */
  int32_t *point; /* numbers of the points, box by box; ascending in each */
  int64_t first_room, point_room;
} bins;

/* Boxes of about that size; larger ones where there would be many more boxes than points. at[2] is
   NULL in the plane. Points are finite; those out of all boxes are in the nearest. */
void bins_of_size(bins *b, int dimensions, const double *const at[3], long points, double size);
/* The same of points that have moved, into the memory of `b`, which grows where it must; all 0
   before the first time. */
void bins_renew(bins *b, int dimensions, const double *const at[3], long points, double size);
/* Boxes with about so many points each; a box is as large along axes along which the points reach
   less far than it. */
void bins_of_few(bins *b, int dimensions, const double *const at[3], long points, double few);
void bins_end(bins *b);

#endif
