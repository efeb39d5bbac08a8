/* A law of families by hand, for tests of the runtime alone: springs in space, force c times
   stretch along the present bond, one pass. */
#ifndef PERILAT_TESTS_SPRING_LAW_H
#define PERILAT_TESTS_SPRING_LAW_H

#include <math.h>
#include <string.h>

#include "runtime/kernel.h"

enum { SPRING_C, SPRING_RHO, SPRING_PARAMETERS };
enum { IS_SPRING, IS_LENGTH, IS_CHORD, SPRING_UNIFORMS = IS_CHORD + 3 };

static const pl_parameter spring_parameters[SPRING_PARAMETERS] = {
    {"c", "N", "force over stretch", 1e5, 1}, {"rho", "kg/m^3", "mass density", 2000, 1}};

static void spring_prepare(const pl_law *law, const double *p, const pl_bond_class *b,
                           double *uniforms) {
  (void)law;
  uniforms[IS_SPRING] = p[SPRING_C] * b->weight;
  uniforms[IS_LENGTH] = b->s;
  memcpy(uniforms + IS_CHORD, b->chord, sizeof b->chord);
}

static void spring_bounds(const pl_law *law, const double *p, double *lower, double *upper,
                          unsigned char *low_open, unsigned char *high_open) {
  (void)law;
  (void)p;
  for (int k = 0; k < SPRING_PARAMETERS; k++) {
    lower[k] = 0;
    upper[k] = INFINITY;
    low_open[k] = high_open[k] = 1;
  }
}

/* Force on q along its bond k, and half the energy of the bond. */
static double spring_of(const double *u, const pl_family *f, long k, long q, double force[3]) {
  const long half = f->neighbours / 2, j = q + f->offset[k];
  const uint64_t bonds = k < half ? f->bonds[q] >> k : f->bonds[j] >> (k - half);
  if (!(bonds & 1)) return 0;
  double c[3], square = 0;
  for (int a = 0; a < 3; a++) {
    c[a] = u[IS_CHORD + a] + f->displacement[a][j] - f->displacement[a][q];
    square += c[a] * c[a];
  }
  const double length = sqrt(square), stretch = (length - u[IS_LENGTH]) / u[IS_LENGTH];
  for (int a = 0; a < 3; a++)
    force[a] += u[IS_SPRING] * stretch * c[a] / length;
  return 0.25 * u[IS_SPRING] * u[IS_LENGTH] * stretch * stretch;
}

static void spring_forces(const pl_law *law, const double *uniforms, const pl_family *f) {
  (void)law;
  for (long q = 0; q < f->count; q++) {
    double force[3] = {0, 0, 0};
    for (long k = 0; k < f->neighbours; k++)
      spring_of(uniforms + k * SPRING_UNIFORMS, f, k, q, force);
    for (int a = 0; a < 3; a++)
      f->force[a][q] = force[a];
  }
}

static void spring_energy(const pl_law *law, const double *uniforms, const pl_family *f) {
  (void)law;
  for (long q = 0; q < f->count; q++) {
    double force[3] = {0, 0, 0};
    f->observed[0][q] = 0;
    for (long k = 0; k < f->neighbours; k++)
      f->observed[0][q] += spring_of(uniforms + k * SPRING_UNIFORMS, f, k, q, force);
  }
}

static const pl_family_function spring_step[] = {spring_forces}, spring_observe[] = {spring_energy};

static const pl_law springs = {.abi = PL_KERNEL_ABI,
                               .size = sizeof(pl_law),
                               .stores = 1,
                               .kind = PL_STATE,
                               .dimensions = 3,
                               .dof = 3,
                               .name = "springs",
                               .key = "springs",
                               .parameter_count = SPRING_PARAMETERS,
                               .density = SPRING_RHO,
                               .parameters = spring_parameters,
                               .uniform_count = SPRING_UNIFORMS,
                               .prepare = spring_prepare,
                               .bounds = spring_bounds,
                               .step = {1, spring_step},
                               .observe = {1, spring_observe}};

#endif
