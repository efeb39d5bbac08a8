/* The text of a path for `perilat drive` through its reader, and the path as a function of time. */
#include <math.h>
#include <string.h>

#include "generator/drive/drive_motion.h"
#include "generator/drive/drive_path.h"
#include "tests/fuzz/fuzz.h"

enum { LONGEST = 1 << 14, MOST_STEPS = 20000 };

static void check_path(const drive_input *in) {
  const double end = drive_end(in);
  MUST(isfinite(end) && end >= 0); /* 0: one moment */
  for (int q = 0; q < DRIVE_QUANTITY_COUNT; q++)
    for (int k = 0; k <= 8; k++) {
      (void)drive_at(in, (drive_quantity)q, end * k / 8);
      (void)drive_slope(in, (drive_quantity)q, end * k / 8);
    }
  if (in->simulation.steps > MOST_STEPS) return; /* right, but slow */
  long count;
  double *times = drive_times(in, &count);
  MUST(count > 0 && times[0] == 0);
  for (long k = 1; k < count; k++)
    MUST(times[k] > times[k - 1] && times[k] <= end);
  free(times);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (size > LONGEST) return 0;
  const fuzz_choice choice = fuzz_choose(data, size);
  source_set sources = {NULL, 0};
  diagnostics said;
  diag_begin(&said, &sources);
  arena *memory = arena_new();
  const int file = source_add(&sources, "nowhere/path.nml", (const char *)data, size);
  const drive_input *in = drive_read(memory, &sources, file, NULL, 0, &said);
  MUST((in != NULL) == (said.errors == 0));
  if (in) check_path(in);
  for (int k = 0; k < said.count; k++) {
    const span where = said.items[k].where;
    MUST(where.begin <= where.end && where.end <= sources.items[where.file].length);
  }
  if (fuzz_one_in(choice, 13)) diag_print(&said, nowhere());
  diag_clear(&said);
  source_clear(&sources);
  arena_free(memory);
  return 0;
}
