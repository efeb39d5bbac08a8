/* A table of answers: lines `name = value`, with a unit or without; from `!` on a comment. */
#ifndef PERILAT_GENERATOR_ANSWER_TABLE_H
#define PERILAT_GENERATOR_ANSWER_TABLE_H

#include <stdbool.h>

#include "dsl/base/arena.h"
#include "dsl/base/units.h"

typedef struct answer_entry {
  const char *name;
  const char *text; /* as written: "1.2 us"; "", "?", "? us": not filled in */
  bool filled, is_number;
  double value;  /* SI */
  bool has_unit; /* a plain number fits any */
  dimension dim;
} answer_entry;

typedef struct answer_table {
  answer_entry *entries;
  int count;
  int lines_unread; /* that are none of the above */
} answer_table;

/* At most 1000 entries. False, with a sentence in *bad, where the file can not be read. */
bool answer_table_read(answer_table *t, arena *a, const char *path, const char **bad);
/* Without regard to case; NULL: none. */
const answer_entry *answer_find(const answer_table *t, const char *name);
/* Do two answers agree, numbers within a relative tolerance? */
bool answers_agree(const answer_entry *x, const answer_entry *right, double tolerance);

#endif
