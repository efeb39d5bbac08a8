/* How the table of one law differs from that of another on the same path. The room: a law beside a
   reference law: where their answers part, in numbers, in words and in a picture. */
#ifndef PERILAT_GENERATOR_TABLE_DIFFERENCE_H
#define PERILAT_GENERATOR_TABLE_DIFFERENCE_H

#include <stdbool.h>

#include "generator/drive/drive_table.h"

/* What kind of a difference it is, the first of these that holds: X(code, name) */
#define DIFFERENCE_KINDS(X)                                                                        \
  X(NONE, "equal")                                                                                 \
  X(NO_NUMBER, "no number")                                                                        \
  X(RATIO, "ratio")                                                                                \
  X(SIGN, "sign")                                                                                  \
  X(LATE, "one step late")                                                                         \
  X(EARLY, "one step early")                                                                       \
  X(TOTAL, "total")                                                                                \
  X(SIDE, "side")                                                                                  \
  X(STATE, "state")

typedef enum difference_kind {
#define X(code, name) DIFFERENCE_##code,
  DIFFERENCE_KINDS(X)
#undef X
} difference_kind;

/* On which side of the path all states are that differ: X(code, name, words) */
#define DIFFERENCE_SIDES(X)                                                                        \
  X(SHORTENED, "shortened", "where it is shortened")                                               \
  X(CLOSED, "shortened after damage", "where it is shortened after it lost energy")                \
  X(STRETCHED, "stretched", "where it is stretched")                                               \
  X(OPENED, "stretched after damage", "where it is stretched after it lost energy")                \
  X(UNLOADING, "unloading", "while it is unloaded")                                                \
  X(RELOADING, "reloading", "while it is loaded again")                                            \
  X(UNLOADED, "below the largest", "below the largest that it has borne")                          \
  X(BEYOND, "beyond the largest", "while it goes farther than ever before")                        \
  X(DAMAGED, "after damage", "after it lost energy")                                               \
  X(SOUND, "before damage", "before it lost energy")

typedef enum difference_side {
#define X(code, name, words) SIDE_##code,
  DIFFERENCE_SIDES(X)
#undef X
      SIDE_COUNT
} difference_side;

/* What a whole path comes to: X(code, name, words) */
#define DIFFERENCE_TOTALS(X)                                                                       \
  X(PEAK, "peak", "the largest force")                                                             \
  X(DISSIPATED, "dissipated", "the energy that it dissipates")                                     \
  X(WORK, "work", "the work that it takes")

typedef enum difference_total {
#define X(code, name, words) TOTAL_##code,
  DIFFERENCE_TOTALS(X)
#undef X
      TOTAL_COUNT
} difference_total;

/* A column that both tables have, and that answers what was prescribed. */
typedef struct column_difference {
  const char *name, *unit;
  const double *answer, *reference;
  bool energy;
  bool minor;     /* far below the largest of its kind: nothing is read from how it differs */
  double scale;   /* what its differences are measured by */
  double worst;   /* largest difference, in parts of the scale */
  long differing; /* rows that differ by more than the tolerance */
  long first;     /* the first of these, or -1 */
} column_difference;

typedef struct table_difference {
  difference_kind kind;
  double tolerance;
  long rows, skipped; /* compared, and left out of them */
  column_difference *columns;
  int column_count;
  int of;       /* the column that is spoken of: the first that differs */
  double ratio; /* RATIO: answer over reference; SIDE: there, or NaN */
  difference_side side;
  double totals[TOTAL_COUNT]; /* answer over reference; NaN: there is none */
  difference_total total;     /* TOTAL: whose ratio is told */
  int larger;                 /* 1: larger in all states that differ, -1: smaller; 0: neither */
  /* [answer, reference] the largest driven force that is borne before energy is lost; NaN: none is
     lost. Both NaN where they are alike */
  double begins[2];
  const char *begins_of, *begins_unit; /* the column, and its unit */
  long row;                            /* the first that differs, or that has no number; -1: none */
  const char *bad;                     /* NO_NUMBER: the column */
} table_difference;

/* Rows that say nothing, because a case of the law begins there: what is answered, or the energies
   summed up since, may be on either side of a jump. */
enum { SKIP_ANSWER = 1, SKIP_ENERGY = 2 };

/* What a column of a table is. */
typedef enum column_role {
  COLUMN_ASIDE, /* prescribed, the law's own, or follows from others */
  COLUMN_ANSWER,
  COLUMN_ENERGY
} column_role;
column_role column_role_of(const drive_table *t, int column);
/* What differences of each column are measured by [column_count]: the largest value of all columns
   of its kind (forces, moments, stresses, strains, energies). */
void column_scales(const drive_table *t, double *scales);

/* The columns of what is driven and of what answers it: `way` and `force`, but where that way is at
   rest all the time the strain or turn that is not, and the stress that goes with it. */
void driven_columns(const drive_table *t, int *way, int *force);

/* Compares `answer` with `reference`, tables of one path with the same rows: each column
   on its scale, by a relative `tolerance`. Rows that `skip` [rows] marks (NULL:
   none) do not count. `energies`: they count, too. To be freed; the tables must outlive it. */
void table_difference_find(table_difference *out, const drive_table *answer,
                           const drive_table *reference, double tolerance,
                           const unsigned char *skip, bool energies);
void table_difference_free(table_difference *d);

/* A ratio that has a meaning of its own, within 2e-3: "twice", "half", ...; NULL: none. */
const char *ratio_words(double ratio);
/* Any other ratio of small whole numbers, roots of 2 and 3, pi and its root, within 5e-6: "3/4",
   "2/(3 sqrt(3))", "pi/4"; false: it is none, or has one digit behind the point. */
bool ratio_formula(double ratio, char *text, size_t size);
/* Does ratio_words or ratio_formula tell it? */
bool ratio_is_known(double ratio);
/* With a root, pi or a logarithm? */
bool ratio_is_closed(double ratio);
/* So near to 1 that somebody has rounded a number. */
bool ratio_is_rounding(double ratio);

#endif
