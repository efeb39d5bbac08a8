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

/* The table goes along: with the result, and in a solver. */
static void a_table_goes_along(void **state) {
  workplace *w = *state;
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

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(a_solver_knows_formulas, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_run_goes_on_from_another, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_table_goes_along, set_up_workplace, tear_down_workplace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
