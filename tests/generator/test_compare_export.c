/* perilat compare and perilat export, as a person calls them, on small results made here. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "runtime/result.h"

enum { PARTICLES = 3, BONDS = 2, SAMPLES = 5, FRAMES = 3 };

typedef struct variant { /* what sets a result apart */
  double load_at_3, energy_at_2, displacement, end, first_x;
  int samples;
} variant;
static const variant plain = {0, 0, 0, 1, 0, SAMPLES};

static char error[512];

static void write_frames(result *r, const variant *v) {
  for (int f = 0; f < FRAMES; f++) {
    double u[2 * PARTICLES], omega[BONDS];
    for (int q = 0; q < 2 * PARTICLES; q++)
      u[q] = f + 0.1 * (q / 2) + 0.01 * (q % 2);
    if (f == 1) u[3] += v->displacement; /* y of particle 1 */
    for (int b = 0; b < BONDS; b++)
      omega[b] = 0.25 * f + 0.125 * b;
    const double *values[] = {u, omega};
    assert_true(result_frame(r, 0.5 * f, values, error, sizeof error));
  }
}

static void make_result(const char *path, variant v) {
  const double reference[] = {v.first_x, 0, 0.01, 0, 0.02, 0}, volume[] = {1, 1, 1};
  const int32_t body[] = {0, 0, 0}, bonds[] = {0, 1, 1, 2};
  const result_field fields[] = {{"displacement", "m", NULL, 2, PARTICLES, "other"},
                                 {"omega", "1", "concrete", 1, BONDS, "damage"}};
  const result_header h = {.path = path,
                           .title = "three",
                           .started = "now",
                           .version = "0",
                           .kernel_key = "k",
                           .deck_text = "&simulation /",
                           .particle_count = PARTICLES,
                           .dimensions = 2,
                           .reference = reference,
                           .body = body,
                           .volume = volume,
                           .interaction = "concrete",
                           .bond_count = BONDS,
                           .bonds = bonds,
                           .fields = fields,
                           .field_count = 2};
  result *r = result_open(&h, -1, error, sizeof error);
  if (!r) fail_msg("%s", error);
  write_frames(r, &v);
  double time[SAMPLES + 4], load[SAMPLES + 4], kinetic[SAMPLES + 4], external[SAMPLES + 4];
  for (int k = 0; k < v.samples; k++) {
    time[k] = v.end * k / (v.samples - 1);
    load[k] = 1000 * time[k] + (k == 3 ? v.load_at_3 : 0);
    kinetic[k] = 1e-6 + (k == 2 ? v.energy_at_2 : 0);
    external[k] = 2 * time[k];
  }
  const result_series series[] = {
      {"load", "N", load}, {"energy/kinetic", "J", kinetic}, {"energy/external", "J", external}};
  assert_true(result_finish(r, 1e-3, 42, time, v.samples, series, 3, false, error, sizeof error));
  result_close(r);
}

/* What the program says, to be freed, and its exit status. */
static char *call(const char *arguments, int *status) {
  char command[1024], piece[1024], *text = NULL;
  size_t length = 0, n;
  snprintf(command, sizeof command, "'%s' %s 2>&1", PERILAT_PROGRAM, arguments);
  FILE *in = popen(command, "r"), *out = open_memstream(&text, &length);
  assert_true(in && out);
  while ((n = fread(piece, 1, sizeof piece, in)) > 0)
    fwrite(piece, 1, n, out);
  fclose(out);
  const int ended = pclose(in);
  *status = WIFEXITED(ended) ? WEXITSTATUS(ended) : -1;
  return text;
}

static void expect(const char *arguments, int status, const char *said) {
  int ended;
  char *text = call(arguments, &ended);
  if (ended != status || (said && !strstr(text, said)))
    fail_msg("perilat %s: status %d, expected %d and `%s` in\n%s", arguments, ended, status,
             said ? said : "", text);
  free(text);
}

static void expect_silence(const char *arguments, int status, const char *not_said) {
  int ended;
  char *text = call(arguments, &ended);
  if (ended != status || strstr(text, not_said))
    fail_msg("perilat %s: status %d, or `%s` in\n%s", arguments, ended, not_said, text);
  free(text);
}

static int remove_results(void **state) {
  (void)state;
  static const char *const names[] = {"ce_a", "ce_b"};
  for (int k = 0; k < 2; k++) {
    char path[32];
    snprintf(path, sizeof path, "%s.h5", names[k]);
    unlink(path);
    snprintf(path, sizeof path, "%s.xdmf", names[k]);
    unlink(path);
  }
  unlink("ce.csv");
  return 0;
}

/* --- compare ---------------------------------------------------------------------------------- */

static void equal_results_are_the_same(void **state) {
  (void)state;
  make_result("ce_a.h5", plain);
  make_result("ce_b.h5", plain);
  expect("compare ce_a.h5 ce_b.h5", 0, "same: 5 quantities");
}

/* Load: 0.5 N of 1000 N. The place of the difference is named. */
static void histories_differ_where_and_by_what(void **state) {
  (void)state;
  variant v = plain;
  v.load_at_3 = 0.5;
  make_result("ce_a.h5", plain);
  make_result("ce_b.h5", v);
  expect("compare ce_a.h5 ce_b.h5", 2, "0.5       0.0005  t = 750 ms: 750 and 750.5");
  expect("compare ce_a.h5 ce_b.h5", 2, "* load [N]");
  expect("compare ce_a.h5 ce_b.h5 --tolerance 4.9e-4", 2, "different: 1 of 5 quantities");
  expect("compare ce_a.h5 ce_b.h5 --tolerance=5.1e-4", 0, "same: 5 quantities");
  expect("compare ce_a.h5 ce_b.h5 --history energy/external", 0, "same: 1 quantity,");
  expect("compare ce_a.h5 ce_b.h5 --field displacement", 0, "same: 1 quantity,");
  expect("compare ce_b.h5 ce_a.h5 --history load", 2, "different: 1 of 1 quantity ");
}

/* A small energy is measured by the largest of all: 2e-6 J of 2 J. */
static void energies_are_measured_by_the_largest(void **state) {
  (void)state;
  variant v = plain;
  v.energy_at_2 = 2e-6;
  make_result("ce_a.h5", plain);
  make_result("ce_b.h5", v);
  expect("compare ce_a.h5 ce_b.h5 --tolerance 1.1e-6", 0, "same");
  expect("compare ce_a.h5 ce_b.h5 --tolerance 0.9e-6", 2, "* energy/kinetic [J]");
}

static void fields_differ_where_and_by_what(void **state) {
  (void)state;
  variant v = plain;
  v.displacement = -0.22; /* of 2.21 at most */
  make_result("ce_a.h5", plain);
  make_result("ce_b.h5", v);
  expect("compare ce_a.h5 ce_b.h5", 2, "frame 1, t = 500 ms, particle 1 at (10, 0) mm");
  expect("compare ce_a.h5 ce_b.h5 --tolerance 0.1", 0, "0.22      0.09955");
  expect("compare ce_a.h5 ce_b.h5 --field concrete/omega", 0, "same");
}

/* A straight line sampled more finely is the same line; one that ends earlier is not. */
static void samples_at_other_times(void **state) {
  (void)state;
  variant fine = plain, shorter = plain;
  fine.samples = SAMPLES + 4;
  shorter.end = 0.5;
  make_result("ce_a.h5", plain);
  make_result("ce_b.h5", fine);
  expect("compare ce_a.h5 ce_b.h5 --tolerance 1e-12", 0, "compared at the times of the first");
  make_result("ce_b.h5", shorter);
  expect("compare ce_a.h5 ce_b.h5 --history load", 2, "0.5  5 samples to 1000 ms");
  expect("compare ce_a.h5 ce_b.h5 --tolerance 0.5", 0, NULL);
}

static void not_a_number_is_a_difference(void **state) {
  (void)state;
  variant v = plain;
  v.load_at_3 = NAN;
  make_result("ce_a.h5", plain);
  make_result("ce_b.h5", v);
  expect("compare ce_a.h5 ce_b.h5 --tolerance 1e9", 2, "* load [N]");
  make_result("ce_a.h5", v);
  expect("compare ce_a.h5 ce_b.h5", 0, "same");
}

static void other_particles_have_no_common_frames(void **state) {
  (void)state;
  variant v = plain;
  v.first_x = 1e-3;
  make_result("ce_a.h5", plain);
  make_result("ce_b.h5", v);
  expect("compare ce_a.h5 ce_b.h5", 2, "at other places: no frames are compared");
  expect("compare ce_a.h5 ce_b.h5 --history load", 0, "same");
}

static void wrong_input_of_compare(void **state) {
  (void)state;
  make_result("ce_a.h5", plain);
  make_result("ce_b.h5", plain);
  expect("compare ce_a.h5", 1, "needs two results");
  expect("compare ce_a.h5 ce_b.h5 ce_a.h5", 1, "a third one");
  expect("compare ce_a.h5 missing.h5", 1, "cannot read the result `missing.h5`");
  expect("compare ce_a.h5 ce_b.h5 --history laod", 1, "did you mean `load`?");
  expect("compare ce_a.h5 ce_b.h5 --field omega", 1, "has no field `omega`");
  expect("compare ce_a.h5 ce_b.h5 --tolerance -1", 1, "not negative");
  expect("compare ce_a.h5 ce_b.h5 --tolerance 1x", 1, "not `1x`");
  expect("compare ce_a.h5 ce_b.h5 --tolerence 1", 1, "did you mean `--tolerance`?");
}

/* --- export ----------------------------------------------------------------------------------- */

static void history_as_table(void **state) {
  (void)state;
  variant v = plain;
  v.load_at_3 = 1.0 / 3;
  make_result("ce_a.h5", v);
  expect("export ce_a.h5", 0,
         "time [s],energy/external [J],energy/kinetic [J],load [N]\n"
         "0,0,1e-06,0\n"
         "0.25,0.5,1e-06,250\n"
         "0.5,1,1e-06,500\n"
         "0.75,1.5,1e-06,750.3333333333334\n"
         "1,2,1e-06,1000\n");
  expect("export ce_a.h5 --history -o ce.csv", 0, "written ce.csv");
  FILE *in = fopen("ce.csv", "r");
  assert_non_null(in);
  char line[256];
  int lines = 0;
  while (fgets(line, sizeof line, in))
    lines++;
  fclose(in);
  assert_int_equal(lines, 1 + SAMPLES);
}

static void frame_as_table(void **state) {
  (void)state;
  make_result("ce_a.h5", plain);
  expect("export ce_a.h5 --frame 1", 0,
         "particle,x [m],y [m],displacement_x [m],displacement_y [m]\n"
         "0,0,0,1,1.01\n1,0.01,0,1.1,1.11\n2,0.02,0,1.2,1.21\n");
  expect("export ce_a.h5 --frame -1 --bonds", 0,
         "bond,i,j,x_i [m],y_i [m],x_j [m],y_j [m],concrete/omega [1]\n"
         "0,0,1,0,0,0.01,0,0.5\n1,1,2,0.01,0,0.02,0,0.625\n");
}

/* A table that cannot be made leaves what stands under its name. */
static void wrong_input_of_export(void **state) {
  (void)state;
  make_result("ce_a.h5", plain);
  expect("export", 1, "needs a result file");
  expect("export ce_a.h5 --frame 3", 1, "has 3 frames, numbered from 0; there is no frame 3");
  expect("export ce_a.h5 --frame x", 1, "needs a whole number");
  expect("export ce_a.h5 --history --frame 0", 1, "one at a time");
  expect("export ce_a.h5 --bonds", 1, "add --frame");
  expect("export ce_a.h5 -o ce_a.h5", 1, "would overwrite");
  expect("export ce_a.h5 -o no/such/folder.csv", 2, "cannot write `no/such/folder.csv`");
  expect("export ce_a.h5 --fame 0", 1, "did you mean `--frame`?");
  expect("export ce_a.h5 -o ce.csv", 0, NULL);
  expect("export ce_a.h5 --frame 9 -o ce.csv", 1, NULL);
  assert_int_equal(access("ce.csv", F_OK), 0);
  expect_silence("export ce_a.h5 --frame 9", 1, "particle,x");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_teardown(equal_results_are_the_same, remove_results),
      cmocka_unit_test_teardown(histories_differ_where_and_by_what, remove_results),
      cmocka_unit_test_teardown(energies_are_measured_by_the_largest, remove_results),
      cmocka_unit_test_teardown(fields_differ_where_and_by_what, remove_results),
      cmocka_unit_test_teardown(samples_at_other_times, remove_results),
      cmocka_unit_test_teardown(not_a_number_is_a_difference, remove_results),
      cmocka_unit_test_teardown(other_particles_have_no_common_frames, remove_results),
      cmocka_unit_test_teardown(wrong_input_of_compare, remove_results),
      cmocka_unit_test_teardown(history_as_table, remove_results),
      cmocka_unit_test_teardown(frame_as_table, remove_results),
      cmocka_unit_test_teardown(wrong_input_of_export, remove_results),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
