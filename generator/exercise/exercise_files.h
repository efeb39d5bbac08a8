/* The files of an exercise: what names with stars stand for, and the known answers of its teacher.
 */
#ifndef PERILAT_GENERATOR_EXERCISE_FILES_H
#define PERILAT_GENERATOR_EXERCISE_FILES_H

#include "generator/exercise/exercise.h"

/* Names of ordinary files in FOLDER whose last part fits `pattern` ("hidden/?*.nml"), in
   alphabetical order, as paths from the folder; NULL: none, count 0. False where the pattern leaves
   the folder. */
bool folder_match(arena *a, const char *folder, const char *pattern, const char ***names,
                  int *count);
/* FOLDER/NAME in an arena. */
const char *path_in(arena *a, const char *folder, const char *name);
bool is_ordinary_file(const char *path);
bool is_folder(const char *path);
/* What the comment lines at the very top of a law or a table of answers say, joined by blanks; ""
   without. */
const char *leading_sentence(arena *a, const char *path);

#endif
