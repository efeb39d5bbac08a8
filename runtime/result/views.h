/* What a result holds for programs of others, without a copy of the numbers: virtual data sets that
   show fields as these want them. One unstructured grid has the particles at the beginning as its
   points and the bonds of all interactions, one after the other, as its cells, lines. Vectors have
   three components. Fields of bonds with one name and unit are one array; it is NaN in bonds of
   interactions without that field.

     /VTKHDF                          for VTK's own reader, by the specification of VTKHDF 2.0: a
                                      grid with steps, all frames of a field one behind the other.
                                      Of a run on meshes alone its cells are theirs that no crack
                                      crosses, a part for each set of mesh_views.h
     /xdmf/particles/<field>/<frame>  [N] or [N, 3], and
     /xdmf/bonds/<field>/<frame>      [M]: a set for each frame, for the sidecar (xdmf.h)  */
#ifndef PERILAT_RUNTIME_VIEWS_H
#define PERILAT_RUNTIME_VIEWS_H

#include <hdf5.h>

#include "dsl/base/arena.h"
#include "runtime/result/mesh_views.h"

#define VIEWS_POINTS       "/VTKHDF/Points"       /* [N, 3] */
#define VIEWS_CONNECTIVITY "/VTKHDF/Connectivity" /* [2 M] */

/* An array of the grid: a field of the header, on bonds those of other interactions with it. */
typedef struct views_array {
  const result_field *field; /* the first of them */
  const char *name;
} views_array;

/* [field_count] at most; how many there are. Names belong to the header's fields or to `texts`. */
int views_arrays(const result_header *h, views_array *arrays, arena *texts);
/* Particles, or bonds of all interactions. */
long views_count(const result_header *h, const result_field *f);
/* After all else has been written. */
bool views_write(hid_t file, const result_header *h, const mesh_views *m, long frames);
/* Of all interactions. */
long views_bonds(const result_header *h);
/* Components in the views: 1 or 3. */
int views_components(const result_field *f);
/* The name of the set that shows a frame of an array. */
void views_frame_name(const views_array *a, long frame, char *name, size_t size);

#endif
