/* Kalthoff and Winkler's plate: the angle of the crack in a deck of examples/kalthoff, as its
   measure.sh has it. */
#ifndef PERILAT_TESTS_CRACK_PATH_H
#define PERILAT_TESTS_CRACK_PATH_H

#include "dsl/base/arena.h"
#include "tests/verification/case.h"
#include "tests/verification/page.h"

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

static inline double angle_in(const char *name, const char *const *overrides, int count) {
  deck_case c;
  assert_true(deck_case_run(&c, name, overrides, count));
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double angle = angle_of(&c);
  deck_case_close(&c);
  return angle;
}

static inline void check_angle(const char *name, const char *const *overrides, int count,
                               double expected) {
  const double angle = angle_in(name, overrides, count);
  if (fabs(angle - expected) > 0.0501) fail_msg("%s, %s: %.2f degrees", name, overrides[0], angle);
}

/* --- with error bars, as angles.sh has them --------------------------------------------------- */

enum { PLATES = 6 };
typedef struct plates {   /* of one kind */
  const char *deck, *row; /* the row of the page */
  const char *key;        /* that is varied: first, first + by, ... */
  int first, by;
  double columns; /* spacings from the notch to a site; < 0: there is no lattice */
} plates;

static const plates all_plates[] = {
    {"examples/kalthoff/hexagon.nml", "| hexagonal, turned by 0,", "rotation", 0, 6, 0.25},
    {"examples/kalthoff/square.nml", "| square, turned by 0,", "rotation", 0, 9, 0.5},
    {"examples/kalthoff/blue_noise.nml", "| blue noise, seeds", "seed", 1, 1, -1}};

static inline double angle_at(const plates *p, int n, double spacing) {
  enum { MOST = 7, ROOM = 64 };
  char text[MOST][ROOM];
  const char *overrides[MOST];
  const double horizon = 3.015 / spacing;
  snprintf(text[0], ROOM, "lattice.%s=%d", p->key, p->first + n * p->by);
  snprintf(text[1], ROOM, "lattice.spacing=%g mm", spacing);
  snprintf(text[2], ROOM, "lattice.horizon=%g", horizon);
  snprintf(text[3], ROOM, "protect[1].radius=%g", horizon);
  snprintf(text[4], ROOM, "protect[2].radius=%g", horizon);
  snprintf(text[5], ROOM, "simulation.step=%g us", 0.1 * spacing);
  snprintf(text[6], ROOM, "lattice.origin=%g mm, %g mm", 25 + p->columns * spacing, spacing / 2);
  for (int k = 0; k < MOST; k++)
    overrides[k] = text[k];
  return angle_in(p->deck, overrides, p->columns < 0 ? MOST - 1 : MOST);
}

/* The page has mean, standard deviation, least and largest of the six. */
static inline void check_plates(const plates *p, double spacing) {
  double sum = 0, squares = 0, least = INFINITY, most = 0;
  char cell[64];
  for (int n = 0; n < PLATES; n++) {
    const double angle = round(10 * angle_at(p, n, spacing)) / 10; /* as measure.sh prints it */
    sum += angle;
    squares += angle * angle;
    least = fmin(least, angle);
    most = fmax(most, angle);
  }
  const double mean = sum / PLATES,
               deviation = sqrt((squares - PLATES * mean * mean) / (PLATES - 1));
  snprintf(cell, sizeof cell, "%.1f° ± %.1f° (%.1f to %.1f)", mean, deviation, least, most);
  print_message("%s, %g mm: %s\n", p->deck, spacing, cell);
  page_line_says("examples/kalthoff/README.md", p->row, cell);
}

#endif
