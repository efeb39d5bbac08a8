/* Cells that die as all of their points fail: what they stored is booked, their nodes go on,
   results tell; threads, resuming, and a law beside that does not fail. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "brittle_law.h"
#include "laws_run.h"
#include "runtime/continuum/cells.h"

/* A bar with a weak place in the middle, pulled at both ends. */
#define BAR                                                                                        \
  "&mesh name = 'bar' size = 0.2, 0.05 nodes = 41, 11 thickness = '20 mm' method = "               \
  "'finite_elements' /\n"                                                                          \
  "&region name = 'left' shape = 'segment' from = 0, 0 to = 0, 0.05 /\n"                           \
  "&region name = 'right' shape = 'segment' from = 0.2, 0 to = 0.2, 0.05 /\n"                      \
  "&region name = 'weak' lattice = 'bar' shape = 'rectangle' corner = 0.095, 0 size = 0.01, 0.05 " \
  "/\n"                                                                                            \
  "&drive region = 'right' component = 'x' velocity = 0.2 /\n"                                     \
  "&drive region = 'left' component = 'x' velocity = -0.2 /\n"                                     \
  "&monitor name = 'load' kind = 'reaction' region = 'right' component = 'x' /\n"                  \
  "&material mesh = 'bar' model = 'hooke' /\n"                                                     \
  "&material mesh = 'bar' region = 'weak' model = 'brittle' eps_u = 1e-5 /\n"
#define RUN "&simulation end_time = '0.2 ms' step_safety = 0.7 /\n"

static pl_law bent;
static const pl_law *laws[2] = {&bent, &brittle_law};

static int set_up(void **state) {
  (void)state;
  bent = hooke_law;
  bent.linear = 0;
  return 0;
}

/* All of the weak cells die; of a quadratic energy the books are exact. */
static void a_bar_breaks_in_two(void **state) {
  (void)state;
  enum { NODES = 41 * 11 };
  laws_run c;
  double dead[NODES], first;
  laws_go(&c, laws, RUN BAR);
  const cells *of = simulation_cells(c.r.simulation, 0);
  assert_true(cells_can_die(of));
  const long died = cells_deaths(of, &first);
  print_message("%ld died, the first at %.4g ms\n", died, 1e3 * first);
  assert_int_equal(died, 2 * 10);
  assert_true(first > 0 && first < 0.2e-3);
  laws_field(&c, "dead_cells", dead);
  for (int n = 0; n < NODES; n++)
    assert_true(dead[n] == ((n % 41 == 19 || n % 41 == 20) && n / 41 < 10));
  const double external = small_largest(&c.r, "energy/external");
  assert_true(small_last(&c.r, "energy/dissipated_damage") > 1e-3 * external);
  assert_true(small_largest(&c.r, "energy/imbalance") < 1e-11 * external);
  small_close(&c.r);
}

/* One value a cell: 1 in the weak cells, which all failed, 0 where the law knows no damage. */
static void cells_show_their_own_state(void **state) {
  (void)state;
  enum { CELLS = 40 * 10 };
  const frame_field *fields;
  laws_run c;
  double values[CELLS];
  int seen = 0;
  laws_go(&c, laws, RUN BAR "&output fields = 'failed' /\n");
  const int count = simulation_frame_fields(c.r.simulation, &fields);
  for (int k = 0; k < count; k++) {
    if (!fields[k].on_cells) continue;
    seen++;
    assert_string_equal(fields[k].name, "failed");
    assert_int_equal(fields[k].count, CELLS);
    simulation_frame_values(c.r.simulation, k, values);
    for (int n = 0; n < CELLS; n++)
      assert_true(n % 40 == 19 || n % 40 == 20 ? values[n] == 1 : values[n] == 0);
  }
  assert_int_equal(seen, 1);
  small_close(&c.r);
}

/* A strip of nodes between dead cells keeps its momentum, however far it goes. */
static void nodes_of_dead_cells_fly_on(void **state) {
  (void)state;
  laws_run c;
  double v[2];
  laws_open(&c, laws, "&simulation end_time = '4 ms' step_safety = 0.7 /\n" BAR);
  const body *b = simulation_state(c.r.simulation, 0)->body;
  const long site = cells_site(simulation_cells(c.r.simulation, 0), 2 * 41 + 20);
  while (simulation_step_done(c.r.simulation) < 200)
    simulation_advance(c.r.simulation, 1, NULL);
  for (int d = 0; d < 2; d++)
    v[d] = b->velocity[d][site];
  assert_int_equal(small_go(&c.r), STEP_END);
  assert_true(simulation_step_done(c.r.simulation) > 2000);
  for (int d = 0; d < 2; d++)
    assert_true(b->velocity[d][site] == v[d]);
  assert_true(v[1] != 0);
  const double external = small_largest(&c.r, "energy/external");
  assert_true(small_largest(&c.r, "energy/imbalance") < 1e-10 * external);
  small_close(&c.r);
}

static void threads_change_no_bit(void **state) {
  (void)state;
  laws_run c[LAWS_RUN_THREADS];
  double first[LAWS_RUN_THREADS];
  laws_go_with_threads(c, laws, "end_time = '0.2 ms' step_safety = 0.7", BAR);
  for (int k = 0; k < LAWS_RUN_THREADS; k++) {
    cells_deaths(simulation_cells(c[k].r.simulation, 0), &first[k]);
    assert_true(first[k] == first[0]);
    small_close(&c[k].r);
  }
}

/* Stopped before the first cell dies, and after some have. */
static void a_resumed_run_is_the_same(void **state) {
  (void)state;
  static const int stops[] = {20, 130};
  for (int k = 0; k < 2; k++) {
    laws_run r, s;
    double first[2];
    laws_open(&r, laws, RUN BAR);
    laws_open(&s, laws, RUN BAR);
    hand_over(r.r.simulation, stops[k], s.r.simulation);
    const long died = cells_deaths(simulation_cells(r.r.simulation, 0), &first[0]);
    print_message("%ld cells are dead\n", died);
    assert_true(k ? died > 0 : died == 0);
    assert_int_equal(cells_deaths(simulation_cells(s.r.simulation, 0), &first[1]), died);
    small_go(&r.r);
    small_go(&s.r);
    same_runs(r.r.simulation, s.r.simulation);
    cells_deaths(simulation_cells(r.r.simulation, 0), &first[0]);
    cells_deaths(simulation_cells(s.r.simulation, 0), &first[1]);
    assert_true(first[0] == first[1]);
    small_close(&r.r);
    small_close(&s.r);
  }
}

/* A law without the statement has no such field. */
static void others_do_not_die(void **state) {
  (void)state;
  static const pl_law *const elastic[] = {&hooke_law, &bent};
  const frame_field *fields;
  laws_run c;
  laws_open(&c, elastic, RUN BAR);
  assert_null(c.r.simulation); /* it has no eps_u */
  small_close(&c.r);
  char text[4096] = RUN BAR;
  memset(strstr(text, "eps_u = 1e-5"), ' ', strlen("eps_u = 1e-5"));
  laws_open(&c, elastic, text);
  assert_non_null(c.r.simulation);
  assert_false(cells_can_die(simulation_cells(c.r.simulation, 0)));
  const int count = simulation_frame_fields(c.r.simulation, &fields);
  for (int k = 0; k < count; k++)
    assert_string_not_equal(fields[k].name, "dead_cells");
  small_close(&c.r);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_bar_breaks_in_two),   cmocka_unit_test(nodes_of_dead_cells_fly_on),
      cmocka_unit_test(threads_change_no_bit), cmocka_unit_test(a_resumed_run_is_the_same),
      cmocka_unit_test(others_do_not_die),     cmocka_unit_test(cells_show_their_own_state)};
  return cmocka_run_group_tests(tests, set_up, NULL);
}
