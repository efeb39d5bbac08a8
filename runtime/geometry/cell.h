/* Convex cells about a point: a polygon or a polyhedron that half spaces are taken from one by one,
   as the cells of a Voronoi diagram are made (Rycroft 2009). All places are seen from the point,
   which stays inside. Lengths in m. */
#ifndef PERILAT_RUNTIME_CELL_H
#define PERILAT_RUNTIME_CELL_H

#include <stdbool.h>

/* Points, and in space faces as closed runs of points, counter-clockwise from outside. */
typedef struct cell_part {
  int point_count, face_count, corner_count;
  int point_room, face_room, corner_room;
  double (*point)[3]; /* in the plane in their order, counter-clockwise, [2] = 0 */
  int *face;          /* [face_count + 1] first corner of each */
  int *corner;        /* [corner_count] points */
} cell_part;

typedef struct cell {
  int dimensions;
  double reach; /* distance of the farthest point */
  cell_part now, next;
  double *height; /* [point_room] while it is cut */
  int *kept, room;
  int (*edge)[2], *follower, edge_count, edge_room;
} cell;

typedef struct cell_moments {
  double size;     /* m^2 or m^3 */
  double first[3]; /* integral of the position, m^3 or m^4 */
} cell_moments;

void cell_begin(cell *c, int dimensions); /* empty; memory is kept from use to use */
void cell_end(cell *c);
/* A box, lower <= 0 <= upper. */
void cell_set_box(cell *c, const double lower[3], const double upper[3]);
/* Takes away where q.normal > level > 0. False when there was nothing. */
bool cell_cut(cell *c, const double normal[3], double level);
cell_moments cell_measure(const cell *c);
void cell_extent(const cell *c, double lower[3], double upper[3]);

#endif
