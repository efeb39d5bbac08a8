/* Whole runs of particles that stand on no lattice: energies, threads, resuming, a slit, a state
   gone bad, particles of a file in the file's order, and what does not run there. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "runtime/interaction/sweep.h"
#include "tests/runtime/family_law.h"
#include "tests/runtime/hand_over.h"
#include "tests/runtime/simulation/same_runs.h"
#include "tests/runtime/simulation/watch_all.h"

static const char broken[] = "S_t = 1e-4 tau = 1e-8";

/* Everything that moves and takes energy; the format takes threads, the law's values and more
   groups. */
static void open_busy(small_run *r, int threads, const char *values, const char *more) {
  static pl_law law;
  char text[4096];
  law = family_for_lists(&family_hexagon);
  snprintf(
      text, sizeof text,
      "&simulation end_time = 1e-4 step_safety = 0.5 threads = %d /\n"
      "&lattice name = 'c' kind = 'blue_noise' spacing = 0.005 thickness = 0.1 /\n"
      "&material lattice = 'c' model = 'm' %s /\n"
      "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.2, 0.15 /\n"
      "&notch lattice = 'c' shape = 'segment' from = 0.1, 0 to = 0.1, 0.05 cut_bonds = .true. /\n"
      "&region name = 'left' shape = 'rectangle' corner = 0, 0 size = 0.015, 0.15 /\n"
      "&region name = 'right' shape = 'rectangle' corner = 0.185, 0 size = 0.015, 0.15 /\n"
      "&region name = 'mid' shape = 'point' at = 0.05, 0.03 within = 0.006 /\n"
      "&support region = 'left' fix = 'xy' /\n"
      "&drive region = 'right' component = 'x' velocity = 0.5 rise = 1e-5 start = 3e-5 /\n"
      "&force region = 'mid' component = 'y' total = 500 history = 'ramp' rise = 1e-4 /\n"
      "&damping rate = 3000 from = 2e-6 until = 6e-5 /\n"
      "&gravity acceleration = 500, -2000 rise = 1.5e-4 /\n"
      "&initial_velocity region = 'mid' component = 'y' value = 0.02 /\n"
      "&protect region = 'left' radius = 2 /\n"
      "&monitor name = 'load' kind = 'reaction' region = 'left' component = 'x' average = 1e-5 /\n"
      "&monitor name = 'strain' kind = 'field' field = 'xx' region = 'mid' /\n"
      "&monitor name = 'cracks' kind = 'damaged' /\n" WATCH_ALL("0")
      "&output frames = 3 sample = 1e-6 /\n%s",
      threads, values, more);
  small_open(r, &law, text);
  if (!r->simulation) small_print(r);
  assert_non_null(r->simulation);
}

/* Masses differ, loads act, mass is damped: all that comes in goes somewhere. What an undamaged
   body takes is of the second order in time. */
static void energies_add_up(void **state) {
  (void)state;
  small_run r;
  open_busy(&r, 2, "", "");
  loses_nothing(&r);
  small_close(&r);
}

static void threads_and_stops_do_not_change_a_bit(void **state) {
  (void)state;
  small_run straight;
  open_busy(&straight, 1, broken, "");
  assert_int_equal(small_go(&straight), STEP_END);
  assert_true(small_last(&straight, "cracks") > 10);
  for (int threads = 2; threads <= 3; threads++) {
    small_run first, second;
    open_busy(&first, threads, broken, "");
    assert_int_equal(simulation_threads(first.simulation), threads);
    open_busy(&second, 1, broken, "");
    hand_over(first.simulation, simulation_step_count(first.simulation) / threads,
              second.simulation);
    small_close(&first);
    small_go(&second);
    same_runs(&straight, &second);
    small_close(&second);
  }
  small_close(&straight);
}

/* Other particles, and other bonds of the same ones, are other runs. */
static void fingerprints_differ(void **state) {
  (void)state;
  small_run r, cut, again;
  open_busy(&r, 1, "", "");
  open_busy(&cut, 1, "",
            "&notch lattice = 'c' shape = 'segment' from = 0.05, 0 to = 0.05, 0.02 "
            "cut_bonds = .true. /\n");
  open_busy(&again, 1, "", "");
  const uint64_t of = rows_fingerprint(simulation_rows(r.simulation, 0));
  assert_true(of != 0 && of == rows_fingerprint(simulation_rows(again.simulation, 0)));
  assert_true(of != rows_fingerprint(simulation_rows(cut.simulation, 0)));
  small_close(&r);
  small_close(&cut);
  small_close(&again);
}

static void no_bond_crosses_the_slit(void **state) {
  (void)state;
  small_run r;
  open_busy(&r, 1, "", "");
  const rows *g = simulation_rows(r.simulation, 0);
  rows_bond *bonds = rows_bonds(g);
  long above = 0;
  for (long m = 0; m < g->bond_count; m++) {
    const long i = g->particle_site[bonds[m].i], j = g->particle_site[bonds[m].j];
    const double left = fmin(g->x[i], g->x[j]), right = fmax(g->x[i], g->x[j]);
    if (left >= 0.1 || right <= 0.1) continue;
    const double part = (0.1 - g->x[i]) / (g->x[j] - g->x[i]);
    const double y = g->y[i] + part * (g->y[j] - g->y[i]);
    assert_true(y > 0.05);
    above++;
  }
  assert_true(above > 20);
  free(bonds);
  small_close(&r);
}

/* The notch that is not there is named; the one in the body is not. */
static void useless_notches_are_named(void **state) {
  (void)state;
  small_run r;
  open_busy(
      &r, 1, "",
      "&notch lattice = 'c' shape = 'segment' from = 0.5, 0 to = 0.5, 1 cut_bonds = .true. /\n");
  assert_int_equal(r.said.count, 1);
  assert_non_null(
      strstr(r.said.items[0].message, "the notch removes no particle and cuts no bond"));
  small_close(&r);
}

static void a_bad_state_names_its_family(void **state) {
  (void)state;
  small_run r;
  open_busy(&r, 2, broken, "");
  const rows *g = simulation_rows(r.simulation, 0);
  const long site = g->particle_site[g->particle_count / 2];
  simulation_state(r.simulation, 0)->field[0][site] = NAN;
  assert_int_equal(small_go(&r), STEP_BAD);
  const bad_state b = simulation_bad(r.simulation);
  assert_true(b.particle >= 0);
  const long bad = g->particle_site[b.particle];
  assert_int_equal(b.family_count, rows_degree(g, bad));
  for (int k = 0; k < b.family_count; k++) {
    const long there = g->particle_site[b.family[k].particle];
    assert_true(hypot(g->x[there] - g->x[bad], g->y[there] - g->y[bad]) < 6 * g->spacing);
    assert_true(fabs(b.family[k].stretch) < 1e-3);
  }
  small_close(&r);
}

/* --- what does not run ------------------------------------------------------------------------ */

static void assert_refused(const pl_law *law, const char *kind, const char *what) {
  small_run r;
  char text[512];
  snprintf(text, sizeof text,
           "&simulation end_time = 1e-4 /\n"
           "&lattice name = 'c' kind = '%s' spacing = 0.02 thickness = 0.1 /\n"
           "&material lattice = 'c' model = 'm' /\n"
           "&body lattice = 'c' shape = 'rectangle' corner = 0, 0 size = 0.2, 0.15 /\n",
           kind);
  small_open(&r, law, text);
  assert_null(r.simulation);
  assert_int_equal(r.said.errors, 1);
  if (!strstr(r.said.items[0].message, what)) small_print(&r);
  assert_non_null(strstr(r.said.items[0].message, what));
  small_close(&r);
}

static void laws_and_places_must_suit(void **state) {
  (void)state;
  const pl_law list = family_for_lists(&family_hexagon);
  assert_refused(&family_hexagon, "blue_noise", "built for particles that stand on a lattice");
  assert_refused(&list, "hexagonal", "built for particles that stand on no lattice");
  assert_refused(&elastic_beam, "blue_noise", "as a law of bonds");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(energies_add_up),
      cmocka_unit_test(threads_and_stops_do_not_change_a_bit),
      cmocka_unit_test(fingerprints_differ),
      cmocka_unit_test(no_bond_crosses_the_slit),
      cmocka_unit_test(useless_notches_are_named),
      cmocka_unit_test(a_bad_state_names_its_family),
      cmocka_unit_test(laws_and_places_must_suit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
