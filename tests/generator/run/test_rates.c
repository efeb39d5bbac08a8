/* States that have a rate, in runs: what is held relaxes and what is loaded creeps as theory says,
   in quasi-static runs, too; steps that shrink are as long as they are; a drive and a run agree;
   and neither threads nor a resume change a bit. */
#define _GNU_SOURCE /* nftw */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/generator/command_tools.h"
#include "tests/verification/same_bits.h"

#define HOUR 3600.0

/* --- quasi-static runs ------------------------------------------------------------------------ */

#define PLATE(model)                                                                               \
  "&lattice name = 'l' kind = 'hexagonal' spacing = '10 mm' thickness = '100 mm' /\n"              \
  "&material lattice = 'l' model = '" model "' /\n"                                                \
  "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '80 mm', '60 mm' /\n"              \
  "&region name = 'foot' shape = 'rectangle' corner = -1, '-1 mm' size = 2, '2 mm' /\n"            \
  "&region name = 'head' shape = 'rectangle' corner = -1, '50 mm' size = 2, 1 /\n"                 \
  "&support region = 'foot' fix = 'xy' /\n"                                                        \
  "&monitor name = 'load' kind = 'reaction' region = 'head' component = 'y' /\n"                   \
  "&monitor name = 'u' kind = 'displacement' region = 'head' component = 'y' /\n"

/* What an element of that time bears of an even rise over an hour, then held. */
static double borne(double time, double tau) {
  const double t = time / tau, rise = HOUR / tau;
  if (time <= HOUR) return (1 - exp(-t)) / rise;
  return (1 - exp(-rise)) / rise * exp(rise - t);
}

/* All bonds relax alike: so does what a plate bears whose head is moved and held, whatever the
   shape of its stresses. Small displacements, so that chords hardly turn. */
static void a_plate_relaxes_as_its_bonds(void **state) {
  (void)state;
  deck_case c;
  deck_case_open(
      &c, "&simulation end_time = '10 h' /\n&relaxation increments = 10 tolerance = 1e-7 /\n" PLATE(
              "maxwell_bond") "&drive region = 'head' component = 'y' displacement = '1 nm' rise = "
                              "'1 h' /\n"
                              "&support region = 'head' fix = 'x' /\n");
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double *time, *load = deck_case_series(&c, "load");
  const long samples = simulation_history(c.simulation, &time);
  double most = 0;
  for (long k = 1; k < samples; k++) {
    const double rise = fmin(time[k] / HOUR, 1);
    const double wanted = 10 * rise + 12 * borne(time[k], HOUR) + 8 * borne(time[k], 100 * HOUR);
    const double first = 10 + 12 * borne(HOUR, HOUR) + 8 * borne(HOUR, 100 * HOUR);
    most = fmax(most, fabs(load[k] / load[1] - wanted / first));
  }
  print_message("a plate that relaxes: off by %.1e of its first load\n", most);
  assert_int_equal(samples, 11);
  assert_true(most < 1e-6);
  deck_case_close(&c);
}

/* Under a force that comes in an hour and stays u goes as 1/E + (1/E_1)(1 - ...). Returns the
   largest error over the last displacement. */
static double creep_error(int increments) {
  char text[3000];
  deck_case c;
  snprintf(
      text, sizeof text,
      "&simulation end_time = '10 h' /\n&relaxation increments = %d tolerance = 1e-8 /\n" PLATE(
          "kelvin_voigt_bond' tau = '2 h") "&force region = 'head' component = 'y' total = '1 N' "
                                           "history = 'ramp and hold' rise = "
                                           "'1 h' /\n",
      increments);
  deck_case_open(&c, text);
  assert_int_equal(deck_case_go(&c), STEP_END);
  const double *time, *u = deck_case_series(&c, "u");
  const long samples = simulation_history(c.simulation, &time);
  double most = 0, scale = 0;
  for (int turn = 0; turn < 2; turn++)
    for (long k = 1; k < samples; k++) {
      const double rise = fmin(time[k] / HOUR, 1);
      const double wanted = rise + 2 * (rise - borne(time[k], 2 * HOUR));
      if (turn == 0)
        scale = u[k] / wanted; /* of the last */
      else
        most = fmax(most, fabs(u[k] - scale * wanted) / (3 * scale));
    }
  deck_case_close(&c);
  return most;
}

static void a_plate_creeps_as_its_bonds(void **state) {
  (void)state;
  const double coarse = creep_error(10), fine = creep_error(40), finest = creep_error(160);
  print_message("a plate that creeps: off by %.1e, %.1e, %.1e\n", coarse, fine, finest);
  assert_true(coarse < 1.2e-2 && fine < coarse / 3 && finest < fine / 3);
}

/* --- steps that shrink ------------------------------------------------------------------------ */

#define BAR                                                                                        \
  "&lattice name = 'l' kind = 'chain' spacing = '10 mm' area = '100 mm^2' /\n"                     \
  "&material lattice = 'l' model = '" SOURCE_DIR "/tests/generator/laws/ageing_bar.plm' /\n"       \
  "&body lattice = 'l' shape = 'segment' from = 0, 0 to = '100 mm', 0 /\n"                         \
  "&region name = 'left' shape = 'point' at = 0, 0 /\n"                                            \
  "&region name = 'right' shape = 'point' at = '100 mm', 0 /\n"                                    \
  "&support region = 'left' fix = 'x' /\n"                                                         \
  "&drive region = 'right' component = 'x' displacement = '0.3 mm' rise = '0.2 ms' /\n"            \
  "&output frames = 2 sample = '10 us' /\n"

static void open_bar(deck_case *c, const char *more, int threads) {
  char text[3000];
  snprintf(text, sizeof text, "&simulation end_time = '0.25 ms' %s threads = %d /\n" BAR, more,
           threads);
  deck_case_open(c, text);
}

/* The age of the first bond, and the time of its state. */
static double age_of(const deck_case *c, double *reached) {
  const sweep *w = c->simulation->laws[0].state;
  *reached = w->body->reached;
  return w->field[0][w->lattice->particle_site[0]];
}

static void the_age_is_the_time(void **state) {
  (void)state;
  static const char *const steps[] = {"step = '0.3 us'", "step_safety = 0.6 shrink_every = 5"};
  for (int k = 0; k < 2; k++) {
    deck_case c;
    int changes;
    double reached;
    open_bar(&c, steps[k], 1);
    assert_int_equal(deck_case_go(&c), STEP_END);
    simulation_step_changes(c.simulation, &changes);
    const double age = age_of(&c, &reached);
    print_message("age %.17g s at %.17g s, after %d changes of the step\n", age, reached, changes);
    assert_true(k == 0 ? changes == 0 : changes > 0);
    assert_true(fabs(age - reached) < 1e-12 * reached && reached > 2.49e-4);
    deck_case_close(&c);
  }
}

/* --- the same bits ---------------------------------------------------------------------------- */

#define MOVED                                                                                      \
  "&region name = 'low' shape = 'rectangle' corner = -1, -1 size = 2, '1.006 m' /\n"               \
  "&region name = 'top' shape = 'rectangle' corner = -1, '34 mm' size = 2, 1 /\n"                  \
  "&support region = 'low' fix = 'xy' /\n"                                                         \
  "&output frames = 2 /\n"
#define DRIVEN  "&drive region = 'top' component = 'x' velocity = '2 m/s' rise = '20 us' /\n" MOVED
#define IN_TIME "&simulation end_time = '0.1 ms' threads = %d /\n"
#define AT_REST                                                                                    \
  "&simulation end_time = '5 h' threads = %d /\n&relaxation increments = 3 tolerance = 1e-3 /\n"
#define BLOCK(kind) "&lattice name = 'l' kind = " kind " spacing = '5 mm' thickness = '10 mm' /\n"
#define BODY        "&body lattice = 'l' shape = 'rectangle' corner = 2*0 size = 0.06, 0.04 /\n"

static const char *const same[] = {
    IN_TIME BLOCK("'hexagonal'") BODY DRIVEN
    "&material lattice = 'l' model = 'maxwell_bond' tau_1 = '30 us' tau_2 = '1 ms' /\n",
    AT_REST BLOCK("'hexagonal'") BODY MOVED
    "&material lattice = 'l' model = 'kelvin_voigt_bond' /\n"
    "&force region = 'top' component = 'x' total = '100 N' /\n",
    IN_TIME BLOCK("'square' horizon = 3") BODY DRIVEN
    "&material lattice = 'l' model = 'lps_viscoelastic' tau = '30 us' /\n",
    IN_TIME "&mesh name = 'l' size = '60 mm', '40 mm' nodes = 13, 9 thickness = '10 mm' method = "
            "'finite_elements' /\n" DRIVEN "&material mesh = 'l' model = '" SOURCE_DIR
            "/tests/generator/laws/relaxing_point.plm' tau = '30 us' /\n",
};
enum { SAME = sizeof same / sizeof *same };

static void open_same(deck_case *c, size_t k, int threads) {
  char text[4096];
  snprintf(text, sizeof text, same[k], threads); /* one %d in each */
  deck_case_open(c, text);
}

static void threads_and_a_resume_give_the_same_bits(void **state) {
  (void)state;
  for (size_t k = 0; k < SAME; k++)
    assert_same_bits_of(open_same, k);
}

/* And where a step has shrunk before. */
static void a_resume_knows_the_time(void **state) {
  (void)state;
  static const char shrinking[] = "step_safety = 0.6 shrink_every = 5";
  deck_case one, first, second;
  open_bar(&one, shrinking, 1);
  assert_int_equal(deck_case_go(&one), STEP_END);
  for (int part = 1; part < 4; part++) {
    open_bar(&first, shrinking, 1);
    open_bar(&second, shrinking, 2);
    hand_over(first.simulation, part * simulation_step_count(one.simulation) / 4,
              second.simulation);
    assert_int_equal(deck_case_go(&second), STEP_END);
    same_runs(one.simulation, second.simulation);
    deck_case_close(&first);
    deck_case_close(&second);
  }
  deck_case_close(&one);
}

/* --- a drive and a run ------------------------------------------------------------------------ */

/* One bond whose ends are moved as a path moves it, by steps of the path's own length. */
static void a_drive_and_a_run_agree(void **state) {
  workplace *w = *state;
  deck_case c;
  deck_case_open(
      &c, "&simulation end_time = '100 us' step = '0.5 us' /\n"
          "&lattice name = 'l' kind = 'chain' spacing = '10 mm' area = '100 mm^2' /\n"
          "&material lattice = 'l' model = '" SOURCE_DIR "/tests/generator/laws/ageing_bar.plm' /\n"
          "&body lattice = 'l' shape = 'segment' from = 0, 0 to = '10 mm', 0 /\n"
          "&region name = 'left' shape = 'point' at = 0, 0 /\n"
          "&region name = 'right' shape = 'point' at = '10 mm', 0 /\n"
          "&support region = 'left' fix = 'x' /\n"
          "&drive region = 'right' component = 'x' displacement = '2 um' rise = '40 us' /\n"
          "&output frames = 2 sample = '1 us' /\n");
  assert_int_equal(deck_case_go(&c), STEP_END);
  const sweep *s = c.simulation->laws[0].state;
  const double v = s->field[1][s->lattice->particle_site[0]], reached = s->body->reached;
  char text[2000];
  for (int steps = 5; steps <= 500; steps *= 10) {
    snprintf(text, sizeof text,
             "&simulation steps = %d /\n&bond spacing = '10 mm' area = '100 mm^2' /\n"
             "&material model = '" SOURCE_DIR "/tests/generator/laws/ageing_bar.plm' /\n"
             "&path quantity = 'stretch' times = 0, '40 us', %.17g values = 0, 2e-4, 2e-4 /\n"
             "&expect quantity = 'final v' value = %.17g tolerance = 1e-9 /\n"
             "&expect quantity = 'final age' value = %.17g tolerance = 1e-12 /\n",
             steps, reached, v, reached);
    write_text(w, "path.nml", text);
    expect(w, "drive path.nml", 0, "2 of 2");
    expect(w, "drive path.nml --compiled", 0, "2 of 2");
  }
  deck_case_close(&c);
}

/* The kernels of families and of points, too, are their interpreters' to the bit. */
static void kernels_are_as_their_interpreters(void **state) {
  workplace *w = *state;
  for (size_t k = 0; k < SAME; k++) {
    char text[4096];
    snprintf(text, sizeof text, same[k], 1);
    write_text(w, "same.nml", text);
    expect(w, "check same.nml", 0, "no errors");
    expect(w, "run same.nml --check-kernel --no-physics", 0, "");
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_plate_relaxes_as_its_bonds),
      cmocka_unit_test(a_plate_creeps_as_its_bonds),
      cmocka_unit_test(the_age_is_the_time),
      cmocka_unit_test(threads_and_a_resume_give_the_same_bits),
      cmocka_unit_test(a_resume_knows_the_time),
      cmocka_unit_test_setup_teardown(a_drive_and_a_run_agree, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(kernels_are_as_their_interpreters, set_up_workplace,
                                      tear_down_workplace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
