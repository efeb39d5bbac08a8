/* What a bond does when its ends are held: states settle, or at least stay finite. */
#include "generator/check/physics_hold.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

enum { STEPS = 240 };
static const double RUNAWAY =
    1e6; /* of the force at first; a tenth more in each step comes to 1e9 */

/* The field whose rule has changed it most, over what it was; -1: none. */
static int runaway_field(const bench *b, double *const *states, const double *began, int lane) {
  int worst = -1;
  double most = 0;
  for (int k = 0; k < b->field_count; k++) {
    double way = fabs(bench_field(b, states, k)[lane] - began[k * BENCH_LANES + lane]);
    if (!(way <= most)) {
      worst = k;
      most = way;
    }
  }
  return worst;
}

static void say_runaway(physics *p, double *const *states, const double *began, int lane,
                        double before, double after) {
  bench *b = &p->b;
  int field = runaway_field(b, states, began, lane);
  const symbol *s = field < 0 ? NULL : b->law->fields.items[field];
  if (!s || !s->rule || p->failed[DIAG_FLOW]) return;
  double *column = must_alloc((size_t)b->width * sizeof *column);
  bench_get(b, states, lane, column);
  for (int k = 0; k < b->field_count; k++)
    column[b->parameter_count + QUANTITY_COUNT + k] = began[k * BENCH_LANES + lane];
  physics_say(p, DIAG_FLOW, s->rule->where, column,
              "state `%s` runs away: while the bond is held its force grows from %.4g to %.4g N in "
              "%d steps",
              s->name, before, after, (int)STEPS);
  diag_hint(p->said, "a plastic stretch or a slip lowers the force that moves it: look at the sign "
                     "of its change");
  free(column);
}

void physics_check_hold(physics *p) {
  bench *b = &p->b;
  if (!b->field_count || !p->pool_count) return;
  double **states = bench_states(b), before[BENCH_LANES];
  double *began = must_alloc((size_t)b->field_count * BENCH_LANES * sizeof *began);
  int count = 0;
  for (int k = 0; k < p->pool_count && count < BENCH_LANES; k += 1 + p->pool_count / BENCH_LANES)
    bench_put(b, states, count++, p->pool + (size_t)k * (size_t)b->width);
  memset(bench_quantity(b, states, QUANTITY_STRETCH_RATE), 0, (size_t)count * sizeof(double));
  for (int k = 0; k < b->field_count; k++)
    memcpy(began + k * BENCH_LANES, bench_field(b, states, k), (size_t)count * sizeof(double));
  for (int step = 0; step < STEPS && !bench_tired(b); step++) {
    probe_run(b, &b->step, states, count);
    bench_accept(b, states, count);
    for (int lane = 0; lane < count; lane++) {
      double size = bench_size(b, states, &b->step, lane);
      if (step == 0) before[lane] = size;
      if (step == STEPS - 1 && before[lane] > 0 && size > RUNAWAY * before[lane])
        say_runaway(p, states, began, lane, before[lane], size);
    }
  }
  bench_states_free(b, states);
  free(began);
}
