#include "generator/plan/program_parity.h"

#include "generator/plan/program_mirror.h"

enum { MOST_LOOKS = 1000 }; /* operations that a search for an image looks at */

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

bool program_terms(builder *b, ir_node n, bool of_sum, int sign, term_list *t) {
  const ir *g = b->g;
  const ir_op op = ir_operation(g, n);
  const ir_op join = of_sum ? IR_ADD : IR_MUL, part = of_sum ? IR_SUB : IR_DIV;
  if (is_whole(b, n)) return add_term(t, n, sign);
  if (op == join || op == part)
    return program_terms(b, ir_operand(g, n, 0), of_sum, sign, t) &&
           program_terms(b, ir_operand(g, n, 1), of_sum, op == join ? sign : -sign, t);
  if (of_sum && op == IR_NEG) return program_terms(b, ir_operand(g, n, 0), of_sum, -sign, t);
  return add_term(t, n, sign);
}

static int image_sign(builder *b, ir_node x, ir_node y, int *left);

/* The same for results of one operation, operand by operand; with `crossed` the first of one is the
   second of the other. */
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

/* NaN aside, also in either order. */
static bool takes_any_order(ir_op op) {
  return operation_has(op, COMMUTES) || op == IR_MIN || op == IR_MAX;
}

/* The same where it has not been seen yet, of operations alike. */
static int image_of_operation(builder *b, ir_node x, ir_node y, int *left) {
  int sign = image_of_operands(b, x, y, false, left);
  if (sign == 0 && takes_any_order(ir_operation(b->g, x)))
    sign = image_of_operands(b, x, y, true, left);
  if (sign == 0) return 0;
  map_set(&b->partner, x, y);
  map_set(&b->partner_sign, x, sign + 1);
  return sign;
}

/* 1: the other end has y for x; -1: it has -y; 0: neither can be seen. `left` operations may be
   looked at. */
static int image_sign(builder *b, ir_node x, ir_node y, int *left) {
  const ir_op op = ir_operation(b->g, x);
  const ir_node image = program_mirror(b, x);
  if (image == y) return 1;
  if (b->sharing != SHARE_PAIRS) return 0;
  if (x == y) return program_parity(b, x);
  if (is_whole(b, x)) return image == ir_neg(b->g, y) ? -1 : 0;
  if (map_get(&b->partner, x) == y) return map_get(&b->partner_sign, x) - 1;
  return op != ir_operation(b->g, y) || --*left < 0 ? 0 : image_of_operation(b, x, y, left);
}

/* The two values that n is the smaller or the larger of, also as a choice by comparing them. */
static bool is_extreme(const ir *g, ir_node n, ir_node *x, ir_node *y) {
  const ir_op op = ir_operation(g, n);
  const int first = op == IR_SELECT;
  if (op != IR_MIN && op != IR_MAX && op != IR_SELECT) return false;
  *x = ir_operand(g, n, first);
  *y = ir_operand(g, n, first + 1);
  if (op != IR_SELECT) return true;
  const ir_node asked = ir_operand(g, n, 0);
  if (ir_operation(g, asked) != IR_LT && ir_operation(g, asked) != IR_LE) return false;
  const ir_node a = ir_operand(g, asked, 0), b = ir_operand(g, asked, 1);
  return (a == *x && b == *y) || (a == *y && b == *x);
}

/* Whether the ends exchange what n is the smaller or the larger of. */
static bool exchanges_extremes(builder *b, ir_node n) {
  ir_node x, y;
  int left = MOST_LOOKS;
  return is_extreme(b->g, n, &x, &y) && image_sign(b, x, y, &left) == 1;
}

/* Takes the mirror image of term k, with that sign, out of the list; in products no sign may
   change. */
static bool take_partner(builder *b, term_list *t, int k, int sign, bool of_sum) {
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
    if (!program_terms(b, n, true, 1, &t)) return 0;
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
  if (!program_terms(b, n, false, 1, &t)) return 0;
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
  return program_mirror(b, n) == n || exchanges_extremes(b, n) ? 1 : 0;
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

/* --- the far end ------------------------------------------------------------------------------ */

/* The same operation of what the other end has for the operands: signs are taken out of it where
   they can be, so that the other end's own values are found again. */
static ir_node far_of_operation(builder *b, ir_node n, const ir_node *far, const int *signs,
                                int *sign) {
  ir *g = b->g;
  const ir_op op = ir_operation(g, n);
  const bool linear = op == IR_ADD || op == IR_SUB || op == IR_SELECT;
  const int first = op == IR_SELECT;
  ir_node operand[3] = {far[0], far[1], far[2]};
  *sign = linear ? signs[first] : 1;
  if ((op == IR_ADD || op == IR_SUB) && signs[0] != signs[1])
    return ir_make(g, op == IR_ADD ? IR_SUB : IR_ADD, far[0], far[1], IR_NONE);
  if (op == IR_MUL || op == IR_DIV) *sign = signs[0] * signs[1];
  if (operation_has(op, ODD)) *sign = signs[0];
  const bool taken =
      op == IR_MUL || op == IR_DIV || operation_has(op, ODD) || operation_has(op, EVEN);
  for (int k = 0; k < ir_arity(op) && !taken; k++)
    if (signs[k] != (linear && k >= first ? *sign : 1)) operand[k] = ir_neg(g, far[k]);
  return program_made_again(g, n, operand);
}

static ir_node far_of(builder *b, ir_node n, int *sign) {
  const ir_node known = map_get(&b->far, n);
  *sign = program_parity(b, n);
  if (*sign) return n;
  if (known >= 0) {
    *sign = map_get(&b->far_sign, n) - 1;
    return known;
  }
  ir_node operand[3] = {IR_NONE, IR_NONE, IR_NONE}, made;
  int signs[3] = {1, 1, 1};
  *sign = 1;
  if (is_whole(b, n)) {
    made = program_mirror(b, n);
  } else {
    for (int k = 0; k < ir_arity(ir_operation(b->g, n)); k++)
      operand[k] = far_of(b, ir_operand(b->g, n, k), &signs[k]);
    made = far_of_operation(b, n, operand, signs, sign);
  }
  map_set(&b->far, n, made);
  map_set(&b->far_sign, n, *sign + 1);
  return made;
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

int program_parity_of_root(builder *b, ir_node n, ir_node *far) {
  node_map seen = {0};
  const bool told = is_told(b, n, &seen);
  int sign;
  map_clear(&seen);
  *far = IR_NONE;
  if (!told) return 0;
  if (program_parity(b, n)) return program_parity(b, n);
  *far = far_of(b, n, &sign);
  if (sign < 0) *far = ir_neg(b->g, *far);
  return 0;
}
