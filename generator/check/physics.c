#include "generator/check/physics.h"

#include <stdint.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "generator/check/physics_family.h"
#include "generator/check/physics_parts.h"
#include "runtime/base/clock.h"

/* What a more telling check has found already is not said again as net work out of a cycle. */
static bool energy_is_wrong(const physics *p) {
  return p->failed[DIAG_STORED_ENERGY] || p->failed[DIAG_CLOSED_PATH] ||
         p->failed[DIAG_DAMAGE_FORCE] || p->failed[DIAG_STIFFNESS] || p->failed[DIAG_REST_FORCE] ||
         p->failed[DIAG_FLOW] || p->failed[DIAG_EXCHANGE] || p->failed[DIAG_MIRROR];
}

static void run_checks(physics *p) {
  const double effort = p->b.options->effort > 0 ? p->b.options->effort : 1;
  const int rays = (int)(48 * effort), legs = (int)(12 * effort);
  bench *b = &p->b;
  bench_allow(b, 0.05);
  physics_check_rest(p);
  if (!p->failed[DIAG_REST_FORCE]) physics_check_stiffness(p);
  bench_allow(b, 0.15);
  physics_scan(p, rays, true);
  bench_allow(b, 0.1);
  physics_histories(p, legs);
  bench_allow(b, 0.1);
  physics_scan(p, rays, false);
  bench_allow(b, 0.1);
  physics_histories(p, legs);
  bench_allow(b, 0.1);
  physics_check_energy_and_force(p);
  physics_check_tangent(p, 0);
  bench_allow(b, 0.1);
  if (!p->failed[DIAG_STIFFNESS]) physics_check_stored_energy(p);
  if (!p->failed[DIAG_STIFFNESS] && !p->failed[DIAG_STORED_ENERGY]) physics_check_damage_force(p);
  bench_allow(b, 0.1);
  if (!p->failed[DIAG_FLOW]) physics_check_hold(p);
  bench_allow(b, 2); /* some hundred states of usual laws */
  physics_check_healing(p);
  bench_allow(b, 0.15);
  physics_check_closed_path(p);
  bench_allow(b, 0.25);
  if (!energy_is_wrong(p)) physics_check_dissipation(p);
}

/* A guard of the law's text, and how it was seen. */
typedef struct seen_guard {
  lowered_line of;
  unsigned char seen; /* 1: false, 2: true */
} seen_guard;

static int by_line(const void *a, const void *b) {
  const lowered_line *x = &((const seen_guard *)a)->of, *y = &((const seen_guard *)b)->of;
  const uintptr_t of_x = (uintptr_t)x->cases, of_y = (uintptr_t)y->cases;
  return of_x != of_y ? (of_x < of_y ? -1 : 1) : x->line - y->line;
}

/* Guards of one line count once, however often its function is called. */
static void count_guards(const bench *b, physics_report *report) {
  const lowered_text *t = &b->law_step.text;
  seen_guard *guards = must_alloc(((size_t)t->line_count + 1) * sizeof *guards);
  int count = 0;
  for (int k = 0; k < t->line_count; k++)
    if (b->varies[k]) guards[count++] = (seen_guard){t->lines[k], b->seen[k]};
  qsort(guards, (size_t)count, sizeof *guards, by_line);
  for (int k = 0; k < count;) {
    const int first = k;
    unsigned char seen = 0;
    for (; k < count && by_line(&guards[first], &guards[k]) == 0; k++)
      seen |= guards[k].seen;
    report->guards++;
    report->guards_reached += seen == 3;
  }
  free(guards);
  for (int k = t->line_count; k < b->guards.count; k++) {
    report->guards += b->varies[k];
    report->guards_reached += b->varies[k] && b->seen[k] == 3;
  }
}

bool physics_check(const law *l, const physics_options *o, diagnostics *d, physics_report *report) {
  static const physics_options usual = {0};
  double begun = monotonic_seconds();
  int errors = d->errors;
  physics_report unwanted;
  report = report ? report : &unwanted;
  *report = (physics_report){0};
  if (l->tree->law == LAW_STATE) return physics_check_family(l, o ? o : &usual, d, report);
  physics *p = must_calloc(1, sizeof *p);
  p->said = d;
  if (bench_open(&p->b, l, o ? o : &usual, d)) {
    p->pool = must_alloc((size_t)POOL_MOST * (size_t)p->b.width * sizeof *p->pool);
    run_checks(p);
    count_guards(&p->b, report);
    report->states = p->b.evaluated;
    free(p->pool);
    bench_close(&p->b);
  }
  free(p);
  report->seconds = monotonic_seconds() - begun;
  return d->errors == errors;
}
