/* The room: what a law does for all values between its bounds, not only for those that were
   tried. Inside a case line its guard holds, and those above it do not; parameters keep the
   bounds that relate them. */
#ifndef PERILAT_GENERATOR_INTERVAL_CHECK_H
#define PERILAT_GENERATOR_INTERVAL_CHECK_H

#include "dsl/semantics/law.h"

/* Warns of operations of a pairwise law that the declared bounds do not keep defined
   (division-by-zero, domain) and of damages that they do not keep from 0 to 1 (damage-range). Each
   warning shows a state; what is suspected but not found by drawing states is not said. */
void interval_check(const law *l, diagnostics *d);

#endif
