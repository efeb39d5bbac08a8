/* What students get of an exercise. */
#ifndef PERILAT_GENERATOR_PUBLISH_H
#define PERILAT_GENERATOR_PUBLISH_H

#include "generator/exercise/exercise.h"

/* Writes into `folder`, which is made, or is there and empty: every file beside the teacher's
   folder, and the exercise's own file with hidden items by title and points alone. Names what it
   wrote on the standard output. False after a sentence; nothing hidden is written in any case. */
bool publish(const exercise *e, const source_set *sources, const char *folder);

#endif
