/* Supports, drives, forces and moments: what they do to the motion, to reactions and to the work
   of loads. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/body/motion.h"
#include "runtime/interaction/interaction.h"
#include "runtime/filling/lattice.h"
#include "runtime/loads/load_steps.h"
#include "runtime/loads/loads.h"
#include "tests/runtime/simulation/chain.h"

#define PUSHED                                                                                     \
  "&simulation end_time = 1e-5 step = 1e-7 /\n"                                                    \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"                      \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, -0.001 size = 0.01, 0.002 /\n"              \
  "&material lattice = 'c' model = 'm' /\n"                                                        \
  "&region name = 'left' shape = 'point' at = 0, 0 /\n"                                            \
  "&region name = 'right' shape = 'point' at = 0.01, 0 /\n"                                        \
  "&monitor name = 'held' kind = 'reaction' region = 'left' component = 'x' /\n"                   \
  "&monitor name = 'u' kind = 'displacement' region = 'left' component = 'x' /\n"                  \
  "&output frames = 0 sample = 1e-7 /\n"
enum { MANY = 19 };

/* A bending moment on a clamped block: the clamp answers with the opposite moment and no force. */
static void an_end_moment_is_a_pure_moment(void **state) {
  (void)state;
  static const char text[] =
      "&simulation end_time = 1e-3 /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
      "&material lattice = 'c' model = 'm' /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.06 /\n"
      "&region name = 'end' shape = 'rectangle' corner = 0.094, -1 size = 1, 2 /\n"
      "&end_moment region = 'end' moment = 7 /\n&output frames = 0 /\n";
  small_run r;
  small_open(&r, &elastic_beam, text);
  assert_non_null(r.simulation);
  rows *w = lattice_build(r.deck, 0, &r.said);
  loads *l = loads_new(r.deck, 0, w, "m", 3, &r.said);
  assert_non_null(l);
  assert_true(l->force_count >= 6);
  double force = 0, moment = 0;
  for (long k = 0; k < l->force_count; k++) {
    assert_int_equal(l->forces[k].component, 0);
    force += 7 * l->forces[k].share;
    moment -= 7 * l->forces[k].share * w->y[l->forces[k].site];
  }
  assert_true(fabs(force) < 1e-12 * 7 / 0.06);
  assert_true(fabs(moment - 7) < 1e-12);
  loads_free(l);
  rows_free(w);
  simulation_advance(r.simulation, 200, NULL); /* counter-clockwise: the upper part goes left */
  const sweep *s = simulation_state(r.simulation, 0);
  double low = 0, high = 0;
  for (long p = 0; p < s->body->lattice->particle_count; p++) {
    const long site = s->body->lattice->particle_site[p];
    if (s->body->lattice->x[site] < 0.094) continue;
    if (s->body->lattice->y[site] < 0.001) low = s->body->displacement[0][site];
    if (s->body->lattice->y[site] > 0.05) high = s->body->displacement[0][site];
  }
  assert_true(low > 0 && high < 0);
  small_close(&r);
}

/* What turns a free body: its angular momentum is moment times time, here from half a step
   before the start on. */
static void each_end_moment_comes_in_its_own_time(void **state) {
  (void)state;
  enum { TURNS = 200 };
  small_run r;
  must_open(&r, &elastic_bar,
            "&simulation end_time = 1e-3 /\n"
            "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
            "&material lattice = 'c' model = 'm' /\n"
            "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.06 /\n"
            "&region name = 'start' shape = 'rectangle' corner = -1, -1 size = 1.006, 2 /\n"
            "&region name = 'end' shape = 'rectangle' corner = 0.094, -1 size = 1, 2 /\n"
            "&end_moment region = 'start' moment = 70 start = 1 /\n"
            "&end_moment region = 'end' moment = 0.05 /\n&output frames = 0 /\n");
  simulation_advance(r.simulation, TURNS, NULL);
  const sweep *w = simulation_state(r.simulation, 0);
  double momentum = 0;
  for (long p = 0; p < w->body->lattice->particle_count; p++) {
    const long q = w->body->lattice->particle_site[p];
    momentum += w->body->mass[0] * (w->body->lattice->x[q] * w->body->velocity[1][q] -
                                    w->body->lattice->y[q] * w->body->velocity[0][q]);
  }
  assert_true(fabs(momentum / (0.05 * (TURNS - 0.5) * w->body->time_step) - 1) < 1e-6);
  small_close(&r);
}

/* Bonds of the particles within so many spacings: the first and the second of a row. */
static void protection_reaches_over_spacings(void **state) {
  (void)state;
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-4 /\n" CHAIN "&material lattice = 'c' model = 'm' /\n" POINT(
               "left", "0", "0") "&protect region = 'left' radius = 1.01 /\n&output frames = 0 /\n",
           5 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  const rows *w = simulation_rows(r.simulation, 0);
  for (long p = 0; p < 5; p++)
    assert_int_equal(w->held_bonds[w->particle_site[p]] != 0, p < 2);
  small_close(&r);
}

static void a_drive_is_followed_exactly_from_its_start(void **state) {
  (void)state;
  char text[2048];
  snprintf(
      text, sizeof text,
      "&simulation end_time = 4e-5 step = 1e-7 /\n" CHAIN
      "&material lattice = 'c' model = 'm' /\n" POINT("left", "0", "0") POINT(
          "right", "0.01",
          "0") "&drive region = 'left' component = 'x' velocity = 0.5 start = 1e-5 rise = 1e-5 /\n"
               "&drive region = 'right' component = 'y' displacement = 2e-6 start = 1e-5 rise = "
               "2e-5 history = 'cosine' /\n"
               "&output frames = 0 /\n",
      1 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  sweep *w = simulation_state(r.simulation, 0);
  const long left = w->body->lattice->particle_site[0], right = w->body->lattice->particle_site[1];
  w->body->velocity[0][left] = w->body->velocity[0][right] = 1; /* free until the start */
  simulation_advance(r.simulation, 100, NULL);
  const double start = w->body->displacement[0][left];
  assert_true(fabs(start - 1e-5) < 1e-15);
  for (int k = 101; k <= 400; k++) {
    simulation_advance(r.simulation, 1, NULL);
    const double t = k * 1e-7 - 1e-5, way = t < 1e-5 ? 0.25 * t * t / 1e-5 : 0.5 * (t - 0.5e-5);
    assert_true(fabs(w->body->displacement[0][left] - start - way) < 1e-16 + 1e-12 * way);
    const double rise = t < 2e-5 ? (1 - cos(acos(-1) * t / 2e-5)) / 2 : 1;
    assert_true(fabs(w->body->displacement[1][right] - 2e-6 * rise) < 1e-18 + 1e-12 * 2e-6);
  }
  assert_true(fabs(w->body->velocity[0][left] - 0.5) < 1e-8);
  small_close(&r);
}

/* Support, drive, force, damping and the impulses of drives that begin: their sum is the rate of
   the momentum, step by step. */
static void reactions_balance_the_momentum(void **state) {
  (void)state;
  static const char text[] =
      "&simulation end_time = 1e-3 step_safety = 0.5 /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = 17 /\n"
      "&material lattice = 'c' model = 'm' tau = 1e-7 /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.06 /\n"
      "&region name = 'left' shape = 'rectangle' corner = 0, 0 size = 0.015, 0.1 /\n"
      "&region name = 'right' shape = 'rectangle' corner = 0.085, 0 size = 0.015, 0.1 /\n"
      "&region name = 'middle' shape = 'disc' centre = 0.05, 0.03 radius = 0.012 /\n"
      "&support region = 'left' fix = 'xy' /\n"
      "&drive region = 'right' component = 'x' velocity = 0.1 rise = 1e-5 /\n"
      "&force region = 'middle' component = 'y' total = -300 /\n"
      "&force region = 'right' component = 'x' total = 200 /\n"
      "&damping rate = 1000 until = 5e-5 /\n"
      "&output frames = 0 /\n";
  small_run r;
  must_open(&r, &elastic_beam, text);
  sweep *w = simulation_state(r.simulation, 0);
  const rows *g = w->body->lattice;
  rows *copy = lattice_build(r.deck, 0, &r.said);
  loads *l = loads_new(r.deck, 0, copy, "m", 3, &r.said);
  double largest = 0;
  l->lattice = g;
  load_steps_begin(l, w->body);
  for (long n = 0; n < 100; n++) {
    double before[2] = {0}, after[2] = {0}, outside[2] = {200, -300};
    const double drag = motion_drag(w->body) / w->body->time_step;
    for (long p = 0; p < g->particle_count; p++)
      for (int d = 0; d < 2; d++)
        before[d] += w->body->mass[d] * w->body->velocity[d][g->particle_site[p]];
    for (long c = 0; c < l->constraint_count;
         c++) { /* what begins to move at once is no reaction */
      const int d = l->constraints[c].component;
      outside[d] += w->body->mass[d] * w->body->decay * l->constraints[c].impulse /
                    (w->body->time_step * motion_force_part(w->body));
    }
    sweep_step(w);
    for (int block = 0; block < w->body->block_count; block++)
      load_steps_apply(l, w->body, block, n);
    load_steps_turn(l, w->body, n);
    for (long c = 0; c < l->constraint_count; c++)
      outside[l->constraints[c].component] += l->constraints[c].reaction;
    for (long p = 0; p < g->particle_count; p++)
      for (int d = 0; d < 2; d++)
        after[d] += w->body->mass[d] * w->body->velocity[d][g->particle_site[p]];
    for (int d = 0; d < 2; d++) {
      outside[d] -= drag * (before[d] + after[d]);
      largest = fmax(largest, fabs(outside[d]));
      assert_true(fabs((after[d] - before[d]) / w->body->time_step - outside[d]) < 1e-9 * 1e4);
    }
  }
  assert_true(largest > 100);
  loads_free(l);
  rows_free(copy);
  small_close(&r);
}

/* All kinds of loads, on rows that blocks share out one way or the other. */
static void loads_keep_their_bits_on_many_threads(void **state) {
  (void)state;
  static const char text[] =
      "&simulation end_time = 2e-4 step_safety = 0.5 threads = %d /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
      "&material lattice = 'c' model = 'm' tau = 1e-7 /\n"
      "&body lattice = 'c' shape = 'disc' centre = 0, 0 radius = 0.06 /\n"
      "&region name = 'left' shape = 'rectangle' corner = -0.1, -0.1 size = 0.06, 0.2 /\n"
      "&region name = 'right' shape = 'rectangle' corner = 0.04, -0.1 size = 0.06, 0.2 /\n"
      "&region name = 'middle' shape = 'disc' centre = 0, 0 radius = 0.03 /\n"
      "&support region = 'left' fix = 'x', 'rotation' /\n"
      "&drive region = 'right' component = 'x' velocity = 0.1 start = 1e-5 rise = 1e-5 /\n"
      "&force region = 'middle' component = 'y' total = -300 history = 'ramp and hold' rise = 1e-4 "
      "/\n"
      "&force region = 'right' component = 'x' total = 200 /\n"
      "&end_moment region = 'middle' moment = 3 /\n"
      "&gravity acceleration = 0, -9.81 /\n"
      "&damping rate = 1000 until = 5e-5 /\n"
      "&monitor name = 'reaction' kind = 'reaction' region = 'left' component = 'x' average = 1e-5 "
      "/\n"
      "&output frames = 0 sample = 1e-6 /\n";
  small_run one;
  char deck_text[sizeof text + 10];
  snprintf(deck_text, sizeof deck_text, text, 1);
  must_open(&one, &elastic_beam, deck_text);
  assert_int_equal(small_go(&one), STEP_END);
  const size_t bytes = (size_t)simulation_history(one.simulation, NULL) * sizeof(double);
  assert_true(fabs(small_last(&one, "reaction")) > 100);
  for (int threads = 2; threads <= 7; threads++) {
    small_run many;
    snprintf(deck_text, sizeof deck_text, text, threads);
    must_open(&many, &elastic_beam, deck_text);
    assert_int_equal(simulation_threads(many.simulation), threads);
    assert_int_equal(small_go(&many), STEP_END);
    for (int k = 0; k < simulation_series_count(one.simulation); k++) {
      const double *a, *b;
      simulation_series(one.simulation, k, NULL, &a);
      simulation_series(many.simulation, k, NULL, &b);
      assert_memory_equal(a, b, bytes);
    }
    small_close(&many);
  }
  small_close(&one);
}

/* A row of particles, each with a load of its own along y; bars in a straight row do not resist
   that. */
static void open_many(small_run *r, const char *load) {
  enum { LONGEST = 8192 };
  char text[LONGEST];
  int used = snprintf(text, sizeof text,
                      "&simulation end_time = 1e-5 step = 1e-7 /\n" CHAIN
                      "&material lattice = 'c' model = 'm' /\n&output frames = 0 /\n",
                      (MANY - 1) * SPACING);
  for (int k = 0; k < MANY; k++) {
    used += snprintf(text + used, LONGEST - (size_t)used,
                     "&region name = 'p%d' shape = 'point' at = %g, 0 /\n", k, k * SPACING);
    used += snprintf(text + used, LONGEST - (size_t)used, load, k, k + 1);
  }
  must_open(r, &elastic_bar, text);
}

/* Values of few functions are remembered in a step: those of many loads are their own all the
   same. */
static void each_of_many_drives_goes_its_own_way(void **state) {
  (void)state;
  small_run r;
  open_many(&r, "&drive region = 'p%d' component = 'y' velocity = '%d um/s' /\n");
  const sweep *w = simulation_state(r.simulation, 0);
  assert_int_equal(small_go(&r), STEP_END);
  for (int k = 0; k < MANY; k++) {
    const double way = 1e-5 * (k + 1) * 1e-6;
    assert_true(fabs(w->body->displacement[1][w->body->lattice->particle_site[k]] / way - 1) <
                1e-12);
  }
  small_close(&r);
}

/* N steps with the force a t at their beginnings: u = a dt^3 N (N^2 - 1)/(6 m). */
static void each_of_many_forces_is_its_own(void **state) {
  (void)state;
  small_run r;
  open_many(&r, "&force region = 'p%d' component = 'y' force = %de-6 history = 'ramp' rise = "
                "1e-5 /\n");
  const sweep *w = simulation_state(r.simulation, 0);
  assert_int_equal(small_go(&r), STEP_END);
  for (int k = 0; k < MANY; k++) {
    const double slope = (k + 1) * 1e-6 / 1e-5;
    const double way = slope * 1e-21 * 100 * (100 * 100 - 1) / (6 * particle_mass());
    assert_true(fabs(w->body->displacement[1][w->body->lattice->particle_site[k]] / way - 1) <
                1e-9);
  }
  small_close(&r);
}

static void expect_everywhere(const small_run *r, const char *name, double expected, double size) {
  const double *values;
  simulation_series(r->simulation, small_series(r, name), NULL, &values);
  for (long n = 0; n < simulation_history(r->simulation, NULL); n++)
    if (!(fabs(values[n] - expected) <= 1e-12 * size))
      fail_msg("%s: %.17g instead of %.17g at sample %ld", name, values[n], expected, n);
}

/* A support carries the force, nothing moves, and no work is done. */
static void a_force_on_a_held_particle_is_its_reaction(void **state) {
  (void)state;
  small_run r;
  must_open(&r, &elastic_bar,
            PUSHED "&support region = 'left' fix = 'x' /\n"
                   "&force region = 'left' component = 'x' force = 500 /\n");
  assert_int_equal(small_go(&r), STEP_END);
  expect_everywhere(&r, "held", -500, 500);
  expect_everywhere(&r, "u", 0, 0);
  expect_everywhere(&r, "energy/external", 0, 0);
  small_close(&r);
}

/* A drive takes up what the force does on the way: what is left is the impulse that both
   particles begin with, m v^2. */
static void a_force_on_a_driven_particle_does_no_work(void **state) {
  (void)state;
  small_run r;
  must_open(&r, &elastic_bar,
            PUSHED "&drive region = 'left' component = 'x' velocity = 2 /\n"
                   "&drive region = 'right' component = 'x' velocity = 2 /\n"
                   "&force region = 'left' component = 'x' force = 500 /\n");
  assert_int_equal(small_go(&r), STEP_END);
  expect_everywhere(&r, "held", -500, particle_mass() * 2 / 1e-7);
  assert_true(fabs(small_last(&r, "u") / (2 * 1e-5) - 1) < 1e-12);
  const double given = 2 * 2 * particle_mass();
  assert_true(fabs(small_last(&r, "energy/external") - given) < 1e-12 * given);
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_end_moment_is_a_pure_moment),
      cmocka_unit_test(each_end_moment_comes_in_its_own_time),
      cmocka_unit_test(protection_reaches_over_spacings),
      cmocka_unit_test(a_drive_is_followed_exactly_from_its_start),
      cmocka_unit_test(reactions_balance_the_momentum),
      cmocka_unit_test(loads_keep_their_bits_on_many_threads),
      cmocka_unit_test(each_of_many_drives_goes_its_own_way),
      cmocka_unit_test(each_of_many_forces_is_its_own),
      cmocka_unit_test(a_force_on_a_held_particle_is_its_reaction),
      cmocka_unit_test(a_force_on_a_driven_particle_does_no_work),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
