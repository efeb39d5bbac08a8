#include "runtime/analysis/bond_probe.h"

#include <stdlib.h>
#include <string.h>

#include "dsl/base/arena.h"

bond_probe *bond_probe_new(const pl_law *law, const double *parameters,
                           const pl_bond_class *bonds) {
  const size_t fields = (size_t)law->field_count;
  bond_probe *p = must_calloc(1, sizeof *p);
  p->law = law;
  p->s = bonds->s;
  p->uniforms = must_calloc((size_t)law->uniform_count + 1, sizeof(double));
  p->fields = must_calloc(2 * fields + 1, sizeof *p->fields);
  p->new_fields = p->fields + fields;
  p->field = must_calloc(fields + 1, sizeof *p->field);
  p->new_field = must_calloc(fields + 1, sizeof *p->new_field);
  for (size_t k = 0; k < PL_STATE_INPUTS; k++)
    p->in[k] = &p->motion[k];
  for (size_t k = 0; k < PL_TANGENTS; k++)
    p->out[k] = &p->results[k];
  for (size_t f = 0; f < fields; f++) {
    p->field[f] = &p->fields[f];
    p->new_field[f] = &p->new_fields[f];
  }
  p->states = (pl_states){.size = sizeof p->states,
                          .count = 1,
                          .in = p->in,
                          .field = p->field,
                          .out = p->out,
                          .new_field = p->new_field};
  bond_probe_reset(p);
  law->prepare(law, parameters, bonds, p->uniforms);
  return p;
}

void bond_probe_free(bond_probe *p) {
  if (!p) return;
  free(p->uniforms);
  free(p->fields);
  free(p->field);
  free(p->new_field);
  free(p);
}

void bond_probe_reset(bond_probe *p) {
  for (int f = 0; f < p->law->field_count; f++)
    p->fields[f] = p->law->fields[f].initial;
}

static void move(bond_probe *p, bond_motion m) {
  const double motion[PL_STATE_INPUTS] = {m.stretch, m.rate, m.theta_i, m.theta_j,
                                          p->s * (1 + m.stretch), 0};
  memcpy(p->motion, motion, sizeof motion);
}

void bond_probe_forces(bond_probe *p, bond_motion m, double forces[PL_STATE_RESULTS]) {
  move(p, m);
  p->law->states(p->law, p->uniforms, &p->states);
  memcpy(forces, p->results, PL_STATE_RESULTS * sizeof *forces);
}

void bond_probe_tangent(bond_probe *p, bond_motion m, double tangent[PL_TANGENTS]) {
  move(p, m);
  p->law->tangent(p->law, p->uniforms, &p->states);
  memcpy(tangent, p->results, PL_TANGENTS * sizeof *tangent);
}

void bond_probe_accept(bond_probe *p) {
  memcpy(p->fields, p->new_fields, (size_t)p->law->field_count * sizeof *p->fields);
}
