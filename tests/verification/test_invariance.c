/* What must not depend on where a body is, how it is turned, or how it moves as a whole: momentum,
   angular momentum, energy, rigid motions of any size, mirror symmetry. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/sweep.h"
#include "tests/runtime/small_run.h"

static void open_patch(small_run *r, const pl_law *law, double rotation, double step_safety) {
  char text[1024];
  snprintf(text, sizeof text,
           "&simulation end_time = 1 step_safety = %g threads = 2 /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = %g /\n"
           "&material lattice = 'c' model = 'm' /\n"
           "&body lattice = 'c' shape = 'disc' centre = 0.02, 0.03 radius = 0.06 /\n"
           "&output frames = 0 sample = 1 energy = .false. fields = 'force' /\n",
           step_safety, rotation);
  small_open(r, law, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

typedef struct totals {
  double mass, momentum[2], angular, kinetic;
} totals;

static totals totals_of(const sweep *w) {
  totals t = {0};
  for (long p = 0; p < w->body->lattice->particle_count; p++) {
    const long q = w->body->lattice->particle_site[p];
    const double x = w->body->lattice->x[q] + w->body->displacement[0][q],
                 y = w->body->lattice->y[q] + w->body->displacement[1][q];
    const double vx = w->body->velocity[0][q], vy = w->body->velocity[1][q];
    t.mass += w->body->mass[0];
    t.momentum[0] += w->body->mass[0] * vx;
    t.momentum[1] += w->body->mass[0] * vy;
    t.angular += w->body->mass[0] * (x * vy - y * vx);
    t.kinetic += 0.5 * w->body->mass[0] * (vx * vx + vy * vy);
    if (w->body->dof < 3) continue;
    t.angular += w->body->mass[2] * w->body->velocity[2][q];
    t.kinetic += 0.5 * w->body->mass[2] * w->body->velocity[2][q] * w->body->velocity[2][q];
  }
  return t;
}

static double axial_rigidity(void) {
  return 30e9 * 0.01 * 0.1 / (sqrt(3) * 0.8);
}

/* Forces that a rigid motion leaves, over EA: rounding only, for any angle. */
static void a_rigid_motion_costs_nothing(void **state) {
  (void)state;
  const double angles[] = {1e-9, 0.3, 3.1, 14, -40};
  for (int k = 0; k < 5; k++) {
    small_run r;
    open_patch(&r, &elastic_beam, 17, 0.5);
    sweep *w = simulation_state(r.simulation, 0);
    const double c = cos(angles[k]), s = sin(angles[k]);
    for (long p = 0; p < w->body->lattice->particle_count; p++) {
      const long q = w->body->lattice->particle_site[p];
      const double x = w->body->lattice->x[q], y = w->body->lattice->y[q];
      w->body->displacement[0][q] = c * x - s * y - x + 0.7;
      w->body->displacement[1][q] = s * x + c * y - y - 0.2;
      w->body->displacement[2][q] = angles[k];
    }
    double largest = 0;
    sweep_observe(w);
    for (long p = 0; p < w->body->lattice->particle_count; p++)
      for (int d = 0; d < 3; d++)
        largest = fmax(largest, fabs(w->body->force[d][w->body->lattice->particle_site[p]]) /
                                    (d < 2 ? 1 : 0.01));
    print_message("rigid rotation %g: forces %.1e of EA\n", angles[k], largest / axial_rigidity());
    /* positions of size 1 m carry roundings of 1e-16 m, that is 1e-14 of a spacing */
    assert_true(largest < 3e-13 * axial_rigidity());
    small_close(&r);
  }
}

static void a_translation_stays_a_translation(void **state) {
  (void)state;
  small_run r;
  open_patch(&r, &elastic_beam, 17, 0.5);
  sweep *w = simulation_state(r.simulation, 0);
  for (long p = 0; p < w->body->lattice->particle_count; p++) {
    w->body->velocity[0][w->body->lattice->particle_site[p]] = 3;
    w->body->velocity[1][w->body->lattice->particle_site[p]] = -1.7;
  }
  simulation_advance(r.simulation, 500, NULL);
  for (long p = 0; p < w->body->lattice->particle_count; p++) {
    const long q = w->body->lattice->particle_site[p];
    assert_true(w->body->velocity[0][q] == 3 && w->body->velocity[1][q] == -1.7 &&
                w->body->velocity[2][q] == 0);
    assert_true(fabs(w->body->displacement[0][q] - 3 * simulation_time(r.simulation)) < 1e-12);
  }
  small_close(&r);
}

/* A free patch set spinning at once: it widens and breathes; momentum and angular momentum stay to
   rounding over more than a turn, and every particle turns with the patch. */
static void a_spinning_patch_keeps_its_angular_momentum(void **state) {
  (void)state;
  const pl_law *laws[] = {&elastic_beam, &elastic_bar};
  for (int k = 0; k < 2; k++) {
    small_run r;
    open_patch(&r, laws[k], 17, 0.5);
    sweep *w = simulation_state(r.simulation, 0);
    const double spin = 500; /* rad/s: 30 m/s at the rim, a stretch of 4e-5 */
    for (long p = 0; p < w->body->lattice->particle_count; p++) {
      const long q = w->body->lattice->particle_site[p];
      w->body->velocity[0][q] = -spin * (w->body->lattice->y[q] - 0.03);
      w->body->velocity[1][q] = spin * (w->body->lattice->x[q] - 0.02);
      if (w->body->dof > 2) w->body->velocity[2][q] = spin;
    }
    const totals before = totals_of(w);
    double drift = 0, energy = 0;
    const long steps = lround(7 / spin / w->body->time_step);
    for (int part = 0; part < 20; part++) {
      simulation_advance(r.simulation, steps / 20, NULL);
      const totals now = totals_of(w);
      drift = fmax(drift, fabs(now.angular / before.angular - 1));
      energy = fmax(energy, fabs(now.kinetic / before.kinetic - 1));
      for (int d = 0; d < 2; d++)
        assert_true(fabs(now.momentum[d] - before.momentum[d]) < 1e-12 * before.mass * 0.06 * spin);
    }
    print_message("spin, %s: %ld steps, angular momentum %.1e, kinetic energy %.1e\n",
                  laws[k]->name, steps, drift, energy);
    assert_true(drift < 1e-11);
    assert_true(energy < 1e-3);
    if (w->body->dof >
        2) { /* seven radians and a little less: the widened patch turns more slowly */
      const double turn =
          w->body->displacement[2][w->body->lattice
                                       ->particle_site[w->body->lattice->particle_count / 2]];
      assert_true(fabs(turn / (spin * simulation_time(r.simulation)) - 1) < 1e-3);
    }
    small_close(&r);
  }
}

/* Random velocities: total momenta to rounding; energy bounded and better with a smaller step. */
static double shaken_energy_error(double step_safety) {
  char text[1024];
  snprintf(text, sizeof text,
           "&simulation end_time = 2e-4 step_safety = %g /\n"
           "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = 5 /\n"
           "&material lattice = 'c' model = 'm' /\n"
           "&body lattice = 'c' shape = 'disc' centre = 0, 0 radius = 0.06 /\n"
           "&output frames = 0 sample = 1e-6 /\n",
           step_safety);
  small_run r;
  small_open(&r, &elastic_beam, text);
  assert_non_null(r.simulation);
  sweep *w = simulation_state(r.simulation, 0);
  uint64_t seed = 5;
  for (long p = 0; p < w->body->lattice->particle_count; p++)
    for (int d = 0; d < 3; d++) {
      seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
      w->body->velocity[d][w->body->lattice->particle_site[p]] =
          ((double)(seed >> 40) / (1 << 23) - 1) * (d < 2 ? 1 : 100);
    }
  const totals before = totals_of(w);
  assert_int_equal(small_go(&r), STEP_END);
  const totals after = totals_of(w);
  for (int d = 0; d < 2; d++)
    assert_true(fabs(after.momentum[d] - before.momentum[d]) < 1e-12 * before.mass);
  assert_true(fabs(after.angular - before.angular) < 1e-12 * before.mass * 0.06);
  const double *imbalance, *kinetic;
  double error = 0;
  simulation_series(r.simulation, small_series(&r, "energy/imbalance"), NULL, &imbalance);
  simulation_series(r.simulation, small_series(&r, "energy/kinetic"), NULL, &kinetic);
  for (long k = 0; k < simulation_history(r.simulation, NULL); k++)
    error = fmax(error, fabs(imbalance[k]));
  const double relative = error / kinetic[0];
  small_close(&r);
  return relative;
}

static void a_shaken_patch_keeps_its_momenta_and_energy(void **state) {
  (void)state;
  const double coarse = shaken_energy_error(0.8), fine = shaken_energy_error(0.4);
  print_message("shaken patch: energy to %.1e and %.1e at 0.8 and 0.4 of the limit\n", coarse,
                fine);
  /* linear springs conserve the sampled energy exactly: what remains is geometry */
  assert_true(coarse < 1e-3 && fine < coarse / 3);
}

/* A symmetric body under a symmetric load: left and right are images to rounding. */
static void mirror_images_stay_mirror_images(void **state) {
  (void)state;
  static const char text[] =
      "&simulation end_time = 2e-4 step_safety = 0.5 threads = 3 /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
      "&material lattice = 'c' model = 'm' S_t = 1e-4 /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = -0.1, 0 size = 0.2, 0.0606 /\n"
      "&region name = 'left' shape = 'point' at = -0.1, 0 /\n"
      "&region name = 'right' shape = 'point' at = 0.1, 0 /\n"
      "&region name = 'top' shape = 'point' at = 0, 0.051961524 /\n"
      "&support region = 'left' fix = 'y' /\n&support region = 'right' fix = 'y' /\n"
      "&drive region = 'top' component = 'y' velocity = -0.3 rise = 2e-5 /\n"
      "&support region = 'top' fix = 'x' /\n"
      "&monitor name = 'cracks' kind = 'damaged' /\n&output frames = 0 /\n";
  small_run r;
  small_open(&r, &elastic_beam, text);
  if (!r.simulation) small_print(&r);
  assert_non_null(r.simulation);
  assert_int_equal(small_go(&r), STEP_END);
  assert_true(small_last(&r, "cracks") > 0);
  const sweep *w = simulation_state(r.simulation, 0);
  const rows *g = w->body->lattice;
  double difference = 0, largest = 0;
  long pairs = 0;
  for (long p = 0; p < g->particle_count; p++)
    for (long m = 0; m < g->particle_count; m++) {
      const long a = g->particle_site[p], b = g->particle_site[m];
      if (fabs(g->x[a] + g->x[b]) > 1e-9 || fabs(g->y[a] - g->y[b]) > 1e-9) continue;
      pairs++;
      largest = fmax(largest, fabs(w->body->displacement[1][a]));
      difference =
          fmax(difference, fabs(w->body->displacement[0][a] + w->body->displacement[0][b]));
      difference =
          fmax(difference, fabs(w->body->displacement[1][a] - w->body->displacement[1][b]));
      difference =
          fmax(difference, 0.01 * fabs(w->body->displacement[2][a] + w->body->displacement[2][b]));
    }
  print_message("mirror: %.1e of the displacement, %g bonds damaged\n", difference / largest,
                small_last(&r, "cracks"));
  assert_int_equal(pairs, g->particle_count);
  assert_true(difference < 1e-8 * largest);
  small_close(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_rigid_motion_costs_nothing),
      cmocka_unit_test(a_translation_stays_a_translation),
      cmocka_unit_test(a_spinning_patch_keeps_its_angular_momentum),
      cmocka_unit_test(a_shaken_patch_keeps_its_momenta_and_energy),
      cmocka_unit_test(mirror_images_stay_mirror_images),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
