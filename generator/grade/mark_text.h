/* Marks for people: sums, and an answer's marks as text. */
#ifndef PERILAT_GENERATOR_MARK_TEXT_H
#define PERILAT_GENERATOR_MARK_TEXT_H

#include <stdio.h>

#include "generator/exercise/exercise.h"
#include "generator/grade/marks.h"

typedef struct mark_sums {
  double got;    /* points */
  int judged;    /* points that could be had here */
  int by_hand;   /* points that the teacher gives */
  int elsewhere; /* points of what can not be judged here */
} mark_sums;

mark_sums marks_add_up(const exercise *e, const marks *m);
/* All points that could be had here. */
bool marks_are_full(const exercise *e, const marks *m);
void marks_print(const exercise *e, const marks *m, FILE *out);
/* The most important sentence of it, on one line, or ""; what was compared with the solution says
   more than what was expected. Of the marks' memory. */
const char *marks_in_short(const exercise *e, const marks *m);
/* Behind "3 of 8", of an item whose parts earn nothing alone: ", all or nothing"; else "". */
const char *all_or_nothing(const exercise_item *item);
/* Ahead of warnings. */
extern const char advice_costs_nothing[];
/* A number of points: "13.3", "20". Good until the thread's fourth next call. */
const char *points_shown(double points);

#endif
