/* Specimens of examples/ between two ends, of the state-based lattice: the peak of the load, what
   the two ends carry, and how much the left half differs from the image of the right. To be
   included after cmocka.h. */
#ifndef PERILAT_TESTS_SPECIMEN_H
#define PERILAT_TESTS_SPECIMEN_H

#include "tests/verification/case.h"

typedef struct outcome {
  double peak, time; /* N, s */
  double ends;       /* largest difference of the two ends' loads up to the peak, over the peak */
  double asymmetry;  /* of w_t and of the displacements (over the largest), in the whole run */
  double damage;     /* largest w_t at the end */
  double external;   /* J: work of the ends */
  double lost;       /* J: what damage and the dampers in the bonds took of it */
} outcome;

static inline const double *specimen_field(const sweep *w, const char *name) {
  for (int k = 0; k < w->law->field_count; k++)
    if (strcmp(w->law->fields[k].name, name) == 0) return w->field[k];
  fprintf(stderr, "no field %s\n", name);
  abort();
}

/* For each particle the site of its image in the line x = 0; NULL when one has none. To be freed.
   */
static inline long *specimen_images(const rows *g) {
  long *image = calloc((size_t)g->particle_count, sizeof *image), found = 0;
  for (long p = 0; p < g->particle_count; p++) {
    const long a = g->particle_site[p];
    for (long q = 0; q < g->particle_count; q++) {
      const long b = g->particle_site[q];
      if (fabs(g->x[a] + g->x[b]) > 1e-6 * g->spacing) continue;
      if (fabs(g->y[a] - g->y[b]) > 1e-6 * g->spacing) continue;
      image[p] = b;
      found++;
    }
  }
  if (found == g->particle_count) return image;
  free(image);
  return NULL;
}

static inline double specimen_asymmetry(const sweep *w, const long *image) {
  const rows *g = w->body->lattice;
  const double *ux = w->body->displacement[0], *uy = w->body->displacement[1],
               *w_t = specimen_field(w, "w_t");
  double moved = 0, difference = 0, damage = 0;
  for (long p = 0; p < g->particle_count; p++) {
    const long a = g->particle_site[p], b = image[p];
    moved = fmax(moved, hypot(ux[a], uy[a]));
    difference = fmax(difference, fmax(fabs(ux[a] + ux[b]), fabs(uy[a] - uy[b])));
    damage = fmax(damage, fabs(w_t[a] - w_t[b]));
  }
  return fmax(difference / moved, damage);
}

static inline double specimen_damage(const sweep *w) {
  double most = 0;
  for (long p = 0; p < w->body->lattice->particle_count; p++)
    most = fmax(most, specimen_field(w, "w_t")[w->body->lattice->particle_site[p]]);
  return most;
}

/* Largest difference of the monitors `top` and `bottom` up to a sample. */
static inline double specimen_ends(const deck_case *c, long until) {
  const double *top = deck_case_series(c, "top"), *bottom = deck_case_series(c, "bottom");
  double difference = 0;
  for (long k = 0; k <= until; k++)
    difference = fmax(difference, fabs(top[k] - bottom[k]));
  return difference;
}

/* A deck of examples/ until `end_time` (as in a deck; NULL: its own end), with `count` more
   overrides;
   the peak must have been passed by then. The asymmetry is looked at every 500 steps, and not a
   number where particles have no image. */
static inline outcome specimen_run_with(const char *deck_name, const char *end_time,
                                        const char *const *more, int more_count) {
  enum { MOST = 8 };
  char until[64];
  const char *overrides[MOST + 2] = {"simulation.threads=1"};
  int count = 1;
  snprintf(until, sizeof until, "simulation.end_time=%s", end_time ? end_time : "");
  if (end_time) overrides[count++] = until;
  for (int k = 0; k < more_count && k < MOST; k++)
    overrides[count++] = more[k];
  deck_case c;
  assert_true(deck_case_run(&c, deck_name, overrides, count));
  const sweep *w = simulation_state(c.simulation, 0);
  long *image = specimen_images(w->body->lattice);
  outcome o = {.asymmetry = image ? 0 : NAN};
  step_status status = STEP_OK;
  while (status == STEP_OK) {
    status = simulation_advance(c.simulation, 500, NULL);
    if (image) o.asymmetry = fmax(o.asymmetry, specimen_asymmetry(w, image));
  }
  const double *time, *load = deck_case_series(&c, "load");
  const long samples = simulation_history(c.simulation, &time), at = largest_of(load, samples);
  assert_int_equal(status, STEP_END);
  assert_true(at < samples - 10);
  o.peak = load[at];
  o.time = time[at];
  o.ends = specimen_ends(&c, at) / o.peak;
  o.damage = specimen_damage(w);
  o.external = deck_case_series(&c, "energy/external")[samples - 1];
  o.lost = deck_case_series(&c, "energy/dissipated_damage")[samples - 1];
  free(image);
  deck_case_close(&c);
  return o;
}

/* With one more override or NULL. */
static inline outcome specimen_run(const char *deck_name, const char *end_time, const char *more) {
  return specimen_run_with(deck_name, end_time, &more, more ? 1 : 0);
}

#endif
