/* Bonds that are evaluated once and add to both ends: the same bits for any number of threads,
   after a checkpoint and from the interpreter, while bonds break everywhere but where they are
   protected; in families of 122, 18 and 6 neighbours. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "generator/interpreter/interpreted.h"
#include "generator/ir/interpret.h"
#include "tests/runtime/hand_over.h"
#include "tests/verification/case.h"

#define REGION(name, shape) "&region name = '" name "' shape = " shape " /\n"
#define PULLED(across)                                                                             \
  "&drive region = 'top' component = '" across "' velocity = '40 m/s' /\n"                         \
  "&support region = 'foot' fix = 'xy' /\n&protect region = 'foot' /\n"                            \
  "&monitor name = 'cracks' kind = 'damaged' /\n&output frames = 0 /\n"

/* Some rows are longer than a chunk. */
static const char *const bodies[] = {
    "&simulation end_time = '6e-5 s' /\n"
    "&lattice name = 'l' spacing = '10 mm' kind = 'cubic' horizon = 3.015 /\n"
    "&body lattice = 'l' shape = 'box' corner = 0, 0, 0 size = '750 mm', '80 mm', '130 mm' /\n"
    "&material lattice = 'l' model = 'lps' s_0 = 1e-3 /\n" REGION(
        "top", "'box' corner = 0, 0, '105 mm' size = '750 mm', '80 mm', '30 mm'")
        REGION("foot", "'box' corner = 0, 0, '-5 mm' size = '750 mm', '80 mm', '30 mm'")
            PULLED("z"),
    "&simulation end_time = '6e-5 s' /\n"
    "&lattice name = 'l' spacing = '10 mm' kind = 'fcc' shells = 2 /\n"
    "&body lattice = 'l' shape = 'box' corner = 0, 0, 0 size = '750 mm', '80 mm', '130 mm' /\n"
    "&material lattice = 'l' model = 'cohesive' f_t = '10 MPa' /\n" REGION(
        "top", "'box' corner = 0, 0, '115 mm' size = '750 mm', '80 mm', '30 mm'")
        REGION("foot", "'box' corner = 0, 0, '-5 mm' size = '750 mm', '80 mm', '20 mm'")
            PULLED("z"),
    "&simulation end_time = '6e-5 s' /\n"
    "&lattice name = 'l' spacing = '10 mm' thickness = '10 mm' kind = 'hexagonal' /\n"
    "&body lattice = 'l' shape = 'rectangle' corner = 0, 0 size = '1.5 m', '250 mm' /\n"
    "&material lattice = 'l' model = 'pmb' /\n" REGION(
        "top", "'rectangle' corner = 0, '230 mm' size = '1.5 m', '30 mm'")
        REGION("foot", "'rectangle' corner = 0, '-5 mm' size = '1.5 m', '30 mm'") PULLED("y"),
};
enum { BODIES = sizeof bodies / sizeof *bodies };

static void open_threads(deck_case *c, int which, const char *threads, bool interpreted) {
  assert_true(deck_case_read(c, "case.nml", bodies[which], &threads, 1));
  assert_true(deck_case_start(c, SOURCE_DIR "/models/case.nml"));
  assert_true(c->law.law->sum_count > 0);
  if (!interpreted) return;
  simulation_free(c->simulation);
  c->law.law = plan_interpreted(c->model.plan);
  c->simulation = simulation_new(c->deck, &c->law, &c->said);
  assert_non_null(c->simulation);
}

static void assert_same(const deck_case *a, const deck_case *b) {
  const sweep *x = simulation_state(a->simulation, 0), *y = simulation_state(b->simulation, 0);
  const rows *g = x->body->lattice;
  const size_t site = (size_t)g->size * sizeof(double);
  for (long p = 0; p < g->particle_count; p++)
    for (int d = 0; d < g->dimensions; d++) {
      const long q = g->particle_site[p];
      assert_memory_equal(&x->body->displacement[d][q], &y->body->displacement[d][q],
                          sizeof(double));
      assert_memory_equal(&x->body->velocity[d][q], &y->body->velocity[d][q], sizeof(double));
    }
  assert_memory_equal(x->field[0], y->field[0], 2 * (size_t)g->directions * site);
}

/* Share of the bonds' values that are not 0; both ends have the same. */
static double broken_share(const deck_case *c) {
  const sweep *w = simulation_state(c->simulation, 0);
  const rows *g = w->body->lattice;
  long broken = 0, values = 0;
  for (long p = 0; p < g->particle_count; p++)
    for (int k = 0; k < g->directions; k++) {
      const long q = g->particle_site[p], far = rows_partner(g, q, k);
      if (!rows_has_bond(g, q, k)) continue;
      const double here = w->field[0][k * g->size + q];
      assert_true(here == w->field[0][(k + g->directions) * g->size + far]);
      assert_true(here == 0 || !(g->held[q] || g->held[far]));
      broken += here != 0;
      values++;
    }
  return (double)broken / (double)values;
}

static void check_threads(int which) {
  static const char *const threads[] = {"simulation.threads=2", "simulation.threads=3",
                                        "simulation.threads=7"};
  deck_case one, more;
  open_threads(&one, which, "simulation.threads=1", false);
  assert_int_equal(deck_case_go(&one), STEP_END);
  const double broken = broken_share(&one);
  print_message("%.1f %% of the bonds are broken\n", 100 * broken);
  const double *cracks;
  simulation_series(one.simulation, 0, NULL, &cracks);
  const rows *g = simulation_state(one.simulation, 0)->body->lattice;
  assert_true(cracks[simulation_history(one.simulation, NULL) - 1] ==
              round(broken * (double)g->bond_count));
  assert_true(broken > 0.01 && broken < 0.5);
  for (size_t k = 0; k < sizeof threads / sizeof *threads; k++) {
    open_threads(&more, which, threads[k], false);
    assert_int_equal(deck_case_go(&more), STEP_END);
    assert_same(&one, &more);
    deck_case_close(&more);
  }
  deck_case_close(&one);
}

/* After an odd and an even number of steps: old and new fields have changed places or not. */
static void check_resuming(int which) {
  deck_case straight;
  open_threads(&straight, which, "simulation.threads=1", false);
  assert_int_equal(deck_case_go(&straight), STEP_END);
  const long steps = simulation_step_done(straight.simulation);
  for (long stop = steps / 2; stop <= steps / 2 + 1; stop++) {
    deck_case first, second;
    open_threads(&first, which, "simulation.threads=1", false);
    open_threads(&second, which, "simulation.threads=2", false);
    hand_over(first.simulation, stop, second.simulation);
    assert_true(broken_share(&first) > 0);
    deck_case_close(&first);
    assert_int_equal(deck_case_go(&second), STEP_END);
    assert_same(&straight, &second);
    deck_case_close(&second);
  }
  deck_case_close(&straight);
}

static void check_interpreter(int which) {
  deck_case compiled, interpreted;
  open_threads(&compiled, which, "simulation.threads=1", false);
  open_threads(&interpreted, which, "simulation.threads=2", true);
  assert_int_equal(deck_case_go(&compiled), STEP_END);
  assert_int_equal(deck_case_go(&interpreted), STEP_END);
  assert_same(&compiled, &interpreted);
  pl_law *reader = (pl_law *)(uintptr_t)interpreted.law.law;
  deck_case_close(&interpreted);
  plan_interpreted_free(reader);
  deck_case_close(&compiled);
}

static void any_number_of_threads_gives_the_same_bits(void **state) {
  (void)state;
  for (int which = 0; which < BODIES; which++)
    check_threads(which);
}

static void a_resumed_run_gives_the_same_bits(void **state) {
  (void)state;
  for (int which = 0; which < BODIES; which++)
    check_resuming(which);
}

static void the_interpreter_gives_the_same_bits(void **state) {
  (void)state;
  for (int which = 0; which < BODIES; which++)
    check_interpreter(which);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
      cmocka_unit_test(a_resumed_run_gives_the_same_bits),
      cmocka_unit_test(the_interpreter_gives_the_same_bits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
