#include "generator/check/physics_family.h"

#include "generator/check/physics_family_parts.h"
#include "runtime/base/clock.h"

/* What a more telling check has found already is not said again as net work out of a cycle. */
static bool energy_is_wrong(const family_bench *b) {
  return b->failed[DIAG_STORED_ENERGY] || b->failed[DIAG_CLOSED_PATH] ||
         b->failed[DIAG_DAMAGE_FORCE] || b->failed[DIAG_STIFFNESS] || b->failed[DIAG_REST_FORCE] ||
         b->failed[DIAG_FLOW];
}

static void run_checks(family_bench *b) {
  const double effort = b->options->effort > 0 ? b->options->effort : 1;
  family_check_rest(b);
  if (!b->failed[DIAG_REST_FORCE]) family_check_stiffness(b);
  if (!b->failed[DIAG_STIFFNESS]) family_check_elasticity(b);
  family_check_histories(b, (int)(24 * effort));
  family_check_energy_and_force(b);
  if (!b->failed[DIAG_STIFFNESS]) family_check_energy(b, false);
  if (!b->failed[DIAG_STIFFNESS] && !b->failed[DIAG_CLOSED_PATH] && !b->law->nonconservative)
    family_check_energy(b, true);
  family_check_healing(b);
  if (!energy_is_wrong(b)) family_check_dissipation(b, (int)(5 * effort));
}

static int guards_of(const family_bench *b) {
  return b->step.text.line_count + b->step.text.flow_count;
}

bool physics_check_family(const law *l, const physics_options *o, diagnostics *d,
                          physics_report *report) {
  const double begun = monotonic_seconds();
  const int errors = d->errors;
  family_bench *b = family_bench_new(l, o, d);
  if (b) {
    run_checks(b);
    for (int k = 0; k < guards_of(b); k++) {
      report->guards += b->varies[k];
      report->guards_reached += b->varies[k] && b->seen[k] == 3;
    }
    report->states = b->evaluated;
    family_bench_free(b);
  }
  report->seconds = monotonic_seconds() - begun;
  return d->errors == errors;
}
