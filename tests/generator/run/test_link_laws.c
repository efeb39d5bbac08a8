/* Laws of links as they come along: `bar_bond` against the closed forms of a beam as stiff as a
   bond of the lattice; dampers and damage in the ledger; the same bits for any number of threads
   and after stops; laws that do not suit. */
#define _GNU_SOURCE /* nftw */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/parts/run_link.h"
#include "runtime/simulation/simulation_state.h"
#include "tests/generator/command_tools.h"
#include "tests/runtime/hand_over.h"
#include "tests/runtime/same_runs.h"
#include "tests/verification/case.h"

enum { CONCRETE, BAR, LINK };

/* --- the elastic link ------------------------------------------------------------------------- */

#define ONE_BOND                                                                                   \
  "&simulation end_time = '1 ms' /\n&output frames = 0 /\n"                                        \
  "&lattice name = 'c' kind = 'hexagonal' spacing = '20 mm' thickness = '120 mm' "                 \
  "stiffness_thickness = '127 mm' /\n"                                                             \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = '100 mm', '40 mm' /\n"             \
  "&material lattice = 'c' model = 'elastic_micropolar' /\n"                                       \
  "&bar name = 'b' points = '46 mm', 0, '86 mm', 0 spacing = '20 mm' diameter = '12 mm' /\n"       \
  "&material bar = 'b' model = 'beam' /\n"                                                         \
  "&link name = 'l' bar = 'b' lattice = 'c' every = 3 within = 0.35 /\n"                           \
  "&material link = 'l' model = 'bar_bond' zeta = 0 /\n"

/* Force (N, along x and y) and moment (N m) on the bar's particle, 6 mm to the right of that of the
   lattice, after a motion of its own. */
static void bond_after(double x, double y, double turn, double f[3]) {
  deck_case c;
  deck_case_open(&c, ONE_BOND);
  run_link *link = &c.simulation->links[0];
  const rows *g = link->own->lattice_rows;
  assert_int_equal(g->bond_count, 1);
  const int p = g->copies[0].lattice == BAR ? 0 : 1;
  body *b = simulation_state(c.simulation, BAR)->body;
  const double way[3] = {x, y, turn};
  for (int d = 0; d < 3; d++)
    b->displacement[d][link->copies[p].site[0]] = way[d];
  run_link_begin(link);
  for (int d = 0; d < 3; d++)
    f[d] = simulation_law_state(c.simulation, LINK)->force[d][g->particle_site[p]];
  deck_case_close(&c);
}

/* EA and EI of a bond of the lattice (Gerstle et al. 2013, eq 3), here of its length s = 20 mm and
   thickness 127 mm, over the link's own length d = 6 mm. */
static void an_elastic_link_is_as_stiff_as_a_bond_of_the_lattice(void **state) {
  (void)state;
  const double E = 24.86e9, nu = 0.2, s = 0.02, t = 0.127, d = 0.006, way = 1e-10, turn = 1e-8;
  const double EA = E * s * t / (sqrt(3) * (1 - nu)),
               EI = E * s * s * s * t * (1 - 3 * nu) / (12 * sqrt(3) * (1 - nu * nu));
  double f[3];
  print_message("EA %.5g N, EI %.5g N m^2\n", EA, EI);
  assert_true(fabs(EA / 4.5571e7 - 1) < 1e-4 && fabs(EI / 506.34 - 1) < 1e-4); /* its table 2 */
  bond_after(way, 0, 0, f);
  assert_true(fabs(f[0] / (-EA / d * way) - 1) < 1e-6 && fabs(f[1]) < 1e-6 * fabs(f[0]));
  bond_after(0, way, 0, f);
  assert_true(fabs(f[1] / (-12 * EI / (d * d * d) * way) - 1) < 1e-6);
  assert_true(fabs(f[2] / (6 * EI / (d * d) * way) - 1) < 1e-6);
  bond_after(0, 0, turn, f);
  assert_true(fabs(f[1] / (6 * EI / (d * d) * turn) - 1) < 1e-6);
  assert_true(fabs(f[2] / (-4 * EI / d * turn) - 1) < 1e-6);
}

/* --- what links lose -------------------------------------------------------------------------- */

#define BEAM                                                                                       \
  "&simulation end_time = '0.2 ms' step_safety = %g threads = %d /\n"                              \
  "&output frames = 0 sample = '2 us' losses = T energy = T /\n"                                   \
  "&lattice name = 'c' kind = 'hexagonal' spacing = '20 mm' thickness = '120 mm' /\n"              \
  "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = '300 mm', '80 mm' /\n"             \
  "&material lattice = 'c' model = 'elastic_micropolar' /\n"                                       \
  "&bar name = 'b' points = '11 mm', '23 mm', '291 mm', '29 mm' spacing = '20 mm' diameter = "     \
  "'12.7 mm' /\n"                                                                                  \
  "&material bar = 'b' model = 'beam' I = '1277 mm^4' /\n"                                         \
  "&link name = 'l' bar = 'b' lattice = 'c' every = 2 /\n"                                         \
  "&region name = 'left' lattice = 'c' shape = 'rectangle' corner = -1, -1 size = '1.015 m', 2 "   \
  "/\n"                                                                                            \
  "&region name = 'tip' lattice = 'b' shape = 'rectangle' corner = '280 mm', -1 size = 1, 2 /\n"   \
  "&support region = 'left' fix = 'xy' /\n"                                                        \
  "&drive region = 'tip' component = 'x' velocity = '%g m/s' rise = '50 us' /\n"
#define DAMPED "&material link = 'l' model = 'bar_bond' zeta = 0.2 /\n"
#define BREAKS "&material link = 'l' model = 'mplm_bilinear' S_t = 1e-4 zeta = 0.05 /\n"

static void open_beam(deck_case *c, const char *link, double safety, int threads, double speed) {
  char text[4096];
  snprintf(text + snprintf(text, sizeof text, BEAM, safety, threads, speed), 1000, "%s", link);
  deck_case_open(c, text);
}

typedef struct balance {
  double imbalance, own, external, lost, links;
} balance;

/* All over the work from outside. */
static balance balance_of(const char *link, const char *lost, double safety, double speed) {
  deck_case c;
  char own[64];
  open_beam(&c, link, safety, 0, speed);
  assert_int_equal(deck_case_go(&c), STEP_END);
  balance b = {.external = deck_case_last(&c, "energy/external")};
  const double *imbalance = deck_case_series(&c, "energy/imbalance"),
               *of_link = deck_case_series(&c, "l/imbalance");
  for (long k = 0; k < simulation_history(c.simulation, NULL); k++) {
    b.imbalance = fmax(b.imbalance, fabs(imbalance[k]) / b.external);
    b.own = fmax(b.own, fabs(of_link[k]) / b.external);
  }
  snprintf(own, sizeof own, "energy/%s", lost);
  b.lost = deck_case_last(&c, own) / b.external;
  snprintf(own, sizeof own, "l/%s", lost);
  b.links = deck_case_last(&c, own) / b.external;
  deck_case_close(&c);
  return b;
}

static void what_links_lose_is_booked(void **state) {
  (void)state;
  static const struct {
    const char *link, *lost;
    double speed, falls; /* by a quarter of the step */
  } cases[] = {{DAMPED, "dissipated_damping", 0.1, 0.4}, {BREAKS, "dissipated_damage", 1, 0.4}};
  for (int k = 0; k < 2; k++) {
    const balance coarse = balance_of(cases[k].link, cases[k].lost, 0.8, cases[k].speed),
                  fine = balance_of(cases[k].link, cases[k].lost, 0.2, cases[k].speed);
    print_message("%s: %.2g of the work, the links' %.2g; imbalance %.1e, of links %.1e, with a "
                  "quarter of the step %.1e, %.1e\n",
                  cases[k].lost, fine.lost, fine.links, coarse.imbalance, coarse.own,
                  fine.imbalance, fine.own);
    assert_true(fine.links > 1e-3 && fabs(fine.lost / fine.links - 1) < 1e-12);
    assert_true(coarse.imbalance < 1e-4 && coarse.own < 1e-4);
    assert_true(fine.imbalance < cases[k].falls * coarse.imbalance);
  }
}

/* --- the same bits ---------------------------------------------------------------------------- */

/* Links that break and damp, with what they lose; restored twice. */
static void threads_and_stops_do_not_change_a_bit(void **state) {
  (void)state;
  deck_case straight;
  open_beam(&straight, BREAKS, 0.8, 1, 1);
  assert_int_equal(deck_case_go(&straight), STEP_END);
  assert_true(deck_case_last(&straight, "l/dissipated_damage") > 0);
  assert_true(deck_case_last(&straight, "l/dissipated_damping") > 0);
  const long steps = simulation_step_count(straight.simulation);
  for (int threads = 2; threads <= 3; threads++) {
    deck_case whole, first, second, third;
    open_beam(&whole, BREAKS, 0.8, threads, 1);
    assert_int_equal(deck_case_go(&whole), STEP_END);
    same_runs(straight.simulation, whole.simulation);
    open_beam(&first, BREAKS, 0.8, threads, 1);
    open_beam(&second, BREAKS, 0.8, 1, 1);
    open_beam(&third, BREAKS, 0.8, threads, 1);
    hand_over(first.simulation, steps / 2, second.simulation);
    hand_over(second.simulation, 2 * steps / 3, third.simulation);
    assert_int_equal(deck_case_go(&third), STEP_END);
    same_runs(straight.simulation, third.simulation);
    deck_case_close(&whole);
    deck_case_close(&first);
    deck_case_close(&second);
    deck_case_close(&third);
  }
  deck_case_close(&straight);
}

/* --- as a person sees them -------------------------------------------------------------------- */

static const char linked_deck[] =
    "&simulation  end_time = '0.05 ms' /\n"
    "&lattice     name = 'c'  kind = 'hexagonal'  spacing = '20 mm'  thickness = '120 mm' /\n"
    "&body        lattice = 'c'  shape = 'rectangle'  corner = 0, 0  size = '200 mm', '80 mm' /\n"
    "&material    lattice = 'c'  model = 'mplm_bilinear' /\n"
    "&bar         name = 'b'  points = '11 mm', '23 mm', '191 mm', '23 mm'  spacing = '20 mm'\n"
    "             diameter = '12 mm' /\n"
    "&material    bar = 'b'  model = 'steel_bar' /\n"
    "&link        name = 'l'  bar = 'b'  lattice = 'c'  every = 3 /\n"
    "&material    link = 'l'  model = 'bar_bond' /\n"
    "&region      name = 'tip'  lattice = 'b'  shape = 'point'  at = '191 mm', '23 mm' /\n"
    "&force       region = 'tip'  component = 'x'  total = '10 kN' /\n"
    "&output      result = 'linked.h5'  frames = 1 /\n";

static void laws_that_do_not_suit_are_named(void **state) {
  workplace *w = *state;
  write_text(w, "linked.nml", linked_deck);
  expect(w, "check linked.nml", 0,
         "link       l: 15 bonds of 5.767 to 19.83 mm join 4 particles of b to 15 of c");
  expect(w, "check linked.nml --set material[l].model=lps", 1,
         "the law `lps` reads whole families, but a link has bonds between two bodies alone");
  expect(w, "check linked.nml --set material[l].model=beam", 1,
         "take another law, such as `bar_bond`");
  expect(w, "check linked.nml --set material[l].model=bond_slip", 1,
         "the law `bond_slip` is one of slip and gap, which links to places alone have");
  expect(w, "check linked.nml --set material[l].model=bond_slip", 1,
         "give the link `to = 'place'`");
  expect(w, "check linked.nml --set material[b].model=bond_slip", 1,
         "take a law that begins with `law central bond`");
  expect(w, "check linked.nml --set material[b].model=bar", 1,
         "the law `bar_bond` of the link `l` bends bonds, but the particles of `b` do not rotate");
  expect(w, "check linked.nml --set material[c].model=elastic_central", 1,
         "the law `bar_bond` of the link `l` bends bonds, but the particles of `c` do not rotate");
  expect(w, "check linked.nml --set material[l].model=elastic_central", 0, "");
}

/* What is wrong with a lattice is not said of its links, too. */
static void a_link_waits_for_what_it_joins(void **state) {
  workplace *w = *state;
  write_text(w, "linked.nml", linked_deck);
  expect(w, "check linked.nml --set lattice.kind=blue_noise", 1, "is meant for lattices");
  assert_null(strstr(w->said, "unstable-step"));
}

/* What is wrong with one of two bars, or the lattice, takes its link with it, and nothing else. */
static void links_go_with_what_they_join(void **state) {
  workplace *w = *state;
  write_text(w, "two.nml",
             "&simulation end_time = '1 us' /\n"
             "&lattice name = 'c' kind = 'hexagonal' spacing = '20 mm' thickness = '100 mm' /\n"
             "&material lattice = 'c' model = 'elastic_micropolar' /\n"
             "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = '0.4 m', '0.2 m' /\n"
             "&bar name = 'a' points = '0.1 m', '30 mm', '0.3 m', '30 mm' diameter = '12 mm' "
             "spacing = '20 mm' /\n"
             "&material bar = 'a' model = 'steel_bar' /\n"
             "&link name = 'la' bar = 'a' lattice = 'c' to = 'place' /\n"
             "&material link = 'la' model = 'bond_slip' /\n"
             "&bar name = 'b' points = '0.1 m', '0.15 m', '0.3 m', '0.15 m' diameter = '12 mm' "
             "spacing = '20 mm' /\n"
             "&material bar = 'b' model = 'steel_bar' /\n"
             "&link name = 'lb' bar = 'b' lattice = 'c' to = 'place' /\n"
             "&material link = 'lb' model = 'bond_slip' /\n");
  expect(w, "check two.nml", 0, "11 particles of b tied to places in c");
  static const char *const slips[] = {"bar[a].diameter='12 MPa'", "bar[b].diameter='12 MPa'",
                                      "lattice.spacing='20 MPa'", "bar[a].copies=0"};
  for (size_t k = 0; k < sizeof slips / sizeof *slips; k++) {
    char command[128];
    snprintf(command, sizeof command, "check two.nml --set %s", slips[k]);
    expect(w, command, 1, "error: ");
    if (strstr(strstr(w->said, "error: ") + 1, "error: ")) fail_msg("%s", w->said);
  }
}

/* In a result each particle stands once: 53 and 10, and bonds of the link join them. */
static void a_particle_stands_once_in_results(void **state) {
  workplace *w = *state;
  char *rest;
  double ends[2];
  long links = 0;
  write_text(w, "linked.nml", linked_deck);
  expect(w, "run linked.nml", 0, "written");
  assert_null(strstr(w->said, "lie in l"));
  expect(w, "info linked.h5", 0, "63 particles");
  expect(w, "export linked.h5 --frame 1 --bonds -o bonds.csv", 0, "written bonds.csv");
  size_t size;
  char *text = read_bytes(w, "bonds.csv", &size);
  for (char *line = strchr(text, '\n'); line && line[1]; line = strchr(line + 1, '\n')) {
    strtol(line + 1, &rest, 10);
    for (int end = 0; end < 2; end++)
      ends[end] = strtod(rest + 1, &rest);
    assert_true(fmax(ends[0], ends[1]) < 63);
    links += (ends[0] < 53) != (ends[1] < 53);
  }
  free(text);
  assert_int_equal(links, 15);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_elastic_link_is_as_stiff_as_a_bond_of_the_lattice),
      cmocka_unit_test(what_links_lose_is_booked),
      cmocka_unit_test(threads_and_stops_do_not_change_a_bit),
      cmocka_unit_test_setup_teardown(laws_that_do_not_suit_are_named, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_link_waits_for_what_it_joins, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(links_go_with_what_they_join, set_up_workplace,
                                      tear_down_workplace),
      cmocka_unit_test_setup_teardown(a_particle_stands_once_in_results, set_up_workplace,
                                      tear_down_workplace),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
