#include "runtime/loads/load_steps.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/body/motion.h"
#include "runtime/body/rotation_vector.h"

/* Of which a cause's forces are shares. */
static const time_function *cause_of(const loads *l, int cause) {
  const int forces = l->deck->force_count;
  return cause < forces ? &l->deck->forces[cause].force
                        : &l->deck->end_moments[cause - forces].moment;
}

/* The function of a load where it acts. */
static time_function function_at(const loads *l, const time_function *f, int64_t site) {
  double at[3];
  if (!time_function_varies(f)) return *f;
  rows_place(l->lattice, site, at);
  return time_function_placed(f, at);
}

/* The function of a force: of its particle, or of a place of its own. */
static time_function function_of(const loads *l, const applied *f) {
  const time_function *of = cause_of(l, f->cause);
  return f->place ? time_function_placed(of, l->places[f->place - 1]) : function_at(l, of, f->site);
}

static double factor_at(const loads *l, const body *w, const applied *f, long step) {
  if (f->link) return *f->link;
  const time_function here = function_of(l, f);
  return load_clock_acting(&l->clock, w, &here, step);
}

/* --- in time ---------------------------------------------------------------------------------- */

static double decay_with(const body *w, double rate) {
  return rate > 0 ? pl_exp(-rate * w->time_step) : 1;
}

/* Factor of the step that begins at step * time_step. */
static double decay_of(const loads *l, const body *w, long step) {
  const double t = load_clock_time(&l->clock, w, step);
  double rate = 0;
  for (int i = 0; i < l->deck->damping_count; i++) {
    const deck_damping *k = &l->deck->dampings[i];
    rate +=
        k->rate * (load_clock_part_after(w, k->from, t) - load_clock_part_after(w, k->until, t));
  }
  return decay_with(w, rate);
}

/* What of the time of a step is rounding. */
static double hardly(const body *w) {
  return 1e-6 * w->time_step;
}

static const deck_drive *drive_of(const loads *l, const constraint *c) {
  return &l->deck->drives[c->drive];
}

static double start_of(const loads *l, const constraint *c) {
  return c->drive < 0 ? 0 : drive_of(l, c)->motion.start;
}

static double end_of(const loads *l, const constraint *c) {
  return c->drive < 0 ? INFINITY : time_function_end(&drive_of(l, c)->motion);
}

static time_function motion_of(const loads *l, const constraint *c) {
  return function_at(l, &drive_of(l, c)->motion, c->site);
}

/* The way of such a drive is summed up step by step, or increment by increment: from its anchor,
   which goes along. */
static bool is_summed(const loads *l, const constraint *c) {
  return c->drive >= 0 && !drive_of(l, c)->is_displacement && drive_of(l, c)->motion.formula;
}

/* Slope of a displacement just after t, or just before. Of a formula through five places within
   half a step, of the fourth order: reactions are by two orders less exact. */
static double slope_at(const body *w, const time_function *f, double t, bool before) {
  if (!f->formula) return time_function_slope(f, before ? t - hardly(w) : t);
  static const double weight[] = {-25, 48, -36, 16, -3};
  const double h = (before ? -0.125 : 0.125) * w->time_step;
  double sum = 0;
  for (int k = 0; k < 5; k++)
    sum += weight[k] * time_function_at(f, t + k * h);
  return sum / (12 * h);
}

/* Velocity that a drive ends with: just before, as kinks often lie there. */
static double last_velocity(const loads *l, const body *w, const constraint *c) {
  const time_function f = motion_of(l, c);
  return drive_of(l, c)->is_displacement ? slope_at(w, &f, f.end, true)
                                         : time_function_at(&f, f.end);
}

/* Up to a time within the step that ends after `step` steps. */
static double way_until(const loads *l, const body *w, const constraint *c, long step, double t) {
  const time_function f = motion_of(l, c);
  if (drive_of(l, c)->is_displacement) return time_function_at(&f, t);
  if (!f.formula) return time_function_integral(&f, t);
  const double from = pl_fmax(load_clock_time(&l->clock, w, step - 1), f.start);
  return time_function_way(&f, pl_fmin(from, t), t, 1);
}

static double motion_in_increment(const loads *l, const body *w, const constraint *c, long step) {
  enum { PIECES = 16 };
  const time_function f = motion_of(l, c);
  in_time *const motion =
      drive_of(l, c)->is_displacement ? time_function_at : time_function_integral;
  if (!is_summed(l, c)) return load_clock_value(&l->clock, w, &f, motion, step);
  return load_clock_part(&l->clock, step) *
         time_function_way(&f, pl_fmax(l->clock.from, f.start), l->clock.to, PIECES);
}

/* Motion prescribed after `step` steps: m, rad. Since the drive's start, or what is summed up.
   After its end it goes on straight. */
static double motion_at(const loads *l, const body *w, const constraint *c, long step) {
  if (c->drive < 0) return 0;
  if (l->clock.ramp > 0) return motion_in_increment(l, w, c, step);
  const double t = load_clock_time(&l->clock, w, step), end = end_of(l, c);
  if (t <= end) return way_until(l, w, c, step, t);
  const double over = is_summed(l, c) ? pl_fmin(t - end, w->time_step) : t - end;
  return way_until(l, w, c, step, end) + over * last_velocity(l, w, c);
}

static bool has_ended(const loads *l, const body *w, const constraint *c, long step) {
  return load_clock_time(&l->clock, w, step) >= end_of(l, c) - hardly(w);
}

/* A drive holds its particles from the step on that begins with it, to rounding; in a quasi-static
   run in all increments that it acts at the end of. */
static bool is_held(const loads *l, const body *w, const constraint *c, long step) {
  if (c->drive < 0) return true;
  if (l->clock.ramp > 0) return load_clock_settled(&l->clock, &drive_of(l, c)->motion, l->clock.to);
  return load_clock_time(&l->clock, w, step) >= start_of(l, c) - hardly(w) &&
         !has_ended(l, w, c, step);
}

/* Velocity prescribed just after the instant of a step, which rounding may have put before the
   start. */
static double velocity_at(const loads *l, const body *w, const constraint *c, long step) {
  const time_function f = motion_of(l, c);
  const double t = pl_fmax(load_clock_time(&l->clock, w, step), f.start);
  if (t >= end_of(l, c)) return last_velocity(l, w, c);
  return drive_of(l, c)->is_displacement ? slope_at(w, &f, t, false) : time_function_at(&f, t);
}

/* A driven node of a mesh that gives way to the body: a step moves it by dt v + dt^2 a/2, v being
   the prescribed velocity and dt a what it would gain by itself, of a whole step that would take it
   to the velocity `free`. */
static bool gives_way(const loads *l, const constraint *c) {
  return l->gives_way && c->drive >= 0;
}

static double velocity_given_way(const loads *l, const body *w, const constraint *c, long step,
                                 double free) {
  return velocity_at(l, w, c, step) + 0.5 * (free - c->velocity);
}

/* The step is the drive's last: it ends within half a step of its instant, or earlier. */
static bool lets_go(const loads *l, const body *w, const constraint *c, long step) {
  if (c->drive < 0 || l->clock.ramp > 0) return false; /* supports do not */
  const double last = load_clock_time(&l->clock, w, step) + 0.5 * w->time_step;
  return last >= end_of(l, c) - hardly(w);
}

/* Velocity after that step: the drive's last one, and from its end on what the particle gains by
   itself, which a whole step would take to the velocity `free`. */
static double velocity_let_go(const loads *l, const body *w, const constraint *c, long step,
                              double free) {
  const double since = load_clock_time(&l->clock, w, step) + 0.5 * w->time_step - end_of(l, c);
  return last_velocity(l, w, c) + since / w->time_step * (free - c->velocity);
}

/* A motion that begins moves on as if it had always gone so: its velocity half a step before is
   that after, mirrored at the velocity prescribed now. A place that is prescribed at once has no
   velocity. */
static double impulse_of(const loads *l, const body *w, const constraint *c, long step) {
  if (c->drive < 0 || l->clock.ramp > 0) return 0;
  const time_function f = motion_of(l, c);
  if (drive_of(l, c)->is_displacement && time_function_jump(&f) != 0) return 0;
  const double after = (c->anchor + motion_at(l, w, c, step + 1) - c->held) / w->time_step;
  return 2 * velocity_at(l, w, c, step) - after - c->velocity;
}

/* The motion takes up a particle that was free and stands where it is. */
static void take_up(const loads *l, const body *w, constraint *c, long step) {
  if (c->active || !is_held(l, w, c, step)) return;
  const bool placed = c->drive >= 0 && drive_of(l, c)->is_displacement;
  c->active = 1;
  c->held = w->displacement[c->component][c->site];
  c->anchor = placed ? c->held : c->held - motion_at(l, w, c, step);
  c->impulse = impulse_of(l, w, c, step);
}

/* Weight of the step that begins at step * time_step, and its work for a velocity after that step;
   as for forces the mean of both ends of the way works. */
static void set_gravity(const loads *l, body *w, long step) {
  for (int c = 0; c < w->dimensions; c++) {
    double here = 0, next = 0;
    for (int i = 0; i < l->deck->gravity_count; i++) {
      const deck_gravity *g = &l->deck->gravitys[i];
      here += g->acceleration[c] * load_clock_acting(&l->clock, w, &g->factor, step);
      next += g->acceleration[c] * load_clock_acting(&l->clock, w, &g->factor, step + 1);
    }
    w->gravity[c] = here;
    w->gravity_work[c] = 0.5 * w->time_step * w->mass[c] * (here + next);
  }
}

/* Of a particle that rotates in space all constraints on its rotations together: what holds one
   component may turn it about all axes (rotation_vector.h). They stand side by side. */
typedef struct held_turn {
  constraint *first;
  int count;
} held_turn;

static int axis_of(const body *w, const constraint *c) {
  return c->component - w->dimensions;
}

/* Those that begin with constraint i; count 0: it is none of them. */
static held_turn turn_at(const loads *l, const body *w, long i) {
  held_turn t = {.first = &l->constraints[i]};
  if (w->dof < 6 || axis_of(w, t.first) < 0) return t;
  while (i + t.count < l->constraint_count && t.first[t.count].site == t.first->site)
    t.count++;
  return t;
}

static void keep_turning(const body *w, const held_turn *t) {
  for (int k = 0; k < 3; k++)
    t->first->turning[k] = w->velocity[w->dimensions + k][t->first->site];
}

static void keep_all_turning(const loads *l, const body *w) {
  for (long i = 0; i < l->constraint_count; i++) {
    const held_turn t = turn_at(l, w, i);
    if (!t.count) continue;
    keep_turning(w, &t);
    i += t.count - 1;
  }
}

double load_steps_motion(const loads *l, const body *w, const constraint *c, long step) {
  return motion_at(l, w, c, step);
}

double load_steps_factor(const loads *l, const body *w, const applied *f, long step) {
  return factor_at(l, w, f, step);
}

void load_steps_weigh(const loads *l, body *w, long step) {
  if (w->weight) set_gravity(l, w, step);
}

bool load_steps_holds(const loads *l, const body *w, const constraint *c) {
  return is_held(l, w, c, (long)l->clock.first);
}

void load_steps_increment(loads *l, const body *w, load_clock clock) {
  l->clock = clock;
  for (long i = 0; i < l->constraint_count; i++) {
    constraint *c = &l->constraints[i];
    if (!is_held(l, w, c, (long)clock.first)) c->active = 0;
    if (is_summed(l, c)) c->anchor = c->held;
    take_up(l, w, c, (long)clock.first);
  }
}

void load_steps_begin(loads *l, body *w) {
  for (long i = 0; i < l->constraint_count; i++) {
    constraint *c = &l->constraints[i];
    c->velocity = w->velocity[c->component][c->site];
    take_up(l, w, c, 0);
  }
  keep_all_turning(l, w);
  for (long i = 0; i < l->force_count; i++) {
    l->forces[i].now = l->forces[i].share * factor_at(l, w, &l->forces[i], 0);
    l->forces[i].velocity = w->velocity[l->forces[i].component][l->forces[i].site];
  }
  if (l->clock.ramp == 0) w->decay = decay_of(l, w, 0);
  if (w->weight) set_gravity(l, w, 0);
}

/* Acceleration by what acts at once when the run begins; a step near it may have only part of
   that. */
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

static double force_at_once(const loads *l, const applied *f) {
  if (f->link) return f->share * *f->link;
  const time_function here = function_of(l, f);
  return f->share * time_function_at(&here, 0);
}

/* s: twice the time that the velocity of a particle is to be set back by. */
static double time_to_set_back(const loads *l, const body *w, int64_t site) {
  return l->goes_on && l->goes_on[site] ? w->time_step - l->former_step : w->time_step;
}

/* With v- = 2/(1 + decay) v - dt/2 a the step (motion.h) goes to v+ with (v- + v+)/2 = v. What goes
   on from a run with the same step has that velocity, to the bit. */
static void set_particle_back(const loads *l, body *w, int component, int64_t site, double weight,
                              double rate) {
  const double time = time_to_set_back(l, w, site),
               back = 2 / (1 + (rate > 0 ? pl_exp(-rate * time) : 1));
  double *v = &w->velocity[component][site];
  if (time == 0) return;
  *v = back * *v - 0.5 * time *
                       ((w->force[component][site] + body_outer(w, component, site)) /
                            body_mass(w, component, site) +
                        weight);
}

void load_steps_set_back(loads *l, body *w) {
  const double rate = damping_at_once(l);
  for (int d = 0; d < w->dof; d++) {
    const double weight = d < w->dimensions ? weight_at_once(l, d) : 0;
    for (long p = 0; p < l->lattice->particle_count; p++) {
      const int64_t q = l->lattice->particle_site[p];
      if (!(body_mass(w, d, q) > 0)) continue; /* a tie moves it */
      set_particle_back(l, w, d, q, weight, rate);
    }
  }
  for (long i = 0; i < l->force_count; i++) {
    applied *f = &l->forces[i];
    w->velocity[f->component][f->site] -= 0.5 * time_to_set_back(l, w, f->site) *
                                          force_at_once(l, f) / body_mass(w, f->component, f->site);
  }
  for (long i = 0; i < l->constraint_count; i++) {
    constraint *c = &l->constraints[i];
    double *v = &w->velocity[c->component][c->site];
    if (c->active)
      *v = c->velocity;
    else
      c->velocity = *v;
  }
  keep_all_turning(l, w);
  for (long i = 0; i < l->force_count; i++)
    l->forces[i].velocity = w->velocity[l->forces[i].component][l->forces[i].site];
}

/* The first item of an order by site that stands at `site` or further on; items begin with their
   site. */
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

long load_steps_first_force(const loads *l, int64_t site) {
  return first_at(l->forces, l->force_count, sizeof *l->forces, site);
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

/* The sweep has counted the loss to mass damping, the work of gravity and that against the bonds
   over the way of a free particle, whose velocity was `before` and is `after`; it turns out to be
   larger by `change`. */
static void correct_free_way(const body *w, int component, int64_t site, double before,
                             double after, double change, load_sums *sums) {
  const double mass = body_mass(w, component, site);
  if (w->weight && component < w->dimensions)
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
    const double v = w->velocity[f->component][f->site];
    const double change = given_by(w, f->component, f->site, f->now);
    correct_free_way(w, f->component, f->site, f->velocity, v, change, &f->sums);
    motion_change(r->w, f->component, f->site, change);
  }
}

/* What a drive or a force does in the step: few of them serve many particles. */
typedef struct cause_step {
  int32_t next;         /* index of the cause, + 1; 0: none */
  bool varies;          /* from particle to particle */
  bool lets_go, summed; /* of drives */
  double value;         /* after the step, unless it varies */
} cause_step;

enum { REMEMBERED = 8 };

static cause_step step_of_drive(const load_run *r, const constraint *c) {
  return (cause_step){.next = c->drive + 1,
                      .varies = time_function_varies(&drive_of(r->l, c)->motion),
                      .lets_go = lets_go(r->l, r->w, c, r->step),
                      .summed = r->l->clock.ramp == 0 && is_summed(r->l, c),
                      .value = motion_at(r->l, r->w, c, r->step + 1)};
}

static cause_step step_of_force(const load_run *r, const applied *f) {
  return (cause_step){.next = f->cause + 1,
                      .varies = time_function_varies(cause_of(r->l, f->cause)),
                      .value = factor_at(r->l, r->w, f, r->step + 1)};
}

/* Of what holds a particle; a support does nothing. */
static const cause_step *drive_step(const load_run *r, const constraint *c, cause_step *known) {
  static const cause_step support = {0};
  if (c->drive < 0) return &support;
  cause_step *drive = &known[c->drive % REMEMBERED];
  if (drive->next != c->drive + 1) *drive = step_of_drive(r, c);
  return drive;
}

static double motion_after(const load_run *r, const constraint *c, const cause_step *drive) {
  return drive->varies ? motion_at(r->l, r->w, c, r->step + 1) : drive->value;
}

static double force_after(const load_run *r, const applied *f, cause_step *known) {
  cause_step *force = &known[f->cause % REMEMBERED];
  if (force->next != f->cause + 1) *force = step_of_force(r, f);
  return f->share * (force->varies ? factor_at(r->l, r->w, f, r->step + 1) : force->value);
}

/* Force that gives a particle one velocity instead of another after a step. */
static double force_for(const body *w, int component, int64_t site, double change) {
  return body_mass(w, component, site) * change / (w->time_step * motion_force_part(w));
}

/* Gives a particle the velocity `prescribed` instead of the one it would have. What this takes
   works with the mean of the velocities before and after. */
static inline double push(body *w, int component, int64_t site, double before, double prescribed,
                          load_sums *sums) {
  double *v = &w->velocity[component][site];
  const double force = force_for(w, component, site, prescribed - *v);
  correct_free_way(w, component, site, before, *v, prescribed - *v, sums);
  sums->work += 0.5 * w->time_step * force * (before + prescribed);
  *v = prescribed;
  return force;
}

/* Moves the particle to `target` instead of where it would go; `leaves`: and lets it go there. */
static inline double pull(body *w, constraint *c, double target, bool leaves) {
  double *at = &w->displacement[c->component][c->site];
  const double free = w->velocity[c->component][c->site];
  const double prescribed = (target - c->held) / w->time_step;
  const double force = push(w, c->component, c->site, c->velocity, prescribed, &c->sums);
  *at = leaves ? *at + w->time_step * (prescribed - free) : target;
  c->held = target;
  return force;
}

/* The same of rotations in space, for the components in `held`. The particle has come from where it
   is by its velocities; of the components in `before` that is known to the bit. */
static void pull_turn(body *w, const held_turn *t, int held, int before, const double target[3],
                      double moment[3]) {
  const int first = w->dimensions;
  const int64_t site = t->first->site;
  double r[3], now[3], turn[3];
  motion_turned_before(w, site, r);
  for (int k = 0; k < 3; k++)
    now[k] = w->velocity[first + k][site];
  for (int k = 0; k < t->count; k++)
    if (before >> axis_of(w, &t->first[k]) & 1) r[axis_of(w, &t->first[k])] = t->first[k].held;
  rotation_vector_reach(r, w->time_step, held, target, now);
  for (int k = 0; k < 3; k++) {
    turn[k] = w->time_step * now[k];
    moment[k] = push(w, first + k, site, t->first->turning[k], now[k], &t->first->sums);
  }
  rotation_vector_turn(r, turn);
  for (int k = 0; k < 3; k++)
    w->displacement[first + k][site] = held >> k & 1 ? target[k] : r[k];
}

/* Part of the force in the step that a motion begins with: its impulse. */
static double impulsive(const body *w, const constraint *c) {
  return c->impulse == 0 ? 0 : force_for(w, c->component, c->site, w->decay * c->impulse);
}

/* A motion that begins between the ends of the step: until then the particle was free. */
static bool begins_on_the_way(const load_run *r, constraint *c, const cause_step *drive,
                              double *target) {
  body *w = r->w;
  if (has_ended(r->l, w, c, r->step)) return false;
  const double rest = load_clock_time(&r->l->clock, w, r->step + 1) - start_of(r->l, c);
  if (r->l->clock.ramp > 0 || rest <= hardly(w)) return false;
  const double v = w->velocity[c->component][c->site],
               here = w->displacement[c->component][c->site];
  c->active = 1;
  c->anchor = here - rest * v;
  c->held = here - w->time_step * v;
  *target = c->anchor + motion_after(r, c, drive);
  return true;
}

/* Where the motion takes the particle in the step; false: it is free. Of the step that it lets go
   in, the part that the drive still covers decides. */
static inline bool aims(const load_run *r, constraint *c, const cause_step *drive, double *target) {
  body *w = r->w;
  if (!c->active) return begins_on_the_way(r, c, drive, target);
  if (drive->lets_go) {
    const double free = w->velocity[c->component][c->site];
    *target = c->held + w->time_step * velocity_let_go(r->l, w, c, r->step, free);
  } else if (gives_way(r->l, c)) {
    const double free = w->velocity[c->component][c->site];
    *target = c->held + w->time_step * velocity_given_way(r->l, w, c, r->step, free);
  } else {
    *target = c->anchor + motion_after(r, c, drive);
  }
  return true;
}

/* After the step, in which `force` was needed; `held`: from its beginning. */
static inline void settle(const load_run *r, constraint *c, const cause_step *drive, bool held,
                          double force) {
  body *w = r->w;
  c->reaction = held ? force - impulsive(w, c) : 0;
  if (held && drive->lets_go) c->active = 0;
  c->velocity = w->velocity[c->component][c->site];
  if (drive->summed) c->anchor = c->held;
  c->impulse = c->active && !held ? impulse_of(r->l, w, c, r->step + 1) : 0;
}

static void apply_motion(const load_run *r, constraint *c, cause_step *known) {
  const cause_step *drive = drive_step(r, c, known);
  const bool held = c->active;
  double target, force = 0;
  if (aims(r, c, drive, &target)) force = pull(r->w, c, target, held && drive->lets_go);
  settle(r, c, drive, held, force);
}

static void apply_turn(const load_run *r, const held_turn *t, cause_step *known) {
  double target[3] = {0, 0, 0}, moment[3] = {0, 0, 0};
  int held = 0, before = 0;
  for (int k = 0; k < t->count; k++) {
    constraint *c = &t->first[k];
    const int axis = axis_of(r->w, c);
    if (c->active) before |= 1 << axis;
    if (aims(r, c, drive_step(r, c, known), &target[axis])) held |= 1 << axis;
  }
  if (held) pull_turn(r->w, t, held, before, target, moment);
  for (int k = 0; k < t->count; k++) {
    constraint *c = &t->first[k];
    const int axis = axis_of(r->w, c);
    if (held >> axis & 1) c->held = target[axis];
    settle(r, c, drive_step(r, c, known), before >> axis & 1, moment[axis]);
  }
  keep_turning(r->w, t);
}

static void apply_motions(const load_run *r) {
  cause_step known[REMEMBERED] = {{0}};
  for (long i = r->first_constraint; i < r->last_constraint; i++) {
    constraint *c = &r->l->constraints[i];
    const held_turn turn = turn_at(r->l, r->w, i);
    if (has_moved(r, c->site)) {
      if (turn.count)
        apply_turn(r, &turn, known);
      else
        apply_motion(r, c, known);
    }
    for (const constraint *last = c + (turn.count ? turn.count : 1); c < last; c++)
      take_up(r->l, r->w, c, r->step + 1);
    if (turn.count) i += turn.count - 1;
  }
}

/* A force works with the mean of its values at both ends of the way. */
static void take_next(const body *w, applied *f, double next) {
  f->velocity = w->velocity[f->component][f->site];
  f->sums.work += 0.5 * w->time_step * (f->now + next) * f->velocity;
  f->now = next;
}

/* Those of links come when all bodies have moved, those of ties before the next step ends. */
static void next_forces(const load_run *r) {
  cause_step known[REMEMBERED] = {{0}};
  for (long i = r->first_force; i < r->last_force; i++) {
    applied *f = &r->l->forces[i];
    if (f->tied)
      f->velocity = r->w->velocity[f->component][f->site];
    else if (!f->link)
      take_next(r->w, f, force_after(r, f, known));
  }
}

void load_steps_take_links(loads *l, body *w, int block) {
  const load_run r = run_of(l, w, block, 0);
  for (long i = r.first_force; i < r.last_force; i++)
    if (l->forces[i].link && !l->forces[i].tied)
      take_next(w, &l->forces[i], l->forces[i].share * *l->forces[i].link);
}

/* Of the way to the state that the step begins with; nothing has led to the first. */
static double work_of_tie(const body *w, const applied *f, double here, long step) {
  return step > 0 ? 0.5 * w->time_step * (f->now + here) * f->velocity : 0;
}

void load_steps_take_ties(loads *l, const body *w, long step) {
  for (long i = 0; i < l->force_count; i++) {
    applied *f = &l->forces[i];
    if (!f->tied) continue;
    const double here = f->share * *f->link;
    f->sums.work += work_of_tie(w, f, here, step);
    f->now = here;
  }
}

double load_steps_see_tie(loads *l, const body *w, int tie, long step) {
  const int cause = loads_cause_of_tie(l, tie);
  double work = 0;
  for (long i = 0; i < l->force_count; i++) {
    applied *f = &l->forces[i];
    if (!f->tied || f->cause != cause) continue;
    f->seen = f->share * *f->link;
    work += f->sums.work + work_of_tie(w, f, f->seen, step);
  }
  return work;
}

void load_steps_apply(loads *l, body *w, int block, long step) {
  const load_run r = run_of(l, w, block, step);
  apply_forces(&r);
  apply_motions(&r);
  next_forces(&r);
}

void load_steps_turn(const loads *l, body *w, long step) {
  if (l->clock.ramp == 0) w->decay = decay_of(l, w, step + 1);
  if (w->weight) set_gravity(l, w, step + 1);
}

static void add_sums(load_sums *to, const load_sums *more) {
  to->work += more->work;
  to->dissipated += more->dissipated;
  to->internal += more->internal;
}

load_sums load_steps_total(const loads *l) {
  load_sums total = {0, 0, 0};
  for (long i = 0; i < l->force_count; i++)
    add_sums(&total, &l->forces[i].sums);
  for (long i = 0; i < l->constraint_count; i++)
    add_sums(&total, &l->constraints[i].sums);
  return total;
}

/* Velocity after the coming step if nothing but bonds, damping, gravity and outer forces acted on a
   particle. */
static double free_velocity(const body *w, int component, int64_t site) {
  if (!(body_mass(w, component, site) > 0)) return w->ahead[component][site];
  const double weight = component < w->dimensions ? w->gravity[component] : 0;
  return w->decay * w->velocity[component][site] +
         given_by(w, component, site, w->force[component][site] + body_outer(w, component, site)) +
         w->time_step * motion_force_part(w) * weight;
}

/* With the forces that are applied to it. */
static double loaded_velocity(const loads *l, const body *w, int component, int64_t site) {
  double velocity = free_velocity(w, component, site);
  long i = first_at(l->forces, l->force_count, sizeof *l->forces, site);
  for (; i < l->force_count && l->forces[i].site == site; i++)
    if (l->forces[i].component == component)
      velocity += given_by(w, component, site, loads_acting(&l->forces[i]));
  return velocity;
}

/* When a motion is prescribed. */
static double prescribed_velocity(const loads *l, const body *w, const constraint *c, long step) {
  if (lets_go(l, w, c, step))
    return velocity_let_go(l, w, c, step, loaded_velocity(l, w, c->component, c->site));
  if (gives_way(l, c))
    return velocity_given_way(l, w, c, step, loaded_velocity(l, w, c->component, c->site));
  return (c->anchor + motion_at(l, w, c, step + 1) - c->held) / w->time_step;
}

/* In quasi-static runs inertia is but a means: a reaction is what balances bonds, outer
   forces and weight. */
static double force_at_rest(const body *w, const constraint *c) {
  const double weight = c->component < w->dimensions ? w->gravity[c->component] : 0;
  return w->force[c->component][c->site] + body_outer(w, c->component, c->site) +
         body_mass(w, c->component, c->site) * weight;
}

/* What a constraint adds that changes a velocity by `change` in the coming step; returns the
   force. */
static double look_at(const body *w, int component, int64_t site, double velocity, double change,
                      load_look *sum) {
  const double mass = body_mass(w, component, site), force = force_for(w, component, site, change);
  sum->kinetic += 0.5 * mass * velocity * change;
  sum->dissipated += 0.5 * mass * motion_drag(w) * velocity * change;
  sum->work += 0.5 * w->time_step * velocity * force;
  return force;
}

/* Rates of turning after the coming step; false where nothing is held. */
static bool turning_ahead(const loads *l, const body *w, const held_turn *t, long step,
                          double now[3]) {
  const int64_t site = t->first->site;
  double r[3], target[3];
  int held = 0;
  for (int k = 0; k < 3; k++) {
    r[k] = target[k] = w->displacement[w->dimensions + k][site];
    now[k] = loaded_velocity(l, w, w->dimensions + k, site);
  }
  for (int k = 0; k < t->count; k++) {
    const constraint *c = &t->first[k];
    if (!c->active) continue;
    held |= 1 << axis_of(w, c);
    target[axis_of(w, c)] = c->held + w->time_step * prescribed_velocity(l, w, c, step);
  }
  if (held) rotation_vector_reach(r, w->time_step, held, target, now);
  return held;
}

int load_steps_release(const loads *l, const body *w, long i, double moment[3]) {
  const held_turn t = turn_at(l, w, i);
  double r[3];
  int held = 0;
  if (!t.count) return 0;
  for (int k = 0; k < 3; k++)
    r[k] = w->displacement[w->dimensions + k][t.first->site];
  for (int k = 0; k < t.count; k++)
    held |= t.first[k].active ? 1 << axis_of(w, &t.first[k]) : 0;
  rotation_vector_release(r, held, moment);
  return t.count;
}

static void settle_look(const loads *l, const body *w, constraint *c, double force) {
  c->reaction = l->clock.ramp > 0 ? -force_at_rest(w, c) : force - impulsive(w, c);
}

/* Applied moments on components that are held are taken off later. */
static void look_at_turn(const loads *l, const body *w, const held_turn *t, long step,
                         load_look *sum) {
  constraint *of[3] = {NULL, NULL, NULL};
  double now[3];
  for (int k = 0; k < t->count; k++) {
    t->first[k].reaction = 0;
    if (t->first[k].active) of[axis_of(w, &t->first[k])] = &t->first[k];
  }
  if (!turning_ahead(l, w, t, step, now)) return;
  for (int k = 0; k < 3; k++) {
    const int component = w->dimensions + k;
    const int64_t site = t->first->site;
    const double free =
        of[k] ? free_velocity(w, component, site) : loaded_velocity(l, w, component, site);
    const double force = look_at(w, component, site, t->first->turning[k], now[k] - free, sum);
    if (of[k]) settle_look(l, w, of[k], force);
  }
}

load_look load_steps_observe(loads *l, const body *w, long step) {
  load_look sum = {0};
  for (long i = 0; i < l->constraint_count; i++) {
    constraint *c = &l->constraints[i];
    const held_turn turn = turn_at(l, w, i);
    if (turn.count) {
      look_at_turn(l, w, &turn, step, &sum);
      i += turn.count - 1;
      continue;
    }
    c->reaction = 0;
    if (!c->active) continue;
    const double change =
        prescribed_velocity(l, w, c, step) - free_velocity(w, c->component, c->site);
    settle_look(l, w, c, look_at(w, c->component, c->site, c->velocity, change, &sum));
  }
  for (long i = 0; i < l->force_count; i++) {
    const applied *f = &l->forces[i];
    constraint *holder = f->holder >= 0 ? &l->constraints[f->holder] : NULL;
    const double here = loads_acting(f), power = 0.5 * w->time_step * here * f->velocity;
    if (f->tied) sum.work += work_of_tie(w, f, here, step);
    if (holder && holder->active) { /* what holds the particle takes the force up */
      holder->reaction -= here;
      sum.work -= power;
      continue;
    }
    sum.kinetic += motion_force_part(w) * power;
    sum.dissipated += motion_force_part(w) * motion_drag(w) * power;
  }
  return sum;
}

velocity_instant load_steps_velocities(const loads *l, const body *w, int component, int64_t site,
                                       long step) {
  const double before = w->velocity[component][site];
  const long count = l->constraint_count;
  double after = loaded_velocity(l, w, component, site), impulse = 0, turning[3];
  long i = first_at(l->constraints, count, sizeof *l->constraints, site);
  for (bool turned = false; i < count && l->constraints[i].site == site; i++) {
    const constraint *c = &l->constraints[i];
    const held_turn turn = turn_at(l, w, i);
    if (turn.count && !turned && component >= w->dimensions &&
        turning_ahead(l, w, &turn, step, turning))
      after = turning[component - w->dimensions];
    turned = turn.count;
    if (c->component != component || !c->active) continue;
    impulse = c->impulse;
    if (!turn.count) after = prescribed_velocity(l, w, c, step);
  }
  return (velocity_instant){before, 0.5 * (before + impulse + after), after};
}

/* --- another step ----------------------------------------------------------------------------- */

static bool is_beside(const body *w, double instant, double t) {
  return t > 0 && fabs(instant - t) <= 0.5 * w->time_step + hardly(w);
}

static bool jumps(const body *w, const time_function *f, double t) {
  return is_beside(w, f->start, t) || is_beside(w, time_function_end(f), t);
}

bool load_steps_jump(const loads *l, const body *w, long step) {
  const deck *k = l->deck;
  const double t = load_clock_time(&l->clock, w, step);
  bool some = false;
  for (int i = 0; i < k->force_count + k->end_moment_count; i++)
    some = some || jumps(w, cause_of(l, i), t);
  for (int i = 0; i < k->drive_count; i++)
    some = some || jumps(w, &k->drives[i].motion, t);
  for (int i = 0; i < k->gravity_count; i++)
    some = some || jumps(w, &k->gravitys[i].factor, t);
  for (int i = 0; i < k->damping_count; i++)
    some = some || is_beside(w, k->dampings[i].from, t) || is_beside(w, k->dampings[i].until, t);
  return some;
}

/* With v- = 2/(1 + decay) v - dt/2 a (motion.h), dt/2 a being that of the present step. */
static double set_back_by(const body *w, velocity_instant v, double time_step, double decay) {
  const double pushed = (v.after - w->decay * v.before) / (1 + w->decay);
  return 2 * v.now / (1 + decay) - time_step / w->time_step * pushed;
}

/* A particle that a motion takes up in the coming step has been free. */
static velocity_instant unheld_velocities(const loads *l, const body *w, const constraint *c) {
  const double before = w->velocity[c->component][c->site],
               after = loaded_velocity(l, w, c->component, c->site);
  return (velocity_instant){before, 0.5 * (before + after), after};
}

/* Of the step that begins after `steps` so long ones. */
static double decay_with_step(const loads *l, const body *w, long steps, double time_step) {
  body as = *w;
  as.time_step = time_step;
  return decay_of(l, &as, steps);
}

/* [dof][particles] Velocities half of the new step before. */
static double *velocities_before(const loads *l, const body *w, long step, double time_step,
                                 double decay) {
  const long particles = l->lattice->particle_count;
  double *v = must_calloc((size_t)(particles * w->dof) + 1, sizeof *v);
  for (int d = 0; d < w->dof; d++)
    for (long p = 0; p < particles; p++) {
      const velocity_instant at =
          load_steps_velocities(l, w, d, l->lattice->particle_site[p], step);
      v[d * particles + p] = set_back_by(w, at, time_step, decay);
    }
  for (long i = 0; i < l->constraint_count; i++) {
    const constraint *c = &l->constraints[i];
    if (c->impulse != 0)
      v[c->component * particles + l->lattice->site_particle[c->site]] =
          set_back_by(w, unheld_velocities(l, w, c), time_step, decay);
  }
  return v;
}

void load_steps_change(loads *l, body *w, long step, double time_step, long steps) {
  const long particles = l->lattice->particle_count;
  double *v = velocities_before(l, w, step, time_step, decay_with_step(l, w, steps, time_step));
  for (int d = 0; d < w->dof; d++)
    for (long p = 0; p < particles; p++)
      w->velocity[d][l->lattice->particle_site[p]] = v[d * particles + p];
  free(v);
  body_take_step(w, time_step);
  load_steps_turn(l, w, steps - 1);
  keep_all_turning(l, w);
  for (long i = 0; i < l->constraint_count; i++) {
    constraint *c = &l->constraints[i];
    c->velocity = w->velocity[c->component][c->site];
    if (c->impulse != 0) c->impulse = impulse_of(l, w, c, steps);
  }
  for (long i = 0; i < l->force_count; i++) {
    applied *f = &l->forces[i];
    f->velocity = w->velocity[f->component][f->site];
    if (!f->link) f->now = f->share * factor_at(l, w, f, steps);
  }
}

double load_steps_velocity(const loads *l, const body *w, int component, int64_t site, long step) {
  return load_steps_velocities(l, w, component, site, step).now;
}
