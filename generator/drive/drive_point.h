/* One point of a law of a continuum under the strains and stresses of a path. */
#ifndef PERILAT_GENERATOR_DRIVE_POINT_H
#define PERILAT_GENERATOR_DRIVE_POINT_H

#include "dsl/semantics/law.h"
#include "generator/drive/drive_path.h"
#include "generator/drive/drive_table.h"
#include "generator/drive/ellipticity.h"
#include "runtime/kernel.h"

/* Where the point first loses its ellipticity along the path. */
typedef struct drive_band {
  long row; /* of the table; -1: nowhere */
  ellipticity of;
} drive_band;

/* As drive_run, drive_columns, drive_observe. Columns: time; strain_xx, ...; strain_rate_xx, ...;
   stress_xx, ... (in the plane stress_zz, too); ellipticity (ellipticity.h); the law's fields and
   outputs; energies in J/m^3. */
bool drive_point_run(const drive_input *in, const pl_law *kernel, const double *parameters,
                     const double *initial, drive_table *out, drive_band *band, diagnostics *d);
void drive_point_columns(const drive_input *in, const pl_law *kernel, drive_table *out);
void drive_point_observe(const drive_input *in, const pl_law *kernel, const double *parameters,
                         const drive_table *t, long row, double *outputs);
/* Whether the path can drive such a point. False after a message. */
bool drive_point_suits(const drive_input *in, const pl_law *kernel, diagnostics *d);

#endif
