/* What students get of an exercise. */
#ifndef PERILAT_GENERATOR_PUBLISH_H
#define PERILAT_GENERATOR_PUBLISH_H

#include "generator/exercise/exercise.h"

/* Writes into `folder`, which is made, or is there and empty: the task, the starter, the files of
   public items, what these name in their turn, and the exercise's own file with hidden items by
   title and points alone. Never an answer or a result. Names what it wrote and what it left out on
   the standard output. False after a sentence; nothing hidden is written in any case. */
bool publish(const exercise *e, const source_set *sources, const char *folder);

#endif
