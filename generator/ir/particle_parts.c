#include "generator/ir/particle_parts.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/semantics/builtins.h"

enum { MOST_PARTS = 4, MOST_FACTORS = 8 };

typedef struct product {
  ir_node particle;           /* IR_NONE: 1 */
  ir_node bond[MOST_FACTORS]; /* [count] in the order of the graph */
  int count;
} product;

typedef struct products {
  product of[MOST_PARTS];
  int count; /* 0: cannot be taken apart */
} products;

typedef struct taking_apart {
  ir *g;
  unsigned char *sided; /* may differ from end to end */
  int node_count;
} taking_apart;

static bool is_sided_input(const ir *g, ir_node n) {
  const placement on = ir_place(g, n);
  if (on == ON_PARTICLE || on == ON_NEIGHBOUR) return true;
  return ir_input_source(g, n) == IR_FROM_QUANTITY &&
         (ir_input_index(g, n) == QUANTITY_M_END_I || ir_input_index(g, n) == QUANTITY_M_END_J);
}

static void find_sided(taking_apart *t, const ir_node *same, int same_count) {
  const ir *g = t->g;
  for (ir_node n = 0; n < t->node_count; n++) {
    const ir_op op = ir_operation(g, n);
    bool sided = op == IR_INPUT ? is_sided_input(g, n) : op == IR_NEIGHBOUR || ir_is_reduction(op);
    for (int k = 0; k < ir_arity(op); k++)
      sided = sided || t->sided[ir_operand(g, n, k)];
    for (int k = 0; k < same_count; k++)
      sided = sided && same[k] != n;
    t->sided[n] = sided;
  }
}

static ir_node times(ir *g, ir_node a, ir_node b) {
  return a == IR_NONE ? b : b == IR_NONE ? a : ir_mul(g, a, b);
}

static bool add_factor(product *p, ir_node n) {
  if (p->count == MOST_FACTORS) return false;
  int at = p->count++;
  for (; at > 0 && p->bond[at - 1] > n; at--)
    p->bond[at] = p->bond[at - 1];
  p->bond[at] = n;
  return true;
}

static bool add_product(ir *g, products *to, const product *p) {
  for (int k = 0; k < to->count; k++) {
    product *known = &to->of[k];
    if (known->count != p->count ||
        memcmp(known->bond, p->bond, (size_t)p->count * sizeof *p->bond) != 0)
      continue;
    const ir_node one = ir_constant(g, 1);
    known->particle = ir_add(g, known->particle == IR_NONE ? one : known->particle,
                             p->particle == IR_NONE ? one : p->particle);
    return true;
  }
  if (to->count == MOST_PARTS) return false;
  to->of[to->count++] = *p;
  return true;
}

static products multiplied(ir *g, const products *a, const products *b) {
  products all = {.count = 0};
  for (int i = 0; i < a->count; i++)
    for (int j = 0; j < b->count; j++) {
      product p = a->of[i];
      bool fits = true;
      p.particle = times(g, p.particle, b->of[j].particle);
      for (int k = 0; k < b->of[j].count && fits; k++)
        fits = add_factor(&p, b->of[j].bond[k]);
      if (!fits || !add_product(g, &all, &p)) return (products){.count = 0};
    }
  return all;
}

static products added(ir *g, const products *a, products b, bool subtracts) {
  products all = *a;
  if (a->count == 0 || b.count == 0) return (products){.count = 0};
  for (int k = 0; k < b.count; k++) {
    product *p = &b.of[k];
    if (subtracts)
      p->particle = ir_neg(g, p->particle == IR_NONE ? ir_constant(g, 1) : p->particle);
    if (!add_product(g, &all, p)) return (products){.count = 0};
  }
  return all;
}

static products taken_apart(const taking_apart *t, ir_node n) {
  ir *g = t->g;
  const ir_op op = ir_operation(g, n);
  if (ir_is_of_particle(g, n)) return (products){{{.particle = n}}, 1};
  if (op != IR_MUL && !t->sided[n])
    return (products){{{.particle = IR_NONE, .bond = {n}, .count = 1}}, 1};
  if (op != IR_MUL && op != IR_ADD && op != IR_SUB && op != IR_NEG && op != IR_DIV)
    return (products){.count = 0};
  products a = taken_apart(t, ir_operand(g, n, 0));
  if (op == IR_NEG) {
    const products minus_one = {{{.particle = ir_constant(g, -1)}}, 1};
    return multiplied(g, &a, &minus_one);
  }
  const ir_node second = ir_operand(g, n, 1);
  if (op == IR_DIV) {
    if (!ir_is_of_particle(g, second)) return (products){.count = 0};
    const products inverse = {{{.particle = ir_div(g, ir_constant(g, 1), second)}}, 1};
    return multiplied(g, &a, &inverse);
  }
  const products b = taken_apart(t, second);
  return op == IR_MUL ? multiplied(g, &a, &b) : added(g, &a, b, op == IR_SUB);
}

static bool has_factor(const product *p, ir_node n) {
  for (int k = 0; k < p->count; k++)
    if (p->bond[k] == n) return true;
  return false;
}

static void drop_factor(product *p, ir_node n) {
  int at = 0;
  while (p->bond[at] != n)
    at++;
  p->count--;
  for (; at < p->count; at++)
    p->bond[at] = p->bond[at + 1];
}

/* The product of the factors that all have, which they lose; IR_NONE without one. */
static ir_node take_common(ir *g, products *all) {
  ir_node common = IR_NONE;
  const product first = all->of[0];
  for (int k = 0; k < first.count; k++) {
    bool by_all = true;
    for (int n = 0; n < all->count && by_all; n++)
      by_all = has_factor(&all->of[n], first.bond[k]);
    for (int n = 0; n < all->count && by_all; n++)
      drop_factor(&all->of[n], first.bond[k]);
    if (by_all) common = times(g, common, first.bond[k]);
  }
  return common;
}

/* A name keeps the particle's part whole: a product that was fused with the neighbour's would be
   another one there. */
static ir_node both(ir *g, ir_node n) {
  if (ir_operation(g, n) != IR_CONSTANT) ir_set_name(g, n, "part", (span){0, 0, 0});
  return ir_add(g, n, ir_make(g, IR_NEIGHBOUR, n, IR_NONE, IR_NONE));
}

ir_node particle_parts_of_both(ir *g, ir_node value, const ir_node *same, int same_count) {
  taking_apart t = {.g = g, .node_count = ir_count(g)};
  t.sided = must_calloc((size_t)t.node_count + 1, 1);
  find_sided(&t, same, same_count);
  products all = taken_apart(&t, value);
  free(t.sided);
  if (all.count == 0) return both(g, value);
  const ir_node common = take_common(g, &all);
  ir_node sum = IR_NONE;
  for (int k = 0; k < all.count; k++) {
    const product *p = &all.of[k];
    ir_node part = p->particle == IR_NONE ? ir_constant(g, 2) : both(g, p->particle);
    for (int n = 0; n < p->count; n++)
      part = ir_mul(g, part, p->bond[n]);
    sum = sum == IR_NONE ? part : ir_add(g, sum, part);
  }
  return times(g, common, sum);
}
