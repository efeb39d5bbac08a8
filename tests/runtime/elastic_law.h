/* A law by hand, for tests of the runtime alone: a co-rotational beam (or bar, kind central) that
   is linear in its deformations, with an axial viscous term and, beyond the stretch S_t, linear
   damage. N = (1 - omega) EA (stretch + tau rate),  M_i = (1 - omega) 2 EI/s (2 theta_i + theta_j)
     omega = min(1, (stretch - S_t)/S_t), never decreasing */
#ifndef PERILAT_TESTS_ELASTIC_LAW_H
#define PERILAT_TESTS_ELASTIC_LAW_H

#include <math.h>

#include "runtime/kernel.h"

enum { ELASTIC_E, ELASTIC_NU, ELASTIC_RHO, ELASTIC_TAU, ELASTIC_S_T, ELASTIC_PARAMETERS };
enum {
  UNIFORM_EA,
  UNIFORM_EI,
  UNIFORM_TAU,
  UNIFORM_S_T,
  UNIFORM_S,
  UNIFORM_CX,
  UNIFORM_CY,
  ELASTIC_UNIFORMS
};

static const pl_parameter elastic_parameters[ELASTIC_PARAMETERS] = {
    {"E", "Pa", "Young's modulus", 30e9, 1},
    {"nu", "1", "Poisson's ratio", 0.2, 1},
    {"rho", "kg/m^3", "mass density", 2323, 1},
    {"tau", "s", "axial relaxation time", 0, 1},
    {"S_t", "1", "stretch where damage begins", 1e30, 1},
};

static const pl_field elastic_fields[] = {{"omega", "1", "damage", 0, PL_FIELD_DAMAGE, PL_ON_BOND}};
static const pl_field elastic_outputs[] = {
    {"axial", "N", "axial force", 0, PL_FIELD_OUTPUT, PL_ON_BOND}};

/* Rigidities of a hexagonal lattice in plane stress (Asadollahi 2014, eq 2.49). */
static void elastic_prepare(const pl_law *law, const double *p, const pl_bond_class *b,
                            double *uniforms) {
  (void)law;
  const double nu = p[ELASTIC_NU], s = b->s;
  uniforms[UNIFORM_EA] = p[ELASTIC_E] * s * b->t / (sqrt(3) * (1 - nu));
  uniforms[UNIFORM_EI] =
      p[ELASTIC_E] * s * s * s * b->t * (1 - 3 * nu) / (12 * sqrt(3) * (1 - nu * nu));
  uniforms[UNIFORM_TAU] = p[ELASTIC_TAU];
  uniforms[UNIFORM_S_T] = p[ELASTIC_S_T];
  uniforms[UNIFORM_S] = s;
  uniforms[UNIFORM_CX] = b->chord[0];
  uniforms[UNIFORM_CY] = b->chord[1];
}

static void elastic_bounds(const pl_law *law, const double *p, double *lower, double *upper,
                           unsigned char *low_open, unsigned char *high_open) {
  (void)law;
  (void)p;
  static const double low[ELASTIC_PARAMETERS] = {0, 0, 0, 0, 0};
  static const double high[ELASTIC_PARAMETERS] = {INFINITY, 1.0 / 3, INFINITY, INFINITY, INFINITY};
  for (int k = 0; k < ELASTIC_PARAMETERS; k++) {
    lower[k] = low[k];
    upper[k] = high[k];
    low_open[k] = k == ELASTIC_E || k == ELASTIC_RHO || k == ELASTIC_S_T;
    high_open[k] = k != ELASTIC_NU;
  }
}

typedef struct elastic_bond {
  double stretch, rate, theta_i, theta_j, length, e[2];
  double N, M_i, M_j, omega;
} elastic_bond;

static void elastic_forces(const double *u, double omega, int kept, elastic_bond *b) {
  const double grown = fmin(1, fmax(0, (b->stretch - u[UNIFORM_S_T]) / u[UNIFORM_S_T]));
  b->omega = kept || !(grown >= omega) ? omega : grown; /* a field that is no number stays so */
  b->N = (1 - b->omega) * u[UNIFORM_EA] * (b->stretch + u[UNIFORM_TAU] * b->rate);
  const double bending = (1 - b->omega) * 2 * u[UNIFORM_EI] / u[UNIFORM_S];
  b->M_i = bending * (2 * b->theta_i + b->theta_j);
  b->M_j = bending * (2 * b->theta_j + b->theta_i);
}

static double elastic_energy(const double *u, const elastic_bond *b) { /* undamaged, J */
  return 0.5 * u[UNIFORM_EA] * u[UNIFORM_S] * b->stretch * b->stretch +
         2 * u[UNIFORM_EI] / u[UNIFORM_S] *
             (b->theta_i * b->theta_i + b->theta_i * b->theta_j + b->theta_j * b->theta_j);
}

static elastic_bond elastic_kinematics(const pl_law *law, const double *u, const pl_strip *s,
                                       long q) {
  elastic_bond b = {0};
  const double C[2] = {u[UNIFORM_CX], u[UNIFORM_CY]};
  const double d[2] = {s->displacement_j[0][q] - s->displacement_i[0][q],
                       s->displacement_j[1][q] - s->displacement_i[1][q]};
  const double c[2] = {C[0] + d[0], C[1] + d[1]};
  b.length = sqrt(c[0] * c[0] + c[1] * c[1]);
  b.e[0] = c[0] / b.length;
  b.e[1] = c[1] / b.length;
  b.stretch = (2 * (C[0] * d[0] + C[1] * d[1]) + d[0] * d[0] + d[1] * d[1]) /
              (u[UNIFORM_S] * (b.length + u[UNIFORM_S]));
  b.rate = (b.e[0] * (s->velocity_j[0][q] - s->velocity_i[0][q]) +
            b.e[1] * (s->velocity_j[1][q] - s->velocity_i[1][q])) /
           u[UNIFORM_S];
  if (law->kind == PL_CENTRAL) return b;
  const double turn = atan2(C[0] * c[1] - C[1] * c[0], C[0] * c[0] + C[1] * c[1]);
  b.theta_i = remainder(s->displacement_i[2][q] - turn, 2 * acos(-1));
  b.theta_j = remainder(s->displacement_j[2][q] - turn, 2 * acos(-1));
  return b;
}

static void elastic_strip(const pl_law *law, const double *u, const pl_strip *s, int with_losses) {
  for (long q = 0; q < s->count; q++) {
    if (!(s->flags[q] & PL_PRESENT(s->direction))) {
      for (int p = 0; p < law->force_planes; p++)
        s->force[p][q] = 0;
      continue;
    }
    elastic_bond b = elastic_kinematics(law, u, s, q);
    const double before = s->field[0][q];
    elastic_forces(u, before, (s->flags[q] & PL_PROTECTED(s->direction)) != 0, &b);
    const double V = law->kind == PL_CENTRAL ? 0 : (b.M_i + b.M_j) / b.length;
    s->field[0][q] = b.omega;
    s->force[0][q] = b.N * b.e[0] + V * b.e[1];
    s->force[1][q] = b.N * b.e[1] - V * b.e[0];
    if (law->kind == PL_MICROPOLAR) {
      s->force[2][q] = b.M_i;
      s->force[3][q] = b.M_j;
    }
    if (!with_losses) continue;
    s->dissipated_state[q] += (b.omega - before) * elastic_energy(u, &b);
    s->dissipated_rate[q] += (1 - b.omega) * u[UNIFORM_EA] * u[UNIFORM_TAU] * u[UNIFORM_S] *
                             b.rate * b.rate * s->time_step;
  }
}

static void elastic_rows(const pl_law *law, const double *u, const pl_strip *s) {
  elastic_strip(law, u, s, 0);
}
static void elastic_rows_ledger(const pl_law *law, const double *u, const pl_strip *s) {
  elastic_strip(law, u, s, 1);
}

static void elastic_rows_observe(const pl_law *law, const double *u, const pl_strip *s) {
  for (long q = 0; q < s->count; q++) {
    elastic_bond b = elastic_kinematics(law, u, s, q);
    elastic_forces(u, s->field[0][q], 1, &b);
    s->observed[0][q] = (1 - b.omega) * elastic_energy(u, &b);
    s->observed[1][q] = b.N;
  }
}

static void elastic_states(const pl_law *law, const double *u, const pl_states *s) {
  (void)law;
  for (long q = 0; q < s->count; q++) {
    elastic_bond b = {s->in[0][q], s->in[1][q], s->in[2][q], s->in[3][q], s->in[4][q],
                      {1, 0},      0,           0,           0,           0};
    elastic_forces(u, s->field[0][q], 0, &b);
    s->out[0][q] = b.N;
    s->out[1][q] = b.M_i;
    s->out[2][q] = b.M_j;
    s->new_field[0][q] = b.omega;
  }
}

static void elastic_tangent(const pl_law *law, const double *u, const pl_states *s) {
  const double EI = law->kind == PL_CENTRAL ? 0 : u[UNIFORM_EI];
  for (long q = 0; q < s->count; q++) {
    const double left = 1 - s->field[0][q], bending = 2 * left * EI / u[UNIFORM_S];
    const double d[12] = {left * u[UNIFORM_EA],
                          left * u[UNIFORM_EA] * u[UNIFORM_TAU],
                          0,
                          0,
                          0,
                          0,
                          2 * bending,
                          bending,
                          0,
                          0,
                          bending,
                          2 * bending};
    for (int k = 0; k < 12; k++)
      s->out[k][q] = d[k];
  }
}

#define ELASTIC_LAW(law_kind, law_name, law_dof, planes)                                           \
  {                                                                                                \
    .abi = PL_KERNEL_ABI, .size = sizeof(pl_law), .stores = 1, .kind = law_kind, .dimensions = 2,  \
    .dof = law_dof, .force_planes = planes, .name = law_name, .key = law_name,                     \
    .parameter_count = ELASTIC_PARAMETERS, .parameters = elastic_parameters,                       \
    .density = ELASTIC_RHO, .field_count = 1, .fields = elastic_fields, .output_count = 1,         \
    .outputs = elastic_outputs, .uniform_count = ELASTIC_UNIFORMS, .prepare = elastic_prepare,     \
    .bounds = elastic_bounds, .rows = elastic_rows, .rows_ledger = elastic_rows_ledger,            \
    .rows_observe = elastic_rows_observe, .states = elastic_states, .tangent = elastic_tangent     \
  }

static const pl_law elastic_beam = ELASTIC_LAW(PL_MICROPOLAR, "elastic_beam", 3, 4);
static const pl_law elastic_bar = ELASTIC_LAW(PL_CENTRAL, "elastic_bar", 2, 2);

#endif
