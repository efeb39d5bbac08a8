/* Loading in stages: a run that begins from another one's result. Two stages are one run to the
   last bit where nothing changes, for laws of all kinds, bars, links and regions; and where a part
   that was joined to nothing is cut out. */
#define _GNU_SOURCE /* nftw */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/run/stages.h"

static void two_stages_are_one_run(void **state) {
  workplace *w = *state;
  assert_true(check_stages(w, BLOCK(HEXAGON, "model = 'mplm_bilinear'", BEAM), STEADY) > 0.5);
  assert_true(check_stages(w, BLOCK(HEXAGON, "model = 'splm_concrete'", BEAM), STEADY) > 0);
  assert_true(check_stages(w,
                           BLOCK(HEXAGON "  rotation = 15  edges = 'exact'",
                                 "model = 'splm_concrete'", BEAM),
                           STEADY) > 0);
  assert_true(check_stages(w,
                           BLOCK("kind = 'square'  spacing = '5 mm'  horizon = 2.015",
                                 "model = 'pmb'  G_0 = '0.02 N/m'", BEAM),
                           STEADY) > 0);
  assert_true(check_stages(w, BLOCK("kind = 'blue_noise'  spacing = '5 mm'", "model = 'lps'", BEAM),
                           STEADY) >= 0);
}

/* Volumes and bonds are others, and the body would jump. */
static void edges_stay_as_they_are(void **state) {
  workplace *w = *state;
  static const char start[] = "&start  result = 'first.h5'  /\n";
  write_stage(w, "first",
              BLOCK(HEXAGON "  edges = 'exact'", "model = 'splm_concrete'", BEAM) STEADY, "50 us",
              "");
  run_stage(w, "first");
  write_stage(w, "second", BLOCK(HEXAGON, "model = 'splm_concrete'", BEAM) STEADY, "50 us", start);
  expect(w, "check second.nml", 1,
         "`c` is hexagonal with exact edges in `first.h5`, and hexagonal in this deck");
  expect(w, "check second.nml", 1, "give it the `edges` that it has in the result's deck");
}

#define BAR                                                                                        \
  "&bar       name = 'b'  points = '2 mm', '12 mm', '58 mm', '12 mm'  diameter = '4 mm'  spacing " \
  "= '8 mm'  /\n"                                                                                  \
  "&material  bar = 'b'  model = 'steel_bar'  F_y = '10 MPa'  /\n"

static void bars_links_and_regions_go_on(void **state) {
  workplace *w = *state;
  static const char beam[] = BLOCK(HEXAGON, "model = 'mplm_bilinear'", BEAM);
  char block[DECK];
  snprintf(block, sizeof block, "%s%s", beam,
           BAR "&link  name = 'k'  bar = 'b'  lattice = 'c'  to = 'place'  /\n"
               "&material  link = 'k'  model = 'bond_slip'  f_cm = '20 MPa'  /\n");
  assert_true(check_stages(w, block, STEADY) > 0);
  snprintf(block, sizeof block, "%s%s", beam,
           BAR "&link  name = 'k'  bar = 'b'  lattice = 'c'  /\n"
               "&material  link = 'k'  model = 'bar_bond'  /\n");
  assert_true(check_stages(w, block, STEADY) > 0);
  snprintf(block, sizeof block, "%s%s", beam,
           "&region  name = 'end'  lattice = 'c'  shape = 'rectangle'  corner = '30 mm', '-1 mm'  "
           "size = '40 mm', '40 mm'  /\n"
           "&material  lattice = 'c'  region = 'end'  model = 'elastic_micropolar'  /\n");
  assert_true(check_stages(w, block, STEADY) > 0);
}

#define SPACE                                                                                      \
  "&lattice   name = 'c'  kind = 'fcc'  spacing = '8 mm'  shells = 2  /\n"                         \
  "&material  lattice = 'c'  model = 'mplm_concrete_space'  /\n"                                   \
  "&body      lattice = 'c'  shape = 'box'  corner = 0, 0, 0  size = '60 mm', '26 mm', '26 mm'  "  \
  "/\n"                                                                                            \
  "&region    name = 'foot'  shape = 'box'  corner = '-1 mm', '-1 mm', '-1 mm'  size = '3 mm', "   \
  "'40 mm', '40 mm'  /\n"                                                                          \
  "&region    name = 'tip'  shape = 'box'  corner = '54 mm', '-1 mm', '-1 mm'  size = '10 mm', "   \
  "'40 mm', '40 mm'  /\n"                                                                          \
  "&support   region = 'foot'  fix = 'xyz', 'rotation'  /\n"

static void rotations_in_space_go_on(void **state) {
  assert_true(check_stages(*state, SPACE,
                           "&force  region = 'tip'  component = 'y'  total = '-900 N'  history = "
                           "'constant'  /\n"
                           "&force  region = 'tip'  component = 'z'  total = '-500 N'  history = "
                           "'constant'  /\n") > 0.1);
}

/* Broken bonds of a block that is crushed push where they were lost, in the second stage, too. */
static void contact_goes_on(void **state) {
  assert_true(check_stages(*state,
                           BLOCK("kind = 'square'  spacing = '5 mm'  horizon = 2.015",
                                 "model = 'pmb'  G_0 = '0.02 N/m'", BEAM),
                           "&contact  /\n&force  region = 'tip'  component = 'x'  total = '-9 kN'  "
                           "history = 'constant'  /\n" STEADY) == 1);
}

/* A beam that bends down onto an anvil and a loose block: where they are, how fast, and how far its
   particles have been dragged along them. */
static void stamps_go_on(void **state) {
  workplace *w = *state;
  check_stages(w, BLOCK(HEXAGON, "model = 'mplm_bilinear'", BEAM),
               STEADY "&stamp  name = 'loose'  shape = 'rectangle'  corner = '24 mm', '-7.5 mm'  "
                      "size = '12 mm', '5 mm'  mass = '20 g'  friction = 0.3  damping = 0.1  /\n"
                      "&stamp  name = 'anvil'  shape = 'disc'  centre = '50 mm', '-12.5 mm'  "
                      "radius = '10 mm'  velocity = 0  friction = 0.5  /\n");
  result_state *s = state_of(w, "second");
  assert_int_equal(s->stamp_count, 2);
  const state_stamp *anvil = &s->stamps[0], *loose = &s->stamps[1];
  assert_true(strcmp(anvil->name, "anvil") == 0 && strcmp(loose->name, "loose") == 0);
  assert_true(loose->velocity[1] < 0 && loose->place[1] < 0 && anvil->place[1] == 0);
  const state_field *f = &anvil->dragged[0];
  print_message("dragged by up to %.2g m\n", largest(f->values, f->count * f->columns));
  assert_true(anvil->dragged_count == 1 && largest(f->values, f->count * f->columns) > 0);
  result_state_free(s);
  write_stage(w, "second", BLOCK(HEXAGON, "model = 'mplm_bilinear'", BEAM), "0.35 ms",
              "&start  result = 'first.h5'  /\n&stamp  name = 'loose'  shape = 'rectangle'  corner "
              "= '24 mm', '-7.5 mm'  size = '12 mm', '5 mm'  mass = '20 g'  direction = 0, 1  "
              "velocity = 1  /\n");
  expect(w, "check second.nml", 1, "goes on from `first.h5` with the velocity that it has there");
  write_stage(w, "second", BLOCK(HEXAGON, "model = 'mplm_bilinear'", BEAM), "0.35 ms",
              "&start  result = 'first.h5'  /\n&stamp  name = 'loose'  shape = 'rectangle'  corner "
              "= '24 mm', '-7.5 mm'  size = '12 mm', '5 mm'  mass = '20 g'  velocity = 0  /\n");
  expect(w, "check second.nml", 1, "goes on from `first.h5` with the velocity that it has there");
  write_stage(w, "second", BLOCK(HEXAGON, "model = 'mplm_bilinear'", BEAM), "0.35 ms",
              "&start  result = 'first.h5'  /\n&stamp  name = 'loose'  shape = 'rectangle'  corner "
              "= '24 mm', '-7.6 mm'  size = '12 mm', '5 mm'  mass = '20 g'  /\n");
  expect(w, "check second.nml", 1, "where it is drawn with another shape or elsewhere");
  /* guided to the left and down from now on: so are its velocity and its way */
  write_stage(w, "second", BLOCK(HEXAGON, "model = 'mplm_bilinear'", BEAM), "0.25 us",
              "&start  result = 'first.h5'  /\n&stamp  name = 'loose'  shape = 'rectangle'  corner "
              "= '24 mm', '-7.5 mm'  size = '12 mm', '5 mm'  mass = '20 g'  guided = T  direction "
              "= -3, -4  /\n");
  run_stage(w, "second");
  result_state *before = state_of(w, "first"), *after = state_of(w, "second");
  const double *was = before->stamps[1].place, *is = after->stamps[0].place;
  assert_true(is[1] < was[1] && fabs((is[0] - was[0]) / (is[1] - was[1]) - 0.75) < 1e-6);
  result_state_free(before);
  result_state_free(after);
}

/* Of two blocks that are not joined one is cut out: the other one moves as if it had always been
   alone. */
static void what_is_cut_out_takes_nothing_along(void **state) {
  workplace *w = *state;
  static const char alone[] = BLOCK(HEXAGON, "model = 'mplm_bilinear'", BEAM) STEADY,
                    far[] = "&body  lattice = 'c'  shape = 'rectangle'  corner = '-90 mm', '-60 "
                            "mm'  size = '40 mm', '50 mm'  /\n";
  write_stage(w, "one", alone, "0.6 ms", "");
  write_stage(w, "first", alone, "0.25 ms", far);
  write_stage(w, "second", alone, "0.35 ms", "&start  result = 'first.h5'  /\n");
  run_stage(w, "one");
  run_stage(w, "first");
  run_stage(w, "second");
  assert_non_null(strstr(w->said, " go on; "));
  assert_non_null(strstr(w->said, " are gone"));
  assert_null(strstr(w->said, " new"));
  assert_true(same_ends(w, "one", "second") > 0.5);
  /* and the other way round: what is new is at rest, and sets nothing in motion */
  write_stage(w, "first", alone, "0.25 ms", "");
  char more[1000];
  snprintf(more, sizeof more, "%s&start  result = 'first.h5'  /\n", far);
  write_stage(w, "second", alone, "0.35 ms", more);
  run_stage(w, "first");
  run_stage(w, "second");
  assert_non_null(strstr(w->said, " are new"));
  result_state *one = state_of(w, "one"), *two = state_of(w, "second");
  assert_true(two->bodies[0].count > one->bodies[0].count);
  const double far_below = largest(two->bodies[0].displacement, 2);
  assert_true(far_below > 0); /* its weight */
  result_state_free(one);
  result_state_free(two);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(two_stages_are_one_run, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(edges_stay_as_they_are, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(bars_links_and_regions_go_on, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(rotations_in_space_go_on, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(contact_goes_on, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(stamps_go_on, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(what_is_cut_out_takes_nothing_along, set_up_workplace,
                                      tear_down_workplace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
