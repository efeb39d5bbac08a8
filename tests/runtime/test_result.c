/* Result files: written, read back, cut to a frame and resumed, refused when truncated or foreign; pictures of them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "runtime/plot.h"
#include "runtime/result.h"

enum { PARTICLES = 3, BONDS = 2, SAMPLES = 5 };

static const double reference[2 * PARTICLES] = {0, 0, 1, 0, 0.5, 0.75};
static const double volume[PARTICLES] = {1, 2, 3};
static const int32_t body[PARTICLES] = {0, 0, 1};
static const int32_t bonds[2 * BONDS] = {0, 1, 1, 2};
static const result_text deck_models[] = {{"law", "model law"}}, kernels[] = {{"law", "int x;"}};
static const result_field fields[] = {{"displacement", "m", NULL, 2, PARTICLES},
                                      {"omega", "1", "concrete", 1, BONDS}};
static char error[512];

static result_header header(const char *path) {
  return (result_header){.path = path, .title = "three particles", .started = "now", .version = "0", .kernel_key = "k",
                         .deck_text = "&simulation /", .models = deck_models, .model_count = 1, .kernels = kernels,
                         .kernel_count = 1, .particle_count = PARTICLES, .reference = reference, .body = body,
                         .volume = volume, .interaction = "concrete", .bond_count = BONDS, .bonds = bonds,
                         .fields = fields, .field_count = 2};
}

/* Values of frame k: displacement k + p/10 + c/100, damage k/10 + b. */
static void write_frame(result *r, int k) {
  double u[2 * PARTICLES], omega[BONDS];
  for (int q = 0; q < 2 * PARTICLES; q++)
    u[q] = k + 0.1 * (q / 2) + 0.01 * (q % 2);
  for (int b = 0; b < BONDS; b++)
    omega[b] = 0.1 * k + b;
  const double *values[] = {u, omega};
  assert_true(result_frame(r, 0.5 * k, values, error, sizeof error));
}

static void finish(result *r) {
  double time[SAMPLES], load[SAMPLES];
  for (int k = 0; k < SAMPLES; k++) {
    time[k] = 0.25 * k;
    load[k] = 1000.0 * k * k;
  }
  const result_series series[] = {{"load", "N", load}, {"energy/kinetic", "J", time}};
  assert_true(result_finish(r, 1e-3, 42, time, SAMPLES, series, 2, false, error, sizeof error));
  result_close(r);
}

static void expect_frame(result_file *f, int k) {
  long count;
  int components;
  char unit_text[16];
  double *u = result_read_frame(f, "displacement", k, &count, &components, unit_text, sizeof unit_text, error, sizeof error);
  assert_non_null(u);
  assert_int_equal(count, PARTICLES);
  assert_int_equal(components, 2);
  assert_string_equal(unit_text, "m");
  for (int q = 0; q < 2 * PARTICLES; q++)
    assert_true(u[q] == k + 0.1 * (q / 2) + 0.01 * (q % 2));
  free(u);
  double *omega = result_read_frame(f, "concrete/omega", k, &count, &components, unit_text, sizeof unit_text, error, sizeof error);
  assert_non_null(omega);
  assert_int_equal(count, BONDS);
  assert_true(omega[1] == 0.1 * k + 1);
  free(omega);
}

static void written_and_read_back(void **state) {
  (void)state;
  result_header h = header("result_a.h5");
  result *r = result_open(&h, -1, error, sizeof error);
  assert_non_null(r);
  for (int k = 0; k < 4; k++)
    write_frame(r, k);
  finish(r);
  assert_int_not_equal(access("result_a.h5.frames", F_OK), 0); /* the working file is gone */
  result_file *f = result_read("result_a.h5", error, sizeof error);
  assert_non_null(f);
  for (int k = 0; k < 4; k++)
    expect_frame(f, k);
  long count;
  char unit_text[16];
  double *load = result_read_series(f, "load", &count, unit_text, sizeof unit_text, error, sizeof error);
  assert_int_equal(count, SAMPLES);
  assert_string_equal(unit_text, "N");
  assert_true(load[4] == 16000);
  free(load);
  double *kinetic = result_read_series(f, "energy/kinetic", &count, unit_text, sizeof unit_text, error, sizeof error);
  assert_non_null(kinetic);
  free(kinetic);
  char *deck = result_read_text(f, "/input/deck"), *law_text = result_read_text(f, "/input/models/law");
  assert_string_equal(deck, "&simulation /");
  assert_string_equal(law_text, "model law");
  free(deck);
  free(law_text);
  assert_null(result_read_series(f, "lode", &count, unit_text, sizeof unit_text, error, sizeof error));
  assert_non_null(strstr(error, "load")); /* the message lists what there is */
  long particles;
  int components;
  assert_null(result_read_frame(f, "displacement", 4, &particles, &components, unit_text, sizeof unit_text, error, sizeof error));
  result_read_close(f);
}

static void resumed_after_a_kill(void **state) {
  (void)state;
  unlink("result_b.h5"); /* of an earlier run of this test */
  result_header h = header("result_b.h5");
  result *r = result_open(&h, -1, error, sizeof error);
  for (int k = 0; k < 3; k++)
    write_frame(r, k);
  result_close(r); /* as a kill would leave it: three frames, of which the checkpoint knows two, and half a fourth */
  int file = open("result_b.h5.frames", O_WRONLY | O_APPEND);
  assert_int_equal(write(file, "garbage", 7), 7);
  close(file);
  assert_int_not_equal(access("result_b.h5", F_OK), 0);
  r = result_open(&h, 2, error, sizeof error);
  assert_non_null(r);
  assert_int_equal(result_frame_count(r), 2);
  write_frame(r, 2);
  write_frame(r, 3);
  finish(r);
  result_file *f = result_read("result_b.h5", error, sizeof error);
  for (int k = 0; k < 4; k++)
    expect_frame(f, k);
  result_read_close(f);
}

static void resume_needs_its_frames(void **state) {
  (void)state;
  result_header h = header("result_c.h5");
  unlink("result_c.h5.frames");
  assert_null(result_open(&h, 2, error, sizeof error));
  result *r = result_open(&h, -1, error, sizeof error);
  write_frame(r, 0);
  result_close(r);
  assert_null(result_open(&h, 2, error, sizeof error));
  assert_non_null(strstr(error, "fewer"));
  unlink("result_c.h5.frames");
}

static void two_runs_do_not_share_a_result(void **state) {
  (void)state;
  result_header h = header("result_d.h5");
  result *first = result_open(&h, -1, error, sizeof error);
  assert_non_null(first);
  assert_null(result_open(&h, -1, error, sizeof error));
  assert_non_null(strstr(error, "another run"));
  result_close(first);
  unlink("result_d.h5.frames");
}

static void an_old_result_survives_a_failed_write(void **state) {
  (void)state;
  result_header h = header("full/result.h5");
  assert_null(result_open(&h, -1, error, sizeof error)); /* no such folder */
  assert_non_null(strstr(error, "full/result.h5"));
}

static void damaged_files_are_refused(void **state) {
  (void)state;
  result_header h = header("result_e.h5");
  result *r = result_open(&h, -1, error, sizeof error);
  write_frame(r, 0);
  finish(r);
  struct stat about;
  assert_int_equal(stat("result_e.h5", &about), 0);
  for (int part = 0; part < 16; part++) { /* truncated at any length: an answer, no crash */
    assert_int_equal(truncate("result_e.h5", about.st_size * (15 - part) / 16), 0);
    result_file *f = result_read("result_e.h5", error, sizeof error);
    if (f)
      result_read_close(f);
    else
      assert_non_null(strstr(error, "result_e.h5"));
  }
  FILE *text = fopen("result_e.h5", "w");
  fputs("not HDF5 at all", text);
  fclose(text);
  assert_null(result_read("result_e.h5", error, sizeof error));
  assert_null(result_read("no_such_file.h5", error, sizeof error));
  assert_non_null(strstr(error, "no_such_file.h5"));
  unlink("result_e.h5");
}

static long size_of(const char *path) {
  struct stat about;
  return stat(path, &about) == 0 ? (long)about.st_size : -1;
}

static void pictures(void **state) {
  (void)state;
  result_header h = header("result_f.h5");
  result *r = result_open(&h, -1, error, sizeof error);
  write_frame(r, 0);
  write_frame(r, 1);
  finish(r);
  const char *results[] = {"result_f.h5", "result_f.h5"};
  static const char *const curves[] = {"curve_f.png", "curve_f.svg", "curve_f.pdf"};
  static const char *const maps[] = {"map_f.png", "map_f.svg", "map_f.pdf"};
  for (int k = 0; k < 3; k++) {
    plot_curve_options curve = {.output = curves[k], .x = "time", .y = "load", .y_unit = "kN"};
    assert_true(plot_curve(results, 2, &curve, error, sizeof error));
    assert_true(size_of(curves[k]) > 1000);
    plot_map_options map = {.output = maps[k], .frame = -1, .field = k ? "displacement" : "damage", .component = -1, .factor = -1};
    assert_true(plot_map("result_f.h5", &map, error, sizeof error));
    assert_true(size_of(maps[k]) > 1000);
  }
  plot_curve_options wrong = {.output = "curve_f.png", .x = "time", .y = "load", .y_unit = "mm"};
  assert_false(plot_curve(results, 1, &wrong, error, sizeof error));
  assert_non_null(strstr(error, "`load` is in N"));
  wrong = (plot_curve_options){.output = "curve_f.jpg", .x = "time", .y = "load"};
  assert_false(plot_curve(results, 1, &wrong, error, sizeof error));
  plot_map_options none = {.output = "map_f.png", .frame = 7, .field = "damage", .component = -1, .factor = -1};
  assert_false(plot_map("result_f.h5", &none, error, sizeof error));
  assert_non_null(strstr(error, "2 frames"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(written_and_read_back),       cmocka_unit_test(resumed_after_a_kill),
      cmocka_unit_test(resume_needs_its_frames),     cmocka_unit_test(two_runs_do_not_share_a_result),
      cmocka_unit_test(an_old_result_survives_a_failed_write), cmocka_unit_test(damaged_files_are_refused),
      cmocka_unit_test(pictures)};
  return cmocka_run_group_tests_name("result", tests, NULL, NULL);
}
