/* Contact of bodies: the bounce of two particles against its closed form, momentum and energies of
   blocks that collide, forces at rest, cracks that close, the same bits with any threads and after
   a stop. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <unistd.h>

#include <cmocka.h>

#include "runtime/parts/run_contact.h"
#include "runtime/simulation/simulation_save.h"
#include "tests/runtime/same_runs.h"
#include "tests/runtime/small_bodies.h"

#define SPACING   0.01
#define THICKNESS 0.1

static double mass(void) {
  return 2323 * sqrt(3) / 2 * SPACING * SPACING * THICKNESS;
}

/* Of a bond, and so of a contact. */
static double stiffness(void) {
  return 30e9 * THICKNESS / (sqrt(3) * (1 - 0.2));
}

#define LATTICE(name, x)                                                                           \
  "&lattice name = '" name "' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 origin = " x       \
  ", 0 /\n&material lattice = '" name "' model = 'm' /\n"
#define ALL(name)                                                                                  \
  "&region name = 'all " name "' lattice = '" name                                                 \
  "' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"
#define SPEED(name, v) "&initial_velocity region = 'all " name "' component = 'x' value = " v " /\n"
/* A row of particles; a block. */
#define ROW(name, x, length)                                                                       \
  LATTICE(name, x)                                                                                 \
  "&body lattice = '" name "' shape = 'rectangle' corner = " x ", -0.001 size = " length           \
  ", 0.002 /\n" ALL(name)
/* Two particles above each other: nothing presses them against each other. */
#define COLUMN(name, x)                                                                            \
  "&lattice name = '" name "' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 origin = " x       \
  ", 0 rotation = 90 /\n&material lattice = '" name "' model = 'm' /\n"                            \
  "&body lattice = '" name "' shape = 'segment' from = " x ", -0.001 to = " x                      \
  ", 0.011 /\n" ALL(name)
#define BLOCK(name, x)                                                                             \
  LATTICE(name, x)                                                                                 \
  "&body lattice = '" name "' shape = 'rectangle' corner = " x ", 0 size = 0.05, 0.06 /\n" ALL(name)

/* --- a bounce --------------------------------------------------------------------------------- */

#define GAP      2e-5
#define APPROACH 5.0

/* Of the left one of two equal particles that nothing holds, hit by the other one. */
static double pushed_way(double t) {
  const double omega = sqrt(2 * stiffness() / mass()), begins = GAP / APPROACH,
               ends = begins + acos(-1) / omega;
  double apart = GAP - APPROACH * t; /* distance less the spacing */
  if (t > begins) apart = -APPROACH / omega * sin(omega * (t - begins));
  if (t > ends) apart = APPROACH * (t - ends);
  return 0.5 * (-APPROACH * t + GAP - apart);
}

/* Two columns in contact for `end`: how far the left one is off its `way` at most. */
static double way_error(const char *right, double end, int steps, double (*way)(double),
                        double *speed) {
  char text[4096];
  snprintf(
      text, sizeof text,
      "&simulation end_time = %.17g step = %.17g /\n" COLUMN(
          "a", "0") "%s"
                    "&contact lattices = 'a', 'b' /\n"
                    "&monitor name = 'u' kind = 'displacement' region = 'all a' component = 'x' /\n"
                    "&monitor name = 'v' kind = 'velocity' region = 'all a' component = 'x' /\n"
                    "&output frames = 0 sample = %.17g /\n",
      end, end / steps, right, end / steps);
  small_bodies b;
  small_bodies_open(&b, &elastic_bar, text);
  assert_int_equal(small_go(&b.run), STEP_END);
  const double *time, *u = small_values(&b.run, "u");
  double most = 0;
  const long samples = simulation_history(b.run.simulation, &time);
  for (long k = 0; k < samples; k++)
    most = fmax(most, fabs(u[k] - way(time[k])));
  *speed = small_last(&b.run, "v");
  small_bodies_close(&b);
  return most;
}

static double bounce_error(int steps, double *rebound) {
  const double end = GAP / APPROACH + 1.7 * acos(-1) / sqrt(2 * stiffness() / mass());
  return way_error(COLUMN("b", "0.01002") SPEED("b", "-5"), end, steps, pushed_way, rebound) / GAP;
}

static void two_particles_bounce(void **state) {
  (void)state;
  double v[2];
  const double coarse = bounce_error(80, &v[0]), fine = bounce_error(320, &v[1]);
  print_message("error %.1e, %.1e; hit particle at %.6f, %.6f of the other one's speed\n", coarse,
                fine, v[0] / -APPROACH, v[1] / -APPROACH);
  assert_true(coarse < 0.02 && fine < coarse / 8);
  assert_true(fabs(v[1] / -APPROACH - 1) < 1e-3);
}

#define OVERLAP 1e-6
/* Begins pressed together by this, at rest: the way of either until they part. */
static double parting_way(double t) {
  return -0.5 * OVERLAP * (1 - cos(sqrt(2 * stiffness() / mass()) * t));
}

static double parting_error(int steps) {
  const double end = 0.4 * acos(-1) / sqrt(2 * stiffness() / mass());
  double speed;
  return way_error(COLUMN("b", "0.01") "&initial_displacement region = 'all b' component = 'x' "
                                       "value = -1e-6 /\n",
                   end, steps, parting_way, &speed) /
         OVERLAP;
}

static void what_begins_pressed_together_parts(void **state) {
  (void)state;
  const double coarse = parting_error(20), fine = parting_error(80);
  print_message("error %.1e, %.1e, order %.2f\n", coarse, fine, log2(coarse / fine) / 2);
  assert_true(coarse < 1e-3 && fabs(log2(coarse / fine) / 2 - 2) < 0.1);
}

/* --- blocks ----------------------------------------------------------------------------------- */

static double momentum(const small_bodies *b, int component) {
  double sum = 0;
  for (int n = 0; n < simulation_bodies(b->run.simulation); n++) {
    const body *w = simulation_state(b->run.simulation, n)->body;
    for (long p = 0; p < w->lattice->particle_count; p++)
      sum += body_mass(w, component, w->lattice->particle_site[p]) *
             w->velocity[component][w->lattice->particle_site[p]];
  }
  return sum;
}

/* The right one comes from the right and a little from above: faces slide. */
static void open_collision(small_bodies *b, double step, int threads, const char *more) {
  char text[8192];
  snprintf(text, sizeof text,
           "&simulation end_time = 2e-4 step = %.17g threads = %d /\n" BLOCK("a", "0")
               BLOCK("b", "0.061") SPEED(
                   "b", "-10") "&initial_velocity region = 'all b' component = 'y' value = -1 /\n"
                               "&output frames = 0 sample = 2e-6 /\n%s",
           step, threads, more);
  small_bodies_open(b, &elastic_beam, text);
}

/* Momentum to rounding; the imbalance of energies falls with the square of the step. */
static void blocks_collide(void **state) {
  (void)state;
  const double steps[2] = {4e-7, 2.5e-8};
  double imbalance[2], of_contact[2];
  for (int k = 0; k < 2; k++) {
    small_bodies b;
    open_collision(&b, steps[k], 1, "&contact /\n");
    const double before[2] = {momentum(&b, 0), momentum(&b, 1)};
    simulation_advance(b.run.simulation, 1, NULL);
    assert_int_equal(small_go(&b.run), STEP_END);
    for (int d = 0; d < 2; d++)
      assert_true(fabs(momentum(&b, d) - before[d]) < 1e-12 * fabs(before[0]));
    const double kinetic = small_largest(&b.run, "energy/kinetic");
    assert_true(small_largest(&b.run, "contact/stored") > 0.05 * kinetic);
    assert_true(small_largest(&b.run, "a/external") > 0.2 * kinetic);
    assert_true(small_last(&b.run, "contact/stored") == 0);
    assert_true(small_last(&b.run, "a/kinetic") > 0.5 * kinetic); /* they have parted */
    imbalance[k] = small_largest(&b.run, "energy/imbalance") / kinetic;
    of_contact[k] = small_largest(&b.run, "contact/imbalance") / kinetic;
    small_bodies_close(&b);
  }
  print_message("imbalance %.1e, %.1e; of the contact %.1e, %.1e\n", imbalance[0], imbalance[1],
                of_contact[0], of_contact[1]);
  assert_true(imbalance[0] < 1e-3 && imbalance[1] < imbalance[0] / 100);
  assert_true(of_contact[0] < 1e-3 && of_contact[1] < of_contact[0] / 100);
}

/* Means over the time between samples give the impulse; what one body bears is the other's. */
static void the_force_of_contact_is_the_change_of_momentum(void **state) {
  (void)state;
  small_bodies b;
  open_collision(&b, 4e-7, 1,
                 "&contact /\n&monitor name = 'f' kind = 'contact_force' lattice = 'a' "
                 "component = 'x' average = 2e-6 /\n"
                 "&monitor name = 'now' kind = 'contact_force' lattice = 'a' component = 'x' /\n"
                 "&monitor name = 'other' kind = 'contact_force' region = 'all b' "
                 "component = 'x' /\n"
                 "&monitor name = 'p' kind = 'momentum' lattice = 'a' component = 'x' /\n");
  assert_int_equal(small_go(&b.run), STEP_END);
  const double *f, *now, *other;
  simulation_series(b.run.simulation, small_series(&b.run, "f"), NULL, &f);
  simulation_series(b.run.simulation, small_series(&b.run, "now"), NULL, &now);
  simulation_series(b.run.simulation, small_series(&b.run, "other"), NULL, &other);
  const double p = small_last(&b.run, "p"), most = small_largest(&b.run, "now");
  double impulse = 0;
  for (long k = 0; k < simulation_history(b.run.simulation, NULL); k++) {
    impulse += 2e-6 * f[k];
    assert_true(fabs(now[k] + other[k]) < 1e-12 * most);
  }
  assert_true(p < -1 && most > 1e4); /* it is pushed on */
  assert_true(fabs(impulse / p - 1) < 1e-12);
  small_bodies_close(&b);
}

/* Three alike in a row: the last one goes on, the one in the middle stays. */
static void a_middle_block_hands_the_blow_on(void **state) {
  (void)state;
  small_bodies b;
  small_bodies_open(
      &b, &elastic_bar,
      "&simulation end_time = 2.2e-4 step = 2e-8 /\n" COLUMN("a", "0") COLUMN("b", "0.011")
          COLUMN("c", "0.0215") SPEED(
              "a",
              "10") "&contact lattices = 'a', 'b' name = 'left' /\n"
                    "&contact lattices = 'b', 'c' name = 'right' /\n"
                    "&monitor name = 'v_a' kind = 'velocity' region = 'all a' component = 'x' /\n"
                    "&monitor name = 'v_b' kind = 'velocity' region = 'all b' component = 'x' /\n"
                    "&monitor name = 'v_c' kind = 'velocity' region = 'all c' component = 'x' /\n"
                    "&output frames = 0 /\n");
  assert_int_equal(small_go(&b.run), STEP_END);
  assert_true(fabs(small_last(&b.run, "v_c") / 10 - 1) < 1e-3);
  assert_true(fabs(small_last(&b.run, "v_b")) < 1e-2 && fabs(small_last(&b.run, "v_a")) < 1e-2);
  assert_true(small_largest(&b.run, "left/stored") > 0 &&
              small_largest(&b.run, "right/stored") > 0);
  small_bodies_close(&b);
}

#define WATCHED_CONTACT                                                                            \
  "&contact /\n&monitor name = 'f' kind = 'contact_force' lattice = 'a' component = 'x' "          \
  "average = 2e-6 /\n"
static void threads_and_stops_change_no_bit(void **state) {
  (void)state;
  static const char path[] = "test_contact.state";
  small_bodies straight, other;
  char error[200];
  open_collision(&straight, 4e-7, 1, WATCHED_CONTACT);
  assert_int_equal(small_go(&straight.run), STEP_END);
  for (int threads = 2; threads <= 3; threads++) {
    open_collision(&other, 4e-7, threads, WATCHED_CONTACT);
    assert_int_equal(small_go(&other.run), STEP_END);
    same_runs(straight.run.simulation, other.run.simulation);
    small_bodies_close(&other);
  }
  open_collision(&other, 4e-7, 2, WATCHED_CONTACT);
  simulation_advance(other.run.simulation, 300, NULL); /* they are in touch */
  assert_true(small_last(&other.run, "contact/stored") > 0);
  assert_true(
      simulation_save(other.run.simulation, path, "x", &(frame_mark){0}, error, sizeof error));
  small_bodies_close(&other);
  open_collision(&other, 4e-7, 1, WATCHED_CONTACT);
  assert_true(simulation_restore(other.run.simulation, path, "x", NULL, error, sizeof error));
  assert_int_equal(small_go(&other.run), STEP_END);
  same_runs(straight.run.simulation, other.run.simulation);
  const contact_said a = simulation_contact(straight.run.simulation, 0),
                     b = simulation_contact(other.run.simulation, 0);
  assert_true(a.pairs > 0 && a.pairs == b.pairs && a.force == b.force && a.stored == b.stored);
  assert_true(a.stored >= small_largest(&straight.run, "contact/stored"));
  small_bodies_close(&other);
  small_bodies_close(&straight);
  unlink(path);
}

/* --- the step --------------------------------------------------------------------------------- */

static double largest_step(const char *more) {
  char text[4096];
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-5 /\n" BLOCK("a", "0")
               BLOCK("b", "0.061") "&output frames = 0 /\n%s",
           more);
  small_bodies b;
  small_bodies_open(&b, &elastic_bar, text);
  const double limit = simulation_step_limit(b.run.simulation)->limit;
  small_bodies_close(&b);
  return limit;
}

/* Central bonds of a hexagon: omega^2 = 6 k/m; contact adds 6 k/m of its own. */
static void contact_makes_the_stable_step_shorter(void **state) {
  (void)state;
  const double k = stiffness(), m = mass();
  assert_true(fabs(largest_step("") / (2 / sqrt(6 * k / m)) - 1) < 1e-8);
  assert_true(fabs(largest_step("&contact /\n") / (2 / sqrt(12 * k / m)) - 1) < 1e-8);
  assert_true(fabs(largest_step("&contact lattices = 'a' stiffness = 1e9 /\n") /
                       (2 / sqrt(6 * (k + 1e9) / m)) -
                   1) < 1e-8);
}

/* --- at rest ---------------------------------------------------------------------------------- */

/* Three springs in a row: of each row of two particles, and of the contact, which is softer. */
static void rows_pressed_together_are_springs(void **state) {
  (void)state;
  small_bodies b;
  small_bodies_open(
      &b, &elastic_bar,
      "&simulation end_time = 1 /\n&relaxation increments = 4 tolerance = 1e-10 /\n" ROW("a", "0",
                                                                                         "0.01")
          ROW("b", "0.02",
              "0.01") "&region name = 'left' lattice = 'a' shape = 'point' at = 0, 0 /\n"
                      "&region name = 'right' lattice = 'b' shape = 'point' at = 0.03, 0 /\n"
                      "&support region = 'left' fix = 'x' /\n"
                      "&drive region = 'right' component = 'x' displacement = -1e-6 /\n"
                      "&contact stiffness = '1e9 N/m' /\n"
                      "&monitor name = 'F' kind = 'reaction' region = 'left' component = 'x' /\n"
                      "&output frames = 0 /\n");
  assert_int_equal(small_go(&b.run), STEP_END);
  const double expected = 1e-6 / (2 / stiffness() + 1e-9);
  print_message("reaction %.9g of %.9g N\n", small_last(&b.run, "F"), expected);
  assert_true(fabs(small_last(&b.run, "F") / expected - 1) < 1e-6);
  assert_true(fabs(small_last(&b.run, "contact/stored") / (0.5 * expected * expected * 1e-9) - 1) <
              1e-5);
  small_bodies_close(&b);
}

#define HELD                                                                                       \
  "&support region = 'all a' fix = 'x', 'y' /\n"                                                   \
  "&monitor name = 'F' kind = 'reaction' region = 'all a' component = 'x' /\n"                     \
  "&output frames = 0 sample = 1e-7 /\n&contact /\n"

/* Both particles of a column are held, and bear what two pairs press. */
static void what_is_held_bears_the_contact(void **state) {
  (void)state;
  small_bodies b;
  small_bodies_open(
      &b, &elastic_bar,
      "&simulation end_time = 1 /\n&relaxation increments = 2 /\n" COLUMN("a", "0") COLUMN(
          "b", "0.01") "&drive region = 'all b' component = 'x' displacement = -1e-6 /\n" HELD);
  assert_int_equal(small_go(&b.run), STEP_END);
  assert_true(fabs(small_last(&b.run, "F") / (2e-6 * stiffness()) - 1) < 1e-6);
  small_bodies_close(&b);
}

/* At every instant, of what comes flying: W = 2 k x^2/2, F = 2 k x. */
static void a_wall_bears_a_blow(void **state) {
  (void)state;
  small_bodies b;
  small_bodies_open(&b, &elastic_bar,
                    "&simulation end_time = 6e-5 step = 1e-7 /\n" COLUMN("a", "0")
                        COLUMN("b", "0.0101") SPEED("b", "-5") HELD);
  assert_int_equal(small_go(&b.run), STEP_END);
  const double *force, *stored;
  double most = 0;
  simulation_series(b.run.simulation, small_series(&b.run, "F"), NULL, &force);
  simulation_series(b.run.simulation, small_series(&b.run, "contact/stored"), NULL, &stored);
  for (long n = 0; n < simulation_history(b.run.simulation, NULL); n++) {
    const double expected = 2 * sqrt(stiffness() * stored[n]);
    assert_true(fabs(force[n] - expected) <= 1e-9 * small_largest(&b.run, "F"));
    most = fmax(most, expected);
  }
  assert_true(most > 0 && small_last(&b.run, "contact/stored") == 0);
  assert_true(small_largest(&b.run, "a/external") < 1e-12 * small_largest(&b.run, "b/external"));
  small_bodies_close(&b);
}

/* Rows that begin nearer than a spacing push no one until they come nearer still. */
static void what_begins_near_is_at_rest(void **state) {
  (void)state;
  small_bodies b;
  small_bodies_open(&b, &elastic_bar,
                    "&simulation end_time = 1e-5 step = 2e-7 /\n" ROW("a", "0", "0.01")
                        ROW("b", "0.016", "0.01") "&contact /\n&output frames = 0 /\n");
  assert_int_equal(small_go(&b.run), STEP_END);
  assert_true(small_largest(&b.run, "energy/kinetic") == 0);
  small_bodies_close(&b);
}

/* --- cracks ----------------------------------------------------------------------------------- */

/* A pair is pulled apart until its bond breaks, and then pressed together. */
#define TORN                                                                                       \
  "&simulation end_time = 2e-3 step = 2e-7 /\n" ROW(                                               \
      "c", "0",                                                                                    \
      "0.01") "&region name = 'left' lattice = 'c' shape = 'point' at = 0, 0 /\n"                  \
              "&region name = 'right' lattice = 'c' shape = 'point' at = 0.01, 0 /\n"              \
              "&support region = 'left' fix = 'xy' /\n&support region = 'right' fix = 'y' /\n"     \
              "&drive region = 'right' component = 'x' displacement = 1e-5 times = 0, 5e-4, "      \
              "1e-3, 2e-3 "                                                                        \
              "values = 0, 1, -2, -2 /\n"                                                          \
              "&monitor name = 'F' kind = 'reaction' region = 'left' component = 'x' /\n"          \
              "&output frames = 0 /\n"

static void open_torn(small_run *r, const pl_law *law, const char *more) {
  char text[4096];
  snprintf(text, sizeof text, TORN "%s", more);
  small_open(r, law, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

static void faces_of_a_crack_close(void **state) {
  (void)state;
  static const char *const contacts[2] = {"", "&contact lattices = 'c' /\n"};
  double force[2];
  for (int k = 0; k < 2; k++) {
    small_run r;
    open_torn(&r, &elastic_bar, contacts[k]);
    sweep *w = simulation_state(r.simulation, 0);
    const rows *g = w->body->lattice;
    simulation_advance(r.simulation, 2500, NULL);
    w->field[0][g->particle_site[0]] = 1; /* the bond is of the left one, along x */
    assert_int_equal(small_go(&r), STEP_END);
    force[k] = small_last(&r, "F");
    small_close(&r);
  }
  print_message("force without and with contact %.6g, %.6g of %.6g N\n", force[0], force[1],
                2e-5 * stiffness());
  assert_true(force[0] == 0);
  assert_true(fabs(force[1] / (2e-5 * stiffness()) - 1) < 1e-9);
}

/* The bond is lost when the pair has come together by 1e-5 m: from there on contact presses. */
static void a_bond_lost_under_pressure_leaves_no_jump(void **state) {
  (void)state;
  small_run r;
  open_torn(&r, &elastic_bar, "&contact /\n");
  sweep *w = simulation_state(r.simulation, 0);
  const rows *g = w->body->lattice;
  const long right = g->particle_site[1], left = g->particle_site[0];
  while (!(w->body->displacement[0][right] < -1e-5))
    simulation_advance(r.simulation, 1, NULL);
  const double lost = w->body->displacement[0][right];
  w->field[0][left] = 1;
  simulation_advance(r.simulation, 1, NULL);
  const double moved = w->body->displacement[0][right]; /* where the loss is seen */
  assert_true(moved < lost && w->body->outer[0][right] == 0);
  assert_int_equal(small_go(&r), STEP_END);
  const double expected = stiffness() * (2e-5 + moved);
  assert_true(fabs(small_last(&r, "F") / expected - 1) < 1e-9);
  small_close(&r);
}

/* As elastic_bar, but failed bonds bear what presses them together. */
static void bearing_strip(const pl_law *law, const double *u, const pl_strip *s, int with_losses) {
  elastic_strip(law, u, s, with_losses);
  for (long q = 0; q < s->count; q++) {
    if (!(s->flags[q] & PL_PRESENT(s->direction)) || s->field[0][q] < 1) continue;
    const elastic_bond b = elastic_kinematics(law, u, s, q);
    for (int c = 0; c < 2 && b.stretch < 0; c++)
      s->force[c][q] = u[UNIFORM_EA] * b.stretch * b.e[c];
  }
}

static void bearing_rows(const pl_law *law, const double *u, const pl_strip *s) {
  bearing_strip(law, u, s, 0);
}

static void bearing_rows_ledger(const pl_law *law, const double *u, const pl_strip *s) {
  bearing_strip(law, u, s, 1);
}

static void bonds_that_press_on_need_no_contact(void **state) {
  (void)state;
  pl_law law = elastic_bar;
  law.rows = bearing_rows;
  law.rows_ledger = bearing_rows_ledger;
  law.stores = 0; /* it does not say what it stores then */
  small_run r;
  open_torn(&r, &law, "&contact /\n");
  sweep *w = simulation_state(r.simulation, 0);
  w->field[0][w->body->lattice->particle_site[0]] = 1;
  assert_int_equal(small_go(&r), STEP_END);
  assert_true(fabs(small_last(&r, "F") / (2e-5 * stiffness()) - 1) < 1e-9);
  assert_true(small_largest(&r, "contact/stored") == 0);
  small_close(&r);
}

/* --- without contact -------------------------------------------------------------------------- */

/* The rows lie 4 mm apart in the end: two particles of either over each other's. */
static void particles_over_each_other_are_named(void **state) {
  (void)state;
  static const char *const contacts[2] = {"", "&contact /\n"};
  for (int k = 0; k < 2; k++) {
    small_bodies b;
    char text[4096];
    snprintf(text, sizeof text,
             "&simulation end_time = 1e-6 step = 1e-8 /\n" ROW("a", "0", "0.01")
                 ROW("b", "0.02", "0.01") "&output frames = 0 /\n%s",
             contacts[k]);
    small_bodies_open(&b, &elastic_bar, text);
    assert_int_equal(simulation_overlap(b.run.simulation).pairs, 0);
    body *w = simulation_state(b.run.simulation, 1)->body;
    for (long p = 0; p < 2; p++)
      w->displacement[0][w->lattice->particle_site[p]] = -0.006;
    const overlap_found o = simulation_overlap(b.run.simulation);
    assert_int_equal(o.pairs, k == 0);
    if (k == 0) {
      assert_true(o.body[0] == 0 && o.particle[0] == 1);
      assert_true(o.body[1] == 1 && o.particle[1] == 0);
    }
    small_bodies_close(&b);
  }
}

/* Of one body only where bonds are lost. */
static void so_are_faces_of_a_crack(void **state) {
  (void)state;
  small_run r;
  open_torn(&r, &elastic_bar, "");
  sweep *w = simulation_state(r.simulation, 0);
  const rows *g = w->body->lattice;
  w->body->displacement[0][g->particle_site[1]] = -0.006;
  assert_int_equal(simulation_overlap(r.simulation).pairs, 0);
  w->field[0][g->particle_site[0]] = 1;
  assert_int_equal(simulation_overlap(r.simulation).pairs, 1);
  assert_true(w->field[0][g->particle_site[0]] == 1 &&
              w->body->displacement[0][g->particle_site[1]] == -0.006);
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(two_particles_bounce),
      cmocka_unit_test(what_begins_pressed_together_parts),
      cmocka_unit_test(blocks_collide),
      cmocka_unit_test(the_force_of_contact_is_the_change_of_momentum),
      cmocka_unit_test(a_middle_block_hands_the_blow_on),
      cmocka_unit_test(threads_and_stops_change_no_bit),
      cmocka_unit_test(contact_makes_the_stable_step_shorter),
      cmocka_unit_test(rows_pressed_together_are_springs),
      cmocka_unit_test(what_is_held_bears_the_contact),
      cmocka_unit_test(a_wall_bears_a_blow),
      cmocka_unit_test(what_begins_near_is_at_rest),
      cmocka_unit_test(faces_of_a_crack_close),
      cmocka_unit_test(a_bond_lost_under_pressure_leaves_no_jump),
      cmocka_unit_test(bonds_that_press_on_need_no_contact),
      cmocka_unit_test(particles_over_each_other_are_named),
      cmocka_unit_test(so_are_faces_of_a_crack),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
