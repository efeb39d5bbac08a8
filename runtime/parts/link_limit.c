#include "runtime/parts/link_limit.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/analysis/stability.h"

typedef struct rates {    /* of the fastest mode */
  double square, damping; /* omega^2 (1/s^2), c (1/s): the step is 2/p with p^2 = omega^2 + p c */
} rates;

static rates rates_of(const step_limit *l) {
  if (isinf(l->limit)) return (rates){0, 0}; /* nothing holds */
  const double p = 2 / l->limit, square = pl_fmin(l->omega_max * l->omega_max, p * p);
  return (rates){square, (p * p - square) / p};
}

static double fastest_of(rates r) {
  return 0.5 * (r.damping + sqrt(r.damping * r.damping + 4 * r.square));
}

static bool is_faster(rates a, rates b) {
  return fastest_of(a) > fastest_of(b);
}

/* The bodies' particles, counted through. */
static long *first_particles(const run_body *bodies, int count) {
  long *first = must_calloc((size_t)count + 1, sizeof *first);
  for (int b = 0; b < count; b++)
    first[b + 1] = first[b] + bodies[b].lattice_rows->particle_count;
  return first;
}

static bool some_are_taken(const rows *g, const long *first, const unsigned char *taken) {
  for (long p = 0; p < g->particle_count; p++)
    for (int k = 0; k < g->copies[p].count; k++)
      if (taken[first[g->copies[p].lattice] + g->copies[p].particle[k]]) return true;
  return false;
}

static void take_all(const rows *g, const long *first, unsigned char *taken) {
  for (long p = 0; p < g->particle_count; p++)
    for (int k = 0; k < g->copies[p].count; k++)
      taken[first[g->copies[p].lattice] + g->copies[p].particle[k]] = 1;
}

/* Links are dealt out to groups in which no two share a particle: the first group that has none of
   a link's particles takes it. taken[group][particle]. Returns the sum over the groups of the
   fastest of each. */
static rates sum_of_links(const run_body *bodies, int count) {
  long *first = first_particles(bodies, count);
  unsigned char **taken = must_calloc((size_t)count + 1, sizeof *taken);
  rates *group = must_calloc((size_t)count + 1, sizeof *group), sum = {0, 0};
  int groups = 0;
  for (int b = 0; b < count; b++) {
    const rows *g = bodies[b].lattice_rows;
    if (!g->copies) continue;
    int k = 0;
    while (k < groups && some_are_taken(g, first, taken[k]))
      k++;
    if (k == groups) taken[groups++] = must_calloc((size_t)first[count] + 1, 1);
    take_all(g, first, taken[k]);
    const rates own = rates_of(&bodies[b].limit);
    if (is_faster(own, group[k])) group[k] = own;
  }
  for (int k = 0; k < groups; k++) {
    sum.square += group[k].square;
    sum.damping += group[k].damping;
    free(taken[k]);
  }
  free(group);
  free(taken);
  free(first);
  return sum;
}

static bool *joined_bodies(const run_body *bodies, int count, const touch_rates *touching) {
  bool *joined = must_calloc((size_t)count + 1, sizeof *joined);
  for (int b = 0; b < count; b++) {
    const rows *g = bodies[b].lattice_rows;
    joined[b] = joined[b] || touching[b].square > 0;
    for (long p = 0; g->copies && p < g->particle_count; p++)
      joined[g->copies[p].lattice] = true;
  }
  return joined;
}

void link_limit(const run_body *bodies, int count, const touch_rates *touching, step_limit *limit,
                int *ruling) {
  bool *joined = joined_bodies(bodies, count, touching);
  touch_rates contact = {0, 0};
  int fastest = -1;
  for (int b = 0; b < count; b++) {
    contact.square = pl_fmax(contact.square, touching[b].square);
    contact.damping = pl_fmax(contact.damping, touching[b].damping);
    if (joined[b] &&
        (fastest < 0 || is_faster(rates_of(&bodies[b].limit), rates_of(&bodies[fastest].limit))))
      fastest = b;
  }
  free(joined);
  if (fastest < 0) return;
  const rates alone = rates_of(&bodies[fastest].limit), links = sum_of_links(bodies, count);
  const rates all = {alone.square + links.square + contact.square,
                     alone.damping + links.damping + contact.damping};
  const double together = stability_rounded(2 / fastest_of(all));
  if (!(together < limit->limit)) return;
  *ruling = fastest;
  *limit = bodies[fastest].limit;
  limit->limit = together;
  limit->between = contact.square + links.square > alone.square;
  if (limit->between) limit->mode = contact.square > links.square ? "contact" : "a link";
  limit->omega_max = sqrt(all.square);
  limit->damping_ratio = all.damping / (2 * limit->omega_max);
}
