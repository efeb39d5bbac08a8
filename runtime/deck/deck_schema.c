#include "runtime/deck/deck_schema.h"

#include <assert.h>
#include <string.h>
#include <strings.h>

int deck_key_find(const deck_group_info *g, const char *name) {
  for (int i = 0; i < g->key_count; i++)
    if (strcasecmp(g->keys[i].name, name) == 0 ||
        (g->keys[i].former && strcasecmp(g->keys[i].former, name) == 0))
      return i;
  return -1;
}

int deck_key_names(const deck_group_info *g, const char **names) {
  for (int i = 0; i < g->key_count; i++)
    names[i] = g->keys[i].name;
  return g->key_count;
}

int deck_choices(arena *a, const char *choices, const char **words, int most) {
  int count = 0;
  while (*choices && count < most) {
    size_t length = strcspn(choices, "|");
    words[count++] = arena_text(a, choices, length);
    choices += length + (choices[length] == '|');
  }
  assert(*choices == 0); /* `most` is enough */
  return count;
}
