#include "generator/plan/program_mirror.h"
#include "generator/plan/program_parts.h"

#include <assert.h>
#include <string.h>

#include "dsl/semantics/builtins.h"
#include "generator/ir/rewrite.h"
#include "generator/lower/kinematics.h"

/* --- passes ----------------------------------------------------------------------------------- */

/* The pass in which a value can be had: one after that of the links of neighbours that it needs. */
static int level_of(builder *b, ir_node n) {
  int known = map_get(&b->level, n);
  if (known >= 0) return known;
  int level = 0;
  if (is_leaf(b->g, n)) {
    ir_source from = ir_operation(b->g, n) == IR_INPUT ? ir_input_source(b->g, n) : IR_SOURCE_COUNT;
    if (from == IR_FROM_NEIGHBOUR_LINK || from == IR_FROM_NEIGHBOUR_BOND_LINK)
      level = level_of(b, program_linked_node(b, n)) + 1;
    if (from == IR_FROM_SHARED || from == IR_FROM_SHARED_ODD)
      level = level_of(b, b->shared[ir_input_index(b->g, n) - b->first_shared]) + 1;
  } else {
    for (int k = 0; k < ir_arity(ir_operation(b->g, n)); k++) {
      int below = level_of(b, ir_operand(b->g, n, k));
      level = below > level ? below : level;
    }
  }
  map_set(&b->level, n, level);
  return level;
}

/* A value in pass `now`, in which the particle's own values of earlier passes are links. */
typedef struct pass_view {
  builder *b;
  int now;
  const segment_root *roots; /* [root_count] of the program */
  int root_count;
  node_map seen, parity; /* parity + 1 of what a sum adds up; of sums as the pass sees them */
} pass_view;

/* The field toward neighbours that an earlier pass has computed the value for, which later ones read; or NULL. */
static const segment_root *field_before(const pass_view *v, ir_node n) {
  if (v->b->sharing != SHARE_PAIRS) return NULL;
  for (int k = 0; k < v->root_count; k++)
    if (v->roots[k].node == n && v->roots[k].target == TO_NEIGHBOUR_FIELD)
      return level_of(v->b, n) < v->now ? &v->roots[k] : NULL;
  return NULL;
}

static ir_node seen_in_pass(pass_view *v, ir_node n) {
  builder *b = v->b;
  ir *g = b->g;
  int known = map_get(&v->seen, n);
  if (known >= 0) return known;
  ir_node image = n, operand[3] = {IR_NONE, IR_NONE, IR_NONE};
  if (!is_leaf(g, n)) {
    const bool kept = is_of_particle(g, n) ? program_goes_over_family(b, n) : map_get(&b->linked, n) >= 0;
    const segment_root *field = field_before(v, n);
    if (field)
      image = ir_input(g, IR_FROM_NEW_FIELD, field->index, ir_name(g, n) ? ir_name(g, n) : "new",
                       ON_NEIGHBOUR);
    else if (kept && level_of(b, n) < v->now) {
      image = program_own_link(b, n);
    } else {
      for (int k = 0; k < ir_arity(ir_operation(g, n)); k++)
        operand[k] = seen_in_pass(v, ir_operand(g, n, k));
      image = program_made_again(g, n, operand);
      if (ir_is_reduction(ir_operation(g, n)) && b->sharing == SHARE_PAIRS)
        map_set(&v->parity, image, program_parity_of_root(b, ir_operand(g, n, 0)) + 1);
    }
  }
  map_set(&v->seen, n, image);
  return image;
}

/* --- segments --------------------------------------------------------------------------------- */

typedef struct scheduler {
  ir *g;
  arena *memory;
  family_pass *pass;
  node_map phase, slot, plane;
  const node_map *parity; /* of sums, as pass_view has it */
  bool pairs;
  int loop_count;
} scheduler;

/* Loops over the neighbours that must be done before the value can be had (of a particle), or before the loop in which it
   can be had (toward a neighbour). */
static int phase_of(scheduler *s, ir_node n) {
  int known = map_get(&s->phase, n);
  if (known >= 0) return known;
  int phase = 0;
  ir_op op = ir_operation(s->g, n);
  for (int k = 0; k < ir_arity(op); k++) {
    int below = phase_of(s, ir_operand(s->g, n, k));
    phase = below > phase ? below : phase;
  }
  if (ir_is_reduction(op)) phase++;
  map_set(&s->phase, n, phase);
  return phase;
}

/* Segments stand in the order particles 0, neighbours 0, particles 1, ... */
static segment *particles_after(scheduler *s, int loops) {
  return &s->pass->segments[2 * loops];
}

static segment *neighbours_in(scheduler *s, int loop) {
  return &s->pass->segments[2 * loop + 1];
}

static void add_root(scheduler *s, segment *to, segment_root root) {
  if (to->root_count == to->root_capacity) {
    int capacity = to->root_capacity ? 2 * to->root_capacity : 8;
    segment_root *roots = arena_alloc(s->memory, (size_t)capacity * sizeof *roots);
    if (to->root_count) memcpy(roots, to->roots, (size_t)to->root_count * sizeof *roots);
    to->roots = roots;
    to->root_capacity = capacity;
  }
  to->roots[to->root_count++] = root;
}

static segment_target target_of_reduction(ir_op op) {
  return op == IR_FAMILY_SUM ? TO_SUM : op == IR_FAMILY_MAX ? TO_LARGEST : TO_SMALLEST;
}

static const char *name_of(scheduler *s, ir_node n, const char *kind, int index) {
  const char *name = ir_name(s->g, n);
  return name ? name : arena_printf(s->memory, "%s_%d", kind, index);
}

/* The particle's value n as an input of later segments; asks the segment that has it. */
static ir_node slot_of(scheduler *s, ir_node n) {
  int slot = map_get(&s->slot, n);
  if (slot < 0) {
    slot = s->pass->slot_count++;
    map_set(&s->slot, n, slot);
    ir_op op = ir_operation(s->g, n);
    if (ir_is_reduction(op))
      add_root(
          s, neighbours_in(s, phase_of(s, n) - 1),
          (segment_root){.node = ir_operand(s->g, n, 0),
                         .target = target_of_reduction(op),
                         .index = slot,
                         .parity = map_get(s->parity, n) >= 0 ? map_get(s->parity, n) - 1 : 0});
    else
      add_root(s, particles_after(s, phase_of(s, n)),
               (segment_root){.node = n, .target = TO_SLOT, .index = slot});
  }
  return ir_input(s->g, IR_FROM_SLOT, slot, name_of(s, n, "slot", slot), ON_PARTICLE);
}

static ir_node plane_of(scheduler *s, ir_node n) {
  int plane = map_get(&s->plane, n);
  if (plane < 0) {
    plane = s->pass->plane_count++;
    map_set(&s->plane, n, plane);
    add_root(s, neighbours_in(s, phase_of(s, n)),
             (segment_root){.node = n, .target = TO_PLANE, .index = plane});
  }
  return ir_input(s->g, IR_FROM_PLANE, plane, name_of(s, n, "plane", plane), ON_NEIGHBOUR);
}

/* A value as a segment sees it: `loop` of the neighbours, or after `loop` loops for the particle. */
typedef struct segment_view {
  scheduler *s;
  segment_kind kind;
  int loop;
  node_map seen;
} segment_view;

static ir_node seen_in_segment(segment_view *v, ir_node n);

static ir_node computed_here(segment_view *v, ir_node n) {
  ir_node operand[3] = {IR_NONE, IR_NONE, IR_NONE};
  for (int k = 0; k < ir_arity(ir_operation(v->s->g, n)); k++)
    operand[k] = seen_in_segment(v, ir_operand(v->s->g, n, k));
  return program_made_again(v->s->g, n, operand);
}

/* Values toward a neighbour that an earlier loop had: a plane costs a store and a load, and room on the stack (64 KiB). */
static bool is_worth_a_plane(scheduler *s, ir_node n, int loop) {
  enum { DEAR = 4, MOST_PLANES = 16 };
  if (phase_of(s, n) >= loop || program_cost_again(s->g, n, DEAR) < DEAR) return false;
  return map_get(&s->plane, n) >= 0 || s->pass->plane_count < MOST_PLANES;
}

/* Of pairs, so that what is held can be told to be 0 where nothing is. */
static bool is_worth_a_slot(const scheduler *s, ir_node n) {
  if (!s->pairs || !ir_is_logical(s->g, n)) return true;
  bool deep = false;
  for (int k = 0; k < ir_arity(ir_operation(s->g, n)); k++)
    deep = deep || !is_leaf(s->g, ir_operand(s->g, n, k));
  return deep;
}

static ir_node seen_in_segment(segment_view *v, ir_node n) {
  scheduler *s = v->s;
  const ir *g = s->g;
  int known = map_get(&v->seen, n);
  if (known >= 0) return known;
  ir_node image;
  if (is_leaf(g, n) || is_uniform(g, n))
    image = n;
  else if (ir_is_reduction(ir_operation(g, n)))
    image = slot_of(s, n);
  else if (is_of_particle(g, n))
    image = (v->kind != OVER_PARTICLES || phase_of(s, n) < v->loop) && is_worth_a_slot(s, n)
                ? slot_of(s, n)
                : computed_here(v, n);
  else
    image = is_worth_a_plane(s, n, v->loop) ? plane_of(s, n) : computed_here(v, n);
  map_set(&v->seen, n, image);
  return image;
}

/* Roots in terms of what the segment can read. A root that is itself kept in a slot or a plane is computed here. */
static void view_segment(scheduler *s, segment *a, int loop) {
  segment_view v = {.s = s, .kind = a->kind, .loop = loop};
  for (int k = 0; k < a->root_count; k++) { /* more may be added to earlier segments only */
    ir_node n = a->roots[k].node;
    bool here = !is_leaf(s->g, n) && !is_uniform(s->g, n) &&
                !ir_is_reduction(ir_operation(s->g, n)) &&
                (a->kind == OVER_PARTICLES) == is_of_particle(s->g, n) && phase_of(s, n) == loop;
    a->roots[k].node = here ? computed_here(&v, n) : seen_in_segment(&v, n);
  }
  map_clear(&v.seen);
}

static bool is_over_neighbours(segment_target target) {
  return target >= TO_SUM && target != TO_SHARED;
}

static void drop_empty_segments(family_pass *p) {
  int kept = 0;
  for (int k = 0; k < p->segment_count; k++)
    if (p->segments[k].root_count) p->segments[kept++] = p->segments[k];
  p->segment_count = kept;
}

/* Where one end computes a value, products and sums may round once. */
static void fuse_segment(ir *g, segment *a) {
  ir_node *nodes = must_alloc(((size_t)a->root_count + 1) * sizeof *nodes);
  for (int k = 0; k < a->root_count; k++)
    nodes[k] = a->roots[k].node;
  rewrite_fused(g, nodes, a->root_count, nodes);
  for (int k = 0; k < a->root_count; k++)
    a->roots[k].node = nodes[k];
  free(nodes);
}

/* A pass whose one loop over neighbours the two ends of a bond would do alike does it bond by bond: what the far end
   gets is complete when its turn comes. */
static void pair_ends(ir *g, family_pass *p) {
  segment *loop = NULL;
  int sums = 0;
  for (int k = 0; k < p->segment_count; k++) {
    if (p->segments[k].kind == OVER_PARTICLES) continue;
    if (loop || p->segments[k].kind == OVER_BONDS) return;
    loop = &p->segments[k];
  }
  for (int k = 0; loop && k < loop->root_count; k++) {
    const segment_root *r = &loop->roots[k];
    if (!(r->target == TO_SUM && r->parity) && !(r->target == TO_NEIGHBOUR_FIELD && r->parity == 1))
      return;
  }
  if (!loop) return;
  loop->kind = OVER_PAIRS;
  for (int k = 0; k < loop->root_count; k++) {
    loop->roots[k].paired = true;
    if (loop->roots[k].target == TO_SUM) loop->roots[k].sum = sums++;
  }
  fuse_segment(g, loop);
}

bool program_is_paired(const family_pass *p) {
  for (int k = 0; k < p->segment_count; k++)
    if (p->segments[k].kind == OVER_PAIRS) return true;
  return false;
}

bool program_pairs_field(const family_program *p, int field) {
  for (int k = 0; k < p->pass_count; k++)
    for (int s = 0; s < p->passes[k].segment_count; s++) {
      const segment *a = &p->passes[k].segments[s];
      for (int r = 0; r < a->root_count && a->kind == OVER_PAIRS; r++)
        if (a->roots[r].target == TO_NEIGHBOUR_FIELD && a->roots[r].index == field) return true;
    }
  return false;
}

int program_sum_count(const family_program *p) {
  int most = 0;
  for (int k = 0; k < p->pass_count; k++)
    for (int s = 0; s < p->passes[k].segment_count; s++) {
      const segment *a = &p->passes[k].segments[s];
      for (int r = 0; r < a->root_count && a->kind == OVER_PAIRS; r++)
        if (a->roots[r].target == TO_SUM && a->roots[r].sum >= most) most = a->roots[r].sum + 1;
    }
  return most;
}

int program_constant_sums(const ir *g, const family_program *p, const segment *before) {
  int count = 0;
  for (int k = 0; k < p->pass_count; k++)
    for (int s = 0; s < p->passes[k].segment_count; s++) {
      const segment *a = &p->passes[k].segments[s];
      if (a == before) return count;
      for (int r = 0; r < a->root_count; r++)
        count += segment_is_constant(g, &a->roots[r]);
    }
  return count;
}

/* Marks the conditions that the segment expects to hold; false without one. */
static bool mark_expected(const ir *g, const segment *a, unsigned char *conditions) {
  unsigned char *needed = must_calloc((size_t)ir_count(g) + 1, 1);
  bool any = false;
  for (int k = 0; k < a->root_count; k++)
    ir_mark(g, &a->roots[k].node, 1, needed);
  for (ir_node n = 0; n < ir_count(g); n++) {
    if (!needed[n] || ir_place(g, n) <= ON_BODY || !ir_is_expected_choice(g, n)) continue;
    conditions[ir_operand(g, n, 0)] = 1;
    any = true;
  }
  free(needed);
  return any;
}

const segment *program_asks(const ir *g, const family_program *p) {
  unsigned char *conditions = must_calloc((size_t)ir_count(g) + 1, 1);
  const segment *found = NULL;
  for (int k = 0; k < p->pass_count && !found; k++)
    for (int s = 0; s < p->passes[k].segment_count && !found; s++) {
      const segment *a = &p->passes[k].segments[s];
      if (a->kind == OVER_PAIRS && mark_expected(g, a, conditions)) found = a;
    }
  free(conditions);
  return found;
}

/* Of the motion alone: what else a node reads may be another thing in another pass. */
static bool is_of_motion(const ir *g, ir_node n) {
  unsigned char *needed = must_calloc((size_t)ir_count(g) + 1, 1);
  bool is = true;
  ir_mark(g, &n, 1, needed);
  for (ir_node m = 0; m <= n && is; m++)
    is = !needed[m] || ir_operation(g, m) != IR_INPUT || ir_place(g, m) <= ON_BODY ||
         ir_input_source(g, m) == IR_FROM_ENDS;
  free(needed);
  return is;
}

bool program_is_told(const ir *g, const family_program *p, const segment *a) {
  const segment *asks = program_asks(g, p);
  if (!asks || asks == a) return false;
  unsigned char *asked = must_calloc((size_t)ir_count(g) + 1, 1),
                *wanted = must_calloc((size_t)ir_count(g) + 1, 1);
  mark_expected(g, asks, asked);
  bool told = mark_expected(g, a, wanted);
  for (ir_node n = 0; n < ir_count(g) && told; n++)
    told = !wanted[n] || (asked[n] && is_of_motion(g, n));
  free(asked);
  free(wanted);
  return told;
}

static void schedule(ir *g, arena *memory, family_pass *pass, const segment_root *roots,
                     int root_count, const node_map *parity, bool pairs) {
  scheduler s = {.g = g, .memory = memory, .pass = pass, .parity = parity, .pairs = pairs};
  for (int k = 0; k < root_count; k++) {
    int loops = phase_of(&s, roots[k].node) + is_over_neighbours(roots[k].target);
    s.loop_count = loops > s.loop_count ? loops : s.loop_count;
  }
  pass->segment_count = 2 * s.loop_count + 2; /* behind them that of the bonds */
  pass->segments = arena_alloc(memory, (size_t)pass->segment_count * sizeof *pass->segments);
  memset(pass->segments, 0, (size_t)pass->segment_count * sizeof *pass->segments);
  for (int k = 0; k < pass->segment_count; k++)
    pass->segments[k].kind = k % 2 ? OVER_NEIGHBOURS : OVER_PARTICLES;
  segment *bonds = &pass->segments[pass->segment_count - 1];
  bonds->kind = OVER_BONDS;
  for (int k = 0; k < root_count; k++) {
    int phase = phase_of(&s, roots[k].node);
    segment *in = roots[k].target == TO_SHARED          ? bonds
                  : is_over_neighbours(roots[k].target) ? neighbours_in(&s, phase)
                                                        : particles_after(&s, phase);
    add_root(&s, in, roots[k]);
  }
  view_segment(&s, bonds, 0);
  for (int k = pass->segment_count - 2; k >= 0; k--)
    view_segment(&s, &pass->segments[k], k / 2);
  drop_empty_segments(pass);
  map_clear(&s.phase);
  map_clear(&s.slot);
  map_clear(&s.plane);
}

/* A constant of the class, or a sum of such and of displacements. */
static bool is_finite(const ir *g, ir_node n) {
  const ir_op op = ir_operation(g, n);
  if (is_uniform(g, n)) return true;
  if (op == IR_ADD || op == IR_SUB)
    return is_finite(g, ir_operand(g, n, 0)) && is_finite(g, ir_operand(g, n, 1));
  return op == IR_INPUT && ir_input_source(g, n) == IR_FROM_ENDS &&
         ends_origins[ir_input_index(g, n)].array == FROM_DISPLACEMENT;
}

bool segment_fuses(const ir *g, const segment_root *r) {
  if (r->target != TO_SUM || ir_operation(g, r->node) != IR_MUL || ir_place(g, r->node) <= ON_BODY)
    return false;
  return !r->paired || is_finite(g, ir_operand(g, r->node, 0)) ||
         is_finite(g, ir_operand(g, r->node, 1));
}

int segment_nodes(const ir *g, const segment *a, ir_node *nodes) {
  int count = a->root_count;
  for (int k = 0; k < a->root_count; k++) {
    const segment_root *r = &a->roots[k];
    nodes[k] = r->node;
    if (!segment_fuses(g, r)) continue;
    const int second = !r->paired || is_finite(g, ir_operand(g, r->node, 1));
    nodes[k] = ir_operand(g, r->node, 1 - second);
    nodes[count++] = ir_operand(g, r->node, second);
  }
  return count;
}

static bool is_neighbours_link(ir_source from) {
  return from == IR_FROM_NEIGHBOUR_LINK || from == IR_FROM_NEIGHBOUR_BOND_LINK;
}

static bool is_shared(ir_source from) {
  return from == IR_FROM_SHARED || from == IR_FROM_SHARED_ODD;
}

static bool segment_reads(const ir *g, const segment *a, bool (*wanted)(ir_source from)) {
  unsigned char *needed = must_calloc((size_t)ir_count(g) + 1, 1);
  bool does = false;
  for (int k = 0; k < a->root_count; k++)
    ir_mark(g, &a->roots[k].node, 1, needed);
  for (ir_node n = 0; n < ir_count(g) && !does; n++)
    does = needed[n] && ir_operation(g, n) == IR_INPUT && wanted(ir_input_source(g, n));
  free(needed);
  return does;
}

unsigned program_at_hand(const ir *g, const family_program *p) {
  unsigned others = 0;
  for (int k = 0; k < p->pass_count; k++)
    for (int s = 0; s < p->passes[k].segment_count; s++)
      if (segment_reads(g, &p->passes[k].segments[s], is_neighbours_link)) others |= 1u << k;
  return ~others & ((1u << p->pass_count) - 1);
}

unsigned program_upward(const ir *g, const family_program *p) {
  unsigned others = 0;
  for (int k = 0; k < p->pass_count; k++)
    for (int s = 0; s < p->passes[k].segment_count; s++) {
      const segment *a = &p->passes[k].segments[s];
      if (a->kind != OVER_BONDS &&
          (segment_reads(g, a, is_neighbours_link) || segment_reads(g, a, is_shared)))
        others |= 1u << k;
    }
  return ~others & ((1u << p->pass_count) - 1);
}

/* The last pass before `pass` that leaves what the input reads; -1: no pass does. */
static int writer_of(const ir *g, const family_program *p, ir_node input, int pass) {
  static const segment_target targets[IR_SOURCE_COUNT] = {
      [IR_FROM_LINK] = TO_LINK,           [IR_FROM_NEIGHBOUR_LINK] = TO_LINK,
      [IR_FROM_BOND_LINK] = TO_BOND_LINK, [IR_FROM_NEIGHBOUR_BOND_LINK] = TO_BOND_LINK,
      [IR_FROM_SHARED] = TO_SHARED,       [IR_FROM_SHARED_ODD] = TO_SHARED};
  const segment_target target = targets[ir_input_source(g, input)];
  for (int k = pass - 1; k >= 0 && target != TO_SLOT; k--)
    for (int s = 0; s < p->passes[k].segment_count; s++)
      for (int r = 0; r < p->passes[k].segments[s].root_count; r++) {
        const segment_root *root = &p->passes[k].segments[s].roots[r];
        if (root->target == target && root->index == ir_input_index(g, input)) return k;
      }
  return -1;
}

static int reaches_behind(unsigned at_hand, int from, int to) {
  int behind = 0;
  for (int p = from + 1; p <= to; p++)
    behind += !(at_hand >> p & 1);
  return behind;
}

/* Reaches of rows from a link of an earlier pass, the farthest that the segment reads, to where that pass now is. */
static int reaches_of_segment(const ir *g, const family_program *p, unsigned at_hand, int pass,
                              const segment *a) {
  unsigned char *needed = must_calloc((size_t)ir_count(g) + 1, 1);
  int most = 0;
  for (int k = 0; k < a->root_count; k++)
    ir_mark(g, &a->roots[k].node, 1, needed);
  for (ir_node n = 0; n < ir_count(g); n++) {
    if (!needed[n] || ir_operation(g, n) != IR_INPUT) continue;
    const ir_source from = ir_input_source(g, n);
    const int writer = writer_of(g, p, n, pass);
    const bool own = from == IR_FROM_LINK || from == IR_FROM_BOND_LINK || a->kind == OVER_BONDS;
    if (writer < 0) continue;
    const int reaches = reaches_behind(at_hand, writer, pass) + !own;
    most = reaches > most ? reaches : most;
  }
  free(needed);
  return most;
}

int program_reaches_spared(const ir *g, const family_program *p) {
  const unsigned at_hand = program_at_hand(g, p);
  int most = 0;
  for (int k = 0; k < p->pass_count; k++)
    for (int s = 0; s < p->passes[k].segment_count; s++) {
      const int reaches = reaches_of_segment(g, p, at_hand, k, &p->passes[k].segments[s]);
      most = reaches > most ? reaches : most;
    }
  return reaches_behind(at_hand, 0, p->pass_count - 1) + 1 - most;
}

/* --- the whole -------------------------------------------------------------------------------- */

static void substitute(builder *b, segment_root *roots, int root_count, const ir_node *from,
                       const ir_node *to, int pair_count) {
  int count = root_count + b->link_count;
  ir_node *all = must_alloc(((size_t)count + 1) * sizeof *all);
  for (int k = 0; k < root_count; k++)
    all[k] = roots[k].node;
  for (int k = 0; k < b->link_count; k++)
    all[root_count + k] = b->link[k];
  ir_substitute(b->g, all, count, from, to, pair_count, all);
  map_clear(&b->linked);
  map_clear(&b->mirrored);
  map_clear(&b->reduced);
  for (int k = 0; k < root_count; k++)
    roots[k].node = all[k];
  for (int k = 0; k < b->link_count; k++) {
    b->link[k] = all[root_count + k];
    map_set(&b->linked, b->link[k], k);
  }
  free(all);
}

static ir_node shared_input(builder *b, int k) {
  const char *name = ir_name(b->g, b->shared[k]);
  const ir_source from = program_parity(b, b->shared[k]) < 0 ? IR_FROM_SHARED_ODD : IR_FROM_SHARED;
  return ir_input(b->g, from, b->first_shared + k,
                  name ? name : arena_printf(b->memory, "shared_%d", k), ON_BOND);
}

/* What follows from links and is the same from either end, too: its owner computes it in a pass of its own. In the plane
   that pass costs more than the few bonds spare. */
static void share_factor(builder *b, segment_root *roots, int root_count) {
  if (b->first_shared + b->shared_count >= MOST_SHARED) return;
  const ir_node factor = program_common_factor(b, roots, root_count);
  if (factor == IR_NONE) return;
  b->shared[b->shared_count++] = factor;
  program_put_factor(b, roots, root_count, factor, shared_input(b, b->shared_count - 1));
}

/* Values that the ends of bonds share become inputs. */
static void share(builder *b, segment_root *roots, int root_count) {
  program_choose_shared(b, roots, root_count);
  b->first_shared = 2 * b->links.of_bonds;
  ir_node *inputs = must_alloc(((size_t)b->shared_count + 1) * sizeof *inputs);
  for (int k = 0; k < b->shared_count; k++)
    inputs[k] = shared_input(b, k);
  substitute(b, roots, root_count, b->shared, inputs, b->shared_count);
  free(inputs);
  if (b->sharing == SHARE_MORE) share_factor(b, roots, root_count);
  b->links.of_bonds += (b->shared_count + 1) / 2;
}

static void build_pass(builder *b, family_pass *pass, int now, const segment_root *roots,
                       int root_count) {
  pass_view v = {.b = b, .now = now, .roots = roots, .root_count = root_count};
  segment_root *wanted =
      must_alloc(((size_t)root_count + MOST_LINKS + (size_t)b->shared_count) * sizeof *wanted);
  int count = 0, links = b->link_count;
  for (int k = 0; k < root_count; k++)
    if (level_of(b, roots[k].node) == now) {
      wanted[count] = roots[k];
      if (b->sharing == SHARE_PAIRS)
        wanted[count].parity = program_parity_of_root(b, roots[k].node);
      count++;
    }
  for (int k = 0; k < links; k++)
    if (level_of(b, b->link[k]) == now)
      wanted[count++] =
          (segment_root){.node = b->link[k],
                         .target = is_of_particle(b->g, b->link[k]) ? TO_LINK : TO_BOND_LINK,
                         .index = b->link_number[k]};
  for (int k = 0; k < b->shared_count; k++)
    if (level_of(b, b->shared[k]) == now)
      wanted[count++] =
          (segment_root){.node = b->shared[k], .target = TO_SHARED, .index = b->first_shared + k};
  for (int k = 0; k < count; k++) {
    bool of_link = wanted[k].target == TO_LINK && is_leaf(b->g, wanted[k].node);
    if (!of_link) wanted[k].node = seen_in_pass(&v, wanted[k].node);
  }
  schedule(b->g, b->memory, pass, wanted, count, &v.parity, b->sharing == SHARE_PAIRS);
  if (b->sharing == SHARE_PAIRS) pair_ends(b->g, pass);
  map_clear(&v.seen);
  map_clear(&v.parity);
  free(wanted);
}

void program_build(family_program *out, const char *name, ir *g, arena *memory,
                   const segment_root *roots, int root_count, const program_motion *motion,
                   program_sharing sharing, program_links *links) {
  /* What other programs leave stays as it is, so that what a pass may rely on where no run comes stays true. */
  builder b = {.g = g, .memory = memory, .sharing = sharing, .links = *links};
  b.link = arena_alloc(memory, MOST_LINKS * sizeof *b.link);
  b.link_number = arena_alloc(memory, MOST_LINKS * sizeof *b.link_number);
  segment_root *own = arena_alloc(memory, ((size_t)root_count + 1) * sizeof *own);
  int last = 0;
  for (int k = 0; k < root_count; k++) {
    own[k] = roots[k];
    own[k].node = program_resolve(&b, roots[k].node);
  }
  substitute(&b, own, root_count, motion->from, motion->to, motion->count);
  if (sharing != SHARE_NOTHING && sharing != SHARE_PAIRS) share(&b, own, root_count);
  for (int k = 0; k < root_count; k++) {
    int level = level_of(&b, own[k].node);
    last = level > last ? level : last;
  }
  *out = (family_program){.name = name, .pass_count = last + 1};
  out->passes = arena_alloc(memory, (size_t)out->pass_count * sizeof *out->passes);
  memset(out->passes, 0, (size_t)out->pass_count * sizeof *out->passes);
  for (int p = last; p >= 0; p--) /* a pass may ask earlier ones for more links */
    build_pass(&b, &out->passes[p], p, own, root_count);
  assert(!b.shared_count || b.first_shared + b.shared_count <= MOST_SHARED);
  if (b.shared_count) program_find_vanishing(g, out);
  if (b.links.of_particles > links->of_particles) links->of_particles = b.links.of_particles;
  if (b.links.of_bonds > links->of_bonds) links->of_bonds = b.links.of_bonds;
  map_clear(&b.resolved);
  map_clear(&b.mirrored);
  map_clear(&b.linked);
  map_clear(&b.reduced);
  map_clear(&b.sided);
  map_clear(&b.level);
  map_clear(&b.parity);
  map_clear(&b.plain);
  map_clear(&b.counted);
  map_clear(&b.users);
}
