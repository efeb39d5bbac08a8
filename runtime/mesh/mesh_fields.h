/* What the values of a mesh's nodes are at a point: sum N_I a_I, and its gradient. Of element-free
   nodes the values are parameters; these are the fields themselves. */
#ifndef PERILAT_RUNTIME_MESH_FIELDS_H
#define PERILAT_RUNTIME_MESH_FIELDS_H

#include "runtime/mesh/node_layout.h"
#include "runtime/mesh/shape_functions.h"

/* Of the vector with the planes nodes[2], laid out as `l`, by the functions `s` of a point:
   value[2]; gradient[i][j] = d value_i/d x_j, 1/m. Either may be NULL. */
void mesh_field(const point_shape *s, const node_layout *l, const double *const nodes[2],
                double value[2], double gradient[2][2]);

/* Strain xx, yy, xy of a gradient; xy as a tensor has it, half of the change of angle. */
static inline void mesh_strain(double gradient[2][2], double strain[3]) {
  strain[0] = gradient[0][0];
  strain[1] = gradient[1][1];
  strain[2] = 0.5 * (gradient[0][1] + gradient[1][0]);
}

#endif
