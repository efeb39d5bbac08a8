/* Hooke's law in plane stress as a kernel by hand: parameters E, nu, rho. */
#ifndef PERILAT_TESTS_HOOKE_LAW_H
#define PERILAT_TESTS_HOOKE_LAW_H

#include <string.h>

#include "runtime/kernel.h"

static const pl_parameter hooke_parameters[] = {
    {"E", "Pa", "", 30e9, 1}, {"nu", "1", "", 0.2, 1}, {"rho", "kg/m^3", "", 2400, 1}};

static void hooke_prepare(const pl_law *law, const double *parameters, const pl_bond_class *bonds,
                          double *uniforms) {
  (void)law;
  (void)bonds;
  uniforms[0] = parameters[0] / (1 - parameters[1] * parameters[1]);
  uniforms[1] = parameters[1] * uniforms[0];
  uniforms[2] = parameters[0] / (2 * (1 + parameters[1]));
}

static void hooke_bounds(const pl_law *law, const double *parameters, double *lower, double *upper,
                         unsigned char *low_open, unsigned char *high_open) {
  (void)parameters;
  for (int k = 0; k < law->parameter_count; k++) {
    lower[k] = 0;
    upper[k] = 1e300;
    low_open[k] = high_open[k] = 1;
  }
}

static void hooke_tangent(const pl_law *law, const double *uniforms, const pl_points *p) {
  const double D[9] = {uniforms[0], uniforms[1], 0, uniforms[1], uniforms[0], 0, 0, 0, uniforms[2]};
  (void)law;
  for (int k = 0; k < 9; k++)
    for (long q = 0; q < p->count; q++)
      p->tangent[k][q] = D[k];
}

/* Stress xx, yy, xy and none across the thickness. */
static void hooke_step(const pl_law *law, const double *uniforms, const pl_points *p) {
  (void)law;
  for (long q = 0; q < p->count; q++) {
    const double x = p->strain[0][q], y = p->strain[1][q];
    p->stress[0][q] = uniforms[0] * x + uniforms[1] * y;
    p->stress[1][q] = uniforms[1] * x + uniforms[0] * y;
    p->stress[2][q] = 2 * uniforms[2] * p->strain[2][q];
    p->stress[3][q] = 0;
  }
}

static void hooke_observe(const pl_law *law, const double *uniforms, const pl_points *p) {
  (void)law;
  for (long q = 0; q < p->count; q++) {
    const double x = p->strain[0][q], y = p->strain[1][q], xy = p->strain[2][q];
    p->observed[0][q] =
        0.5 * uniforms[0] * (x * x + y * y) + uniforms[1] * x * y + 2 * uniforms[2] * xy * xy;
  }
}

static const pl_law hooke_law = {.abi = PL_KERNEL_ABI,
                                 .size = sizeof(pl_law),
                                 .kind = PL_CONTINUUM,
                                 .dimensions = 2,
                                 .dof = 2,
                                 .name = "hooke",
                                 .key = "",
                                 .parameter_count = 3,
                                 .parameters = hooke_parameters,
                                 .density = 2,
                                 .stores = 1,
                                 .uniform_count = 3,
                                 .prepare = hooke_prepare,
                                 .bounds = hooke_bounds,
                                 .point_step = hooke_step,
                                 .point_observe = hooke_observe,
                                 .point_tangent = hooke_tangent,
                                 .linear = 1,
                                 .failed_field = -1};

#endif
