/* The decks of examples/kalthoff, impact_beam, stationary_crack and blast_wall against theory and the
   figures of another program, by the program itself. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct table { /* of a history */
  double time[4096], value[4096];
  int count;
} table;

/* Runs a deck of examples/ with a change, and reads one history. */
static table history_of(const char *deck, const char *change, const char *name) {
  char command[2048], line[512];
  static table t;
  t.count = 0;
  snprintf(command, sizeof command,
           "folder=$(mktemp -d) && '%s' run '%s/examples/%s' %s --set output.result=$folder/r.h5 "
           ">/dev/null 2>&1 && '%s' export --history '%s' $folder/r.h5; rm -r $folder",
           PERILAT_PROGRAM, SOURCE_DIR, deck, change, PERILAT_PROGRAM, name);
  FILE *in = popen(command, "r");
  assert_non_null(in);
  while (fgets(line, sizeof line, in))
    if (t.count < 4096 && sscanf(line, "%lf,%lf", &t.time[t.count], &t.value[t.count]) == 2)
      t.count++;
  assert_int_equal(pclose(in), 0);
  assert_true(t.count > 2);
  return t;
}

static double at(const table *t, double time) {
  int k = 0;
  while (k + 1 < t->count && fabs(t->time[k + 1] - time) < fabs(t->time[k] - time))
    k++;
  return t->value[k];
}

static double first_above(const table *t, double level) {
  for (int k = 0; k < t->count; k++)
    if (t->value[k] >= level) return t->time[k];
  return INFINITY;
}

static double largest(const table *t) {
  double most = 0;
  for (int k = 0; k < t->count; k++)
    most = t->value[k] > most ? t->value[k] : most;
  return most;
}

/* Freund (1990), 2.6: a step of tension on a crack, K(t) = 2 s/(1 - nu) sqrt(c_d (t - t_c)(1 - 2 nu)/pi). */
static void a_stationary_crack_under_a_step_of_tension(void **state) {
  (void)state;
  const table t = history_of("stationary_crack/freund.nml", "", "crack/K_I");
  const double E = 210e9, nu = 0.3, rho = 8000,
               c_d = sqrt(E * (1 - nu) / (rho * (1 + nu) * (1 - 2 * nu))), t_c = 2 / c_d;
  const double known[4][2] = {
      {4.9439e-4, 479e6}, {6.5918e-4, 695e6}, {8.2398e-4, 857e6}, {9.8878e-4, 973e6}};
  for (int k = 0; k < 4; k++)
    assert_true(fabs(at(&t, known[k][0]) - known[k][1]) < 0.01 * known[k][1]);
  double off = 0;
  int count = 0;
  for (int k = 0; k < t.count; k++) {
    if (t.time[k] < 1.3 * t_c) continue;
    const double K = 2 * 500e6 / (1 - nu) * sqrt(c_d * (t.time[k] - t_c) * (1 - 2 * nu) / M_PI);
    off += t.value[k] / K - 1;
    count++;
  }
  print_message("Freund: %.1f %% off in the mean\n", 100 * off / count);
  assert_true(fabs(off / count) < 0.05);
}

/* The longest step that is stable damps more, and changes nothing else. */
static void the_struck_beam(void **state) {
  (void)state;
  const char *quick = "--set simulation.step=4.2435e-7 --set tips.check_steps=3";
  table t = history_of("impact_beam/centre_notch.nml", quick, "midspan/K_I");
  const double begins = first_above(&t, 0.8e6);
  print_message("beam: K_Ic at %.3f ms\n", 1e3 * begins);
  assert_true(begins > 0.75e-3 && begins < 0.95e-3);
  assert_true(fabs(at(&t, 1e-3) - 1.280 * 0.8e6) < 0.02 * 0.8e6);
  t = history_of("impact_beam/centre_notch.nml", quick, "load");
  const double load = at(&t, begins);
  print_message("      load %.2f kN\n", 1e-3 * load);
  assert_true(load > 3.7e3 && load < 4.3e3);
}

static void which_crack_of_the_beam_runs(void **state) {
  (void)state;
  table t = history_of("impact_beam/g0672_constant.nml", "", "notch/speed");
  assert_true(fabs(first_above(&t, 1) - 0.849e-3) < 0.02e-3);
  t = history_of("impact_beam/g0672_constant.nml", "", "midspan/speed");
  assert_true(largest(&t) == 0);
  t = history_of("impact_beam/g0734_constant.nml", "", "midspan/speed");
  assert_true(fabs(first_above(&t, 1) - 0.849e-3) < 0.02e-3);
  t = history_of("impact_beam/g0734_constant.nml", "", "notch/speed");
  assert_true(largest(&t) == 0);
  t = history_of("impact_beam/g0672_constant.nml", "", "load");
  assert_true(largest(&t) > 3.7e3 && largest(&t) < 4.3e3);
}

/* The mean direction from the kink's end to where the crack leaves the plate, against -y. */
static void kalthoff_and_winkler(void **state) {
  (void)state;
  table t = history_of("kalthoff/m30.nml", "", "crack/speed");
  const double begins = first_above(&t, 1);
  assert_true(begins > 22e-6 && begins < 30e-6);
  t = history_of("kalthoff/m30.nml", "", "crack/x");
  const double x = t.value[t.count - 1] - 28.1323e-3;
  t = history_of("kalthoff/m30.nml", "", "crack/y");
  const double y = t.value[t.count - 1] + 1.14007e-3, angle = atan2(x, -y) * 180 / M_PI;
  print_message("Kalthoff M30: %.1f degrees, from %.1f us\n", angle, 1e6 * begins);
  assert_true(angle > 65 && angle < 82);
  t = history_of("kalthoff/m30.nml", "", "energy/imbalance");
  const double lost = t.value[t.count - 1];
  t = history_of("kalthoff/m30.nml", "", "energy/external");
  assert_true(fabs(lost) < 0.01 * t.value[t.count - 1]);
}

static void walls_under_a_blast(void **state) {
  (void)state;
  const struct {
    const char *deck;
    double from, to; /* s: K_I reaches K_Ic */
  } walls[] = {{"blast_wall/wall_400_bottom.nml", 0.119e-3, 0.131e-3},
               {"blast_wall/wall_250_bottom.nml", 0.065e-3, 0.095e-3},
               {"blast_wall/wall_250_horizontal.nml", 0.0885e-3 - 1e-6, 0.1185e-3}};
  for (int k = 0; k < 3; k++) {
    const table t = history_of(walls[k].deck, "", "crack/K_I");
    const double begins = first_above(&t, 0.8e6);
    print_message("%s: %.1f us\n", walls[k].deck, 1e6 * begins);
    assert_true(begins > walls[k].from && begins < walls[k].to);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_stationary_crack_under_a_step_of_tension),
      cmocka_unit_test(the_struck_beam),
      cmocka_unit_test(which_crack_of_the_beam_runs),
      cmocka_unit_test(kalthoff_and_winkler),
      cmocka_unit_test(walls_under_a_blast),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
