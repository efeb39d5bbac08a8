#include "runtime/interaction/sweep.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"
#include "runtime/base/lane_sum.h"
#include "runtime/base/subnormals.h"

/* --- set-up ----------------------------------------------------------------------------------- */

int sweep_planes(const sweep *w, int where) {
  if (where == PL_ON_POINT) return 1;
  if (w->law->kind != PL_STATE) return w->lattice->directions;
  return where == PL_ON_PARTICLE ? 1 : 2 * w->lattice->directions;
}

static void new_fields(sweep *w) {
  const pl_law *law = w->law;
  w->field = must_calloc((size_t)law->field_count + 1, sizeof *w->field);
  w->new_field = must_calloc((size_t)law->field_count + 1, sizeof *w->new_field);
  for (int f = 0; f < law->field_count; f++) {
    const long values = sweep_planes(w, law->fields[f].place) * w->lattice->size;
    w->field[f] = body_doubles(w->body, values);
    w->new_field[f] = body_doubles(w->body, values);
    for (long k = 0; k < values; k++)
      w->field[f][k] = w->new_field[f][k] = law->fields[f].initial;
  }
}

static sweep *begin(body *of, const rows *lattice, const pl_law *law) {
  sweep *w = must_calloc(1, sizeof *w);
  assert(law->dimensions == of->dimensions && law->dof == of->dof);
  w->body = of;
  w->lattice = lattice;
  w->law = law;
  memcpy(w->force, of->force, sizeof w->force);
  return w;
}

sweep *sweep_new(body *of, const pl_law *law, const double *parameters, sweep_engine_new *engine) {
  sweep *w = begin(of, of->lattice, law);
  new_fields(w);
  if (engine) w->engine = engine(w, parameters);
  return w;
}

sweep *sweep_beside(body *of, const rows *lattice, const pl_law *law, const double *parameters,
                    const double *share, sweep_engine_new *engine) {
  sweep *w = begin(of, lattice, law);
  w->beside = true;
  w->share = share;
  for (int d = 0; d < of->dof; d++)
    w->force[d] = body_doubles(of, of->lattice->size);
  new_fields(w);
  w->engine = engine(w, parameters);
  return w;
}

void sweep_free(sweep *w) {
  if (!w) return;
  w->engine.free(w);
  free(w->field);
  free(w->new_field);
  if (!w->beside) body_free(w->body);
  free(w);
}

/* --- a step ----------------------------------------------------------------------------------- */

void sweep_fields_set(sweep *w) {
  if (w->engine.fields_set) w->engine.fields_set(w);
}

void sweep_turn(sweep *w) {
  if (w->engine.turn) w->engine.turn(w);
}

bool sweep_step(sweep *w) {
  for (int stage = 0; stage < w->engine.step_stages; stage++)
    for (int b = 0; b < w->body->block_count; b++)
      w->engine.step(w, stage, b);
  if (body_bad(w->body) >= 0) return false;
  sweep_turn(w);
  return true;
}

static void do_stages(sweep *w, int stages, void (*stage_of)(sweep *, int stage, int block)) {
#pragma omp parallel num_threads(w->body->block_count) if (w->body->block_count > 1)
  {
    const unsigned environment = subnormals_off();
    for (int stage = 0; stage < stages; stage++) {
#pragma omp for schedule(static)
      for (int block = 0; block < w->body->block_count; block++)
        stage_of(w, stage, block);
    }
    subnormals_restore(environment);
  }
}

void sweep_find_forces(sweep *w) {
  do_stages(w, w->engine.force_stages, w->engine.forces);
}

/* --- sampling --------------------------------------------------------------------------------- */

void sweep_observe(sweep *w) {
  do_stages(w, w->engine.observe_stages, w->engine.observe);
}

void sweep_new_losses(sweep *w) {
  double **const energies[] = {&w->dissipated_state, &w->dissipated_rate, &w->lost_state,
                               &w->lost_rate};
  for (int k = 0; k < 4; k++)
    *energies[k] = body_doubles(w->body, w->lattice->size);
  if (!sweep_works_at_rest(w->law)) return;
  w->given_by_rest = body_doubles(w->body, w->lattice->size);
  w->given_now = body_doubles(w->body, w->lattice->size);
}

void sweep_clear_losses(sweep *w, int row) {
  double *const now[] = {w->lost_state, w->lost_rate, w->given_now};
  for (int k = 0; k < 3; k++)
    if (now[k])
      memset(now[k] + body_start(w->body, row), 0, (size_t)w->body->count[row] * sizeof(double));
}

/* Rate terms, like other forces, count half a step until the state is reached; they are none of
   those that a step must be short enough for (body_row.free). */
void sweep_add_losses(sweep *w, int row) {
  const long start = body_start(w->body, row), count = w->body->count[row];
  const double pending = 0.5 * lane_total(count, w->lost_rate + start);
  body_row *r = &w->body->observed[row];
  r->state +=
      lane_total(count, w->dissipated_state + start) + lane_total(count, w->lost_state + start);
  r->rate += lane_total(count, w->dissipated_rate + start) + pending;
  r->free += pending;
  if (w->given_by_rest)
    r->given +=
        lane_total(count, w->given_by_rest + start) + lane_total(count, w->given_now + start);
}

bool sweep_works_at_rest(const pl_law *law) {
  return PL_HAS(law, works_at_rest) && law->works_at_rest;
}

bool sweep_knows_losses(const pl_law *law, bool kept) {
  if (law->kind != PL_STATE) return true;
  if (!law->stores) return false;
  const bool may_lose = law->field_count > 0 || law->reads_rates || sweep_works_at_rest(law);
  return !may_lose || (kept && PL_HAS(law, ledger) && law->ledger.pass_count > 0);
}

void sweep_output(sweep *w, int output, double *values) {
  w->engine.output(w, output, values);
}

void sweep_stored(sweep *w, double *values) {
  w->engine.stored(w, values);
}

double sweep_bond_value(const sweep *w, const double *values, const rows_bond *bond) {
  const rows *g = w->lattice;
  if (w->law->kind != PL_STATE) return values[bond->slot];
  const long back = bond->slot / g->size + g->directions, i = g->particle_site[bond->i],
             j = g->particle_site[bond->j];
  const double here = values[bond->slot], there = values[back * g->size + j];
  if (!w->share) return 0.5 * (here + there);
  return (w->share[i] > 0 ? w->share[i] * here : 0) / (w->share[i] + w->share[j]) +
         (w->share[j] > 0 ? w->share[j] * there : 0) / (w->share[i] + w->share[j]);
}
