#include "runtime/simulation/history.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

enum { INCREMENT_STEPS, INCREMENT_UNBALANCE, INCREMENT_SERIES };
static const char *const increment_names[] = {"relaxation_steps", "relaxation_unbalance"};
static const char *const increment_words[] = {
    "steps of the increment",
    "unbalanced force at the end of the increment over reactions or loads"};

/* Bodies and contacts of which energies are kept one by one. */
static int parts_apart(const history *h) {
  const int parts = h->monitors->body_count + h->contacts->count;
  return parts > 1 ? parts : 0;
}

static const char *part_name(const history *h, int number) {
  const int bodies = h->monitors->body_count;
  return number < bodies ? h->monitors->bodies[number].name
                         : h->contacts->items[number - bodies].from->name;
}

/* "energy/kinetic" in sum, "plate/kinetic" of a body. */
static char *energy_name(const history *h, int energy) {
  const int number = energy / LEDGER_COUNT - 1;
  const char *term = ledger_names[energy % LEDGER_COUNT];
  const char *folder = number < 0 ? "energy" : part_name(h, number);
  term = strchr(term, '/') + 1;
  const size_t size = strlen(folder) + strlen(term) + 2;
  char *name = must_alloc(size);
  snprintf(name, size, "%s/%s", folder, term);
  return name;
}

history history_new(const monitors *m, const run_contacts *c, const relaxation *r, bool energies,
                    int64_t capacity) {
  history h = {.monitors = m, .contacts = c, .relaxation = r, .capacity = capacity};
  h.energies = energies ? (1 + parts_apart(&h)) * LEDGER_COUNT : 0;
  h.series_count = m->count + h.energies + (r ? INCREMENT_SERIES : 0);
  h.time = must_calloc((size_t)capacity, sizeof *h.time);
  h.values = must_calloc((size_t)capacity * (size_t)h.series_count + 1, sizeof *h.values);
  h.sampled = must_calloc((size_t)h.series_count + 1, sizeof *h.sampled);
  h.names = must_calloc((size_t)h.energies + 1, sizeof *h.names);
  for (int k = 0; k < h.energies; k++)
    h.names[k] = energy_name(&h, k);
  return h;
}

void history_free(history *h) {
  for (int k = 0; k < h->energies; k++)
    free(h->names[k]);
  free(h->names);
  free(h->time);
  free(h->values);
  free(h->sampled);
}

double *history_energies(const history *h) {
  return h->energies ? h->sampled + h->monitors->count : NULL;
}

double *history_energies_of(const history *h, int number) {
  const bool apart = h->energies > LEDGER_COUNT;
  return h->energies ? history_energies(h) + (apart ? (1 + number) * LEDGER_COUNT : 0) : NULL;
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
  return own < 0 ? h->names[energy] : increment_names[own];
}

char *history_words(const history *h, int k, arena *a) {
  const int energy = k - h->monitors->count, own = energy - h->energies;
  if (energy < 0) return monitor_words(h->monitors, k, a);
  if (own >= 0) return arena_printf(a, "%s", increment_words[own]);
  const char *words = ledger_words[energy % LEDGER_COUNT];
  const int number = energy / LEDGER_COUNT - 1;
  return number < 0 ? arena_printf(a, "%s", words)
                    : arena_printf(a, "%s, of `%s`", words, part_name(h, number));
}

int history_imbalance(const history *h, int number) {
  const int first = (1 + number) * LEDGER_COUNT;
  return first < h->energies ? h->monitors->count + first + LEDGER_IMBALANCE : -1;
}
