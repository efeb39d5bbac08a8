#include "runtime/mesh/point_values.h"

#include <stdlib.h>

#include "dsl/base/arena.h"
#include "runtime/mesh/shape_functions.h"

void point_values_open(point_values *v, const mesh *m, const integration_points *p) {
  long room = 0, count = 0;
  *v = (point_values){.first = must_calloc((size_t)p->count + 1, sizeof *v->first)};
  for (int n = 0; n < p->count; n++) {
    point_shape s;
    shape_functions(m, p->cell[n], p->at[n], &s);
    if (count + s.count > room) {
      room = 2 * (count + s.count);
      v->node = must_realloc(v->node, (size_t)room * sizeof *v->node);
      v->part = must_realloc(v->part, (size_t)room * sizeof *v->part);
    }
    for (int k = 0; k < s.count; k++) {
      v->node[count] = s.node[k];
      v->part[count++] = s.n[k];
    }
    v->first[n + 1] = count;
  }
}

void point_values_close(point_values *v) {
  free(v->first);
  free(v->node);
  free(v->part);
}

double point_values_at(const point_values *v, int point, const double *nodes) {
  double sum = 0;
  for (long k = v->first[point]; k < v->first[point + 1]; k++)
    sum += v->part[k] * nodes[v->node[k]];
  return sum;
}
