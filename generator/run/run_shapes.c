#include "generator/run/run_shapes.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "generator/kernel/document.h"
#include "generator/run/run_result.h"
#include "runtime/base/clock.h"
#include "runtime/interaction/sweep.h"

static const double shown = 0.01; /* part of the size that the largest displacement is */

/* NULL: a link, whose particles are others'. */
static const body *body_of(const run *r, int b) {
  return simulation_rows(r->simulation, b)->copies ? NULL
                                                   : simulation_state(r->simulation, b)->body;
}

/* --- scale ------------------------------------------------------------------------------------ */

/* The longest side of the box around all particles. */
static double size_of(const result_header *h) {
  double most = 0;
  for (int d = 0; d < h->dimensions; d++) {
    double low = INFINITY, high = -INFINITY;
    for (long p = 0; p < h->particle_count; p++) {
      low = pl_fmin(low, h->reference[p * h->dimensions + d]);
      high = pl_fmax(high, h->reference[p * h->dimensions + d]);
    }
    most = pl_fmax(most, high - low);
  }
  return most;
}

/* Of a particle, m: its displacement, or its rotation at a spacing's distance. */
static double way_of(const body *b, const double *motion, long site) {
  double moved = 0, turned = 0;
  for (int d = 0; d < b->dof; d++) {
    const double value = motion[d * b->lattice->size + site];
    *(body_turns(b, d) ? &turned : &moved) += value * value;
  }
  return pl_fmax(sqrt(moved), b->lattice->spacing * sqrt(turned));
}

static double longest_way(const run *r, const mode *m) {
  double most = 0;
  for (int n = 0; n < simulation_bodies(r->simulation); n++) {
    const body *b = body_of(r, n);
    for (long p = 0; b && p < b->lattice->particle_count; p++)
      most = pl_fmax(most, way_of(b, m->shape[n], b->lattice->particle_site[p]));
  }
  return most;
}

/* --- frames ----------------------------------------------------------------------------------- */

enum { MOST_FIELDS = 2 };

static void describe_fields(const run *r, result_header *h, result_field fields[MOST_FIELDS]) {
  int turns = 0;
  for (int n = 0; n < simulation_bodies(r->simulation); n++) {
    const body *b = body_of(r, n);
    if (b && b->dof > b->dimensions) turns = b->dof - b->dimensions;
  }
  fields[0] = (result_field){
      "displacement", "m", NULL, h->dimensions, h->particle_count, "other", "shape of the mode"};
  fields[1] = (result_field){"rotation",
                             "rad",
                             NULL,
                             turns,
                             h->particle_count,
                             "other",
                             "shape of the mode, counter-clockwise"};
  h->fields = fields;
  h->field_count = turns > 0 ? 2 : 1;
}

/* Of a body, components from that one on; NaN where it has none. */
static double *put(const body *b, const double *motion, double factor, int first, int components,
                   double *at) {
  const rows *w = b->lattice;
  for (long p = 0; p < w->particle_count; p++)
    for (int d = first; d < first + components; d++)
      *at++ = d < b->dof ? factor * motion[d * w->size + w->particle_site[p]] : NAN;
  return at;
}

static bool write_shape(run *r, const result_header *h, const mode *m, int number) {
  const double *values[MOST_FIELDS], factor = shown * size_of(h) / longest_way(r, m);
  double *at = r->frame_buffer;
  for (int k = 0; k < h->field_count; k++) {
    values[k] = at;
    for (int n = 0; n < simulation_bodies(r->simulation); n++) {
      const body *b = body_of(r, n);
      const int first = k == 0 ? 0 : h->dimensions;
      if (b) at = put(b, m->shape[n], factor, first, h->fields[k].components, at);
    }
  }
  char error[ERROR_LENGTH];
  if (result_frame(r->result, number, values, error, sizeof error)) return true;
  say_error("%s", error);
  return false;
}

static bool finish(run *r, const mode *modes, int count, double begun) {
  double *numbers = arena_alloc(r->memory, (size_t)count * sizeof *numbers),
         *frequencies = arena_alloc(r->memory, (size_t)count * sizeof *frequencies);
  for (int k = 0; k < count; k++) {
    numbers[k] = k + 1;
    frequencies[k] = modes[k].omega / (2 * M_PI);
  }
  const result_series frequency = {.name = "frequency",
                                   .unit = "Hz",
                                   .long_name = "frequency of the mode",
                                   .values = frequencies};
  const result_ending e = {.ended = arena_printf(r->memory, "shapes of the lowest %d mode%s", count,
                                                 count == 1 ? "" : "s"),
                           .seconds = monotonic_seconds() - begun,
                           .dt = simulation_step_limit(r->simulation)->step,
                           .time = numbers,
                           .history_count = count,
                           .series = &frequency,
                           .series_count = 1};
  char error[ERROR_LENGTH];
  if (result_finish(r->result, &e, error, sizeof error)) return true;
  say_error("%s", error);
  return false;
}

bool write_shapes(run *r, const mode *modes, int count) {
  const double begun = monotonic_seconds();
  result_field fields[MOST_FIELDS];
  result_header h = describe_result(r);
  h.numbers = "number of the mode";
  describe_fields(r, &h, fields);
  if (!open_described(r, &h) || !begin_anew(r)) return false;
  bool good = true;
  for (int k = 0; good && k < count; k++)
    good = write_shape(r, &h, &modes[k], k + 1);
  good = good && finish(r, modes, count, begun);
  remove_remains(r);
  return good;
}
