/* Particles on a stamp against all particles asked one by one: while they and the stamp wander
   about, come and go, forces, what is stored and what slips are the same. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dsl/base/arena.h"
#include "runtime/base/random_number.h"
#include "runtime/interaction/stamp.h"
#include "runtime/interaction/sweep.h"
#include "tests/runtime/small_bodies.h"

enum { BODIES = 2, STEPS = 120 };
static const double k_of[BODIES] = {3e8, 2e8}, friction = 0.4, damping = 0.2, step = 1e-6;

#define OF_BODY(name, kind, corner)                                                                \
  "&lattice name = '" name "' kind = " kind " thickness = 0.1 /\n"                                 \
  "&material lattice = '" name "' model = 'm' /\n"                                                 \
  "&body lattice = '" name "' shape = 'rectangle' corner = " corner " size = 0.1, 0.08 /\n"
static const char two_bodies[] = "&simulation end_time = 1e-5 step = 1e-7 /\n" OF_BODY(
    "a", "'hexagonal' spacing = 0.01", "0, 0")
    OF_BODY("b", "'hexagonal' spacing = 0.012 rotation = 20", "0.13, 0") "&output frames = 0 /\n";
static const deck_shape disc = {.kind = SHAPE_DISC, .centre = {0.115, 0.112}, .radius = 0.025};

typedef struct wanderers {
  small_bodies all;
  body *of[BODIES];
  double *dragged[BODIES]; /* [size][2] as it should be */
  stamp_motion at;
  stamp_load expected;
} wanderers;

static void open_wanderers(wanderers *w) {
  memset(w, 0, sizeof *w);
  small_bodies_open(&w->all, &elastic_bar, two_bodies);
  for (int b = 0; b < BODIES; b++) {
    w->of[b] = simulation_state(w->all.run.simulation, b)->body;
    body_add_outer(w->of[b]);
    w->dragged[b] = must_calloc(2 * (size_t)w->of[b]->lattice->size, sizeof(double));
  }
}

static void close_wanderers(wanderers *w) {
  for (int b = 0; b < BODIES; b++)
    free(w->dragged[b]);
  small_bodies_close(&w->all);
}

/* Within -1 and 1. */
static double random_at(uint64_t a, uint64_t b) {
  return 2 * random_unit(random_mix(random_mix(a) + b)) - 1;
}

/* The stamp sinks in slowly and swings; particles tremble. */
static void wander(wanderers *w, int n) {
  const double way[2] = {1e-3 * sin(0.2 * n), n < STEPS / 2 ? -8e-4 : 1e-3};
  for (int d = 0; d < 2; d++) {
    w->at.place[d] += way[d];
    w->at.velocity[d] = way[d] / step;
  }
  for (int b = 0; b < BODIES; b++)
    for (long p = 0; p < w->of[b]->lattice->particle_count; p++) {
      const long q = w->of[b]->lattice->particle_site[p];
      for (int d = 0; d < 2; d++) {
        const double here = 2e-4 * random_at((uint64_t)(2 * n + d), (uint64_t)(1000 * b + p));
        w->of[b]->velocity[d][q] = here / step;
        w->of[b]->displacement[d][q] += here;
      }
    }
}

/* The force on a particle by stamp.h, in polar words. */
static void force_on(wanderers *w, int b, long q, double force[2]) {
  const body *of = w->of[b];
  const double x = of->lattice->x[q] + of->displacement[0][q] - w->at.place[0] - disc.centre[0],
               y = of->lattice->y[q] + of->displacement[1][q] - w->at.place[1] - disc.centre[1];
  const double r = hypot(x, y), n[2] = {x / r, y / r}, t[2] = {-y / r, x / r},
               depth = disc.radius + 0.5 * of->lattice->spacing - r, k = k_of[b];
  const double v[2] = {of->velocity[0][q] - w->at.velocity[0],
                       of->velocity[1][q] - w->at.velocity[1]};
  const double across = v[0] * n[0] + v[1] * n[1], along = v[0] * t[0] + v[1] * t[1];
  double *drag = w->dragged[b] + 2 * q, was = drag[0] * t[0] + drag[1] * t[1];
  double pressed = k * depth - 2 * damping * sqrt(k * body_mass(of, 0, q)) * across;
  pressed = depth > 0 ? fmax(pressed, 0) : 0;
  double now = was + step * along;
  const double most = friction * pressed / k, slip = now - fmax(-most, fmin(most, now));
  if (was != 0 || depth > 0) w->expected.slipped += 0.5 * k * (was + now - slip) * slip;
  now = was != 0 || depth > 0 ? now - slip : 0;
  for (int d = 0; d < 2; d++) {
    drag[d] = now * t[d];
    force[d] = depth > 0 ? pressed * n[d] - k * drag[d] : 0;
    w->expected.force[d] -= force[d];
  }
  w->expected.moment[2] -= disc.radius * (n[0] * force[1] - n[1] * force[0]);
  if (depth > 0) w->expected.stored += 0.5 * k * (depth * depth + now * now);
  w->expected.touching += depth > 0;
}

static void near(double found, double expected, double size) {
  if (!(fabs(found - expected) <= 1e-11 * size)) fail_msg("%.17g, not %.17g", found, expected);
}

static void compare(wanderers *w, const stamp_load *l) {
  const double size = k_of[0] * 0.01;
  w->expected = (stamp_load){.touching = 0};
  for (int b = 0; b < BODIES; b++)
    for (long p = 0; p < w->of[b]->lattice->particle_count; p++) {
      const long q = w->of[b]->lattice->particle_site[p];
      double force[2];
      force_on(w, b, q, force);
      for (int d = 0; d < 2; d++)
        near(body_outer(w->of[b], d, q), force[d], size);
    }
  for (int d = 0; d < 2; d++)
    near(l->force[d], w->expected.force[d], size);
  /* the place of contact is on the stamp's surface */
  near(l->moment[2], w->expected.moment[2], size * 0.01);
  near(l->stored, w->expected.stored, size * 0.01);
  near(l->slipped, w->expected.slipped, size * 0.01);
  assert_int_equal(l->touching, w->expected.touching);
}

static void the_list_misses_none(void **state) {
  (void)state;
  wanderers w;
  surface of;
  open_wanderers(&w);
  assert_true(surface_open(&disc, &of));
  const stamp_body bodies[BODIES] = {{w.of[0], k_of[0], false}, {w.of[1], k_of[1], false}};
  stamp *s = stamp_new(&of, bodies, BODIES, friction, damping);
  assert_true(stamp_look_inside(s, w.at.place, 0).count == 0);
  long most = 0;
  double slipped = 0;
  for (int n = 0; n < STEPS; n++) {
    wander(&w, n);
    for (int b = 0; b < BODIES; b++)
      body_clear_outer(w.of[b]);
    const stamp_load l = stamp_find(s, &w.at, step);
    compare(&w, &l);
    most = l.touching > most ? l.touching : most;
    slipped += l.slipped;
  }
  const stamp_inside in = stamp_look_inside(s, w.at.place, 0);
  print_message("at most %ld particles in touch, %.3g J slipped; %ld left\n", most, slipped,
                in.count);
  assert_true(most > 8 && slipped > 0 && in.count == 0 && in.depth < 0);
  stamp_free(s);
  close_wanderers(&w);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_list_misses_none)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
