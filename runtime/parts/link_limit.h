/* The largest stable step of bodies that links join or that may touch, from what is known of each
   alone. The
   stiffnesses of bodies and links add up over the same masses, so that for the largest
   frequencies

     omega^2(K_1 + K_2) <= omega^2(K_1) + omega^2(K_2),

   and of parts that have no particle in common the fastest counts alone: so it is for the bodies,
   and for links that share no particle. The step is safe, and may be shorter than it need be by a
   factor of up to sqrt(2) where no links share particles. Dampers add up likewise, each with that
   of its own ruling mode. Contact adds springs in the same way (run_contact.h), stamps springs and
   dampers (run_stamp.h). */
#ifndef PERILAT_RUNTIME_LINK_LIMIT_H
#define PERILAT_RUNTIME_LINK_LIMIT_H

#include "runtime/parts/run_body.h"

/* What springs and dampers of contact add to the fastest mode of a body. */
typedef struct touch_rates {
  double square, damping; /* omega^2, 1/s^2; 1/s */
} touch_rates;

/* Shortens `limit`, that of the shortest body alone, where the bodies that are joined or touch need
   it; *ruling becomes the body whose own modes are the fastest of these. touching[count]: of each
   body. */
void link_limit(const run_body *bodies, int count, const touch_rates *touching, step_limit *limit,
                int *ruling);

#endif
