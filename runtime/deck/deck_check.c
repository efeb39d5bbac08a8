#include "runtime/deck/deck_check.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "runtime/deck/deck_check_parts.h"
#include "runtime/deck/deck_load.h"
#include "runtime/deck/deck_value.h"

/* --- times ------------------------------------------------------------------------------------ */

static void warn_late(deck_reader *r, const deck_item *item, const char *key, double time) {
  double end = r->k->simulation.end_time;
  if (end <= 0 || time < end) return; /* 0: the end is not known */
  diag_report(r->d, DIAG_DECK_WARNING, deck_where(item, key),
              "`%s` is not before the end of the run", key);
}

/* --- components ------------------------------------------------------------------------------- */

enum { WRITTEN_Z = 2, WRITTEN_ROTATION = 3 }; /* positions among "x|y|z|rotation" */

static int dimensions_of_region(const deck_reader *r, const char *name) {
  const int k = name ? deck_find_region(r->k, name) : -1;
  return k < 0 ? 0 : deck_dimensions_of(r, r->k->regions[k].lattice);
}

/* The degree of freedom of a direction as written. -1 after a message: it is none of the region's particles. */
static int component_of(deck_reader *r, span where, const char *region, int written) {
  const int dimensions = dimensions_of_region(r, region);
  if (written < WRITTEN_Z) return written;
  if (dimensions == 2 && written == WRITTEN_Z)
    diag_report(r->d, DIAG_BAD_VALUE, where, "there is no direction z in the plane");
  else if (dimensions == 3 && written == WRITTEN_ROTATION)
    diag_report(r->d, DIAG_BAD_VALUE, where, "particles of a lattice in space have no rotation");
  else
    return 2;
  return -1;
}

static bool take_component(deck_reader *r, const deck_item *item, const char *region,
                           int *component) {
  const int found = component_of(r, deck_where(item, "component"), region, *component);
  if (found >= 0) *component = found;
  return found >= 0;
}

static bool is_rotation(const deck_reader *r, const char *region, int component) {
  return component == 2 && dimensions_of_region(r, region) != 3;
}

static const char *component_name(const deck_reader *r, const char *region, int component) {
  return deck_component_name(dimensions_of_region(r, region), component);
}

/* --- groups, in the order of DECK_GROUPS ------------------------------------------------------ */

void deck_check_simulation(deck_reader *r, const namelist_group *from, deck_simulation *item) {
  (void)from;
  if (item->step > item->end_time)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "step"),
                "`step` is longer than the run");
}

void deck_check_relaxation(deck_reader *r, const namelist_group *from, deck_relaxation *item) {
  (void)from;
  if (item->increments < 1)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "increments"),
                "a quasi-static run has at least one increment");
  if (item->most_steps < 1)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "most_steps"),
                "an increment needs at least one step");
}

void deck_check_body(deck_reader *r, const namelist_group *from, deck_body *item) {
  deck_lattice_known(r, &item->item, item->lattice);
  deck_check_shape(r, from, &item->item, &item->shape, item->lattice);
  deck_check_can_be_filled(r, &item->item, &item->shape, item->lattice, true);
}

void deck_check_notch(deck_reader *r, const namelist_group *from, deck_notch *item) {
  deck_lattice_known(r, &item->item, item->lattice);
  deck_check_shape(r, from, &item->item, &item->shape, item->lattice);
  deck_check_can_be_filled(r, &item->item, &item->shape, item->lattice, false);
}

void deck_check_region(deck_reader *r, const namelist_group *from, deck_region *item) {
  deck_check_shape(r, from, &item->item, &item->shape, item->lattice);
  int first = deck_find_region(r->k, item->name);
  deck_check_name(r, "region", item->name, &item->item,
                  first < 0 ? NULL : &r->k->regions[first].item);
  if (item->lattice) {
    deck_lattice_known(r, &item->item, item->lattice);
  } else if (r->k->lattice_count == 1) {
    item->lattice = r->k->lattices[0].name;
  } else if (r->names_known && r->k->lattice_count > 1) {
    diag_report(r->d, DIAG_MISSING_KEY, item->item.where, "`&region` needs `lattice` here");
    diag_hint(r->d, "the deck has %d lattices", r->k->lattice_count);
  }
}

/* Of all regions; NULL where the region is not known. */
static deck_motions *motions_of(deck_reader *r, const char *region) {
  const int k = region ? deck_find_region(r->k, region) : -1;
  if (!r->motions)
    r->motions = arena_alloc(r->memory, ((size_t)r->k->region_count + 1) * sizeof *r->motions);
  return k < 0 ? NULL : &r->motions[k];
}

/* Of an item in which nothing is wrong; `components` has a bit each. */
static void note_motions(deck_reader *r, const char *region, int components, span where) {
  deck_motions *m = motions_of(r, region);
  r->moved |= components;
  for (int c = 0; m && c < 3; c++)
    if (components & 1 << c && m->of[c].end == 0) m->of[c] = where;
}

void deck_check_support(deck_reader *r, const namelist_group *from, deck_support *item) {
  (void)from;
  const int errors = r->d->errors;
  const span where = deck_where(&item->item, "fix");
  int fix = 0;
  deck_item_region_known(r, &item->item, item->region);
  for (int k = 0; k <= WRITTEN_ROTATION; k++) {
    if (!(item->fix & 1 << k)) continue;
    const int component = component_of(r, where, item->region, k);
    if (component >= 0) fix |= 1 << component;
  }
  item->fix = fix;
  if (r->d->errors == errors) note_motions(r, item->region, fix, where);
}

/* A particle cannot follow two motions; regions that overlap are found when their particles are
 * known. */
static void check_other_motions(deck_reader *r, const deck_drive *item) {
  const span where = deck_where(&item->item, "component");
  const deck_motions *m = motions_of(r, item->region);
  const span other = m ? m->of[item->component] : (span){0};
  if (other.end == 0) return;
  const char *component = component_name(r, item->region, item->component);
  diag_report(r->d, DIAG_CONFLICT, where, "`%s` of region `%s` has two motions", component,
              deck_shown(r->memory, item->region));
  diag_note(r->d, other, "the other one");
}

/* A load without a history grows with the increments of a quasi-static run. */
static void spread(const deck_reader *r, const namelist_group *from, time_function *f) {
  const double rest = r->k->simulation.end_time - f->start;
  if (r->k->relaxation.increments < 1 || f->shape != TIME_CONSTANT || !(rest > 0)) return;
  if (namelist_find(from, "history")) return;
  f->shape = TIME_RAMP_HOLD;
  f->rise = rest;
}

static void warn_of_jump(deck_reader *r, const namelist_group *from, const time_function *f) {
  if (time_function_jump(f) == 0 || r->k->relaxation.increments > 0) return;
  const bool table = f->shape == TIME_TABLE;
  const namelist_key *at = namelist_find(from, !table ? "displacement" : "values");
  diag_report(r->d, DIAG_DECK_WARNING, (at ? at : namelist_find(from, "file"))->name_where,
              table ? "this displacement begins with a jump"
                    : "this displacement comes all at once");
  diag_hint(r->d, table ? "let the first value be 0" : "give a `rise`, e.g. rise = '1 ms'");
}

static void complete_drive(deck_reader *r, const namelist_group *from, deck_drive *item) {
  deck_item_region_known(r, &item->item, item->region);
  if (!take_component(r, &item->item, item->region, &item->component)) return;
  const bool rotates = is_rotation(r, item->region, item->component);
  check_other_motions(r, item);
  const deck_load_kind kinds[] = {{"velocity", rotates ? "1/s" : "m/s", false},
                                  {"displacement", rotates ? "1" : "m", false}};
  const int kind = deck_load_kind_of(from, kinds, 2, r->d);
  if (kind < 0) return;
  item->is_displacement = kind == 1;
  if (!deck_load_read(r->memory, from, &kinds[kind], &item->motion, r->d)) {
    if (rotates && r->d->items[r->d->count - 1].code == DIAG_UNITS)
      diag_hint(r->d, "a rotation is in rad, its velocity in rad/s");
    return;
  }
  warn_late(r, &item->item, "start", item->motion.start);
  if (!item->is_displacement) return;
  spread(r, from, &item->motion);
  warn_of_jump(r, from, &item->motion);
}

void deck_check_drive(deck_reader *r, const namelist_group *from, deck_drive *item) {
  const int errors = r->d->errors;
  complete_drive(r, from, item);
  if (r->d->errors == errors)
    note_motions(r, item->region, 1 << item->component, deck_where(&item->item, "component"));
}

void deck_check_force(deck_reader *r, const namelist_group *from, deck_force *item) {
  static const deck_load_kind kinds[] = {{"total", "N", false}, {"moment", "N*m", false}};
  deck_item_region_known(r, &item->item, item->region);
  const int kind = deck_load_kind_of(from, kinds, 2, r->d);
  const namelist_key *component = namelist_find(from, "component");
  if (kind < 0) return;
  const bool rotates = kind == 1;
  item->component = rotates ? WRITTEN_ROTATION : 0;
  if (component) item->component = deck_choice_read(r->memory, component, "x|y|z|rotation", r->d);
  if (item->component < 0 || !take_component(r, &item->item, item->region, &item->component))
    return;
  if (!component && !rotates) {
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&force` has no `component`");
    diag_hint(r->d, dimensions_of_region(r, item->region) == 3 ? "component = 'x', 'y' or 'z'"
                                                               : "component = 'x' or 'y'");
    return;
  }
  if (rotates != is_rotation(r, item->region, item->component)) {
    const namelist_key *key = namelist_find(from, kinds[kind].key);
    diag_report(r->d, DIAG_CONFLICT,
                key ? key->name_where : namelist_find(from, "file")->value_where,
                "%s%s%s does not go with component = '%s'", key ? "`" : "a ", kinds[kind].key,
                key ? "`" : "", component_name(r, item->region, item->component));
    diag_hint(r->d, "write `%s`", rotates ? "total" : "moment");
    return;
  }
  if (!deck_load_read(r->memory, from, &kinds[kind], &item->force, r->d)) return;
  warn_late(r, &item->item, "start", item->force.start);
  spread(r, from, &item->force);
}

void deck_check_end_moment(deck_reader *r, const namelist_group *from, deck_end_moment *item) {
  static const deck_load_kind kind = {"moment", "N*m", false};
  deck_item_region_known(r, &item->item, item->region);
  if (deck_load_kind_of(from, &kind, 1, r->d) < 0 ||
      !deck_load_read(r->memory, from, &kind, &item->moment, r->d))
    return;
  warn_late(r, &item->item, "start", item->moment.start);
  spread(r, from, &item->moment);
}

void deck_check_protect(deck_reader *r, const namelist_group *from, deck_protect *item) {
  (void)from;
  deck_item_region_known(r, &item->item, item->region);
}

void deck_check_damping(deck_reader *r, const namelist_group *from, deck_damping *item) {
  if (!namelist_find(from, "until")) item->until = INFINITY;
  warn_late(r, &item->item, "from", item->from);
  if (item->until > item->from) return;
  diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "until"),
              "`until` must be later than `from`");
}

void deck_check_gravity(deck_reader *r, const namelist_group *from, deck_gravity *item) {
  if (deck_factor_read(r->memory, from, "acceleration", &item->factor, r->d)) {
    warn_late(r, &item->item, "start", item->factor.start);
    spread(r, from, &item->factor);
  }
  if (deck_dimensions_of(r, NULL))
    deck_check_place(r, from, "acceleration", deck_dimensions_of(r, NULL));
  if (item->acceleration[0] == 0 && item->acceleration[1] == 0 && item->acceleration[2] == 0)
    diag_report(r->d, DIAG_DECK_WARNING, deck_where(&item->item, "acceleration"),
                "this gravity is zero");
}

void deck_check_initial_velocity(deck_reader *r, const namelist_group *from,
                                 deck_initial_velocity *item) {
  const namelist_key *key = namelist_find(from, "value");
  deck_item_region_known(r, &item->item, item->region);
  if (!take_component(r, &item->item, item->region, &item->component)) return;
  const bool rotates = is_rotation(r, item->region, item->component);
  if (!deck_values_counted(key, 1, r->d) ||
      deck_real_read(&key->values[0], "value", rotates ? "1/s" : "m/s", BOUND_NONE, &item->value,
                     r->d))
    return;
  if (rotates) diag_hint(r->d, "a rotation's velocity is in rad/s");
}

enum {
  OF_MOTION = 1 << MONITOR_REACTION | 1 << MONITOR_DISPLACEMENT | 1 << MONITOR_VELOCITY,
  OF_FIELD = 1 << MONITOR_FIELD,
  OF_PAIR = 1 << MONITOR_OPENING | 1 << MONITOR_REACTIONS,
  OF_DAMAGE = 1 << MONITOR_DAMAGED | 1 << MONITOR_BROKEN
};
static const char *const monitor_words[] = {
    "a reaction monitor", "a displacement monitor",
    "a velocity monitor", "an opening monitor",
    "a damaged monitor",  "a broken monitor",
    "a field monitor",    "a reaction monitor with `between`"};
static const deck_key_use monitor_uses[] = {{"region", OF_MOTION | OF_FIELD, true},
                                            {"between", OF_PAIR, true},
                                            {"component", OF_MOTION | OF_PAIR, true},
                                            {"field", OF_FIELD, true},
                                            {"above", OF_DAMAGE, false}};

static bool is_identifier(const char *name) {
  bool good = isalpha((unsigned char)*name) || *name == '_';
  for (const char *p = name; *p; p++)
    good &= isalnum((unsigned char)*p) || *p == '_';
  return good;
}

static void check_monitor_name(deck_reader *r, const deck_monitor *item) {
  static const char *const taken[] = {"time", "energy", "relaxation_steps", "relaxation_unbalance"};
  span where = deck_where(&item->item, "name");
  if (deck_is_one_of(item->name, taken, 4))
    diag_report(r->d, DIAG_RESERVED_NAME, where,
                "a monitor cannot be called `%s`: the result has a history of that name",
                item->name);
  else if (!is_identifier(item->name)) {
    diag_report(r->d, DIAG_BAD_VALUE, where, "`%s` cannot be the name of a monitor",
                deck_shown(r->memory, item->name));
    diag_hint(r->d, "use letters, digits and `_`, and begin with a letter");
  }
  int first = deck_find_monitor(r->k, item->name);
  deck_check_name(r, "monitor", item->name, &item->item,
                  first < 0 ? NULL : &r->k->monitors[first].item);
}

/* Forces come from supports and drives only; without any along the component a reaction is 0 for
 * ever. */
static void check_reaction(deck_reader *r, const deck_monitor *item) {
  const bool found =
      deck_lacks(r->k, "support") || deck_lacks(r->k, "drive") || r->moved & 1 << item->component;
  if (found || !r->names_known) return;
  diag_report(r->d, DIAG_CONFLICT, item->item.where,
              "this reaction is always 0: no `&support` or `&drive` acts on `%s`",
              component_name(r, item->region, item->component));
}

static void check_broken(deck_reader *r, const namelist_group *from, deck_monitor *item) {
  if (!namelist_find(from, "above")) item->above = 1;
  if (item->above > 0 && item->above <= 1) return;
  diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "above"),
              "`above` of a broken monitor must be greater than 0 and at most 1");
}

static const char *watched_region(const deck_monitor *item) {
  return item->region ? item->region : item->between[0];
}

void deck_check_monitor(deck_reader *r, const namelist_group *from, deck_monitor *item) {
  const namelist_key *between = namelist_find(from, "between");
  check_monitor_name(r, item);
  if (item->kind == MONITOR_REACTION && between) item->kind = MONITOR_REACTIONS;
  if (!deck_keys_fit(from, monitor_uses, 5, (int)item->kind, monitor_words[item->kind], r->d))
    return;
  if (!namelist_find(from, "zero_at")) item->zero_at = -1;
  if (item->kind == MONITOR_BROKEN) check_broken(r, from, item);
  warn_late(r, &item->item, "zero_at", item->zero_at);
  if (item->region) deck_item_region_known(r, &item->item, item->region);
  for (int i = 0; between && i < 2; i++)
    deck_region_known(r, between->values[i].where, item->between[i]);
  if (!take_component(r, &item->item, watched_region(item), &item->component)) return;
  if (item->kind == MONITOR_REACTION || item->kind == MONITOR_REACTIONS) check_reaction(r, item);
}

/* Unit of a monitor's values. */
static const char *monitor_unit(const deck_reader *r, const deck_monitor *m) {
  const bool rotates = is_rotation(r, watched_region(m), m->component);
  switch (m->kind) {
  case MONITOR_REACTION:
  case MONITOR_REACTIONS:
    return rotates ? "N*m" : "N";
  case MONITOR_DISPLACEMENT:
  case MONITOR_OPENING:
    return rotates ? "1" : "m";
  case MONITOR_VELOCITY:
    return rotates ? "1/s" : "m/s";
  default:
    return "1";
  }
}

static void check_level(deck_reader *r, const namelist_key *key, deck_stop *item,
                        const char *unit_text) {
  const namelist_value *v = &key->values[0];
  if (!deck_values_counted(key, 1, r->d) ||
      !deck_real_read(v, key->name, unit_text, BOUND_NOT_NEGATIVE, &item->level, r->d))
    return;
  if (item->of_peak && (item->level <= 0 || item->level >= 1))
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, v->where,
                "a fraction of the peak must be greater than 0 and less than 1");
}

/* The one of two keys that was written, or NULL after a message. */
static const namelist_key *either(deck_reader *r, const namelist_group *from, const char *first,
                                  const char *second) {
  const namelist_key *a = namelist_find(from, first), *b = namelist_find(from, second);
  deck_refuse_both(r, from, first, second);
  if (!a && !b)
    diag_report(r->d, DIAG_MISSING_KEY, from->where, "`&%s` needs `%s` or `%s`", from->name, first,
                second);
  return a && b ? NULL : a ? a : b;
}

void deck_check_stop(deck_reader *r, const namelist_group *from, deck_stop *item) {
  const namelist_key *of = namelist_find(from, "of"), *key = either(r, from, "below", "above");
  warn_late(r, &item->item, "after", item->after);
  const bool found = deck_monitor_known(r, deck_where(&item->item, "monitor"), item->monitor);
  if (!key || !found) return;
  item->below = key == namelist_find(from, "below");
  item->of_peak = of != NULL;
  if (of && !item->below) {
    diag_report(r->d, DIAG_CONFLICT, of->name_where, "`of = 'peak'` goes with `below` only");
    diag_hint(r->d, "no value is above the largest one so far");
    return;
  }
  const deck_monitor *m = &r->k->monitors[deck_find_monitor(r->k, item->monitor)];
  if (!m->item.faulty) check_level(r, key, item, of ? "1" : monitor_unit(r, m));
}

/* Which fields a law has is known later only. */
static void keep_field_places(deck_reader *r, const namelist_group *from, deck_output *item) {
  const namelist_key *fields = namelist_find(from, "fields");
  if (!fields || fields->value_count != item->field_count) return;
  span *where = arena_alloc(r->memory, (size_t)fields->value_count * sizeof *where);
  for (int k = 0; k < fields->value_count; k++)
    where[k] = fields->values[k].where;
  item->field_where = where;
}

void deck_check_output(deck_reader *r, const namelist_group *from, deck_output *item) {
  enum { MOST_SAMPLES = 10000000 };
  double end = r->k->simulation.end_time;
  keep_field_places(r, from, item);
  if (end <= 0 || item->sample <= 0) return;
  if (item->sample > end)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "sample"),
                "`sample` is longer than the run");
  else if (end / item->sample > MOST_SAMPLES)
    diag_report(r->d, DIAG_OUT_OF_BOUNDS, deck_where(&item->item, "sample"),
                "`sample` gives %.3g samples; the most is %d", end / item->sample, MOST_SAMPLES);
}

void deck_check_checkpoint(deck_reader *r, const namelist_group *from, deck_checkpoint *item) {
  (void)r;
  (void)from;
  (void)item;
}

/* --- the whole deck --------------------------------------------------------------------------- */

/* Lattices with bodies, a mark each. */
static bool *find_bodies(const deck_reader *r) {
  const deck *k = r->k;
  bool *found = arena_alloc(r->memory, (size_t)k->lattice_count + 1);
  for (int i = 0; i < k->body_count; i++) {
    const int l = k->bodys[i].lattice ? deck_find_lattice(k, k->bodys[i].lattice) : -1;
    if (l >= 0) found[l] = true;
  }
  return found;
}

/* A faulty item may be the one that is missed. Particles of a file need no body. */
static bool needs_body(const deck *k, const deck_lattice *lattice) {
  return !deck_lacks(k, "body") && !deck_same_name(lattice->kind, "particles");
}

static bool has_material(const deck *k, const char *lattice) {
  return deck_lacks(k, "material") || deck_find_material(k, lattice) >= 0;
}

/* Inertia and its damping are means of the relaxation. */
static void check_quasi_static(deck_reader *r) {
  const deck *k = r->k;
  if (k->relaxation.increments < 1) return;
  if (k->damping_count > 0)
    diag_report(r->d, DIAG_CONFLICT, k->dampings[0].item.where,
                "a quasi-static run chooses its damping itself: no `&damping` with `&relaxation`");
  if (k->initial_velocity_count > 0)
    diag_report(r->d, DIAG_CONFLICT, k->initial_velocitys[0].item.where,
                "a quasi-static run begins at rest: no `&initial_velocity` with `&relaxation`");
}

void deck_check_whole(deck_reader *r) {
  const deck *k = r->k;
  const deck_item *simulation = &k->simulation.item;
  if (simulation->where.end == 0 && !deck_lacks(k, "simulation")) /* never read */
    diag_report(r->d, DIAG_MISSING_KEY, simulation->where, "the deck has no `&simulation`");
  if (k->lattice_count == 0 && !deck_lacks(k, "lattice"))
    diag_report(r->d, DIAG_MISSING_KEY, simulation->where, "the deck has no `&lattice`");
  check_quasi_static(r);
  const bool *has_body = find_bodies(r);
  for (int i = 0; i < k->lattice_count; i++) {
    const deck_lattice *lattice = &k->lattices[i];
    if (!lattice->name) continue;
    const char *name = deck_shown(r->memory, lattice->name);
    if (!has_material(k, lattice->name))
      diag_report(r->d, DIAG_MISSING_KEY, lattice->item.where,
                  "the lattice `%s` has no `&material`", name);
    if (needs_body(k, lattice) && !has_body[i])
      diag_report(r->d, DIAG_MISSING_KEY, lattice->item.where, "the lattice `%s` has no `&body`",
                  name);
  }
}
