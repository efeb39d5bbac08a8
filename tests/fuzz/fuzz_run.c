/* A deck's text as a small run: the body cut from the lattice, its loads, monitors and random
   fields set up, a few steps done, the frames' fields read. Bodies of many sites are left out. */
#include <math.h>
#include <string.h>

#include "runtime/deck/deck_read.h"
#include "runtime/geometry/shape.h"
#include "runtime/simulation/simulation.h"
#include "tests/fuzz/fuzz.h"
#include "tests/runtime/elastic_law.h"

enum { LONGEST = 1 << 12, MOST_SITES = 3000, STEPS = 3 };

/* Of the box around all bodies. Not a number where theirs are none: then the set-up must see it. */
static double site_count(const deck *k) {
  double lower[2] = {INFINITY, INFINITY}, upper[2] = {-INFINITY, -INFINITY}, least[3], most[3];
  for (int b = 0; b < k->body_count; b++) {
    shape_box(&k->bodys[b].shape, least, most);
    for (int c = 0; c < 2; c++) {
      lower[c] = fmin(lower[c], least[c]);
      upper[c] = fmax(upper[c], most[c]);
    }
  }
  const double s = k->lattices[0].spacing;
  return ((upper[0] - lower[0]) / s + 2) * ((upper[1] - lower[1]) / s + 2);
}

static void read_fields(simulation *s) {
  const rows *lattice = simulation_rows(s, 0);
  const frame_field *fields;
  const int count = simulation_frame_fields(s, &fields);
  for (int f = 0; f < count; f++) {
    const long items = fields[f].on_bonds ? lattice->bond_count : lattice->particle_count;
    double *values = malloc(((size_t)items * (size_t)fields[f].components + 1) * sizeof *values);
    MUST(values);
    simulation_frame_values(s, f, values);
    free(values);
  }
}

static void run_some(simulation *s) {
  step_status status = STEP_OK;
  for (int k = 0; k < STEPS && status == STEP_OK; k++)
    status = simulation_advance(s, 1, NULL);
  MUST(simulation_step_done(s) <= simulation_step_count(s));
  MUST(simulation_memory(s) > 0);
  if (status == STEP_BAD)
    MUST(*simulation_bad(s).what);
  else
    read_fields(s);
}

static void set_up_and_run(const deck *read, diagnostics *said) {
  double parameters[ELASTIC_PARAMETERS];
  deck of_one_thread = *read, *k = &of_one_thread;
  k->simulation.threads = 1;
  if (!material_parameters(&k->materials[0], &elastic_beam, parameters, said)) return;
  const simulation_law law = {.law = &elastic_beam, .parameters = parameters};
  simulation *s = simulation_new(k, &law, said);
  MUST((s != NULL) == (said->errors == 0));
  if (s) run_some(s);
  simulation_free(s);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size > LONGEST) return 0;
  source_set sources = {NULL, 0};
  diagnostics said;
  diag_begin(&said, &sources);
  arena *memory = arena_new();
  const int file = source_add(&sources, "deck.nml", (const char *)data, size);
  const deck *k = deck_read(memory, &sources, file, NULL, 0, &said);
  if (k && !(site_count(k) > MOST_SITES)) set_up_and_run(k, &said);
  diag_print(&said, nowhere());
  diag_clear(&said);
  source_clear(&sources);
  arena_free(memory);
  return 0;
}
