#include "runtime/simulation/simulation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/analysis/implied.h"
#include "runtime/base/subnormals.h"
#include "runtime/continuum/point_law.h"
#include "runtime/deck/group_run.h"
#include "runtime/parts/law_fits.h"
#include "runtime/parts/link_limit.h"
#include "runtime/parts/run_start.h"
#include "runtime/simulation/fields_fit.h"
#include "runtime/simulation/modes.h"
#include "runtime/simulation/monitor_setup.h"
#include "runtime/simulation/simulation_state.h"
#include "runtime/simulation/step_shrink.h"
#include "runtime/simulation/time_loop.h"

/* --- set-up ----------------------------------------------------------------------------------- */

/* Everything that can be said of the deck with these lattices, or nothing and true. Laws and
   parameters may be missing, when they are wrong themselves. */
static bool is_sound(simulation *s, rows *const *lattices, diagnostics *d) {
  const deck *k = s->deck;
  rows **built = must_calloc((size_t)s->body_count + 1, sizeof *built);
  bool good = true;
  if (lattices) memcpy(built, lattices, (size_t)s->body_count * sizeof *built);
  for (int b = 0; b < s->body_count; b++)
    good = run_body_open(&s->bodies[b], k, built, d) && good;
  free(built);
  for (int b = 0; b < s->body_count; b++)
    if (!s->bodies[b].fits) return false;
  if (!bodies_fit(k, s->bodies, s->body_count, d) ||
      !run_links_are_free(s->bodies, s->body_count, k, d))
    return false;
  const bool frames =
                 deck_lacks(k, "output") || frames_check(&k->output, s->bodies, s->body_count, d),
             watched = monitors_check(k, s->bodies, s->body_count, d);
  return good && frames && watched;
}

static run_body *body_of(const simulation *s, int lattice) {
  int b = 0;
  while (s->bodies[b].lattice != lattice)
    b++;
  return &s->bodies[b];
}

/* The step that ties allow: those of each mesh. */
static void shorten_by_ties(simulation *s) {
  for (int m = 0; m < s->body_count; m++) {
    const run_body *with = &s->bodies[m];
    if (!with->cells) continue;
    const int nodes = mesh_node_count(&with->cells->mesh);
    tied_node *node = must_calloc((size_t)nodes, sizeof *node);
    const run_body *fastest = NULL;
    for (long p = 0; p < with->lattice_rows->particle_count; p++) {
      const long site = with->lattice_rows->particle_site[p];
      node[cells_node(with->cells, site)].mass = with->lattice_rows->site_mass[site];
    }
    for (int b = 0; b < s->body_count; b++)
      for (int n = 0; n < s->bodies[b].tie_count; n++) {
        const run_body *of = &s->bodies[b];
        if (of->ties[n].mesh != with->lattice) continue;
        mesh_tie_add(&of->ties[n], of->lattice_rows, node);
        if (!fastest || of->limit.limit < fastest->limit.limit) fastest = of;
      }
    if (fastest && mesh_tie_limit(node, nodes, &with->limit, &fastest->limit, &s->limit))
      s->ruling = (int)(fastest - s->bodies);
    free(node);
  }
}

/* The run begins as if nothing touched. */
static void look_at_touching(simulation *s, touch_rates *touching) {
  step_limit together = s->limit;
  int ruling = s->ruling;
  link_limit(s->bodies, s->body_count, touching, &together, &ruling);
  s->touching = together.limit;
  for (int b = 0; b < s->body_count; b++)
    touching[b] = (touch_rates){0, 0};
}

/* The shortest of the bodies' steps is that of the run. */
static bool choose_step(simulation *s, diagnostics *d) {
  for (int b = 1; b < s->body_count; b++)
    if (s->bodies[b].limit.limit < s->bodies[s->ruling].limit.limit) s->ruling = b;
  s->limit = s->bodies[s->ruling].limit;
  touch_rates *touching = must_calloc((size_t)s->body_count + 1, sizeof *touching);
  const bool known =
      run_contacts_open(&s->contacts, s->deck, s->bodies, s->body_count, touching, d) &&
      run_stamps_open(&s->stamps, s->deck, s->bodies, s->body_count, touching, d);
  if (s->deck->simulation.shrink_every > 0) look_at_touching(s, touching);
  link_limit(s->bodies, s->body_count, touching, &s->limit, &s->ruling);
  free(touching);
  if (!known) return false;
  shorten_by_ties(s);
  const run_body *rules = &s->bodies[s->ruling];
  return step_choose(s->deck, rules->law, s->body_count > 1 ? rules->name : NULL, &s->limit, d);
}

static int most(int a, int b) {
  return a > b ? a : b;
}

static void open_ties(simulation *s) {
  s->ties = must_calloc((size_t)s->deck->tie_count + 1, sizeof *s->ties);
  for (int b = 0; b < s->body_count; b++)
    for (int n = 0; n < s->bodies[b].tie_count; n++) {
      run_body *of = &s->bodies[b], *other = body_of(s, of->ties[n].mesh);
      of->tied = other->tied = true;
      tie_steps_open(&s->ties[s->tie_count], &of->ties[n], s->tie_count,
                     (tied_body){of->body, of->loads}, (tied_body){other->body, other->loads},
                     other->cells, of->laws[0].state, of->laws[0].parameters);
      s->tie_count++;
    }
  for (int b = 0; b < s->body_count && s->tie_count > 0; b++)
    loads_links_added(s->bodies[b].loads);
}

/* Young's modulus along x of a mesh's law at rest, as it holds in the plane, Pa. */
static double modulus_of_mesh(const run_body *of) {
  double t[3][3];
  point_law *at = point_law_new(of->laws[0].law, of->laws[0].parameters);
  point_law_tangent(at, (double[3]){0}, mesh_cell_size(&of->cells->mesh, 0), t);
  point_law_free(at);
  return t[0][0] - t[0][1] * t[1][0] / t[1][1];
}

/* Of bodies with one law each, and lattices that a law implies something of. */
static void warn_of_moduli(simulation *s, diagnostics *d) {
  const double most = 0.05;
  for (int b = 0; b < s->body_count; b++)
    for (int n = 0; n < s->bodies[b].tie_count; n++) {
      const run_body *of = &s->bodies[b], *tied = body_of(s, of->ties[n].mesh);
      implied_elasticity e;
      if (of->law_count > 1 || tied->law_count > 1 || of->lattice_rows->list ||
          !implied_elastic(of->law, of->laws[0].parameters, of->lattice_rows, &e))
        continue;
      const double E = modulus_of_mesh(tied);
      if (!(fabs(e.E[0] / E - 1) > most)) continue;
      diag_report(d, DIAG_DECK_WARNING, of->ties[n].from->item.where,
                  "`%s` has E = %.4g GPa and `%s` has %.4g GPa: waves are thrown back at the tie, "
                  "and stresses differ",
                  of->name, 1e-9 * e.E[0], tied->name, 1e-9 * E);
      diag_hint(d, "give the law of the mesh the E and nu of the lattice");
    }
}

/* Their blocks are dealt out to a team with as many as the largest body has. */
static bool open_bodies(simulation *s, diagnostics *d) {
  bool good = true;
  int32_t particles = 0;
  int blocks = 0;
  for (int b = 0; b < s->body_count; b++) {
    run_body *of = &s->bodies[b];
    good = run_body_begin(of, s->deck, s->limit.step, d) && good;
    of->first_particle = particles;
    of->first_block = blocks;
    particles += (int32_t)run_body_particles(of);
    blocks += of->body->block_count;
    s->blocks = most(s->blocks, of->body->block_count);
    s->step_stages = most(s->step_stages, of->state->engine.step_stages);
    s->observe_stages = most(s->observe_stages, of->state->engine.observe_stages);
  }
  for (int b = 0; b < s->body_count; b++)
    s->bodies[b].first_block %= s->blocks;
  s->team = team_new(s->blocks);
  s->links = run_links_new(s->bodies, s->body_count, &s->link_count);
  s->link_stages = s->link_count > 0 ? RUN_LINK_STAGES : 0;
  if (good) {
    warn_of_moduli(s, d);
    open_ties(s);
  }
  run_contacts_begin(&s->contacts, s->deck->simulation.shrink_every > 0 ? STEP_LOOKS_AHEAD : 0);
  run_stamps_begin(&s->stamps, &s->contacts);
  return good;
}

/* --- what follows from frequencies ------------------------------------------------------------ */

static bool is_held(const simulation *s) {
  for (int b = 0; b < s->body_count; b++)
    if (s->bodies[b].loads->constraint_count > 0) return true;
  return false;
}

/* The highest mode that the deck asks about, 0 where it asks about none; *where it does so. */
static int modes_asked(const simulation *s, span *where) {
  const deck *k = s->deck;
  int most = k->simulation.periods > 0;
  *where = deck_where(&k->simulation.item, "end_time");
  for (int n = 0; n < k->damping_count; n++)
    if (k->dampings[n].ratio > 0 && k->dampings[n].mode > most) {
      most = k->dampings[n].mode;
      *where = deck_where(&k->dampings[n].item, "ratio");
    }
  return most;
}

/* Their frequencies. False after a message. */
static bool find_omegas(simulation *s, int most, span where, diagnostics *d) {
  mode *modes = must_calloc((size_t)most, sizeof *modes);
  mode_count count = {.found = 0};
  const char *why = is_held(s) ? modes_find(s, most, modes, &count) : "nothing holds them";
  s->omegas = must_calloc((size_t)most, sizeof *s->omegas);
  for (int k = 0; k < count.found; k++)
    s->omegas[k] = modes[k].omega;
  modes_free(modes, count.found, s->body_count);
  free(modes);
  if (why)
    diag_report(d, DIAG_BAD_VALUE, where, "the bodies have no frequency to go by: %s", why);
  else if (count.found < most)
    diag_report(d, DIAG_BAD_VALUE, where, "the bodies have no mode %d, but %d", most, count.found);
  else
    return true;
  diag_hint(d, "give `end_time` in seconds, and damping as a `rate`");
  return false;
}

static bool take_frequencies(simulation *s, diagnostics *d) {
  deck *k = &s->own;
  span where;
  const int most_asked = modes_asked(s, &where);
  if (most_asked == 0) return true;
  if (!find_omegas(s, most_asked, where, d)) return false;
  for (int n = 0; n < k->damping_count; n++)
    if (s->dampings[n].ratio > 0)
      s->dampings[n].rate = 2 * s->dampings[n].ratio * s->omegas[s->dampings[n].mode - 1];
  if (k->simulation.periods == 0) return true;
  k->simulation.end_time = k->simulation.periods * (2 * M_PI / s->omegas[0]);
  return deck_samples_fit(&k->output, k->simulation.end_time, d);
}

static void open_clock(simulation *s) {
  if (s->deck->relaxation.increments > 0)
    s->relaxation =
        relaxation_new(s->deck, s->bodies, s->body_count, s->limit.step / s->limit.limit);
  s->clock = (run_clock){
      .time_step = s->limit.step, .step_count = s->plan.step_count, .relaxation = s->relaxation};
  s->clock.at.last_frame_step = s->clock.at.stop = s->clock.at.looked = s->observed_step = -1;
}

/* Everything that a static run is to solve has a solution. */
static bool can_stand(const simulation *s, diagnostics *d) {
  const deck *k = s->deck;
  bool good = true;
  for (int b = 0; b < s->body_count; b++)
    good = (!s->bodies[b].rest ||
            mesh_rest_check(s->bodies[b].rest, s->bodies[b].name,
                            deck_where(&k->lattices[s->bodies[b].lattice].item, "name"),
                            k->relaxation.increments, s->relaxation->interval, d)) &&
           good;
  return good;
}

static bool open_monitors(simulation *s, diagnostics *d) {
  const deck *k = s->deck;
  s->monitors = monitors_new(k, s->bodies, s->body_count, s->links, s->link_count, &s->stamps,
                             s->relaxation ? s->relaxation->interval : s->limit.step, d);
  if (!s->monitors) return false;
  s->history = history_new(s->monitors, &s->contacts, &s->stamps, s->relaxation,
                           k->simulation.shrink_every > 0 ? &s->clock : NULL, k->output.energy,
                           s->plan.history_capacity);
  return true;
}

static bool open_frames(simulation *s, diagnostics *d) {
  const frame_field *fields;
  frame_times_open(&s->frame_times, s->deck, &s->clock);
  s->frames = frames_new(&s->deck->output, s->bodies, s->body_count, s->monitors, &s->clock);
  const int count = frames_fields(s->frames, &fields);
  return fields_fit_result(s->deck, s->bodies, fields, count, d);
}

static bool set_up(simulation *s, rows *const *lattices, diagnostics *d) {
  if (!is_sound(s, lattices, d) || deck_lacks(s->deck, NULL)) return false;
  if (!choose_step(s, d) || !open_bodies(s, d) || !take_frequencies(s, d)) return false;
  if (!step_fits(s->deck, &s->limit, d) || !step_plan_make(s->deck, &s->limit, &s->plan, d))
    return false;
  if (!run_start(s->bodies, s->body_count, &s->contacts, &s->stamps, s->deck, &s->started_from, d))
    return false;
  if (!run_stamps_fit(&s->stamps, s->limit.step, d)) return false;
  open_clock(s);
  if (!can_stand(s, d)) return false;
  if (!open_monitors(s, d) || !open_frames(s, d)) return false;
  run_contacts_warn(s->deck, s->bodies, d);
  s->bad = bad_search_new(s->bodies, s->body_count, &s->clock);
  return true;
}

static void take_deck(simulation *s, const deck *k) {
  const size_t count = (size_t)k->damping_count;
  s->own = *k;
  s->deck = &s->own;
  s->own.dampings = s->dampings = must_alloc((count + 1) * sizeof *s->dampings);
  if (count > 0) memcpy(s->dampings, k->dampings, count * sizeof *s->dampings);
}

static void take_laws(simulation *s, const simulation_law *laws) {
  const deck *k = s->deck;
  s->law_count = k->interaction_count;
  s->laws = must_calloc((size_t)s->law_count + 1, sizeof *s->laws);
  s->cracks = must_calloc((size_t)k->crack_count + 1, sizeof *s->cracks);
  for (int n = 0; n < k->crack_count; n++)
    s->cracks[n] = (tip_law){laws[s->law_count + n].law, laws[s->law_count + n].parameters};
  for (int b = 0; b < s->body_count; b++)
    s->bodies[b].cracks = s->cracks;
  for (int n = 0; n < s->law_count; n++) {
    run_body *of = &s->bodies[k->interactions[n].lattice];
    s->laws[n] = (run_law){.from = &k->interactions[n],
                           .law = laws[n].law,
                           .parameters = laws[n].parameters,
                           .regional = laws[n].regional,
                           .regional_count = laws[n].regional_count};
    if (of->law_count++ == 0) of->laws = &s->laws[n];
    of->lattice = k->interactions[n].lattice;
  }
}

simulation *simulation_new_on(rows *const *lattices, const deck *k, const simulation_law *laws,
                              diagnostics *d) {
  simulation *s = must_calloc(1, sizeof *s);
  take_deck(s, k);
  s->body_count = k->lattice_count;
  s->bodies = must_calloc((size_t)s->body_count + 1, sizeof *s->bodies);
  take_laws(s, laws);
  if (set_up(s, lattices, d) && d->errors == 0) return s;
  simulation_free(s);
  return NULL;
}

simulation *simulation_new(const deck *k, const simulation_law *laws, diagnostics *d) {
  return simulation_new_on(NULL, k, laws, d);
}

void simulation_free(simulation *s) {
  if (!s) return;
  monitors_free(s->monitors);
  frames_free(s->frames);
  frame_times_close(&s->frame_times);
  relaxation_free(s->relaxation);
  history_free(&s->history);
  bad_search_free(s->bad);
  run_links_free(s->links, s->link_count);
  for (int n = 0; n < s->tie_count; n++)
    tie_steps_close(&s->ties[n]);
  free(s->ties);
  run_contacts_free(&s->contacts);
  run_stamps_free(&s->stamps);
  for (int b = 0; b < s->body_count; b++)
    run_body_free(&s->bodies[b]);
  team_free(s->team);
  free(s->dampings);
  free(s->omegas);
  free(s->bodies);
  free(s->cracks);
  free(s->laws);
  free(s);
}

int simulation_bodies(const simulation *s) {
  return s->body_count;
}

const parameter_planes *simulation_planes(const simulation *s, int interaction) {
  return s->laws[interaction].planes;
}

const rows *simulation_law_rows(const simulation *s, int interaction) {
  return s->laws[interaction].rows;
}

const deck *simulation_deck(const simulation *s) {
  return s->deck;
}

double simulation_omega(const simulation *s, int number) {
  return s->omegas[number - 1];
}

const rows *simulation_rows(const simulation *s, int number) {
  return s->bodies[number].lattice_rows;
}

const mesh_tie *simulation_ties(const simulation *s, int number, int *count) {
  *count = s->bodies[number].tie_count;
  return s->bodies[number].ties;
}

long simulation_damaged_ties(const simulation *s, int number) {
  return run_body_damaged_ties(&s->bodies[number]);
}

double simulation_sample_interval(const simulation *s) {
  return s->plan.sample_interval;
}

double simulation_limit_now(const simulation *s, int number) {
  return run_body_limit_now(&s->bodies[number]);
}

const cells *simulation_cells(const simulation *s, int number) {
  return s->bodies[number].cells;
}

const step_limit *simulation_step_limit(const simulation *s) {
  return &s->limit;
}
int simulation_ruling_body(const simulation *s) {
  return s->ruling;
}
long simulation_step_count(const simulation *s) {
  return (long)s->clock.step_count;
}
long simulation_step_done(const simulation *s) {
  return (long)s->clock.at.step;
}
long simulation_steps_taken(const simulation *s) {
  return (long)(s->clock.at.step + s->clock.at.more);
}
double simulation_touching_limit(const simulation *s) {
  return s->touching;
}
double simulation_step_now(const simulation *s) {
  return run_clock_step(&s->clock);
}
const step_change *simulation_step_changes(const simulation *s, int *count) {
  *count = (int)s->clock.at.change_count;
  return s->clock.at.changes;
}
result_state *simulation_take_state(const simulation *s) {
  if (s->clock.at.status == STEP_BAD) return NULL;
  return run_state_take(s->bodies, s->body_count, &s->contacts, &s->stamps, s->deck,
                        s->relaxation ? 0 : run_clock_step(&s->clock));
}
run_going simulation_going(const simulation *s, int number) {
  return s->bodies[number].going;
}
uint64_t simulation_started_from(const simulation *s) {
  return s->started_from;
}
double simulation_progress(const simulation *s) {
  return (double)run_clock_position(&s->clock) / (double)run_clock_end(&s->clock);
}
double simulation_stiffened(const simulation *s) {
  return s->relaxation ? 1 / (s->relaxation->state.part * s->relaxation->state.part) : 1;
}

long simulation_increments_within(const simulation *s) {
  return s->relaxation ? (long)s->relaxation->state.within : 0;
}

long simulation_increments(const simulation *s, long *unbalanced) {
  *unbalanced = s->relaxation ? (long)s->relaxation->state.unbalanced : 0;
  return s->relaxation ? (long)s->relaxation->state.done : 0;
}
double simulation_time(const simulation *s) {
  return run_clock_time(&s->clock);
}
int simulation_threads(const simulation *s) {
  return s->blocks;
}
sweep *simulation_state(simulation *s, int number) {
  return s->bodies[number].state;
}

sweep *simulation_law_state(simulation *s, int interaction) {
  return s->laws[interaction].state;
}

double simulation_memory(const simulation *s) {
  double sum =
      (double)sizeof(double) * ((double)s->history.capacity * (s->history.series_count + 1) +
                                (double)s->monitors->ring_size);
  sum += run_contacts_memory(&s->contacts) + run_stamps_memory(&s->stamps);
  for (int b = 0; b < s->body_count; b++) {
    const run_body *of = &s->bodies[b];
    const double looks = s->relaxation ? (double)sizeof(double) * (2 * of->body->dof + 1) : 0;
    sum += run_body_memory(of) + looks * (double)of->lattice_rows->size;
  }
  return sum;
}

double simulation_loaded_length(const simulation *s, int force, long *particles) {
  double sum = 0;
  *particles = 0;
  for (int b = 0; b < s->body_count; b++) {
    long here;
    sum += loads_shares_of(s->bodies[b].loads, force, &here);
    *particles += here;
  }
  return sum;
}

double simulation_point_mass(const simulation *s, int index, long *particles) {
  double sum = 0;
  *particles = 0;
  for (int b = 0; b < s->body_count; b++) {
    long here;
    sum += loads_point_mass_of(s->bodies[b].loads, index, &here);
    *particles += here;
  }
  return sum;
}

double simulation_frame_came(const simulation *s, int frame) {
  return s->frame_times.came[frame];
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

overlap_found simulation_overlap(simulation *s) {
  overlap_found found = {.pairs = 0};
  if (s->deck->contact_count > 0 || s->clock.at.status == STEP_BAD) return found;
  const unsigned environment = subnormals_off();
  const contact_overlap o = run_contacts_overlap(s->deck, s->bodies);
  s->observed_step = -1;
  subnormals_restore(environment);
  found.pairs = o.pairs;
  for (int e = 0; e < 2 && o.pairs > 0; e++) {
    found.body[e] = o.body[e];
    found.particle[e] = s->bodies[o.body[e]].lattice_rows->site_particle[o.site[e]];
  }
  return found;
}

contact_said simulation_contact(const simulation *s, int number) {
  const contact_peaks *p = &s->contacts.items[number].peaks;
  return (contact_said){(long)p->pairs, p->force, p->stored};
}

stamp_said simulation_stamp(const simulation *s, int number) {
  const run_stamp *of = &s->stamps.items[number];
  const stamp_state *st = &of->state;
  stamp_said said = {
      .touching = (long)st->peaks.touching, .force = st->peaks.force, .too_far = of->too_far};
  for (int c = 0; c < 3; c++) {
    said.place[c] = st->at.place[c];
    said.velocity[c] = st->at.velocity[c];
  }
  return said;
}

double simulation_stamp_gap(const simulation *s, int number, int *lattice) {
  const run_stamp *of = &s->stamps.items[number];
  const stamp_inside in = stamp_look_inside(of->found, of->state.at.place, 0);
  const run_body *nearest = &s->bodies[of->of[in.body]];
  *lattice = nearest->lattice;
  return fabs(in.depth) < 1e-6 * nearest->lattice_rows->spacing ? 0 : -in.depth;
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
  *unchecked = NULL;
  for (int b = 0; b < s->body_count && !*unchecked; b++)
    *unchecked = ledger_why(&s->bodies[b].energies);
  return history_imbalance(&s->history, -1);
}

double simulation_largest_energy(const simulation *s) {
  return history_largest_energy(&s->history, s->clock.at.samples);
}

bool simulation_judges(const simulation *s, int series, const char **unchecked) {
  if (series == simulation_imbalance(s, unchecked)) return true;
  for (int b = 0; b < s->body_count; b++) {
    *unchecked = ledger_why(&s->bodies[b].energies);
    if (series == history_imbalance(&s->history, b)) return true;
  }
  *unchecked = NULL;
  for (int k = 0; k < s->contacts.count + s->stamps.count; k++)
    if (series == history_imbalance(&s->history, s->body_count + k)) return true;
  return false;
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
  return frame_times_due(&s->frame_times);
}

void simulation_frame_taken(simulation *s) {
  frame_times_taken(&s->frame_times, &s->clock.at);
}

double simulation_monitor_peak(const simulation *s, int index, double *time) {
  const monitor_state *m = &s->monitors->items[index].state;
  if (time) *time = m->peak_time;
  return m->peak;
}

void simulation_measure(simulation *s, profile *p) {
  s->profile = p;
}
