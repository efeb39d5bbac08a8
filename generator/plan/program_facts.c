#include "generator/plan/program_facts.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

kernel_program program_joined(arena *memory, const char *name, const kernel_program *first,
                              const kernel_program *then) {
  const size_t count = (size_t)(first->pass_count + then->pass_count);
  kernel_program p = {.name = name, .pass_count = (int)count};
  p.passes = arena_alloc(memory, (count + 1) * sizeof *p.passes);
  memcpy(p.passes, first->passes, (size_t)first->pass_count * sizeof *p.passes);
  memcpy(p.passes + first->pass_count, then->passes, (size_t)then->pass_count * sizeof *p.passes);
  return p;
}

/* --- bonds that add to both ends -------------------------------------------------------------- */

bool program_is_paired(const program_pass *p) {
  for (int k = 0; k < p->segment_count; k++)
    if (p->segments[k].kind == OVER_PAIRS) return true;
  return false;
}

bool program_pairs_field(const kernel_program *p, int field) {
  for (int k = 0; k < p->pass_count; k++)
    for (int s = 0; s < p->passes[k].segment_count; s++) {
      const segment *a = &p->passes[k].segments[s];
      for (int r = 0; r < a->root_count && a->kind == OVER_PAIRS; r++)
        if (a->roots[r].target == TO_FIELD && a->roots[r].index == field) return true;
    }
  return false;
}

int program_sum_count(const kernel_program *p) {
  int most = 0;
  for (int k = 0; k < p->pass_count; k++)
    for (int s = 0; s < p->passes[k].segment_count; s++) {
      const segment *a = &p->passes[k].segments[s];
      for (int r = 0; r < a->root_count && a->kind == OVER_PAIRS; r++)
        if (a->roots[r].target == TO_SUM && a->roots[r].sum >= most) most = a->roots[r].sum + 1;
    }
  return most;
}

int program_constant_sums(const ir *g, const kernel_program *p, const segment *before) {
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

/* --- what is expected of bonds ---------------------------------------------------------------- */

/* Marks the conditions that the segment expects to hold; false without one. */
static bool mark_expected(const ir *g, const segment *a, unsigned char *conditions) {
  unsigned char *needed = segment_needed(g, a);
  bool any = false;
  for (ir_node n = 0; n < ir_count(g); n++) {
    if (!needed[n] || ir_is_uniform(g, n) || !ir_is_expected_choice(g, n)) continue;
    conditions[ir_operand(g, n, 0)] = 1;
    any = true;
  }
  free(needed);
  return any;
}

const segment *program_asks(const ir *g, const kernel_program *p) {
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
    is = !needed[m] || ir_operation(g, m) != IR_INPUT || ir_is_uniform(g, m) ||
         ir_input_source(g, m) == IR_FROM_ENDS;
  free(needed);
  return is;
}

bool program_is_told(const ir *g, const kernel_program *p, const segment *a) {
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

/* --- what passes read of each other ----------------------------------------------------------- */

uint64_t program_shared_by(const program_pass *p) {
  uint64_t shared = 0;
  for (int k = 0; k < p->segment_count; k++)
    for (int r = 0; r < p->segments[k].root_count; r++)
      if (p->segments[k].roots[r].target == TO_SHARED)
        shared |= UINT64_C(1) << p->segments[k].roots[r].index;
  return shared;
}

static bool is_neighbours_link(ir_source from) {
  return from == IR_FROM_NEIGHBOUR_LINK || from == IR_FROM_NEIGHBOUR_BOND_LINK;
}

static bool is_shared(ir_source from) {
  return from == IR_FROM_SHARED || from == IR_FROM_SHARED_ODD;
}

static bool segment_reads(const ir *g, const segment *a, bool (*wanted)(ir_source from)) {
  unsigned char *needed = segment_needed(g, a);
  bool does = false;
  for (ir_node n = 0; n < ir_count(g) && !does; n++)
    does = needed[n] && ir_operation(g, n) == IR_INPUT && wanted(ir_input_source(g, n));
  free(needed);
  return does;
}

unsigned program_at_hand(const ir *g, const kernel_program *p) {
  unsigned others = 0;
  for (int k = 0; k < p->pass_count; k++)
    for (int s = 0; s < p->passes[k].segment_count; s++)
      if (segment_reads(g, &p->passes[k].segments[s], is_neighbours_link)) others |= 1u << k;
  return ~others & ((1u << p->pass_count) - 1);
}

unsigned program_upward(const ir *g, const kernel_program *p) {
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

segment_root *program_writer(const kernel_program *p, ir_source from, int index, int *pass) {
  static const struct {
    segment_kind over; /* OVER_BODY: no pass leaves it */
    segment_target target;
  } left[IR_SOURCE_COUNT] = {[IR_FROM_LINK] = {OVER_PARTICLES, TO_LINK},
                             [IR_FROM_NEIGHBOUR_LINK] = {OVER_PARTICLES, TO_LINK},
                             [IR_FROM_BOND_LINK] = {OVER_NEIGHBOURS, TO_LINK},
                             [IR_FROM_NEIGHBOUR_BOND_LINK] = {OVER_NEIGHBOURS, TO_LINK},
                             [IR_FROM_SHARED] = {OVER_BONDS, TO_SHARED},
                             [IR_FROM_SHARED_ODD] = {OVER_BONDS, TO_SHARED}};
  while (left[from].over != OVER_BODY && --*pass >= 0)
    for (int s = 0; s < p->passes[*pass].segment_count; s++) {
      const segment *a = &p->passes[*pass].segments[s];
      for (int r = 0; r < a->root_count && a->kind == left[from].over; r++)
        if (a->roots[r].target == left[from].target && a->roots[r].index == index)
          return &a->roots[r];
    }
  return NULL;
}

static int reaches_behind(unsigned at_hand, int from, int to) {
  int behind = 0;
  for (int p = from + 1; p <= to; p++)
    behind += !(at_hand >> p & 1);
  return behind;
}

/* Reaches of rows from a link of an earlier pass, the farthest that the segment reads, to where
   that pass now is. */
static int reaches_of_segment(const ir *g, const kernel_program *p, unsigned at_hand, int pass,
                              const segment *a) {
  unsigned char *needed = segment_needed(g, a);
  int most = 0;
  for (ir_node n = 0; n < ir_count(g); n++) {
    if (!needed[n] || ir_operation(g, n) != IR_INPUT) continue;
    const ir_source from = ir_input_source(g, n);
    int writer = pass;
    const bool own = from == IR_FROM_LINK || from == IR_FROM_BOND_LINK || a->kind == OVER_BONDS;
    if (!program_writer(p, from, ir_input_index(g, n), &writer)) continue;
    const int reaches = reaches_behind(at_hand, writer, pass) + !own;
    most = reaches > most ? reaches : most;
  }
  free(needed);
  return most;
}

int program_reaches_spared(const ir *g, const kernel_program *p) {
  const unsigned at_hand = program_at_hand(g, p);
  int most = 0;
  for (int k = 0; k < p->pass_count; k++)
    for (int s = 0; s < p->passes[k].segment_count; s++) {
      const int reaches = reaches_of_segment(g, p, at_hand, k, &p->passes[k].segments[s]);
      most = reaches > most ? reaches : most;
    }
  return reaches_behind(at_hand, 0, p->pass_count - 1) + 1 - most;
}
