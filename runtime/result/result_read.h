/* Histories, places and texts of a result, for plots, tables and comparisons. All values are
   malloc'ed; NULL with a sentence in `error` on failure. */
#ifndef PERILAT_RUNTIME_RESULT_READ_H
#define PERILAT_RUNTIME_RESULT_READ_H

#include <stdbool.h>

#include "runtime/result/result_file.h"

C_LINKAGE_BEGIN

/* A name may be given by its last part where that says which: "time", "load", "energy/kinetic". */
double *result_read_series(result_file *f, const char *name, long *count, char *unit,
                           size_t unit_size, char *error, size_t size);
/* Why a series that judges the run does not ("" where it does, or is no such series). */
void result_read_unchecked(result_file *f, const char *name, char *why, size_t size);

double *result_read_reference(result_file *f, long *particles,
                              int *dimensions);              /* [N][2] or [N][3] */
double *result_read_volume(result_file *f, long *particles); /* [N] m^3 */
/* [N] m; NULL where no particles are graded. */
double *result_read_spacing(result_file *f, long *particles);
double *result_read_frame_times(result_file *f, long *frames);
/* Cracks across the line of a monitor: [frames][most][2] place and width, m, NaN beyond the last.
   */
double *result_read_cracks(result_file *f, const char *monitor, long *frames, long *most,
                           char *error, size_t size);
/* Whether the result has a crack of a mesh of that name; and its points, from the first to the
   last: [frames][most][2] m, NaN beyond the last. */
bool result_has_path(result_file *f, const char *crack);
double *result_read_path(result_file *f, const char *crack, long *frames, long *most, char *error,
                         size_t size);
/* Numbers, or integers (int32_t), in as many columns as there may be; how many there are goes into
   *columns. NULL where there is no such table, or it is damaged. */
void *result_read_table(result_file *f, const char *path, bool integers, int least, int most,
                        long *rows_read, int *columns);

char *result_read_text(result_file *f, const char *path); /* "/input/deck" */
/* An attribute of the result: "title", "ended"; "" where it has none (malloc'ed). */
char *result_read_words(result_file *f, const char *name);
/* "threads", "wall_seconds"; NaN where it has none. */
double result_read_number(result_file *f, const char *name);
char *result_read_title(result_file *f);

C_LINKAGE_END

#endif
