/* Which of a mesh's laws each of its cells has: that of the last material whose region holds all
   corners of the cell that are there, else that of the material without region:

       o---o---o---o    region: the nodes x     law 0 has no region
       | 0 | 0 | 0 |                            law 1 that of x
       o---x---x---x
       | 0 | 1 | 1 |    a cell on the border of a region is of the material around it
       o---x---x---x                                                                             */
#ifndef PERILAT_RUNTIME_CELL_LAWS_H
#define PERILAT_RUNTIME_CELL_LAWS_H

#include "dsl/base/diagnostics.h"
#include "runtime/deck/deck.h"
#include "runtime/lattice/rows.h"
#include "runtime/mesh/mesh.h"

enum { CELL_LAWS_MOST = 254 };

typedef struct cell_laws {
  int count;
  unsigned char *of_cell; /* [cells] which; NULL: there is one */
  /* Of several, [count] each: [cells] 1 where a cell is of the law; [sites] 1 at nodes with such a
     cell around; [sites] which part of the cells around a node, by their areas, is of the law. */
  unsigned char **cells, **sites;
  double **share;
} cell_laws;

/* Of the deck's lattice of that number, a &mesh. To be closed in any case. False with a diagnostic
   where a material is for nothing. */
bool cell_laws_open(cell_laws *l, const deck *k, int lattice, const rows *nodes, const mesh *m,
                    diagnostics *d);
void cell_laws_close(cell_laws *l);

/* Number of a cell's law. */
static inline int cell_laws_at(const cell_laws *l, int cell) {
  return l->of_cell ? l->of_cell[cell] : 0;
}
/* [cells] as point_forces_new takes it. */
static inline const unsigned char *cell_laws_own(const cell_laws *l, int number) {
  return l->of_cell ? l->cells[number] : NULL;
}

#endif
