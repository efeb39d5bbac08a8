/* Maps of frames through Cairo, as PNG, SVG or PDF by the path's ending. */
#ifndef PERILAT_RUNTIME_PLOT_MAP_H
#define PERILAT_RUNTIME_PLOT_MAP_H

#include <stdbool.h>
#include <stddef.h>

#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

typedef struct plot_map_options {
  const char *output;
  long frame; /* from 0; negative: from the end (-1 the last) */
  /* "damage" (bonds in its colour classes, default), any field of particles or bonds, or two
     damages of bonds, "omega_t,omega_c": each bond in the colours of that which is larger */
  const char *field;
  int component; /* of a vector field; -1: magnitude */
  /* of a tensor that is stored component by component, "stress": "xx", "yy", ..., or "principal",
     the largest principal value; NULL: the field is none */
  const char *part;
  const char *range; /* "LOW,HIGH": values that have colours of their own; NULL: all there are */
  int contours;      /* of a mesh: about so many lines of equal value; 0: filled cells */
  double factor; /* displacements are drawn times this; negative: chosen so that they can be seen */
  /* 0 x, 1 y, 2 z: of a body in space, a slice at right angles to that axis; negative: its
     surface */
  int slice_axis;
  double slice_at; /* m */
  /* "yielded", "S_p > 1e-6": dots where a field is above 0, above or below a value; NULL: none */
  const char *mark;
  const char *title;
  /* Several frames instead of one, a panel each, with what stands above it; NULL: its time. */
  const long *frames;
  const char *const *captions;
  int frame_count;
} plot_map_options;

enum { PLOT_MOST_PANELS = 48, PLOT_MOST_CONTOURS = 24 };

/* Particles and bonds of one frame, or of several beside each other, deformed, with a legend and a
   scale bar in mm; of meshes their cells and cracks. */
bool plot_map(const char *result, const plot_map_options *o, char *error, size_t size);

C_LINKAGE_END

#endif
