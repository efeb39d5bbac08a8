#include "runtime/simulation/simulation.h"

#include <omp.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "runtime/base/subnormals.h"
#include "runtime/interaction/interaction.h"
#include "runtime/lattice/lattice.h"
#include "runtime/simulation/law_fits.h"
#include "runtime/simulation/material.h"
#include "runtime/simulation/simulation_state.h"
#include "runtime/simulation/time_loop.h"

/* --- set-up ----------------------------------------------------------------------------------- */

/* Small bodies are not worth many threads: a block has at least eight rows, of a list two, unless
   the deck insists. */
static int choose_threads(const simulation *s) {
  const int asked = s->deck->simulation.threads;
  if (asked > 0) return asked;
  const int least = s->lattice->list ? 2 : 8;
  const int offered = omp_get_max_threads(), sensible = s->lattice->row_count / least;
  return sensible < 1 ? 1 : offered < sensible ? offered : sensible;
}

static bool open_fields(simulation *s, diagnostics *d) {
  const deck *k = s->deck;
  if (k->field_count > 0 && s->law->kind == PL_STATE) {
    diag_report(d, DIAG_NOT_SUPPORTED, k->fields[0].item.where,
                "the law `%s` reads whole families: its parameters cannot differ from bond to bond",
                s->law->name);
    return false;
  }
  if (k->field_count == 0 && s->law->varying_count == 0) return true;
  s->fields = random_fields_new(k, 0, s->lattice, s->law, s->parameters, d);
  return s->fields != NULL;
}

/* What asks for the values of parameters. */
static bool open_material(simulation *s, diagnostics *d) {
  const deck *k = s->deck;
  const bool fields = open_fields(s, d), mass = law_fits_motion(s->law, k, d);
  if (mass) rows_set_density(s->lattice, material_density(s->law, s->parameters));
  if (deck_lacks(k, "simulation") || deck_lacks(k, "relaxation")) return false;
  return fields && mass &&
         step_choose(k, s->law, s->parameters, s->fields, s->lattice, &s->limit, d) &&
         step_plan_make(k, &s->limit, &s->plan, d);
}

static bool open_lattice(simulation *s, diagnostics *d) {
  if (s->deck->lattice_count > 1) {
    diag_report(d, DIAG_NOT_SUPPORTED, s->deck->lattices[1].item.where,
                "a run can have one lattice, this is the second");
    return false;
  }
  if (!s->lattice) s->lattice = lattice_build(s->deck, 0, d);
  return s->lattice != NULL;
}

/* Everything that can be said of the deck with this lattice, or nothing and true. Laws and
   parameters may be missing, when they are wrong themselves. */
static bool is_sound(simulation *s, diagnostics *d) {
  enum { ANY_DOF = PL_MAX_DOF };
  const deck *k = s->deck;
  const bool fits = s->law && law_fits_lattice(s->law, k, s->lattice, d);
  s->loads = loads_new(k, 0, s->lattice, fits ? s->law->name : "", fits ? s->law->dof : ANY_DOF, d);
  if (!fits) return false;
  law_fits_protection(s->law, k, d);
  const bool frames = deck_lacks(k, "output") || frames_check(&k->output, s->law, d),
             watched = monitors_check(k, s->law, d);
  return s->parameters && open_material(s, d) && s->loads && frames && watched;
}

static bool is_quasi_static(const simulation *s) {
  return s->deck->relaxation.increments > 0;
}

static bool open_state(simulation *s, diagnostics *d) {
  s->bonds = rows_bonds(s->lattice);
  s->state = interaction_new(s->lattice, s->law, s->parameters, s->limit.step, choose_threads(s),
                             s->deck->output.energy, is_quasi_static(s));
  s->body = s->state->body;
  s->team = team_new(s->body->block_count);
  if (s->fields) s->state->parameter = s->fields->value;
  if (s->deck->gravity_count > 0) body_add_gravity(s->body);
  return loads_initial_velocity(s->loads, s->body, d);
}

static void open_clock(simulation *s) {
  if (is_quasi_static(s))
    s->relaxation = relaxation_new(s->deck, s->body, s->loads, s->limit.step / s->limit.limit);
  s->clock = (run_clock){
      .time_step = s->limit.step, .step_count = s->plan.step_count, .relaxation = s->relaxation};
  s->clock.at.last_frame_step = s->clock.at.stop = s->observed_step = -1;
}

static bool open_monitors(simulation *s, diagnostics *d) {
  const deck *k = s->deck;
  s->monitors = monitors_new(k, s->state, s->loads, s->bonds,
                             s->relaxation ? s->relaxation->interval : s->limit.step, d);
  if (!s->monitors) return false;
  s->history = history_new(s->monitors, s->relaxation, k->output.energy, s->plan.history_capacity);
  return true;
}

static bool open_frames(simulation *s, diagnostics *d) {
  const frame_field *fields;
  s->frames = frames_new(&(frames_of){.asked = &s->deck->output,
                                      .state = s->state,
                                      .loads = s->loads,
                                      .bonds = s->bonds,
                                      .parameter = s->state->parameter,
                                      .clock = &s->clock});
  const int count = frames_fields(s->frames, &fields);
  return law_fits_result(s->law, s->deck, fields, count, d);
}

static bool set_up(simulation *s, diagnostics *d) {
  if (!open_lattice(s, d) || !is_sound(s, d) || deck_lacks(s->deck, NULL)) return false;
  if (!open_state(s, d)) return false;
  open_clock(s);
  if (!open_monitors(s, d) || !open_frames(s, d)) return false;
  s->bad = bad_search_new(s->state, s->parameters, s->state->parameter, s->bonds, &s->clock);
  return true;
}

simulation *simulation_new_on(rows *lattice, const deck *k, const simulation_law *laws,
                              diagnostics *d) {
  simulation *s = must_calloc(1, sizeof *s);
  s->deck = k;
  s->law = laws[0].law;
  s->parameters = laws[0].parameters;
  s->lattice = lattice;
  if (set_up(s, d) && d->errors == 0) return s;
  simulation_free(s);
  return NULL;
}

simulation *simulation_new(const deck *k, const simulation_law *laws, diagnostics *d) {
  return simulation_new_on(NULL, k, laws, d);
}

void simulation_free(simulation *s) {
  if (!s) return;
  monitors_free(s->monitors);
  relaxation_free(s->relaxation);
  loads_free(s->loads);
  sweep_free(s->state);
  team_free(s->team);
  random_fields_free(s->fields);
  free(s->bonds);
  if (s->lattice) rows_free(s->lattice);
  frames_free(s->frames);
  history_free(&s->history);
  bad_search_free(s->bad);
  free(s);
}

const random_fields *simulation_fields(const simulation *s) {
  return s->fields;
}

const rows *simulation_rows(const simulation *s, int lattice) {
  (void)lattice; /* there is one */
  return s->lattice;
}

const step_limit *simulation_step_limit(const simulation *s) {
  return &s->limit;
}
long simulation_step_count(const simulation *s) {
  return (long)s->clock.step_count;
}
long simulation_step_done(const simulation *s) {
  return (long)s->clock.at.step;
}
double simulation_progress(const simulation *s) {
  return (double)run_clock_position(&s->clock) / (double)run_clock_end(&s->clock);
}
long simulation_increments(const simulation *s, long *unbalanced) {
  *unbalanced = s->relaxation ? (long)s->relaxation->state.unbalanced : 0;
  return s->relaxation ? (long)s->relaxation->state.done : 0;
}
double simulation_time(const simulation *s) {
  return run_clock_time(&s->clock);
}
int simulation_threads(const simulation *s) {
  return s->body->block_count;
}
sweep *simulation_state(simulation *s) {
  return s->state;
}

double simulation_memory(const simulation *s) {
  const double site = 2 * sizeof(double) + sizeof(int64_t) + sizeof(int32_t) + 1; /* of rows */
  const double looks = s->relaxation ? (double)sizeof(double) * (2 * s->body->dof + 1) : 0;
  const rows *g = s->lattice;
  const double list =
      g->list ? 2 * g->directions * (sizeof(int32_t) + (1 + (double)g->dimensions) * sizeof(double))
              : 0;
  return (double)s->body->bytes + list * (double)g->size +
         (s->fields ? (double)s->fields->bytes : 0) + looks * (double)s->lattice->size +
         site * (double)s->lattice->size +
         (double)sizeof(rows_bond) * (double)s->lattice->bond_count +
         (double)sizeof(double) * ((double)s->history.capacity * (s->history.series_count + 1) +
                                   (double)s->monitors->ring_size);
}

const deck_stop *simulation_stopped_by(const simulation *s) {
  return s->clock.at.stop >= 0 ? &s->deck->stops[s->clock.at.stop] : NULL;
}

/* --- what others ask -------------------------------------------------------------------------- */

step_status simulation_advance(simulation *s, long steps,
                               const volatile sig_atomic_t *interrupted) {
  return time_loop_run(s, steps, interrupted);
}

bad_state simulation_bad(const simulation *s) {
  return *bad_search_found(s->bad);
}

long simulation_history(const simulation *s, const double **time) {
  if (time) *time = s->history.time;
  return (long)s->clock.at.samples;
}

int simulation_series_count(const simulation *s) {
  return s->history.series_count;
}

const char *simulation_series(const simulation *s, int k, const char **symbol,
                              const double **values) {
  return history_series(&s->history, k, symbol, values);
}

char *simulation_series_words(const simulation *s, int k, arena *a) {
  return history_words(&s->history, k, a);
}

int simulation_imbalance(const simulation *s, const char **unchecked) {
  *unchecked = ledger_unchecked(s->law);
  return history_imbalance(&s->history);
}

int simulation_frame_fields(const simulation *s, const frame_field **fields) {
  return frames_fields(s->frames, fields);
}

void simulation_frame_values(simulation *s, int field, double *values) {
  const unsigned environment = subnormals_off();
  time_loop_observe(s);
  frames_values(s->frames, field, values);
  subnormals_restore(environment);
}

bool simulation_frame_due(const simulation *s) {
  return frames_due(s->frames);
}

void simulation_frame_taken(simulation *s) {
  frames_taken(s->frames, &s->clock.at);
}

double simulation_monitor_peak(const simulation *s, int index, double *time) {
  const monitor_state *m = &s->monitors->items[index].state;
  if (time) *time = m->peak_time;
  return m->peak;
}

void simulation_measure(simulation *s, profile *p) {
  s->profile = p;
}
