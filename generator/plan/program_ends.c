#include "generator/plan/program_ends.h"

#include <stdlib.h>

#include "generator/ir/rewrite.h"
#include "generator/lower/kinematics.h"
#include "generator/plan/program_mirror.h"

/* Whose a value is: what comes of both ends, or of what is the bond's, is BOTH. */
enum { OF_NONE = 0, OF_OWN = 1, OF_FAR = 2, OF_BOTH = 3 };

static int side_of_input(const ir *g, ir_node n) {
  switch (ir_input_source(g, n)) {
  case IR_FROM_ENDS: {
    if (ir_input_index(g, n) == ENDS_ADVANCE) return OF_NONE;
    const ends_owner owner = ends_origins[ir_input_index(g, n)].owner;
    return owner == OF_I ? OF_OWN : owner == OF_J ? OF_FAR : OF_BOTH;
  }
  case IR_FROM_FIELD:
    return is_of_one_particle(g, n) ? OF_OWN : OF_BOTH;
  case IR_FROM_NEIGHBOUR_FIELD: /* on the bond: of the particle there (program_mirror) */
    return ir_place(g, n) == ON_BOND ? OF_FAR : OF_BOTH;
  case IR_FROM_PARTICLE_PARAMETER:
    return OF_OWN;
  case IR_FROM_NEIGHBOUR_PARAMETER:
    return OF_FAR;
  default:
    return OF_BOTH;
  }
}

/* sides[n] of all nodes that there are. */
static unsigned char *find_sides(const ir *g) {
  unsigned char *sides = must_calloc((size_t)ir_count(g) + 1, 1);
  for (ir_node n = 0; n < ir_count(g); n++) {
    const ir_op op = ir_operation(g, n);
    if (ir_is_uniform(g, n))
      sides[n] = ir_is_of_class(g, n) ? OF_BOTH : OF_NONE;
    else if (op == IR_INPUT)
      sides[n] = (unsigned char)side_of_input(g, n);
    else if (ir_is_reduction(op))
      sides[n] = OF_BOTH;
    for (int k = 0; k < ir_arity(op) && !ir_is_uniform(g, n); k++)
      sides[n] |= sides[ir_operand(g, n, k)];
  }
  return sides;
}

/* Marks what the far end has by itself and something of the bond is made of, or a root is. */
static unsigned char *find_candidates(const ir *g, const unsigned char *sides,
                                      const segment *roots) {
  unsigned char *needed = segment_needed(g, roots),
                *candidate = must_calloc((size_t)ir_count(g) + 1, 1);
  for (ir_node n = 0; n < ir_count(g); n++)
    for (int k = 0; k < ir_arity(ir_operation(g, n)) && needed[n]; k++) {
      const ir_node part = ir_operand(g, n, k);
      const bool joins = sides[n] != OF_FAR || ir_is_reduction(ir_operation(g, n));
      if (joins && sides[part] == OF_FAR && !is_leaf(g, part)) candidate[part] = 1;
    }
  free(needed);
  return candidate;
}

typedef struct ends_search {
  const ir *g;
  ir_node *far; /* [count] what is chosen */
  int count;
} ends_search;

/* What n costs beyond what is chosen and what `seen` holds, in additions. */
static int cost_beyond(const ends_search *s, ir_node n, node_map *seen, int most) {
  const ir *g = s->g;
  if (is_leaf(g, n) || ir_is_uniform(g, n) || map_get(seen, n) >= 0) return 0;
  for (int k = 0; k < s->count; k++)
    if (s->far[k] == n) return 0;
  map_set(seen, n, 1);
  int cost = operations[ir_operation(g, n)].weight;
  for (int k = 0; k < ir_arity(ir_operation(g, n)) && cost < most; k++)
    cost += cost_beyond(s, ir_operand(g, n, k), seen, most - cost);
  return cost;
}

/* A link is left once and read by each bond, instead of what the value is made of. */
static bool is_dear(const ends_search *s, ir_node n) {
  enum { DEAR = 25 };
  node_map seen = {0};
  const bool dear = cost_beyond(s, n, &seen, DEAR) >= DEAR;
  map_clear(&seen);
  return dear;
}

/* The same values as the particle's own, not the bond's. As they are computed only there, products
   and sums may round once. */
static void make_of_particle(ir *g, ir_node *nodes, int count) {
  ir_node from[ENDS_COUNT], to[ENDS_COUNT];
  int ends = 0;
  for (int k = 0; k < ENDS_COUNT; k++) {
    if (ends_origins[k].owner != OF_I) continue;
    from[ends] = kinematics_input(g, (ends_input)k);
    to[ends++] = ir_input(g, IR_FROM_ENDS, k, ends_origins[k].name, ON_PARTICLE);
  }
  ir_substitute(g, nodes, count, from, to, ends, nodes);
  rewrite_fused(g, nodes, count, nodes);
}

/* The link of a value for the neighbour; other programs find it again. */
static ir_node link_of_end(builder *b, ir_node own) {
  const ir_node link = program_neighbour_link(b, own);
  program_links *l = &b->links;
  for (int k = 0; k < l->left_count; k++)
    if (l->left[k] == own) return link;
  if (l->left_count == MOST_LEFT) return link;
  l->left[l->left_count] = own;
  l->left_in[l->left_count++] = ir_input_index(b->g, link);
  return link;
}

static void leave(builder *b, segment *roots, const ends_search *s) {
  const size_t bytes = 2 * (size_t)s->count * sizeof(ir_node);
  ir_node *from = must_alloc(bytes), *to = must_alloc(bytes);
  for (int k = 0; k < s->count; k++) {
    from[k] = s->far[k];
    to[s->count + k] = from[s->count + k] = program_mirror(b, s->far[k]);
  }
  make_of_particle(b->g, to + s->count, s->count);
  for (int k = 0; k < s->count; k++)
    to[k] = link_of_end(b, to[s->count + k]);
  program_substitute(b, roots, from, to, 2 * s->count);
  free(from);
  free(to);
}

void program_leave_ends(builder *b, segment *roots) {
  const int known = ir_count(b->g);
  unsigned char *sides = find_sides(b->g), *candidate = find_candidates(b->g, sides, roots);
  ends_search s = {.g = b->g, .far = must_alloc(((size_t)known + 1) * sizeof *s.far)};
  for (ir_node n = 0; n < known; n++)
    if (candidate[n] && is_dear(&s, n)) s.far[s.count++] = n;
  if (s.count) leave(b, roots, &s);
  free(s.far);
  free(sides);
  free(candidate);
}
