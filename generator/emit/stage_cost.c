#include "generator/emit/stage_cost.h"

#include "dsl/base/elementary.h"

/* Cycles until the result is there, and operations, of eight doubles on processors with 512-bit
   vectors (Intel's of 2019 and later); only their ratios matter. */
typedef struct price {
  int latency, operations, divisions;
} price;

enum {
  LOAD_LATENCY = 7,
  DIVIDER_CYCLES = 16,
  LOOP_CYCLES = 2, /* counting and addresses */
  OPERATIONS_IN_FLIGHT = 180
};
/* Two operations can begin each cycle, but long vectors are held back where all cores work. */
#define OPERATION_CYCLES 0.5
#define STORE_CYCLES     0.3 /* and the load that follows; what a buffer takes of the first cache */

/* clang-format off */
static const price prices[IR_OP_COUNT] = { /* numbers and inputs: nothing */
    [IR_ADD] = {4, 1, 0},    [IR_SUB] = {4, 1, 0},    [IR_MUL] = {4, 1, 0},   [IR_DIV] = {24, 3, 1},
    [IR_FMA] = {4, 1, 0},
    [IR_NEG] = {1, 1, 0},    [IR_ABS] = {1, 1, 0},    [IR_SQRT] = {32, 3, 2}, [IR_INVERSE_ROOT] = {48, 14, 0},
    [IR_MIN] = {8, 3, 0},    [IR_MAX] = {8, 3, 0},    [IR_SIGN] = {6, 4, 0},  [IR_EXP] = {75, 25, 0},
    [IR_LOG] = {100, 25, 1}, [IR_POW] = {230, 90, 1}, [IR_CBRT] = {110, 35, 0}, [IR_SIN] = {75, 35, 0},
    [IR_COS] = {75, 35, 0},  [IR_TAN] = {110, 60, 1}, [IR_TANH] = {110, 35, 1}, [IR_ATAN2] = {100, 50, 1},
    [IR_WRAP_ANGLE] = {35, 10, 0},
    [IR_LT] = {4, 1, 0},     [IR_LE] = {4, 1, 0},     [IR_EQ] = {4, 1, 0},    [IR_AND] = {1, 1, 0},
    [IR_OR] = {1, 1, 0},     [IR_NOT] = {1, 1, 0},    [IR_SELECT] = {2, 1, 0},
};
/* clang-format on */

static int larger(int a, int b) {
  return a > b ? a : b;
}

static double most(double a, double b) {
  return a > b ? a : b;
}

int stage_finish(const stages *s, const emitter *e, const int *finish, ir_node n, int stage) {
  ir_node operand[3];
  int start = 0;
  if (stages_is_loaded(e, n)) return LOAD_LATENCY;
  const int count = choice_operands(e, n, RELIES_ON_ALL, operand);
  for (int k = 0; k < count; k++) {
    const ir_node o = operand[k];
    const bool here = s->of[o] == stage || s->of[o] < 0;
    const int ready = !stages_is_line(e, o) ? stage_finish(s, e, finish, o, stage)
                      : here                ? finish[o]
                                            : LOAD_LATENCY;
    start = larger(start, ready);
  }
  return count ? start + prices[ir_operation(e->graph, n)].latency : 0;
}

stage_cost stage_cost_of(const stages *s, const emitter *e, int *finish, int stage,
                         unsigned char *mask, unsigned char *taken) {
  stage_cost c = {0};
  stages_mark(e, s, stage, RELIES_ON_ALL, mask, taken);
  for (ir_node n = 0; n < e->node_count; n++) {
    c.loads += taken[n] || (mask[n] && stages_is_loaded(e, n));
    c.stores += stages_store(s, n, stage);
    if (!mask[n] || expression_is_uniform(e, n)) continue;
    const price of = prices[ir_operation(e->graph, n)];
    c.operations += of.operations;
    c.divisions += of.divisions;
    c.chain = larger(c.chain, stage_finish(s, e, finish, n, stage));
    if (stages_is_line(e, n)) finish[n] = stage_finish(s, e, finish, n, stage);
  }
  if (stage == stages_last(s)) c.stores += e->root_count;
  const double busy =
      most(most(OPERATION_CYCLES * c.operations, c.stores), DIVIDER_CYCLES * c.divisions);
  const double waiting = (double)c.chain * c.operations / OPERATIONS_IN_FLIGHT;
  /* neither hides all of the other; up to two fifths more than measured where chains are short, but
     in the same order */
  c.cycles = pl_hypot(busy, waiting) + STORE_CYCLES * c.stores + LOOP_CYCLES;
  return c;
}
