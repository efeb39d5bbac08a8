/* Where and why a state went bad. */
#include <math.h>
#include <stdlib.h>

#include "dsl/base/elementary.h"
#include "runtime/analysis/bond_probe.h"
#include "runtime/simulation/simulation_parts.h"

/* From a bad particle on, or from a little before it, its row has not moved; all else has. */
static void ends_before(const simulation *s, int64_t site, double u[3], double v[3]) {
  const body *w = s->body;
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

static bond_motion motion_of(const simulation *s, const rows_bond *b, int direction) {
  const double *reference = s->lattice->chord[direction], length = s->lattice->length[direction];
  double ui[3], uj[3], vi[3], vj[3];
  ends_before(s, s->lattice->particle_site[b->i], ui, vi);
  ends_before(s, s->lattice->particle_site[b->j], uj, vj);
  const double c[2] = {reference[0] + uj[0] - ui[0], reference[1] + uj[1] - ui[1]};
  const double turn = pl_atan2(reference[0] * c[1] - reference[1] * c[0],
                               reference[0] * c[0] + reference[1] * c[1]);
  const double now = pl_hypot(c[0], c[1]);
  bond_motion k = {.stretch = (now - length) / length};
  k.rate = (c[0] * (vj[0] - vi[0]) + c[1] * (vj[1] - vi[1])) / (now * length);
  k.theta_i = s->law->dof > 2 ? wrapped(ui[2] - turn) : 0;
  k.theta_j = s->law->dof > 2 ? wrapped(uj[2] - turn) : 0;
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
static double *parameters_of_bond(const simulation *s, const rows_bond *b) {
  const pl_law *law = s->law;
  double *values = must_calloc((size_t)law->parameter_count + 1, sizeof *values);
  for (int p = 0; p < law->parameter_count; p++)
    values[p] = s->parameters[p];
  for (int k = 0; k < law->varying_count; k++)
    values[law->varying[k]] = s->fields->value[k][b->slot];
  return values;
}

/* The largest of N and M/s. */
static double bond_force(const simulation *s, const rows_bond *b, int direction, bond_motion k) {
  const pl_bond_class c = rows_bond_class(s->lattice, direction);
  double *parameters = parameters_of_bond(s, b), forces[PL_STATE_RESULTS];
  bond_probe *p = bond_probe_new(s->law, parameters, &c);
  for (int f = 0; f < s->law->field_count; f++)
    p->fields[f] = s->state->field[f][b->slot];
  bond_probe_forces(p, k, forces);
  bond_probe_free(p);
  free(parameters);
  return worse(forces[2] / c.s, worse(forces[1] / c.s, forces[0]));
}

/* The rules have already been at work; one that gave no number is looked at from the beginning. */
static void keep_fields(simulation *s, const rows_bond *b) {
  const pl_law *law = s->law;
  for (int f = 0; f < law->field_count; f++) {
    const double value = s->state->field[f][b->slot];
    s->bad_fields[f] = isfinite(value) ? value : law->fields[f].initial;
  }
  free(s->bad_parameters);
  s->bad.parameters = s->bad_parameters = parameters_of_bond(s, b);
  s->bad.fields = s->bad_fields;
  s->bad.field_count = law->field_count;
}

/* Values at a site of fields on particles, and toward neighbour k of those on neighbours. */
static void fields_at(const simulation *s, long site, long there, int k, double *values) {
  for (int f = 0; f < s->law->field_count; f++) {
    const bool own = s->law->fields[f].place == PL_ON_PARTICLE;
    values[f] = s->state->field[f][own ? there : k * s->lattice->size + site];
  }
}

static void look_at_neighbour(simulation *s, long site, int k) {
  const rows *g = s->lattice;
  const long there = rows_partner(g, site, k);
  double chord[3];
  const double length = rows_chord(g, site, k, chord);
  double ui[3], uj[3], vi[3], vj[3], now = 0, growth = 0;
  ends_before(s, site, ui, vi);
  ends_before(s, there, uj, vj);
  for (int d = 0; d < s->law->dimensions; d++) {
    const double c = chord[d] + uj[d] - ui[d];
    now += c * c;
    growth += c * (vj[d] - vi[d]);
  }
  now = sqrt(now);
  bad_neighbour *n = &s->bad_family[s->bad.family_count++];
  double *fields = s->bad_fields + s->bad.family_count * s->law->field_count;
  fields_at(s, site, there, k, fields);
  *n = (bad_neighbour){g->site_particle[there], now / length - 1, growth / (now * length), fields};
}

static void look_at_family(simulation *s, long site) {
  s->bad.family = s->bad_family;
  s->bad.own_fields = s->bad_fields;
  fields_at(s, site, site, 0, s->bad_fields);
  for (int k = 0; k < 2 * s->lattice->directions; k++)
    if (rows_has_neighbour(s->lattice, site, k)) look_at_neighbour(s, site, k);
}

void bad_explain(simulation *s) {
  const body_block *at = &s->body->blocks[body_bad(s->body)];
  const int32_t particle = s->lattice->site_particle[at->bad_site];
  double worst = 0;
  s->bad = (bad_state){.step = (long)s->at.step,
                       .time = simulation_time(s),
                       .particle = particle,
                       .bond_particle = -1};
  rows_place(s->lattice, at->bad_site, s->bad.place);
  s->bad.what = !isfinite(at->bad_velocity)                   ? "not a number"
                : at->bad_component >= s->lattice->dimensions ? "runaway rotation"
                                                              : "runaway velocity";
  if (s->law->kind == PL_STATE) {
    look_at_family(s, at->bad_site);
    return;
  }
  for (long m = 0; m < s->lattice->bond_count; m++) {
    const rows_bond *b = &s->bonds[m];
    if (b->i != particle && b->j != particle) continue;
    const int direction = (int)(b->slot / s->lattice->size);
    const bond_motion k = motion_of(s, b, direction);
    const double force = bond_force(s, b, direction, k);
    if (s->bad.bond_particle >= 0 && !is_worse(force, worst)) continue;
    worst = force;
    s->bad.bond_particle = b->i == particle ? b->j : b->i;
    s->bad.stretch = k.stretch;
    s->bad.stretch_rate = k.rate;
    s->bad.theta_i = k.theta_i;
    s->bad.theta_j = k.theta_j;
    keep_fields(s, b);
  }
}

void bad_energy(simulation *s, const char *what) {
  s->at.status = STEP_BAD;
  s->bad = (bad_state){.step = (long)s->at.step,
                       .time = simulation_time(s),
                       .particle = -1,
                       .bond_particle = -1,
                       .what = what};
}

bad_state simulation_bad(const simulation *s) {
  return s->bad;
}
