/* One bond along x between two particles, driven by the passes that a beam runs, compiled or on
   the interpreter. */
#ifndef PERILAT_GENERATOR_DRIVE_BOND_H
#define PERILAT_GENERATOR_DRIVE_BOND_H

#include "dsl/semantics/law.h"
#include "generator/drive/drive_path.h"
#include "generator/drive/drive_table.h"
#include "runtime/kernel.h"

/* A table without rows: the columns that a drive of `kernel` will have. To be freed. */
void drive_columns(const law *l, const pl_law *kernel, drive_table *out);
/* Drives the law's `kernel`. `initial` [fields] is where state and damage begin. The table must be
   freed. False, with a message, when the path leaves what a bond can do (a stretch of -1). */
bool drive_run(const drive_input *in, const law *l, const pl_law *kernel, const double *parameters,
               const double *initial, drive_table *out, diagnostics *d);
/* What the law is told about the bond: it is one of a hexagonal lattice, but for the masses that
   the path gives. rho may be 0. False where there is no lattice of such a spacing. */
bool drive_bond_class(const drive_input *in, double rho, pl_bond_class *out);

/* The law's outputs, of whatever law with the same parameters and fields, in the state of one row.
 */
void drive_observe(const drive_input *in, const pl_law *kernel, const double *parameters,
                   const drive_table *t, long row, double *outputs);

#endif
