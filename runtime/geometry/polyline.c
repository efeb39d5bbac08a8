#include "runtime/geometry/polyline.h"

#include <math.h>

#include "dsl/base/elementary.h"

int polyline_legs(const polyline *p) {
  return p->closed ? p->corners : p->corners - 1;
}

double polyline_leg(const polyline *p, int k, const double **from, const double **to) {
  double square = 0;
  *from = &p->at[k * p->dimensions];
  *to = &p->at[(k + 1) % p->corners * p->dimensions];
  for (int a = 0; a < p->dimensions; a++)
    square += ((*to)[a] - (*from)[a]) * ((*to)[a] - (*from)[a]);
  return sqrt(square);
}

double polyline_length(const polyline *p) {
  const double *from, *to;
  double length = 0;
  for (int k = 0; k < polyline_legs(p); k++)
    length += polyline_leg(p, k, &from, &to);
  return length;
}

static double within_one(double x) {
  return pl_fmin(pl_fmax(x, 0), 1);
}

/* Of two segments r + s*a + t*b apart, 0 <= s <= 1 and -1 <= -t <= 0: for each t the best s is
   known, and the distance is convex in both (Ericson 2005, section 5.1.9). */
static double legs_apart(int dimensions, const double *a_from, const double *a_to,
                         const double *b_from, const double *b_to, const double shift[3]) {
  double aa = 0, ab = 0, bb = 0, ar = 0, br = 0, square = 0;
  for (int k = 0; k < dimensions; k++) {
    const double a = a_to[k] - a_from[k], b = b_to[k] - b_from[k],
                 r = a_from[k] - b_from[k] - shift[k];
    aa += a * a;
    ab += a * b;
    bb += b * b;
    ar += a * r;
    br += b * r;
  }
  const double area = aa * bb - ab * ab;
  double s = area > 1e-12 * aa * bb ? within_one((ab * br - ar * bb) / area) : 0;
  const double t = within_one((ab * s + br) / bb);
  s = within_one((ab * t - ar) / aa);
  for (int k = 0; k < dimensions; k++) {
    const double way =
        a_from[k] + s * (a_to[k] - a_from[k]) - b_from[k] - t * (b_to[k] - b_from[k]) - shift[k];
    square += way * way;
  }
  return sqrt(square);
}

double polyline_apart(const polyline *p, const double shift[3]) {
  const double *from, *to, *of, *up_to;
  double least = INFINITY;
  for (int k = 0; k < polyline_legs(p); k++)
    for (int m = 0; m < polyline_legs(p); m++) {
      polyline_leg(p, k, &from, &to);
      polyline_leg(p, m, &of, &up_to);
      least = pl_fmin(least, legs_apart(p->dimensions, from, to, of, up_to, shift));
    }
  return least;
}

long polyline_parts(const polyline *p, int leg, double spacing) {
  const double *from, *to;
  return (long)pl_fmax(round(polyline_leg(p, leg, &from, &to) / spacing), 1);
}
