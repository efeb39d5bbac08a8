/* A field of the present state as a frame holds it. */
#ifndef PERILAT_RUNTIME_FRAME_FIELD_H
#define PERILAT_RUNTIME_FRAME_FIELD_H

#include <stdbool.h>

typedef struct frame_field {
  const char *name, *unit;
  bool on_bonds, on_cells;
  int components;
  int interaction;  /* of the run; on particles the first that has the field */
  long count;       /* particles of all bodies, bonds of that interaction, or cells of all meshes */
  bool of_law;      /* it, or a parameter, has its name from the law */
  bool of_cracks;   /* place and width (m) of the cracks across a monitor's line; it has the
                            monitor's name, and is NaN beyond the last crack; or places (m) of the
                            points of a crack of a mesh, "notch/points", NaN beyond the last */
  const char *mesh; /* of such a crack; else NULL */
  bool of_stamp;    /* how far it has gone from where it is drawn; `count` is along how many axes */
  const char *kind; /* "state", "damage", "output" of the law; "cracks"; "path"; "stamp"; else
                       "other" */
  const char *long_name; /* in words: the law's, where it is of the law */
} frame_field;

#endif
