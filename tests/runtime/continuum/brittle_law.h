/* Hooke's law in plane stress whose points fail, for good, at a largest principal strain:
   parameters E, nu, rho, eps_u. */
#ifndef PERILAT_TESTS_BRITTLE_LAW_H
#define PERILAT_TESTS_BRITTLE_LAW_H

#include <math.h>

#include "hooke_law.h"

static const pl_parameter brittle_parameters[] = {{"E", "Pa", "", 30e9, 1},
                                                  {"nu", "1", "", 0.2, 1},
                                                  {"rho", "kg/m^3", "", 2400, 1},
                                                  {"eps_u", "1", "", 1e-4, 1}};
static const pl_field brittle_fields[] = {
    {"failed", "1", "the point has failed", 0, PL_FIELD_DAMAGE, PL_ON_POINT}};

static void brittle_prepare(const pl_law *law, const double *parameters, const pl_bond_class *bonds,
                            double *uniforms) {
  hooke_prepare(law, parameters, bonds, uniforms);
  uniforms[3] = parameters[3];
}

static void brittle_step(const pl_law *law, const double *uniforms, const pl_points *p) {
  hooke_step(law, uniforms, p);
  for (long q = 0; q < p->count; q++) {
    const double x = p->strain[0][q], y = p->strain[1][q], xy = p->strain[2][q];
    const double largest = 0.5 * (x + y) + sqrt(0.25 * (x - y) * (x - y) + xy * xy);
    const double failed = p->old_field[0][q] >= 1 || largest >= uniforms[3] ? 1 : 0;
    p->new_field[0][q] = failed;
    for (int c = 0; c < 3 && failed > 0; c++)
      p->stress[c][q] = 0;
  }
}

/* With the term that is due to forces halfway (ledger.h). */
static void brittle_ledger(const pl_law *law, const double *uniforms, const pl_points *p) {
  brittle_step(law, uniforms, p);
  for (long q = 0; q < p->count; q++) {
    const double x = p->strain[0][q], y = p->strain[1][q], xy = p->strain[2][q];
    const double s[3] = {uniforms[0] * x + uniforms[1] * y, uniforms[1] * x + uniforms[0] * y,
                         4 * uniforms[2] * xy}; /* of the shear twice */
    const double before[3] = {x - p->time_step * p->strain_rate[0][q],
                              y - p->time_step * p->strain_rate[1][q],
                              xy - p->time_step * p->strain_rate[2][q]};
    p->lost[PL_LOST_TO_STATES][q] += (p->new_field[0][q] - p->old_field[0][q]) * 0.5 *
                                     (s[0] * before[0] + s[1] * before[1] + s[2] * before[2]);
  }
}

static void brittle_observe(const pl_law *law, const double *uniforms, const pl_points *p) {
  hooke_observe(law, uniforms, p);
  for (long q = 0; q < p->count; q++)
    p->observed[0][q] *= 1 - p->old_field[0][q];
}

static const pl_law brittle_law = {.abi = PL_KERNEL_ABI,
                                   .size = sizeof(pl_law),
                                   .kind = PL_CONTINUUM,
                                   .dimensions = 2,
                                   .dof = 2,
                                   .name = "brittle",
                                   .key = "",
                                   .parameter_count = 4,
                                   .parameters = brittle_parameters,
                                   .density = 2,
                                   .field_count = 1,
                                   .fields = brittle_fields,
                                   .stores = 1,
                                   .uniform_count = 4,
                                   .prepare = brittle_prepare,
                                   .bounds = hooke_bounds,
                                   .point_step = brittle_step,
                                   .point_ledger = brittle_ledger,
                                   .point_observe = brittle_observe,
                                   .point_tangent = hooke_tangent,
                                   .failed_field = 0};

#endif
