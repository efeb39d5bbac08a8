/* Fields of a result's frames, on particles and on the bonds of one interaction or of all. Values
   are malloc'ed; NULL with a sentence in `error` on failure. */
#ifndef PERILAT_RUNTIME_RESULT_FIELDS_H
#define PERILAT_RUNTIME_RESULT_FIELDS_H

#include <stdint.h>

#include "runtime/result/result_file.h"

C_LINKAGE_BEGIN

/* A name may be given by its last part where that says which. Of bonds there is a value for each of
   result_read_bonds, NaN where an interaction has no such field. */
double *result_read_frame(result_file *f, const char *field, long frame, long *count,
                          int *components, char *unit, size_t unit_size, char *error, size_t size);
/* One value for each cell of all meshes, in the order of their first particles; NULL where the
   result has none of that name, or they cannot be read (result_trouble). */
double *result_read_cells(result_file *f, const char *field, long frame, long *count, char *unit,
                          size_t unit_size);
int32_t *result_read_bonds(result_file *f, const char *interaction,
                           long *bonds); /* [M][2]; NULL name: of all, one after the other */
/* Largest of the damages of each bond (of all interactions), NaN where its law has none; NULL when
   the frame cannot be read or holds none (error ""). */
double *result_read_damage(result_file *f, long frame, long *bonds, char *error, size_t size);

C_LINKAGE_END

#endif
