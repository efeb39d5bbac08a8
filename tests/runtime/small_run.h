/* A run in memory for tests: deck text, a law by hand, and what came of it. */
#ifndef PERILAT_TESTS_SMALL_RUN_H
#define PERILAT_TESTS_SMALL_RUN_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "runtime/deck/deck_read.h"
#include "runtime/simulation/simulation.h"
#include "tests/runtime/elastic_law.h"

enum { SMALL_CRACKS = 4 };
typedef struct small_run {
  arena *memory;
  source_set sources;
  diagnostics said;
  const deck *deck;
  double parameters[16];                 /* of any law by hand */
  simulation_law laws[1 + SMALL_CRACKS]; /* cracks have none */
  simulation *simulation;
} small_run;

/* Only the deck: NULL with errors in r->said. */
static inline void small_read(small_run *r, const char *text) {
  memset(r, 0, sizeof *r);
  r->memory = arena_new();
  diag_begin(&r->said, &r->sources);
  const int file = source_add(&r->sources, "deck.nml", text, strlen(text));
  r->deck = deck_read(r->memory, &r->sources, file, NULL, 0, &r->said);
}

/* simulation stays NULL on errors; they are in r->said. The format takes the deck. */
static inline void small_open(small_run *r, const pl_law *law, const char *text) {
  small_read(r, text);
  if (!r->deck || !material_parameters(&r->deck->materials[0], law, r->parameters, &r->said))
    return;
  r->laws[0] = (simulation_law){.law = law, .parameters = r->parameters};
  r->simulation = simulation_new(r->deck, r->laws, &r->said);
}

static inline void small_close(small_run *r) {
  simulation_free(r->simulation);
  diag_clear(&r->said);
  source_clear(&r->sources);
  arena_free(r->memory);
}

static inline void small_print(const small_run *r) {
  diag_print(&r->said, stderr);
}

/* Index of a series of the history, or -1. */
static inline int small_series(const small_run *r, const char *name) {
  for (int k = 0; k < simulation_series_count(r->simulation); k++)
    if (strcmp(simulation_series(r->simulation, k, NULL, NULL), name) == 0) return k;
  return -1;
}

/* Its samples, [simulation_history]. */
static inline const double *small_values(const small_run *r, const char *name) {
  const double *values;
  simulation_series(r->simulation, small_series(r, name), NULL, &values);
  return values;
}

/* Value of a series at the last sample. */
static inline double small_last(const small_run *r, const char *name) {
  return small_values(r, name)[simulation_history(r->simulation, NULL) - 1];
}

static inline step_status small_go(small_run *r) {
  step_status status;
  do
    status = simulation_advance(r->simulation, 1L << 40, NULL);
  while (status == STEP_OK);
  return status;
}

/* Largest size of a series in the history so far. */
static inline double small_largest(const small_run *r, const char *name) {
  const double *values = small_values(r, name);
  double most = 0;
  for (long k = 0; k < simulation_history(r->simulation, NULL); k++)
    most = fmax(most, fabs(values[k]));
  return most;
}

#endif
