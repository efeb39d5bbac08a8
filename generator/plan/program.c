#include "generator/plan/program.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "generator/plan/program_absent.h"
#include "generator/plan/program_builder.h"
#include "generator/plan/program_ends.h"
#include "generator/plan/program_mirror.h"
#include "generator/plan/program_parity.h"
#include "generator/plan/program_schedule.h"
#include "generator/plan/program_share.h"

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
  const segment *wanted; /* of the program */
  node_map seen;
  pass_ends ends;
} pass_view;

/* The field toward neighbours that an earlier pass has computed the value for, which later ones
   read; or NULL. */
static const segment_root *field_before(const pass_view *v, ir_node n) {
  if (v->b->sharing != SHARE_PAIRS) return NULL;
  for (int k = 0; k < v->wanted->root_count; k++) {
    const segment_root *r = &v->wanted->roots[k];
    if (r->node == n && r->target == TO_FIELD && r->over == OVER_NEIGHBOURS)
      return level_of(v->b, n) < v->now ? r : NULL;
  }
  return NULL;
}

static ir_node seen_in_pass(pass_view *v, ir_node n);

/* What the sum `image` of n adds up at the other end of a bond. */
static void find_ends(pass_view *v, ir_node image, ir_node n) {
  ir_node far;
  map_set(&v->ends.parity, image, program_parity_of_root(v->b, n, &far) + 1);
  if (far != IR_NONE) map_set(&v->ends.far, image, seen_in_pass(v, far));
}

static ir_node seen_in_pass(pass_view *v, ir_node n) {
  builder *b = v->b;
  ir *g = b->g;
  int known = map_get(&v->seen, n);
  if (known >= 0) return known;
  ir_node image = n, operand[3] = {IR_NONE, IR_NONE, IR_NONE};
  if (!is_leaf(g, n)) {
    const bool kept =
        is_of_one_particle(g, n) ? program_is_left(b, n) : map_get(&b->linked, n) >= 0;
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
        find_ends(v, image, ir_operand(g, n, 0));
    }
  }
  map_set(&v->seen, n, image);
  return image;
}

/* --- the whole -------------------------------------------------------------------------------- */

/* What a pass leaves to later ones. */
static void want_links(builder *b, segment *wanted, int now, int links) {
  for (int k = 0; k < links; k++)
    if (level_of(b, b->link[k]) == now)
      segment_add(b->memory, wanted,
                  (segment_root){.node = b->link[k],
                                 .target = TO_LINK,
                                 .over = is_of_one_particle(b->g, b->link[k]) ? OVER_PARTICLES
                                                                              : OVER_NEIGHBOURS,
                                 .index = b->link_number[k]});
  for (int k = 0; k < b->shared_count; k++)
    if (level_of(b, b->shared[k]) == now)
      segment_add(b->memory, wanted,
                  (segment_root){.node = b->shared[k],
                                 .target = TO_SHARED,
                                 .over = OVER_BONDS,
                                 .index = b->first_shared + k});
}

/* What asks whether the bond is there behind what does not: clang vectorises no loop in which they
   take turns. */
static void put_askers_last(builder *b, segment *a) {
  segment ordered = {.kind = a->kind};
  for (int asks = 0; asks < 2; asks++)
    for (int k = 0; k < a->root_count; k++)
      if (segment_asks(&a->roots[k]) == asks) segment_add(b->memory, &ordered, a->roots[k]);
  *a = ordered;
}

static void build_pass(builder *b, program_pass *pass, int now, const segment *roots) {
  const bool pairs = b->sharing == SHARE_PAIRS;
  const int links = b->link_count;
  pass_view v = {.b = b, .now = now, .wanted = roots};
  segment wanted = {.root_count = 0};
  for (int k = 0; k < roots->root_count; k++) {
    segment_root r = roots->roots[k];
    ir_node far;
    if (level_of(b, r.node) != now) continue;
    if (pairs) r.parity = program_parity_of_root(b, r.node, &far);
    segment_add(b->memory, &wanted, r);
  }
  want_links(b, &wanted, now, links);
  for (int k = 0; k < wanted.root_count; k++) {
    segment_root *r = &wanted.roots[k];
    const bool of_link =
        r->target == TO_LINK && r->over == OVER_PARTICLES && is_leaf(b->g, r->node);
    if (!of_link) r->node = seen_in_pass(&v, r->node);
  }
  program_schedule(b->g, b->memory, pass, &wanted, &v.ends, pairs);
  for (int s = 0; s < pass->segment_count && b->sharing == SHARE_LEAST; s++)
    put_askers_last(b, &pass->segments[s]);
  map_clear(&v.seen);
  map_clear(&v.ends.parity);
  map_clear(&v.ends.far);
}

void program_build(kernel_program *out, const char *name, ir *g, arena *memory,
                   const segment *wanted, const program_motion *motion, program_sharing sharing,
                   program_links *links) {
  /* What other programs leave stays as it is, so that what a pass may rely on where no run comes
     stays true. */
  builder b = {.g = g, .memory = memory, .sharing = sharing, .links = *links};
  b.link = arena_alloc(memory, MOST_LINKS * sizeof *b.link);
  b.link_number = arena_alloc(memory, MOST_LINKS * sizeof *b.link_number);
  segment own = {.root_count = 0};
  int last = 0;
  for (int k = 0; k < wanted->root_count; k++) {
    segment_add(memory, &own, wanted->roots[k]);
    own.roots[k].node = program_resolve(&b, wanted->roots[k].node);
  }
  program_substitute(&b, &own, motion->from, motion->to, motion->count);
  if (sharing != SHARE_LEAST) program_leave_ends(&b, &own);
  if (sharing > SHARE_NOTHING && sharing != SHARE_PAIRS) program_share(&b, &own);
  for (int k = 0; k < own.root_count; k++) {
    int level = level_of(&b, own.roots[k].node);
    last = level > last ? level : last;
  }
  *out = (kernel_program){.name = name, .pass_count = last + 1};
  out->passes = arena_alloc(memory, (size_t)out->pass_count * sizeof *out->passes);
  memset(out->passes, 0, (size_t)out->pass_count * sizeof *out->passes);
  for (int p = last; p >= 0; p--) /* a pass may ask earlier ones for more links */
    build_pass(&b, &out->passes[p], p, &own);
  assert(!b.shared_count || b.first_shared + b.shared_count <= MOST_SHARED);
  if (b.shared_count) program_find_vanishing(g, out);
  *links = b.links;
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
  map_clear(&b.partner);
  map_clear(&b.partner_sign);
  map_clear(&b.far);
  map_clear(&b.far_sign);
}
