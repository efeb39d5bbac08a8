#include "generator/lower/lower_rate.h"

#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/ir/derive.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/lower_inputs.h"
#include "generator/lower/lower_solved.h"
#include "generator/lower/lower_tensor.h"
#include "generator/lower/point_inputs.h"

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

/* On the way to the root of left(v) = v - old - dt f(v). A rate that falls with v has it between
   old and old + dt f(old), where left has either sign. */
typedef struct root_search {
  ir_node v, left;   /* the state so far, and what is left there */
  ir_node near, far; /* the root is between: left has the sign that it has at old, and the other */
  ir_node slow;      /* the last step did not halve left */
  ir_node settled;   /* nor would it move v by more than a little */
} root_search;

typedef struct implicit_step {
  ir_node old, dt, f, slope;
  ir_node gained;   /* dt f(old) */
  ir_node encloses; /* the root is between near and far */
} implicit_step;

static ir_node gained_at(ir *g, const implicit_step *s, ir_node v) {
  return ir_mul(g, s->dt, at(g, s->f, s->old, v));
}

/* Whether x is less than y, in the direction that the state goes in. */
static ir_node falls_short(ir *g, const implicit_step *s, ir_node x, ir_node y) {
  const ir_node up = ir_binary(g, IR_LT, ir_constant(g, 0), s->gained);
  const ir_node below = ir_binary(g, IR_LT, x, y);
  return ir_select(g, up, below, ir_binary(g, IR_LT, y, x));
}

static root_search begin(ir *g, implicit_step *s) {
  s->gained = gained_at(g, s, s->old);
  const ir_node far = ir_add(g, s->old, s->gained), zero = ir_constant(g, 0);
  const ir_node grows = falls_short(g, s, s->gained, gained_at(g, s, far));
  s->encloses = ir_unary(g, IR_NOT, grows); /* also where f is no number so far on */
  return (root_search){s->old, ir_neg(g, s->gained), s->old, far, zero, zero};
}

static ir_node is_between(ir *g, ir_node v, ir_node a, ir_node b) {
  const ir_node above = ir_binary(g, IR_LE, ir_binary(g, IR_MIN, a, b), v);
  return ir_binary(g, IR_AND, above, ir_binary(g, IR_LE, v, ir_binary(g, IR_MAX, a, b)));
}

/* A step of Newton's method; or, where that leaves the interval or the last one got on badly, to
   its middle. */
static root_search next(ir *g, root_search r, const implicit_step *s) {
  static const double SETTLED = 1e-7; /* of the state: the square is rounding */
  const ir_node one = ir_constant(g, 1), zero = ir_constant(g, 0);
  const ir_node slope = ir_sub(g, one, ir_mul(g, s->dt, at(g, s->slope, s->old, r.v)));
  const ir_node rises = ir_binary(g, IR_LT, zero, slope);
  const ir_node correction = ir_div(g, r.left, ir_select(g, rises, slope, one));
  const ir_node size = ir_unary(g, IR_ABS, s->old);
  const ir_node most = ir_scaled(g, SETTLED, ir_add(g, size, ir_unary(g, IR_ABS, r.v)));
  const ir_node small = ir_binary(g, IR_LE, ir_unary(g, IR_ABS, correction), most);
  const ir_node newton = ir_sub(g, r.v, correction);
  const ir_node between = is_between(g, newton, r.near, r.far);
  const ir_node well = ir_binary(g, IR_AND, between, ir_unary(g, IR_NOT, r.slow));
  const ir_node free = ir_unary(g, IR_NOT, s->encloses);
  const ir_node taken = ir_binary(g, IR_OR, free, ir_binary(g, IR_OR, small, well));
  const ir_node middle = ir_scaled(g, 0.5, ir_add(g, r.near, r.far));
  const ir_node most_left = ir_scaled(g, 0.5, ir_unary(g, IR_ABS, r.left));
  r.v = ir_select(g, taken, newton, middle);
  const ir_node gone = ir_sub(g, r.v, s->old);
  r.left = ir_sub(g, gone, gained_at(g, s, r.v));
  r.slow = ir_binary(g, IR_LT, most_left, ir_unary(g, IR_ABS, r.left));
  r.settled = ir_binary(g, IR_AND, small, rises);
  const ir_node is_near = falls_short(g, s, r.left, zero);
  r.near = ir_select(g, is_near, r.v, r.near);
  r.far = ir_select(g, is_near, r.far, r.v);
  return r;
}

/* The root, or the near side of what is known to enclose it: of steps far too long for the law the
   state then goes less far than it should, never beyond. Any other end is no number, so that it is
   found, and told. */
static ir_node implicit(lowering *c, const stmt *rule, ir_node old, ir_node dt, ir_node f,
                        ir_node slope) {
  enum { STEPS = 16 };
  ir *g = c->graph;
  implicit_step s = {.old = old, .dt = dt, .f = f, .slope = slope};
  root_search r = begin(g, &s);
  for (int k = 0; k < STEPS; k++) {
    r = next(g, r, &s);
    if (ir_count(g) > MOST_NODES)
      return lower_fail(c, rule->where,
                        "with its steps written out this rate is too large to compile");
  }
  const ir_node good = ir_binary(g, IR_OR, r.settled, s.encloses);
  const ir_node end = ir_select(g, r.settled, r.v, r.near);
  return ir_add(g, end, lower_zero_if(g, good));
}

/* --- one component ---------------------------------------------------------------------------- */

static bool couples(lowering *c, ir_node f, const components *old, int component) {
  for (int k = 0; k < old->count; k++)
    if (k != component && ir_operation(c->graph, old->of[k]) == IR_INPUT &&
        rewrite_depends(c->graph, &f, 1, &old->of[k], 1))
      return true;
  return false;
}

static bool reads_speed(ir *g, ir_node f) {
  enum { STRAINS = POINT_STRAINS };
  ir_node speed[1 + STRAINS] = {lower_quantity(g, QUANTITY_STRETCH_RATE)};
  for (int k = 0; k < STRAINS; k++)
    speed[1 + k] = point_input_node(g, POINT_STRAIN_RATE + k);
  return rewrite_depends(g, &f, 1, speed, 1 + STRAINS);
}

/* The stretch that comes of a rate of stretch would not be the stretch: runs know speeds between
   two steps, paths have corners, and where a body comes to rest its speeds are none of the deck's
   time. */
static bool is_good(lowering *c, const stmt *rule, ir_node f, const components *old,
                    int component) {
  if (reads_speed(c->graph, f)) {
    lower_fail(c, rule->where,
               "a rate cannot read how quickly the body moves: let the state be the strain that "
               "flows, as in `rate v = (stretch - v)/tau`, and the force `E*(stretch - v)`");
    return false;
  }
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

/* Whether f takes one course or another by the state, even with the same slope on either. */
static bool switches(const ir *g, ir_node f, ir_node old) {
  unsigned char *marks = must_calloc((size_t)ir_count(g) + 1, 1);
  bool found = false;
  ir_mark(g, &f, 1, marks);
  for (ir_node n = 0; n <= f && !found; n++)
    found = marks[n] && (ir_is_logical(g, n) || ir_operation(g, n) == IR_SIGN) &&
            rewrite_depends(g, &n, 1, &old, 1);
  free(marks);
  return found;
}

static ir_node step_of(lowering *c, const stmt *rule, ir_node old, ir_node f, ir_node before) {
  ir *g = c->graph;
  const ir_node dt = lower_advance(g, c->law), slope = ir_derivative(g, f, old);
  if (rewrite_depends(g, &slope, 1, &old, 1) || switches(g, f, old))
    return implicit(c, rule, old, dt, f, slope);
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
