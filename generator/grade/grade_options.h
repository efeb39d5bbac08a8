/* What `perilat grade` is asked for. */
#ifndef PERILAT_GENERATOR_GRADE_OPTIONS_H
#define PERILAT_GENERATOR_GRADE_OPTIONS_H

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

#endif
