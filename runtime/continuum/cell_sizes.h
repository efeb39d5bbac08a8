/* Whether the cells of a mesh are of sizes that a law holds for, and whether they have a size at
   all. */
#ifndef PERILAT_RUNTIME_CELL_SIZES_H
#define PERILAT_RUNTIME_CELL_SIZES_H

#include "dsl/base/diagnostics.h"
#include "runtime/kernel.h"
#include "runtime/mesh/mesh.h"

/* own[cells]: 1 where a cell is of the law; NULL: all are. parameters[law->parameter_count], SI.
   False with a diagnostic at `where` about the worst cell: it is too large or too small; or
   element-free, with a law that reads the size of cells. Such a law with cells whose sides differ
   much: a warning. */
bool cell_sizes_fit(const mesh *m, const unsigned char *own, const pl_law *law,
                    const double *parameters, span where, diagnostics *d);

#endif
