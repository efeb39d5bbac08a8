#include "generator/study/held_load.h"

#include <math.h>

/* Until it passes a number that is none. */
static double largest(const double *time, const double *u, long count, double from, double until) {
  double most = 0;
  for (long k = 0; k < count; k++)
    if (time[k] >= from && time[k] <= until && !(fabs(u[k]) <= most)) most = fabs(u[k]);
  return most;
}

/* The last sample is the last that the run has before its end. */
static bool reaches(const double *time, long count, double end) {
  return count > 1 && time[count - 1] + 2 * (time[count - 1] - time[count - 2]) >= end;
}

held_load held_load_judge(const double *time, const double *u, long count, double held, double end,
                          double growth, double limit) {
  const double middle = (held + end) / 2;
  held_load h = {.first = largest(time, u, count, held, middle),
                 .second = largest(time, u, count, middle, INFINITY),
                 .verdict = HELD_UNDECIDED};
  const double all = largest(time, u, count, 0, INFINITY);
  if (!(all <= limit))
    h.verdict = HELD_COLLAPSED;
  else if (!reaches(time, count, end))
    h.verdict = HELD_CUT;
  else if (!(h.second <= (1 + growth) * h.first))
    h.verdict = HELD_COLLAPSED;
  else if ((1 + growth) * h.second >= h.first)
    h.verdict = HELD_BORNE;
  return h;
}
