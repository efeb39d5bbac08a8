#include "generator/lower/rest_ends.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/ir/operation.h"
#include "generator/ir/random_values.h"
#include "generator/lower/law_inputs.h"
#include "generator/lower/lower.h"

typedef struct two_ends {
  const law *law;
  const ir *graph;
  const double *parameters;
  const law_variation *variation;
  const pl_bond_class *bonds;
  double of_class[QUANTITY_COUNT];
  uint64_t seed; /* 0: all as it is at rest */
  double *value; /* [2][nodes] */
} two_ends;

/* Near the usual value, of a particle its own. */
static double drawn(const two_ends *t, ir_node n, int end, double usual) {
  if (t->seed == 0) return usual;
  uint64_t seed = t->seed + 2 * (uint64_t)n + (uint64_t)end;
  const double part = draw_uniform(&seed, 0.5, 1);
  return usual == 0 ? 1e-3 * part : usual * (1 + 0.1 * part);
}

static double field_value(const two_ends *t, ir_node n, int end) {
  const int k = ir_input_index(t->graph, n);
  if (k < 0 || k >= t->law->fields.count) return 0;
  const symbol *s = t->law->fields.items[k];
  return drawn(t, n, s->place == ON_PARTICLE ? end : 0, s->initial);
}

static double quantity_value(const two_ends *t, ir_node n, int end) {
  int q = ir_input_index(t->graph, n);
  if (end == 1 && q == QUANTITY_M_END_I)
    q = QUANTITY_M_END_J;
  else if (end == 1 && q == QUANTITY_M_END_J)
    q = QUANTITY_M_END_I;
  return q < QUANTITY_COUNT ? t->of_class[q] : 0;
}

static double end_value(const two_ends *t, ir_node n, int end) {
  const ends_origin *of = &ends_origins[ir_input_index(t->graph, n)];
  switch (of->array) {
  case FROM_CHORD:
  case FROM_CLASS:
    return (end ? -1 : 1) * t->bonds->chord[of->component];
  case FROM_LENGTH:
    return t->bonds->s;
  case FROM_VOLUME:
    return drawn(t, 0, end ^ (of->owner == OF_J), t->bonds->V);
  case FROM_MASS:
    return end ^ (of->owner == OF_J) ? t->bonds->mass_j : t->bonds->mass_i;
  case FROM_SIZE:
    return drawn(t, 1, end ^ (of->owner == OF_J), 1);
  default:
    return 0;
  }
}

static double input_value(const two_ends *t, ir_node n, int end) {
  const int index = ir_input_index(t->graph, n);
  switch (ir_input_source(t->graph, n)) {
  case IR_FROM_PARAMETER:
    return t->parameters[index];
  case IR_FROM_PARTICLE_PARAMETER:
    return drawn(t, n, end, t->parameters[t->variation->varying[index]]);
  case IR_FROM_BOND_PARAMETER:
    return t->parameters[t->variation->varying[index]];
  case IR_FROM_QUANTITY:
    return quantity_value(t, n, end);
  case IR_FROM_FIELD:
    return field_value(t, n, end);
  case IR_FROM_ENDS:
    return end_value(t, n, end);
  default:
    return drawn(t, n, end, 1);
  }
}

static double operand(const two_ends *t, ir_node n, int k, int end) {
  const ir_node of = ir_operand(t->graph, n, k);
  return of == IR_NONE ? 0 : t->value[end * ir_count(t->graph) + of];
}

/* Nodes only refer to earlier ones. A sum over a family is a number of the particle. */
static double value_at(const two_ends *t, ir_node n, int end) {
  const ir_op op = ir_operation(t->graph, n);
  if (op == IR_CONSTANT) return ir_value(t->graph, n);
  if (op == IR_INPUT) return input_value(t, n, end);
  if (op == IR_NEIGHBOUR) return operand(t, n, 0, !end);
  if (ir_is_reduction(op) || op == IR_SEARCH) return drawn(t, n, end, 1);
  return operation_value(op, operand(t, n, 0, end), operand(t, n, 1, end), operand(t, n, 2, end));
}

static void evaluate(two_ends *t, ir_node root, double both[2]) {
  const int count = ir_count(t->graph);
  unsigned char *needed = must_calloc((size_t)count, 1);
  ir_mark(t->graph, &root, 1, needed);
  for (ir_node n = 0; n <= root; n++)
    for (int end = 0; end < 2 && needed[n]; end++)
      t->value[end * count + n] = value_at(t, n, end);
  for (int end = 0; end < 2; end++)
    both[end] = t->value[end * count + root];
  free(needed);
}

static void find_ends(two_ends *t, ir_node rest, rest_ends *out) {
  enum { DRAWS = 4 };
  t->value = must_calloc(2 * (size_t)ir_count(t->graph), sizeof *t->value);
  law_class_values(t->bonds, t->of_class);
  evaluate(t, rest, out->both);
  out->finite = isfinite(out->both[0]) && isfinite(out->both[1]);
  for (int k = 1; k <= DRAWS; k++) {
    double both[2];
    t->seed = 1000003 * (uint64_t)k;
    evaluate(t, rest, both);
    if (fabs(both[0] - both[1]) > fabs(out->both[0] - out->both[1]))
      for (int end = 0; end < 2; end++)
        out->both[end] = both[end];
  }
  free(t->value);
}

/* What differs from place to place by its nature: the law's fields. */
static law_variation fields_of(const law *l, int *varying) {
  law_variation v = {.varying = varying};
  for (int k = 0; k < l->parameters.count && l->tree->law == LAW_STATE; k++)
    if (symbol_is_field(l->parameters.items[k])) varying[v.varying_count++] = k;
  return v;
}

bool rest_ends_find(const law *l, const double *parameters, const pl_bond_class *bonds,
                    rest_ends *out, diagnostics *d) {
  if (!l->rest) return false;
  int *varying = must_calloc((size_t)l->parameters.count + 1, sizeof *varying);
  const law_variation v = fields_of(l, varying);
  lowered_law lowered;
  ir *g = ir_new();
  arena *memory = arena_new();
  const bool good = lower_law_varying(l, g, LOWER_STEP, &v, memory, &lowered, d);
  two_ends t = {.law = l, .graph = g, .parameters = parameters, .variation = &v, .bonds = bonds};
  if (good) find_ends(&t, lowered.rest, out);
  arena_free(memory);
  ir_free(g);
  free(varying);
  return good;
}

bool rest_ends_differ(const rest_ends *r) {
  const double rounding = 1e-9;
  return fabs(r->both[0] - r->both[1]) > rounding * (fabs(r->both[0]) + fabs(r->both[1]));
}
