/* When a run stops because a state went bad: the bond or point at fault as a path for
   `perilat drive`. */
#ifndef PERILAT_GENERATOR_BAD_BOND_H
#define PERILAT_GENERATOR_BAD_BOND_H

#include "generator/kernel/model.h"
#include "runtime/lattice/rows.h"
#include "runtime/simulation/simulation.h"

/* Writes the bond's last state, its lattice and all parameters. `m` may be NULL (a stand-alone
   solver): then the law is named, not found. What is not finite is left out and said in a comment.
   False with a sentence in `error`. */
bool bad_bond_write(const char *path, const char *deck_name, const model *m,
                    const simulation_law *l, const rows *w, const bad_state *b, char *error,
                    size_t size);

/* The same of the point of a mesh; at rest. */
bool bad_point_write(const char *path, const char *deck_name, const model *m,
                     const simulation_law *l, const deck_lattice *of, const bad_state *b,
                     char *error, size_t size);

/* Of a point's cell: the number that its file gives it, or "(i, j)" in a grid. */
enum { BAD_CELL_TEXT = 32 };
const char *bad_cell_text(const deck_lattice *of, const int cell[2], char text[BAD_CELL_TEXT]);

/* `<result>_bad_bond.nml` for `<result>.h5`; where a point is at fault `<result>_bad_point.nml`. */
void bad_bond_path(const char *result, const bad_state *b, char *path, size_t size);

#endif
