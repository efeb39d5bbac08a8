/* The answers that are to be marked: one file, or one of each student of a class. */
#ifndef PERILAT_GENERATOR_ANSWERS_FOUND_H
#define PERILAT_GENERATOR_ANSWERS_FOUND_H

#include "generator/exercise/exercise.h"
#include "generator/grade/grade_child.h"

/* Those of `path`: a file; or a folder with NAME.plm or NAME/answer.plm (of an exercise that asks
   for a table of answers NAME.txt, NAME/answers.txt), in alphabetical order. *count is -1, after a
   sentence, where there is no such file or folder. */
handed_in *answers_found(arena *a, const exercise *e, const char *path, int *count);

#endif
