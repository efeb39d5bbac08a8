#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/semantics/law_limits.h"
#include "generator/check/physics_report.h"
#include "generator/intervals/interval_witness.h"
#include "generator/ir/random_values.h"

enum { BATCHES = 24, BISECTIONS = 60 };

typedef struct hunt {
  bench *b;
  probe seen; /* argument, then the conditions */
  const interval_condition *conditions;
  int count;
  const range *fields;
  interval_wish wish;
  double **states;
  double *low, *high; /* columns where the argument is below and above 0 */
  bool has_low, has_high;
} hunt;

/* --- drawing within the declared bounds ------------------------------------------------------- */

static double draw_between(bench *b, double low, double high, double usual) {
  uint64_t choice = draw_bits(&b->seed) % 8;
  if (choice == 0 && isfinite(low)) return low;
  if (choice == 1 && isfinite(high)) return high;
  if (choice < 5 && isfinite(low) && isfinite(high)) return draw_uniform(&b->seed, low, high);
  double drawn =
      usual != 0 ? usual * pl_pow(10, draw_uniform(&b->seed, -2, 2)) : draw_size(&b->seed, -3, 3);
  if (!isfinite(low) && draw_bits(&b->seed) % 2) drawn = -drawn;
  return pl_fmin(pl_fmax(drawn, low), high);
}

static bool draw_parameters(hunt *h, int lane) {
  bench *b = h->b;
  const law *l = b->law;
  double *values = must_calloc((size_t)l->parameters.count + 1, sizeof *values);
  for (int k = 0; k < l->parameters.count; k++)
    values[k] = h->states[k][lane];
  for (int k = 0; k < l->parameters.count; k++) {
    const law_limits in = law_parameter_limits(l, k, values);
    if (draw_bits(&b->seed) % 2) values[k] = draw_between(b, in.lower, in.upper, values[k]);
  }
  bool within = true;
  char text[64];
  for (int k = 0; k < l->parameters.count; k++)
    within = within && law_parameter_within(l, k, values, text, sizeof text);
  for (int k = 0; k < l->parameters.count && within; k++)
    h->states[k][lane] = values[k];
  free(values);
  return within;
}

static void draw_lane(hunt *h, int lane, bool vary) {
  bench *b = h->b;
  bench_draw(b, h->states, lane);
  bench_virgin(b, h->states, lane);
  if (vary)
    for (int tries = 0; tries < 8 && !draw_parameters(h, lane);)
      tries++;
  for (int k = 0; k < b->field_count; k++) {
    bool damage = b->law->fields.items[k]->kind == SYMBOL_DAMAGE;
    uint64_t choice = draw_bits(&b->seed) % 4;
    if (damage)
      bench_field(b, h->states, k)[lane] = choice == 0   ? 1
                                           : choice == 1 ? draw_uniform(&b->seed, 0, 1)
                                                         : 0;
    else if (choice == 0) {
      double drawn = bench_field(b, h->states, k)[lane] + draw_size(&b->seed, -6, 0);
      bench_field(b, h->states, k)[lane] =
          pl_fmin(pl_fmax(drawn, h->fields[k].low), h->fields[k].high);
    }
  }
  motion m = {{draw_size(&b->seed, -7, 0.5), draw_size(&b->seed, -3, 5),
               draw_size(&b->seed, -6, 0.4), draw_size(&b->seed, -6, 0.4)}};
  if (draw_bits(&b->seed) % 8 == 0) m = (motion){{0}};
  m.at[AXIS_STRETCH] = pl_fmax(m.at[AXIS_STRETCH], -0.999);
  bench_move(b, h->states, lane, m);
}

/* --- looking ---------------------------------------------------------------------------------- */

static bool conditions_hold(const hunt *h, int lane) {
  for (int k = 0; k < h->count; k++)
    if ((h->seen.out[1 + k][lane] != 0) != h->conditions[k].truth) return false;
  return true;
}

static bool is_as_wished(const hunt *h, int lane) {
  double x = h->seen.out[0][lane];
  switch (h->wish) {
  case WISH_ZERO:
    return x == 0;
  case WISH_NOT_POSITIVE:
    return x <= 0;
  case WISH_BEYOND_ONE:
    return fabs(x) > 1;
  default:
    return x < 0;
  }
}

static void run(hunt *h, int count) {
  probe_run(h->b, &h->seen, h->states, count);
}

static bool look_in_batch(hunt *h, double *found) {
  run(h, BENCH_LANES);
  for (int lane = 0; lane < BENCH_LANES; lane++) {
    if (!conditions_hold(h, lane)) continue;
    if (is_as_wished(h, lane)) {
      bench_get(h->b, h->states, lane, found);
      return true;
    }
    double x = h->seen.out[0][lane];
    if (x < 0 && !h->has_low) bench_get(h->b, h->states, lane, h->low), h->has_low = true;
    if (x > 0 && !h->has_high) bench_get(h->b, h->states, lane, h->high), h->has_high = true;
  }
  return false;
}

/* On the straight way between a state below 0 and one above it. */
static bool bisect(hunt *h, double *found) {
  bench *b = h->b;
  int length = b->parameter_count + (int)QUANTITY_LENGTH,
      stretch = b->parameter_count + (int)QUANTITY_STRETCH;
  int s = b->parameter_count + (int)QUANTITY_S;
  double first = 0;
  for (int round = 0; round < BISECTIONS; round++) {
    for (int k = 0; k < b->width; k++)
      found[k] = h->low[k] + 0.5 * (h->high[k] - h->low[k]);
    found[length] = found[s] * (1 + found[stretch]);
    bench_put(b, h->states, 0, found);
    run(h, 1);
    if (!conditions_hold(h, 0)) return false;
    double x = h->seen.out[0][0];
    first = round == 0 ? fabs(x) : first;
    if (x == 0) return true;
    memcpy(x < 0 ? h->low : h->high, found, (size_t)b->width * sizeof *found);
    if (round == BISECTIONS - 1) return fabs(x) <= 1e-12 * first;
  }
  return false;
}

char *interval_witness(bench *b, const range *fields, ir_node operand, interval_wish wish,
                       const interval_condition *conditions, int count) {
  hunt h = {.b = b,
            .fields = fields,
            .conditions = conditions,
            .count = count,
            .wish = wish,
            .states = bench_states(b)};
  size_t width = (size_t)b->width * sizeof(double);
  ir_node nodes[64] = {operand};
  h.count = count < 63 ? count : 63;
  for (int k = 0; k < h.count; k++)
    nodes[1 + k] = conditions[k].guard;
  h.seen = probe_new(b, nodes, 1 + h.count);
  h.low = must_alloc(width);
  h.high = must_alloc(width);
  double *found = must_alloc(width);
  bool good = false;
  for (int batch = 0; batch < BATCHES && !good; batch++) {
    for (int lane = 0; lane < BENCH_LANES; lane++)
      draw_lane(&h, lane, batch > 0);
    good = look_in_batch(&h, found);
  }
  if (!good && wish == WISH_ZERO && h.has_low && h.has_high) good = bisect(&h, found);
  physics p = {.b = *b};
  char *text = good ? physics_state_text(&p, found) : NULL;
  probe_free(&h.seen);
  bench_states_free(b, h.states);
  free(h.low);
  free(h.high);
  free(found);
  return text;
}
