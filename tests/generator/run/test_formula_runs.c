/* Decks with formulas and files of places, from the command: a solver gives the same bits, runs go
   on from where another has ended, and no input is overwritten. */
#define _GNU_SOURCE /* nftw */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

#include "tests/generator/command_tools.h"

#define PLATE_OF(E, more)                                                                          \
  "&simulation  end_time = '20 us'  step = '0.1 us'  /\n"                                          \
  "&lattice     name = 'c'  kind = 'hexagonal'  spacing = '10 mm'  thickness = '10 mm'  /\n"       \
  "&material    lattice = 'c'  model = 'elastic_central'  E = '" E "'  /\n"                        \
  "&body        lattice = 'c'  shape = 'rectangle'  corner = 0, 0  size = '100 mm', '60 mm'  /\n"  \
  "&region      name = 'all'  shape = 'rectangle'  corner = -1, -1  size = 3, 3  /\n"              \
  "&region      name = 'left'  shape = 'rectangle'  corner = -1, -1  size = 1.006, 3  /\n"         \
  "&output      frames = 2  fields = 'displacement', 'velocity'  /\n" more

#define PLATE(more) PLATE_OF("30 [GPa]*(1 + x/1 [m])", more)

#define WAVE                                                                                       \
  "&drive  region = 'left'  component = 'x'  formula = '1 [um]*sin(t/2 [us])*(1 + y/60 [mm])'  "   \
  "end = '9.13 us'  /\n"                                                                           \
  "&force  region = 'all'  component = 'y'  total = '1 kN'  formula = 'exp(-((x - 5 [km/s]*t)/20 " \
  "[mm])**2)'  /\n"

/* Values of a field on particles, both components; to be freed. */
static double *frame_of(const workplace *w, const char *name, const char *field, long frame,
                        long *count) {
  char error[512], in[64];
  int components;
  result_file *f = result_read(in_workplace(w, name), error, sizeof error);
  assert_non_null(f);
  double *values =
      result_read_frame(f, field, frame, count, &components, in, sizeof in, error, sizeof error);
  assert_non_null(values);
  assert_int_equal(components, 2);
  result_read_close(f);
  return values;
}

static void expect_same(const workplace *w, const char *a, long frame_a, const char *b,
                        long frame_b) {
  static const char *const fields[] = {"displacement", "velocity"};
  for (int k = 0; k < 2; k++) {
    long count_a, count_b;
    double *u = frame_of(w, a, fields[k], frame_a, &count_a);
    double *v = frame_of(w, b, fields[k], frame_b, &count_b);
    assert_int_equal(count_a, count_b);
    assert_true(count_a > 50);
    assert_memory_equal(u, v, 2 * (size_t)count_a * sizeof(double));
    free(u);
    free(v);
  }
}

static void a_solver_knows_formulas(void **state) {
  workplace *w = *state;
#if defined(__SANITIZE_ADDRESS__)
  skip(); /* the solver's compiler does not know the sanitizers that the libraries were made with */
#endif
  write_text(w, "wave.nml", PLATE(WAVE));
  assert_int_equal(shell(w, "\"$P\" run wave.nml"), 0);
  assert_non_null(strstr(w->said, "E differs from place to place: 3.0"));
  assert_int_equal(shell(w, "\"$P\" build wave.nml -o wave && ./wave --set output.result=s.h5"), 0);
  expect_same(w, "wave.h5", 2, "s.h5", 2);
  assert_int_equal(shell(w, "./wave --set output.result=s.h5 --set 'force.formula=exp(-x/a)'"), 1);
  assert_non_null(strstr(w->said, "there is no quantity `a`"));
  write_text(w, "even.nml", PLATE_OF("30 GPa", WAVE));
  assert_int_equal(shell(w, "\"$P\" build even.nml -o even"), 0);
  assert_int_equal(shell(w, "./even --set 'material.E=30 [GPa]*(1 + x/1 [m])'"), 1);
  assert_non_null(strstr(w->said, "made for a `E` that is the same everywhere"));
}

#define FROM(name, component)                                                                      \
  "&initial_displacement  region = 'all'  component = '" component "'  file = '" name              \
  ":displacement'  /\n&initial_velocity  region = 'all'  component = '" component                  \
  "'  file = '" name ":velocity'  /\n"

static void a_run_goes_on_from_another(void **state) {
  workplace *w = *state;
  write_text(w, "first.nml", PLATE(WAVE));
  write_text(w, "next.nml", PLATE(FROM("first.h5", "x") FROM("first.h5", "y")));
  assert_int_equal(shell(w, "\"$P\" run first.nml && \"$P\" run next.nml"), 0);
  long count;
  double *u = frame_of(w, "first.h5", "displacement", 2, &count);
  double *v = frame_of(w, "next.h5", "displacement", 0, &count);
  assert_memory_equal(u, v, 2 * (size_t)count * sizeof(double));
  free(u);
  free(v);
  u = frame_of(w, "first.h5", "velocity", 2, &count);
  v = frame_of(w, "next.h5", "velocity", 0, &count); /* the mean of those half a step off */
  for (long k = 0; k < 2 * count; k++)
    assert_true(fabs(u[k] - v[k]) <= 1e-15 * (1e-3 + fabs(u[k])));
  free(u);
  free(v);
  assert_int_equal(shell(w, "\"$P\" run next.nml --set output.result=first.h5"), 1);
  assert_non_null(strstr(w->said, "the result would overwrite"));
  assert_true(exists(w, "first.h5"));
}

/* The last frame of the first run is the first one of the next. */
static void expect_handed_over(workplace *w, const char *field) {
  assert_int_equal(shell(w, "\"$P\" run first.nml && \"$P\" run next.nml"), 0);
  char error[512], in[64];
  double *values[2];
  long count[2];
  int components[2];
  for (int k = 0; k < 2; k++) {
    result_file *f = result_read(in_workplace(w, k ? "next.h5" : "first.h5"), error, sizeof error);
    assert_non_null(f);
    values[k] = result_read_frame(f, field, k ? 0 : 1, &count[k], &components[k], in, sizeof in,
                                  error, sizeof error);
    assert_non_null(values[k]);
    result_read_close(f);
  }
  const long size = count[0] * components[0];
  assert_int_equal(size, count[1] * components[1]);
  double most = 0;
  for (long k = 0; k < size; k++)
    most = fmax(most, fabs(values[0][k]));
  assert_true(most > 0);
  assert_memory_equal(values[0], values[1], (size_t)size * sizeof(double));
  free(values[0]);
  free(values[1]);
}

#define OVERLAPPING(name, E)                                                                       \
  "&lattice name = '" name "' kind = 'hexagonal' spacing = '5 mm' thickness = '10 mm' /\n"         \
  "&material lattice = '" name "' model = 'splm_elastic' E = '" E "' /\n"                          \
  "&body lattice = '" name "' shape = 'rectangle' corner = 0, 0 size = '60 mm', '30 mm' /\n"       \
  "&region name = 'all_" name "' lattice = '" name                                                 \
  "' shape = 'rectangle' corner = -1, -1 size = 3, 3 /\n"
#define OVERLAP                                                                                    \
  "&simulation end_time = '5 us' /\n" OVERLAPPING("a", "30 GPa") OVERLAPPING("b", "10 GPa") OUTPUT
#define OUTPUT "&output frames = 1 fields = 'displacement' /\n"
#define MOVE(region, from)                                                                         \
  "&initial_displacement region = '" region "' component = 'x' " from " /\n"

/* Places that two lattices have in common. */
static void lattices_that_overlap_go_on_from_their_own_values(void **state) {
  workplace *w = *state;
  write_text(w, "first.nml", OVERLAP MOVE("all_a", "value = '1e-6*x'") MOVE("all_b", "value = 0"));
  write_text(w, "next.nml",
             OVERLAP MOVE("all_a", "file = 'first.h5:displacement'")
                 MOVE("all_b", "file = 'first.h5:displacement'") "&initial_displacement region = "
                                                                 "'all_a' component = 'y' file = "
                                                                 "'first.h5:displacement' /\n"
                                                                 "&initial_displacement region = "
                                                                 "'all_b' component = 'y' file = "
                                                                 "'first.h5:displacement' /\n");
  expect_handed_over(w, "displacement");
  write_text(w, "other.nml",
             "&simulation end_time = '5 us' /\n" OUTPUT OVERLAPPING("c", "30 GPa")
                 MOVE("all_c", "file = 'first.h5:displacement'"));
  assert_int_equal(shell(w, "\"$P\" check other.nml"), 1);
  assert_non_null(strstr(w->said, "of several lattices, and none of them is named `c`"));
}

#define CUBE                                                                                       \
  "&simulation end_time = '1 us' /\n&output frames = 1 fields = 'displacement', 'rotation' /\n"    \
  "&lattice name = 'l' kind = 'cubic' shells = 2 spacing = '5 mm' /\n"                             \
  "&material lattice = 'l' model = 'mplm_space' /\n"                                               \
  "&body lattice = 'l' shape = 'box' corner = 0, 0, 0 size = '20 mm', '20 mm', '20 mm' /\n"        \
  "&region name = 'all' shape = 'box' corner = -1, -1, -1 size = 3, 3, 3 /\n"
#define TURN(axis, from)                                                                           \
  "&initial_displacement region = 'all' component = 'rotation_" axis "' " from " /\n"
#define TURNED "file = 'first.h5:rotation'"

static void rotations_in_space_go_on(void **state) {
  workplace *w = *state;
  write_text(w, "first.nml", CUBE TURN("x", "value = 1e-6") TURN("z", "value = '2e-5*y/1 [m]'"));
  write_text(w, "next.nml", CUBE TURN("x", TURNED) TURN("y", TURNED) TURN("z", TURNED));
  expect_handed_over(w, "rotation");
}

/* The table goes along: with the result, and in a solver. */
static void a_table_goes_along(void **state) {
  workplace *w = *state;
#if defined(__SANITIZE_ADDRESS__)
  skip(); /* the solver's compiler does not know the sanitizers that the libraries were made with */
#endif
  write_text(w, "first.nml", PLATE(WAVE));
  write_text(w, "next.nml",
             PLATE("&initial_velocity  region = 'all'  component = 'x'  file = "
                   "'first.csv:velocity_x'  /\n"));
  assert_int_equal(shell(w,
                         "\"$P\" run first.nml && \"$P\" export first.h5 --frame 2 -o first.csv "
                         "&& \"$P\" run next.nml && \"$P\" build next.nml -o next && rm first.csv "
                         "&& ./next --set output.result=s.h5"),
                   0);
  expect_same(w, "next.h5", 2, "s.h5", 2);
  long count;
  double *from = frame_of(w, "first.h5", "velocity", 2, &count);
  double *to = frame_of(w, "next.h5", "velocity", 0, &count);
  for (long p = 0; p < count; p++)
    assert_true(to[2 * p] == from[2 * p] && to[2 * p + 1] == 0);
  free(from);
  free(to);
}

/* --- parameters ------------------------------------------------------------------------------- */

#define GRADED(given, more)                                                                        \
  "&simulation  end_time = '20 us'  step = '0.2 us'  /\n"                                          \
  "&lattice     name = 'c'  kind = 'square'  horizon = 2.015  spacing = '10 mm'  thickness = "     \
  "'10 mm'  /\n&body  lattice = 'c'  shape = 'rectangle'  corner = 0, 0  size = '100 mm', '60 "    \
  "mm'  /\n&region  name = 'all'  shape = 'rectangle'  corner = -1, -1  size = 3, 3  /\n"          \
  "&region  name = 'top'  shape = 'rectangle'  corner = -1, '35 mm'  size = 3, 3  /\n"             \
  "&initial_velocity  region = 'all'  component = 'x'  value = '2 [m/s]*x/60 [mm]'  /\n"           \
  "&material    lattice = 'c'  model = 'lps'  " given "  /\n"                                      \
  "&output      frames = 2  fields = 'displacement', 'velocity'" more "  /\n"
#define IN_TOP(given) "/\n&material  lattice = 'c'  region = 'top'  model = 'lps'  " given
#define BY_FORMULA    "E = '30 [GPa]*(1 + x/1 [m])'  rho = '2000 [kg/m^3]*(1 + y/60 [mm])'"

/* The same bits from a formula, from the result of that run, and from a table of it; so in a region
   and with the mass. */
static void parameters_come_from_a_result_or_a_table(void **state) {
  workplace *w = *state;
  write_text(w, "formula.nml", GRADED(BY_FORMULA, ", 'E', 'rho'"));
  write_text(w, "result.nml", GRADED("E = 'formula.h5:E'  rho = 'formula.h5:rho'", ""));
  write_text(w, "table.nml", GRADED("E = 'table.csv:E'  rho = 'table.csv:rho'", ""));
  write_text(w, "region.nml",
             GRADED("E = 'table.csv:E'  rho = 'formula.h5:rho'" IN_TOP(
                        "E = '30 [GPa]*(1 + x/1 [m])'  rho = 'table.csv:rho'"),
                    ""));
  assert_int_equal(shell(w, "\"$P\" run formula.nml && \"$P\" export formula.h5 --frame 0 -o "
                            "table.csv && \"$P\" run result.nml && \"$P\" run table.nml"),
                   0);
  assert_non_null(strstr(w->said, "file       E differs from place to place: 3e+10 to 3.3e+10 Pa"));
  expect_same(w, "formula.h5", 2, "result.h5", 2);
  expect_same(w, "formula.h5", 2, "table.h5", 2);
  assert_int_equal(shell(w, "\"$P\" run region.nml"), 0);
  expect_same(w, "formula.h5", 2, "region.h5", 2);
  assert_int_equal(shell(w, "\"$P\" run result.nml --set output.result=formula.h5"), 1);
  assert_non_null(strstr(w->said, "the result would overwrite"));
#if !defined(__SANITIZE_ADDRESS__)
  assert_int_equal(shell(w, "\"$P\" build table.nml -o table && rm table.csv && ./table --set "
                            "output.result=s.h5"),
                   0);
  expect_same(w, "formula.h5", 2, "s.h5", 2);
#endif
}

static void slips_of_files_are_told_at_the_deck(void **state) {
  workplace *w = *state;
  static const struct {
    const char *given, *said;
  } slips[] = {
      {"E = 'none.csv'", "cannot read `none.csv`"},
      {"E = 'field.csv'", "`field.csv` has 2 columns beside those of the places"},
      {"E = 'field.csv:G'", "`field.csv` has no column `G`"},
      {"E = 'field.csv:rho'", "the unit of `rho` is one of `Pa`"},
      {"E = 'field.csv:E'", "no value within half a spacing of the particle at (10, 0) mm"},
      {"E = 'own.h5:displacement'", "`displacement` is in m, here a value in Pa is needed"},
      {"nu = 'own.h5:displacement'", "`displacement` is in m, here a value in 1 is needed"}};
  write_text(w, "own.nml", GRADED("E = '30 GPa'", ""));
  write_text(w, "field.csv", "x, y, E [GPa], rho [kg/m^3]\n0, 0, 30, -1\n");
  assert_int_equal(shell(w, "\"$P\" run own.nml"), 0);
  for (size_t k = 0; k < sizeof slips / sizeof *slips; k++) {
    char text[4096];
    snprintf(text, sizeof text, GRADED("%s", ""), slips[k].given);
    write_text(w, "slip.nml", text);
    assert_int_equal(shell(w, "\"$P\" check slip.nml"), 1);
    if (!strstr(w->said, slips[k].said)) fail_msg("expected `%s` in\n%s", slips[k].said, w->said);
  }
  assert_int_equal(shell(w, "\"$P\" info lps --set \"E='field.csv:E'\""), 1);
  assert_non_null(strstr(w->said, "no particles here that a file could have values for"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(a_solver_knows_formulas, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_run_goes_on_from_another, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(lattices_that_overlap_go_on_from_their_own_values,
                                      set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(rotations_in_space_go_on, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_table_goes_along, set_up_workplace, tear_down_workplace),
      cmocka_unit_test_setup_teardown(parameters_come_from_a_result_or_a_table, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(slips_of_files_are_told_at_the_deck, set_up_workplace,
                                      tear_down_workplace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
