/* `perilat grade` from beginning to end: answers to an exercise, a folder of them, or the exercise
   itself put to the test. */
#ifndef PERILAT_GENERATOR_GRADE_H
#define PERILAT_GENERATOR_GRADE_H

#include <stdint.h>

#include "generator/grade/confine.h"

typedef struct grade_options {
  const char *exercise, *answer; /* folder; file or folder, NULL: none */
  const char *csv, *junit, *html, *publish;
  bool only_public, json, self_test;
  bool seeded;
  uint64_t seed; /* on top of the item's */
  confinement limits;
} grade_options;

/* Exit status: 0 all points that are not given by hand, 2 less, 1 the exercise or the command is
   wrong. */
int grade(const grade_options *o);

#endif
