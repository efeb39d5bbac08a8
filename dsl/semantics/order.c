#include "dsl/semantics/order.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/semantics/names.h"

/* A search along the names that rules read, with a stack of its own: chains may be as long as the
 * file. */
typedef struct search {
  checker *ck;
  int mark;
  bool old_too; /* follow reads of the last step's value as well */
  const entry *reader;
  int reader_at; /* position of the statement that reads */
  const stmt *reader_rule;
  entry **stack;
  int count, room;
  int depth;
} search;

static search search_begin(checker *ck, bool old_too) {
  return (search){.ck = ck, .mark = ++ck->search_mark, .old_too = old_too};
}

static void reach(search *s, entry *e) {
  if (!e || e->visited == s->mark) return;
  bool field = e->symbol.kind == SYMBOL_STATE || e->symbol.kind == SYMBOL_DAMAGE;
  if (field && s->reader && !s->old_too && (e->rule_at < 0 || e->rule_at >= s->reader_at)) return;
  e->visited = s->mark;
  e->reached_from = s->reader;
  if (s->count == s->room) {
    s->room = s->room ? 2 * s->room : 64;
    s->stack = must_realloc(s->stack, (size_t)s->room * sizeof(entry *));
  }
  s->stack[s->count++] = e;
}

static bool is_argument(const stmt *rule, const char *name) {
  for (int i = 0; rule->kind == STMT_FUNCTION && i < rule->word_count; i++)
    if (strcmp(rule->words[i], name) == 0) return true;
  return false;
}

static void reach_names(search *s, const expr *e) {
  if (!e || s->depth >= MOST_DEPTH) return;
  s->depth++;
  if (e->kind == EXPR_NAME && !is_argument(s->reader_rule, e->name))
    reach(s, names_find(s->ck, SPACE_QUANTITIES, e->name));
  if (e->kind == EXPR_CALL) reach(s, names_find(s->ck, SPACE_FUNCTIONS, e->name));
  reach_names(s, e->left);
  reach_names(s, e->right);
  for (int i = 0; i < e->argument_count; i++)
    reach_names(s, e->arguments[i].value);
  for (int i = 0; i < e->case_count; i++) {
    reach_names(s, e->cases[i].value);
    reach_names(s, e->cases[i].guard);
  }
  s->depth--;
}

/* Follows everything reachable; stops early at `goal` (which may be NULL). */
static bool search_run(search *s, const entry *goal) {
  while (s->count > 0) {
    entry *e = s->stack[--s->count];
    const bool parameter = e->symbol.kind == SYMBOL_PARAMETER; /* whose default may be a formula */
    const stmt *rule = parameter ? e->symbol.declared : e->symbol.rule;
    if (e == goal) return true;
    if (!rule) continue;
    s->reader = e;
    s->reader_rule = rule;
    s->reader_at = e->rule_at >= 0 ? e->rule_at : e->declared_at;
    reach_names(s, rule->value);
    reach_names(s, rule->when);
  }
  return false;
}

/* --- cycles ----------------------------------------------------------------------------------- */

/* a = b + 1, b = 2*c, c = a: while `a` is checked, `b` is found below. A search from `b` along what
   rules read arrives at `a`: "`a` needs `b`, which needs `c`, which needs `a`". Without `c = a` it
   does not arrive, and `b` is only used above its definition. A state whose rule stands below is
   read with its value of the last step: it ends the search. */

/* "`a` needs `b`, which needs `a`": the chain from the target back to what is being defined. */
static const char *chain_text(checker *ck, const entry *self) {
  const char *text = arena_printf(ck->memory, "`%s`", self->symbol.name);
  int links = 0;
  for (const entry *e = self->reached_from; e; e = e->reached_from) {
    if (++links > 6) return arena_printf(ck->memory, "... %s", text);
    text = arena_printf(ck->memory, "`%s`, which needs %s", e->symbol.name, text);
  }
  return arena_printf(ck->memory, "`%s` needs %s", self->symbol.name, text);
}

static void report_self(checker *ck, const expr *e, const entry *self) {
  if (self->symbol.kind == SYMBOL_FUNCTION) {
    complain(ck, DIAG_CYCLE, e->name_where, "`%s` calls itself", e->name);
    diag_hint(ck->d, "functions cannot be recursive");
    return;
  }
  complain(ck, DIAG_CYCLE, e->name_where, "`%s` is defined by itself", e->name);
  if (self->symbol.kind == SYMBOL_PARAMETER)
    diag_hint(ck->d, "its default may read the parameters above it, or is a number");
  else
    diag_hint(ck->d, "to read its value of the last step declare `state %s on %s = 0` above",
              e->name, placement_name(natural_place(ck)));
}

void report_undefined(checker *ck, const expr *e, entry *target) {
  const stmt *now = ck->statements[ck->now];
  const entry *self = now->symbol ? entry_of(now->symbol) : NULL;
  if (self == target) {
    report_self(ck, e, self);
    return;
  }
  if (self && self->in_cycle && target->in_cycle) return; /* one report a cycle */
  if (self && ck->searches++ < MOST_SEARCHES) {
    search s = search_begin(ck, false);
    reach(&s, target);
    bool cycle = search_run(&s, self);
    free(s.stack);
    if (cycle) {
      complain(ck, DIAG_CYCLE, e->name_where, "%s", chain_text(ck, self));
      for (const entry *x = self; x; x = x->reached_from)
        entry_of(&x->symbol)->in_cycle = true;
      diag_note(ck->d, target->symbol.where, "`%s` is defined here", e->name);
      if (self->symbol.kind == SYMBOL_PARAMETER)
        diag_hint(ck->d, "one of them must have a number as its default");
      else if (self->symbol.kind != SYMBOL_FUNCTION)
        diag_hint(ck->d, "one of them must be a state, whose value of the last step can be read");
      return;
    }
  }
  complain(ck, DIAG_UNDEFINED, e->name_where, "`%s` is used above its definition", e->name);
  diag_note(ck->d, target->symbol.where, "`%s` is defined here", e->name);
  diag_hint(ck->d, "move its definition up");
}

/* --- rates ------------------------------------------------------------------------------------ */

/* x = (stretch - v)/tau
   rate v = x

   In x, too, v is the state as it goes on. Upward from the last line each one hands what it belongs
   to on to the names that it reads, as bits; states beyond the 63rd share one. */
typedef struct going {
  uint64_t *rates;       /* [statements] whose rates the line belongs to */
  const symbol **owners; /* [64] the states of the bits */
  int owner_count;
} going;

static uint64_t bit_of(going *g, const symbol *state) {
  enum { LAST = 63 };
  int k = 0;
  while (k < g->owner_count && k < LAST && g->owners[k] != state)
    k++;
  if (k == g->owner_count) g->owners[g->owner_count++] = state;
  return (uint64_t)1 << k;
}

static bool has_rate(const symbol *s) {
  return s->kind == SYMBOL_STATE && s->rule && s->rule->kind == STMT_RATE;
}

static void hand_on(going *g, uint64_t rates, expr *e) {
  if (!e) return;
  const symbol *s = e->kind == EXPR_NAME ? e->symbol : NULL;
  if (s && has_rate(s)) e->goes_on = e->reads_old && (rates & bit_of(g, s));
  if (s && s->kind == SYMBOL_DEFINED && entry_of(s)->declared_at >= 0)
    g->rates[entry_of(s)->declared_at] |= rates;
  hand_on(g, rates, e->left);
  hand_on(g, rates, e->right);
  for (int k = 0; k < e->argument_count; k++)
    hand_on(g, rates, e->arguments[k].value);
  for (int k = 0; k < e->case_count; k++) {
    hand_on(g, rates, e->cases[k].value);
    hand_on(g, rates, e->cases[k].guard);
  }
}

void mark_going_on(checker *ck) {
  const symbol *owners[64];
  going g = {.owners = owners};
  g.rates = must_calloc((size_t)ck->statement_count + 1, sizeof *g.rates);
  for (int i = ck->statement_count - 1; i >= 0; i--) {
    const stmt *s = ck->statements[i];
    if (s->kind == STMT_RATE && s->symbol) g.rates[i] |= bit_of(&g, s->symbol);
    if (g.rates[i]) hand_on(&g, g.rates[i], s->value);
  }
  free(g.rates);
}

/* --- what has no effect ----------------------------------------------------------------------- */

void mark_used(checker *ck) {
  search s = search_begin(ck, true);
  for (int i = 0; i < ck->entry_count; i++) {
    entry *e = ck->entries[i];
    e->symbol.used = false;
    if (e->symbol.kind == SYMBOL_RESULT || e->symbol.kind == SYMBOL_OUTPUT) reach(&s, e);
  }
  for (int i = 0; i < RESULT_COUNT; i++)
    if (ck->law->results[i]) reach(&s, entry_of(ck->law->results[i]));
  if (ck->law->rest) reach(&s, entry_of(ck->law->rest));
  if (ck->law->failed) reach(&s, entry_of(ck->law->failed));
  search_run(&s, NULL);
  free(s.stack);
  for (int i = 0; i < ck->entry_count; i++)
    ck->entries[i]->symbol.used = ck->entries[i]->visited == s.mark;
  for (int i = 0; i < ck->law->parameters.count; i++) {
    const symbol *p = ck->law->parameters.items[i];
    if (p->component_of) entry_of(p)->symbol.used = p->component_of->used;
  }
}

static const char *kind_words(const symbol *s) {
  switch (s->kind) {
  case SYMBOL_PARAMETER:
    return symbol_is_field(s) ? "field" : "parameter";
  case SYMBOL_CONSTANT:
    return "constant";
  case SYMBOL_STATE:
    return "state";
  case SYMBOL_FUNCTION:
    return "function";
  case SYMBOL_OPTION:
    return "option";
  case SYMBOL_DEFINED:
    return "quantity";
  default:
    return NULL;
  }
}

void report_unused(checker *ck) {
  for (int i = 0; i < ck->entry_count; i++) {
    const symbol *s = &ck->entries[i]->symbol;
    if (s->used || s == ck->law->rho || (s->rule && s->rule->total)) continue;
    if (ck->reads_poisson && strcmp(s->name, "nu") == 0) continue;
    if (s->where.file != ck->tree->name_where.file)
      continue; /* a library brings more than needed */
    if (ck->entries[i]->space != SPACE_QUANTITIES && ck->entries[i]->space != SPACE_FUNCTIONS)
      continue;
    if (s->kind == SYMBOL_DAMAGE) {
      complain(ck, DIAG_UNUSED_DAMAGE, s->where, "no force and no output uses the damage `%s`",
               s->name);
      diag_hint(ck->d, "weaken a force with it, such as `(1 - %s)*...`, or remove it", s->name);
    } else if (kind_words(s)) {
      complain(ck, DIAG_UNUSED, s->where, "no force and no output uses the %s `%s`", kind_words(s),
               s->name);
    }
  }
}
