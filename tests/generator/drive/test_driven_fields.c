/* Paths that set a field of the law: forces by hand, the work that a field gives, whose error falls
   with the square of the step, and what a path may not say. */
#define _GNU_SOURCE
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "generator/drive/driven_fields.h"
#include "tests/generator/command_tools.h"

static const char head[] = "  parameter E_20 = 30 [GPa] in (0, inf)\n"
                           "  parameter rho = 2323 [kg/m^3] in (0, inf)\n";
static const char modulus[] = "  E = E_20*(1 - 1e-3 [1/K]*(T - 293 [K]))\n";

static void write_laws(const workplace *w) {
  char text[1500];
  snprintf(text, sizeof text,
           "model bond\n  law central bond\n%s"
           "  field T [K] on particle = 293 [K] in (0, 900 [K])\n%s"
           "  force N = E*area*stretch\nend model\n",
           head, modulus);
  write_text(w, "bond.plm", text);
  snprintf(text, sizeof text,
           "model point\n  law continuum\n  for space\n%s"
           "  field T [K] on point = 293 [K] in (0, 900 [K])\n%s"
           "  stress sigma = hooke(strain, E, 0.2)\nend model\n",
           head, modulus);
  write_text(w, "point.plm", text);
  snprintf(text, sizeof text,
           "model family\n  law state\n  for plane_stress\n%s"
           "  field T [K] on particle = 293 [K] in (0, 900 [K])\n%s"
           "  force state F[j] = 2*E*s*t/(sqrt(3)*(1 + 1/3))*stretch[j]\n"
           "  energy W = sum(s*F[j]*stretch[j])/4\n  output seen = T\nend model\n",
           head, modulus);
  write_text(w, "family.plm", text);
}

#define BOTH                                                                                       \
  "&path quantity = '%s' times = 0, 1 values = 0, 1e-4 /\n"                                        \
  "&path field = 'T' times = 0, 1 values = '293 K', '793 K' /\n"

static void write_path(const workplace *w, const char *model, const char *quantity, int steps,
                       const char *more) {
  char text[1500];
  snprintf(text, sizeof text,
           "&simulation steps = %d /\n&material model = '%s.plm' /\n" BOTH "%s"
           "&output csv = 'path.csv' /\n",
           steps, model, quantity, more);
  write_text(w, "path.nml", text);
}

/* The last value of a column. */
static double last_of(const workplace *w, const char *column) {
  size_t size;
  char *text = read_bytes(w, "path.csv", &size), *line = strtok(text, "\n"), *last = NULL;
  int number = 0;
  for (const char *at = line, *end = strstr(line, column); at < end; at++)
    number += *at == ',';
  while ((line = strtok(NULL, "\n")))
    last = line;
  for (; number > 0; number--)
    last = strchr(last, ',') + 1;
  const double value = atof(last);
  free(text);
  return value;
}

static void forces_follow_the_field(void **state) {
  workplace *w = *state;
  write_laws(w);
  write_path(w, "bond", "stretch", 10,
             "&bond area = '400 mm^2' /\n"
             "&expect quantity = 'final N' formula = 'E_20/2*area*stretch' /\n"
             "&expect quantity = 'N' at_time = 0.5 value = '450 N' /\n"
             "&expect quantity = 'N' at_time = 0.5 formula = 'E_20*area*stretch*(1 - 1e-3 "
             "[1/K]*(T - 293 [K]))' /\n");
  expect(w, "drive path.nml", 0, "3 of 3 expectations hold");
  expect(w, "drive path.nml --compiled", 0, "3 of 3 expectations hold");
  write_path(w, "point", "strain_xx", 10,
             "&point test = 'uniaxial stress' /\n"
             "&expect quantity = 'final stress_xx' formula = 'E_20/2*1e-4' /\n"
             "&expect quantity = 'stress_xx' at_time = 0.5 value = '1.125 MPa' /\n");
  expect(w, "drive path.nml", 0, "2 of 2 expectations hold");
  write_path(w, "family", "strain_xx", 10,
             "&expect quantity = 'final seen' value = '793 K' /\n"
             "&expect quantity = 'final F_1' formula = 'E_20*spacing*t/(sqrt(3)*(1 + "
             "1/3))*1e-4' /\n");
  expect(w, "drive path.nml", 0, "2 of 2 expectations hold");
}

/* The table has the fields, driven or not, between outputs and energies. */
static void the_table_has_the_fields(void **state) {
  static const char *const laws[][3] = {
      {"bond", "stretch",
       "&bond area = '400 mm^2' /\n&expect quantity = 'T' at_time = 0.5 value = "
       "'543 K' /\n&output picture = 'T.svg' x = 'T' /\n"},
      {"point", "strain_xx",
       "&expect quantity = 'stress_xx at peak T' formula = "
       "'E/0.9*1e-4' /\n"},
      {"family", "strain_xx", "&expect quantity = 'final T' formula = 'seen' /\n"}};
  workplace *w = *state;
  write_laws(w);
  for (int k = 0; k < 3; k++) {
    write_path(w, laws[k][0], laws[k][1], 10, k ? laws[k][2] : "");
    if (k == 0) {
      char text[1000];
      snprintf(text, sizeof text,
               "&simulation steps = 10 /\n&material model = 'bond.plm' /\n" BOTH "%s", "stretch",
               laws[k][2]);
      write_text(w, "path.nml", text);
    }
    expect(w, "drive path.nml", 0, "1 of 1 expectations hold");
  }
  assert_true(exists(w, "T.svg"));
  write_text(w, "path.nml",
             "&bond area = '400 mm^2' /\n&material model = 'bond.plm' /\n"
             "&path quantity = 'stretch' times = 0, 1 values = 0, 1e-4 /\n"
             "&expect quantity = 'T' value = '293 K' /\n");
  expect(w, "drive path.nml", 0, "1 of 1 expectations hold");
}

/* `stretch` is the law's, less the rest stretch, or nothing; that of the path is the total. */
static void stretch_has_one_meaning(void **state) {
  workplace *w = *state;
  write_text(w, "dry.plm",
             "model dry\n  law central bond\n  parameter rho = 2323 [kg/m^3] in (0, inf)\n"
             "  parameter k = 1e-3 in [0, 0.01]\n  field h on particle = 1 in [0, 1]\n"
             "  rest stretch = -k*(1 - h)\n  force N = 1 [MN]*stretch\n  output e = stretch\n"
             "end model\n");
#define DRY                                                                                        \
  "&material model = 'dry.plm' /\n"                                                                \
  "&path quantity = 'stretch' times = 0, 1 values = 0, 1e-4 /\n"                                   \
  "&path field = 'h' times = 0, 1 values = 1, 0.5 /\n"
  write_text(w, "path.nml",
             DRY "&expect quantity = 'final e' formula = 'stretch' /\n"
                 "&expect quantity = 'final e' value = 6e-4 /\n"
                 "&expect quantity = 'final total_stretch' formula = 'total_stretch' /\n"
                 "&expect quantity = 'N' at_stretch = 5e-5 formula = '1 [MN]*(5e-5 + k/4)' /\n");
  expect(w, "drive path.nml", 0, "4 of 4 expectations hold");
  write_text(w, "path.nml", DRY "&expect quantity = 'final stretch' formula = 'stretch' /\n");
  expect(w, "drive path.nml", 1, "that of the path is `total_stretch`");
}

/* What is explained is the step that went wrong, with its length and what the fields are then. */
static void what_goes_wrong_is_found(void **state) {
  workplace *w = *state;
  write_text(w, "root.plm",
             "model root\n  law central bond\n  parameter rho = 2323 [kg/m^3] in (0, inf)\n"
             "  field h on particle = 1 in [0, 1]\n  state v on bond = 0\n"
             "  rate v = (1e3*v**2 + 1e-5)/1 [s]\n  low = sqrt(h - 0.5)\n"
             "  force N = 1 [MN]*(stretch - v)*low\nend model\n");
#define STRETCHED "&material model = 'root.plm' /\n&path quantity = 'stretch' "
  write_text(w, "path.nml",
             STRETCHED "times = 0, 1, 401 values = 0, 1e-3, 1e-3 /\n"
                       "&simulation steps = 4 /\n");
  expect(w, "drive path.nml", 2, "root.plm:6: the law's `v` stops being finite there");
  write_text(w, "path.nml",
             STRETCHED "times = 0, 1e-6 values = 0, 1e-3 /\n"
                       "&path field = 'h' times = 0, 1e-6 values = 1, 0 /\n");
  expect(w, "drive path.nml", 2, "root.plm:7: the law's `low` stops being finite there");
}

/* Work of the force less what is stored at the end: integral of E x dx less E x^2/2, and what the
   field took is the rest; the imbalance is the error of trapezoids. */
static void the_balance_holds(void **state) {
  static const char *const laws[][3] = {{"bond", "stretch", "&bond area = '400 mm^2' /\n"},
                                        {"point", "strain_xx", ""}};
  workplace *w = *state;
  write_laws(w);
  for (int k = 0; k < 2; k++) {
    double off[2];
    for (int fine = 0; fine < 2; fine++) {
      write_path(w, laws[k][0], laws[k][1], fine ? 40 : 20, laws[k][2]);
      assert_int_equal(shell(w, "$P drive path.nml"), 0);
      off[fine] = fabs(last_of(w, "imbalance") / last_of(w, "stored"));
    }
    assert_true(off[1] < 1e-3 && off[0] / off[1] > 3.5 && off[0] / off[1] < 4.5);
  }
  write_path(w, "family", "strain_xx", 400, "");
  assert_int_equal(shell(w, "$P drive path.nml"), 0);
  assert_true(fabs(last_of(w, "dissipated") / last_of(w, "stored")) < 1e-4);
}

static void what_cannot_be_is_told(void **state) {
  workplace *w = *state;
  static const char *const wrong[][2] = {
      {"&path field = 'Q' times = 0, 1 values = 1, 2 /\n", "the law `bond` has no field `Q`"},
      {"&path field = 'E_20' times = 0, 1 values = 1, 2 /\n",
       "`E_20` is a parameter: give it in &material"},
      {"&path field = 'T' times = 0, 1 values = '1 mm', '2 mm' /\n",
       "`T` needs a temperature (K), this is a length (m)"},
      {"&path field = 'T' times = 0, 1 values = '293 K', '950 K' /\n",
       "`T` = 950 (SI) is not in the range (0, 900) of the law `bond`"},
      {"&path field = 'T' times = 1, 0 values = '293 K', '300 K' /\n",
       "each of the `times` must be later than the one before"},
      {"&path field = 'T' value = '300 K' /\n", "`value` does not go with `field`"},
      {"&path field = 'T' times = 0, 1 values = 293, 300 /\n&path field = 'T' times = 0, 1 values "
       "= 293, 300 /\n",
       "the field `T` has a path already"},
      {"&path times = 0, 1 values = 0, 1 /\n", "`&path` needs `quantity` or `field`"}};
  write_laws(w);
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    char text[1000];
    snprintf(text, sizeof text,
             "&bond area = '400 mm^2' /\n&material model = 'bond.plm' /\n"
             "&path quantity = 'stretch' times = 0, 1 values = 0, 1e-4 /\n%s",
             wrong[k][0]);
    write_text(w, "path.nml", text);
    expect(w, "drive path.nml", 1, wrong[k][1]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up_workplace, tear_down_workplace)
      TEST(forces_follow_the_field),  TEST(the_table_has_the_fields), TEST(stretch_has_one_meaning),
      TEST(what_goes_wrong_is_found), TEST(the_balance_holds),        TEST(what_cannot_be_is_told)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
