/* `perilat check` and `perilat info` as commands: a path is no deck, a law is meant for a setting, and
   what a law implies is said with what it is measured on. */
#define _GNU_SOURCE
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/command_tools.h"

static const char path_of_bond[] = "&material  model = 'elastic_central'  /\n"
                                   "&path  quantity = 'stretch'  value = 1e-4  rise = '1 s'  /\n";

static void a_path_is_shown_the_way_to_drive(void **state) {
  workplace *w = *state;
  static const char *const commands[] = {"run", "build -o solver", "info"};
  write_text(w, "path.nml", path_of_bond);
  for (size_t k = 0; k < sizeof commands / sizeof *commands; k++) {
    char arguments[100];
    snprintf(arguments, sizeof arguments, "%s path.nml", commands[k]);
    expect(w, arguments, 1, "`path.nml` is a path that drives one bond");
    assert_non_null(strstr(w->said, "perilat drive path.nml"));
  }
  expect(w, "check path.nml", 0, "path.nml: no errors; a path that drives one bond");
  assert_non_null(strstr(w->said, "perilat drive path.nml"));
  expect(w, "drive path.nml", 0, "elastic_central");
  /* a deck that is wrong otherwise stays a deck */
  write_text(w, "wrong.nml", "&simulation  end_time = '1 ms'  /\n&boddy  /\n");
  expect(w, "check wrong.nml", 1, "there is no group `&boddy`");
}

static const char law_for_space[] = "model solid\n  law central bond\n  for plane_strain, space\n"
                                    "  parameter EA  = 2 [MN]         in (0, inf)\n"
                                    "  parameter rho = 2300 [kg/m^3]  in (0, inf)\n"
                                    "  force N = EA*stretch\nend model\n";

static void a_law_runs_in_the_setting_it_is_meant_for(void **state) {
  workplace *w = *state;
  write_text(w, "solid.plm", law_for_space);
  write_text(w, "solid_path.nml", path_of_bond);
  expect(w, "check solid.plm", 0, "no errors");
  expect(w, "run beam.nml --set material.model=./solid.plm", 1,
         "the law `solid` is meant for plane_strain, space, but this lattice is in plane_stress");
  assert_non_null(strstr(w->said, "[conflict]"));
  expect(w, "drive ./solid.plm solid_path.nml", 1, "is meant for plane_strain, space");
  expect(w, "info solid.plm", 0, "t = 100 mm, plane strain:");
  expect(w, "info solid.plm --lattice cubic", 0,
         "On a cubic lattice of 6 neighbours, s = 10 mm, space:");
}

/* Nikravesh 2017: the hexagon has E and nu exactly, fcc with second neighbours, too. */
static void laws_of_families_are_put_on_lattices(void **state) {
  workplace *w = *state;
  expect(w, "info splm_elastic --spacing '5 mm'", 0,
         "On a hexagonal lattice, s = 5 mm, t = 100 mm");
  assert_non_null(strstr(w->said, "E = 25.131 GPa along x, 25.131 GPa along y; nu = 0.2, 0.2"));
  assert_non_null(strstr(w->said, "3 passes"));
  assert_non_null(strstr(w->said, "stable step"));
  expect(w, "info splm_elastic --lattice fcc --shells 2", 0, "On an fcc lattice of 18 neighbours");
  assert_non_null(strstr(w->said, "E = 25.131 GPa along x"));
  assert_null(strstr(w->said, "longitudinal 0 m/s"));
  expect(w, "info lps --lattice square --horizon 3 --json", 0, "\"neighbours\": 28");
  expect(w, "info lps --lattice kagome", 1, "there is no lattice `kagome`");
  expect(w, "info lps --horizon 3 --shells 2", 1, "exclude each other");
  expect(w, "info lps --horizon far", 1, "--horizon needs a number from 1 to 8");
  expect(w, "info lps --lattice cubic --horizon 7", 1, "no neighbours, or more than");
  expect(w, "info mplm_bilinear --lattice square", 1,
         "hexagonal lattice of nearest neighbours only");
}

static void what_a_law_implies_says_what_it_is_measured_on(void **state) {
  workplace *w = *state;
  expect(w, "info mplm_bilinear --spacing '6.35 mm' --thickness '152.4 mm'", 0,
         "81.5872 N/m on its share of a crack, sqrt(3)/2*s*t");
  assert_non_null(strstr(w->said, "sides held"));
  expect(w, "info cohesive --set G_f='100 N/m'", 0,
         "115.47 N/m of a straight crack across the rows (opens along x), 100 N/m along them");
  expect(w, "info cohesive --json", 0, "\"crack_energy\": [");
}

static const char deck_of_families[] =
    "&simulation  title = 'family'  end_time = '5 us'  /\n"
    "&lattice     name = 'concrete'  kind = 'hexagonal'  spacing = '10 mm'  thickness = '100 mm'  "
    "/\n"
    "&material    lattice = 'concrete'  model = 'splm_elastic'  /\n"
    "&body        lattice = 'concrete'  shape = 'rectangle'  corner = 0, 0  size = '60 mm', '60 "
    "mm'  /\n"
    "&output      result = 'family.h5'  /\n";

/* Its kernel against the interpreter; its mechanics on the lattice of the deck. */
static void decks_of_families_are_checked(void **state) {
  workplace *w = *state;
  write_text(w, "family.nml", deck_of_families);
  expect(w, "run family.nml --check-kernel", 0,
         "kernel check: splm_elastic and its interpreter give the same bits");
  assert_non_null(strstr(w->said, "random bonds of families in each of 4 passes"));
  expect(w, "check family.nml", 0, "no errors");
  assert_null(strstr(w->said, "[patch]"));
  expect(w, "check family.nml --set lattice.kind=square --set lattice.shells=2", 0, "[patch]");
  assert_non_null(strstr(w->said, "particles of a square lattice"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(a_path_is_shown_the_way_to_drive, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_law_runs_in_the_setting_it_is_meant_for, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(what_a_law_implies_says_what_it_is_measured_on,
                                      set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(laws_of_families_are_put_on_lattices, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(decks_of_families_are_checked, set_up_workplace,
                                      tear_down_workplace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
