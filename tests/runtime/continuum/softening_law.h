/* A law with a state and a damage as a kernel by hand, in plane stress: Hooke's stress times
   1 - omega, omega = kappa/(kappa + k), kappa the largest size of the strain so far. It resists the
   strain rate with `tau` times Hooke's stress of that. Parameters E, nu, rho, k, tau. */
#ifndef PERILAT_TESTS_SOFTENING_LAW_H
#define PERILAT_TESTS_SOFTENING_LAW_H

#include <math.h>

#include "hooke_law.h"

enum { SOFT_KAPPA, SOFT_OMEGA, SOFT_FIELDS };

static const pl_parameter softening_parameters[] = {{"E", "Pa", "", 30e9, 1},
                                                    {"nu", "1", "", 0.2, 1},
                                                    {"rho", "kg/m^3", "", 2400, 1},
                                                    {"k", "1", "", 1e-3, 1},
                                                    {"tau", "s", "", 0, 1}};
static const pl_field softening_fields[] = {
    {"kappa", "1", "largest strain", 1e-6, PL_FIELD_STATE, PL_ON_POINT},
    {"omega", "1", "damage", 0, PL_FIELD_DAMAGE, PL_ON_POINT}};
static const pl_field softening_outputs[] = {
    {"press", "Pa", "mean stress", 0, PL_FIELD_OUTPUT, PL_ON_POINT}};

static void softening_prepare(const pl_law *law, const double *parameters,
                              const pl_bond_class *bonds, double *uniforms) {
  hooke_prepare(law, parameters, bonds, uniforms);
  uniforms[3] = parameters[3];
  uniforms[4] = parameters[4];
}

static void softening_bounds(const pl_law *law, const double *parameters, double *lower,
                             double *upper, unsigned char *low_open, unsigned char *high_open) {
  hooke_bounds(law, parameters, lower, upper, low_open, high_open);
  low_open[4] = 0;
}

static void softening_stress(const double *D, const double *const *strain, long q, double out[3]) {
  out[0] = D[0] * strain[0][q] + D[1] * strain[1][q];
  out[1] = D[1] * strain[0][q] + D[0] * strain[1][q];
  out[2] = 2 * D[2] * strain[2][q];
}

/* stress : rate of deformation */
static double softening_product(const double stress[3], const double *const *strain, long q) {
  return stress[0] * strain[0][q] + stress[1] * strain[1][q] + 2 * stress[2] * strain[2][q];
}

static void softening_step(const pl_law *law, const double *uniforms, const pl_points *p) {
  (void)law;
  for (long q = 0; q < p->count; q++) {
    double s[3], viscous[3];
    softening_stress(uniforms, p->strain, q, s);
    softening_stress(uniforms, p->strain_rate, q, viscous);
    const double x = p->strain[0][q], y = p->strain[1][q], xy = p->strain[2][q],
                 kappa = fmax(p->old_field[SOFT_KAPPA][q], sqrt(x * x + y * y + 2 * xy * xy)),
                 omega = kappa / (kappa + uniforms[3]);
    p->new_field[SOFT_KAPPA][q] = kappa;
    p->new_field[SOFT_OMEGA][q] = omega;
    for (int c = 0; c < 3; c++)
      p->stress[c][q] = (1 - omega) * s[c] + uniforms[4] * viscous[c];
    p->stress[3][q] = 0;
  }
}

/* With the term that is due to forces halfway (ledger.h). */
static void softening_ledger(const pl_law *law, const double *uniforms, const pl_points *p) {
  softening_step(law, uniforms, p);
  for (long q = 0; q < p->count; q++) {
    double s[3], viscous[3];
    softening_stress(uniforms, p->strain, q, s);
    softening_stress(uniforms, p->strain_rate, q, viscous);
    p->lost[PL_LOST_TO_STATES][q] += (p->new_field[SOFT_OMEGA][q] - p->old_field[SOFT_OMEGA][q]) *
                                     0.5 *
                                     (softening_product(s, p->strain, q) -
                                      p->time_step * softening_product(s, p->strain_rate, q));
    p->lost[PL_LOST_TO_RATES][q] +=
        p->time_step * uniforms[4] * softening_product(viscous, p->strain_rate, q);
  }
}

static void softening_observe(const pl_law *law, const double *uniforms, const pl_points *p) {
  (void)law;
  for (long q = 0; q < p->count; q++) {
    double s[3];
    softening_stress(uniforms, p->strain, q, s);
    p->observed[0][q] =
        (1 - p->old_field[SOFT_OMEGA][q]) * 0.5 * softening_product(s, p->strain, q);
    p->observed[1][q] = (1 - p->old_field[SOFT_OMEGA][q]) * (s[0] + s[1]) / 3;
  }
}

static const pl_law softening_law = {.abi = PL_KERNEL_ABI,
                                     .size = sizeof(pl_law),
                                     .kind = PL_CONTINUUM,
                                     .dimensions = 2,
                                     .dof = 2,
                                     .name = "softening",
                                     .key = "",
                                     .parameter_count = 5,
                                     .parameters = softening_parameters,
                                     .density = 2,
                                     .field_count = SOFT_FIELDS,
                                     .fields = softening_fields,
                                     .output_count = 1,
                                     .outputs = softening_outputs,
                                     .stores = 1,
                                     .reads_rates = 1,
                                     .uniform_count = 5,
                                     .prepare = softening_prepare,
                                     .bounds = softening_bounds,
                                     .point_step = softening_step,
                                     .point_ledger = softening_ledger,
                                     .point_observe = softening_observe,
                                     .point_tangent = hooke_tangent,
                                     .failed_field = -1};

#endif
