/* What is driven, and how: the groups of a path as they were read. The room: one bond, one
   particle of a law of families or one point of a continuum, driven along a path without a lattice
   or a mesh, what it answers row by row, with its energies, and what it is expected to answer. */
#ifndef PERILAT_GENERATOR_DRIVE_PATH_H
#define PERILAT_GENERATOR_DRIVE_PATH_H

#include "runtime/base/namelist.h"
#include "runtime/deck/deck.h"

/* What a path prescribes: X(code, name, unit) */
#define DRIVE_QUANTITIES(X)                                                                        \
  X(STRETCH, "stretch", "1")                                                                       \
  X(THETA_I, "theta_i", "1")                                                                       \
  X(THETA_J, "theta_j", "1")                                                                       \
  X(TWIST, "twist", "1")                                                                           \
  X(STRETCH_RATE, "stretch_rate", "1/s")                                                           \
  X(STRAIN_XX, "strain_xx", "1")                                                                   \
  X(STRAIN_YY, "strain_yy", "1")                                                                   \
  X(STRAIN_ZZ, "strain_zz", "1")                                                                   \
  X(STRAIN_XY, "strain_xy", "1")                                                                   \
  X(STRAIN_YZ, "strain_yz", "1")                                                                   \
  X(STRAIN_XZ, "strain_xz", "1")                                                                   \
  X(STRESS_XX, "stress_xx", "Pa")                                                                  \
  X(STRESS_YY, "stress_yy", "Pa")                                                                  \
  X(STRESS_ZZ, "stress_zz", "Pa")                                                                  \
  X(STRESS_XY, "stress_xy", "Pa") X(STRESS_YZ, "stress_yz", "Pa") X(STRESS_XZ, "stress_xz", "Pa")

typedef enum drive_quantity {
#define X(code, name, unit) DRIVE_##code,
  DRIVE_QUANTITIES(X)
#undef X
      DRIVE_QUANTITY_COUNT
} drive_quantity;

/* What becomes of the components of a point that no path names: X(code, name) */
#define DRIVE_TESTS(X)                                                                             \
  X(COMPONENTS, "components")                                                                      \
  X(UNIAXIAL_STRESS, "uniaxial stress")                                                            \
  X(PLANE_STRESS, "plane stress") X(SHEAR, "shear") X(HYDROSTATIC, "hydrostatic")

typedef enum drive_test {
#define X(code, name) DRIVE_TEST_##code,
  DRIVE_TESTS(X)
#undef X
      DRIVE_TEST_COUNT
} drive_test;

typedef enum drive_wave { WAVE_TRIANGLE, WAVE_SINE, WAVE_PULSE } drive_wave;

/* One group &path; those of one quantity add up. */
typedef struct drive_piece {
  drive_quantity quantity;
  span where;
  bool cyclic;
  time_function f; /* unless cyclic */
  drive_wave wave;
  double amplitude, period, start; /* cyclic: 1 or 1/s, s, s */
  int cycles;
} drive_piece;

/* One group &path with `field`: a field of the law by a table in time. */
typedef struct drive_given {
  const char *name;
  span name_where, where; /* of its values */
  time_function f;
  bool has_unit;
  dimension dim;
} drive_given;

/* One group &expect. */
typedef struct drive_expect {
  deck_item item;
  const char *quantity;       /* a column, "peak N", "final omega", "stretch at peak N" */
  double at_time, at_stretch; /* NaN: not given */
  double after;               /* s: the stretch is looked for from then on */
  const char *formula;        /* closed form in the law's language, or NULL */
  span formula_where;
  const namelist_key *value;    /* NULL with a formula */
  double tolerance;             /* relative */
  const namelist_key *absolute; /* tolerance in the quantity's unit, or NULL */
} drive_expect;

typedef struct drive_simulation {
  deck_item item;
  const char *title;
  double end_time; /* s; negative: where the last piece ends */
  int steps;
} drive_simulation;

typedef struct drive_bond {
  deck_item item;
  double spacing, thickness; /* m */
  double area;               /* m^2; 0: none, the bond is no bar */
  double mass_i, mass_j;     /* kg; negative: from rho */
  const char *setting;       /* NULL: the law's first */
} drive_bond;

/* Laws of families: one particle of a lattice in which all are alike. */
typedef struct drive_particle {
  deck_item item;
  const char *lattice; /* kind; NULL: hexagonal, of a law in space fcc with second neighbours */
  double spacing, thickness; /* m */
  double horizon;            /* spacings; 0: `shells` decides */
  int shells;                /* 0: the nearest neighbours */
  double rotation;           /* rad */
} drive_particle;

/* Laws of continua: one point. */
typedef struct drive_point {
  deck_item item;
  drive_test test;
  const char *setting; /* NULL: the law's first */
  double cell_size;    /* m */
} drive_point;

typedef struct drive_output {
  deck_item item;
  const char *csv, *hdf5, *picture; /* paths, or NULL */
  const char *x, *y;                /* columns of the picture */
  int rows;                         /* of the printed table */
} drive_output;

typedef struct drive_input {
  const char *path; /* of the file */
  drive_simulation simulation;
  drive_bond bond;
  drive_particle particle;
  drive_point point;
  drive_output output;
  deck_material material; /* model may be NULL */
  deck_material initial;  /* state and damage at the start, as assignments */
  drive_piece *pieces;
  int piece_count;
  drive_given *given;
  int given_count;
  drive_expect *expects;
  int expect_count;
} drive_input;

/* Reads sources->items[file], changed by overrides "group.key=value" as those of a deck; a table
   in a &path is read from its file beside it. NULL on errors. */
drive_input *drive_read(arena *a, source_set *sources, int file, const deck_override *overrides,
                        int override_count, diagnostics *d);

#endif
