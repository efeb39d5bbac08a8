/* The table of a drive: a column for each quantity, state, output and energy, a row for each
   time. */
#ifndef PERILAT_GENERATOR_DRIVE_TABLE_H
#define PERILAT_GENERATOR_DRIVE_TABLE_H

#include <stdbool.h>

#include "dsl/base/arena.h"

/* The columns before and after those of the law: X(code, name, unit) */
#define DRIVE_FIRST_COLUMNS(X)                                                                     \
  X(TIME, "time", "s")                                                                             \
  X(STRETCH, "stretch", "1")                                                                       \
  X(STRETCH_RATE, "stretch_rate", "1/s")                                                           \
  X(THETA_I, "theta_i", "1")                                                                       \
  X(THETA_J, "theta_j", "1")                                                                       \
  X(TWIST, "twist", "1")                                                                           \
  X(N, "N", "N") X(M_I, "M_i", "N*m") X(M_J, "M_j", "N*m") X(T, "T", "N*m")
/* Energies in J, of points in J/m^3. `dissipated` is the sum of its two parts; `external` counts
   from what the first row holds; `imbalance` is external less stored less dissipated. */
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

typedef enum drive_kind { DRIVE_OF_BONDS, DRIVE_OF_FAMILIES, DRIVE_OF_POINTS } drive_kind;

typedef struct drive_table {
  drive_kind of;
  /* Columns of what is prescribed and what answers: stretch and N, first strain and stress. */
  int way, force;
  int law_column; /* those of the law's fields, then its outputs, begin here */
  drive_column *columns;
  int column_count;
  long rows;
  int fields;    /* columns of the law's fields */
  long bad_row;  /* first row in which a value is not finite, or -1; rows then end with it */
  arena *memory; /* owns all */
} drive_table;

void drive_table_free(drive_table *t);
/* A law's own name that is a column already stands with `law_` before it. */
void drive_add_column(drive_table *t, const char *name, const char *unit_text, long rows);
int drive_column_find(const drive_table *t, const char *name); /* or -1 */

#endif
