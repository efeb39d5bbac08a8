/* For tests: from the text of a law to its plan on the interpreter. */
#ifndef PERILAT_TESTS_LAW_TEXT_H
#define PERILAT_TESTS_LAW_TEXT_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/semantics/law_check.h"
#include "dsl/syntax/parse.h"
#include "generator/interpreter/interpreted.h"
#include "generator/plan/plan.h"

typedef struct tested_law {
  arena *memory;
  source_set sources;
  diagnostics said;
  law *law;
  kernel_plan *plan; /* NULL when the law could not be planned; then `said` has the reason */
  pl_law *kernel;
  double *parameters, *uniforms;
} tested_law;

/* A bond of the notched beam, 6.35 mm, lattice turned by 17 degrees. */
static inline pl_bond_class tested_bond(void) {
  const double s = 6.35e-3, t = 0.1524, turn = 17 * acos(-1.0) / 180;
  pl_bond_class b = {.size = sizeof b,
                     .s = s,
                     .spacing = s,
                     .t = t,
                     .V = sqrt(3.0) / 2 * s * s * t,
                     .area = 1e-4,
                     .shell = 1,
                     .n = 6,
                     .chord = {s * cos(turn), s * sin(turn), 0}};
  b.mass_i = 2323 * b.V;
  b.mass_j = 1.5 * b.mass_i;
  return b;
}

static inline tested_law *open_law_chosen(const char *text, const law_choice *choices, int count) {
  tested_law *t = calloc(1, sizeof *t);
  t->memory = arena_new();
  diag_begin(&t->said, &t->sources);
  int file = source_add(&t->sources, "test.plm", text, strlen(text));
  parse_options options = {NULL, NULL};
  tree *parsed = parse_model(t->memory, &t->sources, file, &options, &t->said);
  if (parsed && !t->said.errors)
    t->law = law_check(t->memory, parsed, &t->sources, choices, count, &t->said);
  if (t->said.errors) diag_print(&t->said, stderr);
  if (!t->law) return t;
  t->plan = plan_kernel(t->law, &t->said);
  if (!t->plan) return t;
  t->kernel = plan_interpreted(t->plan);
  t->parameters = calloc((size_t)t->kernel->parameter_count + 1, sizeof(double));
  t->uniforms = calloc((size_t)t->kernel->uniform_count + 1, sizeof(double));
  for (int k = 0; k < t->kernel->parameter_count; k++)
    t->parameters[k] = t->kernel->parameters[k].initial;
  pl_bond_class bond = tested_bond();
  t->kernel->prepare(t->kernel, t->parameters, &bond, t->uniforms);
  return t;
}

static inline tested_law *open_law(const char *text) {
  return open_law_chosen(text, NULL, 0);
}

static inline tested_law *open_law_file(const char *path) {
  FILE *in = fopen(path, "rb");
  if (!in) return NULL;
  char *text = calloc(1, 1 << 20);
  size_t length = fread(text, 1, (1 << 20) - 1, in);
  fclose(in);
  text[length] = 0;
  tested_law *t = open_law(text);
  free(text);
  return t;
}

static inline void close_law(tested_law *t) {
  plan_interpreted_free(t->kernel);
  plan_free(t->plan);
  free(t->parameters);
  free(t->uniforms);
  diag_clear(&t->said);
  source_clear(&t->sources);
  arena_free(t->memory);
  free(t);
}

enum { MOST_FIELDS = 8 };

/* Inputs and results of one state. */
typedef struct tested_state {
  double stretch, rate, theta_i, theta_j, dt;
  double field[MOST_FIELDS];
  double N, M_i, M_j;
  double new_field[MOST_FIELDS];
  double tangent[PL_TANGENTS];
} tested_state;

static inline void evaluate_law(const tested_law *t, tested_state *x, int with_tangent) {
  double length = tested_bond().s * (1 + x->stretch), result[PL_STATE_RESULTS];
  static const char *const names[] = {"stretch", "stretch_rate", "theta_i",
                                      "theta_j", "length",       "dt"};
  const double *in[] = {&x->stretch, &x->rate, &x->theta_i, &x->theta_j, &length, &x->dt};
  assert_int_equal(t->kernel->state_input_count, PL_STATE_INPUTS);
  for (int k = 0; k < PL_STATE_INPUTS; k++)
    assert_string_equal(t->kernel->state_inputs[k].name, names[k]);
  const double *field[MOST_FIELDS];
  double *out[PL_TANGENTS], *new_field[MOST_FIELDS];
  for (int k = 0; k < MOST_FIELDS; k++) {
    field[k] = &x->field[k];
    new_field[k] = &x->new_field[k];
  }
  for (int k = 0; k < PL_STATE_RESULTS; k++)
    out[k] = &result[k];
  const pl_states s = {
      .size = sizeof s, .count = 1, .in = in, .field = field, .out = out, .new_field = new_field};
  t->kernel->states(t->kernel, t->uniforms, &s);
  x->N = result[0];
  x->M_i = result[1];
  x->M_j = result[2];
  for (int k = 0; k < PL_TANGENTS; k++)
    out[k] = &x->tangent[k];
  if (with_tangent) t->kernel->tangent(t->kernel, t->uniforms, &s);
}

/* --- random numbers --------------------------------------------------------------------------- */

static inline double random_uniform(uint64_t *seed, double low, double high) {
  *seed ^= *seed << 13;
  *seed ^= *seed >> 7;
  *seed ^= *seed << 17;
  return low + (high - low) * (double)(*seed >> 11) * 0x1p-53;
}

/* Of either sign, with a size spread evenly over the decades. */
static inline double random_spread(uint64_t *seed, double low, double high) {
  double size = exp(random_uniform(seed, log(low), log(high)));
  return random_uniform(seed, -1, 1) < 0 ? -size : size;
}

#endif
