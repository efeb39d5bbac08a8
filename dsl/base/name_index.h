/* Finds the number that belongs to a name at once, however many names there are: a hash table over
   names that stay where they are. All zero it is empty. */
#ifndef PERILAT_DSL_NAME_INDEX_H
#define PERILAT_DSL_NAME_INDEX_H

#include <stddef.h>

#include "dsl/base/arena.h"
#include "dsl/base/c_linkage.h"

C_LINKAGE_BEGIN

typedef struct named_number {
  const char *name; /* not owned; NULL: a free place */
  int number;
} named_number;

typedef struct name_index {
  named_number *places; /* open addressing, a power of two and at least twice the names */
  size_t room, count;
  arena *memory; /* where the places are; NULL: freed by name_index_clear */
} name_index;

/* The number of a name, which may be changed; NULL without such a name. */
int *name_index_at(const name_index *x, const char *name);
/* The same, -1 without such a name. */
int name_index_find(const name_index *x, const char *name);
/* Gives a name that is new its number; the number of one that is there already stays. Returns the
 * number's place. */
int *name_index_add(name_index *x, const char *name, int number);
void name_index_clear(name_index *x);

C_LINKAGE_END

#endif
