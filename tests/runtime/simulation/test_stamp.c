/* Stamps: the bounce of particles on one against its closed form, with and without damping;
   momentum and energies of a block that is hit; friction against Coulomb's law; prescribed ways;
   gravity; the same bits with any threads and after a stop. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <unistd.h>

#include <cmocka.h>

#include "runtime/parts/run_stamp.h"
#include "tests/runtime/hand_over.h"
#include "tests/runtime/same_runs.h"
#include "tests/runtime/small_bodies.h"

#define SPACING   0.01
#define THICKNESS 0.1
#define PI        acos(-1)

static double mass(void) {
  return 2323 * sqrt(3) / 2 * SPACING * SPACING * THICKNESS;
}

/* E V/s^2: of a bond of the law by hand. */
static double stiffness(void) {
  return 30e9 * THICKNESS / (sqrt(3) * (1 - 0.2));
}

/* Two particles above each other, at x = 0: nothing presses them against each other, and a flat
   stamp touches both. */
#define COLUMN                                                                                     \
  "&lattice name = 'a' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = 90 /\n"        \
  "&material lattice = 'a' model = 'm' /\n"                                                        \
  "&body lattice = 'a' shape = 'segment' from = 0, -0.001 to = 0, 0.011 /\n"                       \
  "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"
#define BLOCK                                                                                      \
  "&lattice name = 'a' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"                      \
  "&material lattice = 'a' model = 'm' /\n"                                                        \
  "&body lattice = 'a' shape = 'rectangle' corner = 0, 0 size = 0.05, 0.06 /\n"                    \
  "&region name = 'all' shape = 'rectangle' corner = -1, -1 size = 2, 2 /\n"

static void open_run(small_bodies *b, const pl_law *law, const char *format, ...) {
  char text[8192];
  va_list list;
  va_start(list, format);
  vsnprintf(text, sizeof text, format, list);
  va_end(list);
  small_bodies_open(b, law, text);
}

/* --- a bounce --------------------------------------------------------------------------------- */

#define GAP      2e-5
#define APPROACH 5.0
#define HEAVIER  3.0 /* the stamp, than both particles together */

static double reduced_mass(void) {
  return 2 * mass() * HEAVIER / (1 + HEAVIER);
}

static double time_of_contact(void) {
  return PI * sqrt(reduced_mass() / (2 * stiffness()));
}

/* Of the stamp that comes from the right, before, during and after. */
static double way_of_stamp(double t) {
  const double begins = GAP / APPROACH, whole = time_of_contact(), part = 1 / (1 + HEAVIER);
  double apart = GAP - APPROACH * t;
  if (t > begins) apart = -APPROACH * whole / PI * sin(PI * (t - begins) / whole);
  if (t > begins + whole) apart = APPROACH * (t - begins - whole);
  return part * (apart - GAP) - HEAVIER * part * APPROACH * t; /* the centre of mass goes on */
}

static double bounce_error(int steps, double *after, double *impulse) {
  const double end = GAP / APPROACH + 1.7 * time_of_contact(), dt = end / steps;
  small_bodies b;
  open_run(&b, &elastic_bar,
           "&simulation end_time = %.17g step = %.17g /\n" COLUMN
           "&stamp name = 'wall' shape = 'rectangle' corner = %.17g, -0.02 size = 0.02, 0.05 "
           "mass = %.17g direction = -1, 0 velocity = 5 /\n"
           "&monitor name = 'u' kind = 'displacement' stamp = 'wall' component = 'x' /\n"
           "&monitor name = 'v' kind = 'velocity' stamp = 'wall' component = 'x' /\n"
           "&monitor name = 'F' kind = 'contact_force' stamp = 'wall' component = 'x' /\n"
           "&monitor name = 'G' kind = 'contact_force' region = 'all' component = 'x' /\n"
           "&monitor name = 'M' kind = 'moment' stamp = 'wall' /\n"
           "&output frames = 0 sample = %.17g /\n",
           end, dt, 0.5 * SPACING + GAP, 2 * HEAVIER * mass(), dt);
  assert_int_equal(small_go(&b.run), STEP_END);
  const double *time, *u = small_values(&b.run, "u"), *F = small_values(&b.run, "F"),
                      *G = small_values(&b.run, "G");
  const long samples = simulation_history(b.run.simulation, &time);
  double most = 0;
  *impulse = 0;
  for (long k = 0; k < samples; k++) {
    most = fmax(most, fabs(u[k] - way_of_stamp(time[k])));
    *impulse += F[k] * dt;
    assert_true(F[k] == -G[k]);
  }
  *after = small_last(&b.run, "v");
  /* both particles push alike, 5 mm below and 5 mm above the middle of the stamp */
  assert_true(small_largest(&b.run, "M") < 1e-9 * SPACING * small_largest(&b.run, "F"));
  small_bodies_close(&b);
  return most / GAP;
}

static void particles_bounce_on_a_free_stamp(void **state) {
  (void)state;
  double v[2], impulse[2];
  const double coarse = bounce_error(80, &v[0], &impulse[0]),
               fine = bounce_error(320, &v[1], &impulse[1]);
  const double rebound = -APPROACH * (HEAVIER - 1) / (HEAVIER + 1),
               handed = 2 * reduced_mass() * APPROACH;
  print_message("error %.1e, %.1e; velocity after %.6f, %.6f, impulse %.6f, %.6f of theory\n",
                coarse, fine, v[0] / rebound, v[1] / rebound, impulse[0] / handed,
                impulse[1] / handed);
  assert_true(coarse < 0.02 && fine < coarse / 8);
  assert_true(fabs(v[1] / rebound - 1) < 1e-3 && fabs(impulse[1] / handed - 1) < 1e-3);
}

/* Restitution of a spring and a dashpot that do not pull (Schwager and Poeschel 2007). */
static double restitution(double zeta) {
  const double root = sqrt(1 - zeta * zeta);
  return exp(-zeta / root * (PI - atan2(2 * zeta * root, 1 - 2 * zeta * zeta)));
}

static double damped_bounce(double zeta, int steps, double *lost) {
  const double whole = PI * sqrt(mass() / stiffness()), end = 2 * whole;
  small_bodies b;
  open_run(&b, &elastic_bar,
           "&simulation end_time = %.17g step = %.17g /\n" COLUMN
           "&initial_velocity region = 'all' component = 'x' value = 5 /\n"
           "&stamp name = 'wall' shape = 'rectangle' corner = 0.005, -0.02 size = 0.02, 0.05 "
           "velocity = 0 damping = %.17g /\n"
           "&monitor name = 'v' kind = 'velocity' region = 'all' component = 'x' /\n"
           "&output frames = 0 sample = %.17g /\n",
           end, end / steps, zeta, end / 50);
  assert_int_equal(small_go(&b.run), STEP_END);
  const double e = -small_last(&b.run, "v") / APPROACH;
  *lost = small_last(&b.run, "wall/dissipated_damping") / (mass() * APPROACH * APPROACH);
  assert_true(small_last(&b.run, "energy/imbalance") < 1e-2 * mass() * APPROACH * APPROACH);
  small_bodies_close(&b);
  return e;
}

static void damping_sets_the_restitution(void **state) {
  (void)state;
  const double zetas[] = {0, 0.1, 0.3};
  for (int k = 0; k < 3; k++) {
    double lost[2];
    const double e = restitution(zetas[k]), coarse = damped_bounce(zetas[k], 100, &lost[0]),
                 fine = damped_bounce(zetas[k], 1600, &lost[1]);
    print_message("damping %.1f: restitution %.5f, %.5f, theory %.5f; lost %.5f of %.5f\n",
                  zetas[k], coarse, fine, e, lost[1], 1 - e * e);
    assert_true(fabs(coarse - e) < 0.05 && fabs(fine - e) < 4e-3);
    assert_true(fabs(lost[1] - (1 - e * e)) < 4e-3);
  }
}

/* --- a block ---------------------------------------------------------------------------------- */

static double momentum(const small_bodies *b, int component, double of_stamp) {
  const body *w = simulation_state(b->run.simulation, 0)->body;
  const run_stamp *s = &b->run.simulation->stamps.items[0];
  double sum = of_stamp * s->state.at.velocity[component];
  for (long p = 0; p < w->lattice->particle_count; p++)
    sum += body_mass(w, component, w->lattice->particle_site[p]) *
           w->velocity[component][w->lattice->particle_site[p]];
  return sum;
}

#define BALL 2.0 /* kg */
static void open_hit(small_bodies *b, double step, int threads, double friction, double damping) {
  open_run(b, &elastic_beam,
           "&simulation end_time = 3e-4 step = %.17g threads = %d /\n" BLOCK
           "&stamp name = 'ball' shape = 'disc' centre = 0.0853, 0.041 radius = 0.03 mass = 2 "
           "direction = -1, -0.2 velocity = 8 friction = %.17g damping = %.17g /\n"
           "&output frames = 0 sample = 2e-6 /\n",
           step, threads, friction, damping);
}

/* Momentum to rounding; the imbalance of energies falls with the square of the step, with friction
   that takes up and lets go at least with the step. */
static void a_stamp_hits_a_block(void **state) {
  (void)state;
  const double steps[2] = {4e-7, 2.5e-8};
  for (int sort = 0; sort < 3; sort++) {
    double imbalance[2], taken = 0;
    for (int k = 0; k < 2; k++) {
      small_bodies b;
      open_hit(&b, steps[k], 1, sort > 0 ? 0.3 : 0, sort > 1 ? 0.1 : 0);
      simulation_advance(b.run.simulation, 1, NULL);
      const double before[2] = {momentum(&b, 0, BALL), momentum(&b, 1, BALL)};
      assert_int_equal(small_go(&b.run), STEP_END);
      for (int d = 0; d < 2; d++)
        assert_true(fabs(momentum(&b, d, BALL) - before[d]) < 1e-12 * fabs(before[0]));
      const double kinetic = small_largest(&b.run, "energy/kinetic");
      assert_true(small_largest(&b.run, "ball/stored") > 0.02 * kinetic);
      assert_true(small_last(&b.run, "ball/stored") == 0); /* they have parted */
      assert_true(small_last(&b.run, "a/kinetic") > 0.1 * kinetic);
      taken = small_last(&b.run, "ball/dissipated_damping") / kinetic;
      imbalance[k] = small_largest(&b.run, "energy/imbalance") / kinetic;
      small_bodies_close(&b);
    }
    print_message("imbalance %.1e, %.1e; taken by friction and damping %.4f\n", imbalance[0],
                  imbalance[1], taken);
    assert_true(imbalance[0] < 2e-3 && imbalance[1] < imbalance[0] / (sort ? 10 : 100));
    assert_true(sort ? taken > 1e-3 : taken == 0);
  }
}

/* A stamp lighter than a particle, and dampers, make the longest stable step shorter: with all but
   all of it nothing is made. A tenth longer is refused. */
static void light_stamps_shorten_the_step(void **state) {
  (void)state;
  double limit[3];
  const char *const stamps[3] = {"", "damping = 0", "damping = 0.5"};
  for (int k = 0; k < 3; k++) {
    small_bodies b;
    char text[600] = "";
    if (k > 0)
      snprintf(text, sizeof text,
               "&stamp name = 'ball' shape = 'rectangle' corner = 0.0551, 0.01 size = 0.01, 0.02 "
               "mass = 0.05 direction = -1, 0 velocity = 20 friction = 0.2 %s /\n",
               stamps[k]);
    open_run(&b, &elastic_beam,
             "&simulation end_time = 3e-4 step_safety = 0.999 /\n" BLOCK
             "%s&output frames = 0 sample = 1e-6 /\n",
             text);
    limit[k] = simulation_step_limit(b.run.simulation)->limit;
    assert_int_equal(small_go(&b.run), STEP_END);
    if (k > 0)
      assert_true(small_largest(&b.run, "energy/kinetic") < 1.5 * 0.5 * 0.05 * 20 * 20 &&
                  small_largest(&b.run, "ball/stored") > 0);
    small_bodies_close(&b);
  }
  print_message("longest step %.4g us, %.4g us, damped %.4g us\n", 1e6 * limit[0], 1e6 * limit[1],
                1e6 * limit[2]);
  /* k/m + N k/M; N: 2, and as many as the surface half a spacing outside has spacings */
  const double k = 30e9 * sqrt(3) / 2 * THICKNESS, alone = pow(2 / limit[0], 2), N = 2 + 6 + PI;
  assert_true(fabs(pow(2 / limit[1], 2) / (alone + k / mass() + N * k / 0.05) - 1) < 1e-3);
  assert_true(limit[2] < 0.8 * limit[1]);
}

#define COLUMN_OF(name, x)                                                                         \
  "&lattice name = '" name "' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = 90 "    \
  "origin = " x ", 0 /\n&material lattice = '" name "' model = 'm' /\n&body lattice = '" name      \
  "' shape = 'segment' from = " x ", -0.001 to = " x ", 0.011 /\n"

static double limit_of_columns(const char *bodies, const char *masses, double damping, double M) {
  small_bodies b;
  open_run(&b, &elastic_bar,
           "&simulation end_time = 1e-6 /\n%s%s"
           "&stamp name = 'dust' shape = 'rectangle' corner = 0.0051, -0.001 size = 0.01, 0.01 "
           "mass = %.17g direction = -1, 0 stiffness = 1e9 damping = %.17g /\n"
           "&output frames = 0 /\n",
           bodies, masses, M, damping);
  const double limit = simulation_step_limit(b.run.simulation)->limit;
  small_bodies_close(&b);
  return limit;
}

/* A stamp that is light is all that moves: omega^2 = N k/M and c = N c/M of all that touch it, the
   heaviest particles' dampers with their point masses. */
static void light_stamps_feel_all_that_touch_them(void **state) {
  (void)state;
  static const char second[] = COLUMN_OF("a", "0") COLUMN_OF("b", "0.03");
  char heavy[100];
  snprintf(heavy, sizeof heavy, "&point_mass region = 'all' mass = %.17g /\n", 99 * mass());
  const double M = 1e-8, k = 1e9, one = pow(2 / limit_of_columns(COLUMN, "", 0, M), 2),
               two = pow(2 / limit_of_columns(second, "", 0, M), 2);
  assert_true(fabs(one / (2 * k / M) - 1) < 1e-4 && fabs(two / (4 * k / M) - 1) < 1e-4);
  for (int n = 0; n < 2; n++) {
    const double p = 2 / limit_of_columns(COLUMN, n ? heavy : "", 0.1, M),
                 c = 2 * 0.2 * sqrt(k * mass() * (n ? 100 : 1)) / M;
    assert_true(fabs((p - 2 * k / M / p) / c - 1) < 1e-3); /* p^2 = omega^2 + p c */
  }
}

/* --- friction --------------------------------------------------------------------------------- */

#define G 10.0

/* A block on a floor, both tilted by tan(angle) = 0.5: the acceleration along it in the second half
   of the run. */
static double slide(double friction, double *ratio) {
  const double end = 0.02, down = G / sqrt(1.25);
  small_bodies b;
  open_run(&b, &elastic_beam,
           "&simulation end_time = %.17g /\n" BLOCK "&gravity acceleration = %.17g, %.17g /\n"
           "&stamp name = 'floor' shape = 'rectangle' corner = -1, -1.005 size = 3, 1 "
           "velocity = 0 stiffness = 1e7 damping = 0.2 friction = %.17g /\n"
           "&monitor name = 'v' kind = 'velocity' region = 'all' component = 'x' average = 1e-3 /\n"
           "&monitor name = 'x' kind = 'contact_force' stamp = 'floor' component = 'x' /\n"
           "&monitor name = 'y' kind = 'contact_force' stamp = 'floor' component = 'y' /\n"
           "&output frames = 0 sample = 1e-4 /\n",
           end, 0.5 * down, -down, friction);
  assert_int_equal(small_go(&b.run), STEP_END);
  const double *v = small_values(&b.run, "v"), *time;
  const long last = simulation_history(b.run.simulation, &time) - 1;
  *ratio = -small_last(&b.run, "x") / small_last(&b.run, "y");
  const double a = (v[last] - v[last / 2]) / (time[last] - time[last / 2]);
  small_bodies_close(&b);
  return a / down;
}

static void blocks_slide_by_coulombs_law(void **state) {
  (void)state;
  double ratio[3];
  const double slow = slide(0.3, &ratio[0]), fast = slide(0, &ratio[1]),
               held = slide(0.7, &ratio[2]);
  print_message("acceleration %.5f (0.2), %.5f (0.5), %.1e (0); force along over across %.15f, "
                "%.2g, %.4f\n",
                slow, fast, held, ratio[0], ratio[1], ratio[2]);
  assert_true(fabs(slow - 0.2) < 2e-3 && fabs(fast - 0.5) < 1e-9 && fabs(held) < 2e-3);
  assert_true(fabs(ratio[0] - 0.3) < 1e-12 && ratio[1] == 0);
}

/* --- how it moves ----------------------------------------------------------------------------- */

static void stamps_go_where_the_deck_says(void **state) {
  (void)state;
  small_bodies b;
  open_run(&b, &elastic_bar,
           "&simulation end_time = 1e-4 step = 1e-6 /\n" COLUMN
           "&stamp name = 'p' shape = 'disc' centre = 1, 0 radius = 0.1 direction = 3, 4 "
           "velocity = 2 rise = 5e-5 end = 8e-5 /\n"
           "&stamp name = 'q' shape = 'disc' centre = 1, 1 radius = 0.1 direction = 0, 1 "
           "displacement = 1e-3 times = 0, 5e-5, 1e-4 values = 0, 1, 0.5 /\n"
           "&stamp name = 'r' shape = 'disc' centre = 1, 2 radius = 0.1 direction = 1, 0 "
           "velocity = '1 m/s' formula = 'sin(t/5e-5 [s])' /\n"
           "&stamp name = 'f' shape = 'disc' centre = 3, 2 radius = 0.1 mass = 3 /\n"
           "&stamp name = 'g' shape = 'disc' centre = 5, 2 radius = 0.1 mass = 3 guided = T "
           "direction = 1, -1 velocity = 1 /\n"
           "&gravity acceleration = 0, -10 /\n"
           "&monitor name = 'px' kind = 'displacement' stamp = 'p' component = 'x' /\n"
           "&monitor name = 'py' kind = 'displacement' stamp = 'p' component = 'y' /\n"
           "&monitor name = 'qy' kind = 'displacement' stamp = 'q' component = 'y' /\n"
           "&monitor name = 'rx' kind = 'displacement' stamp = 'r' component = 'x' /\n"
           "&monitor name = 'rv' kind = 'velocity' stamp = 'r' component = 'x' /\n"
           "&monitor name = 'fy' kind = 'displacement' stamp = 'f' component = 'y' /\n"
           "&monitor name = 'fv' kind = 'velocity' stamp = 'f' component = 'y' /\n"
           "&monitor name = 'gx' kind = 'displacement' stamp = 'g' component = 'x' /\n"
           "&monitor name = 'gy' kind = 'displacement' stamp = 'g' component = 'y' /\n"
           "&output frames = 0 sample = 1e-6 /\n");
  assert_int_equal(small_go(&b.run), STEP_END);
  const double t = 1e-4, way = 5e-5 + 2 * 3e-5, guided = (t + 0.25 * sqrt(2) * 10 * t * t);
  assert_true(fabs(small_last(&b.run, "px") - 0.6 * way) < 1e-15);
  assert_true(fabs(small_last(&b.run, "py") - 0.8 * way) < 1e-15);
  assert_true(fabs(small_last(&b.run, "qy") - 5e-4) < 1e-15);
  assert_true(fabs(small_largest(&b.run, "qy") - 1e-3) < 1e-15);
  assert_true(fabs(small_last(&b.run, "rx") - (1 - cos(2)) / 20000) < 1e-12);
  assert_true(fabs(small_last(&b.run, "rv") - sin(2)) < 1e-3);
  assert_true(fabs(small_last(&b.run, "fy") + 0.5 * 10 * t * t) < 1e-15);
  assert_true(fabs(small_last(&b.run, "fv") + 10 * t) < 1e-12);
  assert_true(fabs(small_last(&b.run, "gx") - guided / sqrt(2)) < 1e-12);
  assert_true(fabs(small_last(&b.run, "gy") + guided / sqrt(2)) < 1e-12);
  const double weight = small_last(&b.run, "f/external"), kinetic = small_last(&b.run, "f/kinetic");
  assert_true(fabs(weight / (3 * 10 * 0.5 * 10 * t * t) - 1) < 1e-2);
  assert_true(fabs(small_largest(&b.run, "f/imbalance")) < 1e-6 * kinetic);
  assert_true(fabs(small_largest(&b.run, "energy/imbalance")) < 1e-6);
  small_bodies_close(&b);
}

/* The work of what moves a stamp is what the block has. */
static void pressing_does_work(void **state) {
  (void)state;
  small_bodies b;
  open_run(&b, &elastic_beam,
           "&simulation end_time = 1 /\n&relaxation increments = 4 tolerance = 1e-8 /\n" BLOCK
           "&region name = 'foot' shape = 'rectangle' corner = -1, -0.001 size = 2, 0.002 /\n"
           "&support region = 'foot' fix = 'x', 'y' /\n"
           "&stamp name = 'punch' shape = 'rectangle' corner = -1, %.17g size = 2, 1 "
           "direction = 0, -1 displacement = 1e-5 /\n"
           "&monitor name = 'F' kind = 'contact_force' stamp = 'punch' component = 'y' /\n"
           "&monitor name = 'R' kind = 'reaction' region = 'foot' component = 'y' /\n"
           "&output frames = 0 /\n",
           6 * 0.01 * sqrt(3) / 2 + 0.005);
  assert_int_equal(small_go(&b.run), STEP_END);
  const double *F = small_values(&b.run, "F"), *R = small_values(&b.run, "R");
  for (int k = 1; k <= 4; k++)
    assert_true(fabs(F[k] / F[4] - 0.25 * k) < 1e-3 && fabs(F[k] / R[k] - 1) < 1e-6);
  const double held = small_last(&b.run, "energy/stored"), half = 0.5 * F[4] * 1e-5;
  print_message("F %.4g N, energy over F w/2 %.6f\n", F[4], held / half);
  assert_true(fabs(held / half - 1) < 1e-5);
  assert_true(small_last(&b.run, "energy/external") >= held);
  assert_true(fabs(small_last(&b.run, "energy/imbalance")) < 1e-5 * held);
  small_bodies_close(&b);
}

#define UP(more)                                                                                   \
  BLOCK "&stamp name = 'up' shape = 'rectangle' corner = -1, 0.07 size = 2, 1 direction = 0, 1 "   \
        "displacement = 0.02 history = 'constant' " more " /\n"                                    \
        "&monitor name = 'u' kind = 'displacement' stamp = 'up' component = 'y' /\n"

/* A way of two spacings that begins all at once comes within the steps of its increment. */
static void ways_come_evenly_in_an_increment(void **state) {
  (void)state;
  small_bodies b;
  open_run(&b, &elastic_beam,
           "&simulation end_time = 1 /\n&relaxation increments = 4 /\n" UP(
               "start = 0.25 end = 0.75") "&output frames = 0 /\n");
  assert_int_equal(small_go(&b.run), STEP_END);
  const double *u = small_values(&b.run, "u");
  assert_true(u[0] == 0 && u[1] == 0 && u[2] == 0.02 && u[3] == 0.02 && u[4] == 0.02);
  small_bodies_close(&b);
}

/* No sample that would end the run well is taken after a stamp has gone too far. */
static void a_stop_does_not_hide_a_stamp_that_went_too_far(void **state) {
  (void)state;
  small_bodies b;
  open_run(
      &b, &elastic_beam,
      "&simulation end_time = 1e-4 /\n" UP("start = 5e-5") "&stop monitor = 'u' above = 0.015 /\n"
                                                           "&output frames = 0 sample = 1e-9 /\n");
  assert_int_equal(small_go(&b.run), STEP_BAD);
  assert_null(simulation_stopped_by(b.run.simulation));
  assert_true(simulation_stamp(b.run.simulation, 0).too_far);
  small_bodies_close(&b);
}

/* --- the same bits ---------------------------------------------------------------------------- */

static void open_many(small_bodies *b, int threads) {
  open_run(b, &elastic_beam,
           "&simulation end_time = 3e-4 step = 4e-7 threads = %d /\n" BLOCK "&contact /\n"
           "&stamp name = 'ball' shape = 'disc' centre = 0.0853, 0.041 radius = 0.03 mass = 2 "
           "direction = -1, -0.2 velocity = 8 friction = 0.3 damping = 0.1 /\n"
           "&stamp name = 'floor' shape = 'rectangle' corner = -1, -1.006 size = 2.1, 1 "
           "velocity = 0 friction = 0.2 /\n"
           "&stamp name = 'punch' shape = 'rectangle' corner = 0.01, 0.0572 size = 0.03, 0.01 "
           "direction = 0, -1 velocity = '4 m/s' formula = 'sin(t/1e-4 [s])' friction = 0.5 /\n"
           "&monitor name = 'F' kind = 'contact_force' stamp = 'punch' component = 'y' /\n"
           "&monitor name = 'M' kind = 'moment' stamp = 'ball' /\n"
           "&monitor name = 'u' kind = 'displacement' stamp = 'ball' component = 'x' /\n"
           "&monitor name = 'v' kind = 'velocity' stamp = 'ball' component = 'y' "
           "average = 1e-5 /\n"
           "&output frames = 0 sample = 2e-6 /\n",
           threads);
}

static void threads_and_stops_change_no_bit(void **state) {
  (void)state;
  small_bodies one, three, first, second;
  open_many(&one, 1);
  open_many(&three, 3);
  open_many(&first, 2);
  open_many(&second, 1);
  assert_int_equal(small_go(&one.run), STEP_END);
  assert_int_equal(small_go(&three.run), STEP_END);
  hand_over(first.run.simulation, 301, second.run.simulation);
  assert_int_equal(small_go(&second.run), STEP_END);
  assert_true(small_largest(&one.run, "F") > 0 && small_largest(&one.run, "M") > 0);
  assert_true(small_largest(&one.run, "floor/dissipated_damping") > 0);
  same_runs(one.run.simulation, three.run.simulation);
  same_runs(one.run.simulation, second.run.simulation);
  small_bodies_close(&one);
  small_bodies_close(&three);
  small_bodies_close(&first);
  small_bodies_close(&second);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(particles_bounce_on_a_free_stamp),
      cmocka_unit_test(damping_sets_the_restitution),
      cmocka_unit_test(a_stamp_hits_a_block),
      cmocka_unit_test(light_stamps_shorten_the_step),
      cmocka_unit_test(light_stamps_feel_all_that_touch_them),
      cmocka_unit_test(blocks_slide_by_coulombs_law),
      cmocka_unit_test(stamps_go_where_the_deck_says),
      cmocka_unit_test(pressing_does_work),
      cmocka_unit_test(ways_come_evenly_in_an_increment),
      cmocka_unit_test(a_stop_does_not_hide_a_stamp_that_went_too_far),
      cmocka_unit_test(threads_and_stops_change_no_bit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
