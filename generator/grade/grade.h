/* `perilat grade` from beginning to end: answers to an exercise, a folder of them, or the exercise
   itself put to the test. The room: answers of students marked, in words. They are read and driven
   in a process of their own (grade_child.h). */
#ifndef PERILAT_GENERATOR_GRADE_H
#define PERILAT_GENERATOR_GRADE_H

#include "generator/grade/grade_options.h"

/* Exit status: 0 all points that are not given by hand, 2 less, 1 the exercise or the command is
   wrong. */
int grade(const grade_options *o);

#endif
