/* The decks of examples/impact_beam against the figures of another program, by the program
   itself. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "deck_run.h"

/* h/c_d/2, and looks at the tip as far apart as with the short step: damps more, and changes
   nothing else. */
#define QUICK "--set simulation.step=4.2435e-7 --set tips.check_steps=20 "

static void the_struck_beam(void **state) {
  (void)state;
  /* of another program, at its looks: the first ones at or after 0.2, 0.4 ... ms, the last before
     1.5 ms */
  const int look[] = {24, 48, 71, 95, 118, 142, 176};
  const double known[] = {.142, .439, .711, 1, 1.28, 1.564, 1.98};
  const deck_run r = run_begin("impact_beam/centre_notch.nml", QUICK);
  const table *K = run_history(&r, "midspan/K_I");
  for (int k = 0; k < 7; k++) {
    const double found = history_at(K, look[k] * 8.487e-6) / 0.8e6;
    assert_true(fabs(found - known[k]) < 0.012 * known[k]);
  }
  const double begins = history_first_above(K, 0.8e6);
  assert_true(fabs(begins - 0.806e-3) < 1e-6);
  const double load = history_at(run_history(&r, "load"), begins);
  print_message("beam: K_Ic at %.3f ms, load %.2f kN\n", 1e3 * begins, 1e-3 * load);
  assert_true(load > 3.7e3 && load < 4.3e3);
  const double work = run_last(&r, "energy/external");
  const double kept = run_last(&r, "energy/kinetic") + run_last(&r, "energy/stored");
  assert_true(kept / work > 0.997 && kept / work < 1);
  run_end(&r);
}

static void an_enriched_basis_in_the_beam(void **state) {
  (void)state;
  for (int radius = 2; radius <= 4; radius += 2) {
    char change[256];
    snprintf(change, sizeof change,
             QUICK "--set mesh.basis=enriched --set mesh.enriched_radius=%d "
                   "--set simulation.end_time=1.01e-3",
             radius);
    const deck_run r = run_begin("impact_beam/centre_notch.nml", change);
    const double K = history_at(run_history(&r, "midspan/K_I"), 118 * 8.487e-6) / 0.8e6;
    print_message("enriched, %d spacings: %.3f\n", radius, K);
    assert_true(K > 0.84 && K < 0.9); /* 0.85 to 0.89 */
    run_end(&r);
  }
}

/* Driven nodes that give way: no crack with a long step. */
static void driven_nodes_that_give_way(void **state) {
  (void)state;
  const deck_run r =
      run_begin("impact_beam/centre_notch.nml", QUICK "--set newmark.motion=velocity_only");
  assert_true(fabs(history_largest(run_history(&r, "midspan/K_I")) - 0.36 * 0.8e6) < 0.01 * 0.8e6);
  run_end(&r);
}

/* Stress intensities of both cracks at 0.8487 ms beside another program's, MPa m^(1/2): K_I at
   midspan; K_I, K_II, K_eq of the notch. */
static void cracks_of_the_beam_before_they_run(void **state) {
  (void)state;
  const struct {
    const char *deck;
    double known[4];
  } beams[] = {{"impact_beam/g0672_constant.nml", {.785, .794, .103, .813}},
               {"impact_beam/g0705_constant.nml", {.796, .744, .102, .765}},
               {"impact_beam/g0734_constant.nml", {.805, .687, .104, .709}}};
  const char *series[] = {"midspan/K_I", "notch/K_I", "notch/K_II", "notch/K_eq"};
  for (int k = 0; k < 3; k++) {
    const deck_run r = run_begin(beams[k].deck, "--set simulation.end_time=0.85e-3");
    for (int n = 0; n < 4; n++) {
      const double K = 1e-6 * run_last(&r, series[n]);
      assert_true(fabs(K - beams[k].known[n]) < 0.02 * beams[k].known[n]);
    }
    run_end(&r);
  }
}

static void which_crack_of_the_beam_runs(void **state) {
  (void)state;
  deck_run r = run_begin("impact_beam/g0672_constant.nml", "");
  assert_true(fabs(history_first_above(run_history(&r, "notch/speed"), 1) - 0.849e-3) < 1e-6);
  assert_true(history_largest(run_history(&r, "midspan/speed")) == 0);
  const table *angle = run_history(&r, "notch/angle");
  const double first = history_at(angle, 0.86e-3) * 180 / M_PI;
  print_message("notch: first at %.1f degrees\n", first);
  assert_true(first > 60 && first < 78);
  const double most = history_largest(run_history(&r, "load"));
  assert_true(most > 3.7e3 && most < 4.3e3);
  run_end(&r);
  r = run_begin("impact_beam/g0734_constant.nml", "");
  assert_true(fabs(history_first_above(run_history(&r, "midspan/speed"), 1) - 0.849e-3) < 1e-6);
  assert_true(history_largest(run_history(&r, "notch/speed")) == 0);
  assert_true(fabs(history_at(run_history(&r, "midspan/angle"), 0.86e-3) * 180 / M_PI - 90) < 2);
  run_end(&r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_struck_beam),
      cmocka_unit_test(an_enriched_basis_in_the_beam),
      cmocka_unit_test(driven_nodes_that_give_way),
      cmocka_unit_test(cracks_of_the_beam_before_they_run),
      cmocka_unit_test(which_crack_of_the_beam_runs),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
