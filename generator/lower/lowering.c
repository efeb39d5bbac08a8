#include "generator/lower/lowering.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/hash.h"
#include "generator/lower/lower_inputs.h"

ir_node lower_fail(lowering *c, span where, const char *what) {
  if (!c->failed) diag_report(c->said, DIAG_NOT_SUPPORTED, where, "%s", what);
  c->failed = true;
  return ir_constant(c->graph, 0);
}

components lower_failed_value(lowering *c, span where, const char *what) {
  return scalar(lower_fail(c, where, what));
}

bool lower_is_state_law(const lowering *c) {
  return c->law->tree->law == LAW_STATE;
}

law_setting lower_hooke_setting(const lowering *c) {
  return c->law->tree->law == LAW_CONTINUUM ? SETTING_SPACE : c->law->setting;
}

/* --- names ------------------------------------------------------------------------------------ */

/* Where the symbol is bound, or would be. */
static binding *place_of(const lowering *c, const symbol *s) {
  size_t k = (size_t)hash_more(HASH_START, &s, sizeof s) & (c->bound_room - 1);
  while (c->bound[k].symbol && c->bound[k].symbol != s)
    k = (k + 1) & (c->bound_room - 1);
  return &c->bound[k];
}

ir_node lower_own_parameter(const lowering *c, int k) {
  const law_variation *v = c->variation;
  for (int n = 0; n < v->varying_count; n++)
    if (v->varying[n] == k) return lower_varying(c->graph, c->law, v, n);
  return lower_parameter(c->graph, c->law, k);
}

components *lower_binding_of(const lowering *c, const symbol *s) {
  binding *found = c->bound_room ? place_of(c, s) : NULL;
  return found && found->symbol ? &found->value : NULL;
}

static void grow_bindings(lowering *c) {
  binding *before = c->bound;
  const size_t room = c->bound_room;
  c->bound_room = room ? 2 * room : 64;
  c->bound = must_calloc(c->bound_room, sizeof *c->bound);
  for (size_t k = 0; k < room; k++)
    if (before[k].symbol) *place_of(c, before[k].symbol) = before[k];
  free(before);
}

void lower_bind(lowering *c, const symbol *s, components value) {
  if (2 * (c->bound_count + 1) > c->bound_room) grow_bindings(c);
  binding *bound = place_of(c, s);
  c->bound_count += bound->symbol == NULL;
  *bound = (binding){s, value};
}

void lower_name_node(ir *g, ir_node n, const char *name, span where) {
  if (n != IR_NONE && ir_arity(ir_operation(g, n)) > 0) ir_set_name(g, n, name, where);
}

void lower_name_value(lowering *c, components value, const char *name, span where) {
  static const char *const parts[] = {"xx", "yy", "zz", "xy", "yz", "xz", "yx", "zy", "zx"};
  static const char *const axes[] = {"x", "y", "z"};
  for (int k = 0; k < value.count; k++) {
    const char *part = value.count == 3 ? axes[k] : parts[k];
    const char *full = value.count == 1 ? name : arena_printf(c->memory, "%s_%s", name, part);
    lower_name_node(c->graph, value.of[k], full, where);
  }
}

/* --- what became of the text ------------------------------------------------------------------ */

/* Room for one more of `count` items. */
static void *one_more(void *items, int count, size_t size) {
  bool full = count == 0 || (count >= 16 && (count & (count - 1)) == 0);
  return full ? must_realloc(items, (size_t)(count ? 2 * count : 16) * size) : items;
}

void lower_note_place(lowering *c, ir_node n, const expr *e) {
  if (c->mode != LOWER_STEP || c->failed || n == IR_NONE) return;
  if (!operation_has(ir_operation(c->graph, n), PARTIAL)) return;
  lowered_text *t = &c->text;
  for (int k = 0; k < t->place_count; k++)
    if (t->places[k].node == n) return;
  t->places = one_more(t->places, t->place_count, sizeof *t->places);
  t->places[t->place_count++] = (lowered_place){n, e->where, e};
}

void lower_note_line(lowering *c, const expr *cases, int line, ir_node guard) {
  if (c->mode != LOWER_STEP) return;
  lowered_text *t = &c->text;
  t->lines = one_more(t->lines, t->line_count, sizeof *t->lines);
  t->lines[t->line_count++] = (lowered_line){cases, line, c->group_count, guard};
}
void lower_note_flow(lowering *c, const stmt *rule, ir_node when, ir_node overstress) {
  lowered_text *t = &c->text;
  t->flows = one_more(t->flows, t->flow_count, sizeof *t->flows);
  t->flows[t->flow_count++] = (lowered_flow){.rule = rule,
                                             .field = rule->symbol->index,
                                             .when = when,
                                             .overstress = overstress,
                                             .slope = IR_NONE,
                                             .slope_after = IR_NONE};
}
