/* Steps that shrink: the motion keeps its order and its energy over a change, a bond that stiffens
   is followed where the step that it began with is unstable, and a run that is cut or shared out
   gives the same bits. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <unistd.h>

#include <cmocka.h>

#include "runtime/result/result_state.h"
#include "runtime/simulation/simulation_save.h"
#include "runtime/simulation/step_shrink.h"
#include "tests/runtime/same_runs.h"
#include "tests/runtime/simulation/pair_motions.h"
#include "tests/runtime/simulation/watch_all.h"
#include "tests/runtime/small_bodies.h"

/* --- over a change ---------------------------------------------------------------------------- */

/* The left end goes off by a speed that rises within the run. */
static const double speed = 0.5; /* m/s */
static double driven(double t, double start) {
  const double w = frequency(), a = speed / end_time();
  (void)start;
  return 0.5 * a * t * t - a / (w * w) * (1 - cos(w * t));
}
static double driven_reaction(double t, double start) {
  const double a = speed / end_time();
  return mass() * a + stiffness() * (0.5 * a * t * t - driven(t, start));
}

#define DRIVEN                                                                                     \
  "&drive region = 'left' component = 'x' velocity = 0.5 rise = %.17g /\n" /* `start`: the end */

/* Where a load begins beside the change. */
static bool is_smooth(const motion *m, double t) {
  return m->start == 0 || *m->series == 'u' || fabs(t - step_of(m->start)) > step_of(1);
}

static bool load_jumps(const simulation *s) {
  return load_steps_jump(s->bodies[0].loads, s->bodies[0].body, (long)s->clock.at.step);
}

/* The largest error of a run whose steps shrink at a step of the coarse one, over size; *left: the
   largest imbalance over the largest energy. */
static double error_over_change(const motion *m, int finer, int steps, int halvings, double *left) {
  long at = (long)steps * finer;
  small_run r = open_run(m, STEPS * finer);
  const double *time, *values;
  simulation_advance(r.simulation, at, NULL);
  while (load_jumps(r.simulation)) {
    simulation_advance(r.simulation, 1, NULL);
    at++;
  }
  step_shrink_to(r.simulation, halvings, STEP_STIFFER, 0);
  assert_true(simulation_step_now(r.simulation) * (1 << halvings) ==
              simulation_step_limit(r.simulation)->step);
  assert_int_equal(small_go(&r), STEP_END);
  const long samples = simulation_history(r.simulation, &time);
  assert_int_equal(samples, STEPS * finer + 1);
  assert_int_equal(simulation_steps_taken(r.simulation), at + ((finer * STEPS - at) << halvings));
  simulation_series(r.simulation, small_series(&r, m->series), NULL, &values);
  double most = 0;
  for (long k = 1; k < samples - 1; k++) /* accelerations jump at the ends */
    if (is_smooth(m, time[k]))
      most = fmax(most, fabs(values[k] - m->exact(time[k], step_of(m->start))));
  *left = small_largest(&r, "energy/imbalance") / simulation_largest_energy(r.simulation);
  small_close(&r);
  return most / m->size;
}

static void the_order_is_kept(const motion *m, int halvings) {
  for (int at = 0; at <= 100; at += 50) {
    double left[2];
    const double coarse = error_over_change(m, 1, at, halvings, &left[0]),
                 fine = error_over_change(m, 4, at, halvings, &left[1]),
                 order = log2(coarse / fine) / 2;
    print_message("%-2s 2^-%d at %3d: error %.1e, %.1e, order %.2f; imbalance %.0e, %.0e\n",
                  m->series, halvings, at, coarse, fine, order, left[0], left[1]);
    assert_true(coarse < 0.01 && order > 1.6);
    assert_true(left[0] < 1e-9 && left[1] < 1e-9);
  }
}

static void the_order_and_the_energy_are_kept_over_a_change(void **state) {
  (void)state;
  const double u = 2 * force / stiffness(), a = speed / end_time();
  const motion all[] = {
      {PUSH, 0, "u", pushed, u},
      {PUSH, 0, "v", pushed_velocity, u * frequency() / 2},
      {PUSH, 0, "r", pushed_support, u * stiffness()},
      {PUSH "&damping rate = 3e4 /\n", 0, "u", pushed_damped, u},
      {PUSH, 50, "u", pushed, u},
      {PUSH, 50.4, "u", pushed, u},
      {PUSH, 49.7, "v", pushed_velocity, u * frequency() / 2},
      {WEIGHT, 0, "u", fallen, 20 / (frequency() * frequency())},
      {DRIVEN, STEPS, "u", driven, a / (frequency() * frequency())},
      {DRIVEN, STEPS, "r", driven_reaction, 2 * mass() * a},
  };
  for (size_t n = 0; n < sizeof all / sizeof *all; n++) {
    the_order_is_kept(&all[n], 1);
    the_order_is_kept(&all[n], 4);
  }
}

/* --- a bond that stiffens --------------------------------------------------------------------- */

/* A bar that is `stiffer` times as stiff beyond the stretch S_t: N = EA (x + (stiffer - 1) <x -
   S_t>), W/s = EA (x^2 + (stiffer - 1) <x - S_t>^2)/2. */
static double stiffer = 25;

static double beyond(const double *u, double stretch) {
  return fmax(0, stretch - u[UNIFORM_S_T]);
}

static double normal_force(const double *u, double stretch) {
  return u[UNIFORM_EA] * (stretch + (stiffer - 1) * beyond(u, stretch));
}

static void stiffening_rows(const pl_law *law, const double *u, const pl_strip *s) {
  for (long q = 0; q < s->count; q++) {
    const bool here = s->flags[q] & PL_PRESENT(s->direction);
    const elastic_bond b = elastic_kinematics(law, u, s, q);
    for (int d = 0; d < 2; d++)
      s->force[d][q] = here ? normal_force(u, b.stretch) * b.e[d] : 0;
  }
}

static void stiffening_observe(const pl_law *law, const double *u, const pl_strip *s) {
  for (long q = 0; q < s->count; q++) {
    const elastic_bond b = elastic_kinematics(law, u, s, q);
    const double more = beyond(u, b.stretch);
    s->observed[0][q] =
        0.5 * u[UNIFORM_EA] * u[UNIFORM_S] * (b.stretch * b.stretch + (stiffer - 1) * more * more);
    s->observed[1][q] = normal_force(u, b.stretch);
  }
}

static void stiffening_states(const pl_law *law, const double *u, const pl_states *s) {
  (void)law;
  for (long q = 0; q < s->count; q++) {
    s->out[0][q] = normal_force(u, s->in[0][q]);
    s->out[1][q] = s->out[2][q] = s->new_field[0][q] = 0;
  }
}

static pl_law stiffening_bar(void) {
  pl_law law = elastic_bar;
  law.name = law.key = "stiffening_bar";
  law.rows = law.rows_ledger = stiffening_rows;
  law.rows_observe = stiffening_observe;
  law.states = stiffening_states;
  return law;
}

/* A force that rises takes the pair beyond S_t = 1e-5: m u'' = F t/T - K u, then with STIFFER K
   beyond u_t. */
static const double yields_at = 1e-5 * SPACING, peak = 2000; /* m, N */

static double periods = 8; /* of the run */
static double duration(void) {
  return 2 * M_PI * periods / frequency();
}

typedef struct path { /* u = slope t + offset + a cos(w s) + b sin(w s), s from `from` on */
  double from, w, slope, offset, a, b;
} path;

static path path_from(double from, double u, double v, double stiff, double held) {
  path p = {.from = from, .w = sqrt(stiff / mass()), .slope = peak / duration() / stiff};
  p.offset = held / stiff;
  p.a = u - (p.slope * from + p.offset);
  p.b = (v - p.slope) / p.w;
  return p;
}

static double place_on(const path *p, double t) {
  const double s = t - p->from;
  return p->slope * t + p->offset + p->a * cos(p->w * s) + p->b * sin(p->w * s);
}

static double speed_on(const path *p, double t) {
  const double s = t - p->from;
  return p->slope + p->w * (p->b * cos(p->w * s) - p->a * sin(p->w * s));
}

/* In the soft bond, or held back by the stiff one. */
static path path_in(bool stiff, double from, double u, double v) {
  return stiff
             ? path_from(from, u, v, stiffer * stiffness(), (stiffer - 1) * stiffness() * yields_at)
             : path_from(from, u, v, stiffness(), 0);
}

/* When it next passes the stretch at which the bond stiffens, or the end. */
static double passes_at(const path *p, bool stiff) {
  const double part = 0.01 / p->w;
  double low = p->from + part, high = low;
  while (high < duration() && (place_on(p, high) > yields_at) == stiff)
    high += part;
  if (high >= duration()) return duration();
  low = high - part;
  for (int k = 0; k < 60; k++) {
    const double middle = 0.5 * (low + high);
    *((place_on(p, middle) > yields_at) == stiff ? &low : &high) = middle;
  }
  return low;
}

enum { MOST_PATHS = 200 };
static path paths[MOST_PATHS];
static int path_count;

static void find_paths(void) {
  bool stiff = false;
  paths[0] = path_in(false, 0, 0, 0);
  for (path_count = 1; path_count < MOST_PATHS; path_count++) {
    const path *last = &paths[path_count - 1];
    const double at = passes_at(last, stiff);
    if (at >= duration()) return;
    stiff = !stiff;
    paths[path_count] = path_in(stiff, at, yields_at, speed_on(last, at));
  }
}

static double stretched(double t) {
  int k = path_count - 1;
  while (k > 0 && paths[k].from > t)
    k--;
  return place_on(&paths[k], t);
}

static void open_pulled(small_run *r, const pl_law *law, const char *steps, const char *more) {
  char text[4096];
  snprintf(text, sizeof text,
           "&simulation %s /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
           "&material lattice = 'c' model = 'm' S_t = 1e-5 /\n"
           "&body lattice = 'c' shape = 'rectangle' corner = 0, -0.001 size = 0.01, 0.002 /\n"
           "&region name = 'left' shape = 'point' at = 0, 0 /\n"
           "&region name = 'right' shape = 'point' at = 0.01, 0 /\n" FIXED
           "&force region = 'right' component = 'x' total = %.17g history = 'ramp' rise = %.17g /\n"
           "&monitor name = 'u' kind = 'displacement' region = 'right' component = 'x' /\n"
           "&output frames = 0 sample = 1e-9 /\n%s",
           steps, peak, duration(), more);
  small_open(r, law, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

static void open_stretched(small_run *r, const pl_law *law, double part, int every) {
  char steps[200];
  snprintf(steps, sizeof steps, "end_time = %.17g step_safety = %.17g shrink_every = %d",
           duration(), part, every);
  open_pulled(r, law, steps, "");
}

/* The largest error over the largest way; runs that go bad have none. */
static double stretched_error(double part, int every, int64_t *halvings, double *left) {
  const pl_law law = stiffening_bar();
  small_run r;
  open_stretched(&r, &law, part, every);
  find_paths();
  const step_status status = small_go(&r);
  const double *time, *values;
  const long samples = simulation_history(r.simulation, &time);
  simulation_series(r.simulation, small_series(&r, "u"), NULL, &values);
  double most = 0, size = 0;
  for (long k = 0; k < samples; k++) {
    most = fmax(most, fabs(values[k] - stretched(time[k])));
    size = fmax(size, fabs(stretched(time[k])));
  }
  *halvings = r.simulation->clock.at.halvings;
  *left = small_largest(&r, "energy/imbalance") / simulation_largest_energy(r.simulation);
  small_close(&r);
  return status == STEP_BAD ? INFINITY : most / size;
}

/* Pulled slowly: what the bond that stiffens adds is small against the way. */
static void a_bond_may_stiffen(void **state) {
  (void)state;
  int64_t halvings;
  double left;
  periods = 32;
  const double fixed = stretched_error(0.9, 0, &halvings, &left);
  assert_true(isinf(fixed) && halvings == 0);
  const double shrinking = stretched_error(0.9, 1, &halvings, &left);
  print_message(
      "a step of 0.9 of the stable one goes bad; shrinking to 2^-%d of it: off by %.2f of "
      "the way, imbalance %.1e\n",
      (int)halvings, shrinking, left);
  assert_true(halvings == 2 && shrinking < 0.3 && left < 0.06);
}

/* Where in a step the bond stiffens is by chance: errors fall with the square in the mean. */
static void a_bond_that_stiffens_is_followed(void **state) {
  (void)state;
  int64_t halvings;
  double first[2] = {0, 0}, error = 0, left = 0;
  periods = 2;
  for (int k = 0; k <= 3; k++) {
    const double part = 0.225 / (1 << 2 * k);
    error = stretched_error(part, 1, &halvings, &left);
    print_message("shrinking from %.3g on, %d times: error %.2e, imbalance %.1e\n", part,
                  (int)halvings, error, left);
    assert_int_equal(halvings, 2);
    if (k > 0) continue;
    first[0] = error;
    first[1] = left;
  }
  const double orders[] = {log2(first[0] / error) / 6, log2(first[1] / left) / 6};
  print_message("orders %.2f and %.2f\n", orders[0], orders[1]);
  assert_true(orders[0] > 1.7 && orders[1] > 1.7);
}

static void steps_do_not_shrink_without_end(void **state) {
  (void)state;
  small_run r;
  stiffer = 1e9;
  const pl_law law = stiffening_bar();
  periods = 2;
  open_stretched(&r, &law, 0.5, 1);
  assert_int_equal(small_go(&r), STEP_BAD);
  assert_string_equal(simulation_bad(r.simulation).what, BAD_TOO_STIFF);
  assert_int_equal(simulation_bad(r.simulation).body, 0);
  assert_true(r.simulation->clock.at.step < r.simulation->clock.step_count / 4);
  small_close(&r);
  stiffer = 25;
}

static void pull_until(const pl_law *law, double end, double step, const char *more) {
  char steps[200];
  small_run r;
  snprintf(steps, sizeof steps, "end_time = %.17g step = %.17g shrink_every = 1000000000", end,
           step);
  open_pulled(&r, law, steps, more);
  const step_status status = small_go(&r);
  print_message("%s: status %d after %ld steps\n", *more ? "a stop" : "the end", status,
                (long)r.simulation->clock.at.step);
  assert_int_equal(status, STEP_BAD);
  assert_string_equal(simulation_bad(r.simulation).what, BAD_ENERGY);
  small_close(&r);
}

/* Where the last sample is the first that finds energies of steps that are too long no look comes
   any more. */
static void what_the_last_sample_finds_is_not_lost(void **state) {
  (void)state;
  small_run r;
  char stop[200];
  const pl_law law = stiffening_bar();
  periods = 32;
  open_stretched(&r, &law, 0.9, 0);
  assert_int_equal(small_go(&r), STEP_BAD);
  const long steps = (long)r.simulation->clock.at.step;
  const double step = r.simulation->limit.step;
  small_close(&r);
  pull_until(&law, (double)steps * step, step, "");
  snprintf(stop, sizeof stop, "&stop monitor = 'u' above = 0 after = %.17g /\n",
           ((double)steps - 0.5) * step);
  pull_until(&law, 1.5 * (double)steps * step, step, stop);
}

/* --- contact ---------------------------------------------------------------------------------- */

#define BLOCK(name, x)                                                                             \
  "&lattice name = '" name "' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 origin = " x       \
  ", 0 /\n&material lattice = '" name "' model = 'm' /\n"                                          \
  "&body lattice = '" name "' shape = 'rectangle' corner = " x ", 0 size = 0.05, 0.06 /\n"         \
  "&region name = 'all " name "' lattice = '" name                                                 \
  "' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"

/* The right one comes from the right and a little from above: they meet after a millimetre. */
static void open_meeting(small_bodies *b, double part, int every, int threads) {
  char text[8192];
  snprintf(text, sizeof text,
           "&simulation end_time = 2e-4 step_safety = %g shrink_every = %d threads = %d /\n" BLOCK(
               "a", "0") BLOCK("b", "0.061") "&initial_velocity region = 'all b' component = 'x' "
                                             "value = -10 /\n"
                                             "&initial_velocity region = 'all b' component = 'y' "
                                             "value = -1 /\n&contact stiffness = 2e10 /\n"
                                             "&monitor name = 'f' kind = 'contact_force' lattice "
                                             "= 'a' component = 'x' average = 2e-6 /\n"
                                             "&monitor name = 'p' kind = 'momentum' lattice = 'a' "
                                             "component = 'x' /\n"
                                             "&monitor name = 'v' kind = 'velocity' region = 'all "
                                             "a' component = 'x' average = 3e-6 /\n"
                                             "&monitor name = 'c' kind = 'acceleration' region = "
                                             "'all b' component = 'x' average = 3e-6 /\n"
                                             "&output frames = 3 sample = 2e-6 /\n",
           part, every, threads);
  small_bodies_open(b, &elastic_beam, text);
}

static step_status go_with_frames(simulation *s, long until) {
  step_status status = STEP_OK;
  while (status == STEP_OK && simulation_step_done(s) < until) {
    if (simulation_frame_due(s)) simulation_frame_taken(s);
    status = simulation_advance(s, until - simulation_step_done(s), NULL);
  }
  return status;
}

typedef struct blow {
  double momentum, imbalance;
  long steps;
} blow;

static blow meet(double part, int every) {
  small_bodies b;
  open_meeting(&b, part, every, 1);
  assert_int_equal(small_go(&b.run), STEP_END);
  const blow found = {small_last(&b.run, "p"),
                      small_largest(&b.run, "energy/imbalance") /
                          simulation_largest_energy(b.run.simulation),
                      simulation_steps_taken(b.run.simulation)};
  small_bodies_close(&b);
  return found;
}

/* Contact that is nine times as stiff as a bond: until they come near, steps are those of the
   blocks. */
static void a_blow_needs_short_steps_from_the_touch_on_alone(void **state) {
  (void)state;
  int count;
  small_bodies b;
  const blow fixed = meet(0.5, 0), shrinking = meet(0.5, 50), fine = meet(0.02, 0);
  print_message("steps %ld and %ld, momentum %.5f and %.5f instead of %.5f, imbalance %.1e and "
                "%.1e\n",
                fixed.steps, shrinking.steps, fixed.momentum, shrinking.momentum, fine.momentum,
                fixed.imbalance, shrinking.imbalance);
  assert_true(shrinking.steps < 0.7 * (double)fixed.steps);
  assert_true(fabs(shrinking.momentum / fine.momentum - 1) < 1e-2);
  assert_true(shrinking.imbalance < 1e-2);
  open_meeting(&b, 0.5, 50, 1);
  assert_int_equal(small_go(&b.run), STEP_END);
  const step_change *changes = simulation_step_changes(b.run.simulation, &count);
  const double step = simulation_step_limit(b.run.simulation)->step,
               at = (double)changes->step * step;
  const double near = (0.001 - STEP_LOOKS_AHEAD * 0.01) / 10; /* a millimetre at 10 m/s */
  print_message("shrunk at %.4g us, near at %.4g us\n", 1e6 * at, 1e6 * near);
  assert_true(count == 1 && changes->cause == STEP_TOUCHED && changes->halvings == 1);
  assert_true(at >= near && at < near + step);
  result_state *left = simulation_take_state(b.run.simulation); /* for a next stage */
  assert_true(left->step == step / 2);
  result_state_free(left);
  small_bodies_close(&b);
}

/* --- bits ------------------------------------------------------------------------------------- */

/* In a file that is whole otherwise. */
static void numbers_that_no_run_can_reach_are_refused(void **state) {
  (void)state;
  static const char saved[] = "test_step_shrink.state";
  const frame_mark none = {0, 0};
  char error[200];
  small_bodies from, to;
  open_meeting(&from, 0.5, 50, 1);
  open_meeting(&to, 0.5, 50, 1);
  go_with_frames(from.run.simulation, simulation_step_count(from.run.simulation) - 1);
  run_progress *at = &from.run.simulation->clock.at;
  const run_progress good = *at;
  assert_int_equal(good.change_count, 1);
  struct {
    int64_t *of, value;
  } bad[] = {{&at->looked, -2},
             {&at->looked, at->step + 1},
             {&at->more, -1},
             {&at->more, INT64_MAX},
             {&at->doubted, 2},
             {&at->touched, -1},
             {&at->halvings, 2},
             {&at->change_count, 0},
             {&at->changes[0].step, -1},
             {&at->changes[0].step, at->step + 1},
             {&at->changes[0].halvings, 0},
             {&at->changes[0].halvings, 2},
             {&at->changes[0].cause, STEP_TOUCHED + 1},
             {&at->changes[0].cause, -1},
             {&at->changes[0].body, 2},
             {&at->changes[0].body, -1}};
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    *bad[k].of = bad[k].value;
    assert_true(simulation_save(from.run.simulation, saved, "one", &none, error, sizeof error));
    if (simulation_restore(to.run.simulation, saved, "one", NULL, error, sizeof error))
      fail_msg("number %zu is taken", k);
    assert_non_null(strstr(error, "another size"));
    *at = good;
  }
  assert_true(simulation_save(from.run.simulation, saved, "one", &none, error, sizeof error));
  assert_true(simulation_restore(to.run.simulation, saved, "one", NULL, error, sizeof error));
  small_bodies_close(&from);
  small_bodies_close(&to);
  unlink(saved);
}

static void threads_and_stops_change_no_bit(void **state) {
  (void)state;
  static const char saved[] = "test_step_shrink.state";
  char error[200];
  int count;
  small_bodies straight, other;
  open_meeting(&straight, 0.5, 50, 1);
  assert_int_equal(small_go(&straight.run), STEP_END);
  const long at = (long)simulation_step_changes(straight.run.simulation, &count)->step,
             end = simulation_step_count(straight.run.simulation),
             stops[] = {0, 50, 60, at - 1, at, at + 1, at + 17, end - 1};
  for (int threads = 2; threads <= 3; threads++) {
    open_meeting(&other, 0.5, 50, threads);
    assert_int_equal(small_go(&other.run), STEP_END);
    same_runs(straight.run.simulation, other.run.simulation);
    small_bodies_close(&other);
  }
  for (size_t k = 0; k < sizeof stops / sizeof *stops; k++) {
    open_meeting(&other, 0.5, 50, 2);
    go_with_frames(other.run.simulation, stops[k]);
    assert_true(
        simulation_save(other.run.simulation, saved, "x", &(frame_mark){0}, error, sizeof error));
    small_bodies_close(&other);
    open_meeting(&other, 0.5, 50, 1);
    assert_true(simulation_restore(other.run.simulation, saved, "x", NULL, error, sizeof error));
    assert_int_equal(simulation_step_done(other.run.simulation), stops[k]);
    assert_int_equal(go_with_frames(other.run.simulation, end), STEP_END);
    same_runs(straight.run.simulation, other.run.simulation);
    small_bodies_close(&other);
  }
  small_bodies_close(&straight);
  unlink(saved);
}

/* Damage, drives that begin, damping that ends, all monitors. */
static void open_busy(small_run *r, double step, int every, double breaks) {
  char text[8192];
  snprintf(
      text, sizeof text,
      "&simulation end_time = 2e-4 step = %g shrink_every = %d threads = 2 /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = 10 /\n"
      "&material lattice = 'c' model = 'm' S_t = %g tau = 1e-7 /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.06 /\n"
      "&region name = 'left' shape = 'rectangle' corner = 0, 0 size = 0.015, 0.1 /\n"
      "&region name = 'right' shape = 'rectangle' corner = 0.085, 0 size = 0.015, 0.1 /\n"
      "&region name = 'mid' shape = 'point' at = 0.05, 0.03 within = 0.006 /\n"
      "&support region = 'left' fix = 'xy' /\n"
      "&drive region = 'right' component = 'x' velocity = 0.2 rise = 1e-5 start = 6e-5 /\n"
      "&force region = 'mid' component = 'y' force = 500 history = 'ramp' rise = 1e-4 /\n"
      "&damping rate = 3000 until = 1.1e-4 /\n"
      "&gravity acceleration = 500, -2000 rise = 1.5e-4 /\n"
      "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' average = 3e-5 /\n"
      "&monitor name = 'cracks' kind = 'damaged' /\n" WATCH_ALL(
          "2e-6") "&output frames = 7 sample = 1e-6 /\n",
      step, every, breaks);
  small_open(r, &elastic_beam, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

static void a_look_alone_changes_no_bit(void **state) {
  (void)state;
  small_run fixed, looked;
  open_busy(&fixed, 5e-7, 0, 1e-4);
  open_busy(&looked, 5e-7, 3, 1e-4);
  assert_int_equal(small_go(&fixed), STEP_END);
  assert_int_equal(small_go(&looked), STEP_END);
  assert_int_equal(looked.simulation->clock.at.halvings, 0);
  assert_true(looked.simulation->clock.at.looked > 0 && small_last(&looked, "cracks") > 0);
  same_runs(fixed.simulation, looked.simulation);
  small_close(&fixed);
  small_close(&looked);
}

/* The largest difference of a series in two runs, over its size. */
static double difference(const small_run *x, const small_run *y, int series) {
  const double *a, *b;
  double most = 0, off = 0;
  simulation_series(x->simulation, series, NULL, &a);
  simulation_series(y->simulation, series, NULL, &b);
  const long samples = simulation_history(x->simulation, NULL);
  assert_int_equal(simulation_history(y->simulation, NULL), samples);
  for (long n = 0; n < samples; n++) {
    most = fmax(most, fabs(a[n]));
    off = fmax(off, fabs(a[n] - b[n]));
  }
  return most > 0 ? off / most : 0;
}

/* Shrunk in the middle of it all it is nearer to a run with steps of that length. */
static void a_body_goes_on_as_with_shorter_steps(void **state) {
  (void)state;
  small_run fixed, shrunk, fine;
  open_busy(&fixed, 5e-7, 0, 1e30);
  open_busy(&shrunk, 5e-7, 1000000, 1e30);
  open_busy(&fine, 1.25e-7, 0, 1e30);
  assert_int_equal(small_go(&fixed), STEP_END);
  assert_int_equal(small_go(&fine), STEP_END);
  simulation_advance(shrunk.simulation, 40, NULL);
  step_shrink_to(shrunk.simulation, 2, STEP_STIFFER, 0);
  assert_int_equal(small_go(&shrunk), STEP_END);
  for (int k = 0; k < simulation_series_count(fixed.simulation); k++) {
    const double off = difference(&fine, &shrunk, k), coarse = difference(&fine, &fixed, k);
    print_message("%-28s off by %.1e, with a step that stays %.1e\n",
                  simulation_series(fixed.simulation, k, NULL, NULL), off, coarse);
    assert_true(off <= 1.2 * coarse);
  }
  const int left = small_series(&shrunk, "energy/imbalance");
  assert_true(difference(&fine, &shrunk, left) < 1e-3);
  small_close(&fixed);
  small_close(&shrunk);
  small_close(&fine);
}

/* --- what does not shrink --------------------------------------------------------------------- */

static void must_refuse(const char *text, const char *message) {
  small_run r;
  bool found = false;
  small_read(&r, text);
  for (int k = 0; k < r.said.count; k++)
    found = found || strstr(r.said.items[k].message, message);
  if (!found) {
    small_print(&r);
    fail_msg("no `%s`", message);
  }
  assert_true(r.said.errors > 0);
  small_close(&r);
}

static void steps_out_of_time_do_not_shrink(void **state) {
  (void)state;
  must_refuse("&simulation end_time = 1 shrink_every = 10 /\n"
              "&relaxation increments = 4 /\n" PAIR FIXED "&force region = 'right' component = 'x' "
              "total = 100 /\n",
              "which a run with `&relaxation` does not have");
  must_refuse("&simulation shrink_every = 10 /\n&static /\n"
              "&mesh name = 'p' size = 1, 1 nodes = 5, 5 thickness = 1 /\n"
              "&material mesh = 'p' model = 'm' /\n",
              "which a run with `&static` does not have");
  must_refuse("&simulation end_time = 1 shrink_every = 10 /\n" PAIR
              "&mesh name = 'p' corner = 0.02, 0 size = 1, 1 nodes = 5, 5 thickness = 1 /\n"
              "&material mesh = 'p' model = 'm' /\n"
              "&tie lattice = 'c' mesh = 'p' region = 'right' /\n",
              "steps do not shrink where a lattice is tied to a mesh");
  must_refuse("&simulation end_time = 1 shrink_every = 10 /\n" PAIR
              "&stamp name = 'ram' shape = 'disc' centre = 5, 5 radius = 0.1 velocity = 1 "
              "direction = 0, -1 /\n",
              "steps do not shrink in a run with stamps");
  must_refuse("&simulation end_time = 1 shrink_every = -1 /\n" PAIR, "shrink_every");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_order_and_the_energy_are_kept_over_a_change),
      cmocka_unit_test(a_bond_may_stiffen),
      cmocka_unit_test(a_bond_that_stiffens_is_followed),
      cmocka_unit_test(steps_do_not_shrink_without_end),
      cmocka_unit_test(what_the_last_sample_finds_is_not_lost),
      cmocka_unit_test(a_blow_needs_short_steps_from_the_touch_on_alone),
      cmocka_unit_test(threads_and_stops_change_no_bit),
      cmocka_unit_test(numbers_that_no_run_can_reach_are_refused),
      cmocka_unit_test(steps_out_of_time_do_not_shrink),
      cmocka_unit_test(a_look_alone_changes_no_bit),
      cmocka_unit_test(a_body_goes_on_as_with_shorter_steps),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
