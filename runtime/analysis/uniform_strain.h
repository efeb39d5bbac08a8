/* What particles make of a uniform strain, before anything has happened to them; those that rotate
   are in balance of moments. The mean stress of a free body follows from the forces on its
   particles alone, -sum(f x)/V (virial theorem); a body with exact families has that of the
   material, whatever its shape. The forces themselves should be 0 inside; how far they are from it
   is what a particle feels of the irregularity of its surroundings. */
#ifndef PERILAT_RUNTIME_UNIFORM_STRAIN_H
#define PERILAT_RUNTIME_UNIFORM_STRAIN_H

#include "runtime/kernel.h"
#include "runtime/lattice/rows.h"

typedef struct uniform_response {
  /* Pa, 1: of the isotropic solid whose stresses are nearest (Voigt's mean of the stiffness) */
  double E, nu;
  /* median over particles and strains of the force left, over stress times the face of a
     particle */
  double left_force;
  double momentum; /* largest |sum of forces| over sum of |forces| */
  long unresolved; /* particles whose bonds do not resolve all strains */
} uniform_response;

/* Of a law of families on a body whose masses are set; `varying` as in sweep.h (NULL: none);
   plane_strain tells the two planes apart. False where the law gives no finite forces or no
   stiffness. */
bool uniform_strain_response(const pl_law *law, const double *parameters, double *const *varying,
                             const rows *w, bool plane_strain, uniform_response *out);

/* Young's moduli (Pa) along x, y and z of a body as it stands on a lattice: of its middle part,
   away from the ends that each is loaded at, stress over the volume of the particles, sides free in
   the mean. A perfect body whose bonds along the load are all there has the lattice's; what its
   other edges lack makes it softer. `varying` as above. NaN in a direction in
   which the body is too short to have a middle. False where the law gives no finite forces or no
   stiffness. */
bool uniform_strain_moduli(const pl_law *law, const double *parameters, double *const *varying,
                           const rows *w, double E[3]);

/* Young's modulus (Pa) along a bar (bar_rows.h) of a law of bonds in the form of families: of a
   straight one with the same spacing and area. Parameters that differ from place to place count
   with their value in `parameters`. NaN without memory. */
double uniform_strain_of_bar(const pl_law *law, const double *parameters, const rows *bar);

#endif
