#include "runtime/deck/deck_check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/deck/deck_value.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/deck/output_fields.h"

/* --- names ------------------------------------------------------------------------------------ */

static void report_unknown(deck_reader *r, span where, const char *kind, const char *name,
                           const char **names, int count) {
  char intro[32];
  diag_report(r->d, DIAG_UNKNOWN_NAME, where, "there is no %s `%s`", kind,
              deck_shown(r->memory, name));
  snprintf(intro, sizeof(intro), "the deck's %ss are", kind);
  deck_suggest(r->d, name, names, count, intro);
}

/* A name must be that of a group of this kind; else the kind's names are shown. */
#define KNOWN(word, group, counts)                                                                 \
  static bool word##_is_known(deck_reader *r, span where, const char *name) {                      \
    const deck *k = r->k;                                                                          \
    int found = deck_find_##group(k, name), count = 0;                                             \
    if (found >= 0 && !(counts)) found = -1;                                                       \
    if (found >= 0 || !r->names_known) return found >= 0;                                          \
    const char **names = must_calloc((size_t)k->group##_count + 1, sizeof *names);                 \
    for (found = 0; found < k->group##_count; found++)                                             \
      if (counts) names[count++] = k->group##s[found].name;                                        \
    report_unknown(r, where, #word, name, names, count);                                           \
    free(names);                                                                                   \
    return false;                                                                                  \
  }
KNOWN(lattice, lattice, true)
KNOWN(bar, lattice, deck_lattice_is_bar(&k->lattices[found]))
KNOWN(link, lattice, deck_lattice_is_link(&k->lattices[found]))
KNOWN(mesh, lattice, deck_lattice_is_mesh(&k->lattices[found]))
KNOWN(region, region, true)
KNOWN(monitor, monitor, true)
KNOWN(stamp, stamp, true)

bool deck_lattice_known(deck_reader *r, const deck_item *item, const char *name) {
  return lattice_is_known(r, deck_where(item, "lattice"), name);
}

bool deck_lattice_known_at(deck_reader *r, span where, const char *name) {
  return lattice_is_known(r, where, name);
}

bool deck_bar_known(deck_reader *r, const deck_item *item, const char *name) {
  return bar_is_known(r, deck_where(item, "bar"), name);
}

bool deck_link_known(deck_reader *r, const deck_item *item, const char *name) {
  return link_is_known(r, deck_where(item, "link"), name);
}

bool deck_mesh_known(deck_reader *r, const deck_item *item, const char *name) {
  return mesh_is_known(r, deck_where(item, "mesh"), name);
}

void deck_refuse_of_file(deck_reader *r, const deck_item *item, const char *mesh,
                         const char *what) {
  const int lattice = mesh ? deck_find_lattice(r->k, mesh) : -1;
  if (lattice < 0 || !r->k->lattices[lattice].gmsh) return;
  diag_report(r->d, DIAG_CONFLICT, deck_where(item, "mesh"),
              "`%s` is the mesh of a file, in which there are no %s", deck_shown(r->memory, mesh),
              what);
  diag_hint(r->d, "what the body has is drawn in Gmsh; zones, holes and cracks are those of a "
                  "rectangle (`corner`, `size`)");
}

bool deck_region_known(deck_reader *r, span where, const char *name) {
  return region_is_known(r, where, name);
}

bool deck_monitor_known(deck_reader *r, span where, const char *name) {
  return monitor_is_known(r, where, name);
}

bool deck_stamp_known(deck_reader *r, const deck_item *item, const char *name) {
  return stamp_is_known(r, deck_where(item, "stamp"), name);
}

bool deck_item_region_known(deck_reader *r, const deck_item *item, const char *name) {
  return deck_region_known(r, deck_where(item, "region"), name);
}

bool deck_moves(deck_reader *r, span where, int lattice) {
  if (lattice < 0 || !deck_lattice_is_link(&r->k->lattices[lattice])) return true;
  const deck_link *link = &r->k->lattices[lattice];
  diag_report(
      r->d, DIAG_CONFLICT, where,
      "the particles of the link `%s` are copies of those that it joins, and move with them",
      deck_shown(r->memory, link->name));
  diag_hint(r->d, "take the bar `%s` or the lattice `%s`", deck_shown(r->memory, link->bar),
            deck_shown(r->memory, link->around));
  return false;
}

bool deck_moving_region_known(deck_reader *r, const deck_item *item, const char *name) {
  return deck_item_region_known(r, item, name) &&
         deck_moves(r, deck_where(item, "region"), deck_lattice_of_region(r, name));
}

void deck_check_name(deck_reader *r, const char *kind, const char *name, const deck_item *item,
                     const deck_item *first) {
  if (name && strlen(name) > NAMELIST_LONGEST_NAME)
    diag_report(r->d, DIAG_TOO_LONG, deck_where(item, "name"),
                "this name has %zu bytes; a name may have up to %d", strlen(name),
                NAMELIST_LONGEST_NAME);
  if (!first) return;
  diag_report(r->d, DIAG_DUPLICATE_NAME, deck_where(item, "name"), "a %s `%s` exists already", kind,
              deck_shown(r->memory, name));
  diag_note(r->d, deck_where(first, "name"), "it is named here");
}

void deck_check_not_both(deck_reader *r, const char *kind, const deck_item *item,
                         const char *its_kind, const char *name, const deck_item *other) {
  if (!other) return;
  diag_report(r->d, DIAG_DUPLICATE_NAME, deck_where(item, "name"),
              "a %s and a %s cannot both be called `%s`: results have them side by side", kind,
              its_kind, deck_shown(r->memory, name));
  diag_note(r->d, deck_where(other, "name"), "the %s is named here", its_kind);
}

bool deck_same_name(const char *a, const char *b) {
  return a && b && strcmp(a, b) == 0;
}

bool deck_is_one_of(const char *name, const char *const *words, int count) {
  for (int i = 0; i < count; i++)
    if (strcmp(words[i], name) == 0) return true;
  return false;
}

void deck_check_lattice_name(deck_reader *r, const deck_lattice *item) {
#define X(name, unit, components, exists, kind, words) #name,
  static const char *const taken[] = {"time", ".", OUTPUT_FIELDS(X)};
#undef X
  const char *word = deck_lattice_word(item);
  const span where = deck_where(&item->item, "name");
  if (deck_is_one_of(item->name, taken, (int)(sizeof taken / sizeof *taken)) ||
      output_is_component(item->name, 3))
    diag_report(r->d, DIAG_RESERVED_NAME, where,
                "a %s cannot be called `%s`: the result has a field of that name", word,
                item->name);
  else if (strchr(item->name, '/'))
    diag_report(r->d, DIAG_BAD_VALUE, where, "a %s's name must not hold `/`", word);
  const int first = deck_find_lattice(r->k, item->name);
  const deck_lattice *other = first < 0 ? NULL : &r->k->lattices[first];
  deck_check_name(r, other ? deck_lattice_word(other) : word, item->name, &item->item,
                  other ? &other->item : NULL);
}

void deck_refuse_both(deck_reader *r, const namelist_group *from, const char *a, const char *b) {
  const namelist_key *first = namelist_find(from, a), *second = namelist_find(from, b);
  if (!first || !second) return;
  diag_report(r->d, DIAG_CONFLICT, second->name_where, "`%s` and `%s` exclude each other", a, b);
  diag_note(r->d, first->name_where, "`%s` is given here", a);
}

static void check_place(deck_reader *r, const namelist_key *key, const char *name, int dimensions) {
  if (!key || key->value_count == dimensions) return;
  diag_report(r->d, DIAG_BAD_VALUE, key->value_where,
              "`%s` takes %d values in %s, but %d are given", name, dimensions,
              dimensions == 2 ? "the plane" : "space", key->value_count);
}

void deck_check_places(deck_reader *r, const namelist_group *from, const deck_group_info *info,
                       int dimensions) {
  for (int k = 0; k < info->key_count; k++)
    if (info->keys[k].type == DECK_PLACE)
      check_place(r, namelist_find(from, info->keys[k].name), info->keys[k].name, dimensions);
}

/* Of that name, or the only one. */
static int lattice_named(const deck_reader *r, const char *lattice) {
  return lattice ? deck_find_lattice(r->k, lattice) : r->k->lattice_count == 1 ? 0 : -1;
}

int deck_dimensions_of(const deck_reader *r, const char *lattice) {
  const int l = lattice_named(r, lattice);
  return l < 0 || !r->k->lattices[l].kind ? 0 : deck_lattice_dimensions(&r->k->lattices[l]);
}

int deck_lattice_of_region(const deck_reader *r, const char *name) {
  const int k = name ? deck_find_region(r->k, name) : -1;
  return k < 0 ? -1 : lattice_named(r, r->k->regions[k].lattice);
}

/* --- directions ------------------------------------------------------------------------------- */

int deck_dimensions_of_region(const deck_reader *r, const char *name) {
  const int k = name ? deck_find_region(r->k, name) : -1;
  return k < 0 ? 0 : deck_dimensions_of(r, r->k->regions[k].lattice);
}

static int report_component(deck_reader *r, span where, const char *what, const char *mend) {
  diag_report(r->d, DIAG_BAD_VALUE, where, "%s", what);
  if (mend) diag_hint(r->d, "%s", mend);
  return -1;
}

int deck_component_in(deck_reader *r, span where, int dimensions, int written) {
  if (written < DECK_WRITTEN_Z) return written;
  if (dimensions == 2 && written == DECK_WRITTEN_Z)
    return report_component(r, where, "there is no direction z in the plane", NULL);
  if (dimensions == 2 && written > DECK_WRITTEN_ROTATION)
    return report_component(r, where, "in the plane particles rotate about one axis",
                            "write `rotation`");
  if (dimensions == 3 && written == DECK_WRITTEN_ROTATION)
    return report_component(r, where, "in space particles rotate about three axes",
                            "write `rotation_x`, `rotation_y` or `rotation_z`");
  return written > DECK_WRITTEN_ROTATION ? written - 1 : 2;
}

int deck_component(deck_reader *r, span where, const char *region, int written) {
  return deck_component_in(r, where, deck_dimensions_of_region(r, region), written);
}

int deck_components(deck_reader *r, span where, const char *region, int written) {
  const bool space = deck_dimensions_of_region(r, region) == 3;
  int components = 0;
  for (int k = 0; k < DECK_WRITTEN_COUNT; k++) {
    if (!(written & 1 << k)) continue;
    const bool all = space && k == DECK_WRITTEN_ROTATION;
    const int component = all ? 3 : deck_component(r, where, region, k);
    if (component >= 0) components |= (all ? 1 | 2 | 4 : 1) << component;
  }
  return components;
}

bool deck_take_component(deck_reader *r, const deck_item *item, const char *region,
                         int *component) {
  const int found = deck_component(r, deck_where(item, "component"), region, *component);
  if (found >= 0) *component = found;
  return found >= 0;
}

bool deck_is_rotation(const deck_reader *r, const char *region, int component) {
  return component >= (deck_dimensions_of_region(r, region) == 3 ? 3 : 2);
}

const char *deck_component_of(const deck_reader *r, const char *region, int component) {
  return deck_component_name(deck_dimensions_of_region(r, region), component);
}

void deck_warn_late(deck_reader *r, const deck_item *item, const char *key, double time) {
  double end = r->k->simulation.end_time;
  if (end <= 0 || time < end) return; /* 0: the end is not known */
  diag_report(r->d, DIAG_DECK_WARNING, deck_where(item, key),
              "`%s` is not before the end of the run", key);
}
