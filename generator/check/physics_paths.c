/* Closed ways: nothing may come out of a loop. */
#include "generator/check/physics_paths.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/check/physics_states.h"
#include "generator/ir/random_values.h"

static const double GAIN_TOLERANCE = 1e-6; /* of the path's peak energy */

enum { CORNERS = 9, LEGS = CORNERS - 1 };

typedef struct loop {
  motion corner[CORNERS]; /* corner[LEGS] is corner[0] */
  double rate[LEGS];      /* of the stretch, 1/s */
  double time[LEGS];      /* s, of laws that read it */
} loop;

typedef struct loops {
  double **base, **now; /* states: where the loops begin; where they are */
  loop of[BENCH_LANES];
  double work[BENCH_LANES], peak[BENCH_LANES];
  double by_force[FORCE_COUNT][BENCH_LANES];
} loops;

static loops *loops_new(physics *p) {
  loops *l = must_calloc(1, sizeof *l);
  l->base = bench_states(&p->b);
  l->now = bench_states(&p->b);
  return l;
}

static void loops_free(physics *p, loops *l) {
  bench_states_free(&p->b, l->base);
  bench_states_free(&p->b, l->now);
  free(l);
}

static void restart(physics *p, loops *l, int count) {
  for (int k = 0; k < p->b.width; k++)
    memcpy(l->now[k], l->base[k], (size_t)count * sizeof(double));
  memset(l->work, 0, sizeof l->work);
  memset(l->peak, 0, sizeof l->peak);
  memset(l->by_force, 0, sizeof l->by_force);
}

static motion between(const loop *l, int leg, double way) {
  motion m;
  for (int k = 0; k < AXIS_COUNT; k++)
    m.at[k] = l->corner[leg].at[k] + way * (l->corner[leg + 1].at[k] - l->corner[leg].at[k]);
  return m;
}

/* Adds the work of the forces in `from` over `share` of the leg. */
static void add_leg_work(physics *p, loops *l, const probe *from, int lane, int leg, double share) {
  static const bench_axis axis[FORCE_COUNT] = {AXIS_STRETCH, AXIS_THETA_I, AXIS_THETA_J};
  const loop *o = &l->of[lane];
  for (int k = 0; k < FORCE_COUNT; k++) {
    double way = o->corner[leg + 1].at[axis[k]] - o->corner[leg].at[axis[k]];
    double part =
        share * from->out[k][lane] * way * (k == FORCE_N ? bench_length(&p->b, l->now, lane) : 1);
    l->work[lane] += part;
    l->by_force[k][lane] += part;
  }
  l->peak[lane] = pl_fmax(l->peak[lane], fabs(l->work[lane]));
}

static int force_at_fault(const loops *l, int lane) {
  int worst = FORCE_N;
  for (int k = 1; k < FORCE_COUNT; k++)
    if (l->by_force[k][lane] < l->by_force[worst][lane]) worst = k;
  return worst;
}

void physics_describe_way(const physics *p, const motion *corners, const double *rates,
                          const double *times, int count, char *text, size_t size) {
  size_t n = 0;
  text[0] = 0;
  for (int k = 1; k < count && n + 80 < size; k++) {
    const double *m = corners[k].at;
    if (k > 1 && !times && !memcmp(m, corners[k - 1].at, sizeof corners->at)) continue;
    n += (size_t)snprintf(text + n, size - n, p->b.micropolar ? "%s(%.3g, %.3g, %.3g)" : "%s%.3g",
                          n ? ", " : "", m[AXIS_STRETCH], m[AXIS_THETA_I], m[AXIS_THETA_J]);
    if (rates && physics_reads_rate(p))
      n += (size_t)snprintf(text + n, size - n, " at %.3g 1/s", rates[k - 1]);
    if (times) n += (size_t)snprintf(text + n, size - n, " in %.3g s", times[k - 1]);
  }
}

/* `rates` and `times`: those of the legs, or NULL. */
static void note_loop(physics *p, const loops *l, int lane, const double *rates,
                      const double *times) {
  char corners[640];
  double *column = must_alloc((size_t)p->b.width * sizeof *column);
  bench_get(&p->b, l->base, lane, column);
  physics_describe_way(p, l->of[lane].corner, rates, times, CORNERS, corners, sizeof corners);
  char *state = physics_state_text(p, column);
  diag_note(p->said, (span){0, 0, UINT16_MAX}, "the way goes through %s = %s; it begins at %s",
            p->b.micropolar ? "(stretch, theta_i, theta_j)" : "stretch", corners, state);
  free(state);
  free(column);
}

/* --- closed path at frozen fields ------------------------------------------------------------- */

static const double gauss_at[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                   0.9602898564975363};
static const double gauss_weight[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                       0.1012285362903763};

static void go_round_frozen(physics *p, loops *l, int count, int legs, int panels) {
  bench *b = &p->b;
  restart(p, l, count);
  for (int leg = 0; leg < legs; leg++)
    for (int point = 0; point < 8 * panels; point++) {
      int k = point % 8, panel = point / 8;
      double at = k < 4 ? -gauss_at[3 - k] : gauss_at[k - 4],
             weight = gauss_weight[k < 4 ? 3 - k : k - 4];
      for (int lane = 0; lane < count; lane++)
        bench_move(b, l->now, lane, between(&l->of[lane], leg, (panel + 0.5 * (1 + at)) / panels));
      probe_run(b, &b->frozen, l->now, count);
      for (int lane = 0; lane < count; lane++)
        add_leg_work(p, l, &b->frozen, lane, leg, 0.5 * weight / panels);
    }
}

/* Largest damage of a lane that is not 0; -1 without one. */
static double damage_of(const bench *b, double *const *states, int lane) {
  double largest = -1;
  for (int k = 0; k < b->field_count; k++)
    if (b->law->fields.items[k]->kind == SYMBOL_DAMAGE && bench_field(b, states, k)[lane] > 0)
      largest = pl_fmax(largest, bench_field(b, states, k)[lane]);
  return largest;
}

static void say_closed_path(physics *p, const loops *l, int lane) {
  bool damaged = damage_of(&p->b, l->base, lane) > 0;
  diag_code code = damaged ? DIAG_CLOSED_PATH_DAMAGED : DIAG_CLOSED_PATH;
  if (p->failed[code] || (damaged && p->b.law->nonconservative)) return;
  double *column = must_alloc((size_t)p->b.width * sizeof *column);
  bench_get(&p->b, l->base, lane, column);
  physics_say(p, code, physics_fault(p, force_at_fault(l, lane), column), NULL,
              "a closed way %sgives %.3g %% of its peak energy back or takes it, by the direction "
              "it is gone: the forces "
              "have no stored energy",
              damaged ? "at a damage that stays the same " : "",
              100 * fabs(l->work[lane]) / l->peak[lane]);
  note_loop(p, l, lane, NULL, NULL);
  if (p->b.law->results[RESULT_V])
    diag_hint(p->said,
              "the moments of `force V` are V*length/2: they have an energy when V is as s/length");
  else
    diag_hint(p->said,
              damaged
                  ? "derive the forces from an `energy W`, or say `nonconservative \"why\"`"
                  : "derive the forces from an `energy W`; friction needs a `state` for the slip");
  free(column);
}

static void draw_triangle(physics *p, loop *o) {
  motion amplitude = physics_draw_motion(p);
  for (int k = 0; k < 3; k++)
    o->corner[k] = physics_draw_corner(p, amplitude);
  if (draw_bits(&p->b.seed) %
      2) /* a corner above another, where a limit on one force by the other shows best */
    for (int k = 1; k < AXIS_COUNT; k++)
      o->corner[1].at[k] = o->corner[0].at[k];
  for (int k = 3; k < CORNERS; k++)
    o->corner[k] = o->corner[0];
}

/* Loops whose work neither vanishes nor settles are left alone: kinks make it converge slowly.
   Panels and steps here are no multiples of each other: a kink beside a division of one is not
   beside one of the next. */
static void try_triangles(physics *p, loops *l, int count) {
  static const int panels[] = {1, 3, 7, 17, 37};
  double before[BENCH_LANES] = {0};
  unsigned char settled[BENCH_LANES] = {0}, decided[BENCH_LANES] = {0};
  double largest[2] = {0};
  int worst[2] = {-1, -1}; /* whole, damaged */
  int left = count;
  for (size_t k = 0; k < sizeof panels / sizeof *panels && left && !(k && bench_tired(&p->b));
       k++) {
    go_round_frozen(p, l, count, 3, panels[k]);
    for (int lane = 0; lane < count; lane++) {
      double gain = l->work[lane];
      if (decided[lane]) continue;
      settled[lane] = k > 0 && fabs(gain - before[lane]) <= 0.02 * fabs(gain)
                          ? (unsigned char)(settled[lane] + 1)
                          : 0;
      before[lane] = gain;
      bool vanishes = !(fabs(gain) > GAIN_TOLERANCE * l->peak[lane]);
      if (!vanishes && settled[lane] < 2) continue;
      decided[lane] = 1;
      left--;
      bool damaged = damage_of(&p->b, l->base, lane) > 0;
      if (vanishes || !(fabs(gain) > largest[damaged] * l->peak[lane])) continue;
      largest[damaged] = fabs(gain) / l->peak[lane];
      worst[damaged] = lane;
    }
    if (left < count / 8 || worst[0] >= 0) break;
  }
  for (int k = 0; k < 2; k++)
    if (worst[k] >= 0) say_closed_path(p, l, worst[k]);
}

void physics_check_closed_path(physics *p) {
  bench *b = &p->b;
  if (!b->micropolar) return; /* a force that follows one motion has a stored energy */
  loops *l = loops_new(p);
  for (int round = 0; round < 3 && !(round && bench_tired(b)); round++) {
    int count = round == 0                    ? BENCH_LANES
                : p->pool_count < BENCH_LANES ? p->pool_count
                                              : BENCH_LANES;
    for (int lane = 0; lane < count; lane++) {
      if (round == 0) {
        bench_draw(b, l->base, lane);
        bench_virgin(b, l->base, lane);
      } else {
        uint64_t at = draw_bits(&b->seed) % (uint64_t)p->pool_count;
        bench_put(b, l->base, lane, p->pool + at * (size_t)b->width);
      }
      draw_triangle(p, &l->of[lane]);
    }
    try_triangles(p, l, count);
  }
  loops_free(p, l);
}

/* --- dissipation ------------------------------------------------------------------------------ */

/* How quickly states of the virgin bond begin to change. */
static void begin_time(physics *p, loops *l, int count) {
  bench *b = &p->b;
  if (!b->reads_time) return;
  probe_run(b, &b->step, l->now, count);
  bench_accept(b, l->now, count);
}

/* Up to the middle of a step from that of the one before. */
static double time_since(const loop *o, int leg, int step, int steps) {
  if (step > 0) return o->time[leg] / steps;
  return 0.5 * (o->time[leg] + (leg > 0 ? o->time[leg - 1] : 0)) / steps;
}

/* The whole law along the loop, from rest; `steps` a leg, forces in the middle of each. */
static void go_round(physics *p, loops *l, int count, int steps) {
  bench *b = &p->b;
  restart(p, l, count);
  begin_time(p, l, count);
  for (int leg = 0; leg < LEGS; leg++) {
    for (int step = 0; step < steps; step++) {
      for (int lane = 0; lane < count; lane++) {
        motion m = between(&l->of[lane], leg, (step + 0.5) / steps);
        m.at[AXIS_RATE] = l->of[lane].rate[leg];
        bench_move(b, l->now, lane, m);
        bench_quantity(b, l->now, QUANTITY_DT)[lane] = time_since(&l->of[lane], leg, step, steps);
      }
      probe_run(b, &b->step, l->now, count);
      for (int lane = 0; lane < count; lane++)
        add_leg_work(p, l, &b->step, lane, leg, 1.0 / steps);
      bench_accept(b, l->now, count);
    }
  }
}

static motion only(motion m, bool stretch, bool theta) {
  if (!stretch) m.at[AXIS_STRETCH] = 0;
  if (!theta) m.at[AXIS_THETA_I] = m.at[AXIS_THETA_J] = 0;
  return m;
}

static motion stretch_of(motion theta, motion stretch) {
  theta.at[AXIS_STRETCH] = stretch.at[AXIS_STRETCH];
  return theta;
}

/* Out and back; there and back through rest; stretch and rotation in turns; anywhere. */
static void draw_corners(physics *p, loop *o, int kind) {
  motion amplitude = physics_draw_motion(p), rest = {{0}};
  motion a = physics_draw_corner(p, amplitude), b = physics_draw_corner(p, amplitude);
  *o = (loop){0};
  motion *c = o->corner;
  switch (p->b.micropolar ? kind % 4 : kind % 2) {
  case 0:
    c[1] = c[3] = only(a, true, kind % 8 < 4);
    c[5] = only(b, true, kind % 8 < 4);
    return;
  case 1:
    c[1] = c[4] = a;
    c[2] = c[5] = b;
    c[3] = rest;
    return;
  case 2:
    c[1] = only(a, true, false);
    c[2] = a;
    c[3] = stretch_of(a, b);
    c[4] = only(b, true, false);
    c[5] = stretch_of(b, b);
    c[6] = stretch_of(b, a);
    c[7] = only(a, true, false);
    return;
  default:
    for (int k = 1; k < LEGS; k++)
      c[k] = physics_draw_corner(p, amplitude);
  }
}

/* The same of laws that read the time: quick and slow ones, and some that stand still. */
static void draw_times(physics *p, loop *o) {
  const double time = pl_pow(10, draw_uniform(&p->b.seed, -8, 9));
  for (int leg = 0; leg < LEGS; leg++) {
    const double way = o->corner[leg + 1].at[AXIS_STRETCH] - o->corner[leg].at[AXIS_STRETCH];
    o->time[leg] = time * pl_pow(10, draw_uniform(&p->b.seed, -1, 0));
    o->rate[leg] = way / o->time[leg];
  }
}

/* Each leg at its own speed, within a decade of the others. */
static void draw_rates(physics *p, loop *o) {
  double speed = pl_pow(10, draw_uniform(&p->b.seed, -3, 5));
  for (int leg = 0; leg < LEGS; leg++) {
    double way = o->corner[leg + 1].at[AXIS_STRETCH] - o->corner[leg].at[AXIS_STRETCH];
    double rate = speed * pl_pow(10, draw_uniform(&p->b.seed, -1, 0));
    o->rate[leg] = way == 0 ? 0 : copysign(rate, way);
  }
}

/* True when ever finer steps agree that work comes out of the loop in lane 0. */
static bool stays_negative(physics *p, loops *l) {
  static const int steps[] = {61, 139, 317, 727, 1667, 3821};
  double before = INFINITY;
  int settled = 0;
  for (size_t k = 0; k < sizeof steps / sizeof *steps && settled < 2 && !bench_tired(&p->b); k++) {
    go_round(p, l, 1, steps[k]);
    if (!(l->work[0] < -GAIN_TOLERANCE * l->peak[0])) return false;
    settled = fabs(l->work[0] - before) <= 0.1 * fabs(l->work[0]) ? settled + 1 : 0;
    before = l->work[0];
  }
  return settled == 2;
}

static double tolerated_gain(const physics *p) {
  return p->b.law->nonconservative || p->failed[DIAG_CLOSED_PATH_DAMAGED] ? GAIN_OF_NONCONSERVATIVE
                                                                          : GAIN_TOLERANCE;
}

static void look_closer(physics *p, const loops *coarse, int lane, loops *l) {
  double *column = must_alloc((size_t)p->b.width * sizeof *column);
  bench_get(&p->b, coarse->base, lane, column);
  bench_put(&p->b, l->base, 0, column);
  l->of[0] = coarse->of[lane];
  if (stays_negative(p, l) && l->work[0] < -tolerated_gain(p) * l->peak[0]) {
    physics_say(
        p, DIAG_DISSIPATION, physics_fault(p, force_at_fault(l, 0), column), NULL,
        "a closed cycle gives %.4g J of work out, %.3g %% of its peak energy: the law feeds energy",
        -l->work[0], -100 * l->work[0] / l->peak[0]);
    note_loop(p, l, 0, l->of[0].rate, p->b.reads_time ? l->of[0].time : NULL);
    diag_hint(p->said,
              p->b.reads_time
                  ? "what relaxes goes toward the deformation that moves it: look at signs "
                    "of rates; a stiffness that grows in time adds to what comes, not to "
                    "what is there"
                  : "damping opposes the rate, friction needs a `state` for the slip, and "
                    "damage is not undone");
  }
  free(column);
}

/* The loop that gives the largest share of its peak energy out; -1 when none does. */
static int worst_lane(const loops *l) {
  int worst = -1;
  double least = -GAIN_TOLERANCE;
  for (int lane = 0; lane < BENCH_LANES; lane++)
    if (l->work[lane] < least * l->peak[lane]) {
      least = l->work[lane] / l->peak[lane];
      worst = lane;
    }
  return worst;
}

void physics_check_dissipation(physics *p) {
  enum { COARSE_STEPS = 24, ROUNDS = 3, MOST_CLOSER = 6 };
  bench *b = &p->b;
  loops *l = loops_new(p), *closer = loops_new(p);
  int looked = 0;
  for (int round = 0; round < ROUNDS && !p->failed[DIAG_DISSIPATION] && !(round && bench_tired(b));
       round++) {
    for (int lane = 0; lane < BENCH_LANES; lane++) {
      bench_draw(b, l->base, lane);
      bench_virgin(b, l->base, lane);
      draw_corners(p, &l->of[lane], lane + round);
      (b->reads_time ? draw_times : draw_rates)(p, &l->of[lane]);
    }
    go_round(p, l, BENCH_LANES, COARSE_STEPS);
    for (int lane = worst_lane(l);
         lane >= 0 && looked < MOST_CLOSER && !p->failed[DIAG_DISSIPATION]; looked++) {
      look_closer(p, l, lane, closer);
      l->work[lane] = 0;
      lane = worst_lane(l);
    }
  }
  loops_free(p, l);
  loops_free(p, closer);
}
