#include "dsl/semantics/decided.h"

#include <string.h>

static bool is_option(const expr *e) {
  return e->kind == EXPR_NAME && e->symbol && e->symbol->kind == SYMBOL_OPTION;
}

/* `option == choice` or `option /= choice`, either way round. */
static bool compares_option(const expr *e) {
  return (e->binary == OP_EQ || e->binary == OP_NE) && (is_option(e->left) || is_option(e->right));
}

bool decided_early(const expr *e) {
  if (e->kind == EXPR_NAME)
    return e->symbol && e->symbol->kind == SYMBOL_CHOICE && !e->symbol->option;
  if (e->kind == EXPR_UNARY) return e->unary == OP_NOT && decided_early(e->left);
  if (e->kind != EXPR_BINARY) return false;
  if (e->binary == OP_AND || e->binary == OP_OR)
    return decided_early(e->left) && decided_early(e->right);
  return compares_option(e);
}

static bool option_holds(const law *l, const expr *e) {
  const expr *option = is_option(e->left) ? e->left : e->right;
  const expr *choice = option == e->left ? e->right : e->left;
  const bool same = strcmp(l->chosen[option->symbol->index], choice->name) == 0;
  return same == (e->binary == OP_EQ);
}

static bool lattice_holds(const law *l, const char *word) {
  if (strcmp(word, LAW_IRREGULAR) == 0) return l->irregular;
  return strcmp(word, law_setting_name(l->setting)) == 0;
}

bool decided_to_hold(const law *l, const expr *e) {
  if (e->kind == EXPR_NAME) return lattice_holds(l, e->name);
  if (e->kind == EXPR_UNARY) return !decided_to_hold(l, e->left);
  if (e->binary == OP_AND) return decided_to_hold(l, e->left) && decided_to_hold(l, e->right);
  if (e->binary == OP_OR) return decided_to_hold(l, e->left) || decided_to_hold(l, e->right);
  return option_holds(l, e);
}
