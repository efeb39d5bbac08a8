#include "generator/check/physics_parameters.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "dsl/semantics/law_limits.h"
#include "dsl/semantics/law_reads.h"
#include "generator/ir/random_values.h"
#include "runtime/deck/lattice_kind.h"

/* Something in the middle of the bounds for a parameter that has no default. */
static double middle(const symbol *p, double low, double high) {
  double usual = 1;
  dimension stress = {{-12, 12, -24, 0}}, density = {{-36, 12, 0, 0}};
  if (dim_equal(p->dim, stress)) usual = 1e9;
  if (dim_equal(p->dim, density)) usual = 2000;
  if (isfinite(low) && isfinite(high)) return 0.5 * (low + high);
  if (isfinite(low) && usual <= low) return low + (fabs(low) > 0 ? fabs(low) : 1);
  if (isfinite(high) && usual >= high) return high - (fabs(high) > 0 ? fabs(high) : 1);
  return usual;
}

static void start_values(const law *l, double *values) {
  for (int p = 0; p < l->parameters.count; p++) {
    const symbol *s = l->parameters.items[p];
    values[p] = s->initial;
  }
  for (int p = 0; p < l->parameters.count; p++) {
    const law_limits in = law_parameter_limits(l, p, values);
    if (!l->parameters.items[p]->has_default)
      values[p] = middle(l->parameters.items[p], in.lower, in.upper);
  }
}

static double vary(uint64_t *seed, double value, double low, double high) {
  double drawn = value * pl_pow(2, draw_uniform(seed, -1, 1));
  bool off = draw_bits(seed) % 2;
  if (value == 0 && !off)
    return 0; /* what is switched off by default is switched on in half of the draws */
  if (value == 0 && isfinite(high))
    drawn = draw_uniform(seed, isfinite(low) ? low : -high, high);
  else if (value == 0)
    drawn = pl_pow(10, draw_uniform(seed, -3, 0));
  return pl_fmin(pl_fmax(drawn, low), high);
}

static bool all_within(const law *l, const double *values) {
  char text[64];
  for (int p = 0; p < l->parameters.count; p++)
    if (!law_parameter_within(l, p, values, text, sizeof text)) return false;
  return true;
}

static void draw_values(const law *l, uint64_t *seed, double *values) {
  int n = l->parameters.count;
  double *start = must_calloc((size_t)n + 1, sizeof *start);
  memcpy(start, values, (size_t)n * sizeof *start);
  for (int p = 0; p < n; p++) {
    const law_limits in = law_parameter_limits(l, p, values);
    if (symbol_is_field(l->parameters.items[p])) continue; /* a temperature has its usual value */
    values[p] = vary(seed, start[p], in.lower, in.upper);
  }
  /* Open ends and relations between parameters: back toward the defaults until all hold. */
  for (int back = 0; back < 40 && !all_within(l, values); back++)
    for (int p = 0; p < n; p++)
      values[p] = start[p] + (back < 39 ? 0.7 * (values[p] - start[p]) : 0);
  free(start);
}

void physics_draw_parameters(const law *l, uint64_t *seed, double *values) {
  start_values(l, values);
  if (seed) draw_values(l, seed, values);
}

deck_lattice physics_usual_lattice(const law *l) {
  const char *setting = law_setting_name(l->setting);
  return law_reads(l, QUANTITY_AREA) ? lattice_default_bars(setting, 0.01, 1e-4)
                                     : lattice_default(setting, 0.01, 0.1);
}
