/* A run of several lattices of one law by hand. */
#ifndef PERILAT_TESTS_SMALL_BODIES_H
#define PERILAT_TESTS_SMALL_BODIES_H

#include "tests/runtime/small_run.h"

enum { SMALL_BODIES = 3 };

typedef struct small_bodies {
  small_run run;
  simulation_law law[SMALL_BODIES];
  double parameters[SMALL_BODIES][ELASTIC_PARAMETERS];
} small_bodies;

static inline void small_bodies_open(small_bodies *b, const pl_law *law, const char *text) {
  small_run *r = &b->run;
  memset(b, 0, sizeof *b);
  small_read(r, text);
  for (int n = 0; r->deck && n < r->deck->lattice_count; n++) {
    assert_true(material_parameters(&r->deck->materials[n], law, b->parameters[n], &r->said));
    b->law[n] = (simulation_law){.law = law, .parameters = b->parameters[n]};
  }
  if (r->deck) r->simulation = simulation_new(r->deck, b->law, &r->said);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

static inline void small_bodies_close(small_bodies *b) {
  small_close(&b->run);
}

#endif
