#include "runtime/parts/step_choice.h"

#include <math.h>

#include "dsl/base/elementary.h"
#include "runtime/analysis/stability.h"
#include "runtime/parts/law_fits.h"

static bool is_stable_at_rest(const step_limit *limit, const pl_law *law, span where,
                              diagnostics *d) {
  if (stability_at_rest(limit)) return true;
  diag_report(d, DIAG_STIFFNESS, where,
              "the virgin body is unstable at rest: by the law `%s` a small motion pushes its "
              "particles on (smallest eigenvalue of its stiffness %.3g of the largest)",
              law->name, limit->least);
  diag_hint(d, "a bond that is longer pulls its ends together: look at the signs, and at what the "
               "law takes for lengths and volumes of this lattice");
  return false;
}

bool step_fits(const deck *k, const step_limit *limit, diagnostics *d) {
  const double end = k->simulation.end_time;
  if (k->relaxation.increments > 0 || limit->step <= end) return true;
  diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&k->simulation.item, "end_time"),
              "the run of %.4g s is shorter than one step of %.4g s", end, limit->step);
  diag_hint(d, "give a later `end_time`, a shorter `step`, or look at the units of stiffness and "
               "density");
  return false;
}

bool step_limit_check(const deck *k, span where, const pl_law *law, const step_limit *limit,
                      diagnostics *d) {
  if (!is_stable_at_rest(limit, law, where, d)) return false;
  if (limit->limit > 0) return true;
  diag_report(d, DIAG_UNSTABLE_STEP, k->simulation.item.where,
              "the law `%s` has no finite stiffness at rest, so that no step is stable", law->name);
  diag_hint(d,
            "look for a division by zero or a root where stretch, rotations and states are all 0");
  return false;
}

bool step_limit_of(const deck *k, int lattice, const pl_law *law, const double *parameters,
                   const parameter_planes *fields, const rows *w, step_limit *limit,
                   diagnostics *d) {
  stability_limit(law, parameters, fields, w, limit);
  return step_limit_check(k, law_fits_where(k, lattice), law, limit, d);
}

bool step_choose(const deck *of, const pl_law *law, const char *lattice, step_limit *limit,
                 diagnostics *d) {
  const deck_simulation *k = &of->simulation;
  const double most = limit->limit;
  if (k->step > most) {
    diag_report(d, DIAG_UNSTABLE_STEP, deck_where(&k->item, "step"),
                "a step of %.6g s is unstable: the largest stable one%s%s%s is %.6g s", k->step,
                lattice ? " of `" : "", lattice ? lattice : "", lattice ? "`" : "", most);
    diag_hint(d, "leave `step` away to have it chosen: %.2g of the limit, %.4g s", k->step_safety,
              k->step_safety * most);
    return false;
  }
  limit->step = k->step > 0 ? k->step : k->step_safety * most;
  if (isfinite(limit->step) && limit->step > 0) return true;
  diag_report(d, DIAG_UNSTABLE_STEP, k->item.where,
              "the law `%s` has no stiffness to choose a step from", law->name);
  diag_hint(d, "give `step` in &simulation");
  return false;
}

/* A sample at the start, and after each increment. */
static bool count_increments(const deck *of, step_plan *plan) {
  const deck_relaxation *k = &of->relaxation;
  plan->step_count = INT64_C(1) << 60; /* as many as it takes */
  plan->sample_interval = of->simulation.end_time / k->increments;
  plan->history_capacity = k->increments + 3;
  return true;
}

/* Unless the deck asks for more: a sample takes up to four steps, so that these take less than 2 %
   of a run. */
enum { STEPS_A_SAMPLE = 200 };

bool step_plan_make(const deck *k, const step_limit *limit, step_plan *plan, diagnostics *d) {
  static const double most = 1e12;
  if (k->relaxation.increments > 0) return count_increments(k, plan);
  const double end = k->simulation.end_time, steps = ceil(end / limit->step - 1e-9);
  if (!(steps <= most)) {
    diag_report(d, DIAG_BAD_VALUE, deck_where(&k->simulation.item, "end_time"),
                "the run would take %.3g steps of %.3g s; the most is %.0e", steps, limit->step,
                most);
    diag_hint(d, "does `end_time` have the unit that is meant? What is loaded slowly is computed "
                 "without waves: with `&relaxation`, or a mesh with `&static`");
    return false;
  }
  plan->step_count = steps < 1 ? 1 : (int64_t)steps;
  const double asked = k->output.sample;
  plan->sample_interval = asked > 0 ? pl_fmax(asked, limit->step) /* no more than a sample a step */
                                    : pl_fmax(end / 2000, STEPS_A_SAMPLE * limit->step);
  const double samples = pl_fmin(ceil(end / plan->sample_interval), steps);
  plan->history_capacity = (int64_t)samples + 3;
  return true;
}
