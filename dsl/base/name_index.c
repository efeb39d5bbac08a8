#include "dsl/base/name_index.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/hash.h"

enum { FIRST_ROOM = 16 };

/* Where the name is, or would be. */
static named_number *place_of(const name_index *x, const char *name) {
  size_t k = (size_t)hash_more(HASH_START, name, strlen(name)) & (x->room - 1);
  while (x->places[k].name && strcmp(x->places[k].name, name) != 0)
    k = (k + 1) & (x->room - 1);
  return &x->places[k];
}

int *name_index_at(const name_index *x, const char *name) {
  named_number *found = x->room ? place_of(x, name) : NULL;
  return found && found->name ? &found->number : NULL;
}

int name_index_find(const name_index *x, const char *name) {
  const int *number = name_index_at(x, name);
  return number ? *number : -1;
}

static void grow(name_index *x) {
  name_index larger = *x;
  larger.room = x->room ? 2 * x->room : FIRST_ROOM;
  larger.places = x->memory ? arena_alloc(x->memory, larger.room * sizeof *larger.places)
                            : must_calloc(larger.room, sizeof *larger.places);
  for (size_t k = 0; k < x->room; k++)
    if (x->places[k].name) *place_of(&larger, x->places[k].name) = x->places[k];
  if (!x->memory) free(x->places);
  *x = larger;
}

int *name_index_add(name_index *x, const char *name, int number) {
  if (2 * (x->count + 1) > x->room) grow(x);
  named_number *place = place_of(x, name);
  if (!place->name) {
    *place = (named_number){name, number};
    x->count++;
  }
  return &place->number;
}

void name_index_clear(name_index *x) {
  if (!x->memory) free(x->places);
  *x = (name_index){.memory = x->memory};
}
