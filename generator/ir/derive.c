#include "generator/ir/derive.h"

#include <stdlib.h>

/* Derivatives in the order of the nodes (forward): each node's is built from its operands' once. A
   derivative that is zero for structural reasons is IR_NONE and leaves no nodes behind: 0*u = 0
   here even where u is not finite. */

static ir_node nothing_if_zero(const ir *g, ir_node n) {
  const bool zero = n != IR_NONE && ir_operation(g, n) == IR_CONSTANT && ir_value(g, n) == 0.0;
  return zero ? IR_NONE : n;
}

static ir_node number(ir *g, double value) {
  return ir_constant(g, value);
}

static ir_node sum(ir *g, ir_node a, ir_node b) {
  if (a == IR_NONE) return b;
  return b == IR_NONE ? a : ir_add(g, a, b);
}

static ir_node difference(ir *g, ir_node a, ir_node b) {
  if (b == IR_NONE) return a;
  return a == IR_NONE ? ir_neg(g, b) : ir_sub(g, a, b);
}

/* a times the derivative d. */
static ir_node times(ir *g, ir_node a, ir_node d) {
  return d == IR_NONE || nothing_if_zero(g, a) == IR_NONE ? IR_NONE : ir_mul(g, a, d);
}

static ir_node over(ir *g, ir_node d, ir_node a) {
  return d == IR_NONE ? IR_NONE : ir_div(g, d, a);
}

static ir_node choose(ir *g, ir_node condition, ir_node yes, ir_node no) {
  if (yes == no) return yes;
  if (yes == IR_NONE) yes = number(g, 0.0);
  return ir_select(g, condition, yes, no == IR_NONE ? number(g, 0.0) : no);
}

/* An operation q = op(a, b, c) and the derivatives of its operands. */
typedef struct term {
  ir_op op;
  ir_node q, a, b, c, da, db, dc;
} term;

static ir_node of_product(ir *g, const term *t) {
  if (t->a == t->b) {
    const ir_node product = times(g, t->a, t->da);
    return times(g, number(g, 2.0), product);
  }
  const ir_node first = times(g, t->b, t->da);
  return sum(g, first, times(g, t->a, t->db));
}

/* (a/b)' = (a' - q b')/b. */
static ir_node of_quotient(ir *g, const term *t) {
  return over(g, difference(g, t->da, times(g, t->q, t->db)), t->b);
}

/* The guard gives 0 instead of 0/0 where the root and its argument's derivative vanish together. */
static ir_node of_root(ir *g, const term *t) {
  const ir_node twice = ir_mul(g, number(g, 2.0), t->q);
  return over(g, t->da, ir_make(g, IR_MAX, twice, number(g, 1e-290), IR_NONE));
}

/* (a^b)' = b a^(b-1) a' + a^b log(a) b'; the last term is 0 where the power is. */
static ir_node of_power(ir *g, const term *t) {
  ir_node by_base = IR_NONE;
  if (t->da != IR_NONE) {
    const ir_node lower = ir_power(g, t->a, ir_sub(g, t->b, number(g, 1.0)));
    by_base = times(g, ir_mul(g, t->b, lower), t->da);
  }
  if (t->db == IR_NONE) return by_base;
  const ir_node zero = number(g, 0.0);
  const ir_node growth = ir_mul(g, t->q, ir_unary(g, IR_LOG, t->a));
  const ir_node vanishes = ir_make(g, IR_EQ, t->q, zero, IR_NONE);
  return sum(g, by_base, times(g, ir_select(g, vanishes, zero, growth), t->db));
}

static ir_node of_cube_root(ir *g, const term *t) {
  return over(g, t->da, ir_scaled(g, 3.0, ir_mul(g, t->q, t->q)));
}

/* Angle of (b, a): (b a' - a b')/(a^2 + b^2). */
static ir_node of_angle(ir *g, const term *t) {
  const ir_node a_square = ir_mul(g, t->a, t->a), b_square = ir_mul(g, t->b, t->b);
  const ir_node first = times(g, t->b, t->da), second = times(g, t->a, t->db);
  const ir_node square = ir_add(g, a_square, b_square);
  return over(g, difference(g, first, second), square);
}

static ir_node of_least(ir *g, const term *t) {
  return choose(g, ir_make(g, IR_LT, t->a, t->b, IR_NONE), t->da, t->db);
}

static ir_node of_most(ir *g, const term *t) {
  return choose(g, ir_make(g, IR_LT, t->b, t->a, IR_NONE), t->da, t->db);
}

/* 1 + q^2 and 1 - q^2, for tan and tanh. */
static ir_node one_and_square(ir *g, ir_op op, ir_node q) {
  const ir_node square = ir_mul(g, q, q);
  return ir_make(g, op, number(g, 1.0), square, IR_NONE);
}

/* a'/sqrt((1 - a)(1 + a)), of asin; where the root is 0, as in of_root. */
static ir_node of_arc_sine(ir *g, const term *t) {
  const ir_node one = number(g, 1.0), below = ir_sub(g, one, t->a), above = ir_add(g, one, t->a);
  const ir_node root = ir_unary(g, IR_SQRT, ir_mul(g, below, above));
  return over(g, t->da, ir_make(g, IR_MAX, root, number(g, 1e-290), IR_NONE));
}

/* The neighbours that attain the extreme. */
static ir_node of_family_extreme(ir *g, const term *t) {
  const ir_node attains = ir_make(g, IR_EQ, t->a, t->q, IR_NONE);
  return t->da == IR_NONE ? IR_NONE
                          : ir_unary(g, IR_FAMILY_SUM, choose(g, attains, t->da, IR_NONE));
}

/* At a root the slope of the step by anything is how the root follows it: -f_x/f_z. */
static ir_node of_search(ir *g, const term *t) {
  const ir_node sought = ir_sought(g);
  ir_node follows = t->db;
  if (follows != IR_NONE) ir_substitute(g, &follows, 1, &sought, &t->q, 1, &follows);
  return follows;
}

static ir_node of_operation(ir *g, const term *t) {
  switch (t->op) {
  case IR_ADD:
    return sum(g, t->da, t->db);
  case IR_SUB:
    return difference(g, t->da, t->db);
  case IR_MUL:
    return of_product(g, t);
  case IR_FMA:
    return sum(g, of_product(g, t), t->dc);
  case IR_DIV:
    return of_quotient(g, t);
  case IR_NEG:
    return difference(g, IR_NONE, t->da);
  case IR_ABS:
    return times(g, ir_unary(g, IR_SIGN, t->a), t->da);
  case IR_SQRT:
    return of_root(g, t);
  case IR_MIN:
    return of_least(g, t);
  case IR_MAX:
    return of_most(g, t);
  case IR_EXP:
    return times(g, t->q, t->da);
  case IR_LOG:
    return over(g, t->da, t->a);
  case IR_LOG10:
    return over(g, times(g, number(g, PL_LGE_HI), t->da), t->a);
  case IR_POW:
    return of_power(g, t);
  case IR_INVERSE_ROOT:
    return times(g, ir_scaled(g, -0.5, ir_mul(g, t->q, ir_mul(g, t->q, t->q))), t->da);
  case IR_CBRT:
    return of_cube_root(g, t);
  case IR_SIN:
    return times(g, ir_unary(g, IR_COS, t->a), t->da);
  case IR_COS:
    return difference(g, IR_NONE, times(g, ir_unary(g, IR_SIN, t->a), t->da));
  case IR_TAN:
    return times(g, one_and_square(g, IR_ADD, t->q), t->da);
  case IR_ASIN:
    return of_arc_sine(g, t);
  case IR_ACOS:
    return difference(g, IR_NONE, of_arc_sine(g, t));
  case IR_SINH:
    return times(g, ir_unary(g, IR_COSH, t->a), t->da);
  case IR_COSH:
    return times(g, ir_unary(g, IR_SINH, t->a), t->da);
  case IR_TANH:
    return times(g, one_and_square(g, IR_SUB, t->q), t->da);
  case IR_ATAN2:
    return of_angle(g, t);
  case IR_WRAP_ANGLE:
    return t->da;
  case IR_SELECT:
    return choose(g, t->a, t->db, t->dc);
  case IR_FAMILY_SUM:
    return t->da == IR_NONE ? IR_NONE : ir_unary(g, IR_FAMILY_SUM, t->da);
  case IR_FAMILY_MAX:
  case IR_FAMILY_MIN:
    return of_family_extreme(g, t);
  case IR_NEIGHBOUR:
    return t->da == IR_NONE ? IR_NONE : ir_unary(g, IR_NEIGHBOUR, t->da);
  case IR_SEARCH:
    return of_search(g, t);
  case IR_CONSTANT:
  case IR_INPUT: /* others than x */
  case IR_SIGN:
  case IR_LT:
  case IR_LE:
  case IR_EQ:
  case IR_AND:
  case IR_OR:
  case IR_NOT:
  case IR_OP_COUNT:
    return IR_NONE; /* flat where they are smooth */
  }
  return IR_NONE;
}

static ir_node of_node(ir *g, ir_node n, const ir_node *slope) {
  term t = {.op = ir_operation(g, n), .q = n};
  ir_node *const operand[3] = {&t.a, &t.b, &t.c};
  ir_node *const change[3] = {&t.da, &t.db, &t.dc};
  bool varies = false;
  for (int k = 0; k < ir_arity(t.op); k++) {
    *operand[k] = ir_operand(g, n, k);
    *change[k] = slope[*operand[k]];
    varies = varies || *change[k] != IR_NONE;
  }
  return varies ? nothing_if_zero(g, of_operation(g, &t)) : IR_NONE;
}

ir_node ir_derivative(ir *g, ir_node f, ir_node x) {
  const size_t count = (size_t)f + 1;
  unsigned char *marks = must_calloc((size_t)ir_count(g), 1);
  ir_node *slope = must_alloc(sizeof(ir_node) * count);
  ir_mark(g, &f, 1, marks);
  for (ir_node n = 0; n <= f; n++) {
    slope[n] = IR_NONE;
    if (n == x)
      slope[n] = ir_constant(g, 1.0);
    else if (n > x && marks[n])
      slope[n] = of_node(g, n, slope);
  }
  const ir_node result = slope[f] == IR_NONE ? ir_constant(g, 0.0) : slope[f];
  free(slope);
  free(marks);
  return result;
}
