#include "runtime/simulation/monitor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/base/symmetric_tensor.h"
#include "runtime/deck/deck_value.h"
#include "runtime/deck/group_monitor.h"
#include "runtime/interaction/damage.h"
#include "runtime/loads/load_steps.h"

/* --- set-up ----------------------------------------------------------------------------------- */

static bool counts_damage(const deck_monitor *m) {
  return m->kind == MONITOR_DAMAGED || m->kind == MONITOR_BROKEN;
}

/* A component of the motion of particles, or of the forces on them. */
static bool has_component(const deck_monitor *m) {
  return m->kind == MONITOR_REACTION || m->kind == MONITOR_REACTIONS ||
         m->kind == MONITOR_APPLIED || m->kind == MONITOR_DISPLACEMENT ||
         m->kind == MONITOR_VELOCITY || m->kind == MONITOR_OPENING ||
         m->kind == MONITOR_ACCELERATION || m->kind == MONITOR_MOMENTUM ||
         m->kind == MONITOR_CONTACT_FORCE;
}

static bool follows_cracks(const deck_monitor *m) {
  return m->kind == MONITOR_TIP || m->kind == MONITOR_TIP_SPEED || m->kind == MONITOR_CRACK_WIDTH;
}

/* Of the first region that it watches, or of the second: the name of its lattice, or NULL. */
static const char *lattice_of(const deck *k, const deck_monitor *m, int end) {
  const char *region = end || m->between[0] ? m->between[end] : m->region;
  const int r = region ? deck_find_region(k, region) : -1;
  return r >= 0 ? k->regions[r].lattice : end ? NULL : m->lattice;
}

/* NULL where it watches all bodies, or has no second region. */
static const run_body *body_of(const deck *k, const run_body *bodies, int count,
                               const deck_monitor *m, int end) {
  const char *lattice = lattice_of(k, m, end);
  for (int b = 0; b < count && lattice; b++)
    if (strcmp(bodies[b].name, lattice) == 0) return &bodies[b];
  return !lattice && !end && count == 1 ? bodies : NULL;
}

/* Of a region, or all (NULL). */
static void take_sites(monitor *m, int list, const monitors *all, const char *name) {
  const run_body *of = m->of[list];
  if (!of) return;
  const rows *g = of->lattice_rows;
  const region_sites *at = name ? &of->loads->regions[deck_find_region(all->deck, name)] : NULL;
  const long count = at ? at->count : g->particle_count;
  m->indices[list] = must_calloc((size_t)count + 1, sizeof(int32_t));
  m->index_count[list] = count;
  for (long p = 0; p < count; p++)
    m->indices[list][p] = g->particle_site[at ? at->particles[p] : p];
}

static void take_reactions(monitor *m, int list, const monitors *all, const char *name) {
  const run_body *of = m->of[list];
  if (of)
    m->index_count[list] = loads_constraints_of(of->loads, deck_find_region(all->deck, name),
                                                m->deck->component, &m->indices[list]);
}

static void take_forces(monitor *m, const monitors *all, diagnostics *d) {
  const run_body *of = m->of[0];
  m->index_count[0] = loads_forces_of(of->loads, deck_find_region(all->deck, m->deck->region),
                                      m->deck->component, &m->indices[0]);
  if (m->index_count[0] > 0) return;
  diag_report(d, DIAG_CONFLICT, m->deck->item.where,
              "this is always 0: no `&force` or `&end_moment` acts %s `%s` on particles of `%s`",
              m->deck->component < of->body->dimensions ? "along" : "in",
              deck_component_name(of->body->dimensions, m->deck->component), m->deck->region);
}

/* Particles of a link to places that are copies of places: all, or the one nearest to `at`. */
static void take_places(monitor *m, const monitors *all, diagnostics *d) {
  const rows *g = m->of[0]->lattice_rows;
  int32_t *sites = must_calloc((size_t)g->particle_count + 1, sizeof *sites);
  long count = 0;
  for (int k = 0; k < all->link_count; k++)
    if (all->links[k].own == m->of[0]) m->link = &all->links[k];
  m->indices[0] = must_calloc((size_t)g->particle_count + 1, sizeof(int32_t));
  for (long n = 0; n < g->bond_count; n++) { /* the bar's particle, then the place */
    sites[count] = g->particle_site[2 * n];
    m->indices[0][count++] = (int32_t)(2 * n + 1);
  }
  const long best = m->deck->placed ? watched_nearest(m->deck, g, sites, count, d) : 0;
  if (m->deck->placed && best >= 0) {
    m->indices[0][0] = m->indices[0][best];
    count = 1;
  }
  m->index_count[0] = count;
  free(sites);
}

/* The tip that has that folder in the history. */
static void take_tip(monitor *m, const monitors *all, diagnostics *d) {
  enum { MOST = 64, LENGTH = 256 };
  char folders[MOST][LENGTH];
  const char *names[MOST];
  int count = 0;
  for (int b = 0; b < all->body_count; b++) {
    const cells *c = all->bodies[b].cells;
    for (int n = 0; c && c->tips && n < c->tips->count && count < MOST; n++) {
      names[count] = tip_folder(c->tips, n, folders[count], LENGTH);
      if (strcmp(names[count++], m->deck->crack) != 0) continue;
      m->tips = c->tips;
      m->tip = n;
      return;
    }
  }
  diag_report(d, DIAG_UNKNOWN_NAME, deck_where(&m->deck->item, "crack"), "there is no tip `%s`",
              m->deck->crack);
  deck_suggest(d, m->deck->crack, names, count, "a monitor can watch");
}

static bool check_component(const deck_monitor *m, const pl_law *law, diagnostics *d) {
  if (!has_component(m) || m->component < law->dof) return true;
  diag_report(d, DIAG_BAD_VALUE, deck_where(&m->item, "component"),
              "the particles of the law `%s` do not rotate", law->name);
  return false;
}

static bool law_can_be_damaged(const pl_law *law) {
  return damage_on_bonds(law) || damage_on_particles(law);
}

static bool can_be_damaged(const run_body *b) {
  for (int n = 0; n < b->law_count; n++)
    if (law_can_be_damaged(b->laws[n].law)) return true;
  return false;
}

static bool check_damage(const deck_monitor *m, const run_body *bodies, int count, diagnostics *d) {
  bool some = !counts_damage(m) && !follows_cracks(m);
  for (int b = 0; b < count; b++)
    some = some || can_be_damaged(&bodies[b]);
  if (some) return true;
  const char *task = follows_cracks(m) ? "follow" : "count";
  if (bodies[0].cells && follows_cracks(m)) {
    diag_report(d, DIAG_BAD_VALUE, deck_where(&m->item, "kind"),
                "this follows damage, and the law `%s` of the mesh `%s` has none",
                bodies[0].law->name, bodies[0].name);
    diag_hint(d, "a `&crack` is watched by kind = 'crack'");
    return false;
  }
  if (count > 1 || bodies[0].law_count > 1)
    diag_report(d, DIAG_BAD_VALUE, deck_where(&m->item, "kind"),
                "none of the laws has damage to %s", task);
  else
    diag_report(d, DIAG_BAD_VALUE, deck_where(&m->item, "kind"), "the law `%s` has no damage to %s",
                bodies[0].law->name, task);
  return false;
}

/* By its place among the law's fields, then outputs. */
static const pl_field *law_field(const pl_law *law, int k) {
  return k < law->field_count ? &law->fields[k] : &law->outputs[k - law->field_count];
}

/* Particles have it; of points nodes have the mean around. */
static bool is_watchable(const pl_field *f) {
  return f->place == PL_ON_PARTICLE || f->place == PL_ON_POINT;
}

static int find_field(const deck_monitor *m, const pl_law *law) {
  for (int k = law->field_count + law->output_count - 1; k >= 0; k--) {
    const pl_field *f = law_field(law, k);
    if (is_watchable(f) && strcasecmp(f->name, m->field) == 0) return k;
  }
  return -1;
}

/* The first law of the body that has the field; NULL: none. */
static const run_law *law_with_field(const deck_monitor *m, const run_body *of) {
  for (int n = 0; n < of->law_count; n++)
    if (find_field(m, of->laws[n].law) >= 0) return &of->laws[n];
  return NULL;
}

static bool check_field(const deck_monitor *m, const run_body *of, diagnostics *d) {
  if (m->kind != MONITOR_FIELD || law_with_field(m, of)) return true;
  const pl_law *law = of->law;
  const int count = law->field_count + law->output_count;
  const char **names = must_calloc((size_t)count + 1, sizeof *names);
  int there = 0;
  for (int k = 0; k < count; k++)
    if (is_watchable(law_field(law, k))) names[there++] = law_field(law, k)->name;
  diag_report(d, DIAG_BAD_VALUE, deck_where(&m->item, "field"), "the law `%s` has no `%s` %s",
              law->name, m->field, of->cells ? "at points" : "on particles");
  deck_suggest(d, m->field, names, there, "a monitor can watch");
  free(names);
  return false;
}

bool monitors_check(const deck *k, const run_body *bodies, int count, diagnostics *d) {
  bool good = true;
  for (int i = 0; i < k->monitor_count; i++) {
    const deck_monitor *m = &k->monitors[i];
    const run_body *first = body_of(k, bodies, count, m, 0);
    good = check_damage(m, first ? first : bodies, first ? 1 : count, d) && good;
    for (int end = 0; end < 2; end++) {
      const run_body *of = body_of(k, bodies, count, m, end);
      good = (!of || (check_component(m, of->law, d) && check_field(m, of, d))) && good;
    }
  }
  return good;
}

static bool find_steps(monitor *m, const monitors *all, diagnostics *d) {
  static const double most = 1e8; /* values in a ring */
  const double dt = all->interval, steps = m->deck->average / dt;
  m->zero_step = m->deck->zero_at >= 0 ? lround(pl_fmin(m->deck->zero_at / dt, 9e15)) : -1;
  m->window = 1;
  if (counts_damage(m->deck) || m->deck->average <= 0) return true;
  if (steps <= most) {
    m->window = steps < 1 ? 1 : lround(steps);
    return true;
  }
  diag_report(d, DIAG_BAD_VALUE, deck_where(&m->deck->item, "average"),
              "a mean over %.3g steps of %.3g s does not fit into memory", steps, dt);
  return false;
}

static monitor_time when_known(const monitor *m, const monitors *all) {
  if (all->deck->relaxation.increments > 0) return KNOWN_WHEN_OBSERVED;
  switch (m->deck->kind) {
  case MONITOR_FIELD:
    return m->field < m->law->law->field_count && !m->of[0]->cells ? KNOWN_ONE_LATE
                                                                   : KNOWN_WHEN_OBSERVED;
  case MONITOR_REACTION:
  case MONITOR_REACTIONS:
  case MONITOR_TIP:
  case MONITOR_TIP_SPEED:
    return KNOWN_ONE_LATE;
  case MONITOR_MOMENTUM:
  case MONITOR_ANGULAR_MOMENTUM:
  case MONITOR_ENERGY:
  case MONITOR_FORCE:
  case MONITOR_MOMENT:
  case MONITOR_BAR_FORCE:
  case MONITOR_STRESS:
  case MONITOR_CRACK_WIDTH:
    return KNOWN_WHEN_OBSERVED;
  default:
    return KNOWN_AFTER_STEP;
  }
}

static bool is_field_of_mesh(const deck_monitor *m) {
  return m->kind == MONITOR_DISPLACEMENT || m->kind == MONITOR_OPENING ||
         m->kind == MONITOR_VELOCITY || m->kind == MONITOR_ACCELERATION ||
         m->kind == MONITOR_STRAIN || m->kind == MONITOR_STRESS;
}

/* Fields of a mesh (mesh_gauge.h). */
static void take_gauges(monitor *m, const monitors *all, diagnostics *d) {
  const bool opening = m->deck->kind == MONITOR_OPENING;
  for (int end = 0; end < 1 + opening; end++) {
    const run_body *of = m->of[end];
    take_sites(m, end, all, opening ? m->deck->between[end] : m->deck->region);
    m->gauge[end] = mesh_gauge_new(m->deck, m->indices[end], m->index_count[end], of->cells,
                                   of->loads, of->body, d);
  }
}

/* All bodies of an opening are meshes. */
static bool has_gauges(const monitor *m) {
  return is_field_of_mesh(m->deck) && m->of[0] && m->of[0]->cells && (!m->of[1] || m->of[1]->cells);
}

/* The stress of tied particles is not known: their bonds bear a part of it. False with a diagnostic
   where all of them are tied. */
static bool leave_out_tied(monitor *m, diagnostics *d) {
  const run_body *of = m->of[0];
  long left = 0;
  if (m->deck->kind != MONITOR_STRESS || of->tie_count == 0) return true;
  unsigned char *tied = run_body_tied_sites(of);
  for (long p = 0; p < m->index_count[0]; p++)
    if (!tied[m->indices[0][p]]) m->indices[0][left++] = m->indices[0][p];
  free(tied);
  m->index_count[0] = left;
  if (left > 0) return true;
  diag_report(d, DIAG_EMPTY_REGION, deck_where(&m->deck->item, "region"),
              "all particles of `%s` here are tied to a mesh, which bears a part of their stress",
              of->name);
  diag_hint(d, "watch the stress of the mesh there");
  return false;
}

/* What watched.h watches, of a region or of all particles. */
static void watch(monitor *m, monitors *all, diagnostics *d) {
  const run_body *of = m->of[0];
  take_sites(m, 0, all, m->deck->region);
  if (!leave_out_tied(m, d)) return;
  damage_law *laws = run_body_damages(of);
  m->own =
      watched_new(m->deck, m->indices[0], m->index_count[0], of->state, laws, of->law_count, d);
  free(laws);
  bond_forces **forces = &all->forces[of - all->bodies];
  if (watched_needs_forces(m->deck) && !*forces) *forces = bond_forces_new(of->state);
}

/* A line through one value has no slope. */
static void check_speed(const monitor *m, const monitors *all, diagnostics *d) {
  if (m->deck->kind != MONITOR_TIP_SPEED || m->window > 1) return;
  diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&m->deck->item, "average"),
              "a speed is taken over two states at least: %.6g s and more", 2 * all->interval);
}

/* The law has the monitor's field, in the monitor's unit. */
static bool same_field(const monitor *m, const run_law *law) {
  const int k = find_field(m->deck, law->law);
  return k >= 0 && strcmp(law_field(law->law, k)->unit, m->unit) == 0;
}

/* That of the region's first particle, where it has the field. */
static const run_law *law_watched(const monitor *m) {
  const run_body *of = m->of[0];
  for (int n = 0; n < of->law_count && m->index_count[0] > 0; n++)
    if (of->laws[n].own && of->laws[n].own[m->indices[0][0]] &&
        find_field(m->deck, of->laws[n].law) >= 0)
      return &of->laws[n];
  return law_with_field(m->deck, of);
}

/* What of a node's value is a law's: by the areas of its cells around, among those of laws that
   have the field. */
static double part_of_node(const monitor *m, const run_law *law, long site) {
  double all = 0;
  if (!law->share) return 1;
  for (int n = 0; n < m->of[0]->law_count; n++)
    if (same_field(m, &m->of[0]->laws[n])) all += m->of[0]->laws[n].share[site];
  return all > 0 ? law->share[site] / all : 0;
}

/* Those with cells around of a law that has the field. */
static void keep_nodes(monitor *m, diagnostics *d) {
  const run_body *of = m->of[0];
  long kept = 0;
  for (long p = 0; p < m->index_count[0]; p++) {
    bool has = false;
    for (int n = 0; n < of->law_count; n++)
      has = has ||
            (same_field(m, &of->laws[n]) && part_of_node(m, &of->laws[n], m->indices[0][p]) > 0);
    if (has) m->indices[0][kept++] = m->indices[0][p];
  }
  m->index_count[0] = kept;
  if (kept > 0) return;
  diag_report(d, DIAG_BAD_VALUE, deck_where(&m->deck->item, "region"),
              "no node of `%s` has a cell of the law `%s` around it, whose `%s` is watched",
              m->deck->region, m->law->law->name, m->deck->field);
}

/* Other laws have no such field on their particles. */
static void check_share(const monitor *m, diagnostics *d) {
  for (long p = 0; m->law->share && p < m->index_count[0]; p++) {
    if (m->law->share[m->indices[0][p]] > 0) continue;
    diag_report(d, DIAG_BAD_VALUE, deck_where(&m->deck->item, "region"),
                "the region `%s` holds particles that are not of the law `%s`, whose `%s` is "
                "watched",
                m->deck->region, m->law->law->name, m->deck->field);
    return;
  }
}

static void new_monitor(monitors *all, int index, diagnostics *d) {
  monitor *m = &all->items[index];
  m->deck = &all->deck->monitors[index];
  m->unit = deck_monitor_unit(m->deck, has_component(m->deck) &&
                                           m->deck->component >= all->bodies[0].body->dimensions);
  m->window = 1;
  if (!find_steps(m, all, d)) return;
  for (int end = 0; end < 2; end++)
    m->of[end] = body_of(all->deck, all->bodies, all->body_count, m->deck, end);
  check_speed(m, all, d);
  if (has_gauges(m)) {
    take_gauges(m, all, d);
    m->known = when_known(m, all);
    return;
  }
  switch (m->deck->kind) {
  case MONITOR_REACTION:
    take_reactions(m, 0, all, m->deck->region);
    break;
  case MONITOR_REACTIONS:
    take_reactions(m, 0, all, m->deck->between[0]);
    take_reactions(m, 1, all, m->deck->between[1]);
    break;
  case MONITOR_APPLIED:
    take_forces(m, all, d);
    break;
  case MONITOR_OPENING:
    take_sites(m, 0, all, m->deck->between[0]);
    take_sites(m, 1, all, m->deck->between[1]);
    break;
  case MONITOR_DISPLACEMENT:
  case MONITOR_VELOCITY:
  case MONITOR_CONTACT_FORCE:
    take_sites(m, 0, all, m->deck->region);
    break;
  case MONITOR_SLIP:
    take_places(m, all, d);
    break;
  case MONITOR_CRACK:
    take_tip(m, all, d);
    break;
  case MONITOR_FIELD:
    take_sites(m, 0, all, m->deck->region);
    m->law = law_watched(m);
    m->field = find_field(m->deck, m->law->law);
    m->unit = law_field(m->law->law, m->field)->unit;
    if (m->of[0]->cells)
      keep_nodes(m, d);
    else
      check_share(m, d);
    break;
  case MONITOR_DAMAGED:
  case MONITOR_BROKEN:
    break;
  default:
    watch(m, all, d);
  }
  m->known = when_known(m, all);
}

static size_t largest_size(const run_body *bodies, int count) {
  long most = 0;
  for (int b = 0; b < count; b++)
    if (bodies[b].lattice_rows->size > most) most = bodies[b].lattice_rows->size;
  return (size_t)most;
}

monitors *monitors_new(const deck *k, const run_body *bodies, int count, const run_link *links,
                       int link_count, double interval, diagnostics *d) {
  const int before = d->errors;
  monitors *m = must_calloc(1, sizeof *m);
  *m = (monitors){.interval = interval,
                  .count = k->monitor_count,
                  .deck = k,
                  .bodies = bodies,
                  .body_count = count,
                  .links = links,
                  .link_count = link_count};
  m->items = must_calloc((size_t)m->count + 1, sizeof *m->items);
  m->forces = must_calloc((size_t)count, sizeof *m->forces);
  for (int i = 0; i < m->count; i++) {
    new_monitor(m, i, d);
    m->ring_size += m->items[i].window;
  }
  if (d->errors > before) {
    monitors_free(m);
    return NULL;
  }
  m->values = must_calloc(largest_size(bodies, count), sizeof(double));
  m->ring_memory = must_calloc((size_t)m->ring_size + 1, sizeof(double));
  double *at = m->ring_memory;
  for (int i = 0; i < m->count; at += m->items[i].window, i++)
    m->items[i].ring = at;
  return m;
}

void monitors_free(monitors *m) {
  if (!m) return;
  for (int i = 0; i < m->count; i++) {
    free(m->items[i].indices[0]);
    free(m->items[i].indices[1]);
    watched_free(m->items[i].own);
    for (int end = 0; end < 2; end++)
      mesh_gauge_free(m->items[i].gauge[end]);
  }
  for (int b = 0; m->forces && b < m->body_count; b++)
    bond_forces_free(m->forces[b]);
  free(m->forces);
  free(m->items);
  free(m->values);
  free(m->ring_memory);
  free(m);
}

/* --- in words --------------------------------------------------------------------------------- */

static char *component_words(const monitors *all, const monitor *m, const char *quantity,
                             arena *a) {
  const int c = m->deck->component, dimensions = all->bodies[0].body->dimensions;
  return arena_printf(a, "%s %s %s", quantity, c < dimensions ? "along" : "in",
                      deck_component_name(dimensions, c));
}

static char *difference_words(const monitors *all, const monitor *m, const char *quantity,
                              arena *a) {
  return arena_printf(a, "%s of `%s` less that of `%s`", component_words(all, m, quantity, a),
                      m->deck->between[1], m->deck->between[0]);
}

static char *region_words(const monitors *all, const monitor *m, const char *quantity, arena *a) {
  return arena_printf(a, "%s of `%s`", component_words(all, m, quantity, a), m->deck->region);
}

/* It watches this body, or all. */
static bool watches(const monitors *all, const monitor *m, int b) {
  return !m->of[0] || m->of[0] == &all->bodies[b];
}

static char *count_words(const monitors *all, const monitor *m, arena *a) {
  bool bonds = false, particles = false;
  for (int b = 0; b < all->body_count; b++) {
    const run_body *of = &all->bodies[b];
    for (int n = 0; n < of->law_count && watches(all, m, b); n++) {
      const pl_law *law = of->laws[n].law;
      bonds = bonds || damage_on_bonds(law);
      particles = particles || (!damage_on_bonds(law) && damage_on_particles(law));
    }
  }
  const char *of = m->deck->lattice ? arena_printf(a, " of `%s`", m->deck->lattice) : "";
  return arena_printf(a, "%s%s with %s %.6g",
                      bonds && particles ? "bonds, or particles where damage is on these,"
                      : bonds            ? "bonds"
                                         : "particles",
                      of,
                      m->deck->kind == MONITOR_BROKEN ? "a damage of at least" : "more damage than",
                      m->deck->above);
}

static char *field_words(const monitor *m, arena *a) {
  const pl_field *f = law_field(m->law->law, m->field);
  char *words = arena_printf(a, "mean `%s` of `%s`", f->name, m->deck->region);
  return f->doc && *f->doc ? arena_printf(a, "%s (%s)", words, f->doc) : words;
}

static char *slip_words(const monitors *all, const monitor *m, arena *a) {
  const rows *g = m->of[0]->lattice_rows;
  double here[3];
  char text[ROWS_PLACE_TEXT];
  if (!m->deck->placed) return arena_printf(a, "largest slip along `%s`", m->of[0]->name);
  rows_place(g, g->particle_site[m->indices[0][0] - 1], here);
  return arena_printf(a, "slip along `%s` at %s", m->of[0]->name,
                      rows_place_text(all->bodies[0].body->dimensions, here, text));
}

/* "stress xx at (3, 4) mm" */
static char *gauge_words(const monitors *all, const monitor *m, arena *a) {
  char text[ROWS_PLACE_TEXT];
  const tensor_component *t;
  const char *kind = m->deck->kind == MONITOR_STRESS ? "stress" : "strain";
  tensor_components(2, &t);
  rows_place_text(2, m->deck->at, text);
  if (!m->deck->placed && (m->deck->kind == MONITOR_STRAIN || m->deck->kind == MONITOR_STRESS))
    return arena_printf(a, "mean %s %s of `%s`", kind, t[m->deck->component].name, m->deck->region);
  if (m->deck->kind == MONITOR_STRAIN || m->deck->kind == MONITOR_STRESS)
    return arena_printf(a, "%s %s at %s", kind, t[m->deck->component].name, text);
  const char *quantity = m->deck->kind == MONITOR_ACCELERATION ? "acceleration"
                         : m->deck->kind == MONITOR_VELOCITY   ? "velocity"
                                                               : "displacement";
  const char *along = deck_component_name(2, m->deck->component);
  if (m->deck->placed) return arena_printf(a, "%s along %s at %s", quantity, along, text);
  return region_words(all, m, arena_printf(a, "mean %s", quantity), a);
}

static char *quantity_words(const monitors *all, const monitor *m, arena *a) {
  if (m->gauge[0] && !m->gauge[1]) return gauge_words(all, m, a);
  switch (m->deck->kind) {
  case MONITOR_REACTION:
    return region_words(all, m, "reaction", a);
  case MONITOR_REACTIONS:
    return difference_words(all, m, "half the reaction", a);
  case MONITOR_APPLIED:
    return region_words(all, m, "force on particles", a);
  case MONITOR_OPENING:
    return difference_words(all, m, "mean displacement", a);
  case MONITOR_DISPLACEMENT:
    return region_words(all, m, "mean displacement", a);
  case MONITOR_VELOCITY:
    return region_words(all, m, "mean velocity", a);
  case MONITOR_SLIP:
    return slip_words(all, m, a);
  case MONITOR_CRACK:
    return arena_printf(a, "%s, of the tip `%s`", tip_value_words[m->deck->value], m->deck->crack);
  case MONITOR_CONTACT_FORCE:
    return arena_printf(a, "%s of `%s`",
                        component_words(all, m, "force of contact on particles", a),
                        m->deck->region ? m->deck->region : m->of[0]->name);
  case MONITOR_FIELD:
    return field_words(m, a);
  case MONITOR_DAMAGED:
  case MONITOR_BROKEN:
    return count_words(all, m, a);
  default:
    return watched_words(m->own, a);
  }
}

char *monitor_words(const monitors *all, int index, arena *a) {
  const monitor *m = &all->items[index];
  char *words = quantity_words(all, m, a);
  if (m->window > 1) words = arena_printf(a, "%s, mean over %.6g s", words, m->deck->average);
  if (m->zero_step >= 0)
    words = arena_printf(a, "%s, less its value at %.6g s", words, m->deck->zero_at);
  if (m->deck->scale < 1 || m->deck->scale > 1)
    words = arena_printf(a, "%s, times %.6g", words, m->deck->scale);
  return words;
}

/* --- values ----------------------------------------------------------------------------------- */

static double mean_at(const double *values, const int32_t *sites, long count) {
  double sum = 0;
  for (long p = 0; p < count; p++)
    sum += values[sites[p]];
  return count ? sum / (double)count : 0;
}

static double reaction_sum(const monitor *m, int list) {
  double sum = 0;
  for (long c = 0; c < m->index_count[list]; c++)
    sum += m->of[list]->loads->constraints[m->indices[list][c]].reaction;
  return sum;
}

static double applied_sum(const monitor *m) {
  double sum = 0;
  for (long c = 0; c < m->index_count[0]; c++)
    sum += m->of[0]->loads->forces[m->indices[0][c]].now;
  return sum;
}

static double contact_sum(const monitor *m) {
  double sum = 0;
  for (long p = 0; p < m->index_count[0]; p++)
    sum += body_outer(m->of[0]->body, m->deck->component, m->indices[0][p]);
  return sum;
}

/* The largest in size. */
static double slip_now(const monitor *m) {
  double largest = 0;
  for (long n = 0; n < m->index_count[0]; n++) {
    const double slip = run_link_slip(m->link, m->indices[0][n]);
    if (fabs(slip) > fabs(largest)) largest = slip;
  }
  return largest;
}

static bool is_counted(const monitor *m, double damage) {
  return m->deck->kind == MONITOR_BROKEN ? damage >= m->deck->above : damage > m->deck->above;
}

/* Place by place: several times as fast as bond by bond. */
static long count_in_places(const rows *g, const monitor *m, const double *damage) {
  const bool broken = m->deck->kind == MONITOR_BROKEN;
  const double above = m->deck->above;
  long count = 0;
  for (int k = 0; k < g->directions; k++, damage += g->size)
    for (long q = 0; q < g->size; q++)
      count += (long)(g->bonds[q] >> k & 1) & (broken ? damage[q] >= above : damage[q] > above);
  return count;
}

/* Of a bond that two laws of families bear the mean of what they say; it counts for that of its
   first end, and for the other not at all (-1). */
static double damage_once(const run_body *on, const run_law *of, const rows_bond *bond) {
  const int32_t *site = of->rows->particle_site;
  const double here = damage_of_bond(of->state, bond);
  if (!of->share || (of->share[site[bond->i]] > 0 && of->share[site[bond->j]] > 0)) return here;
  if (!(of->share[site[bond->i]] > 0)) return -1;
  double sum = here;
  for (int n = 0; n < on->law_count; n++)
    if (on->laws[n].share[site[bond->j]] > 0) sum += damage_of_bond(on->laws[n].state, bond);
  return 0.5 * sum;
}

/* Bonds, or particles where the law's damage is on particles alone. */
static long count_damaged(const run_body *on, const run_law *of, const monitor *m) {
  const rows *g = of->rows;
  const bool bonds = damage_on_bonds(of->law);
  const double *in_places = damage_of_all_bonds(of->state);
  long count = 0;
  if (in_places) return count_in_places(g, m, in_places);
  for (long b = 0; bonds && b < g->bond_count; b++) {
    const double damage = damage_once(on, of, &of->bonds[b]);
    count += damage >= 0 && is_counted(m, damage);
  }
  for (long p = 0; !bonds && p < g->particle_count; p++)
    if (!of->share || of->share[g->particle_site[p]] > 0)
      count += is_counted(m, damage_of_site(of->state, g->particle_site[p]));
  return count;
}

static double count_all_damaged(const monitors *all, const monitor *m) {
  long count = 0;
  for (int b = 0; b < all->body_count; b++)
    for (int n = 0; n < all->bodies[b].law_count && watches(all, m, b); n++)
      if (law_can_be_damaged(all->bodies[b].laws[n].law))
        count += count_damaged(&all->bodies[b], &all->bodies[b].laws[n], m);
  return (double)count;
}

/* Of nodes, which have what frames show there. */
static double node_mean(const monitors *all, const monitor *m) {
  double sum = 0;
  for (int n = 0; n < m->of[0]->law_count; n++) {
    const run_law *law = &m->of[0]->laws[n];
    if (!same_field(m, law)) continue;
    const int k = find_field(m->deck, law->law), output = k - law->law->field_count;
    const double *values = output >= 0 ? all->values : law->state->new_field[k];
    if (output >= 0) sweep_output(law->state, output, all->values);
    for (long p = 0; p < m->index_count[0]; p++) {
      const double part = part_of_node(m, law, m->indices[0][p]);
      if (part > 0) sum += part * values[m->indices[0][p]];
    }
  }
  return sum / (double)m->index_count[0];
}

/* Of a law's field or output on particles. */
static double field_mean(const monitors *all, const monitor *m, bool late) {
  if (m->of[0]->cells) return node_mean(all, m);
  sweep *state = m->law->state;
  const int count = m->law->law->field_count;
  const double *values = m->field >= count ? all->values
                         : late            ? state->field[m->field]
                                           : state->new_field[m->field];
  if (m->field >= count) sweep_output(state, m->field - count, all->values);
  return mean_at(values, m->indices[0], m->index_count[0]);
}

static double velocity_mean(const monitor *m, long step) {
  const run_body *of = m->of[0];
  double sum = 0;
  for (long p = 0; p < m->index_count[0]; p++)
    sum += load_steps_velocity(of->loads, of->body, m->deck->component, m->indices[0][p], step);
  return m->index_count[0] ? sum / (double)m->index_count[0] : 0;
}

static double displacement_mean(const monitor *m, int list) {
  return mean_at(m->of[list]->body->displacement[m->deck->component], m->indices[list],
                 m->index_count[list]);
}

typedef struct instant_velocities { /* what a velocity at an instant is known by */
  const run_body *of;
  long step;
} instant_velocities;

static velocity_instant velocities_at(const void *from, int component, long site) {
  const instant_velocities *v = from;
  return load_steps_velocities(v->of->loads, v->of->body, component, site, v->step);
}

/* What watched.h has. */
static double watched_now(const monitors *all, const monitor *m, long step, bool late) {
  const instant_velocities v = {m->of[0], step};
  bond_forces *forces = all->forces[m->of[0] - all->bodies];
  const watch_instant at = {.velocity = velocities_at,
                            .velocities = &v,
                            .forces = forces,
                            .late = late,
                            .scratch = all->values};
  if (watched_needs_forces(m->deck)) bond_forces_find(forces, step);
  return watched_value(m->own, &at);
}

/* A value at the instant of the state observed. */
static double value_now(const monitors *all, const monitor *m, long step) {
  if (m->gauge[1]) return mesh_gauge_value(m->gauge[1], step) - mesh_gauge_value(m->gauge[0], step);
  if (m->gauge[0]) return mesh_gauge_value(m->gauge[0], step);
  switch (m->deck->kind) {
  case MONITOR_REACTION:
    return reaction_sum(m, 0);
  case MONITOR_REACTIONS:
    return 0.5 * (reaction_sum(m, 1) - reaction_sum(m, 0));
  case MONITOR_APPLIED:
    return applied_sum(m);
  case MONITOR_DISPLACEMENT:
    return displacement_mean(m, 0);
  case MONITOR_VELOCITY:
    return velocity_mean(m, step);
  case MONITOR_OPENING:
    return displacement_mean(m, 1) - displacement_mean(m, 0);
  case MONITOR_SLIP:
    return slip_now(m);
  case MONITOR_CRACK:
    return tip_value_now(m->tips, &m->tips->items[m->tip], m->deck->value);
  case MONITOR_CONTACT_FORCE:
    return contact_sum(m);
  case MONITOR_FIELD:
    return field_mean(all, m, false);
  case MONITOR_DAMAGED:
  case MONITOR_BROKEN:
    return count_all_damaged(all, m);
  default:
    return watched_now(all, m, step, false);
  }
}

/* What a step has made known for a window: the velocity in it, the field of the state that it left;
   the same for all else. */
static double value_of_step(const monitors *all, const monitor *m, long step) {
  const bool moves = m->deck->kind == MONITOR_VELOCITY || m->deck->kind == MONITOR_ACCELERATION;
  if (m->gauge[0] && moves) return mesh_gauge_velocity(m->gauge[0]);
  if (m->deck->kind == MONITOR_VELOCITY)
    return mean_at(m->of[0]->body->velocity[m->deck->component], m->indices[0], m->index_count[0]);
  if (m->deck->kind == MONITOR_FIELD) return field_mean(all, m, true);
  if (m->deck->kind == MONITOR_ACCELERATION) return watched_velocity(m->own);
  if (m->own) return watched_now(all, m, step, true);
  return value_now(all, m, step);
}

/* --- windows ---------------------------------------------------------------------------------- */

static void push(monitor *m, double value) {
  m->ring[m->state.filled++ % m->window] = value;
}

/* Of the last `most` values, and of one more that is not in the ring. From the oldest value to the
   newest, so that a resumed run sums in the same order. */
static double mean_of_ring(const monitor *m, long most, const double *more) {
  const int64_t count = m->state.filled < most ? m->state.filled : most;
  double sum = 0;
  for (int64_t k = m->state.filled - count; k < m->state.filled; k++)
    sum += m->ring[k % m->window];
  return more ? (sum + *more) / (double)(count + 1) : sum / (double)count;
}

/* Slope over time of the straight line that fits the same values best. */
static double slope_of_ring(const monitors *all, const monitor *m, long most, const double *more) {
  const int64_t count = m->state.filled < most ? m->state.filled : most,
                values = count + (more != NULL);
  const double n = (double)values, middle = 0.5 * (n - 1);
  double sum = more ? (n - 1 - middle) * *more : 0;
  for (int64_t k = 0; k < count; k++)
    sum += ((double)k - middle) * m->ring[(m->state.filled - count + k) % m->window];
  return values > 1 ? sum / (n * (n * n - 1) / 12 * all->interval) : 0;
}

/* Velocity over the time of the states in the window: from half a step before the first of them to
   half a step after the present one. */
static double acceleration_of_ring(const monitors *all, const monitor *m, double now) {
  const int64_t count = m->state.filled < m->window ? m->state.filled : m->window;
  const double first = m->ring[(m->state.filled - count) % m->window],
               last = m->ring[(m->state.filled - 1) % m->window];
  return (last - first + now * all->interval) / ((double)count * all->interval);
}

static double reduced(const monitors *all, const monitor *m, long most, const double *more) {
  return m->deck->kind == MONITOR_TIP_SPEED ? slope_of_ring(all, m, most, more)
                                            : mean_of_ring(m, most, more);
}

/* Its window holds what steps made of velocities, not states. */
static bool is_over_steps(const monitor *m) {
  return m->known == KNOWN_AFTER_STEP &&
         (m->deck->kind == MONITOR_VELOCITY || m->deck->kind == MONITOR_ACCELERATION);
}

static double averaged(const monitors *all, const monitor *m, long step) {
  const bool late = m->known == KNOWN_ONE_LATE;
  if (m->window > 1 && !late && m->state.filled > 0) {
    if (m->deck->kind == MONITOR_ACCELERATION && is_over_steps(m))
      return acceleration_of_ring(all, m, value_now(all, m, step));
    return reduced(all, m, m->window, NULL);
  }
  const double now = value_now(all, m, step);
  return m->window > 1 && late ? reduced(all, m, m->window - 1, &now) : now;
}

void monitors_step(monitors *all, long step) {
  for (int i = 0; i < all->count; i++) {
    monitor *m = &all->items[i];
    if (m->window > 1 && m->known != KNOWN_WHEN_OBSERVED &&
        (step > 0 || (m->known == KNOWN_AFTER_STEP && !is_over_steps(m))))
      push(m, value_of_step(all, m, step));
  }
}

bool monitors_due(const monitors *all, long step) {
  for (int i = 0; i < all->count; i++) {
    const monitor *m = &all->items[i];
    if (step == m->zero_step || (m->window > 1 && m->known == KNOWN_WHEN_OBSERVED)) return true;
  }
  return false;
}

void monitors_look(monitors *all, long step, long position) {
  for (int i = 0; i < all->count; i++) {
    monitor *m = &all->items[i];
    if (m->window > 1 && m->known == KNOWN_WHEN_OBSERVED) push(m, value_now(all, m, step));
    if (position == m->zero_step) m->state.zero = averaged(all, m, step);
  }
}

void monitors_sample(monitors *all, long step, double time, double *values) {
  for (int i = 0; i < all->count; i++) {
    monitor *m = &all->items[i];
    values[i] = m->deck->scale * (averaged(all, m, step) - m->state.zero);
    if (fabs(values[i]) <= fabs(m->state.peak)) continue;
    m->state.peak = values[i];
    m->state.peak_time = time;
  }
}

static bool applies(const monitors *all, const deck_stop *stop, double time, const double *values) {
  const int i = deck_find_monitor(all->deck, stop->monitor);
  if (i < 0 || time < stop->after) return false;
  const double peak = fabs(all->items[i].state.peak), value = fabs(values[i]);
  const double level = stop->of_peak ? stop->level * peak : stop->level;
  if (stop->of_peak && peak == 0) return false;
  return stop->below ? value < level : value > level;
}

int monitors_stop(const monitors *all, double time, const double *values) {
  for (int i = 0; i < all->deck->stop_count; i++)
    if (applies(all, &all->deck->stops[i], time, values)) return i;
  return -1;
}
