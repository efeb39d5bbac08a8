/* The state-based lattice gives the same bits for any number of threads, and after a checkpoint: a
   prism at 15 degrees, pressed so fast that it yields, cracks and crushes within a millisecond,
   with the lattice's edges and with exact ones. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/runtime/hand_over.h"
#include "tests/runtime/same_runs.h"
#include "tests/verification/case.h"

#define EXACT   "lattice.edges=exact"
#define LATTICE "lattice.edges=lattice"

static void open_prism(deck_case *c, const char *edges, const char *threads) {
  const char *const overrides[] = {threads,           "simulation.end_time=0.9 ms",
                                   "drive.rise=1 ms", "output.sample=0.01 ms",
                                   "output.frames=0", edges};
  assert_true(deck_case_run(c, "examples/compression/rot15.nml", overrides, 6));
}

/* Particles whose value of a field is not 0 on any of its planes. */
static long touched(const sweep *w, int field) {
  const rows *g = w->body->lattice;
  const int planes = sweep_planes(w, w->law->fields[field].place);
  long count = 0;
  for (long p = 0; p < g->particle_count; p++) {
    bool any = false;
    for (int k = 0; k < planes; k++)
      any |= w->field[field][k * g->size + g->particle_site[p]] != 0;
    count += any;
  }
  return count;
}

static void compare_threads(const char *edges) {
  deck_case one, more;
  open_prism(&one, edges, "simulation.threads=1");
  assert_int_equal(deck_case_go(&one), STEP_END);
  const sweep *w = simulation_state(one.simulation, 0);
  for (int f = 0; f < w->law->field_count; f++) { /* every rule of the law was at work */
    print_message("%s: %ld of %ld particles\n", w->law->fields[f].name, touched(w, f),
                  w->body->lattice->particle_count);
    assert_true(touched(w, f) > 20);
  }
  for (int threads = 2; threads <= 3; threads++) {
    open_prism(&more, edges, threads == 2 ? "simulation.threads=2" : "simulation.threads=3");
    assert_int_equal(deck_case_go(&more), STEP_END);
    same_runs(one.simulation, more.simulation);
    deck_case_close(&more);
  }
  deck_case_close(&one);
}

static void any_number_of_threads_gives_the_same_bits(void **state) {
  (void)state;
  compare_threads(LATTICE);
  compare_threads(EXACT);
}

/* Stopped in the midst of yielding, an odd and an even number of steps in. */
static void compare_resumed(const char *edges) {
  deck_case straight;
  open_prism(&straight, edges, "simulation.threads=1");
  assert_int_equal(deck_case_go(&straight), STEP_END);
  for (long stop = 1200; stop <= 1201; stop++) {
    deck_case first, second;
    open_prism(&first, edges, "simulation.threads=1");
    open_prism(&second, edges, "simulation.threads=2");
    hand_over(first.simulation, stop, second.simulation);
    deck_case_close(&first);
    assert_int_equal(deck_case_go(&second), STEP_END);
    same_runs(straight.simulation, second.simulation);
    deck_case_close(&second);
  }
  deck_case_close(&straight);
}

static void a_resumed_run_gives_the_same_bits(void **state) {
  (void)state;
  compare_resumed(LATTICE);
  compare_resumed(EXACT);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
      cmocka_unit_test(a_resumed_run_gives_the_same_bits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
