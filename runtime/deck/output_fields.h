/* What frames can hold of any law, beside its own states, damages, outputs and parameters. The
   values of field NAME are values_of_NAME in runtime/simulation/frames.c.

   X(name, unit, components, exists, kind, words), in the order of results. Components: VECTOR (one
   for each direction of space), ROTATION (one for each axis) or SCALAR. Exists: in which runs. Kind as in results: "damage" of
   the law, else "other". */
#ifndef PERILAT_RUNTIME_OUTPUT_FIELDS_H
#define PERILAT_RUNTIME_OUTPUT_FIELDS_H

#define OUTPUT_FIELDS(X)                                                                           \
  X(displacement, "m", VECTOR, always, "other", "displacement")                                    \
  X(velocity, "m/s", VECTOR, always, "other",                                                      \
    "velocity: the mean of those half a step before and after")                                    \
  X(rotation, "rad", ROTATION, with_rotations, "other", "rotation, counter-clockwise")             \
  X(force, "N", VECTOR, always, "other", "sum of the forces of the bonds")                         \
  X(damage, "1", SCALAR, with_damage, "damage",                                                    \
    "mean damage of the bonds that the particle began with")                                       \
  X(dissipated, "J", SCALAR, with_losses, "other",                                                 \
    "energy lost in the bonds to the right of the particle and above it")

#endif
