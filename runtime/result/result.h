/* Writing the result file (HDF5) and its XDMF sidecar; reading is result_read.h's. While a run goes
   on, frames are added to a plain file beside it (frame_file.h), which survives a kill; result.h5
   itself appears whole, by rename, when the run ends. Layout, names and units of result.h5 are
   stable:

     /                      attributes seal (sealed_file.h), perilat_version, started (ISO 8601),
                            title, deck (its name), dt, steps, kernel_key, compiler,
                            flags (of the kernels), threads,
                            ended (how, in words), status (of exit), wall_seconds
     /said/<when>           what the run said: begin, end, warnings (only where it said any)
     /input/deck            text; /input/set: what --set changed in it, one a line (only then);
                            /input/models/<name> law text; /input/kernels/<name> generated C;
                            /input/files/<name> tables of loads (only then)
     /particles/reference   [N, dimensions] m, body by body in the order of the deck's lattices
     /particles/body        [N] which of them
     /particles/volume      [N] m^3
     /particles/spacing     [N] m; only where particles are graded
     /particles/resolved    [N] 1 where the bonds resolve all strains, else 0; only of particles
                            that stand on no lattice
     /bonds/<interaction>   [M, 2] particle indices
     /history/time          [T] s, or pure numbers of what the samples are of;
                            /history/<monitor> [T], attributes units and long_name;
                            /history/energy/<term> [T] J
     /frames/time           [F] likewise; /frames/<field> [F, N, components];
                            /frames/<interaction>/<bond field> [F, M], attributes units, long_name
                            and kind ("state", "damage", "output" of the law, "other")
     /cells/<field>         [F, C]: states and outputs of laws that are not linear, a value for each
                            cell of all meshes in the order of their first particles; attributes as
                            of fields of frames; only with meshes of such laws
     /cracks/<monitor>      [F, N, 2] m: place along the monitor's line and width of each crack in
                            the order of places, NaN beyond the last; only with such monitors
     /cracks/<crack>/points [F, P, 2] m: the points of a mesh's crack from its first to its last,
                            with what has grown at either end, NaN beyond; P as many as it has had;
                            attribute mesh
     /stamps/<stamp>/       place [F, dimensions] m, from where it is drawn; in the plane outline
                            [P, 2] m, its corners there, counter-clockwise; only with stamps
     /meshes/<mesh>/        nodes [N, 2] m, cells [C, 4] their nodes counter-clockwise, method [C]
                            of cells (1 a finite element, 2 blended, 3 element-free); of a file
                            node_numbers [N], cell_numbers [C] there; attributes
                            first_particle (of its nodes in /particles) and thickness (m)
     /state                 all of the state at the end, for another run (result_state.h); only
                            where the deck asks for it
     /VTKHDF, /xdmf         the same for other programs (views.h)

   The times are dimension scales of what stands beside them. */
#ifndef PERILAT_RUNTIME_RESULT_H
#define PERILAT_RUNTIME_RESULT_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "dsl/base/c_linkage.h"
#include "runtime/result/frame_file.h"

C_LINKAGE_BEGIN

struct result_state; /* result_state.h */

typedef struct result_text {
  const char *name, *text;
} result_text;

typedef struct result_field { /* of a frame */
  const char *name;
  const char *unit;        /* "m", "1" */
  const char *interaction; /* NULL: per particle; else bond field of that interaction */
  int components;          /* 1, 2, ... */
  long count;              /* particles, bonds, cells or, at most, cracks */
  /* "state", "damage", "output" of the law; "cells": one value for each cell of the meshes, in
     their order; "cracks" across the line of the monitor of that name;
     "path" of a crack of a mesh; "stamp": its way along each axis, `count` of them; else "other" */
  const char *kind;
  const char *long_name; /* in words; NULL: nobody has said */
} result_field;

/* The points of a crack, "notch/points"; `count` is how many it can have. */
static inline bool result_field_is_path(const result_field *f) {
  return strcmp(f->kind, "path") == 0;
}
static inline bool result_field_of_cells(const result_field *f) {
  return strcmp(f->kind, "cells") == 0;
}
static inline bool result_field_of_stamp(const result_field *f) {
  return strcmp(f->kind, "stamp") == 0;
}
/* Neither of particles nor of bonds nor of cells nor of a stamp. */
static inline bool result_field_of_cracks(const result_field *f) {
  return strcmp(f->kind, "cracks") == 0 || result_field_is_path(f);
}

typedef struct result_series { /* of the history */
  const char *name;            /* "load"; "energy/kinetic" */
  const char *unit;
  const char *long_name; /* in words; NULL: nobody has said */
  const double *values;  /* [history_count] */
  /* Of a series that judges the run: attribute `checked` 1, or 0 where it is not known, with the
     sentence `unchecked`. */
  bool judges;
  const char *unchecked;
} result_series;

typedef struct result_bonds { /* of an interaction */
  const char *name;           /* the lattice's */
  long count;
  const int32_t *pairs; /* [count][2] particles */
} result_bonds;

typedef struct result_mesh {
  const char *name;
  long first_particle, node_count; /* its nodes are particles of the result */
  long cell_count;
  int columns;          /* 4; 3, 4 or 6 where cells come from a file */
  const int32_t *cells; /* [cell_count][columns] its nodes: corners counter-clockwise, then those of
                            the sides; -1 behind the last */
  const int32_t *method;                      /* [cell_count] 1, 2, 3 as /meshes says */
  double thickness;                           /* m */
  const int64_t *node_numbers, *cell_numbers; /* of its file; NULL: it has none */
} result_mesh;

typedef struct result_crack { /* whose points are a path */
  const char *field, *mesh;   /* "notch/points", "beam" */
} result_crack;

typedef struct result_stamp { /* in the plane, where it is drawn */
  const char *name;
  const double *outline; /* [count][2] m */
  int count;
} result_stamp;

typedef struct result_header {
  const char *path;        /* of the final file */
  const char *fingerprint; /* says which run the frames belong to */
  const char *numbers;     /* "number of the mode": what stands in place of times; NULL: times */
  const char *title, *started, *version, *kernel_key;
  const char *compiler, *flags; /* of the kernels */
  int threads;
  const char *deck_name; /* of its file, as it was given; NULL: not known */
  const char *deck_text;
  const char *overrides; /* of --set, one a line; NULL or "" without */
  const result_text *models, *kernels;
  int model_count, kernel_count;
  const result_text *files; /* tables of loads */
  int file_count;
  int dimensions; /* 2 or 3 */
  long particle_count;
  const double *reference;   /* [N][dimensions] */
  const int32_t *body;       /* [N] number of the body in the deck, from 0 */
  const double *volume;      /* [N] */
  const int32_t *resolved;   /* [N]; NULL on lattices */
  const double *spacing;     /* [N] m; NULL where no particles are graded */
  const result_bonds *bonds; /* [interaction_count] */
  int interaction_count;
  const result_mesh *meshes;
  int mesh_count;
  const result_crack *cracks; /* [crack_count] all paths */
  int crack_count;
  const result_stamp *stamps; /* [stamp_count] */
  int stamp_count;
  const result_field *fields;
  int field_count;
} result_header;

typedef struct result_ending {
  const char *ended;       /* how, in words */
  const result_text *said; /* [said_count] what the run said: "begin", ... */
  int said_count;
  int status;     /* of exit */
  double seconds; /* wall time since the run began or was resumed */
  double dt;
  long steps;
  const double *time; /* [history_count] */
  long history_count;
  const result_series *series;
  int series_count;
  const struct result_state *state; /* NULL: it is not kept */
} result_ending;

typedef struct result result;

/* Opens and locks the file of the frames, and changes nothing yet. With `resume` it must be there.
   On failure returns NULL with a sentence in error (size bytes). */
result *result_open(const result_header *header, bool resume, char *error, size_t size);
/* Either comes next: a new run, without frames, or one that goes on from the frames that the mark
   tells of. */
bool result_begin(result *r, char *error, size_t size);
bool result_resume(result *r, const frame_mark *mark, char *error, size_t size);
/* Appends a frame: values[k] is field k, [count][components]. False when it cannot be written (disk
   full). */
bool result_frame(result *r, double time, const double *const *values, char *error, size_t size);
frame_mark result_mark(const result *r); /* of the frames so far */
/* The frames can be read, every bit as it was written. */
bool result_frames_hold(const result *r);
/* Forces the frames to the disk (before a checkpoint that counts on them). */
bool result_sync(result *r, char *error, size_t size);
/* The name of what is written beside the result for ParaView: RESULT.xdmf for RESULT.h5. */
void result_sidecar(const char *path, char *sidecar, size_t size);
/* Writes result.h5 and result.xdmf, whole or not at all; the file of the frames stays. */
bool result_finish(result *r, const result_ending *e, char *error, size_t size);
/* Removes the file of the frames; the result is closed afterwards all the same. */
void result_discard(result *r);
void result_close(result *r); /* frees; keeps files */

C_LINKAGE_END

#endif
