/* The mesh that a deck describes: nodes, zones of methods, holes, rules of integration. */
#ifndef PERILAT_RUNTIME_MESH_BUILD_H
#define PERILAT_RUNTIME_MESH_BUILD_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/mesh/mesh.h"

/* Of the deck's lattice of that number, which is a &mesh. False with a diagnostic where a zone
   holds no node; the mesh is to be closed in any case. */
bool mesh_build(const deck *k, int lattice, mesh *out, diagnostics *d);

#endif
