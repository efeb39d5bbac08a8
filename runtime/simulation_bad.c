/* Where and why a state went bad. */
#include <math.h>
#include <stdlib.h>

#include "runtime/simulation_parts.h"

typedef struct bond_state {
  double stretch, rate, theta_i, theta_j, length;
  double force; /* largest of N and M/s, not finite when one is not */
} bond_state;

/* The row of a bad particle was not moved; others have been. */
static void ends_before(const simulation *s, int64_t site, double u[3], double v[3]) {
  const sweep *w = s->state;
  const long bad_row = w->blocks[sweep_bad(w)].bad_site / s->lattice->pitch;
  for (int d = 0; d < 3; d++) {
    u[d] = d < w->dof ? w->displacement[d][site] : 0;
    v[d] = d < w->dof ? w->velocity[d][site] : 0;
    if (site / s->lattice->pitch != bad_row && isfinite(v[d])) u[d] -= w->time_step * v[d];
  }
}

static double wrapped(double angle) {
  return remainder(angle, 2 * acos(-1));
}

static bond_state bond_kinematics(const simulation *s, const rows_bond *b, int direction) {
  const double *reference = s->lattice->chord[direction], length = s->lattice->length[direction];
  double ui[3], uj[3], vi[3], vj[3];
  ends_before(s, s->lattice->particle_site[b->i], ui, vi);
  ends_before(s, s->lattice->particle_site[b->j], uj, vj);
  const double c[2] = {reference[0] + uj[0] - ui[0], reference[1] + uj[1] - ui[1]};
  const double turn =
      atan2(reference[0] * c[1] - reference[1] * c[0], reference[0] * c[0] + reference[1] * c[1]);
  bond_state k = {.length = hypot(c[0], c[1])};
  k.stretch = (k.length - length) / length;
  k.rate = (c[0] * (vj[0] - vi[0]) + c[1] * (vj[1] - vi[1])) / (k.length * length);
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

static double *uniforms_of_bond(const simulation *s, const rows_bond *b, int direction) {
  double *parameters = parameters_of_bond(s, b);
  double *uniforms = must_calloc((size_t)s->law->uniform_count + 1, sizeof *uniforms);
  const pl_bond_class c = rows_bond_class(s->lattice, direction);
  s->law->prepare(s->law, parameters, &c, uniforms);
  free(parameters);
  return uniforms;
}

static void bond_forces(const simulation *s, const rows_bond *b, int direction, bond_state *k) {
  const pl_law *law = s->law;
  const int fields = law->field_count;
  double *values = must_calloc(2 * (size_t)(fields + 5), sizeof *values);
  const double **in = must_calloc((size_t)fields + 5, sizeof *in);
  double **out = must_calloc((size_t)fields + 3, sizeof *out);
  const double kinematics[5] = {k->stretch, k->rate, k->theta_i, k->theta_j, k->length};
  for (int f = 0; f < fields + 5; f++) {
    values[f] = f < 5 ? kinematics[f] : s->state->field[f - 5][b->slot];
    in[f] = &values[f];
  }
  for (int f = 0; f < fields + 3; f++)
    out[f] = &values[fields + 5 + f];
  double *uniforms = uniforms_of_bond(s, b, direction);
  law->states(law, uniforms, 1, in, out);
  free(uniforms);
  const double length = s->lattice->length[direction];
  k->force = worse(*out[2] / length, worse(*out[1] / length, *out[0]));
  free(values);
  free(in);
  free(out);
}

/* The rules have already been at work; a rule that gave no number is looked at from the beginning. */
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

void bad_explain(simulation *s) {
  const sweep_block *at = &s->state->blocks[sweep_bad(s->state)];
  const int32_t particle = s->lattice->site_particle[at->bad_site];
  double worst = 0;
  s->bad = (bad_state){.step = (long)s->at.step,
                       .time = simulation_time(s),
                       .particle = particle,
                       .bond_particle = -1,
                       .x = s->lattice->x[at->bad_site],
                       .y = s->lattice->y[at->bad_site]};
  s->bad.what = !isfinite(at->bad_velocity) ? "not a number"
                : at->bad_component == 2    ? "runaway rotation"
                                            : "runaway velocity";
  for (long m = 0; m < s->lattice->bond_count; m++) {
    const rows_bond *b = &s->bonds[m];
    if (b->i != particle && b->j != particle) continue;
    const int direction = (int)(b->slot / s->lattice->size);
    bond_state k = bond_kinematics(s, b, direction);
    bond_forces(s, b, direction, &k);
    if (s->bad.bond_particle >= 0 && !is_worse(k.force, worst)) continue;
    worst = k.force;
    s->bad.bond_particle = b->i == particle ? b->j : b->i;
    s->bad.stretch = k.stretch;
    s->bad.stretch_rate = k.rate;
    s->bad.theta_i = k.theta_i;
    s->bad.theta_j = k.theta_j;
    keep_fields(s, b);
  }
}

bad_state simulation_bad(const simulation *s) {
  return s->bad;
}
