/* The range of every value of a law, case by case, and what may not be defined within them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/check/physics_bench.h"
#include "generator/intervals/interval_sums.h"
#include "generator/intervals/interval_witness.h"
#include "generator/ir/interval.h"

enum {
  MOST_CONTEXTS = 600,
  MOST_RELATIONS = 24,
  DEEPEST = 150,
  MOST_SEARCHES = 40,
  MOST_TRIES = 3
};
static const long MOST_MEMORY = 20000000; /* numbers, in all contexts */
static const long MOST_COMBINATIONS = 200000;

typedef enum relation_kind { NOT_NEGATIVE, POSITIVE, NOT_ZERO } relation_kind;
typedef struct relation {
  relation_kind kind;
  sum of;
} relation;

/* What is known in a branch: relations, and ranges of nodes that follow from them. */
typedef struct context {
  struct context *outer;
  relation relations[MOST_RELATIONS];
  int relation_count;
  ir_node guard; /* that made it; IR_NONE for the whole law */
  bool truth;
  range *known;         /* [nodes] */
  unsigned char *state; /* [nodes] */
} context;
enum { UNSEEN, BEGUN, DONE };

typedef struct analysis {
  bench *bench;
  ir *graph;
  const law *law;
  diagnostics *said;
  arena *memory;
  int nodes, contexts, most_contexts, searches, depth;
  long combinations;      /* of sums with relations so far */
  ir_node *lower, *upper; /* [parameters] */
  range *fields;          /* [fields] what a bond can reach from the initial values */
  unsigned char *tried;   /* [nodes] searches for a state, in different branches */
  bool quiet;
} analysis;

static range value_of(analysis *a, context *c, ir_node n);

/* --- contexts --------------------------------------------------------------------------------- */

static context *new_context(analysis *a, context *outer, ir_node guard, bool truth) {
  context *c = arena_alloc(a->memory, sizeof *c);
  c->outer = outer;
  c->guard = guard;
  c->truth = truth;
  c->known = arena_alloc(a->memory, (size_t)a->nodes * sizeof *c->known);
  c->state = arena_alloc(a->memory, (size_t)a->nodes);
  a->contexts++;
  return c;
}

/* The sums with either operand in place of max, min or |x| in term k; false where it holds none. */
static bool unbend(const ir *g, const sum *s, int k, sum *with_first, sum *with_second) {
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

/* True when the sum is at most both of those that unbend gives: c - |x| is at most c - x and c + x.
 */
static bool is_least(const ir *g, const sum_term *t) {
  return (ir_operation(g, t->factor[0]) == IR_MIN) == (t->coefficient > 0);
}

static void add_relation(const ir *g, context *c, relation_kind kind, const sum *of) {
  if (c->relation_count == MOST_RELATIONS || of->count == 0) return;
  c->relations[c->relation_count++] = (relation){kind, *of};
  for (int k = 0; k < of->count && kind != NOT_ZERO; k++) {
    sum p, q;
    if (!unbend(g, of, k, &p, &q) || !is_least(g, &of->term[k])) continue;
    add_relation(g, c, kind, &p);
    add_relation(g, c, kind, &q);
    return;
  }
}

/* b - a > 0 and the like. */
static void relate(analysis *a, context *c, relation_kind kind, ir_node less, ir_node more) {
  sum p = sum_of(a->graph, more), q = sum_of(a->graph, less), difference;
  if (sum_combine(&p, -1, &q, &difference)) add_relation(a->graph, c, kind, &difference);
}

static bool is_zero(const ir *g, ir_node n) {
  return ir_operation(g, n) == IR_CONSTANT && ir_value(g, n) == 0;
}

/* n > 0: so is what is left when positive factors and divisors are taken away, and x of max(x, 0).
 */
static void assume_positive(analysis *a, context *c, ir_node n) {
  const ir *g = a->graph;
  ir_op op = ir_operation(g, n);
  sum whole = sum_of(g, n);
  add_relation(g, c, POSITIVE, &whole);
  if (op != IR_MUL && op != IR_DIV && op != IR_MAX) return;
  ir_node p = ir_operand(g, n, 0), q = ir_operand(g, n, 1);
  if (op == IR_MAX ? is_zero(g, q) : range_is_positive(value_of(a, c->outer, q)))
    assume_positive(a, c, p);
  else if (op == IR_MAX ? is_zero(g, p)
                        : op == IR_MUL && range_is_positive(value_of(a, c->outer, p)))
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
    relate(a, c, truth ? POSITIVE : NOT_NEGATIVE, truth ? p : q, truth ? q : p);
  else if (op == IR_LE)
    relate(a, c, truth ? NOT_NEGATIVE : POSITIVE, truth ? p : q, truth ? q : p);
  else if (op == IR_EQ && !truth)
    relate(a, c, NOT_ZERO, p, q);
  else if (op == IR_EQ) {
    relate(a, c, NOT_NEGATIVE, p, q);
    relate(a, c, NOT_NEGATIVE, q, p);
  }
}

/* --- ranges of sums --------------------------------------------------------------------------- */

static range term_range(analysis *a, context *c, const sum_term *t) {
  range r = range_of(t->coefficient);
  for (int k = 0; k < t->count; k++) {
    range f = value_of(a, c, t->factor[k]);
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
    r = range_meet(r, range_mul(value_of(a, c, shared), plain_range(a, c, &rest)));
  return r;
}

static range sum_range(analysis *a, context *c, const sum *s, int effort);

/* max(p, q) is at least p and at least q, |x| at least x and -x: the sum with either in its place.
 */
static range bent_range(analysis *a, context *c, const sum *s, int effort) {
  range r = range_all();
  for (int k = 0; k < s->count; k++) {
    sum with_p, with_q;
    if (!unbend(a->graph, s, k, &with_p, &with_q)) continue;
    range x = sum_range(a, c, &with_p, effort - 1), y = sum_range(a, c, &with_q, effort - 1);
    r = range_meet(r, range_apply(is_least(a->graph, &s->term[k]) ? IR_MIN : IR_MAX, x, y));
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
    range low = value_of(a, c, a->lower[k]), high = value_of(a, c, a->upper[k]);
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
  value_of(a, c, p); /* whatever they hold is looked at */
  value_of(a, c, q);
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
  context *inner = new_context(a, c, guard, truth);
  assume(a, inner, guard, truth);
  return value_of(a, inner, n);
}

static range choice_range(analysis *a, context *c, ir_node n) {
  const ir *g = a->graph;
  ir_node guard = ir_operand(g, n, 0), yes = ir_operand(g, n, 1), no = ir_operand(g, n, 2);
  bool truth;
  if (is_decided(value_of(a, c, guard), &truth)) return value_of(a, c, truth ? yes : no);
  return range_join(branch_range(a, c, guard, true, yes), branch_range(a, c, guard, false, no));
}

/* --- what is not defined ---------------------------------------------------------------------- */

static int conditions_of(const context *c, interval_condition *out, int most) {
  int count = 0;
  for (; c && count < most; c = c->outer)
    if (c->guard != IR_NONE) out[count++] = (interval_condition){c->guard, c->truth};
  return count;
}

static span place_of(const analysis *a, ir_node n) {
  const lowered_text *t = &a->bench->law_step.text;
  for (int k = 0; k < t->place_count; k++)
    if (t->places[k].node == n) return t->places[k].where;
  for (ir_node at = n; at < a->nodes; at++) /* what it goes into stands behind it */
    if (ir_name(a->graph, at) && ir_where(a->graph, at).end > 0) return ir_where(a->graph, at);
  return a->law->tree->name_where;
}

/* A function called many times is one place. */
static bool said_before(const analysis *a, diag_code code, span where) {
  for (int k = 0; k < a->said->count; k++) {
    const diagnostic *d = &a->said->items[k];
    if (d->code == code && d->where.file == where.file && d->where.begin == where.begin)
      return true;
  }
  return false;
}

static void warn(analysis *a, context *c, ir_node n, ir_node operand, interval_wish wish) {
  static const char *const what[] = {"this divides by zero",
                                     "this takes the root of a negative number",
                                     "this takes the logarithm of a number that is not positive",
                                     "this raises a negative number to a power that is not whole"};
  interval_condition conditions[32];
  diag_code code = wish == WISH_ZERO ? DIAG_DIVISION_BY_ZERO : DIAG_DOMAIN;
  span where = place_of(a, n);
  if (a->quiet || a->tried[n] == MOST_TRIES || a->searches == MOST_SEARCHES ||
      said_before(a, code, where))
    return;
  a->tried[n]++;
  a->searches++;
  int count = conditions_of(c, conditions, 32);
  char *state = interval_witness(a->bench, a->fields, operand, wish, conditions, count);
  if (!state) return;
  diag_report(a->said, code, where, "%s in a state within the bounds", what[wish]);
  diag_note(a->said, (span){0, 0, UINT16_MAX}, "found at %s", state);
  diag_hint(
      a->said,
      wish == WISH_ZERO
          ? "narrow the bounds of a parameter, or keep the zero away by a case line or `max`"
          : "narrow the bounds of a parameter, or keep such numbers away by a case line or `max`");
  free(state);
}

static void check_operation(analysis *a, context *c, ir_node n, range p, range q) {
  const ir *g = a->graph;
  ir_node first = ir_operand(g, n, 0);
  switch (ir_operation(g, n)) {
  case IR_DIV: {
    ir_node below = ir_operand(g, n, 1);
    if (range_holds(q, 0) && !known_not_zero(a, c, below)) {
      sum s = sum_of(g, below);
      if (range_holds(sum_range(a, c, &s, 2), 0)) warn(a, c, n, below, WISH_ZERO);
    }
    return;
  }
  case IR_SQRT:
    if (p.low < 0) {
      sum s = sum_of(g, first);
      if (sum_range(a, c, &s, 2).low < 0) warn(a, c, n, first, WISH_NEGATIVE);
    }
    return;
  case IR_LOG:
    if (!range_is_positive(p)) warn(a, c, n, first, WISH_NOT_POSITIVE);
    return;
  case IR_POW:
    if (!range_is_nonnegative(p))
      warn(a, c, n, first, WISH_NEGATIVE_BASE);
    else if (range_holds(p, 0) && q.low < 0)
      warn(a, c, n, first, WISH_ZERO);
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
  range p = value_of(a, c, first), q = second == IR_NONE ? range_all() : value_of(a, c, second);
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

static range value_of(analysis *a, context *c, ir_node n) {
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
    r = operation_range(a, c, n);
  }
  r = tightened(a, c, n, r);
  a->depth--;
  c->known[n] = r;
  c->state[n] = DONE;
  return r;
}

/* --- bounds of parameters --------------------------------------------------------------------- */

/* False when a bound cannot be compiled (said). */
static bool find_bounds(analysis *a) {
  const law *l = a->law;
  size_t bytes = ((size_t)l->parameters.count + 1) * sizeof(ir_node);
  a->lower = arena_alloc(a->memory, bytes);
  a->upper = arena_alloc(a->memory, bytes);
  for (int k = 0; k < l->parameters.count; k++) {
    const bounds *in = &l->parameters.items[k]->declared->in;
    a->lower[k] = lower_bound(a->graph, l, in->given ? in->lower : NULL, -INFINITY, a->said);
    a->upper[k] = lower_bound(a->graph, l, in->given ? in->upper : NULL, INFINITY, a->said);
    if (a->lower[k] == IR_NONE || a->upper[k] == IR_NONE) return false;
    lower_parameter(a->graph, l, k);
  }
  return true;
}

/* Bounds that are made of other parameters. */
static void relate_parameters(analysis *a, context *c) {
  const law *l = a->law;
  for (int k = 0; k < l->parameters.count; k++) {
    const bounds *in = &l->parameters.items[k]->declared->in;
    ir_node p = lower_parameter(a->graph, l, k);
    if (ir_operation(a->graph, a->lower[k]) != IR_CONSTANT)
      relate(a, c, in->lower_open ? POSITIVE : NOT_NEGATIVE, a->lower[k], p);
    if (ir_operation(a->graph, a->upper[k]) != IR_CONSTANT)
      relate(a, c, in->upper_open ? POSITIVE : NOT_NEGATIVE, p, a->upper[k]);
  }
}

static context *whole_law(analysis *a) {
  context *c = new_context(a, NULL, IR_NONE, false);
  relate_parameters(a, c);
  return c;
}

/* --- states ----------------------------------------------------------------------------------- */

/* Takes back what the rules do not keep up when all fields are as supposed. False when nothing is
 * left to take back. */
static bool take_back(analysis *a) {
  arena *memory = a->memory;
  bool changed = false;
  a->memory = arena_new();
  a->contexts = 0;
  context *whole = whole_law(a);
  for (int k = 0; k < a->law->fields.count; k++) {
    if (a->law->fields.items[k]->kind == SYMBOL_DAMAGE) continue;
    range r = value_of(a, whole, a->bench->law_step.fields[k]), *f = &a->fields[k];
    if (f->low > r.low) changed = true, f->low = -INFINITY, f->low_open = true;
    if (f->high < r.high) changed = true, f->high = INFINITY, f->high_open = true;
  }
  arena_free(a->memory);
  a->memory = memory;
  a->contexts = 0;
  return changed;
}

/* A state may never fall below its initial value, or never rise above it: supposed of all, until
   the rules keep up what is left. A damage is kept from 0 to 1. */
static void learn_fields(analysis *a) {
  const symbol_list *fields = &a->law->fields;
  a->fields = arena_alloc(a->memory, ((size_t)fields->count + 1) * sizeof *a->fields);
  for (int k = 0; k < fields->count; k++)
    a->fields[k] = fields->items[k]->kind == SYMBOL_DAMAGE ? range_between(0, 1, false, false)
                                                           : range_of(fields->items[k]->initial);
  a->quiet = true;
  for (bool changed = fields->count > 0; changed;)
    changed = take_back(a);
  a->quiet = false;
  a->combinations = 0;
}

/* --- the law ---------------------------------------------------------------------------------- */

static void look_at(analysis *a, context *c, ir_node n) {
  if (n != IR_NONE) value_of(a, c, n);
}

/* How far the rules of the damages stay above 0 and below 1: [2*fields], IR_NONE for states. */
static ir_node *damage_margins(analysis *a) {
  const double rounding = 1e-9;
  ir *g = a->graph;
  int count = a->law->fields.count;
  ir_node *margins = arena_alloc(a->memory, (2 * (size_t)count + 1) * sizeof *margins);
  for (int k = 0; k < count; k++) {
    bool damage = a->law->fields.items[k]->kind == SYMBOL_DAMAGE;
    ir_node rule = a->bench->law_step.text.rules[k];
    margins[2 * k] = damage ? ir_add(g, rule, ir_constant(g, rounding)) : IR_NONE;
    margins[2 * k + 1] = damage ? ir_sub(g, ir_constant(g, 1 + rounding), rule) : IR_NONE;
  }
  return margins;
}

/* Only what a state shows is said: ranges alone are too wide for a curve of softening. */
static void check_damages(analysis *a, context *c, const ir_node *margins) {
  for (int k = 0; k < 2 * a->law->fields.count; k++) {
    const symbol *s = a->law->fields.items[k / 2];
    if (margins[k] == IR_NONE || value_of(a, c, margins[k]).low >= 0 ||
        said_before(a, DIAG_DAMAGE_RANGE, s->rule->where))
      continue;
    char *state = interval_witness(a->bench, a->fields, margins[k], WISH_NEGATIVE, NULL, 0);
    if (!state) continue;
    diag_report(
        a->said, DIAG_DAMAGE_RANGE, s->rule->where,
        "the rule of damage `%s` gives %s in a state within the bounds; it is cut off there",
        s->name, k % 2 ? "more than 1" : "less than 0");
    diag_note(a->said, (span){0, 0, UINT16_MAX}, "found at %s", state);
    diag_hint(a->said, "narrow the bounds of a parameter, or keep such values away by `max`");
    free(state);
  }
}

static void look_at_law(analysis *a) {
  const bench *b = a->bench;
  const law *l = a->law;
  const ir_node *margins = damage_margins(a);
  a->nodes = ir_count(b->graph);
  a->most_contexts = (int)pl_fmin(MOST_CONTEXTS, (double)(1 + MOST_MEMORY / (4 * (long)a->nodes)));
  a->tried = arena_alloc(a->memory, (size_t)a->nodes);
  learn_fields(a);
  context *whole = whole_law(a);
  const lowered_law *s = &b->law_step;
  for (int k = 0; k < l->fields.count; k++)
    look_at(a, whole, s->fields[k]);
  const ir_node results[] = {s->N, s->M_i, s->M_j, s->W};
  for (size_t k = 0; k < sizeof results / sizeof *results; k++)
    look_at(a, whole, results[k]);
  for (int k = 0; k < l->outputs.count; k++)
    look_at(a, whole, s->outputs[k]);
  check_damages(a, whole, margins);
}

void interval_check(const law *l, diagnostics *d) {
  static const physics_options usual = {0};
  bench b;
  if (l->tree->law == LAW_STATE || !bench_open(&b, l, &usual, d)) return;
  analysis a = {.bench = &b, .graph = b.graph, .law = l, .said = d, .memory = arena_new()};
  if (find_bounds(&a)) look_at_law(&a);
  arena_free(a.memory);
  bench_close(&b);
}
