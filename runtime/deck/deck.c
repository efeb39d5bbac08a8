#include "runtime/deck/deck.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/name_index.h"

static const deck_key *key_of(const deck_item *item, const char *key) {
  for (int i = 0; i < item->key_count; i++)
    if (strcasecmp(item->keys[i].name, key) == 0) return &item->keys[i];
  return NULL;
}

span deck_where(const deck_item *item, const char *key) {
  const deck_key *of = key_of(item, key);
  return of ? of->value_where : item->where;
}

bool deck_is_written(const deck_item *item, const char *key) {
  return key_of(item, key);
}

static const char *const group_names[DECK_GROUP_COUNT] = {
#define X(group) #group,
    DECK_GROUPS(X, X, X)
#undef X
};

int deck_group_find(const char *name) {
  for (int i = 0; i < DECK_GROUP_COUNT; i++)
    if (strcasecmp(group_names[i], name) == 0) return i;
  return -1;
}

int deck_group_names(const char **names) {
  memcpy(names, group_names, sizeof group_names);
  return DECK_GROUP_COUNT;
}

bool deck_lacks(const deck *k, const char *group) {
  assert(!group || deck_group_find(group) >= 0);
  return group ? k->lacks >> deck_group_find(group) & 1 : k->lacks != 0;
}

/* --- names ------------------------------------------------------------------------------------ */

/* Names of the items that were there at the last search. */
struct deck_names {
  struct {
    name_index of;
    int count;
  } kind[DECK_GROUP_COUNT];
};

deck_names *deck_names_new(arena *a) {
  deck_names *n = arena_alloc(a, sizeof *n);
  for (int k = 0; k < DECK_GROUP_COUNT; k++)
    n->kind[k].of.memory = a;
  return n;
}

#define FIND(group, member, counts)                                                                \
  static int look_for_##group(const deck *k, const char *name) {                                   \
    for (int i = 0; i < k->group##_count; i++)                                                     \
      if (k->group##s[i].member && (counts) && strcmp(k->group##s[i].member, name) == 0) return i; \
    return -1;                                                                                     \
  }                                                                                                \
  int deck_find_##group(const deck *k, const char *name) {                                         \
    if (!k->names) return look_for_##group(k, name);                                               \
    name_index *of = &k->names->kind[DECK_GROUP_##group].of;                                       \
    int *known = &k->names->kind[DECK_GROUP_##group].count;                                        \
    for (int i = *known; i < k->group##_count; i++)                                                \
      if (k->group##s[i].member && (counts)) name_index_add(of, k->group##s[i].member, i);         \
    *known = k->group##_count;                                                                     \
    return name_index_find(of, name);                                                              \
  }
FIND(region, name, true)
FIND(lattice, name, true)
FIND(monitor, name, true)
FIND(crack, name, true)
FIND(contact, name, true)
FIND(stamp, name, true)
FIND(material, lattice, !k->materials[i].region && !k->materials[i].between[0])

const deck_material *deck_material_of(const deck *k, int lattice) {
  const int m = deck_find_material(k, k->lattices[lattice].name);
  return m < 0 ? NULL : &k->materials[m];
}

bool deck_misses_body(const deck *k, int lattice) {
  const deck_lattice *l = &k->lattices[lattice];
  const bool needs_none =
      l->kind && (strcmp(l->kind, "particles") == 0 || strcmp(l->kind, "bar") == 0 ||
                  strcmp(l->kind, "link") == 0 || strcmp(l->kind, "mesh") == 0);
  if (deck_lacks(k, "body") || !l->name || needs_none) return false;
  for (int b = 0; b < k->body_count; b++)
    if (k->bodys[b].lattice && strcmp(k->bodys[b].lattice, l->name) == 0) return false;
  return true;
}

char *deck_file_path(const char *deck_path, const char *name) {
  const char *slash = strrchr(deck_path, '/');
  const int folder = slash && name[0] != '/' ? (int)(slash - deck_path) + 1 : 0;
  const size_t size = (size_t)folder + strlen(name) + 1;
  char *path = must_alloc(size);
  snprintf(path, size, "%.*s%s", folder, deck_path, name);
  return path;
}

const char *deck_component_name(int dimensions, int component) {
  static const char *const plane[] = {"x", "y", "rotation"};
  static const char *const space[] = {"x", "y", "z", "rotation_x", "rotation_y", "rotation_z"};
  return (dimensions == 3 ? space : plane)[component];
}
