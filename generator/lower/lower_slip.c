#include "generator/lower/lower_slip.h"

#include "generator/ir/rewrite.h"
#include "generator/lower/lower_inputs.h"

/* Half of theta: with it L cos(theta) - s loses no digits. */
typedef struct half_turn {
  components sine; /* times the direction */
  ir_node square;  /* of the sine */
  ir_node cosine;
} half_turn;

static components half_angle(const lowering *c) {
  components h = {.count = lower_bending_axes(c->law)};
  for (int k = 0; k < h.count; k++) {
    const ir_node i = lower_bending(c->graph, c->law, QUANTITY_THETA_I, k),
                  j = lower_bending(c->graph, c->law, QUANTITY_THETA_J, k);
    h.of[k] = ir_scaled(c->graph, 0.25, ir_add(c->graph, i, j));
  }
  return h;
}

static ir_node series(ir *g, const double *fit, int count, ir_node x) {
  ir_node sum = ir_constant(g, fit[count - 1]);
  for (int k = count - 2; k >= 0; k--) {
    const ir_node higher = ir_mul(g, sum, x);
    sum = ir_add(g, ir_constant(g, fit[k]), higher);
  }
  return sum;
}

/* Of a vector the direction is lost where it vanishes: up to a hundredth series of the square,
   whose next terms are 3e-22 and 3e-27. */
static half_turn half_turn_in_space(ir *g, const components *h) {
  static const double sine_ratio[] = {1, -1.0 / 6, 1.0 / 120, -1.0 / 5040},
                      cosine[] = {1, -1.0 / 2, 1.0 / 24, -1.0 / 720, 1.0 / 40320};
  const ir_node most = ir_constant(g, 1e-4);
  ir_node square = ir_constant(g, 0);
  for (int k = 0; k < h->count; k++)
    square = ir_add(g, square, ir_mul(g, h->of[k], h->of[k]));
  const ir_node small = ir_binary(g, IR_LT, square, most);
  const ir_node size = ir_unary(g, IR_SQRT, ir_binary(g, IR_MAX, square, most));
  const ir_node far = ir_div(g, ir_unary(g, IR_SIN, size), size);
  const ir_node ratio = ir_select(g, small, series(g, sine_ratio, 4, square), far);
  half_turn t = {.sine = {h->count, {0}}, .square = ir_mul(g, ir_mul(g, ratio, ratio), square)};
  const ir_node cosine_far = ir_unary(g, IR_COS, size);
  t.cosine = ir_select(g, small, series(g, cosine, 5, square), cosine_far);
  for (int k = 0; k < h->count; k++)
    t.sine.of[k] = ir_mul(g, ratio, h->of[k]);
  return t;
}

static half_turn half_turn_of(const lowering *c) {
  ir *g = c->graph;
  const components h = half_angle(c);
  if (c->law->bends_in_space) return half_turn_in_space(g, &h);
  const ir_node sine = ir_unary(g, IR_SIN, h.of[0]);
  return (half_turn){.sine = scalar(sine),
                     .square = ir_mul(g, sine, sine),
                     .cosine = ir_unary(g, IR_COS, h.of[0])};
}

static ir_node twice_length(ir *g) {
  return ir_scaled(g, 2, lower_quantity(g, QUANTITY_LENGTH));
}

static ir_node slip_of(const lowering *c) {
  ir *g = c->graph;
  const half_turn t = half_turn_of(c);
  const ir_node stretch = lower_quantity(g, QUANTITY_STRETCH);
  const ir_node growth = ir_mul(g, lower_quantity(g, QUANTITY_S), stretch);
  return ir_sub(g, growth, ir_mul(g, twice_length(g), t.square));
}

static components gap_of(const lowering *c) {
  ir *g = c->graph;
  const half_turn t = half_turn_of(c);
  components gap = {.count = t.sine.count};
  const ir_node scale = ir_neg(g, ir_mul(g, twice_length(g), t.cosine));
  for (int k = 0; k < gap.count; k++)
    gap.of[k] = ir_mul(g, scale, t.sine.of[k]);
  return gap;
}

components lower_slip_quantity(lowering *c, builtin_quantity q) {
  ir *g = c->graph;
  if (q == QUANTITY_GAP) return gap_of(c);
  if (q == QUANTITY_SLIP) return scalar(slip_of(c));
  const ir_node rate = lower_quantity(g, QUANTITY_STRETCH_RATE);
  return scalar(ir_mul(g, lower_quantity(g, QUANTITY_S), rate));
}

static ir_node stand_in(lowering *c, slip_work *w, ir_node meant) {
  static const char *const names[] = {"along", "across", "across_y", "across_z"};
  const int first = 2 * c->law->fields.count + 1;
  const ir_node n = ir_input(c->graph, IR_FROM_FIELD, first + w->count, names[w->count], ON_BOND);
  w->meant[w->count] = meant;
  w->stand_in[w->count++] = n;
  return n;
}

slip_work lower_slip_work(lowering *c, ir_node N, const components *V) {
  ir *g = c->graph;
  slip_work w = {.count = 0};
  const components gap = gap_of(c);
  const ir_node slip = slip_of(c);
  w.energy = ir_mul(g, stand_in(c, &w, N), slip);
  for (int k = 0; k < V->count; k++)
    w.energy = ir_add(g, w.energy, ir_mul(g, stand_in(c, &w, V->of[k]), gap.of[k]));
  return w;
}

ir_node lower_slip_settle(ir *g, const slip_work *w, ir_node force) {
  ir_substitute(g, &force, 1, w->stand_in, w->meant, w->count, &force);
  return force;
}
