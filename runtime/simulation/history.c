#include "runtime/simulation/history.h"

#include <stdlib.h>

#include "dsl/base/arena.h"

enum { INCREMENT_STEPS, INCREMENT_UNBALANCE, INCREMENT_SERIES };
static const char *const increment_names[] = {"relaxation_steps", "relaxation_unbalance"};
static const char *const increment_words[] = {
    "steps of the increment",
    "unbalanced force at the end of the increment over reactions or loads"};

history history_new(const monitors *m, const relaxation *r, bool energies, int64_t capacity) {
  history h = {.monitors = m,
               .relaxation = r,
               .energies = energies ? LEDGER_COUNT : 0,
               .capacity = capacity};
  h.series_count = m->count + h.energies + (r ? INCREMENT_SERIES : 0);
  h.time = must_calloc((size_t)capacity, sizeof *h.time);
  h.values = must_calloc((size_t)capacity * (size_t)h.series_count + 1, sizeof *h.values);
  h.sampled = must_calloc((size_t)h.series_count + 1, sizeof *h.sampled);
  return h;
}

void history_free(history *h) {
  free(h->time);
  free(h->values);
  free(h->sampled);
}

double *history_energies(const history *h) {
  return h->energies ? h->sampled + h->monitors->count : NULL;
}

void history_add(history *h, int64_t sample, double time) {
  if (h->relaxation) {
    double *own = h->sampled + h->series_count - INCREMENT_SERIES;
    own[INCREMENT_STEPS] = (double)h->relaxation->state.steps;
    own[INCREMENT_UNBALANCE] = h->relaxation->state.unbalance;
  }
  h->time[sample] = time;
  for (int k = 0; k < h->series_count; k++)
    h->values[k * h->capacity + sample] = h->sampled[k];
}

const char *history_series(const history *h, int k, const char **symbol, const double **values) {
  const int energy = k - h->monitors->count, own = energy - h->energies;
  if (values) *values = h->values + k * h->capacity;
  if (symbol) *symbol = energy < 0 ? h->monitors->items[k].unit : own < 0 ? "J" : "1";
  if (energy < 0) return h->monitors->deck->monitors[k].name;
  return own < 0 ? ledger_names[energy] : increment_names[own];
}

char *history_words(const history *h, int k, arena *a) {
  const int energy = k - h->monitors->count, own = energy - h->energies;
  if (energy < 0) return monitor_words(h->monitors, k, a);
  return arena_printf(a, "%s", own < 0 ? ledger_words[energy] : increment_words[own]);
}

int history_imbalance(const history *h) {
  return h->energies ? h->monitors->count + LEDGER_IMBALANCE : -1;
}
