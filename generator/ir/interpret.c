#include "generator/ir/interpret.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"

/* One operation over a strip; unused operands point anywhere readable. */
typedef void (*lane_function)(int count, const double *a, const double *b, const double *c,
                              double *out);

/* So many at a time without a rest to look after: strips are multiples of it. Numbers in a line of
   the cache. */
enum { AT_ONCE = 8, LINE = 8 };

#define X(code, name, operands, traits, image, counted, weight, price, value)                      \
  static inline double one_##code(double a, double b, double c) {                                  \
    (void)a, (void)b, (void)c;                                                                     \
    return value;                                                                                  \
  }                                                                                                \
  static void lanes_##code(int count, const double *a, const double *b, const double *c,           \
                           double *restrict out) {                                                 \
    const int whole = count & ~(AT_ONCE - 1);                                                      \
    for (int k = 0; k < whole; k++)                                                                \
      out[k] = one_##code(a[k], b[k], c[k]);                                                       \
    for (int k = whole; k < count; k++)                                                            \
      out[k] = one_##code(a[k], b[k], c[k]);                                                       \
  }
OPERATIONS_OF_NUMBERS(X)
#undef X

static const lane_function lane_functions[IR_OP_COUNT] = {
#define X(code, ...) [IR_##code] = lanes_##code,
    OPERATIONS_OF_NUMBERS(X)
#undef X
};

/* --- the interpreter -------------------------------------------------------------------------- */

typedef struct search search;

typedef struct step {
  lane_function apply; /* NULL: a search */
  const double *a, *b, *c;
  double *out;
  const search *search;
} step;

/* What is done anew in each of its steps. */
struct search {
  step *steps;
  int step_count;
  double *sought;
};

typedef struct input_slot {
  ir_source source;
  int index;
  double *out;
  double all; /* that the first `filled` lanes have */
  int filled;
} input_slot;

struct interpreter {
  int slot_count;
  ir_node *nodes; /* [slot_count] the nodes needed, in evaluation order */
  double *lanes;  /* [slot_count][INTERPRET_LANES], where a line of the cache begins */
  void *space;    /* of the lanes */
  input_slot *inputs;
  int input_count;
  step *steps;
  int step_count;
  search *searches;
  int search_count;
  const double **roots; /* lanes of each root */
  int root_count;
  interpreter_look *look; /* or NULL */
  void *look_context;
};

static double *lanes_of(const interpreter *p, int slot) {
  return p->lanes + (size_t)slot * INTERPRET_LANES;
}

/* Slot of node n, or of the one before which it would stand, by bisection: nodes are sorted. */
static int find_slot(const interpreter *p, ir_node n) {
  int low = 0, high = p->slot_count - 1;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (p->nodes[middle] < n)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

static double *find_lanes(const interpreter *p, ir_node n) {
  const int slot = find_slot(p, n);
  assert(p->slot_count > 0 && p->nodes[slot] == n);
  return lanes_of(p, slot);
}

static step step_of(const interpreter *p, const ir *g, int slot) {
  const ir_node n = p->nodes[slot];
  const ir_op op = ir_operation(g, n);
  const double *operand[3] = {p->lanes, p->lanes, p->lanes};
  for (int k = 0; k < ir_arity(op); k++)
    operand[k] = find_lanes(p, ir_operand(g, n, k));
  assert((op == IR_SEARCH || lane_functions[op]) && "reductions over the family are for programs");
  return (step){lane_functions[op], operand[0], operand[1], operand[2], lanes_of(p, slot), NULL};
}

/* Its steps are those nodes of it that change while it goes on. */
static const search *add_search(interpreter *p, const ir *g, ir_node n) {
  search *s = &p->searches[p->search_count++];
  const ir_node asked[2] = {ir_operand(g, n, 1), ir_operand(g, n, 2)};
  unsigned char *marks = must_calloc((size_t)n + 1, 1);
  ir_mark(g, asked, 2, marks);
  s->steps = must_calloc((size_t)p->slot_count, sizeof *s->steps);
  for (int slot = 0; slot < p->slot_count && p->nodes[slot] < n; slot++) {
    const ir_node of = p->nodes[slot];
    if (!marks[of] || !ir_is_sought(g, of)) continue;
    if (ir_operation(g, of) == IR_INPUT)
      s->sought = lanes_of(p, slot);
    else
      s->steps[s->step_count++] = step_of(p, g, slot);
  }
  free(marks);
  return s;
}

static void add_slot(interpreter *p, const ir *g, int slot) {
  const ir_node n = p->nodes[slot];
  if (ir_is_sought(g, n)) return;
  if (ir_operation(g, n) == IR_CONSTANT) {
    for (int k = 0; k < INTERPRET_LANES; k++)
      lanes_of(p, slot)[k] = ir_value(g, n);
  } else if (ir_operation(g, n) == IR_INPUT) {
    p->inputs[p->input_count++] =
        (input_slot){ir_input_source(g, n), ir_input_index(g, n), lanes_of(p, slot), 0, 0};
  } else {
    step *made = &p->steps[p->step_count++];
    *made = step_of(p, g, slot);
    if (ir_operation(g, n) == IR_SEARCH) made->search = add_search(p, g, n);
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
  p->space = must_calloc(slots * INTERPRET_LANES + LINE, sizeof(double));
  p->lanes = (double *)p->space + (LINE - (uintptr_t)p->space / sizeof(double) % LINE) % LINE;
  p->inputs = must_calloc(slots, sizeof(input_slot));
  p->steps = must_calloc(slots, sizeof(step));
  p->searches = must_calloc(slots, sizeof(search));
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
  for (int k = 0; k < p->search_count; k++)
    free(p->searches[k].steps);
  free(p->searches);
  free(p->steps);
  free(p->inputs);
  free(p->space);
  free(p->nodes);
  free(p);
}

/* One value for all lanes, which most often have it from the run before. */
static void fill(input_slot *slot, const double *value, int count) {
  if (count <= slot->filled && memcmp(value, &slot->all, sizeof *value) == 0) return;
  for (int lane = 0; lane < count; lane++)
    slot->out[lane] = *value;
  slot->all = *value;
  slot->filled = count;
}

static void load(const interpreter *p, const interpreter_inputs *in, int first, int count) {
  for (int k = 0; k < p->input_count; k++) {
    input_slot *slot = &p->inputs[k];
    assert(in->values[slot->source] && in->values[slot->source][slot->index]);
    const double *from = in->values[slot->source][slot->index];
    const unsigned char *strides = in->stride[slot->source];
    if (!strides || !strides[slot->index]) {
      fill(slot, from, count);
      continue;
    }
    memcpy(slot->out, from + first, sizeof(double) * (size_t)count);
    slot->filled = 0;
  }
}

/* As emitted kernels do it (point_loops): all lanes as long as one goes on. */
static void run_search(const step *of, int lanes) {
  pl_search_place at[INTERPRET_LANES];
  bool goes_on = true;
  for (int k = 0; k < lanes; k++)
    at[k] = pl_search_from(of->a[k]);
  for (int n = 0; n < PL_SEARCH_STEPS && goes_on; n++) {
    goes_on = false;
    for (int k = 0; k < lanes; k++)
      of->search->sought[k] = at[k].z;
    for (int k = 0; k < of->search->step_count; k++) {
      const step *s = &of->search->steps[k];
      s->apply(lanes, s->a, s->b, s->c, s->out);
    }
    for (int k = 0; k < lanes; k++) {
      at[k] = pl_search(at[k], of->b[k], of->c[k]);
      goes_on = goes_on || at[k].going != 0;
    }
  }
  for (int k = 0; k < lanes; k++)
    of->out[k] = at[k].z;
}

static void run_steps(const step *steps, int step_count, int lanes) {
  for (int k = 0; k < step_count; k++) {
    const step *s = &steps[k];
    if (s->apply)
      s->apply(lanes, s->a, s->b, s->c, s->out);
    else
      run_search(s, lanes);
  }
}

void interpreter_run(interpreter *p, const interpreter_inputs *in, int count,
                     double *const *outputs) {
  for (int first = 0; first < count; first += INTERPRET_LANES) {
    const int left = count - first;
    const int lanes = left < INTERPRET_LANES ? left : INTERPRET_LANES;
    load(p, in, first, lanes);
    run_steps(p->steps, p->step_count, lanes);
    for (int k = 0; k < p->root_count && outputs; k++)
      memcpy(outputs[k] + first, p->roots[k], sizeof(double) * (size_t)lanes);
    if (p->look) p->look(p->look_context, p, lanes);
  }
}

const double *interpreter_root(const interpreter *p, int root) {
  return p->roots[root];
}

void interpreter_watch(interpreter *p, interpreter_look *look, void *context) {
  p->look = look;
  p->look_context = context;
}

const double *interpreter_lanes(const interpreter *p, ir_node n) {
  const int slot = find_slot(p, n);
  return p->slot_count > 0 && p->nodes[slot] == n ? lanes_of(p, slot) : NULL;
}

ir_node interpreter_first_bad(const interpreter *p) {
  for (int slot = 0; slot < p->slot_count; slot++)
    if (!isfinite(lanes_of(p, slot)[0])) return p->nodes[slot];
  return IR_NONE;
}

double interpreter_value(const interpreter *p, ir_node n) {
  return *find_lanes(p, n);
}
