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

long polyline_parts(const polyline *p, int leg, double spacing) {
  const double *from, *to;
  return (long)pl_fmax(round(polyline_leg(p, leg, &from, &to) / spacing), 1);
}
