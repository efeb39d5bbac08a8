/* For verification: a law of models/ with both its readers, lattices and whole runs made from it,
   without files in between. */
#ifndef PERILAT_TESTS_CASE_H
#define PERILAT_TESTS_CASE_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/semantics/law_variant.h"
#include "generator/interpreter/interpreted.h"
#include "generator/kernel/material_law.h"
#include "generator/kernel/model.h"
#include "generator/plan/plan.h"
#include "generator/run/run.h"
#include "runtime/deck/deck_read.h"
#include "runtime/filling/lattice.h"
#include "runtime/interaction/pairwise.h"
#include "runtime/simulation/simulation.h"

/* A law as the interpreter and as the compiled kernel have it, with one set of parameters. */
typedef struct law_case {
  model model;
  const pl_law *compiled;
  pl_law *interpreted;
  double *parameters;
} law_case;

static inline bool law_case_read(law_case *c, const char *name) {
  char path[4096];
  snprintf(path, sizeof path, "%s/models/%s.plm", SOURCE_DIR, name);
  memset(c, 0, sizeof *c);
  if (model_open(&c->model, path, NULL, 0)) return true;
  diag_print(&c->model.said, stderr);
  return false;
}

static inline bool law_case_compile(law_case *c) {
  char error[4096];
  const char *note;
  if (!model_plan(&c->model)) {
    diag_print(&c->model.said, stderr);
    return false;
  }
  c->compiled = model_kernel(&c->model, false, &note, error, sizeof error);
  if (!c->compiled) fprintf(stderr, "%s\n", error);
  c->interpreted = plan_interpreted(c->model.plan);
  c->parameters = calloc((size_t)c->interpreted->parameter_count + 1, sizeof *c->parameters);
  for (int p = 0; p < c->interpreted->parameter_count; p++)
    c->parameters[p] = c->interpreted->parameters[p].initial;
  return c->compiled != NULL && note == NULL;
}

static inline bool law_case_open(law_case *c, const char *name) {
  return law_case_read(c, name) && law_case_compile(c);
}

/* The same for a lattice in this setting. */
static inline bool law_case_open_in(law_case *c, const char *name, law_setting setting) {
  if (!law_case_read(c, name)) return false;
  c->model.law = law_on_lattice(c->model.law, setting, false, 0);
  return law_case_compile(c);
}

static inline void law_case_close(law_case *c) {
  free(c->parameters);
  if (c->interpreted) plan_interpreted_free(c->interpreted);
  model_close(&c->model);
}

/* The place of a parameter's value; ends the test when there is none of that name. */
static inline double *law_case_value(law_case *c, const char *name) {
  for (int p = 0; p < c->interpreted->parameter_count; p++)
    if (strcmp(c->interpreted->parameters[p].name, name) == 0) return &c->parameters[p];
  fprintf(stderr, "no parameter %s\n", name);
  abort();
}

enum { DECK_CASE_LAWS = 12 };
/* A deck read from text or file, and the lattice or the run that it describes. */
typedef struct deck_case {
  arena *memory;
  source_set sources;
  diagnostics said;
  const deck *deck;
  rows *lattice;      /* of deck_case_lattice */
  model model;        /* of deck_case_run */
  simulation_law law; /* of deck_case_run: the first */
  /* of the deck's other interactions */
  model more_models[DECK_CASE_LAWS];
  simulation_law laws[DECK_CASE_LAWS];
  simulation *simulation;
} deck_case;

static inline bool deck_case_read(deck_case *c, const char *name, const char *text,
                                  const char *const *overrides, int count) {
  deck_override list[32];
  memset(c, 0, sizeof *c);
  c->memory = arena_new();
  diag_begin(&c->said, &c->sources);
  for (int k = 0; k < count && k < 32; k++)
    list[k].text = overrides[k];
  const int file = source_add(&c->sources, name, text, strlen(text));
  c->deck = deck_read(c->memory, &c->sources, file, list, count, &c->said);
  if (c->said.errors) diag_print(&c->said, stderr);
  return c->deck != NULL;
}

/* Only the lattice of the deck. */
static inline bool deck_case_lattice(deck_case *c, const char *text) {
  if (!deck_case_read(c, "lattice.nml", text, NULL, 0)) return false;
  c->lattice = lattice_build(c->deck, 0, &c->said);
  if (c->said.errors) diag_print(&c->said, stderr);
  return c->lattice != NULL;
}

static inline double *deck_case_parameters(deck_case *c, const pl_law *kernel,
                                           const deck_material *values) {
  double *parameters = calloc((size_t)kernel->parameter_count + 1, sizeof *parameters);
  if (material_parameters(values, kernel, parameters, &c->said)) return parameters;
  free(parameters);
  return NULL;
}

static inline bool deck_case_regions(deck_case *c, const deck_material *m, const model *of,
                                     simulation_law *into) {
  into->regional = calloc((size_t)m->regional_count + 1, sizeof *into->regional);
  for (int k = 0; k < m->regional_count; k++) {
    deck_material values;
    if (!material_law_regional(m->regional[k], of, c->memory, &values, &c->said)) return false;
    double *parameters = deck_case_parameters(c, into->law, &values);
    if (!parameters) return false;
    into->regional[into->regional_count++] = (regional_values){m->regional[k], parameters};
  }
  return true;
}

/* The compiled kernel of a material and its parameters; `on` is NULL of a crack's. */
static inline bool deck_case_kernel(deck_case *c, const deck_material *m, const deck_lattice *on,
                                    const char *path, model *opened, simulation_law *into) {
  const char *note;
  char error[4096];
  if (!m || !material_law_open(m, on, path, opened, &c->said)) return false;
  into->law = model_kernel(opened, false, &note, error, sizeof error);
  if (!into->law) return false;
  into->parameters = deck_case_parameters(c, into->law, &opened->values);
  return into->parameters != NULL;
}

static inline bool deck_case_law(deck_case *c, const deck_interaction *of, const char *path,
                                 model *opened, simulation_law *into) {
  return deck_case_kernel(c, of->material, &c->deck->lattices[of->lattice], path, opened, into) &&
         deck_case_regions(c, of->material, opened, into);
}

/* A simulation of the deck with the compiled kernels of its own laws. */
static inline bool deck_case_start(deck_case *c, const char *path) {
  bool good = c->deck->interaction_count + c->deck->crack_count <= DECK_CASE_LAWS &&
              deck_case_law(c, c->deck->interactions, path, &c->model, &c->law);
  for (int n = 1; n < c->deck->interaction_count && good; n++)
    good = deck_case_law(c, &c->deck->interactions[n], path, &c->more_models[n], &c->laws[n]);
  for (int k = 0; k < c->deck->crack_count && good; k++) {
    const int n = c->deck->interaction_count + k;
    if (c->deck->cracks[k].model)
      good = deck_case_kernel(c, &c->deck->cracks[k].material, NULL, path, &c->more_models[n],
                              &c->laws[n]);
  }
  c->laws[0] = c->law;
  if (good) c->simulation = simulation_new(c->deck, c->laws, &c->said);
  if (c->said.errors) diag_print(&c->said, stderr);
  return c->simulation != NULL;
}

static inline bool deck_case_text(deck_case *c, const char *text) {
  return deck_case_read(c, "case.nml", text, NULL, 0) &&
         deck_case_start(c, SOURCE_DIR "/models/case.nml");
}

/* The same, or the test ends here. */
static inline void deck_case_open(deck_case *c, const char *text) {
  if (deck_case_text(c, text)) return;
  diag_print(&c->model.said, stderr);
  fprintf(stderr, "%s\n", text);
  abort();
}

/* A deck of the repository, named from its root, with overrides as of --set. */
static inline bool deck_case_run(deck_case *c, const char *name, const char *const *overrides,
                                 int count) {
  char path[4096], error[1024];
  size_t length;
  snprintf(path, sizeof path, "%s/%s", SOURCE_DIR, name);
  char *text = read_text_file(path, 1 << 20, &length, error, sizeof error);
  if (!text) {
    fprintf(stderr, "%s\n", error);
    return false;
  }
  const bool good = deck_case_read(c, path, text, overrides, count) && deck_case_start(c, path);
  free(text);
  return good;
}

static inline step_status deck_case_go(deck_case *c) {
  step_status status;
  do
    status = simulation_advance(c->simulation, 1L << 40, NULL);
  while (status == STEP_OK);
  return status;
}

static inline void deck_case_close(deck_case *c) {
  if (c->simulation) simulation_free(c->simulation);
  for (int n = 0; n < DECK_CASE_LAWS; n++) {
    const simulation_law *of = n ? &c->laws[n] : &c->law;
    free(of->parameters);
    for (int k = 0; k < of->regional_count; k++)
      free(of->regional[k].parameters);
    free(of->regional);
    if (c->more_models[n].memory) model_close(&c->more_models[n]);
  }
  if (c->model.memory) model_close(&c->model);
  if (c->lattice) rows_free(c->lattice);
  diag_clear(&c->said);
  source_clear(&c->sources);
  arena_free(c->memory);
}

/* Samples of a series of the history, [simulation_history]. */
static inline const double *deck_case_series(const deck_case *c, const char *name) {
  const double *values;
  for (int k = 0; k < simulation_series_count(c->simulation); k++)
    if (strcmp(simulation_series(c->simulation, k, NULL, &values), name) == 0) return values;
  fprintf(stderr, "no series %s\n", name);
  abort();
}

static inline double deck_case_last(const deck_case *c, const char *name) {
  return deck_case_series(c, name)[simulation_history(c->simulation, NULL) - 1];
}

/* Whether kinetic and stored energy together were never so many times what they are first. */
static inline bool deck_case_stays_below(const deck_case *c, double times) {
  const double *kinetic = deck_case_series(c, "energy/kinetic"),
               *stored = deck_case_series(c, "energy/stored");
  const double most = times * (kinetic[0] + stored[0]);
  for (long k = 0; k < simulation_history(c->simulation, NULL); k++)
    if (!(kinetic[k] + stored[k] < most)) return false;
  return true;
}

/* The largest size of a series so far. */
static inline double deck_case_largest(const deck_case *c, const char *name) {
  const double *values = deck_case_series(c, name);
  double most = 0;
  for (long k = 0; k < simulation_history(c->simulation, NULL); k++)
    most = fmax(most, fabs(values[k]));
  return most;
}

/* Index of the largest value. */
static inline long largest_of(const double *values, long count) {
  long at = 0;
  for (long k = 1; k < count; k++)
    if (values[k] > values[at]) at = k;
  return at;
}

/* Bond forces of the state, a plane at a time: force[plane][direction * size + site of the owner].
   0 where there is no bond. The fields keep their values. */
static inline void all_bond_forces(sweep *w, double *force[4]) {
  const rows *g = w->body->lattice;
  const pl_law *kernel = w->law;
  double *fields = calloc((size_t)(kernel->field_count * g->pitch) + 1, sizeof *fields);
  for (int r = 0; r < g->row_count; r++)
    for (int k = 0; k < g->directions && w->body->count[r] > 0; k++) {
      const long near = rows_start(g, r) + w->body->begin[r], far = near + rows_offset(g, r, k);
      double *field[16], *planes[PL_MAX_PLANES];
      for (int f = 0; f < kernel->field_count; f++) {
        field[f] = fields + f * g->pitch;
        memcpy(field[f], w->field[f] + k * g->size + near,
               (size_t)w->body->count[r] * sizeof(double));
      }
      for (int p = 0; p < kernel->force_planes; p++)
        planes[p] = force[p] + k * g->size + near;
      pl_strip s = {.size = sizeof(pl_strip),
                    .count = w->body->count[r],
                    .direction = k,
                    .flags = pairwise_flags(w, r),
                    .field = field,
                    .force = planes,
                    .time_step = w->body->time_step};
      for (int d = 0; d < w->body->dof; d++) {
        s.displacement_i[d] = w->body->displacement[d] + near;
        s.displacement_j[d] = w->body->displacement[d] + far;
        s.velocity_i[d] = w->body->velocity[d] + near;
        s.velocity_j[d] = w->body->velocity[d] + far;
      }
      kernel->rows(kernel, pairwise_uniforms(w, k), &s);
    }
  free(fields);
}

#endif
