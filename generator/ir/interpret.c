#include "generator/ir/interpret.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"

/* One operation over a strip; unused operands point anywhere readable. */
typedef void (*lane_function)(int count, const double *a, const double *b, const double *c,
                              double *out);

#define X(code, name, operands, traits, image, counted, weight, price, value)                      \
  static void lanes_##code(int count, const double *pa, const double *pb, const double *pc,        \
                           double *restrict out) {                                                 \
    for (int k = 0; k < count; k++) {                                                              \
      const double a = pa[k], b = pb[k], c = pc[k];                                                \
      (void)a, (void)b, (void)c;                                                                   \
      out[k] = value;                                                                              \
    }                                                                                              \
  }
OPERATIONS_OF_NUMBERS(X)
#undef X

static const lane_function lane_functions[IR_OP_COUNT] = {
#define X(code, ...) [IR_##code] = lanes_##code,
    OPERATIONS_OF_NUMBERS(X)
#undef X
};

/* --- the interpreter -------------------------------------------------------------------------- */

typedef struct step {
  lane_function apply;
  const double *a, *b, *c;
  double *out;
} step;

typedef struct input_slot {
  ir_source source;
  int index;
  double *out;
} input_slot;

struct interpreter {
  int slot_count;
  ir_node *nodes; /* [slot_count] the nodes needed, in evaluation order */
  double *lanes;  /* [slot_count][INTERPRET_LANES] */
  input_slot *inputs;
  int input_count;
  step *steps;
  int step_count;
  const double **roots; /* lanes of each root */
  int root_count;
};

static double *lanes_of(const interpreter *p, int slot) {
  return p->lanes + (size_t)slot * INTERPRET_LANES;
}

/* Lanes of node n, by bisection: nodes are sorted. */
static double *find_lanes(const interpreter *p, ir_node n) {
  int low = 0, high = p->slot_count - 1;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (p->nodes[middle] < n)
      low = middle + 1;
    else
      high = middle;
  }
  assert(p->slot_count > 0 && p->nodes[low] == n);
  return lanes_of(p, low);
}

static void add_step(interpreter *p, const ir *g, int slot) {
  const ir_node n = p->nodes[slot];
  const ir_op op = ir_operation(g, n);
  const double *operand[3] = {p->lanes, p->lanes, p->lanes};
  for (int k = 0; k < ir_arity(op); k++)
    operand[k] = find_lanes(p, ir_operand(g, n, k));
  assert(lane_functions[op] && "reductions over the family are for programs");
  p->steps[p->step_count++] =
      (step){lane_functions[op], operand[0], operand[1], operand[2], lanes_of(p, slot)};
}

static void add_slot(interpreter *p, const ir *g, int slot) {
  const ir_node n = p->nodes[slot];
  if (ir_operation(g, n) == IR_CONSTANT) {
    for (int k = 0; k < INTERPRET_LANES; k++)
      lanes_of(p, slot)[k] = ir_value(g, n);
  } else if (ir_operation(g, n) == IR_INPUT) {
    p->inputs[p->input_count++] =
        (input_slot){ir_input_source(g, n), ir_input_index(g, n), lanes_of(p, slot)};
  } else {
    add_step(p, g, slot);
  }
}

static void find_needed(interpreter *p, const ir *g, const ir_node *roots, int root_count) {
  const int count = ir_count(g);
  unsigned char *marks = must_calloc((size_t)count, 1);
  ir_mark(g, roots, root_count, marks);
  p->nodes = must_alloc(sizeof(ir_node) * (size_t)count);
  for (ir_node n = 0; n < count; n++)
    if (marks[n]) p->nodes[p->slot_count++] = n;
  free(marks);
}

interpreter *interpreter_new(const ir *g, const ir_node *roots, int root_count) {
  interpreter *p = must_calloc(1, sizeof(interpreter));
  find_needed(p, g, roots, root_count);
  const size_t slots = (size_t)p->slot_count;
  p->lanes = must_calloc(slots * INTERPRET_LANES, sizeof(double));
  p->inputs = must_calloc(slots, sizeof(input_slot));
  p->steps = must_calloc(slots, sizeof(step));
  for (int slot = 0; slot < p->slot_count; slot++)
    add_slot(p, g, slot);
  p->roots = must_calloc((size_t)root_count, sizeof(double *));
  p->root_count = root_count;
  for (int k = 0; k < root_count; k++)
    p->roots[k] = find_lanes(p, roots[k]);
  return p;
}

void interpreter_free(interpreter *p) {
  if (!p) return;
  free(p->roots);
  free(p->steps);
  free(p->inputs);
  free(p->lanes);
  free(p->nodes);
  free(p);
}

static void load(const interpreter *p, const interpreter_inputs *in, int first, int count) {
  for (int k = 0; k < p->input_count; k++) {
    const input_slot *slot = &p->inputs[k];
    assert(in->values[slot->source] && in->values[slot->source][slot->index]);
    const double *from = in->values[slot->source][slot->index];
    const unsigned char *strides = in->stride[slot->source];
    if (strides && strides[slot->index])
      memcpy(slot->out, from + first, sizeof(double) * (size_t)count);
    else
      for (int lane = 0; lane < count; lane++)
        slot->out[lane] = *from;
  }
}

void interpreter_run(interpreter *p, const interpreter_inputs *in, int count,
                     double *const *outputs) {
  for (int first = 0; first < count; first += INTERPRET_LANES) {
    const int left = count - first;
    const int lanes = left < INTERPRET_LANES ? left : INTERPRET_LANES;
    load(p, in, first, lanes);
    for (int k = 0; k < p->step_count; k++) {
      const step *s = &p->steps[k];
      s->apply(lanes, s->a, s->b, s->c, s->out);
    }
    for (int k = 0; k < p->root_count; k++)
      memcpy(outputs[k] + first, p->roots[k], sizeof(double) * (size_t)lanes);
  }
}

ir_node interpreter_first_bad(const interpreter *p) {
  for (int slot = 0; slot < p->slot_count; slot++)
    if (!isfinite(lanes_of(p, slot)[0])) return p->nodes[slot];
  return IR_NONE;
}

double interpreter_value(const interpreter *p, ir_node n) {
  return *find_lanes(p, n);
}
