#include "generator/lower/lower_rate.h"

#include "generator/ir/derive.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/lower_inputs.h"
#include "generator/lower/lower_solved.h"
#include "generator/lower/lower_tensor.h"

/* --- steps in time of what is linear ---------------------------------------------------------- */

typedef struct phi {
  ir_node one, two;
} phi;

/* sum (-z)^k/(k + 2)!, whose first term left out is below 1e-17 of it for |z| <= 1/2. */
static ir_node series_of_phi_2(ir *g, ir_node z) {
  enum { TERMS = 14 };
  double factorial = 1;
  for (int k = 2; k <= TERMS + 1; k++)
    factorial *= k;
  ir_node sum = ir_constant(g, 1 / factorial);
  for (int k = TERMS + 1; k > 2; k--) {
    factorial /= k;
    const ir_node more = ir_mul(g, z, sum);
    sum = ir_sub(g, ir_constant(g, 1 / factorial), more);
  }
  return sum;
}

/* By the series near 0, where the formulas lose digits. */
static phi phi_of(ir *g, ir_node z) {
  const ir_node one = ir_constant(g, 1), size = ir_unary(g, IR_ABS, z);
  const ir_node near = ir_binary(g, IR_LE, size, ir_constant(g, 0.5));
  const ir_node close = ir_select(g, near, z, ir_constant(g, 0)), far = ir_select(g, near, one, z);
  phi a = {.two = series_of_phi_2(g, close)}, b;
  a.one = ir_sub(g, one, ir_mul(g, close, a.two));
  const ir_node decayed = ir_unary(g, IR_EXP, ir_neg(g, far));
  b.one = ir_div(g, ir_sub(g, one, decayed), far);
  b.two = ir_div(g, ir_sub(g, one, b.one), far);
  a.one = ir_select(g, near, a.one, b.one);
  a.two = ir_select(g, near, a.two, b.two);
  return a;
}

/* old + dt (phi_1 r + phi_2 (g - r)) */
static ir_node gone_on(ir *g, ir_node old, ir_node dt, ir_node minus_b, ir_node r, ir_node f) {
  const phi p = phi_of(g, ir_neg(g, ir_mul(g, minus_b, dt)));
  const ir_node by_r = ir_mul(g, p.one, r), change = ir_sub(g, f, r);
  const ir_node mean = ir_add(g, by_r, ir_mul(g, p.two, change));
  return ir_add(g, old, ir_mul(g, dt, mean));
}

/* --- and of what is not ----------------------------------------------------------------------- */

static ir_node at(ir *g, ir_node f, ir_node old, ir_node v) {
  ir_substitute(g, &f, 1, &old, &v, 1, &f);
  return f;
}

typedef struct newton {
  ir_node v, last; /* the state so far, and what it was corrected by */
  ir_node rises;   /* the slope was more than 0 there */
} newton;

/* A step of Newton's method for v - old - dt f(v) = 0. Where the rate grows faster with v than the
   step is short there is no way back, and the slope is taken as 1. */
static newton next(ir *g, newton n, ir_node old, ir_node dt, ir_node f, ir_node slope) {
  const ir_node one = ir_constant(g, 1), zero = ir_constant(g, 0);
  const ir_node gained = ir_mul(g, dt, at(g, f, old, n.v));
  const ir_node rest = ir_sub(g, one, ir_mul(g, dt, at(g, slope, old, n.v)));
  const ir_node left = ir_sub(g, ir_sub(g, n.v, old), gained);
  n.rises = ir_binary(g, IR_LT, zero, rest);
  n.last = ir_div(g, left, ir_select(g, n.rises, rest, one));
  n.v = ir_sub(g, n.v, n.last);
  return n;
}

/* Whether the last correction was as small as one whose square is rounding; or, of steps far too
   long for the law, went on from `old`, so that v lies on the near side of the root. */
static ir_node is_good_end(ir *g, newton n, ir_node old) {
  static const double SETTLED = 1e-7; /* of the state */
  const ir_node before = ir_unary(g, IR_ABS, old), now = ir_unary(g, IR_ABS, n.v);
  const ir_node most = ir_scaled(g, SETTLED, ir_add(g, before, now));
  const ir_node settled = ir_binary(g, IR_LE, ir_unary(g, IR_ABS, n.last), most);
  const ir_node back = ir_mul(g, ir_sub(g, n.v, old), n.last);
  const ir_node went_on = ir_binary(g, IR_LE, back, ir_constant(g, 0));
  return ir_binary(g, IR_OR, settled, ir_binary(g, IR_AND, went_on, n.rises));
}

/* Any other end is no number, so that it is found, and told. */
static ir_node implicit(lowering *c, const stmt *rule, ir_node old, ir_node dt, ir_node f,
                        ir_node slope) {
  enum { NEWTON_STEPS = 12 };
  ir *g = c->graph;
  newton n = {.v = old};
  for (int k = 0; k < NEWTON_STEPS; k++) {
    n = next(g, n, old, dt, f, slope);
    if (ir_count(g) > MOST_NODES)
      return lower_fail(c, rule->where,
                        "with its steps written out this rate is too large to compile");
  }
  const ir_node good = is_good_end(g, n, old);
  return ir_add(g, n.v, lower_zero_if(g, good));
}

/* --- one component ---------------------------------------------------------------------------- */

static bool couples(lowering *c, ir_node f, const components *old, int component) {
  for (int k = 0; k < old->count; k++)
    if (k != component && ir_operation(c->graph, old->of[k]) == IR_INPUT &&
        rewrite_depends(c->graph, &f, 1, &old->of[k], 1))
      return true;
  return false;
}

static bool is_good(lowering *c, const stmt *rule, ir_node f, const components *old,
                    int component) {
  if (couples(c, f, old, component)) {
    const bool vector = rule->symbol->shape == SHAPE_VECTOR;
    lower_fail(c, rule->where,
               vector
                   ? "the rate of one component of this vector depends on others: that cannot be "
                     "solved yet; a factor may read `previous(...)` of it"
                   : "the rate of one component of this tensor depends on others: that cannot be "
                     "solved yet; a factor may read `previous(...)` of it");
    return false;
  }
  if (old->of[component] != IR_NONE && lower_moves_a_sum(c->graph, f, old->of[component]) &&
      ir_place(c->graph, f) > ON_PARTICLE) {
    lower_fail(c, rule->where,
               "the rate toward one neighbour would change with the states toward all others: in "
               "what goes over the family read `previous(...)` of the state");
    return false;
  }
  return true;
}

static ir_node step_of(lowering *c, const stmt *rule, ir_node old, ir_node f, ir_node before) {
  ir *g = c->graph;
  const ir_node dt = lower_advance(g, c->law), slope = ir_derivative(g, f, old);
  if (rewrite_depends(g, &slope, 1, &old, 1)) return implicit(c, rule, old, dt, f, slope);
  return gone_on(g, old, dt, slope, before, f);
}

components lower_rate(lowering *c, const stmt *rule, components old, components rate,
                      components rate_before, components *rate_after) {
  ir *g = c->graph;
  components now = old;
  *rate_after = rate;
  for (int k = 0; k < old.count && !c->failed; k++) {
    if (rate_before.of[k] == IR_NONE) continue;
    ir_node f = rate.of[k], *what, *stand_in;
    const int frozen = lower_freeze_neighbours(c, &f, &what, &stand_in);
    if (!is_good(c, rule, f, &old, k)) break;
    ir_node both[2];
    both[0] = step_of(c, rule, old.of[k], f, rate_before.of[k]);
    both[1] = at(g, f, old.of[k], both[0]);
    ir_substitute(g, both, 2, stand_in, what, frozen, both);
    now.of[k] = both[0];
    rate_after->of[k] = both[1];
  }
  return tensor_settled(g, now);
}
