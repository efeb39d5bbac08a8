#include "generator/plan/program_share.h"

#include <stdlib.h>

#include "generator/plan/program_mirror.h"
#include "generator/plan/program_parity.h"

/* Whether a value follows from motion, fields and parameters alone, without what goes over a family
   or was left by a pass. */
static bool is_plain(builder *b, ir_node n) {
  int known = map_get(&b->plain, n);
  if (known >= 0) return known != 0;
  const ir_op op = ir_operation(b->g, n);
  bool plain = !ir_is_reduction(op);
  if (op == IR_INPUT) {
    const ir_source from = ir_input_source(b->g, n);
    plain = from == IR_FROM_FIELD || from == IR_FROM_NEIGHBOUR_FIELD || from == IR_FROM_ENDS ||
            ir_is_parameter(from) || ir_is_uniform(b->g, n);
  }
  for (int k = 0; k < ir_arity(op) && plain; k++)
    plain = is_plain(b, ir_operand(b->g, n, k));
  map_set(&b->plain, n, plain);
  return plain;
}

/* Operations that have not been counted since `round` began. */
static int cost_in_round(builder *b, ir_node n, int most) {
  if (map_get(&b->counted, n) == b->round) return 0;
  map_set(&b->counted, n, b->round);
  for (int k = 0; k < b->shared_count; k++)
    if (b->shared[k] == n) return 0;
  if (is_leaf(b->g, n) || ir_is_uniform(b->g, n) || is_of_one_particle(b->g, n)) return 0;
  int cost = operations[ir_operation(b->g, n)].weight;
  for (int k = 0; k < ir_arity(ir_operation(b->g, n)) && cost < most; k++)
    cost += cost_in_round(b, ir_operand(b->g, n, k), most - cost);
  return cost;
}

/* What a value toward a neighbour costs beyond the shared values found so far, in additions. */
static int cost_beyond(builder *b, ir_node n, int most) {
  b->round++;
  return cost_in_round(b, n, most);
}

/* What a value must cost to be shared: a store and two loads for each bond, or, where planes do not
   stay in a cache, more. */
static int dear(const builder *b) {
  return b->sharing >= SHARE_MORE ? 12 : 25;
}

static bool is_worth_sharing(builder *b, ir_node n) {
  if (is_leaf(b->g, n) || ir_is_uniform(b->g, n) || is_of_one_particle(b->g, n) ||
      !is_plain(b, n) || ir_is_logical(b->g, n) || cost_beyond(b, n, dear(b)) < dear(b))
    return false;
  const int parity = program_parity(b, n);
  return parity == 1 || (parity == -1 && b->sharing >= SHARE_MORE);
}

/* Whether little is left to do for a value when the part is shared. */
static bool costs_nearly_all(builder *b, ir_node part, ir_node n) {
  const int cheap = b->sharing == SHARE_MOST ? 2 : b->sharing == SHARE_MORE ? 3 : 6;
  b->shared[b->shared_count++] = part;
  const bool does = cost_beyond(b, n, cheap + 1) <= cheap;
  b->shared_count--;
  return does;
}

/* The part of a value that costs nearly all and serves others, too: it is shared in its place. */
static ir_node dear_part(builder *b, ir_node n) {
  for (int k = 0; k < ir_arity(ir_operation(b->g, n)); k++) {
    const ir_node part = ir_operand(b->g, n, k);
    if (map_get(&b->users, part) > 1 && is_worth_sharing(b, part) && costs_nearly_all(b, part, n))
      return dear_part(b, part);
  }
  return n;
}

typedef struct node_list {
  ir_node *items;
  int count;
} node_list;

/* The largest values that the ends could share. */
static void find_shareable(builder *b, ir_node n, node_map *seen, node_list *found) {
  if (map_get(seen, n) >= 0) return;
  map_set(seen, n, 1);
  if (is_worth_sharing(b, n) && found->count < MOST_LINKS) {
    found->items[found->count++] = n;
    return;
  }
  for (int k = 0; k < ir_arity(ir_operation(b->g, n)); k++)
    find_shareable(b, ir_operand(b->g, n, k), seen, found);
}

static int by_number(const void *a, const void *b) {
  const ir_node x = *(const ir_node *)a, y = *(const ir_node *)b;
  return (x > y) - (x < y);
}

/* How many nodes and roots read each node. */
static void count_users(builder *b, ir_node n) {
  const int before = map_get(&b->users, n);
  map_set(&b->users, n, before < 0 ? 1 : before + 1);
  if (before > 0) return;
  for (int k = 0; k < ir_arity(ir_operation(b->g, n)); k++)
    count_users(b, ir_operand(b->g, n, k));
}

/* Chooses b->shared: of what is dear and the same or opposite from either end of a bond, operands
   first, what is still dear given those before. */
static void choose_shared(builder *b, const segment *wanted) {
  node_list found = {must_alloc(MOST_LINKS * sizeof(ir_node)), 0};
  node_map seen = {0};
  for (int k = 0; k < wanted->root_count; k++)
    count_users(b, wanted->roots[k].node);
  for (int k = 0; k < b->link_count; k++)
    count_users(b, b->link[k]);
  for (int k = 0; k < wanted->root_count; k++)
    find_shareable(b, wanted->roots[k].node, &seen, &found);
  for (int k = 0; k < b->link_count; k++)
    find_shareable(b, b->link[k], &seen, &found);
  qsort(found.items, (size_t)found.count, sizeof *found.items, by_number);
  b->shared = arena_alloc(b->memory, ((size_t)found.count + 2) * sizeof *b->shared);
  const int most = MOST_SHARED - 1 - 2 * b->links.of_bonds; /* one more: the force's factor */
  for (int k = 0; k < found.count && b->shared_count < most; k++)
    if (is_worth_sharing(b, found.items[k])) {
      const ir_node dear = dear_part(b, found.items[k]);
      b->shared[b->shared_count++] = dear;
    }
  map_clear(&seen);
  free(found.items);
}

/* --- the force of a bond ---------------------------------------------------------------------- */

/* The factors of what a force adds up over the neighbours; false where it is no such sum. */
static bool factors_of_force(builder *b, const segment_root *r, term_list *t) {
  t->count = 0;
  if (ir_operation(b->g, r->node) != IR_FAMILY_SUM) return false;
  if (!program_terms(b, ir_operand(b->g, r->node, 0), false, 1, t)) return false;
  for (int k = 0; k < t->count; k++) {
    if (t->sign[k] < 0) return false;
    for (int n = 0; n < k; n++) /* of terms it is asked whether they are there, not how often */
      if (t->term[n] == t->term[k]) return false;
  }
  return true;
}

static bool has_term(const term_list *t, ir_node n) {
  for (int k = 0; k < t->count; k++)
    if (t->term[k] == n) return true;
  return false;
}

/* The product of the terms of `t` that `other` has, or has not; IR_NONE: of none. */
static ir_node product_of(builder *b, const term_list *t, const term_list *other, bool in_other) {
  ir_node product = IR_NONE;
  for (int k = 0; k < t->count; k++)
    if (has_term(other, t->term[k]) == in_other)
      product = product == IR_NONE ? t->term[k] : ir_mul(b->g, product, t->term[k]);
  return product;
}

/* The factors that all components of the force have. */
static bool find_common(builder *b, const segment *wanted, term_list *common) {
  bool any = false;
  for (int k = 0; k < wanted->root_count; k++) {
    term_list now;
    if (wanted->roots[k].target != TO_FORCE) continue;
    if (!factors_of_force(b, &wanted->roots[k], &now)) return false;
    if (!any) *common = now;
    any = true;
    int kept = 0;
    for (int n = 0; n < common->count; n++)
      if (has_term(&now, common->term[n])) common->term[kept++] = common->term[n];
    common->count = kept;
  }
  return any && common->count > 0;
}

/* What all components of the force have as a factor, the same from either end, that no earlier pass
   can know: the force of a bond over its length. IR_NONE: nothing that is worth it. */
static ir_node common_factor(builder *b, const segment *wanted) {
  enum { DEAR = 4 }; /* a store and two loads, of fewer values than it is computed from */
  term_list common = {.count = 0};
  if (!find_common(b, wanted, &common)) return IR_NONE;
  const ir_node product = product_of(b, &common, &common, true);
  const bool late = !is_plain(b, product) && cost_beyond(b, product, DEAR) >= DEAR;
  return late && program_parity(b, product) == 1 ? product : IR_NONE;
}

/* Puts `input` in its place. */
static void put_factor(builder *b, segment *wanted, ir_node factor, ir_node input) {
  term_list of_factor = {.count = 0}, now;
  if (!program_terms(b, factor, false, 1, &of_factor)) return;
  for (int k = 0; k < wanted->root_count; k++) {
    if (wanted->roots[k].target != TO_FORCE || !factors_of_force(b, &wanted->roots[k], &now))
      continue;
    const ir_node rest = product_of(b, &now, &of_factor, false);
    wanted->roots[k].node = ir_make(
        b->g, IR_FAMILY_SUM, rest == IR_NONE ? input : ir_mul(b->g, rest, input), IR_NONE, IR_NONE);
  }
}

/* --- sharing ---------------------------------------------------------------------------------- */

static ir_node shared_input(builder *b, int k) {
  const char *name = ir_name(b->g, b->shared[k]);
  const ir_source from = program_parity(b, b->shared[k]) < 0 ? IR_FROM_SHARED_ODD : IR_FROM_SHARED;
  return ir_input(b->g, from, b->first_shared + k,
                  name ? name : arena_printf(b->memory, "shared_%d", k), ON_BOND);
}

/* What follows from links and is the same from either end, too: its owner computes it in a pass of
   its own. In the plane that pass costs more than the few bonds spare. */
static void share_factor(builder *b, segment *wanted) {
  if (b->first_shared + b->shared_count >= MOST_SHARED) return;
  const ir_node factor = common_factor(b, wanted);
  if (factor == IR_NONE) return;
  b->shared[b->shared_count++] = factor;
  put_factor(b, wanted, factor, shared_input(b, b->shared_count - 1));
}

/* Values that the ends of bonds share become inputs. */
void program_share(builder *b, segment *wanted) {
  choose_shared(b, wanted);
  b->first_shared = 2 * b->links.of_bonds;
  ir_node *inputs = must_alloc(((size_t)b->shared_count + 1) * sizeof *inputs);
  for (int k = 0; k < b->shared_count; k++)
    inputs[k] = shared_input(b, k);
  program_substitute(b, wanted, b->shared, inputs, b->shared_count);
  free(inputs);
  if (b->sharing == SHARE_MORE) share_factor(b, wanted);
  b->links.of_bonds += (b->shared_count + 1) / 2;
}
