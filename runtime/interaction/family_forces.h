/* Forces of single bonds of a law of families (bond_forces.h). All passes of a step but the last
   are run over the body as it is. The last one, which adds the forces up, sees only some bonds: of
   one direction every second one, so that a particle has one at most,

     o--o  o--o  o--o        then    o  o--o  o--o  o

   and what it leaves on a particle is the force of that bond alone. Where it does not ask whether a
   bond exists, as earlier passes have left 0 for those that do not (pl_program.shared), 0 is put
   there for the bonds that it is not to see. */
#ifndef PERILAT_RUNTIME_FAMILY_FORCES_H
#define PERILAT_RUNTIME_FAMILY_FORCES_H

#include "runtime/interaction/bond_forces.h"

typedef struct family_forces family_forces;

family_forces *family_forces_new(sweep *w);
void family_forces_free(family_forces *f);
void family_forces_find(family_forces *f);
void family_forces_each(family_forces *f, const uint64_t *wanted, bond_force_use *use, void *to);

#endif
