#define _GNU_SOURCE
#include "runtime/base/processors.h"

#include <limits.h>
#include <omp.h>
#include <sched.h>
#include <unistd.h>

static int kept_to = INT_MAX;

static int offered_processors(void) {
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0 && CPU_COUNT(&allowed) > 0)
    return CPU_COUNT(&allowed);
  const long online = sysconf(_SC_NPROCESSORS_ONLN); /* a machine with more than such a set has */
  return online < 1 ? 1 : (int)online;
}

int usable_processors(void) {
  const int offered = offered_processors();
  return offered < kept_to ? offered : kept_to;
}

int processors_keep_to(int most) {
  const int before = kept_to;
  kept_to = most < 1 ? 1 : most;
  omp_set_num_threads(usable_processors());
  return before;
}
