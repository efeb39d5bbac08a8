#include "generator/report/run_document.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

#include "generator/report/bad_bond.h"
#include "generator/report/report_mesh.h"
#include "generator/report/run_cracks.h"

static double last_of(const double *values, long samples) {
  return samples > 0 ? values[samples - 1] + 0.0 : NAN; /* no minus before zeros */
}

static void put_energy(json *w, const run *r, long samples) {
  const char *unchecked = NULL;
  json_key(w, "energy");
  if (simulation_imbalance(r->simulation, &unchecked) < 0) { /* the deck wants none */
    json_null(w);
    return;
  }
  json_object(w);
  for (int k = 0; k < simulation_series_count(r->simulation); k++) {
    const double *values;
    const char *name = simulation_series(r->simulation, k, NULL, &values);
    if (strncmp(name, "energy/", 7) == 0) json_put_number(w, name + 7, last_of(values, samples));
  }
  json_put_number(w, "largest", simulation_largest_energy(r->simulation));
  json_put_bool(w, "checked", !unchecked);
  json_put_text(w, "unchecked", unchecked);
  json_object_end(w);
}

static void put_monitors(json *w, const run *r, long samples) {
  json_put_array(w, "monitors");
  for (int k = 0; k < r->deck->monitor_count; k++) {
    const char *unit_name;
    const double *values;
    double when = NAN;
    json_object(w);
    json_put_text(w, "name", simulation_series(r->simulation, k, &unit_name, &values));
    json_put_text(w, "unit", unit_name);
    json_put_number(w, "last", last_of(values, samples));
    const double peak = samples > 0 ? simulation_monitor_peak(r->simulation, k, &when) : NAN;
    json_put_number(w, "peak", peak + 0.0);
    json_put_number(w, "peak_time", when);
    json_object_end(w);
  }
  json_array_end(w);
}

static void put_existing(json *w, const char *path) {
  if (access(path, F_OK) == 0) json_text(w, path);
}

/* What the run has left. */
static void put_files(json *w, const run *r) {
  char path[4200];
  json_put_array(w, "files");
  if (r->is_written) {
    result_sidecar(r->result_path, path, sizeof path);
    json_text(w, r->result_path);
    json_text(w, path);
  }
  if (r->is_kept) put_existing(w, r->checkpoint_path);
  const bad_state bad = simulation_bad(r->simulation);
  if (bad.what && (bad.bond_particle >= 0 || bad.point)) {
    bad_bond_path(r->result_path, &bad, path, sizeof path);
    put_existing(w, path);
  }
  json_array_end(w);
}

void put_run(json *w, const run *r) {
  json_put_text(w, "status", r->ending);
  json_key(w, "signal");
  if (r->signal)
    json_integer(w, r->signal);
  else
    json_null(w);
  if (!r->simulation) return;
  const double *time;
  const long samples = simulation_history(r->simulation, &time);
  const step_limit *limit = simulation_step_limit(r->simulation);
  json_put_integer(w, "steps", simulation_steps_taken(r->simulation));
  json_put_number(w, "step", limit->step);
  json_put_number(w, "stable_step", limit->limit);
  json_put_number(w, "time", simulation_time(r->simulation));
  json_put_number(w, "wall", r->wall);
  put_energy(w, r, samples);
  put_monitors(w, r, samples);
  put_cracks(w, r);
  put_deaths(w, r);
  put_files(w, r);
}
