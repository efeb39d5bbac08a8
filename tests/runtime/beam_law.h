/* A micropolar law of families by hand, for tests of the runtime alone: elastic beams between
   particles that displace and rotate, in the plane and in space, on rows and on lists, one pass.

   A bond of length s has stiffnesses k_n along it and k_s across it (N/m; of the second and farther
   shells k_n2, k_s2) and k_t of its twist (N m). With the chord's direction e now and the end's
   turned reference direction R e0 the end's bending is b = e x R e0 and the twist w the axial
   vector of the skew part of R_j R_i^T along e:
     N = k_n s stretch,  M_i = k_s s^2/6 (2 b_i + b_j),  M_j likewise,  T = k_t w
   force on i: N e - S, on j the opposite, S = (M_i + M_j) x e/l; moments on i: T e - M_i, on j:
   -T e - M_j: in balance exactly. R is the rotation of the vector theta (Rodrigues), so that a
   rigid motion leaves no force. */
#ifndef PERILAT_TESTS_BEAM_LAW_H
#define PERILAT_TESTS_BEAM_LAW_H

#include <math.h>
#include <string.h>

#include "runtime/kernel.h"

enum { BEAM_N, BEAM_S, BEAM_N2, BEAM_S2, BEAM_T, BEAM_TAU, BEAM_RHO, BEAM_PARAMETERS };
enum { OF_BEAM_N, OF_BEAM_S, OF_BEAM_T, OF_BEAM_TAU, OF_BEAM_LENGTH, OF_BEAM_CHORD };
enum { BEAM_UNIFORMS = OF_BEAM_CHORD + 3 };

static const pl_parameter beam_parameters[BEAM_PARAMETERS] = {
    {"k_n", "N/m", "stiffness along a bond", 5e6, 1},
    {"k_s", "N/m", "stiffness across a bond", 1e6, 1},
    {"k_n2", "N/m", "the same of farther shells", 2e6, 1},
    {"k_s2", "N/m", "the same of farther shells", 1e6, 1},
    {"k_t", "N*m", "moment over the twist", 20, 1},
    {"tau", "s", "relaxation time along a bond", 0, 1},
    {"rho", "kg/m^3", "mass density", 2000, 1}};

static void beam_prepare(const pl_law *law, const double *p, const pl_bond_class *b,
                         double *uniforms) {
  (void)law;
  uniforms[OF_BEAM_N] = p[b->shell > 1 ? BEAM_N2 : BEAM_N];
  uniforms[OF_BEAM_S] = p[b->shell > 1 ? BEAM_S2 : BEAM_S];
  uniforms[OF_BEAM_T] = p[BEAM_T];
  uniforms[OF_BEAM_TAU] = p[BEAM_TAU];
  uniforms[OF_BEAM_LENGTH] = b->s;
  memcpy(uniforms + OF_BEAM_CHORD, b->chord, sizeof b->chord);
}

static void beam_bounds(const pl_law *law, const double *p, double *lower, double *upper,
                        unsigned char *low_open, unsigned char *high_open) {
  (void)law;
  (void)p;
  for (int k = 0; k < BEAM_PARAMETERS; k++) {
    lower[k] = k == BEAM_S || k == BEAM_S2 ? -1e9 : 0;
    upper[k] = INFINITY;
    low_open[k] = k == BEAM_RHO;
    high_open[k] = 1;
  }
}

static inline void beam_cross(const double a[3], const double b[3], double out[3]) {
  for (int k = 0; k < 3; k++)
    out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static inline double beam_dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* What a vector gains when turned about theta by its length (Rodrigues): no difference of what is
   nearly alike. */
static inline void beam_turned(const double theta[3], const double v[3], double out[3]) {
  const double angle = sqrt(beam_dot(theta, theta));
  const double first = angle > 0 ? sin(angle) / angle : 1, half = sin(angle / 2);
  const double second = angle > 0 ? 2 * half * half / (angle * angle) : 0.5;
  double once[3], twice[3];
  beam_cross(theta, v, once);
  beam_cross(theta, once, twice);
  for (int k = 0; k < 3; k++)
    out[k] = first * once[k] + second * twice[k];
}

/* out += scale (v + dv) x (v + dw) */
static inline void beam_between(const double v[3], const double dv[3], const double dw[3],
                                double scale, double out[3]) {
  double before[3], after[3], both[3];
  beam_cross(dv, v, before);
  beam_cross(v, dw, after);
  beam_cross(dv, dw, both);
  for (int k = 0; k < 3; k++)
    out[k] += scale * (before[k] + after[k] + both[k]);
}

/* Axial vector of the skew part of R_j R_i^T: sum over the axes of (R_i a) x (R_j a), halved. */
static inline void beam_relative(const double theta_i[3], const double theta_j[3], double out[3]) {
  memset(out, 0, 3 * sizeof *out);
  for (int k = 0; k < 3; k++) {
    const double axis[3] = {k == 0, k == 1, k == 2};
    double at_i[3], at_j[3];
    beam_turned(theta_i, axis, at_i);
    beam_turned(theta_j, axis, at_j);
    beam_between(axis, at_i, at_j, 0.5, out);
  }
}

static inline void beam_rotation(const pl_law *law, const pl_family *f, long q, double theta[3]) {
  for (int k = 0; k < 3; k++)
    theta[k] = law->dof == 6 ? f->displacement[3 + k][q] : k == 2 ? f->displacement[2][q] : 0;
}

static inline long beam_neighbour(const pl_family *f, long k, long q) {
  return q + (f->neighbour ? f->neighbour[k * f->plane + q] : f->offset[k]);
}

static inline int beam_exists(const pl_family *f, long k, long q) {
  const long half = f->neighbours / 2;
  if (k < half) return (int)(f->bonds[q] >> k & 1);
  if (f->neighbour) return (int)(f->incoming[q] >> (k - half) & 1);
  return (int)(f->bonds[beam_neighbour(f, k, q)] >> (k - half) & 1);
}

/* Force and moment on q along its bond k, and half the energy of the bond. */
static inline double beam_of(const pl_law *law, const double *uniforms, const pl_family *f, long k,
                             long q, double force[3], double moment[3]) {
  if (!beam_exists(f, k, q)) return 0;
  const long j = beam_neighbour(f, k, q);
  const double *u = uniforms + (f->neighbour ? 0 : k) * BEAM_UNIFORMS;
  const double s = f->neighbour ? f->length[k * f->plane + q] : u[OF_BEAM_LENGTH];
  double C[3] = {0, 0, 0}, d[3] = {0, 0, 0}, v[3] = {0, 0, 0}, e[3], theta_i[3], theta_j[3];
  for (int a = 0; a < law->dimensions; a++) {
    C[a] = f->neighbour ? f->chord[a][k * f->plane + q] : u[OF_BEAM_CHORD + a];
    d[a] = f->displacement[a][j] - f->displacement[a][q];
    v[a] = f->velocity[a][j] - f->velocity[a][q];
  }
  const double c[3] = {C[0] + d[0], C[1] + d[1], C[2] + d[2]}, l = sqrt(beam_dot(c, c));
  const double stretch = (2 * beam_dot(C, d) + beam_dot(d, d)) / (s * (l + s));
  for (int a = 0; a < 3; a++)
    e[a] = c[a] / l;
  double at_i[3], at_j[3], b_i[3] = {0, 0, 0}, b_j[3] = {0, 0, 0}, twist[3], shear[3], sum[3];
  beam_rotation(law, f, q, theta_i);
  beam_rotation(law, f, j, theta_j);
  beam_turned(theta_i, C, at_i);
  beam_turned(theta_j, C, at_j);
  beam_between(C, d, at_i, 1 / (l * s), b_i);
  beam_between(C, d, at_j, 1 / (l * s), b_j);
  beam_relative(theta_i, theta_j, twist);
  const double bend = u[OF_BEAM_S] * s * s / 6, w = beam_dot(twist, e);
  const double N = u[OF_BEAM_N] * s * (stretch + u[OF_BEAM_TAU] * beam_dot(e, v) / s);
  for (int a = 0; a < 3; a++)
    sum[a] = 3 * bend * (b_i[a] + b_j[a]) / l;
  beam_cross(sum, e, shear);
  for (int a = 0; a < 3; a++) {
    force[a] += N * e[a] - shear[a];
    moment[a] += u[OF_BEAM_T] * w * e[a] - bend * (2 * b_i[a] + b_j[a]);
  }
  return 0.25 * (u[OF_BEAM_N] * s * s * stretch * stretch + u[OF_BEAM_T] * w * w +
                 2 * bend * (beam_dot(b_i, b_i) + beam_dot(b_i, b_j) + beam_dot(b_j, b_j)));
}

static void beam_forces(const pl_law *law, const double *uniforms, const pl_family *f) {
  for (long q = 0; q < f->count; q++) {
    double force[3] = {0, 0, 0}, moment[3] = {0, 0, 0};
    for (long k = 0; k < f->neighbours; k++)
      beam_of(law, uniforms, f, k, q, force, moment);
    for (int a = 0; a < law->dimensions; a++)
      f->force[a][q] = force[a];
    for (int a = law->dimensions; a < law->dof; a++)
      f->force[a][q] = moment[law->dof == 6 ? a - 3 : 2];
  }
}

static void beam_energy(const pl_law *law, const double *uniforms, const pl_family *f) {
  for (long q = 0; q < f->count; q++) {
    double force[3] = {0, 0, 0}, moment[3] = {0, 0, 0};
    f->observed[0][q] = 0;
    for (long k = 0; k < f->neighbours; k++)
      f->observed[0][q] += beam_of(law, uniforms, f, k, q, force, moment);
  }
}

static const pl_family_function beam_step[] = {beam_forces}, beam_observe[] = {beam_energy};

static inline pl_law beams_in(int dimensions, int topology) {
  return (pl_law){.abi = PL_KERNEL_ABI,
                  .size = sizeof(pl_law),
                  .stores = 1,
                  .kind = PL_STATE,
                  .pairwise = 1,
                  .topology = topology,
                  .dimensions = dimensions,
                  .dof = dimensions == 2 ? 3 : 6,
                  .name = "beams",
                  .key = "beams",
                  .parameter_count = BEAM_PARAMETERS,
                  .density = BEAM_RHO,
                  .parameters = beam_parameters,
                  .uniform_count = BEAM_UNIFORMS,
                  .prepare = beam_prepare,
                  .bounds = beam_bounds,
                  .step = {1, beam_step},
                  .observe = {1, beam_observe}};
}

/* Beams of the face-centred lattice with two shells that make an isotropic solid: along less across
   is four times as much in the first shell as in the second. With L the first length and a cell of
   L^3/root 2: lambda = L^2 (k_n - k_s)/(2 V), mu - lambda = L^2 (k_s + k_s2)/V. */
static inline void beam_isotropic(double E, double nu, double L, double *parameters) {
  const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
  const double V = L * L * L / sqrt(2), across = V * (mu - lambda) / (L * L);
  for (int p = 0; p < BEAM_PARAMETERS; p++)
    parameters[p] = beam_parameters[p].initial;
  parameters[BEAM_S] = 0.6 * across;
  parameters[BEAM_S2] = 0.4 * across;
  parameters[BEAM_N] = parameters[BEAM_S] + 2 * V * lambda / (L * L);
  parameters[BEAM_N2] = parameters[BEAM_S2] + V * lambda / (2 * L * L);
  parameters[BEAM_T] = 0.1 * across * L * L;
}

#endif
