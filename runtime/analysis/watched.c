#include "runtime/analysis/watched.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "runtime/analysis/bar_force.h"
#include "runtime/analysis/crack_line.h"
#include "runtime/analysis/crack_tip.h"
#include "runtime/analysis/particle_tensors.h"
#include "runtime/analysis/section.h"

struct watched_part {
  const deck_monitor *deck;
  sweep *state;
  const body *of;
  int32_t *sites; /* [count] of the region, of the particle at the place, or all */
  long count;
  /* of the kind that they are for */
  section section;
  bar_force bar;
  crack_line *line;
  tensor_region region;
  crack_tip *tips; /* [tip_count] of each law that has damage */
  int tip_count;
};

bool watched_needs_forces(const deck_monitor *m) {
  return m->kind == MONITOR_FORCE || m->kind == MONITOR_MOMENT || m->kind == MONITOR_STRESS ||
         m->kind == MONITOR_BAR_FORCE;
}

/* --- set-up ----------------------------------------------------------------------------------- */

static double distance_to(const rows *g, long site, const double at[3]) {
  double here[3];
  rows_place(g, site, here);
  return bravais_distance(here, at);
}

static bool is_near(const deck_monitor *m, const rows *g, const char *what, const double here[3],
                    diagnostics *d) {
  const double distance = bravais_distance(here, m->at);
  char text[ROWS_PLACE_TEXT];
  if (distance <= rows_largest_spacing(g)) return true;
  diag_report(d, DIAG_EMPTY_REGION, deck_where(&m->item, "at"),
              "no %s stands within a spacing of `at`", what);
  diag_hint(d, "the nearest %s stands %.4g mm away at %s", what, 1e3 * distance,
            rows_place_text(g->dimensions, here, text));
  return false;
}

long watched_nearest(const deck_monitor *m, const rows *g, const int32_t *sites, long count,
                     diagnostics *d) {
  long best = 0;
  double here[3];
  for (long p = 1; p < count; p++) {
    const double gain = distance_to(g, sites[best], m->at) - distance_to(g, sites[p], m->at);
    if (gain > 1e-6 * g->spacing) best = p;
  }
  rows_place(g, sites[best], here);
  return is_near(m, g, "particle", here, d) ? best : -1;
}

static bool take_nearest(watched_part *w, diagnostics *d) {
  const rows *g = w->of->lattice;
  const long best = watched_nearest(w->deck, g, g->particle_site, g->particle_count, d);
  if (best < 0) return false;
  w->sites[0] = g->particle_site[best];
  w->count = 1;
  return true;
}

/* NULL where all particles are meant. */
static unsigned char *inside_of(const watched_part *w) {
  if (!w->deck->region) return NULL;
  unsigned char *inside = must_calloc((size_t)w->of->lattice->size, sizeof *inside);
  for (long p = 0; p < w->count; p++)
    inside[w->sites[p]] = 1;
  return inside;
}

static bool open_section(watched_part *w, diagnostics *d) {
  unsigned char *inside = inside_of(w);
  w->section = section_new(w->of, w->deck->at, w->deck->normal, inside);
  free(inside);
  if (w->section.count > 0) return true;
  diag_report(d, DIAG_EMPTY_REGION, deck_where(&w->deck->item, "at"),
              "no bond crosses this section");
  diag_hint(d, "`at` is a place of the section, `normal` stands across it%s",
            w->deck->region ? "; both ends of a bond must belong to the region" : "");
  return false;
}

static bool open_bar(watched_part *w, diagnostics *d) {
  unsigned char *inside = inside_of(w);
  w->bar = bar_force_new(w->of, w->deck->placed ? w->deck->at : NULL, inside);
  free(inside);
  if (w->bar.count > 0)
    return !w->deck->placed || is_near(w->deck, w->of->lattice, "bond", w->bar.middle, d);
  diag_report(d, DIAG_EMPTY_REGION, deck_where(&w->deck->item, "region"),
              "no bond of the bar has both ends in this region");
  return false;
}

static bool open_line(watched_part *w, const damage_law *laws, int count, diagnostics *d) {
  double outside[3];
  char text[ROWS_PLACE_TEXT];
  const deck_monitor *m = w->deck;
  w->line = crack_line_new(w->of, laws, count, m->from, m->to, m->above, outside);
  if (w->line) return true;
  diag_report(d, DIAG_EMPTY_REGION, deck_where(&m->item, "from"),
              "the line leaves the lattice at %s",
              rows_place_text(w->of->dimensions, outside, text));
  diag_hint(d, "between `from` and `to` it must lie among particles");
  return false;
}

static bool open_tips(watched_part *w, const damage_law *laws, int count, diagnostics *d) {
  unsigned char *inside = inside_of(w);
  long places = 0;
  w->tips = must_calloc((size_t)count, sizeof *w->tips);
  for (int n = 0; n < count; n++) {
    if (!damage_on_bonds(laws[n].of->law) && !damage_on_particles(laws[n].of->law)) continue;
    crack_tip *t = &w->tips[w->tip_count++];
    *t = crack_tip_new(&laws[n], w->deck->at, w->deck->direction, w->deck->above, inside);
    places += t->count;
  }
  free(inside);
  if (places > 0) return true;
  diag_report(d, DIAG_EMPTY_REGION, deck_where(&w->deck->item, "direction"),
              "no bond lies in this direction from `at`: the way of the crack would always be 0");
  return false;
}

static bool open_tensor(watched_part *w, diagnostics *d) {
  double strain[TENSOR_MOST];
  if (w->deck->placed && !take_nearest(w, d)) return false;
  w->region = tensor_region_new(w->of, w->sites, w->count);
  if (w->deck->kind == MONITOR_STRESS) return true;
  tensor_region_strain(&w->region, strain);
  if (!isnan(strain[0])) return true;
  diag_report(d, DIAG_EMPTY_REGION, deck_where(&w->deck->item, w->deck->placed ? "at" : "region"),
              "there is no strain: the bonds of each particle lie %s",
              w->of->dimensions == 2 ? "on a line" : "in a plane");
  if (rows_are_chain(w->of->lattice)) diag_hint(d, "along a chain it is the `stress` over E");
  return false;
}

static bool open_kind(watched_part *w, const damage_law *laws, int count, diagnostics *d) {
  switch (w->deck->kind) {
  case MONITOR_FORCE:
  case MONITOR_MOMENT:
    return open_section(w, d);
  case MONITOR_BAR_FORCE:
    return open_bar(w, d);
  case MONITOR_CRACK_WIDTH:
    return open_line(w, laws, count, d);
  case MONITOR_TIP:
  case MONITOR_TIP_SPEED:
    return open_tips(w, laws, count, d);
  case MONITOR_STRESS:
  case MONITOR_STRAIN:
    return open_tensor(w, d);
  case MONITOR_ACCELERATION:
    return !w->deck->placed || take_nearest(w, d);
  case MONITOR_MOMENTUM:
  case MONITOR_ANGULAR_MOMENTUM:
  case MONITOR_ENERGY:
    return true;
  default:
    return false;
  }
}

watched_part *watched_new(const deck_monitor *m, const int32_t *sites, long count, sweep *state,
                          const damage_law *laws, int law_count, diagnostics *d) {
  watched_part *w = must_calloc(1, sizeof *w);
  *w = (watched_part){.deck = m, .state = state, .of = state->body, .count = count};
  w->sites = must_calloc((size_t)count + 1, sizeof *w->sites);
  memcpy(w->sites, sites, (size_t)count * sizeof *sites);
  if (open_kind(w, laws, law_count, d)) return w;
  watched_free(w);
  return NULL;
}

void watched_free(watched_part *w) {
  if (!w) return;
  section_free(&w->section);
  bar_force_free(&w->bar);
  crack_line_free(w->line);
  tensor_region_free(&w->region);
  for (int n = 0; n < w->tip_count; n++)
    crack_tip_free(&w->tips[n]);
  free(w->tips);
  free(w->sites);
  free(w);
}

/* --- values ----------------------------------------------------------------------------------- */

static moving_particles moving(const watched_part *w, const watch_instant *at) {
  return (moving_particles){w->of, w->sites, w->count, at->velocity, at->velocities};
}

double watched_velocity(const watched_part *w) {
  double sum = 0;
  for (long p = 0; p < w->count; p++)
    sum += w->of->velocity[w->deck->component][w->sites[p]];
  return sum / (double)w->count;
}

static double acceleration(const watched_part *w, const watch_instant *at) {
  double sum = 0;
  for (long p = 0; p < w->count; p++) {
    const velocity_instant v = at->velocity(at->velocities, w->deck->component, w->sites[p]);
    sum += v.after - v.before;
  }
  return sum / ((double)w->count * w->of->time_step);
}

static double energy(const watched_part *w, const watch_instant *at) {
  double sum = 0;
  const moving_particles m = moving(w, at);
  if (w->deck->component == MONITOR_KINETIC) return momentum_kinetic(&m);
  sweep_stored(w->state, at->scratch);
  for (long p = 0; p < w->count; p++)
    sum += at->scratch[w->sites[p]];
  return sum;
}

/* Force or moment. */
static double through_section(const watched_part *w, bond_forces *forces) {
  double carried[3], along = 0;
  (w->deck->kind == MONITOR_MOMENT ? section_moment : section_force)(&w->section, forces, carried);
  for (int d = 0; d < 3; d++)
    along += carried[d] * w->section.normal[d];
  return w->deck->component < 0 ? along : carried[w->deck->component];
}

static double tensor(const watched_part *w, const watch_instant *at) {
  double t[TENSOR_MOST];
  if (w->deck->kind == MONITOR_STRESS)
    tensor_region_stress(&w->region, at->forces, t);
  else
    tensor_region_strain(&w->region, t);
  return t[w->deck->component];
}

static double way_of_tip(const watched_part *w, bool late) {
  double way = 0;
  for (int n = 0; n < w->tip_count; n++)
    way = pl_fmax(way, crack_tip_way(&w->tips[n], late));
  return way;
}

double watched_value(const watched_part *w, const watch_instant *at) {
  const moving_particles m = moving(w, at);
  switch (w->deck->kind) {
  case MONITOR_ACCELERATION:
    return acceleration(w, at);
  case MONITOR_MOMENTUM:
    return momentum_of(&m, w->deck->component);
  case MONITOR_ANGULAR_MOMENTUM:
    return momentum_angular(&m, w->deck->about, w->deck->component);
  case MONITOR_ENERGY:
    return energy(w, at);
  case MONITOR_FORCE:
  case MONITOR_MOMENT:
    return through_section(w, at->forces);
  case MONITOR_BAR_FORCE:
    return bar_force_largest(&w->bar, at->forces);
  case MONITOR_CRACK_WIDTH:
    return crack_line_widest(w->line);
  case MONITOR_TIP:
  case MONITOR_TIP_SPEED:
    return way_of_tip(w, at->late);
  default:
    return tensor(w, at);
  }
}

crack_line *watched_line(const watched_part *w) {
  return w ? w->line : NULL;
}

/* --- in words --------------------------------------------------------------------------------- */

static const char *place_words(const watched_part *w, const double at[3], arena *a) {
  char text[ROWS_PLACE_TEXT];
  return arena_printf(a, "%s", rows_place_text(w->of->dimensions, at, text));
}

static const char *part_words(const watched_part *w, arena *a) {
  if (w->deck->region) return arena_printf(a, "of `%s`", w->deck->region);
  if (!w->deck->placed && w->deck->lattice) return arena_printf(a, "of `%s`", w->deck->lattice);
  if (!w->deck->placed) return "of all particles";
  double here[3];
  rows_place(w->of->lattice, w->sites[0], here);
  return arena_printf(a, "of the particle at %s", place_words(w, here, a));
}

static const char *along_words(const watched_part *w, arena *a) {
  const int c = w->deck->component, dimensions = w->of->dimensions;
  return arena_printf(a, "%s %s", c < dimensions ? "along" : "in",
                      deck_component_name(dimensions, c));
}

static const char *tensor_words(const watched_part *w) {
  const tensor_component *t;
  tensor_components(w->of->dimensions, &t);
  return t[w->deck->component].name;
}

static char *tip_words(const watched_part *w, arena *a) {
  const bool speed = w->deck->kind == MONITOR_TIP_SPEED;
  return arena_printf(a, "%s of the furthest %s with more damage than %.6g from %s on",
                      speed ? "speed" : "way", w->tips[0].on_bonds ? "bond" : "particle",
                      w->deck->above, place_words(w, w->deck->at, a));
}

static char *bar_words(const watched_part *w, arena *a) {
  return w->deck->placed
             ? arena_printf(a, "tension along the bond at %s", place_words(w, w->bar.middle, a))
             : arena_printf(a, "largest tension along the bonds %s", part_words(w, a));
}

char *watched_words(const watched_part *w, arena *a) {
  static const char *const axes[] = {"x", "y", "z"};
  const char *of = part_words(w, a);
  switch (w->deck->kind) {
  case MONITOR_ACCELERATION:
    return arena_printf(a, "mean acceleration %s %s", along_words(w, a), of);
  case MONITOR_MOMENTUM:
    return arena_printf(a, "momentum %s %s", along_words(w, a), of);
  case MONITOR_ANGULAR_MOMENTUM:
    return arena_printf(a, "angular momentum about %s through %s %s", axes[w->deck->component],
                        place_words(w, w->deck->about, a), of);
  case MONITOR_ENERGY:
    return arena_printf(a, "%s energy %s",
                        w->deck->component == MONITOR_KINETIC ? "kinetic" : "stored", of);
  case MONITOR_FORCE:
    return arena_printf(a, "force %s through the section at %s",
                        w->deck->component < 0 ? "along the normal" : along_words(w, a),
                        place_words(w, w->deck->at, a));
  case MONITOR_MOMENT:
    return arena_printf(a, "moment about %s through the section at %s",
                        w->deck->component < 0 ? "the normal" : axes[w->deck->component],
                        place_words(w, w->deck->at, a));
  case MONITOR_BAR_FORCE:
    return bar_words(w, a);
  case MONITOR_CRACK_WIDTH:
    return arena_printf(a, "width of the widest crack across the line from %s to %s",
                        place_words(w, w->deck->from, a), place_words(w, w->deck->to, a));
  case MONITOR_TIP:
  case MONITOR_TIP_SPEED:
    return tip_words(w, a);
  default:
    return arena_printf(a, "mean %s %s %s", w->deck->kind == MONITOR_STRESS ? "stress" : "strain",
                        tensor_words(w), of);
  }
}
