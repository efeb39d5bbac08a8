/* Tractions on sides of elements, straight or curved, as a file lists them: nodes bear the integral
   of their functions along the side, by four Gauss points. */
#ifndef PERILAT_RUNTIME_SIDE_LOAD_H
#define PERILAT_RUNTIME_SIDE_LOAD_H

#include "runtime/geometry/gmsh_mesh.h"
#include "runtime/mesh/mesh.h"
#include "runtime/mesh/moving_least_squares.h"

/* At a point of a side whose part of it has `area` (m^2): the functions of its nodes, and the
   normal out of its cell; of a line inside that to the right of its direction. */
typedef void side_visitor(void *context, const double at[2], const double normal[2], double area,
                          const point_shape *s);
/* Visits the lines of a group; returns their length, m. */
double sides_visit(const mesh *m, const gmsh_mesh *file, const gmsh_group *group,
                   side_visitor *visit, void *context);

#endif
