/* A frame of a result as a map shows it: places in the plane of the picture. A body in the plane is
   shown as it is; of a body in space a slice, or what is seen of its surface. */
#ifndef PERILAT_RUNTIME_PLOT_FRAME_H
#define PERILAT_RUNTIME_PLOT_FRAME_H

#include <stdint.h>

#include "runtime/plot/plot_map.h"
#include "runtime/plot/plot_mesh.h"
#include "runtime/plot/plot_stamps.h"

typedef struct plot_frame {
  int dimensions; /* of the result; from plot_frame_read on, places have two coordinates */
  long particles, bonds;
  double *reference, *moved; /* [particles][2] m */
  double *damage;            /* [bonds] NULL without */
  /* [bonds] 1 where the second of two damages is the larger one, `damage`; NULL: one damage */
  double *second;
  char damages[2][64]; /* names of the two */
  int32_t *pairs;      /* [bonds][2] */
  double *values;      /* of the particles, or of the bonds; NULL: a map of damage */
  double *of_cells;    /* [cells of all meshes] in place of the values of their nodes; NULL: none */
  long value_count;
  bool of_bonds; /* the values are those of bonds */
  /* Of the particles, or of the bonds: 1 where there is a mark, else 0; NULL without marks. */
  double *marked;
  bool marks_on_bonds;
  /* damages, to be shown in their classes: of bonds, or the values as means on particles */
  bool of_damage;
  bool surface; /* particles alone, from the farthest to the nearest */
  int components;
  char unit_text[64], title[512];
  const char *damage_of; /* what the damages shown are those of */
  char view[80];         /* of a body in space: what is shown, for the picture's head */
  double axes[3][2];     /* of a body in space: unit vectors along x, y, z in the picture, m a m */
  char extents[128]; /* of a body in space: "x 0 to 100 mm, ...", where it stood in the beginning */
  plot_meshes meshes; /* their nodes are particles, too */
  plot_stamps stamps;
  unsigned char *nodes; /* [particles] 1: a node of a mesh; NULL without meshes */
  char shown[256];      /* what the values are, "stress_yy" */
  double time, factor, spacing;
  double *size;     /* [particles] of graded ones their spacing over the mean one; else NULL */
  long increment;   /* of a quasi-static run; -1: a dynamic one */
  double frequency; /* Hz: of the mode that the frame is, whose number is `time`; NaN: of none */
} plot_frame;

/* False with a sentence in `error`. To be freed in either case. */
bool plot_frame_read(plot_frame *m, const char *path, const plot_map_options *o, char *error,
                     size_t size);
/* The same of a result that is open, whose path is named in sentences. */
bool plot_frame_take(plot_frame *m, result_file *f, const char *path, const plot_map_options *o,
                     char *error, size_t size);
void plot_frame_free(plot_frame *m);

/* Component of value k, or its size for component -1. */
double plot_frame_value(const plot_frame *m, long k, int component);
/* m: as wide as particle p is shown. */
double plot_frame_spacing(const plot_frame *m, long p);

#endif
