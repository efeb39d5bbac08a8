/* Text of a table: of particles, then of a load. The first byte of an input says whether the
   lattice is in the plane, whether it has a body and whether a spacing. A set and errors exclude
   each other; what is in the set is finite, positive and, without volumes of its own, adds up to
   the body; times of a load ascend; places of messages lie in the text. */
#include <math.h>
#include <string.h>

#include "runtime/deck/deck_load.h"
#include "runtime/particles/particle_set.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/memory_file.h"

enum { IN_SPACE = 1, WITH_BODY = 2, WITH_SPACING = 4, LONGEST = 4096 };

static const char lattice_text[] = "&lattice name = 'c' /";
static memory_file file;

static void end(void) {
  memory_file_free(&file);
}

static void check_set(const particle_set *set, double body) {
  double sum = 0;
  MUST(set->count > 0 && set->spacing > 0);
  for (long k = 0; k < set->count; k++) {
    for (int c = 0; c < set->dimensions; c++)
      MUST(isfinite(set->at[c][k]));
    MUST(set->volume[k] > 0 && isfinite(set->volume[k]));
    sum += set->volume[k];
  }
  if (body > 0) MUST(fabs(sum / body - 1) < 1e-6);
}

static bool has_volumes(const char *text) {
  return strcasestr(text, "volume") || strcasestr(text, "area");
}

static void check_places(const diagnostics *d) {
  for (int n = 0; n < d->count; n++)
    MUST(d->items[n].where.file < d->sources->count &&
         d->items[n].where.end <= d->sources->items[d->items[n].where.file].length);
}

static void try_load(const char *table, size_t size, unsigned how) {
  const deck_load_kind kinds[] = {{"velocity", "m/s", how & WITH_BODY, NULL},
                                  {"displacement", "m", false, NULL}};
  char text[400];
  source_set sources = {0};
  diagnostics d;
  arena *memory = arena_new();
  snprintf(text, sizeof text, "&drive file = 't.csv%s' %s /", how & IN_SPACE ? ":2,1" : "",
           how & WITH_SPACING ? "velocity = 2" : "");
  diag_begin(&d, &sources);
  source_add(&sources, "t.csv", table, size);
  const namelist *n =
      namelist_read(memory, &sources, source_add(&sources, "fuzz.nml", text, strlen(text)), &d);
  time_function f;
  const int kind = deck_load_kind_of(memory, &n->groups[0], kinds, 2, &d);
  const bool good = kind >= 0 && deck_load_read(memory, &n->groups[0], &kinds[kind], &f, &d);
  MUST(good == (d.errors == 0));
  for (int k = 0; good && k < f.count; k++)
    MUST(isfinite(f.values[k]) && f.times[k] >= 0 && (k == 0 || f.times[k] > f.times[k - 1]));
  check_places(&d);
  diag_clear(&d);
  source_clear(&sources);
  arena_free(memory);
}

static void try_text(const char *text, unsigned how) {
  const bool space = how & IN_SPACE;
  deck_lattice l = {.name = "c",
                    .kind = "particles",
                    .file = file.path,
                    .setting = space ? "space" : "plane_stress",
                    .spacing = how & WITH_SPACING ? 0.5 : 0,
                    .mass_thickness = 0.25};
  deck_body b = {.lattice = "c",
                 .shape = {.kind = space ? SHAPE_BOX : SHAPE_RECTANGLE, .size = {4, 3, 2}}};
  const deck k = {.name = "fuzz.nml",
                  .lattices = &l,
                  .lattice_count = 1,
                  .bodys = &b,
                  .body_count = how & WITH_BODY ? 1 : 0};
  source_set sources = {0};
  diagnostics d;
  diag_begin(&d, &sources);
  source_add(&sources, "fuzz.nml", lattice_text, sizeof lattice_text - 1);
  particle_set *set = particle_set_make(&k, 0, &d);
  MUST((set == NULL) == (d.errors > 0));
  check_places(&d);
  if (set) check_set(set, how & WITH_BODY && !has_volumes(text) ? (space ? 24 : 12) : 0);
  particle_set_free(set);
  diag_clear(&d);
  source_clear(&sources);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size == 0 || size > LONGEST) return 0;
  if (!file.path[0]) {
    atexit(end);
    file = memory_file_new();
  }
  char *text = calloc(size, 1);
  MUST(text);
  memcpy(text, data + 1, size - 1);
  memory_file_set(&file, data + 1, size - 1);
  try_text(text, *data);
  try_load(text, size - 1, *data);
  free(text);
  return 0;
}
