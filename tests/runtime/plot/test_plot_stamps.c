/* Stamps as a result keeps them and maps show them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

#include "runtime/plot/plot_stamps.h"
#include "runtime/result/result_read.h"
#include "tests/runtime/small_result.h"

static const double outline[8] = {0, 1, 2, 1, 2, 3, 0, 3};

/* Two frames: in the second one the stamp has gone by (0.25, -0.5). */
static void write_result(const char *path) {
  static const result_field fields[] = {{"displacement", "m", NULL, 2, PARTICLES, "other", NULL},
                                        {"punch", "m", NULL, 1, 2, "stamp", "its way"}};
  static const result_stamp punch = {"punch", outline, 4};
  static const double way[2][2] = {{0, 0}, {0.25, -0.5}};
  double u[2 * PARTICLES] = {0};
  char error[512] = "";
  result_header h = small_header(path);
  h.fields = fields;
  h.stamps = &punch;
  h.stamp_count = 1;
  result *r = small_begin(&h, error, sizeof error);
  assert_non_null(r);
  for (int k = 0; k < 2; k++) {
    const double *values[2] = {u, way[k]};
    assert_true(result_frame(r, k, values, error, sizeof error));
  }
  const double time[SAMPLES] = {0, 1, 2, 3, 4};
  assert_true(small_finish(r, time, SAMPLES, NULL, 0, error, sizeof error));
  result_discard(r);
  result_close(r);
}

static void expect_reach(const plot_stamps *s, double factor, double x, double y) {
  double low[2] = {10, 10}, high[2] = {-10, -10};
  plot_stamps_reach(s, factor, low, high);
  assert_true(low[0] == x && low[1] == 1 + y && high[0] == 2 + x && high[1] == 3 + y);
}

static void maps_have_them_where_they_are(void **state) {
  (void)state;
  char path[] = "/tmp/perilat-stamps-XXXXXX.h5", sidecar[64], error[512];
  const int made = mkstemps(path, 3);
  assert_true(made >= 0);
  close(made);
  write_result(path);
  result_file *f = result_read(path, error, sizeof error);
  assert_non_null(f);
  plot_stamps s;
  assert_true(plot_stamps_read(&s, f, 0));
  assert_true(s.count == 1 && s.items[0].count == 4);
  assert_memory_equal(s.items[0].outline, outline, sizeof outline);
  expect_reach(&s, 100, 0, 0);
  plot_stamps_free(&s);
  for (int frame = -1; frame < 2; frame += 2) { /* the last, by either number */
    assert_true(plot_stamps_read(&s, f, frame));
    expect_reach(&s, 1, 0.25, -0.5);
    expect_reach(&s, 2, 0.5, -1);
    plot_stamps_free(&s);
  }
  assert_false(plot_stamps_read(&s, f, 2));
  plot_stamps_free(&s);
  result_read_close(f);
  result_sidecar(path, sidecar, sizeof sidecar);
  unlink(path);
  unlink(sidecar);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(maps_have_them_where_they_are)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
