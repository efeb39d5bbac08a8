/* What `perilat check` says of the mechanics of a law, whoever asks. */
#ifndef PERILAT_GENERATOR_LAW_JUDGED_H
#define PERILAT_GENERATOR_LAW_JUDGED_H

#include "generator/check/physics.h"

/* Does the law obey mechanics: with `parameters` (SI, in its order), or with those around its
   defaults, within its bounds, where that is NULL? All that is found goes to `d`, warnings about
   ranges, too. `report` may be NULL. */
bool law_obeys(const law *l, const double *parameters, diagnostics *d, physics_report *report);
/* The same of a law around its defaults, in the setting that it names first, whatever the one that
   it has been read for. */
bool law_obeys_alone(const law *l, diagnostics *d);

#endif
