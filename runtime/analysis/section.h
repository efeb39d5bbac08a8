/* What a body carries through a plane section: force and moment of the bonds that cross it in the
   reference place. */
#ifndef PERILAT_RUNTIME_SECTION_H
#define PERILAT_RUNTIME_SECTION_H

#include "runtime/interaction/bond_forces.h"

typedef struct section {
  const body *of;
  double at[3], normal[3]; /* m, 1 */
  uint64_t *bonds;         /* [size] that cross */
  long count;
} section;

/* Of particles `inside` ([size]; NULL: all) only, both ends. Particles in the plane, to a millionth
   of a spacing, belong to the side that the normal points to. To be freed by section_free. */
section section_new(const body *of, const double at[3], const double normal[3],
                    const unsigned char *inside);
void section_free(section *s);
/* What the far side, where the normal points to, exerts on the near one, N. The forces have been
   found (bond_forces.h). */
void section_force(const section *s, bond_forces *f, double force[3]);
/* The moment of that about the section's place, N m: of the forces where the near particles now
   are, and of what turns these. In the plane it has a z alone. */
void section_moment(const section *s, bond_forces *f, double moment[3]);

#endif
