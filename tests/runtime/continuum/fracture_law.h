/* Linear elastic fracture mechanics as a kernel by hand: parameters K_Ic and v. */
#ifndef PERILAT_TESTS_FRACTURE_LAW_H
#define PERILAT_TESTS_FRACTURE_LAW_H

#include "runtime/crack/hoop_stress.h"
#include "runtime/kernel.h"

static const pl_parameter fracture_parameters[] = {{"K_Ic", "Pa*m^(1/2)", "", 1e6, 1},
                                                   {"v", "m/s", "", 500, 1}};

static void fracture_prepare(const pl_law *law, const double *parameters,
                             const pl_bond_class *bonds, double *uniforms) {
  (void)law;
  (void)bonds;
  uniforms[0] = parameters[0];
  uniforms[1] = parameters[1];
}

static void fracture_bounds(const pl_law *law, const double *parameters, double *lower,
                            double *upper, unsigned char *low_open, unsigned char *high_open) {
  (void)parameters;
  for (int k = 0; k < law->parameter_count; k++) {
    lower[k] = 0;
    upper[k] = 1e300;
    low_open[k] = high_open[k] = 1;
  }
}

static void fracture_look(const pl_law *law, const double *uniforms, const pl_tips *t) {
  (void)law;
  for (long q = 0; q < t->count; q++) {
    const double K[2] = {t->in[PL_TIP_K_I][q], t->in[PL_TIP_K_II][q]}, angle = hoop_angle(K);
    t->out[PL_TIP_GROW][q] = hoop_intensity(K, angle) >= uniforms[0];
    t->out[PL_TIP_TOWARD][q] = angle;
    t->out[PL_TIP_RUN][q] = uniforms[1];
  }
}

static const pl_law fracture_law = {.abi = PL_KERNEL_ABI,
                                    .size = sizeof(pl_law),
                                    .kind = PL_CRACK,
                                    .dimensions = 2,
                                    .name = "fracture",
                                    .key = "",
                                    .parameter_count = 2,
                                    .parameters = fracture_parameters,
                                    .density = -1,
                                    .uniform_count = 2,
                                    .prepare = fracture_prepare,
                                    .bounds = fracture_bounds,
                                    .tip_look = fracture_look};

#endif
