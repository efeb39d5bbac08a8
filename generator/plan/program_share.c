/* What both ends of a bond share: values whose mirror image is the value itself, or its opposite. */
#include "generator/plan/program_mirror.h"
#include "generator/plan/program_parts.h"

/* Whether a value follows from motion and fields alone, without what goes over a family or was left by a pass. */
static bool is_plain(builder *b, ir_node n) {
  int known = map_get(&b->plain, n);
  if (known >= 0) return known != 0;
  const ir_op op = ir_operation(b->g, n);
  bool plain = !ir_is_reduction(op);
  if (op == IR_INPUT) {
    const ir_source from = ir_input_source(b->g, n);
    plain = from == IR_FROM_FIELD || from == IR_FROM_NEIGHBOUR_FIELD || from == IR_FROM_ENDS ||
            is_uniform(b->g, n);
  }
  for (int k = 0; k < ir_arity(op) && plain; k++)
    plain = is_plain(b, ir_operand(b->g, n, k));
  map_set(&b->plain, n, plain);
  return plain;
}

/* The terms of a sum, or the factors of a product. */
enum { MOST_TERMS = 24 };
typedef struct term_list {
  ir_node term[MOST_TERMS];
  int sign[MOST_TERMS]; /* of a term; of a factor: -1 below the line */
  int count;
} term_list;

static bool add_term(term_list *t, ir_node n, int sign) {
  if (t->count == MOST_TERMS) return false;
  t->term[t->count] = n;
  t->sign[t->count++] = sign;
  return true;
}

/* What the other end knows as a whole only: an input, or what a link tells. */
static bool is_whole(builder *b, ir_node n) {
  return is_leaf(b->g, n) || (b->sharing == SHARE_PAIRS && map_get(&b->linked, n) >= 0);
}

static bool add_terms(builder *b, ir_node n, bool of_sum, int sign, term_list *t) {
  const ir *g = b->g;
  const ir_op op = ir_operation(g, n);
  const ir_op join = of_sum ? IR_ADD : IR_MUL, part = of_sum ? IR_SUB : IR_DIV;
  if (is_whole(b, n)) return add_term(t, n, sign);
  if (op == join || op == part)
    return add_terms(b, ir_operand(g, n, 0), of_sum, sign, t) &&
           add_terms(b, ir_operand(g, n, 1), of_sum, op == join ? sign : -sign, t);
  if (of_sum && op == IR_NEG) return add_terms(b, ir_operand(g, n, 0), of_sum, -sign, t);
  return add_term(t, n, sign);
}

static int image_sign(builder *b, ir_node x, ir_node y, int *left);

/* The same for results of one operation, operand by operand; with `crossed` the first of one is the second of the other. */
static int image_of_operands(builder *b, ir_node x, ir_node y, bool crossed, int *left) {
  const ir_op op = ir_operation(b->g, x);
  int sign[3] = {1, 1, 1};
  for (int k = 0; k < ir_arity(op); k++) {
    sign[k] = image_sign(b, ir_operand(b->g, x, k),
                         ir_operand(b->g, y, crossed && k < 2 ? 1 - k : k), left);
    if (sign[k] == 0) return 0;
  }
  if (op == IR_ADD || op == IR_SUB) return sign[0] == sign[1] ? sign[0] : 0;
  if (op == IR_FMA) return sign[0] * sign[1] == sign[2] ? sign[2] : 0;
  if (op == IR_MUL || op == IR_DIV || operation_has(op, ODD)) return sign[0] * sign[1];
  if (operation_has(op, EVEN)) return 1;
  return sign[0] == 1 && sign[1] == 1 && sign[2] == 1 ? 1 : 0;
}

/* 1: the other end has y for x; -1: it has -y; 0: neither can be seen. `left` operations may be looked at. */
static int image_sign(builder *b, ir_node x, ir_node y, int *left) {
  const ir_op op = ir_operation(b->g, x);
  const ir_node image = program_mirror(b, x);
  if (image == y) return 1;
  if (b->sharing != SHARE_PAIRS) return 0;
  if (x == y) return program_parity(b, x);
  if (is_whole(b, x)) return image == ir_neg(b->g, y) ? -1 : 0;
  if (op != ir_operation(b->g, y) || --*left < 0) return 0;
  const int sign = image_of_operands(b, x, y, false, left);
  return sign != 0 || !operation_has(op, COMMUTES) ? sign : image_of_operands(b, x, y, true, left);
}

/* Takes the mirror image of term k, with that sign, out of the list; in products no sign may change. */
static bool take_partner(builder *b, term_list *t, int k, int sign, bool of_sum) {
  enum { MOST_LOOKS = 1000 };
  for (int other = k + 1; other < t->count; other++) {
    int left = MOST_LOOKS;
    const int image = image_sign(b, t->term[k], t->term[other], &left);
    if (image == 0 || (!of_sum && image < 0) || t->sign[other] * image != sign) continue;
    t->term[other] = t->term[--t->count];
    t->sign[other] = t->sign[t->count];
    return true;
  }
  return false;
}

/* A sum has the parity of its terms, or its terms come in pairs that the ends exchange. */
static int parity_of_sum(builder *b, ir_node n) {
  for (int wanted = 1; wanted >= -1; wanted -= 2) {
    term_list t = {.count = 0};
    if (!add_terms(b, n, true, 1, &t)) return 0;
    bool all = true;
    for (int k = 0; k < t.count && all; k++)
      all = program_parity(b, t.term[k]) == wanted ||
            take_partner(b, &t, k, wanted * t.sign[k], true);
    if (all) return wanted;
  }
  return 0;
}

static int parity_of_product(builder *b, ir_node n) {
  term_list t = {.count = 0};
  int all = 1;
  if (!add_terms(b, n, false, 1, &t)) return 0;
  for (int k = 0; k < t.count && all; k++) {
    const int one = program_parity(b, t.term[k]);
    if (one)
      all *= one;
    else
      all = take_partner(b, &t, k, t.sign[k], false) ? all : 0;
  }
  return all;
}

static int parity_of_leaf(builder *b, ir_node n) {
  if (ir_operation(b->g, n) == IR_CONSTANT) return 1;
  const ir_node image = program_mirror(b, n);
  return image == n ? 1 : image == ir_neg(b->g, n) ? -1 : 0;
}

/* Of any other operation: even when its operands are, or when the ends exchange them. */
static int parity_of_others(builder *b, ir_node n) {
  const ir_op op = ir_operation(b->g, n);
  int operand[3] = {1, 1, 1};
  for (int k = 0; k < ir_arity(op); k++)
    operand[k] = program_parity(b, ir_operand(b->g, n, k));
  if (operation_has(op, ODD)) return operand[0];
  if (op == IR_FMA && operand[0] * operand[1] != 0)
    return operand[0] * operand[1] == operand[2] ? operand[2] : 0;
  if (operation_has(op, EVEN) && operand[0]) return 1;
  if (op == IR_SELECT && operand[0] == 1 && operand[1] == operand[2]) return operand[1];
  if (operand[0] == 1 && operand[1] == 1 && operand[2] == 1) return 1;
  return program_mirror(b, n) == n ? 1 : 0;
}

/* Rounding is left aside, since only one end will compute the value. */
int program_parity(builder *b, ir_node n) {
  int known = map_get(&b->parity, n);
  if (known >= 0) return known - 1;
  const ir_op op = ir_operation(b->g, n);
  int p;
  if (is_whole(b, n))
    p = parity_of_leaf(b, n);
  else if (ir_is_reduction(op))
    p = 0; /* the other end has another family */
  else if (op == IR_ADD || op == IR_SUB)
    p = parity_of_sum(b, n);
  else if (op == IR_MUL || op == IR_DIV)
    p = parity_of_product(b, n);
  else
    p = parity_of_others(b, n);
  map_set(&b->parity, n, p + 1);
  return p;
}

/* Whether links tell the other end all that it cannot compute. */
static bool is_told(builder *b, ir_node n, node_map *seen) {
  if (map_get(seen, n) >= 0 || map_get(&b->linked, n) >= 0) return true;
  map_set(seen, n, 1);
  const ir_op op = ir_operation(b->g, n);
  if (ir_is_reduction(op)) return false;
  if (op == IR_INPUT && ir_input_source(b->g, n) == IR_FROM_SHAPE) return false;
  bool told = true;
  for (int k = 0; k < ir_arity(op) && told; k++)
    told = is_told(b, ir_operand(b->g, n, k), seen);
  return told;
}

int program_parity_of_root(builder *b, ir_node n) {
  node_map seen = {0};
  const bool told = is_told(b, n, &seen);
  map_clear(&seen);
  return told ? program_parity(b, n) : 0;
}

/* Operations that have not been counted since `round` began. */
static int cost_in_round(builder *b, ir_node n, int most) {
  if (map_get(&b->counted, n) == b->round) return 0;
  map_set(&b->counted, n, b->round);
  for (int k = 0; k < b->shared_count; k++)
    if (b->shared[k] == n) return 0;
  if (is_leaf(b->g, n) || is_uniform(b->g, n) || is_of_particle(b->g, n)) return 0;
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

/* What a value must cost to be shared: a store and two loads for each bond, or, where planes do not stay in a cache, more. */
static int dear(const builder *b) {
  return b->sharing >= SHARE_MORE ? 12 : 25;
}

static bool is_worth_sharing(builder *b, ir_node n) {
  if (is_leaf(b->g, n) || is_uniform(b->g, n) || is_of_particle(b->g, n) || !is_plain(b, n) ||
      ir_is_logical(b->g, n) || cost_beyond(b, n, dear(b)) < dear(b))
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

void program_choose_shared(builder *b, const segment_root *roots, int root_count) {
  node_list found = {must_alloc(MOST_LINKS * sizeof(ir_node)), 0};
  node_map seen = {0};
  for (int k = 0; k < root_count; k++)
    count_users(b, roots[k].node);
  for (int k = 0; k < b->link_count; k++)
    count_users(b, b->link[k]);
  for (int k = 0; k < root_count; k++)
    find_shareable(b, roots[k].node, &seen, &found);
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

/* --- the force of a bond ------------------------------------------------------------------------ */

/* The factors of what a force adds up over the neighbours; false where it is no such sum. */
static bool factors_of_force(builder *b, const segment_root *r, term_list *t) {
  t->count = 0;
  if (ir_operation(b->g, r->node) != IR_FAMILY_SUM) return false;
  if (!add_terms(b, ir_operand(b->g, r->node, 0), false, 1, t)) return false;
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
static bool find_common(builder *b, const segment_root *roots, int root_count, term_list *common) {
  bool any = false;
  for (int k = 0; k < root_count; k++) {
    term_list now;
    if (roots[k].target != TO_PARTICLE_FORCE) continue;
    if (!factors_of_force(b, &roots[k], &now)) return false;
    if (!any) *common = now;
    any = true;
    int kept = 0;
    for (int n = 0; n < common->count; n++)
      if (has_term(&now, common->term[n])) common->term[kept++] = common->term[n];
    common->count = kept;
  }
  return any && common->count > 0;
}

ir_node program_common_factor(builder *b, const segment_root *roots, int root_count) {
  enum { DEAR = 4 }; /* a store and two loads, of fewer values than it is computed from */
  term_list common = {.count = 0};
  if (!find_common(b, roots, root_count, &common)) return IR_NONE;
  const ir_node product = product_of(b, &common, &common, true);
  const bool late = !is_plain(b, product) && cost_beyond(b, product, DEAR) >= DEAR;
  return late && program_parity(b, product) == 1 ? product : IR_NONE;
}

void program_put_factor(builder *b, segment_root *roots, int root_count, ir_node factor,
                        ir_node input) {
  term_list of_factor = {.count = 0}, now;
  if (!add_terms(b, factor, false, 1, &of_factor)) return;
  for (int k = 0; k < root_count; k++) {
    if (roots[k].target != TO_PARTICLE_FORCE || !factors_of_force(b, &roots[k], &now)) continue;
    const ir_node rest = product_of(b, &now, &of_factor, false);
    roots[k].node = ir_make(b->g, IR_FAMILY_SUM,
                            rest == IR_NONE ? input : ir_mul(b->g, rest, input), IR_NONE, IR_NONE);
  }
}
