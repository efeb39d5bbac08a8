#include "generator/plan/program_absent.h"

#include "generator/plan/node_map.h"
#include "generator/plan/program_facts.h"

typedef struct absent_search {
  const ir *g;
  kernel_program *program;
  node_map *finite, *zero; /* [passes] of nodes as the pass sees them */
} absent_search;

static bool is_shared(const ir *g, ir_node n) {
  return ir_operation(g, n) == IR_INPUT &&
         (ir_input_source(g, n) == IR_FROM_SHARED || ir_input_source(g, n) == IR_FROM_SHARED_ODD);
}

static bool is_finite(absent_search *s, int pass, ir_node n);

static bool is_finite_slot(absent_search *s, int pass, int slot) {
  const program_pass *p = &s->program->passes[pass];
  for (int k = 0; k < p->segment_count; k++)
    for (int r = 0; r < p->segments[k].root_count; r++) {
      const segment_root *root = &p->segments[k].roots[r];
      if ((root->target == TO_SLOT || root->target == TO_SUM) && root->index == slot)
        return is_finite(s, pass, root->node);
    }
  return false;
}

/* Fields, shapes and what follows from them may be anything where no particle is. */
static bool is_finite_input(absent_search *s, int pass, ir_node n) {
  const int index = ir_input_index(s->g, n);
  switch (ir_input_source(s->g, n)) {
  case IR_FROM_ENDS:
  case IR_FROM_BOND_PARAMETER:
  case IR_FROM_PARTICLE_PARAMETER:
  case IR_FROM_NEIGHBOUR_PARAMETER:
  case IR_FROM_SHARED:
  case IR_FROM_SHARED_ODD:
    return true;
  case IR_FROM_SLOT:
    return is_finite_slot(s, pass, index);
  case IR_FROM_LINK:
  case IR_FROM_NEIGHBOUR_LINK: {
    const segment_root *root = program_writer(s->program, IR_FROM_LINK, index, &pass);
    return root && is_finite(s, pass, root->node);
  }
  default:
    return false;
  }
}

static bool keeps_finite(ir_op op) {
  return op == IR_SELECT || (operation_has(op, ARITHMETIC) && !operation_has(op, PARTIAL));
}

static bool is_finite(absent_search *s, int pass, ir_node n) {
  const ir_op op = ir_operation(s->g, n);
  const int known = map_get(&s->finite[pass], n);
  if (known >= 0) return known != 0;
  bool finite = ir_is_uniform(s->g, n);
  if (!finite && op == IR_INPUT)
    finite = is_finite_input(s, pass, n);
  else if (!finite && keeps_finite(op)) {
    finite = true;
    for (int k = op == IR_SELECT; k < ir_arity(op) && finite; k++)
      finite = is_finite(s, pass, ir_operand(s->g, n, k));
  }
  map_set(&s->finite[pass], n, finite);
  return finite;
}

/* Whether the value is 0 where the bond is absent, if shared values are. */
static bool is_zero(absent_search *s, int pass, ir_node n) {
  const ir_op op = ir_operation(s->g, n);
  const int known = map_get(&s->zero[pass], n);
  if (known >= 0) return known != 0;
  bool zero = is_shared(s->g, n);
  if (op == IR_MUL) {
    const ir_node a = ir_operand(s->g, n, 0), b = ir_operand(s->g, n, 1);
    zero = (is_zero(s, pass, a) && is_finite(s, pass, b)) ||
           (is_zero(s, pass, b) && is_finite(s, pass, a));
  } else if (op == IR_NEG || op == IR_ADD || op == IR_SUB) {
    zero = is_zero(s, pass, ir_operand(s->g, n, 0)) &&
           (op == IR_NEG || is_zero(s, pass, ir_operand(s->g, n, 1)));
  }
  map_set(&s->zero[pass], n, zero);
  return zero;
}

/* Owners leave 0 of what the nodes read, unless it is 0 since what it follows from is. */
static void leave_zeros(absent_search *s, int pass, ir_node n) {
  unsigned char *needed = must_calloc((size_t)ir_count(s->g) + 1, 1);
  ir_mark(s->g, &n, 1, needed);
  for (ir_node m = 0; m <= n; m++) {
    int writer = pass;
    if (!needed[m] || !is_shared(s->g, m)) continue;
    segment_root *root =
        program_writer(s->program, IR_FROM_SHARED, ir_input_index(s->g, m), &writer);
    if (is_zero(s, writer, root->node))
      leave_zeros(s, writer, root->node);
    else
      root->vanishes = true;
  }
  free(needed);
}

/* All or nothing: a loop that asks for one value may do so for all. */
static void look_at_segment(absent_search *s, int pass, segment *a) {
  bool all = a->kind == OVER_NEIGHBOURS;
  for (int k = 0; k < a->root_count && all; k++)
    all = a->roots[k].target == TO_SUM ? is_zero(s, pass, a->roots[k].node)
                                       : !segment_asks(&a->roots[k]);
  for (int k = 0; k < a->root_count && all; k++) {
    if (a->roots[k].target != TO_SUM) continue;
    a->roots[k].vanishes = true;
    leave_zeros(s, pass, a->roots[k].node);
  }
}

void program_find_vanishing(const ir *g, kernel_program *p) {
  absent_search s = {.g = g,
                     .program = p,
                     .finite = must_calloc((size_t)p->pass_count, sizeof *s.finite),
                     .zero = must_calloc((size_t)p->pass_count, sizeof *s.zero)};
  for (int pass = 0; pass < p->pass_count; pass++)
    for (int k = 0; k < p->passes[pass].segment_count; k++)
      look_at_segment(&s, pass, &p->passes[pass].segments[k]);
  for (int pass = 0; pass < p->pass_count; pass++) {
    map_clear(&s.finite[pass]);
    map_clear(&s.zero[pass]);
  }
  free(s.finite);
  free(s.zero);
}
