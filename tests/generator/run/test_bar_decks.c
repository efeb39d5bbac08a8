/* Decks with bars as a person runs them: what the report says, what results and pictures hold, bars
   that know nothing of each other, the same bits whatever the threads and after a resume. */
#define _GNU_SOURCE /* nftw */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/plot/plot_frame.h"
#include "tests/generator/command_tools.h"
#include "tests/runtime/hand_over.h"
#include "tests/runtime/same_runs.h"
#include "tests/verification/case.h"

/* A plate that tears; a straight bar that yields, and a stirrup that is struck. */
#define START "&simulation end_time = '0.2 ms' step = '0.3 us' threads = %d /\n"
#define PLATE                                                                                      \
  "&lattice name = 'plate' kind = 'hexagonal' spacing = '10 mm' thickness = '10 mm' /\n"           \
  "&material lattice = 'plate' model = 'mplm_bilinear' /\n"                                        \
  "&body lattice = 'plate' shape = 'rectangle' corner = 0, 0 size = '0.2 m', '0.1 m' /\n"          \
  "&region name = 'left' lattice = 'plate' shape = 'rectangle' corner = -1, -1 size = '1.011 m', " \
  "2 /\n"                                                                                          \
  "&region name = 'right' lattice = 'plate' shape = 'rectangle' corner = '0.189 m', -1 size = 1, " \
  "2 /\n"                                                                                          \
  "&support region = 'left' fix = 'xy' /\n"                                                        \
  "&drive region = 'right' component = 'x' velocity = '1 m/s' rise = '0.1 ms' /\n"
#define BARS                                                                                       \
  "&bar name = 'tie' points = '-10 mm', '20 mm', '210 mm', '20 mm' diameter = '8 mm' spacing = "   \
  "'10 mm' /\n"                                                                                    \
  "&material bar = 'tie' model = 'steel_bar' H = '2 GPa' /\n"                                      \
  "&region name = 'start' lattice = 'tie' shape = 'point' at = '-10 mm', '20 mm' /\n"              \
  "&region name = 'end' lattice = 'tie' shape = 'point' at = '210 mm', '20 mm' /\n"                \
  "&support region = 'start' fix = 'xy' /\n"                                                       \
  "&drive region = 'end' component = 'x' velocity = '10 m/s' rise = '0.02 ms' /\n"                 \
  "&bar name = 'stirrup' closed = T points = '50 mm', '10 mm', '153 mm', '10 mm', '153 mm', "      \
  "'90 mm', '50 mm', '90 mm' area = '30 mm^2' spacing = '10 mm' /\n"                               \
  "&material bar = 'stirrup' model = 'steel_bar' /\n"                                              \
  "&region name = 'corner' lattice = 'stirrup' shape = 'point' at = '50 mm', '90 mm' /\n"          \
  "&initial_velocity region = 'corner' component = 'y' value = '40 m/s' /\n"                       \
  "&monitor name = 'load' kind = 'reaction' region = 'end' component = 'x' /\n"

static void open_deck(deck_case *c, const char *text, int threads) {
  char whole[8000];
  snprintf(whole, sizeof whole, text, threads);
  deck_case_open(c, whole);
}

/* The largest value of the law's first field. */
static double most_of_field(const deck_case *c, int number) {
  const sweep *w = simulation_state(c->simulation, number);
  const rows *g = w->body->lattice;
  double most = 0;
  for (long p = 0; p < g->particle_count; p++)
    for (int k = 0; k < g->directions; k++)
      if (rows_has_bond(g, g->particle_site[p], k))
        most = fmax(most, fabs(w->field[0][k * g->size + g->particle_site[p]]));
  return most;
}

static void threads_and_a_resume_give_the_same_bits(void **state) {
  (void)state;
  deck_case one, more, first, second;
  open_deck(&one, START PLATE BARS, 1);
  assert_int_equal(simulation_bodies(one.simulation), 3);
  assert_int_equal(deck_case_go(&one), STEP_END);
  for (int b = 1; b < 3; b++) /* both bars have yielded */
    assert_true(most_of_field(&one, b) > 1e-3);
  open_deck(&more, START PLATE BARS, 3);
  assert_int_equal(deck_case_go(&more), STEP_END);
  open_deck(&first, START PLATE BARS, 1);
  open_deck(&second, START PLATE BARS, 2);
  hand_over(first.simulation, simulation_step_count(one.simulation) / 3, second.simulation);
  assert_int_equal(deck_case_go(&second), STEP_END);
  same_runs(one.simulation, more.simulation);
  same_runs(one.simulation, second.simulation);
  deck_case_close(&one);
  deck_case_close(&more);
  deck_case_close(&first);
  deck_case_close(&second);
}

/* They lie over the plate and over each other. */
static void bars_do_not_act_on_what_they_touch(void **state) {
  (void)state;
  deck_case all, plate, bars;
  open_deck(&all, START PLATE BARS, 1);
  open_deck(&plate, START PLATE, 1);
  open_deck(&bars, START BARS, 1);
  assert_int_equal(deck_case_go(&all), STEP_END);
  assert_int_equal(deck_case_go(&plate), STEP_END);
  assert_int_equal(deck_case_go(&bars), STEP_END);
  same_states(simulation_state(all.simulation, 0), simulation_state(plate.simulation, 0));
  same_states(simulation_state(all.simulation, 1), simulation_state(bars.simulation, 0));
  same_states(simulation_state(all.simulation, 2), simulation_state(bars.simulation, 1));
  deck_case_close(&all);
  deck_case_close(&plate);
  deck_case_close(&bars);
}

static double last_of(const workplace *w, const char *name) {
  result_file *f = open_result_of(w, "bars.h5");
  char unit_text[64], error[1000];
  long count;
  double *values =
      result_read_series(f, name, &count, unit_text, sizeof unit_text, error, sizeof error);
  assert_non_null(values);
  const double last = values[count - 1];
  free(values);
  result_read_close(f);
  return last;
}

/* Stirrups that are struck and yield, joined to a plate that tears. */
#define LEG(name, x, copies)                                                                       \
  "&bar name = '" name "' points = '" x "', '13 mm', '" x                                          \
  "', '85 mm' diameter = '8 mm' spacing = "                                                        \
  "'10 mm' " copies " /\n&material bar = '" name "' model = 'steel_bar' H = '2 GPa' /\n"           \
  "&link name = 'k" name "' bar = '" name "' lattice = 'plate' every = 2 first = 1 /\n"            \
  "&material link = 'k" name "' model = 'bar_bond' /\n"                                            \
  "&region name = 't" name "' lattice = '" name                                                    \
  "' shape = 'rectangle' corner = 0, '80 mm' size = "                                              \
  "1, 1 /\n&initial_velocity region = 't" name "' component = 'y' value = '40 m/s' /\n"
#define COPIES LEG("s", "23 mm", "copies = 3 shift = '80 mm', 0")
#define SINGLE LEG("a", "23 mm", "") LEG("b", "103 mm", "") LEG("c", "183 mm", "")
enum { ALL = 1, LEGS = 3, EACH = 8 };

static double far_apart(const body *a, long p, const body *b, long q) {
  double most = 0;
  for (int d = 0; d < a->dof; d++)
    most = fmax(most, fabs(a->displacement[d][a->lattice->particle_site[p]] -
                           b->displacement[d][b->lattice->particle_site[q]]));
  return most;
}

/* A bar of copies moves as bars do that stand each by itself, and so does the plate. */
static void copies_move_as_single_bars(void **state) {
  (void)state;
  deck_case copies, single;
  double apart = 0;
  open_deck(&copies, START PLATE COPIES, 1);
  open_deck(&single, START PLATE SINGLE, 1);
  assert_int_equal(deck_case_go(&copies), STEP_END);
  assert_int_equal(deck_case_go(&single), STEP_END);
  assert_true(most_of_field(&copies, 0) > 0.1 && most_of_field(&copies, ALL) > 1e-3);
  const body *plate = simulation_state(copies.simulation, 0)->body,
             *all = simulation_state(copies.simulation, ALL)->body;
  assert_int_equal(all->lattice->particle_count, LEGS * EACH);
  for (long p = 0; p < plate->lattice->particle_count; p++)
    apart = fmax(apart, far_apart(plate, p, simulation_state(single.simulation, 0)->body, p));
  for (int leg = 0; leg < LEGS; leg++)
    for (long p = 0; p < EACH; p++)
      apart = fmax(apart, far_apart(all, leg * EACH + p,
                                    simulation_state(single.simulation, 1 + leg)->body, p));
  print_message("%.1e m apart\n", apart);
  assert_true(apart < 1e-12);
  deck_case_close(&copies);
  deck_case_close(&single);
}

static void copies_have_the_same_bits_whatever_the_threads(void **state) {
  (void)state;
  deck_case one, more, rest;
  open_deck(&one, START PLATE COPIES, 1);
  open_deck(&more, START PLATE COPIES, 3);
  open_deck(&rest, START PLATE COPIES, 2);
  assert_int_equal(deck_case_go(&one), STEP_END);
  hand_over(more.simulation, simulation_step_count(one.simulation) / 3, rest.simulation);
  assert_int_equal(deck_case_go(&rest), STEP_END);
  same_runs(one.simulation, rest.simulation);
  deck_case_close(&one);
  deck_case_close(&more);
  deck_case_close(&rest);
}

static void copies_stand_in_report_and_results(void **state) {
  workplace *w = *state;
  char text[4000];
  snprintf(text, sizeof text,
           START PLATE COPIES
           "&monitor name = 'cut' kind = 'force' lattice = 's' at = 0, '51 mm' normal = 0, 1 "
           "component = 'y' /\n&output result = 'bars.h5' frames = 2 fields = 'displacement', "
           "'sigma' /\n",
           1);
  write_text(w, "copies.nml", text);
  expect(w, "run copies.nml", 0,
         "  bar        s: 3 copies, each (80, 0) mm from the one before, 24 particles, 21 bonds, "
         "each 72 mm long, area 50.2655 mm^2, spacing 10.2857 mm");
  assert_non_null(strstr(w->said, "  placing    of 24 particles of s 24 lie in plate"));
  assert_non_null(strstr(w->said, " join 12 particles of s to "));
  assert_true(last_of(w, "cut") != 0);
  expect(w, "export bars.h5 --frame 2 --bonds --field s/sigma", 0, "");
  expect(
      w, "check copies.nml --set bar[s].copies=4", 0,
      "4 of the 16 particles of the bar `s` that the link `ks` chooses are not joined to `plate`");
  assert_non_null(strstr(w->said, "the first is at (263, 23.2857) mm, in copy 4 of 4"));
  expect(w,
         "check copies.nml --set link[ks].to=place --set material[ks].model=bond_slip --set "
         "material[ks].f_cm=30",
         1, "`f_cm` = 30 Pa is not in [1000000, inf), the range of the law `bond_slip`");
  expect(w, "check copies.nml --set link[ks].first=8", 1,
         "each copy of the bar `s` has 8 particles");
}

static void write_deck(workplace *w) {
  char text[4000];
  snprintf(text, sizeof text,
           START PLATE BARS
           "&output result = 'bars.h5' frames = 2 losses = .true. fields = 'displacement', "
           "'damage', 'stress', 'sigma', 'yielded' /\n",
           1);
  write_text(w, "bars.nml", text);
}

static void the_report_says_what_bars_are(void **state) {
  workplace *w = *state;
  write_deck(w);
  expect(w, "check bars.nml", 0,
         "  bar        tie: 23 particles, 22 bonds, 220 mm long, area 50.2655 mm^2, spacing 10 mm\n"
         "  placing    of 23 particles of tie 21 lie in plate, 2.68 to 2.68 mm from the nearest "
         "site, in the mean 2.68 mm; no link joins them\n"
         "  law        steel_bar (");
  assert_non_null(strstr(w->said, "): along this bar E = 200 GPa, E A = 10.05 MN\n"));
  assert_non_null(strstr(w->said,
                         "  bar        stirrup: closed, 36 particles, 36 bonds, 366 mm long, area "
                         "30 mm^2, spacing 10 to 10.3 mm: legs are no multiples of 10 mm\n"));
  assert_non_null(strstr(w->said, "): along this bar E = 200 GPa, E A = 6 MN\n"));
  expect(w, "check bars.nml --set bar[tie].diameter='10 mm' --set material[tie].E='100 GPa'", 0,
         "along this bar E = 100 GPa, E A = 7.854 MN\n");
  expect(w, "check bars.nml --set material[tie].model=mplm_concrete", 1,
         "the law `mplm_concrete` reads the thickness `t`, which a bar does not have");
  expect(w, "check bars.nml --set material[tie].model=lps", 1,
         "the law `lps` reads whole families, but a bar has bonds along one line alone");
  expect(w, "check bars.nml --set bar[tie].spacing='1 nm'", 1,
         "the bar 'tie' has 2.2e+08 particles");
}

/* Bonds with a number in a map, of those that are drawn. */
static long numbers_in(const workplace *w, const char *field, long *bonds) {
  const plot_map_options o = {.field = field, .frame = -1, .component = -1, .slice_axis = -1};
  plot_frame m;
  char error[1000];
  long count = 0;
  if (!plot_frame_read(&m, in_workplace(w, "bars.h5"), &o, error, sizeof error))
    fail_msg("%s", error);
  for (long b = 0; b < m.bonds; b++)
    count += !isnan(m.values ? m.values[b] : m.damage[b]);
  *bonds = m.bonds;
  plot_frame_free(&m);
  return count;
}

/* All bonds are drawn, those of bars in colours where these have the field; where the plate has it
   in a colour of their own. */
static void results_and_pictures_hold_bars(void **state) {
  workplace *w = *state;
  write_deck(w);
  expect(w, "run bars.nml", 0, "written");
  const double external = last_of(w, "energy/external");
  print_message("imbalance %.1e of the work, yield took %.2f of it\n",
                last_of(w, "energy/imbalance") / external,
                last_of(w, "energy/dissipated_damage") / external);
  assert_true(fabs(last_of(w, "energy/imbalance")) < 1e-2 * external);
  assert_true(last_of(w, "tie/dissipated_damage") > 0.1 * external);
  expect(w, "info bars.h5", 0, "305 particles, 732 bonds, 3 frames");
  assert_non_null(strstr(w->said, "stirrup/sigma"));
  expect(w, "export bars.h5 --frame 2 --bonds --field tie/yielded", 0, "tie/yielded");
  expect(w, "compare bars.h5 bars.h5", 0, "");
  expect(w, "plot bars.h5 --map sigma -o sigma.svg", 0, "written sigma.svg");
  expect(w, "plot bars.h5 --map damage -o damage.png", 0, "written damage.png");
  expect(w, "plot bars.h5 --map displacement --mark yielded -o displacement.pdf", 0, "written");
  long bonds;
  assert_int_equal(numbers_in(w, "sigma", &bonds), 22 + 36);
  assert_int_equal(bonds, 674 + 22 + 36);
  assert_int_equal(numbers_in(w, "tie/yielded", &bonds), 22);
  assert_int_equal(numbers_in(w, "damage", &bonds), 674);
  assert_int_equal(bonds, 674 + 22 + 36);
  expect(w, "run bars.nml --set bar[tie].spacing='20 mm' --set bar[stirrup].spacing='5 mm'", 0, "");
  assert_int_equal(numbers_in(w, "damage", &bonds), 674); /* and not hidden by longer ones */
  assert_int_equal(bonds, 674 + 11 + 74);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(threads_and_a_resume_give_the_same_bits),
      cmocka_unit_test(bars_do_not_act_on_what_they_touch),
      cmocka_unit_test(copies_move_as_single_bars),
      cmocka_unit_test(copies_have_the_same_bits_whatever_the_threads),
      cmocka_unit_test_setup_teardown(the_report_says_what_bars_are, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(results_and_pictures_hold_bars, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(copies_stand_in_report_and_results, set_up_workplace,
                                      tear_down_workplace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
