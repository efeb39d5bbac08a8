/* An exercise put to the test: does it give right answers all points, and does it know wrong
   ones? */
#ifndef PERILAT_GENERATOR_SELF_TEST_H
#define PERILAT_GENERATOR_SELF_TEST_H

#include "generator/grade/grading.h"

/* Solution and equal forms get all points; every known wrong answer loses some, and is known by its
   own sentence; every case of the solution is reached. Prints a line for each; false where one does
   not hold. */
bool self_test(grading *g);

#endif
