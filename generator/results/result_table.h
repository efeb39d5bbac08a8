/* Results as commands read them: opened with a message for what is no result, a history or a
   frame's field with all that says what it is. */
#ifndef PERILAT_GENERATOR_RESULT_TABLE_H
#define PERILAT_GENERATOR_RESULT_TABLE_H

#include <stdbool.h>

#include "runtime/result/result_file.h"

/* NULL after a message. `command` as the person typed it, "perilat export". */
result_file *table_open(const char *command, const char *path);
/* What is `good` so far is so no longer, after a message, when something in the result could not be
   read. */
bool table_close(result_file *f, bool good);

/* A history, or a field of one frame. */
typedef struct table_values {
  const char *name;
  char unit[64];
  double *values;      /* [count][components]; owned */
  long count;          /* samples, particles or bonds */
  int components;      /* of a frame's field; 1 in a history */
  char unchecked[256]; /* why a history that judges the run says nothing, or "" */
} table_values;
/* False with a sentence in error. frame < 0: the history of that name. */
bool table_read(result_file *f, const char *name, long frame, table_values *out, char *error,
                size_t size);

/* Fields of bonds are named `interaction/field`. */
bool table_on_bonds(const char *field);
/* "_x", "_y", ... of a vector's component; "" of a scalar. */
const char *table_component(int components, int c);

#endif
