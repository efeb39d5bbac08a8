#include "generator/plan/program_schedule.h"

#include <string.h>

#include "generator/ir/rewrite.h"
#include "generator/plan/program_mirror.h"

typedef struct scheduler {
  ir *g;
  arena *memory;
  program_pass *pass;
  node_map phase, slot, plane;
  const pass_ends *ends;
  bool pairs;
  int loop_count;
} scheduler;

/* Loops over the neighbours that must be done before the value can be had (of a particle), or
   before the loop in which it can be had (toward a neighbour). */
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
    const int parity = map_get(&s->ends->parity, n), far = map_get(&s->ends->far, n);
    if (ir_is_reduction(op))
      segment_add(s->memory, neighbours_in(s, phase_of(s, n) - 1),
                  (segment_root){.node = ir_operand(s->g, n, 0),
                                 .target = target_of_reduction(op),
                                 .over = OVER_NEIGHBOURS,
                                 .index = slot,
                                 .parity = parity >= 0 ? parity - 1 : 0,
                                 .far = far >= 0 ? far : IR_NONE});
    else
      segment_add(
          s->memory, particles_after(s, phase_of(s, n)),
          (segment_root){.node = n, .target = TO_SLOT, .over = OVER_PARTICLES, .index = slot});
  }
  return ir_input(s->g, IR_FROM_SLOT, slot, name_of(s, n, "slot", slot), ON_PARTICLE);
}

static ir_node plane_of(scheduler *s, ir_node n) {
  int plane = map_get(&s->plane, n);
  if (plane < 0) {
    plane = s->pass->plane_count++;
    map_set(&s->plane, n, plane);
    segment_add(
        s->memory, neighbours_in(s, phase_of(s, n)),
        (segment_root){.node = n, .target = TO_PLANE, .over = OVER_NEIGHBOURS, .index = plane});
  }
  return ir_input(s->g, IR_FROM_PLANE, plane, name_of(s, n, "plane", plane), ON_NEIGHBOUR);
}

/* A value as a segment sees it: `loop` of the neighbours, or after `loop` loops for the
   particle. */
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

/* Values toward a neighbour that an earlier loop had: a plane costs a store and a load, and room on
   the stack (64 KiB). */
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
  if (is_leaf(g, n) || ir_is_uniform(g, n))
    image = n;
  else if (ir_is_reduction(ir_operation(g, n)))
    image = slot_of(s, n);
  else if (is_of_one_particle(g, n))
    image = (v->kind != OVER_PARTICLES || phase_of(s, n) < v->loop) && is_worth_a_slot(s, n)
                ? slot_of(s, n)
                : computed_here(v, n);
  else
    image = is_worth_a_plane(s, n, v->loop) ? plane_of(s, n) : computed_here(v, n);
  map_set(&v->seen, n, image);
  return image;
}

static bool has_far(const segment_root *r) {
  return r->target == TO_SUM && r->parity == 0 && r->far != IR_NONE;
}

/* Roots in terms of what the segment can read. A root that is itself kept in a slot or a plane is
   computed here. */
static void view_segment(scheduler *s, segment *a, int loop) {
  segment_view v = {.s = s, .kind = a->kind, .loop = loop};
  for (int k = 0; k < a->root_count; k++) { /* more may be added to earlier segments only */
    ir_node n = a->roots[k].node;
    bool here =
        !is_leaf(s->g, n) && !ir_is_uniform(s->g, n) && !ir_is_reduction(ir_operation(s->g, n)) &&
        (a->kind == OVER_PARTICLES) == is_of_one_particle(s->g, n) && phase_of(s, n) == loop;
    a->roots[k].node = here ? computed_here(&v, n) : seen_in_segment(&v, n);
    if (has_far(&a->roots[k])) a->roots[k].far = seen_in_segment(&v, a->roots[k].far);
  }
  map_clear(&v.seen);
}

static void drop_empty_segments(program_pass *p) {
  int kept = 0;
  for (int k = 0; k < p->segment_count; k++)
    if (p->segments[k].root_count) p->segments[kept++] = p->segments[k];
  p->segment_count = kept;
}

/* --- bonds that add to both ends -------------------------------------------------------------- */

/* Where one end computes a value, products and sums may round once. */
static void fuse_segment(ir *g, segment *a) {
  ir_node *values = segment_values(a);
  rewrite_fused(g, values, segment_value_count(a), values);
  segment_replace(a, values);
  free(values);
}

static int cost_of(const ir *g, const ir_node *nodes, int count) {
  const ir_cost c = ir_count_cost(g, nodes, count, ON_BOND, NULL);
  enum { DEAR = 10 };
  return c.additions + c.multiplications + c.selects + DEAR * (c.divisions + c.functions);
}

/* Whether bonds find what their far ends add nearly at no cost, in what they compute anyway. */
static bool are_ends_alike(const ir *g, const segment *a) {
  const double little = 1.0 / 16;
  ir_node *values = must_alloc(2 * ((size_t)a->root_count + 1) * sizeof *values);
  int count = 0;
  for (int k = 0; k < a->root_count; k++)
    values[count++] = a->roots[k].node;
  const int own = cost_of(g, values, count);
  for (int k = 0; k < a->root_count; k++)
    if (has_far(&a->roots[k])) values[count++] = a->roots[k].far;
  const int both = cost_of(g, values, count);
  free(values);
  return both <= (1 + little) * own;
}

/* A pass with one loop over neighbours, of which each end of a bond knows what the other adds up,
   does it bond by bond: what the far end gets is complete when its turn comes. */
static void pair_ends(ir *g, program_pass *p) {
  segment *loop = NULL;
  int sums = 0;
  for (int k = 0; k < p->segment_count; k++) {
    if (p->segments[k].kind == OVER_PARTICLES) continue;
    if (loop || p->segments[k].kind == OVER_BONDS) return;
    loop = &p->segments[k];
  }
  for (int k = 0; loop && k < loop->root_count; k++) {
    const segment_root *r = &loop->roots[k];
    if (!(r->target == TO_SUM && (r->parity || has_far(r))) &&
        !(r->target == TO_FIELD && r->parity == 1))
      return;
  }
  if (!loop || !are_ends_alike(g, loop)) return;
  loop->kind = OVER_PAIRS;
  for (int k = 0; k < loop->root_count; k++) {
    loop->roots[k].over = OVER_PAIRS;
    if (loop->roots[k].target == TO_SUM) loop->roots[k].sum = sums++;
  }
  fuse_segment(g, loop);
}

/* --- the pass --------------------------------------------------------------------------------- */

void program_schedule(ir *g, arena *memory, program_pass *pass, const segment *wanted,
                      const pass_ends *ends, bool pairs) {
  scheduler s = {.g = g, .memory = memory, .pass = pass, .ends = ends, .pairs = pairs};
  for (int k = 0; k < wanted->root_count; k++) {
    const segment_root *r = &wanted->roots[k];
    int loops = phase_of(&s, r->node) + (r->over == OVER_NEIGHBOURS);
    s.loop_count = loops > s.loop_count ? loops : s.loop_count;
  }
  pass->segment_count = 2 * s.loop_count + 2; /* behind them that of the bonds */
  pass->segments = arena_alloc(memory, (size_t)pass->segment_count * sizeof *pass->segments);
  memset(pass->segments, 0, (size_t)pass->segment_count * sizeof *pass->segments);
  for (int k = 0; k < pass->segment_count; k++)
    pass->segments[k].kind = k % 2 ? OVER_NEIGHBOURS : OVER_PARTICLES;
  segment *bonds = &pass->segments[pass->segment_count - 1];
  bonds->kind = OVER_BONDS;
  for (int k = 0; k < wanted->root_count; k++) {
    const segment_root *r = &wanted->roots[k];
    const int phase = phase_of(&s, r->node);
    segment *in = r->over == OVER_BONDS        ? bonds
                  : r->over == OVER_NEIGHBOURS ? neighbours_in(&s, phase)
                                               : particles_after(&s, phase);
    segment_add(memory, in, *r);
  }
  view_segment(&s, bonds, 0);
  for (int k = pass->segment_count - 2; k >= 0; k--)
    view_segment(&s, &pass->segments[k], k / 2);
  drop_empty_segments(pass);
  map_clear(&s.phase);
  map_clear(&s.slot);
  map_clear(&s.plane);
  if (pairs) pair_ends(g, pass);
}
