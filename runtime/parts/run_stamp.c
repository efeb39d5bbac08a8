#include "runtime/parts/run_stamp.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/deck/lattice_kind.h"
#include "runtime/loads/load_clock.h"

/* --- which bodies, how stiff ------------------------------------------------------------------ */

static void take_bodies(run_stamp *s, const deck *k) {
  s->of = must_calloc((size_t)k->lattice_count + 1, sizeof *s->of);
  s->stiffness = must_calloc((size_t)k->lattice_count + 1, sizeof *s->stiffness);
  for (int b = 0; b < k->lattice_count; b++)
    if (deck_lattice_is_stamped(&k->lattices[b], s->from)) s->of[s->count++] = b;
}

static bool find_stiffness(run_stamp *s, const deck *k, const run_body *bodies, diagnostics *d) {
  for (int n = 0; n < s->count; n++) {
    const run_body *b = &bodies[s->of[n]];
    s->stiffness[n] = s->from->stiffness > 0 ? s->from->stiffness : run_contact_stiffness(b, k);
    if (s->stiffness[n] > 0) continue;
    diag_report(d, DIAG_STIFFNESS, s->from->item.where,
                "the lattice `%s` has no Young's modulus that the stiffness of the contact with "
                "the stamp `%s` could follow from",
                b->name, s->from->name);
    diag_hint(d, "give `stiffness`, e.g. stiffness = '1e8 N/m'");
    return false;
  }
  return true;
}

/* That touch it at most: balls of half a spacing. */
static double most_touching(const run_stamp *s, const rows *g) {
  surface of;
  surface_open(&s->from->shape, &of);
  const double each = g->dimensions == 2 ? g->spacing : g->spacing * g->spacing,
               extent = surface_extent(&of, g->dimensions, 0.5 * g->spacing);
  return pl_fmin(2 + extent / each, (double)g->particle_count);
}

static double critical(double stiffness, double mass) {
  return 2 * sqrt(stiffness * mass);
}

static bool is_by_size(const run_stamp *s, const rows *g) {
  return run_contact_by_size(g, s->from->stiffness);
}

/* Of a free stamp on the springs and dampers of all that may touch it. */
static touch_rates own_rates(const run_stamp *s, const run_body *bodies) {
  touch_rates own = {0, 0};
  for (int n = 0; n < s->count && s->from->mass > 0; n++) {
    const run_body *b = &bodies[s->of[n]];
    const rows *g = b->lattice_rows;
    const double part = most_touching(s, g) / s->from->mass,
                 larger = is_by_size(s, g) ? rows_largest_spacing(g) / g->spacing : 1,
                 hardest = larger * s->stiffness[n];
    own.square += part * hardest;
    own.damping += part * s->damping * critical(hardest, loads_heaviest(b->loads));
  }
  return own;
}

static void add_rates(const run_stamp *s, const run_body *bodies, touch_rates *touching) {
  const touch_rates own = own_rates(s, bodies);
  for (int n = 0; n < s->count; n++) {
    const rows *g = bodies[s->of[n]].lattice_rows;
    const double k = s->stiffness[n], m = run_contact_lightest(g, is_by_size(s, g));
    touching[s->of[n]].square += k / m + own.square;
    touching[s->of[n]].damping += s->damping * critical(k, m) / m + own.damping;
  }
}

bool run_stamps_open(run_stamps *s, const deck *k, run_body *bodies, int body_count,
                     touch_rates *touching, diagnostics *d) {
  *s = (run_stamps){
      .deck = k, .bodies = bodies, .body_count = body_count, .step = -1, .slowest = INFINITY};
  s->items = must_calloc((size_t)k->stamp_count + 1, sizeof *s->items);
  s->power = must_calloc((size_t)body_count + 1, sizeof *s->power);
  s->clears = must_calloc((size_t)body_count + 1, sizeof *s->clears);
  for (; s->count < k->stamp_count; s->count++) {
    run_stamp *item = &s->items[s->count];
    item->from = &k->stamps[s->count];
    item->damping = k->relaxation.increments > 0 ? 0 : item->from->damping;
    take_bodies(item, k);
    if (!find_stiffness(item, k, bodies, d)) {
      s->count++;
      return false;
    }
    add_rates(item, bodies, touching);
  }
  return true;
}

/* --- where it goes ---------------------------------------------------------------------------- */

static const load_clock *clock_of(const run_stamps *s) {
  return &s->bodies[0].loads->clock;
}

static double time_of(const run_stamps *s, int64_t step) {
  return load_clock_time(clock_of(s), s->bodies[0].body, (long)step);
}

static double length_of_step(const run_stamps *s) {
  return s->bodies[0].body->time_step;
}

/* m: from one time to another, not beyond its end. */
static double way_between(const time_function *f, bool placed, double from, double to) {
  const double end = time_function_end(f), a = pl_fmin(from, end), b = pl_fmin(to, end);
  if (placed) return time_function_at(f, b) - time_function_at(f, a);
  if (!f->formula) return time_function_integral(f, b) - time_function_integral(f, a);
  const double begin = pl_fmax(a, f->start);
  return b > begin ? time_function_way(f, begin, b, 1) : 0;
}

/* m: at the end of an increment at t. What begins then comes in the next one. */
static double way_settled(const run_stamps *s, const run_stamp *item, double t) {
  const time_function *f = &item->from->motion;
  if (t <= load_clock_just_after(clock_of(s), f->start)) return 0;
  return way_between(f, item->from->is_displacement, -1, t);
}

/* Evenly from the beginning of an increment to its end. */
static double way_in_increment(const run_stamps *s, const run_stamp *item, int64_t step) {
  const load_clock *c = clock_of(s);
  const double part = load_clock_part(c, (long)step);
  return (1 - part) * way_settled(s, item, c->from) + part * way_settled(s, item, c->to);
}

/* m: along its direction, after so many steps, of which the last but one led to state.way. */
static double way_after(const run_stamps *s, const run_stamp *item, int64_t step) {
  const time_function *f = &item->from->motion;
  const double t = time_of(s, step);
  if (step == 0) return 0;
  if (f->formula && !item->from->is_displacement)
    return item->state.way + way_between(f, false, time_of(s, step - 1), t);
  if (clock_of(s)->ramp > 0) return way_in_increment(s, item, step);
  return way_between(f, item->from->is_displacement, -1, t);
}

static void weight(const run_stamps *s, int64_t step, double g[3]) {
  const deck *k = s->deck;
  memset(g, 0, 3 * sizeof *g);
  for (int i = 0; i < k->gravity_count; i++)
    for (int c = 0; c < 3; c++)
      g[c] += k->gravitys[i].acceleration[c] *
              load_clock_acting(clock_of(s), s->bodies[0].body, &k->gravitys[i].factor, (long)step);
}

/* m/s^2 of a free stamp with the forces found last; of a guided one along its way. */
static void acceleration(const run_stamps *s, const run_stamp *item, int64_t step, double a[3]) {
  double along = 0;
  weight(s, step, a);
  for (int c = 0; c < 3; c++) {
    a[c] += item->load.force[c] / item->from->mass;
    along += a[c] * item->from->direction[c];
  }
  for (int c = 0; c < 3 && item->from->guided; c++)
    a[c] = along * item->from->direction[c];
}

/* Velocity of the step after `step` steps. */
static void velocity_after(const run_stamps *s, const run_stamp *item, int64_t step, double v[3]) {
  const double dt = length_of_step(s);
  double a[3];
  if (item->from->mass > 0) {
    acceleration(s, item, step, a);
    for (int c = 0; c < 3; c++)
      v[c] = item->state.at.velocity[c] + dt * a[c];
    return;
  }
  const double way = way_after(s, item, step + 1) - item->state.way;
  for (int c = 0; c < 3; c++)
    v[c] = way / dt * item->from->direction[c];
}

/* Work of the weight in the step that ends after `step` steps, of which that is the velocity. */
static double work_of_weight(const run_stamps *s, const run_stamp *item, int64_t step) {
  double before[3], after[3], sum = 0;
  if (item->from->mass == 0 || s->deck->gravity_count == 0) return 0;
  weight(s, step - 1, before);
  weight(s, step, after);
  for (int c = 0; c < 3; c++)
    sum += (before[c] + after[c]) * item->state.at.velocity[c];
  return 0.5 * length_of_step(s) * item->from->mass * sum;
}

/* False where it goes too far. */
static bool move(const run_stamps *s, run_stamp *item, int64_t step) {
  stamp_state *st = &item->state;
  const double dt = length_of_step(s);
  double square = 0;
  velocity_after(s, item, step - 1, st->at.velocity);
  if (item->from->mass == 0) st->way = way_after(s, item, step);
  for (int c = 0; c < 3; c++) {
    st->at.place[c] = item->from->mass > 0 ? st->at.place[c] + dt * st->at.velocity[c]
                                           : item->start[c] + st->way * item->from->direction[c];
    square += st->at.velocity[c] * st->at.velocity[c];
  }
  st->work += work_of_weight(s, item, step);
  item->too_far = !(dt * sqrt(square) < s->slowest);
  return !item->too_far;
}

/* --- at work ---------------------------------------------------------------------------------- */

void run_stamps_begin(run_stamps *s, const run_contacts *contacts) {
  for (int n = 0; n < s->count; n++) {
    run_stamp *item = &s->items[n];
    stamp_body *of = must_calloc((size_t)item->count + 1, sizeof *of);
    surface shape;
    surface_open(&item->from->shape, &shape);
    for (int b = 0; b < item->count; b++) {
      body *pushed = s->bodies[item->of[b]].body;
      of[b] = (stamp_body){pushed, item->stiffness[b],
                           run_contact_by_size(pushed->lattice, item->from->stiffness)};
      s->slowest = pl_fmin(s->slowest, pushed->lattice->spacing);
      s->clears[item->of[b]] = true;
      body_add_outer(pushed);
    }
    item->found = stamp_new(&shape, of, item->count, item->from->friction, item->damping);
    free(of);
    for (int c = 0; c < 3 && item->from->mass > 0; c++)
      item->state.at.velocity[c] = item->from->motion.value * item->from->direction[c];
  }
  for (int n = 0; n < contacts->count; n++)
    for (int b = 0; b < contacts->items[n].count; b++)
      s->clears[contacts->items[n].of[b]] = false;
}

void run_stamps_free(run_stamps *s) {
  for (int n = 0; n < s->count; n++) {
    stamp_free(s->items[n].found);
    free(s->items[n].of);
    free(s->items[n].stiffness);
  }
  free(s->items);
  free(s->power);
  free(s->clears);
}

/* Of the forces found last over half of the way that the last step took. */
static void add_work(run_stamps *s, run_stamp *item) {
  const double half = 0.5 * length_of_step(s);
  double damped, on_bodies = 0;
  memset(s->power, 0, (size_t)item->count * sizeof *s->power);
  const double past = stamp_power(item->found, item->state.at.velocity, s->power, &damped);
  for (int b = 0; b < item->count; b++) {
    s->bodies[item->of[b]].body->outer_work += half * s->power[b];
    on_bodies += s->power[b];
  }
  /* what moves a prescribed stamp bears the forces on it */
  item->state.work -= half * (item->from->mass > 0 ? on_bodies : past);
  item->state.damped += half * damped;
}

static double size_of(const double v[3]) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static void find(run_stamps *s, run_stamp *item, bool goes_on) {
  stamp_peaks *most = &item->state.peaks;
  item->load = stamp_find(item->found, &item->state.at, goes_on ? length_of_step(s) : 0);
  item->state.slipped += item->load.slipped;
  if (item->load.touching > most->touching) most->touching = item->load.touching;
  most->force = pl_fmax(most->force, size_of(item->load.force));
}

bool run_stamps_find(run_stamps *s, int64_t step) {
  const bool known = s->step >= 0;
  bool good = true;
  if (s->step == step) return true;
  for (int n = 0; n < s->count && known; n++) {
    good = move(s, &s->items[n], step) && good;
    add_work(s, &s->items[n]);
  }
  for (int b = 0; b < s->body_count; b++)
    if (s->clears[b]) body_clear_outer(s->bodies[b].body);
  for (int n = 0; n < s->count; n++) {
    find(s, &s->items[n], known);
    if (known) add_work(s, &s->items[n]);
  }
  s->step = step;
  return good;
}

void run_stamps_set_back(run_stamps *s) {
  for (int n = 0; n < s->count; n++) {
    run_stamp *item = &s->items[n];
    double a[3];
    if (item->from->mass == 0) {
      velocity_after(s, item, 0, item->state.at.velocity);
      continue;
    }
    const double time = length_of_step(s) - (item->goes_on ? item->former_step : 0);
    acceleration(s, item, 0, a);
    for (int c = 0; c < 3 && time != 0; c++) /* the same step: the same bits */
      item->state.at.velocity[c] -= 0.5 * time * a[c];
  }
}

double run_stamp_velocity(const run_stamps *s, int number, int component, int64_t step) {
  double after[3];
  velocity_after(s, &s->items[number], step, after);
  return 0.5 * (s->items[number].state.at.velocity[component] + after[component]);
}

stamp_energies run_stamp_energies(const run_stamps *s, int number, int64_t step) {
  const run_stamp *item = &s->items[number];
  double after[3], kinetic = 0;
  velocity_after(s, item, step, after);
  for (int c = 0; c < 3; c++)
    kinetic += 0.5 * item->from->mass * item->state.at.velocity[c] * after[c];
  return (stamp_energies){.kinetic = kinetic,
                          .stored = item->load.stored,
                          .dissipated = item->state.damped + item->state.slipped,
                          .work = item->state.work};
}

double run_stamps_memory(const run_stamps *s) {
  double bytes = 0;
  for (int n = 0; n < s->count; n++)
    bytes += stamp_memory(s->items[n].found);
  return bytes;
}

/* --- whether it can begin --------------------------------------------------------------------- */

static bool is_outside(const run_stamps *s, const run_stamp *item, diagnostics *d) {
  const double rounding = 1e-6, pressed = 0.5; /* spacings */
  const stamp_inside in =
      stamp_look_inside(item->found, item->state.at.place, item->goes_on ? pressed : rounding);
  if (in.count == 0) return true;
  const run_body *of = &s->bodies[item->of[in.body]];
  double at[3];
  char text[ROWS_PLACE_TEXT];
  rows_place(of->lattice_rows, in.site, at);
  for (int c = 0; c < of->body->dimensions; c++)
    at[c] += of->body->displacement[c][in.site];
  diag_report(d, DIAG_CONFLICT, item->from->item.where,
              "the stamp `%s` lies in the body of `%s` at the beginning: %ld particle%s, %s at "
              "%s by %.4g mm",
              item->from->name, of->name, in.count, in.count == 1 ? "" : "s",
              in.count == 1 ? "that" : "the deepest",
              rows_place_text(of->body->dimensions, at, text), 1e3 * in.depth);
  diag_hint(
      d,
      "move it out by as much, or further where it lies deep: a particle reaches half a spacing, "
      "%.4g mm, beyond its place",
      0.5e3 * rows_spacing(of->lattice_rows, in.site));
  return false;
}

bool run_stamps_fit(const run_stamps *s, double step, diagnostics *d) {
  bool good = true;
  for (int n = 0; n < s->count; n++) {
    const run_stamp *item = &s->items[n];
    const double way = step * size_of(item->state.at.velocity);
    good = is_outside(s, item, d) && good;
    if (!(item->from->mass > 0) || way < s->slowest) continue;
    diag_report(d, DIAG_OUT_OF_BOUNDS, deck_where(&item->from->item, "velocity"),
                "the stamp `%s` would go %.3g mm in a step, more than a spacing of %.4g mm: it "
                "would pass through particles unseen",
                item->from->name, 1e3 * way, 1e3 * s->slowest);
    diag_hint(d, "give a shorter `step` in &simulation, or a smaller `step_safety`");
    good = false;
  }
  return good;
}
