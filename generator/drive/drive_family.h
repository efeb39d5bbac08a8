/* One particle of a law of families under the strains of a path. */
#ifndef PERILAT_GENERATOR_DRIVE_FAMILY_H
#define PERILAT_GENERATOR_DRIVE_FAMILY_H

#include "dsl/semantics/law.h"
#include "generator/drive/drive_path.h"
#include "generator/drive/drive_table.h"
#include "runtime/kernel.h"

/* What stress and force states are observed with: of one law, along any path. */
typedef struct family_gauge {
  struct kernel_plan *plan; /* NULL: not yet made */
  pl_law *kernel;
} family_gauge;

/* As drive_run, drive_columns, drive_observe: one particle under the path's strains (small, as
   tensor components), its neighbours always in the same state. Columns: time; strain_xx, ...;
   strain_rate_xx, ...; stress_xx, ... (by virtual work of the bond forces); F_1, ... (force
   state toward each neighbour, in the order of the lattice); the law's fields and outputs
   (toward neighbours: name_1, ...); energies of the particle: stored, dissipated, external. `g` is
   made when it is needed first, and to be closed. */
bool drive_family_run(const drive_input *in, const law *l, const pl_law *kernel, family_gauge *g,
                      const double *parameters, const double *initial, drive_table *out,
                      diagnostics *d);
void family_gauge_close(family_gauge *g);
void drive_family_columns(const drive_input *in, const law *l, const pl_law *kernel,
                          drive_table *out);
void drive_family_observe(const drive_input *in, const law *l, const pl_law *kernel,
                          const double *parameters, const drive_table *t, long row,
                          double *outputs);
/* The lattice of the particle. */
deck_lattice drive_lattice(const drive_input *in, const law *l);

#endif
