/* A run that is resumed gives the bits of one that was not stopped; files that do not fit are
   refused and change nothing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <unistd.h>

#include <cmocka.h>

#include "runtime/interaction/sweep.h"
#include "runtime/result/checkpoint.h"
#include "runtime/simulation/simulation_save.h"
#include "tests/runtime/simulation/same_runs.h"
#include "tests/runtime/simulation/watch_all.h"

static const char path[] = "test_checkpoint.state";
static const char fingerprint[] = "deck 1, law 2";

/* Everything that has a memory: drives that begin later, damping that ends, running means, zeros,
 * damage, ledger. */
static void open_busy(small_run *r, double length, int threads) {
  char text[4096];
  snprintf(
      text, sizeof text,
      "&simulation end_time = 2e-4 step_safety = 0.5 threads = %d /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 rotation = 10 /\n"
      "&material lattice = 'c' model = 'm' S_t = 1e-4 tau = 1e-7 /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = %g, 0.06 /\n"
      "&region name = 'left' shape = 'rectangle' corner = 0, 0 size = 0.015, 0.1 /\n"
      "&region name = 'right' shape = 'rectangle' corner = 0.085, 0 size = 0.015, 0.1 /\n"
      "&region name = 'mid' shape = 'point' at = 0.05, 0.03 within = 0.006 /\n"
      "&support region = 'left' fix = 'xy' /\n"
      "&drive region = 'right' component = 'x' velocity = 0.2 rise = 1e-5 start = 6e-5 /\n"
      "&force region = 'mid' component = 'y' force = 500 history = 'ramp' rise = 1e-4 /\n"
      "&damping rate = 3000 until = 1.1e-4 /\n"
      "&gravity acceleration = 500, -2000 rise = 1.5e-4 /\n"
      "&initial_velocity region = 'mid' component = 'y' value = 0.02 /\n"
      "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' average = 3e-5 /\n"
      "&monitor name = 'open' kind = 'opening' between = 'left', 'right' component = 'x' zero_at = "
      "1.2e-4 /\n"
      "&monitor name = 'cracks' kind = 'damaged' /\n" WATCH_ALL("2e-6")
      "&output frames = 7 sample = 1e-6 /\n",
      threads, length);
  small_open(r, &elastic_beam, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

static int go_with_frames(small_run *r, long steps) {
  int frames = 0;
  const long until = simulation_step_done(r->simulation) + steps;
  step_status status = STEP_OK;
  while (status == STEP_OK && simulation_step_done(r->simulation) < until) {
    if (simulation_frame_due(r->simulation)) {
      frames++;
      simulation_frame_taken(r->simulation);
    }
    status = simulation_advance(r->simulation, until - simulation_step_done(r->simulation), NULL);
  }
  return frames;
}

static void same_runs_and_peaks(const small_run *a, const small_run *b) {
  same_runs(a, b);
  for (int m = 0; m < a->deck->monitor_count; m++) {
    double s, t;
    assert_true(simulation_monitor_peak(a->simulation, m, &s) ==
                simulation_monitor_peak(b->simulation, m, &t));
    assert_true(s == t);
  }
}

static void a_resumed_run_gives_the_same_bits(void **state) {
  (void)state;
  char error[200];
  small_run straight;
  open_busy(&straight, 0.1, 2);
  const long total = simulation_step_count(straight.simulation);
  assert_int_equal(go_with_frames(&straight, total), 7); /* the eighth, at the end, is still due */
  assert_true(small_last(&straight, "cracks") > 0);
  /* before the first step, in the middle of a ramp, after the zero, one step before the end; other
   * threads */
  const long stops[] = {0, 7, total / 3, 2 * total / 3, total - 1};
  for (int k = 0; k < 5; k++) {
    small_run first, second;
    frame_mark frames = {-1, 0};
    open_busy(&first, 0.1, 1);
    const int before = go_with_frames(&first, stops[k]);
    assert_true(simulation_save(first.simulation, path, fingerprint, &(frame_mark){before, 9},
                                error, sizeof error));
    small_close(&first);
    open_busy(&second, 0.1, 3);
    assert_true(
        simulation_restore(second.simulation, path, fingerprint, &frames, error, sizeof error));
    assert_true(frames.count == before && frames.sum == 9);
    assert_int_equal(simulation_step_done(second.simulation), stops[k]);
    assert_int_equal(before + go_with_frames(&second, total), 7);
    same_runs_and_peaks(&straight, &second);
    small_close(&second);
  }
  small_close(&straight);
  unlink(path);
}

/* Stopped where a drive takes up a particle: its impulse is that of the coming step. */
static void open_struck(small_run *r) {
  small_open(
      r, &elastic_beam,
      "&simulation end_time = 4e-6 step = 1e-7 /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
      "&material lattice = 'c' model = 'm' /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, -0.001 size = 0.01, 0.002 /\n"
      "&region name = 'left' shape = 'point' at = 0, 0 /\n"
      "&region name = 'right' shape = 'point' at = 0.01, 0 /\n"
      "&drive region = 'left' component = 'x' velocity = 1 start = 2e-6 /\n"
      "&monitor name = 'r' kind = 'reaction' region = 'left' component = 'x' average = 5e-7 /\n"
      "&monitor name = 'u' kind = 'displacement' region = 'left' component = 'x' /\n"
      "&monitor name = 'v' kind = 'velocity' region = 'left' component = 'x' /\n"
      "&output frames = 0 sample = 1e-7 /\n");
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

static void an_impulse_is_not_lost(void **state) {
  (void)state;
  char error[200];
  small_run straight;
  open_struck(&straight);
  go_with_frames(&straight, 40);
  for (int stop = 19; stop <= 21; stop++) {
    small_run first, second;
    open_struck(&first);
    open_struck(&second);
    go_with_frames(&first, stop);
    assert_true(simulation_save(first.simulation, path, fingerprint, &(frame_mark){0, 0}, error,
                                sizeof error));
    assert_true(
        simulation_restore(second.simulation, path, fingerprint, NULL, error, sizeof error));
    go_with_frames(&second, 40 - stop);
    same_runs_and_peaks(&straight, &second);
    small_close(&first);
    small_close(&second);
  }
  small_close(&straight);
  unlink(path);
}

static unsigned char *read_all(size_t *size) {
  FILE *f = fopen(path, "rb");
  assert_non_null(f);
  fseek(f, 0, SEEK_END);
  *size = (size_t)ftell(f);
  rewind(f);
  unsigned char *bytes = must_alloc(*size);
  assert_int_equal(fread(bytes, 1, *size, f), *size);
  fclose(f);
  return bytes;
}

static void write_all(const unsigned char *bytes, size_t size) {
  FILE *f = fopen(path, "wb");
  assert_non_null(f);
  assert_int_equal(fwrite(bytes, 1, size, f), size);
  assert_int_equal(fclose(f), 0);
}

static void refuse(small_run *r, const char *sentence) {
  char error[200] = "";
  frame_mark frames = {-1, 0};
  assert_false(simulation_restore(r->simulation, path, fingerprint, &frames, error, sizeof error));
  if (!strstr(error, sentence)) fail_msg("said: %s", error);
  assert_int_equal(frames.count, -1);
  assert_int_equal(frames.sum, 0);
}

/* The runs have gone on since the file was written: whatever was taken from it would be seen. */
static void refuse_untouched(small_run *r, small_run *untouched, const char *sentence) {
  refuse(r, sentence);
  same_runs_and_peaks(r, untouched);
}

static void damaged_and_foreign_files_are_refused(void **state) {
  (void)state;
  char error[200];
  small_run r, same;
  open_busy(&r, 0.1, 1);
  open_busy(&same, 0.1, 1);
  go_with_frames(&r, 50);
  assert_true(
      simulation_save(r.simulation, path, fingerprint, &(frame_mark){1, 0}, error, sizeof error));
  go_with_frames(&r, 20);
  go_with_frames(&same, 70);
  size_t size;
  unsigned char *bytes = read_all(&size);
  const size_t head = 8 + 8 + strlen(fingerprint); /* magic, length, fingerprint */
  for (size_t k = 0; k < 40; k++) {                /* a flipped bit anywhere behind the head */
    const size_t at = head + k * (size - head - 1) / 39;
    bytes[at] ^= 0x10;
    write_all(bytes, size);
    bytes[at] ^= 0x10;
    refuse_untouched(&r, &same, "damaged");
  }
  for (size_t left = 0; left < head + 8; left++) { /* no more than a part of the head is left */
    write_all(bytes, left);
    refuse_untouched(&r, &same, "cut short");
  }
  for (size_t k = 0; k < 20; k++) { /* the head, and something of the rest */
    write_all(bytes, head + 8 + k * (size - head - 9) / 19);
    refuse_untouched(&r, &same, "damaged");
  }
  bytes[0] = 'x';
  write_all(bytes, size);
  refuse_untouched(&r, &same, "not a checkpoint");
  bytes[0] = 'P';
  bytes[7]++;
  write_all(bytes, size);
  refuse_untouched(&r, &same, "another version");
  bytes[7]--;
  bytes[16]++;
  write_all(bytes, size);
  refuse_untouched(&r, &same, "another deck");
  bytes[16]--;
  write_all(bytes, size);
  small_run other, other_same; /* the same fingerprint by mistake, another body */
  open_busy(&other, 0.12, 1);
  open_busy(&other_same, 0.12, 1);
  refuse_untouched(&other, &other_same, "another size");
  small_close(&other);
  small_close(&other_same);
  free(bytes);
  unlink(path);
  refuse_untouched(&r, &same, "No such file");
  small_close(&r);
  small_close(&same);
}

static void a_resumed_run_knows_what_stopped_it(void **state) {
  (void)state;
  static const char text[] =
      "&simulation end_time = 1e-4 /\n"
      "&lattice name = 'c' kind = 'hexagonal' spacing = 0.01 thickness = 0.1 /\n"
      "&material lattice = 'c' model = 'm' /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.05, 0.03 /\n"
      "&region name = 'all' shape = 'rectangle' corner = 0, 0 size = 0.05, 0.03 /\n"
      "&initial_velocity region = 'all' component = 'x' value = 1 /\n"
      "&monitor name = 'way' kind = 'displacement' region = 'all' component = 'x' /\n"
      "&stop monitor = 'way' above = 1 /\n"
      "&stop monitor = 'way' above = 2e-5 /\n";
  small_run first, second;
  char error[200] = "";
  const frame_mark none = {0, 0};
  small_open(&first, &elastic_beam, text);
  small_open(&second, &elastic_beam, text);
  assert_non_null(first.simulation);
  step_status status = STEP_OK;
  while (status == STEP_OK)
    status = simulation_advance(first.simulation, 1000, NULL);
  assert_int_equal(status, STEP_STOPPED);
  assert_ptr_equal(simulation_stopped_by(first.simulation), &first.deck->stops[1]);
  assert_true(simulation_save(first.simulation, path, fingerprint, &none, error, sizeof error));
  assert_null(simulation_stopped_by(second.simulation));
  assert_true(simulation_restore(second.simulation, path, fingerprint, NULL, error, sizeof error));
  assert_int_equal(simulation_advance(second.simulation, 1, NULL), STEP_STOPPED);
  assert_ptr_equal(simulation_stopped_by(second.simulation), &second.deck->stops[1]);
  small_close(&first);
  small_close(&second);
  unlink(path);
}

static void a_failed_save_leaves_the_old_file(void **state) {
  (void)state;
  char error[200], old[3] = {1, 2, 3}, back[3] = {0};
  const checkpoint_part part = {"numbers", old, sizeof old};
  assert_true(checkpoint_write(path, "a", &part, 1, error, sizeof error));
  assert_false(checkpoint_write("no_such_folder/x", "a", &part, 1, error, sizeof error));
  assert_non_null(strstr(error, "No such file"));
  const checkpoint_part to = {"numbers", back, sizeof back};
  assert_true(checkpoint_read(path, "a", &to, 1, error, sizeof error));
  assert_memory_equal(old, back, 3);
  assert_int_not_equal(system("ls test_checkpoint.state.*"), 0); /* nothing is left beside it */
  unlink(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_resumed_run_gives_the_same_bits),
      cmocka_unit_test(an_impulse_is_not_lost),
      cmocka_unit_test(damaged_and_foreign_files_are_refused),
      cmocka_unit_test(a_resumed_run_knows_what_stopped_it),
      cmocka_unit_test(a_failed_save_leaves_the_old_file),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
