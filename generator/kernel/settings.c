#include "generator/kernel/settings.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

#include "runtime/deck/group_lattice.h"

bool settings_of_group(arena *a, const namelist_group *g, deck_material *m, diagnostics *d) {
  m->item.where = g->where;
  bool good = deck_assignments_read(a, g, &deck_group_material, m, d);
  for (int k = 0; k < m->assignment_count; k++) {
    const deck_placed *by = m->assignments[k].placed;
    if (!by) continue;
    diag_report(d, DIAG_NOT_SUPPORTED, m->assignments[k].value_where,
                by->path ? "there are no particles here that a file could have values for"
                         : "there are no places here that a formula of x, y, z could read");
    good = false;
  }
  return good;
}

/* The rest of the text, without quotes and trimmed: `40 GPa`, `exponential`. */
static void take_text(arena *a, const char *text, uint32_t begin, uint16_t file,
                      namelist_key *key) {
  uint32_t end = (uint32_t)strlen(text);
  while (end > begin && text[end - 1] == ' ')
    end--;
  while (begin < end && text[begin] == ' ')
    begin++;
  const span where = {begin, end, file};
  key->values = arena_alloc(a, sizeof *key->values);
  key->values[0] = (namelist_value){.kind = NAMELIST_TEXT,
                                    .text = arena_text(a, text + begin, end - begin),
                                    .where = where,
                                    .text_where = where};
  key->value_count = 1;
  key->value_where = where;
  key->broken = false;
}

static void read_value(arena *a, source_set *sources, int file, uint32_t begin, namelist_key *key) {
  diagnostics trial;
  diag_begin(&trial, sources);
  namelist_read_values(a, sources, file, begin, key, &trial);
  bool good = !key->broken && trial.errors == 0 && key->value_count >= 1 && key->value_count <= 3;
  diag_clear(&trial);
  if (!good) take_text(a, sources->items[file].text, begin, (uint16_t)file, key);
}

static bool is_called(const deck_assignment *a, const char *name) {
  return strcasecmp(a->name, name) == 0 || (a->vector && strcasecmp(a->vector, name) == 0);
}

/* Those of `m` but the ones of a name, or of a vector's. */
static int remove_name(deck_material *m, const char *name) {
  int kept = 0;
  const int before = m->assignment_count;
  for (int k = 0; k < before; k++)
    if (!is_called(&m->assignments[k], name)) m->assignments[kept++] = m->assignments[k];
  m->assignment_count = kept;
  return before - kept;
}

static void add_all(arena *a, const deck_material *set, deck_material *m) {
  const size_t room = (size_t)(m->assignment_count + set->assignment_count) + 1;
  deck_assignment *all = arena_alloc(a, room * sizeof *all);
  for (int k = 0; k < m->assignment_count; k++)
    all[k] = m->assignments[k];
  for (int k = 0; k < set->assignment_count; k++)
    all[m->assignment_count++] = set->assignments[k];
  m->assignments = all;
}

/* name=value, or name= */
static bool set_one(arena *a, source_set *sources, const char *given, deck_material *m,
                    diagnostics *d) {
  int file = source_add(sources, "--set", given, strlen(given));
  const char *text = sources->items[file].text;
  size_t length = strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_");
  const span where = {0, (uint32_t)length, (uint16_t)file};
  size_t equals = length + strspn(text + length, " ");
  if (length == 0 || length > NAMELIST_LONGEST_NAME || text[equals] != '=') {
    diag_report(d, DIAG_DECK_SYNTAX, (span){0, (uint32_t)strlen(text), (uint16_t)file},
                "`--set` takes a name and its value");
    diag_hint(d, "for example --set E='40 GPa'");
    return false;
  }
  const char *name = arena_text(a, text, length);
  const int removed = remove_name(m, name);
  if (text[equals + 1 + strspn(text + equals + 1, " ")] == 0) {
    if (!removed) diag_report(d, DIAG_UNKNOWN_KEY, where, "no `%s` is given to take back", name);
    return removed > 0;
  }
  namelist_group g = {.name = "material"};
  deck_material set = {.lattice = NULL};
  namelist_key *key = namelist_add_key(a, &g, name);
  read_value(a, sources, file, (uint32_t)equals + 1, key);
  key->name_where = where;
  if (!settings_of_group(a, &g, &set, d)) return false;
  add_all(a, &set, m);
  return true;
}

bool settings_read(arena *a, source_set *sources, const char *const *texts, int count,
                   deck_material *m, diagnostics *d) {
  bool good = true;
  for (int k = 0; k < count; k++)
    good = set_one(a, sources, texts[k], m, d) && good;
  return good;
}
