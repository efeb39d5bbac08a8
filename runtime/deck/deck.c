#include "runtime/deck/deck.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/name_index.h"
#include "runtime/deck/bravais.h"
#include "runtime/deck/deck_check.h"
#include "runtime/deck/deck_set.h"
#include "runtime/deck/deck_value.h"
#include "runtime/deck/namelist.h"
#include "runtime/deck/text_table.h"

enum { MOST_ERRORS = 100 };

span deck_where(const deck_item *item, const char *key) {
  for (int i = 0; i < item->key_count; i++)
    if (strcasecmp(item->keys[i].name, key) == 0) return item->keys[i].value_where;
  return item->where;
}

/* Names of the items that were there at the last search. */
struct deck_names {
  struct {
    name_index of;
    int count;
  } kind[DECK_GROUP_COUNT];
};

static deck_names *new_names(arena *a) {
  deck_names *n = arena_alloc(a, sizeof *n);
  for (int k = 0; k < DECK_GROUP_COUNT; k++)
    n->kind[k].of.memory = a;
  return n;
}

#define FIND(group, member)                                                                        \
  static int look_for_##group(const deck *k, const char *name) {                                   \
    for (int i = 0; i < k->group##_count; i++)                                                     \
      if (k->group##s[i].member && strcmp(k->group##s[i].member, name) == 0) return i;             \
    return -1;                                                                                     \
  }                                                                                                \
  int deck_find_##group(const deck *k, const char *name) {                                         \
    if (!k->names) return look_for_##group(k, name);                                               \
    name_index *of = &k->names->kind[DECK_GROUP_##group].of;                                       \
    for (int *i = &k->names->kind[DECK_GROUP_##group].count; *i < k->group##_count; ++*i)          \
      if (k->group##s[*i].member) name_index_add(of, k->group##s[*i].member, *i);                  \
    return name_index_find(of, name);                                                              \
  }
FIND(region, name)
FIND(lattice, name)
FIND(monitor, name)
FIND(material, lattice)

bool deck_lattice_is_irregular(const deck_lattice *l) {
  return strcmp(l->kind, "blue_noise") == 0 || strcmp(l->kind, "particles") == 0;
}

int deck_lattice_dimensions(const deck_lattice *l) {
  if (!deck_lattice_is_irregular(l)) return bravais_dimensions(l->kind);
  return l->setting && strcmp(l->setting, "space") == 0 ? 3 : 2;
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
  static const char *const names[] = {"x", "y", "rotation", "z"};
  return names[dimensions == 3 && component == 2 ? 3 : component];
}

/* --- one group -------------------------------------------------------------------------------- */

static void copy_places(arena *a, const namelist_group *from, deck_item *item) {
  deck_key *keys = arena_alloc(a, (size_t)from->key_count * sizeof(*keys));
  for (int i = 0; i < from->key_count; i++) {
    const namelist_key *key = &from->keys[i];
    keys[i] = (deck_key){key->name, key->name_where, key->value_where};
  }
  item->where = from->where;
  item->keys = keys;
  item->key_count = from->key_count;
}

static void report_unknown(deck_reader *r, const deck_group_info *info, const namelist_key *key) {
  static const char *const synonyms[][2] = {
      {"dt", "step"}, {"time_step", "step"}, {"position", "at"}, {"center", "centre"}};
  diag_report(r->d, DIAG_UNKNOWN_KEY, key->name_where, "`&%s` has no key `%s`", info->name,
              key->name);
  for (int i = 0; i < 4; i++)
    if (strcasecmp(key->name, synonyms[i][0]) == 0 && deck_key_find(info, synonyms[i][1]) >= 0) {
      diag_hint(r->d, "did you mean `%s`?", synonyms[i][1]);
      return;
    }
  const char *names[DECK_MOST_KEYS];
  deck_suggest(r->d, key->name, names, deck_key_names(info, names), "its keys are");
}

static bool is_repeated(deck_reader *r, const namelist_group *from, const namelist_key *key) {
  const namelist_key *first = namelist_find(from, key->name);
  if (first == key) return false;
  diag_report(r->d, DIAG_DUPLICATE_KEY, key->name_where, "`%s` is given twice in this `&%s`",
              key->name, from->name);
  diag_note(r->d, first->name_where, "it is given here");
  if (strcmp(first->name, key->name) != 0)
    diag_hint(r->d, "upper and lower case are the same here");
  return true;
}

/* A required key that was only misspelt is not missing as well. */
static bool is_misspelt(const namelist_group *from, const deck_group_info *info, const char *name) {
  if (info->open) return false;
  for (int i = 0; i < from->key_count; i++)
    if (deck_key_find(info, from->keys[i].name) < 0 && nearest_name(from->keys[i].name, &name, 1))
      return true;
  return false;
}

static void read_keys(deck_reader *r, const namelist_group *from, const deck_group_info *info,
                      void *item) {
  for (int i = 0; i < from->key_count; i++) {
    const namelist_key *key = &from->keys[i];
    if (is_repeated(r, from, key)) continue;
    int k = deck_key_find(info, key->name);
    if (k >= 0 && !key->broken)
      deck_field_read(r->memory, &info->keys[k], key, item, r->d);
    else if (k < 0 && !info->open)
      report_unknown(r, info, key);
  }
  if (from->broken) return; /* what seems missing may stand in the part that could not be read */
  for (int k = 0; k < info->key_count; k++) {
    const deck_key_info *key = &info->keys[k];
    if (!key->required || namelist_find(from, key->name) || is_misspelt(from, info, key->name))
      continue;
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&%s` has no `%s`", info->name, key->name);
    bool has_unit = key->unit && strcmp(key->unit, "1") != 0;
    diag_hint(r->d, "%s: %s%s%s%s", key->name, key->doc, has_unit ? " (" : "",
              has_unit ? key->unit : "", has_unit ? ")" : "");
  }
}

/* Fills `item`, which begins with a deck_item. True when its keys can be looked at together. */
static bool read_item(deck_reader *r, const namelist_group *from, deck_group_kind kind,
                      deck_item *item) {
  int errors = r->d->errors;
  copy_places(r->memory, from, item);
  deck_defaults(r->memory, &deck_groups[kind], item);
  read_keys(r, from, &deck_groups[kind], item);
  item->faulty = from->broken || r->d->errors > errors;
  return !item->faulty;
}

/* --- the groups of a kind --------------------------------------------------------------------- */

static bool is_kind(const namelist_group *g, deck_group_kind kind) {
  return strcmp(g->name, deck_groups[kind].name) == 0;
}

static int count_kind(const namelist *n, deck_group_kind kind) {
  int count = 0;
  for (int i = 0; i < n->group_count; i++)
    count += is_kind(&n->groups[i], kind);
  return count;
}

static bool too_many_errors(const deck_reader *r) {
  return r->d->errors > MOST_ERRORS;
}

static void lack(deck *k, int kind) {
  k->lacks |= 1u << kind;
}

#define READ_LIST(group)                                                                           \
  static void read_##group##s(deck_reader *r, const namelist *n) {                                 \
    size_t count = (size_t)count_kind(n, DECK_GROUP_##group);                                      \
    r->k->group##s = arena_alloc(r->memory, count * sizeof(deck_##group));                         \
    for (int i = 0; i < n->group_count && !too_many_errors(r); i++) {                              \
      const namelist_group *from = &n->groups[i];                                                  \
      if (!is_kind(from, DECK_GROUP_##group)) continue;                                            \
      deck_##group *item = &r->k->group##s[r->k->group##_count];                                   \
      int errors = r->d->errors;                                                                   \
      if (read_item(r, from, DECK_GROUP_##group, &item->item)) deck_check_##group(r, from, item);  \
      item->item.faulty |= r->d->errors > errors;                                                  \
      if (item->item.faulty) lack(r->k, DECK_GROUP_##group);                                       \
      r->k->group##_count++;                                                                       \
    }                                                                                              \
  }
DECK_LISTS(READ_LIST)

#define READ_SINGLE(group)                                                                         \
  static void read_##group(deck_reader *r, const namelist *n) {                                    \
    deck_##group *item = &r->k->group;                                                             \
    const namelist_group *first = NULL;                                                            \
    deck_defaults(r->memory, &deck_groups[DECK_GROUP_##group], item);                              \
    for (int i = 0; i < n->group_count && !too_many_errors(r); i++) {                              \
      const namelist_group *from = &n->groups[i];                                                  \
      if (!is_kind(from, DECK_GROUP_##group)) continue;                                            \
      if (first) {                                                                                 \
        report_second(r, from, first);                                                             \
        continue;                                                                                  \
      }                                                                                            \
      first = from;                                                                                \
      int errors = r->d->errors;                                                                   \
      if (read_item(r, from, DECK_GROUP_##group, &item->item)) deck_check_##group(r, from, item);  \
      if (r->d->errors > errors) lack(r->k, DECK_GROUP_##group);                                   \
    }                                                                                              \
  }

static void report_second(deck_reader *r, const namelist_group *second,
                          const namelist_group *first) {
  diag_report(r->d, DIAG_DUPLICATE_NAME, second->where, "a deck has one `&%s`", second->name);
  diag_note(r->d, first->where, "it is given here");
}

READ_SINGLE(simulation)
READ_SINGLE(relaxation)
READ_SINGLE(output)
READ_SINGLE(checkpoint)

static void report_unknown_groups(deck_reader *r, const namelist *n) {
  const char *names[DECK_GROUP_COUNT];
  for (int i = 0; i < n->group_count && !too_many_errors(r); i++) {
    const namelist_group *g = &n->groups[i];
    if (deck_group_find(g->name) >= 0) continue;
    diag_report(r->d, DIAG_UNKNOWN_GROUP, g->where, "there is no group `&%s`", g->name);
    const char *meant = nearest_name(g->name, names, deck_group_names(names));
    if (meant) lack(r->k, deck_group_find(meant));
    if (strcmp(g->name, "cut") == 0)
      diag_hint(r->d, "a cut-out is a `&notch`, with cut_bonds = .false. when bonds may span it");
    else
      deck_suggest(r->d, g->name, names, deck_group_names(names), "the groups are");
  }
}

/* --- the deck --------------------------------------------------------------------------------- */

static const char *without_ending(arena *a, const char *path, const char *ending) {
  const char *slash = strrchr(path, '/');
  const char *name = slash ? slash + 1 : path;
  size_t length = strlen(name), tail = strlen(ending);
  if (length > tail && strcmp(name + length - tail, ending) == 0) length -= tail;
  return arena_text(a, name, length);
}

static void set_computed_defaults(deck_reader *r) {
  deck *k = r->k;
  const char *name = without_ending(r->memory, k->name, ".nml");
  if (!k->simulation.title) k->simulation.title = name;
  if (!k->output.result) k->output.result = arena_printf(r->memory, "%s.h5", name);
  if (k->simulation.step_safety <= 0)
    k->simulation.step_safety = k->relaxation.increments > 0 ? 0.9 : 0.25;
}

/* A name that could not be read may be the one that a reference means. */
static bool all_names_known(const deck *k, const namelist *n) {
  bool known = !n->broken;
  for (int i = 0; i < k->lattice_count; i++)
    known &= k->lattices[i].name != NULL;
  for (int i = 0; i < k->region_count; i++)
    known &= k->regions[i].name != NULL;
  for (int i = 0; i < k->monitor_count; i++)
    known &= k->monitors[i].name != NULL;
  return known;
}

/* --- files of loads --------------------------------------------------------------------------- */

static int find_source(const source_set *sources, const char *name) {
  for (int i = 0; i < sources->count; i++)
    if (strcmp(sources->items[i].name, name) == 0) return i;
  return -1;
}

static bool is_listed(const deck *k, int number) {
  for (int i = 0; i < k->file_count; i++)
    if (k->files[i].source == number) return true;
  return false;
}

static void list_file(deck_reader *r, const namelist_value *v) {
  const char *columns;
  char *name = text_table_split(v->text, &columns), *path = deck_file_path(r->k->name, name);
  const int found = find_source(r->d->sources, path);
  if (found >= 0 && !is_listed(r->k, found))
    r->k->files[r->k->file_count++] = (deck_file){arena_text(r->memory, name, strlen(name)), found};
  free(path);
  free(name);
}

/* Loads alone have a `file` that is read with the deck. */
static void list_files(deck_reader *r, const namelist *n) {
  r->k->files = arena_alloc(r->memory, ((size_t)n->group_count + 1) * sizeof *r->k->files);
  for (int i = 0; i < n->group_count; i++) {
    const int kind = deck_group_find(n->groups[i].name);
    const namelist_key *file = namelist_find(&n->groups[i], "file");
    if (kind < 0 || !file || file->value_count != 1 || file->values[0].kind != NAMELIST_TEXT)
      continue;
    const int key = deck_key_find(&deck_groups[kind], "file");
    if (key >= 0 && deck_groups[kind].keys[key].type == DECK_LATER) list_file(r, &file->values[0]);
  }
}

/* What may differ between a run and the run that resumes it. */
static bool is_no_matter(const char *group, const char *key) {
  if (strcmp(group, "checkpoint") == 0) return true;
  return key && strcmp(group, "simulation") == 0 &&
         (strcasecmp(key, "title") == 0 || strcasecmp(key, "threads") == 0);
}

/* A material is still good for saying what is wrong with its law. */
static bool is_kept(const deck_item *item, deck_group_kind kind) {
  const deck_material *m = (const deck_material *)item;
  return !item->faulty || (kind == DECK_GROUP_material && m->model && m->lattice);
}

#define LEAVE_OUT(group)                                                                           \
  static void leave_out_##group##s(deck *k) {                                                      \
    int kept = 0;                                                                                  \
    for (int i = 0; i < k->group##_count; i++)                                                     \
      if (is_kept(&k->group##s[i].item, DECK_GROUP_##group)) k->group##s[kept++] = k->group##s[i]; \
    k->group##_count = kept;                                                                       \
  }
DECK_LISTS(LEAVE_OUT)

static void leave_out_faulty(deck *k) {
#define X(group) leave_out_##group##s(k);
  DECK_LISTS(X)
#undef X
}

bool deck_lacks(const deck *k, const char *group) {
  return group ? k->lacks >> deck_group_find(group) & 1 : k->lacks != 0;
}

deck *deck_read_what_is_right(arena *a, source_set *sources, int file,
                              const deck_override *overrides, int override_count, diagnostics *d) {
  namelist *n = namelist_read(a, sources, file, d);
  deck_present_names(n, &deck_grammar_of_decks, d);
  deck_set(a, sources, n, &deck_grammar_of_decks, overrides, override_count, d);

  deck *k = arena_alloc(a, sizeof(*k));
  k->names = new_names(a);
  k->name = arena_text(a, sources->items[file].name, strlen(sources->items[file].name));
  k->simulation.item.where.file = k->output.item.where.file = k->checkpoint.item.where.file =
      (uint16_t)file;
  deck_reader r = {.memory = a, .d = d, .k = k, .names_known = true};
  report_unknown_groups(&r, n);
#define X(group, identity, single, open, doc)                                                      \
  r.names_known = all_names_known(k, n);                                                           \
  READ_##single(group);
#define READ_true(group)  read_##group(&r, n)
#define READ_false(group) read_##group##s(&r, n)
  DECK_GROUPS(X)
#undef X
  set_computed_defaults(&r);
  list_files(&r, n);
  k->identity = namelist_text(a, n, is_no_matter);
  if (!n->broken && !too_many_errors(&r)) deck_check_whole(&r);
  if (k->simulation.item.where.end == 0) lack(k, DECK_GROUP_simulation);
  if (n->broken || too_many_errors(&r)) k->lacks = ~0u; /* nobody knows what is behind */
  leave_out_faulty(k);
  k->names = new_names(a); /* others have moved up */
  return k;
}

deck *deck_read(arena *a, source_set *sources, int file, const deck_override *overrides,
                int override_count, diagnostics *d) {
  const int errors = d->errors;
  deck *k = deck_read_what_is_right(a, sources, file, overrides, override_count, d);
  return d->errors > errors ? NULL : k;
}
