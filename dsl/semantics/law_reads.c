#include "dsl/semantics/law_reads.h"

#include "dsl/semantics/decided.h"

/* With a law, case lines that are never chosen do not count. */
static void find(const law *l, const expr *e, bool *read) {
  if (!e) return;
  if (e->symbol && e->kind == EXPR_NAME && e->symbol->kind == SYMBOL_QUANTITY)
    read[e->symbol->index] = true;
  if (e->symbol && e->kind == EXPR_CALL) find(l, e->symbol->declared->value, read);
  find(l, e->left, read);
  find(l, e->right, read);
  for (int i = 0; i < e->argument_count; i++)
    find(l, e->arguments[i].value, read);
  for (int i = 0; i < e->case_count; i++) {
    const expr *guard = e->cases[i].guard;
    const bool decided = l && guard && decided_early(guard);
    if (decided && !decided_to_hold(l, guard)) continue;
    find(l, guard, read);
    find(l, e->cases[i].value, read);
    if (decided) break;
  }
}

void quantities_read(const expr *e, bool read[QUANTITY_COUNT]) {
  find(NULL, e, read);
}

bool law_reads(const law *l, builtin_quantity q) {
  bool read[QUANTITY_COUNT] = {false};
  for (int k = 0; k < l->rule_count; k++) {
    find(l, l->rules[k]->value, read);
    find(l, l->rules[k]->when, read);
  }
  return read[q];
}
