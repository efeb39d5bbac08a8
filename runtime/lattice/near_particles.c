#include "runtime/lattice/near_particles.h"

#include <stdlib.h>

#include "dsl/base/arena.h"

near_particles near_particles_of(const rows *body, double reach) {
  near_particles n = {.body = body, .reach = reach};
  for (int a = 0; a < body->dimensions; a++)
    n.at[a] = must_alloc(((size_t)body->particle_count + 1) * sizeof(double));
  for (long p = 0; p < body->particle_count; p++) {
    double at[3];
    rows_place(body, body->particle_site[p], at);
    for (int a = 0; a < body->dimensions; a++)
      n.at[a][p] = at[a];
  }
  bins_of_size(&n.bins, body->dimensions, (const double *const *)n.at, body->particle_count, reach);
  return n;
}

void near_particles_end(near_particles *n) {
  bins_end(&n->bins);
  for (int a = 0; a < 3; a++)
    free(n->at[a]);
  free(n->found);
}

static void add_near(near_particles *n, int32_t particle, const double from[3]) {
  near_particle p = {.particle = particle};
  for (int a = 0; a < n->body->dimensions; a++) {
    p.way[a] = n->at[a][particle] - from[a];
    p.square += p.way[a] * p.way[a];
  }
  if (p.square > n->reach * n->reach) return;
  if (n->count == n->room) {
    n->room = 2 * n->room + 64;
    n->found = must_realloc(n->found, (size_t)n->room * sizeof *n->found);
  }
  n->found[n->count++] = p;
}

static int by_number(const void *a, const void *b) {
  const near_particle *p = a, *q = b;
  return (p->particle > q->particle) - (p->particle < q->particle);
}

/* Boxes hold what is out of all of them, too: those at their sides. */
void near_particles_find(near_particles *n, const double from[3]) {
  const boxes *b = &n->bins.boxes;
  int low[3] = {0, 0, 0}, high[3] = {0, 0, 0}, box[3];
  for (int a = 0; a < b->dimensions; a++) {
    low[a] = boxes_along(b, a, from[a] - n->reach);
    high[a] = boxes_along(b, a, from[a] + n->reach);
  }
  n->count = 0;
  for (box[2] = low[2]; box[2] <= high[2]; box[2]++)
    for (box[1] = low[1]; box[1] <= high[1]; box[1]++)
      for (box[0] = low[0]; box[0] <= high[0]; box[0]++) {
        const int64_t here = boxes_number(b, box);
        for (int32_t k = n->bins.first[here]; k < n->bins.first[here + 1]; k++)
          add_near(n, n->bins.point[k], from);
      }
  if (n->count > 1) qsort(n->found, (size_t)n->count, sizeof *n->found, by_number);
}
