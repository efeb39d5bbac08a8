/* The law alone on one bond: forces and tangent in given states, through pl_law's `states` and
   `tangent`. The bond's fields are carried along by the caller's leave: a step shows the new ones,
   bond_probe_accept takes them over. One thread at a time. */
#ifndef PERILAT_RUNTIME_BOND_PROBE_H
#define PERILAT_RUNTIME_BOND_PROBE_H

#include "runtime/kernel.h"

typedef struct bond_motion {
  double stretch, rate, theta_i, theta_j; /* 1, 1/s, rad, rad; the length follows the stretch */
} bond_motion;

typedef struct bond_probe {
  double s;           /* reference length, m */
  double *fields;     /* [law's fields] at hand; at first their initial values */
  double *new_fields; /* [law's fields] of the last bond_probe_forces; only to be read */
  const pl_law *law;

  /* own */
  pl_states states;
  double *uniforms, motion[PL_STATE_INPUTS], results[PL_TANGENTS];
  const double *in[PL_STATE_INPUTS], **field;
  double *out[PL_TANGENTS], **new_field;
} bond_probe;

bond_probe *bond_probe_new(const pl_law *law, const double *parameters, const pl_bond_class *bonds);
void bond_probe_free(bond_probe *p);

/* The fields as they are in a new bond. */
void bond_probe_reset(bond_probe *p);
/* N (N), M_i, M_j (N m); the fields at hand stay. */
void bond_probe_forces(bond_probe *p, bond_motion m, double forces[PL_STATE_RESULTS]);
/* d(N, M_i, M_j)/d(stretch, rate, theta_i, theta_j), row by row. */
void bond_probe_tangent(bond_probe *p, bond_motion m, double tangent[PL_TANGENTS]);
/* The new fields of the last bond_probe_forces become those at hand. */
void bond_probe_accept(bond_probe *p);

#endif
