/* Runs of particles that rotate, with beams by hand, in the plane and in space: loads and monitors
   about each axis against closed forms of one beam, rigid motion, what a spinning body keeps, the
   ledger, frames, and the same bits for any number of threads and after a stop. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <unistd.h>

#include "runtime/interaction/sweep.h"
#include "runtime/simulation/simulation_save.h"
#include "tests/runtime/rigid_motion.h"
#include "tests/runtime/simulation/same_runs.h"

static small_run run_of(const pl_law *law, const char *text) {
  small_run r;
  small_open(&r, law, text);
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  return r;
}

/* --- one beam --------------------------------------------------------------------------------- */

enum { SPACE = 3, PLANE = 2 };
static const double length = 0.01, along = 5e6, across = 1e6, twist = 20; /* m, N/m, N/m, N m */

#define PAIR_IN_SPACE                                                                              \
  "&lattice name = 'c' kind = 'cubic' spacing = 0.01 origin = 0, 0, 0 /\n"                         \
  "&body lattice = 'c' shape = 'box' corner = 0, 0, 0 size = 0.011, 0.001, 0.001 /\n"              \
  "&region name = 'left' shape = 'point' at = 0, 0, 0 /\n"                                         \
  "&region name = 'right' shape = 'point' at = 0.01, 0, 0 /\n"                                     \
  "&support region = 'left' fix = 'xyz', 'rotation' /\n"
#define PAIR_IN_PLANE                                                                              \
  "&lattice name = 'c' kind = 'square' spacing = 0.01 thickness = 0.1 origin = 0, 0 /\n"           \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.011, 0.001 /\n"                  \
  "&region name = 'left' shape = 'point' at = 0, 0 /\n"                                            \
  "&region name = 'right' shape = 'point' at = 0.01, 0 /\n"                                        \
  "&support region = 'left' fix = 'xy', 'rotation' /\n"
#define AT_REST                                                                                    \
  "&simulation end_time = 1 /\n&relaxation increments = 1 tolerance = 1e-10 /\n"                   \
  "&material lattice = 'c' model = 'm' /\n&output frames = 0 /\n"
#define WATCH(name, kind, region, component)                                                       \
  "&monitor name = '" name "' kind = '" kind "' region = '" region "' component = '" component     \
  "' /\n"

/* A moment M at the far end of a beam of EI = k_s s^3/12: it rotates by M s/EI and goes sideways by
   M s^2/(2 EI). A moment along it twists it by M/k_t. The near end holds M. */
static void a_moment_bends_and_twists_a_beam(void **state) {
  (void)state;
  const double M = 1e-3, EI = across * length * length * length / 12;
  static const struct {
    int dimensions;
    const char *axis, *sideways;
    double angle, side; /* over M s/EI, M s^2/(2 EI) */
  } cases[] = {{SPACE, "rotation_x", "y", 0, 0},
               {SPACE, "rotation_y", "z", 1, -1},
               {SPACE, "rotation_z", "y", 1, 1},
               {PLANE, "rotation", "y", 1, 1}};
  for (int k = 0; k < 4; k++) {
    const pl_law law = beams_in(cases[k].dimensions, PL_ROWS);
    char text[2048];
    snprintf(text, sizeof text,
             AT_REST "%s&force region = 'right' component = '%s' moment = %g /\n"
                     "&monitor name = 'angle' kind = 'displacement' region = 'right' component = "
                     "'%s' /\n&monitor name = 'held' kind = 'reaction' region = 'left' component = "
                     "'%s' /\n&monitor name = 'side' kind = 'displacement' region = 'right' "
                     "component = '%s' /\n",
             cases[k].dimensions == SPACE ? PAIR_IN_SPACE : PAIR_IN_PLANE, cases[k].axis, M,
             cases[k].axis, cases[k].axis, cases[k].sideways);
    small_run r = run_of(&law, text);
    assert_int_equal(small_go(&r), STEP_END);
    const double angle = cases[k].angle > 0 ? M * length / EI : M / twist;
    const double side = cases[k].side * M * length * length / (2 * EI);
    assert_true(fabs(small_last(&r, "angle") / angle - 1) < 1e-6);
    assert_true(fabs(small_last(&r, "side") - side) < 1e-6 * angle * length);
    assert_true(fabs(small_last(&r, "held") / -M - 1) < 1e-6);
    assert_string_equal(r.deck->monitors[0].name, "angle");
    small_close(&r);
  }
}

/* A particle with one bond whose far end is held, turning about the axis of the bond: the frequency
   of its twist; about another axis with its place held: that of bending, sqrt(k_s s^2/(3 I)). */
static void a_particle_swings_about_each_axis(void **state) {
  (void)state;
  static const char *const axis[] = {"rotation_x", "rotation_y", "rotation_z"};
  const double mass = 2000 * length * length * length, inertia = 0.1 * mass * length * length;
  for (int k = 0; k < 3; k++) {
    const pl_law law = beams_in(SPACE, PL_ROWS);
    const double stiffness = k == 0 ? twist : across * length * length / 3;
    const double rate = 1, omega = sqrt(stiffness / inertia), end = 2 * acos(-1) * 10.25 / omega;
    char text[2048];
    snprintf(text, sizeof text,
             "&simulation end_time = %.17g step = %.17g /\n"
             "&material lattice = 'c' model = 'm' /\n&output frames = 0 /\n" PAIR_IN_SPACE
             "&support region = 'right' fix = 'xyz' /\n"
             "&initial_velocity region = 'right' component = '%s' value = %g /\n"
             "&monitor name = 'angle' kind = 'displacement' region = 'right' component = '%s' /\n",
             end, end / 8000, axis[k], rate, axis[k]);
    small_run r = run_of(&law, text);
    assert_int_equal(small_go(&r), STEP_END);
    assert_true(fabs(small_last(&r, "angle") * omega / rate - 1) < 1e-4);
    assert_true(small_largest(&r, "energy/imbalance") < 1e-9 * 0.5 * inertia * rate * rate);
    small_close(&r);
  }
}

/* Turned far about z, with a moment about y, held about x: the components of the rotation vector
   are what is prescribed, though turns about one axis move the others. */
static void prescribed_rotations_are_kept(void **state) {
  (void)state;
  const pl_law law = beams_in(SPACE, PL_ROWS);
  small_run r = run_of(
      &law, "&simulation end_time = 1e-2 step = 2e-6 /\n"
            "&material lattice = 'c' model = 'm' /\n&output frames = 0 /\n" PAIR_IN_SPACE
            "&support region = 'right' fix = 'xyz', 'rotation_x' /\n"
            "&drive region = 'right' component = 'rotation_z' displacement = 0.5 rise = 1e-2 /\n"
            "&force region = 'right' component = 'rotation_y' moment = 10 rise = 1e-3 /\n"
            "&damping rate = 1000 /\n" WATCH("x", "displacement", "right", "rotation_x")
                WATCH("y", "displacement", "right", "rotation_y")
                    WATCH("z", "displacement", "right", "rotation_z"));
  assert_int_equal(small_go(&r), STEP_END);
  assert_true(fabs(small_last(&r, "z") - 0.5) < 1e-12);
  assert_true(small_last(&r, "y") > 0.1);
  assert_true(small_largest(&r, "x") == 0);
  small_close(&r);
}

/* --- a body ----------------------------------------------------------------------------------- */

static const char *const bodies[] = {
    "&lattice name = 'c' kind = 'square' spacing = 0.01 thickness = 0.1 rotation = 20 /\n"
    "&body lattice = 'c' shape = 'disc' centre = 0, 0 radius = 0.031 /\n",
    "&lattice name = 'c' kind = 'fcc' shells = 2 spacing = 0.01 rotation = 20 axis = 1, 2, 3 /\n"
    "&body lattice = 'c' shape = 'sphere' centre = 0, 0, 0 radius = 0.021 /\n"};

static small_run free_body(const pl_law *law, double end_time, double safety) {
  char text[1024];
  snprintf(text, sizeof text,
           "&simulation end_time = %g step_safety = %g /\n%s"
           "&material lattice = 'c' model = 'm' /\n&output frames = 0 sample = %g /\n",
           end_time, safety, bodies[law->dimensions - 2], end_time / 20);
  return run_of(law, text);
}

/* Wherever it has turned, a body that moves as a whole feels nothing. */
static void a_rigid_motion_leaves_no_force(void **state) {
  (void)state;
  static const double angles[] = {1e-12, 1e-6, 0.3, 1.5707963267948966, 3.1, 3.15, 14};
  for (int dimensions = PLANE; dimensions <= SPACE; dimensions++) {
    const pl_law law = beams_in(dimensions, PL_ROWS);
    small_run r = free_body(&law, 1e-3, 0.5);
    sweep *w = simulation_state(r.simulation, 0);
    body *b = w->body;
    double worst = 0;
    for (int n = 0; n < 7; n++) {
      rigid_turn(b, angles[n], 0.3);
      sweep_find_forces(w);
      for (int d = 0; d < law.dof; d++)
        for (long p = 0; p < b->lattice->particle_count; p++)
          worst = fmax(worst, fabs(b->force[d][b->lattice->particle_site[p]]) /
                                  (d < dimensions ? 1 : length));
    }
    print_message("%dD: largest force %.1e EA\n", dimensions, worst / (along * length));
    assert_true(worst < 1e-12 * along * length);
    small_close(&r);
  }
}

typedef struct drifts {
  double momenta, energy; /* relative */
  double turned;          /* rad, of the first particle about z */
} drifts;

/* Spins about an oblique axis, flies and breathes. */
static drifts spin(const pl_law *law, double safety) {
  const double rate = 300;
  small_run r = free_body(law, 0.8 * acos(-1) / rate, safety);
  body *b = simulation_state(r.simulation, 0)->body;
  drifts d = {0, 0, 0};
  rigid_spin(b, rate, 0.5, 0.003);
  const momenta before = momenta_of(b);
  while (simulation_advance(r.simulation, 100, NULL) == STEP_OK) {
    const momenta now = momenta_of(b);
    d.momenta = fmax(d.momenta, momenta_apart(&now, &before));
  }
  d.energy = small_largest(&r, "energy/imbalance") / small_largest(&r, "energy/kinetic");
  d.turned = b->displacement[law->dof - 1][b->lattice->particle_site[0]];
  small_close(&r);
  return d;
}

/* Momentum and angular momentum, of ways and of rotations together, stay; energy up to an error of
   the second order in the step. In space that needs particles that turn as quickly as their
   velocities say: were these rates of the rotation vectors, a body that has turned would shake
   itself apart. */
static void a_spinning_body_keeps_its_momenta(void **state) {
  (void)state;
  for (int dimensions = PLANE; dimensions <= SPACE; dimensions++) {
    const pl_law law = beams_in(dimensions, PL_ROWS);
    double energy[2];
    for (int fine = 0; fine < 2; fine++) {
      const drifts d = spin(&law, fine ? 0.25 : 0.5);
      const double whole = 0.8 * acos(-1) * (dimensions == SPACE ? 3 / sqrt(14) : 1);
      print_message("%dD, turned by %.4f about z: momenta %.1e, energy %.1e\n", dimensions,
                    d.turned, d.momenta, d.energy);
      assert_true(fabs(d.turned / whole - 1) < 1e-2);
      assert_true(d.momenta < 1e-12);
      energy[fine] = d.energy;
    }
    assert_true(energy[0] < 1e-3 && energy[0] / energy[1] > 3);
  }
}

/* --- bits ------------------------------------------------------------------------------------- */

static void open_busy(small_run *r, const pl_law *law, int threads, const char *more) {
  char text[2048];
  snprintf(text, sizeof text,
           "&simulation end_time = 2e-4 step_safety = 0.5 threads = %d /\n"
           "&lattice name = 'c' kind = 'fcc' shells = 2 spacing = 0.01 origin = 0, 0, 0 /\n"
           "&material lattice = 'c' model = 'm' tau = 1e-7 /\n"
           "&body lattice = 'c' shape = 'box' corner = 0, 0, 0 size = 0.03, 0.05, 0.06 /\n"
           "&region name = 'foot' shape = 'box' corner = -1, -1, -1 size = 2, 2, 1.001 /\n"
           "&region name = 'top' shape = 'box' corner = -1, -1, 0.054 size = 2, 2, 1 /\n"
           "&region name = 'mid' shape = 'box' corner = -1, -1, 0.02 size = 2, 2, 0.02 /\n"
           "&support region = 'foot' fix = 'xyz', 'rotation' /\n"
           "&drive region = 'top' component = 'rotation_z' velocity = 3 rise = 5e-5 /\n"
           "&force region = 'mid' component = 'rotation_x' moment = 0.5 rise = 5e-5 /\n"
           "&gravity acceleration = 100, 0, -2000 rise = 1.5e-4 /\n"
           "&damping rate = 3000 until = 1.1e-4 /\n" WATCH("held", "reaction", "foot", "rotation_z")
               WATCH("turn", "displacement", "mid", "rotation_x")
                   WATCH("rate", "velocity", "top",
                         "rotation_z") "&output frames = 4 sample = 1e-6 fields = 'rotation', "
                                       "'displacement', 'velocity' /\n%s",
           threads, more);
  *r = run_of(law, text);
}

/* A particle whose rotation vector's z grows by 3 rad/s turns about z at that rate up to
   |r x w|/2 of the other axes. */
static double largest_wobble(const small_run *r) {
  const body *b = simulation_state(r->simulation, 0)->body;
  double most = 0;
  for (long p = 0; p < b->lattice->particle_count; p++) {
    const long q = b->lattice->particle_site[p];
    most = fmax(most, hypot(b->displacement[3][q], b->displacement[4][q]) *
                          hypot(b->velocity[3][q], b->velocity[4][q]));
  }
  return most;
}

static void neither_threads_nor_a_stop_change_bits(void **state) {
  (void)state;
  static const char path[] = "test_rotations.state";
  const pl_law law = beams_in(SPACE, PL_ROWS);
  char error[200];
  small_run one, some;
  open_busy(&one, &law, 1, "");
  assert_int_equal(small_go(&one), STEP_END);
  assert_true(fabs(small_last(&one, "held")) > 0 && fabs(small_last(&one, "turn")) > 1e-9);
  assert_true(fabs(small_last(&one, "rate") - 3) < largest_wobble(&one));
  assert_true(small_largest(&one, "energy/imbalance") <
              1e-3 * small_largest(&one, "energy/external"));
  for (int threads = 2; threads <= 3; threads++) {
    open_busy(&some, &law, threads, "");
    assert_int_equal(small_go(&some), STEP_END);
    same_runs(&one, &some);
    small_close(&some);
  }
  open_busy(&some, &law, 2, "");
  simulation_advance(some.simulation, simulation_step_count(some.simulation) / 3, NULL);
  frame_mark frames = {0, 0};
  assert_true(simulation_save(some.simulation, path, "deck", &frames, error, sizeof error));
  small_close(&some);
  open_busy(&some, &law, 3, "");
  assert_true(simulation_restore(some.simulation, path, "deck", &frames, error, sizeof error));
  assert_int_equal(small_go(&some), STEP_END);
  same_runs(&one, &some);
  small_close(&some);
  small_close(&one);
  unlink(path);
}

static void frames_hold_a_rotation_about_each_axis(void **state) {
  (void)state;
  const pl_law laws[] = {beams_in(PLANE, PL_ROWS), beams_in(SPACE, PL_ROWS)};
  for (int k = 0; k < 2; k++) {
    const frame_field *fields;
    char text[1024];
    snprintf(text, sizeof text,
             "&simulation end_time = 1e-4 /\n%s&material lattice = 'c' model = 'm' /\n"
             "&output frames = 1 fields = 'rotation' /\n",
             bodies[k]);
    small_run r = run_of(&laws[k], text);
    body *b = simulation_state(r.simulation, 0)->body;
    assert_int_equal(simulation_frame_fields(r.simulation, &fields), 2);
    assert_string_equal(fields[1].name, "rotation");
    assert_string_equal(fields[1].unit, "rad");
    assert_int_equal(fields[1].components, k == 0 ? 1 : 3);
    const long count = b->lattice->particle_count, components = fields[1].components;
    double *values = test_calloc((size_t)(count * components), sizeof *values);
    for (long p = 0; p < count; p++)
      for (long c = 0; c < components; c++)
        b->displacement[laws[k].dimensions + c][b->lattice->particle_site[p]] =
            1e-9 * (double)(p + 10 * c);
    simulation_frame_values(r.simulation, 1, values);
    for (long n = 0; n < count * components; n++)
      assert_true(values[n] == 1e-9 * (double)(n / components + 10 * (n % components)));
    test_free(values);
    small_close(&r);
  }
}

/* --- particles of unlike size ----------------------------------------------------------------- */

/* Each turns as a ball of its own size: of volume V in the plane, where a mean one has V0 and half
   a spacing r, with 2/5 m r^2 V/V0. */
static void particles_of_unlike_size_have_their_own_inertia(void **state) {
  (void)state;
  const pl_law law = beams_in(PLANE, PL_LIST);
  small_run r = run_of(
      &law, "&simulation end_time = 1e-5 step = 1e-7 /\n"
            "&lattice name = 'c' kind = 'blue_noise' spacing = 0.01 thickness = 0.1 seed = 3 /\n"
            "&material lattice = 'c' model = 'm' /\n&output frames = 0 /\n"
            "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.1, 0.1 /\n");
  body *b = simulation_state(r.simulation, 0)->body;
  const rows *g = b->lattice;
  double lightest = INFINITY, heaviest = 0;
  for (long p = 0; p < g->particle_count; p++) {
    const long q = g->particle_site[p];
    const double mass = body_mass(b, 0, q), size = g->site_volume[q] / g->volume;
    const double inertia = 0.4 * mass * 0.25 * length * length * size;
    assert_true(fabs(mass / (2000 * g->site_volume[q]) - 1) < 1e-14);
    assert_true(fabs(body_mass(b, 2, q) / inertia - 1) < 1e-12);
    lightest = fmin(lightest, mass);
    heaviest = fmax(heaviest, mass);
    b->displacement[2][q] = 1e-6;
  }
  assert_true(heaviest > 1.1 * lightest);
  sweep_find_forces(simulation_state(r.simulation, 0));
  double expected[5];
  for (long p = 0; p < 5; p++) {
    const long q = g->particle_site[p];
    expected[p] = b->time_step * b->force[2][q] / body_mass(b, 2, q);
  }
  simulation_advance(r.simulation, 1, NULL);
  for (long p = 0; p < 5; p++) {
    const double got = b->velocity[2][g->particle_site[p]];
    assert_true(expected[p] != 0 &&
                fabs(got / expected[p] - 1) < 0.51); /* the first kick is half */
  }
  small_close(&r);
}

/* --- what does not go ------------------------------------------------------------------------- */

static void laws_without_rotations_say_so(void **state) {
  (void)state;
  static const char *const uses[] = {
      "&support region = 'right' fix = 'rotation' /\n",
      "&support region = 'right' fix = 'rotation_y' /\n",
      "&drive region = 'right' component = 'rotation_x' velocity = 1 /\n",
      "&force region = 'right' component = 'rotation_z' moment = 1 /\n",
      "&initial_velocity region = 'right' component = 'rotation_z' value = 1 /\n",
      "&monitor name = 'm' kind = 'velocity' region = 'right' component = 'rotation_z' /\n"};
  pl_law law = beams_in(SPACE, PL_ROWS);
  law.dof = 3;
  law.name = "bars";
  for (int k = 0; k < 6; k++) {
    char text[2048];
    small_run r;
    snprintf(text, sizeof text,
             "&simulation end_time = 1e-4 /\n&material lattice = 'c' model = 'm' /\n"
             "&lattice name = 'c' kind = 'cubic' spacing = 0.01 /\n"
             "&body lattice = 'c' shape = 'box' corner = 0, 0, 0 size = 0.02, 0.02, 0.02 /\n"
             "&region name = 'right' shape = 'point' at = 0.01, 0, 0 /\n%s",
             uses[k]);
    small_open(&r, &law, text);
    assert_null(r.simulation);
    assert_non_null(
        strstr(r.said.items[0].message, "the particles of the law `bars` do not rotate"));
    small_close(&r);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_moment_bends_and_twists_a_beam),
      cmocka_unit_test(a_particle_swings_about_each_axis),
      cmocka_unit_test(prescribed_rotations_are_kept),
      cmocka_unit_test(a_rigid_motion_leaves_no_force),
      cmocka_unit_test(a_spinning_body_keeps_its_momenta),
      cmocka_unit_test(neither_threads_nor_a_stop_change_bits),
      cmocka_unit_test(frames_hold_a_rotation_about_each_axis),
      cmocka_unit_test(particles_of_unlike_size_have_their_own_inertia),
      cmocka_unit_test(laws_without_rotations_say_so),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
