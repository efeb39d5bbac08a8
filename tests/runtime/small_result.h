/* A small result for tests: three particles, two bonds between them, a field of each. */
#ifndef PERILAT_TESTS_SMALL_RESULT_H
#define PERILAT_TESTS_SMALL_RESULT_H

#include "runtime/result/result.h"

enum { PARTICLES = 3, BONDS = 2, SAMPLES = 5 };

static const double small_reference[2 * PARTICLES] = {0, 0, 1, 0, 0.5, 0.75};
static const result_field small_fields[] = {
    {"displacement", "m", NULL, 2, PARTICLES, "other", NULL},
    {"omega", "1", "concrete", 1, BONDS, "damage", NULL}};

static inline result_header small_header(const char *path) {
  static const double volume[PARTICLES] = {1, 2, 3};
  static const int32_t body_of[PARTICLES] = {0, 0, 1}, pairs[2 * BONDS] = {0, 1, 1, 2};
  static const result_bonds bonds = {"concrete", BONDS, pairs};
  return (result_header){.path = path,
                         .fingerprint = "small",
                         .title = "three particles",
                         .started = "now",
                         .version = "0",
                         .kernel_key = "k",
                         .deck_text = "&simulation /",
                         .particle_count = PARTICLES,
                         .dimensions = 2,
                         .reference = small_reference,
                         .body = body_of,
                         .volume = volume,
                         .bonds = &bonds,
                         .interaction_count = 1,
                         .fields = small_fields,
                         .field_count = 2};
}

/* A new result, without frames yet; NULL with a sentence. */
static inline result *small_begin(const result_header *h, char *error, size_t size) {
  result *r = result_open(h, false, error, size);
  if (!r || result_begin(r, error, size)) return r;
  result_close(r);
  return NULL;
}

/* Ends it after 42 steps. */
static inline bool small_finish(result *r, const double *time, long samples,
                                const result_series *series, int series_count, char *error,
                                size_t size) {
  const result_ending e = {.ended = "end of the run",
                           .dt = 1e-3,
                           .steps = 42,
                           .time = time,
                           .history_count = samples,
                           .series = series,
                           .series_count = series_count};
  return result_finish(r, &e, error, size);
}

/* Values of frame k: displacement k + p/10 + c/100, damage k/4 + b/8. */
static inline void small_frame(int k, double u[2 * PARTICLES], double omega[BONDS]) {
  for (int q = 0; q < 2 * PARTICLES; q++)
    u[q] = k + 0.1 * (q / 2) + 0.01 * (q % 2);
  for (int b = 0; b < BONDS; b++)
    omega[b] = 0.25 * k + 0.125 * b;
}

#endif
