#include "generator/emit/family_segment.h"

#include <stdlib.h>

#include "generator/target/choices.h"

bool family_segment_asks(const segment *a) {
  for (int k = 0; k < a->root_count; k++)
    if (segment_asks(&a->roots[k])) return true;
  return false;
}

bool family_root_is_reduction(const segment_root *r) {
  return r->target >= TO_SUM && r->target <= TO_SMALLEST;
}

const char *family_reduction_start(const emitter *e, const segment_root *r) {
  return r->target == TO_SUM ? "0.0"
                             : spell(e, r->target == TO_LARGEST ? SAY_BELOW_ALL : SAY_ABOVE_ALL);
}

static void store_if_present(emitter *e, const segment_root *r, word store, const char *to,
                             const char *value, const char *otherwise) {
  if (segment_asks(r)) value = spell(e, SAY_CHOICE, "present", value, otherwise);
  say(e, store, "        ", to, value);
}

static void store_sum(emitter *e, const segment_root *r, const char *to, bool in_register) {
  if (segment_fuses(e->graph, r)) {
    const char *first = expression_value(e, ir_operand(e->graph, r->node, 0)),
               *second = expression_value(e, ir_operand(e->graph, r->node, 1));
    store_if_present(e, r, SAY_STORE, to, spell(e, SAY_FUSED, first, second, to), to);
    return;
  }
  const char *value = expression_value(e, r->node);
  if (in_register)
    store_if_present(e, r, SAY_STORE, to, spell(e, SAY_SUM, to, value), to);
  else
    store_if_present(e, r, SAY_ADD, to, value, "0.0");
}

void family_store(emitter *e, const segment_root *r, const char *to, bool in_register) {
  const word extreme = r->target == TO_LARGEST ? SAY_LARGER : SAY_SMALLER;
  if (segment_is_loss(r))
    say(e, SAY_ADD, "        ", to, expression_value(e, r->node));
  else if (r->target == TO_SUM)
    store_sum(e, r, to, in_register);
  else if (family_root_is_reduction(r))
    store_if_present(e, r, SAY_STORE, to, spell(e, extreme, to, expression_value(e, r->node)), to);
  else
    store_if_present(e, r, SAY_STORE, to, expression_value(e, r->node), "0.0");
}

/* --- what is expected ------------------------------------------------------------------------- */

const char *family_expected(const emitter *e) {
  const char *all = NULL;
  for (ir_node n = 0; n < e->node_count; n++) {
    bool again = !e->needed[n] || !choice_is_expected(e, n);
    const ir_node asked = again ? IR_NONE : ir_operand(e->graph, n, 0);
    for (ir_node before = 0; before < n && !again; before++)
      again = e->needed[before] && choice_is_expected(e, before) &&
              ir_operand(e->graph, before, 0) == asked;
    if (!again) all = words_join(e->memory, all, ") && (", expression_condition(e, asked));
  }
  return all;
}

unsigned char *family_narrow(emitter *e, const ir_node *nodes, int count, unsigned relies) {
  unsigned char *before = e->needed;
  e->needed = must_calloc((size_t)e->node_count + 1, 1);
  e->relies = relies;
  for (int k = 0; k < count; k++)
    if (nodes[k] != IR_NONE) e->needed[nodes[k]] = 1;
  choice_mark_operands(e, relies, e->needed);
  return before;
}

void family_widen(emitter *e, unsigned char *before) {
  free(e->needed);
  e->needed = before;
  e->relies = RELIES_ON_NOTHING;
}
