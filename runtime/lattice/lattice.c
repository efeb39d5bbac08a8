#include "runtime/lattice/lattice.h"

#include "runtime/lattice/rows_build.h"
#include "runtime/lattice/scattered.h"

rows *lattice_build(const deck *k, int lattice, diagnostics *d) {
  const bool irregular = deck_lattice_is_irregular(&k->lattices[lattice]);
  return (irregular ? scattered_build : rows_build)(k, lattice, d);
}
