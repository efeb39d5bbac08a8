#include "runtime/body/body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

/* --- set-up ----------------------------------------------------------------------------------- */

double *body_doubles(body *w, long count) {
  w->bytes += (size_t)count * sizeof(double);
  return pool_doubles(w->memory, count);
}

void *body_apart(body *w, size_t bytes) {
  const long gap = BODY_APART / (long)sizeof(double);
  return body_doubles(w, (long)((bytes + sizeof(double) - 1) / sizeof(double)) + 2 * gap) + gap;
}

/* Part of every row that holds sites, widened to whole vectors. */
static void find_spans(body *w) {
  const rows *g = w->lattice;
  w->begin = must_calloc((size_t)g->row_count, sizeof *w->begin);
  w->count = must_calloc((size_t)g->row_count, sizeof *w->count);
  for (int r = 0; r < g->row_count; r++) {
    const unsigned char *present = g->present + rows_start(g, r);
    long first = 0, end = g->pitch;
    while (first < end && !present[first])
      first++;
    while (end > first && !present[end - 1])
      end--;
    if (first == end) continue;
    w->begin[r] = first / PL_LANES * PL_LANES;
    w->count[r] = (end - w->begin[r] + PL_LANES - 1) / PL_LANES * PL_LANES;
  }
}

void body_take_step(body *w, double time_step) {
  w->time_step = time_step;
  for (int d = 0; d < w->dof; d++)
    w->limit[d] = (d < w->dimensions ? w->lattice->spacing : M_PI) / time_step;
}

static void new_motion(body *w) {
  const rows *g = w->lattice;
  for (int d = 0; d < w->dof; d++) {
    w->mass[d] = d < w->dimensions ? g->mass : g->inertia;
    w->displacement[d] = body_doubles(w, g->size);
    w->velocity[d] = body_doubles(w, g->size);
    w->force[d] = body_doubles(w, g->size);
  }
  w->row_mass = body_doubles(w, g->row_count);
  w->row_internal = body_doubles(w, g->row_count);
  w->observed = must_calloc((size_t)g->row_count, sizeof *w->observed);
  w->row_stuck = must_calloc((size_t)g->row_count, sizeof *w->row_stuck);
}

/* A mass for each particle. */
static void new_masses(body *w) {
  const rows *g = w->lattice;
  const int kinds = w->dof > w->dimensions ? 2 : 1;
  for (int turns = 0; turns < kinds; turns++) {
    w->relative_mass[turns] = body_doubles(w, g->size);
    w->mobility[turns] = body_doubles(w, g->size);
    for (long q = 0; q < g->size; q++) {
      if (!g->present[q]) continue;
      const double square = turns ? rows_radius_square(g, q) : 1;
      const double mass = g->site_mass ? g->site_mass[q] : g->mass;
      w->relative_mass[turns][q] = mass / g->mass * square;
      w->mobility[turns][q] = g->mass / mass / square;
    }
  }
}

void body_add_mass(body *w, long site, double mass, double inertia) {
  const double more[] = {mass / w->mass[0], inertia / w->mass[w->dof - 1]};
  if (!w->relative_mass[0]) new_masses(w);
  for (int turns = 0; turns < 2 && w->relative_mass[turns]; turns++) {
    w->relative_mass[turns][site] += more[turns];
    w->mobility[turns][site] = 1 / w->relative_mass[turns][site];
  }
}

void body_give_away(body *w, long site) {
  if (!w->relative_mass[0]) new_masses(w);
  for (int d = 0; d < w->dimensions && !w->ahead[d]; d++)
    w->ahead[d] = body_doubles(w, w->lattice->size);
  w->relative_mass[0][site] = 0;
  if (w->weight) w->weight[site] = 0;
}

/* v = decay v_before + part dt/m f (motion.h), part = (1 + decay)/2. */
double body_kicked_by(const body *w, int component, long site, double before) {
  const double gained = w->velocity[component][site] - w->decay * before;
  return gained * w->mass[component] / (0.5 * (1 + w->decay) * w->time_step * w->mobility[0][site]);
}

static long doubles_below(const body *w, int row) {
  long sum = 0;
  for (int r = 0; r < row; r++)
    sum += w->count[r];
  return sum;
}

/* Where a block that begins with row `first` ends. */
static int end_of_block(const body *w, int block, int first, body_share share) {
  const int n = w->lattice->row_count, most = n - (w->block_count - 1 - block);
  if (share == BODY_SHARE_ROWS) return (int)((long)n * (block + 1) / w->block_count);
  const long wanted = doubles_below(w, n) * (block + 1) / w->block_count;
  long below = doubles_below(w, first + 1);
  int end = first + 1;
  while (end < most && below + w->count[end] / 2 <= wanted)
    below += w->count[end++];
  return end;
}

static void new_blocks(body *w, int threads, body_share share) {
  const int n = w->lattice->row_count;
  w->block_count = threads < 1 ? 1 : threads < n ? threads : n;
  w->blocks = must_calloc((size_t)w->block_count, sizeof *w->blocks);
  for (int k = 0, first = 0; k < w->block_count; first = w->blocks[k++].last)
    w->blocks[k] = (body_block){.first = first,
                                .last = end_of_block(w, k, first, share),
                                .next = body_doubles(w, w->dof * w->lattice->pitch),
                                .bad_site = -1};
}

body *body_new(const rows *lattice, int dof, double time_step, int threads, body_share share) {
  body *w = must_calloc(1, sizeof *w);
  w->memory = pool_new();
  w->lattice = lattice;
  w->dimensions = lattice->dimensions;
  w->dof = dof;
  body_take_step(w, time_step);
  w->decay = 1;
  find_spans(w);
  if (lattice->site_mass) new_masses(w);
  new_motion(w);
  new_blocks(w, threads, share);
  return w;
}

void body_add_gravity(body *w) {
  w->weight = body_doubles(w, w->lattice->size);
  for (long q = 0; q < w->lattice->size; q++)
    w->weight[q] = w->lattice->present[q] ? 1 : 0;
  w->row_gravity = body_doubles(w, w->lattice->row_count);
}

void body_add_outer(body *w) {
  if (w->row_outer) return;
  for (int d = 0; d < w->dimensions; d++)
    w->outer[d] = body_doubles(w, w->lattice->size);
  w->row_outer = must_calloc((size_t)w->lattice->row_count + 1, 1);
}

void body_clear_outer(body *w) {
  for (int row = 0; row < w->lattice->row_count; row++) {
    if (!w->row_outer[row]) continue;
    for (int d = 0; d < w->dimensions; d++)
      memset(w->outer[d] + body_start(w, row), 0, (size_t)w->count[row] * sizeof(double));
    w->row_outer[row] = 0;
  }
}

void body_free(body *w) {
  if (!w) return;
  free(w->row_stuck);
  free(w->row_outer);
  free(w->observed);
  free(w->begin);
  free(w->count);
  free(w->blocks);
  pool_free(w->memory);
  free(w);
}

/* --- what has become of it -------------------------------------------------------------------- */

int body_bad(const body *w) {
  for (int k = 0; k < w->block_count; k++)
    if (w->blocks[k].bad_site >= 0) return k;
  return -1;
}

bool body_has_moved(const body *w, long site) {
  const long stuck = w->row_stuck[rows_row(w->lattice, site)];
  return stuck == 0 || site < stuck;
}

static double sum_of(const double *values, long count) {
  double sum = 0;
  for (long k = 0; k < count; k++)
    sum += values[k];
  return sum;
}

body_totals body_sum(const body *w) {
  const int n = w->lattice->row_count;
  body_totals t = {.internal = sum_of(w->row_internal, n), .dissipated = sum_of(w->row_mass, n)};
  if (w->weight) t.gravity = sum_of(w->row_gravity, n);
  t.outer = w->outer_work;
  t.given_by_rest = w->given_before;
  for (int row = 0; row < n; row++) {
    const body_row *r = &w->observed[row];
    t.kinetic += r->kinetic;
    t.stored += r->stored;
    t.free += r->free;
    t.dissipated_state += r->state;
    t.dissipated_rate += r->rate;
    t.given_by_rest += r->given;
    t.dissipated += r->mass;
    t.internal += r->internal;
  }
  return t;
}
