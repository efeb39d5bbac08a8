#include "dsl/semantics/names.h"

#include <stdlib.h>
#include <string.h>

#define X(code, word) word,
static const char *const settings[] = {LAW_SETTINGS(X) LAW_IRREGULAR};
#undef X

enum { SETTING_COUNT = sizeof(settings) / sizeof(settings[0]), MOST_SUGGESTIONS = 100 };

/* --- the table -------------------------------------------------------------------------------- */

static unsigned hash_of(name_space space, const char *key) {
  unsigned hash = 2166136261u + (unsigned)space; /* Fowler, Noll, Vo */
  for (; *key; key++)
    hash = (hash ^ (unsigned char)*key) * 16777619u;
  return hash;
}

entry *names_find(const checker *ck, name_space space, const char *name) {
  entry *found = ck->buckets[hash_of(space, name) % (unsigned)ck->bucket_count];
  while (found && (found->space != space || strcmp(found->key, name) != 0))
    found = found->next;
  return found;
}

entry *names_find_choice(const checker *ck, const symbol *option, const char *name) {
  entry *found = names_find(ck, SPACE_CHOICES, name);
  while (found && (found->space != SPACE_CHOICES || found->symbol.option != option ||
                   strcmp(found->key, name) != 0))
    found = found->next;
  return found;
}

entry *names_add(checker *ck, name_space space, const char *key, symbol what) {
  entry *added = arena_alloc(ck->memory, sizeof(entry));
  entry **bucket = &ck->buckets[hash_of(space, key) % (unsigned)ck->bucket_count];
  *added = (entry){.symbol = what,
                   .space = space,
                   .key = key,
                   .declared_at = ck->now,
                   .rule_at = -1,
                   .next = *bucket};
  *bucket = added;
  if (ck->entry_count == ck->entry_room) {
    ck->entry_room = ck->entry_room ? 2 * ck->entry_room : 64;
    ck->entries = must_realloc(ck->entries, (size_t)ck->entry_room * sizeof(entry *));
  }
  ck->entries[ck->entry_count++] = added;
  return added;
}

/* Slip and gap are a law's own names where they are no quantities; so is what continua have in laws
   of lattices, and what lattices have in those of continua. */
static bool is_free_here(const checker *ck, const builtin_quantity_info *q) {
  const int here = 1 << ck->tree->law;
  if (q->kinds & here) return false;
  return q->kinds == IN_SLIP || ((q->kinds ^ here) & (IN_CONTINUUM | IN_CRACK));
}

/* Where a quantity lives in the law at hand. */
static placement place_here(const checker *ck, const builtin_quantity_info *q) {
  if (q->place == ON_NOTHING) return ON_NOTHING;
  if (ck->tree->law == LAW_CRACK) return ON_TIP;
  return is_single(ck) && q->place == ON_PARTICLE ? ON_BODY : q->place;
}

void names_add_quantity(checker *ck, int quantity) {
  const builtin_quantity_info *q = &builtin_quantities[quantity];
  const dimension dim = dimension_of(q->unit);
  const placement on = place_here(ck, q);
  entry *e = names_add(ck, SPACE_QUANTITIES, q->name,
                       (symbol){.kind = SYMBOL_QUANTITY,
                                .name = q->name,
                                .index = quantity,
                                .dim = dim,
                                .shape = q->shape,
                                .place = on,
                                .doc = q->meaning,
                                .used = true});
  e->type = (value){.dim = dim, .shape = q->shape, .place = on};
  e->known = true;
}

static void add_builtins(checker *ck) {
  ck->now = -1;
  for (int i = 0; i < QUANTITY_COUNT; i++)
    if (!is_free_here(ck, &builtin_quantities[i])) names_add_quantity(ck, i);
  for (int i = 0; i < SETTING_COUNT; i++) {
    entry *e = names_add(ck, SPACE_QUANTITIES, settings[i],
                         (symbol){.kind = SYMBOL_CHOICE,
                                  .name = settings[i],
                                  .index = i,
                                  .shape = SHAPE_LOGICAL,
                                  .used = true});
    e->type = (value){.shape = SHAPE_LOGICAL};
    e->known = true;
  }
}

void names_open(checker *ck) {
  ck->bucket_count = 101;
  for (int i = 0; i < ck->statement_count; i++)
    ck->bucket_count += 2 + ck->statements[i]->word_count;
  ck->buckets = must_calloc((size_t)ck->bucket_count, sizeof(entry *));
}

void names_begin(checker *ck) {
  names_open(ck);
  add_builtins(ck);
}

void names_end(checker *ck) {
  free(ck->buckets);
  free(ck->entries);
}

/* "fibre_x", as decks and results call a component of fibre. False: it is none. */
static bool suggest_axis(checker *ck, const char *name, size_t length) {
  if (length < 3 || name[length - 2] != '_' || !strchr("xyz", name[length - 1])) return false;
  const entry *e =
      names_find(ck, SPACE_QUANTITIES, arena_printf(ck->memory, "%.*s", (int)length - 2, name));
  if (!e || !e->known || e->type.shape != SHAPE_VECTOR) return false;
  diag_hint(ck->d, "a component of the vector `%s` is written `%s[%c]`", e->symbol.name,
            e->symbol.name, name[length - 1]);
  return true;
}

/* "eps_p_xy", as results call a component of eps_p; what is a tensor is found later. False: it is
   none. */
static bool suggest_component(checker *ck, const char *name) {
  const size_t length = strlen(name);
  if (suggest_axis(ck, name, length)) return true;
  if (length < 4 || name[length - 3] != '_') return false;
  const char *axes = name + length - 2;
  const entry *e =
      names_find(ck, SPACE_QUANTITIES, arena_printf(ck->memory, "%.*s", (int)length - 3, name));
  if (!e || strspn(axes, "xyz") != 2) return false;
  diag_hint(ck->d, "if `%s` is a tensor, its component is written `%s[%c,%c]`", e->symbol.name,
            e->symbol.name, axes[0], axes[1]);
  return true;
}

void names_suggest(checker *ck, name_space space, const char *name) {
  if (ck->d->count > MOST_SUGGESTIONS) return;
  if (space == SPACE_QUANTITIES && suggest_component(ck, name)) return;
  size_t most = (size_t)ck->entry_count + FUNCTION_COUNT;
  const char **candidates = must_calloc(most, sizeof(*candidates));
  int count = 0;
  for (int i = 0; i < ck->entry_count; i++) {
    const symbol *s = &ck->entries[i]->symbol;
    if (ck->entries[i]->space != space || strcmp(s->name, name) == 0) continue;
    if (s->kind == SYMBOL_QUANTITY && !(builtin_quantities[s->index].kinds & (1 << ck->tree->law)))
      continue;
    candidates[count++] = s->name;
  }
  for (int i = 0; i < FUNCTION_COUNT && space == SPACE_FUNCTIONS; i++)
    candidates[count++] = builtin_functions[i].name;
  diag_suggest(ck->d, name, candidates, count);
  free(candidates);
}

/* --- reading ---------------------------------------------------------------------------------- */

static const char *law_that_has(int kinds) {
  const law_kind kind = kinds & IN_MICROPOLAR  ? LAW_MICROPOLAR_BOND
                        : kinds & IN_STATE     ? LAW_STATE
                        : kinds & IN_SLIP      ? LAW_SLIP_BOND
                        : kinds & IN_CONTINUUM ? LAW_CONTINUUM
                                               : LAW_CENTRAL_BOND;
  return law_kind_name(kind);
}

static void report_other_kind(checker *ck, const expr *e, const builtin_quantity_info *q) {
  static const char *const laws[] = {[LAW_CENTRAL_BOND] = "a central law",
                                     [LAW_MICROPOLAR_BOND] = "a micropolar law",
                                     [LAW_STATE] = "a state law",
                                     [LAW_SLIP_BOND] = "a law of slip",
                                     [LAW_CONTINUUM] = "a law of a continuum",
                                     [LAW_CRACK] = "a law of cracks"};
  complain(ck, DIAG_LAW_KIND, e->name_where, "%s does not have `%s` (%s)", laws[ck->tree->law],
           e->name, q->meaning);
  if (q == &builtin_quantities[QUANTITY_DT])
    diag_hint(ck->d, "a tip is looked at now and then: `speed_now` is what it has of the time");
  else if (q->kinds == IN_CRACK)
    diag_hint(ck->d, "what a tip does, between `crack` and `end crack`, may read it");
  else
    diag_hint(ck->d, "a law that begins with `law %s` has it", law_that_has(q->kinds));
}

/* A name that a line `rest ...` would declare. */
static bool is_named_by_rest(const checker *ck, const char *name) {
  const char *resting = law_resting(ck->tree->law);
  const char *of = strncmp(name, "rest_", 5) == 0    ? name + 5
                   : strncmp(name, "total_", 6) == 0 ? name + 6
                                                     : "";
  return resting && strcmp(of, resting) == 0;
}

static void report_unknown(checker *ck, const expr *e) {
  const char *name = e->name;
  const int quantity = ck->alone ? -1 : builtin_quantity_find(name);
  if (quantity >= 0) {
    report_other_kind(ck, e, &builtin_quantities[quantity]);
    return;
  }
  const entry *choice = names_find(ck, SPACE_CHOICES, name);
  if (choice) {
    complain(ck, DIAG_OPTION, e->name_where, "`%s` is a choice of option `%s`, not a quantity",
             name, choice->symbol.option->name);
    diag_hint(ck->d, "write `%s == %s`", choice->symbol.option->name, name);
    return;
  }
  bool function = builtin_function_find(name) >= 0 || names_find(ck, SPACE_FUNCTIONS, name) != NULL;
  complain(ck, DIAG_UNKNOWN_NAME, e->name_where,
           function ? "`%s` is a function, not a quantity" : "there is no quantity `%s`", name);
  if (function)
    diag_hint(ck->d, "write its arguments: `%s(...)`", name);
  else if (ck->alone)
    diag_hint(ck->d, "a formula knows %s", ck->alone);
  else if (is_named_by_rest(ck, name))
    diag_hint(ck->d, "a line `rest %s = ...` declares it", law_resting(ck->tree->law));
  else
    names_suggest(ck, SPACE_QUANTITIES, name);
}

bool is_fixed(const symbol *s) {
  if (s->kind == SYMBOL_QUANTITY) return builtin_quantities[s->index].fixed;
  return s->kind == SYMBOL_CONSTANT || (s->kind == SYMBOL_PARAMETER && !symbol_is_field(s));
}

static bool quantity_is_here(checker *ck, const expr *e, const symbol *s) {
  const builtin_quantity_info *q = &builtin_quantities[s->index];
  if (!(q->kinds & (1 << ck->tree->law))) {
    report_other_kind(ck, e, q);
    return false;
  }
  if (ck->context == IN_CONSTANT && !is_fixed(s)) {
    complain(ck, DIAG_PLACEMENT, e->name_where, "`%s` changes in time, so a constant cannot use it",
             e->name);
    diag_hint(ck->d, "leave out the word `constant`");
    return false;
  }
  return true;
}

/* Whether the context lets the name in at all. */
static bool context_allows(checker *ck, const expr *e, const symbol *s) {
  if (s->kind == SYMBOL_QUANTITY && s->index == QUANTITY_PI) return true;
  switch (ck->context) {
  case IN_RULE:
    return true;
  case IN_DEFAULT:
    complain(ck, DIAG_PLACEMENT, e->name_where,
             "a default or initial value is made of numbers only");
    diag_hint(ck->d, "for a value that follows from others write `constant x = ...`");
    return false;
  case IN_FORMULA:
    if (s->kind == SYMBOL_PARAMETER && !symbol_is_field(s) && !s->component_of &&
        !expr_is_vector(s->declared->value))
      return true;
    complain(ck, DIAG_PLACEMENT, e->name_where,
             "a default is made of numbers and of parameters above it");
    diag_hint(ck->d, "for a value that follows from others write `constant x = ...`");
    return false;
  case IN_BOUNDS:
    if ((s->kind == SYMBOL_PARAMETER && !symbol_is_field(s)) || s->kind == SYMBOL_CHOICE ||
        s->kind == SYMBOL_OPTION)
      return true;
    complain(ck, DIAG_BOUNDS, e->name_where, "bounds are made of numbers and parameters");
    if (s->kind == SYMBOL_QUANTITY)
      diag_hint(ck->d,
                "`%s` is not known yet when parameters are read: let the parameter be the ratio to "
                "it, and write `constant x = ratio*%s`",
                s->name, s->name);
    else if (s->kind == SYMBOL_PARAMETER)
      diag_hint(ck->d, "`%s` is a field, which may differ from place to place and in time",
                s->name);
    else
      diag_hint(ck->d, "write out what `%s` is, in numbers and parameters", s->name);
    return false;
  case IN_CONSTANT:
    if ((s->kind <= SYMBOL_CONSTANT && (s->kind == SYMBOL_QUANTITY || is_fixed(s))) ||
        s->kind == SYMBOL_CHOICE || s->kind == SYMBOL_OPTION)
      return true;
    complain(ck, DIAG_PLACEMENT, e->name_where,
             "`%s` may change in time, so a constant cannot use it", e->name);
    if (s->kind == SYMBOL_DEFINED) {
      diag_note(ck->d, s->where, "`%s` is defined here", s->name);
      diag_hint(ck->d, "declare `constant %s = ...`, or leave out `constant` here", s->name);
    } else {
      diag_hint(ck->d, "leave out the word `constant`");
    }
    return false;
  }
  return false;
}

static bool field_may_be_read(checker *ck, expr *e, entry *found) {
  if (ck->function) {
    complain(ck, DIAG_PLACEMENT, e->name_where, "a function cannot read the %s `%s` by itself",
             found->symbol.kind == SYMBOL_STATE ? "state" : "damage", e->name);
    diag_hint(ck->d, "give it to the function as an argument");
    return false;
  }
  e->reads_old = found->rule_at < 0 || found->rule_at >= ck->now;
  found->symbol.old_is_read |= e->reads_old;
  return true;
}

static entry *find_argument(const checker *ck, const char *name) {
  const stmt *s = ck->function ? ck->function->symbol.declared : NULL;
  for (int i = 0; s && i < s->word_count; i++)
    if (strcmp(s->words[i], name) == 0) return &ck->function->arguments[i];
  return NULL;
}

/* Above its line there is no rest state yet, and that itself knows no motion. A function is
   checked where it is called. */
static bool is_measured_from_rest(checker *ck, const expr *e, const symbol *s) {
  const bool moves =
      s->kind == SYMBOL_QUANTITY && (s->index == QUANTITY_STRETCH || s->index == QUANTITY_STRAIN);
  if (!moves || !ck->law->rest || ck->now > ck->rest_at || ck->now >= ck->statement_count ||
      ck->statements[ck->now]->kind == STMT_FUNCTION)
    return true;
  if (ck->now == ck->rest_at)
    complain(ck, DIAG_PLACEMENT, e->where, "the rest %s does not know the %s", s->name, s->name);
  else
    complain(ck, DIAG_UNDEFINED, e->where, "`%s` is read above the line `rest %s`", s->name,
             s->name);
  diag_note(ck->d, ck->law->rest->where, "from here on it is measured from the rest %s", s->name);
  return false;
}

entry *names_resolve(checker *ck, expr *e) {
  entry *found = find_argument(ck, e->name);
  if (found) return found;
  if (strcmp(e->name, "j") == 0) {
    complain(ck, DIAG_RESERVED_NAME, e->name_where,
             "`j` stands for the neighbour and only in brackets, as in x[j]");
    return NULL;
  }
  found = names_find(ck, SPACE_QUANTITIES, e->name);
  if (!found) {
    report_unknown(ck, e);
    return NULL;
  }
  symbol *s = &found->symbol;
  if (ck->context != IN_BOUNDS) s->used = true;
  if (found->blamed) return NULL; /* said where it is declared */
  if (s->kind == SYMBOL_QUANTITY && !quantity_is_here(ck, e, s)) return NULL;
  if (!is_measured_from_rest(ck, e, s)) return NULL;
  if (!context_allows(ck, e, s)) return NULL;
  if (s->kind == SYMBOL_STATE || s->kind == SYMBOL_DAMAGE)
    return field_may_be_read(ck, e, found) ? found : NULL;
  return found;
}

bool names_is_below(const checker *ck, const entry *e) {
  const symbol_kind kind = e->symbol.kind;
  if (kind == SYMBOL_STATE || kind == SYMBOL_DAMAGE || kind == SYMBOL_ARGUMENT) return false;
  return e->declared_at >= ck->now && ck->context != IN_BOUNDS && ck->call_depth == 0;
}
