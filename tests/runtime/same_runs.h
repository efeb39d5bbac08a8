/* For tests: two runs that came the same way, to the last bit. Include after cmocka.h. */
#ifndef PERILAT_TESTS_SAME_RUNS_H
#define PERILAT_TESTS_SAME_RUNS_H

#include "runtime/interaction/sweep.h"
#include "runtime/simulation/simulation_state.h"

/* Places, velocities and fields of a body or a link. */
static inline void same_states(const sweep *x, const sweep *y) {
  const rows *g = x->lattice;
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    for (int d = 0; d < x->body->dof; d++) {
      assert_true(x->body->displacement[d][q] == y->body->displacement[d][q]);
      assert_true(x->body->velocity[d][q] == y->body->velocity[d][q]);
    }
    for (int f = 0; f < x->law->field_count; f++)
      for (long k = 0; k < sweep_planes(x, x->law->fields[f].place); k++)
        assert_true(x->field[f][k * g->size + q] == y->field[f][k * g->size + q]);
  }
}

/* And all histories. */
static inline void same_runs(const simulation *a, const simulation *b) {
  const double *p, *q;
  const long samples = simulation_history(a, NULL);
  assert_int_equal(simulation_history(b, NULL), samples);
  assert_int_equal(a->law_count, b->law_count);
  for (int n = 0; n < a->law_count; n++)
    same_states(a->laws[n].state, b->laws[n].state);
  for (int k = 0; k < simulation_series_count(a); k++) {
    simulation_series(a, k, NULL, &p);
    simulation_series(b, k, NULL, &q);
    assert_memory_equal(p, q, (size_t)samples * sizeof(double));
  }
}

#endif
