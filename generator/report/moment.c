#include "generator/report/moment.h"

#include <math.h>
#include <stdio.h>

#include "runtime/base/quantity.h"

const char *moment(const run *r, double time, char text[MOMENT_TEXT]) {
  const int increments = r->deck->relaxation.increments;
  char shown[TIME_TEXT];
  if (increments > 0)
    snprintf(text, MOMENT_TEXT, "increment %ld of %d",
             lround(time / r->deck->simulation.end_time * increments), increments);
  else
    snprintf(text, MOMENT_TEXT, "t = %s", time_text(time, 5, shown));
  return text;
}
