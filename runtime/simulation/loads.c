#include "runtime/simulation/loads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/body/motion.h"

/* --- regions ---------------------------------------------------------------------------------- */

/* A point says how far away the nearest particle is, other shapes where the body is. */
static void hint_nearest(const double at[3], const rows *w, diagnostics *d) {
  double best = INFINITY, nearest[3] = {0, 0, 0};
  char text[ROWS_PLACE_TEXT];
  for (long p = 0; p < w->particle_count; p++) {
    double here[3];
    rows_place(w, w->particle_site[p], here);
    const double distance = bravais_distance(here, at);
    if (distance >= best) continue;
    best = distance;
    memcpy(nearest, here, sizeof nearest);
  }
  diag_hint(d,
            "the nearest particle stands %.4g mm away at %s; `within` says how far is near enough",
            1e3 * best, rows_place_text(w->dimensions, nearest, text));
}

static void hint_extent(const char *lattice, const rows *w, diagnostics *d) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  char above[64] = "";
  for (long p = 0; p < w->particle_count; p++) {
    double at[3];
    rows_place(w, w->particle_site[p], at);
    for (int c = 0; c < 3; c++) {
      low[c] = pl_fmin(low[c], at[c]);
      high[c] = pl_fmax(high[c], at[c]);
    }
  }
  if (w->dimensions == 3)
    snprintf(above, sizeof above, ", z = %.6g .. %.6g mm", 1e3 * low[2], 1e3 * high[2]);
  diag_hint(d, "the particles of `%s` lie in x = %.6g .. %.6g mm, y = %.6g .. %.6g mm%s", lattice,
            1e3 * low[0], 1e3 * high[0], 1e3 * low[1], 1e3 * high[1], above);
}

static void report_empty(const char *lattice, const deck_region *region, const rows *w,
                         diagnostics *d) {
  diag_report(d, DIAG_EMPTY_REGION, region->item.where, "region `%s` holds no particle",
              region->name);
  if (region->shape.kind == SHAPE_POINT)
    hint_nearest(region->shape.at, w, d);
  else
    hint_extent(lattice, w, d);
}

/* Regions that anything names, a mark each; malloc'ed. */
static bool *find_used_regions(const deck *k) {
  bool *used = must_calloc((size_t)k->region_count + 1, sizeof *used);
#define USED(list, member)                                                                         \
  for (int i = 0; i < k->list##_count; i++) {                                                      \
    const char *name = k->list##s[i].member;                                                       \
    const int region = name ? deck_find_region(k, name) : -1;                                      \
    if (region >= 0) used[region] = true;                                                          \
  }
  USED(support, region)
  USED(drive, region)
  USED(force, region)
  USED(end_moment, region)
  USED(protect, region)
  USED(initial_velocity, region)
  USED(monitor, region)
  USED(monitor, between[0])
  USED(monitor, between[1])
#undef USED
  return used;
}

static void select_regions(loads *l, const deck *k, const char *lattice, diagnostics *d) {
  bool *used = find_used_regions(k);
  l->regions = must_calloc((size_t)k->region_count + 1, sizeof *l->regions);
  for (int r = 0; r < k->region_count; r++) {
    const deck_region *region = &k->regions[r];
    l->regions[r].count = rows_select(l->lattice, &region->shape, &l->regions[r].particles);
    if (l->regions[r].count == 0)
      report_empty(lattice, region, l->lattice, d);
    else if (!deck_lacks(k, NULL) && !used[r])
      diag_report(d, DIAG_DECK_WARNING, region->item.where, "region `%s` is never used",
                  region->name);
  }
  free(used);
}

static const region_sites *region_of(const loads *l, const char *name) {
  const int r = deck_find_region(l->deck, name);
  return r < 0 ? NULL : &l->regions[r];
}

/* --- motions ---------------------------------------------------------------------------------- */

typedef struct motions { /* who holds which component of which particle, while the loads are set up
                          */
  int32_t *holder;       /* [dof * particle_count]: index of the constraint + 1 */
  int dof;
  const char *law;
  diagnostics *said;
} motions;

static span motion_where(const deck *k, const constraint *c, const int *supports, long index) {
  return c->drive >= 0 ? deck_where(&k->drives[c->drive].item, "region")
                       : deck_where(&k->supports[supports[index]].item, "region");
}

static const char *place_of(const loads *l, int64_t site, char text[ROWS_PLACE_TEXT]) {
  double at[3];
  rows_place(l->lattice, site, at);
  return rows_place_text(l->lattice->dimensions, at, text);
}

/* Two supports may share a particle: both hold it where it is. Anything else is two motions at
 * once. */
static bool add_motion(loads *l, motions *m, int **supports, int32_t particle, int component,
                       int drive, int support) {
  int32_t *holder = &m->holder[(long)component * l->lattice->particle_count + particle];
  if (*holder) {
    const constraint *first = &l->constraints[*holder - 1];
    if (drive < 0 && first->drive < 0) return true;
    const deck_item *item =
        drive >= 0 ? &l->deck->drives[drive].item : &l->deck->supports[support].item;
    char text[ROWS_PLACE_TEXT];
    diag_report(m->said, DIAG_CONFLICT, deck_where(item, "region"),
                "the particle at %s has its motion in %s prescribed twice",
                place_of(l, l->lattice->particle_site[particle], text),
                deck_component_name(l->lattice->dimensions, component));
    diag_note(m->said, motion_where(l->deck, first, *supports, *holder - 1),
              "first prescribed here");
    return false;
  }
  l->constraints =
      must_realloc(l->constraints, ((size_t)l->constraint_count + 1) * sizeof *l->constraints);
  *supports = must_realloc(*supports, ((size_t)l->constraint_count + 1) * sizeof **supports);
  (*supports)[l->constraint_count] = support;
  l->constraints[l->constraint_count] = (constraint){
      .site = l->lattice->particle_site[particle], .component = component, .drive = drive};
  *holder = (int32_t)++l->constraint_count;
  return true;
}

static bool has_component(const motions *m, int component, span where) {
  if (component < m->dof) return true;
  diag_report(m->said, DIAG_BAD_VALUE, where, "the particles of the law `%s` do not rotate",
              m->law);
  diag_hint(m->said, "only micropolar laws have rotations and moments on particles");
  return false;
}

static void add_motions(loads *l, motions *m) {
  const deck *k = l->deck;
  int *supports = NULL;
  for (int i = 0; i < k->support_count; i++) {
    const region_sites *at = region_of(l, k->supports[i].region);
    for (int c = 0; c < 3; c++) {
      if (!at || !(k->supports[i].fix & (1 << c))) continue;
      bool good = has_component(m, c, deck_where(&k->supports[i].item, "fix"));
      for (long p = 0; good && p < at->count; p++)
        good = add_motion(l, m, &supports, at->particles[p], c, -1, i);
    }
  }
  for (int i = 0; i < k->drive_count; i++) {
    const region_sites *at = region_of(l, k->drives[i].region);
    const int c = k->drives[i].component;
    bool good = at && has_component(m, c, deck_where(&k->drives[i].item, "component"));
    for (long p = 0; good && p < at->count; p++)
      good = add_motion(l, m, &supports, at->particles[p], c, i, -1);
  }
  free(supports);
}

/* --- the deck's time --------------------------------------------------------------------------- */

/* Part of the increment's loads that is there after `step` steps of a quasi-static run. */
static double part_of(const load_clock *c, long step) {
  return pl_fmin(1, (double)(step - c->first) / (double)c->ramp);
}

static double time_of(const loads *l, const body *w, long step) {
  const load_clock *c = &l->clock;
  if (c->ramp == 0) return (double)step * w->time_step;
  return c->from + (c->to - c->from) * part_of(c, step);
}

/* A time later than t by what rounding may do to the ends of increments. */
static double just_after(const load_clock *c, double t) {
  return t + 1e-9 * (c->to - c->from);
}

/* Time functions or their integrals. */
typedef double in_time(const time_function *f, double t);

/* When an increment has ended: a load that begins at that time comes in the next one. */
static double settled(const load_clock *c, const time_function *f, in_time *value, double t) {
  return t <= just_after(c, f->start) ? 0 : value(f, t);
}

/* After a number of steps; within an increment evenly from its beginning to its end, so that no load
   comes all at once. */
static double load_at(const loads *l, const body *w, const time_function *f, in_time *value,
                      long step) {
  const load_clock *c = &l->clock;
  if (c->ramp == 0) return value(f, time_of(l, w, step));
  const double part = part_of(c, step);
  return (1 - part) * settled(c, f, value, c->from) + part * settled(c, f, value, c->to);
}

/* Part of the time within half a step of t that comes after `start`. The run itself begins with what begins at 0. */
static double part_after(const body *w, double start, double t) {
  return start <= 0 ? 1 : pl_fmin(pl_fmax((t - start) / w->time_step + 0.5, 0), 1);
}

/* What acts in the step: the value at its instant, of a jump nearby the part that is covered. */
static double acting(const loads *l, const body *w, const time_function *f, long step) {
  const double value = load_at(l, w, f, time_function_at, step), jump = time_function_jump(f);
  if (l->clock.ramp > 0 || jump == 0) return value;
  const double t = time_of(l, w, step);
  return value + jump * (part_after(w, f->start, t) - (t >= f->start));
}

/* --- forces ----------------------------------------------------------------------------------- */

static void add_force(loads *l, int32_t particle, int component, int cause, double share) {
  l->forces = must_realloc(l->forces, ((size_t)l->force_count + 1) * sizeof *l->forces);
  l->forces[l->force_count++] = (applied){.site = l->lattice->particle_site[particle],
                                          .component = component,
                                          .cause = cause,
                                          .share = share};
}

static void add_forces(loads *l, const motions *m) {
  for (int i = 0; i < l->deck->force_count; i++) {
    const deck_force *f = &l->deck->forces[i];
    const region_sites *at = region_of(l, f->region);
    if (!at || !has_component(m, f->component, deck_where(&f->item, "component"))) continue;
    for (long p = 0; p < at->count; p++)
      add_force(l, at->particles[p], f->component, i, 1.0 / (double)at->count);
  }
}

/* Moment about z of horizontal forces f at heights y: -sum y f. Without resultant and linear in y,
   counter-clockwise when positive: f = -M (y - mean)/sum (y - mean)^2. */
static void add_end_moment(loads *l, int index, diagnostics *d) {
  const deck_end_moment *e = &l->deck->end_moments[index];
  const region_sites *at = region_of(l, e->region);
  if (!at || at->count == 0) return;
  const double *y = l->lattice->y;
  double mean = 0, square = 0;
  for (long p = 0; p < at->count; p++)
    mean += y[l->lattice->particle_site[at->particles[p]]] / (double)at->count;
  for (long p = 0; p < at->count; p++) {
    const double arm = y[l->lattice->particle_site[at->particles[p]]] - mean;
    square += arm * arm;
  }
  if (sqrt(square) < 1e-6 * l->lattice->spacing) {
    diag_report(
        d, DIAG_BAD_VALUE, deck_where(&e->item, "region"),
        "the particles of region `%s` lie at one height: horizontal forces on them make no moment",
        e->region);
    diag_hint(d, "let the region reach over several rows");
    return;
  }
  for (long p = 0; p < at->count; p++)
    add_force(l, at->particles[p], 0, l->deck->force_count + index,
              -(y[l->lattice->particle_site[at->particles[p]]] - mean) / square);
}

static int by_site(const void *a, const void *b) {
  const constraint *p = a, *q = b;
  if (p->site != q->site) return p->site < q->site ? -1 : 1;
  return (p->component > q->component) - (p->component < q->component);
}

static int by_site_and_cause(const void *a, const void *b) {
  const applied *p = a, *q = b;
  if (p->site != q->site) return p->site < q->site ? -1 : 1;
  if (p->component != q->component) return p->component < q->component ? -1 : 1;
  return (p->cause > q->cause) - (p->cause < q->cause);
}

/* No two items compare as equal. */
static void put_in_order(loads *l, const motions *m) {
  if (l->constraint_count > 0)
    qsort(l->constraints, (size_t)l->constraint_count, sizeof *l->constraints, by_site);
  if (l->force_count > 0)
    qsort(l->forces, (size_t)l->force_count, sizeof *l->forces, by_site_and_cause);
  for (long i = 0; i < l->constraint_count; i++) {
    const constraint *c = &l->constraints[i];
    const int32_t particle = l->lattice->site_particle[c->site];
    m->holder[(long)c->component * l->lattice->particle_count + particle] = (int32_t)i + 1;
  }
}

static void find_holders(loads *l, const motions *m) {
  for (long i = 0; i < l->force_count; i++) {
    applied *f = &l->forces[i];
    const int32_t particle = l->lattice->site_particle[f->site];
    f->holder = m->holder[(long)f->component * l->lattice->particle_count + particle] - 1;
  }
}

/* Of which a cause's forces are shares. */
static const time_function *cause_of(const loads *l, int cause) {
  const int forces = l->deck->force_count;
  return cause < forces ? &l->deck->forces[cause].force
                        : &l->deck->end_moments[cause - forces].moment;
}

static double factor_at(const loads *l, const body *w, int cause, long step) {
  return acting(l, w, cause_of(l, cause), step);
}

/* --- velocities at the start ------------------------------------------------------------------ */

enum { HELD = -1 };

static void mark_held(const loads *l, int *set) {
  for (long i = 0; i < l->constraint_count; i++) {
    const constraint *c = &l->constraints[i];
    if (c->drive < 0 || l->deck->drives[c->drive].motion.start <= 0)
      set[(long)c->component * l->lattice->size + c->site] = HELD;
  }
}

/* `set` remembers which velocities are given: [dof][size], index of the group + 1, or HELD. */
static void check_velocity(const loads *l, int index, int *set, diagnostics *d) {
  const deck_initial_velocity *v = &l->deck->initial_velocitys[index];
  const region_sites *at = region_of(l, v->region);
  for (long p = 0; at && p < at->count; p++) {
    const int64_t site = l->lattice->particle_site[at->particles[p]];
    int *given = &set[(long)v->component * l->lattice->size + site];
    if (*given) {
      const bool held = *given == HELD;
      char text[ROWS_PLACE_TEXT];
      diag_report(d, DIAG_CONFLICT, deck_where(&v->item, "region"), "the particle at %s %s %s",
                  place_of(l, site, text),
                  held ? "is held from the start in" : "is given two initial velocities in",
                  deck_component_name(l->lattice->dimensions, v->component));
      if (!held) diag_note(d, l->deck->initial_velocitys[*given - 1].item.where, "the other one");
      return;
    }
    *given = index + 1;
  }
}

static void check_velocities(const loads *l, const motions *m) {
  int *set = must_calloc((size_t)m->dof * (size_t)l->lattice->size + 1, sizeof *set);
  mark_held(l, set);
  for (int i = 0; i < l->deck->initial_velocity_count; i++) {
    const deck_initial_velocity *v = &l->deck->initial_velocitys[i];
    if (has_component(m, v->component, deck_where(&v->item, "component")))
      check_velocity(l, i, set, m->said);
  }
  free(set);
}

/* --- set-up ----------------------------------------------------------------------------------- */

static void protect(loads *l, rows *w) {
  for (int i = 0; i < l->deck->protect_count; i++) {
    const deck_protect *p = &l->deck->protects[i];
    const region_sites *at = region_of(l, p->region);
    if (at) rows_protect(w, at->particles, at->count, p->radius * w->spacing);
  }
}

loads *loads_new(const deck *k, int lattice, rows *w, const char *law, int dof, diagnostics *d) {
  const int before = d->errors;
  loads *l = must_calloc(1, sizeof *l);
  l->deck = k;
  l->lattice = w;
  select_regions(l, k, k->lattices[lattice].name, d);
  motions m = {.dof = dof, .law = law, .said = d};
  m.holder = must_calloc((size_t)dof * (size_t)w->particle_count + 1, sizeof *m.holder);
  add_motions(l, &m);
  add_forces(l, &m);
  for (int i = 0; i < k->end_moment_count; i++)
    add_end_moment(l, i, d);
  put_in_order(l, &m);
  find_holders(l, &m);
  check_velocities(l, &m);
  protect(l, w);
  free(m.holder);
  if (d->errors == before) return l;
  loads_free(l);
  return NULL;
}

void loads_free(loads *l) {
  if (!l) return;
  for (int r = 0; r < l->deck->region_count; r++)
    free(l->regions[r].particles);
  free(l->regions);
  free(l->constraints);
  free(l->forces);
  free(l);
}

long loads_constraints_of(const loads *l, int region, int component, int32_t **indices) {
  const region_sites *at = &l->regions[region];
  long count = 0;
  *indices = must_calloc((size_t)l->constraint_count + 1, sizeof **indices);
  unsigned char *inside = must_calloc((size_t)l->lattice->size, 1);
  for (long p = 0; p < at->count; p++)
    inside[l->lattice->particle_site[at->particles[p]]] = 1;
  for (long c = 0; c < l->constraint_count; c++)
    if (inside[l->constraints[c].site] && l->constraints[c].component == component)
      (*indices)[count++] = (int32_t)c;
  free(inside);
  return count;
}

/* --- velocities at the start ------------------------------------------------------------------ */

bool loads_initial_velocity(const loads *l, body *w, diagnostics *d) {
  bool good = true;
  for (int i = 0; i < l->deck->initial_velocity_count; i++) {
    const deck_initial_velocity *v = &l->deck->initial_velocitys[i];
    const region_sites *at = region_of(l, v->region);
    for (long p = 0; at && p < at->count; p++)
      w->velocity[v->component][l->lattice->particle_site[at->particles[p]]] = v->value;
    if (fabs(v->value) < w->limit[v->component]) continue;
    diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&v->item, "value"),
                "this velocity takes a particle further than %s in one step",
                v->component < w->dimensions ? "a spacing" : "half a turn");
    good = false;
  }
  return good;
}

/* --- in time ---------------------------------------------------------------------------------- */

static double decay_with(const body *w, double rate) {
  return rate > 0 ? pl_exp(-rate * w->time_step) : 1;
}

/* Factor of the step that begins at step * time_step. */
static double decay_of(const loads *l, const body *w, long step) {
  const double t = time_of(l, w, step);
  double rate = 0;
  for (int i = 0; i < l->deck->damping_count; i++) {
    const deck_damping *k = &l->deck->dampings[i];
    rate += k->rate * (part_after(w, k->from, t) - part_after(w, k->until, t));
  }
  return decay_with(w, rate);
}

/* Motion prescribed after `step` steps since the drive's start: m, rad. */
static double motion_at(const loads *l, const body *w, const constraint *c, long step) {
  if (c->drive < 0) return 0;
  const deck_drive *drive = &l->deck->drives[c->drive];
  return load_at(l, w, &drive->motion,
                 drive->is_displacement ? time_function_at : time_function_integral, step);
}

static double start_of(const loads *l, const constraint *c) {
  return c->drive < 0 ? 0 : l->deck->drives[c->drive].motion.start;
}

/* What of the time of a step is rounding. */
static double hardly(const body *w) {
  return 1e-6 * w->time_step;
}

/* A drive holds its particles from the step on that begins with it, to rounding; in a quasi-static run from the beginning of the
   increment that it begins in. */
static bool is_held(const loads *l, const body *w, const constraint *c, long step) {
  if (c->drive < 0) return true;
  if (l->clock.ramp > 0) return l->clock.to > just_after(&l->clock, start_of(l, c));
  return time_of(l, w, step) >= start_of(l, c) - hardly(w);
}

/* Velocity prescribed just after the instant of a step, which rounding may have put before the start. */
static double velocity_at(const loads *l, const body *w, const constraint *c, long step) {
  const deck_drive *drive = &l->deck->drives[c->drive];
  const double t = pl_fmax(time_of(l, w, step), drive->motion.start);
  return (drive->is_displacement ? time_function_slope : time_function_at)(&drive->motion, t);
}

/* A motion that begins moves on as if it had always gone so: its velocity half a step before is that after, mirrored at the
   velocity prescribed now. A place that is prescribed at once has no velocity. */
static double impulse_of(const loads *l, const body *w, const constraint *c, long step) {
  if (c->drive < 0 || l->clock.ramp > 0) return 0;
  const deck_drive *drive = &l->deck->drives[c->drive];
  if (drive->is_displacement && time_function_jump(&drive->motion) != 0) return 0;
  const double after = (c->anchor + motion_at(l, w, c, step + 1) - c->held) / w->time_step;
  return 2 * velocity_at(l, w, c, step) - after - c->velocity;
}

/* The motion takes up a particle that was free and stands where it is. */
static void take_up(const loads *l, const body *w, constraint *c, long step) {
  if (c->active || !is_held(l, w, c, step)) return;
  const bool placed = c->drive >= 0 && l->deck->drives[c->drive].is_displacement;
  c->active = 1;
  c->held = w->displacement[c->component][c->site];
  c->anchor = placed ? c->held : c->held - motion_at(l, w, c, step);
  c->impulse = impulse_of(l, w, c, step);
}

/* Weight of the step that begins at step * time_step, and its work for a velocity after that step; as for forces the mean of both
   ends of the way works. */
static void set_gravity(const loads *l, body *w, long step) {
  for (int c = 0; c < w->dimensions; c++) {
    double here = 0, next = 0;
    for (int i = 0; i < l->deck->gravity_count; i++) {
      const deck_gravity *g = &l->deck->gravitys[i];
      here += g->acceleration[c] * acting(l, w, &g->factor, step);
      next += g->acceleration[c] * acting(l, w, &g->factor, step + 1);
    }
    w->gravity[c] = here;
    w->gravity_work[c] = 0.5 * w->time_step * w->mass[c] * (here + next);
  }
}

void loads_increment(loads *l, const body *w, load_clock clock) {
  l->clock = clock;
  for (long i = 0; i < l->constraint_count; i++)
    take_up(l, w, &l->constraints[i], (long)clock.first);
}

void loads_begin(loads *l, body *w) {
  for (long i = 0; i < l->constraint_count; i++) {
    constraint *c = &l->constraints[i];
    c->velocity = w->velocity[c->component][c->site];
    take_up(l, w, c, 0);
  }
  for (long i = 0; i < l->force_count; i++) {
    l->forces[i].now = l->forces[i].share * factor_at(l, w, l->forces[i].cause, 0);
    l->forces[i].velocity = w->velocity[l->forces[i].component][l->forces[i].site];
  }
  if (l->clock.ramp == 0) w->decay = decay_of(l, w, 0);
  if (w->weight) set_gravity(l, w, 0);
}

/* Acceleration by what acts at once when the run begins; a step near it may have only part of that. */
static double weight_at_once(const loads *l, int component) {
  double sum = 0;
  for (int i = 0; i < l->deck->gravity_count; i++)
    sum += l->deck->gravitys[i].acceleration[component] *
           time_function_at(&l->deck->gravitys[i].factor, 0);
  return sum;
}

static double damping_at_once(const loads *l) {
  double rate = 0;
  for (int i = 0; i < l->deck->damping_count; i++)
    if (l->deck->dampings[i].from <= 0) rate += l->deck->dampings[i].rate;
  return rate;
}

/* With v- = 2/(1 + decay) v - dt/2 a the step (motion.h) goes to v+ with (v- + v+)/2 = v. */
void loads_set_back(loads *l, body *w) {
  const double half = 0.5 * w->time_step, back = 2 / (1 + decay_with(w, damping_at_once(l)));
  for (int d = 0; d < w->dof; d++) {
    const double weight = d < w->dimensions ? weight_at_once(l, d) : 0;
    for (long p = 0; p < l->lattice->particle_count; p++) {
      const int64_t q = l->lattice->particle_site[p];
      double *v = &w->velocity[d][q];
      *v = back * *v - half * (w->force[d][q] / body_mass(w, d, q) + weight);
    }
  }
  for (long i = 0; i < l->force_count; i++) {
    applied *f = &l->forces[i];
    const double force = f->share * time_function_at(cause_of(l, f->cause), 0);
    w->velocity[f->component][f->site] -= half * force / body_mass(w, f->component, f->site);
  }
  for (long i = 0; i < l->constraint_count; i++) {
    constraint *c = &l->constraints[i];
    double *v = &w->velocity[c->component][c->site];
    if (c->active)
      *v = c->velocity;
    else
      c->velocity = *v;
  }
  for (long i = 0; i < l->force_count; i++)
    l->forces[i].velocity = w->velocity[l->forces[i].component][l->forces[i].site];
}

/* The first item of an order by site that stands at `site` or further on; items begin with their site. */
static long first_at(const void *items, long count, size_t size, int64_t site) {
  long low = 0, high = count;
  while (low < high) {
    const long middle = low + (high - low) / 2;
    const int64_t *here = (const void *)((const char *)items + (size_t)middle * size);
    if (*here < site)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* The loads on the rows of a block in a step. */
typedef struct load_run {
  loads *l;
  body *w;
  long step;
  bool stuck; /* some rows have not moved */
  long first_constraint, last_constraint, first_force, last_force;
} load_run;

static load_run run_of(loads *l, body *w, int block, long step) {
  const body_block *b = &w->blocks[block];
  const int64_t from = rows_start(l->lattice, b->first), to = rows_start(l->lattice, b->last);
  load_run r = {.l = l, .w = w, .step = step, .stuck = b->bad_site >= 0};
  r.first_constraint = first_at(l->constraints, l->constraint_count, sizeof *l->constraints, from);
  r.last_constraint = first_at(l->constraints, l->constraint_count, sizeof *l->constraints, to);
  r.first_force = first_at(l->forces, l->force_count, sizeof *l->forces, from);
  r.last_force = first_at(l->forces, l->force_count, sizeof *l->forces, to);
  return r;
}

static bool has_moved(const load_run *r, int64_t site) {
  return !r->stuck || body_has_moved(r->w, site);
}

/* The sweep has counted the loss to mass damping, the work of gravity and that against the bonds over the way of a free particle,
   whose velocity was `before` and is `after`; it turns out to be larger by `change`. */
static void correct_free_way(const body *w, int component, int64_t site, double before,
                             double after, double change, load_sums *sums) {
  const double mass = body_mass(w, component, site);
  if (component < w->dimensions)
    sums->work += w->gravity_work[component] * (mass / w->mass[component]) * change;
  sums->dissipated += 0.5 * mass * motion_drag(w) * change * (2 * (before + after) + change);
  if (w->works) sums->internal -= 0.5 * w->time_step * w->force[component][site] * change;
}

/* Velocity that a force gives in a step. */
static double given_by(const body *w, int component, int64_t site, double force) {
  return w->time_step / body_mass(w, component, site) * (motion_force_part(w) * force);
}

static void apply_forces(const load_run *r) {
  const body *w = r->w;
  for (long i = r->first_force; i < r->last_force; i++) {
    applied *f = &r->l->forces[i];
    if (!has_moved(r, f->site)) continue;
    double *v = &w->velocity[f->component][f->site];
    const double change = given_by(w, f->component, f->site, f->now);
    correct_free_way(w, f->component, f->site, f->velocity, *v, change, &f->sums);
    *v += change;
    w->displacement[f->component][f->site] += w->time_step * change;
  }
}

/* Values of the deck's functions after the step: few of them serve many particles. */
typedef struct remembered {
  int32_t index[8]; /* of a function, + 1; 0: none */
  double value[8];
} remembered;

/* True: *value is that of the function; else it is to be set now. */
static bool is_remembered(remembered *m, int32_t index, double **value) {
  const int slot = index % 8;
  *value = &m->value[slot];
  if (m->index[slot] == index + 1) return true;
  m->index[slot] = index + 1;
  return false;
}

static double motion_after(const load_run *r, const constraint *c, remembered *m) {
  double *motion;
  if (c->drive < 0) return 0;
  if (!is_remembered(m, c->drive, &motion)) *motion = motion_at(r->l, r->w, c, r->step + 1);
  return *motion;
}

static double force_after(const load_run *r, const applied *f, remembered *m) {
  double *factor;
  if (!is_remembered(m, f->cause, &factor)) *factor = factor_at(r->l, r->w, f->cause, r->step + 1);
  return f->share * *factor;
}

/* Force that gives a particle one velocity instead of another after a step. */
static double force_for(const body *w, const constraint *c, double change) {
  return body_mass(w, c->component, c->site) * change / (w->time_step * motion_force_part(w));
}

/* Moves the particle to `target` instead of where it would go. What this takes works with the mean of the velocities before and
   after. */
static double pull(const body *w, constraint *c, double target) {
  double *v = &w->velocity[c->component][c->site], *u = &w->displacement[c->component][c->site];
  const double before = c->velocity, prescribed = (target - c->held) / w->time_step;
  const double force = force_for(w, c, prescribed - *v);
  correct_free_way(w, c->component, c->site, before, *v, prescribed - *v, &c->sums);
  c->sums.work += 0.5 * w->time_step * force * (before + prescribed);
  c->held = target;
  *v = prescribed;
  *u = target;
  return force;
}

/* Part of the force in the step that a motion begins with: its impulse. */
static double impulsive(const body *w, const constraint *c) {
  return c->impulse == 0 ? 0 : force_for(w, c, w->decay * c->impulse);
}

/* A motion that begins between the ends of the step: until then the particle was free. */
static void begin_on_the_way(const load_run *r, constraint *c, remembered *after) {
  const body *w = r->w;
  const double rest = time_of(r->l, w, r->step + 1) - start_of(r->l, c);
  if (r->l->clock.ramp > 0 || rest <= hardly(w)) return;
  const double v = w->velocity[c->component][c->site],
               here = w->displacement[c->component][c->site];
  c->active = 1;
  c->anchor = here - rest * v;
  c->held = here - w->time_step * v;
  pull(w, c, c->anchor + motion_after(r, c, after));
}

static void apply_motion(const load_run *r, constraint *c, remembered *after) {
  const body *w = r->w;
  const bool held = c->active;
  c->reaction = 0;
  if (held)
    c->reaction = pull(w, c, c->anchor + motion_after(r, c, after)) - impulsive(w, c);
  else
    begin_on_the_way(r, c, after);
  c->velocity = w->velocity[c->component][c->site];
  c->impulse = c->active && !held ? impulse_of(r->l, w, c, r->step + 1) : 0;
}

static void apply_motions(const load_run *r) {
  remembered after = {{0}, {0}};
  for (long i = r->first_constraint; i < r->last_constraint; i++)
    if (has_moved(r, r->l->constraints[i].site)) apply_motion(r, &r->l->constraints[i], &after);
}

/* A force works with the mean of its values at both ends of the way. */
static void next_forces(const load_run *r) {
  remembered after = {{0}, {0}};
  for (long i = r->first_force; i < r->last_force; i++) {
    applied *f = &r->l->forces[i];
    const double next = force_after(r, f, &after);
    f->velocity = r->w->velocity[f->component][f->site];
    f->sums.work += 0.5 * r->w->time_step * (f->now + next) * f->velocity;
    f->now = next;
  }
}

void loads_apply(loads *l, body *w, int block, long step) {
  const load_run r = run_of(l, w, block, step);
  apply_forces(&r);
  apply_motions(&r);
  next_forces(&r);
  for (long i = r.first_constraint; i < r.last_constraint; i++)
    take_up(l, w, &l->constraints[i], step + 1);
}

void loads_turn(const loads *l, body *w, long step) {
  if (l->clock.ramp == 0) w->decay = decay_of(l, w, step + 1);
  if (w->weight) set_gravity(l, w, step + 1);
}

static void add_sums(load_sums *to, const load_sums *more) {
  to->work += more->work;
  to->dissipated += more->dissipated;
  to->internal += more->internal;
}

load_sums loads_total(const loads *l) {
  load_sums total = {0, 0, 0};
  for (long i = 0; i < l->force_count; i++)
    add_sums(&total, &l->forces[i].sums);
  for (long i = 0; i < l->constraint_count; i++)
    add_sums(&total, &l->constraints[i].sums);
  return total;
}

/* Velocity after the coming step if nothing but bonds, damping and gravity acted on a particle. */
static double free_velocity(const body *w, int component, int64_t site) {
  const double weight = component < w->dimensions ? w->gravity[component] : 0;
  return w->decay * w->velocity[component][site] +
         given_by(w, component, site, w->force[component][site]) +
         w->time_step * motion_force_part(w) * weight;
}

/* The same when a motion is prescribed. */
static double prescribed_velocity(const loads *l, const body *w, const constraint *c, long step) {
  return (c->anchor + motion_at(l, w, c, step + 1) - c->held) / w->time_step;
}

/* In quasi-static runs inertia is but a means: a reaction is what balances bonds and weight. */
static double force_at_rest(const body *w, const constraint *c) {
  const double weight = c->component < w->dimensions ? w->gravity[c->component] : 0;
  return w->force[c->component][c->site] + body_mass(w, c->component, c->site) * weight;
}

load_look loads_observe(loads *l, const body *w, long step) {
  load_look sum = {0, 0, 0};
  for (long i = 0; i < l->constraint_count; i++) {
    constraint *c = &l->constraints[i];
    c->reaction = 0;
    if (!c->active) continue;
    const double mass = body_mass(w, c->component, c->site);
    const double change =
        prescribed_velocity(l, w, c, step) - free_velocity(w, c->component, c->site);
    const double force = force_for(w, c, change);
    c->reaction = l->clock.ramp > 0 ? -force_at_rest(w, c) : force - impulsive(w, c);
    sum.kinetic += 0.5 * mass * c->velocity * change;
    sum.dissipated += 0.5 * mass * motion_drag(w) * c->velocity * change;
    sum.work += 0.5 * w->time_step * c->velocity * force;
  }
  for (long i = 0; i < l->force_count; i++) {
    const applied *f = &l->forces[i];
    constraint *holder = f->holder >= 0 ? &l->constraints[f->holder] : NULL;
    const double power = 0.5 * w->time_step * f->now * f->velocity;
    if (holder && holder->active) { /* what holds the particle takes the force up */
      holder->reaction -= f->now;
      sum.work -= power;
      continue;
    }
    sum.kinetic += motion_force_part(w) * power;
    sum.dissipated += motion_force_part(w) * motion_drag(w) * power;
  }
  return sum;
}

static double mean_velocity(const loads *l, const body *w, const constraint *c, long step) {
  return 0.5 * (c->velocity + c->impulse + prescribed_velocity(l, w, c, step));
}

double loads_velocity(const loads *l, const body *w, int component, int64_t site, long step) {
  const long count = l->constraint_count;
  long i = first_at(l->constraints, count, sizeof *l->constraints, site);
  for (; i < count && l->constraints[i].site == site; i++)
    if (l->constraints[i].component == component && l->constraints[i].active)
      return mean_velocity(l, w, &l->constraints[i], step);
  double after = free_velocity(w, component, site);
  i = first_at(l->forces, l->force_count, sizeof *l->forces, site);
  for (; i < l->force_count && l->forces[i].site == site; i++)
    if (l->forces[i].component == component)
      after += given_by(w, component, site, l->forces[i].now);
  return 0.5 * (w->velocity[component][site] + after);
}
