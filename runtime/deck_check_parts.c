#include "runtime/deck_check_parts.h"

#include <stdio.h>
#include <string.h>

#include "runtime/deck_value.h"

/* --- names ------------------------------------------------------------------------------------ */

/* Names of one kind of group, for suggestions. */
#define NAMES_OF(group)                                                                            \
  static const char **group##_names(const deck_reader *r) {                                        \
    const deck *k = r->k;                                                                          \
    const char **names = arena_alloc(r->memory, ((size_t)k->group##_count + 1) * sizeof(*names));  \
    for (int i = 0; i < k->group##_count; i++)                                                     \
      names[i] = k->group##s[i].name;                                                              \
    return names;                                                                                  \
  }
NAMES_OF(lattice)
NAMES_OF(region)
NAMES_OF(monitor)

static bool known(deck_reader *r, bool found, span where, const char *kind, const char *name,
                  const char **names, int count) {
  if (found || !r->names_known) return found;
  diag_report(r->d, DIAG_UNKNOWN_NAME, where, "there is no %s `%s`", kind,
              deck_shown(r->memory, name));
  char intro[32];
  snprintf(intro, sizeof(intro), "the deck's %ss are", kind);
  deck_suggest(r->d, name, names, count, intro);
  return false;
}

bool deck_lattice_known(deck_reader *r, const deck_item *item, const char *name) {
  return known(r, deck_find_lattice(r->k, name) >= 0, deck_where(item, "lattice"), "lattice", name,
               lattice_names(r), r->k->lattice_count);
}

bool deck_region_known(deck_reader *r, span where, const char *name) {
  return known(r, deck_find_region(r->k, name) >= 0, where, "region", name, region_names(r),
               r->k->region_count);
}

bool deck_monitor_known(deck_reader *r, span where, const char *name) {
  return known(r, deck_find_monitor(r->k, name) >= 0, where, "monitor", name, monitor_names(r),
               r->k->monitor_count);
}

bool deck_item_region_known(deck_reader *r, const deck_item *item, const char *name) {
  return deck_region_known(r, deck_where(item, "region"), name);
}

void deck_name_is_new(deck_reader *r, const char *kind, const char *name, const deck_item *item,
                      const deck_item *first) {
  if (!first) return;
  diag_report(r->d, DIAG_DUPLICATE_NAME, deck_where(item, "name"), "a %s `%s` exists already", kind,
              deck_shown(r->memory, name));
  diag_note(r->d, deck_where(first, "name"), "it is named here");
}

bool deck_same_name(const char *a, const char *b) {
  return a && b && strcmp(a, b) == 0;
}

bool deck_is_one_of(const char *name, const char *const *words, int count) {
  for (int i = 0; i < count; i++)
    if (strcmp(words[i], name) == 0) return true;
  return false;
}

void deck_refuse_both(deck_reader *r, const namelist_group *from, const char *a, const char *b) {
  const namelist_key *first = namelist_find(from, a), *second = namelist_find(from, b);
  if (!first || !second) return;
  diag_report(r->d, DIAG_CONFLICT, second->name_where, "`%s` and `%s` exclude each other", a, b);
  diag_note(r->d, first->name_where, "`%s` is given here", a);
}

void deck_check_place(deck_reader *r, const namelist_group *from, const char *name,
                      int dimensions) {
  const namelist_key *key = namelist_find(from, name);
  if (!key || key->value_count == dimensions) return;
  diag_report(r->d, DIAG_BAD_VALUE, key->value_where,
              "`%s` takes %d values in %s, but %d are given", name, dimensions,
              dimensions == 2 ? "the plane" : "space", key->value_count);
}

int deck_dimensions_of(const deck_reader *r, const char *lattice) {
  const int l = lattice ? deck_find_lattice(r->k, lattice) : r->k->lattice_count == 1 ? 0 : -1;
  return l < 0 || !r->k->lattices[l].kind ? 0 : deck_lattice_dimensions(&r->k->lattices[l]);
}
