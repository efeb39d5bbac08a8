#include "runtime/mesh/mesh_fields.h"

#include <string.h>

void mesh_field(const point_shape *s, const node_layout *l, const double *const nodes[2],
                double value[2], double gradient[2][2]) {
  double v[2] = {0}, g[2][2] = {{0}};
  for (int q = 0; q < s->count; q++) {
    const long site = node_layout_at(l, s->node[q]);
    for (int d = 0; d < 2; d++) {
      const double a = nodes[d][site];
      v[d] += s->n[q] * a;
      g[d][0] += s->nx[q] * a;
      g[d][1] += s->ny[q] * a;
    }
  }
  if (value) memcpy(value, v, sizeof v);
  if (gradient) memcpy(gradient, g, sizeof g);
}
