#include "runtime/simulation/monitor_setup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/deck/deck_value.h"
#include "runtime/deck/group_monitor.h"
#include "runtime/interaction/damage.h"
#include "runtime/simulation/monitor_field.h"

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

/* --- what a monitor watches ------------------------------------------------------------------- */

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

/* --- whether it can --------------------------------------------------------------------------- */

static bool check_component(const deck_monitor *m, const pl_law *law, diagnostics *d) {
  if (!has_component(m) || m->component < law->dof) return true;
  diag_report(d, DIAG_BAD_VALUE, deck_where(&m->item, "component"),
              "the particles of the law `%s` do not rotate", law->name);
  return false;
}

static bool can_be_damaged(const run_body *b) {
  for (int n = 0; n < b->law_count; n++)
    if (damage_on_any(b->laws[n].law)) return true;
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

bool monitors_check(const deck *k, const run_body *bodies, int count, diagnostics *d) {
  bool good = true;
  for (int i = 0; i < k->monitor_count; i++) {
    const deck_monitor *m = &k->monitors[i];
    const run_body *first = body_of(k, bodies, count, m, 0);
    good = check_damage(m, first ? first : bodies, first ? 1 : count, d) && good;
    for (int end = 0; end < 2; end++) {
      const run_body *of = body_of(k, bodies, count, m, end);
      good = (!of || (check_component(m, of->law, d) && monitor_check_field(m, of, d))) && good;
    }
  }
  return good;
}

/* --- a monitor -------------------------------------------------------------------------------- */

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
    m->law = monitor_law_watched(m);
    m->field = monitor_find_field(m->deck, m->law->law);
    m->unit = monitor_law_field(m->law->law, m->field)->unit;
    if (m->of[0]->cells)
      monitor_keep_nodes(m, d);
    else
      monitor_check_share(m, d);
    break;
  case MONITOR_STAMP_DISPLACEMENT:
  case MONITOR_STAMP_VELOCITY:
  case MONITOR_STAMP_FORCE:
  case MONITOR_STAMP_MOMENT:
    m->stamp = deck_find_stamp(all->deck, m->deck->stamp);
    break;
  case MONITOR_DAMAGED:
  case MONITOR_BROKEN:
    break;
  default:
    watch(m, all, d);
  }
  m->known = when_known(m, all);
}

/* --- all of them ------------------------------------------------------------------------------ */

static size_t largest_size(const run_body *bodies, int count) {
  long most = 0;
  for (int b = 0; b < count; b++)
    if (bodies[b].lattice_rows->size > most) most = bodies[b].lattice_rows->size;
  return (size_t)most;
}

monitors *monitors_new(const deck *k, const run_body *bodies, int count, const run_link *links,
                       int link_count, const run_stamps *stamps, double interval, diagnostics *d) {
  const int before = d->errors;
  monitors *m = must_calloc(1, sizeof *m);
  *m = (monitors){.interval = interval,
                  .count = k->monitor_count,
                  .deck = k,
                  .bodies = bodies,
                  .body_count = count,
                  .links = links,
                  .link_count = link_count,
                  .stamps = stamps};
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
