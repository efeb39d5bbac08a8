/* Fields of a mesh at its nodes, as frames show them: what the nodes' values make of them
   (mesh_fields.h). Gradients are the mean of those in the cells around a node, of elements with one
   point of those there; beside a crack a node sees its own side. */
#ifndef PERILAT_RUNTIME_NODE_FIELDS_H
#define PERILAT_RUNTIME_NODE_FIELDS_H

#include "runtime/continuum/cells.h"

/* Of planes as node_layout.h has them: values[particles][2] of the nodes that are there. */
void node_field_values(const cells *c, const double *const planes[2], double *values);
/* Strain xx, yy, xy (of a tensor) of displacements, and the law's stress at it, Pa; with a law that
   is not linear the mean stress of the points around: planes of the body. Between several laws the
   mean of what they have there, by the areas of their cells around. NaN at nodes without a cell. */
void node_field_strain(const cells *c, const double *const displacement[2],
                       double *const strain[3]);
void node_field_stress(const cells *c, const double *const displacement[2],
                       double *const stress[3]);

#endif
