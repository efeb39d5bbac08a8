#include "generator/emit/stages.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"

/* --- what operations cost --------------------------------------------------------------------- */

/* In the cycles of operation_price. */
enum {
  LOAD_LATENCY = 7,
  DIVIDER_CYCLES = 16,
  LOOP_CYCLES = 2, /* counting and addresses */
  OPERATIONS_IN_FLIGHT = 180
};
/* Two operations can begin each cycle, but long vectors are held back where all cores work. */
#define OPERATION_CYCLES 0.5
#define STORE_CYCLES     0.3 /* and the load that follows; what a buffer takes of the first cache */

enum { SURE_OF_ALL = SURE_OF_EXPECTED | SURE_OF_UNHELD };

/* --- lines and their operands ----------------------------------------------------------------- */

bool stages_is_expected_choice(const emitter *e, ir_node n) {
  return ir_is_expected_choice(e->graph, n) && !emit_is_uniform(e, n);
}

bool stages_is_held_choice(const emitter *e, ir_node n) {
  return e->name[n] && ir_operation(e->graph, n) == IR_SELECT &&
         emit_asks_whether_protected(e, ir_operand(e->graph, n, 0));
}

expectation stages_expectation(const emitter *e, ir_node condition) {
  const ir *g = e->graph;
  assert(ir_operation(g, condition) == IR_LT);
  const ir_node size = ir_operand(g, condition, 0), limit = ir_operand(g, condition, 1);
  expectation x = {{size, IR_NONE}, 1, limit};
  const bool is_two = ir_operation(g, limit) == IR_CONSTANT && ir_value(g, limit) == 2;
  if (!is_two || ir_operation(g, size) != IR_MAX) return x;
  for (int k = 0; k < 2; k++) {
    const ir_node one = ir_operand(g, size, k);
    if (ir_operation(g, one) != IR_ABS) return (expectation){{size, IR_NONE}, 1, limit};
    x.size[k] = ir_operand(g, one, 0);
  }
  x.count = 2;
  return x;
}

/* The value first. */
static int operands_of_expected(const emitter *e, ir_node n, ir_node operand[3]) {
  operand[0] = ir_operand(e->graph, n, 1);
  if (e->scope != IN_ROWS) {
    operand[1] = ir_operand(e->graph, n, 0);
    return 2;
  }
  const expectation x = stages_expectation(e, ir_operand(e->graph, n, 0));
  for (int k = 0; k < x.count; k++)
    operand[1 + k] = x.size[k];
  return 1 + x.count;
}

int stages_operands(const emitter *e, ir_node n, unsigned relies, ir_node operand[3]) {
  int count = emit_is_uniform(e, n) ? 0 : ir_arity(ir_operation(e->graph, n));
  if ((relies & SURE_OF_EXPECTED) && stages_is_expected_choice(e, n))
    return operands_of_expected(e, n, operand);
  if ((relies & SURE_OF_UNHELD) && stages_is_held_choice(e, n)) {
    operand[0] = ir_operand(e->graph, n, 2);
    return 1;
  }
  for (int k = 0; k < count; k++)
    operand[k] = ir_operand(e->graph, n, k);
  return count;
}

/* Neither number nor value of the whole strip. */
static bool is_loaded(const emitter *e, ir_node n) {
  return emit_is_input(e, n) && !(ir_input_source(e->graph, n) == IR_FROM_ENDS &&
                                  ir_input_index(e->graph, n) == ENDS_TIME_STEP);
}

static bool is_line(const emitter *e, ir_node n) {
  return e->name[n] && !emit_is_uniform(e, n) && ir_operation(e->graph, n) != IR_INPUT;
}

static bool is_damage(const emitter *e, int field) {
  return e->plan->law->fields.items[field]->kind == SYMBOL_DAMAGE;
}

bool stages_is_of_change(const emitter *e, const pass_root *r) {
  if (r->target == TO_FIELD) return is_damage(e, r->index);
  if (r->target != TO_DISSIPATED_STATE || !e->plan->law->fields.count) return false;
  for (int f = 0; f < e->plan->law->fields.count; f++)
    if (!is_damage(e, f)) return false;
  return true;
}

static bool is_always_computed(const emitter *e, const pass_root *r) {
  return r->target == TO_FIELD || !stages_is_of_change(e, r);
}

static bool has_changes(const emitter *e) {
  for (int k = 0; k < e->root_count; k++)
    if (stages_is_of_change(e, &e->roots[k])) return true;
  return false;
}

/* --- what a stage computes -------------------------------------------------------------------- */

int stages_last(const stages *s) {
  return s->count - 1 - s->changes;
}

/* Whether the pass gives a result in that stage: all in the last one but those of a change. New
   damage is asked for there, too. */
static bool gives(const emitter *e, const stages *s, int stage, const pass_root *r) {
  if (stage < stages_last(s)) return false;
  if (!s->changes) return true;
  return stage > stages_last(s) ? stages_is_of_change(e, r) : is_always_computed(e, r);
}

/* The stage of changes takes results from the one before it, and computes what else that has again:
 * it is rare. */
static bool comes_from_before(const stages *s, ir_node n, int stage) {
  if (s->of[n] < 0 || s->of[n] >= stage) return false;
  return s->of[n] < stages_last(s) || s->result[n];
}

/* As stages_operands; what an earlier choice has asked is not asked again. */
static int operands_in_stage(const emitter *e, const stages *s, ir_node n, unsigned relies,
                             ir_node operand[3]) {
  const int count = stages_operands(e, n, relies, operand);
  const bool answered =
      (relies & SURE_OF_EXPECTED) && stages_is_expected_choice(e, n) && !stages_asks(e, s, n);
  return answered ? 1 : count;
}

/* --- a plan in the making --------------------------------------------------------------------- */

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
  const int count = stages_operands(p->e, n, SURE_OF_ALL, operand);
  for (int k = 0; k < count; k++) {
    const ir_node o = operand[k];
    stage = larger(stage, is_line(p->e, o) ? p->s->of[o] : stage_below(p, o));
  }
  return stage;
}

/* Cycles into `stage` at which node n is computed. */
static int finish_in(const planner *p, ir_node n, int stage) {
  ir_node operand[3];
  int start = 0;
  if (is_loaded(p->e, n)) return LOAD_LATENCY;
  const int count = stages_operands(p->e, n, SURE_OF_ALL, operand);
  for (int k = 0; k < count; k++) {
    const ir_node o = operand[k];
    const bool here = p->s->of[o] == stage || p->s->of[o] < 0;
    const int ready = !is_line(p->e, o) ? finish_in(p, o, stage)
                      : here            ? p->finish[o]
                                        : LOAD_LATENCY;
    start = larger(start, ready);
  }
  return count ? start + operations[ir_operation(p->e->graph, n)].price.latency : 0;
}

/* Every line as early as chains allow, of at most `first` cycles in the first stage and `later` in the others. */
static void place_early(planner *p, int first, int later) {
  for (ir_node n = 0; n < p->e->node_count; n++) {
    p->s->of[n] = -1;
    if (!p->usual[n] || !is_line(p->e, n)) continue;
    int stage = stage_below(p, n);
    p->s->of[n] = stage;
    p->finish[n] = finish_in(p, n, stage);
    if (p->finish[n] <= (stage > 0 ? later : first) || stages_is_held_choice(p->e, n))
      continue; /* behind what it chooses it would be a copy of a buffer */
    const int alone = finish_in(p, n, stage + 1);
    if (alone >= p->finish[n]) continue; /* a long operation of its own */
    p->s->of[n] = stage + 1;
    p->finish[n] = alone;
  }
}

/* The last stage writes what the pass gives; it has no expected choices, because it cannot be done twice. */
static int last_stage(const planner *p) {
  const emitter *e = p->e;
  int last = 0;
  for (ir_node n = 0; n < e->node_count; n++)
    if (p->usual[n] && is_line(e, n))
      last = larger(last, p->s->of[n] + stages_is_expected_choice(e, n));
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
      if (gives(e, p->s, stage, &e->roots[k])) need_in(u, e->roots[k].node, UINT64_C(1) << stage);
}

/* Of the stages that need a node those that take it from an earlier one. The others compute it, be
 * it once more. */
static uint64_t taken_by(const planner *p, ir_node n, uint64_t needed) {
  uint64_t taken = 0;
  for (int stage = 0; stage < p->s->count; stage++)
    if (comes_from_before(p->s, n, stage)) taken |= UINT64_C(1) << stage;
  return needed & taken;
}

static void need_below(const planner *p, users *u, ir_node n) {
  ir_node operand[3];
  const int own = p->s->of[n];
  const uint64_t needed = u->now[n] | (own >= 0 ? UINT64_C(1) << own : 0);
  const uint64_t computed = needed & ~taken_by(p, n, needed);
  if (!computed) return;
  const int count = operands_in_stage(p->e, p->s, n, SURE_OF_ALL, operand);
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
  const int count = stages_operands(p->e, n, SURE_OF_ALL, operand);
  for (int k = 0; k < count; k++) {
    const ir_node o = operand[k];
    if (is_line(p->e, o))
      kept += p->s->of[o] < to && last_to_take(p, u->ever, o) < to;
    else
      kept += newly_kept(p, o, to, u);
  }
  return kept;
}

/* Whether a line moves to the first stage that takes it: where that saves a buffer. */
static bool moves_late(const planner *p, const users *u, ir_node n, int to) {
  return p->s->of[n] >= 0 && to > p->s->of[n] && !stages_is_expected_choice(p->e, n) &&
         !stages_is_held_choice(p->e, n) && newly_kept(p, n, to, u) == 0;
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

bool stages_is_lent(const pass_root *r) {
  return r->target == TO_FORCE || r->target == TO_OBSERVED;
}

static int lent_results(const emitter *e) {
  int lent = 0;
  for (int k = 0; k < e->root_count; k++)
    lent += stages_is_lent(&e->roots[k]);
  return lent;
}

/* Marks the results of the pass (stages.result). */
static void mark_pass_results(const emitter *e, stages *s) {
  for (ir_node n = 0; n < e->node_count; n++)
    s->result[n] = 0;
  for (int k = 0, lent = 0; k < e->root_count; k++) {
    int *of = &s->result[e->roots[k].node];
    const bool is_lent = stages_is_lent(&e->roots[k]);
    if (*of < 2) *of = is_lent ? 2 + lent : 1;
    lent += is_lent;
  }
}

/* A buffer is free again in the last stage that reads it, whose lines load before they store. The first ones are the arrays
   of results that the last stage writes anew: up to there they cost no place in the cache. */
static void give_buffers(planner *p) {
  const emitter *e = p->e;
  users u = users_new(e);
  int *until = must_alloc(((size_t)e->node_count + 1) * sizeof(int));
  find_users(p, &u);
  const int lent = lent_results(e), last = stages_last(p->s);
  int given = lent;
  for (ir_node n = 0; n < e->node_count; n++)
    p->s->buffer[n] = p->s->until[n] = until[n] = -1;
  for (int stage = 0; stage < p->s->count; stage++) {
    int next[2] = {0, lent}; /* buffers before are taken; the second, of those that are not lent */
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
  p->s->lent = lent;
  p->s->buffers = given - lent;
  users_free(&u);
  free(until);
}

/* --- cost ------------------------------------------------------------------------------------- */

static double most(double a, double b) {
  return a > b ? a : b;
}

bool stages_stores(const stages *s, ir_node n, int stage) {
  const bool result = stage == stages_last(s) && s->buffer[n] < s->lent;
  return s->of[n] == stage && s->buffer[n] >= 0 && !result;
}

static stage_cost cost_of(planner *p, int stage, unsigned char *mask, unsigned char *taken) {
  const emitter *e = p->e;
  stage_cost c = {0};
  stages_mark(e, p->s, stage, SURE_OF_ALL, mask, taken);
  for (ir_node n = 0; n < e->node_count; n++) {
    c.loads += taken[n] || (mask[n] && is_loaded(e, n));
    c.stores += stages_stores(p->s, n, stage);
    if (!mask[n] || emit_is_uniform(e, n)) continue;
    const operation_price of = operations[ir_operation(e->graph, n)].price;
    c.operations += of.operations;
    c.divisions += of.divisions;
    c.chain = larger(c.chain, finish_in(p, n, stage));
    if (is_line(e, n)) p->finish[n] = finish_in(p, n, stage);
  }
  if (stage == stages_last(p->s)) c.stores += e->root_count;
  const double busy =
      most(most(OPERATION_CYCLES * c.operations, c.stores), DIVIDER_CYCLES * c.divisions);
  const double waiting = (double)c.chain * c.operations / OPERATIONS_IN_FLIGHT;
  /* neither hides all of the other; up to two fifths more than measured where chains are short, but in the same order */
  c.cycles = pl_hypot(busy, waiting) + STORE_CYCLES * c.stores + LOOP_CYCLES;
  return c;
}

static void find_costs(planner *p) {
  unsigned char *mask = must_alloc((size_t)p->e->node_count + 1);
  unsigned char *taken = must_alloc((size_t)p->e->node_count + 1);
  p->s->cost = must_calloc((size_t)p->s->count, sizeof *p->s->cost);
  for (int stage = 0; stage < p->s->count; stage++) {
    p->s->cost[stage] = cost_of(p, stage, mask, taken);
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
    if (is_always_computed(e, &e->roots[k])) p->usual[e->roots[k].node] = 1;
  for (ir_node n = e->node_count - 1; n >= 0; n--) {
    ir_node operand[3];
    const int count = p->usual[n] ? stages_operands(e, n, SURE_OF_ALL, operand) : 0;
    for (int k = 0; k < count; k++)
      p->usual[operand[k]] = 1;
  }
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
    s->conditions += stages_is_expected_choice(p->e, n);
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
    s->of[n] = p->e->needed[n] && is_line(p->e, n) ? 0 : -1;
    s->buffer[n] = s->until[n] = -1;
  }
  s->lent = lent_results(p->e);
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

stages *stages_plan(const emitter *e, loop_cutting cutting) {
  planner p = {.e = e};
  mark_usual(&p);
  p.finish = must_calloc((size_t)e->node_count + 1, sizeof *p.finish);
  int lines = 0;
  for (ir_node n = 0; n < e->node_count; n++)
    lines += is_line(e, n);
  stages *best = search(&p, cutting, lines);
  if (!best) best = plan_whole(&p);
  free(p.finish);
  free(p.usual);
  return best;
}

void stages_free(stages *s) {
  if (!s) return;
  free(s->of);
  free(s->buffer);
  free(s->until);
  free(s->result);
  free(s->cost);
  free(s);
}

/* --- one loop --------------------------------------------------------------------------------- */

bool stages_has_held_choices(const emitter *e, const stages *s, int stage) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (s->of[n] == stage && stages_is_held_choice(e, n)) return true;
  return false;
}

bool stages_asks(const emitter *e, const stages *s, ir_node n) {
  if (!stages_is_expected_choice(e, n)) return false;
  for (ir_node k = 0; k < e->node_count; k++) {
    const bool before = s->of[k] >= 0 && (s->of[k] < s->of[n] || (s->of[k] == s->of[n] && k < n));
    if (before && stages_is_expected_choice(e, k) &&
        ir_operand(e->graph, k, 0) == ir_operand(e->graph, n, 0))
      return false;
  }
  return true;
}

void stages_mark_kept(const emitter *e, const stages *s, unsigned char *mask) {
  for (ir_node n = 0; n < e->node_count; n++)
    mask[n] = s->buffer[n] >= 0 && s->of[n] < stages_last(s) && s->until[n] >= stages_last(s);
}

/* What the stage hands on: its lines, or what the pass gives. */
static void mark_results(const emitter *e, const stages *s, int stage, unsigned char *mask) {
  for (ir_node n = 0; n < e->node_count; n++)
    if (s->of[n] == stage) mask[n] = 1;
  for (int k = 0; k < e->root_count; k++)
    if (gives(e, s, stage, &e->roots[k])) mask[e->roots[k].node] = 1;
}

void stages_mark(const emitter *e, const stages *s, int stage, unsigned relies, unsigned char *mask,
                 unsigned char *kept_loads) {
  memset(mask, 0, (size_t)e->node_count + 1);
  memset(kept_loads, 0, (size_t)e->node_count + 1);
  mark_results(e, s, stage, mask);
  for (ir_node n = e->node_count - 1; n >= 0; n--) {
    if (!mask[n]) continue;
    /* what only the unexpected needs is not kept for it: it is computed again */
    if (comes_from_before(s, n, stage) && (relies != SURE_OF_NOTHING || s->until[n] >= stage)) {
      kept_loads[n] = 1;
      mask[n] = 0;
      continue;
    }
    ir_node operand[3];
    const int count = operands_in_stage(e, s, n, relies, operand);
    for (int k = 0; k < count; k++)
      mask[operand[k]] = 1;
  }
}
