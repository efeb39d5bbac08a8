/* Cracks in a mesh with several laws: what of it can be. Stress intensities are those of one linear
   law, and cracks hide nodes only from points whose stiffness is assembled. */
#ifndef PERILAT_RUNTIME_TIP_LAWS_H
#define PERILAT_RUNTIME_TIP_LAWS_H

#include "runtime/continuum/cell_laws.h"
#include "runtime/continuum/tips.h"

/* Of the mesh called `name`. Finds the law around the tips, t->law. linear[cells] as cells.h has
   it. False with a diagnostic: tips in laws that differ, or that are not linear, such a law in
   cells that are no finite elements. A box that reaches into another law is warned of. */
bool tip_laws_fit(tips *t, const deck *k, const char *name, const cell_laws *where,
                  const unsigned char *linear, const mesh *m, diagnostics *d);

#endif
