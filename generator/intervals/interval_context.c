#include "generator/intervals/interval_context.h"

#include "dsl/base/arena.h"

context *context_new(analysis *a, context *outer, ir_node guard, bool truth) {
  context *c = arena_alloc(a->memory, sizeof *c);
  c->outer = outer;
  c->guard = guard;
  c->truth = truth;
  c->known = arena_alloc(a->memory, (size_t)a->nodes * sizeof *c->known);
  c->state = arena_alloc(a->memory, (size_t)a->nodes);
  a->contexts++;
  return c;
}

bool sum_unbend(const ir *g, const sum *s, int k, sum *with_first, sum *with_second) {
  const sum_term *t = &s->term[k];
  ir_node n = t->count == 1 ? t->factor[0] : IR_NONE;
  ir_op op = n == IR_NONE ? IR_CONSTANT : ir_operation(g, n);
  if (op != IR_MAX && op != IR_MIN && op != IR_ABS) return false;
  sum p = sum_of(g, ir_operand(g, n, 0)), q, none = {0};
  if (op == IR_ABS)
    sum_combine(&none, -1, &p, &q);
  else
    q = sum_of(g, ir_operand(g, n, 1));
  return sum_replace(s, k, &p, with_first) && sum_replace(s, k, &q, with_second);
}

bool sum_term_is_least(const ir *g, const sum_term *t) {
  return (ir_operation(g, t->factor[0]) == IR_MIN) == (t->coefficient > 0);
}

void context_add_relation(const ir *g, context *c, relation_kind kind, const sum *of) {
  if (c->relation_count == MOST_RELATIONS || of->count == 0) return;
  c->relations[c->relation_count++] = (relation){kind, *of};
  for (int k = 0; k < of->count && kind != NOT_ZERO; k++) {
    sum p, q;
    if (!sum_unbend(g, of, k, &p, &q) || !sum_term_is_least(g, &of->term[k])) continue;
    context_add_relation(g, c, kind, &p);
    context_add_relation(g, c, kind, &q);
    return;
  }
}

void context_relate(analysis *a, context *c, relation_kind kind, ir_node less, ir_node more) {
  sum p = sum_of(a->graph, more), q = sum_of(a->graph, less), difference;
  if (sum_combine(&p, -1, &q, &difference)) context_add_relation(a->graph, c, kind, &difference);
}
