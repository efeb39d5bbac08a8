/* A law's field or output that a monitor watches, by its name: which laws have it, on which
   particles or nodes, and its mean there. */
#ifndef PERILAT_RUNTIME_MONITOR_FIELD_H
#define PERILAT_RUNTIME_MONITOR_FIELD_H

#include "runtime/simulation/monitor.h"

/* By its place among the law's fields, then outputs. */
const pl_field *monitor_law_field(const pl_law *law, int k);
/* The place of what the monitor names; -1: the law has none on particles or points. */
int monitor_find_field(const deck_monitor *m, const pl_law *law);
/* The first law of the body that has the field; NULL: none. Then the check is false with a
   diagnostic, where the monitor watches a field. */
const run_law *monitor_law_with_field(const deck_monitor *m, const run_body *of);
bool monitor_check_field(const deck_monitor *m, const run_body *of, diagnostics *d);
/* The law of the region's first particle, where it has the field. */
const run_law *monitor_law_watched(const monitor *m);
/* Leaves nodes with cells around of a law that has the field; a diagnostic where none is left. */
void monitor_keep_nodes(monitor *m, diagnostics *d);
/* A diagnostic where particles are of laws that have no such field. */
void monitor_check_share(const monitor *m, diagnostics *d);
/* Of a plane of values at sites; 0 of none. */
double monitor_mean_at(const double *values, const int32_t *sites, long count);
/* Of what it watches, in the state observed; `late`: in that which the step has left. */
double monitor_field_mean(const monitors *all, const monitor *m, bool late);

#endif
