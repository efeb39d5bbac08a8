/* Cracks of meshes as they are now: points from the first to the last, with what has grown at
   either end. */
#ifndef PERILAT_RUNTIME_CRACK_PATHS_H
#define PERILAT_RUNTIME_CRACK_PATHS_H

#include "runtime/continuum/tips.h"

/* How many points the crack can have after so many steps, once tips_take has been called. */
int crack_path_most(const tips *t, const deck_crack *c, int64_t steps);
/* Its points, m; returns how many, `most` at most. */
int crack_path(const tips *t, const deck_crack *c, double (*at)[2], int most);

#endif
