#include "generator/ir/ir.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"

enum { FIRST_NODES = 256, LARGEST_EXPONENT = 16 };

typedef enum expected_as { AS_NOTHING, AS_ANY, AS_SIZE } expected_as;

typedef struct node {
  ir_op op;
  ir_node operand[3];
  double value;     /* CONSTANT */
  ir_source source; /* INPUT */
  int index;        /* INPUT */
  placement place;
  bool of_class;          /* differs from neighbour to neighbour, but not along a row */
  unsigned char expected; /* a condition that holds nearly always: an expected_as */
  bool may_be_nan;
  bool sought; /* changes while a search goes on */
  const char *name;
  span where;
} node;

struct ir {
  node *nodes;
  int count, room;
  ir_node *table; /* open addressing, a power of two and at least twice the nodes; IR_NONE: free */
  uint32_t mask;
  arena *names;
  const source_set *sources;
};

int ir_arity(ir_op op) {
  return operations[op].arity;
}
const char *ir_op_name(ir_op op) {
  return operations[op].name;
}

/* --- nodes and the table that finds them ------------------------------------------------------ */

ir *ir_new(void) {
  ir *g = must_calloc(1, sizeof(ir));
  g->room = FIRST_NODES;
  g->nodes = must_alloc(sizeof(node) * (size_t)g->room);
  g->mask = 2 * FIRST_NODES - 1;
  g->table = must_alloc(sizeof(ir_node) * (size_t)(g->mask + 1));
  memset(g->table, 0xff, sizeof(ir_node) * (size_t)(g->mask + 1));
  g->names = arena_new();
  return g;
}

void ir_free(ir *g) {
  if (!g) return;
  arena_free(g->names);
  free(g->table);
  free(g->nodes);
  free(g);
}

void ir_set_sources(ir *g, const source_set *sources) {
  g->sources = sources;
}

static uint32_t hash_of(const node *n) {
  const uint64_t parts[] = {(uint64_t)n->op,         (uint32_t)n->operand[0],
                            (uint32_t)n->operand[1], (uint32_t)n->operand[2],
                            pl_to_bits(n->value),    (uint64_t)n->source,
                            (uint32_t)n->index,      (uint64_t)n->place};
  uint64_t h = 0;
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) {
    h = (h ^ parts[k]) * UINT64_C(0x9e3779b97f4a7c15);
    h ^= h >> 29;
  }
  return (uint32_t)(h >> 32);
}

static bool is_same(const node *a, const node *b) {
  return a->op == b->op && a->operand[0] == b->operand[0] && a->operand[1] == b->operand[1] &&
         a->operand[2] == b->operand[2] && pl_to_bits(a->value) == pl_to_bits(b->value) &&
         a->source == b->source && a->index == b->index && a->place == b->place;
}

static void grow_table(ir *g) {
  g->mask = 2 * g->mask + 1;
  const size_t size = sizeof(ir_node) * ((size_t)g->mask + 1);
  g->table = must_realloc(g->table, size);
  memset(g->table, 0xff, size);
  for (ir_node n = 0; n < g->count; n++) {
    uint32_t slot = hash_of(&g->nodes[n]) & g->mask;
    while (g->table[slot] != IR_NONE)
      slot = (slot + 1) & g->mask;
    g->table[slot] = n;
  }
}

/* The node equal to `wanted`, made if there is none. */
static ir_node intern(ir *g, const node *wanted) {
  uint32_t slot = hash_of(wanted) & g->mask;
  for (; g->table[slot] != IR_NONE; slot = (slot + 1) & g->mask)
    if (is_same(&g->nodes[g->table[slot]], wanted)) return g->table[slot];
  if (g->count == g->room) {
    g->room *= 2;
    g->nodes = must_realloc(g->nodes, sizeof(node) * (size_t)g->room);
  }
  const ir_node made = g->count++;
  g->nodes[made] = *wanted;
  g->table[slot] = made;
  if ((uint32_t)g->count > g->mask / 2) grow_table(g);
  return made;
}

static node blank(ir_op op) {
  return (node){.op = op, .operand = {IR_NONE, IR_NONE, IR_NONE}};
}

ir_node ir_constant(ir *g, double value) {
  node n = blank(IR_CONSTANT);
  n.value = value == value ? value : PL_NAN; /* one NaN, whatever its bits */
  return intern(g, &n);
}

ir_node ir_input(ir *g, ir_source from, int index, const char *name, placement on) {
  node n = blank(IR_INPUT);
  n.source = from;
  n.index = index;
  n.place = on;
  const ir_node made = intern(g, &n);
  node *input = &g->nodes[made];
  if (name && !input->name) input->name = arena_text(g->names, name, strlen(name));
  return made;
}

/* --- questions about nodes -------------------------------------------------------------------- */

static const node *at(const ir *g, ir_node n) {
  assert(n >= 0 && n < g->count);
  return &g->nodes[n];
}

int ir_count(const ir *g) {
  return g->count;
}
ir_op ir_operation(const ir *g, ir_node n) {
  return at(g, n)->op;
}
ir_node ir_operand(const ir *g, ir_node n, int k) {
  return at(g, n)->operand[k];
}
double ir_value(const ir *g, ir_node n) {
  return at(g, n)->value;
}
ir_source ir_input_source(const ir *g, ir_node n) {
  return at(g, n)->source;
}
int ir_input_index(const ir *g, ir_node n) {
  return at(g, n)->index;
}
placement ir_place(const ir *g, ir_node n) {
  return at(g, n)->place;
}
ir_node ir_mark_class(ir *g, ir_node input) {
  g->nodes[input].of_class = true;
  return input;
}
bool ir_is_of_class(const ir *g, ir_node n) {
  return at(g, n)->of_class;
}
static ir_node expect(ir *g, ir_node condition, unsigned char as) {
  node *n = &g->nodes[condition];
  if (n->op != IR_CONSTANT && n->expected < as) n->expected = as;
  return condition;
}
ir_node ir_expect(ir *g, ir_node size_is_small) {
  return expect(g, size_is_small, AS_SIZE);
}
ir_node ir_expect_any(ir *g, ir_node condition) {
  return expect(g, condition, AS_ANY);
}
bool ir_is_expected(const ir *g, ir_node n) {
  return at(g, n)->expected != AS_NOTHING;
}
bool ir_is_expected_of_size(const ir *g, ir_node n) {
  return at(g, n)->expected == AS_SIZE;
}

bool ir_is_sought(const ir *g, ir_node n) {
  return at(g, n)->sought;
}

bool ir_may_be_nan(const ir *g, ir_node n) {
  return at(g, n)->may_be_nan;
}

bool ir_is_expected_choice(const ir *g, ir_node n) {
  return ir_operation(g, n) == IR_SELECT && ir_is_expected(g, ir_operand(g, n, 0));
}
bool ir_is_logical(const ir *g, ir_node n) {
  return operation_has(at(g, n)->op, LOGICAL);
}
const char *ir_name(const ir *g, ir_node n) {
  return at(g, n)->name;
}
span ir_where(const ir *g, ir_node n) {
  return at(g, n)->where;
}

void ir_set_name(ir *g, ir_node n, const char *name, span where) {
  node *named = &g->nodes[n];
  if (named->name || named->op == IR_CONSTANT || !name) return;
  named->name = arena_text(g->names, name, strlen(name));
  named->where = where;
}

static bool is_constant(const ir *g, ir_node n) {
  return at(g, n)->op == IR_CONSTANT;
}

bool ir_is_number(const ir *g, ir_node n, double value) {
  return is_constant(g, n) && at(g, n)->value == value;
}

static bool is_op(const ir *g, ir_node n, ir_op op) {
  return at(g, n)->op == op;
}

/* --- simplification --------------------------------------------------------------------------- */

static ir_node make_node(ir *g, ir_op op, ir_node a, ir_node b, ir_node c) {
  node n = blank(op);
  const bool swapped = operation_has(op, COMMUTES) && b < a; /* the earlier node stands first */
  const ir_node operand[3] = {swapped ? b : a, swapped ? a : b, c};
  for (int k = 0; k < ir_arity(op); k++) {
    n.operand[k] = operand[k];
    if (at(g, operand[k])->place > n.place) n.place = at(g, operand[k])->place;
  }
  for (int k = 0; k < ir_arity(op) && !ir_is_reduction(op); k++)
    n.of_class = n.of_class || at(g, operand[k])->of_class;
  if (ir_is_reduction(op)) n.place = ON_PARTICLE;
  if (op == IR_NEIGHBOUR) n.place = ON_NEIGHBOUR;
  n.may_be_nan = operation_has(op, MAKES_NAN) && n.place > ON_BODY;
  for (int k = 0; k < ir_arity(op); k++)
    n.may_be_nan = n.may_be_nan || at(g, operand[k])->may_be_nan;
  for (int k = 0; k < ir_arity(op) && op != IR_SEARCH; k++)
    n.sought = n.sought || at(g, operand[k])->sought;
  return intern(g, &n);
}

static ir_node simplify_add(ir *g, ir_node a, ir_node b) {
  if (ir_is_number(g, a, 0.0)) return b;
  if (ir_is_number(g, b, 0.0)) return a;
  if (is_op(g, b, IR_NEG)) return ir_sub(g, a, ir_operand(g, b, 0));
  if (is_op(g, a, IR_NEG)) return ir_sub(g, b, ir_operand(g, a, 0));
  return make_node(g, IR_ADD, a, b, IR_NONE);
}

static ir_node simplify_sub(ir *g, ir_node a, ir_node b) {
  if (ir_is_number(g, b, 0.0)) return a;
  if (ir_is_number(g, a, 0.0)) return ir_neg(g, b);
  if (is_op(g, b, IR_NEG)) return ir_add(g, a, ir_operand(g, b, 0));
  return make_node(g, IR_SUB, a, b, IR_NONE);
}

static ir_node simplify_mul(ir *g, ir_node a, ir_node b) {
  if (is_constant(g, a)) { /* a constant factor stands second while it is looked at */
    const ir_node swapped = a;
    a = b;
    b = swapped;
  }
  if (ir_is_number(g, b, 1.0)) return a;
  if (ir_is_number(g, b, -1.0)) return ir_neg(g, a);
  if (is_op(g, a, IR_NEG) && is_constant(g, b))
    return ir_mul(g, ir_operand(g, a, 0), ir_constant(g, -ir_value(g, b)));
  if (is_op(g, a, IR_NEG)) return ir_neg(g, ir_mul(g, ir_operand(g, a, 0), b));
  if (is_op(g, b, IR_NEG)) return ir_neg(g, ir_mul(g, a, ir_operand(g, b, 0)));
  return make_node(g, IR_MUL, a, b, IR_NONE);
}

/* Whether 1/value is exact: a power of two well inside the normal range. */
static bool has_exact_reciprocal(double value) {
  const uint64_t bits = pl_to_bits(value);
  const uint64_t exponent = (bits >> 52) & 0x7ff;
  return (bits & UINT64_C(0x000fffffffffffff)) == 0 && exponent >= 2 && exponent <= 2044;
}

static ir_node simplify_div(ir *g, ir_node a, ir_node b) {
  if (is_constant(g, b) && has_exact_reciprocal(ir_value(g, b)))
    return ir_mul(g, a, ir_constant(g, 1.0 / ir_value(g, b)));
  if (is_op(g, a, IR_NEG)) return ir_neg(g, ir_div(g, ir_operand(g, a, 0), b));
  if (is_op(g, b, IR_NEG)) return ir_neg(g, ir_div(g, a, ir_operand(g, b, 0)));
  return make_node(g, IR_DIV, a, b, IR_NONE);
}

static ir_node simplify_neg(ir *g, ir_node a) {
  return is_op(g, a, IR_NEG) ? ir_operand(g, a, 0) : make_node(g, IR_NEG, a, IR_NONE, IR_NONE);
}

static ir_node simplify_abs(ir *g, ir_node a) {
  if (is_op(g, a, IR_NEG)) a = ir_operand(g, a, 0);
  const bool never_negative = operations[at(g, a)->op].image.low >= 0;
  return never_negative ? a : make_node(g, IR_ABS, a, IR_NONE, IR_NONE);
}

/* Any number as a truth value: other than 0. */
static ir_node as_logical(ir *g, ir_node a) {
  if (ir_is_logical(g, a)) return a;
  if (is_constant(g, a)) return ir_constant(g, ir_value(g, a) != 0.0 ? 1.0 : 0.0);
  const ir_node zero = ir_make(g, IR_EQ, a, ir_constant(g, 0.0), IR_NONE);
  return make_node(g, IR_NOT, zero, IR_NONE, IR_NONE);
}

static ir_node simplify_not(ir *g, ir_node a) {
  return is_op(g, a, IR_NOT) ? ir_operand(g, a, 0) : make_node(g, IR_NOT, a, IR_NONE, IR_NONE);
}

/* a and b, a or b: `neutral` leaves the other as it is, its opposite decides. */
static ir_node simplify_junction(ir *g, ir_op op, ir_node a, ir_node b) {
  const double neutral = op == IR_AND ? 1.0 : 0.0;
  if (a == b || ir_is_number(g, b, neutral) || ir_is_number(g, a, 1.0 - neutral)) return a;
  if (ir_is_number(g, a, neutral) || ir_is_number(g, b, 1.0 - neutral)) return b;
  return make_node(g, op, a, b, IR_NONE);
}

static ir_node simplify_select(ir *g, ir_node condition, ir_node yes, ir_node no) {
  if (yes == no) return yes;
  if (is_constant(g, condition)) return ir_value(g, condition) != 0.0 ? yes : no;
  if (is_op(g, condition, IR_NOT)) return ir_select(g, ir_operand(g, condition, 0), no, yes);
  if (!ir_is_logical(g, yes) || !ir_is_logical(g, no))
    return make_node(g, IR_SELECT, condition, yes, no);
  const ir_node otherwise = ir_make(g, IR_NOT, condition, IR_NONE, IR_NONE);
  const ir_node first = ir_make(g, IR_AND, condition, yes, IR_NONE);
  const ir_node second = ir_make(g, IR_AND, otherwise, no, IR_NONE);
  return ir_make(g, IR_OR, first, second, IR_NONE);
}

bool ir_is_reduction(ir_op op) {
  return operation_has(op, OVER_FAMILY);
}

/* True, and the result in *value, when all operands are constants. */
static bool fold(const ir *g, ir_op op, const ir_node operand[3], double *value) {
  double v[3] = {0.0, 0.0, 0.0};
  if (ir_is_reduction(op) || op == IR_SEARCH) return false;
  for (int k = 0; k < ir_arity(op); k++) {
    if (!is_constant(g, operand[k])) return false;
    v[k] = ir_value(g, operand[k]);
  }
  *value = operation_value(op, v[0], v[1], v[2]);
  return true;
}

static bool takes_logical(ir_op op) {
  return op == IR_AND || op == IR_OR || op == IR_NOT || op == IR_SELECT;
}

ir_node ir_make(ir *g, ir_op op, ir_node a, ir_node b, ir_node c) {
  assert(ir_arity(op) > 0);
  if (takes_logical(op)) a = as_logical(g, a);
  if (op == IR_AND || op == IR_OR) b = as_logical(g, b);
  if (op == IR_NEIGHBOUR && is_constant(g, a)) return a;
  if (op == IR_NEIGHBOUR && is_op(g, a, IR_NEIGHBOUR)) return ir_operand(g, a, 0);
  double value;
  if (fold(g, op, (ir_node[3]){a, b, c}, &value)) return ir_constant(g, value);
  switch (op) {
  case IR_ADD:
    return simplify_add(g, a, b);
  case IR_SUB:
    return simplify_sub(g, a, b);
  case IR_MUL:
    return simplify_mul(g, a, b);
  case IR_DIV:
    return simplify_div(g, a, b);
  case IR_NEG:
    return simplify_neg(g, a);
  case IR_ABS:
    return simplify_abs(g, a);
  case IR_NOT:
    return simplify_not(g, a);
  case IR_AND:
  case IR_OR:
    return simplify_junction(g, op, a, b);
  case IR_SELECT:
    return simplify_select(g, a, b, c);
  case IR_MIN:
  case IR_MAX:
    return a == b ? a : make_node(g, op, a, b, c);
  case IR_LT:
    return a == b ? ir_constant(g, 0.0) : make_node(g, op, a, b, c);
  default:
    return make_node(g, op, a, b, c);
  }
}

ir_node ir_add(ir *g, ir_node a, ir_node b) {
  return ir_make(g, IR_ADD, a, b, IR_NONE);
}
ir_node ir_sub(ir *g, ir_node a, ir_node b) {
  return ir_make(g, IR_SUB, a, b, IR_NONE);
}
ir_node ir_mul(ir *g, ir_node a, ir_node b) {
  return ir_make(g, IR_MUL, a, b, IR_NONE);
}
ir_node ir_div(ir *g, ir_node a, ir_node b) {
  return ir_make(g, IR_DIV, a, b, IR_NONE);
}
ir_node ir_neg(ir *g, ir_node a) {
  return ir_make(g, IR_NEG, a, IR_NONE, IR_NONE);
}

ir_node ir_scaled(ir *g, double factor, ir_node a) {
  return ir_mul(g, ir_constant(g, factor), a);
}
ir_node ir_sought(ir *g) {
  const ir_node n = ir_input(g, IR_FROM_SEARCH, 0, "sought", ON_POINT);
  g->nodes[n].sought = true;
  return n;
}

ir_node ir_search(ir *g, ir_node start, ir_node step, ir_node open) {
  return ir_make(g, IR_SEARCH, start, step, open);
}

ir_node ir_select(ir *g, ir_node condition, ir_node yes, ir_node no) {
  return ir_make(g, IR_SELECT, condition, yes, no);
}

/* --- powers ----------------------------------------------------------------------------------- */

static ir_node whole_power(ir *g, ir_node base, int n) {
  ir_node result = IR_NONE;
  for (ir_node square = base; n > 0; n >>= 1) {
    if (n & 1) result = result == IR_NONE ? square : ir_mul(g, result, square);
    if (n > 1) square = ir_mul(g, square, square);
  }
  return result == IR_NONE ? ir_constant(g, 1.0) : result;
}

ir_node ir_power(ir *g, ir_node base, ir_node exponent) {
  if (!is_constant(g, exponent)) return ir_make(g, IR_POW, base, exponent, IR_NONE);
  const double power = ir_value(g, exponent), size = fabs(power);
  const bool whole = size == floor(size), half = size == floor(size) + 0.5;
  ir_node result;
  if (size == 1.0 / 3.0)
    result = ir_make(g, IR_CBRT, base, IR_NONE, IR_NONE);
  else if (size <= LARGEST_EXPONENT && (whole || half))
    result = whole_power(g, base, (int)size);
  else
    return ir_make(g, IR_POW, base, exponent, IR_NONE);
  if (half) result = ir_mul(g, result, ir_make(g, IR_SQRT, base, IR_NONE, IR_NONE));
  return power < 0.0 ? ir_div(g, ir_constant(g, 1.0), result) : result;
}

/* --- walks over the graph --------------------------------------------------------------------- */

void ir_mark(const ir *g, const ir_node *roots, int root_count, unsigned char *marks) {
  ir_node last = IR_NONE;
  for (int k = 0; k < root_count; k++) {
    if (roots[k] == IR_NONE) continue;
    marks[roots[k]] = 1;
    if (roots[k] > last) last = roots[k];
  }
  for (ir_node n = last; n >= 0; n--) {
    if (!marks[n]) continue;
    for (int k = 0; k < ir_arity(at(g, n)->op); k++)
      marks[at(g, n)->operand[k]] = 1;
  }
}

/* The node with its operands replaced by their images. */
static ir_node rebuild(ir *g, ir_node n, const ir_node *image) {
  const node old = *at(g, n); /* a copy: the array may move */
  ir_node operand[3] = {IR_NONE, IR_NONE, IR_NONE};
  bool same = true;
  for (int k = 0; k < ir_arity(old.op); k++) {
    operand[k] = image[old.operand[k]];
    same = same && operand[k] == old.operand[k];
  }
  if (same) return n;
  const ir_node made = ir_make(g, old.op, operand[0], operand[1], operand[2]);
  if (old.name) ir_set_name(g, made, old.name, old.where);
  expect(g, made, old.expected);
  return made;
}

void ir_substitute(ir *g, const ir_node *roots, int root_count, const ir_node *from,
                   const ir_node *to, int pair_count, ir_node *out) {
  const int count = ir_count(g);
  unsigned char *marks = must_calloc((size_t)count, 1);
  ir_node *image = must_alloc(sizeof(ir_node) * (size_t)(count ? count : 1));
  ir_mark(g, roots, root_count, marks);
  for (ir_node n = 0; n < count; n++)
    image[n] = IR_NONE;
  for (int k = 0; k < pair_count; k++)
    image[from[k]] = to[k];
  for (ir_node n = 0; n < count; n++)
    if (marks[n] && image[n] == IR_NONE) image[n] = rebuild(g, n, image);
  for (int k = 0; k < root_count; k++)
    out[k] = roots[k] == IR_NONE ? IR_NONE : image[roots[k]];
  free(image);
  free(marks);
}

struct ir_substitution {
  ir *graph;
  ir_node *image;        /* [known] of the nodes so far; IR_NONE: not rebuilt yet */
  unsigned char *listed; /* [known] */
  ir_node *list;         /* [known] what a root needs that has no image */
  int known;
};

ir_substitution *ir_substitution_new(ir *g) {
  ir_substitution *s = must_calloc(1, sizeof *s);
  s->graph = g;
  return s;
}

void ir_substitution_free(ir_substitution *s) {
  free(s->image);
  free(s->listed);
  free(s->list);
  free(s);
}

/* Rebuilding makes nodes that later roots may need. */
static void know_all(ir_substitution *s) {
  const int count = ir_count(s->graph);
  if (count <= s->known) return;
  const int room = 2 * count;
  s->image = must_realloc(s->image, (size_t)room * sizeof *s->image);
  s->list = must_realloc(s->list, (size_t)room * sizeof *s->list);
  s->listed = must_realloc(s->listed, (size_t)room);
  for (int k = s->known; k < room; k++) {
    s->image[k] = IR_NONE;
    s->listed[k] = 0;
  }
  s->known = room;
}

void ir_substitution_add(ir_substitution *s, ir_node from, ir_node to) {
  know_all(s);
  assert(s->image[from] == IR_NONE);
  s->image[from] = to;
}

static int by_number(const void *a, const void *b) {
  const ir_node x = *(const ir_node *)a, y = *(const ir_node *)b;
  return x < y ? -1 : x > y;
}

static void list_node(ir_substitution *s, ir_node n, int *count) {
  if (s->image[n] != IR_NONE || s->listed[n]) return;
  s->listed[n] = 1;
  s->list[(*count)++] = n;
}

ir_node ir_substitution_apply(ir_substitution *s, ir_node root) {
  int count = 0;
  know_all(s);
  list_node(s, root, &count);
  for (int k = 0; k < count; k++) {
    const node *n = at(s->graph, s->list[k]);
    for (int o = 0; o < ir_arity(n->op); o++)
      list_node(s, n->operand[o], &count);
  }
  qsort(s->list, (size_t)count, sizeof *s->list, by_number);
  for (int k = 0; k < count; k++) {
    s->image[s->list[k]] = rebuild(s->graph, s->list[k], s->image);
    s->listed[s->list[k]] = 0;
  }
  return s->image[root];
}

static void count_operation(ir_op op, ir_cost *cost) {
  const operation_count as = operations[op].count;
  cost->additions += as == COUNT_ADDITION || as == COUNT_FUSED;
  cost->multiplications += as == COUNT_MULTIPLICATION || as == COUNT_FUSED;
  cost->divisions += as == COUNT_DIVISION;
  cost->functions += as == COUNT_FUNCTION;
  cost->selects += as == COUNT_SELECT;
}

ir_cost ir_count_cost(const ir *g, const ir_node *roots, int root_count, placement at_least,
                      const unsigned char *but) {
  ir_cost cost = {0};
  unsigned char *marks = must_calloc((size_t)g->count, 1);
  ir_mark(g, roots, root_count, marks);
  for (ir_node n = 0; n < g->count; n++)
    if (marks[n] && !(but && but[n]) && at(g, n)->place >= at_least)
      count_operation(at(g, n)->op, &cost);
  free(marks);
  return cost;
}

/* --- printing --------------------------------------------------------------------------------- */

static const char *const source_names[IR_SOURCE_COUNT] = {
    [IR_FROM_PARAMETER] = "parameter",
    [IR_FROM_QUANTITY] = "quantity",
    [IR_FROM_FIELD] = "field",
    [IR_FROM_BOND_PARAMETER] = "bond parameter",
    [IR_FROM_PARTICLE_PARAMETER] = "particle's parameter",
    [IR_FROM_NEIGHBOUR_PARAMETER] = "neighbour's parameter",
    [IR_FROM_ENDS] = "ends",
    [IR_FROM_SHAPE] = "shape",
    [IR_FROM_NEIGHBOUR_FIELD] = "neighbour's field",
    [IR_FROM_LINK] = "link",
    [IR_FROM_NEIGHBOUR_LINK] = "neighbour's link",
    [IR_FROM_BOND_LINK] = "link of bonds",
    [IR_FROM_NEIGHBOUR_BOND_LINK] = "neighbour's link of bonds",
    [IR_FROM_SHARED] = "shared",
    [IR_FROM_SHARED_ODD] = "shared_odd",
    [IR_FROM_NEW_FIELD] = "new field",
    [IR_FROM_SLOT] = "slot",
    [IR_FROM_PLANE] = "plane",
    [IR_FROM_TIP] = "tip",
    [IR_FROM_POINT] = "point",
    [IR_FROM_SEARCH] = "search",
};

static void dump_node(const ir *g, ir_node number, FILE *out) {
  const node *n = at(g, number);
  fprintf(out, "%%%d = %s", number, ir_op_name(n->op));
  if (n->op == IR_CONSTANT) fprintf(out, " %.17g", n->value);
  if (n->op == IR_INPUT) fprintf(out, " %s %d", source_names[n->source], n->index);
  for (int k = 0; k < ir_arity(n->op); k++)
    fprintf(out, " %%%d", n->operand[k]);
  if (n->place != ON_NOTHING) fprintf(out, " : %s", placement_name(n->place));
  if (n->name) fprintf(out, "  ; %s", n->name);
  if (g->sources && n->where.end > 0)
    fprintf(out, " (line %d)", source_line_number(g->sources, n->where.file, n->where.begin));
  fputc('\n', out);
}

void ir_dump(const ir *g, const ir_node *roots, const char *const *root_names, int root_count,
             FILE *out) {
  unsigned char *marks = must_calloc((size_t)g->count, 1);
  ir_mark(g, roots, root_count, marks);
  for (ir_node n = 0; n < g->count; n++)
    if (marks[n]) dump_node(g, n, out);
  for (int k = 0; k < root_count; k++)
    if (roots[k] != IR_NONE) fprintf(out, "%s = %%%d\n", root_names[k], roots[k]);
  free(marks);
}
