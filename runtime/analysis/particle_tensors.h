/* Stress and strain at particles, for every law.

   Stress: the virtual work of the forces in the bonds of a particle, half of it the particle's,
     stress_p = 1/(2 V) sum of sym(f (x) c),
   with the force f on the particle and the present chord c to the other end: the stress of a linear
   elastic lattice in a uniform strain, exactly; summed over a body, times volume, what its surface
   tractions do. V is the whole volume of the particle in the beginning (thickness as laws see it):
   a particle at a surface, which lacks bonds, shows less than the body has under its surface. The
   force stress of a micropolar law is not symmetric where couple stresses change; this is its
   symmetric part.

   Strain: Green's, (F^T F - 1)/2, with the F that fits the present chords of the bonds which the
   body began with best, each by the square of its relative error. Exact where displacements are
   linear, 0 in a rigid rotation; a shear component is half the change of an angle. NaN where bonds
   do not span the plane or space. */
#ifndef PERILAT_RUNTIME_PARTICLE_TENSORS_H
#define PERILAT_RUNTIME_PARTICLE_TENSORS_H

#include "runtime/base/symmetric_tensor.h"
#include "runtime/interaction/bond_forces.h"

/* Of all particles, Pa: stress[components][size]. The forces have been found (bond_forces.h). */
void particle_stress(bond_forces *f, const body *of, double *const *stress);
/* Of a site. */
void particle_strain(const body *of, long site, double strain[TENSOR_MOST]);

/* A few particles, and the bonds that their stress needs; to be freed by tensor_region_free. */
typedef struct tensor_region {
  const body *of;
  const int32_t *sites; /* not owned */
  long count;
  unsigned char *inside; /* [size] */
  uint64_t *bonds;       /* [size] that a particle of the region is an end of */
  double volume;         /* m^3 */
} tensor_region;

tensor_region tensor_region_new(const body *of, const int32_t *sites, long count);
void tensor_region_free(tensor_region *r);
/* Means over the volume of the particles; strains of those that have one, NaN where none has. */
void tensor_region_stress(const tensor_region *r, bond_forces *f, double stress[TENSOR_MOST]);
void tensor_region_strain(const tensor_region *r, double strain[TENSOR_MOST]);

#endif
