#include "generator/settings.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

#include "runtime/deck_check.h"

bool settings_of_group(arena *a, const namelist_group *g, deck_material *m, diagnostics *d) {
  deck none = {.name = ""};
  deck_reader r = {a, d, &none, false}; /* there is no lattice that it could name */
  int errors = d->errors;
  m->item.where = g->where;
  deck_check_material(&r, g, m);
  return d->errors == errors;
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
  bool good = !key->broken && trial.errors == 0 && key->value_count == 1;
  diag_clear(&trial);
  if (!good) take_text(a, sources->items[file].text, begin, (uint16_t)file, key);
}

/* name=value into a key of the group. */
static bool read_one(arena *a, source_set *sources, const char *given, namelist_group *g,
                     diagnostics *d) {
  int file = source_add(sources, "--set", given, strlen(given));
  const char *text = sources->items[file].text;
  size_t name = strspn(text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_");
  const span where = {0, (uint32_t)name, (uint16_t)file};
  size_t equals = name + strspn(text + name, " ");
  bool empty = text[equals] == '=' && text[equals + 1 + strspn(text + equals + 1, " ")] == 0;
  if (name == 0 || name > NAMELIST_LONGEST_NAME || text[equals] != '=' || empty) {
    diag_report(d, DIAG_DECK_SYNTAX, (span){0, (uint32_t)strlen(text), (uint16_t)file},
                "`--set` takes a name and its value");
    diag_hint(d, "for example --set E='40 GPa'");
    return false;
  }
  namelist_key *key = namelist_add_key(a, g, arena_text(a, text, name));
  read_value(a, sources, file, (uint32_t)equals + 1, key);
  key->name_where = where;
  return true;
}

/* Those of `set` after those of `m`, of which the ones that it names again go. */
static void replace(arena *a, const deck_material *set, deck_material *m) {
  size_t room = (size_t)(m->assignment_count + set->assignment_count) + 1;
  deck_assignment *all = arena_alloc(a, room * sizeof *all);
  int count = 0;
  for (int k = 0; k < m->assignment_count; k++) {
    bool again = false;
    for (int n = 0; n < set->assignment_count; n++)
      again = again || strcasecmp(m->assignments[k].name, set->assignments[n].name) == 0;
    if (!again) all[count++] = m->assignments[k];
  }
  for (int n = 0; n < set->assignment_count; n++)
    all[count++] = set->assignments[n];
  m->assignments = all;
  m->assignment_count = count;
}

bool settings_read(arena *a, source_set *sources, const char *const *texts, int count,
                   deck_material *m, diagnostics *d) {
  namelist_group g = {.name = "material"};
  deck_material set = {.lattice = NULL};
  bool good = true;
  for (int k = 0; k < count; k++)
    good = read_one(a, sources, texts[k], &g, d) && good;
  good = good && settings_of_group(a, &g, &set, d);
  if (good) replace(a, &set, m);
  return good;
}
