#include "generator/report/run_series.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "dsl/base/elementary.h"
#include "generator/report/moment.h"

/* Samples of a series; NULL where there is none of that name. */
static const double *series_of(const run *r, const char *name) {
  for (int k = 0; k < simulation_series_count(r->simulation); k++) {
    const double *values;
    if (strcmp(simulation_series(r->simulation, k, NULL, &values), name) == 0) return values;
  }
  return NULL;
}

/* The first or the last sample; NaN where there is none. */
double sample_of(const run *r, const char *name, bool last) {
  const double *time, *values = series_of(r, name);
  const long samples = simulation_history(r->simulation, &time);
  return values && samples > 0 ? values[last ? samples - 1 : 0] : NAN;
}

double last_value(const run *r, const char *name) {
  return sample_of(r, name, true);
}

double largest_of(const run *r, const char *name) {
  const double *time, *values = series_of(r, name);
  const long samples = simulation_history(r->simulation, &time);
  double largest = 0;
  for (long k = 0; values && k < samples; k++)
    largest = pl_fmax(largest, values[k]);
  return largest;
}

/* What is lost in rounding and in the integration's own wave is nothing. */
double unless_nothing(double energy, double external) {
  return fabs(energy) < 1e-7 * fabs(external) ? 0 : energy;
}

const char *lost_to(const run *r) {
  bool has[PL_FIELD_OUTPUT] = {false};
  for (int n = 0; n < r->deck->interaction_count; n++)
    for (int f = 0; f < r->laws[n].law->field_count; f++)
      has[r->laws[n].law->fields[f].kind] = true;
  return !has[PL_FIELD_STATE] ? "damage" : has[PL_FIELD_DAMAGE] ? "damage and states" : "states";
}

/* "load 3100 N (peak 11020 N), cmod 1.2e-5 m": monitors at the last sample. */
void describe_monitors(const run *r, char *text, size_t size) {
  const double *time;
  long samples = simulation_history(r->simulation, &time);
  char now[MOMENT_TEXT];
  int n = snprintf(text, size, "%s", moment(r, simulation_time(r->simulation), now));
  for (int k = 0; samples > 0 && k < r->deck->monitor_count && k < 2 && n > 0 && (size_t)n < size;
       k++) {
    const char *unit_name;
    const double *values;
    const char *name = simulation_series(r->simulation, k, &unit_name, &values);
    const double last = values[samples - 1] + 0.0; /* no minus before zeros */
    const bool pure = unit_is_pure(unit_name);
    n += snprintf(text + n, size - (size_t)n, ", %s %.4g%s%s", name, last, pure ? "" : " ",
                  pure ? "" : unit_name);
    if (k == 0 && (size_t)n < size)
      n += snprintf(text + n, size - (size_t)n, " (peak %.4g)",
                    simulation_monitor_peak(r->simulation, k, NULL) + 0.0);
  }
}
