#include "generator/emit/stage_cost.h"

#include "dsl/base/elementary.h"

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
  return count ? start + operations[ir_operation(e->graph, n)].price.latency : 0;
}

stage_cost stage_cost_of(const stages *s, const emitter *e, int *finish, int stage,
                         unsigned char *mask, unsigned char *taken) {
  stage_cost c = {0};
  stages_mark(e, s, stage, RELIES_ON_ALL, mask, taken);
  for (ir_node n = 0; n < e->node_count; n++) {
    c.loads += taken[n] || (mask[n] && stages_is_loaded(e, n));
    c.stores += stages_store(s, n, stage);
    if (!mask[n] || expression_is_uniform(e, n) || expression_is_of_time(e, n)) continue;
    const operation_price of = operations[ir_operation(e->graph, n)].price;
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
