/* What a result says of meshes and their cracks: tables of nodes and cells, and what is seen of
   them frame by frame: the cells that no crack crosses, and the cracks as lines.

     /meshes/<mesh>/{nodes,cells,method}   result.h
     /xdmf/cells/<k>                       [C, 4] particles: cells of all meshes that no crack
                                           crosses, for the frames of set k; [C, 3] or [C, 6] of
                                           triangles; where kinds differ all in one row, each with
                                           its number of XDMF before it
     /xdmf/cell_values/<field>/all         [sum of C] values of those cells, frame by frame, and
     /xdmf/cell_values/<field>/<frame>     [C] the same for each frame
     /xdmf/cracks/<crack>/<frame>          [P, 3] points of the crack
     /xdmf/nothing/<columns>/<P>           [P] NaN, [P, 3] 0: fields of the nodes and, [1], of the
                                           cells on a crack, which has none; a
                                           reader of ParaView's colours a grid only
                                           with arrays that all grids have

   A crack that has come further leaves out more cells, and so do cells that died: frames in between
   share a set. Which cells have died a field of nodes tells, dead_cells: a node has a bit for each
   cell that begins with it, in their order, 1, 2, 4, ...: 1 where the first has died. */
#ifndef PERILAT_RUNTIME_MESH_VIEWS_H
#define PERILAT_RUNTIME_MESH_VIEWS_H

#include <hdf5.h>
#include <math.h>
#include <string.h>

#include "runtime/result/result.h"

#define MESH_DEAD_CELLS "dead_cells"

/* Whether a cell has died: what its first corner has, and how many cells before it begin there. */
static inline bool mesh_cell_died(double value, int before) {
  return fmod(floor(ldexp(value, -before)), 2) >= 1;
}

typedef struct mesh_path { /* a crack, frame by frame */
  const result_field *field;
  const char *mesh; /* whose crack it is */
  long most;        /* points that it has had */
  double *points;   /* [frames][most][2] m, NaN beyond the last */
} mesh_path;

typedef struct mesh_cells { /* that are there and no crack crosses */
  int32_t *corners;         /* [corner_count] particles, cell by cell */
  unsigned char *nodes;     /* [count] of each: 3, 4, 6 */
  int32_t *numbers;         /* [count] among the cells of all meshes */
  long count, corner_count;
  int alike; /* nodes of all; 0: they differ */
} mesh_cells;

typedef struct mesh_views {
  mesh_path *paths; /* [path_count] */
  int path_count;
  mesh_cells *sets; /* [set_count] one at least where there are meshes */
  int set_count;
  int *set_of_frame; /* [frames] */
  double *dead;      /* [frames][particles] values of dead_cells; NULL: none can die */
  long particles;
} mesh_views;

/* Whose points are known already, with room for `most` of each frame. */
void mesh_views_find(mesh_views *v, const result_header *h, long frames);
void mesh_views_free(mesh_views *v);
/* Points that the path has in a frame. */
long mesh_path_count(const mesh_path *p, long frame);

bool mesh_views_write_meshes(hid_t file, const result_header *h);
/* After the frames. */
bool mesh_views_write(hid_t file, const result_header *h, const mesh_views *v, long frames);
void mesh_views_set_name(int set, char *name, size_t size);
void mesh_views_path_name(const mesh_path *p, long frame, char *name, size_t size);
/* A frame of a field of cells; where it begins among all frames. */
void mesh_views_values_name(const result_field *f, long frame, char *name, size_t size);
void mesh_views_all_values_name(const result_field *f, char *name, size_t size);
int64_t mesh_views_values_begin(const mesh_views *v, long frame);
void mesh_views_nothing_name(long points, int columns, char *name, size_t size);
/* "notch" of the field "notch/points". */
int mesh_path_name_length(const mesh_path *p);

#endif
