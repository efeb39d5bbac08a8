/* Random paths with random parameters, the same for the same seed. */
#ifndef PERILAT_GENERATOR_PATH_SAMPLE_H
#define PERILAT_GENERATOR_PATH_SAMPLE_H

#include <stdint.h>

#include "generator/exercise/path_case.h"

/* Paths of a sample item, referred to the solution's file, in the arena: the paths `known` give
   what is prescribed and how far it goes; `kept`: driven_law_open_kept. NULL after messages. */
path_case *path_samples(arena *a, const exercise_item *item, const path_case *known,
                        int known_count, const char *solution, driven_law *kept, uint64_t seed,
                        int *count, diagnostics *d);

#endif
