/* Two runs of a deck have the same bits: all particles and fields at the end, and the history.
   Include after cmocka.h. */
#ifndef PERILAT_TESTS_SAME_RUNS_H
#define PERILAT_TESTS_SAME_RUNS_H

#include "tests/verification/case.h"

static inline void assert_same_values(const rows *g, const double *x, const double *y, int planes) {
  for (int k = 0; k < planes; k++)
    for (long p = 0; p < g->particle_count; p++) {
      const long at = k * g->size + g->particle_site[p];
      assert_memory_equal(&x[at], &y[at], sizeof(double));
    }
}

static inline void assert_same_bodies(const sweep *x, const sweep *y) {
  const rows *g = x->body->lattice;
  for (int d = 0; d < x->body->dof; d++) {
    assert_same_values(g, x->body->displacement[d], y->body->displacement[d], 1);
    assert_same_values(g, x->body->velocity[d], y->body->velocity[d], 1);
  }
}

static inline void assert_same_fields(const sweep *x, const sweep *y) {
  for (int f = 0; f < x->law->field_count; f++)
    assert_same_values(x->lattice, x->field[f], y->field[f],
                       sweep_planes(x, x->law->fields[f].place));
}

static inline void assert_same_runs(const deck_case *a, const deck_case *b) {
  const double *p, *q;
  const long samples = simulation_history(a->simulation, NULL);
  for (int n = 0; n < a->deck->lattice_count; n++)
    assert_same_bodies(simulation_state(a->simulation, n), simulation_state(b->simulation, n));
  for (int n = 0; n < a->deck->interaction_count; n++)
    assert_same_fields(simulation_law_state(a->simulation, n),
                       simulation_law_state(b->simulation, n));
  assert_int_equal(simulation_history(b->simulation, NULL), samples);
  for (int k = 0; k < simulation_series_count(a->simulation); k++) {
    simulation_series(a->simulation, k, NULL, &p);
    simulation_series(b->simulation, k, NULL, &q);
    assert_memory_equal(p, q, (size_t)samples * sizeof(double));
  }
}

#endif
