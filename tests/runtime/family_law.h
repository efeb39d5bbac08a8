/* A law of families by hand, for tests of the runtime alone: the elastic hexagon of Nikravesh 2017
   (eq 4.5, plane stress) with particle damage, an axial viscous term and a memory on neighbours.
     F_ij = (1 - omega_i) (a S_ij + b sum_m S_im + a tau dS_ij/dt),  bond force: mean of both sides
   along the present bond
     omega_i = min(1, (max_j S_ij - S_t)/S_t), never decreasing;  most_ij = max over time of S_ij
   Energy of a particle: (1 - omega) L0/4 (a sum S^2 + b (sum S)^2). Two passes: the first writes
   omega, most and, into links, sum S and 1 - omega; the second the forces.

   On lists a and b are those of the spacing, stretches are by the bonds' own lengths s, and bond
   forces have the factor L0/s that they follow from the energy with. */
#ifndef PERILAT_TESTS_FAMILY_LAW_H
#define PERILAT_TESTS_FAMILY_LAW_H

#include <math.h>

#include "runtime/kernel.h"

enum { FAMILY_E, FAMILY_NU, FAMILY_RHO, FAMILY_TAU, FAMILY_S_T, FAMILY_PARAMETERS };
enum {
  FAMILY_A,
  FAMILY_B,
  FAMILY_VISCOUS,
  FAMILY_ONSET,
  FAMILY_S,
  FAMILY_CHORD,
  FAMILY_UNIFORMS = FAMILY_CHORD + 3
};
enum { LINK_SUM, LINK_LEFT, FAMILY_LINKS };

static const pl_parameter family_parameters[FAMILY_PARAMETERS] = {
    {"E", "Pa", "Young's modulus", 30e9, 1},
    {"nu", "1", "Poisson's ratio", 0.2, 1},
    {"rho", "kg/m^3", "mass density", 2323, 1},
    {"tau", "s", "axial relaxation time", 0, 1},
    {"S_t", "1", "stretch where damage begins", 1e30, 1},
};

static const pl_field family_fields[] = {
    {"omega", "1", "damage", 0, PL_FIELD_DAMAGE, PL_ON_PARTICLE},
    {"most", "1", "largest stretch so far", -1, PL_FIELD_STATE, PL_ON_NEIGHBOUR}};
static const pl_field family_outputs[] = {
    {"energy", "J", "stored energy", 0, PL_FIELD_OUTPUT, PL_ON_PARTICLE},
    {"stretches", "1", "stretch", 0, PL_FIELD_OUTPUT, PL_ON_NEIGHBOUR},
    {"xx", "1", "strain fitted to the stretches", 0, PL_FIELD_OUTPUT, PL_ON_PARTICLE}};

static void family_prepare(const pl_law *law, const double *p, const pl_bond_class *b,
                           double *uniforms) {
  (void)law;
  const double E = p[FAMILY_E], nu = p[FAMILY_NU];
  uniforms[FAMILY_A] = 2 * E * b->s * b->t / (sqrt(3) * (1 + nu));
  uniforms[FAMILY_B] = E * b->s * b->t * (1 - 3 * nu) / (6 * sqrt(3) * (nu * nu - 1));
  uniforms[FAMILY_VISCOUS] = uniforms[FAMILY_A] * p[FAMILY_TAU];
  uniforms[FAMILY_ONSET] = p[FAMILY_S_T];
  uniforms[FAMILY_S] = b->s;
  for (int c = 0; c < 3; c++)
    uniforms[FAMILY_CHORD + c] = b->chord[c];
}

static void family_bounds(const pl_law *law, const double *p, double *lower, double *upper,
                          unsigned char *low_open, unsigned char *high_open) {
  (void)law;
  (void)p;
  for (int k = 0; k < FAMILY_PARAMETERS; k++) {
    lower[k] = 0;
    upper[k] = k == FAMILY_NU ? 0.5 : INFINITY;
    low_open[k] = k == FAMILY_E || k == FAMILY_RHO || k == FAMILY_S_T;
    high_open[k] = 1;
  }
}

typedef struct family_bond {
  int exists;
  double stretch, rate, e[2], arm; /* arm: L0/s */
} family_bond;

static long family_neighbour(const pl_family *f, long k, long q) {
  return q + (f->neighbour ? f->neighbour[k * f->plane + q] : f->offset[k]);
}

static long family_neighbours_link(const pl_family *f, long k, long q) {
  return q + (f->neighbour ? f->neighbour[k * f->plane + q] : f->link_offset[k]);
}

static int family_has_bond(const pl_family *f, long k, long q) {
  const long half = f->neighbours / 2;
  if (k < half) return (int)(f->bonds[q] >> k & 1);
  if (f->neighbour) return (int)(f->incoming[q] >> (k - half) & 1);
  return (int)(f->bonds[family_neighbour(f, k, q)] >> (k - half) & 1);
}

static const double *family_uniforms_of(const double *uniforms, const pl_family *f, long k) {
  return f->neighbour ? uniforms : uniforms + k * FAMILY_UNIFORMS;
}

/* Reference chord; returns its length. */
static double family_chord(const double *uniforms, const pl_family *f, long k, long q,
                           double C[2]) {
  const double *u = family_uniforms_of(uniforms, f, k);
  for (int a = 0; a < 2; a++)
    C[a] = f->neighbour ? f->chord[a][k * f->plane + q] : u[FAMILY_CHORD + a];
  return f->neighbour ? f->length[k * f->plane + q] : u[FAMILY_S];
}

static family_bond family_look(const double *uniforms, const pl_family *f, long k, long q) {
  const long j = family_neighbour(f, k, q);
  family_bond b = {.exists = family_has_bond(f, k, q)};
  double C[2];
  if (!b.exists) return b;
  const double s = family_chord(uniforms, f, k, q, C);
  const double d[2] = {f->displacement[0][j] - f->displacement[0][q],
                       f->displacement[1][j] - f->displacement[1][q]};
  const double c[2] = {C[0] + d[0], C[1] + d[1]}, length = sqrt(c[0] * c[0] + c[1] * c[1]);
  b.arm = f->neighbour ? uniforms[FAMILY_S] / s : 1;
  b.stretch = (2 * (C[0] * d[0] + C[1] * d[1]) + d[0] * d[0] + d[1] * d[1]) / (s * (length + s));
  for (int a = 0; a < 2; a++) {
    b.e[a] = c[a] / length;
    b.rate += b.e[a] * (f->velocity[a][j] - f->velocity[a][q]) / s;
  }
  return b;
}

/* Sites of a run, row after row. */
static long family_end(const pl_family *f) {
  return (f->rows - 1) * f->row_stride + f->count;
}

static long family_next(const pl_family *f, long q) {
  const int last_of_row = f->rows > 1 && (q + 1) % f->row_stride == f->count;
  return q + 1 + (last_of_row ? f->row_stride - f->count : 0);
}

static void family_fields_pass(const pl_law *law, const double *uniforms, const pl_family *f) {
  (void)law;
  for (long q = 0; q < family_end(f); q = family_next(f, q)) {
    double sum = 0, largest = 0;
    for (long k = 0; k < f->neighbours; k++) {
      const family_bond b = family_look(uniforms, f, k, q);
      const double most = f->old_field[1][k * f->plane + q];
      sum += b.stretch;
      largest = fmax(largest, b.stretch);
      f->new_field[1][k * f->new_plane + q] = b.exists ? fmax(most, b.stretch) : most;
    }
    const double onset = uniforms[FAMILY_ONSET], old = f->old_field[0][q];
    const double grown = fmin(1, fmax(0, (largest - onset) / onset));
    f->new_field[0][q] = f->held[q] || !(grown >= old) ? old : grown;
    f->link[LINK_SUM][q] = sum;
    f->link[LINK_LEFT][q] = 1 - f->new_field[0][q];
  }
}

/* Force state of a particle toward a bond. */
static double family_state(const double *u, const pl_family *f, long at, const family_bond *b) {
  return f->link[LINK_LEFT][at] * (u[FAMILY_A] * b->stretch + u[FAMILY_B] * f->link[LINK_SUM][at] +
                                   u[FAMILY_VISCOUS] * b->rate);
}

static void family_force_pass(const pl_law *law, const double *uniforms, const pl_family *f) {
  (void)law;
  for (long q = 0; q < family_end(f); q = family_next(f, q)) {
    double force[2] = {0, 0};
    for (long k = 0; k < f->neighbours; k++) {
      const double *u = family_uniforms_of(uniforms, f, k);
      const family_bond b = family_look(uniforms, f, k, q);
      if (!b.exists) continue;
      const long j = family_neighbours_link(f, k, q);
      const double N = (family_state(u, f, q, &b) + family_state(u, f, j, &b)) / 2;
      for (int a = 0; a < 2; a++)
        force[a] += b.arm * N * b.e[a];
    }
    for (int a = 0; a < 2; a++)
      f->force[a][q] = force[a];
  }
}

static void family_observe_pass(const pl_law *law, const double *uniforms, const pl_family *f) {
  (void)law;
  for (long q = 0; q < family_end(f); q = family_next(f, q)) {
    double sum = 0, squares = 0, products[3] = {0, 0, 0};
    for (long k = 0; k < f->neighbours; k++) {
      double C[2];
      const double s = family_chord(uniforms, f, k, q, C), weight = f->neighbour ? s : 1;
      const family_bond b = family_look(uniforms, f, k, q);
      const double n[3] = {C[0] * C[0] / (s * s), C[1] * C[1] / (s * s), C[0] * C[1] / (s * s)};
      sum += b.stretch;
      squares += b.stretch * b.stretch;
      for (int a = 0; a < 3; a++)
        products[a] += weight * n[a] * b.stretch;
      f->observed[2][k * f->new_plane + q] = b.stretch;
    }
    f->observed[0][q] = (1 - f->old_field[0][q]) * uniforms[FAMILY_S] / 4 *
                        (uniforms[FAMILY_A] * squares + uniforms[FAMILY_B] * sum * sum);
    f->observed[1][q] = f->observed[0][q];
    f->observed[3][q] =
        f->shape[0][q] * products[0] + f->shape[1][q] * products[1] + f->shape[2][q] * products[2];
  }
}

/* The law for lists. */
static inline pl_law family_for_lists(const pl_law *law) {
  pl_law list = *law;
  list.topology = PL_LIST;
  return list;
}

static const pl_family_function family_step[] = {family_fields_pass, family_force_pass};
static const pl_family_function family_observe[] = {family_observe_pass};

static const pl_law family_hexagon = {.abi = PL_KERNEL_ABI,
                                      .size = sizeof(pl_law),
                                      .stores = 1,
                                      .kind = PL_STATE,
                                      .dimensions = 2,
                                      .dof = 2,
                                      .name = "family_hexagon",
                                      .key = "family_hexagon",
                                      .parameter_count = FAMILY_PARAMETERS,
                                      .density = FAMILY_RHO,
                                      .parameters = family_parameters,
                                      .field_count = 2,
                                      .fields = family_fields,
                                      .output_count = 3,
                                      .outputs = family_outputs,
                                      .uniform_count = FAMILY_UNIFORMS,
                                      .prepare = family_prepare,
                                      .bounds = family_bounds,
                                      .link_count = FAMILY_LINKS,
                                      .reads_shape = 1,
                                      .step = {2, family_step},
                                      .observe = {1, family_observe}};

#endif
