#include "runtime/simulation/history.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/simulation/monitor_words.h"

enum { INCREMENT_STEPS, INCREMENT_UNBALANCE, INCREMENT_SERIES };
static const char *const increment_names[] = {"relaxation_steps", "relaxation_unbalance"};
static const char *const increment_words[] = {
    "steps of the increment",
    "unbalanced force at the end of the increment over reactions or loads, or 1e-5 of the forces "
    "between particles"};

static const char step_name[] = "time_step", step_words[] = "time step, which may shrink";

/* Series of increments, or of the step. */
static int own_series(const history *h) {
  return h->relaxation ? INCREMENT_SERIES : h->shrinking ? 1 : 0;
}

/* Bodies, contacts and stamps of which energies are kept one by one. */
static int parts_apart(const history *h) {
  const int parts = h->monitors->body_count + h->contacts->count + h->stamps->count;
  return parts > 1 ? parts : 0;
}

static const char *part_name(const history *h, int number) {
  const int beyond = number - h->monitors->body_count, of_stamps = beyond - h->contacts->count;
  if (beyond < 0) return h->monitors->bodies[number].name;
  return of_stamps < 0 ? h->contacts->items[beyond].from->name
                       : h->stamps->items[of_stamps].from->name;
}

static const ledger_term law_terms[HISTORY_LAW_TERMS] = {LEDGER_STORED, LEDGER_DISSIPATED_DAMAGE};

static int laws_beside(const history *h) {
  int count = 0;
  for (int b = 0; b < h->monitors->body_count; b++)
    count += h->monitors->bodies[b].law_count > 1 ? h->monitors->bodies[b].law_count - 1 : 0;
  return count;
}

static const char *law_name(const history *h, int number) {
  for (int b = 0;; b++) {
    const run_body *of = &h->monitors->bodies[b];
    const int beside = of->law_count > 1 ? of->law_count - 1 : 0;
    if (number < beside) return of->laws[1 + number].from->name;
    number -= beside;
  }
}

/* Terms of the sum, of bodies, contacts and stamps; those of laws stand behind them. */
static int whole_terms(const history *h) {
  return (1 + parts_apart(h)) * LEDGER_COUNT;
}

static ledger_term term_of(const history *h, int energy) {
  const int own = energy - whole_terms(h);
  return own < 0 ? (ledger_term)(energy % LEDGER_COUNT) : law_terms[own % HISTORY_LAW_TERMS];
}

/* Whose energy it is; NULL: of all. */
static const char *owner_of(const history *h, int energy) {
  const int number = energy / LEDGER_COUNT - 1, own = energy - whole_terms(h);
  if (own >= 0) return law_name(h, own / HISTORY_LAW_TERMS);
  return number < 0 ? NULL : part_name(h, number);
}

/* "energy/kinetic" in sum, "plate/kinetic" of a body, "plate.core/stored" of a law in a part. */
static char *energy_name(const history *h, int energy) {
  const char *owner = owner_of(h, energy), *term = ledger_names[term_of(h, energy)];
  const char *folder = owner ? owner : "energy";
  term = strchr(term, '/') + 1;
  const size_t size = strlen(folder) + strlen(term) + 2;
  char *name = must_alloc(size);
  snprintf(name, size, "%s/%s", folder, term);
  return name;
}

/* Series of the tips of all meshes. */
static int crack_series(const history *h) {
  int count = 0;
  for (int b = 0; b < h->monitors->body_count; b++) {
    const cells *c = h->monitors->bodies[b].cells;
    count += c && c->tips ? c->tips->count * TIP_VALUE_COUNT : 0;
  }
  return count;
}

/* "notch/K_I", "notch/start/K_I". */
static char *crack_name(const history *h, int series) {
  char folder[256], *name;
  int tip = series / TIP_VALUE_COUNT;
  for (int b = 0;; b++) {
    const cells *c = h->monitors->bodies[b].cells;
    const int here = c && c->tips ? c->tips->count : 0;
    if (tip < here) {
      tip_folder(c->tips, tip, folder, sizeof folder);
      break;
    }
    tip -= here;
  }
  const char *last = tip_value_names[series % TIP_VALUE_COUNT];
  const size_t size = strlen(folder) + strlen(last) + 2;
  name = must_alloc(size);
  snprintf(name, size, "%s/%s", folder, last);
  return name;
}

/* Of the last look at each tip. */
static void sample_cracks(history *h) {
  double *values = h->sampled + h->monitors->count + h->energies;
  for (int b = 0; b < h->monitors->body_count; b++) {
    const cells *c = h->monitors->bodies[b].cells;
    for (int n = 0; c && c->tips && n < c->tips->count; n++)
      for (int k = 0; k < TIP_VALUE_COUNT; k++)
        *values++ = tip_value_now(c->tips, &c->tips->items[n], (tip_value)k);
  }
}

history history_new(const monitors *m, const run_contacts *c, const run_stamps *s,
                    const relaxation *r, const run_clock *shrinking, bool energies,
                    int64_t capacity) {
  history h = {.monitors = m,
               .contacts = c,
               .stamps = s,
               .relaxation = r,
               .shrinking = shrinking,
               .capacity = capacity};
  h.energies = energies ? whole_terms(&h) + laws_beside(&h) * HISTORY_LAW_TERMS : 0;
  h.cracks = crack_series(&h);
  h.series_count = m->count + h.energies + h.cracks + own_series(&h);
  h.time = must_calloc((size_t)capacity, sizeof *h.time);
  h.values = must_calloc((size_t)capacity * (size_t)h.series_count + 1, sizeof *h.values);
  h.sampled = must_calloc((size_t)h.series_count + 1, sizeof *h.sampled);
  h.names = must_calloc((size_t)(h.energies + h.cracks) + 1, sizeof *h.names);
  for (int k = 0; k < h.energies; k++)
    h.names[k] = energy_name(&h, k);
  for (int k = 0; k < h.cracks; k++)
    h.names[h.energies + k] = crack_name(&h, k);
  return h;
}

void history_free(history *h) {
  for (int k = 0; k < h->energies + h->cracks; k++)
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
  const bool apart = parts_apart(h) > 0;
  return h->energies ? history_energies(h) + (apart ? (1 + number) * LEDGER_COUNT : 0) : NULL;
}

double *history_energies_of_law(const history *h, int number) {
  return h->energies ? history_energies(h) + whole_terms(h) + number * HISTORY_LAW_TERMS : NULL;
}

void history_add(history *h, int64_t sample, double time) {
  if (h->relaxation) {
    double *own = h->sampled + h->series_count - INCREMENT_SERIES;
    own[INCREMENT_STEPS] = (double)h->relaxation->state.steps;
    own[INCREMENT_UNBALANCE] = h->relaxation->state.unbalance;
  }
  if (h->shrinking) h->sampled[h->series_count - 1] = run_clock_step(h->shrinking);
  sample_cracks(h);
  h->time[sample] = time;
  for (int k = 0; k < h->series_count; k++)
    h->values[k * h->capacity + sample] = h->sampled[k];
}

const char *history_series(const history *h, int k, const char **symbol, const double **values) {
  const int energy = k - h->monitors->count, of_crack = energy - h->energies,
            own = of_crack - h->cracks;
  if (values) *values = h->values + k * h->capacity;
  if (symbol)
    *symbol = energy < 0     ? h->monitors->items[k].unit
              : of_crack < 0 ? "J"
              : own < 0      ? tip_value_units[of_crack % TIP_VALUE_COUNT]
              : h->shrinking ? "s"
                             : "1";
  if (energy < 0) return h->monitors->deck->monitors[k].name;
  if (own < 0) return h->names[energy];
  return h->shrinking ? step_name : increment_names[own];
}

char *history_words(const history *h, int k, arena *a) {
  const int energy = k - h->monitors->count, of_crack = energy - h->energies,
            own = of_crack - h->cracks;
  if (energy < 0) return monitor_words(h->monitors, k, a);
  if (of_crack >= 0 && own < 0)
    return arena_printf(a, "%s", tip_value_words[of_crack % TIP_VALUE_COUNT]);
  if (own >= 0) return arena_printf(a, "%s", h->shrinking ? step_words : increment_words[own]);
  const char *words = ledger_words[term_of(h, energy)], *owner = owner_of(h, energy);
  return owner ? arena_printf(a, "%s, of `%s`", words, owner) : arena_printf(a, "%s", words);
}

double history_largest_energy(const history *h, int64_t samples) {
  double largest = h->energies ? 0 : NAN;
  for (int term = 0; term < LEDGER_COUNT && h->energies; term++) {
    const double *values = h->values + (h->monitors->count + term) * h->capacity;
    for (int64_t k = 0; k < samples && term != LEDGER_IMBALANCE; k++)
      largest = pl_fmax(largest, fabs(values[k]));
  }
  return largest;
}

int history_imbalance(const history *h, int number) {
  const int first = (1 + number) * LEDGER_COUNT;
  return first < whole_terms(h) && h->energies ? h->monitors->count + first + LEDGER_IMBALANCE : -1;
}
