/* A result file read back, for plots, tables and comparisons; its layout and names are those of
   result.h. All values are malloc'ed; NULL or false with a sentence in `error` on failure. Damaged
   files, changed ones, and those that lead out of themselves are refused; of a file without a seal
   a warning is printed. */
#ifndef PERILAT_RUNTIME_RESULT_READ_H
#define PERILAT_RUNTIME_RESULT_READ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "dsl/base/c_linkage.h"
#include "dsl/base/name_index.h"

C_LINKAGE_BEGIN

typedef struct result_file result_file;
result_file *result_read(const char *path, char *error, size_t size);
void result_read_close(result_file *f);
/* A sentence when something that is in the file could not be read: then no answer from it counts.
   NULL: all is well. */
const char *result_trouble(const result_file *f);
/* The run was quasi-static: its samples are increments, its time is only an order. */
bool result_is_quasi_static(result_file *f);

typedef struct result_names {
  char **items;
  int count;
  name_index whole, last; /* where a name is; where its last part is, -1 where several have it */
} result_names;
/* Names of what a group holds ("/history", "/bonds"), in alphabetical order. Empty where there is
   no such group. */
result_names result_list(result_file *f, const char *group);
/* Histories ("/history") or fields ("/frames"): data sets of the group and of the groups in it,
   "load", "energy/kinetic", "concrete/omega"; without `time`. */
result_names result_members(result_file *f, const char *group);
void result_names_free(result_names *n);
/* Position of the name given in full or, where that says which, by its last part ("kinetic"); else
   -1. */
int result_names_find(const result_names *n, const char *given);
/* The full name of a history or a field that is given so; a field of bonds that several
   interactions have, of all of them, is named with a star for the interaction. False with a
   sentence that lists what there is. */
bool result_find(result_file *f, const char *group, const char *given, char *name, size_t size,
                 char *error, size_t error_size);

/* Why a series that judges the run does not ("" where it does, or is no such series). */
void result_read_unchecked(result_file *f, const char *name, char *why, size_t size);

/* A name may be given by its last part where that says which. */
double *result_read_series(result_file *f, const char *name, long *count, char *unit,
                           size_t unit_size, char *error,
                           size_t size); /* "time", "load", "energy/kinetic" */
/* Of bonds there is a value for each of result_read_bonds, NaN where an interaction has no such
   field. */
double *result_read_frame(result_file *f, const char *field, long frame, long *count,
                          int *components, char *unit, size_t unit_size, char *error, size_t size);
double *result_read_reference(result_file *f, long *particles,
                              int *dimensions);              /* [N][2] or [N][3] */
double *result_read_volume(result_file *f, long *particles); /* [N] m^3 */
int32_t *result_read_bonds(result_file *f, const char *interaction,
                           long *bonds); /* [M][2]; NULL name: of all, one after the other */
/* Largest of the damages of each bond (of all interactions); NULL when the frame cannot be read or
   holds none (error ""). */
double *result_read_damage(result_file *f, long frame, long *bonds, char *error, size_t size);
double *result_read_frame_times(result_file *f, long *frames);
char *result_read_text(result_file *f, const char *path); /* "/input/deck" */
/* An attribute of the result: "title", "ended"; "" where it has none (malloc'ed). */
char *result_read_words(result_file *f, const char *name);
/* "threads", "wall_seconds"; NaN where it has none. */
double result_read_number(result_file *f, const char *name);
char *result_read_title(result_file *f);

C_LINKAGE_END

#endif
