#include "generator/intervals/interval_ranges.h"

#include <math.h>

#include "dsl/base/elementary.h"
#include "generator/intervals/interval_warning.h"

enum { DEEPEST = 150 };
enum { UNSEEN, BEGUN, DONE };
static const long MOST_COMBINATIONS = 200000;

/* --- what a guard says ------------------------------------------------------------------------ */

static bool is_zero(const ir *g, ir_node n) {
  return ir_operation(g, n) == IR_CONSTANT && ir_value(g, n) == 0;
}

/* n > 0: so is what is left when positive factors and divisors are taken away, and x of max(x, 0).
 */
static void assume_positive(analysis *a, context *c, ir_node n) {
  const ir *g = a->graph;
  ir_op op = ir_operation(g, n);
  sum whole = sum_of(g, n);
  context_add_relation(g, c, POSITIVE, &whole);
  if (op != IR_MUL && op != IR_DIV && op != IR_MAX) return;
  ir_node p = ir_operand(g, n, 0), q = ir_operand(g, n, 1);
  if (op == IR_MAX ? is_zero(g, q) : range_is_positive(interval_value(a, c->outer, q)))
    assume_positive(a, c, p);
  else if (op == IR_MAX ? is_zero(g, p)
                        : op == IR_MUL && range_is_positive(interval_value(a, c->outer, p)))
    assume_positive(a, c, q);
}

static void assume(analysis *a, context *c, ir_node guard, bool truth) {
  const ir *g = a->graph;
  ir_op op = ir_operation(g, guard);
  ir_node p = ir_arity(op) > 0 ? ir_operand(g, guard, 0) : IR_NONE;
  ir_node q = ir_arity(op) > 1 ? ir_operand(g, guard, 1) : IR_NONE;
  if (op == IR_NOT)
    assume(a, c, p, !truth);
  else if ((op == IR_AND && truth) || (op == IR_OR && !truth)) {
    assume(a, c, p, truth);
    assume(a, c, q, truth);
  } else if (op == IR_LT && truth && is_zero(g, p))
    assume_positive(a, c, q);
  else if (op == IR_LT)
    context_relate(a, c, truth ? POSITIVE : NOT_NEGATIVE, truth ? p : q, truth ? q : p);
  else if (op == IR_LE)
    context_relate(a, c, truth ? NOT_NEGATIVE : POSITIVE, truth ? p : q, truth ? q : p);
  else if (op == IR_EQ && !truth)
    context_relate(a, c, NOT_ZERO, p, q);
  else if (op == IR_EQ) {
    context_relate(a, c, NOT_NEGATIVE, p, q);
    context_relate(a, c, NOT_NEGATIVE, q, p);
  }
}

/* --- ranges of sums --------------------------------------------------------------------------- */

static range term_range(analysis *a, context *c, const sum_term *t) {
  range r = range_of(t->coefficient);
  for (int k = 0; k < t->count; k++) {
    range f = interval_value(a, c, t->factor[k]);
    bool squared = k + 1 < t->count && t->factor[k + 1] == t->factor[k];
    r = range_mul(r, squared ? range_square(f) : f);
    k += squared;
  }
  return r;
}

/* Term by term; with a factor that all terms share taken out. */
static range plain_range(analysis *a, context *c, const sum *s) {
  range r = range_of(0);
  for (int k = 0; k < s->count; k++)
    r = range_add(r, term_range(a, c, &s->term[k]));
  sum rest = *s;
  ir_node shared = sum_take_factor(&rest);
  if (shared != IR_NONE)
    r = range_meet(r, range_mul(interval_value(a, c, shared), plain_range(a, c, &rest)));
  return r;
}

static range sum_range(analysis *a, context *c, const sum *s, int effort);

/* max(p, q) is at least p and at least q, |x| at least x and -x: the sum with either in its place.
 */
static range bent_range(analysis *a, context *c, const sum *s, int effort) {
  range r = range_all();
  for (int k = 0; k < s->count; k++) {
    sum with_p, with_q;
    if (!sum_unbend(a->graph, s, k, &with_p, &with_q)) continue;
    range x = sum_range(a, c, &with_p, effort - 1), y = sum_range(a, c, &with_q, effort - 1);
    r = range_meet(r,
                   range_apply(sum_term_is_least(a->graph, &s->term[k]) ? IR_MIN : IR_MAX, x, y));
  }
  return r;
}

/* The sum is k times a relation and a rest, k > 0: it is at least the rest. */
static range least_by(analysis *a, context *c, const sum *s, const relation *known, int effort) {
  range r = range_all();
  for (int p = 0; p < s->count && known->kind != NOT_ZERO; p++)
    for (int q = 0; q < known->of.count; q++) {
      double k = s->term[p].coefficient / known->of.term[q].coefficient;
      sum rest;
      if (a->combinations > MOST_COMBINATIONS) return r;
      if (!(k > 0) || !sum_same_factors(&s->term[p], &known->of.term[q]) ||
          !sum_combine(s, -k, &known->of, &rest))
        continue;
      a->combinations++;
      range left = sum_range(a, c, &rest, effort - 1);
      r = range_meet(
          r, range_between(left.low, INFINITY, left.low_open || known->kind == POSITIVE, true));
    }
  return r;
}

static range related_range(analysis *a, context *c, const sum *s, int effort) {
  range r = range_all();
  sum minus, none = {0};
  sum_combine(&none, -1, s, &minus);
  for (context *at = c; at; at = at->outer)
    for (int k = 0; k < at->relation_count; k++) {
      r = range_meet(r, least_by(a, c, s, &at->relations[k], effort));
      r = range_meet(r, range_neg(least_by(a, c, &minus, &at->relations[k], effort)));
    }
  return r;
}

static range sum_range(analysis *a, context *c, const sum *s, int effort) {
  range r = plain_range(a, c, s);
  if (s->count < 2 || effort <= 0) return r;
  r = range_meet(r, bent_range(a, c, s, effort));
  return range_meet(r, related_range(a, c, s, effort));
}

/* True when a guard says that the sum is other than 0. */
static bool known_not_zero(analysis *a, const context *c, ir_node n) {
  sum s = sum_of(a->graph, n);
  for (const context *at = c; at; at = at->outer)
    for (int k = 0; k < at->relation_count; k++)
      if (at->relations[k].kind != NOT_NEGATIVE && sum_is_multiple(&s, &at->relations[k].of))
        return true;
  return false;
}

/* --- ranges of nodes -------------------------------------------------------------------------- */

/* What the relations say of a node that stands alone in one of their terms. The others are taken as
   they are outside the branch, so that two that bound each other do not wait for each other. */
static range tightened(analysis *a, context *c, ir_node n, range r) {
  for (context *at = c; at->outer; at = at->outer)
    for (int k = 0; k < at->relation_count; k++) {
      const relation *known = &at->relations[k];
      for (int q = 0; q < known->of.count; q++) {
        const sum_term *t = &known->of.term[q];
        if (t->count != 1 || t->factor[0] != n) continue;
        sum rest = known->of;
        rest.term[q] = rest.term[--rest.count];
        bool open = known->kind == POSITIVE;
        if (known->kind == NOT_ZERO) { /* next to 0 it moves an end that would be there */
          if (rest.count == 0 && r.low == 0) r.low_open = true;
          if (rest.count == 0 && r.high == 0) r.high_open = true;
          continue;
        }
        range other = range_mul(plain_range(a, at->outer, &rest), range_of(-1 / t->coefficient));
        range bound = t->coefficient > 0
                          ? range_between(other.low, INFINITY, open || other.low_open, true)
                          : range_between(-INFINITY, other.high, true, open || other.high_open);
        r = range_meet(r, bound);
      }
    }
  return r;
}

static range quantity_range(int q) {
  switch (q) {
  case QUANTITY_STRETCH:
    return range_between(-1, INFINITY, true, true);
  case QUANTITY_STRETCH_RATE:
  case QUANTITY_THETA_I:
  case QUANTITY_THETA_J:
    return range_all();
  case QUANTITY_DT:
    return range_between(0, INFINITY, false, true);
  case QUANTITY_SHELL:
  case QUANTITY_N_FAMILY:
    return range_between(1, INFINITY, false, true);
  default:
    return range_between(0, INFINITY, true, true);
  }
}

static range input_range(analysis *a, context *c, ir_node n) {
  int k = ir_input_index(a->graph, n);
  switch (ir_input_source(a->graph, n)) {
  case IR_FROM_QUANTITY:
    return quantity_range(k);
  case IR_FROM_FIELD:
    return k < a->law->fields.count ? a->fields[k] : range_all();
  case IR_FROM_PARAMETER: {
    const bounds *in = &a->law->parameters.items[k]->declared->in;
    range low = interval_value(a, c, a->lower[k]), high = interval_value(a, c, a->upper[k]);
    return range_between(low.low, high.high, in->lower_open || low.low_open,
                         in->upper_open || high.high_open);
  }
  default:
    return range_all();
  }
}

static range quotient(analysis *a, context *c, ir_node n, range p, range q) {
  const ir *g = a->graph;
  range r = range_div(p, q);
  sum above = sum_of(g, ir_operand(g, n, 0)), below = sum_of(g, ir_operand(g, n, 1)), s;
  if (!range_is_positive(q)) return r;
  if (sum_combine(&below, -1, &above, &s)) {
    range d = sum_range(a, c, &s, 1);
    if (range_is_nonnegative(d))
      r = range_meet(r, range_between(-INFINITY, 1, true, range_is_positive(d)));
    if (range_is_nonnegative(range_neg(d)))
      r = range_meet(r, range_between(1, INFINITY, range_is_positive(range_neg(d)), true));
  }
  if (sum_combine(&below, 1, &above, &s)) {
    range d = sum_range(a, c, &s, 1);
    if (range_is_nonnegative(d))
      r = range_meet(r, range_between(-1, INFINITY, range_is_positive(d), true));
  }
  return r;
}

static bool is_decided(range r, bool *truth) {
  *truth = r.low > 0;
  return r.low > 0 || r.high < 1;
}

/* a < b, a <= b, a == b: what the difference says. */
static range comparison_range(analysis *a, context *c, ir_node n) {
  const ir *g = a->graph;
  ir_node p = ir_operand(g, n, 0), q = ir_operand(g, n, 1);
  sum x = sum_of(g, p), y = sum_of(g, q), s;
  range either = range_between(0, 1, false, false);
  interval_value(a, c, p); /* whatever they hold is looked at */
  interval_value(a, c, q);
  if (p == q) return range_of(ir_operation(g, n) != IR_LT); /* not a number is found elsewhere */
  if (!sum_combine(&y, -1, &x, &s)) return either;
  range d = sum_range(a, c, &s, 1), m = range_neg(d);
  switch (ir_operation(g, n)) {
  case IR_LT:
    return range_is_positive(d) ? range_of(1) : range_is_nonnegative(m) ? range_of(0) : either;
  case IR_LE:
    return range_is_nonnegative(d) ? range_of(1) : range_is_positive(m) ? range_of(0) : either;
  default:
    return range_is_positive(d) || range_is_positive(m) ? range_of(0) : either;
  }
}

static range branch_range(analysis *a, context *c, ir_node guard, bool truth, ir_node n) {
  if (a->contexts >= a->most_contexts) return range_all();
  context *inner = context_new(a, c, guard, truth);
  assume(a, inner, guard, truth);
  return interval_value(a, inner, n);
}

static range choice_range(analysis *a, context *c, ir_node n) {
  const ir *g = a->graph;
  ir_node guard = ir_operand(g, n, 0), yes = ir_operand(g, n, 1), no = ir_operand(g, n, 2);
  bool truth;
  if (is_decided(interval_value(a, c, guard), &truth))
    return interval_value(a, c, truth ? yes : no);
  return range_join(branch_range(a, c, guard, true, yes), branch_range(a, c, guard, false, no));
}

/* --- what is not defined ---------------------------------------------------------------------- */

static void check_operation(analysis *a, context *c, ir_node n, range p, range q) {
  const ir *g = a->graph;
  ir_node first = ir_operand(g, n, 0);
  switch (ir_operation(g, n)) {
  case IR_DIV: {
    ir_node below = ir_operand(g, n, 1);
    if (range_holds(q, 0) && !known_not_zero(a, c, below)) {
      sum s = sum_of(g, below);
      if (range_holds(sum_range(a, c, &s, 2), 0)) interval_warn(a, c, n, below, WISH_ZERO);
    }
    return;
  }
  case IR_SQRT:
    if (p.low < 0) {
      sum s = sum_of(g, first);
      if (sum_range(a, c, &s, 2).low < 0) interval_warn(a, c, n, first, WISH_NEGATIVE);
    }
    return;
  case IR_ASIN:
  case IR_ACOS:
    if (p.low < -1 || p.high > 1) interval_warn(a, c, n, first, WISH_BEYOND_ONE);
    return;
  case IR_LOG:
  case IR_LOG10:
    if (!range_is_positive(p)) interval_warn(a, c, n, first, WISH_NOT_POSITIVE);
    return;
  case IR_POW:
    if (!range_is_nonnegative(p))
      interval_warn(a, c, n, first, WISH_NEGATIVE_BASE);
    else if (range_holds(p, 0) && q.low < 0)
      interval_warn(a, c, n, first, WISH_ZERO);
    return;
  default:
    return;
  }
}

static range operation_range(analysis *a, context *c, ir_node n) {
  const ir *g = a->graph;
  ir_op op = ir_operation(g, n);
  if (op == IR_LT || op == IR_LE || op == IR_EQ) return comparison_range(a, c, n);
  ir_node first = ir_operand(g, n, 0), second = ir_arity(op) > 1 ? ir_operand(g, n, 1) : IR_NONE;
  range p = interval_value(a, c, first),
        q = second == IR_NONE ? range_all() : interval_value(a, c, second);
  check_operation(a, c, n, p, q);
  sum s;
  switch (op) {
  case IR_ADD:
  case IR_SUB:
    s = sum_of(g, n);
    return range_meet(range_add(p, op == IR_ADD ? q : range_neg(q)), sum_range(a, c, &s, 1));
  case IR_MUL:
    return first == second ? range_square(p) : range_mul(p, q);
  case IR_DIV:
    return quotient(a, c, n, p, q);
  case IR_NEG:
    return range_neg(p);
  case IR_NOT:
    return range_between(1 - p.high, 1 - p.low, false, false);
  case IR_AND:
    return p.high < 1 || q.high < 1 ? range_of(0)
                                    : range_between(pl_fmin(p.low, q.low), 1, false, false);
  case IR_OR:
    return p.low > 0 || q.low > 0 ? range_of(1)
                                  : range_between(0, pl_fmax(p.high, q.high), false, false);
  default:
    return range_apply(op, p, q);
  }
}

/* The new value of a state that has a rate is what the rate lets it be. */
static bool is_gone_on(const analysis *a, ir_node n, range *r) {
  for (int k = 0; k < a->law->fields.count; k++)
    if (a->bench->law_step.fields[k] == n && law_rate_field(a->law, k) >= 0) {
      *r = a->fields[k];
      return true;
    }
  return false;
}

range interval_value(analysis *a, context *c, ir_node n) {
  if (c->state[n] == DONE) return c->known[n];
  if (c->state[n] == BEGUN) /* bounds that refer to each other */
    return range_all();
  if (a->depth > DEEPEST) return range_all();
  c->state[n] = BEGUN;
  a->depth++;
  range r;
  switch (ir_operation(a->graph, n)) {
  case IR_CONSTANT:
    r = range_of(ir_value(a->graph, n));
    break;
  case IR_INPUT:
    r = input_range(a, c, n);
    break;
  case IR_SELECT:
    r = choice_range(a, c, n);
    break;
  default:
    if (!is_gone_on(a, n, &r)) r = operation_range(a, c, n);
  }
  r = tightened(a, c, n, r);
  a->depth--;
  c->known[n] = r;
  c->state[n] = DONE;
  return r;
}
