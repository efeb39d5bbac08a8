/* Holes of a mesh: the insides of shapes, which may overlap. They hold no nodes and no points of
   integration, and what is on one side of a hole does not act on the other: a node acts at a point
   where the straight line between them goes through no hole (visibility, as with cracks), or where
   the way along the hole's outline is at most half longer than what the line has inside:

        I   x     a slot hides I: the way around     I ,-'-. x    a line past a round hole or around
       ---------  its end is long                     ,'     '.   one corner does not hide

   If each line through a hole hid, functions would jump along the tangents of a round hole and
   around corners: on the outline of Kirsch's plate (80 x 80 nodes) stresses would be off by 2.2 of
   the stress that pulls, not 0.6, with a support of 2.1, and by 2.4, not 0.1, with 3.5. With a
   tenth in place of a half a uniform stress around a rectangle is off by 4 % in the mean, not 0.01
   %. */
#ifndef PERILAT_RUNTIME_HOLES_H
#define PERILAT_RUNTIME_HOLES_H

#include <stdbool.h>

#include "dsl/base/c_linkage.h"
#include "runtime/geometry/shape.h"

C_LINKAGE_BEGIN

typedef struct mesh_hole {
  deck_shape shape;
  double lower[3], upper[3]; /* m: its box */
} mesh_hole;

typedef struct mesh_holes {
  mesh_hole *items; /* [count] */
  int count;
  double tolerance; /* m: what is no deeper in a hole is on its outline */
} mesh_holes;

void holes_open(mesh_holes *h);
void holes_close(mesh_holes *h);
/* A shape of the plane that has an area; its points must outlive the holes. */
void holes_add(mesh_holes *h, const deck_shape *shape);

/* Whether some hole meets the box. */
bool holes_meet_box(const mesh_holes *h, const double lower[2], const double upper[2]);
/* Whether the point is in a hole, not only on the outlines. */
bool holes_hold(const mesh_holes *h, const double at[2]);
/* Whether it is in a hole, or nearer to one than `distance` (m). */
bool holes_near(const mesh_holes *h, const double at[2], double distance);
/* Whether a hole hides the node from the point. */
bool holes_hide(const mesh_holes *h, const double at[2], const double node[2]);
/* Part of the way a -> b up to the first hole, 0 where a is in one; 1: it meets none. */
double holes_until(const mesh_holes *h, const double a[2], const double b[2]);
/* Where a line from -> at, which ends on the outline of a hole or inside, is in the middle of what
   is left of its way through; false where it ends in no hole. */
bool holes_beyond(const mesh_holes *h, const double from[2], const double at[2], double middle[2]);
/* Places u, 0 < u < 1 from a to b, where the line may enter or leave a hole, 0 and 1 included,
   ascending; to be freed. Returns how many. */
int holes_cuts(const mesh_holes *h, const double a[2], const double b[2], double **u);

C_LINKAGE_END

#endif
