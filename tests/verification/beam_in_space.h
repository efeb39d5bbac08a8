/* The beam of examples/reinforced_concrete/beam_in_space.nml: what it carries when its lower bars
   yield, beside the code's strength, and what the page says of it. */
#ifndef PERILAT_TESTS_BEAM_IN_SPACE_H
#define PERILAT_TESTS_BEAM_IN_SPACE_H

#include "tests/verification/held_load.h"

#define BEAM_IN_SPACE FOLDER "beam_in_space.nml"
/* 20 mm from layer to layer. */
#define COARSE "lattice.spacing=28.2842712 mm", "lattice.origin=-590 mm, 10 mm, -50 mm"

static const double steel_area = 2 * 63.3348e-6; /* m^2: of both lower bars */

static inline double mean_since(const deck_case *c, const char *series, double from) {
  const double *time, *values = deck_case_series(c, series);
  const long samples = simulation_history(c->simulation, &time);
  double sum = 0;
  long count = 0;
  for (long k = 0; k < samples; k++) {
    if (time[k] < from) continue;
    sum += values[k];
    count++;
  }
  return sum / (double)count;
}

/* A_s F_y (d - a/2), a = A_s F_y/(0.85 f_c b), over the way from the feet to the loads: ACI 318. */
static inline double code_strength(void) {
  const double force = steel_area * 414e6, a = force / (0.85 * 27.58e6 * 0.12);
  return 2 * force * (0.24 - a / 2) / 0.28;
}

/* Bonds whose field is not 0, of an interaction of the deck. */
static inline long touched(const deck_case *c, int interaction, const char *field) {
  const sweep *w = simulation_law_state(c->simulation, interaction);
  long count = 0;
  int f = 0;
  while (strcmp(w->law->fields[f].name, field) != 0)
    assert_true(++f < w->law->field_count);
  for (int k = 0; k < w->lattice->directions; k++)
    for (long p = 0; p < w->lattice->particle_count; p++)
      count += w->field[f][k * w->lattice->size + w->lattice->particle_site[p]] != 0;
  print_message("%s: %ld bonds\n", field, count);
  return count;
}

/* From 15 ms on, while the lower bars yield; the line of the page that begins so says it. */
static inline void carries_what_steel_bears(const deck_case *c, const char *row) {
  const double load = mean_since(c, "load", 15e-3), code = code_strength();
  char figure[64];
  print_message("load %.6g N, of the code %.6g N\n", load, code);
  assert_true(fabs(load / code - 1) < 0.05);
  assert_true(touched(c, 1, "S_p") > 0);
  snprintf(figure, sizeof figure, "| %.1f kN |", load / 1e3);
  page_says(row, figure);
}

#endif
