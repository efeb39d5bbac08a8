#include "runtime/lattice/lattice.h"
#include "runtime/simulation/simulation_parts.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/elementary.h"
#include "runtime/analysis/stability.h"
#include "runtime/base/clock.h"

/* --- set-up: mass and step -------------------------------------------------------------------- */

/* Where the deck says which law it is. */
static span where_of_law(const simulation *s) {
  const deck_lattice *lattice = &s->deck->lattices[0];
  const int m = deck_find_material(s->deck, lattice->name);
  return m < 0 ? lattice->item.where : deck_where(&s->deck->materials[m].item, "model");
}

static bool set_mass(simulation *s, diagnostics *d) {
  if (material_rho(s->law) >= 0) {
    rows_set_density(s->lattice, material_density(s->law, s->parameters));
    return true;
  }
  diag_report(d, DIAG_MISSING_KEY, where_of_law(s),
              "the law `%s` has no parameter `rho`, so its particles have no mass", s->law->name);
  for (int p = 0; p < s->law->parameter_count; p++)
    if (strcasecmp(s->law->parameters[p].name, "rho") == 0) {
      diag_hint(d, "in a law upper and lower case differ: write `rho` for `%s`",
                s->law->parameters[p].name);
      return false;
    }
  diag_hint(d, "add a mass density to the law, e.g. parameter rho = 2300 [kg/m^3] in (0, inf)");
  return false;
}

/* Protection keeps damage as it is: a law that softens through a plain state is not held back by it. */
static void warn_of_protection(const simulation *s, diagnostics *d) {
  for (int f = 0; f < s->law->field_count; f++)
    if (s->law->fields[f].kind == PL_FIELD_DAMAGE) return;
  if (s->deck->protect_count > 0 && s->law->field_count > 0)
    diag_report(
        d, DIAG_DECK_WARNING, s->deck->protects[0].item.where,
        "the law `%s` has no damage that could be held back; its states go on as they do elsewhere",
        s->law->name);
}

static bool is_stable_at_rest(const simulation *s, diagnostics *d) {
  if (s->limit.least >= STABILITY_LEAST) return true;
  diag_report(d, DIAG_STIFFNESS, where_of_law(s),
              "the virgin body is unstable at rest: by the law `%s` a small motion pushes its "
              "particles on (smallest eigenvalue of its stiffness %.3g of the largest)",
              s->law->name, s->limit.least);
  diag_hint(d, "a bond that is longer pulls its ends together: look at the signs, and at what the "
               "law takes for lengths and volumes of this lattice");
  return false;
}

/* Of a dynamic run: the time of others is only an order. */
static bool ends_after_a_step(const simulation *s, diagnostics *d) {
  const double end = s->deck->simulation.end_time;
  if (s->deck->relaxation.increments > 0 || s->limit.step <= end) return true;
  diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&s->deck->simulation.item, "end_time"),
              "the run of %.4g s is shorter than one step of %.4g s", end, s->limit.step);
  diag_hint(d, "give a later `end_time`, a shorter `step`, or look at the units of stiffness and "
               "density");
  return false;
}

static bool choose_step(simulation *s, diagnostics *d) {
  const deck_simulation *k = &s->deck->simulation;
  stability_limit(s->law, s->parameters, s->fields, s->lattice, &s->limit);
  const double limit = s->limit.limit;
  if (!is_stable_at_rest(s, d)) return false;
  if (!(limit > 0)) {
    diag_report(d, DIAG_UNSTABLE_STEP, k->item.where,
                "the law `%s` has no finite stiffness at rest, so that no step is stable",
                s->law->name);
    diag_hint(
        d, "look for a division by zero or a root where stretch, rotations and states are all 0");
    return false;
  }
  if (k->step > limit) {
    diag_report(d, DIAG_UNSTABLE_STEP, deck_where(&k->item, "step"),
                "a step of %.6g s is unstable: the largest stable one is %.6g s", k->step, limit);
    diag_hint(d, "leave `step` away to have it chosen: %.2g of the limit, %.4g s", k->step_safety,
              k->step_safety * limit);
    return false;
  }
  s->limit.step = k->step > 0 ? k->step : k->step_safety * limit;
  if (isfinite(s->limit.step) && s->limit.step > 0) return ends_after_a_step(s, d);
  diag_report(d, DIAG_UNSTABLE_STEP, k->item.where,
              "the law `%s` has no stiffness to choose a step from", s->law->name);
  diag_hint(d, "give `step` in &simulation");
  return false;
}

/* A sample at the start, and after each increment. */
static bool count_increments(simulation *s) {
  const deck_relaxation *k = &s->deck->relaxation;
  s->step_count = INT64_C(1) << 60; /* as many as it takes */
  s->sample_interval = s->deck->simulation.end_time / k->increments;
  s->history_capacity = k->increments + 3;
  return true;
}

/* Unless the deck asks for more: a sample takes up to four steps, so that these take less than 2 % of a run. */
enum { STEPS_A_SAMPLE = 200 };

static bool count_steps(simulation *s, diagnostics *d) {
  static const double most = 1e12;
  if (s->deck->relaxation.increments > 0) return count_increments(s);
  const double end = s->deck->simulation.end_time, steps = ceil(end / s->limit.step - 1e-9);
  if (!(steps <= most)) {
    diag_report(d, DIAG_BAD_VALUE, deck_where(&s->deck->simulation.item, "end_time"),
                "the run would take %.3g steps of %.3g s", steps, s->limit.step);
    return false;
  }
  s->step_count = steps < 1 ? 1 : (int64_t)steps;
  const double asked = s->deck->output.sample;
  s->sample_interval = asked > 0 ? pl_fmax(asked, s->limit.step) /* no more than a sample a step */
                                 : pl_fmax(end / 2000, STEPS_A_SAMPLE * s->limit.step);
  const double samples = pl_fmin(ceil(end / s->sample_interval), steps);
  s->history_capacity = (int64_t)samples + 3;
  return true;
}

/* --- set-up ----------------------------------------------------------------------------------- */

/* Small bodies are not worth many threads: a block has at least eight rows, of a list two, unless the deck insists. */
static int choose_threads(const simulation *s) {
  const int asked = s->deck->simulation.threads;
  if (asked > 0) return asked;
  const int least = s->lattice->list ? 2 : 8;
  const int offered = omp_get_max_threads(), sensible = s->lattice->row_count / least;
  return sensible < 1 ? 1 : offered < sensible ? offered : sensible;
}

enum { RELAXATION_COUNT = 2 };
static const char *const relaxation_names[] = {"relaxation_steps", "relaxation_unbalance"};
static const char *const relaxation_words[] = {
    "steps of the increment",
    "unbalanced force at the end of the increment over reactions or loads"};

static void new_history(simulation *s) {
  s->series_count = s->monitors->count + (s->deck->output.energy ? LEDGER_COUNT : 0) +
                    (s->relaxation ? RELAXATION_COUNT : 0);
  const size_t capacity = (size_t)s->history_capacity;
  s->time = must_calloc(capacity, sizeof(double));
  s->history = must_calloc(capacity * (size_t)s->series_count + 1, sizeof(double));
  s->sampled = must_calloc((size_t)s->series_count + 1, sizeof(double));
}

/* The kernel of a law of families is made for lattices or for lists. A solver has one, and its deck may change. */
static bool topology_serves(const simulation *s, diagnostics *d) {
  const deck_lattice *l = &s->deck->lattices[0];
  const bool list = s->lattice->list != NULL;
  const int neighbours = 2 * s->lattice->directions;
  const bool same = (s->law->topology == PL_LIST) == list;
  if (s->law->kind == PL_STATE && same && s->law->neighbours && s->law->neighbours != neighbours) {
    diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&l->item, l->horizon > 0 ? "horizon" : "shells"),
                "this solver was built for %d neighbours, not %d", s->law->neighbours, neighbours);
    diag_hint(d, "build another one with `perilat build`, or use `perilat run`");
    return false;
  }
  if (s->law->kind == PL_STATE && same) return true;
  if (s->law->kind == PL_STATE) {
    diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&l->item, "kind"),
                "this solver was built for particles that stand on %s",
                list ? "a lattice" : "no lattice");
    diag_hint(d, "build another one with `perilat build`, or use `perilat run`");
    return false;
  }
  diag_report(
      d, DIAG_NOT_SUPPORTED, deck_where(&l->item, "kind"),
      "as a law of bonds `%s` runs on a hexagonal lattice, not on particles that stand on none",
      s->law->name);
  diag_hint(d,
            "laws of families, `law state`, run on them, and central laws without random fields");
  return false;
}

/* A law is of the plane or of space. Laws of bonds run on the hexagonal lattice of nearest neighbours. */
static bool lattice_serves(const simulation *s, diagnostics *d) {
  const deck_lattice *l = &s->deck->lattices[0];
  const bool same = s->law->dimensions == s->lattice->dimensions;
  if (same && (s->law->kind == PL_STATE || s->lattice->list)) return topology_serves(s, d);
  if (same && bravais_is_hexagon(l)) return true;
  if (s->law->dimensions != s->lattice->dimensions) {
    diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&l->item, "kind"),
                "the law `%s` is of %s, the lattice is in %s", s->law->name,
                s->law->dimensions == 2 ? "the plane" : "space",
                s->law->dimensions == 2 ? "space" : "the plane");
    return false;
  }
  const bool hexagonal = strcmp(l->kind, "hexagonal") == 0;
  const char *key = !hexagonal ? "kind" : l->horizon > 0 ? "horizon" : "shells";
  diag_report(d, DIAG_NOT_SUPPORTED, deck_where(&l->item, key),
              "`%s` is a law of bonds: it runs on a hexagonal lattice of nearest neighbours",
              s->law->name);
  diag_hint(d,
            "other lattices bear laws of families, `law state`, and central laws of bonds without "
            "random fields");
  return false;
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
  const bool fields = open_fields(s, d), mass = set_mass(s, d);
  if (deck_lacks(s->deck, "simulation") || deck_lacks(s->deck, "relaxation")) return false;
  return fields && mass && choose_step(s, d) && count_steps(s, d);
}

/* Everything that can be said of the deck with this lattice, or nothing and true. Laws and
   parameters may be missing, when they are wrong themselves. */
static bool is_sound(simulation *s, diagnostics *d) {
  enum { ANY_DOF = 3 };
  const deck *k = s->deck;
  const bool serves = s->law && lattice_serves(s, d);
  s->loads =
      loads_new(k, 0, s->lattice, serves ? s->law->name : "", serves ? s->law->dof : ANY_DOF, d);
  if (!serves) return false;
  warn_of_protection(s, d);
  const bool frames = deck_lacks(k, "output") || frames_check(s, d),
             watched = monitors_check(k, s->law, d);
  return s->parameters && open_material(s, d) && s->loads && frames && watched;
}

/* In a result stand side by side: the times, fields of particles, a folder for those of bonds. */
static bool is_named_once(const simulation *s, int field) {
  const frame_field *f = s->frame_fields;
  const char *name = f[field].name;
  bool once = strcmp(name, "time") != 0;
  for (int k = 0; k < s->frame_field_count; k++)
    if (k != field && strcmp(f[k].on_bonds ? s->deck->lattices[0].name : f[k].name, name) == 0)
      once = false;
  return once || f[field].on_bonds;
}

static bool frames_fit(const simulation *s, diagnostics *d) {
  const int errors = d->errors;
  for (int k = 0; k < s->frame_field_count; k++) {
    const char *name = s->frame_fields[k].name;
    if (strcmp(s->frame_fields[k].kind, "other") == 0 || is_named_once(s, k)) continue;
    diag_report(d, DIAG_RESERVED_NAME, where_of_law(s),
                "`%s` of the law `%s` cannot be stored: a result has another `%s` there", name,
                s->law->name, name);
    diag_hint(d, "give it another name in the law, or leave it out of `fields` in &output");
  }
  return d->errors == errors;
}

static bool set_up(simulation *s, diagnostics *d) {
  const deck *k = s->deck;
  const bool quasi_static = k->relaxation.increments > 0;
  if (k->lattice_count > 1) {
    diag_report(d, DIAG_NOT_SUPPORTED, k->lattices[1].item.where,
                "a run can have one lattice, this is the second");
    return false;
  }
  if (!s->lattice) s->lattice = lattice_build(k, 0, d);
  if (!s->lattice || !is_sound(s, d) || deck_lacks(k, NULL)) return false;
  s->bonds = rows_bonds(s->lattice);
  s->state = interaction_new(s->lattice, s->law, s->parameters, s->limit.step, choose_threads(s),
                             k->output.energy, quasi_static);
  s->body = s->state->body;
  s->team = team_new(s->body->block_count);
  if (s->fields) s->state->parameter = s->fields->value;
  if (k->gravity_count > 0) body_add_gravity(s->body);
  if (!loads_initial_velocity(s->loads, s->body, d)) return false;
  if (quasi_static)
    s->relaxation = relaxation_new(k, s->body, s->loads, s->limit.step / s->limit.limit);
  s->monitors = monitors_new(k, s->state, s->loads, s->bonds,
                             quasi_static ? s->relaxation->interval : s->limit.step, d);
  if (!s->monitors) return false;
  frames_choose(s);
  if (!frames_fit(s, d)) return false;
  new_history(s);
  s->at.last_frame_step = s->at.stop = s->observed_step = -1;
  const size_t family = 2 * (size_t)s->lattice->directions;
  s->bad_fields = must_calloc((1 + family) * (size_t)s->law->field_count + 1, sizeof(double));
  s->bad_family = must_calloc(family, sizeof *s->bad_family);
  s->bad = (bad_state){.particle = -1, .bond_particle = -1, .what = ""};
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
  free(s->frame_fields);
  free(s->frame_sources);
  free(s->time);
  free(s->history);
  free(s->sampled);
  free(s->bad_fields);
  free(s->bad_family);
  free(s->bad_parameters);
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
  return (long)s->step_count;
}
long simulation_step_done(const simulation *s) {
  return (long)s->at.step;
}
int64_t simulation_position(const simulation *s) {
  return s->relaxation ? s->relaxation->state.done : s->at.step;
}
int64_t simulation_end(const simulation *s) {
  return s->relaxation ? s->deck->relaxation.increments : s->step_count;
}
double simulation_progress(const simulation *s) {
  return (double)simulation_position(s) / (double)simulation_end(s);
}
long simulation_increments(const simulation *s, long *unbalanced) {
  *unbalanced = s->relaxation ? (long)s->relaxation->state.unbalanced : 0;
  return s->relaxation ? (long)s->relaxation->state.done : 0;
}
double simulation_time(const simulation *s) {
  return s->relaxation ? (double)s->relaxation->state.done * s->relaxation->interval
                       : (double)s->at.step * s->limit.step;
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
         (double)sizeof(double) *
             ((double)s->history_capacity * (s->series_count + 1) + (double)s->monitors->ring_size);
}

/* --- samples ---------------------------------------------------------------------------------- */

/* Steps of samples follow from whole numbers, so that a resumed run samples where the unbroken one
 * does. */
static int64_t sample_step(const simulation *s, int64_t k) {
  return llround((double)k * s->sample_interval / s->limit.step);
}

static bool sample_due(const simulation *s) {
  return s->at.step >= sample_step(s, s->at.next_sample) || s->at.step == s->step_count;
}

static int64_t next_sample(const simulation *s) {
  int64_t k = s->at.next_sample;
  while (sample_step(s, k) <= s->at.step)
    k++;
  return k;
}

/* Values of the state observed into the history. The end is sampled also when it lies between two
 * samples. */
static void take_sample(simulation *s, const load_look *look) {
  const double time = simulation_time(s);
  const int watched = s->monitors->count;
  bool sound = true;
  monitors_sample(s->monitors, (long)s->at.step, time, s->sampled);
  if (s->deck->output.energy)
    sound = ledger_sample(&s->ledger, s->state, s->loads, look, s->limit.omega_max,
                          s->sampled + watched);
  if (s->relaxation) {
    double *own = s->sampled + s->series_count - RELAXATION_COUNT;
    own[0] = (double)s->relaxation->state.steps;
    own[1] = s->relaxation->state.unbalance;
  }
  s->time[s->at.samples] = time;
  for (int k = 0; k < s->series_count; k++)
    s->history[k * s->history_capacity + s->at.samples] = s->sampled[k];
  s->at.samples++;
  s->at.next_sample = s->relaxation ? s->at.samples : next_sample(s);
  s->at.stop = monitors_stop(s->monitors, time, s->sampled);
  if (s->at.stop >= 0) s->at.status = STEP_STOPPED;
  if (!sound) bad_energy(s, "energy from nothing");
  if (s->deck->output.energy && simulation_position(s) == simulation_end(s) &&
      !isfinite(s->sampled[watched + LEDGER_KINETIC] + s->sampled[watched + LEDGER_STORED]))
    bad_energy(s, "energies that are not finite");
  if (s->at.status != STEP_OK) s->go_on = false;
}

static void record_sample(simulation *s, const load_look *look) {
  const double begun = s->profile ? monotonic_seconds() : 0;
  take_sample(s, look);
  if (s->profile) s->profile->sampled += monotonic_seconds() - begun;
}

const deck_stop *simulation_stopped_by(const simulation *s) {
  return s->at.stop >= 0 ? &s->deck->stops[s->at.stop] : NULL;
}

long simulation_history(const simulation *s, const double **time) {
  if (time) *time = s->time;
  return (long)s->at.samples;
}

int simulation_series_count(const simulation *s) {
  return s->series_count;
}

const char *simulation_series(const simulation *s, int k, const char **symbol,
                              const double **values) {
  const int watched = s->monitors->count;
  const int own = k - (s->series_count - (s->relaxation ? RELAXATION_COUNT : 0));
  if (symbol) *symbol = k < watched ? s->monitors->items[k].unit : own < 0 ? "J" : "1";
  if (values) *values = s->history + k * s->history_capacity;
  return k < watched ? s->deck->monitors[k].name
         : own < 0   ? ledger_names[k - watched]
                     : relaxation_names[own];
}

char *simulation_series_words(const simulation *s, int k, arena *a) {
  const int watched = s->monitors->count;
  const int own = k - (s->series_count - (s->relaxation ? RELAXATION_COUNT : 0));
  if (k < watched) return monitor_words(s->monitors, k, a);
  return arena_printf(a, "%s", own < 0 ? ledger_words[k - watched] : relaxation_words[own]);
}

int simulation_imbalance(const simulation *s, const char **unchecked) {
  *unchecked = ledger_unchecked(s->law);
  return s->deck->output.energy ? s->monitors->count + LEDGER_IMBALANCE : -1;
}

double simulation_monitor_peak(const simulation *s, int index, double *time) {
  const monitor_state *m = &s->monitors->items[index].state;
  if (time) *time = m->peak_time;
  return m->peak;
}

/* --- time loop -------------------------------------------------------------------------------- */

/* What one thread does after all have moved their rows and what is loaded in them. */
static void after_step(simulation *s) {
  if (body_bad(s->body) >= 0) {
    bad_explain(s);
    s->at.status = STEP_BAD;
    s->go_on = s->observe = false;
    return;
  }
  sweep_turn(s->state);
  loads_turn(s->loads, s->body, (long)s->at.step);
  s->at.step++;
  s->go_on = s->at.step < s->until && !(s->interrupted && *s->interrupted);
  if (s->relaxation) {
    s->observe = relaxation_due(s->relaxation, s->at.step);
    return;
  }
  monitors_step(s->monitors, (long)s->at.step);
  s->observe = sample_due(s) || monitors_due(s->monitors, (long)s->at.step);
}

/* Quasi-static runs observe to see whether the body has come to rest. */
static void end_increment(simulation *s, const load_look *look) {
  if (!relaxation_look(s->relaxation, s->at.step)) return;
  monitors_look(s->monitors, (long)s->at.step, (long)simulation_position(s));
  record_sample(s, look);
  if (simulation_position(s) == simulation_end(s))
    s->at.status = s->at.status == STEP_OK ? STEP_END : s->at.status;
  else
    relaxation_next(s->relaxation, s->at.step);
  if (s->at.status != STEP_OK || simulation_frame_due(s)) s->go_on = false;
}

static void after_observing(simulation *s) {
  const load_look look = loads_observe(s->loads, s->body, (long)s->at.step);
  s->observe = false;
  s->observed_step = s->at.step;
  if (s->relaxation && s->at.step > 0) {
    end_increment(s, &look);
    return;
  }
  monitors_look(s->monitors, (long)s->at.step, (long)simulation_position(s));
  if (sample_due(s)) record_sample(s, &look);
}

void simulation_measure(simulation *s, profile *p) {
  s->profile = p;
}

/* Adds the time from `begun` to now, and returns now; nothing where nothing is measured. */
static double add_time(const simulation *s, double begun, double *sum) {
  if (!s->profile) return 0;
  const double now = monotonic_seconds();
  *sum += now - begun;
  return now;
}

/* Tasks of the team: the stages of a step, then those of observing. */
static void do_stage(void *of, int task, int block) {
  simulation *s = of;
  const sweep_engine *engine = &s->state->engine;
  body_block *b = &s->body->blocks[block];
  double now = s->profile ? monotonic_seconds() : 0;
  if (task >= engine->step_stages) {
    engine->observe(s->state, task - engine->step_stages, block);
    add_time(s, now, &b->observing);
    return;
  }
  engine->step(s->state, task, block);
  now = add_time(s, now, &b->stepping);
  if (task < engine->step_stages - 1) return;
  loads_apply(s->loads, s->body, block, (long)s->at.step);
  add_time(s, now, &b->loading);
}

/* Blocks keep the times of what they do in steps only. */
static int next_task(simulation *s) {
  s->body->timed = s->profile && !s->observe;
  return s->observe ? s->state->engine.step_stages : s->go_on ? 0 : TEAM_END;
}

/* What one thread does between stages; sampling counts its time for itself (record_sample). */
static int after_stage(void *of, int task) {
  simulation *s = of;
  profile *p = s->profile;
  const sweep_engine *engine = &s->state->engine;
  const bool stepped = task == engine->step_stages - 1,
             observed = task == engine->step_stages + engine->observe_stages - 1;
  if (!stepped && !observed) return task + 1;
  const double begun = p ? monotonic_seconds() : 0, sampled = p ? p->sampled : 0;
  (stepped ? after_step : after_observing)(s);
  if (p) p->loaded += monotonic_seconds() - begun - (p->sampled - sampled);
  return next_task(s);
}

/* First frame after the present step bounds an advance; one that is due but not taken does not. */
static int64_t next_stop(const simulation *s, long steps) {
  const int64_t frames = s->deck->output.frames, step = s->at.step;
  int64_t until = steps < s->step_count - step ? step + steps : s->step_count;
  int64_t f = s->at.next_frame;
  if (frames <= 0 || s->relaxation) return until;
  while (f <= frames && frames_step(s, f) <= step)
    f++;
  if (f <= frames && frames_step(s, f) < until) until = frames_step(s, f);
  return until;
}

static void begin(simulation *s) {
  if (s->at.begun) return;
  s->at.begun = 1;
  if (s->relaxation) relaxation_begin(s->relaxation);
  loads_begin(s->loads, s->body);
  if (!s->relaxation) {
    sweep_observe(s->state);
    loads_set_back(s->loads, s->body);
    monitors_step(s->monitors, 0);
  }
}

void simulation_observe(simulation *s) {
  begin(s);
  if (s->observed_step == s->at.step) return;
  sweep_observe(s->state);
  loads_observe(s->loads, s->body, (long)s->at.step);
  s->observed_step = s->at.step;
}

static void run_team(simulation *s) {
  const team_work work = {.of = s, .block = do_stage, .next = after_stage};
  team_begin(s->team, next_task(s));
#pragma omp parallel num_threads(s->body->block_count)
  {
    const unsigned environment = subnormals_off();
    team_join(s->team, &work);
    subnormals_restore(environment);
  }
}

/* Of all blocks, a thread's share; when it does not work, it waits. */
static void sum_profile(profile *p, const body *w) {
  const double share = 1.0 / w->block_count;
  double *part = p->part;
  part[PROFILE_LAW] = part[PROFILE_PARTICLES] = 0;
  part[PROFILE_SAMPLING] = p->sampled;
  part[PROFILE_LOADS] = p->loaded;
  memset(p->pass, 0, sizeof p->pass);
  for (int k = 0; k < w->block_count; k++) {
    const body_block *b = &w->blocks[k];
    part[PROFILE_LAW] += share * (b->stepping - b->moving);
    part[PROFILE_PARTICLES] += share * b->moving;
    part[PROFILE_LOADS] += share * b->loading;
    part[PROFILE_SAMPLING] += share * b->observing;
    for (int n = 0; n < BODY_TIMED_PASSES; n++)
      p->pass[n] += share * b->passes[n];
  }
  part[PROFILE_WAITING] = p->elapsed - part[PROFILE_LAW] - part[PROFILE_PARTICLES] -
                          part[PROFILE_SAMPLING] - part[PROFILE_LOADS];
}

step_status simulation_advance(simulation *s, long steps,
                               const volatile sig_atomic_t *interrupted) {
  if (s->at.status != STEP_OK) return (step_status)s->at.status;
  s->until = next_stop(s, steps);
  s->interrupted = interrupted;
  s->go_on = s->at.step < s->until && !(interrupted && *interrupted);
  const double begun = s->profile ? monotonic_seconds() : 0;
  begin(s);
  s->observe = s->at.samples == 0;
  run_team(s);
  if (s->profile) {
    s->profile->elapsed += monotonic_seconds() - begun;
    sum_profile(s->profile, s->body);
  }
  if (s->at.status == STEP_OK && s->at.step == s->step_count) s->at.status = STEP_END;
  return (step_status)s->at.status;
}
