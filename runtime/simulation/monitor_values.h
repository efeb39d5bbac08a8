/* Values of monitors at an instant, before means and zeros. */
#ifndef PERILAT_RUNTIME_MONITOR_VALUES_H
#define PERILAT_RUNTIME_MONITOR_VALUES_H

#include "runtime/simulation/monitor.h"

/* In the state observed after `step` steps. */
double monitor_value_now(const monitors *all, const monitor *m, long step);
/* What a step has made known for a window: the velocity in it, the field of the state that it left;
   the same for all else. */
double monitor_value_of_step(const monitors *all, const monitor *m, long step);

#endif
