/* How long a step is, how many there are, and at which of them samples are taken. */
#ifndef PERILAT_RUNTIME_STEP_CHOICE_H
#define PERILAT_RUNTIME_STEP_CHOICE_H

#include "dsl/base/diagnostics.h"
#include "runtime/analysis/step_limit.h"
#include "runtime/deck/deck.h"
#include "runtime/kernel.h"
#include "runtime/lattice/parameter_planes.h"
#include "runtime/lattice/rows.h"

typedef struct step_plan {
  int64_t step_count;
  double sample_interval;   /* s */
  int64_t history_capacity; /* samples, at most */
} step_plan;

/* The stable step of the virgin body. False with a diagnostic where none is stable. */
bool step_limit_of(const deck *k, int lattice, const pl_law *law, const double *parameters,
                   const parameter_planes *fields, const rows *w, step_limit *limit,
                   diagnostics *d);
/* The same of a limit that is known, and a law that stands at that place of the deck. */
bool step_limit_check(const deck *k, span where, const pl_law *law, const step_limit *limit,
                      diagnostics *d);
/* limit->step, the deck's part of the shortest of these limits. It is that of `law`, and of
   `lattice` where there are others, too (else NULL). */
bool step_choose(const deck *k, const pl_law *law, const char *lattice, step_limit *limit,
                 diagnostics *d);
/* False with a diagnostic where a dynamic run is shorter than a step; the time of others is only an
   order. */
bool step_fits(const deck *k, const step_limit *limit, diagnostics *d);
/* False with a diagnostic where there are too many steps. */
bool step_plan_make(const deck *k, const step_limit *limit, step_plan *plan, diagnostics *d);

#endif
