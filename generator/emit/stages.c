#include "generator/emit/stages.h"

#include <stdlib.h>
#include <string.h>

/* --- lines and results ------------------------------------------------------------------------ */

bool stages_is_loaded(const emitter *e, ir_node n) {
  return expression_is_input(e, n) && !expression_is_of_time(e, n);
}

static bool is_damage(const emitter *e, int field) {
  return e->plan->law->fields.items[field]->kind == SYMBOL_DAMAGE;
}

bool stages_is_of_change(const emitter *e, const segment_root *r) {
  if (r->target == TO_FIELD) return is_damage(e, r->index);
  if (r->target != TO_DISSIPATED_STATE || !e->plan->law->fields.count) return false;
  for (int f = 0; f < e->plan->law->fields.count; f++)
    if (!is_damage(e, f)) return false;
  return true;
}

bool stages_in_result_array(const segment_root *r) {
  return r->target == TO_FORCE || r->target == TO_OBSERVED;
}

bool stages_give(const emitter *e, const stages *s, int stage, const segment_root *r) {
  if (stage < stages_last(s)) return false;
  if (!s->changes) return true;
  if (stage > stages_last(s)) return stages_is_of_change(e, r);
  return r->target == TO_FIELD || !stages_is_of_change(e, r);
}

int stages_operands(const emitter *e, const stages *s, ir_node n, unsigned relies,
                    ir_node operand[3]) {
  const int count = choice_operands(e, n, relies, operand);
  const bool answered =
      (relies & RELIES_ON_EXPECTED) && choice_is_expected(e, n) && !stages_ask(e, s, n);
  return answered ? 1 : count;
}

/* --- one loop --------------------------------------------------------------------------------- */

bool stages_ask_for_protection(const emitter *e, const stages *s, int stage) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (s->of[n] == stage && choice_is_by_protection(e, n)) return true;
  return false;
}

bool stages_store(const stages *s, ir_node n, int stage) {
  const bool result = stage == stages_last(s) && s->buffer[n] < s->result_arrays;
  return s->of[n] == stage && s->buffer[n] >= 0 && !result;
}

bool stages_ask(const emitter *e, const stages *s, ir_node n) {
  if (!choice_is_expected(e, n)) return false;
  for (ir_node k = 0; k < e->node_count; k++) {
    const bool before = s->of[k] >= 0 && (s->of[k] < s->of[n] || (s->of[k] == s->of[n] && k < n));
    if (before && choice_is_expected(e, k) &&
        ir_operand(e->graph, k, 0) == ir_operand(e->graph, n, 0))
      return false;
  }
  return true;
}

void stages_mark_kept(const emitter *e, const stages *s, unsigned char *mask) {
  for (ir_node n = 0; n < e->node_count; n++)
    mask[n] = s->buffer[n] >= 0 && s->of[n] < stages_last(s) && s->until[n] >= stages_last(s);
}

/* What the stage hands on: its lines, or what the pass gives. */
static void mark_results(const emitter *e, const stages *s, int stage, unsigned char *mask) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (s->of[n] == stage) mask[n] = 1;
  for (int k = 0; k < e->root_count; k++)
    if (stages_give(e, s, stage, &e->roots[k])) mask[e->roots[k].node] = 1;
}

void stages_mark(const emitter *e, const stages *s, int stage, unsigned relies, unsigned char *mask,
                 unsigned char *kept_loads) {
  memset(mask, 0, (size_t)e->node_count + 1);
  memset(kept_loads, 0, (size_t)e->node_count + 1);
  mark_results(e, s, stage, mask);
  for (ir_node n = e->node_count - 1; n >= 0; n--) {
    if (!mask[n]) continue;
    /* what only the unexpected needs is not kept for it: it is computed again */
    if (stages_take(s, n, stage) && (relies != RELIES_ON_NOTHING || s->until[n] >= stage)) {
      kept_loads[n] = 1;
      mask[n] = 0;
      continue;
    }
    ir_node operand[3];
    const int count = stages_operands(e, s, n, relies, operand);
    for (int k = 0; k < count; k++)
      mask[operand[k]] = 1;
  }
}

void stages_free(stages *s) {
  if (!s) return;
  free(s->of);
  free(s->buffer);
  free(s->until);
  free(s->result);
  free(s->cost);
  free(s);
}
