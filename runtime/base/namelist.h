/* Fortran namelist text: groups of `key = values`, with a span on every group, key and value. Knows
   the notation only; what the groups mean is the deck's business (deck.h). */
#ifndef PERILAT_RUNTIME_NAMELIST_H
#define PERILAT_RUNTIME_NAMELIST_H

#include <stdbool.h>

#include "dsl/base/arena.h"
#include "dsl/base/diagnostics.h"

/* Limits that keep hopeless input quick to refuse; no sensible deck comes near them. */
enum {
  NAMELIST_LARGEST_TEXT = 16 * 1024 * 1024, /* bytes */
  NAMELIST_LONGEST_NAME = 63,               /* as in Fortran */
  NAMELIST_MOST_GROUPS = 10000,
  NAMELIST_MOST_KEYS = 200,       /* in a group */
  NAMELIST_MOST_VALUES = 1000000, /* of all keys, repeat counts included */
  NAMELIST_MOST_ERRORS = 50
};

typedef enum namelist_kind { NAMELIST_NUMBER, NAMELIST_TEXT, NAMELIST_LOGICAL } namelist_kind;

typedef struct namelist_value {
  namelist_kind kind;
  double number;    /* NUMBER: finite */
  const char *text; /* TEXT: without its quotes */
  bool logical;
  span where;
  span text_where; /* TEXT: inside the quotes */
} namelist_value;

typedef struct namelist_key {
  const char *name; /* as written; compare without regard to case */
  span name_where, value_where;
  namelist_value *values;
  int value_count;
  bool broken; /* a value could not be read (reported) */
} namelist_key;

typedef struct namelist_group {
  const char *name; /* in lower case */
  span where;       /* of & and name */
  namelist_key *keys;
  int key_count;
  bool broken; /* something in it could not be read (reported) */
} namelist_group;

typedef struct namelist {
  namelist_group *groups; /* in the order written; the same name may occur several times */
  int group_count;
  bool broken;
} namelist;

/* Reads sources->items[file]. All errors are reported; what could be read is returned, never NULL.
 */
namelist *namelist_read(arena *a, source_set *sources, int file, diagnostics *d);

/* Reads bytes `begin` .. end of sources->items[file] as the values of one key into key->values. */
void namelist_read_values(arena *a, source_set *sources, int file, uint32_t begin,
                          namelist_key *key, diagnostics *d);

/* The key of that name, without regard to case, or NULL. */
namelist_key *namelist_find(const namelist_group *g, const char *name);
/* Adds an empty key. `name` is not copied. */
namelist_key *namelist_add_key(arena *a, namelist_group *g, const char *name);
void namelist_remove_key(namelist_group *g, namelist_key *key);
/* Adds an empty group. `name` is not copied. */
namelist_group *namelist_add_group(arena *a, namelist *n, const char *name);

/* The groups as text: one spelling for one meaning (names in lower case, no comments, numbers to
   the last bit). Groups and keys for which `leave_out` is true are left out (key NULL: the whole
   group). */
char *namelist_text(arena *a, const namelist *n,
                    bool (*leave_out)(const char *group, const char *key));

/* Length of the number at the start of `text` (Fortran: 1, -.5, 1.5d-3), 0 when there is none.
 *value may be infinite when the number is too large. */
size_t namelist_number(const char *text, size_t length, double *value);

#endif
