#include "runtime/deck/deck_set.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "runtime/deck/deck_value.h"

/* --- former names ----------------------------------------------------------------------------- */

static void present_name(namelist_group *g, const deck_key_info *info, diagnostics *d) {
  namelist_key *old = namelist_find(g, info->former), *given = namelist_find(g, info->name);
  if (old && given) {
    diag_report(d, DIAG_DUPLICATE_KEY, old->name_where, "`%s` is a former name of `%s`",
                info->former, info->name);
    diag_note(d, given->name_where, "`%s` is given here", info->name);
    namelist_remove_key(g, old);
  } else if (old)
    old->name = info->name;
}

void deck_present_names(namelist *n, const deck_grammar *grammar, diagnostics *d) {
  for (int t = 0; t < grammar->group_count; t++)
    for (int k = 0; k < grammar->groups[t]->key_count; k++) {
      const deck_key_info *info = &grammar->groups[t]->keys[k];
      for (int i = 0; info->former && i < n->group_count; i++)
        if (strcmp(n->groups[i].name, grammar->groups[t]->name) == 0)
          present_name(&n->groups[i], info, d);
    }
}

/* --- overrides -------------------------------------------------------------------------------- */

typedef struct setter {
  arena *memory;
  source_set *sources;
  namelist *groups;
  const deck_grammar *grammar;
  diagnostics *d;
  int file;
  const char *text;
  const deck_group_info *group; /* table entry */
  const char *key;
  const char *which; /* between the brackets, or NULL */
  span group_where, key_where, which_where;
  uint32_t value_begin;
} setter;

static span at(const setter *s, size_t begin, size_t end) {
  return (span){(uint32_t)begin, (uint32_t)end, (uint16_t)s->file};
}

static bool wrong_form(setter *s) {
  diag_report(s->d, DIAG_DECK_SYNTAX, at(s, 0, strlen(s->text)),
              "an override has the form group.key=value");
  diag_hint(s->d, "e.g. \"drive.velocity=-20 mm/s\" or \"region[loader].at=0.1, 0.2\"");
  return false;
}

static size_t name_length(const char *text) {
  size_t i = 0;
  while (isalnum((unsigned char)text[i]) || text[i] == '_')
    i++;
  return i;
}

/* group [ "[" which "]" ] "." key "=" */
static bool split(setter *s, const char **group) {
  size_t i = strspn(s->text, " &"), length = name_length(s->text + i);
  if (length == 0) return wrong_form(s);
  *group = arena_text(s->memory, s->text + i, length);
  s->group_where = at(s, i, i + length);
  i += length;
  if (s->text[i] == '[') {
    i++;
    size_t end = i + strcspn(s->text + i, "]");
    if (s->text[end] != ']' || end == i) return wrong_form(s);
    s->which = arena_text(s->memory, s->text + i, end - i);
    s->which_where = at(s, i, end);
    i = end + 1;
  }
  if (s->text[i] != '.') return wrong_form(s);
  i++;
  length = name_length(s->text + i);
  if (length == 0 || length > NAMELIST_LONGEST_NAME) return wrong_form(s);
  s->key = arena_text(s->memory, s->text + i, length);
  s->key_where = at(s, i, i + length);
  i += length;
  i += strspn(s->text + i, " ");
  if (s->text[i] != '=') return wrong_form(s);
  s->value_begin = (uint32_t)(i + 1);
  return true;
}

static bool find_group_info(setter *s, const char *group) {
  const deck_grammar *g = s->grammar;
  const char **names = arena_alloc(s->memory, (size_t)g->group_count * sizeof *names);
  for (int k = 0; k < g->group_count; k++) {
    names[k] = g->groups[k]->name;
    if (strcasecmp(names[k], group) == 0) s->group = g->groups[k];
  }
  if (s->group) return true;
  diag_report(s->d, DIAG_UNKNOWN_GROUP, s->group_where, "there is no group `&%s`",
              deck_shown(s->memory, group));
  deck_suggest(s->d, group, names, g->group_count, "the groups are");
  return false;
}

static bool find_names(setter *s, const char *group) {
  const char *names[DECK_MOST_KEYS];
  if (!find_group_info(s, group)) return false;
  const int known = deck_key_find(s->group, s->key);
  if (known >= 0 && s->group->keys[known].former) s->key = s->group->keys[known].name;
  if (s->group->open || known >= 0) return true;
  diag_report(s->d, DIAG_UNKNOWN_KEY, s->key_where, "`&%s` has no key `%s`", s->group->name,
              s->key);
  deck_suggest(s->d, s->key, names, deck_key_names(s->group, names), "its keys are");
  return false;
}

static bool is_meant(const setter *s, const namelist_group *g, int occurrence) {
  if (strcmp(g->name, s->group->name) != 0) return false;
  if (!s->which) return true;
  if (strspn(s->which, "0123456789") == strlen(s->which))
    return strtol(s->which, NULL, 10) == occurrence;
  const namelist_key *key = s->group->identity ? namelist_find(g, s->group->identity) : NULL;
  for (int k = 0; k < 4 && s->group->parts[k]; k++)
    if (namelist_find(g, s->group->parts[k])) key = namelist_find(g, s->group->parts[k]);
  return key && key->value_count == 1 && key->values[0].kind == NAMELIST_TEXT &&
         strcmp(key->values[0].text, s->which) == 0;
}

static void report_choice(setter *s, int found, int all) {
  const char *name = s->group->name, *identity = s->group->identity;
  span where = s->which ? s->which_where : s->group_where;
  if (all == 0)
    diag_report(s->d, DIAG_UNKNOWN_GROUP, where, "the %s has no group `&%s`", s->grammar->file,
                name);
  else if (found == 0)
    diag_report(s->d, DIAG_UNKNOWN_NAME, where, "none of the %s's %d `&%s` is `%s`",
                s->grammar->file, all, name, deck_shown(s->memory, s->which));
  else
    diag_report(s->d, DIAG_UNKNOWN_GROUP, where, "the %s has %d `&%s` that could be meant",
                s->grammar->file, found, name);
  if (all == 0)
    diag_hint(s->d, "`--set` changes what is there; write `&%s ... /` into the %s first", name,
              s->grammar->file);
  else if (identity)
    diag_hint(s->d, "say which by number or by its %s, e.g. `%s[1].%s`", identity, name, s->key);
  else
    diag_hint(s->d, "say which by number, e.g. `%s[1].%s`", name, s->key);
}

/* The group meant; one that occurs once at most and is not there is added. */
static namelist_group *find_group(setter *s) {
  namelist_group *meant = NULL;
  int found = 0, all = 0;
  for (int i = 0; i < s->groups->group_count; i++) {
    namelist_group *g = &s->groups->groups[i];
    all += strcmp(g->name, s->group->name) == 0;
    if (!is_meant(s, g, all)) continue;
    meant = g;
    found++;
  }
  if (found == 1) return meant;
  if (all == 0 && s->group->single) {
    meant = namelist_add_group(s->memory, s->groups, s->group->name);
    meant->where = s->group_where;
    return meant;
  }
  report_choice(s, found, all);
  return NULL;
}

/* Unquoted text, trimmed; cut at commas where the key takes several values. */
static void take_texts(setter *s, namelist_key *key, bool several) {
  *key = (namelist_key){.name = key->name, .value_where = at(s, s->value_begin, strlen(s->text))};
  for (size_t begin = s->value_begin;;) {
    size_t end = begin + strcspn(s->text + begin, several ? "," : "");
    size_t from = begin + strspn(s->text + begin, " "), to = end;
    while (to > from && s->text[to - 1] == ' ')
      to--;
    namelist_value *larger =
        arena_alloc(s->memory, ((size_t)key->value_count + 1) * sizeof(*larger));
    if (key->value_count) memcpy(larger, key->values, (size_t)key->value_count * sizeof(*larger));
    larger[key->value_count++] =
        (namelist_value){.kind = NAMELIST_TEXT,
                         .text = arena_text(s->memory, s->text + from, to - from),
                         .where = at(s, from, to),
                         .text_where = at(s, from, to)};
    key->values = larger;
    if (!s->text[end]) return;
    begin = end + 1;
  }
}

static bool takes_several(const setter *s) {
  enum { MOST_PIECES = 1000 };
  int k = deck_key_find(s->group, s->key);
  if (k < 0) return false;
  int commas = 0;
  for (const char *p = s->text; *p; p++)
    commas += *p == ',';
  deck_type type = s->group->keys[k].type;
  bool listed = strcmp(s->key, "times") == 0 || strcmp(s->key, "values") == 0;
  return commas < MOST_PIECES &&
         (type == DECK_NAMES || type == DECK_FIXED || type == DECK_PAIR || type == DECK_PLACE ||
          type == DECK_DIRECTION || type == DECK_REALS || listed);
}

/* Mixed values such as `4 mm, 0.1` split into texts: a bare number in one is a number again. */
static void numbers_again(namelist_key *key) {
  for (int i = 0; i < key->value_count; i++) {
    namelist_value *v = &key->values[i];
    double number;
    size_t length = strlen(v->text);
    if (length == 0 || namelist_number(v->text, length, &number) != length) continue;
    if (number - number != 0) continue; /* infinite: reported where it is used */
    v->kind = NAMELIST_NUMBER;
    v->number = number;
  }
}

static bool read_value(setter *s, namelist_key *key) {
  diagnostics trial;
  diag_begin(&trial, s->sources);
  namelist_read_values(s->memory, s->sources, s->file, s->value_begin, key, &trial);
  diag_clear(&trial);
  if (!key->broken) return true;
  const char *value = s->text + s->value_begin;
  value += strspn(value, " ");
  bool printable = *value && !strpbrk(value, "'\"");
  for (const char *p = value; *p; p++)
    printable &= (unsigned char)*p >= 32;
  if (printable) {
    take_texts(s, key, takes_several(s));
    numbers_again(key);
    return true;
  }
  *key = (namelist_key){.name = key->name};
  namelist_read_values(s->memory, s->sources, s->file, s->value_begin, key, s->d);
  return false;
}

/* Back to the default. A name that no table knows must be one that the deck gives. */
static void remove_key(setter *s) {
  namelist_group *g = find_group(s);
  namelist_key *key = g ? namelist_find(g, s->key) : NULL;
  if (key) {
    namelist_remove_key(g, key);
    g->where = s->key_where; /* there it is missed, if it must be given */
  } else if (g && deck_key_find(s->group, s->key) < 0) {
    diag_report(s->d, DIAG_UNKNOWN_KEY, s->key_where, "this `&%s` gives no `%s` to take back",
                s->group->name, s->key);
    const char **names = arena_alloc(s->memory, ((size_t)g->key_count + 1) * sizeof *names);
    for (int k = 0; k < g->key_count; k++)
      names[k] = g->keys[k].name;
    diag_suggest(s->d, s->key, names, g->key_count);
  }
}

static bool is_empty(const setter *s) {
  const char *value = s->text + s->value_begin;
  return value[strspn(value, " ")] == 0;
}

static void set_one(setter *s) {
  const char *group;
  if (!split(s, &group) || !find_names(s, group)) return;
  if (is_empty(s)) {
    remove_key(s);
    return;
  }
  namelist_key value = {.name = s->key};
  if (!read_value(s, &value)) return;
  namelist_group *g = find_group(s);
  if (!g) return;
  namelist_key *key = namelist_find(g, s->key);
  if (!key) key = namelist_add_key(s->memory, g, s->key);
  *key = value;
  key->name_where = s->key_where;
  g->where =
      at(s, 0, strlen(s->text)); /* what is wrong with the group as a whole is so since then */
}

void deck_set(arena *a, source_set *sources, namelist *n, const deck_grammar *grammar,
              const deck_override *overrides, int count, diagnostics *d) {
  for (int i = 0; i < count; i++) {
    size_t length = strlen(overrides[i].text);
    int file = source_add(sources, "--set", overrides[i].text, length);
    if (length > NAMELIST_LARGEST_TEXT) {
      diag_report(d, DIAG_TOO_LONG, (span){0, 0, (uint16_t)file}, "the override is too long");
      continue;
    }
    setter s = {
        .memory = a, .sources = sources, .groups = n, .grammar = grammar, .d = d, .file = file};
    s.text = sources->items[file].text;
    set_one(&s);
  }
}

const namelist_key *deck_find_key(arena *a, source_set *sources, namelist *n,
                                  const deck_grammar *grammar, const char *name, diagnostics *d) {
  const char *text = arena_printf(a, "%s=", name), *group;
  const int file = source_add(sources, name, text, strlen(text));
  setter s = {
      .memory = a, .sources = sources, .groups = n, .grammar = grammar, .d = d, .file = file};
  s.text = sources->items[file].text;
  if (!split(&s, &group) || !find_names(&s, group)) return NULL;
  const namelist_group *g = find_group(&s);
  return g ? namelist_find(g, s.key) : NULL;
}
