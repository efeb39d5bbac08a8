#include "generator/plan/seldom.h"

#include <stdlib.h>

#include "generator/plan/plan_roots.h"

/* What a chain of cases gives where nothing grows, and where that is; IR_NONE: nowhere. */
typedef struct still {
  ir_node where, value;
} still;

enum { MOST_CUTS = 16 };
typedef struct finder {
  ir *graph;
  int count;             /* nodes before any is made here */
  unsigned char *seen;   /* [count] */
  ir_node of[MOST_CUTS]; /* [cuts] chains that are dear only where something grows */
  still at[MOST_CUTS];
  int cuts;
} finder;

/* --- what it costs ---------------------------------------------------------------------------- */

/* In operations; of what the nodes need and that differs from place to place. */
static int price_of(const ir *g, const ir_node *nodes, int count) {
  enum { OF_DIVISION = 8 };
  unsigned char *needed = must_calloc((size_t)ir_count(g) + 1, 1);
  int sum = 0;
  ir_mark(g, nodes, count, needed);
  for (ir_node n = 0; n < ir_count(g); n++) {
    if (!needed[n] || ir_is_uniform(g, n)) continue;
    const operation_price p = operations[ir_operation(g, n)].price;
    sum += p.operations + OF_DIVISION * p.divisions;
  }
  free(needed);
  return sum;
}

/* --- where nothing grows ---------------------------------------------------------------------- */

/* A number, or what a field was. */
static bool stays(const ir *g, ir_node n) {
  return ir_is_uniform(g, n) ||
         (ir_operation(g, n) == IR_INPUT && ir_input_source(g, n) == IR_FROM_FIELD);
}

/* Whether what is held there asks: that is rare. */
static bool asks_what_is_held(const ir *g, ir_node n) {
  unsigned char *needed = must_calloc((size_t)n + 1, 1);
  bool does = false;
  ir_mark(g, &n, 1, needed);
  for (ir_node m = 0; m <= n && !does; m++) {
    if (!needed[m] || ir_operation(g, m) != IR_INPUT || ir_input_source(g, m) != IR_FROM_ENDS)
      continue;
    const ends_array from = ends_origins[ir_input_index(g, m)].array;
    does = from == FROM_FLAGS || from == FROM_HELD;
  }
  free(needed);
  return does;
}

/* A condition that holds only where n does not; of what is no number it may not hold either.
   IR_NONE: not found. */
static ir_node opposite(ir *g, ir_node n) {
  const ir_op op = ir_operation(g, n);
  if (op == IR_NOT) return ir_operand(g, n, 0);
  if (op != IR_LT && op != IR_LE && op != IR_AND && op != IR_OR) return IR_NONE;
  const ir_node a = ir_operand(g, n, 0), b = ir_operand(g, n, 1);
  if (op == IR_LT) return ir_binary(g, IR_LE, b, a);
  if (op == IR_LE) return ir_binary(g, IR_LT, b, a);
  const ir_node first = opposite(g, a), second = opposite(g, b);
  if (first == IR_NONE || second == IR_NONE) return IR_NONE;
  return ir_binary(g, op == IR_AND ? IR_OR : IR_AND, first, second);
}

static still still_of(finder *f, ir_node n) {
  ir *g = f->graph;
  const still nowhere = {IR_NONE, IR_NONE};
  if (stays(g, n)) return (still){ir_constant(g, 1), n};
  if (ir_operation(g, n) != IR_SELECT || asks_what_is_held(g, ir_operand(g, n, 0))) return nowhere;
  const ir_node asked = ir_operand(g, n, 0);
  const still yes = still_of(f, ir_operand(g, n, 1)), no = still_of(f, ir_operand(g, n, 2));
  const ir_node otherwise = no.where == IR_NONE ? IR_NONE : opposite(g, asked);
  const ir_node first = yes.where == IR_NONE ? IR_NONE : ir_binary(g, IR_AND, asked, yes.where);
  const ir_node second = otherwise == IR_NONE ? IR_NONE : ir_binary(g, IR_AND, otherwise, no.where);
  if (first == IR_NONE && second == IR_NONE) return nowhere;
  if (second == IR_NONE) return (still){first, yes.value};
  if (first == IR_NONE) return (still){second, no.value};
  const ir_node where = ir_binary(g, IR_OR, first, second);
  return (still){where, ir_select(g, asked, yes.value, no.value)};
}

/* Whether a chain costs more than to find out that nothing grows: by a function at least. */
static bool saves(const ir *g, ir_node n, still s) {
  enum { A_FUNCTION = 25 };
  const ir_node all[] = {n, s.where, s.value};
  return s.where != IR_NONE && price_of(g, all, 3) - price_of(g, all + 1, 2) >= A_FUNCTION;
}

/* The longest chains under a node. */
static void find_chains(finder *f, ir_node n) {
  if (f->seen[n] || ir_is_uniform(f->graph, n)) return;
  f->seen[n] = 1;
  const still s = still_of(f, n);
  if (saves(f->graph, n, s) && f->cuts < MOST_CUTS) {
    f->of[f->cuts] = n;
    f->at[f->cuts++] = s;
    return;
  }
  for (int k = 0; k < ir_arity(ir_operation(f->graph, n)); k++)
    find_chains(f, ir_operand(f->graph, n, k));
}

/* --- a segment -------------------------------------------------------------------------------- */

/* Nowhere does any of the chains grow. */
static ir_node all_still(finder *f) {
  ir_node all = f->at[0].where;
  for (int k = 1; k < f->cuts; k++)
    all = ir_binary(f->graph, IR_AND, all, f->at[k].where);
  return all;
}

/* Where that is expected, what is left out is at least this part of the segment: else looking for
   it costs as much. */
static bool is_worth_it(finder *f, const ir_node *values, int count, ir_node all) {
  static const double PART = 1.0 / 6;
  ir_node *rest = must_alloc(((size_t)count + 1) * sizeof *rest), cheap[MOST_CUTS];
  for (int k = 0; k < f->cuts; k++)
    cheap[k] = f->at[k].value;
  ir_substitute(f->graph, values, count, f->of, cheap, f->cuts, rest);
  rest[count] = all;
  const int before = price_of(f->graph, values, count), left = price_of(f->graph, rest, count + 1);
  free(rest);
  return before - left >= PART * before;
}

/* Either; a chain that begins with that very case is it already. */
static ir_node chosen_where(ir *g, ir_node all, ir_node value, ir_node chain) {
  const bool begins = ir_operand(g, chain, 0) == all && ir_operand(g, chain, 1) == value;
  return begins ? chain : ir_select(g, all, value, chain);
}

static void expect_nothing_grows(finder *f, ir_node *values, int count) {
  ir *g = f->graph;
  const ir_node all = f->cuts ? all_still(f) : IR_NONE;
  ir_node chosen[MOST_CUTS];
  if (all == IR_NONE || ir_operation(g, all) == IR_CONSTANT || !is_worth_it(f, values, count, all))
    return;
  ir_expect_any(g, all);
  for (int k = 0; k < f->cuts; k++)
    chosen[k] = chosen_where(g, all, f->at[k].value, f->of[k]);
  ir_substitute(g, values, count, f->of, chosen, f->cuts, values);
}

static void look_at_segment(ir *g, segment *a) {
  finder f = {.graph = g, .count = ir_count(g)};
  ir_node *values = segment_values(a);
  f.seen = must_calloc((size_t)f.count + 1, 1);
  for (int k = 0; k < a->root_count; k++)
    if (a->roots[k].target == TO_FIELD) find_chains(&f, a->roots[k].node);
  expect_nothing_grows(&f, values, segment_value_count(a));
  segment_replace(a, values);
  free(f.seen);
  free(values);
}

void plan_seldom(kernel_plan *p) {
  const bool families = plan_is_of_families(p);
  if (p->form == FORM_TIPS || p->variation.everywhere) return;
  for (int task = PROGRAM_STEP; task <= (families ? PROGRAM_STEP : PROGRAM_LEDGER); task++)
    for (int k = 0; k < p->programs[task].pass_count; k++)
      for (int s = 0; s < p->programs[task].passes[k].segment_count; s++) {
        segment *a = &p->programs[task].passes[k].segments[s];
        if (!families || a->kind == OVER_PARTICLES || a->kind == OVER_PAIRS)
          look_at_segment(p->graph, a);
      }
}
