#include "generator/study/held_load.h"

#include <math.h>

/* Until it passes a number that is none. */
static double largest(const double *time, const double *u, long count, double from, double until) {
  double most = 0;
  for (long k = 0; k < count; k++)
    if (time[k] >= from && time[k] <= until && !(fabs(u[k]) <= most)) most = fabs(u[k]);
  return most;
}

held_load held_load_judge(const double *time, const double *u, long count, double held,
                          double growth, double limit) {
  const double end = count ? time[count - 1] : held, middle = (held + end) / 2;
  held_load h = {.first = largest(time, u, count, held, middle),
                 .second = largest(time, u, count, middle, end)};
  const double all = largest(time, u, count, 0, end);
  if (!(all <= limit) || !(h.second <= 2 * h.first))
    h.verdict = HELD_COLLAPSED;
  else
    h.verdict = h.second <= (1 + growth) * h.first ? HELD_BORNE : HELD_UNDECIDED;
  return h;
}
