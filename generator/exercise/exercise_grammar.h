/* The groups of an exercise's file, with their keys. */
#ifndef PERILAT_GENERATOR_EXERCISE_GRAMMAR_H
#define PERILAT_GENERATOR_EXERCISE_GRAMMAR_H

#include <stdio.h>

#include "generator/exercise/exercise.h"

enum { EXERCISE_GROUP_EXERCISE, EXERCISE_GROUP_ITEM, EXERCISE_GROUP_COUNT };

extern const deck_grammar exercise_grammar;
extern const char *const item_kind_names[ITEM_KIND_COUNT];

#endif
