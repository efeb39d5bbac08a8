#include "dsl/semantics/law_reads.h"

#include "dsl/semantics/decided.h"

typedef struct found {
  bool quantity[QUANTITY_COUNT], function[FUNCTION_COUNT];
} found;

/* With a law, case lines that are never chosen do not count. */
static void find(const law *l, const expr *e, found *read) {
  if (!e) return;
  if (e->symbol && e->kind == EXPR_NAME && e->symbol->kind == SYMBOL_QUANTITY)
    read->quantity[e->symbol->index] = true;
  if (e->symbol && e->kind == EXPR_CALL) find(l, e->symbol->declared->value, read);
  if (!e->symbol && e->kind == EXPR_CALL && e->builtin >= 0) read->function[e->builtin] = true;
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
  found all = {{false}, {false}};
  find(NULL, e, &all);
  for (int q = 0; q < QUANTITY_COUNT; q++)
    read[q] = read[q] || all.quantity[q];
}

static found find_all(const law *l) {
  found all = {{false}, {false}};
  for (int k = 0; k < l->rule_count; k++) {
    find(l, l->rules[k]->value, &all);
    find(l, l->rules[k]->when, &all);
  }
  return all;
}

bool law_reads(const law *l, builtin_quantity q) {
  return find_all(l).quantity[q];
}

bool law_reads_time(const law *l) {
  for (int k = 0; k < l->rule_count; k++)
    if (l->rules[k]->kind == STMT_RATE) return true;
  return law_reads(l, QUANTITY_DT);
}

bool law_calls(const law *l, builtin_function f) {
  return find_all(l).function[f];
}
