#include "tests/benchmark/trial.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/semantics/law_variant.h"
#include "generator/kernel/material_law.h"
#include "generator/plan/plan.h"
#include "generator/run/run.h"
#include "runtime/analysis/material.h"
#include "runtime/deck/deck_read.h"
#include "tests/benchmark/measure.h"

void trial_plate_text(char *text, size_t size, double particles, const char *model_name,
                      const char *simulation_keys, const char *groups) {
  const double side = 10 * sqrt(particles * sqrt(3) / 2); /* mm */
  snprintf(text, size,
           "&simulation %s /\n"
           "&lattice name = 'l' kind = 'hexagonal' spacing = '10 mm' thickness = '100 mm' /\n"
           "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '%.6f mm', '%.6f mm' /\n"
           "&region name = 'left' shape = 'rectangle' corner = 0, 0 size = '10 mm', '%.6f mm' /\n"
           "&region name = 'right' shape = 'rectangle' corner = '%.6f mm', 0 size = '20 mm', '%.6f "
           "mm' /\n"
           "&material lattice = 'l' model = '%s' /\n%s\n",
           simulation_keys, side, side, side, side - 10, side, model_name, groups);
}

void trial_open_model(model *m, const char *name, int neighbours) {
  char path[4096];
  if (strchr(name, '/'))
    snprintf(path, sizeof path, "%s", name);
  else
    snprintf(path, sizeof path, "%s/models/%s.plm", SOURCE_DIR, name);
  bool good = model_open(m, path, NULL, 0);
  if (good) m->law = law_on_lattice(m->law, m->law->setting, false, neighbours);
  good = good && model_plan(m);
  diag_print(&m->said, stderr);
  if (!good) give_up("%s cannot be used", path);
}

/* Marsaglia's xorshift64 (2003). */
void trial_shake(sweep *state) {
  const rows *g = state->body->lattice;
  uint64_t random = UINT64_C(0x9e3779b97f4a7c15);
  for (int d = 0; d < state->body->dimensions; d++)
    for (long q = 0; q < g->size; q++) {
      random ^= random << 13;
      random ^= random >> 7;
      random ^= random << 17;
      if (g->present[q])
        state->body->displacement[d][q] = 1e-5 * g->spacing * (double)(int64_t)random * 0x1p-63;
    }
}

double *trial_parameters(trial *t, const pl_law *kernel) {
  double *parameters = must_calloc((size_t)kernel->parameter_count + 1, sizeof *parameters);
  if (!material_parameters(&t->model.values, kernel, parameters, &t->said)) {
    diag_print(&t->said, stderr);
    give_up("the parameters do not fit the law");
  }
  return parameters;
}

/* The same law once more, which computes everywhere what it needs only where something grows. */
static void plan_everywhere(model *m) {
  const law_variation v = {.everywhere = true};
  const bool families = plan_is_of_families(m->plan);
  plan_free(m->plan);
  m->plan = NULL;
  if (!(families ? model_plan_of_families : model_plan_varying)(m, &v)) give_up("no plan");
}

trial *trial_open(const char *deck_text) {
  return trial_open_kernel(deck_text, false);
}

trial *trial_open_kernel(const char *deck_text, bool everywhere) {
  char error[4096];
  const char *note = NULL;
  trial *t = must_calloc(1, sizeof *t);
  t->memory = arena_new();
  diag_begin(&t->said, &t->sources);
  const int file = source_add(&t->sources, "deck", deck_text, strlen(deck_text));
  t->deck = deck_read(t->memory, &t->sources, file, NULL, 0, &t->said);
  if (t->deck) {
    const char *beside = SOURCE_DIR "/models/trial.nml"; /* where laws are looked for */
    if (!material_law_open(&t->deck->materials[0], &t->deck->lattices[0], beside, &t->model,
                           &t->said)) {
      diag_print(&t->said, stderr);
      give_up("the law of a deck cannot be used");
    }
    if (everywhere) plan_everywhere(&t->model);
    t->law.law = model_kernel(&t->model, false, &note, error, sizeof error);
    if (!t->law.law || note) give_up("%s", note ? note : error);
    t->law.parameters = trial_parameters(t, t->law.law);
    t->run = simulation_new(t->deck, &t->law, &t->said);
  }
  if (!t->run) diag_print(&t->said, stderr);
  if (!t->run) give_up("a deck is faulty");
  trial_shake(simulation_state(t->run, 0));
  return t;
}

void trial_close(trial *t) {
  simulation_free(t->run);
  free(t->law.parameters);
  model_close(&t->model);
  diag_clear(&t->said);
  source_clear(&t->sources);
  arena_free(t->memory);
  free(t);
}
