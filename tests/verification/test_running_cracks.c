/* The decks of examples/kalthoff, stationary_crack and blast_wall against theory and the figures of
   another program, by the program itself. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "deck_run.h"

/* --- a plate under a step of tension (Freund 1990) -------------------------------------------- */

static const double E = 210e9, NU = 0.3, RHO = 8000;

static double dilatational(void) {
  return sqrt(E * (1 - NU) / (RHO * (1 + NU) * (1 - 2 * NU)));
}

static double shear(void) {
  return sqrt(E / (2 * (1 + NU) * RHO));
}

/* 2.6: K(t) = 2 s/(1 - nu) sqrt(c_d (t - t_c)(1 - 2 nu)/pi). */
static double at_rest(double time) {
  const double c = dilatational(), since = time - 2 / c;
  return since > 0 ? 2 * 500e6 / (1 - NU) * sqrt(c * since * (1 - 2 * NU) / M_PI) : 0;
}

static double rayleigh(void) {
  double low = 0.5 * shear(), high = shear();
  while (high - low > 1e-9) {
    const double v = 0.5 * (low + high), d = sqrt(1 - pow(v / dilatational(), 2)),
                 s = sqrt(1 - pow(v / shear(), 2));
    *(4 * d * s > pow(1 + s * s, 2) ? &low : &high) = v;
  }
  return low;
}

/* 6.4: what a tip of speed v has of it, (1 - v/c_R) S/sqrt(1 - v/c_d). */
static double part_of_moving(double v) {
  enum { PIECES = 20000 };
  const double a = 1 / dilatational(), b = 1 / shear();
  double sum = 0;
  for (int k = 0; k < PIECES; k++) {
    const double x = a + (b - a) * (k + 0.5) / PIECES;
    const double up = 4 * x * x * sqrt((x * x - a * a) * (b * b - x * x));
    sum += atan(up / pow(b * b - 2 * x * x, 2)) / (1 / v - x) * (b - a) / PIECES;
  }
  return (1 - v / rayleigh()) / sqrt(1 - v / dilatational()) * exp(sum / M_PI);
}

static void the_part_of_a_moving_tip(void **state) {
  (void)state;
  const double known[] = {.89718, .78288, .65239, .49665};
  for (int k = 0; k < 4; k++)
    assert_true(fabs(part_of_moving(500 * (k + 1)) - known[k]) < 2e-5);
}

static void a_stationary_crack_under_a_step_of_tension(void **state) {
  (void)state;
  const deck_run r = run_begin("stationary_crack/freund.nml", "");
  const table *t = run_history(&r, "crack/K_I");
  const double known[4][2] = {
      {4.9439e-4, 479e6}, {6.5918e-4, 695e6}, {8.2398e-4, 857e6}, {9.8878e-4, 973e6}};
  for (int k = 0; k < 4; k++)
    assert_true(fabs(history_at(t, known[k][0]) - known[k][1]) < 0.01 * known[k][1]);
  double off = 0;
  int count = 0;
  for (int k = 0; k < t->count; k++) {
    if (t->time[k] < 1.3 * 2 / dilatational()) continue;
    off += t->value[k] / at_rest(t->time[k]) - 1;
    count++;
  }
  print_message("Freund: %.1f %% off in the mean\n", 100 * off / count);
  assert_true(fabs(off / count) < 0.05);
  run_end(&r);
}

static void a_moving_crack_under_a_step_of_tension(void **state) {
  (void)state;
  const deck_run r = run_begin("stationary_crack/freund_moving.nml", "");
  const table *t = run_history(&r, "crack/K_I");
  const double t_c = 2 / dilatational();
  double most = 0;
  for (int k = 0; k < t->count; k++) {
    if (t->time[k] < 1.5 * t_c) assert_true(t->value[k] == 0);
    if (t->time[k] < 1.8 * t_c || t->time[k] > 2.8 * t_c) continue;
    const double off = t->value[k] / (part_of_moving(1500) * at_rest(t->time[k])) - 1;
    most = fmax(most, fabs(off));
  }
  print_message("Freund, moving: at most %.1f %% off\n", 100 * most);
  assert_true(most > 0 && most < 0.15);
  const double time = run_last(&r, "crack/length") / 1500 - 5.0001 / 1500; /* it ran for */
  assert_true(fabs(time - (1.009e-3 - 100 * 5.4932e-6)) < 12e-6);
  run_end(&r);
}

/* --- plates ----------------------------------------------------------------------------------- */

/* The mean direction from the kink's end to where the crack leaves the plate, against -y. */
static double mean_angle(const deck_run *r) {
  const double x = run_last(r, "crack/x") - 28.1323e-3, y = run_last(r, "crack/y") + 1.14007e-3;
  return atan2(x, -y) * 180 / M_PI;
}

static void kalthoff_and_winkler(void **state) {
  (void)state;
  const deck_run r = run_begin("kalthoff/m30.nml", "");
  const double begins = history_first_above(run_history(&r, "crack/speed"), 1);
  print_message("Kalthoff M30: %.1f degrees, from %.1f us\n", mean_angle(&r), 1e6 * begins);
  assert_true(begins > 22e-6 && begins < 30e-6);
  assert_true(mean_angle(&r) > 65 && mean_angle(&r) < 82);
  assert_true(fabs(run_said(&r, "mm long, its tip at (") - 100) < 1e-3); /* it has left there */
  assert_true(fabs(run_last(&r, "energy/imbalance")) < 1e-9 * run_last(&r, "energy/external"));
  run_end(&r);
}

/* Without numerical damping all work is found again, and what growth releases is a third of the
   energy release rate over the way. */
static void where_the_energy_of_the_plate_goes(void **state) {
  (void)state;
  const deck_run r = run_begin("kalthoff/m30.nml", "--set simulation.step=2.94761e-7 --set "
                                                   "tips.check_steps=12 --set newmark.beta_1=0.5");
  const double found = run_last(&r, "energy/kinetic") + run_last(&r, "energy/stored") +
                       run_last(&r, "energy/dissipated_damage"),
               part = run_last(&r, "energy/dissipated_damage") /
                      run_said(&r, "of the energy release rate over its way, ");
  print_message("found %.6f of the work, growth releases %.2f\n",
                found / run_last(&r, "energy/external"), part);
  assert_true(fabs(found / run_last(&r, "energy/external") - 0.996) < 0.01);
  assert_true(part > 0.2 && part < 0.4);
  run_end(&r);
}

/* --- walls ------------------------------------------------------------------------------------ */

static void walls_under_a_blast(void **state) {
  (void)state;
  const struct {
    const char *deck;
    double from, to; /* s: K_I reaches K_Ic */
  } walls[] = {{"blast_wall/wall_400_bottom.nml", 0.119e-3, 0.131e-3},
               {"blast_wall/wall_250_bottom.nml", 0.065e-3, 0.095e-3},
               {"blast_wall/wall_250_horizontal.nml", 0.0885e-3, 0.1185e-3}};
  for (int k = 0; k < 3; k++) {
    const deck_run r = run_begin(walls[k].deck, "--set output.sample=2e-7");
    const double begins = history_first_above(run_history(&r, "crack/K_I"), 0.8e6);
    print_message("%s: %.1f us\n", walls[k].deck, 1e6 * begins);
    assert_true(begins > walls[k].from && begins < walls[k].to);
    run_end(&r);
  }
}

/* All tips start at the fifth look; the lower crack runs straight up; the other one is its own
   mirror image. */
static void cracks_of_a_wall_run(void **state) {
  (void)state;
  const deck_run r = run_begin("blast_wall/wall_growth.nml", "");
  const char *tips[] = {"foot/speed", "middle/speed", "middle/start/speed"};
  for (int k = 0; k < 3; k++)
    assert_true(fabs(history_first_above(run_history(&r, tips[k]), 1) - 0.1352e-3) < 1e-7);
  const double foot[] = {run_last(&r, "foot/x"), run_last(&r, "foot/y")},
               left[] = {run_last(&r, "middle/start/x"), run_last(&r, "middle/start/y")},
               right[] = {run_last(&r, "middle/x"), run_last(&r, "middle/y")};
  print_message("wall: foot to %.4f m, the others to (%.4f, %.4f), (%.4f, %.4f) m\n", foot[1],
                left[0], left[1], right[0], right[1]);
  assert_true(fabs(foot[0] - 0.3) < 1e-6 && foot[1] > 0.19 && foot[1] < 0.2001);
  assert_true(fabs(left[0] + right[0] - 0.6) < 1e-5 && fabs(left[1] - right[1]) < 1e-5);
  assert_true(history_largest(run_history(&r, "middle/y")) > 0.206);
  run_end(&r);
}

/* The crack across the low wall runs to its foot on both sides. */
static void the_foot_of_a_wall_spalls(void **state) {
  (void)state;
  const deck_run r = run_begin("blast_wall/spalling.nml", "");
  assert_true(fabs(run_last(&r, "crack/y")) < 1e-9 && fabs(run_last(&r, "crack/start/y")) < 1e-9);
  const double left = run_last(&r, "crack/start/x"), right = run_last(&r, "crack/x");
  print_message("spalling: %.1f mm wide\n", 1e3 * (right - left));
  assert_true(right > 0.31 && fabs(left + right - 0.6) < 1e-5);
  run_end(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_part_of_a_moving_tip),
      cmocka_unit_test(a_stationary_crack_under_a_step_of_tension),
      cmocka_unit_test(a_moving_crack_under_a_step_of_tension),
      cmocka_unit_test(kalthoff_and_winkler),
      cmocka_unit_test(where_the_energy_of_the_plate_goes),
      cmocka_unit_test(walls_under_a_blast),
      cmocka_unit_test(cracks_of_a_wall_run),
      cmocka_unit_test(the_foot_of_a_wall_spalls),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
