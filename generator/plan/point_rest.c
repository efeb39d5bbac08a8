#include "generator/plan/point_rest.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/ir/derive.h"
#include "generator/ir/random_values.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/lower_inputs.h"

enum { MOST = PL_MAX_STRAINS };

/* --- elastic strain --------------------------------------------------------------------------- */

static bool depends_on_states(const kernel_plan *plan, const ir_node *roots, int count) {
  const int fields = plan->law->fields.count;
  ir_node *at_hand = must_alloc(((size_t)fields + 1) * sizeof *at_hand);
  for (int k = 0; k < fields; k++)
    at_hand[k] = lower_field(plan->graph, plan->law, k);
  const bool found = rewrite_depends(plan->graph, roots, count, at_hand, fields);
  free(at_hand);
  return found;
}

/* a - b*c; what is 0 by its law stays out of it. */
static ir_node less(ir *g, ir_node a, ir_node b, ir_node c) {
  if (ir_is_number(g, b, 0) || ir_is_number(g, c, 0)) return a;
  return ir_sub(g, a, ir_mul(g, b, c));
}

/* D x = x, by elimination without pivots: a stiffness is positive definite. */
static void solve(ir *g, int count, ir_node D[MOST][MOST], ir_node *x) {
  for (int k = 0; k < count; k++)
    for (int row = k + 1; row < count; row++) {
      if (ir_is_number(g, D[row][k], 0)) continue;
      const ir_node share = ir_div(g, D[row][k], D[k][k]);
      for (int c = k + 1; c < count; c++)
        D[row][c] = less(g, D[row][c], share, D[k][c]);
      x[row] = less(g, x[row], share, x[k]);
    }
  for (int k = count - 1; k >= 0; k--) {
    for (int c = k + 1; c < count; c++)
      x[k] = less(g, x[k], D[k][c], x[c]);
    x[k] = ir_div(g, x[k], D[k][k]);
  }
}

bool point_elastic_strain(const kernel_plan *plan, const ir_node *stress, const ir_node *strain,
                          int count, ir_node *elastic) {
  ir *g = plan->graph;
  ir_node D[MOST][MOST];
  for (int k = 0; k < count; k++) {
    for (int m = 0; m < count; m++)
      D[k][m] = ir_derivative(g, stress[k], strain[m]);
    if (rewrite_depends(g, D[k], count, strain, count) || depends_on_states(plan, D[k], count))
      return false;
    elastic[k] = stress[k];
  }
  solve(g, count, D, elastic);
  return true;
}

/* --- numbers ---------------------------------------------------------------------------------- */

/* Components have either sign; a number, as a largest value so far, that of growth, or it falls. */
static double draw_state(const symbol *s, double size, uint64_t *seed) {
  if (s->kind == SYMBOL_DAMAGE) return draw_uniform(seed, 0, 1);
  if (s->initial < 0 || s->initial > 0) return s->initial * draw_uniform(seed, 0, 1);
  return size * draw_uniform(seed, s->component_of ? -1 : 0, 1);
}

static double draw_parameter(const symbol *s, uint64_t *seed) {
  const bool usual = s->has_default && (s->initial < 0 || s->initial > 0);
  return usual ? s->initial * draw_uniform(seed, 0.9, 1.1) : draw_uniform(seed, 0, 1);
}

static double draw_input(const kernel_plan *plan, ir_node input, double size, uint64_t *seed) {
  const law *l = plan->law;
  const int k = ir_input_index(plan->graph, input);
  switch (ir_input_source(plan->graph, input)) {
  case IR_FROM_FIELD:
    return draw_state(l->fields.items[k], size, seed);
  case IR_FROM_PARAMETER:
    return draw_parameter(l->parameters.items[k], seed);
  case IR_FROM_BOND_PARAMETER:
    return draw_parameter(l->parameters.items[plan->variation.varying[k]], seed);
  default:
    return draw_uniform(seed, 0, 1);
  }
}

/* inputs[..] that two nodes need; returns how many. */
static int inputs_of(const ir *g, const ir_node of[2], ir_node *inputs) {
  const int nodes = ir_count(g);
  unsigned char *marks = must_calloc((size_t)nodes + 1, 1);
  int count = 0;
  ir_mark(g, of, 2, marks);
  for (ir_node n = 0; n < nodes; n++)
    if (marks[n] && ir_operation(g, n) == IR_INPUT) inputs[count++] = n;
  free(marks);
  return count;
}

/* What of[0], and of[1] beside it, are where the inputs have these values. False: no numbers. */
static bool evaluate(ir *g, const ir_node of[2], const ir_node *inputs, const ir_node *values,
                     int count, double found[2]) {
  ir_node at[2];
  ir_substitute(g, of, 2, inputs, values, count, at);
  for (int k = 0; k < 2; k++) {
    if (ir_operation(g, at[k]) != IR_CONSTANT) return false;
    found[k] = ir_value(g, at[k]);
  }
  return isfinite(found[0]) && isfinite(found[1]);
}

bool point_rest_is_none(const kernel_plan *plan, ir_node rest) {
  enum { DRAWS = 32 };
  static const double NOTHING = 1e-9; /* of what is added up to it */
  ir *g = plan->graph;
  const ir_node of[2] = {rest, rewrite_size(g, rest)};
  ir_node *inputs = must_alloc(((size_t)ir_count(g) + 1) * sizeof *inputs),
          *values = must_alloc(((size_t)ir_count(g) + 1) * sizeof *values);
  const int count = inputs_of(g, of, inputs);
  uint64_t seed = 1;
  bool none = true;
  int numbers = 0;
  for (int draw = 0; draw < DRAWS && none; draw++) {
    const double size = pl_pow(10, draw_uniform(&seed, -8, 8));
    double found[2];
    for (int k = 0; k < count; k++)
      values[k] = ir_constant(g, draw_input(plan, inputs[k], size, &seed));
    if (!evaluate(g, of, inputs, values, count, found)) continue;
    numbers++;
    none = fabs(found[0]) <= NOTHING * found[1];
  }
  free(inputs);
  free(values);
  return none && numbers > 0;
}
