/* A run with several laws by hand, one for each interaction of its deck, and one for all cracks
   that grow. */
#ifndef PERILAT_TESTS_LAWS_RUN_H
#define PERILAT_TESTS_LAWS_RUN_H

#include "fracture_law.h"
#include "tests/runtime/small_run.h"

enum { LAWS_RUN_MOST = 6 };
typedef struct laws_run {
  small_run r;
  double values[LAWS_RUN_MOST][16];
  simulation_law laws[LAWS_RUN_MOST + SMALL_CRACKS];
} laws_run;

/* r.simulation stays NULL on errors. */
static inline void laws_open(laws_run *c, const pl_law *const *laws, const char *text) {
  small_run *r = &c->r;
  memset(c->laws, 0, sizeof c->laws);
  small_read(r, text);
  if (!r->deck) return;
  for (int n = 0; n < r->deck->interaction_count; n++) {
    if (!material_parameters(r->deck->interactions[n].material, laws[n], c->values[n], &r->said))
      return;
    c->laws[n] = (simulation_law){.law = laws[n], .parameters = c->values[n]};
  }
  for (int k = 0; k < r->deck->crack_count; k++) {
    const int number = r->deck->interaction_count + k;
    const deck_material *m = &r->deck->cracks[k].material;
    if (!m->model || !material_parameters(m, &fracture_law, c->values[number], &r->said)) continue;
    c->laws[number] = (simulation_law){.law = &fracture_law, .parameters = c->values[number]};
  }
  r->simulation = simulation_new(r->deck, c->laws, &r->said);
}

#endif
