/* perilat compare and perilat export, as a person calls them, on small results made here. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>

#include "tests/generator/command_tools.h"
#include "tests/runtime/small_result.h"

enum { FRAMES = 3 };

typedef struct variant { /* what sets a result apart */
  double load_at_3, energy_at_2, displacement, end, first_x;
  int samples;
  const char *lattice;
  const char *unchecked; /* why the imbalance says nothing; NULL: there is none of it */
} variant;
static const variant plain = {0, 0, 0, 1, 0, SAMPLES, "concrete", NULL};

static char error[512];

static void write_frames(result *r, const variant *v) {
  for (int f = 0; f < FRAMES; f++) {
    double u[2 * PARTICLES], omega[BONDS];
    small_frame(f, u, omega);
    if (f == 1) u[3] += v->displacement; /* y of particle 1 */
    const double *values[] = {u, omega};
    assert_true(result_frame(r, 0.5 * f * v->end, values, error, sizeof error));
  }
}

static void make_result(const workplace *w, const char *name, variant v) {
  double reference[2 * PARTICLES];
  memcpy(reference, small_reference, sizeof reference);
  reference[0] = v.first_x;
  result_header h = small_header(in_workplace(w, name));
  h.reference = reference;
  const result_bonds bonds = {v.lattice, BONDS, h.bonds->pairs};
  h.bonds = &bonds;
  result_field fields[2] = {small_fields[0], small_fields[1]};
  fields[1].interaction = v.lattice;
  h.fields = fields;
  result *r = small_begin(&h, error, sizeof error);
  if (!r) fail_msg("%s", error);
  write_frames(r, &v);
  double time[SAMPLES + 4], load[SAMPLES + 4], kinetic[SAMPLES + 4], external[SAMPLES + 4];
  for (int k = 0; k < v.samples; k++) {
    time[k] = v.end * k / (v.samples - 1);
    load[k] = 1000 * time[k] + (k == 3 ? v.load_at_3 : 0);
    kinetic[k] = 1e-6 + (k == 2 ? v.energy_at_2 : 0);
    external[k] = 2 * time[k];
  }
  const result_series series[] = {{.name = "load", .unit = "N", .values = load},
                                  {.name = "energy/kinetic", .unit = "J", .values = kinetic},
                                  {.name = "energy/external", .unit = "J", .values = external},
                                  {.name = "energy/imbalance",
                                   .unit = "J",
                                   .values = kinetic,
                                   .judges = true,
                                   .unchecked = v.unchecked && *v.unchecked ? v.unchecked : NULL}};
  const int count = v.unchecked ? 4 : 3;
  assert_true(small_finish(r, time, v.samples, series, count, error, sizeof error));
  result_discard(r);
  result_close(r);
}

/* --- compare ---------------------------------------------------------------------------------- */

static void equal_results_are_the_same(void **state) {
  workplace *w = *state;
  make_result(w, "a.h5", plain);
  make_result(w, "b.h5", plain);
  expect(w, "compare a.h5 b.h5", 0, "same: 5 quantities");
}

/* Load: 0.5 N of 1000 N. The place of the difference is named. */
static void histories_differ_where_and_by_what(void **state) {
  workplace *w = *state;
  variant v = plain;
  v.load_at_3 = 0.5;
  make_result(w, "a.h5", plain);
  make_result(w, "b.h5", v);
  expect(w, "compare a.h5 b.h5", 2, "0.5       0.0005  t = 750 ms: 750 and 750.5");
  expect(w, "compare a.h5 b.h5", 2, "* load [N]");
  expect(w, "compare a.h5 b.h5 --tolerance 4.9e-4", 2, "different: 1 of 5 quantities");
  expect(w, "compare a.h5 b.h5 --tolerance=5.1e-4", 0, "same: 5 quantities");
  expect(w, "compare a.h5 b.h5 --history energy/external", 0, "same: 1 quantity,");
  expect(w, "compare a.h5 b.h5 --field displacement", 0, "same: 1 quantity,");
  expect(w, "compare b.h5 a.h5 --history load", 2, "different: 1 of 1 quantity ");
}

/* A small energy is measured by the largest of all: 2e-6 J of 2 J. */
static void energies_are_measured_by_the_largest(void **state) {
  workplace *w = *state;
  variant v = plain;
  v.energy_at_2 = 2e-6;
  make_result(w, "a.h5", plain);
  make_result(w, "b.h5", v);
  expect(w, "compare a.h5 b.h5 --tolerance 1.1e-6", 0, "same");
  expect(w, "compare a.h5 b.h5 --tolerance 0.9e-6", 2, "* energy/kinetic [J]");
}

static void fields_differ_where_and_by_what(void **state) {
  workplace *w = *state;
  variant v = plain;
  v.displacement = -0.22; /* of 2.21 at most */
  make_result(w, "a.h5", plain);
  make_result(w, "b.h5", v);
  expect(w, "compare a.h5 b.h5", 2, "frame 1, t = 500 ms, particle 1 at (1000, 0) mm");
  expect(w, "compare a.h5 b.h5 --tolerance 0.1", 0, "0.22      0.09955");
  expect(w, "compare a.h5 b.h5 --field concrete/omega", 0, "same: 1 quantity,");
  expect(w, "compare a.h5 b.h5 --field omega", 0, "concrete/omega [1]");
  expect(w, "compare a.h5 b.h5 --history kinetic", 0, "energy/kinetic [J]");
}

/* A straight line sampled more finely is the same line; one that ends earlier is not. */
static void samples_at_other_times(void **state) {
  workplace *w = *state;
  variant fine = plain, shorter = plain;
  fine.samples = SAMPLES + 4;
  shorter.end = 0.5;
  make_result(w, "a.h5", plain);
  make_result(w, "b.h5", fine);
  expect(w, "compare a.h5 b.h5 --tolerance 1e-12", 0, "compared at the times of the first");
  make_result(w, "b.h5", shorter);
  expect(w, "compare a.h5 b.h5 --history load", 2, "0.5  5 samples to 1000 ms");
  expect(w, "compare a.h5 b.h5 --tolerance 0.5", 0, "");
  shorter.displacement = -0.22;
  make_result(w, "b.h5", shorter);
  expect(w, "compare a.h5 b.h5 --field displacement", 2,
         "frame 1, t = 500 ms and 250 ms, particle 1");
}

static void not_a_number_is_a_difference(void **state) {
  workplace *w = *state;
  variant v = plain;
  v.load_at_3 = NAN;
  make_result(w, "a.h5", plain);
  make_result(w, "b.h5", v);
  expect(w, "compare a.h5 b.h5 --tolerance 1e9", 2, "* load [N]");
  make_result(w, "a.h5", v);
  expect(w, "compare a.h5 b.h5", 0, "same");
}

/* Series that judge a run, but do not where nobody can: no agreement follows from that. */
static void what_is_not_checked_is_neither_same_nor_a_curve(void **state) {
  workplace *w = *state;
  variant v = plain;
  v.unchecked = "";
  make_result(w, "checked.h5", v);
  v.unchecked = "the law has no energy";
  make_result(w, "a.h5", v);
  make_result(w, "b.h5", v);
  expect(w, "compare a.h5 b.h5", 0, "same: 5 quantities");
  assert_non_null(strstr(w->said, "not checked in either: the law has no energy"));
  expect(w, "export a.h5 --json", 0, "\"unchecked\": \"the law has no energy\"");
  expect(w, "export checked.h5 --json", 0, "\"unchecked\": null");
  expect(w, "compare checked.h5 checked.h5", 0, "same: 6 quantities");
  expect(w, "compare checked.h5 a.h5", 2, "energy/imbalance");
  assert_non_null(strstr(w->said, "not checked in a.h5: the law has no energy"));
  expect(w, "compare a.h5 checked.h5", 2, "not checked in a.h5: the law has no energy");
  expect(w, "plot a.h5 --y energy/imbalance -o p.png", 1, "is not checked: the law has no energy");
  expect(w, "plot checked.h5 a.h5 --y imbalance -o p.png", 1, "the law has no energy");
  expect(w, "plot checked.h5 --y imbalance -o p.png", 0, "");
}

static void other_particles_have_no_common_frames(void **state) {
  workplace *w = *state;
  variant v = plain;
  v.first_x = 1e-3;
  make_result(w, "a.h5", plain);
  make_result(w, "b.h5", v);
  expect(w, "compare a.h5 b.h5", 2, "at other places: no frames are compared");
  expect(w, "compare a.h5 b.h5 --history load", 0, "same");
}

static void wrong_input_of_compare(void **state) {
  workplace *w = *state;
  make_result(w, "a.h5", plain);
  make_result(w, "b.h5", plain);
  expect(w, "compare a.h5", 1, "needs two results");
  expect(w, "compare a.h5 b.h5 a.h5", 1, "a third one");
  expect(w, "compare a.h5 missing.h5", 1, "cannot read the result `missing.h5`");
  expect(w, "compare a.h5 b.h5 --history laod", 1, "did you mean `load`?");
  expect(w, "compare a.h5 b.h5 --field omga", 1, "has no field `omga`; did you mean `omega`?");
  expect(w, "compare a.h5 b.h5 --tolerance -1", 1, "not negative");
  expect(w, "compare a.h5 b.h5 --tolerance 1x", 1, "not `1x`");
  expect(w, "compare a.h5 b.h5 --tolerence 1", 1, "did you mean `--tolerance`?");
}

/* --- export ----------------------------------------------------------------------------------- */

static void history_as_table(void **state) {
  workplace *w = *state;
  variant v = plain;
  v.load_at_3 = 1.0 / 3;
  make_result(w, "a.h5", v);
  expect(w, "export a.h5", 0,
         "time [s],energy/external [J],energy/kinetic [J],load [N]\n"
         "0,0,1e-06,0\n"
         "0.25,0.5,1e-06,250\n"
         "0.5,1,1e-06,500\n"
         "0.75,1.5,1e-06,750.3333333333334\n"
         "1,2,1e-06,1000\n");
  expect(w, "export a.h5 -o t.csv", 0, "written t.csv");
  size_t size;
  int lines = 0;
  char *text = read_bytes(w, "t.csv", &size);
  for (const char *c = text; *c; c++)
    lines += *c == '\n';
  free(text);
  assert_int_equal(lines, 1 + SAMPLES);
}

static void frame_as_table(void **state) {
  workplace *w = *state;
  make_result(w, "a.h5", plain);
  expect(w, "export a.h5 --frame 1", 0,
         "particle,x [m],y [m],displacement_x [m],displacement_y [m]\n"
         "0,0,0,1,1.01\n1,1,0,1.1,1.11\n2,0.5,0.75,1.2,1.21\n");
  expect(w, "export a.h5 --frame -2", 0, "0,0,0,1,1.01\n"); /* the last but one */
  expect(w, "export a.h5 --frame -1 --bonds", 0,
         "bond,i,j,x_i [m],y_i [m],x_j [m],y_j [m],concrete/omega [1]\n"
         "0,0,1,0,0,1,0,0.5\n1,1,2,1,0,0.5,0.75,0.625\n");
}

/* Frame k has k cracks, at 0.1, 0.2, ... m and as wide in mm, of at most two. */
static void cracks_as_table(void **state) {
  workplace *w = *state;
  result_header h = small_header(in_workplace(w, "c.h5"));
  const result_field fields[] = {
      small_fields[0], small_fields[1], {"opened", "m", NULL, 2, 2, "cracks", "of each crack"}};
  h.fields = fields;
  h.field_count = 3;
  result *r = small_begin(&h, error, sizeof error);
  for (int f = 0; f < FRAMES; f++) {
    double u[2 * PARTICLES], omega[BONDS], cracks[4] = {NAN, NAN, NAN, NAN};
    small_frame(f, u, omega);
    for (int k = 0; k < f; k++) {
      cracks[2 * k] = 0.1 * (k + 1);
      cracks[2 * k + 1] = 1e-4 * (k + 1);
    }
    const double *values[] = {u, omega, cracks};
    assert_true(result_frame(r, 0.5 * f, values, error, sizeof error));
  }
  const double time[] = {0, 1};
  assert_true(small_finish(r, time, 2, NULL, 0, error, sizeof error));
  result_discard(r);
  result_close(r);
  expect(w, "export c.h5 --cracks opened", 0,
         "frame [1],time [s],place [m],width [m]\n1,0.5,0.1,0.0001\n2,1,0.1,0.0001\n"
         "2,1,0.2,0.0002\n");
  expect(w, "export c.h5 --cracks opened --json", 0, "\"of\": \"cracks\"");
  expect(w, "export c.h5 --frame 1", 0,
         "particle,x [m],y [m],displacement_x [m],displacement_y [m]\n");
  expect(w, "info c.h5", 0,
         "Cracks of `opened`: 2 in the last frame, the widest 0.2 mm; at most 2 in a frame");
  expect(w, "info c.h5 --json", 0, "\"cracks\": [");
  expect(w, "compare c.h5 c.h5", 0, "same");
  expect(w, "export c.h5 --cracks closed", 1,
         "has no crack, and no cracks of a monitor, `closed`; it has `opened`");
  expect(w, "export c.h5 --cracks opened --frame 1", 1, "cracks are a table of their own");
  make_result(w, "a.h5", plain);
  expect(w, "export a.h5 --cracks opened", 1,
         "holds them where the deck has a &crack, or a monitor of the kind 'crack_width'");
}

/* Histories and fields are given by their names, or by the part of it that says which. */
static void chosen_columns(void **state) {
  workplace *w = *state;
  make_result(w, "a.h5", plain);
  expect(w, "export a.h5 --history load --history kinetic", 0,
         "time [s],load [N],energy/kinetic [J]\n0,0,1e-06\n");
  expect(w, "export a.h5 --history=energy/external", 0, "time [s],energy/external [J]\n");
  expect(w, "export a.h5 --history laod", 1, "has no history `laod`; did you mean `load`? it has");
  expect(w, "export a.h5 --history -o t.csv", 1, "`--history` needs a value");
  expect(w, "export a.h5 --frame 1 --field displacement", 0,
         "particle,x [m],y [m],displacement_x [m],displacement_y [m]\n0,0,0,1,1.01\n");
  expect(w, "export a.h5 --frame 2 --bonds --field omega", 0, "concrete/omega [1]\n0,0,1,0,0,1,0,");
  expect(w, "export a.h5 --frame 2 --field omega", 1, "is a field of bonds; add --bonds");
  expect(w, "export a.h5 --frame 2 --bonds --field displacement", 1, "leave out --bonds");
  expect(w, "export a.h5 --frame 2 --field omga", 1, "did you mean `omega`? fields of particles:");
  expect(w, "export a.h5 --frame 2 --field time", 1, "has no field `time`");
  expect(w, "export a.h5 --field omega", 1, "--field belongs to frames; add --frame N");
  expect(w, "export a.h5 --frame 0 --field displacement --history load", 1, "one at a time");
}

/* What separates names in lists may stand in one. */
static void names_of_lattices_are_free(void **state) {
  workplace *w = *state;
  variant v = plain;
  v.lattice = "left plate, \"old\"";
  make_result(w, "a.h5", v);
  make_result(w, "b.h5", plain);
  expect(w, "info a.h5", 0, "3 particles, 2 bonds, 3 frames");
  expect(w, "info a.h5", 0, "Frames hold: displacement, left plate, \"old\"/omega\n");
  expect(w, "compare a.h5 a.h5 --field omega", 0, "left plate, \"old\"/omega [1]");
  expect(w, "export a.h5 --frame 0 --bonds", 0, "\"left plate, \"\"old\"\"/omega [1]\"\n0,0,1,");
  expect(w, "plot a.h5 --map omega -o map.png", 0, "written");
  expect(w, "compare a.h5 b.h5 --field omega", 1, "`omega` is `left plate, \"old\"/omega` in");
}

/* A table that cannot be made leaves what stands under its name. */
static void wrong_input_of_export(void **state) {
  workplace *w = *state;
  make_result(w, "a.h5", plain);
  expect(w, "export", 1, "needs a result file");
  expect(w, "export a.h5 --frame 3", 1, "has 3 frames, numbered from 0; there is no frame 3");
  expect(w, "export a.h5 --frame x", 1, "needs a whole number");
  expect(w, "export a.h5 --bonds", 1, "add --frame");
  expect(w, "export a.h5 -o a.h5", 1, "would overwrite");
  expect(w, "export a.h5 -o no/such/folder.csv", 2, "cannot write `no/such/folder.csv`");
  expect(w, "export a.h5 --fame 0", 1, "did you mean `--frame`?");
  expect(w, "export a.h5 -o t.csv", 0, "");
  expect(w, "export a.h5 --frame 9 -o t.csv", 1, "");
  assert_true(exists(w, "t.csv"));
  expect(w, "export a.h5 --frame 0 -o /dev/full", 2, "cannot write `/dev/full`: No space left");
  expect(w, "export a.h5 --frame 9", 1, "there is no frame 9");
  assert_null(strstr(w->said, "particle,x"));
}

#define ONE(test) cmocka_unit_test_setup_teardown(test, set_up_workplace, tear_down_workplace)

int main(void) {
  const struct CMUnitTest tests[] = {
      ONE(equal_results_are_the_same),
      ONE(histories_differ_where_and_by_what),
      ONE(energies_are_measured_by_the_largest),
      ONE(fields_differ_where_and_by_what),
      ONE(samples_at_other_times),
      ONE(not_a_number_is_a_difference),
      ONE(what_is_not_checked_is_neither_same_nor_a_curve),
      ONE(other_particles_have_no_common_frames),
      ONE(wrong_input_of_compare),
      ONE(history_as_table),
      ONE(frame_as_table),
      ONE(cracks_as_table),
      ONE(chosen_columns),
      ONE(names_of_lattices_are_free),
      ONE(wrong_input_of_export),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
