/* What frames can hold of any law, beside its own states, damages, outputs and parameters. The
   values of field NAME are values_of_NAME in runtime/simulation/frames.c.

   X(name, unit, components, exists, kind, words), in the order of results. Components: VECTOR (one
   for each direction of space), ROTATION (one for each axis) or SCALAR. Exists: in which runs. Kind
   as in results: "damage" of the law, else "other". */
#ifndef PERILAT_RUNTIME_OUTPUT_FIELDS_H
#define PERILAT_RUNTIME_OUTPUT_FIELDS_H

#include <stdbool.h>

#define OUTPUT_FIELDS(X)                                                                           \
  X(displacement, "m", VECTOR, always, "other", "displacement")                                    \
  X(velocity, "m/s", VECTOR, always, "other",                                                      \
    "velocity: the mean of those half a step before and after")                                    \
  X(rotation, "rad", ROTATION, with_rotations, "other", "rotation, counter-clockwise")             \
  X(force, "N", VECTOR, always, "other", "sum of the forces of the bonds")                         \
  X(damage, "1", SCALAR, with_damage, "damage",                                                    \
    "mean damage of the bonds that the particle began with")                                       \
  X(dissipated, "J", SCALAR, with_losses, "other",                                                 \
    "energy lost in the bonds to the right of the particle and above it")                          \
  X(dead_cells, "1", SCALAR, with_failing, "other",                                                \
    "of the cells that begin with the node those that have died: a bit for each")

/* Symmetric tensors of any law, which frames hold component by component, stress_xx and so on; a
   deck asks for all of one or for a component.

   X(name, unit, words, words of a mesh's nodes), as the functions that find them: frames.c. */
#define OUTPUT_TENSORS(X)                                                                          \
  X(stress, "Pa", "stress of the bonds", "stress at the node, by the law")                         \
  X(strain, "1", "strain of the bonds that the particle began with", "strain at the node")

/* Whether a name is that of a component, "stress_xx". */
bool output_is_component(const char *name, int dimensions);

#endif
