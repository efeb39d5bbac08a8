/* Meshes of a result as pictures show them: cells, coloured by their own values or their nodes',
   and cracks. A cell that a crack crosses is cut into small parts, each of which takes the values
   of the nodes on its own side. */
#ifndef PERILAT_RUNTIME_PLOT_MESH_H
#define PERILAT_RUNTIME_PLOT_MESH_H

#include <stdint.h>

#include "runtime/mesh/crack_lines.h"
#include "runtime/result/result_file.h"

typedef struct plot_crack {
  char name[80], mesh[80];
  double *points; /* [count][2] m, where they were at the beginning */
  long count;
  long first, last; /* of the points: the crack as it was at the beginning */
} plot_crack;

typedef struct plot_mesh {
  char name[80];
  long cell_count;
  long all_count; /* with those that have died, which stand behind */
  /* [all_count][4] particles, counter-clockwise; a triangle has its last one twice, one of 6 nodes
     is four of them */
  int32_t *cells;
  /* [all_count] of a file: the first node of the cell; -1: of the same as the one before; NULL:
     cells[.][0] */
  int32_t *first;
  int32_t *number; /* [all_count] which of the cells of all meshes it is, or a part of */
  long listed;     /* cells in the result */
  int64_t first_particle;
  double size; /* m: a side of a cell of the same area */
  crack_lines lines;
} plot_mesh;

typedef struct plot_meshes {
  plot_mesh *items; /* [count] */
  int count;
  plot_crack *cracks; /* [crack_count] */
  int crack_count;
} plot_meshes;

/* All that the result has, with the cracks as they are in the frame (negative: from the end). False
   with a sentence in `error`. To be freed in either case. */
bool plot_meshes_read(plot_meshes *m, result_file *f, long frame, char *error, size_t size);
void plot_meshes_free(plot_meshes *m);
/* Cells that have died are shown, too: [cells of all meshes], 1 where one has, else 0; to be
   freed. */
double *plot_meshes_show_dead(plot_meshes *m);
/* Of all meshes. */
long plot_meshes_cells(const plot_meshes *m);

/* What is drawn: nodes at the beginning and where they have moved to, [particles][2] m, and a value
   of each (may be NULL). */
typedef struct mesh_view {
  const double *reference, *moved, *values;
  const double *of_cells; /* [cells of all meshes] in place of `values`; NULL: none */
} mesh_view;

/* A part of a cell: four corners around, m, and what they have there. */
typedef void mesh_part(void *context, const double at[4][2], const double value[4]);
/* Cells that no crack crosses come in `whole` x `whole` parts, others in `cut` x `cut`. */
void plot_mesh_parts(const plot_mesh *m, const mesh_view *v, int whole, int cut, mesh_part *take,
                     void *context);
/* Where a side of a crack has moved to: a point of it at the beginning, and the direction, m, in
   which its side lies. */
void plot_mesh_face(const plot_mesh *m, const mesh_view *v, const double at[2],
                    const double side[2], double moved[2]);
/* One face of the crack's legs from point `from` to point `to`, in points near to each other; side
   is 1 on the left, -1 on the right. */
typedef void crack_point(void *context, const double moved[2]);
void plot_mesh_crack_face(const plot_mesh *m, const mesh_view *v, const plot_crack *k, long from,
                          long to, double side, crack_point *take, void *context);
/* Whether a crack cuts the cell, so that it comes in `cut` parts. */
bool plot_mesh_is_cut(const plot_mesh *m, const mesh_view *v, long cell);
/* Sides of cells that belong to one cell alone, in pairs of particles, [*count][2]; to be freed. */
int32_t *plot_mesh_outline(const plot_mesh *m, long *count);

#endif
