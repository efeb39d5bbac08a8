/* What became of a notch: a lattice has sites where it has them, and a cut ends at the first bond
   that it leaves. */
#ifndef PERILAT_RUNTIME_NOTCH_DEPTH_H
#define PERILAT_RUNTIME_NOTCH_DEPTH_H

#include "runtime/lattice/rows.h"

typedef enum notch_kind {
  NOTCH_NONE,    /* a hole, or nothing of it lies in the body */
  NOTCH_AT_EDGE, /* open at one end */
  NOTCH_INSIDE,  /* a crack with bonds left at both ends */
  NOTCH_THROUGH  /* nothing holds the body together across it */
} notch_kind;

/* Along the notch, between outermost particles and where the first bonds left cross its middle
   plane; m. */
typedef struct notch_depth {
  notch_kind kind;
  double drawn;       /* what the deck's shape takes of the body */
  double cut;         /* what it became: from the edge, or from bond to bond */
  double ligament[2]; /* what is left beyond; of a crack inside on either side */
} notch_depth;

/* Of shapes that are long and thin: rectangles and boxes, segments and faces, polygons and
   extrusions; a crack is four times as long as wide. Where a shape reaches through the body in one
   direction, its depth is meant in the other. */
notch_depth notch_depth_of(const rows *w, const deck_shape *notch);

#endif
