/* Does a law obey mechanics, and does it mean what it says? The room: what is likely a mistake in a
   law that breaks no rule, each kind with a code of its own. Here is the one door for whoever
   judges a law. */
#ifndef PERILAT_GENERATOR_SENSE_H
#define PERILAT_GENERATOR_SENSE_H

#include "generator/check/physics.h"

/* physics_check, what is likely a mistake in the text, and where there is no error in the rest.
   Everything found goes to `d`. Returns false when there were errors among them. `report` may be
   NULL. */
bool law_is_sound(const law *l, const physics_options *o, diagnostics *d, physics_report *report);

#endif
