#include "runtime/simulation/bad_state.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/analysis/bond_probe.h"
#include "runtime/interaction/sweep.h"
#include "runtime/simulation/run_clock.h"

struct bad_search {
  const sweep *state;
  const double *parameters; /* of the law */
  double *const *varying;   /* that differ in space */
  const rows_bond *bonds;
  const run_clock *clock;
  bad_state found;
  double *own_parameters; /* of the bad bond */
  double *fields;         /* [law's fields], of the bad bond; families: [1 + neighbours] of these */
  bad_neighbour *family;
};

/* From a bad particle on, or from a little before it, its row has not moved; all else has. */
static void ends_before(const bad_search *s, int64_t site, double u[3], double v[3]) {
  const body *w = s->state->body;
  const bool moved = body_has_moved(w, site);
  for (int d = 0; d < 3; d++) {
    u[d] = d < w->dof ? w->displacement[d][site] : 0;
    v[d] = d < w->dof ? w->velocity[d][site] : 0;
    if (moved && isfinite(v[d])) u[d] -= w->time_step * v[d];
  }
}

static double wrapped(double angle) {
  return remainder(angle, 2 * M_PI);
}

static bond_motion motion_of(const bad_search *s, const rows_bond *b, int direction) {
  const double *reference = s->state->body->lattice->chord[direction],
               length = s->state->body->lattice->length[direction];
  double ui[3], uj[3], vi[3], vj[3];
  ends_before(s, s->state->body->lattice->particle_site[b->i], ui, vi);
  ends_before(s, s->state->body->lattice->particle_site[b->j], uj, vj);
  const double c[2] = {reference[0] + uj[0] - ui[0], reference[1] + uj[1] - ui[1]};
  const double turn = pl_atan2(reference[0] * c[1] - reference[1] * c[0],
                               reference[0] * c[0] + reference[1] * c[1]);
  const double now = pl_hypot(c[0], c[1]);
  bond_motion k = {.stretch = (now - length) / length};
  k.rate = (c[0] * (vj[0] - vi[0]) + c[1] * (vj[1] - vi[1])) / (now * length);
  k.theta_i = s->state->law->dof > 2 ? wrapped(ui[2] - turn) : 0;
  k.theta_j = s->state->law->dof > 2 ? wrapped(uj[2] - turn) : 0;
  return k;
}

/* No number is worse than any number. */
static bool is_worse(double a, double b) {
  return isfinite(b) && (!isfinite(a) || fabs(a) > fabs(b));
}

static double worse(double a, double b) {
  return is_worse(a, b) ? a : b;
}

/* Values of the law's parameters in a bond. */
static double *parameters_of_bond(const bad_search *s, const rows_bond *b) {
  const pl_law *law = s->state->law;
  double *values = must_calloc((size_t)law->parameter_count + 1, sizeof *values);
  for (int p = 0; p < law->parameter_count; p++)
    values[p] = s->parameters[p];
  for (int k = 0; k < law->varying_count; k++)
    values[law->varying[k]] = s->varying[k][b->slot];
  return values;
}

/* The largest of N and M/s. */
static double bond_force(const bad_search *s, const rows_bond *b, int direction, bond_motion k) {
  const pl_bond_class c = rows_bond_class(s->state->body->lattice, direction);
  double *parameters = parameters_of_bond(s, b), forces[PL_STATE_RESULTS];
  bond_probe *p = bond_probe_new(s->state->law, parameters, &c);
  for (int f = 0; f < s->state->law->field_count; f++)
    p->fields[f] = s->state->field[f][b->slot];
  bond_probe_forces(p, k, forces);
  bond_probe_free(p);
  free(parameters);
  return worse(forces[2] / c.s, worse(forces[1] / c.s, forces[0]));
}

/* The rules have already been at work; one that gave no number is looked at from the beginning. */
static void keep_fields(bad_search *s, const rows_bond *b) {
  const pl_law *law = s->state->law;
  for (int f = 0; f < law->field_count; f++) {
    const double value = s->state->field[f][b->slot];
    s->fields[f] = isfinite(value) ? value : law->fields[f].initial;
  }
  free(s->own_parameters);
  s->found.parameters = s->own_parameters = parameters_of_bond(s, b);
  s->found.fields = s->fields;
  s->found.field_count = law->field_count;
}

/* Values at a site of fields on particles, and toward neighbour k of those on neighbours. */
static void fields_at(const bad_search *s, long site, long there, int k, double *values) {
  for (int f = 0; f < s->state->law->field_count; f++) {
    const bool own = s->state->law->fields[f].place == PL_ON_PARTICLE;
    values[f] = s->state->field[f][own ? there : k * s->state->body->lattice->size + site];
  }
}

static void look_at_neighbour(bad_search *s, long site, int k) {
  const rows *g = s->state->body->lattice;
  const long there = rows_partner(g, site, k);
  double chord[3];
  const double length = rows_chord(g, site, k, chord);
  double ui[3], uj[3], vi[3], vj[3], now = 0, growth = 0;
  ends_before(s, site, ui, vi);
  ends_before(s, there, uj, vj);
  for (int d = 0; d < s->state->law->dimensions; d++) {
    const double c = chord[d] + uj[d] - ui[d];
    now += c * c;
    growth += c * (vj[d] - vi[d]);
  }
  now = sqrt(now);
  bad_neighbour *n = &s->family[s->found.family_count++];
  double *fields = s->fields + s->found.family_count * s->state->law->field_count;
  fields_at(s, site, there, k, fields);
  *n = (bad_neighbour){g->site_particle[there], now / length - 1, growth / (now * length), fields};
}

static void look_at_family(bad_search *s, long site) {
  s->found.family = s->family;
  s->found.own_fields = s->fields;
  fields_at(s, site, site, 0, s->fields);
  for (int k = 0; k < 2 * s->state->body->lattice->directions; k++)
    if (rows_has_neighbour(s->state->body->lattice, site, k)) look_at_neighbour(s, site, k);
}

void bad_search_velocity(bad_search *s) {
  const body_block *at = &s->state->body->blocks[body_bad(s->state->body)];
  const int32_t particle = s->state->body->lattice->site_particle[at->bad_site];
  double worst = 0;
  s->found = (bad_state){.step = (long)s->clock->at.step,
                         .time = run_clock_time(s->clock),
                         .particle = particle,
                         .bond_particle = -1};
  rows_place(s->state->body->lattice, at->bad_site, s->found.place);
  s->found.what = !isfinite(at->bad_velocity)                                ? "not a number"
                  : at->bad_component >= s->state->body->lattice->dimensions ? "runaway rotation"
                                                                             : "runaway velocity";
  if (s->state->law->kind == PL_STATE) {
    look_at_family(s, at->bad_site);
    return;
  }
  for (long m = 0; m < s->state->body->lattice->bond_count; m++) {
    const rows_bond *b = &s->bonds[m];
    if (b->i != particle && b->j != particle) continue;
    const int direction = (int)(b->slot / s->state->body->lattice->size);
    const bond_motion k = motion_of(s, b, direction);
    const double force = bond_force(s, b, direction, k);
    if (s->found.bond_particle >= 0 && !is_worse(force, worst)) continue;
    worst = force;
    s->found.bond_particle = b->i == particle ? b->j : b->i;
    s->found.stretch = k.stretch;
    s->found.stretch_rate = k.rate;
    s->found.theta_i = k.theta_i;
    s->found.theta_j = k.theta_j;
    keep_fields(s, b);
  }
}

void bad_search_energy(bad_search *s, const char *what) {
  s->found = (bad_state){.step = (long)s->clock->at.step,
                         .time = run_clock_time(s->clock),
                         .particle = -1,
                         .bond_particle = -1,
                         .what = what};
}

const bad_state *bad_search_found(const bad_search *s) {
  return &s->found;
}

/* --- set-up ----------------------------------------------------------------------------------- */

bad_search *bad_search_new(const sweep *state, const double *parameters, double *const *varying,
                           const rows_bond *bonds, const run_clock *clock) {
  const size_t neighbours = 2 * (size_t)state->body->lattice->directions;
  bad_search *s = must_calloc(1, sizeof *s);
  *s = (bad_search){
      .state = state, .parameters = parameters, .varying = varying, .bonds = bonds, .clock = clock};
  s->found = (bad_state){.particle = -1, .bond_particle = -1, .what = ""};
  s->fields = must_calloc((1 + neighbours) * (size_t)state->law->field_count + 1, sizeof(double));
  s->family = must_calloc(neighbours, sizeof *s->family);
  return s;
}

void bad_search_free(bad_search *s) {
  if (!s) return;
  free(s->own_parameters);
  free(s->fields);
  free(s->family);
  free(s);
}
