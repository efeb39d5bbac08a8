/* Runs against closed forms: oscillator, chain, cantilever, end moment; loads, monitors and the
   energy ledger; what a deck that does not fit is told. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/body/motion.h"
#include "runtime/interaction/interaction.h"
#include "runtime/lattice/lattice.h"
#include "runtime/simulation/load_steps.h"
#include "runtime/simulation/loads.h"
#include "tests/runtime/small_run.h"

#define SPACING   0.01
#define THICKNESS 0.1
#define CHAIN                                                                                      \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"                      \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, -0.001 size = %g, 0.002 /\n"
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
#define POINT(name, x, y) "&region name = '" name "' shape = 'point' at = " x ", " y " /\n"

static double rigidity_axial(double nu) {
  return 30e9 * SPACING * THICKNESS / (sqrt(3) * (1 - nu));
}

static double rigidity_bending(double nu) {
  return 30e9 * pow(SPACING, 3) * THICKNESS * (1 - 3 * nu) / (12 * sqrt(3) * (1 - nu * nu));
}

static double particle_mass(void) {
  return 2323 * sqrt(3) / 2 * SPACING * SPACING * THICKNESS;
}

static void must_open(small_run *r, const pl_law *law, const char *text) {
  small_open(r, law, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

/* --- two particles ---------------------------------------------------------------------------- */

/* Frequency of a free pair of particles: sqrt(2 k/m). Displacements of a leapfrog oscillator lie on
   a sine exactly: u(n+1) + u(n-1) = 2 cos(omega' dt) u(n). */
static double measured_frequency(double step) {
  char text[1024];
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-3 step = %.17g /\n" CHAIN
           "&material lattice = 'c' model = 'm' /\n"
           "&output energy = .false. frames = 0 /\n",
           step, 1.0 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  sweep *w = simulation_state(r.simulation);
  assert_int_equal(w->body->lattice->particle_count, 2);
  const double *u = &w->body->displacement[0][w->body->lattice->particle_site[1]];
  w->body->velocity[0][w->body->lattice->particle_site[0]] = -1e-3;
  w->body->velocity[0][w->body->lattice->particle_site[1]] = 1e-3;
  double last[3] = {0};
  while (simulation_step_done(r.simulation) < 10 || fabs(last[1]) < 0.5 * 1e-3 * 2e-6) {
    simulation_advance(r.simulation, 1, NULL);
    memmove(last, last + 1, 2 * sizeof *last);
    last[2] = *u;
  }
  small_close(&r);
  return acos((last[0] + last[2]) / (2 * last[1])) / step;
}

static void a_pair_oscillates_as_theory_says(void **state) {
  (void)state;
  const double omega = sqrt(2 * rigidity_axial(0.2) / SPACING / particle_mass());
  const double coarse = measured_frequency(0.2 / omega), fine = measured_frequency(0.1 / omega);
  /* leapfrog: sin(omega' dt/2) = omega dt/2 */
  assert_true(fabs(coarse * 0.2 / omega / 2 - asin(0.1)) < 1e-10);
  assert_true(fabs(fine * 0.1 / omega / 2 - asin(0.05)) < 1e-10);
  const double ratio = (coarse - omega) / (fine - omega);
  assert_true(ratio > 3.98 && ratio < 4.04); /* second order */
}

static double pair_step(void) {
  return 0.05 / sqrt(2 * rigidity_axial(0.2) / SPACING / particle_mass());
}

/* --- chains in equilibrium -------------------------------------------------------------------- */

/* A chain of bars under a force at its end: F L/EA, reaction -F. */
static void a_chain_stretches_by_its_closed_form(void **state) {
  (void)state;
  char text[2048];
  snprintf(
      text, sizeof text,
      "&simulation end_time = 4e-3 step_safety = 0.5 /\n" CHAIN
      "&material lattice = 'c' model = 'm' /\n" POINT("left", "0", "0") POINT(
          "right", "0.05",
          "0") "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"
               "&support region = 'left' fix = 'x' /\n&support region = 'all' fix = 'y' /\n"
               "&force region = 'right' component = 'x' total = '1 kN' history = 'cosine' rise = "
               "'1 ms' /\n"
               "&damping rate = '40000 1/s' /\n"
               "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' /\n"
               "&monitor name = 'tip' kind = 'displacement' region = 'right' component = 'x' /\n"
               "&output frames = 0 /\n",
      5 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  assert_int_equal(small_go(&r), STEP_END);
  assert_true(fabs(small_last(&r, "load") / -1000 - 1) < 1e-9);
  assert_true(fabs(small_last(&r, "tip") / (1000 * 5 * SPACING / rigidity_axial(0.2)) - 1) < 1e-9);
  /* what the force did is stored or damped away; linear and on its axis: the ledger closes to
   * rounding */
  assert_true(fabs(small_last(&r, "energy/imbalance")) < 1e-10 * small_last(&r, "energy/external"));
  assert_true(fabs(small_last(&r, "energy/stored") / (0.5 * 1000 * small_last(&r, "tip")) - 1) <
              1e-9);
  assert_true(small_last(&r, "energy/dissipated_damping") > 0);
  small_close(&r);
}

/* A chain of beams clamped at one end: F L^3/(3 EI) and the clamp's reactions. */
static void a_cantilever_bends_by_its_closed_form(void **state) {
  (void)state;
  const double L = 4 * SPACING,
               force = 1; /* N: deflection 1e-7 of L, so that geometry stays linear */
  char text[2048];
  snprintf(
      text, sizeof text,
      "&simulation end_time = 0.03 step_safety = 0.9 /\n" CHAIN
      "&material lattice = 'c' model = 'm' /\n" POINT("left", "0", "0") POINT(
          "right", "0.04",
          "0") "&support region = 'left' fix = 'x', 'y', 'rotation' /\n"
               "&force region = 'right' component = 'y' total = %g history = 'cosine' rise = '10 "
               "ms' /\n"
               "&damping rate = '8000 1/s' /\n"
               "&monitor name = 'shear' kind = 'reaction' region = 'left' component = 'y' /\n"
               "&monitor name = 'moment' kind = 'reaction' region = 'left' component = 'rotation' "
               "/\n"
               "&monitor name = 'tip' kind = 'displacement' region = 'right' component = 'y' /\n"
               "&monitor name = 'turn' kind = 'displacement' region = 'right' component = "
               "'rotation' /\n"
               "&output frames = 0 /\n",
      L, force);
  small_run r;
  must_open(&r, &elastic_beam, text);
  assert_int_equal(small_go(&r), STEP_END);
  const double EI = rigidity_bending(0.2);
  assert_true(fabs(small_last(&r, "tip") / (force * L * L * L / (3 * EI)) - 1) < 1e-6);
  assert_true(fabs(small_last(&r, "turn") / (force * L * L / (2 * EI)) - 1) < 1e-6);
  assert_true(fabs(small_last(&r, "shear") / -force - 1) < 1e-6);
  assert_true(fabs(small_last(&r, "moment") / (-force * L) - 1) < 1e-6);
  small_close(&r);
}

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
  const sweep *s = simulation_state(r.simulation);
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

/* What turns a free body: its angular momentum is moment times time, here from half a step before the start on. */
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
  const sweep *w = simulation_state(r.simulation);
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

/* --- loads in time ---------------------------------------------------------------------------- */

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
  sweep *w = simulation_state(r.simulation);
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

/* Support, drive, force, damping and the impulses of drives that begin: their sum is the rate of the momentum, step by step. */
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
  sweep *w = simulation_state(r.simulation);
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

/* A row of particles, each with a load of its own along y; bars in a straight row do not resist that. */
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

/* Values of few functions are remembered in a step: those of many loads are their own all the same. */
static void each_of_many_drives_goes_its_own_way(void **state) {
  (void)state;
  small_run r;
  open_many(&r, "&drive region = 'p%d' component = 'y' velocity = '%d um/s' /\n");
  const sweep *w = simulation_state(r.simulation);
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
  const sweep *w = simulation_state(r.simulation);
  assert_int_equal(small_go(&r), STEP_END);
  for (int k = 0; k < MANY; k++) {
    const double slope = (k + 1) * 1e-6 / 1e-5;
    const double way = slope * 1e-21 * 100 * (100 * 100 - 1) / (6 * particle_mass());
    assert_true(fabs(w->body->displacement[1][w->body->lattice->particle_site[k]] / way - 1) <
                1e-9);
  }
  small_close(&r);
}

/* --- forces on what is held ------------------------------------------------------------------- */

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

/* A drive takes up what the force does on the way: what is left is the impulse that both particles begin with, m v^2. */
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

/* --- energy ----------------------------------------------------------------------------------- */

typedef struct balance {
  double imbalance, external, damage;
} balance;

/* Largest imbalance of a driven block over the run. */
static balance driven_block(double safety, const char *material) {
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = 2e-4 step_safety = %g /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = 10 /\n"
           "&material lattice = 'c' model = 'm' %s /\n"
           "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.2, 0.06 /\n"
           "&region name = 'left' shape = 'rectangle' corner = 0, 0 size = 0.015, 0.1 /\n"
           "&region name = 'right' shape = 'rectangle' corner = 0.185, 0 size = 0.015, 0.1 /\n"
           "&support region = 'left' fix = 'x', 'y' /\n"
           "&drive region = 'right' component = 'x' velocity = 0.1 rise = 5e-5 /\n"
           "&drive region = 'right' component = 'y' velocity = 0.2 rise = 5e-5 /\n"
           "&damping rate = 2000 until = 1e-4 /\n"
           "&output frames = 0 sample = 1e-6 /\n",
           safety, material);
  small_run r;
  must_open(&r, &elastic_beam, text);
  assert_int_equal(small_go(&r), STEP_END);
  const double *imbalance;
  const long samples = simulation_history(r.simulation, NULL);
  simulation_series(r.simulation, small_series(&r, "energy/imbalance"), NULL, &imbalance);
  balance b = {0, small_last(&r, "energy/external"), small_last(&r, "energy/dissipated_damage")};
  for (long k = 0; k < samples; k++)
    b.imbalance = fmax(b.imbalance, fabs(imbalance[k]));
  small_close(&r);
  return b;
}

static void the_ledger_closes_for_an_elastic_block(void **state) {
  (void)state;
  const balance coarse = driven_block(0.5, ""), fine = driven_block(0.25, "");
  print_message("elastic block: imbalance %.2e and %.2e of the work at 0.5 and 0.25 of the limit\n",
                coarse.imbalance / coarse.external, fine.imbalance / fine.external);
  assert_true(coarse.imbalance < 1e-4 * coarse.external);
  assert_true(fine.imbalance < 0.4 * coarse.imbalance);
}

static void the_ledger_closes_with_dissipation(void **state) {
  (void)state;
  const balance coarse = driven_block(0.4, "tau = 2e-7"), fine = driven_block(0.2, "tau = 2e-7");
  print_message("viscous block: imbalance %.2e and %.2e of the work\n",
                coarse.imbalance / coarse.external, fine.imbalance / fine.external);
  assert_true(fine.imbalance < 0.01 * fine.external && fine.imbalance < 0.7 * coarse.imbalance);
  const balance a = driven_block(0.4, "S_t = 1e-4"), b = driven_block(0.1, "S_t = 1e-4");
  print_message("damaged block: imbalance %.2e and %.2e of the work, %.2f lost to damage\n",
                a.imbalance / a.external, b.imbalance / b.external, b.damage / b.external);
  assert_true(b.damage > 0.05 * b.external);
  assert_true(b.imbalance < 0.01 * b.external && b.imbalance < 0.7 * a.imbalance);
}

/* --- monitors --------------------------------------------------------------------------------- */

#define COASTING                                                                                   \
  "&simulation end_time = 1e-5 step = 1e-7 /\n" CHAIN                                              \
  "&material lattice = 'c' model = 'm' /\n" POINT("left", "0", "0") POINT("right", "0.01", "0")

/* A pair that coasts at 2 m/s: means, zeros and scales have closed forms. */
static void means_zeros_and_scales_are_as_defined(void **state) {
  (void)state;
  char text[2048];
  snprintf(text, sizeof text,
           COASTING
           "&monitor name = 'now' kind = 'displacement' region = 'left' component = 'x' /\n"
           "&monitor name = 'mean' kind = 'displacement' region = 'left' component = 'x' average = "
           "1e-6 /\n"
           "&monitor name = 'zeroed' kind = 'displacement' region = 'left' component = 'x' zero_at "
           "= 5e-6 "
           "scale = -3 /\n"
           "&monitor name = 'gap' kind = 'opening' between = 'left', 'right' component = 'y' /\n"
           "&monitor name = 'speed' kind = 'velocity' region = 'right' component = 'x' /\n"
           "&output frames = 0 sample = 1e-6 energy = .false. /\n",
           1.0 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  sweep *w = simulation_state(r.simulation);
  w->body->velocity[0][w->body->lattice->particle_site[0]] =
      w->body->velocity[0][w->body->lattice->particle_site[1]] = 2;
  assert_int_equal(small_go(&r), STEP_END);
  const double *time, *now, *mean, *zeroed;
  assert_int_equal(simulation_history(r.simulation, &time), 11);
  simulation_series(r.simulation, small_series(&r, "now"), NULL, &now);
  simulation_series(r.simulation, small_series(&r, "mean"), NULL, &mean);
  simulation_series(r.simulation, small_series(&r, "zeroed"), NULL, &zeroed);
  for (int k = 0; k <= 10; k++) {
    assert_true(fabs(time[k] - k * 1e-6) < 1e-18);
    assert_true(fabs(now[k] - 2 * time[k]) < 1e-18);
    /* ten steps that end with the sample; at the start the one there is */
    assert_true(fabs(mean[k] - (k ? 2 * (time[k] - 4.5e-7) : 0)) < 1e-18);
    assert_true(fabs(zeroed[k] + 3 * (now[k] - (k < 5 ? 0 : 1e-5))) < 1e-17);
  }
  assert_true(small_last(&r, "gap") == 0);
  assert_true(fabs(small_last(&r, "speed") - 2) < 1e-12);
  double when;
  assert_true(fabs(simulation_monitor_peak(r.simulation, small_series(&r, "zeroed"), &when) +
                   3e-5) < 1e-16);
  assert_true(simulation_monitor_peak(r.simulation, small_series(&r, "speed"), &when) == 2);
  assert_true(when == 0); /* the first of equal values */
  small_close(&r);
}

/* A chain stretched from both ends, unevenly so that it also speeds up: the ends carry differently. */
static void the_reaction_between_two_regions_is_the_mean_of_both_ends(void **state) {
  (void)state;
  char text[2048];
  snprintf(
      text, sizeof text,
      "&simulation end_time = 1e-4 step_safety = 0.5 /\n" CHAIN
      "&material lattice = 'c' model = 'm' /\n" POINT("left", "0", "0") POINT(
          "right", "0.05",
          "0") "&drive region = 'left' component = 'x' displacement = '-2 um' rise = '0.1 ms' /\n"
               "&drive region = 'right' component = 'x' displacement = '6 um' rise = '0.1 ms' /\n"
               "&monitor name = 'left' kind = 'reaction' region = 'left' component = 'x' /\n"
               "&monitor name = 'right' kind = 'reaction' region = 'right' component = 'x' /\n"
               "&monitor name = 'load' kind = 'reaction' between = 'left', 'right' component = 'x' "
               "scale = 3 /\n"
               "&output frames = 0 sample = 1e-5 /\n",
      5 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  assert_int_equal(small_go(&r), STEP_END);
  const double *left, *right, *load;
  const char *symbol;
  simulation_series(r.simulation, small_series(&r, "left"), NULL, &left);
  simulation_series(r.simulation, small_series(&r, "right"), NULL, &right);
  simulation_series(r.simulation, small_series(&r, "load"), &symbol, &load);
  assert_string_equal(symbol, "N");
  double uneven = 0;
  for (long k = 0; k < simulation_history(r.simulation, NULL); k++) {
    assert_true(fabs(load[k] - 3 * 0.5 * (right[k] - left[k])) < 1e-12 * rigidity_axial(0.2));
    uneven = fmax(uneven, fabs(right[k] + left[k]));
  }
  assert_true(small_last(&r, "left") < 0 && small_last(&r, "right") > 0);
  assert_true(uneven > 1e-2 * small_last(&r, "right"));
  small_close(&r);
}

static void a_stop_ends_the_run_at_its_sample(void **state) {
  (void)state;
  char text[2048];
  snprintf(text, sizeof text,
           COASTING
           "&monitor name = 'way' kind = 'displacement' region = 'left' component = 'x' /\n"
           "&stop monitor = 'way' above = '7.5 um' after = 4e-6 /\n"
           "&output frames = 4 sample = 1e-6 energy = .false. /\n",
           1.0 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  sweep *w = simulation_state(r.simulation);
  w->body->velocity[0][w->body->lattice->particle_site[0]] =
      w->body->velocity[0][w->body->lattice->particle_site[1]] = 2;
  int frames = 0;
  step_status status = STEP_OK;
  while (status == STEP_OK) {
    if (simulation_frame_due(r.simulation)) {
      frames++;
      simulation_frame_taken(r.simulation);
    }
    status = simulation_advance(r.simulation, 7, NULL);
  }
  assert_int_equal(status, STEP_STOPPED);
  assert_int_equal(simulation_step_done(r.simulation), 40);
  assert_int_equal(frames, 2);                     /* at steps 0 and 25 */
  assert_true(simulation_frame_due(r.simulation)); /* the last state */
  simulation_frame_taken(r.simulation);
  assert_false(simulation_frame_due(r.simulation));
  small_close(&r);
}

/* Seven frames of a hundred steps, each at the step nearest to its time. */
static void frames_are_taken_at_the_nearest_step(void **state) {
  (void)state;
  static const long expected[] = {0, 14, 29, 43, 57, 71, 86, 100};
  char text[1024];
  snprintf(text, sizeof text, COASTING "&output frames = 7 energy = .false. /\n", 1.0 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  for (int k = 0; k < 8; k++) {
    assert_true(simulation_frame_due(r.simulation));
    assert_int_equal(simulation_step_done(r.simulation), expected[k]);
    simulation_frame_taken(r.simulation);
    simulation_advance(r.simulation, 1000, NULL);
  }
  assert_false(simulation_frame_due(r.simulation));
  small_close(&r);
}

/* The condition holds from the first sample after the start; the run goes on to the first after 4.5 us. */
static void a_stop_waits_for_its_time(void **state) {
  (void)state;
  char text[2048];
  snprintf(text, sizeof text,
           COASTING
           "&monitor name = 'way' kind = 'displacement' region = 'left' component = 'x' /\n"
           "&stop monitor = 'way' above = '0.5 um' after = 4.5e-6 /\n"
           "&output frames = 0 sample = 1e-6 energy = .false. /\n",
           1.0 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  sweep *w = simulation_state(r.simulation);
  w->body->velocity[0][w->body->lattice->particle_site[0]] =
      w->body->velocity[0][w->body->lattice->particle_site[1]] = 2;
  assert_int_equal(small_go(&r), STEP_STOPPED);
  assert_int_equal(simulation_step_done(r.simulation), 50);
  small_close(&r);
}

/* Times that lie between two steps are those of the nearest: samples 2.7 steps apart, a zero at 4.7, a mean over 2.7. */
static void times_between_steps_are_rounded_to_the_nearest(void **state) {
  (void)state;
  char text[2048];
  snprintf(text, sizeof text,
           COASTING
           "&monitor name = 'zeroed' kind = 'displacement' region = 'left' component = 'x' zero_at "
           "= 4.7e-7 /\n"
           "&monitor name = 'mean' kind = 'displacement' region = 'left' component = 'x' average = "
           "2.7e-7 /\n"
           "&output frames = 0 sample = 2.7e-7 energy = .false. /\n",
           1.0 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  sweep *w = simulation_state(r.simulation);
  w->body->velocity[0][w->body->lattice->particle_site[0]] =
      w->body->velocity[0][w->body->lattice->particle_site[1]] = 2;
  assert_int_equal(small_go(&r), STEP_END);
  const double *time, *zeroed, *mean;
  static const int steps[] = {0, 3, 5, 8, 11, 14, 16};
  assert_true(simulation_history(r.simulation, &time) > 7);
  simulation_series(r.simulation, small_series(&r, "zeroed"), NULL, &zeroed);
  simulation_series(r.simulation, small_series(&r, "mean"), NULL, &mean);
  for (int k = 0; k < 7; k++) {
    assert_true(fabs(time[k] - 1e-7 * steps[k]) < 1e-18);
    assert_true(fabs(zeroed[k] - 2e-7 * (steps[k] < 5 ? steps[k] : steps[k] - 5)) < 1e-18);
    assert_true(fabs(mean[k] - 2e-7 * (steps[k] > 0 ? steps[k] - 1 : 0)) < 1e-18);
  }
  small_close(&r);
}

static void an_interrupt_ends_an_advance_at_a_step(void **state) {
  (void)state;
  char text[1024];
  snprintf(text, sizeof text, COASTING "&output frames = 0 energy = .false. /\n", 1.0 * SPACING);
  small_run r;
  must_open(&r, &elastic_bar, text);
  const volatile sig_atomic_t interrupted = 1;
  assert_int_equal(simulation_advance(r.simulation, 50, &interrupted), STEP_OK);
  assert_int_equal(simulation_step_done(r.simulation), 0);
  assert_int_equal(simulation_advance(r.simulation, 50, NULL), STEP_OK);
  assert_int_equal(simulation_step_done(r.simulation), 50);
  small_close(&r);
}

/* Stretching a pair past S_t damages its one bond; a protected one stays whole. */
static void damage_is_counted_and_protection_kept(void **state) {
  (void)state;
  for (int protected = 0; protected < 2; protected ++) {
    char text[2048];
    snprintf(text, sizeof text,
             "&simulation end_time = 1e-4 step = %.17g /\n" CHAIN
             "&material lattice = 'c' model = 'm' S_t = 1e-3 /\n" POINT("left", "0", "0")
                 POINT("right", "0.01",
                       "0") "&support region = 'left' fix = 'x' /\n"
                            "&drive region = 'right' component = 'x' velocity = 0.3 /\n%s"
                            "&monitor name = 'any' kind = 'damaged' /\n&monitor name = 'most' kind "
                            "= 'damaged' above = 0.9 /\n"
                            "&monitor name = 'gone' kind = 'broken' /\n&output frames = 0 fields = "
                            "'damage', 'omega' /\n",
             pair_step(), 1.0 * SPACING, protected ? "&protect region = 'left' /\n" : "");
    small_run r;
    must_open(&r, &elastic_bar, text);
    /* stretch 0.3 t/s: damage begins at 33 us, is complete at 67 us */
    simulation_advance(r.simulation, lround(5e-5 / pair_step()), NULL);
    const frame_field *fields;
    double values[2] = {-1, -1};
    assert_int_equal(simulation_frame_fields(r.simulation, &fields), 2);
    assert_string_equal(fields[0].name, "damage");
    assert_true(fields[1].on_bonds);
    simulation_frame_values(r.simulation, 0, values);
    const double expected = protected ? 0 : 0.5;
    assert_true(fabs(values[0] - expected) < 0.01 && values[1] == values[0]);
    simulation_frame_values(r.simulation, 1, values);
    assert_true(values[0] == values[1]);
    assert_int_equal(small_go(&r), STEP_END);
    assert_true(small_last(&r, "any") == !protected);
    assert_true(small_last(&r, "most") == !protected);
    assert_true(small_last(&r, "gone") == !protected);
    small_close(&r);
  }
}

/* A law with two damages and a state before them: the larger damage of a bond counts everywhere. The chain has two
   bonds, far below any growth of damage. */
static void the_larger_of_two_damages_counts(void **state) {
  (void)state;
  static const pl_field fields[] = {{"omega", "1", "damage", 0, PL_FIELD_DAMAGE, PL_ON_BOND},
                                    {"alpha", "1", "state", 0, PL_FIELD_STATE, PL_ON_BOND},
                                    {"crush", "1", "damage", 0, PL_FIELD_DAMAGE, PL_ON_BOND}};
  pl_law law = elastic_bar;
  law.field_count = 3;
  law.fields = fields;
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-5 step = 1e-7 /\n" CHAIN
           "&material lattice = 'c' model = 'm' /\n"
           "&monitor name = 'half' kind = 'damaged' above = 0.5 /\n"
           "&monitor name = 'most' kind = 'damaged' above = 0.6 /\n"
           "&monitor name = 'nearly' kind = 'broken' above = 0.9 /\n"
           "&monitor name = 'gone' kind = 'broken' /\n"
           "&output frames = 0 fields = 'damage', 'dissipated', 'alpha', 'axial' /\n",
           2.0 * SPACING);
  small_run r;
  must_open(&r, &law, text);
  sweep *w = simulation_state(r.simulation);
  rows_bond *bonds = rows_bonds(simulation_rows(r.simulation, 0));
  assert_int_equal(w->body->lattice->bond_count, 2);
  const double given[2][3] = {{0.3, 0.99, 0.6},
                              {0.9, 0.99, 0.1}}; /* of each bond: omega, alpha, crush */
  int32_t ends[3] = {0};
  for (int b = 0; b < 2; b++) {
    for (int f = 0; f < 3; f++)
      w->field[f][bonds[b].slot] = given[b][f];
    ends[bonds[b].i]++;
    ends[bonds[b].j]++;
  }
  static const struct {
    const char *name, *kind;
    bool on_bonds;
  } expected[] = {{"damage", "damage", false}, {"dissipated", "other", false},
                  {"omega", "damage", true},   {"alpha", "state", true},
                  {"crush", "damage", true},   {"axial", "output", true}};
  const frame_field *offered;
  assert_int_equal(simulation_frame_fields(r.simulation, &offered), 6);
  for (int k = 0; k < 6; k++) {
    assert_string_equal(offered[k].name, expected[k].name);
    assert_string_equal(offered[k].kind, expected[k].kind);
    assert_int_equal(offered[k].on_bonds, expected[k].on_bonds);
  }
  double values[3];
  simulation_frame_values(r.simulation, 0, values);
  for (int b = 0; b < 2; b++) { /* 0.6 and 0.9 at the ends, their mean in the middle */
    const int32_t pair[2] = {bonds[b].i, bonds[b].j};
    for (int e = 0; e < 2; e++)
      assert_true(fabs(values[pair[e]] - (ends[pair[e]] == 2 ? 0.75 : b ? 0.9 : 0.6)) < 1e-15);
  }
  free(bonds);
  assert_int_equal(small_go(&r), STEP_END);
  assert_true(small_last(&r, "half") == 2 && small_last(&r, "most") == 1);
  assert_true(small_last(&r, "nearly") == 1 && small_last(&r, "gone") == 0);
  small_close(&r);
}

/* --- what a deck that does not fit is told ---------------------------------------------------- */

typedef struct misfit {
  const char *groups;
  diag_code code;
  const char *text; /* part of the message */
} misfit;

#define BLOCK                                                                                      \
  "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"                      \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.1 /\n"                      \
  "&region name = 'corner' shape = 'point' at = 0, 0 /\n"                                          \
  "&region name = 'edge' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.001 /\n"
#define RUN "&simulation end_time = 1e-4 /\n"
#define LAW "&material lattice = 'c' model = 'm' /\n"
#define USE "&support region = 'corner' fix = 'x' /\n&protect region = 'edge' /\n"

static const misfit misfits[] = {
    {RUN LAW BLOCK USE "&region name = 'far' shape = 'disc' centre = 1, 1 radius = 0.01 /\n",
     DIAG_EMPTY_REGION, "region `far` holds no particle"},
    {RUN LAW BLOCK "&support region = 'corner' fix = 'x' /\n", DIAG_DECK_WARNING,
     "region `edge` is never used"},
    {RUN LAW BLOCK "&support region = 'edge' fix = 'y' /\n&drive region = 'corner' component = 'y' "
                   "velocity = 1 /\n",
     DIAG_CONFLICT, "the particle at (0, 0) mm has its motion in y prescribed twice"},
    {RUN LAW BLOCK "&drive region = 'edge' component = 'x' velocity = 1 /\n"
                   "&drive region = 'corner' component = 'x' velocity = 2 /\n",
     DIAG_CONFLICT, "prescribed twice"},
    {RUN LAW BLOCK USE "&support region = 'edge' fix = 'rotation' /\n", DIAG_BAD_VALUE,
     "do not rotate"},
    {RUN LAW BLOCK USE "&end_moment region = 'edge' moment = 3 /\n", DIAG_BAD_VALUE,
     "lie at one height"},
    {RUN LAW BLOCK USE "&output fields = 'displacment' /\n", DIAG_BAD_VALUE,
     "no field `displacment`"},
    {RUN LAW BLOCK USE "&output fields = 'energy' /\n", DIAG_BAD_VALUE, "no field `energy`"},
    {RUN LAW BLOCK USE "&output energy = .false. fields = 'dissipated' /\n", DIAG_DECK_WARNING,
     "no `dissipated` to store"},
    {RUN LAW BLOCK USE "&monitor name = 'n' kind = 'broken' above = 1.5 /\n", DIAG_OUT_OF_BOUNDS,
     "greater than 0 and at most 1"},
    {RUN LAW BLOCK USE "&monitor name = 'n' kind = 'broken' above = 0 /\n", DIAG_OUT_OF_BOUNDS,
     "greater than 0 and at most 1"},
    {RUN LAW BLOCK USE "&output fields = 'rotation' /\n", DIAG_DECK_WARNING,
     "no `rotation` to store"},
    {"&simulation end_time = 1e-4 step = 1e-5 /\n" LAW BLOCK USE, DIAG_UNSTABLE_STEP,
     "is unstable: the largest"},
    {RUN "&material lattice = 'c' model = 'm' Nu = 0.4 /\n" BLOCK USE, DIAG_OUT_OF_BOUNDS,
     "`nu` = 0.4 is not in [0, 0.33333333], the range of the law `elastic_bar`"},
    {RUN "&material lattice = 'c' model = 'm' E = -3e9 /\n" BLOCK USE, DIAG_OUT_OF_BOUNDS,
     "`E` = -3e+09 Pa is not in (0, inf)"},
    {RUN "&material lattice = 'c' model = 'm' E = '30 mm' /\n" BLOCK USE, DIAG_UNITS, "`E` needs"},
    {RUN "&material lattice = 'c' model = 'm' rhoo = 3 /\n" BLOCK USE, DIAG_UNKNOWN_KEY,
     "no parameter `rhoo`"},
    {RUN "&material lattice = 'c' model = 'm' E = 'stiff' /\n" BLOCK USE, DIAG_BAD_VALUE,
     "needs a number"},
};

static bool said(const small_run *r, const misfit *m) {
  for (int k = 0; k < r->said.count; k++)
    if (r->said.items[k].code == m->code && strstr(r->said.items[k].message, m->text)) return true;
  return false;
}

static void misfits_are_told_at_their_line(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof misfits / sizeof *misfits; k++) {
    small_run r;
    small_open(&r, &elastic_bar, misfits[k].groups);
    if (!said(&r, &misfits[k])) {
      print_error("case %zu: expected \"%s\"\n", k, misfits[k].text);
      small_print(&r);
      fail();
    }
    if (getenv("PERILAT_SHOW")) small_print(&r);
    const bool warning = diag_severity(misfits[k].code) == SEVERITY_WARNING;
    assert_int_equal(r.simulation != NULL, warning);
    small_close(&r);
  }
}

/* The caret stands under the word that is wrong; the hint lists what this law can store. */
static void an_unknown_field_is_answered_with_the_known_ones(void **state) {
  (void)state;
  static const char text[] = RUN LAW BLOCK USE "&output fields = 'damage', 'stress', 'energy' /\n";
  small_run r;
  small_open(&r, &elastic_bar, text);
  assert_null(r.simulation);
  assert_int_equal(r.said.count, 2);
  static const char *const words[] = {"'stress'", "'energy'"};
  for (int k = 0; k < 2; k++) {
    const span where = r.said.items[k].where;
    assert_int_equal(where.end - where.begin, strlen(words[k]));
    assert_memory_equal(text + where.begin, words[k], strlen(words[k]));
  }
  assert_string_equal(r.said.items[0].hint,
                      "this run can store `displacement`, `velocity`, `force`, `damage`, "
                      "`dissipated`, `omega`, `axial`");
  assert_non_null(strstr(r.said.items[1].hint, "is `dissipated`"));
  small_close(&r);
}

static void parameters_are_matched_without_case(void **state) {
  (void)state;
  small_run r;
  small_open(&r, &elastic_beam,
             RUN "&material lattice = 'c' model = 'm' e = '20 GPa' s_T = 1e-3 /\n" BLOCK USE);
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  assert_true(r.parameters[ELASTIC_E] == 20e9);
  assert_true(r.parameters[ELASTIC_S_T] == 1e-3);
  assert_true(r.parameters[ELASTIC_NU] == 0.2); /* default */
  small_close(&r);
}

static void a_value_without_default_is_asked_for(void **state) {
  (void)state;
  pl_law strict = elastic_bar;
  pl_parameter table[ELASTIC_PARAMETERS];
  memcpy(table, elastic_parameters, sizeof table);
  table[ELASTIC_E].has_default = table[ELASTIC_NU].has_default = 0;
  strict.parameters = table;
  small_run r;
  small_open(&r, &strict, RUN "&material lattice = 'c' model = 'm' nu = 0.1 /\n" BLOCK USE);
  assert_null(r.simulation);
  assert_int_equal(r.said.count, 1);
  assert_int_equal(r.said.items[0].code, DIAG_MISSING_KEY);
  assert_string_equal(r.said.items[0].message,
                      "the law `elastic_bar` needs a value for `E` (Young's modulus)");
  small_close(&r);
}

static void a_law_without_density_is_refused(void **state) {
  (void)state;
  pl_law massless = elastic_bar;
  pl_parameter renamed[ELASTIC_PARAMETERS];
  memcpy(renamed, elastic_parameters, sizeof renamed);
  renamed[ELASTIC_RHO].name = "density";
  massless.parameters = renamed;
  massless.density = -1;
  small_run r;
  small_open(&r, &massless, RUN LAW BLOCK USE);
  assert_null(r.simulation);
  assert_string_equal(
      r.said.items[0].message,
      "the law `elastic_bar` has no parameter `rho`, so its particles have no mass");
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_pair_oscillates_as_theory_says),
      cmocka_unit_test(a_chain_stretches_by_its_closed_form),
      cmocka_unit_test(a_cantilever_bends_by_its_closed_form),
      cmocka_unit_test(an_end_moment_is_a_pure_moment),
      cmocka_unit_test(a_drive_is_followed_exactly_from_its_start),
      cmocka_unit_test(reactions_balance_the_momentum),
      cmocka_unit_test(loads_keep_their_bits_on_many_threads),
      cmocka_unit_test(each_end_moment_comes_in_its_own_time),
      cmocka_unit_test(protection_reaches_over_spacings),
      cmocka_unit_test(each_of_many_drives_goes_its_own_way),
      cmocka_unit_test(each_of_many_forces_is_its_own),
      cmocka_unit_test(a_force_on_a_held_particle_is_its_reaction),
      cmocka_unit_test(a_force_on_a_driven_particle_does_no_work),
      cmocka_unit_test(the_ledger_closes_for_an_elastic_block),
      cmocka_unit_test(the_ledger_closes_with_dissipation),
      cmocka_unit_test(means_zeros_and_scales_are_as_defined),
      cmocka_unit_test(the_reaction_between_two_regions_is_the_mean_of_both_ends),
      cmocka_unit_test(a_stop_ends_the_run_at_its_sample),
      cmocka_unit_test(frames_are_taken_at_the_nearest_step),
      cmocka_unit_test(a_stop_waits_for_its_time),
      cmocka_unit_test(times_between_steps_are_rounded_to_the_nearest),
      cmocka_unit_test(an_interrupt_ends_an_advance_at_a_step),
      cmocka_unit_test(damage_is_counted_and_protection_kept),
      cmocka_unit_test(the_larger_of_two_damages_counts),
      cmocka_unit_test(misfits_are_told_at_their_line),
      cmocka_unit_test(an_unknown_field_is_answered_with_the_known_ones),
      cmocka_unit_test(parameters_are_matched_without_case),
      cmocka_unit_test(a_value_without_default_is_asked_for),
      cmocka_unit_test(a_law_without_density_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
