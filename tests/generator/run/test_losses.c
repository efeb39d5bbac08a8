/* What laws of families lose is booked: the imbalance is small and falls with the step, of second
   order where damage and flow take energy, of first where rate terms do (ledger.h); nothing is lost
   where nothing changes; and it has the same bits whatever the threads and after a resume. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/runtime/hand_over.h"
#include "tests/verification/case.h"

#define PLATE                                                                                      \
  "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '100 mm', '60 mm' /\n"             \
  "&region name = 'low' shape = 'rectangle' corner = -1, -1 size = 2, '1.006 m' /\n"               \
  "&region name = 'top' shape = 'rectangle' corner = -1, '54 mm' size = 2, 1 /\n"                  \
  "&region name = 'right' shape = 'rectangle' corner = '51 mm', -1 size = 2, 2 /\n"                \
  "&support region = 'low' fix = 'xy' /\n"                                                         \
  "&drive region = 'top' component = 'y' velocity = '%g m/s' rise = '10 us' /\n"
#define BLOCK                                                                                      \
  "&body lattice = 'l' shape = 'box' corner = 3*0 size = '12 mm', '24 mm', '12 mm' /\n"            \
  "&region name = 'low' shape = 'box' corner = 3*-1 size = 2, '1.003 m', 2 /\n"                    \
  "&region name = 'top' shape = 'box' corner = -1, '21 mm', -1 size = 3*2 /\n"                     \
  "&support region = 'low' fix = 'xyz' /\n"                                                        \
  "&drive region = 'top' component = 'y' velocity = '%g m/s' rise = '10 us' /\n"
#define IN_PLANE(kind, more)                                                                       \
  "&lattice name = 'l' kind = '" kind "' spacing = '5 mm' thickness = '10 mm' " more " /\n" PLATE
#define IN_SPACE(kind, more)                                                                       \
  "&lattice name = 'l' kind = '" kind "' spacing = '3 mm' " more " /\n" BLOCK
#define LAW(model, more) "&material lattice = 'l' model = '" model "' " more " /\n"
#define DAMPER           SOURCE_DIR "/tests/generator/run/damped_bonds.plm"

typedef struct lossy_run {
  const char *what, *text;
  double velocity; /* m/s */
  int end;         /* us */
  int order;
  double most; /* imbalance over external work, at 0.8 of the stable step */
} lossy_run;

static const lossy_run runs[] = {
    {"breaking bonds", IN_PLANE("square", "horizon = 3.015") LAW("pmb", "G_0 = 20"), 2, 60, 2,
     1e-4},
    {"breaking bonds, irregular", IN_PLANE("blue_noise", "") LAW("pmb", "G_0 = 20"), 2, 60, 2,
     1e-4},
    {"plastic flow", IN_SPACE("cubic", "horizon = 2.015") LAW("eps", ""), 20, 30, 2, 3e-5},
    {"damage of bonds", IN_SPACE("fcc", "") LAW("cohesive", ""), 2, 60, 2, 3e-3},
    {"damage of beams, dampers", IN_PLANE("hexagonal", "shells = 2") LAW("mplm_bilinear", ""), 1,
     100, 1, 2e-3},
    {"dampers", IN_PLANE("square", "horizon = 2.015") LAW(DAMPER, ""), 1, 60, 1, 1e-3},
    {"two laws",
     IN_PLANE("square", "horizon = 2.015") LAW("pmb", "G_0 = 20") LAW("lps", "region = 'right'"), 4,
     60, 2, 1e-4},
};
enum { RUNS = sizeof runs / sizeof *runs };

static bool keeps_energy = true;

static void open_run(deck_case *c, const lossy_run *r, double safety, int threads) {
  char text[4096], head[1024];
  snprintf(head, sizeof head,
           "&simulation end_time = '%d us' step_safety = %g threads = %d /\n"
           "&output frames = 0 sample = '2 us' losses = T energy = %s /\n",
           r->end, safety, threads, keeps_energy ? "T" : "F");
  snprintf(text + snprintf(text, sizeof text, "%s", head), sizeof text - strlen(head), r->text,
           r->velocity);
  deck_case_open(c, text);
}

static const char *const lost_to[] = {"energy/dissipated_damage", "energy/dissipated_damping"};

typedef struct balance {
  double imbalance, external, lost[2];
} balance;

static balance balance_of(const lossy_run *r, double safety) {
  deck_case c;
  open_run(&c, r, safety, 0);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double *imbalance = deck_case_series(&c, "energy/imbalance");
  const long last = simulation_history(c.simulation, NULL) - 1;
  balance b = {.external = deck_case_series(&c, "energy/external")[last]};
  for (long k = 0; k <= last; k++)
    b.imbalance = fmax(b.imbalance, fabs(imbalance[k]) / b.external);
  for (int k = 0; k < 2; k++)
    b.lost[k] = deck_case_series(&c, lost_to[k])[last] / b.external;
  deck_case_close(&c);
  return b;
}

static void what_is_lost_is_booked(void **state) {
  (void)state;
  for (int k = 0; k < RUNS; k++) {
    const lossy_run *r = &runs[k];
    const balance coarse = balance_of(r, 0.8), fine = balance_of(r, 0.2);
    print_message("%s: %.2g lost to states, %.2g to rates; imbalance %.1e, a quarter of the step: "
                  "%.1e\n",
                  r->what, fine.lost[0], fine.lost[1], coarse.imbalance, fine.imbalance);
    assert_true(fine.lost[0] + fine.lost[1] > 0.004);
    assert_true(coarse.imbalance < r->most);
    assert_true(fine.imbalance < (r->order == 2 ? 1.0 / 8 : 0.4) * coarse.imbalance);
  }
}

/* --- nothing ---------------------------------------------------------------------------------- */

/* Bonds that do not break, metal that does not yield. */
static void nothing_is_lost_where_nothing_changes(void **state) {
  (void)state;
  static const lossy_run still[] = {
      {"unbroken", IN_PLANE("square", "horizon = 3.015") LAW("pmb", "G_0 = 1e6"), 2, 60, 2, 1e-4},
      {"elastic metal", IN_SPACE("cubic", "horizon = 2.015") LAW("eps", ""), 0.2, 30, 2, 1e-4}};
  for (int k = 0; k < 2; k++) {
    const balance b = balance_of(&still[k], 0.8);
    print_message("%s: %g lost, imbalance %.1e\n", still[k].what, b.lost[0], b.imbalance);
    assert_true(b.lost[0] == 0 && b.lost[1] == 0);
    assert_true(b.external > 0 && b.imbalance < still[k].most);
  }
}

/* --- the same bits ---------------------------------------------------------------------------- */

static void assert_same_losses(const deck_case *a, const deck_case *b) {
  const long last = simulation_history(a->simulation, NULL) - 1;
  assert_int_equal(simulation_history(b->simulation, NULL) - 1, last);
  for (int k = 0; k < 2; k++) {
    const double *of = deck_case_series(a, lost_to[k]), *and = deck_case_series(b, lost_to[k]);
    for (long n = 0; n <= last; n++)
      assert_true(of[n] == and[n]);
  }
}

static void threads_and_a_resume_lose_the_same(void **state) {
  (void)state;
  for (int k = 0; k < RUNS; k++) {
    deck_case one, more, first, second;
    open_run(&one, &runs[k], 0.8, 1);
    assert_int_equal(deck_case_go(&one), STEP_END);
    open_run(&more, &runs[k], 0.8, 3);
    assert_int_equal(deck_case_go(&more), STEP_END);
    assert_same_losses(&one, &more);
    open_run(&first, &runs[k], 0.8, 1);
    open_run(&second, &runs[k], 0.8, 2);
    hand_over(first.simulation, simulation_step_count(one.simulation) / 2, second.simulation);
    assert_int_equal(deck_case_go(&second), STEP_END);
    assert_same_losses(&one, &second);
    deck_case_close(&one);
    deck_case_close(&more);
    deck_case_close(&first);
    deck_case_close(&second);
  }
}

/* Whether losses are kept makes no difference to what moves. */
static void keeping_losses_changes_nothing_else(void **state) {
  (void)state;
  for (int k = 0; k < RUNS; k++) {
    deck_case with, without;
    open_run(&with, &runs[k], 0.8, 2);
    keeps_energy = false;
    open_run(&without, &runs[k], 0.8, 2);
    keeps_energy = true;
    assert_int_equal(deck_case_go(&with), STEP_END);
    assert_int_equal(deck_case_go(&without), STEP_END);
    const body *a = simulation_state(with.simulation, 0)->body,
               *b = simulation_state(without.simulation, 0)->body;
    for (int d = 0; d < a->dof; d++)
      for (long p = 0; p < a->lattice->particle_count; p++)
        assert_true(a->displacement[d][a->lattice->particle_site[p]] ==
                    b->displacement[d][a->lattice->particle_site[p]]);
    deck_case_close(&with);
    deck_case_close(&without);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_is_lost_is_booked),
      cmocka_unit_test(nothing_is_lost_where_nothing_changes),
      cmocka_unit_test(threads_and_a_resume_lose_the_same),
      cmocka_unit_test(keeping_losses_changes_nothing_else),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
