#include "runtime/deck/deck_read.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/elementary.h"
#include "dsl/semantics/formula.h"
#include "runtime/base/text_table.h"
#include "runtime/deck/deck_check.h"
#include "runtime/deck/deck_formula.h"
#include "runtime/deck/deck_groups.h"
#include "runtime/deck/deck_set.h"
#include "runtime/deck/deck_value.h"
#include "runtime/deck/group_lattice.h"
#include "runtime/deck/lattice_kind.h"

enum { MOST_ERRORS = 100 };

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

/* --- the groups of a kind --------------------------------------------------------------------- */

static void lack(deck *k, int kind) {
  k->lacks |= UINT64_C(1) << kind;
}

static bool too_many_errors(const deck_reader *r) {
  return r->d->errors > MOST_ERRORS;
}

/* Fills `item`, which begins with a deck_item. */
static void read_item(deck_reader *r, const namelist_group *from, int kind, void *of) {
  const deck_group_info *info = deck_groups[kind];
  const int errors = r->d->errors;
  deck_item *item = of;
  copy_places(r->memory, from, item);
  if (info->begin) info->begin(item);
  deck_defaults(r->memory, info, item);
  read_keys(r, from, info, item);
  item->faulty = from->broken || r->d->errors > errors;
  if (info->check && !item->faulty) info->check(r, from, item);
  item->faulty |= r->d->errors > errors;
  if (item->faulty) lack(r->k, kind);
}

/* The next group of the kind from *i on, or NULL. */
static const namelist_group *next_of(const namelist *n, int kind, int *i) {
  while (*i < n->group_count) {
    const namelist_group *g = &n->groups[(*i)++];
    if (strcmp(g->name, deck_groups[kind]->name) == 0) return g;
  }
  return NULL;
}

static size_t count_of(const namelist *n, int kind) {
  size_t count = 0;
  for (int i = 0; next_of(n, kind, &i);)
    count++;
  return count;
}

/* The items of a list in the deck, and where their count stands. */
static char *items_of(deck *k, const deck_group_info *info, int **count) {
  char *items;
  memcpy(&items, (char *)k + info->place, sizeof items);
  *count = (int *)(void *)((char *)k + info->count_place);
  return items;
}

/* Behind what the list holds already. */
static void read_list(deck_reader *r, const namelist *n, int kind) {
  const deck_group_info *info = deck_groups[kind];
  int *count, i = 0;
  const char *before = items_of(r->k, info, &count);
  char *items = arena_alloc(r->memory, ((size_t)*count + count_of(n, kind)) * info->size);
  if (*count > 0) memcpy(items, before, (size_t)*count * info->size);
  memcpy((char *)r->k + info->place, &items, sizeof items);
  for (const namelist_group *g; !too_many_errors(r) && (g = next_of(n, kind, &i)); ++*count)
    read_item(r, g, kind, items + (size_t)*count * info->size);
}

static void read_one(deck_reader *r, const namelist *n, int kind) {
  void *item = (char *)r->k + deck_groups[kind]->place;
  const namelist_group *first = NULL;
  int i = 0;
  deck_defaults(r->memory, deck_groups[kind], item);
  for (const namelist_group *g; !too_many_errors(r) && (g = next_of(n, kind, &i));) {
    if (!first) {
      first = g;
      read_item(r, g, kind, item);
      continue;
    }
    diag_report(r->d, DIAG_DUPLICATE_NAME, g->where, "a deck has one `&%s`", g->name);
    diag_note(r->d, first->where, "it is given here");
  }
}

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

/* A name that could not be read may be the one that a reference means. */
static bool all_names_known(const deck *k, const namelist *n) {
  bool known = !n->broken;
  for (int i = 0; i < k->lattice_count; i++)
    known &= k->lattices[i].name != NULL;
  for (int i = 0; i < k->lattice_count; i++) /* whose groups are regions */
    known &= !deck_lattice_is_mesh(&k->lattices[i]) || !k->lattices[i].file || k->lattices[i].gmsh;
  for (int i = 0; i < k->region_count; i++)
    known &= k->regions[i].name != NULL;
  for (int i = 0; i < k->monitor_count; i++)
    known &= k->monitors[i].name != NULL;
  return known;
}

/* A material is still good for saying what is wrong with its law. */
static bool is_kept(const deck_item *item, int kind) {
  const deck_material *m = (const deck_material *)item;
  return !item->faulty || (kind == DECK_GROUP_material && m->model && m->lattice);
}

static void leave_out_faulty(deck *k, int kind) {
  const size_t size = deck_groups[kind]->size;
  int *count, kept = 0;
  char *items = items_of(k, deck_groups[kind], &count);
  for (int i = 0; i < *count; i++) {
    void *item = items + (size_t)i * size;
    if (is_kept(item, kind)) memmove(items + (size_t)kept++ * size, item, size);
  }
  *count = kept;
}

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

/* --- files of loads and materials ------------------------------------------------------------- */

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
  if (found >= 0 && !is_listed(r->k, found)) {
    r->k->files = arena_room(r->memory, r->k->files, r->k->file_count, sizeof *r->k->files);
    r->k->files[r->k->file_count++] = (deck_file){arena_text(r->memory, name, strlen(name)), found};
  }
  free(path);
  free(name);
}

/* That of loads and meshes, and of parameters of materials, which are keys of no name that the deck
   knows. */
static bool is_read_with_the_deck(int kind, const namelist_key *key) {
  const int known = deck_key_find(deck_groups[kind], key->name);
  if (key->value_count != 1 || key->values[0].kind != NAMELIST_TEXT) return false;
  if (known < 0)
    return deck_groups[kind] == &deck_group_material && deck_is_place_file(&key->values[0]);
  return strcasecmp(key->name, "file") == 0 &&
         (deck_groups[kind]->keys[known].type == DECK_LATER || kind == DECK_GROUP_mesh);
}

static void list_files(deck_reader *r, const namelist *n) {
  for (int i = 0; i < n->group_count; i++) {
    const namelist_group *g = &n->groups[i];
    const int kind = deck_group_find(g->name);
    for (int k = 0; kind >= 0 && k < g->key_count; k++)
      if (is_read_with_the_deck(kind, &g->keys[k])) list_file(r, &g->keys[k].values[0]);
  }
}

/* What may differ between a run and the run that resumes it. */
static bool is_no_matter(const char *group, const char *key) {
  if (strcmp(group, "checkpoint") == 0 || strcmp(group, "study") == 0) return true;
  return key && strcmp(group, "simulation") == 0 &&
         (strcasecmp(key, "title") == 0 || strcasecmp(key, "threads") == 0);
}

/* --- the whole deck --------------------------------------------------------------------------- */

static bool has_material(const deck *k, const char *lattice) {
  return deck_lacks(k, "material") || deck_find_material(k, lattice) >= 0;
}

/* Equations are solved of meshes; and what they have no use for. */
static void check_static_run(deck_reader *r) {
  const deck *k = r->k;
  for (int n = 0; n < k->lattice_count; n++) {
    if (deck_lattice_is_mesh(&k->lattices[n])) continue;
    diag_report(r->d, DIAG_CONFLICT, k->lattices[n].item.where,
                "`&static` solves for meshes, and `%s` is none",
                deck_shown(r->memory, k->lattices[n].name ? k->lattices[n].name : ""));
    diag_hint(r->d, "`&relaxation increments = %d` in its place brings lattices to rest",
              k->relaxation.increments);
    break;
  }
  if (k->damping_count > 0)
    diag_report(r->d, DIAG_CONFLICT, k->dampings[0].item.where,
                "a static solution knows no motion: no `&damping` with `&static`");
  if (k->initial_displacement_count > 0)
    diag_report(r->d, DIAG_CONFLICT, k->initial_displacements[0].item.where,
                "a static solution does not depend on where it begins: no `&initial_displacement` "
                "with `&static`");
}

/* The time of these runs is only an order: a tip has no speed in it. */
static void check_no_growth(deck_reader *r, const char *group) {
  for (int n = 0; n < r->k->crack_count; n++) {
    const deck_crack *c = &r->k->cracks[n];
    if (!c->grows) continue;
    diag_report(r->d, DIAG_CONFLICT, deck_where(&c->item, "grows"),
                "a crack grows in time, which a run with `&%s` does not have", group);
    diag_hint(r->d, "leave `grows` away: stress intensities are found all the same");
    return;
  }
}

/* Inertia and its damping are means of the relaxation. */
static void check_quasi_static(deck_reader *r) {
  const deck *k = r->k;
  const char *group = k->relaxation.solved ? "static" : "relaxation";
  if (k->relaxation.increments < 1) return;
  check_no_growth(r, group);
  if (k->relaxation.solved)
    check_static_run(r);
  else if (k->damping_count > 0)
    diag_report(r->d, DIAG_CONFLICT, k->dampings[0].item.where,
                "a quasi-static run chooses its damping itself: no `&damping` with `&relaxation`");
  if (k->simulation.periods > 0)
    diag_report(r->d, DIAG_CONFLICT, deck_where(&k->simulation.item, "end_time"),
                "the time of a quasi-static run is only an order: it has no periods");
  if (k->simulation.shrink_every > 0) {
    diag_report(r->d, DIAG_CONFLICT, deck_where(&k->simulation.item, "shrink_every"),
                "steps that may shrink are steps in time, which a run with `&%s` does not have",
                group);
    diag_hint(r->d, "leave `shrink_every` away");
  }
  if (k->initial_velocity_count > 0)
    diag_report(r->d, DIAG_CONFLICT, k->initial_velocitys[0].item.where,
                "a quasi-static run begins at rest: no `&initial_velocity` with `&%s`", group);
}

/* What ties and stamps carry over from step to step is of steps of one length. */
static void check_shrinking(deck_reader *r) {
  const deck *k = r->k;
  if (k->simulation.shrink_every == 0 || (k->tie_count == 0 && k->stamp_count == 0)) return;
  const bool tied = k->tie_count > 0;
  diag_report(r->d, DIAG_NOT_SUPPORTED, deck_where(&k->simulation.item, "shrink_every"),
              tied ? "steps do not shrink where a lattice is tied to a mesh"
                   : "steps do not shrink in a run with stamps");
  diag_note(r->d, tied ? k->ties[0].item.where : k->stamps[0].item.where,
            tied ? "it is tied here" : "a stamp");
  diag_hint(r->d, "leave `shrink_every` away, and give a smaller `step_safety`");
}

/* Only a static solution needs no time. */
static void check_end(deck_reader *r) {
  deck_simulation *s = &r->k->simulation;
  if (s->end_time > 0 || s->periods > 0 || s->item.where.end == 0 || s->item.faulty) return;
  diag_report(r->d, DIAG_MISSING_KEY, s->item.where, "`&simulation` has no `end_time`");
  diag_hint(
      r->d,
      "end_time: the run begins at 0 and ends here; periods are those of the lowest mode (s)");
  lack(r->k, DECK_GROUP_simulation);
}

/* A region that a material is for is one of its lattice. */
static void check_region_of(deck_reader *r, const deck_material *m, const char *key,
                            const char *name) {
  const span where = deck_where(&m->item, key);
  const int region = deck_region_known(r, where, name) ? deck_find_region(r->k, name) : -1;
  const char *of = region < 0 ? NULL : r->k->regions[region].lattice;
  if (of && m->lattice && strcmp(of, m->lattice) != 0)
    diag_report(r->d, DIAG_CONFLICT, where, "the region `%s` is of the lattice `%s`, not of `%s`",
                deck_shown(r->memory, name), deck_shown(r->memory, of),
                deck_shown(r->memory, m->lattice));
}

/* The second material of the same bonds or particles. */
static void check_once(deck_reader *r, const deck_material *m) {
  for (const deck_material *other = r->k->materials; other < m; other++) {
    const bool same = deck_same_name(other->lattice, m->lattice);
    const bool region = m->region && deck_same_name(other->region, m->region);
    const bool bonds = m->between[0] && other->between[0] &&
                       ((deck_same_name(other->between[0], m->between[0]) &&
                         deck_same_name(other->between[1], m->between[1])) ||
                        (deck_same_name(other->between[0], m->between[1]) &&
                         deck_same_name(other->between[1], m->between[0])));
    if (!same || !(region || bonds)) continue;
    diag_report(r->d, DIAG_CONFLICT, deck_where(&m->item, region ? "region" : "between"),
                region ? "the region `%s` has a material already"
                       : "the bonds between `%s` and `%s` have a material already",
                deck_shown(r->memory, region ? m->region : m->between[0]),
                region ? "" : deck_shown(r->memory, m->between[1]));
    diag_note(r->d, other->item.where, "it is given here");
    return;
  }
}

static void check_regional_materials(deck_reader *r) {
  for (int i = 0; i < r->k->material_count; i++) {
    const deck_material *m = &r->k->materials[i];
    if (m->region) check_region_of(r, m, "region", m->region);
    for (int end = 0; end < 2 && m->between[end]; end++)
      check_region_of(r, m, "between", m->between[end]);
    if (m->between[0] && deck_same_name(m->between[0], m->between[1]))
      diag_report(r->d, DIAG_BAD_VALUE, deck_where(&m->item, "between"),
                  "a bond `between` joins two regions; the material of one is given by `region`");
    check_once(r, m);
  }
}

/* The material of the lattice or mesh whose region `m` is for, with its law; -1: nothing fits. */
static int lattice_material(const deck *k, const deck_material *m) {
  const int region = m->region ? deck_find_region(k, m->region) : -1;
  const int whole = region < 0 || !m->lattice ? -1 : deck_find_material(k, m->lattice);
  const bool fits = whole >= 0 && deck_same_name(k->regions[region].lattice, m->lattice) &&
                    deck_same_name(k->materials[whole].model, m->model);
  return fits ? whole : -1;
}

static const deck_assignment *density_of(const deck_material *m) {
  for (int n = 0; n < m->assignment_count; n++)
    if (strcasecmp(m->assignments[n].name, "rho") == 0) return &m->assignments[n];
  return NULL;
}

/* Unless a region says otherwise its particles have the density of their lattice. */
static void inherit_density(deck_material *m, const deck_material *whole) {
  const deck_assignment *density = density_of(whole);
  if (!density || density_of(m)) return;
  m->assignments[m->assignment_count++] = *density; /* there is room: for `region` */
}

/* The deck is still being read. */
static deck_material *material_read(const deck *k, int material) {
  return (deck_material *)(uintptr_t)&k->materials[material];
}

/* The lattice's material knows those of its regions. */
static void link_regional(arena *a, deck *k) {
  for (int i = 0; i < k->material_count; i++) {
    const int whole = lattice_material(k, &k->materials[i]);
    if (whole < 0) continue;
    deck_material *of = material_read(k, whole);
    inherit_density(material_read(k, i), of);
    if (of->mesh) continue; /* there it is a law beside, with values of its own */
    of->regional = arena_room(a, of->regional, of->regional_count, sizeof *of->regional);
    of->regional[of->regional_count++] = &k->materials[i];
  }
}

static bool is_region_of(const deck *k, const char *name, const char *lattice) {
  const int region = name ? deck_find_region(k, name) : -1;
  return region >= 0 && deck_same_name(k->regions[region].lattice, lattice);
}

/* A law of its own in a part of the lattice, of a mesh also its law with other values; what is
   wrong has been said. */
static bool is_law_beside(const deck *k, int material, const char *lattice) {
  const deck_material *m = &k->materials[material];
  if (!deck_same_name(m->lattice, lattice) || !m->model) return false;
  if (m->region)
    return is_region_of(k, m->region, lattice) && (m->mesh || lattice_material(k, m) < 0);
  return is_region_of(k, m->between[0], lattice) && is_region_of(k, m->between[1], lattice);
}

static deck_interaction law_beside(arena *a, const deck *k, int lattice, int material) {
  const deck_material *m = &k->materials[material];
  const char *of = k->lattices[lattice].name;
  return (deck_interaction){
      .name = m->region ? arena_printf(a, "%s.%s", of, m->region)
                        : arena_printf(a, "%s.%s-%s", of, m->between[0], m->between[1]),
      .lattice = lattice,
      .material = m};
}

/* The laws at work on each lattice. */
static void list_interactions(arena *a, deck *k) {
  deck_interaction *all =
      arena_alloc(a, ((size_t)k->lattice_count + (size_t)k->material_count + 1) * sizeof *all);
  int count = 0;
  for (int n = 0; n < k->lattice_count; n++) {
    const char *name = k->lattices[n].name;
    const int whole = name ? deck_find_material(k, name) : -1;
    all[count++] = (deck_interaction){
        .name = name, .lattice = n, .material = whole < 0 ? NULL : &k->materials[whole]};
    for (int m = 0; m < k->material_count && whole >= 0; m++)
      if (is_law_beside(k, m, name)) {
        material_read(k, m)->beside = material_read(k, whole)->beside = true;
        all[count++] = law_beside(a, k, n, m);
      }
  }
  k->interactions = all;
  k->interaction_count = count;
}

/* Middle of the box of a region, or where that is NULL of a lattice's bodies; NaN where no shape
   says. */
static void find_middle(const deck *k, const char *lattice, const char *of_region,
                        double middle[3]) {
  double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY};
  const int region = of_region ? deck_find_region(k, of_region) : -1;
  for (int b = 0; b < (region < 0 ? k->body_count : 1); b++) {
    double low[3], high[3];
    if (region < 0 && !deck_same_name(k->bodys[b].lattice, lattice)) continue;
    if ((region < 0 ? &k->bodys[b].item : &k->regions[region].item)->faulty) continue;
    shape_box(region < 0 ? &k->bodys[b].shape : &k->regions[region].shape, low, high);
    for (int c = 0; c < 3; c++) {
      lower[c] = pl_fmin(lower[c], low[c]);
      upper[c] = pl_fmax(upper[c], high[c]);
    }
  }
  for (int c = 0; c < 3; c++)
    middle[c] = isfinite(lower[c] + upper[c]) ? 0.5 * (lower[c] + upper[c]) : NAN;
}

/* What is asked of a parameter before there are particles, the middle answers; the particles
   themselves are asked when they are known. */
static void take_middles(deck_reader *r) {
  for (int i = 0; i < r->k->material_count; i++) {
    const deck_material *m = &r->k->materials[i];
    double middle[FORMULA_VARIABLES] = {0};
    find_middle(r->k, m->lattice, m->region, middle);
    for (int n = 0; n < m->assignment_count; n++) {
      deck_assignment *a = &m->assignments[n];
      if (a->placed && a->placed->formula) a->value = formula_value(a->placed->formula, middle);
    }
  }
}

static void take_middle_spacings(deck_reader *r) {
  for (int i = 0; i < r->k->lattice_count; i++) {
    deck_lattice *l = (deck_lattice *)(uintptr_t)&r->k->lattices[i]; /* still being read */
    double middle[3];
    if (!l->graded) continue;
    find_middle(r->k, l->name, NULL, middle);
    l->spacing = formula_value(l->graded, middle);
  }
}

static bool has_regional(const deck *k, const char *lattice) {
  for (int i = 0; i < k->material_count; i++)
    if (k->materials[i].region && deck_same_name(k->materials[i].lattice, lattice)) return true;
  return false;
}

/* A law that suits a bar, or a link. */
static void hint_law(deck_reader *r, const deck_lattice *l, const char *name) {
  const bool link = deck_lattice_is_link(l);
  if (!link && !deck_lattice_is_bar(l)) return;
  const char *law = !link                             ? "steel_bar"
                    : l->to == LINK_TO_PLACE          ? "bond_slip"
                    : deck_lattice_dimensions(l) == 3 ? "mplm_space"
                                                      : "bar_bond";
  diag_hint(r->d, "such as: &material %s = '%s' model = '%s' /", deck_lattice_word(l), name, law);
}

/* What speaks of meshes and their cracks alone. */
static void check_meshless(deck_reader *r) {
  const deck *k = r->k;
  bool mesh = deck_lacks(k, "mesh");
  for (int n = 0; n < k->lattice_count; n++)
    mesh = mesh || deck_lattice_is_mesh(&k->lattices[n]);
  const deck_item *items[] = {&k->tips.item, &k->newmark.item};
  for (int n = 0; n < 2 && !mesh; n++)
    if (items[n]->where.end > 0)
      diag_report(r->d, DIAG_MISSING_KEY, items[n]->where, "`&%s` is for meshes, and there is none",
                  n ? "newmark" : "tips");
  if (!mesh || k->tips.item.where.end == 0 || k->crack_count > 0 || deck_lacks(k, "crack")) return;
  diag_report(r->d, DIAG_DECK_WARNING, k->tips.item.where,
              "`&tips` does nothing: the deck has no `&crack`");
}

static void check_whole(deck_reader *r) {
  const deck *k = r->k;
  const deck_item *simulation = &k->simulation.item;
  if (simulation->where.end == 0 && !deck_lacks(k, "simulation")) /* never read */
    diag_report(r->d, DIAG_MISSING_KEY, simulation->where, "the deck has no `&simulation`");
  if (k->lattice_count == 0 && !deck_lacks(k, "lattice") && !deck_lacks(k, "bar"))
    diag_report(r->d, DIAG_MISSING_KEY, simulation->where,
                "the deck has no body: neither `&lattice` nor `&mesh`");
  check_end(r);
  check_quasi_static(r);
  check_shrinking(r);
  check_meshless(r);
  check_regional_materials(r);
  take_middles(r);
  take_middle_spacings(r);
  for (int i = 0; i < k->lattice_count; i++) {
    const deck_lattice *lattice = &k->lattices[i];
    if (!lattice->name) continue;
    const char *name = deck_shown(r->memory, lattice->name);
    if (!has_material(k, lattice->name)) {
      diag_report(r->d, DIAG_MISSING_KEY, lattice->item.where, "the %s `%s` has no `&material`%s",
                  deck_lattice_word(lattice), name,
                  has_regional(k, lattice->name) ? " without `region`" : "");
      hint_law(r, lattice, name);
    }
    if (deck_misses_body(k, i))
      diag_report(r->d, DIAG_MISSING_KEY, lattice->item.where, "the lattice `%s` has no `&body`",
                  name);
  }
}

/* --- the deck --------------------------------------------------------------------------------- */

static void read_groups(deck_reader *r, const namelist *n) {
  report_unknown_groups(r, n);
  for (int kind = 0; kind < DECK_GROUP_COUNT; kind++) {
    r->names_known = all_names_known(r->k, n);
    if (deck_groups[kind]->single)
      read_one(r, n, kind);
    else
      read_list(r, n, kind);
  }
  set_computed_defaults(r);
  list_files(r, n);
  if (!n->broken && !too_many_errors(r)) check_whole(r);
}

static void leave_out_all_faulty(deck *k) {
  for (int kind = 0; kind < DECK_GROUP_COUNT; kind++)
    if (!deck_groups[kind]->single) leave_out_faulty(k, kind);
}

/* Lattices have moved up. */
static void find_anew_what_links_join(deck *k) {
  for (int n = 0; n < k->lattice_count; n++) {
    deck_link *link = (deck_link *)&k->lattices[n];
    if (!deck_lattice_is_link(link)) continue;
    link->of_bar = deck_find_lattice(k, link->bar);
    link->of_around = deck_find_lattice(k, link->around);
  }
}

const deck *deck_read_what_is_right(arena *a, source_set *sources, int file,
                                    const deck_override *overrides, int override_count,
                                    diagnostics *d) {
  namelist *n = namelist_read(a, sources, file, d);
  deck_present_names(n, &deck_grammar_of_decks, d);
  deck_set(a, sources, n, &deck_grammar_of_decks, overrides, override_count, d);

  deck *k = arena_alloc(a, sizeof(*k));
  k->names = deck_names_new(a);
  k->name = arena_text(a, sources->items[file].name, strlen(sources->items[file].name));
  k->identity = namelist_text(a, n, is_no_matter);
  k->simulation.item.where.file = k->output.item.where.file = k->checkpoint.item.where.file =
      (uint16_t)file;
  deck_reader r = {.memory = a, .d = d, .k = k, .names_known = true};
  read_groups(&r, n);
  if (k->simulation.item.where.end == 0) lack(k, DECK_GROUP_simulation);
  if (n->broken || too_many_errors(&r)) k->lacks = UINT64_MAX; /* nobody knows what is behind */
  leave_out_all_faulty(k);
  k->names = deck_names_new(a); /* others have moved up */
  find_anew_what_links_join(k);
  link_regional(a, k);
  list_interactions(a, k);
  return k;
}

const deck *deck_read(arena *a, source_set *sources, int file, const deck_override *overrides,
                      int override_count, diagnostics *d) {
  const int errors = d->errors;
  const deck *k = deck_read_what_is_right(a, sources, file, overrides, override_count, d);
  return d->errors > errors ? NULL : k;
}

const deck_study *deck_read_study(arena *a, source_set *sources, int file, bool *whole,
                                  diagnostics *d) {
  const int errors = d->errors;
  const namelist *n = namelist_read(a, sources, file, d);
  deck *k = arena_alloc(a, sizeof *k);
  deck_reader r = {.memory = a, .d = d, .k = k, .names_known = true};
  *whole = false;
  for (int g = 0; g < n->group_count; g++)
    *whole |= strcmp(n->groups[g].name, deck_groups[DECK_GROUP_study]->name) != 0;
  read_one(&r, n, DECK_GROUP_study);
  return d->errors == errors ? &k->study : NULL;
}

const char *deck_read_value(arena *a, source_set *sources, int file, const deck_override *overrides,
                            int override_count, const char *name, diagnostics *d) {
  namelist *n = namelist_read(a, sources, file, d);
  deck_present_names(n, &deck_grammar_of_decks, d);
  deck_set(a, sources, n, &deck_grammar_of_decks, overrides, override_count, d);
  const namelist_key *key = deck_find_key(a, sources, n, &deck_grammar_of_decks, name, d);
  if (!key || key->value_count != 1) return NULL;
  const namelist_value *v = &key->values[0];
  return v->kind == NAMELIST_TEXT     ? arena_text(a, v->text, strlen(v->text))
         : v->kind == NAMELIST_NUMBER ? arena_printf(a, "%.17g", v->number)
                                      : NULL;
}
