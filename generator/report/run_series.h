/* Single values of a run's history, by the names of its series; its first monitors in words. */
#ifndef PERILAT_GENERATOR_RUN_SERIES_H
#define PERILAT_GENERATOR_RUN_SERIES_H

#include "generator/report/run_state.h"

/* The first or the last sample, and the largest of all, or 0; NaN where there is no such series. */
double sample_of(const run *r, const char *name, bool last);
double last_value(const run *r, const char *name);
double largest_of(const run *r, const char *name);
/* J: 0 where it is nothing beside the external work. */
double unless_nothing(double energy, double external);
/* What the run's laws lose `dissipated_damage` to: "damage", "states", or "damage and states". */
const char *lost_to(const run *r);
/* "t = 25 ms, load 3100 N (peak 11020), cmod 0.12 mm": the first monitors at the last sample. */
void describe_monitors(const run *r, char *text, size_t size);

#endif
