/* The surface of a solid shape without holes: how far a point is from it, and which way is out. Of
   rectangles, discs, boxes, cylinders and spheres (shape.h). Lengths in m. */
#ifndef PERILAT_RUNTIME_SURFACE_H
#define PERILAT_RUNTIME_SURFACE_H

#include "runtime/geometry/shape.h"

typedef enum surface_kind { SURFACE_BOX, SURFACE_BALL, SURFACE_CYLINDER } surface_kind;

typedef struct surface {
  surface_kind kind;
  double centre[3];
  /* unit vectors: of a box its edges, of a cylinder its axis, then two across; in the plane the
     third is along z */
  double axes[3][3];
  /* box: half of its edges, in the plane the third is infinite; ball: the radius; cylinder: half of
     its length, then the radius */
  double half[3];
} surface;

/* False for shapes of other kinds. */
bool surface_open(const deck_shape *shape, surface *s);
/* What it is in numbers: its kind, centre, half (infinite: 0) and axes. */
enum { SURFACE_NUMBERS = 1 + 3 + 3 + 9 };
void surface_numbers(const surface *s, double numbers[SURFACE_NUMBERS]);
/* By these; up to rounding, as a part of the largest length. */
bool surface_is_alike(const double a[SURFACE_NUMBERS], const double b[SURFACE_NUMBERS]);
/* m: of a point from the surface, negative inside; the unit vector out of the shape at the nearest
   point of the surface. In the plane p[2] is 0. */
double surface_distance(const surface *s, const double p[3], double out[3]);
/* In the plane: corners of its outline, counter-clockwise; of a disc points that are alike. Returns
   how many there are. */
enum { SURFACE_OUTLINE = 180 };
int surface_outline(const surface *s, double points[SURFACE_OUTLINE][2]);
/* m^2, in the plane m: of all points that lie that far outside (m). */
double surface_extent(const surface *s, int dimensions, double out);

#endif
