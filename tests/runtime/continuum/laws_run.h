/* A run with several laws by hand, one for each interaction of its deck, and one for all cracks
   that grow. Include after cmocka.h. */
#ifndef PERILAT_TESTS_LAWS_RUN_H
#define PERILAT_TESTS_LAWS_RUN_H

#include "fracture_law.h"
#include "runtime/simulation/frame_field.h"
#include "tests/runtime/hand_over.h"
#include "tests/runtime/same_runs.h"
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

/* To its end. */
static inline void laws_go(laws_run *c, const pl_law *const *laws, const char *text) {
  laws_open(c, laws, text);
  if (!c->r.simulation) small_print(&c->r);
  assert_non_null(c->r.simulation);
  assert_int_equal(small_go(&c->r), STEP_END);
}

/* With 1, 2 and 3 threads, `run` being what &simulation says beside: the same to the last bit. */
enum { LAWS_RUN_THREADS = 3 };
static inline void laws_go_with_threads(laws_run c[LAWS_RUN_THREADS], const pl_law *const *laws,
                                        const char *run, const char *groups) {
  for (int k = 0; k < LAWS_RUN_THREADS; k++) {
    char text[8192];
    snprintf(text, sizeof text, "&simulation %s threads = %d /\n%s", run, k + 1, groups);
    laws_go(&c[k], laws, text);
    if (k > 0) same_runs(c[0].r.simulation, c[k].r.simulation);
  }
}

/* `s` goes on where `r` is after step `stop`, and ends as `r` does. */
static inline void laws_resume(laws_run *r, laws_run *s, const pl_law *const *laws,
                               const char *text, long stop) {
  laws_open(r, laws, text);
  laws_open(s, laws, text);
  hand_over(r->r.simulation, stop, s->r.simulation);
  small_go(&r->r);
  small_go(&s->r);
  same_runs(r->r.simulation, s->r.simulation);
}

/* values[particles] of a frame now. */
static inline void laws_field(const laws_run *c, const char *name, double *values) {
  const frame_field *fields;
  const int count = simulation_frame_fields(c->r.simulation, &fields);
  for (int k = 0; k < count; k++)
    if (strcmp(fields[k].name, name) == 0) {
      simulation_frame_values(c->r.simulation, k, values);
      return;
    }
  fail_msg("no field %s", name);
}

#endif
