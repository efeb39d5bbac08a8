/* Bytes as the checkpoint of a small run. The first byte of an input says how the file comes about:
   the input itself, or a checkpoint that was right with some of its bytes changed; with the
   checksum as it falls or put right, so that what lies behind it is reached, too. A file that is
   refused must leave the run untouched; with one that is taken it must go on to its end without
   touching what is not its own. */
#include <string.h>

#include "runtime/interaction/sweep.h"
#include "runtime/result/checkpoint.h"
#include "runtime/simulation/simulation_save.h"
#include "tests/fuzz/memory_file.h"
#include "tests/runtime/small_run.h"

enum { FROM_INPUT = 1, PUT_SUM_RIGHT = 2, STEPS_AFTER = 3, LONGEST = 1 << 16 };

static const char fingerprint[] = "f";
static const char deck_text[] =
    "&simulation end_time = 2e-4 step_safety = 0.5 threads = 1 /\n"
    "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
    "&material lattice = 'c' model = 'm' S_t = 1e-4 tau = 1e-7 /\n"
    "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.03, 0.02 /\n"
    "&region name = 'left' shape = 'rectangle' corner = -1, -1 size = 1.001, 2 /\n"
    "&region name = 'right' shape = 'rectangle' corner = 0.0245, -1 size = 1, 2 /\n"
    "&support region = 'left' fix = 'xy' /\n"
    "&drive region = 'right' component = 'x' velocity = 0.2 rise = 1e-5 start = 6e-5 /\n"
    "&force region = 'right' component = 'y' force = 500 history = 'ramp' rise = 1e-4 /\n"
    "&damping rate = 3000 until = 1.1e-4 /\n"
    "&gravity acceleration = 500, -2000 rise = 1.5e-4 /\n"
    "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' average = 3e-5 /\n"
    "&monitor name = 'open' kind = 'opening' between = 'left', 'right' component = 'x' zero_at = "
    "1.2e-4 /\n"
    "&stop monitor = 'load' below = 0.2 of = 'peak' /\n"
    "&output frames = 7 sample = 1e-5 /\n";

static small_run run;
static memory_file file;
static uint8_t *right_bytes;
static size_t right_size;
static char error[300];

static void end(void) {
  memory_file_free(&file);
  small_close(&run);
  free(right_bytes);
}

static void begin(void) {
  atexit(end);
  small_open(&run, &elastic_beam, deck_text);
  if (!run.simulation) small_print(&run);
  MUST(run.simulation);
  simulation_advance(run.simulation, 20, NULL);
  char path[64];
  snprintf(path, sizeof path, "/tmp/perilat_fuzz_%d", (int)getpid());
  MUST(
      simulation_save(run.simulation, path, fingerprint, &(frame_mark){1, 0}, error, sizeof error));
  right_bytes = file_bytes(path, &right_size);
  unlink(path);
  file = memory_file_new();
}

/* FNV-1a, as at the end of every checkpoint. */
static uint64_t sum_of(const uint8_t *bytes, size_t size) {
  uint64_t sum = UINT64_C(0xcbf29ce484222325);
  for (size_t k = 0; k < size; k++)
    sum = (sum ^ bytes[k]) * UINT64_C(0x100000001b3);
  return sum;
}

static void restore_right(void) {
  memory_file_set(&file, right_bytes, right_size);
  MUST(simulation_restore(run.simulation, file.path, fingerprint, NULL, error, sizeof error));
}

static void try_bytes(const uint8_t *bytes, size_t size) {
  const sweep *w = simulation_state(run.simulation, 0);
  const double before = w->body->displacement[0][w->body->lattice->size / 2];
  const long step = simulation_step_done(run.simulation);
  frame_mark frames = {-1, 0};
  *error = 0;
  memory_file_set(&file, bytes, size);
  if (simulation_restore(run.simulation, file.path, fingerprint, &frames, error, sizeof error)) {
    for (int k = 0; k < STEPS_AFTER; k++)
      simulation_advance(run.simulation, 1, NULL);
    (void)simulation_bad(run.simulation);
    restore_right();
  } else {
    MUST(*error && frames.count == -1);
    MUST(simulation_step_done(run.simulation) == step);
    MUST(memcmp(&before, &w->body->displacement[0][w->body->lattice->size / 2], sizeof before) ==
         0);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  if (!right_bytes) begin();
  if (size == 0 || size > LONGEST) return 0;
  recipe r = {data, data + size};
  const unsigned how = recipe_byte(&r);
  const size_t room = right_size > size ? right_size : size;
  uint8_t *bytes = malloc(room + 1);
  MUST(bytes);
  size_t left = size - 1;
  if (how & FROM_INPUT)
    memcpy(bytes, data + 1, left);
  else {
    memcpy(bytes, right_bytes, right_size);
    left = recipe_damage(&r, bytes, right_size);
  }
  if ((how & PUT_SUM_RIGHT) && left >= sizeof(uint64_t)) {
    const uint64_t sum = sum_of(bytes, left - sizeof sum);
    memcpy(bytes + left - sizeof sum, &sum, sizeof sum);
  }
  try_bytes(bytes, left);
  free(bytes);
  return 0;
}
