/* Bars whose stiffness follows a field: the force under a gradient of temperature against the
   integral of 1/E, with an error that falls with the square of the spacing, of a chain of bonds, of
   families and of a mesh; a bar that is heated under load; the same bits for any number of threads
   and after a stop. */
#define _GNU_SOURCE
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/command_tools.h"

static const double AREA = 4e-4, E_20 = 30e9, STRAIN = 1e-4, HALF = 0.5; /* left of E at the end */

/* Of E = E_20 (1 - x/(2 L)): strain L A / integral(dx/E). */
static double force_of_gradient(void) {
  return STRAIN * AREA * E_20 * HALF / log(1 / (1 - HALF));
}

static double last_of(const workplace *w, const char *result, const char *series) {
  char unit_text[64], error[1000];
  long count;
  result_file *f = open_result_of(w, result);
  double *values =
      result_read_series(f, series, &count, unit_text, sizeof unit_text, error, sizeof error);
  assert_non_null(values);
  const double last = values[count - 1];
  free(values);
  result_read_close(f);
  return last;
}

/* The largest force of a deck with a change. */
static double force_of(workplace *w, const char *deck, const char *change) {
  const int status = shell(w, "$P run %s %s --set output.result=bar.h5", deck, change);
  if (status) fprintf(stderr, "%s\n", w->said);
  assert_int_equal(status, 0);
  return last_of(w, "bar.h5", "load");
}

static void check_order(workplace *w, const char *deck, const char *key, const double *sizes,
                        double most) {
  const double exact = force_of_gradient();
  double error[3];
  for (int k = 0; k < 3; k++) {
    char change[100];
    snprintf(change, sizeof change, "--set '%s=%g mm'", key, sizes[k]);
    error[k] = force_of(w, deck, change) / exact - 1;
  }
  assert_true(fabs(error[2]) < most);
  for (int k = 0; k < 2; k++)
    assert_true(error[k] / error[k + 1] > 3.8 && error[k] / error[k + 1] < 4.2);
}

static void a_chain_bears_the_force_of_theory(void **state) {
  check_order(*state, SOURCE_DIR "/examples/heated_bar/gradient.nml", "lattice.spacing",
              (const double[]){40, 20, 10}, 1e-5);
}

/* --- a mesh ----------------------------------------------------------------------------------- */

static const char solid[] =
    "model solid\n"
    "  law continuum\n"
    "  for plane_stress\n"
    "  parameter E_20 = 30 [GPa] in (0, inf)\n"
    "  parameter nu = 0 in [0, 0.5)\n"
    "  parameter rho = 2323 [kg/m^3] in (0, inf)\n"
    "  field T [K] on point = 293 [K] in (0, inf)\n"
    "  stress sigma = hooke(strain, E_20*(1 - 1e-3 [1/K]*(T - 293 [K])), nu)\n"
    "  output seen = T\n"
    "end model\n";

static void write_mesh(const workplace *w, int cells, const char *field) {
  char text[2000];
  write_text(w, "solid.plm", solid);
  snprintf(text, sizeof text,
           "&simulation end_time = 1 /\n&relaxation increments = 1 tolerance = 1e-9 /\n"
           "&mesh name = 'bar' corner = 0, 0 size = '1 m', '40 mm' nodes = %d, 3 thickness = "
           "'10 mm' method = 'finite_elements' /\n"
           "&material mesh = 'bar' model = './solid.plm' /\n"
           "&field mesh = 'bar' name = 'T' %s /\n"
           "&region name = 'left' shape = 'rectangle' corner = '-1 mm', '-1 mm' size = '2 mm', "
           "'50 mm' /\n"
           "&region name = 'right' shape = 'rectangle' corner = '999 mm', '-1 mm' size = '2 mm', "
           "'50 mm' /\n"
           "&support region = 'left' fix = 'x' /\n&support region = 'foot' fix = 'y' /\n"
           "&region name = 'foot' shape = 'rectangle' corner = '-1 mm', '-1 mm' size = '2 mm', "
           "'2 mm' /\n"
           "&drive region = 'right' component = 'x' displacement = '0.1 mm' /\n"
           "&monitor name = 'load' kind = 'reaction' region = 'right' component = 'x' /\n"
           "&output result = 'bar.h5' frames = 1 fields = 'displacement', 'T', 'seen' /\n",
           cells + 1, field);
  write_text(w, "mesh.nml", text);
}

static void a_mesh_bears_the_force_of_theory(void **state) {
  workplace *w = *state;
  const double exact = force_of_gradient();
  double error[3];
  for (int k = 0; k < 3; k++) {
    write_mesh(w, 10 << k, "value = '293 [K] + 500 [K]*x/1 [m]'");
    error[k] = force_of(w, "mesh.nml", "") / exact - 1;
  }
  assert_true(fabs(error[2]) < 1e-4);
  for (int k = 0; k < 2; k++)
    assert_true(error[k] / error[k + 1] > 3.8 && error[k] / error[k + 1] < 4.2);
}

/* At the end of a ramp in time all is as if it had been so from the start. */
static void what_a_table_ends_with_counts(void **state) {
  workplace *w = *state;
  write_mesh(w, 10, "times = 0, 0.5, 1 values = '293 K', '350 K', '493 K'");
  const double heated = force_of(w, "mesh.nml", "");
  write_mesh(w, 10, "value = '493 K'");
  const double hot = force_of(w, "mesh.nml", "");
  assert_true(fabs(heated / hot - 1) < 1e-9);
  assert_true(fabs(hot / (STRAIN * AREA * E_20 * 0.8) - 1) < 1e-9);
}

/* So it is where the place counts, too. */
static void what_a_formula_ends_with_counts(void **state) {
  workplace *w = *state;
  static const char grown[] = "293 [K] + 500 [K]*x/1 [m]*t**2/1 [s]**2";
  char change[200];
  snprintf(change, sizeof change, "--set 'field.value=%s'", grown);
  const char *deck = SOURCE_DIR "/examples/heated_bar/gradient.nml";
  assert_true(fabs(force_of(w, deck, change) / force_of(w, deck, "") - 1) < 1e-6);
  snprintf(change, sizeof change, "value = '%s'", grown);
  write_mesh(w, 10, change);
  const double moved = force_of(w, "mesh.nml", "");
  write_mesh(w, 10, "value = '293 [K] + 500 [K]*x/1 [m]'");
  assert_true(fabs(moved / force_of(w, "mesh.nml", "") - 1) < 1e-6);
}

/* --- in time ---------------------------------------------------------------------------------- */

/* The end moves by F L/(A E(T)). */
static void a_bar_gives_way_in_a_fire(void **state) {
  workplace *w = *state;
  assert_int_equal(
      shell(w, "$P run " SOURCE_DIR "/examples/heated_bar/fire.nml --set output.result=fire.h5"),
      0);
  const double end = 1200 / (AREA * E_20 * HALF);
  assert_true(fabs(last_of(w, "fire.h5", "displacement") / end - 1) < 1e-9);
  assert_non_null(strstr(w->said, "T changes in time: 293 to 793 K"));
  /* W = F^2 L/(2 A E) doubles as the load works on: half of that work is stored, half goes out,
     less what damping bears of the force as the bar moves, an 800th */
  const double stored = last_of(w, "fire.h5", "energy/stored");
  assert_true(fabs(last_of(w, "fire.h5", "energy/imbalance")) < 1e-6 * stored);
  assert_true(fabs(last_of(w, "fire.h5", "energy/rest") / -(stored / 2) - 1) < 2e-3);
}

/* --- the same bits ---------------------------------------------------------------------------- */

static const char brittle[] = "model brittle\n"
                              "  law %s\n"
                              "  for plane_stress\n"
                              "  parameter E = 30 [GPa] in (0, inf)\n"
                              "  parameter rho = 2323 [kg/m^3] in (0, inf)\n"
                              "  field T [K] on particle = 293 [K] in (0, inf)\n"
                              "%s"
                              "end model\n";
static const char of_bonds[] =
    "  limit = 4e-4*293 [K]/T\n"
    "  damage omega = | 0 when stretch <= limit | 1 otherwise\n"
    "  force N = (1 - omega)*sqrt(3)/2*E*s*t*stretch*(1 - 1e-3 [1/K]*(T - 293 [K]))\n";
static const char of_families[] =
    "  damage w on particle\n"
    "  k = 1.5*E*spacing*t*(1 - 1e-3 [1/K]*(T - 293 [K]))\n"
    "  force state F[j] = (1 - (w + w[j])/2)*k/2*(1 + T[j]/T)*stretch[j]\n"
    "  w = | 0 when max(stretch[j]) <= 4e-4*293 [K]/T | 0.5 otherwise\n";

static void write_brittle(workplace *w, const char *kind, const char *rules, const char *lattice) {
  char text[2000];
  snprintf(text, sizeof text, brittle, kind, rules);
  write_text(w, "brittle.plm", text);
  snprintf(text, sizeof text,
           "&simulation title = 'a plate' end_time = '1 ms' /\n"
           "&lattice name = 'plate' kind = '%s' spacing = '5 mm' thickness = '10 mm' /\n"
           "&material lattice = 'plate' model = './brittle.plm' /\n"
           "&field name = 'T' value = '293 [K] + 200 [K]*x/100 [mm]*sin(t/0.2 [ms])**2' /\n"
           "&body lattice = 'plate' shape = 'rectangle' corner = 0, 0 size = '100 mm', '60 mm' /\n"
           "&region name = 'left' shape = 'rectangle' corner = '-1 mm', '-1 mm' size = '5 mm', "
           "'70 mm' /\n"
           "&region name = 'right' shape = 'rectangle' corner = '96 mm', '-1 mm' size = '5 mm', "
           "'70 mm' /\n"
           "&support region = 'left' fix = 'xy' /\n"
           "&drive region = 'right' component = 'x' velocity = '60 mm/s' rise = '0.2 ms' /\n"
           "&monitor name = 'load' kind = 'reaction' region = 'right' component = 'x' /\n"
           "&output result = 'beam.h5' frames = 4 fields = 'displacement', 'damage', 'T' /\n",
           lattice);
  write_text(w, "beam.nml", text);
}

static void check_threads(workplace *w) {
  for (int threads = 1; threads <= 3; threads++)
    assert_int_equal(
        shell(w, "$P run beam.nml --threads %d --set output.result=%d.h5", threads, threads), 0);
  expect_same_results(w, "1.h5", "2.h5");
  expect_same_results(w, "1.h5", "3.h5");
  assert_int_equal(shell(w, "$P run beam.nml --interpret --set output.result=i.h5"), 0);
  expect_same_results(w, "1.h5", "i.h5");
}

static void threads_do_not_show(void **state) {
  workplace *w = *state;
  write_brittle(w, "central bond", of_bonds, "hexagonal");
  check_threads(w);
  assert_true(last_of(w, "1.h5", "load") != 0);
  write_brittle(w, "central bond", of_bonds, "square");
  check_threads(w);
  write_brittle(w, "state", of_families, "hexagonal");
  check_threads(w);
}

static void a_stop_does_not_show(void **state) {
  workplace *w = *state;
  write_brittle(w, "central bond", of_bonds, "hexagonal");
  write_long_deck(w);
  const pid_t run = start_long_run(w, "part.h5", NULL);
  kill(run, SIGINT);
  assert_int_equal(end_of(run), 130);
  assert_int_equal(shell(w, "$P run long.nml --resume --threads 2 --set output.result=part.h5 "
                            "--set 'simulation.title=a long run'"),
                   0);
  assert_int_equal(shell(w, "$P run long.nml --set output.result=whole.h5"), 0);
  expect_same_results(w, "part.h5", "whole.h5");
}

/* A field that a deck does not give is a number, to the last bit. */
static void a_default_is_a_number(void **state) {
  workplace *w = *state;
  char text[1000];
  write_brittle(w, "central bond", of_bonds, "hexagonal");
  assert_int_equal(shell(w, "sed -i '/^&field/d; s/, .T. / /' beam.nml && $P run beam.nml"), 0);
  snprintf(text, sizeof text, brittle, "central bond", of_bonds);
  char *field = strstr(text, "field T [K] on particle");
  memcpy(field, "parameter T            ", 23);
  write_text(w, "brittle.plm", text);
  assert_int_equal(shell(w, "$P run beam.nml --set output.result=number.h5"), 0);
  expect_same_results(w, "beam.h5", "number.h5");
}

int main(void) {
  const struct CMUnitTest tests[] = {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up_workplace, tear_down_workplace)
      TEST(a_chain_bears_the_force_of_theory),
      TEST(a_mesh_bears_the_force_of_theory),
      TEST(what_a_table_ends_with_counts),
      TEST(what_a_formula_ends_with_counts),
      TEST(a_bar_gives_way_in_a_fire),
      TEST(threads_do_not_show),
      TEST(a_stop_does_not_show),
      TEST(a_default_is_a_number),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
