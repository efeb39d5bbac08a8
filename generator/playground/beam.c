#include "generator/playground/beam.h"

#include <stdlib.h>
#include <string.h>

#include "generator/kernel/document.h"
#include "generator/run/run_laws.h"
#include "runtime/deck/deck_read.h"
#include "runtime/lattice/rows.h"

static const run_options as_asked = {.program = "perilat run", .interpret = true};

static struct {
  run of;
  long particles;
  double *places, *moved, *damage;
} beam;

/* --- setting up ------------------------------------------------------------------------------- */

static bool read_deck(run *r, const char *path) {
  char error[ERROR_LENGTH];
  size_t length;
  char *text = read_text_file(path, 1 << 20, &length, error, sizeof error);
  if (!text) {
    say_error("%s", error);
    return false;
  }
  const int file = source_add(&r->sources, path, text, length);
  free(text);
  r->deck = deck_read(r->memory, &r->sources, file, NULL, 0, &r->said);
  return r->deck != NULL;
}

static bool set_up(run *r, const char *path) {
  if (!read_deck(r, path)) return false;
  const size_t laws = (size_t)run_law_count(r) + 1;
  r->models = must_calloc((size_t)r->deck->material_count + 1, sizeof *r->models);
  r->laws = must_calloc(laws, sizeof *r->laws);
  r->built_in = must_calloc(laws, sizeof *r->built_in);
  r->model_of = must_calloc(laws, sizeof *r->model_of);
  r->lattices = must_calloc((size_t)r->deck->lattice_count + 1, sizeof *r->lattices);
  for (int k = 0; k < r->deck->interaction_count; k++)
    if (load_law(r, k) != 0) return false;
  r->simulation = simulation_new(r->deck, r->laws, &r->said);
  return r->simulation != NULL;
}

static void tell(const run *r) {
  for (int k = 0; k < r->open_models; k++)
    diag_print(&r->models[k].said, stderr);
  diag_print(&r->said, stderr);
  fflush(NULL);
}

/* The reference places of all bodies, one after the other. */
static void take_places(void) {
  const simulation *s = beam.of.simulation;
  beam.particles = 0;
  for (int b = 0; b < simulation_bodies(s); b++)
    beam.particles += simulation_rows(s, b)->particle_count;
  const size_t room = (size_t)beam.particles + 1;
  beam.places = must_calloc(2 * room, sizeof(double));
  beam.moved = must_calloc(3 * room, sizeof(double));
  beam.damage = must_calloc(room, sizeof(double));
  double *to = beam.places;
  for (int b = 0; b < simulation_bodies(s); b++) {
    const rows *w = simulation_rows(s, b);
    for (long p = 0; p < w->particle_count; p++, to += 2) {
      double x[3];
      rows_place(w, w->particle_site[p], x);
      memcpy(to, x, 2 * sizeof *to);
    }
  }
}

void beam_close(void) {
  run *r = &beam.of;
  if (!r->memory) return;
  if (r->simulation) simulation_free(r->simulation);
  for (int k = 0; r->laws && k < run_law_count(r); k++)
    free_parameters(&r->laws[k]);
  for (int k = 0; k < r->open_models; k++)
    model_close(&r->models[k]);
  free(r->laws);
  free(r->built_in);
  free(r->model_of);
  free(r->lattices);
  free(r->models);
  diag_clear(&r->said);
  source_clear(&r->sources);
  arena_free(r->memory);
  free(beam.places);
  free(beam.moved);
  free(beam.damage);
  memset(&beam, 0, sizeof beam);
}

int beam_open(const char *deck_path) {
  beam_close();
  run *r = &beam.of;
  static run_options options;
  options = as_asked;
  options.deck_path = deck_path;
  r->options = &options;
  r->memory = arena_new();
  diag_begin(&r->said, &r->sources);
  const bool good = set_up(r, deck_path);
  tell(r);
  if (good) take_places();
  return good;
}

/* --- going on --------------------------------------------------------------------------------- */

beam_status beam_step(int steps) {
  simulation *s = beam.of.simulation;
  if (!s) return BEAM_FAILED;
  const long end = simulation_step_done(s) + steps;
  while (simulation_step_done(s) < end) {
    const step_status status = simulation_advance(s, end - simulation_step_done(s), NULL);
    if (simulation_frame_due(s)) simulation_frame_taken(s);
    if (status == STEP_OK) continue;
    return status == STEP_END || status == STEP_STOPPED ? BEAM_ENDED : BEAM_FAILED;
  }
  return BEAM_GOES_ON;
}

double beam_time(void) {
  return beam.of.simulation ? simulation_time(beam.of.simulation) : 0;
}

double beam_progress(void) {
  return beam.of.simulation ? simulation_progress(beam.of.simulation) : 0;
}

int beam_count(void) {
  return (int)beam.particles;
}

const double *beam_places(void) {
  return beam.places;
}

static int find_field(const char *name, const frame_field **fields) {
  const int count = simulation_frame_fields(beam.of.simulation, fields);
  for (int f = 0; f < count; f++)
    if (strcmp((*fields)[f].name, name) == 0 && !(*fields)[f].on_bonds && !(*fields)[f].of_law)
      return f;
  return -1;
}

const double *beam_moved(void) {
  const frame_field *fields;
  const int f = find_field("displacement", &fields);
  if (f >= 0) simulation_frame_values(beam.of.simulation, f, beam.moved);
  return beam.moved;
}

const double *beam_damage(void) {
  const frame_field *fields;
  const int f = find_field("damage", &fields);
  if (f >= 0) simulation_frame_values(beam.of.simulation, f, beam.damage);
  return beam.damage;
}

int beam_samples(void) {
  const double *time;
  return beam.of.simulation ? (int)simulation_history(beam.of.simulation, &time) : 0;
}

const double *beam_series(int monitor) {
  const double *values, *time;
  const char *unit_text;
  if (!beam.of.simulation) return NULL;
  simulation_history(beam.of.simulation, &time);
  if (monitor < 0) return time;
  simulation_series(beam.of.simulation, monitor, &unit_text, &values);
  return values;
}

const char *beam_series_name(int monitor) {
  const double *values;
  const char *unit_text;
  if (!beam.of.simulation || monitor >= beam.of.deck->monitor_count) return NULL;
  return simulation_series(beam.of.simulation, monitor, &unit_text, &values);
}
