/* An instant of a run in words. */
#ifndef PERILAT_GENERATOR_RUN_MOMENT_H
#define PERILAT_GENERATOR_RUN_MOMENT_H

#include "generator/report/run_state.h"

/* "t = 4.1 ms"; in quasi-static runs "increment 170 of 480": the run's state at a time of the deck,
   s. */
enum { MOMENT_TEXT = 80 };
const char *moment(const run *r, double time, char text[MOMENT_TEXT]);

#endif
