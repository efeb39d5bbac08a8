/* One bond driven along a path, without a lattice: what a law answers, row by row, with its
   energies; and what it is expected to answer. Exercises and tests of laws are written in such
   paths.

   A path is a namelist file (groups in drive_path.c's table, printed by drive_reference). The bond
   lies along x between two particles; the passes that a beam runs drive it, compiled or on the
   interpreter. */
#ifndef PERILAT_GENERATOR_DRIVE_H
#define PERILAT_GENERATOR_DRIVE_H

#include "dsl/base/diagnostics_json.h"
#include "generator/kernel/model.h"
#include "runtime/deck/deck.h"
#include "runtime/deck/namelist.h"

/* What a path prescribes: X(code, name, unit) */
#define DRIVE_QUANTITIES(X)                                                                        \
  X(STRETCH, "stretch", "1")                                                                       \
  X(THETA_I, "theta_i", "1")                                                                       \
  X(THETA_J, "theta_j", "1")                                                                       \
  X(STRETCH_RATE, "stretch_rate", "1/s")                                                           \
  X(STRAIN_XX, "strain_xx", "1")                                                                   \
  X(STRAIN_YY, "strain_yy", "1")                                                                   \
  X(STRAIN_ZZ, "strain_zz", "1")                                                                   \
  X(STRAIN_XY, "strain_xy", "1") X(STRAIN_YZ, "strain_yz", "1") X(STRAIN_XZ, "strain_xz", "1")

typedef enum drive_quantity {
#define X(code, name, unit) DRIVE_##code,
  DRIVE_QUANTITIES(X)
#undef X
      DRIVE_QUANTITY_COUNT
} drive_quantity;

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
  double mass_i, mass_j;     /* kg; negative: from rho */
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
  drive_output output;
  deck_material material; /* model may be NULL */
  deck_material initial;  /* state and damage at the start, as assignments */
  drive_piece *pieces;
  int piece_count;
  drive_expect *expects;
  int expect_count;
} drive_input;

/* Reads sources->items[file], changed by overrides "group.key=value" as those of a deck; a table in a &path is
   read from its file beside it. NULL on errors. */
drive_input *drive_read(arena *a, source_set *sources, int file, const deck_override *overrides,
                        int override_count, diagnostics *d);
/* Every group and key, as Markdown. */
void drive_reference(FILE *out);
/* The groups that a path may hold. */
extern const struct deck_grammar drive_grammar;
/* The group of paths with that name (without &), or NULL. */
const struct deck_group_info *drive_group(const char *name);

/* True when `file` has a group that only paths have; that only decks have. */
bool drive_is_path(const char *file);
bool drive_is_deck(const char *file);
/* True, after a sentence on the standard error stream, when `file` is a path for `perilat drive` and
   not the deck that `perilat COMMAND` needs. */
bool drive_refuse_path(const char *command, const char *file);

/* Value at a time, and the slope there, which is taken at a time between two steps. */
double drive_at(const drive_input *in, drive_quantity q, double time);
double drive_slope(const drive_input *in, drive_quantity q, double time);
bool drive_prescribes(const drive_input *in, drive_quantity q);
/* Times within the path at which one of its pieces begins, ends or has a corner, ascending; malloc'ed. */
double *drive_corners(const drive_input *in, long *count);
/* Times from 0 to the end at which the bond is evaluated, ascending: even steps, the corners of the
   path and the times that expectations name; malloc'ed. */
double *drive_times(const drive_input *in, long *count);
double drive_end(const drive_input *in);
/* First time from `after` on at which the stretch takes the value, or NaN. */
double drive_time_of_stretch(const drive_input *in, double stretch, double after);

/* --- driving ---------------------------------------------------------------------------------- */

/* The columns before and after those of the law: X(code, name, unit) */
#define DRIVE_FIRST_COLUMNS(X)                                                                     \
  X(TIME, "time", "s")                                                                             \
  X(STRETCH, "stretch", "1")                                                                       \
  X(STRETCH_RATE, "stretch_rate", "1/s")                                                           \
  X(THETA_I, "theta_i", "1")                                                                       \
  X(THETA_J, "theta_j", "1") X(N, "N", "N") X(M_I, "M_i", "N*m") X(M_J, "M_j", "N*m")
/* Energies in J. `dissipated` is the sum of its two parts; `external` counts from what the first
   row holds; `imbalance` is external less stored less dissipated. */
#define DRIVE_LAST_COLUMNS(X)                                                                      \
  X(STORED, "stored")                                                                              \
  X(DISSIPATED_DAMAGE, "dissipated_damage")                                                        \
  X(DISSIPATED_DAMPING, "dissipated_damping")                                                      \
  X(DISSIPATED, "dissipated") X(EXTERNAL, "external") X(IMBALANCE, "imbalance")

enum {
#define X(code, name, unit) DRIVE_COLUMN_##code,
  DRIVE_FIRST_COLUMNS(X)
#undef X
      DRIVE_COLUMN_LAW /* fields and outputs follow */
};
enum {
#define X(code, name) DRIVE_ENERGY_##code,
  DRIVE_LAST_COLUMNS(X)
#undef X
      DRIVE_ENERGY_COUNT
};

typedef struct drive_column {
  const char *name, *unit;
  double *values; /* [rows] */
} drive_column;

typedef struct drive_table {
  bool of_families;
  int way,
      force; /* columns of what is prescribed and what answers: stretch and N, first strain and stress */
  int law_column; /* those of the law's fields, then its outputs, begin here */
  drive_column *columns;
  int column_count;
  long rows;
  int fields;    /* columns of the law's fields */
  long bad_row;  /* first row in which a value is not finite, or -1; rows then end with it */
  arena *memory; /* owns all */
} drive_table;

/* A table without rows: the columns that a drive of `kernel` will have. To be freed. */
void drive_columns(const pl_law *kernel, drive_table *out);
/* Drives `kernel`. `initial` [fields] is where state and damage begin. The table must be freed.
   False, with a message, when the path leaves what a bond can do (a stretch of -1). */
bool drive_run(const drive_input *in, const pl_law *kernel, const double *parameters,
               const double *initial, drive_table *out, diagnostics *d);
void drive_table_free(drive_table *t);
/* A law's own name that is a column already stands with `law_` before it. */
void drive_add_column(drive_table *t, const char *name, const char *unit_text, long rows);
int drive_column_find(const drive_table *t, const char *name); /* or -1 */
/* What the law is told about the bond: it is one of a hexagonal lattice, but for the masses that
   the path gives. rho may be 0. False where there is no lattice of such a spacing. */
bool drive_bond_class(const drive_input *in, double rho, pl_bond_class *out);

/* The law's outputs, of whatever law with the same parameters and fields, in the state of one row.
 */
void drive_observe(const drive_input *in, const pl_law *kernel, const double *parameters,
                   const drive_table *t, long row, double *outputs);

/* --- laws of families (drive_family.c) -------------------------------------------------------- */

/* As drive_run, drive_columns, drive_observe: one particle under the path's strains (small, as tensor components), its
   neighbours always in the same state. Columns: time; strain_xx, ...; strain_rate_xx, ...; stress_xx, ... (by virtual
   work of the bond forces); F_1, ... (force state toward each neighbour, in the order of the lattice); the law's fields
   and outputs (toward neighbours: name_1, ...); energies of the particle: stored, dissipated, external. */
bool drive_family_run(const drive_input *in, const law *l, const pl_law *kernel,
                      const double *parameters, const double *initial, drive_table *out,
                      diagnostics *d);
void drive_family_columns(const drive_input *in, const law *l, const pl_law *kernel,
                          drive_table *out);
void drive_family_observe(const drive_input *in, const law *l, const pl_law *kernel,
                          const double *parameters, const drive_table *t, long row,
                          double *outputs);
/* The lattice of the particle. */
deck_lattice drive_lattice(const drive_input *in, const law *l);

/* --- expectations (drive_expect.c) ------------------------------------------------------------ */

typedef struct drive_verdict {
  bool passed;
  double found, expected, allowed;
  const char *unit;
  double time, way; /* of the row */
  bool extreme;     /* the row was chosen for a largest or smallest value */
  double beside[2]; /* times of the rows before and after it */
} drive_verdict;

/* What every &expect asks for, before anything is driven: names, units and times are checked against `columns` (of
   drive_columns, which must stay), closed forms are compiled as further outputs of `m`, the law as it will be driven.
   NULL, with messages, when one cannot be understood. */
typedef struct drive_expectations drive_expectations;
drive_expectations *drive_expectations_read(const drive_input *in, const model *m,
                                            const drive_table *columns, diagnostics *d);
/* Judges every &expect by the rows of `t`; verdicts[expect_count]. */
void drive_judge(const drive_expectations *x, const double *parameters, const drive_table *t,
                 drive_verdict *verdicts);
void drive_expectations_free(drive_expectations *x);

/* --- checking (command_drive.c) --------------------------------------------------------------- */

/* `perilat check path.nml`: everything of a drive but the driving. `report` as in run_options. Exit status. */
int drive_check(const char *path, const char *const *settings, int count, diag_json *report);

/* --- what is written (drive_write.c) ---------------------------------------------------------- */

/* About in->output.rows rows: both ends, the largest force, the corners of the path, and others evenly between. What is
   wider than the terminal goes on below; of more than a dozen neighbours the columns are left out, and said to be. */
void drive_print(const drive_input *in, const drive_table *t, FILE *out);
bool drive_write_csv(const drive_table *t, const char *path, char *error, size_t size);
/* As a result file of two particles: `perilat plot` and `perilat info` read it. */
bool drive_write_hdf5(const drive_input *in, const drive_table *t, const char *path, char *error,
                      size_t size);

#endif
