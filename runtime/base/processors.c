#define _GNU_SOURCE
#include "runtime/base/processors.h"

#include <sched.h>
#include <unistd.h>

int usable_processors(void) {
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) == 0 && CPU_COUNT(&allowed) > 0)
    return CPU_COUNT(&allowed);
  const long online = sysconf(_SC_NPROCESSORS_ONLN); /* a machine with more than such a set has */
  return online < 1 ? 1 : (int)online;
}
