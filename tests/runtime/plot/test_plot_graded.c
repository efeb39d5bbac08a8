/* Slices of a body in space whose particles have sizes of their own: each is in a slice up to half
   of its own spacing, and keeps its size there. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

#include <math.h>

#include "runtime/plot/plot_frame.h"
#include "tests/runtime/small_result.h"

/* Nearest neighbours 3, 3 and 5 apart, spacings of 1 to 2 to 3: 11/3 in the mean. */
static const double reference[3 * PARTICLES] = {0, 0, 0, 0, 0, 3, 3, 0, 7};
static const double mean = 11.0 / 3;

static void write_result(const char *path, const double *spacing) {
  static const result_field fields[] = {{"displacement", "m", NULL, 3, PARTICLES, "other", NULL}};
  static const double u[3 * PARTICLES], time[SAMPLES] = {0, 1, 2, 3, 4};
  const double *values[1] = {u};
  char error[512] = "";
  result_header h = small_header(path);
  h.dimensions = 3;
  h.reference = reference;
  h.spacing = spacing;
  h.fields = fields;
  h.field_count = 1;
  result *r = small_begin(&h, error, sizeof error);
  assert_non_null(r);
  assert_true(result_frame(r, 0, values, error, sizeof error));
  assert_true(small_finish(r, time, SAMPLES, NULL, 0, error, sizeof error));
  result_discard(r);
  result_close(r);
}

/* Particles in a slice at z; `first`: the spacing of the first of them. */
static long slice(const char *path, double z, double *first) {
  const plot_map_options o = {
      .field = "displacement", .component = -1, .factor = 1, .slice_axis = 2, .slice_at = z};
  char error[512] = "";
  plot_frame m;
  const bool good = plot_frame_read(&m, path, &o, error, sizeof error);
  const long count = good ? m.particles : 0;
  *first = good ? plot_frame_spacing(&m, 0) : NAN;
  plot_frame_free(&m);
  return count;
}

static void put(char path[40], const double *spacing) {
  snprintf(path, 40, "/tmp/perilat-graded-XXXXXX.h5");
  const int made = mkstemps(path, 3);
  assert_true(made >= 0);
  close(made);
  write_result(path, spacing);
}

static void put_away(const char *path) {
  char sidecar[64];
  result_sidecar(path, sidecar, sizeof sidecar);
  unlink(path);
  unlink(sidecar);
}

static void slices_go_by_a_particles_own_spacing(void **state) {
  (void)state;
  static const double spacing[PARTICLES] = {0.01, 0.02, 0.03};
  char path[40];
  double first;
  put(path, spacing);
  for (int p = 0; p < PARTICLES; p += 2) { /* on either side of that between them */
    const double own = 0.5 * (p + 1) * mean, at = reference[3 * p + 2];
    const double side = p == 0 ? -1 : 1;
    assert_int_equal(slice(path, at + side * 0.49 * own, &first), 1);
    assert_true(fabs(first - own) < 1e-12);
    assert_int_equal(slice(path, at + side * 0.51 * own, &first), 0);
  }
  put_away(path);
}

/* A file may hold anything. */
static void sizes_that_are_none_are_passed_over(void **state) {
  (void)state;
  static const double spacing[PARTICLES] = {0.01, NAN, -1};
  char path[40];
  double first;
  put(path, spacing);
  assert_int_equal(slice(path, -0.49 * mean, &first), 1);
  assert_true(fabs(first - mean) < 1e-12);
  put_away(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(slices_go_by_a_particles_own_spacing),
                                     cmocka_unit_test(sizes_that_are_none_are_passed_over)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
