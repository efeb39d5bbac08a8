/* Kalthoff and Winkler's plate: the angle of the crack in a deck of examples/kalthoff, as its
   measure.sh has it. */
#ifndef PERILAT_TESTS_CRACK_PATH_H
#define PERILAT_TESTS_CRACK_PATH_H

#include "dsl/base/arena.h"
#include "tests/verification/case.h"

typedef struct middle { /* of a piece of crack; each particle counts by its share of broken bonds */
  double weight, x, y;
} middle;

static inline double *broken_shares(const deck_case *c, const rows *g) {
  const frame_field *fields;
  const int count = simulation_frame_fields(c->simulation, &fields);
  int broken = 0;
  while (broken < count && strcmp(fields[broken].name, "broken") != 0)
    broken++;
  assert_true(broken < count);
  double *shares = must_alloc((size_t)g->particle_count * sizeof *shares);
  simulation_frame_values(c->simulation, broken, shares);
  return shares;
}

/* Degrees to the notch, from the middle of the crack behind its kink to that at the side. */
static inline double angle_of(const deck_case *c) {
  const rows *g = simulation_rows(c->simulation, 0);
  double *shares = broken_shares(c, g);
  middle kink = {0}, side = {0};
  for (long p = 0; p < g->particle_count; p++) {
    const double x = g->x[g->particle_site[p]], y = g->y[g->particle_site[p]];
    const bool behind = x > 0.029 && x < 0.031 && y > -0.01;
    if (shares[p] <= 0.25 || !(behind || x > 0.098)) continue;
    middle *m = behind ? &kink : &side;
    m->weight += shares[p];
    m->x += shares[p] * x;
    m->y += shares[p] * y;
  }
  free(shares);
  assert_true(kink.weight > 0 && side.weight > 0); /* the crack has crossed the plate */
  const double dx = side.x / side.weight - kink.x / kink.weight,
               dy = side.y / side.weight - kink.y / kink.weight;
  return 90 + atan2(dy, dx) * 180 / M_PI;
}

static inline void check_angle(const char *name, const char *const *overrides, int count,
                               double expected) {
  deck_case c;
  assert_true(deck_case_run(&c, name, overrides, count));
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double angle = angle_of(&c);
  deck_case_close(&c);
  if (fabs(angle - expected) > 0.0501) fail_msg("%s, %s: %.2f degrees", name, overrides[0], angle);
}

#endif
