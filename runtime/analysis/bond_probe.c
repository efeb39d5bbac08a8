#include "runtime/analysis/bond_probe.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

bond_probe *bond_probe_new(const pl_law *law, const double *parameters,
                           const pl_bond_class *bonds) {
  const size_t fields = (size_t)law->field_count;
  const size_t states = PL_STATE_RESULTS + fields;
  const size_t results = states > PL_TANGENTS ? states : PL_TANGENTS;
  bond_probe *p = must_calloc(1, sizeof *p);
  p->law = law;
  p->s = bonds->s;
  p->uniforms = must_calloc((size_t)law->uniform_count + 1, sizeof(double));
  p->memory = must_calloc(fields + results, sizeof(double));
  p->fields = p->memory;
  p->results = p->memory + fields;
  p->new_fields = p->results + PL_STATE_RESULTS;
  p->in = must_calloc(PL_STATE_INPUTS + fields, sizeof *p->in);
  p->out = must_calloc(results, sizeof *p->out);
  for (size_t k = 0; k < PL_STATE_INPUTS; k++)
    p->in[k] = &p->motion[k];
  for (size_t f = 0; f < fields; f++)
    p->in[PL_STATE_INPUTS + f] = &p->fields[f];
  for (size_t k = 0; k < results; k++)
    p->out[k] = &p->results[k];
  bond_probe_reset(p);
  law->prepare(law, parameters, bonds, p->uniforms);
  return p;
}

void bond_probe_free(bond_probe *p) {
  if (!p) return;
  free(p->uniforms);
  free(p->memory);
  free(p->in);
  free(p->out);
  free(p);
}

void bond_probe_reset(bond_probe *p) {
  for (int f = 0; f < p->law->field_count; f++)
    p->fields[f] = p->law->fields[f].initial;
}

static void move(bond_probe *p, bond_motion m) {
  const double motion[PL_STATE_INPUTS] = {m.stretch, m.rate, m.theta_i, m.theta_j,
                                          p->s * (1 + m.stretch)};
  memcpy(p->motion, motion, sizeof motion);
}

void bond_probe_forces(bond_probe *p, bond_motion m, double forces[PL_STATE_RESULTS]) {
  move(p, m);
  p->law->states(p->law, p->uniforms, 1, p->in, p->out);
  memcpy(forces, p->results, PL_STATE_RESULTS * sizeof *forces);
}

void bond_probe_tangent(bond_probe *p, bond_motion m, double tangent[PL_TANGENTS]) {
  move(p, m);
  p->law->tangent(p->law, p->uniforms, 1, p->in, p->out);
  memcpy(tangent, p->results, PL_TANGENTS * sizeof *tangent);
}

void bond_probe_accept(bond_probe *p) {
  memcpy(p->fields, p->new_fields, (size_t)p->law->field_count * sizeof *p->fields);
}
