/* This room: shapes, cells, points and what is near them, in numbers alone: it knows no deck. Here
   shapes, in the plane and in space: which points lie in them, which chords cross them. Points are
   [2] for shapes of the plane and [3] for those of space. Lengths in m. */
#ifndef PERILAT_RUNTIME_SHAPE_H
#define PERILAT_RUNTIME_SHAPE_H

#include <stdbool.h>
#include <stdint.h>

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

typedef enum shape_kind { /* those of space from the box on; a point is of both */
                          SHAPE_POINT,
                          SHAPE_RECTANGLE,
                          SHAPE_DISC,
                          SHAPE_POLYGON,
                          SHAPE_DOG_BONE,
                          SHAPE_SEGMENT,
                          SHAPE_BOX,
                          SHAPE_CYLINDER,
                          SHAPE_SPHERE,
                          SHAPE_EXTRUSION,
                          SHAPE_FACE
} shape_kind;

typedef struct deck_shape { /* m */
  shape_kind kind;
  double at[3];              /* point: position; the nearest site within `within` is meant */
  double within;             /* point; default half a spacing (0 here: not given) */
  double corner[3], size[3]; /* rectangle, box: the corner of least coordinates, extent */
  double rotation;           /* rectangle: about its corner; dog-bone: about its centre; rad */
  double centre[3], radius,
      inner_radius; /* disc, sphere; cylinder without centre; dog-bone: radius of its arcs */
  double width, height, neck; /* dog-bone: of the ends, over all, in the middle */
  double from[3], to[3];      /* segment, cylinder: its ends */
  double z[2];                /* extrusion: from, to */
  const double *points;       /* polygon, extrusion: x1, y1, x2, y2, ...; face: x1, y1, z1, ... */
  int point_count;            /* pairs or triples, at least 3 */
  /* polygon, extrusion: rise of the arc above the edge that begins at each point, outward positive,
     points counter-clockwise; NULL: straight edges */
  const double *bulge;
  int bulge_count;
  /* What a file lists instead: particles by their numbers, ascending; the rectangle is the box
     around them. NULL: none */
  const int32_t *members;
  int member_count;
} deck_shape;

/* Smallest box with sides along the axes that holds the shape; not a number where the shape's
   numbers are not. lower[2] and upper[2] are 0 for shapes of the plane. */
void shape_box(const deck_shape *shape, double lower[3], double upper[3]);

/* m: of a point from the shape's outline, negative inside. */
double shape_distance(const deck_shape *shape, const double *point);

/* True inside, on the outline, and outside within `tolerance` of the outline. A polygon's inside is
   where a ray crosses its outline an odd number of times; a disc with an inner radius is a ring;
   points, segments and faces are their own outlines. */
bool shape_contains(const deck_shape *shape, const double *point, double tolerance);

/* True for all kinds with an area or a volume; false for points, segments and faces. */
bool shape_has_size(const deck_shape *shape);

/* Places u, 0 < u < 1 from a to b, where the chord may enter or leave the shape, in no order:
   between two that follow each other it is inside or outside throughout. At most `most` are
   written; returns how many there are. */
int shape_cuts(const deck_shape *shape, const double *a, const double *b, double *u, int most);

/* Of a shape of the plane with an area: length of the shorter way along its outline between two
   points on it; infinite between the two circles of a ring. */
double shape_way(const deck_shape *shape, const double *p, const double *q);

/* Coordinates along axis c (0, 1, 2) of the corners, of the ends of the shape's box and of a disc's
   hole; likewise. */
int shape_levels(const deck_shape *shape, int c, double *level, int most);

/* True when a straight line meets the shape in one piece. */
bool shape_is_convex(const deck_shape *shape);

/* True when the open chord a-b has a point deeper than `tolerance` inside the shape: touching a
   corner or running along the outline is no crossing. A shape without area (a segment, a rectangle
   of width 0, a polygon folded flat) or without volume (a face) is a slit: every chord that has its
   ends on either side and meets it, its tip included, crosses it. A point is never crossed. */
bool shape_crossed(const deck_shape *shape, const double *a, const double *b, double tolerance);

/* Largest distance of a face's corners from one plane, in parts of its extent; not a number for a
   face without area. */
double shape_unevenness(const deck_shape *face);

C_LINKAGE_END

#endif
