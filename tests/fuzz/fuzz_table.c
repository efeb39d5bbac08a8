/* Text of a table of particles. The first byte of an input says whether the lattice is in the plane, whether it has a body and
   whether a spacing. A set and errors exclude each other; what is in the set is finite, positive and, without volumes of its
   own, adds up to the body; places of messages lie in the text. */
#include <math.h>
#include <string.h>

#include "runtime/particle_set.h"
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
  for (int n = 0; n < d.count; n++)
    MUST(d.items[n].where.file < sources.count &&
         d.items[n].where.end <= sources.items[d.items[n].where.file].length);
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
  free(text);
  return 0;
}
