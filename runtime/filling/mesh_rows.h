/* The nodes of a &mesh as rows of particles without bonds: node (i, j) is particle j*nodes_x + i, and
   stands in memory as node_layout.h has it. */
#ifndef PERILAT_RUNTIME_MESH_ROWS_H
#define PERILAT_RUNTIME_MESH_ROWS_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/lattice/rows.h"

/* NULL with a diagnostic where there are too many nodes. Masses are not known yet. */
rows *mesh_rows(const deck *k, int lattice, diagnostics *d);

#endif
