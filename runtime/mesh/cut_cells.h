/* Cells of a mesh that a hole cuts, and their points of integration, which stand outside of the
   hole alone. A cut cell is divided along one axis where the outline begins, ends, has a corner or
   crosses the cell's sides; each part has Gauss's places along that axis, and at each of these the
   line across the cell has Gauss's points on every piece outside of the holes:

        +---|---------+      The weights are positive and sum to the cell's area outside: exactly
        |: :|: :'. hole      with straight outlines, to some 1e-6 of the cell with round ones.
        |: :|: : :'.__|      Functions that are smooth outside are integrated as well as in whole
        |: :|: : :  : |      cells.
        +---|---------+ */
#ifndef PERILAT_RUNTIME_CUT_CELLS_H
#define PERILAT_RUNTIME_CUT_CELLS_H

#include "runtime/mesh/mesh.h"

typedef struct cut_points {
  double (*at)[2]; /* [count] m */
  double *area;    /* [count] m^2 */
  int count, room;
} cut_points;

/* Adds the points of the cell, by the mesh's background rule. */
void cut_cell_points(const mesh *m, int cell, cut_points *to);
void cut_points_free(cut_points *p);

/* By the mesh's holes: which nodes and cells are gone, and which cells are cut: one with a
   corner that is gone is. The nodes of a cut cell are element-free, whatever they were. A node is
   gone in a hole, and where no cell or none of its cells' points sees it. Before mesh_settle.
   Returns how many nodes are left. */
int mesh_cut(mesh *m);

#endif
