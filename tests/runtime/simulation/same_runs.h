/* Two runs of one deck that must have come to the same, bit by bit. */
#ifndef PERILAT_TESTS_SAME_RUNS_H
#define PERILAT_TESTS_SAME_RUNS_H

#include "runtime/interaction/sweep.h"
#include "tests/runtime/small_run.h"

/* Steps, motion, fields and histories. */
static inline void same_runs(const small_run *a, const small_run *b) {
  const sweep *x = simulation_state(a->simulation, 0), *y = simulation_state(b->simulation, 0);
  const size_t site = (size_t)x->body->lattice->size * sizeof(double);
  assert_int_equal(simulation_step_done(a->simulation), simulation_step_done(b->simulation));
  assert_int_equal(x->body->lattice->size, y->body->lattice->size);
  for (int d = 0; d < x->body->dof; d++) {
    assert_memory_equal(x->body->displacement[d], y->body->displacement[d], site);
    assert_memory_equal(x->body->velocity[d], y->body->velocity[d], site);
  }
  for (int f = 0; f < x->law->field_count; f++) {
    const size_t planes = (size_t)sweep_planes(x, (int)x->law->fields[f].place);
    assert_memory_equal(x->field[f], y->field[f], planes * site);
  }
  const double *p, *q;
  const long samples = simulation_history(a->simulation, &p);
  assert_int_equal(simulation_history(b->simulation, &q), samples);
  assert_memory_equal(p, q, (size_t)samples * sizeof(double));
  for (int k = 0; k < simulation_series_count(a->simulation); k++) {
    simulation_series(a->simulation, k, NULL, &p);
    simulation_series(b->simulation, k, NULL, &q);
    assert_memory_equal(p, q, (size_t)samples * sizeof(double));
  }
}

/* The run to its end, of a body whose law takes nothing: all that comes in goes somewhere, and what
   stretches of 1e-5 leave is of their second order in time. */
static inline void loses_nothing(small_run *r) {
  assert_int_equal(small_go(r), STEP_END);
  const double external = small_largest(r, "energy/external");
  assert_true(external > 1e-3 && small_largest(r, "energy/stored") > 0.1 * external);
  assert_true(small_largest(r, "energy/dissipated_damping") > 1e-3 * external);
  print_message("imbalance %.1e, taken by the law %.1e of the work\n",
                small_largest(r, "energy/imbalance") / external,
                small_largest(r, "energy/dissipated_damage") / external);
  assert_true(small_largest(r, "energy/imbalance") <= 1e-12 * external);
  assert_true(small_largest(r, "energy/dissipated_damage") <= 1e-6 * external);
}

#endif
