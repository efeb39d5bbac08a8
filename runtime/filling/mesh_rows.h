/* The nodes of a &mesh as rows of particles without bonds, which stand in memory as node_layout.h
   has it. Without holes node (i, j) is particle j*nodes_x + i; nodes in holes are no particles. */
#ifndef PERILAT_RUNTIME_MESH_ROWS_H
#define PERILAT_RUNTIME_MESH_ROWS_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/lattice/rows.h"
#include "runtime/mesh/mesh.h"

/* NULL with a diagnostic where there are too many nodes or holes leave none. Masses are not known
   yet. */
rows *mesh_rows(const deck *k, int lattice, diagnostics *d);

/* Gives a mesh the deck's background rule and cuts its holes by it, before it is settled. Returns
   how many nodes are left. */
int mesh_rows_cut(const deck *k, const deck_mesh *l, mesh *m);

#endif
