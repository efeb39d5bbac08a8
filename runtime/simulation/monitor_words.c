#include "runtime/simulation/monitor_words.h"

#include "runtime/base/symmetric_tensor.h"
#include "runtime/interaction/damage.h"
#include "runtime/simulation/monitor_field.h"

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

static char *count_words(const monitors *all, const monitor *m, arena *a) {
  bool bonds = false, particles = false;
  for (int b = 0; b < all->body_count; b++) {
    const run_body *of = &all->bodies[b];
    for (int n = 0; n < of->law_count && monitor_watches(all, m, b); n++) {
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
  const pl_field *f = monitor_law_field(m->law->law, m->field);
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

static char *stamp_words(const monitors *all, const monitor *m, const char *quantity, arena *a) {
  return arena_printf(a, "%s of `%s`", component_words(all, m, quantity, a), m->deck->stamp);
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
  case MONITOR_STAMP_DISPLACEMENT:
    return stamp_words(all, m, "displacement", a);
  case MONITOR_STAMP_VELOCITY:
    return stamp_words(all, m, "velocity", a);
  case MONITOR_STAMP_FORCE:
    return stamp_words(all, m, "force of particles on the stamp", a);
  case MONITOR_STAMP_MOMENT:
    return arena_printf(a, "moment about %c on the stamp `%s`, about its middle",
                        "xyz"[m->deck->component], m -> deck -> stamp);
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
