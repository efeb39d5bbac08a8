#include "generator/emit/loop_cutting.h"

#include <stdlib.h>
#include <string.h>

#include "generator/emit/stage_cost.h"

typedef struct planner {
  const emitter *e;
  stages *s;
  unsigned char *usual; /* [node_count] needed where all is as expected */
  int *finish;          /* [node_count] cycles into its stage at which a line's value is there */
} planner;

static int larger(int a, int b) {
  return a > b ? a : b;
}

/* Latest stage among the lines under node n, which is written in place or is the line itself. */
static int stage_below(const planner *p, ir_node n) {
  ir_node operand[3];
  int stage = 0;
  const int count = choice_operands(p->e, n, RELIES_ON_ALL, operand);
  for (int k = 0; k < count; k++) {
    const ir_node o = operand[k];
    stage = larger(stage, stages_is_line(p->e, o) ? p->s->of[o] : stage_below(p, o));
  }
  return stage;
}

/* Every line as early as chains allow, of at most `first` cycles in the first stage and `later` in
   the others. */
static void place_early(planner *p, int first, int later) {
  for (ir_node n = 0; n < p->e->node_count; n++) {
    p->s->of[n] = -1;
    if (!p->usual[n] || !stages_is_line(p->e, n)) continue;
    int stage = stage_below(p, n);
    p->s->of[n] = stage;
    p->finish[n] = stage_finish(p->s, p->e, p->finish, n, stage);
    if (p->finish[n] <= (stage > 0 ? later : first) || choice_is_by_protection(p->e, n))
      continue; /* behind what it chooses it would be a copy of a buffer */
    const int alone = stage_finish(p->s, p->e, p->finish, n, stage + 1);
    if (alone >= p->finish[n]) continue; /* a long operation of its own */
    p->s->of[n] = stage + 1;
    p->finish[n] = alone;
  }
}

/* The last stage writes what the pass gives; it has no expected choices, because it cannot be done
   twice. */
static int last_stage(const planner *p) {
  const emitter *e = p->e;
  int last = 0;
  for (ir_node n = 0; n < e->node_count; n++)
    if (p->usual[n] && stages_is_line(e, n))
      last = larger(last, p->s->of[n] + choice_is_expected(e, n));
  return last;
}

/* Stages in which nodes are needed, a bit each. Users of a node stand behind it: walked from the
   last node to the first, all that use a node are known when it is its turn. */
typedef struct users {
  uint64_t *now;  /* [node_count] as the lines stand */
  uint64_t *ever; /* [node_count] these, and as the lines stood before they moved */
} users;

static users users_new(const emitter *e) {
  const size_t size = ((size_t)e->node_count + 1) * sizeof(uint64_t);
  return (users){must_alloc(size), must_alloc(size)};
}

static void users_free(users *u) {
  free(u->now);
  free(u->ever);
}

static void need_in(users *u, ir_node n, uint64_t stages_of_use) {
  u->now[n] |= stages_of_use;
  u->ever[n] |= stages_of_use;
}

static void need_results(const planner *p, users *u) {
  const emitter *e = p->e;
  memset(u->now, 0, ((size_t)e->node_count + 1) * sizeof *u->now);
  for (int stage = stages_last(p->s); stage < p->s->count; stage++)
    for (int k = 0; k < e->root_count; k++)
      if (stages_give(e, p->s, stage, &e->roots[k]))
        need_in(u, e->roots[k].node, UINT64_C(1) << stage);
}

/* Of the stages that need a node those that take it from an earlier one. The others compute it, be
 * it once more. */
static uint64_t taken_by(const planner *p, ir_node n, uint64_t needed) {
  uint64_t taken = 0;
  for (int stage = 0; stage < p->s->count; stage++)
    if (stages_take(p->s, n, stage)) taken |= UINT64_C(1) << stage;
  return needed & taken;
}

static void need_below(const planner *p, users *u, ir_node n) {
  ir_node operand[3];
  const int own = p->s->of[n];
  const uint64_t needed = u->now[n] | (own >= 0 ? UINT64_C(1) << own : 0);
  const uint64_t computed = needed & ~taken_by(p, n, needed);
  if (!computed) return;
  const int count = stages_operands(p->e, p->s, n, RELIES_ON_ALL, operand);
  for (int k = 0; k < count; k++)
    need_in(u, operand[k], computed);
}

static void find_users(const planner *p, users *u) {
  memset(u->ever, 0, ((size_t)p->e->node_count + 1) * sizeof *u->ever);
  need_results(p, u);
  for (ir_node n = p->e->node_count - 1; n >= 0; n--)
    need_below(p, u, n);
}

/* The first and the last stage that takes a line from an earlier one; -1 without such a stage. */
static int first_to_take(const planner *p, const users *u, ir_node n) {
  const uint64_t taken = taken_by(p, n, u->now[n]);
  int stage = 0;
  while (stage < p->s->count && !(taken >> stage & 1))
    stage++;
  return stage < p->s->count ? stage : -1;
}

static int last_to_take(const planner *p, const uint64_t *needed, ir_node n) {
  const uint64_t taken = taken_by(p, n, needed[n]);
  int stage = p->s->count - 1;
  while (stage >= 0 && !(taken >> stage & 1))
    stage--;
  return stage;
}

/* Lines under node n that would be kept for stage `to` on its account alone. */
static int newly_kept(const planner *p, ir_node n, int to, const users *u) {
  ir_node operand[3];
  int kept = 0;
  const int count = choice_operands(p->e, n, RELIES_ON_ALL, operand);
  for (int k = 0; k < count; k++) {
    const ir_node o = operand[k];
    if (stages_is_line(p->e, o))
      kept += p->s->of[o] < to && last_to_take(p, u->ever, o) < to;
    else
      kept += newly_kept(p, o, to, u);
  }
  return kept;
}

/* Whether a line moves to the first stage that takes it: where that saves a buffer. */
static bool moves_late(const planner *p, const users *u, ir_node n, int to) {
  return p->s->of[n] >= 0 && to > p->s->of[n] && !choice_is_expected(p->e, n) &&
         !choice_is_by_protection(p->e, n) && newly_kept(p, n, to, u) == 0;
}

/* From the last line to the first, so that whole trees move. */
static void place_late(planner *p) {
  users u = users_new(p->e);
  find_users(p, &u); /* then once more, as they move: the latest users only become later */
  need_results(p, &u);
  for (ir_node n = p->e->node_count - 1; n >= 0; n--) {
    const int to = first_to_take(p, &u, n);
    if (moves_late(p, &u, n, to)) p->s->of[n] = to;
    need_below(p, &u, n);
  }
  users_free(&u);
}

/* Stages that all lines have left go. */
static void drop_empty(planner *p) {
  stages *s = p->s;
  const int stage_count = s->count;
  int *number = must_calloc((size_t)stage_count + 1, sizeof *number);
  for (ir_node n = 0; n < p->e->node_count; n++)
    if (s->of[n] >= 0) number[s->of[n]] = 1;
  number[stages_last(s)] = number[stage_count - 1] = 1;
  s->count = 0;
  for (int k = 0; k < stage_count; k++)
    number[k] = number[k] ? s->count++ : -1;
  for (ir_node n = 0; n < p->e->node_count; n++)
    if (s->of[n] >= 0) s->of[n] = number[s->of[n]];
  free(number);
}

/* --- buffers ---------------------------------------------------------------------------------- */

static int result_arrays(const emitter *e) {
  int count = 0;
  for (int k = 0; k < e->root_count; k++)
    count += stages_in_result_array(&e->roots[k]);
  return count;
}

/* Marks the results of the pass (stages.result). */
static void mark_pass_results(const emitter *e, stages *s) {
  for (ir_node n = 0; n < e->node_count; n++)
    s->result[n] = 0;
  for (int k = 0, array = 0; k < e->root_count; k++) {
    int *of = &s->result[e->roots[k].node];
    const bool in_array = stages_in_result_array(&e->roots[k]);
    if (*of < 2) *of = in_array ? 2 + array : 1;
    array += in_array;
  }
}

/* A buffer is free again in the last stage that reads it, whose lines load before they store. The
   first ones are the arrays of results that the last stage writes anew: up to there they cost no
   place in the cache. */
static void give_buffers(planner *p) {
  const emitter *e = p->e;
  users u = users_new(e);
  int *until = must_alloc(((size_t)e->node_count + 1) * sizeof(int));
  find_users(p, &u);
  const int arrays = result_arrays(e), last = stages_last(p->s);
  int given = arrays;
  for (ir_node n = 0; n < e->node_count; n++)
    p->s->buffer[n] = p->s->until[n] = until[n] = -1;
  for (int stage = 0; stage < p->s->count; stage++) {
    int next[2] = {0, arrays}; /* buffers before are taken; the second, behind the results' */
    for (ir_node n = 0; n < e->node_count; n++) {
      const int user = p->s->of[n] == stage ? last_to_take(p, u.now, n) : -1;
      if (user <= stage) continue;
      p->s->until[n] = user;
      p->s->buffer[n] = p->s->result[n] - 2; /* the array of a result holds the value anyway */
      if (stage == last && p->s->buffer[n] >= 0) continue;
      int *b = &next[user > last];
      while (*b < given && until[*b] > stage)
        ++*b;
      if (*b == given) given++;
      until[*b] = user;
      p->s->buffer[n] = *b;
    }
  }
  p->s->result_arrays = arrays;
  p->s->buffers = given - arrays;
  users_free(&u);
  free(until);
}

static void find_costs(planner *p) {
  unsigned char *mask = must_alloc((size_t)p->e->node_count + 1);
  unsigned char *taken = must_alloc((size_t)p->e->node_count + 1);
  p->s->cost = must_calloc((size_t)p->s->count, sizeof *p->s->cost);
  for (int stage = 0; stage < p->s->count; stage++) {
    p->s->cost[stage] = stage_cost_of(p->s, p->e, p->finish, stage, mask, taken);
    if (stage <= stages_last(p->s)) p->s->cycles += p->s->cost[stage].cycles;
  }
  free(mask);
  free(taken);
}

/* --- the plan --------------------------------------------------------------------------------- */

static void mark_usual(planner *p) {
  const emitter *e = p->e;
  p->usual = must_calloc((size_t)e->node_count + 1, 1);
  for (int k = 0; k < e->root_count; k++)
    if (e->roots[k].target == TO_FIELD || !stages_is_of_change(e, &e->roots[k]))
      p->usual[e->roots[k].node] = 1;
  choice_mark_operands(e, RELIES_ON_ALL, p->usual);
}

static bool has_changes(const emitter *e) {
  for (int k = 0; k < e->root_count; k++)
    if (stages_is_of_change(e, &e->roots[k])) return true;
  return false;
}

static stages *new_plan(const emitter *e) {
  const size_t nodes = (size_t)e->node_count + 1;
  stages *s = must_calloc(1, sizeof *s);
  s->of = must_alloc(nodes * sizeof *s->of);
  s->buffer = must_alloc(nodes * sizeof *s->buffer);
  s->until = must_alloc(nodes * sizeof *s->until);
  s->result = must_alloc(nodes * sizeof *s->result);
  mark_pass_results(e, s);
  return s;
}

/* Real laws need a few. Buffers stand on the stack. */
enum {
  MOST_STAGES = 63 /* a bit each, and one that follows */,
  MOST_BUFFERS = 200,
  MOST_LINES = 1000
};

/* NULL where the cuts are too many. */
static stages *plan_with(planner *p, int first, int later) {
  stages *s = p->s = new_plan(p->e);
  place_early(p, first, later);
  for (ir_node n = 0; n < p->e->node_count; n++) {
    if (s->of[n] < 0) continue;
    s->whole_chain = larger(s->whole_chain, p->finish[n]);
    s->conditions += choice_is_expected(p->e, n);
  }
  s->count = last_stage(p) + 1;
  if (s->count > MOST_STAGES) {
    stages_free(s);
    return NULL;
  }
  s->changes = s->count > 1 && has_changes(p->e);
  s->count += s->changes;
  if (s->count > 1) place_late(p);
  drop_empty(p);
  give_buffers(p);
  find_costs(p);
  return s;
}

/* One loop that expects nothing and needs no buffers. */
static stages *plan_whole(planner *p) {
  stages *s = p->s = new_plan(p->e);
  s->count = 1;
  for (ir_node n = 0; n < p->e->node_count; n++) {
    s->of[n] = p->e->needed[n] && stages_is_line(p->e, n) ? 0 : -1;
    s->buffer[n] = s->until[n] = -1;
  }
  s->result_arrays = result_arrays(p->e);
  find_costs(p);
  s->whole_chain = s->cost[0].chain;
  return s;
}

enum { NO_CUT = 1 << 20, SHORTEST_CHAIN = 50 };
static const int longest_chains[] = {NO_CUT, 160, 140, 120, 105, 95, 85, 75, 66, SHORTEST_CHAIN};
enum { CHAIN_COUNT = sizeof longest_chains / sizeof *longest_chains };

/* The better of two plans, one of which may be missing or have too many buffers; the other one
 * goes. */
static stages *cheaper(stages *a, stages *b) {
  const bool takes_b = b && b->buffers <= MOST_BUFFERS && (!a || b->cycles < a->cycles);
  stages_free(takes_b ? a : b);
  return takes_b ? b : a;
}

/* The best of many cuts. */
static stages *search(planner *p, loop_cutting cutting, int lines) {
  stages *best = NULL;
  if (cutting == CUT_ALWAYS) best = cheaper(NULL, plan_with(p, SHORTEST_CHAIN, SHORTEST_CHAIN));
  if (best) return best;
  best = cheaper(NULL, plan_with(p, NO_CUT, NO_CUT));
  const int whole_chain = best ? best->whole_chain : 0;
  const bool may_cut = cutting == CUT_BY_COST && lines <= MOST_LINES;
  for (int k = 1; k < CHAIN_COUNT && may_cut; k++)
    for (int l = 1; l < CHAIN_COUNT; l++)
      best = cheaper(best, plan_with(p, longest_chains[k], longest_chains[l]));
  if (best && whole_chain) best->whole_chain = whole_chain;
  return best;
}

stages *loop_cutting_plan(const emitter *e, loop_cutting cutting) {
  planner p = {.e = e};
  mark_usual(&p);
  p.finish = must_calloc((size_t)e->node_count + 1, sizeof *p.finish);
  int lines = 0;
  for (ir_node n = 0; n < e->node_count; n++)
    lines += stages_is_line(e, n);
  stages *best = e->plan->large ? NULL : search(&p, cutting, lines);
  if (!best) best = plan_whole(&p);
  free(p.finish);
  free(p.usual);
  return best;
}
