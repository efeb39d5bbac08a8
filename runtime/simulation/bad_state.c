#include "runtime/simulation/bad_state.h"

#include <math.h>
#include <stdlib.h>

#include "dsl/base/arena.h"
#include "dsl/base/elementary.h"
#include "runtime/analysis/bond_probe.h"
#include "runtime/continuum/cells_engine.h"
#include "runtime/continuum/point_forces.h"
#include "runtime/parts/run_body.h"
#include "runtime/simulation/run_clock.h"

struct bad_search {
  const run_body *bodies;
  int body_count;
  const run_clock *clock;
  const run_body *of; /* the bad one */
  const run_law *law; /* that is looked at */
  const sweep *state; /* of it */
  bad_state found;
  double *own_parameters; /* of the bad bond */
  double *fields;         /* [law's fields], of the bad bond; families: [1 + neighbours] of these */
  bad_neighbour *family;
  point_state point; /* of a mesh */
};

static long in_results(const bad_search *s, int32_t particle) {
  const rows_copy *copies = s->of->lattice_rows->copies;
  if (copies)
    return s->bodies[copies[particle].lattice].first_particle + copies[particle].particle[0];
  return (long)s->of->first_particle + particle;
}

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
  const double *reference = s->of->lattice_rows->chord[direction],
               length = s->of->lattice_rows->length[direction];
  double ui[3], uj[3], vi[3], vj[3];
  ends_before(s, s->of->lattice_rows->particle_site[b->i], ui, vi);
  ends_before(s, s->of->lattice_rows->particle_site[b->j], uj, vj);
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
    values[p] = s->law->parameters[p];
  for (int k = 0; k < parameter_planes_of(law); k++)
    values[law->varying[k]] = s->state->parameter[k][b->slot];
  return values;
}

/* The largest of N and M/s. */
static double bond_force(const bad_search *s, const rows_bond *b, int direction, bond_motion k) {
  const pl_bond_class c = rows_bond_class(s->of->lattice_rows, direction);
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
    values[f] = s->state->field[f][own ? there : k * s->of->lattice_rows->size + site];
  }
}

static void look_at_neighbour(bad_search *s, long site, int k) {
  const rows *g = s->of->lattice_rows;
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
  *n = (bad_neighbour){in_results(s, g->site_particle[there]), now / length - 1,
                       growth / (now * length), fields};
}

static void look_at_family(bad_search *s, long site) {
  s->found.family = s->family;
  s->found.own_fields = s->fields;
  fields_at(s, site, site, 0, s->fields);
  for (int k = 0; k < 2 * s->state->lattice->directions; k++)
    if (rows_has_neighbour(s->state->lattice, site, k)) look_at_neighbour(s, site, k);
}

/* Of the bonds of the particle the one that pulls most, and what its law read. */
static void look_at_bonds(bad_search *s, int32_t particle) {
  double worst = 0;
  for (long m = 0; m < s->law->rows->bond_count; m++) {
    const rows_bond *b = &s->law->bonds[m];
    if (b->i != particle && b->j != particle) continue;
    const int direction = (int)(b->slot / s->of->lattice_rows->size);
    const bond_motion k = motion_of(s, b, direction);
    const double force = bond_force(s, b, direction, k);
    if (s->found.bond_particle >= 0 && !is_worse(force, worst)) continue;
    worst = force;
    s->found.bond_particle = in_results(s, b->i == particle ? b->j : b->i);
    s->found.stretch = k.stretch;
    s->found.stretch_rate = k.rate;
    s->found.theta_i = k.theta_i;
    s->found.theta_j = k.theta_j;
    keep_fields(s, b);
  }
}

/* Of a mesh the point around the node that is worst. */
static void look_at_points(bad_search *s, int64_t site) {
  s->point.field = s->fields;
  const int law = cells_worst_point(s->of->state, site, &s->point);
  if (law < 0) return;
  s->law = &s->of->laws[law];
  s->found.interaction = (int)(s->law - s->bodies[0].laws);
  s->found.point = &s->point;
}

static int first_bad(const bad_search *s) {
  int b = 0;
  while (body_bad(s->bodies[b].body) < 0)
    b++;
  return b;
}

/* The size of what a law's bonds exert on a particle; NaN is that of no number. */
static double force_at(const run_law *l, long site) {
  double sum = 0;
  for (int d = 0; d < l->law->dof; d++)
    sum += fabs(l->state->force[d][site]);
  return sum;
}

/* Of several laws with a part in the particle's bonds the one that pulls most. */
static const run_law *law_at(const run_body *of, long site) {
  const run_law *worst = of->laws;
  for (int n = 1; n < of->law_count; n++)
    if (is_worse(force_at(&of->laws[n], site), force_at(worst, site))) worst = &of->laws[n];
  return worst;
}

void bad_search_velocity(bad_search *s) {
  const int bad = first_bad(s);
  s->of = &s->bodies[bad];
  const body_block *at = &s->of->body->blocks[body_bad(s->of->body)];
  const int32_t particle = s->of->lattice_rows->site_particle[at->bad_site];
  s->law = law_at(s->of, at->bad_site);
  s->state = s->law->state;
  s->found = (bad_state){.body = bad,
                         .interaction = (int)(s->law - s->bodies[0].laws),
                         .step = (long)s->clock->at.step,
                         .time = run_clock_time(s->clock),
                         .advance = s->of->body->advance,
                         .particle = in_results(s, particle),
                         .bond_particle = -1};
  rows_place(s->of->lattice_rows, at->bad_site, s->found.place);
  s->found.what = !isfinite(at->bad_velocity)                            ? "not a number"
                  : at->bad_component >= s->of->lattice_rows->dimensions ? "runaway rotation"
                                                                         : "runaway velocity";
  if (s->of->cells)
    look_at_points(s, at->bad_site);
  else if (s->of->law->kind == PL_STATE)
    look_at_family(s, at->bad_site);
  else
    look_at_bonds(s, particle);
}

void bad_search_energy(bad_search *s, const char *what) {
  s->found = (bad_state){.step = (long)s->clock->at.step,
                         .time = run_clock_time(s->clock),
                         .particle = -1,
                         .bond_particle = -1,
                         .what = what};
}

void bad_search_step(bad_search *s, int number) {
  bad_search_energy(s, BAD_TOO_STIFF);
  s->found.body = number;
}

const bad_state *bad_search_found(const bad_search *s) {
  return &s->found;
}

/* --- set-up ----------------------------------------------------------------------------------- */

bad_search *bad_search_new(const run_body *bodies, int count, const run_clock *clock) {
  size_t values = 0, neighbours = 0;
  bad_search *s = must_calloc(1, sizeof *s);
  *s = (bad_search){.bodies = bodies, .body_count = count, .clock = clock};
  s->found = (bad_state){.particle = -1, .bond_particle = -1, .what = ""};
  for (int b = 0; b < count; b++) {
    const size_t n = 2 * (size_t)bodies[b].lattice_rows->directions;
    neighbours = n > neighbours ? n : neighbours;
    for (int l = 0; l < bodies[b].law_count; l++) {
      const size_t all = (1 + n) * (size_t)bodies[b].laws[l].law->field_count;
      values = all > values ? all : values;
    }
  }
  s->fields = must_calloc(values + 1, sizeof(double));
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
