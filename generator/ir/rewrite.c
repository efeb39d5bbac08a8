#include "generator/ir/rewrite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "generator/ir/derive.h"

/* --- rebuilding ------------------------------------------------------------------------------- */

typedef struct rebuilding rebuilding;
/* What node `old` becomes when its operands have become `operand`. */
typedef ir_node (*rebuild_rule)(const rebuilding *r, ir_node old, const ir_node *operand);

struct rebuilding {
  ir *graph;
  rebuild_rule rule;
  const ir_node *inputs; /* rewrite_zero */
  int input_count;
  /* rewrite_reciprocals: denominators of several divisions; others: nodes that are used several
     times. */
  const unsigned char *shared;
  const unsigned char *needs;   /* rewrite_fused: what nodes need: NEEDS_NEIGHBOUR, NEEDS_FAMILY */
  const unsigned char *lasting; /* rewrite_reciprocals: nodes that are the same in all steps */
};

static unsigned char *marks_of(const ir *g, const ir_node *roots, int root_count) {
  unsigned char *marks = must_calloc((size_t)ir_count(g) + 1, 1);
  ir_mark(g, roots, root_count, marks);
  return marks;
}

static bool is_constant(const ir *g, ir_node n, double value) {
  return ir_operation(g, n) == IR_CONSTANT && ir_value(g, n) == value;
}

static void rebuild(const rebuilding *r, const ir_node *roots, int root_count, ir_node *out) {
  ir *g = r->graph;
  int count = ir_count(g); /* nodes made on the way are above it */
  unsigned char *marks = marks_of(g, roots, root_count);
  ir_node *become = must_alloc(((size_t)count + 1) * sizeof *become);
  for (ir_node n = 0; n < count; n++) {
    if (!marks[n]) continue;
    ir_node operand[3] = {IR_NONE, IR_NONE, IR_NONE};
    for (int k = 0; k < ir_arity(ir_operation(g, n)); k++)
      operand[k] = become[ir_operand(g, n, k)];
    become[n] = r->rule(r, n, operand);
    if (ir_name(g, n) && ir_arity(ir_operation(g, become[n])) > 0)
      ir_set_name(g, become[n], ir_name(g, n), ir_where(g, n));
    if (ir_is_expected(g, n)) ir_expect(g, become[n]);
  }
  for (int k = 0; k < root_count; k++)
    out[k] = roots[k] == IR_NONE ? IR_NONE : become[roots[k]];
  free(become);
  free(marks);
}

static ir_node again(ir *g, ir_node old, const ir_node *operand) {
  ir_op op = ir_operation(g, old);
  return ir_arity(op) == 0 ? old : ir_make(g, op, operand[0], operand[1], operand[2]);
}

/* 1 for each node that two or more of the needed ones use, those with one operation left aside. */
static unsigned char *shared_nodes(const ir *g, const unsigned char *marks, ir_op aside) {
  unsigned char *uses = must_calloc((size_t)ir_count(g) + 1, 1);
  for (ir_node n = 0; n < ir_count(g); n++)
    for (int k = 0; marks[n] && ir_operation(g, n) != aside && k < ir_arity(ir_operation(g, n));
         k++) {
      unsigned char *use = &uses[ir_operand(g, n, k)];
      *use = *use < 2 ? (unsigned char)(*use + 1) : 2;
    }
  for (ir_node n = 0; n < ir_count(g); n++)
    uses[n] = uses[n] >= 2;
  return uses;
}

/* --- zero ------------------------------------------------------------------------------------- */

static ir_node zero_rule(const rebuilding *r, ir_node old, const ir_node *operand) {
  ir *g = r->graph;
  for (int k = 0; k < r->input_count; k++)
    if (old == r->inputs[k]) return ir_constant(g, 0);
  switch (ir_operation(g, old)) {
  case IR_MUL:
    if (is_constant(g, operand[0], 0) || is_constant(g, operand[1], 0)) return ir_constant(g, 0);
    break;
  case IR_DIV:
    if (is_constant(g, operand[0], 0)) return ir_constant(g, 0);
    break;
  case IR_SUB:
    if (operand[0] == operand[1]) return ir_constant(g, 0);
    break;
  default:
    break;
  }
  return again(g, old, operand);
}

void rewrite_zero(ir *g, const ir_node *roots, int root_count, const ir_node *inputs,
                  int input_count, ir_node *out) {
  rebuilding r = {.graph = g, .rule = zero_rule, .inputs = inputs, .input_count = input_count};
  rebuild(&r, roots, root_count, out);
}

/* --- reciprocals ------------------------------------------------------------------------------ */

/* Not of the body as a whole. */
static bool is_of_one_particle(const ir *g, ir_node n) {
  return ir_is_of_particle(g, n) && !ir_is_uniform(g, n);
}

/* a/b by 1/b, with what rounding left put right: the bits of the division (Markstein 1990), so that
   x/x is 1 and n of n broken bonds are all of them. */
static ir_node quotient_by_reciprocal(ir *g, ir_node above, ir_node below) {
  const ir_node reciprocal = ir_div(g, ir_constant(g, 1), below);
  const ir_node rough = ir_mul(g, above, reciprocal);
  const ir_node left = ir_make(g, IR_FMA, ir_neg(g, rough), below, above);
  return ir_make(g, IR_FMA, left, reciprocal, rough);
}

/* Toward each neighbour, by a value of the particle: (p*x)/q = (p/q)*x divides once. */
static ir_node quotient_by_particle(ir *g, ir_node above, ir_node below) {
  for (int k = 0; k < 2 && ir_operation(g, above) == IR_MUL; k++)
    if (is_of_one_particle(g, ir_operand(g, above, k)))
      return ir_mul(g, ir_div(g, ir_operand(g, above, k), below), ir_operand(g, above, 1 - k));
  return quotient_by_reciprocal(g, above, below);
}

static ir_node reciprocal_rule(const rebuilding *r, ir_node old, const ir_node *operand) {
  ir *g = r->graph;
  if (ir_operation(g, old) != IR_DIV || ir_is_uniform(g, old)) return again(g, old, operand);
  ir_node below = ir_operand(g, old, 1);
  const bool lasts = !ir_is_uniform(g, below) && r->lasting[below] && !r->lasting[old];
  if (lasts && is_of_one_particle(g, old)) return quotient_by_reciprocal(g, operand[0], operand[1]);
  if (ir_is_uniform(g, below) || r->shared[below])
    return ir_mul(g, operand[0], ir_div(g, ir_constant(g, 1), operand[1]));
  if (lasts) return quotient_by_reciprocal(g, operand[0], operand[1]);
  if (is_of_one_particle(g, below) && !is_of_one_particle(g, old))
    return quotient_by_particle(g, operand[0], operand[1]);
  return again(g, old, operand);
}

/* 1 for each node that two or more of the needed divisions divide by. */
static unsigned char *shared_denominators(const ir *g, const unsigned char *marks) {
  unsigned char *uses = must_calloc((size_t)ir_count(g) + 1, 1);
  for (ir_node n = 0; n < ir_count(g); n++) {
    if (!marks[n] || ir_operation(g, n) != IR_DIV) continue;
    unsigned char *use = &uses[ir_operand(g, n, 1)];
    *use = *use < 2 ? (unsigned char)(*use + 1) : 2;
  }
  for (ir_node n = 0; n < ir_count(g); n++)
    uses[n] = uses[n] >= 2;
  return uses;
}

/* What follows from parameters, the lattice and the bonds that exist. */
static unsigned char *lasting_nodes(const ir *g) {
  unsigned char *lasting = must_calloc((size_t)ir_count(g) + 1, 1);
  for (ir_node n = 0; n < ir_count(g); n++) {
    const bool input = ir_operation(g, n) == IR_INPUT;
    lasting[n] = !input || ir_is_uniform(g, n) || ir_input_source(g, n) == IR_FROM_SHAPE;
    for (int k = 0; k < ir_arity(ir_operation(g, n)); k++)
      lasting[n] &= lasting[ir_operand(g, n, k)];
  }
  return lasting;
}

void rewrite_reciprocals(ir *g, const ir_node *roots, int root_count, ir_node *out) {
  unsigned char *marks = marks_of(g, roots, root_count);
  unsigned char *shared = shared_denominators(g, marks), *lasting = lasting_nodes(g);
  rebuilding r = {.graph = g, .rule = reciprocal_rule, .shared = shared, .lasting = lasting};
  rebuild(&r, roots, root_count, out);
  free(lasting);
  free(shared);
  free(marks);
}

/* --- choices between quotients ---------------------------------------------------------------- */

static bool is_own_quotient(const rebuilding *r, ir_node old, ir_node n) {
  return ir_operation(r->graph, n) == IR_DIV && !ir_is_uniform(r->graph, n) && !r->shared[old];
}

/* Of two conditions of one kind that share an operand, the one that asks about the chosen
   operand. */
static ir_node chosen_condition(ir *g, ir_node chooses, ir_node a, ir_node b) {
  const ir_op op = ir_operation(g, a);
  for (int k = 0; k < 2 && op == ir_operation(g, b) && (op == IR_LT || op == IR_LE); k++) {
    const ir_node same = ir_operand(g, a, k);
    if (same != ir_operand(g, b, k)) continue;
    const ir_node other = ir_select(g, chooses, ir_operand(g, a, 1 - k), ir_operand(g, b, 1 - k));
    return k == 0 ? ir_make(g, op, same, other, IR_NONE) : ir_make(g, op, other, same, IR_NONE);
  }
  return IR_NONE;
}

static ir_node chosen_quotient(ir *g, ir_node chooses, ir_node a, ir_node b) {
  const ir_node above = ir_select(g, chooses, ir_operand(g, a, 0), ir_operand(g, b, 0));
  return ir_div(g, above, ir_select(g, chooses, ir_operand(g, a, 1), ir_operand(g, b, 1)));
}

/* c ? a/b : d/e, or c ? (p ? v : a/b) : (q ? v : d/e). */
static ir_node choice_rule(const rebuilding *r, ir_node old, const ir_node *operand) {
  ir *g = r->graph;
  if (ir_operation(g, old) != IR_SELECT) return again(g, old, operand);
  const ir_node yes = operand[1], no = operand[2];
  const ir_node old_yes = ir_operand(g, old, 1), old_no = ir_operand(g, old, 2);
  if (is_own_quotient(r, old_yes, yes) && is_own_quotient(r, old_no, no))
    return chosen_quotient(g, operand[0], yes, no);
  if (ir_operation(g, yes) != IR_SELECT || ir_operation(g, no) != IR_SELECT ||
      ir_operand(g, yes, 1) != ir_operand(g, no, 1) || r->shared[old_yes] || r->shared[old_no] ||
      !is_own_quotient(r, ir_operand(g, old_yes, 2), ir_operand(g, yes, 2)) ||
      !is_own_quotient(r, ir_operand(g, old_no, 2), ir_operand(g, no, 2)))
    return again(g, old, operand);
  const ir_node asked =
      chosen_condition(g, operand[0], ir_operand(g, yes, 0), ir_operand(g, no, 0));
  if (asked == IR_NONE) return again(g, old, operand);
  return ir_select(g, asked, ir_operand(g, yes, 1),
                   chosen_quotient(g, operand[0], ir_operand(g, yes, 2), ir_operand(g, no, 2)));
}

/* --- factors that are the same for all bonds -------------------------------------------------- */

/* Takes node n apart: n = factor * rest, to the order of multiplication. IR_NONE where no factor is
   uniform, or where n is done once for many of the values `of` that need it. */
typedef struct factored {
  ir_node factor, rest;
} factored;

static factored take_factor(const ir *g, ir_node n, ir_node of) {
  if (ir_operation(g, n) == IR_MUL && !ir_is_uniform(g, n) && ir_place(g, n) == ir_place(g, of))
    for (int k = 0; k < 2; k++)
      if (ir_is_uniform(g, ir_operand(g, n, k)))
        return (factored){ir_operand(g, n, k), ir_operand(g, n, 1 - k)};
  return (factored){IR_NONE, n};
}

static ir_node join_factors(ir *g, ir_node a, ir_node b) {
  return a == IR_NONE ? b : b == IR_NONE ? a : ir_mul(g, a, b);
}

/* Both factors move out of a product where that costs nothing: one operand is uniform, or nothing
   else needs it as it was. */
static ir_node factored_product(const rebuilding *r, ir_node old, const ir_node *operand) {
  ir *g = r->graph;
  factored part[2];
  bool moves = false;
  for (int k = 0; k < 2; k++) {
    const bool uniform = ir_is_uniform(g, operand[k]);
    part[k] = uniform ? (factored){operand[k], IR_NONE} : take_factor(g, operand[k], old);
    const bool alone = uniform || !r->shared[ir_operand(g, old, k)];
    moves = moves || (alone && part[k].factor != IR_NONE);
  }
  if (!moves) return again(g, old, operand);
  const ir_node rest = join_factors(g, part[0].rest, part[1].rest);
  return ir_mul(g, join_factors(g, part[0].factor, part[1].factor), rest);
}

/* (u*x)/y = u*(x/y) */
static ir_node factored_quotient(const rebuilding *r, ir_node old, const ir_node *operand) {
  ir *g = r->graph;
  const factored above = take_factor(g, operand[0], old);
  if (above.factor == IR_NONE || r->shared[ir_operand(g, old, 0)]) return again(g, old, operand);
  return ir_mul(g, above.factor, ir_div(g, above.rest, operand[1]));
}

/* A factor of which the graph shows that it is not below 0. */
static bool is_size(const ir *g, ir_node n) {
  const ir_op op = ir_operation(g, n);
  return operations[op].image.low >= 0 || (op == IR_CONSTANT && ir_value(g, n) >= 0);
}

/* The larger or smaller of two is one operation of the processor, if one is NaN wherever the other
   is. */
static ir_node quick_extreme(ir *g, ir_op op, ir_node a, ir_node b) {
  if (!rewrite_nan_follows(g, a, b)) {
    if (!rewrite_nan_follows(g, b, a)) return ir_make(g, op, a, b, IR_NONE);
    const ir_node first = b;
    b = a;
    a = first;
  }
  const bool smaller = op == IR_MIN;
  return ir_select(g, ir_make(g, IR_LT, smaller ? a : b, smaller ? b : a, IR_NONE), a, b);
}

static ir_node factored_extreme(const rebuilding *r, ir_node old, const ir_node *operand) {
  ir *g = r->graph;
  const ir_op op = ir_operation(g, old);
  const factored a = take_factor(g, operand[0], old), b = take_factor(g, operand[1], old);
  if (a.factor == IR_NONE || a.factor != b.factor || !is_size(g, a.factor))
    return quick_extreme(g, op, operand[0], operand[1]);
  return ir_mul(g, a.factor, quick_extreme(g, op, a.rest, b.rest));
}

static ir_node factor_rule(const rebuilding *r, ir_node old, const ir_node *operand) {
  ir *g = r->graph;
  if (ir_is_uniform(g, old)) return again(g, old, operand);
  switch (ir_operation(g, old)) {
  case IR_MUL:
    return factored_product(r, old, operand);
  case IR_DIV:
    return factored_quotient(r, old, operand);
  case IR_ABS: {
    const factored a = take_factor(g, operand[0], old);
    if (a.factor == IR_NONE) return again(g, old, operand);
    const ir_node size = ir_make(g, IR_ABS, a.factor, IR_NONE, IR_NONE);
    return ir_mul(g, size, ir_make(g, IR_ABS, a.rest, IR_NONE, IR_NONE));
  }
  case IR_MIN:
  case IR_MAX:
    return factored_extreme(r, old, operand);
  default:
    return again(g, old, operand);
  }
}

void rewrite_choices(ir *g, const ir_node *roots, int root_count, ir_node *out) {
  unsigned char *marks = marks_of(g, roots, root_count);
  unsigned char *shared = shared_nodes(g, marks, IR_OP_COUNT);
  for (int k = 0; k < root_count; k++)
    if (roots[k] != IR_NONE) shared[roots[k]] = 1;
  rebuilding r = {.graph = g, .rule = choice_rule, .shared = shared};
  rebuild(&r, roots, root_count, out);
  free(shared);
  free(marks);
}

void rewrite_factors(ir *g, const ir_node *roots, int root_count, ir_node *out) {
  unsigned char *marks = marks_of(g, roots, root_count);
  unsigned char *shared = shared_nodes(g, marks, IR_ABS); /* factors leave it in any case */
  rebuilding r = {.graph = g, .rule = factor_rule, .shared = shared};
  rebuild(&r, roots, root_count, out);
  free(shared);
  free(marks);
}

/* --- fused sums of products ------------------------------------------------------------------- */

/* What has a name stays a value of its own: bodies at rest count on a length that is rounded before
   its reference is taken from it. */
static bool is_local_product(const ir *g, ir_node n) {
  return ir_operation(g, n) == IR_MUL && !ir_is_uniform(g, n) && !ir_name(g, n);
}

enum { NEEDS_NEIGHBOUR = 1, NEEDS_FAMILY = 2 };

/* Of two products the one that nothing else needs, else the second. None where the neighbour may
   have the one that the particle has not, both going over a family or neither: both ends of a bond
   would round another one. */
static int product_to_fuse(const rebuilding *r, ir_node old, const ir_node *operand) {
  const bool first = is_local_product(r->graph, operand[0]),
             second = is_local_product(r->graph, operand[1]);
  const unsigned char *needs = r->needs;
  const int other = needs[ir_operand(r->graph, old, 0)] ^ needs[ir_operand(r->graph, old, 1)];
  if ((needs[old] & NEEDS_NEIGHBOUR) && !(other & NEEDS_FAMILY) &&
      ir_operation(r->graph, operand[0]) == IR_MUL && ir_operation(r->graph, operand[1]) == IR_MUL)
    return -1;
  if (first && second)
    return r->shared[ir_operand(r->graph, old, 1)] && !r->shared[ir_operand(r->graph, old, 0)] ? 0
                                                                                               : 1;
  return first ? 0 : second ? 1 : -1;
}

static ir_node fused_rule(const rebuilding *r, ir_node old, const ir_node *operand) {
  ir *g = r->graph;
  const ir_op op = ir_operation(g, old);
  const int k = op == IR_ADD || op == IR_SUB ? product_to_fuse(r, old, operand) : -1;
  if (k < 0) return again(g, old, operand);
  ir_node a = ir_operand(g, operand[k], 0), b = ir_operand(g, operand[k], 1), rest = operand[1 - k];
  if (op == IR_SUB && k == 1) a = ir_neg(g, a);
  if (op == IR_SUB && k == 0) rest = ir_neg(g, rest);
  return ir_make(g, IR_FMA, a, b, rest);
}

static unsigned char *needs_of_nodes(const ir *g) {
  unsigned char *needs = must_calloc((size_t)ir_count(g) + 1, 1);
  for (ir_node n = 0; n < ir_count(g); n++) {
    const ir_op op = ir_operation(g, n);
    needs[n] = op == IR_NEIGHBOUR ? NEEDS_NEIGHBOUR : ir_is_reduction(op) ? NEEDS_FAMILY : 0;
    for (int k = 0; k < ir_arity(op); k++)
      needs[n] |= needs[ir_operand(g, n, k)];
  }
  return needs;
}

void rewrite_fused(ir *g, const ir_node *roots, int root_count, ir_node *out) {
  unsigned char *marks = marks_of(g, roots, root_count);
  unsigned char *shared = shared_nodes(g, marks, IR_OP_COUNT), *needs = needs_of_nodes(g);
  rebuilding r = {.graph = g, .rule = fused_rule, .shared = shared, .needs = needs};
  rebuild(&r, roots, root_count, out);
  free(shared);
  free(needs);
  free(marks);
}

/* --- questions -------------------------------------------------------------------------------- */

bool rewrite_depends(const ir *g, const ir_node *roots, int root_count, const ir_node *nodes,
                     int node_count) {
  unsigned char *marks = marks_of(g, roots, root_count);
  bool found = false;
  for (int k = 0; k < node_count; k++)
    found |= nodes[k] != IR_NONE && marks[nodes[k]];
  free(marks);
  return found;
}

static bool is_zero_degree(double degree) {
  return degree == REWRITE_ZERO;
}

/* Degree of a sum, a choice or a comparison of two parts: theirs, when they agree. */
static double common_degree(double a, double b) {
  if (is_zero_degree(a)) return b;
  if (is_zero_degree(b) || a == b) return a;
  return NAN;
}

static double degree_of_power(const ir *g, ir_node n, double base, double exponent) {
  ir_node power = ir_operand(g, n, 1);
  if (base == 0 && exponent == 0) return 0;
  if (ir_operation(g, power) != IR_CONSTANT || ir_value(g, power) <= 0) return NAN;
  return is_zero_degree(base) ? REWRITE_ZERO : base * ir_value(g, power);
}

/* Functions without a degree of their own: of a pure constant they are constant; some vanish at
   zero. */
static double degree_of_function(ir_op op, double a) {
  if (!is_zero_degree(a)) return a == 0 ? 0 : NAN;
  return operation_has(op, VANISHES) ? REWRITE_ZERO : 0;
}

static double degree_of_product(ir_op op, double a, double b) {
  if (is_zero_degree(a)) return REWRITE_ZERO;
  if (op == IR_MUL) return is_zero_degree(b) ? REWRITE_ZERO : a + b;
  return is_zero_degree(b) ? NAN : a - b;
}

static double degree_of(const ir *g, ir_node n, const double *degree) {
  ir_op op = ir_operation(g, n);
  double a = 0, b = 0, c = 0;
  if (ir_arity(op) > 0) a = degree[ir_operand(g, n, 0)];
  if (ir_arity(op) > 1) b = degree[ir_operand(g, n, 1)];
  if (ir_arity(op) > 2) c = degree[ir_operand(g, n, 2)];
  switch (op) {
  case IR_CONSTANT:
    return ir_value(g, n) == 0 ? REWRITE_ZERO : 0;
  case IR_INPUT:
    return 0;
  case IR_ADD:
  case IR_SUB:
  case IR_MIN:
  case IR_MAX:
    return common_degree(a, b);
  case IR_MUL:
  case IR_DIV:
    return degree_of_product(op, a, b);
  case IR_FMA:
    return common_degree(degree_of_product(IR_MUL, a, b), c);
  case IR_NEG:
  case IR_ABS:
    return a;
  case IR_SIGN:
    return is_zero_degree(a) ? a : 0 * a; /* NAN stays */
  case IR_SQRT:
    return is_zero_degree(a) ? a : a / 2;
  case IR_INVERSE_ROOT:
    return is_zero_degree(a) ? NAN : -a / 2;
  case IR_CBRT:
    return is_zero_degree(a) ? a : a / 3;
  case IR_POW:
    return degree_of_power(g, n, a, b);
  case IR_LT:
  case IR_LE:
  case IR_EQ:
  case IR_ATAN2:
    return 0 * common_degree(a, b); /* the same whatever the scale */
  case IR_AND:
  case IR_OR:
    return isnan(a) || isnan(b) ? NAN : 0;
  case IR_NOT:
    return isnan(a) ? NAN : 0;
  case IR_SELECT:
    return isnan(a) ? NAN : common_degree(b, c);
  case IR_SEARCH:
    return NAN;
  case IR_FAMILY_SUM:
  case IR_FAMILY_MAX:
  case IR_FAMILY_MIN:
  case IR_NEIGHBOUR:
    return a;
  default:
    return degree_of_function(op, a);
  }
}

double rewrite_degree(const ir *g, ir_node f, const ir_node *x, int count) {
  unsigned char *marks = marks_of(g, &f, 1);
  double *degree = must_calloc((size_t)f + 1, sizeof *degree);
  for (ir_node n = 0; n <= f; n++) {
    if (!marks[n]) continue;
    degree[n] = degree_of(g, n, degree);
    for (int k = 0; k < count; k++)
      if (n == x[k]) degree[n] = 1;
  }
  double result = degree[f];
  free(degree);
  free(marks);
  return result;
}

/* --- NaN -------------------------------------------------------------------------------------- */

/* Nodes that are still to be looked at, each once; a walk that has looked at very many gives up. */
typedef struct walk {
  const ir *graph;
  unsigned char *met; /* [ir_count] */
  ir_node *list;      /* [MOST_LOOKS] */
  int count;
} walk;

enum { MOST_LOOKS = 10000 };

static walk walk_from(const ir *g, ir_node n) {
  walk w = {g, must_calloc((size_t)ir_count(g), 1), must_alloc(MOST_LOOKS * sizeof(ir_node)), 0};
  w.met[n] = 1;
  w.list[w.count++] = n;
  return w;
}

/* False where there is no room left. */
static bool walk_on(walk *w, ir_node n) {
  for (int k = 0; k < ir_arity(ir_operation(w->graph, n)); k++) {
    const ir_node operand = ir_operand(w->graph, n, k);
    if (w->met[operand]) continue;
    if (w->count == MOST_LOOKS) return false;
    w->met[operand] = 1;
    w->list[w->count++] = operand;
  }
  return true;
}

static void walk_end(walk *w) {
  free(w->met);
  free(w->list);
}

/* What, being NaN, surely makes n NaN: n itself, and what arithmetic alone leads from. */
static walk walk_of_nan(const ir *g, ir_node n) {
  walk w = walk_from(g, n);
  for (int k = 0; k < w.count; k++)
    if (operation_has(ir_operation(g, w.list[k]), ARITHMETIC) && !walk_on(&w, w.list[k])) break;
  return w;
}

bool rewrite_nan_follows(const ir *g, ir_node a, ir_node b) {
  walk reaching = walk_of_nan(g, b), open = walk_from(g, a);
  bool follows = true;
  for (int k = 0; k < open.count && follows; k++) {
    const ir_node n = open.list[k];
    if (reaching.met[n] || ir_is_uniform(g, n)) continue;
    const ir_op op = ir_operation(g, n);
    follows = op != IR_INPUT && !operation_has(op, MAKES_NAN) && walk_on(&open, n);
  }
  walk_end(&reaching);
  walk_end(&open);
  return follows;
}

/* --- rounding --------------------------------------------------------------------------------- */

static ir_node size_of(ir *g, ir_node n, int deep);

/* Of a function that can be 0 where its operands are not: how much these move it. */
static ir_node size_of_function(ir *g, ir_node n, int deep) {
  ir_node sum = ir_unary(g, IR_ABS, n);
  for (int k = 0; k < ir_arity(ir_operation(g, n)); k++) {
    const ir_node of = ir_operand(g, n, k), slope = ir_derivative(g, n, of);
    const ir_node size = size_of(g, of, deep + 1);
    sum = ir_add(g, sum, ir_mul(g, ir_unary(g, IR_ABS, slope), size));
  }
  return sum;
}

static ir_node size_of(ir *g, ir_node n, int deep) {
  enum { DEEP = 10 };
  const ir_op op = ir_operation(g, n);
  if (deep == DEEP || ir_arity(op) == 0 || op == IR_SEARCH) return ir_unary(g, IR_ABS, n);
  ir_node of[3] = {IR_NONE, IR_NONE, IR_NONE};
  switch (op) {
  case IR_ADD:
  case IR_SUB:
  case IR_MUL:
  case IR_DIV:
  case IR_NEG:
  case IR_SELECT:
  case IR_MIN:
  case IR_MAX:
    for (int k = op == IR_SELECT; k < ir_arity(op); k++)
      of[k] = size_of(g, ir_operand(g, n, k), deep + 1);
    break;
  default:
    return operations[op].image.low < 0 ? size_of_function(g, n, deep) : ir_unary(g, IR_ABS, n);
  }
  if (op == IR_NEG) return of[0];
  if (op == IR_SELECT) return ir_select(g, ir_operand(g, n, 0), of[1], of[2]);
  if (op == IR_MUL) return ir_mul(g, of[0], of[1]);
  if (op == IR_DIV) return ir_div(g, of[0], ir_unary(g, IR_ABS, ir_operand(g, n, 1)));
  return ir_add(g, of[0], of[1]);
}

ir_node rewrite_size(ir *g, ir_node n) {
  return size_of(g, n, 0);
}
