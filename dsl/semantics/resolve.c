#include "dsl/semantics/resolve.h"

#include <string.h>

typedef struct resolver {
  arena *memory;
  const law_choice *choices;
  int count;
} resolver;

typedef enum truth { UNDECIDED, NEVER, ALWAYS } truth;

static const char *choice_of(const resolver *r, const expr *e) {
  const symbol *s = e->kind == EXPR_NAME ? e->symbol : NULL;
  for (int k = 0; s && s->kind == SYMBOL_OPTION && k < r->count; k++)
    if (strcmp(r->choices[k].option, s->name) == 0) return r->choices[k].choice;
  return NULL;
}

/* Of `option == choice` or `option /= choice`, either way round. */
static truth decide_comparison(const resolver *r, const expr *e) {
  const char *chosen = choice_of(r, e->left);
  const expr *other = chosen ? e->right : e->left;
  if (!chosen) chosen = choice_of(r, e->right);
  if (!chosen || other->kind != EXPR_NAME) return UNDECIDED;
  const bool same = strcmp(chosen, other->name) == 0;
  return same == (e->binary == OP_EQ) ? ALWAYS : NEVER;
}

static truth decide(const resolver *r, const expr *e) {
  if (e->kind == EXPR_UNARY && e->unary == OP_NOT) {
    const truth inner = decide(r, e->left);
    return inner == UNDECIDED ? UNDECIDED : inner == ALWAYS ? NEVER : ALWAYS;
  }
  if (e->kind != EXPR_BINARY) return UNDECIDED;
  if (e->binary == OP_EQ || e->binary == OP_NE) return decide_comparison(r, e);
  if (e->binary != OP_AND && e->binary != OP_OR) return UNDECIDED;
  const truth left = decide(r, e->left), right = decide(r, e->right);
  const truth settles = e->binary == OP_AND ? NEVER : ALWAYS;
  if (left == settles || right == settles) return settles;
  return left == UNDECIDED || right == UNDECIDED ? UNDECIDED : left;
}

static const expr *resolve(const resolver *r, const expr *e);

/* A part of the tree, which copies share. */
static expr *part(const resolver *r, const expr *e) {
  return e ? (expr *)(uintptr_t)resolve(r, e) : NULL;
}

static expr *copy_of(const resolver *r, const expr *e) {
  expr *copy = arena_alloc(r->memory, sizeof *copy);
  *copy = *e;
  return copy;
}

static const expr *resolve_cases(const resolver *r, const expr *e) {
  expr *copy = copy_of(r, e);
  copy->cases = arena_alloc(r->memory, (size_t)e->case_count * sizeof *copy->cases);
  copy->case_count = 0;
  for (int k = 0; k < e->case_count; k++) {
    const truth chosen = e->cases[k].guard ? decide(r, e->cases[k].guard) : ALWAYS;
    if (chosen == NEVER) continue;
    case_line *line = &copy->cases[copy->case_count++];
    *line = e->cases[k];
    line->value = part(r, line->value);
    line->guard = chosen == ALWAYS ? NULL : part(r, line->guard);
    if (chosen == ALWAYS) break;
  }
  return copy->case_count == 1 ? copy->cases[0].value : copy;
}

static const expr *resolve_binary(const resolver *r, const expr *e) {
  const bool joins = e->binary == OP_AND || e->binary == OP_OR;
  if (joins && decide(r, e->left) != UNDECIDED) return resolve(r, e->right);
  if (joins && decide(r, e->right) != UNDECIDED) return resolve(r, e->left);
  expr *copy = copy_of(r, e);
  copy->left = part(r, e->left);
  copy->right = part(r, e->right);
  return copy;
}

static const expr *resolve(const resolver *r, const expr *e) {
  expr *copy;
  switch (e->kind) {
  case EXPR_CASES:
    return resolve_cases(r, e);
  case EXPR_BINARY:
    return resolve_binary(r, e);
  case EXPR_UNARY:
    copy = copy_of(r, e);
    copy->left = part(r, e->left);
    return copy;
  case EXPR_CALL:
    copy = copy_of(r, e);
    copy->arguments = arena_alloc(r->memory, (size_t)e->argument_count * sizeof *copy->arguments);
    for (int k = 0; k < e->argument_count; k++) {
      copy->arguments[k] = e->arguments[k];
      copy->arguments[k].value = part(r, e->arguments[k].value);
    }
    return copy;
  default:
    return e;
  }
}

const expr *resolve_options(const law *l, const expr *e, const law_choice *choices, int count) {
  const resolver r = {l->memory, choices, count};
  return count && e ? resolve(&r, e) : e;
}
