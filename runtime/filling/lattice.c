#include "runtime/filling/lattice.h"

#include "runtime/filling/bar_rows.h"
#include "runtime/filling/linked.h"
#include "runtime/filling/mesh_rows.h"
#include "runtime/lattice/edged_rows.h"
#include "runtime/lattice/rows_build.h"
#include "runtime/lattice/scattered.h"

rows *lattice_build(const deck *k, int lattice, diagnostics *d) {
  const deck_lattice *l = &k->lattices[lattice];
  if (deck_lattice_is_bar(l)) return bar_rows(k, lattice, d);
  if (deck_lattice_is_mesh(l)) return mesh_rows(k, lattice, d);
  if (l->edges == EDGES_EXACT) return edged_rows(k, lattice, d);
  return (deck_lattice_is_irregular(l) ? scattered_build : rows_build)(k, lattice, d);
}

rows *lattice_build_next(const deck *k, int lattice, rows *const *built, diagnostics *d) {
  return deck_lattice_is_link(&k->lattices[lattice]) ? linked_build(k, lattice, built, d)
                                                     : lattice_build(k, lattice, d);
}
